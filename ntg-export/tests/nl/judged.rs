//! What is said to be solved is a solution: a judge outside the solver confirms it, for all shipped specs, and for those of
//! the gallery that have ended wrongly, or in which a constraint or the objective loses its gradient at the optimum.

use super::compile;
use ntg_export::judge::{Point, judge};
use ntg_interp::Interpreted;
use ntg_runtime::guess::{Guess, start};
use ntg_runtime::nlp::Nlp;
use ntg_runtime::problem::WithStructure;
use ntg_runtime::report::Report;
use ntg_runtime::settings::Settings;
use ntg_runtime::transcribe::Transcription;
use std::path::{Path, PathBuf};

/// The largest error that a solution may have, relative to sizes: tolerances are 1e-8 of what the solver scales by.
const MOST: f64 = 1e-6;
/// By how much a second start is moved, in parts of typical sizes.
const MOVED: f64 = 0.2;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs")
}

/// What the judge finds worst; the status where the solver does not say that the point is a solution.
fn worst(path: &Path, seed: Option<u64>) -> Result<f64, String> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let folder = path.parent().unwrap_or(Path::new("."));
    let problem = Interpreted::new(&compile(&text, folder).program);
    let report = solved(&problem, seed);
    if !report.is_solved() {
        return Err(report.to_string());
    }
    // With the parameters of the last step of a continuation.
    let last = WithStructure::new(&problem).edited(|structure| structure.clone_from(report.solution.structure()));
    let mut nlp = Transcription::new(&last).expect("it was transcribed before");
    let first = start(&nlp, None).expect("it had a start");
    nlp.set_scales(&first, &Settings::default()).expect("it had sizes");
    let (x, multipliers) = (report.solution.coefficients(), Some(report.solution.row_multipliers()));
    let judged = judge(&nlp, Point { x, multipliers }).expect("finite at a solution");
    let [stationarity, complementarity] = judged.optimality.expect("there are multipliers");
    Ok(judged.violation().max(stationarity.relative).max(complementarity.relative))
}

/// From the spec's guess, or from a point beside it.
fn solved(problem: &Interpreted, seed: Option<u64>) -> Report {
    let settings = Settings::default();
    let Some(seed) = seed else { return ntg_runtime::solve(problem, &settings).expect("it can be begun") };
    let mut nlp = Transcription::new(problem).expect("it can be transcribed");
    let mut first = start(&nlp, None).expect("it has a start");
    nlp.set_scales(&first, &settings).expect("it has sizes");
    let mut random = fastrand::Rng::with_seed(seed);
    let sizes = nlp.limits().scale.clone();
    first.iter_mut().zip(sizes).for_each(|(x, size)| *x += MOVED * size * (random.f64() - 0.5));
    ntg_runtime::solve_from(problem, &Guess::raw(first), &settings).expect("it can be begun")
}

#[test]
fn the_judge_confirms_what_is_solved() {
    let files = std::fs::read_dir(folder()).expect("the folder is there").map(|entry| entry.expect("readable").path());
    let mut asked: Vec<(PathBuf, Option<u64>)> =
        files.filter(|path| path.extension().is_some_and(|e| e == "ntg")).map(|path| (path, None)).collect();
    let gallery = |name: &str| folder().join("gallery").join(name).with_extension("ntg");
    for name in ["lambert", "two_phase_schwartz", "lander_6dof", "terrain_spline", "radar_net_20", "formation_4"] {
        asked.push((gallery(name), None));
    }
    asked.extend([None, Some(1), Some(2), Some(3), Some(4)].map(|seed| (gallery("powered_descent_mars"), seed)));
    let mut wrong = vec![];
    for (path, seed) in &asked {
        match worst(path, *seed) {
            Ok(error) if error <= MOST => {}
            Ok(error) => wrong.push(format!("{} {seed:?}: {error:.1e}", path.display())),
            Err(report) => wrong.push(format!("{} {seed:?}: {report}", path.display())),
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
