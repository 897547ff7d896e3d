//! The spec's own text with its constraints marked: which are violated, which are active, and
//! with which multiplier and where.

use maud::{Markup, html};

use super::tables::{multiplier_words, number, place_words, prose, with_unit};
use crate::run::{Constraint, Run, Spec};

/// Relative violations at points above this are violations.
pub(super) const VIOLATED: f64 = 1e-6;

/// How a constraint ended, from bad to good.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum State {
    /// Missed at a point of the transcription.
    Violated,
    /// Met at the points, missed between them.
    Between,
    /// An inequality that reaches a bound.
    Active,
    /// An equality that holds.
    Equality,
    /// An inequality that stays away from its bounds.
    Inactive,
}

impl State {
    /// The class in the style sheet, which is also its word.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Violated => "violated",
            Self::Between => "missed between points",
            Self::Active => "active",
            Self::Equality => "equality",
            Self::Inactive => "inactive",
        }
    }

    pub(super) fn class(self) -> &'static str {
        if self == Self::Between { "between" } else { self.word() }
    }
}

/// How a constraint ended; `tolerance` is how much is missed between the points without a word, [`Run::tolerance`].
pub(super) fn state(constraint: &Constraint, tolerance: f64) -> State {
    let worst = |worst: &Option<crate::run::Worst>| worst.as_ref().map_or(0.0, |w| w.relative);
    let (points, between) = (worst(&constraint.points), worst(&constraint.between));
    if points > VIOLATED || points.is_nan() {
        return State::Violated;
    }
    if between > tolerance || between.is_nan() {
        return State::Between;
    }
    let members = &constraint.members;
    if !members.is_empty() && members.iter().all(|m| m.lower.is_some() && m.lower == m.upper) {
        return State::Equality;
    }
    if constraint.reaches_a_bound() { State::Active } else { State::Inactive }
}

/// The spec of one run; nothing where the file does not hold it.
pub(super) fn section(name: &str, run: &Run, several: bool) -> Markup {
    let Some(spec) = &run.spec else { return html! {} };
    html! {
        section #spec {
            h2 { @if several { "Spec of " (name) } @else { "Spec" } }
            p.legend {
                @for state in [State::Violated, State::Between, State::Active, State::Equality, State::Inactive] {
                    mark class=(state.class()) { (state.word()) }
                }
                " Point at a constraint for its value, place and multiplier."
            }
            pre.spec tabindex="0" { code { (text(spec, run)) } }
            (findings(spec))
        }
    }
}

fn findings(spec: &Spec) -> Markup {
    html! {
        @if spec.findings.is_empty() {
            p.quiet { "The compiler has nothing to remark on " code { (spec.name) } "." }
        } @else {
            h3 { "What the compiler remarks on " code { (spec.name) } }
            ul.findings {
                @for found in &spec.findings {
                    li {
                        span class={ "severity " (found.severity) } { (found.severity) " " (found.code) }
                        " line " (found.line) ": " (prose(&found.message))
                        @if !found.help.is_empty() { br; span.quiet { (prose(&found.help)) } }
                    }
                }
            }
        }
    }
}

/// A stretch of bytes and the constraints that stand there (a template stands for several).
struct Marked<'a> {
    start: usize,
    end: usize,
    constraints: Vec<&'a Constraint>,
}

fn text(spec: &Spec, run: &Run) -> Markup {
    let marks = marks(&spec.text, &run.constraints);
    let mut at = 0;
    let mut parts: Vec<Markup> = vec![];
    for mark in &marks {
        parts.push(plain(&spec.text[at..mark.start]));
        let state = mark.constraints.iter().map(|c| state(c, run.tolerance())).min().unwrap_or(State::Inactive);
        parts.push(html! {
            mark class=(state.class()) tabindex="0" {
                (&spec.text[mark.start..mark.end])
                span.tip role="tooltip" { @for constraint in &mark.constraints { (tip(constraint, run)) } }
            }
        });
        at = mark.end;
    }
    parts.push(plain(&spec.text[at..]));
    html! { @for part in &parts { (part) } }
}

/// What one reads on pointing at a constraint.
fn tip(constraint: &Constraint, run: &Run) -> Markup {
    let (state, independent) = (state(constraint, run.tolerance()), &run.independent);
    html! {
        span.tipline {
            b { (constraint.name) } " is " (state.word())
            @if let Some(worst) = constraint.points.iter().chain(&constraint.between).find(|w| w.relative > VIOLATED) {
                span.row { "missed by " (with_unit(worst.violation, &constraint.unit)) (place_words(worst.t, &worst.phase, independent)) }
            }
            @if let Some(multiplier) = &constraint.largest_multiplier() {
                span.row { "largest multiplier " (multiplier_words(multiplier, independent)) (place_words(multiplier.t, "", independent)) }
                @if constraint.sensitivity.is_finite() {
                    span.row { "dJ*/d(bound) " (number(constraint.sensitivity)) }
                }
            }
        }
    }
}

