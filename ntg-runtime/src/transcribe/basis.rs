//! Values of basis functions along points, computed and stored once for all outputs on the same knots and for all members
//! with the same points (docs/maths.md, equation 4.5).

use super::node::Site;
use ntg_splines::Knots;
use ntg_splines::basis::derivatives_along;
use std::ops::Range;
use std::sync::Arc;

/// Basis functions along the points of members.
pub(super) struct Basis {
    /// The derivatives that any slot needs, one for each table.
    pub(super) derivatives: Vec<usize>,
    pub(super) tables: Vec<Vec<f64>>,
    known: Vec<Along>,
}

/// The basis functions on some knots along the points of some elements.
pub(super) struct Along {
    knots: Arc<Knots>,
    elements: Range<usize>,
    pub(super) stretches: Vec<Stretch>,
}

/// Points of one interval.
pub(super) struct Stretch {
    pub(super) interval: usize,
    /// One past the last point.
    pub(super) end: usize,
    /// Where their basis functions begin in every table.
    pub(super) first: usize,
}

impl Basis {
    pub(super) fn new(derivatives: Vec<usize>) -> Self {
        Self { tables: vec![vec![]; derivatives.len()], derivatives, known: vec![] }
    }

    /// The basis functions of knots along elements, computed unless they are known.
    pub(super) fn along(&mut self, knots: &Arc<Knots>, sites: &[Site], elements: &Range<usize>) -> &Along {
        let points = &sites[elements.clone()];
        let is_same = |known: &Along| {
            let others = &sites[known.elements.clone()];
            let same = |(a, b): (&Site, &Site)| (a.point.tau, a.point.side) == (b.point.tau, b.point.side);
            Arc::ptr_eq(&known.knots, knots) && others.len() == points.len() && others.iter().zip(points).all(same)
        };
        let at = self.known.iter().rposition(is_same).unwrap_or_else(|| {
            let stretches = self.compute(knots, points);
            self.known.push(Along { knots: Arc::clone(knots), elements: elements.clone(), stretches });
            self.known.len() - 1
        });
        &self.known[at]
    }

    /// Adds the basis functions at points to all tables.
    fn compute(&mut self, knots: &Knots, points: &[Site]) -> Vec<Stretch> {
        let taus: Vec<f64> = points.iter().map(|site| site.point.tau).collect();
        let intervals: Vec<usize> = points.iter().map(|site| knots.interval(site.point.tau, site.point.side)).collect();
        let highest = self.derivatives.iter().copied().max().unwrap_or(0);
        let (mut stretches, mut begin, mut all) = (vec![], 0, vec![]);
        for same in intervals.chunk_by(|a, b| a == b) {
            let (interval, numbers) = (same[0], knots.order() * same.len());
            let (first, end) = (self.tables.first().map_or(0, Vec::len), begin + same.len());
            all.resize((highest + 1) * numbers, 0.0);
            derivatives_along(knots, interval, &taus[begin..end], highest, &mut all);
            for (table, &derivative) in self.tables.iter_mut().zip(&self.derivatives) {
                table.extend_from_slice(&all[derivative * numbers..][..numbers]);
            }
            begin = end;
            stretches.push(Stretch { interval, end, first });
        }
        stretches
    }
}
