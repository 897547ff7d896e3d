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

/// The same with every spline's intervals times `factor`, at least one: breakpoints lie as dense as before, wherever that is.
/// Equally spaced points keep their number for each interval; Gauss points are given for each interval anyway.
pub fn with_mesh<'p>(problem: &WithStructure<'p>, factor: f64) -> WithStructure<'p> {
    problem.edited(|structure| {
        for phase in &mut structure.phases {
            for points in &mut phase.points {
                if let Points::Uniform { points } = points {
                    *points = scaled(*points - 1, factor) + 1;
                }
            }
            for output in &mut phase.outputs {
                output.spline.breakpoints = resampled(&output.spline.breakpoints, factor);
            }
        }
    })
}

fn scaled(count: usize, factor: f64) -> usize {
    ((count as f64 * factor).round() as usize).max(1)
}

/// Breakpoints along the line through the given ones.
fn resampled(breakpoints: &[f64], factor: f64) -> Vec<f64> {
    let before = breakpoints.len() - 1;
    let after = scaled(before, factor);
    let at = |i: usize| {
        let place = i as f64 * before as f64 / after as f64;
        let cell = (place.floor() as usize).min(before - 1);
        let share = place - cell as f64;
        breakpoints[cell] + share * (breakpoints[cell + 1] - breakpoints[cell])
    };
    (0..=after).map(|i| if i == after { breakpoints[before] } else { at(i) }).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_is_halved_and_doubled_where_it_is_dense() {
        let own = [0.0, 0.1, 0.2, 0.6, 1.0];
        assert_eq!(resampled(&own, 1.0), own);
        assert_eq!(resampled(&own, 0.5), [0.0, 0.2, 1.0]);
        let twice = resampled(&own, 2.0);
        assert_eq!(twice.len(), 9);
        assert!(twice.iter().step_by(2).zip(own).all(|(a, b)| (a - b).abs() < 1e-15) && (twice[7] - 0.8).abs() < 1e-15);
        assert_eq!(resampled(&[0.0, 1.0], 0.5), [0.0, 1.0]);
    }
}
