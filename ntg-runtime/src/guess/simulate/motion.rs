//! The equations of motion of one phase: the equalities that hold all along it.

use super::call::AtPlaces;
use super::elimination::Rows;
use super::radau::{Instant, Linear, Motion};
use crate::transcribe::batch::batches;
use crate::transcribe::deadline::Deadline;
use crate::transcribe::elements::domain_sites;
use crate::transcribe::frame::Frame;
use crate::transcribe::node::Site;
use crate::transcribe::points::Point;
use crate::transcribe::rows::group_bounds;
use crate::transcribe::shape::trace;
use crate::transcribe::slots::Source;
use crate::transcribe::{Model, Transcription};
use nalgebra::DVector;
use ntg_structure::{At, Domain, Group, Points, Row};
use std::collections::BTreeMap;

/// One member of a group with equalities.
pub(super) struct Member<'a> {
    pub(super) group: &'a Group,
    pub(super) site: Site,
    /// What its slots stand for.
    pub(super) sources: Vec<Source>,
    /// Its equalities: their rows, and what these are equal to.
    pub(super) rows: Vec<(usize, f64)>,
    /// Row and slot of every first derivative.
    pub(super) pattern: Vec<(usize, usize)>,
}

impl<'a> Member<'a> {
    /// The member of a group at a site; none where that has no equality.
    pub(super) fn new(frame: &Frame<'a>, group: &'a Group, site: Site) -> Option<Self> {
        let posed = |constraint: usize| frame.structure.is_posed(constraint);
        let equal = |row: &Row| matches!(row, Row::Constraint { constraint, lower: Some(l), upper: Some(u) } if l == u && posed(*constraint));
        if !group.rows.iter().any(equal) {
            return None;
        }
        let bounds = group_bounds(frame, group, &site.indices).ok()?;
        let rows =
            (0..group.rows.len()).filter(|row| equal(&group.rows[*row])).map(|row| (row, bounds[row].0)).collect();
        let sources = trace(frame, &group.call, &site).ok()?.sources;
        let [pattern, _] =
            batches(frame, &group.call, vec![site.clone()]).ok()?.first()?.patterns(&frame.structure.kernels);
        Some(Self { group, site, sources, rows, pattern })
    }

    /// What a row depends on.
    pub(super) fn sources_of(&self, row: usize) -> impl Iterator<Item = Source> {
        self.pattern.iter().filter(move |(r, _)| *r == row).map(|(_, slot)| self.sources[*slot])
    }
}

/// Whether a member of a phase is a helper of the compiler's.
fn is_helper(model: &Model, (phase, output): (usize, usize)) -> bool {
    let phase = &model.layout.phases[phase];
    model.structure.phases[phase.phase].outputs[phase.outputs[output].output].is_helper()
}

/// The equations of one phase for given times, variables and inputs.
pub(super) struct Equations<'a> {
    frame: Frame<'a>,
    x: &'a [f64],
    pub(super) phase: usize,
    members: Vec<Member<'a>>,
    /// The outputs that move, as members of the phase.
    pub(super) outputs: Vec<usize>,
    pub(super) orders: Vec<usize>,
    sizes: Vec<f64>,
    /// Where the value of a derivative of a member of the phase stands among all values.
    pub(super) columns: BTreeMap<(usize, usize), usize>,
    calls: Vec<AtPlaces>,
    until: Deadline,
}

/// What holds all along each phase: groups, and where each is, in their order.
pub(super) struct Along<'a>(Vec<Vec<(&'a Group, Site)>>);

impl<'a> Along<'a> {
    /// Of all phases at once; none where an index is outside its family.
    pub(super) fn of(nlp: &'a Transcription) -> Option<Self> {
        let frame = nlp.frame();
        let mut all = vec![vec![]; nlp.model.layout.phases.len()];
        for group in &frame.structure.groups {
            let Domain::Path { phase: of, points, part } = &group.domain else { continue };
            // What holds at the ends of intervals alone is taken back there and moves nothing.
            let is_at_ends = frame.structure.phases[of.phase].points.get(*points) == Some(&Points::Breakpoints);
            if !part.is_whole() || is_at_ends {
                continue;
            }
            let middle = |_: &_, _: &[f64], of: usize| vec![Point { tau: 0.5, ..Point::start(of) }];
            for site in domain_sites(&frame, &group.loops, &group.domain, middle).ok()? {
                all[site.point.phase?].push((group, site));
            }
        }
        Some(Self(all))
    }
}

