//! What flight costs per second, by the spec's own functions, at many places at once.
//!
//! Takes a phase, a scaled time and poses of one vehicle; evaluates every integrand and every
//! trajectory constraint of that phase with the vehicle in these poses and everything else as it
//! is guessed. Constraints count by their violations (docs/maths.md, equation 12.4).

use super::poses::{Pose, Poses, Uses};
use crate::multistart::vehicles::Vehicle;
use crate::transcribe::instances::members;
use crate::transcribe::node::{Node, Site};
use crate::transcribe::points::Point;
use crate::transcribe::rows::{bound_size, group_bounds};
use crate::transcribe::shape::trace;
use crate::transcribe::slots::Source;
use crate::transcribe::{SetupError, Transcription};
use ntg_splines::Side;
use ntg_structure::{At, Block, Call, Data, Domain, Group, Row};
use rayon::prelude::*;

/// Which functions are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Where {
    /// Those along a phase, at a scaled time.
    Along(f64),
    /// Those at its start.
    Start,
    /// Those at its end.
    End,
}

/// What one pose costs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rate {
    /// The objective per second along a phase, or the objective itself at its ends.
    pub(super) cost: f64,
    /// The sum of relative violations, each at most [`MOST`].
    pub(super) violation: f64,
}

/// How a row counts.
#[derive(Clone, Copy, Debug)]
enum Price {
    /// As a cost, by this factor.
    Cost(f64),
    /// As a violation of bounds; with the unit's factor.
    Bounds((f64, f64), f64),
}

/// One violation counts at most this much.
const MOST: f64 = 10.0;
/// Poses that are evaluated at once.
const CHUNK: usize = 4096;

/// A problem seen from one vehicle in one phase.
pub(super) struct Rates<'a> {
    pub(super) nlp: &'a Transcription<'a>,
    pub(super) vehicle: &'a Vehicle,
    pub(super) phase: usize,
    /// The guess.
    pub(super) x: &'a [f64],
    /// The derivative of the objective by every integral that is a variable.
    pub(super) integrals: &'a [f64],
}

