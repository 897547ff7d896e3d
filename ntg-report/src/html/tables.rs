//! The tables of a page, and how numbers are written in it.

use maud::{Markup, html};

use super::spec::{State, state};
use crate::figure::Runs;
use crate::run::{Constraint, Independent, Multiplier, Run};

/// Seven significant digits without an exponent where that is readable.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "–".to_owned();
    }
    if !(1e-4..1e9).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let decimals = (6.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A number with its unit.
pub(super) fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() { number(value) } else { format!("{} {unit}", number(value)) }
}

/// A violation: its order of magnitude matters.
pub(super) fn small(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") }
}

/// Seconds of computing.
pub(super) fn seconds(value: f64) -> String {
    if value < 1.0 { format!("{:.3} ms", 1e3 * value) } else { format!("{value:.3} s") }
}

/// ", t = 12.5 s in `covert`"; empty for no place.
pub(super) fn place_words(t: Option<f64>, phase: &str, independent: &Independent) -> String {
    let Independent { name, unit, .. } = independent;
    let time = t.map_or_else(String::new, |t| format!(" at {name} = {} {unit}", number(t)).trim_end().to_owned());
    if phase.is_empty() { time } else { format!("{time} in {phase}") }
}

/// The head of a column of times.
fn time_unit(independent: &Independent) -> String {
    match independent.unit.as_str() {
        "s" => "seconds".to_owned(),
        unit => unit.to_owned(),
    }
}

/// A multiplier, per unit of time where it is a density.
pub(super) fn multiplier_words(multiplier: &Multiplier, independent: &Independent) -> String {
    let per = if multiplier.density { format!(" {}", independent.per()) } else { String::new() };
    format!("{}{per}", number(multiplier.value))
}

/// Prose in which code stands between backticks, as in documentation and messages.
pub(super) fn prose(text: &str) -> Markup {
    let parts: Vec<&str> = text.split('`').collect();
    // A backtick without its partner is a character like any other.
    let closed = parts.len() - 1 + parts.len() % 2;
    html! {
        @for (number, part) in parts.iter().enumerate() {
            @if number % 2 == 1 && number < closed { code { (part) } }
            @else if number == closed { "`" (part) }
            @else { (part) }
        }
    }
}

/// The objective's terms.
pub(super) fn terms(run: &Run) -> Markup {
    html! {
        div.scroll { table {
            thead { tr { th { "term" } th.n { "value" } th.n { "finely integrated" } th { "unit" } } }
            tbody { @for term in &run.terms {
                tr { td { (term.name) } td.n { (number(term.value)) } td.n { (number(term.fine)) } td { (term.unit) } }
            } }
        } }
    }
}

/// Every constraint with its state, violations and multiplier.
pub(super) fn constraints(run: &Run) -> Markup {
    let proved = run.constraints.iter().any(|constraint| constraint.proof.is_some());
    html! {
        @if !run.constraints.is_empty() {
            section #table {
                h2 { "Constraints" }
                div.scroll { table {
                    thead { tr {
                        th { "constraint" } th { "block" } th.n { "line" } th { "state" }
                        th.n { "missed at points" } th.n { "between" }
                        @if proved { th { "for all times" } }
                        th.n { "largest multiplier" } th.n { "at " (run.independent.name) }
                        th.n title="when the bound moves everywhere at once" { "dJ*/d(bound)" } th { "unit" }
                    } }
                    tbody { @for constraint in &run.constraints {
                        @let state = state(constraint, run.tolerance());
                        tr.dim[state == State::Inactive] {
                            td.name { (constraint.name) (which(run, constraint)) }
                            td { (constraint.block) }
                            td.n { @if constraint.line > 0 { (constraint.line) } }
                            td { mark class=(state.class()) { (state.word()) } }
                            td.n { @if let Some(worst) = &constraint.points { (small(worst.relative)) } }
                            td.n { @if let Some(worst) = &constraint.between { (small(worst.relative)) } }
                            @if proved { td { @if let Some(proof) = &constraint.proof {
                                mark.equality[proof.holds()].violated[!proof.holds()] title=(proof.words) { (proof.verdict) }
                            } } }
                            @if let Some(multiplier) = &constraint.largest_multiplier() {
                                @let vague = !run.is_priced(constraint);
                                td.n.vague[vague] { (multiplier_words(multiplier, &run.independent)) }
                                td.n { @if let Some(t) = multiplier.t { (number(t)) } }
                                td.n.vague[vague] { (number(constraint.sensitivity)) @if vague { " ?" } }
                            } @else { td {} td {} td {} }
                            td { (constraint.unit) }
                        }
                    } }
                } }
                p.quiet { "Violations are relative to the size of the bounds. Multipliers are dJ*/d(bound) in units of the objective per unit of the constraint; along a trajectory the largest mean over an interval, a density over time." }
                @if run.constraints.iter().any(|constraint| !run.is_priced(constraint)) { p.quiet {
                    "A question mark: a bound that moves by a thousandth of its size would change the objective by more than all of it. "
                    "Most often several constraints hold one and the same thing there, as a limit at a fixed end does; then their multipliers are not unique, and only their sum means anything."
                } }
                @if proved { p.quiet { "For all times: `proved` and `within` hold between the points, too, in real arithmetic; the words appear under the pointer." } }
            }
        }
    }
}

