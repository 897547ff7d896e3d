//! Groups as blocks of elements, and their rows as rows of the program (docs/maths.md, section 4.4).
//!
//! Takes a [`Structure`](ntg_structure::Structure) with its layout; gives blocks, the batches that
//! evaluate them, and rows with bounds. Afterwards: every row has a maker, every element row a
//! target; the last block, if integrals are variables, holds their identities.

use super::batch::{Batch, batches};
use super::deadline::Deadline;
use super::error::SetupError;
use super::frame::Frame;
use super::instances::members;
use super::layout::{Layout, narrow, outside};
use super::node::Site;
use super::points::{Point, point_set, within};
use super::range_maps::{identities, range_maps};
use super::relations::Relations;
use super::repeated::without_repetitions;
use super::rows::{RowInfo, RowKind, group_bounds};
use ntg_nlp::{Block, Definition, Limits, Target};
use ntg_structure::{Affine, Degree, Domain, Group, PhaseRef, Points, Row};
use std::collections::BTreeMap;

/// A batch with the group that it belongs to.
#[derive(Clone, Debug)]
pub(crate) struct GroupBatch {
    pub(crate) group: usize,
    pub(crate) batch: Batch,
    /// How each row depends on the slots.
    pub(crate) degree: Vec<Degree>,
}

/// Everything that depends on groups.
#[derive(Clone, Debug, Default)]
pub(crate) struct Elements {
    pub(crate) blocks: Vec<Block>,
    /// One for each block but the block of identities.
    pub(crate) batches: Vec<GroupBatch>,
    pub(crate) rows: Vec<RowInfo>,
    pub(crate) relations: Relations,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    /// Rows on [`Domain::Mission`] by constraint and indices, for parts.
    makers: BTreeMap<(usize, Vec<i64>), u32>,
    /// The row that defines each integral member, counted over all integrals.
    integral_rows: Vec<u32>,
}

/// Builds all elements, where that does not take longer.
pub(crate) fn elements(frame: &Frame, until: Deadline) -> Result<Elements, SetupError> {
    let mut all = Elements::default();
    for (index, group) in frame.structure.groups.iter().enumerate() {
        let kernel = frame.structure.kernels.get(group.call.kernel);
        if kernel.is_some_and(|kernel| kernel.rows != group.rows.len()) {
            return Err(SetupError::malformed("a group has not one meaning for each row of its kernel"));
        }
        let sites = without_repetitions(frame, group, sites(frame, group, point_set)?)?;
        until.check()?;
        for batch in batches(frame, &group.call, sites)? {
            all.add(frame, index, group, batch)?;
            until.check()?;
        }
    }
    all.add_identities(frame);
    all.add_parts(frame)?;
    all.relations = Relations::new(&all.rows);
    Ok(all)
}

/// The sites of a group, with the points of its phase made by `make`.
pub(crate) fn sites(
    frame: &Frame,
    group: &Group,
    make: impl Fn(&Points, &[f64], usize) -> Vec<Point>,
) -> Result<Vec<Site>, SetupError> {
    domain_sites(frame, &group.loops, &group.domain, make)
}

/// The sites of any loops and domain.
pub(crate) fn domain_sites(
    frame: &Frame,
    loops: &[ntg_structure::Loop],
    domain: &Domain,
    make: impl Fn(&Points, &[f64], usize) -> Vec<Point>,
) -> Result<Vec<Site>, SetupError> {
    let mut sites = vec![];
    for indices in members(loops) {
        let phase = |reference: &PhaseRef| frame.layout.phase(frame.structure, reference, &indices);
        let points = match domain {
            Domain::Mission => vec![Point::NONE],
            Domain::Start(reference) => vec![Point::start(phase(reference)?)],
            Domain::End(reference) => vec![Point::end(phase(reference)?)],
            Domain::Path { phase: reference, points, part } => {
                let phase = phase(reference)?;
                let member = &frame.layout.phases[phase];
                let Some(set) = frame.structure.phases[member.phase].points.get(*points) else {
                    return Err(SetupError::malformed(format!("there is no point set number {points}")));
                };
                within(part, set, make(set, &member.breakpoints, phase), phase, &member.breakpoints)
            }
        };
        sites.extend(points.into_iter().map(|point| Site { indices: indices.clone(), point }));
    }
    Ok(sites)
}