/// Text outside of constraints, with its comments set apart.
fn plain(text: &str) -> Markup {
    html! {
        @for line in text.split_inclusive('\n') {
            @match line.find("//") {
                Some(comment) => { (&line[..comment]) span.comment { (&line[comment..]) } }
                None => { (line) }
            }
        }
    }
}

/// The constraints' stretches in order of the text, each once.
fn marks<'a>(text: &str, constraints: &'a [Constraint]) -> Vec<Marked<'a>> {
    let mut marks: Vec<Marked<'a>> = vec![];
    for constraint in constraints.iter().filter(|c| c.line > 0 && c.block != "continuity") {
        let Some((start, end)) = stretch(text, constraint) else { continue };
        match marks.iter_mut().find(|mark| mark.start == start) {
            Some(mark) => mark.constraints.push(constraint),
            None => marks.push(Marked { start, end, constraints: vec![constraint] }),
        }
    }
    marks.sort_by_key(|mark| mark.start);
    let mut end = 0;
    marks.retain(|mark| {
        let apart = mark.start >= end;
        end = end.max(mark.end);
        apart
    });
    marks
}

/// Where a constraint stands: from its place as far as its text goes, whatever the white space;
/// a text that was cut goes on to its semicolon.
fn stretch(text: &str, constraint: &Constraint) -> Option<(usize, usize)> {
    let line = text.split_inclusive('\n').take(constraint.line as usize - 1).map(str::len).sum::<usize>();
    let rest = text.get(line..)?.trim_start_matches('\u{feff}');
    let line = text.len() - rest.len();
    let column = rest.char_indices().nth(constraint.column.saturating_sub(1) as usize).map_or(rest.len(), |(at, _)| at);
    let start = line + column;
    let (wanted, cut) = match constraint.text.strip_suffix("...") {
        Some(head) => (head, true),
        None => (constraint.text.as_str(), false),
    };
    let mut letters = wanted.chars().filter(|c| !c.is_whitespace()).peekable();
    let mut end = start;
    for (at, found) in text.get(start..)?.char_indices().filter(|(_, c)| !c.is_whitespace()) {
        match letters.next_if_eq(&found) {
            Some(_) => end = start + at + found.len_utf8(),
            None => break,
        }
    }
    if letters.peek().is_some() {
        return None; // The text is another one than that of the run.
    }
    if cut {
        end += text[end..].find(';').unwrap_or(0);
    }
    (end > start).then_some((start, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(line: u32, column: u32, text: &str) -> Constraint {
        Constraint { line, column, text: text.to_owned(), ..Constraint::default() }
    }

    #[test]
    fn a_constraint_is_found_over_lines_and_after_letters_of_several_bytes() {
        let text = "\u{feff}final {\n    ẋ: a +\n      b <= 2;\n}";
        let (start, end) = stretch(text, &at(2, 5, "ẋ: a + b <= 2")).expect("it stands there");
        assert_eq!(&text[start..end], "ẋ: a +\n      b <= 2");
        let (start, end) = stretch(text, &at(2, 5, "ẋ: a...")).expect("it stands there");
        assert_eq!(&text[start..end], "ẋ: a +\n      b <= 2");
        assert!(stretch(text, &at(2, 5, "x: a")).is_none(), "another text is not marked");
        assert!(stretch(text, &at(9, 1, "x")).is_none());
    }

    #[test]
    fn a_template_is_marked_once_for_all_its_phases_and_comments_are_set_apart() {
        let text = "// head <b>\ntrajectory { v <= 1; }";
        let both = [at(2, 14, "v <= 1"), at(2, 14, "v <= 1")];
        assert_eq!(marks(text, &both).len(), 1);
        assert_eq!(marks(text, &both)[0].constraints.len(), 2);
        let shown = plain(text).into_string();
        assert!(shown.contains("<span class=\"comment\">// head &lt;b&gt;\n</span>"), "{shown}");
    }

    #[test]
    fn states_are_told_apart() {
        let member = |lower, upper, value: f64| crate::run::Member {
            lower,
            upper,
            value: vec![value],
            ..crate::run::Member::default()
        };
        let with = |member, relative| Constraint {
            points: Some(crate::run::Worst { relative, ..Default::default() }),
            members: vec![member],
            ..Constraint::default()
        };
        assert_eq!(state(&with(member(None, Some(1.0), 0.5), 0.0), 0.01), State::Inactive);
        assert_eq!(state(&with(member(None, Some(1.0), 1.0), 0.0), 0.01), State::Active);
        assert_eq!(state(&with(member(Some(1.0), Some(1.0), 1.0), 0.0), 0.01), State::Equality);
        assert_eq!(state(&with(member(None, Some(1.0), 1.1), 0.1), 0.01), State::Violated);
        assert_eq!(state(&with(member(None, Some(1.0), 1.1), f64::NAN), 0.01), State::Violated);
    }
}
