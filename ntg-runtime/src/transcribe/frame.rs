//! What the inputs of calls are, once families are expanded and parameters have values.
//!
//! Takes slots and data of a [`Call`] with the indices of the loops around it; gives the concrete
//! thing a slot stands for ([`Source`]) and the number that a datum is. Finds: indices outside
//! families and arrays, parameters that are not finite.

use super::batch::batches;
use super::error::SetupError;
use super::instances::{index_at, members};
use super::layout::Layout;
use super::node::{Node, Site};
use super::points::Point;
use super::shape::trace;
use super::slots::Source;
use super::times::Clock;
use crate::problem::Problem;
use ntg_splines::{Side, Table};
use ntg_structure::{At, Call, Data, Instant, Loop, Place, Slot, Structure};

/// How far within an interval the end of it is for conditions of time, as a part of the interval: `t in 5 .. 6` holds on one side of
/// 6. A choice: far above rounding of times, far below what a report shows.
const WITHIN: f64 = 1e-9;

/// Everything that gives calls their meaning.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) problem: &'a dyn Problem,
    pub(crate) structure: &'a Structure,
    pub(crate) tables: &'a [Table],
    pub(crate) layout: &'a Layout,
    pub(crate) clock: &'a Clock,
}

impl Frame<'_> {
    /// The indices that a phase's own calls are evaluated with: the agent's, then the phase's.
    pub(crate) fn phase_indices(&self, phase: usize) -> Vec<i64> {
        let member = &self.layout.phases[phase];
        self.layout.agents[member.agent].index.into_iter().chain(member.index).collect()
    }

    /// The single result of a call without slots.
    pub(crate) fn number(&self, call: &Call, indices: &[i64]) -> Result<f64, SetupError> {
        Ok(self.numbers(call, indices, Point::NONE)?[0])
    }

    /// The results of a call without slots.
    pub(crate) fn numbers(&self, call: &Call, indices: &[i64], point: Point) -> Result<Vec<f64>, SetupError> {
        self.evaluate(call, indices, point, &[])
    }

    /// The results of any call at one point, for known variables.
    pub(crate) fn evaluate(
        &self,
        call: &Call,
        indices: &[i64],
        point: Point,
        x: &[f64],
    ) -> Result<Vec<f64>, SetupError> {
        let site = Site { indices: indices.to_vec(), point };
        let traced = trace(self, call, &site)?;
        let node = Node::build(self, call, &[site], &traced.sources)?;
        let slots: Vec<f64> =
            traced.sources.iter().map(|source| self.layout.affine(*source, &point).value(x)).collect();
        let mut work = node.work();
        node.values(self.problem, self.tables, &slots, &mut work);
        Ok(work.values)
    }

    /// The first result of any call at many sites, for known variables: one number for each, in their order, where
    /// all sites are of one phase and have the same indices.
    pub(crate) fn evaluate_all(&self, call: &Call, sites: Vec<Site>, x: &[f64]) -> Result<Vec<f64>, SetupError> {
        let mut values = vec![];
        for batch in batches(self, call, sites)? {
            let mut work = batch.work();
            batch.values(self.problem, self.tables, x, &mut work);
            let first = work.node.values.get(..batch.sites.len());
            values
                .extend_from_slice(first.ok_or_else(|| SetupError::malformed("a call without results is evaluated"))?);
        }
        Ok(values)
    }

    /// The first result of a call that belongs to no point, for known variables: the indices of each member of its
    /// loops, in their order, and the number.
    pub(crate) fn evaluate_members(
        &self,
        call: &Call,
        loops: &[Loop],
        x: &[f64],
    ) -> Result<Vec<(Vec<i64>, f64)>, SetupError> {
        let sites = members(loops).into_iter().map(|indices| Site { indices, point: Point::NONE }).collect();
        let mut found = vec![];
        for batch in batches(self, call, sites)? {
            let mut work = batch.work();
            batch.values(self.problem, self.tables, x, &mut work);
            let values = work.node.values[..batch.sites.len()].iter();
            found.extend(batch.sites.iter().zip(values).map(|(site, value)| (site.indices.clone(), *value)));
        }
        // Members of another shape stand behind the others.
        found.sort_by(|a, b| a.0.cmp(&b.0));
        Ok(found)
    }

    /// What a slot stands for.
    pub(crate) fn source(&self, slot: &Slot, site: &Site) -> Result<Source, SetupError> {
        let (structure, layout, indices) = (self.structure, self.layout, &site.indices);
        match slot {
            Slot::Flat { phase, at, output, index, derivative } => {
                let phase = layout.phase(structure, phase, indices)?;
                let output = layout.output(structure, phase, *output, index_at(index.as_ref(), indices))?;
                let at = match at {
                    At::Here if site.point.phase != Some(phase) => {
                        return Err(SetupError::malformed("an output is used at a point of another phase"));
                    }
                    At::Among { places, index } => {
                        let place = structure.places.get(*places).zip(indices.get(*index));
                        match place.and_then(|(places, index)| places.at(*index)) {
                            Some(Instant::START) => At::Start,
                            Some(Instant::END) => At::End,
                            Some(instant) => At::Inside(instant),
                            None => return Err(SetupError::malformed("a place for a value of an index is missing")),
                        }
                    }
                    at => *at,
                };
                Ok(Source::Flat { phase, at, output, derivative: *derivative })
            }
            Slot::Duration(phase) => Ok(Source::Duration(layout.phase(structure, phase, indices)?)),
            Slot::Start(phase) => Ok(Source::Start(layout.phase(structure, phase, indices)?)),
            Slot::Variable { variable, index } => {
                let index = index_at(index.as_ref(), indices);
                Ok(Source::Global(layout.variable(structure, *variable, index)?))
            }
            Slot::Integral { integral, index } => {
                let index: Vec<i64> = index.iter().map(|affine| affine.at(indices)).collect();
                Ok(Source::Global(layout.integral(structure, *integral, &index)?))
            }
        }
    }

    /// The number that a datum is.
    pub(crate) fn data(&self, data: &Data, site: &Site) -> Result<f64, SetupError> {
        let indices = &site.indices;
        match data {
            Data::Parameter { parameter, index } => {
                self.parameter(*parameter, index.as_ref().map(|index| index.at(indices)))
            }
            Data::Index(index) => Ok(index.at(indices) as f64),
            Data::Tau => Ok(site.point.tau),
            Data::TauWithin => Ok(self.tau_within(site)),
            Data::Duration(phase) => {
                let phase = self.layout.phase(self.structure, phase, indices)?;
                self.clock.durations[phase].ok_or_else(|| SetupError::malformed("a free duration is used as data"))
            }
            Data::Start(phase) => {
                let phase = self.layout.phase(self.structure, phase, indices)?;
                self.clock.starts[phase].ok_or_else(|| SetupError::malformed("a free start is used as data"))
            }
        }
    }

    /// The scaled time of a site; at the end of an interval [`WITHIN`] of the interval from which the site is looked at within it.
    pub(crate) fn tau_within(&self, site: &Site) -> f64 {
        let Point { phase, tau, side, .. } = site.point;
        let Some(breakpoints) = phase.map(|phase| &self.layout.phases[phase].breakpoints) else { return tau };
        let Ok(at) = breakpoints.binary_search_by(|breakpoint| breakpoint.total_cmp(&tau)) else { return tau };
        let neighbour = if side == Side::Left { at.checked_sub(1) } else { Some(at + 1) };
        let beyond = neighbour.and_then(|neighbour| breakpoints.get(neighbour));
        beyond.map_or(tau, |beyond| tau + WITHIN * (beyond - tau))
    }

    fn parameter(&self, parameter: usize, index: Option<i64>) -> Result<f64, SetupError> {
        let Some(declared) = self.structure.parameters.get(parameter) else {
            return Err(SetupError::malformed(format!("there is no parameter number {parameter}")));
        };
        let index = index.unwrap_or(1);
        let position = usize::try_from(index - 1).ok();
        let value = position.and_then(|position| declared.value.get(position)).copied();
        value.ok_or_else(|| SetupError::IndexOutOfRange {
            what: format!("parameter `{}`", declared.name),
            index,
            first: 1,
            last: i64::try_from(declared.value.len()).unwrap_or(i64::MAX),
            place: Place::default(),
        })
    }
}