impl Elements {
    /// Adds the block of a batch; `index` is the number of its group.
    pub(super) fn add(&mut self, frame: &Frame, index: usize, group: &Group, batch: Batch) -> Result<(), SetupError> {
        let kernels = &frame.structure.kernels;
        let [jacobian, hessian] = batch.patterns(kernels);
        let count = batch.sites.len();
        let mut block = Block {
            elements: count,
            slots: batch.slots.slots(),
            rows: group.rows.len(),
            jacobian,
            hessian,
            target: vec![Target::Objective; group.rows.len() * count],
            weight: vec![1.0; group.rows.len() * count],
            ..Block::default()
        };
        range_maps(&mut block, &batch.slots);
        let mut bounds = vec![];
        for (element, site) in batch.sites.iter().enumerate() {
            if element == 0 || !batch.sites[element - 1].is_of_member(site) {
                bounds = group_bounds(frame, group, &site.indices)?;
            }
            for (row, meaning) in group.rows.iter().enumerate() {
                let at = row * count + element;
                match meaning {
                    Row::Constraint { constraint, .. } => {
                        let maker = (self.blocks.len(), element, row);
                        block.target[at] = self.add_row(*constraint, site, bounds[row], maker);
                    }
                    _ => block.weight[at] = weight(group, site)?,
                }
            }
        }
        self.blocks.push(block);
        let degree = batch.degrees(kernels);
        self.batches.push(GroupBatch { group: index, batch, degree });
        Ok(())
    }

    /// Takes in other values of parameters: data and bounds. Layout and clock are the same.
    pub(crate) fn take_data(&mut self, frame: &Frame) -> Result<(), SetupError> {
        let Self { blocks, batches, lower, upper, rows, .. } = self;
        for (number, (block, GroupBatch { group, batch, .. })) in blocks.iter().zip(batches).enumerate() {
            let group = &frame.structure.groups[*group];
            batch.take_data(frame, &group.call)?;
            let mut bounds = vec![];
            for (element, site) in batch.sites.iter().enumerate() {
                if element == 0 || !batch.sites[element - 1].is_of_member(site) {
                    bounds = group_bounds(frame, group, &site.indices)?;
                }
                for (row, bounds) in bounds.iter().enumerate() {
                    let Target::Row(target) = block.target[row * block.elements + element] else { continue };
                    let target = target as usize;
                    if rows[target].maker == (number, element, row) {
                        (lower[target], upper[target]) = *bounds;
                    }
                }
            }
        }
        Ok(())
    }

    fn add_row(&mut self, constraint: usize, site: &Site, bounds: (f64, f64), maker: (usize, usize, usize)) -> Target {
        let row = narrow(self.rows.len());
        if site.point.phase.is_none() {
            self.makers.insert((constraint, site.indices.clone()), row);
        }
        let (kind, indices) = (RowKind::Constraint(constraint), site.indices.clone());
        self.rows.push(RowInfo { kind, indices, point: site.point, maker });
        self.lower.push(bounds.0);
        self.upper.push(bounds.1);
        Target::Row(row)
    }

    /// The block of `variable - sum = 0`: one element for each member of each integral
    /// (docs/maths.md, equation 4.12); the sums are added by [`Elements::add_parts`].
    fn add_identities(&mut self, frame: &Frame) {
        let (mut variables, mut targets) = (vec![], vec![]);
        for (integral, members) in frame.layout.integral_members.iter().enumerate() {
            for (member, indices) in members.iter().enumerate() {
                let row = narrow(self.rows.len());
                let variable = frame.layout.integral_first[integral] + narrow(member);
                self.rows.push(RowInfo {
                    kind: RowKind::Integral(integral),
                    indices: indices.clone(),
                    point: Point::NONE,
                    maker: (self.blocks.len(), variables.len(), 0),
                });
                self.lower.push(0.0);
                self.upper.push(0.0);
                self.integral_rows.push(row);
                targets.push(Target::Row(row));
                variables.push(variable);
            }
        }
        if variables.is_empty() {
            return;
        }
        let count = variables.len();
        let mut block = Block {
            elements: count,
            slots: 1,
            rows: 1,
            jacobian: vec![(0, 0)],
            target: targets,
            weight: vec![1.0; count],
            ..Block::default()
        };
        identities(&mut block, variables);
        self.blocks.push(block);
    }

