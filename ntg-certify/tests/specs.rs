//! Shipped specs: what is proved encloses what the runtime computes, the checker agrees, a guarantee mends.

use std::path::{Path, PathBuf};

use ntg_certify::certify::certify;
use ntg_certify::change::Spared;
use ntg_certify::guarantee::{Ending, Task, proved_from};
use ntg_certify::prove::Options;
use ntg_certify::{Certificate, Finding, Guarantee, Verdict, statement, write};
use ntg_compiler::model::Loader;
use ntg_compiler::program::Program;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::prelude::*;

struct Beside(PathBuf);

impl Loader for Beside {
    fn load(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(self.0.join(path)).map_err(|error| error.to_string())
    }
}

struct Solved {
    program: Program,
    problem: Interpreted,
    report: Report,
    text: String,
}

fn solved(spec: &str) -> Solved {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs");
    solved_text(spec, std::fs::read_to_string(folder.join(spec)).expect("a spec"))
}

fn solved_text(spec: &str, text: String) -> Solved {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs");
    let source = Source::new(spec, text.clone());
    let program = ntg_compiler::compile(&source, &Beside(folder)).expect("a sound spec").program;
    let problem = Interpreted::new(&program);
    let report = solve(&problem, &Settings::default()).expect("a problem");
    assert!(report.is_solved(), "{spec}: {report}");
    Solved { program, problem, report, text }
}

fn certified(of: &Solved) -> Certificate {
    let statement = statement(&of.program, &of.report.solution, &of.text).expect("a solution");
    certify(statement, &Options::default())
}

#[test]
fn bounds_enclose_what_the_runtime_computes_and_the_checker_agrees() {
    for spec in
        ["missile_intercept.ntg", "multi_vehicle_separated.ntg", "radar_net.ntg", "launch.ntg", "round_the_mast.ntg"]
    {
        let of = solved(spec);
        let certificate = certified(&of);
        let summary = certificate.summary(&of.program.structure);
        for signal in of.report.solution.signals(&of.problem) {
            let name = signal.name().rsplit('.').next().unwrap_or_default().to_owned();
            let own: Vec<_> = summary.named.iter().filter(|b| b.name.split(" in ").next() == Some(&name)).collect();
            assert!(!own.is_empty(), "{spec}: nothing is said of {name}");
            let low = own.iter().map(|b| b.values.0).fold(f64::INFINITY, f64::min);
            let high = own.iter().map(|b| b.values.1).fold(f64::NEG_INFINITY, f64::max);
            let (start, end) = signal.span().unwrap_or((0.0, 0.0));
            for i in 0..=200 {
                let value = signal.at(start + (end - start) * f64::from(i) / 200.0);
                let slack = 1e-9 * (1.0 + value.abs());
                let inside = low - slack <= value && value <= high + slack;
                assert!(inside || value.is_nan(), "{spec}: {name} = {value} is not in {low} .. {high}");
            }
        }
        for (term, bounds) in of.report.terms.iter().zip(&summary.terms) {
            let slack = 1e-6 * (1.0 + term.fine.abs());
            let inside = bounds.values.0 - slack <= term.fine && term.fine <= bounds.values.1 + slack;
            assert!(inside, "{spec}: {} = {} is not in {:?}", term.name, term.fine, bounds.values);
        }
        let checked = ntg_check::verify(&write::text(&certificate));
        let refuted = certificate.findings.iter().filter(|f| matches!(f.verdict, Verdict::Refuted(..))).count();
        assert_eq!(checked.map(|checked| checked.get("refuted").copied().unwrap_or(0)), Ok(refuted), "{spec}");
    }
}

#[test]
fn what_fails_between_the_points_is_mended_at_little_cost() {
    for spec in ["gates.ntg", "missile_intercept.ntg", "low_observable.ntg", "low_observable_gauss.ntg"] {
        let of = solved(spec);
        let before = certified(&of);
        let is_missed = |finding: &Finding| finding.witness.is_some_and(|witness| witness.missed > 0.0);
        assert!(before.findings.iter().any(is_missed), "{spec} is to fail at a time between the points");
        let task = Task { program: &of.program, problem: &of.problem, spec: &of.text };
        let wanted = Guarantee::default();
        let found = proved_from(task, of.report.clone(), &Settings::default(), &wanted).expect("a problem");
        assert_eq!(found.ending, Ending::Proved, "{spec}: {:?}", found.rounds);
        assert!((-1e-6..1e-3).contains(&found.cost()), "{spec} costs {}", found.cost());
        for number in found.changes.keys() {
            let own = &found.report.constraints[*number];
            assert!(own.between.as_ref().is_none_or(|worst| worst.violation == 0.0), "{spec}: {}", own.name);
        }
        let checked = ntg_check::verify(&write::text(&found.certificate)).expect("a sound certificate");
        assert!(!checked.contains_key("refuted") && !checked.contains_key("undecided"), "{spec}: {checked:?}");
    }
}