/// What tells a constraint from others of the same words: its phase, or, where both bounds of a range change along the way,
/// which of them it is.
fn which(run: &Run, constraint: &Constraint) -> String {
    let place = |c: &Constraint| (c.line, c.column);
    let names = |c: &Constraint| c.members.iter().map(|member| member.name.clone()).collect::<Vec<_>>();
    let alike = |other: &&Constraint| other.name == constraint.name && place(other) == place(constraint);
    let all: Vec<&Constraint> = run.constraints.iter().filter(alike).collect();
    let twins: Vec<&&Constraint> = all.iter().filter(|other| names(other) == names(constraint)).collect();
    match (twins.iter().position(|twin| std::ptr::eq(**twin, constraint)), twins.len(), all.len()) {
        (Some(0), 2, _) => ", from below".to_owned(),
        (Some(1), 2, _) => ", from above".to_owned(),
        (_, 1, several) if several > 1 => match constraint.members.first().map(|member| member.name.split(" [").next())
        {
            Some(Some(phase)) if !phase.is_empty() => format!(" in {phase}"),
            _ => String::new(),
        },
        _ => String::new(),
    }
}

/// Times, phases, variables and parameters.
pub(super) fn quantities(run: &Run) -> Markup {
    html! {
        section #quantities {
            h2 { "Times, variables and parameters" }
            div.columns {
                @if !run.times.is_empty() {
                    div.scroll { table {
                        thead { tr { th { (if run.independent.name == "t" { "time" } else { &run.independent.name }) } th.n { (time_unit(&run.independent)) } } }
                        tbody { @for (name, t) in &run.times { tr { td { (name) } td.n { (number(*t)) } } } }
                    } }
                }
                @if !run.variables.is_empty() {
                    div.scroll { table {
                        thead { tr { th { "variable" } th.n { "value" } th { "unit" } } }
                        tbody { @for (name, v) in &run.variables { tr { td { (name) } td.n { (number(v.value)) } td { (v.unit) } } } }
                    } }
                }
                @let constants = run.lets.iter().filter(|(_, series)| series.t.is_empty()).collect::<Vec<_>>();
                @if !constants.is_empty() {
                    div.scroll { table {
                        thead { tr { th { "named number" } th.n { "value" } th { "unit" } } }
                        tbody { @for (name, series) in constants {
                            tr { td { (name) } td.n { (number(series.value.first().copied().unwrap_or(f64::NAN))) } td { (series.unit) } }
                        } }
                    } }
                }
                @if !run.parameters.is_empty() {
                    div.scroll { table {
                        thead { tr { th { "parameter" } th.n { "value" } th { "unit" } } }
                        tbody { @for (name, v) in &run.parameters {
                            tr { td { (name) } td.n { (several(&v.value)) } td { (v.unit) } }
                        } }
                    } }
                }
            }
        }
    }
}

