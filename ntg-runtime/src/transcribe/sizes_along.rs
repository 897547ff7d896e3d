//! Sizes along a motion that runs through many decades (docs/maths.md, section 11.12): what equations miss at one end of it, within
//! the tolerance by the size at the other end, may decide the objective.

use super::Transcription;
use super::layout::OutputMember;

/// An output that is somewhere so small a part of its largest value runs through many decades. A law: a tolerance of 1e-8 by the
/// largest value is a hundredth of the output there.
const MANY_DECADES: f64 = 1e-6;
/// An output that stays below this part of its size is 0 by the tolerance, whatever it is. A law: the default tolerance.
const UNSEEN: f64 = 1e-8;
/// An output that is unseen and below this part of its unit is rounding of 0, as in section 11.12.
const NOTHING: f64 = 1e-8;

impl Transcription<'_> {
    /// The sizes of the variables along a motion: of an output that runs through many decades, what the output is nearby; of
    /// one that its size hides, what it is at most; of all else the size that it has. None where all is so. What has a size by
    /// name keeps it.
    pub(crate) fn sizes_along(&self, x: &[f64]) -> Option<Vec<f64>> {
        let (mut sizes, units) = (self.limits.scale.clone(), self.units());
        let is_named = |v: &u32| self.has_named_size.get(*v as usize).is_some_and(|named| *named);
        let is_shifted = |v: &u32| self.origin.get(*v as usize).is_some_and(|origin| *origin != 0.0);
        let outputs = self.model.layout.phases.iter().flat_map(|phase| &phase.outputs);
        for output in outputs.filter(|output| !output.coefficients.iter().any(|v| is_named(v) || is_shifted(v))) {
            let nearby = nearby(output, x);
            let most = nearby.iter().copied().fold(0.0, f64::max);
            let has_many_decades = nearby.iter().any(|near| *near < MANY_DECADES * most);
            for (v, near) in output.coefficients.iter().map(|v| *v as usize).zip(nearby) {
                let is_unseen = most < UNSEEN * sizes[v];
                if is_unseen && most < NOTHING * units[v] {
                    continue;
                }
                if has_many_decades {
                    sizes[v] = near;
                } else if is_unseen {
                    sizes[v] = most;
                }
            }
        }
        (sizes != self.limits.scale).then_some(sizes)
    }
}

/// The largest coefficient of an output, by absolute value, among those that share an interval with each; no less than what is
/// rounding of rounding beside the largest of all.
fn nearby(output: &OutputMember, x: &[f64]) -> Vec<f64> {
    let values: Vec<f64> = output.coefficients.iter().map(|v| x[*v as usize].abs()).collect();
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let (least, reach) = (f64::EPSILON.powi(2) * largest(&values), output.knots.order() - 1);
    let near = |j: usize| &values[j.saturating_sub(reach)..(j + reach + 1).min(values.len())];
    (0..values.len()).map(|j| largest(near(j)).max(least)).collect()
}