#[test]
fn a_kink_is_held_at_its_own_time() {
    // Beside the kinks of a ground of straight lines ever more points help little.
    let of = solved("gallery/terrain_linear.ntg");
    let task = Task { program: &of.program, problem: &of.problem, spec: &of.text };
    let found = proved_from(task, of.report.clone(), &Settings::default(), &Guarantee::default()).expect("a problem");
    assert_eq!(found.ending, Ending::Proved, "{:?}", found.rounds);
    let (held, points) = found.changes.values().map(|change| (change.held(), change.points())).max().unwrap_or((0, 0));
    assert!(held > 0 && points <= 8 && found.rounds.len() <= 4, "{held} times, {points}, {:?}", found.rounds);
}

#[test]
fn what_is_missed_by_roundings_is_not_refuted() {
    // Some last places below what the end of the last agent is: another arithmetic need not find them, and does not have to.
    for last_places in 0..12 {
        let latest = 3.0 - f64::from(last_places) * 3.0 * f64::EPSILON / 2.0;
        let text = format!(
            "problem Agents {{ const n = 3;
                agent c[i in 1 .. n] {{ start in 0 .. 10 [s]; duration in 1 .. 4 [s];
                    output x [m]: spline(order = 4, intervals = 1); minimize e [m^2/s^3]: integral(der(x, 2)^2);
                    initial {{ x == 0; der(x) == 0; }} final {{ x == i * 1 [m]; der(x) == 0; }} }}
                temporal {{ for i in 1 .. n - 1 {{ end(c[i + 1]) >= end(c[i]) + 1 [s]; }} end(c[n]) <= {latest:?} [s]; }} }}"
        );
        let certificate = certified(&solved_text("agents", text));
        let checked = ntg_check::verify(&write::text(&certificate));
        assert!(checked.is_ok(), "{last_places} below: {checked:?}");
    }
}

#[test]
fn what_an_end_condition_meets_is_proved_too() {
    // The path has a bound that is also where it ends: there it is kept to the last bit, and tightened elsewhere.
    for spec in ["gallery/bryson_denham.ntg", "gallery/contact_order_three.ntg", "gallery/beam.ntg"] {
        let of = solved(spec);
        assert!(!certified(&of).is_proved(), "{spec} is to fail between the points");
        let task = Task { program: &of.program, problem: &of.problem, spec: &of.text };
        let wanted = Guarantee::default();
        let found = proved_from(task, of.report.clone(), &Settings::default(), &wanted).expect("a problem");
        assert_eq!(found.ending, Ending::Proved, "{spec}: {:?}", found.rounds);
        assert!(
            found.changes.values().any(|change| change.ends != [Spared::Nothing; 2]),
            "{spec}: {:?}",
            found.changes
        );
        let checked = ntg_check::verify(&write::text(&found.certificate)).expect("a sound certificate");
        assert!(!checked.contains_key("refuted") && !checked.contains_key("undecided"), "{spec}: {checked:?}");
    }
}

#[test]
fn what_cannot_be_tightened_is_said_to_be_missed_by_rounding() {
    // The height begins at its bound and rises with a speed that begins at 0, which the equation of motion says at points
    // of collocation alone.
    let of = solved("gallery/goddard.ntg");
    let task = Task { program: &of.program, problem: &of.problem, spec: &of.text };
    let wanted = Guarantee::default();
    let found = proved_from(task, of.report.clone(), &Settings::default(), &wanted).expect("a problem");
    assert_eq!(found.ending, Ending::Rounding, "{:?}", found.rounds);
    assert!(found.rounds.first().is_some_and(|first| first.missed > 1e-5), "{:?}", found.rounds);
    assert!(found.rounds.last().is_some_and(|last| last.missed <= wanted.margin), "{:?}", found.rounds);
    assert!(ntg_check::verify(&write::text(&found.certificate)).is_ok());
}
