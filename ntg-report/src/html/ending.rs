//! How a solve ended, in a word and in advice: what is missed between the points of the transcription is no good end,
//! neither of a constraint nor of the objective.

use maud::{Markup, html};

use super::spec::{State, state};
use super::tables::{number, place_words, prose, with_unit};
use crate::run::{Constraint, Run};
use ntg_runtime::report::{Cost, Missed, Resolution};

/// What `ntg solve --refine` is told where the objective is off: an error that nobody would see.
const REFINED: &str = "1e-3";

/// Constraints that are met at the points and missed between them by more than the run's tolerance.
fn missed_between(run: &Run) -> Vec<&Constraint> {
    run.constraints.iter().filter(|constraint| state(constraint, run.tolerance()) == State::Between).collect()
}

/// The relative difference of the objective and its finer integral, where it is worth a warning. A refined solution tells
/// of its objective there.
fn off(run: &Run) -> Option<f64> {
    let apart = Cost { value: run.objective, zero: run.objective_zero }.apart(run.objective_fine);
    (run.has_solution() && run.refinement.is_none() && apart > run.tolerance()).then_some(apart)
}

/// How the solve ended, in the words of `ntg solve`.
pub fn ending(run: &Run) -> String {
    resolution(run).map_or_else(|| run.status.clone(), |resolution| resolution.ending(&run.status))
}

/// Whether a solution of the points is one of the problem: what the file says, or, where it is older, what it says of
/// constraints and objective; nothing where there is no solution.
pub fn resolution(run: &Run) -> Option<Resolution> {
    if !run.has_solution() {
        return None;
    }
    let of_file = || {
        let most = run.constraints.iter().filter_map(|constraint| Some(constraint.between.as_ref()?.relative));
        let missed = most.map(Missed::Limit).chain([Missed::Objective(off(run).unwrap_or(0.0))]);
        Resolution::of(missed, run.tolerance())
    };
    Some(Resolution::from_word(&run.resolution).unwrap_or_else(of_file))
}

/// How the solve ended. What is missed between the points is no good end, and what holds at the points alone is none.
pub(super) fn status(run: &Run) -> Markup {
    let resolution = resolution(run);
    let bad = resolution.is_none_or(|resolution| resolution == Resolution::Unresolved);
    let good = run.is_sound() && resolution == Some(Resolution::Fine);
    html! {
        span.status.good[good].warned[!good && !bad].bad[bad] {
            @match ending(run).split_once(": ") {
                Some((word, why)) => { b { (word) } ": " (prose(why)) }
                None => { b { (ending(run)) } }
            }
        }
    }
}

/// `ntg solve` of the run's spec.
fn command(run: &Run) -> String {
    let name = run.spec.as_ref().map_or("SPEC", |spec| spec.name.as_str());
    let plain = |c: char| c.is_alphanumeric() || "/._-+".contains(c);
    if name.chars().all(plain) { format!("ntg solve {name}") } else { format!("ntg solve '{name}'") }
}

/// By how much the objective differs from its finer integral; nothing where that is little.
pub(super) fn cost(run: &Run) -> Markup {
    let Some(apart) = off(run) else { return html! {} };
    let unit = &run.objective_unit;
    html! {
        p.advice {
            "Finely integrated, the objective is " (with_unit(run.objective_fine, unit)) " instead of "
            (with_unit(run.objective, unit)) ": the two differ by "
            (number((1e3 * apart).round() / 10.0)) " % of the larger. The points are too few for its "
            "integrals, and the optimum may be one of these points alone. More points or intervals help: "
            code { (command(run)) " --refine " (REFINED) } " adds intervals until both agree."
        }
    }
}

/// Which constraints are missed between the points, the worst first; nothing where none is.
pub(super) fn missed(run: &Run) -> Markup {
    let mut missed = missed_between(run);
    let relative = |c: &Constraint| c.between.as_ref().map_or(0.0, |worst| worst.relative);
    missed.sort_by(|a, b| relative(b).total_cmp(&relative(a)));
    html! {
        @if let (true, Some(worst)) = (run.has_solution(), missed.first()) {
            p.advice {
                @if missed.len() == 1 { code { (worst.name) } " is missed between the points" }
                @else {
                    (missed.len()) " constraints are missed between the points, most of all " code { (worst.name) }
                }
                @if let Some(between) = &worst.between {
                    " by " (with_unit(between.violation, &worst.unit)) " (" (share(between.relative)) " of its size)"
                    (place_words(between.t, &between.phase, &run.independent))
                }
                ". " code { (command(run)) " --between refine --between-tolerance " (tolerance(relative(worst))) }
                " adds intervals until that is small."
            }
        }
    }
}

