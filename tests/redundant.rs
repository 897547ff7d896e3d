//! The law of redundant equations: an equation that follows from others changes no optimum.
//!
//! Each shipped spec is solved again with equations that say nothing new: copies, multiples, and sums of two equations of the
//! same points. The Jacobian of the equations then has less than full rank at every point, and multipliers are not unique.
//! The compiler and the transcription take them as they take those of a user, who writes the same at two places.

mod shipped;

use ntg_compiler::expr::{Binary, NodeId};
use ntg_compiler::model::problem::{Bounds, Constraint, Domain, Problem};
use ntg_compiler::model::{self, Loader};
use ntg_compiler::source::Source;
use ntg_compiler::{program, syntax};
use ntg_interp::Interpreted;
use ntg_runtime::nlp::Nlp;
use ntg_runtime::structure::Block;
use ntg_runtime::transcribe::Transcription;
use shipped::{Change, holds};

/// Four minima of its mesh, three of them between 7.91717 and 7.91790 (`specs/gallery/expected.json`): which one is found, and in
/// how many iterations, depends on rounding. Sums of its equations take 385 iterations for 89.
const MANY_MINIMA: &str = "free_flying_robot";
/// One of how many equations is copied, where not all of them are.
const EVERY: usize = 3;

/// The equations of a problem: body and value.
fn equations(problem: &Problem) -> Vec<(Constraint, NodeId)> {
    let value = |c: &Constraint| c.bounds.lower.filter(|lower| c.bounds.upper == Some(*lower));
    let all = problem.constraints.iter().filter(|c| c.block != Block::Corner);
    all.filter_map(|c| Some((c.clone(), value(c)?))).collect()
}

/// An equation with another body and value.
fn with(equation: &Constraint, body: NodeId, value: NodeId) -> Constraint {
    let bounds = Bounds { lower: Some(value), upper: Some(value) };
    Constraint { name: None, written: None, body, bounds, ..equation.clone() }
}

/// Adds equations, before the compiler's own, which come last; whether there are any.
fn add(problem: &mut Problem, more: Vec<Constraint>) -> bool {
    let is_any = !more.is_empty();
    let end = problem.constraints.iter().position(|c| c.block == Block::Corner).unwrap_or(problem.constraints.len());
    problem.constraints.splice(end..end, more);
    is_any
}

/// Multiples of equations.
fn add_multiples(problem: &mut Problem, factor: f64, of: Vec<(Constraint, NodeId)>) -> bool {
    let factor = problem.dag.constant(factor);
    let mut multiple = |(equation, value): (Constraint, NodeId)| {
        let body = problem.dag.binary(Binary::Mul, factor, equation.body);
        let value = problem.dag.binary(Binary::Mul, factor, value);
        with(&equation, body, value)
    };
    let more = of.into_iter().map(&mut multiple).collect();
    add(problem, more)
}

/// One of three equations a second time.
fn copies(problem: &mut Problem) -> bool {
    let of = equations(problem).into_iter().step_by(EVERY).collect();
    add_multiples(problem, 1.0, of)
}

/// Twice every equation along paths: the equations of motion.
fn doubled_motion(problem: &mut Problem) -> bool {
    let is_path = |(c, _): &(Constraint, NodeId)| matches!(c.domain, Domain::Path(..));
    let of = equations(problem).into_iter().filter(is_path).collect();
    add_multiples(problem, 2.0, of)
}

/// Twice every equation at a start or an end, and of the whole.
fn doubled_ends(problem: &mut Problem) -> bool {
    let is_path = |(c, _): &(Constraint, NodeId)| matches!(c.domain, Domain::Path(..));
    let of = equations(problem).into_iter().filter(|equation| !is_path(equation)).collect();
    add_multiples(problem, 2.0, of)
}

/// The sums of equations that follow one another and hold at the same points.
fn sums(problem: &mut Problem) -> bool {
    let all = equations(problem);
    let is_pair = |(a, b): &(&Constraint, &Constraint)| {
        (a.block, a.sides, &a.loops, &a.domain) == (b.block, b.sides, &b.loops, &b.domain)
    };
    let mut more = vec![];
    for two in all.windows(2) {
        let ((a, of_a), (b, of_b)) = (&two[0], &two[1]);
        if is_pair(&(a, b)) {
            let body = problem.dag.binary(Binary::Add, a.body, b.body);
            let value = problem.dag.binary(Binary::Add, *of_a, *of_b);
            more.push(with(a, body, value));
        }
    }
    add(problem, more)
}

#[test]
fn equations_that_follow_from_others_change_no_optimum() {
    let changes = [
        Change::meant("copies", copies),
        Change::meant("doubled motion", doubled_motion),
        Change::meant("doubled ends", doubled_ends),
        Change::meant("sums", sums),
    ];
    holds(&changes, &[MANY_MINIMA], 60);
}

/// There are no files.
struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("{path}: there are no files"))
    }
}

/// How many rows the program of a small spec has, after a change of what it means.
fn rows(change: fn(&mut Problem) -> bool) -> usize {
    let text = "problem Turn {
        duration T = 1;
        state x, v;
        input u;
        collocation gauss(points = 3, intervals = 2);
        minimize integral(u^2);
        dynamics { der(x) == v;  der(v) == u - sin(x); }
        initial { x == 0;  v == 0; }
        final { x == 1;  cos(v) == 1; }
    }";
    let source = Source::new("turn.ntg", text);
    let spec = syntax::parse(&source).unwrap_or_else(|_| panic!("{text}"));
    let (problem, _) = model::build(&spec, &source, &NoFiles);
    let mut problem = problem.expect("it has a meaning");
    change(&mut problem);
    let program = program::lower(problem, &source);
    Transcription::new(&Interpreted::new(&program)).expect("it transcribes").rows()
}

/// Neither the compiler nor the transcription drops what follows from others, so that the law is about the solver.
#[test]
fn equations_that_follow_from_others_are_rows() {
    let plain = rows(|_| false);
    // Two equations of motion at three points of two intervals are 12 rows, two conditions at each end are 4.
    // Copied are the first equation of motion and the second condition; sums are one of each two.
    assert_eq!([copies, doubled_motion, doubled_ends, sums].map(|change| rows(change) - plain), [7, 12, 4, 8]);
}
