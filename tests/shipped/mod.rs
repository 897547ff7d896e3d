//! What laws over the shipped specs have in common: which specs there are, how one is solved after a change of its text's
//! tree or of its meaning, and when two outcomes count as the same.

use ntg_compiler::model::problem::Problem;
use ntg_compiler::model::{self, Loader};
use ntg_compiler::source::Source;
use ntg_compiler::syntax::ast::Spec;
use ntg_compiler::{program, syntax};
use ntg_interp::Interpreted;
use ntg_runtime::report::Report;
use ntg_runtime::settings::Settings;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// More iterations than this are not compared: a path of that many through a problem that is not convex depends on rounding.
const LONG: usize = 200;
/// A path that depends on rounding although it is shorter (`tests/laws.rs`).
const CHAOTIC: &str = "powered_descent_6dof";
/// By how much optima may differ, relative.
const SAME_OPTIMUM: f64 = 1e-6;

/// A change of a spec that does not change its optimum.
pub(crate) struct Change {
    /// What a failure calls it.
    name: &'static str,
    how: How,
}

/// What is changed.
enum How {
    /// What was written.
    Written(fn(&mut Spec)),
    /// What is meant; whether there was anything to change.
    Meant(Box<dyn Fn(&mut Problem) -> bool + Sync>),
}

impl Change {
    /// A change of what was written.
    #[allow(dead_code, reason = "each law has changes of one kind")]
    pub(crate) fn written(name: &'static str, change: fn(&mut Spec)) -> Self {
        Self { name, how: How::Written(change) }
    }

    /// A change of what is meant, which says whether there was anything to change.
    #[allow(dead_code, reason = "each law has changes of one kind")]
    pub(crate) fn meant(name: &'static str, change: impl Fn(&mut Problem) -> bool + Sync + 'static) -> Self {
        Self { name, how: How::Meant(Box::new(change)) }
    }

    /// Whether it changes a spec.
    fn spec(&self, spec: &mut Spec) -> bool {
        let How::Written(change) = &self.how else { return false };
        let before = spec.clone();
        change(spec);
        *spec != before
    }

    /// Whether it changes a problem.
    fn problem(&self, problem: &mut Problem) -> bool {
        if let How::Meant(change) = &self.how { change(problem) } else { false }
    }
}

/// What a law says of one spec after one change.
enum Found {
    /// It holds.
    Same,
    /// The change has nothing to change.
    Unchanged,
    /// It does not hold: what was found instead.
    Broken(String),
}

/// Files are found beside the specs.
struct Beside(PathBuf);

impl Loader for Beside {
    fn load(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(self.0.join(path)).map_err(|error| error.to_string())
    }
}

/// All shipped specs, and those of the gallery that once depended on units: joints in line, outputs without a slope.
fn specs() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("specs");
    let files = std::fs::read_dir(&folder).expect("the folder is there").map(|entry| entry.expect("readable").path());
    let mut specs: Vec<_> = files.filter(|path| path.extension().is_some_and(|e| e == "ntg")).collect();
    specs.sort();
    assert!(specs.len() >= 20, "{} specs", specs.len());
    let of_gallery = ["arm_2", "arm_3", "radar_net_2", "halo_orbit", "f8", "heat_control", "free_flying_robot"];
    specs.extend(of_gallery.map(|name| folder.join("gallery").join(name).with_extension("ntg")));
    specs
}

/// Solves a spec after a change; none where the change has nothing to change.
fn solved(path: &Path, change: Option<&Change>) -> Option<Report> {
    let source = Source::new(path.display().to_string(), std::fs::read_to_string(path).expect("readable"));
    let mut spec = syntax::parse(&source).unwrap_or_else(|_| panic!("{}", path.display()));
    let beside = Beside(path.parent().expect("a folder").to_path_buf());
    let is_rewritten = change.is_some_and(|change| change.spec(&mut spec));
    let (problem, findings) = model::build(&spec, &source, &beside);
    let mut problem = problem.unwrap_or_else(|| panic!("{}: {findings:?}", path.display()));
    if change.is_some_and(|change| !is_rewritten && !change.problem(&mut problem)) {
        return None;
    }
    let program = program::lower(problem, &source);
    Some(ntg_runtime::solve(&Interpreted::new(&program), &Settings::default()).expect("can be set up"))
}

/// The optimum agrees, and iterations to half as many again.
fn is_the_same(plain: &Report, other: &Report) -> bool {
    plain.is_solved() == other.is_solved()
        && (other.objective - plain.objective).abs() <= SAME_OPTIMUM * plain.objective.abs().max(1e-9)
        && other.iterations <= plain.iterations * 3 / 2 + 3
        && plain.iterations <= other.iterations * 3 / 2 + 3
}

/// What the law says of one spec, after each of the changes.
fn compared(path: &Path, changes: &[Change], except: &[&str]) -> Vec<Found> {
    let name = path.file_stem().expect("a name").to_string_lossy();
    if name == CHAOTIC || except.contains(&&*name) {
        return vec![];
    }
    let plain = solved(path, None).expect("nothing is changed");
    assert!(plain.has_solution(), "{}: {} after {}", path.display(), plain.status, plain.iterations);
    if plain.iterations > LONG {
        return vec![];
    }
    let compare = |change: &Change| {
        let Some(other) = solved(path, Some(change)) else { return Found::Unchanged };
        if is_the_same(&plain, &other) {
            return Found::Same;
        }
        let (found, wanted) = ((&other.status, other.iterations), (&plain.status, plain.iterations));
        let objectives = (other.objective, plain.objective);
        Found::Broken(format!("{name} ({}): {found:?} for {wanted:?}, {objectives:?}", change.name))
    };
    changes.iter().map(compare).collect()
}

/// Compares all specs but for some after each of the changes, on all cores; at least `enough` outcomes are of changed specs.
pub(crate) fn holds(changes: &[Change], except: &[&str], enough: usize) {
    let found: Vec<Found> = specs().par_iter().flat_map_iter(|path| compared(path, changes, except)).collect();
    let broken: Vec<&str> = found
        .iter()
        .filter_map(|found| if let Found::Broken(how) = found { Some(how.as_str()) } else { None })
        .collect();
    let changed = found.iter().filter(|found| !matches!(found, Found::Unchanged)).count();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    assert!(changed >= enough, "{changed} were changed");
}
