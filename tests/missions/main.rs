//! Laws of missions: what holds for phases, agents and their events whatever the problem is.

mod constructs;
mod growth;
mod multipliers;
mod times;
mod typed;

use ntg::prelude::*;
use ntg_compiler::Compiled;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;

struct NoTables;

impl Loader for NoTables {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("`{path}` is not needed here"))
    }
}

/// Compiles the text of a spec.
#[track_caller]
fn compile(text: &str) -> Compiled {
    let source = Source::new("spec.ntg", text);
    ntg_compiler::compile(&source, &NoTables)
        .unwrap_or_else(|found| panic!("{}", found.iter().map(|d| d.render(&source)).collect::<Vec<_>>().join("\n")))
}

/// A spec of the folder `specs/`.
fn shipped(name: &str) -> String {
    let path = format!("{}/specs/{name}.ntg", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Solves to more digits than the default; the solve must succeed.
#[track_caller]
fn solved(problem: &Interpreted) -> Report {
    let settings = Settings { tolerance: 1e-10, constraint_tolerance: 1e-10, ..Settings::default() };
    let report = solve(problem, &settings).unwrap_or_else(|error| panic!("{error}"));
    assert!(report.is_solved(), "{report}");
    report
}