/// A part of a size in per cent, to two digits.
fn share(relative: f64) -> String {
    let percent = 100.0 * relative;
    let digits = 10_f64.powf(1.0 - percent.log10().floor());
    format!("{} %", number((percent * digits).round() / digits))
}

/// A tolerance that what was found does not meet: a tenth of it, rounded down to a power of ten; at most what holds
/// without one.
fn tolerance(found: f64) -> String {
    /// Ten's power of `Settings::between_tolerance` without a word.
    const DEFAULT: f64 = -2.0;
    // Rounding must not make 1e-3 a little less than a power of ten.
    format!("1e{}", (found.log10() - 1.0 + 1e-9).floor().min(DEFAULT))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Worst;

    fn solved(objective: f64, objective_fine: f64) -> Run {
        Run { status: "solved".to_owned(), objective, objective_fine, ..Run::default() }
    }

    fn missing(relative: f64) -> Run {
        let between = Some(Worst { violation: relative, relative, ..Worst::default() });
        Run { constraints: vec![Constraint { between, ..Constraint::default() }], ..solved(1.0, 1.0) }
    }

    #[test]
    fn the_head_says_what_the_run_says_by_the_tolerance_of_the_run() {
        for (told, relative, tolerance, word, class) in [
            ("fine", 1e-3, 0.0, "solved", "good"),
            ("", 1e-3, 0.0, "solved", "good"),
            ("coarse", 1e-3, 1e-4, "solved at the points", "warned"),
            ("", 1e-3, 1e-4, "solved at the points", "warned"),
            ("coarse", 0.1, 0.0, "solved at the points", "warned"),
            ("", 0.1, 0.2, "solved", "good"),
            ("unresolved", 3.0, 0.0, "solved at the points, and not between them", "bad"),
            ("", 3.0, 0.0, "solved at the points, and not between them", "bad"),
        ] {
            let run = Run { resolution: told.to_owned(), between_tolerance: tolerance, ..missing(relative) };
            assert_eq!(ending(&run), word, "{told} {relative} {tolerance}");
            let shown = status(&run).into_string();
            assert!(shown.contains(&format!("status {class}\"")), "{shown}");
            assert_eq!(missed(&run).into_string().is_empty(), word == "solved", "{told} {relative} {tolerance}");
        }
    }

    #[test]
    fn an_objective_that_its_finer_integral_does_not_bear_out_is_no_good_end() {
        let run = solved(11.0458, 12.8027);
        assert_eq!(ending(&run), "solved at the points");
        let mut nowhere = solved(1.0, 1.0);
        nowhere.resolution = Resolution::Unresolved.word().to_owned();
        assert_eq!(ending(&nowhere), "solved at the points, and not between them");
        assert!(status(&run).into_string().contains("status warned"));
        let words = cost(&run).into_string();
        assert!(words.contains("12.8027 instead of 11.0458: the two differ by 13.7 % of the larger"), "{words}");
        assert!(words.contains("<code>ntg solve SPEC --refine 1e-3</code>"), "{words}");
        let zero = Run { objective_zero: 1e-9, ..solved(1e-12, 3e-12) };
        for near in [solved(1.702, 1.694), zero, solved(f64::NAN, f64::NAN), solved(0.0, 0.0)] {
            assert!(status(&near).into_string().contains("status good") && cost(&near).into_string().is_empty());
        }
    }

    #[test]
    fn the_command_refines_what_is_missed_in_its_spec() {
        for (found, told) in [(0.0123, "1e-3"), (0.02, "1e-3"), (9.9, "1e-2")] {
            assert_eq!(tolerance(found), told);
            let words = missed(&missing(found)).into_string();
            let command = format!("<code>ntg solve SPEC --between refine --between-tolerance {told}</code>");
            assert!(words.contains(&command), "{words}");
        }
        assert_eq!(tolerance(1e-3), "1e-4");
        let spec = |name: &str| Some(crate::run::Spec { name: name.to_owned(), ..crate::run::Spec::default() });
        let words = |name| missed(&Run { spec: spec(name), ..missing(0.1) }).into_string();
        assert!(words("specs/arm_5.ntg").contains("<code>ntg solve specs/arm_5.ntg --between refine"));
        assert!(
            words("my arm.ntg").contains("<code>ntg solve 'my arm.ntg' --between refine"),
            "{}",
            words("my arm.ntg")
        );
    }

    #[test]
    fn code_in_a_status_is_code() {
        let run = Run { status: "infeasible: `goal` cannot hold".to_owned(), ..Run::default() };
        assert!(status(&run).into_string().contains("<b>infeasible</b>: <code>goal</code> cannot hold"));
    }
}
