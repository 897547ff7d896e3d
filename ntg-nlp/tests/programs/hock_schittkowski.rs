//! Both methods on the smooth problems of Hock and Schittkowski, from the published starts to the published optima.

use crate::hs::Problem;
use ntg_nlp::{InertiaCorrection, Method, Options, Outcome, Status, Violations, ipm, sqp};

/// Iterations of one problem at most. A law, and a generous one.
const MOST_ITERATIONS: usize = 100;
/// How far an objective may be from the published one, relative to it and at least to 0.1.
const TOLERANCE: f64 = 1e-6;

/// Optima that are not the published ones. Most are local optima. The one of 105 is lower than the published one, whose
/// point has the objective 1136.670 with the data here; the one of 109 is lower too.
const OTHER_OPTIMA: [(u32, f64); 13] = [
    (2, 4.941_229_318),
    (16, 23.144_660_94),
    (20, 40.198_729_81),
    (44, -13.0),
    (55, 20.0 / 3.0),
    (57, 0.030_647_619_05),
    (59, -7.802_789_471_5),
    (59, -6.749_505_273_7),
    (97, 4.071_246_357),
    (98, 4.071_246_357),
    (105, 1_136.307_303_6),
    (108, -0.674_981_442_9),
    (109, 5_326.851_330),
];

/// Problems that a method does not solve as asked, and what is seen. A problem that is solved must leave the table.
const EXCEPTIONS_OF_IPM: [(u32, &str); 0] = [];
/// As above. Those of 13 and 116 are faults: they are called solved. So is that of 63.
const EXCEPTIONS_OF_SQP: [(u32, &str); 5] = [
    (13, "called solved 1e-5 beside the optimum, where no multipliers exist"),
    (63, "called infeasible after 4 iterations"),
    (93, "a subproblem fails after one step"),
    (106, "290 iterations"),
    (116, "called solved 4e-5 above the optimum"),
];

fn is_right(problem: &Problem, outcome: &Outcome) -> bool {
    let others = OTHER_OPTIMA.iter().filter(|(number, _)| *number == problem.number).map(|(_, optimum)| *optimum);
    let near = |optimum: f64| (outcome.objective - optimum).abs() <= TOLERANCE * optimum.abs().max(0.1);
    outcome.status == Status::Solved
        && outcome.iterations <= MOST_ITERATIONS
        && std::iter::once(problem.optimum).chain(others).any(near)
}

fn all_by(exceptions: &[(u32, &str)], solve: impl Fn(&Problem) -> Outcome) {
    let problems = crate::hs::all();
    assert!(problems.len() >= 100, "{} problems", problems.len());
    let (mut wrong, mut iterations, mut largest) = (Vec::new(), 0, 0);
    for problem in &problems {
        let outcome = solve(problem);
        let exception = exceptions.iter().find(|(number, _)| *number == problem.number);
        let line = format!(
            "{:3} {:4} {:.10e} for {:.10e} {}",
            problem.number, outcome.iterations, outcome.objective, problem.optimum, outcome.status
        );
        println!("{line}");
        if is_right(problem, &outcome) == exception.is_some() {
            wrong.push(line);
        }
        if exception.is_none() {
            (iterations, largest) = (iterations + outcome.iterations, largest.max(outcome.iterations));
        }
    }
    println!("{} problems, {iterations} iterations, at most {largest}", problems.len() - exceptions.len());
    assert!(wrong.is_empty(), "not as stated:\n{}", wrong.join("\n"));
}

/// Options of a further attempt solve at least so many of the problems.
#[track_caller]
fn at_least(count: usize, options: &Options) {
    let is_solved = |problem: &&Problem| is_right(problem, &ipm::solve(&problem.program(), &problem.start, options));
    let problems = crate::hs::all();
    let unsolved: Vec<u32> =
        problems.iter().filter(|problem| !is_solved(problem)).map(|problem| problem.number).collect();
    assert!(problems.len() - unsolved.len() >= count, "{} of {}: {unsolved:?}", unsolved.len(), problems.len());
}

#[test]
fn restoring_by_squares() {
    at_least(100, &Options { restoration: Violations::Squared, ..Options::default() });
}

#[test]
fn with_shifts() {
    at_least(100, &Options { inertia_correction: InertiaCorrection::ByShift, ..Options::default() });
}

#[test]
fn augmented_lagrangian() {
    at_least(100, &Options { method: Method::AugmentedLagrangian, ..Options::default() });
}

#[test]
fn interior_point_method() {
    all_by(&EXCEPTIONS_OF_IPM, |problem| ipm::solve(&problem.program(), &problem.start, &Options::default()));
}

#[test]
fn sequential_quadratic_programming() {
    all_by(&EXCEPTIONS_OF_SQP, |problem| sqp::solve(&problem.program(), &problem.start, &Options::default()));
}