impl<'a> Equations<'a> {
    /// The equations of a phase; none where they do not decide how its outputs move.
    pub(super) fn new(nlp: &'a Transcription, along: &Along<'a>, phase: usize, x: &'a [f64]) -> Option<Self> {
        let frame = nlp.frame();
        let own = along.0[phase].iter();
        let members: Vec<Member> = own.filter_map(|(group, site)| Member::new(&frame, group, site.clone())).collect();
        let mut orders = BTreeMap::new();
        for member in &members {
            for source in member.rows.iter().flat_map(|(row, _)| member.sources_of(*row)) {
                if let Source::Flat { phase: of, at: At::Here, output, derivative } = source {
                    debug_assert_eq!(of, phase, "a point is of one phase");
                    // What the mesh lets drift is no motion.
                    if is_helper(&nlp.model, (phase, output)) {
                        continue;
                    }
                    let order = orders.entry(output).or_insert(0);
                    *order = derivative.max(*order);
                }
            }
        }
        // What has no derivative is an input, unless the equations decide that too.
        let equations: usize = members.iter().map(|member| member.rows.len()).sum();
        if equations != orders.len() {
            orders.retain(|_, order| *order > 0);
        }
        if equations != orders.len() || orders.is_empty() {
            return None;
        }
        let mut columns = BTreeMap::new();
        for (output, order) in &orders {
            for derivative in 0..=*order {
                columns.insert((*output, derivative), columns.len());
            }
        }
        let size = |output: &usize| {
            let coefficients = &nlp.model.layout.phases[phase].outputs[*output].coefficients;
            coefficients.iter().map(|variable| nlp.limits.scale[*variable as usize]).fold(0.0, f64::max)
        };
        let sizes = orders.keys().map(size).collect();
        let (outputs, orders) = orders.into_iter().unzip();
        Some(Self { frame, x, phase, members, outputs, orders, sizes, columns, calls: vec![], until: nlp.until })
    }

    /// Whether the equations decide the highest derivatives for these values at the start: where they do not, as equations
    /// of a constrained motion, they cannot be simulated.
    pub(super) fn decide(&mut self, values: &[f64]) -> bool {
        /// A pivot below this part of the largest is 0. A choice, far from rounding and from rates in SI.
        const SINGULAR: f64 = 1e-12;
        let count = self.outputs.len();
        let start = Point::start(self.phase);
        let mut out = [Linear { residual: DVector::zeros(count), jacobian: Rows::new(count) }];
        let placed = self.place(&[Instant { tau: start.tau, side: start.side }]);
        if placed.and_then(|()| self.evaluate(&[values.to_vec()], &mut out)).is_none() {
            return false;
        }
        let highest = self.outputs.iter().zip(&self.orders).map(|(output, order)| self.columns[&(*output, *order)]);
        let columns: Vec<usize> = highest.collect();
        out[0].of(&columns).has_full_rank(SINGULAR)
    }

    /// What the guess says about all values at the start.
    pub(super) fn guessed(&self, nlp: &Transcription) -> Vec<f64> {
        let at = (0.0, Point::start(self.phase).side);
        let value =
            |(output, derivative): &(usize, usize)| nlp.model.layout.flat(self.phase, *output, *derivative, at, self.x);
        self.columns.keys().map(value).collect()
    }
}

impl Motion for Equations<'_> {
    fn orders(&self) -> &[usize] {
        &self.orders
    }

    fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    fn is_late(&self) -> bool {
        self.until.is_over()
    }

    fn place(&mut self, at: &[Instant]) -> Option<()> {
        self.calls.clear();
        for member in &self.members {
            let point = |at: &Instant| Point { tau: at.tau, side: at.side, ..member.site.point };
            let site = |at: &Instant| Site { indices: member.site.indices.clone(), point: point(at) };
            let sites = at.iter().map(site).collect();
            self.calls.push(AtPlaces::new(&self.frame, &member.group.call, sites, self.x)?);
        }
        Some(())
    }

    fn evaluate(&mut self, values: &[Vec<f64>], out: &mut [Linear]) -> Option<()> {
        let mut equation = 0;
        out.iter_mut().for_each(|linear| linear.jacobian.clear());
        for (member, call) in self.members.iter().zip(&mut self.calls) {
            let places = call.places();
            let column = |source: &Source| match source {
                Source::Flat { at: At::Here, output, derivative, .. } => self.columns.get(&(*output, *derivative)),
                _ => None,
            };
            for (slot, source) in member.sources.iter().enumerate() {
                let Some(column) = column(source) else { continue };
                for (place, values) in values.iter().enumerate() {
                    call.slots[slot * places + place] = values[*column];
                }
            }
            call.evaluate(&self.frame);
            for (row, wanted) in &member.rows {
                for (place, linear) in out.iter_mut().enumerate() {
                    let residual = call.out.values[row * places + place] - wanted;
                    if !residual.is_finite() {
                        return None;
                    }
                    linear.residual[equation] = residual;
                }
                for (entry, (_, slot)) in call.pattern.iter().enumerate().filter(|(_, (r, _))| r == row) {
                    let Some(column) = column(&member.sources[*slot]) else { continue };
                    for (place, linear) in out.iter_mut().enumerate() {
                        linear.jacobian.add(equation, *column, call.out.jacobian[entry * places + place]);
                    }
                }
                equation += 1;
            }
        }
        out.iter().all(|linear| linear.jacobian.is_finite()).then_some(())
    }
}