/// Numbers one after another; of many the first ones, the last, and how many there are.
fn several(values: &[f64]) -> String {
    /// So many stand on a line.
    const MOST: usize = 8;
    let all = |values: &[f64]| values.iter().map(|value| number(*value)).collect::<Vec<_>>().join(", ");
    match values {
        [.., last] if values.len() > MOST => {
            format!("{}, ..., {} ({} numbers)", all(&values[..MOST / 2]), number(*last), values.len())
        }
        _ => all(values),
    }
}

/// The steps of a continuation.
pub(super) fn history(run: &Run) -> Markup {
    html! {
        @if run.history.len() > 1 {
            section {
                h2 { "Steps of the continuation" }
                div.scroll { table {
                    thead { tr { th { "parameters" } th.n { "objective" } th.n { "iterations" } th.n { "time" } th { "status" } } }
                    tbody { @for step in &run.history {
                        tr {
                            td { (step.parameters.iter().map(|(n, v)| format!("{n} = {}", number(*v))).collect::<Vec<_>>().join(", ")) }
                            td.n { (number(step.objective)) } td.n { (step.iterations) } td.n { (seconds(step.seconds)) }
                            td { (step.status) }
                        }
                    } }
                } }
            }
        }
    }
}

/// Splines, points and the size of the optimisation problem.
pub(super) fn discretisation(run: &Run) -> Markup {
    let grid = &run.discretisation;
    html! {
        section #discretisation {
            h2 { "Discretisation" }
            p { (grid.variables) " variables, of which " (grid.coefficients) " are spline coefficients; " (grid.rows) " rows of constraints." }
            div.scroll { table {
                thead { tr { th { "phase" } th { "points" } th { "splines" } } }
                tbody { @for phase in &grid.phases {
                    tr {
                        td { @if phase.name.is_empty() { "the whole time" } @else { (phase.name) } }
                        td { (phase.points) }
                        td { @for (name, words) in &phase.splines { div { code { (name) } ": " (words) } } }
                    }
                } }
            } }
        }
    }
}

/// Several runs side by side.
pub(super) fn comparison(runs: &Runs<'_>) -> Markup {
    let mut parameters: Vec<&str> = vec![];
    for (name, values) in runs.iter().flat_map(|(_, run)| &run.parameters) {
        let differs =
            runs.iter().any(|(_, run)| run.parameters.get(name).is_none_or(|other| other.value != values.value));
        if differs && !parameters.contains(&name.as_str()) {
            parameters.push(name);
        }
    }
    html! {
        section #comparison {
            h2 { "Comparison" }
            div.scroll { table {
                thead { tr {
                    th { "run" } th { "status" } th.n { "objective" } th { "unit" } th.n { "finely integrated" }
                    th.n { "missed at points" } th.n { "between" } th.n { "iterations" } th.n { "time" }
                    @for name in &parameters { th.n { (name) } }
                } }
                tbody { @for (name, run) in runs {
                    tr {
                        td.name { (name) }
                        td { (super::ending::status(run)) }
                        td.n { (number(run.objective)) } td { (run.objective_unit) } td.n { (number(run.objective_fine)) }
                        td.n { (small(run.violation.points)) } td.n { (small(run.violation.between)) }
                        td.n { (run.iterations) } td.n { (seconds(run.seconds)) }
                        @for parameter in &parameters {
                            td.n { @if let Some(values) = run.parameters.get(*parameter) {
                                (values.value.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", "))
                            } }
                        }
                    }
                } }
            } }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_array_has_its_ends_and_its_length() {
        assert_eq!(several(&[1.0, 2.5]), "1, 2.5");
        let long: Vec<f64> = (1..=93).map(f64::from).collect();
        assert_eq!(several(&long), "1, 2, 3, 4, ..., 93 (93 numbers)");
        assert_eq!(several(&[]), "");
    }

    #[test]
    fn code_stands_between_backticks_and_a_lone_one_stays() {
        for (text, page) in [
            ("plain & simple", "plain &amp; simple"),
            ("`x` is a position", "<code>x</code> is a position"),
            ("raise `a` or `b<c>`", "raise <code>a</code> or <code>b&lt;c&gt;</code>"),
            ("the ` of `x`", "the <code> of </code>x`"),
            ("a lone ` stays", "a lone ` stays"),
        ] {
            assert_eq!(prose(text).into_string(), page);
        }
    }
}
