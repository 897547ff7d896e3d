//! Knots where a spec lets inputs jump: at the ends of parts of a trajectory and at the times of `at`.
//!
//! States and inputs without a spline of their own have the intervals of `collocation`. Where a limit begins within an
//! interval, an input cannot jump to it there, and the limit costs as much as if it held over all of the interval. So these
//! times are knots of such splines too. So is a time at which a state has a price, or a limit: what it is worth jumps there, and an input
//! with it. Measurements are none: their times are as many as there are data. Splines, knots and points that are written out stay what they are, and so does an
//! input that is held.

use ntg_structure::{At, Instant};

use super::elaborator::Elaborator;
use super::problem::{Collocation, Domain, Leaf};
use crate::expr::NodeId;
use crate::syntax::ast::ItemKind;

/// Times that differ by less than this part of a phase are one.
const SAME: f64 = 1e-9;

impl Elaborator<'_> {
    /// Puts the knots in, once all constraints are known.
    pub(super) fn part_ends(&mut self) {
        let mut times: Vec<(usize, f64)> = vec![];
        let mut add = |phase: usize, instant: Instant| {
            let tau = instant.tau();
            if tau > SAME && tau < 1.0 - SAME && !times.iter().any(|(of, t)| *of == phase && (t - tau).abs() <= SAME) {
                times.push((phase, tau));
            }
        };
        for constraint in &self.problem.constraints {
            if let Domain::Path(phase, part) = &constraint.domain {
                [part.from, part.to].into_iter().for_each(|instant| add(phase.phase, instant));
            }
        }
        let terms = self.problem.objective.iter().map(|term| term.body);
        let bodies: Vec<NodeId> = terms.chain(self.problem.constraints.iter().map(|own| own.body)).collect();
        for input in self.problem.dag.inputs_of(&self.below(&bodies)) {
            let Leaf::Flat { phase, at, .. } = self.problem.leaves.leaf(input) else { continue };
            let instants = match at {
                At::Inside(instant) => std::slice::from_ref(instant),
                At::Among { places, .. } => &self.problem.places[*places].instants,
                _ => continue,
            };
            instants.iter().for_each(|instant| add(phase.phase, *instant));
        }
        for phase in 0..self.problem.phases.len() {
            let own = times.iter().filter(|(of, _)| *of == phase).map(|(_, tau)| *tau).collect::<Vec<_>>();
            let Collocation::Gauss { points, .. } = self.problem.phases[phase].collocation else { continue };
            if own.is_empty() || !self.has_intervals(phase) {
                continue;
            }
            let Some(common) = self.common_breakpoints(phase) else { continue };
            for output in &mut self.problem.phases[phase].outputs {
                let spline = &mut output.spline;
                let is_held = spline.order == 1 && points > 1;
                if is_held || spline.breakpoints != common {
                    continue;
                }
                for tau in &own {
                    if !spline.breakpoints.iter().any(|b| (b - tau).abs() <= SAME) {
                        spline.breakpoints.push(*tau);
                    }
                }
                spline.breakpoints.sort_by(f64::total_cmp);
            }
        }
    }

    /// Whether the intervals that a phase's splines have in common are told by their number.
    fn has_intervals(&self, phase: usize) -> bool {
        let mut next = Some(self.phases[phase].scope);
        while let Some(scope) = next {
            for item in self.items[scope] {
                let ItemKind::Collocation(collocation) = &item.kind else { continue };
                if collocation.intervals.is_some() || collocation.knots.is_some() {
                    return collocation.intervals.is_some() && collocation.knots.is_none();
                }
            }
            next = self.scopes[scope].parent;
        }
        false
    }
}
