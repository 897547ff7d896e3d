//! Generated code on other knots, and a continuation as one problem for each of its steps.

use ntg_runtime::problem::WithStructure;
use ntg_runtime::structure::Points;

/// The same with this many equal intervals a spline, and as many points an interval as before.
pub fn with_intervals<'p>(problem: &WithStructure<'p>, intervals: usize) -> WithStructure<'p> {
    problem.edited(|structure| {
        for phase in &mut structure.phases {
            let before = phase.outputs.first().map_or(1, |output| output.spline.breakpoints.len() - 1);
            for points in &mut phase.points {
                if let Points::Uniform { points } = points {
                    *points = (*points - 1) / before * intervals + 1;
                }
            }
            for output in &mut phase.outputs {
                output.spline.breakpoints = (0..=intervals).map(|i| i as f64 / intervals as f64).collect();
            }
        }
    })
}

/// A minimised objective in SI units as the user sees it.
pub fn in_its_unit(problem: &WithStructure<'_>, minimised: f64) -> f64 {
    let value = minimised / problem.structure.objective_unit.factor;
    if problem.structure.maximize { -value } else { value }
}

/// One problem for each step of the continuation, in order; the last one has the parameters of
/// the program.
pub fn steps<'p>(problem: &WithStructure<'p>) -> Vec<WithStructure<'p>> {
    let count = problem.structure.continuations.iter().map(|c| c.steps.len()).max().unwrap_or(1);
    let step = |i: usize| {
        problem.edited(|structure| {
            for continuation in std::mem::take(&mut structure.continuations) {
                if i + 1 < count {
                    let value = continuation.steps[i.min(continuation.steps.len() - 1)];
                    structure.parameters[continuation.parameter].value.fill(value);
                }
            }
        })
    };
    (0..count).map(step).collect()
}
