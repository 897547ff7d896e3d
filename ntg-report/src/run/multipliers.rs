//! What the multipliers of a saved run tell, and what they do not.

use super::{Constraint, Multiplier, Run};

impl Constraint {
    /// The multiplier that is furthest from 0: of what stands along a trajectory the mean over an interval, as charts show
    /// it. What stands at an interval's end is no density, and not to be held against those that are.
    pub fn largest_multiplier(&self) -> Option<Multiplier> {
        let means = self.members.iter().flat_map(|member| member.mean_t.chunks(2).zip(member.mean.chunks(2)));
        let means = means.filter_map(|(ends, mean)| Some((0.5 * (ends.first()? + ends.last()?), *mean.first()?)));
        let largest = means.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let mean = |(t, value)| Multiplier { value, density: true, t: Some(t) };
        largest.map(mean).or_else(|| self.multiplier.clone())
    }

    /// What its values and bounds are measured by; 0 where nothing tells.
    fn size(&self) -> f64 {
        let worst = [&self.points, &self.between].into_iter().flatten().map(|worst| worst.violation / worst.relative);
        let bounds = self.members.iter().flat_map(|member| [member.lower, member.upper]).flatten().map(f64::abs);
        worst.chain(bounds).filter(|size| size.is_finite()).fold(0.0, f64::max)
    }
}

impl Run {
    /// Whether the multipliers of a constraint tell what a shifted bound would cost: not where a shift by a thousandth of
    /// its size would change the objective by more than all of it. Then constraints hold one and the same thing, and only
    /// sums of their multipliers are determined.
    pub fn is_priced(&self, constraint: &Constraint) -> bool {
        const SHIFT: f64 = 1e-3;
        let terms: f64 = self.terms.iter().map(|term| term.value.abs()).sum();
        let cost = terms.max(self.objective.abs());
        let change = SHIFT * constraint.size() * constraint.sensitivity.abs();
        // NaN, of what was not saved, is no answer.
        change.is_nan() || cost.is_nan() || change <= cost
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{Member, Worst};

    #[test]
    fn the_largest_multiplier_along_the_way_is_the_largest_mean_and_no_weight_of_a_point() {
        let at_an_end = Some(Multiplier { value: -92.85, density: false, t: Some(4.0) });
        let member =
            Member { mean_t: vec![0.0, 2.0, 2.0, 4.0], mean: vec![3.0, 3.0, -12.0, -12.0], ..Member::default() };
        let along = Constraint { multiplier: at_an_end.clone(), members: vec![member], ..Constraint::default() };
        let found = along.largest_multiplier().expect("a multiplier");
        assert_eq!((found.value, found.density, found.t), (-12.0, true, Some(3.0)));
        let there = Constraint { multiplier: at_an_end, ..Constraint::default() };
        assert_eq!(there.largest_multiplier().map(|found| found.value), Some(-92.85));
    }

    #[test]
    fn a_multiplier_beyond_all_of_the_objective_prices_nothing() {
        let constraint = |sensitivity: f64, relative: f64| {
            let points = Some(Worst { violation: 2e-9, relative, ..Worst::default() });
            Constraint { sensitivity, points, ..Constraint::default() }
        };
        let run = Run { objective: 10.0, ..Run::default() };
        // Its size is 2, a thousandth of it 0.002.
        assert!(run.is_priced(&constraint(4.9e3, 1e-9)) && !run.is_priced(&constraint(-5.1e3, 1e-9)));
        assert!(run.is_priced(&constraint(f64::NAN, 1e-9)));
        assert!(run.is_priced(&Constraint { sensitivity: 1e9, ..Constraint::default() }), "of no size");
    }
}