impl Rates<'_> {
    /// The costs of poses. Every function is evaluated once for all poses that it cannot tell apart.
    pub(super) fn at(&self, place: Where, poses: &Poses) -> Result<Vec<Rate>, SetupError> {
        let mut rates = vec![Rate::default(); poses.len()];
        // A constraint stands in several groups, one for each kind of point; once is enough.
        let mut seen: Vec<(usize, Vec<i64>)> = vec![];
        for group in &self.nlp.model.structure.groups {
            for indices in members(&group.loops) {
                if !self.concerns(group, place, &indices)? {
                    continue;
                }
                let prices = self.prices(group, &indices, &mut seen)?;
                if prices.is_empty() {
                    continue;
                }
                let site = Site { indices, point: self.point(place) };
                let sources = trace(&self.nlp.frame(), &group.call, &site)?.sources;
                let classes = poses.classes(self.uses(&sources, place));
                let found: Result<Vec<Vec<Rate>>, SetupError> = classes
                    .first
                    .par_chunks(CHUNK)
                    .map(|chunk| self.chunk((group, &prices), (&site, &sources, place), &poses.of(chunk)))
                    .collect();
                let found: Vec<Rate> = found?.into_iter().flatten().collect();
                for (rate, class) in rates.iter_mut().zip(&classes.of) {
                    let part = found[*class as usize];
                    (rate.cost, rate.violation) = (rate.cost + part.cost, rate.violation + part.violation);
                }
            }
        }
        Ok(rates)
    }

    fn point(&self, place: Where) -> Point {
        match place {
            Where::Along(tau) => Point { phase: Some(self.phase), tau, side: Side::Right, weight: f64::NAN },
            Where::Start => Point::start(self.phase),
            Where::End => Point::end(self.phase),
        }
    }

    /// Which parts of a pose slots stand for.
    fn uses(&self, sources: &[Source], place: Where) -> Uses {
        let mut uses = Uses::default();
        for (_, derivative) in sources.iter().filter_map(|source| self.own(*source, place)) {
            uses.add(derivative);
        }
        uses
    }

    /// Whether anything along the phase depends on time, or on outputs that move with it.
    pub(super) fn depend_on_time(&self) -> Result<bool, SetupError> {
        let point = self.point(Where::Along(0.5));
        for group in &self.nlp.model.structure.groups {
            if matches!(&group.domain, Domain::Path { part, .. } if !part.is_whole()) {
                return Ok(true);
            }
            for indices in members(&group.loops) {
                if !self.concerns(group, Where::Along(0.5), &indices)? {
                    continue;
                }
                let sources = trace(&self.nlp.frame(), &group.call, &Site { indices, point })?.sources;
                let moves = |source: &Source| {
                    matches!(source, Source::Flat { at: At::Here, .. })
                        && self.own(*source, Where::Along(0.5)).is_none()
                };
                if uses_tau(&group.call) || sources.iter().any(moves) {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Whether a group is evaluated there in this phase.
    fn concerns(&self, group: &Group, place: Where, indices: &[i64]) -> Result<bool, SetupError> {
        let reference = match (&group.domain, place) {
            (Domain::Path { phase, part, .. }, Where::Along(tau))
                if (part.from.tau()..=part.to.tau()).contains(&tau) =>
            {
                phase
            }
            (Domain::Start(phase), Where::Start) | (Domain::End(phase), Where::End) => phase,
            _ => return Ok(false),
        };
        let structure = &self.nlp.model.structure;
        let joins = |row: &Row| {
            matches!(row, Row::Constraint { constraint, .. }
                if structure.constraints[*constraint].block == Block::Continuity)
        };
        Ok(!group.rows.iter().any(joins) && self.nlp.model.layout.phase(structure, reference, indices)? == self.phase)
    }

    /// What one member of a group costs in some poses.
    fn chunk(
        &self,
        (group, prices): (&Group, &[(usize, Price)]),
        (site, sources, place): (&Site, &[Source], Where),
        poses: &[Pose],
    ) -> Result<Vec<Rate>, SetupError> {
        let (frame, layout) = (self.nlp.frame(), &self.nlp.model.layout);
        let node = Node::build(&frame, &group.call, &vec![site.clone(); poses.len()], sources)?;
        let duration = layout.duration(self.phase, self.x);
        let mut u = Vec::with_capacity(sources.len() * poses.len());
        for source in sources {
            match self.own(*source, place) {
                Some((axis, derivative)) => {
                    let factor = duration.powi(i32::try_from(derivative).unwrap_or(i32::MAX));
                    u.extend(poses.iter().map(|pose| pose.at(axis, derivative) * factor));
                }
                None => u.resize(u.len() + poses.len(), layout.affine(*source, &site.point).value(self.x)),
            }
        }
        let mut work = node.work();
        node.values(self.nlp.problem, &self.nlp.model.tables, &u, &mut work);
        let mut rates = vec![Rate::default(); poses.len()];
        for (row, price) in prices {
            let values = &work.values[row * poses.len()..(row + 1) * poses.len()];
            for (rate, value) in rates.iter_mut().zip(values) {
                match price {
                    Price::Cost(factor) => rate.cost += factor * value,
                    Price::Bounds(bounds, unit) => rate.violation += violation(*value, *bounds, *unit),
                }
            }
        }
        Ok(rates)
    }

    /// The axis and derivative of the vehicle that a slot stands for, if it does.
    fn own(&self, source: Source, place: Where) -> Option<(usize, usize)> {
        let Source::Flat { phase, at, output, derivative } = source else { return None };
        let here = match at {
            At::Here => true,
            At::Start => place == Where::Start,
            At::End => place == Where::End,
            At::Inside(_) | At::Among { .. } => false,
        };
        let first = self.nlp.model.layout.agents[self.vehicle.agent].phases.start;
        let axis = self.vehicle.members[self.phase - first].iter().position(|member| *member == output)?;
        (here && phase == self.phase && axis < 2).then_some((axis, derivative))
    }

    /// The rows of one member of a group that count, each with how. Constraints count once.
    fn prices(
        &self,
        group: &Group,
        indices: &[i64],
        seen: &mut Vec<(usize, Vec<i64>)>,
    ) -> Result<Vec<(usize, Price)>, SetupError> {
        let (structure, layout) = (&self.nlp.model.structure, &self.nlp.model.layout);
        // Integrands hold the factor T.
        let path = matches!(group.domain, Domain::Path { .. });
        let duration = if path { layout.duration(self.phase, self.x) } else { 1.0 };
        let bounds = group_bounds(&self.nlp.frame(), group, indices)?;
        let mut prices = vec![];
        for ((number, row), bounds) in group.rows.iter().enumerate().zip(bounds) {
            prices.push(match row {
                Row::Cost { .. } => (number, Price::Cost(1.0 / duration)),
                Row::Integral { integral, index } => {
                    let index: Vec<i64> = index.iter().map(|affine| affine.at(indices)).collect();
                    let variable = layout.integral(structure, *integral, &index)?;
                    let slope = self.integrals.get(variable as usize).copied().unwrap_or(0.0);
                    (number, Price::Cost(slope / duration))
                }
                Row::Part { .. } => continue,
                Row::Constraint { constraint, .. } => {
                    let member = (*constraint, indices.to_vec());
                    if seen.contains(&member) {
                        continue;
                    }
                    seen.push(member);
                    (number, Price::Bounds(bounds, structure.constraints[*constraint].unit.factor))
                }
            });
        }
        Ok(prices)
    }
}

fn uses_tau(call: &Call) -> bool {
    call.data.iter().any(|data| matches!(data, Data::Tau | Data::TauWithin))
        || call.reductions.iter().any(|reduction| uses_tau(&reduction.body))
}

/// The relative violation (9.3), at most [`MOST`]; also where there is no value.
fn violation(value: f64, (lower, upper): (f64, f64), unit: f64) -> f64 {
    let size = match bound_size((lower, upper)) {
        size if size > 0.0 => size,
        _ => unit,
    };
    let missed = (lower - value).max(value - upper).max(0.0) / size;
    if value.is_nan() { MOST } else { missed.min(MOST) }
}
