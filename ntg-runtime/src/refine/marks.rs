//! What is made finer in each phase, and the structure that comes of it.

use crate::transcribe::Transcription;
use ntg_structure::{Output, Points, Structure};

/// New breakpoints and finer rules of one phase.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Marks {
    /// Where intervals are split, in scaled time.
    pub(super) at: Vec<f64>,
    /// How many times equally spaced points are doubled.
    pub(super) doublings: u32,
}

impl Marks {
    /// Whether nothing is to be made finer.
    pub(super) fn is_empty(&self) -> bool {
        self.at.is_empty() && self.doublings == 0
    }
}

/// What halves all intervals, for each declared phase; equally spaced points are doubled.
pub(super) fn halved(nlp: &Transcription) -> Vec<Marks> {
    let phases = &nlp.model.structure.phases;
    let mut marks = vec![Marks::default(); phases.len()];
    for member in &nlp.model.layout.phases {
        let is_uniform = phases[member.phase].points.iter().any(|points| matches!(points, Points::Uniform { .. }));
        let at = member.breakpoints.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        // Members of a family share their mesh.
        marks[member.phase] = Marks { at, doublings: u32::from(is_uniform) };
    }
    marks
}

/// Whether an output has one value in each of its intervals although there are several points in each: a sampled input, whose
/// rate is part of the problem and none of its discretisation.
fn is_held(output: &Output, points: &[Points]) -> bool {
    let has_several = |points: &Points| match points {
        Points::Gauss { points } => *points > 1,
        Points::Uniform { .. } => true,
        Points::Breakpoints | Points::LeftLimits | Points::Times { .. } => false,
    };
    output.spline.order == 1 && !output.is_helper() && points.iter().any(has_several)
}

/// More breakpoints, but for inputs that are held; `marks` holds one entry a declared phase.
pub(super) fn split(structure: &mut Structure, marks: &[Marks]) {
    for (phase, marks) in structure.phases.iter_mut().zip(marks) {
        for output in &mut phase.outputs {
            if is_held(output, &phase.points) {
                continue;
            }
            let is_helper = output.is_helper();
            let breakpoints = &mut output.spline.breakpoints;
            breakpoints.extend(&marks.at);
            // A helper has a value of its own at each of equally spaced points.
            for _ in 0..if is_helper { marks.doublings } else { 0 } {
                let between: Vec<f64> = breakpoints.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
                breakpoints.extend(between);
                breakpoints.sort_by(f64::total_cmp);
            }
            breakpoints.sort_by(f64::total_cmp);
            breakpoints.dedup();
        }
        for points in &mut phase.points {
            if let Points::Uniform { points } = points {
                // The old points remain: midpoints are added.
                *points = ((*points - 1) << marks.doublings) + 1;
            }
        }
    }
}