    /// Sends parts of constraints and of integrals to the rows that other elements have made.
    fn add_parts(&mut self, frame: &Frame) -> Result<(), SetupError> {
        for (block, GroupBatch { group, batch, .. }) in self.blocks.iter_mut().zip(&self.batches) {
            let group = &frame.structure.groups[*group];
            for (row, meaning) in group.rows.iter().enumerate() {
                for (element, site) in batch.sites.iter().enumerate() {
                    let at = row * batch.sites.len() + element;
                    let target = match meaning {
                        Row::Cost { .. } | Row::Constraint { .. } => continue,
                        Row::Part { constraint, index } => {
                            let index = evaluate(index, &site.indices);
                            match self.makers.get(&(*constraint, index.clone())) {
                                Some(row) => *row,
                                None => return Err(no_maker(frame, *constraint, &index)),
                            }
                        }
                        Row::Integral { integral, index } => {
                            block.weight[at] = -block.weight[at];
                            let index = evaluate(index, &site.indices);
                            let variable = frame.layout.integral(frame.structure, *integral, &index)?;
                            let first = first_integral(frame.layout);
                            self.integral_rows[(variable - first) as usize]
                        }
                    };
                    block.target[at] = Target::Row(target);
                }
            }
        }
        Ok(())
    }
}

impl Elements {
    /// The row that defines each integral's member, in the order of their variables.
    pub(crate) fn integral_rows(&self) -> impl Iterator<Item = &u32> {
        self.integral_rows.iter()
    }

    /// The rows that define integrals, with their variables, but for those that boundary conditions decide.
    pub(super) fn definitions(&self, layout: &Layout, limits: &Limits) -> Vec<Definition> {
        let all = (first_integral(layout)..).zip(&self.integral_rows);
        let is_open = |of: &Definition| {
            let (row, variable) = (of.row as usize, of.variable as usize);
            (limits.row_lower[row], limits.row_upper[row]) == (0.0, 0.0)
                && (limits.lower[variable], limits.upper[variable]) == (f64::NEG_INFINITY, f64::INFINITY)
        };
        all.map(|(variable, &row)| Definition { row, variable }).filter(is_open).collect()
    }
}

/// The quadrature weight of an integrand, 1 for what belongs to no path.
fn weight(group: &Group, site: &Site) -> Result<f64, SetupError> {
    match group.domain {
        Domain::Path { .. } if site.point.weight.is_nan() => {
            Err(SetupError::malformed("an integrand stands on points without weights"))
        }
        Domain::Path { .. } => Ok(site.point.weight),
        _ => Ok(1.0),
    }
}

fn first_integral(layout: &Layout) -> u32 {
    layout.integral_first.first().copied().unwrap_or(0)
}

fn evaluate(index: &[Affine], indices: &[i64]) -> Vec<i64> {
    index.iter().map(|affine| affine.at(indices)).collect()
}

fn no_maker(frame: &Frame, constraint: usize, index: &[i64]) -> SetupError {
    let place = frame.structure.constraints.get(constraint).map(|c| c.place.clone()).unwrap_or_default();
    outside(format!("the constraint `{}`", place.text), index, place)
}

impl Frame<'_> {
    /// A linear row of one slot as `slope * slot + offset` in each element, from its values at 0 and 1.
    pub(crate) fn lines(&self, group: &GroupBatch, row: usize, slot: usize) -> Vec<Option<(f64, f64)>> {
        let elements = group.batch.sites.len();
        let mut work = group.batch.node.work();
        let mut slots = vec![0.0; group.batch.slots.len()];
        let mut values = |at: f64| {
            slots[slot * elements..][..elements].fill(at);
            group.batch.node.values(self.problem, self.tables, &slots, &mut work);
            work.values[row * elements..][..elements].to_vec()
        };
        let ends = values(0.0).into_iter().zip(values(1.0));
        let line = |(offset, one): (f64, f64)| {
            let slope = one - offset;
            (slope.is_finite() && slope != 0.0 && offset.is_finite()).then_some((slope, offset))
        };
        ends.map(line).collect()
    }
}
