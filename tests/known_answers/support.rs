//! Shipped specs without rustc, and what it means that a number is known.

use std::path::{Path, PathBuf};

use ntg::prelude::*;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;

/// Asserts that a number is the known one, to a relative error.
#[track_caller]
pub(crate) fn close(found: f64, known: f64, relative: f64) {
    let error = (found / known - 1.0).abs();
    assert!(error <= relative, "{found}, but {known} is known: relative error {error:e}");
}

/// A spec of the folder `specs/`, interpreted, and how to solve it.
pub(crate) struct Shipped(Interpreted, Settings);

struct BesideSpecs;

impl Loader for BesideSpecs {
    fn load(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(folder().join(path)).map_err(|error| error.to_string())
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("specs")
}

impl Shipped {
    /// The spec `specs/{name}.ntg`.
    pub(crate) fn spec(name: &str) -> Self {
        Self::edited(name, &[])
    }

    /// The spec with pieces of its text replaced: for constants, which no program can set.
    pub(crate) fn edited(name: &str, edits: &[(&str, &str)]) -> Self {
        let path = folder().join(name).with_extension("ntg");
        let mut text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        for (old, new) in edits {
            assert_eq!(text.matches(old).count(), 1, "`{old}` must stand once in specs/{name}.ntg");
            text = text.replace(old, new);
        }
        Self::compiled(&Source::new(format!("specs/{name}.ntg"), text))
    }

    /// A spec of a test's own.
    pub(crate) fn text(text: &str) -> Self {
        Self::compiled(&Source::new("test.ntg", text))
    }

    fn compiled(source: &Source) -> Self {
        let compiled = ntg_compiler::compile(source, &BesideSpecs);
        let compiled = compiled.unwrap_or_else(|found| {
            panic!("{}", found.iter().map(|d| d.render(source)).collect::<Vec<_>>().join("\n"))
        });
        Self(Interpreted::new(&compiled.program), Settings::default())
    }

    /// Sets a parameter, in its declared unit.
    #[track_caller]
    pub(crate) fn with(mut self, name: &str, values: &[f64]) -> Self {
        let structure = self.0.structure();
        let parameter = structure.parameters.iter().find(|p| p.name == name);
        let factor = parameter.unwrap_or_else(|| panic!("there is no parameter {name}")).unit.factor;
        let si: Vec<f64> = values.iter().map(|value| value * factor).collect();
        self.0.set(name, &si).unwrap_or_else(|error| panic!("{error}"));
        self
    }

    /// Sets a parameter of a problem that a solver holds, in its declared unit.
    #[track_caller]
    pub(crate) fn set<S>(solver: &mut Solver<Interpreted, S>, name: &str, value: f64) {
        let structure = solver.problem.structure();
        let parameter = structure.parameters.iter().find(|p| p.name == name);
        let factor = parameter.unwrap_or_else(|| panic!("there is no parameter {name}")).unit.factor;
        solver.problem.set(name, &[value * factor]).unwrap_or_else(|error| panic!("{error}"));
    }

    /// A solver that keeps what does not change between solves.
    pub(crate) fn solver(self) -> Solver<Interpreted> {
        Solver::new(self.0, &self.1)
    }

    /// The problem itself.
    pub(crate) fn problem(&self) -> &dyn Problem {
        &self.0
    }

    /// A named expression of a solution.
    #[track_caller]
    pub(crate) fn signal(&self, report: &Report, name: &str) -> Signal<'_> {
        report.solution.signal(&self.0, name).unwrap_or_else(|| panic!("nothing is called {name}"))
    }

    /// Solves by one method, where several minima lie side by side.
    pub(crate) fn by(mut self, method: Method) -> Self {
        self.1.method = method;
        self
    }

    /// Constraints to the last digits: for what is checked in a high derivative, whose numbers are large.
    pub(crate) fn precisely(mut self) -> Self {
        self.1.constraint_tolerance = 1e-12;
        self
    }

    /// Solves from a guess; the solve must succeed.
    #[track_caller]
    pub(crate) fn solve_from(&self, guess: &Guess) -> Report {
        let report = solve_from(&self.0, guess, &self.1);
        let report = report.unwrap_or_else(|error| panic!("{error}"));
        assert!(report.is_solved(), "{report}");
        report
    }

    /// Solves from the spec's own guess; the solve must succeed.
    #[track_caller]
    pub(crate) fn solve(&self) -> Report {
        self.solve_from(&Guess::new())
    }
}

/// By how much a derivative of an output jumps where one phase ends at a time, in declared units.
///
/// | `kind`  | meaning                                            |
/// |---------|----------------------------------------------------|
/// | `kind.0` | the spline's order: pieces are of one degree less |
/// | `kind.1` | which derivative                                  |
///
/// The value from the left is the polynomial before the join, carried there by its own derivatives.
#[track_caller]
pub(crate) fn jump(report: &Report, output: &str, join: f64, kind: (usize, usize)) -> f64 {
    let (order, derivative) = kind;
    let curve = report.solution.output(output).unwrap_or_else(|| panic!("no output {output}"));
    let before = report.phases().iter().find(|phase| phase.end == join).map(|phase| phase.end - phase.start);
    // Nearer to the join than a knot can be.
    let step = 1e-3 * before.unwrap_or_else(|| panic!("no phase ends at {join}"));
    let mut left = 0.0;
    let mut power = 1.0;
    for j in derivative..order {
        left += curve.derivative(join - step, j) * power;
        power *= step / (j - derivative + 1) as f64;
    }
    curve.derivative(join, derivative) - left
}

/// Asserts that all outputs are continuous up to a derivative where phases meet, to 1e-9 in their
/// declared units, and that each phase starts where the one before it ends.
#[track_caller]
pub(crate) fn joins_hold(report: &Report, order: usize, up_to: usize) {
    let phases = report.phases();
    for pair in phases.windows(2) {
        assert_eq!(pair[0].end.to_bits(), pair[1].start.to_bits(), "{} and {}", pair[0].name, pair[1].name);
        for curve in report.solution.trajectories() {
            for derivative in 0..=up_to {
                let jump = jump(report, curve.name(), pair[0].end, (order, derivative));
                let what = format!("derivative {derivative} of {} after {}", curve.name(), pair[0].name);
                assert!(jump.abs() <= 1e-9, "{what} jumps by {jump:e}");
            }
        }
    }
    let whole: f64 = phases.iter().map(|phase| phase.end - phase.start).sum();
    assert!((whole - (report.solution.end() - report.solution.start())).abs() <= 1e-9, "durations add up");
}
