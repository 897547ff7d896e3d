//! What is made finer in each phase, and the structure that comes of it.

use crate::transcribe::Transcription;
use crate::transcribe::points::SAME;
use ntg_structure::{At, Domain, Output, Phase, Points, Slot, Structure};

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

/// The times at which a spec itself lets inputs jump: ends of parts of a phase and the times of `at`, as far as an
/// output has no knot there. A phase with equally spaced points has none: it would have too few points in short intervals.
pub(super) fn given(nlp: &Transcription) -> Vec<Marks> {
    let structure = &nlp.model.structure;
    let mut times = vec![];
    for group in &structure.groups {
        if let Domain::Path { phase, part, .. } = &group.domain {
            times.extend([part.from, part.to].map(|instant| (phase.phase, instant.tau())));
        }
        times.extend(group.call.slots.iter().filter_map(|slot| match slot {
            Slot::Flat { phase, at: At::Inside(instant), .. } => Some((phase.phase, instant.tau())),
            _ => None,
        }));
    }
    let of_phase = |(number, phase): (usize, &Phase)| {
        let mut own = Marks::default();
        if phase.points.iter().any(|points| matches!(points, Points::Uniform { .. })) {
            return own;
        }
        let free = || phase.outputs.iter().filter(|output| !is_held(output, &phase.points));
        for (_, tau) in times.iter().filter(|(of, tau)| *of == number && *tau > 0.0 && *tau < 1.0) {
            let is_at = |other: &f64| (other - tau).abs() <= SAME;
            let has_all = free().all(|output| output.spline.breakpoints.iter().any(is_at));
            if !has_all && !own.at.iter().any(is_at) {
                own.at.push(*tau);
            }
        }
        own
    };
    structure.phases.iter().enumerate().map(of_phase).collect()
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
            breakpoints.dedup_by(|next, kept| (*next - *kept).abs() <= SAME);
        }
        for points in &mut phase.points {
            if let Points::Uniform { points } = points {
                // The old points remain: midpoints are added.
                *points = ((*points - 1) << marks.doublings) + 1;
            }
        }
    }
}
