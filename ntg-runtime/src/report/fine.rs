//! Constraints and cost on a finer grid (docs/maths.md, section 9).
//!
//! A [`Plan`] holds every group with constraints at equally spaced points with both one-sided limits at breakpoints,
//! where what is integrated beside them is integrated too, and every other group at composite Gauss points.
//! To build it costs far more than to evaluate it, so a problem that is solved again keeps it. Integrals that are
//! variables are first replaced by their finer values.

use super::dips;
use super::nodes::Passing;
use crate::transcribe::batch::{Batch, BatchWork, batches};
use crate::transcribe::elements::sites;
use crate::transcribe::node::Site;
use crate::transcribe::points::{Point, fine_quadrature, fine_set};
use crate::transcribe::rows::{Pair, group_bounds};
use crate::transcribe::{SetupError, Transcription};
use ntg_structure::{Block, Domain, Row};
use std::collections::BTreeMap;

/// Which values of constraints are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// Those of constraints that are violated, and one of every other constraint.
    Violated,
    /// All.
    All,
}

/// A constraint's value somewhere, with its bounds, SI.
pub(super) struct Checked<'a> {
    pub(super) constraint: usize,
    pub(super) point: Point,
    pub(super) value: f64,
    pub(super) bounds: Pair,
    /// The group of the structure that computes it.
    pub(super) group: usize,
    /// The indices of the loops around it.
    pub(super) indices: &'a [i64],
}

/// A constraint, its member and the phase.
pub(super) type Key = (usize, Vec<i64>, usize);

impl Checked<'_> {
    /// Which limit along which phase this is a value of; none of equations, and of what belongs to no phase.
    pub(super) fn limit(&self) -> Option<Key> {
        let phase = self.point.phase.filter(|_| self.bounds.0 < self.bounds.1)?;
        Some((self.constraint, self.indices.to_vec(), phase))
    }
}

/// A problem on the finer grid.
#[derive(Debug)]
pub(crate) struct Plan {
    parts: Vec<Part>,
}

/// One group at points of one shape.
#[derive(Debug)]
struct Part {
    group: usize,
    /// Whether it has rows that add to a sum, and rows that are constraints.
    adds: bool,
    checks: bool,
    batch: Batch,
    work: BatchWork,
    /// The bounds of the rows from an element on, where the indices change there.
    bounds: Vec<(usize, Vec<Pair>)>,
    /// What tables of its limits are evaluated at, once there are limits.
    passing: Option<Passing>,
}

/// Constraint and member of a row that has parts elsewhere.
type Member = (usize, Vec<i64>);

impl Plan {
    /// Plans `samples` stretches for each point of the transcription.
    pub(crate) fn new(nlp: &Transcription, samples: usize) -> Result<Self, SetupError> {
        let frame = nlp.frame();
        let mut plan = Self { parts: vec![] };
        let structure = &nlp.model.structure;
        for (index, group) in structure.groups.iter().chain(&structure.shown).enumerate() {
            let checked = |row: &Row| matches!(row, Row::Constraint { .. });
            let (adds, checks) = (!group.rows.iter().all(checked), group.rows.iter().any(checked));
            let finer = if checks { fine_set } else { fine_quadrature };
            let sites = sites(&frame, group, |points, breakpoints, phase| finer(points, breakpoints, phase, samples))?;
            for batch in batches(&frame, &group.call, sites)? {
                let work = batch.work();
                plan.parts.push(Part { group: index, adds, checks, batch, work, bounds: vec![], passing: None });
            }
        }
        plan.set_bounds(nlp)?;
        Ok(plan)
    }

    /// Takes in other values of parameters, where layout and clock are those of the plan.
    pub(crate) fn take_data(&mut self, nlp: &Transcription) -> Result<(), SetupError> {
        let frame = nlp.frame();
        for part in &mut self.parts {
            let call = &nlp.model.structure.group(part.group).call;
            part.batch.take_data_into(&frame, call, &mut part.work)?;
            if let Some(passing) = &mut part.passing {
                passing.take_data(nlp)?;
            }
        }
        self.set_bounds(nlp)
    }

    fn set_bounds(&mut self, nlp: &Transcription) -> Result<(), SetupError> {
        self.parts.iter_mut().filter(|part| part.checks).try_for_each(|part| part.set_bounds(nlp))
    }

    /// Evaluates everything: calls `visit` with constraints, and gives the minimised value of every term, SI.
    pub(super) fn evaluate(
        &mut self,
        nlp: &Transcription,
        (x, wanted): (&[f64], Wanted),
        mut visit: impl FnMut(&Checked<'_>),
    ) -> Result<Vec<f64>, SetupError> {
        let x = self.integrals(nlp, x)?;
        self.parts.iter_mut().for_each(|part| part.values(nlp, &x));
        let structure = &nlp.model.structure;
        let (mut terms, shown) = (vec![0.0; structure.terms.len()], structure.terms_shown());
        let constraints_shown = structure.constraints_shown();
        // Between the points a helper says nothing of the corner that it stands for.
        let counts = |shown: &[bool], of: usize, group: usize| {
            shown.get(of).is_some_and(|shown| *shown == (group >= structure.groups.len()))
        };
        let mut parts: BTreeMap<Member, f64> = BTreeMap::new();
        for part in self.parts.iter().filter(|part| part.adds) {
            part.integrands(nlp, |row, site, value| match row {
                Row::Cost { term } => {
                    if let Some(sum) = terms.get_mut(*term).filter(|_| counts(&shown, *term, part.group)) {
                        *sum += value;
                    }
                }
                Row::Part { constraint, .. } if !counts(&constraints_shown, *constraint, part.group) => {}
                Row::Part { constraint, index } => {
                    let index = index.iter().map(|affine| affine.at(&site.indices)).collect();
                    *parts.entry((*constraint, index)).or_insert(0.0) += value;
                }
                Row::Constraint { .. } | Row::Integral { .. } => {}
            });
        }
        for part in self.parts.iter_mut().filter(|part| part.checks) {
            let group = part.group;
            let mut checked = |checked: &Checked<'_>| {
                if counts(&constraints_shown, checked.constraint, group) {
                    visit(checked);
                }
            };
            part.check(nlp, (&parts, wanted), &mut checked);
            // Equations are measured by their mean and integral over the points alone.
            for between in part.between(nlp, &x)? {
                between.check(nlp, (&parts, Wanted::Violated), &mut |found| {
                    if found.bounds.0 < found.bounds.1 {
                        checked(found);
                    }
                });
            }
        }
        Ok(terms)
    }

    /// The variables with every integral replaced by its finer value.
    fn integrals(&mut self, nlp: &Transcription, x: &[f64]) -> Result<Vec<f64>, SetupError> {
        /// Integrals may depend on integrals.
        const NESTING: usize = 3;
        let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
        let mut x = x.to_vec();
        for _ in 0..if structure.integrals.is_empty() { 0 } else { NESTING } {
            let mut sums: BTreeMap<u32, f64> = BTreeMap::new();
            let mut failed = None;
            for part in self.parts.iter_mut().filter(|part| part.adds) {
                part.values(nlp, &x);
                part.integrands(nlp, |row, site, value| {
                    let Row::Integral { integral, index } = row else { return };
                    let index: Vec<i64> = index.iter().map(|affine| affine.at(&site.indices)).collect();
                    match layout.integral(structure, *integral, &index) {
                        Ok(variable) => *sums.entry(variable).or_insert(0.0) += value,
                        Err(error) => failed = Some(error),
                    }
                });
            }
            if let Some(error) = failed {
                return Err(error);
            }
            sums.into_iter().for_each(|(variable, value)| x[variable as usize] = value);
        }
        Ok(x)
    }
}

impl Part {
    fn set_bounds(&mut self, nlp: &Transcription) -> Result<(), SetupError> {
        let (frame, group) = (nlp.frame(), nlp.model.structure.group(self.group));
        self.bounds.clear();
        for (element, site) in self.batch.sites.iter().enumerate() {
            if element == 0 || !self.batch.sites[element - 1].is_of_member(site) {
                self.bounds.push((element, group_bounds(&frame, group, &site.indices)?));
            }
        }
        Ok(())
    }

    /// The same group, with values, where limits may be crossed between the points: where they fall and rise again, and where
    /// arguments of tables pass nodes. Before: [`Part::values`].
    fn between(&mut self, nlp: &Transcription, x: &[f64]) -> Result<Vec<Self>, SetupError> {
        let unknown = self.at(nlp, x, self.places(nlp, dips::unknown))?;
        let mut places = self.places(nlp, dips::between);
        places.extend(unknown.iter().flat_map(|part| part.places(nlp, dips::between)));
        let is_limit = |(lower, upper): &Pair| lower < upper && (lower.is_finite() || upper.is_finite());
        if self.bounds.iter().any(|(_, bounds)| bounds.iter().any(is_limit)) {
            if self.passing.is_none() {
                self.passing = Passing::of(nlp, self.group, &self.batch.sites)?;
            }
            if let Some(passing) = &mut self.passing {
                passing.nodes(nlp, x, &mut places)?;
            }
        }
        let mut all = self.at(nlp, x, places)?;
        all.extend(unknown);
        Ok(all)
    }

    /// The places that a rule finds beside the values of every constraint.
    fn places(&self, nlp: &Transcription, rule: impl Fn(&[Site], &[f64], Pair, &mut Vec<Site>)) -> Vec<Site> {
        let (group, sites) = (nlp.model.structure.group(self.group), &self.batch.sites);
        let mut places = vec![];
        let ends = self.bounds.iter().skip(1).map(|(element, _)| *element).chain([sites.len()]);
        for ((first, bounds), end) in self.bounds.iter().zip(ends) {
            for row in (0..group.rows.len()).filter(|row| matches!(group.rows[*row], Row::Constraint { .. })) {
                let values = &self.work.node.values[row * sites.len()..][*first..end];
                rule(&sites[*first..end], values, bounds[row], &mut places);
            }
        }
        places
    }

    /// The same group elsewhere, with values.
    fn at(&self, nlp: &Transcription, x: &[f64], places: Vec<Site>) -> Result<Vec<Self>, SetupError> {
        if places.is_empty() {
            return Ok(vec![]);
        }
        let part = |batch: Batch| {
            let work = batch.work();
            let mut part =
                Self { group: self.group, adds: false, checks: true, batch, work, bounds: vec![], passing: None };
            part.set_bounds(nlp)?;
            part.values(nlp, x);
            Ok(part)
        };
        batches(&nlp.frame(), &nlp.model.structure.group(self.group).call, places)?.into_iter().map(part).collect()
    }

    /// Evaluates all rows.
    fn values(&mut self, nlp: &Transcription, x: &[f64]) {
        self.batch.values(nlp.problem, &nlp.model.tables, x, &mut self.work);
    }

    /// Calls `add` with every row that adds to a sum, its value times its weight. Before: [`Part::values`].
    fn integrands(&self, nlp: &Transcription, mut add: impl FnMut(&Row, &Site, f64)) {
        let group = nlp.model.structure.group(self.group);
        let sites = &self.batch.sites;
        for (row, meaning) in group.rows.iter().enumerate() {
            if matches!(meaning, Row::Constraint { .. }) {
                continue;
            }
            for (element, site) in sites.iter().enumerate() {
                let weight = if matches!(group.domain, Domain::Path { .. }) { site.point.weight } else { 1.0 };
                // Where it is 0 there may be no value.
                if weight == 0.0 {
                    continue;
                }
                add(meaning, site, weight * self.work.node.values[row * sites.len() + element]);
            }
        }
    }

    /// Calls `visit` with what is wanted of the constraints. Before: [`Part::values`].
    fn check(
        &self,
        nlp: &Transcription,
        (parts, wanted): (&BTreeMap<Member, f64>, Wanted),
        visit: &mut impl FnMut(&Checked<'_>),
    ) {
        let group = nlp.model.structure.group(self.group);
        let sites = &self.batch.sites;
        let ends = self.bounds.iter().skip(1).map(|(element, _)| *element).chain([sites.len()]);
        for ((first, bounds), end) in self.bounds.iter().zip(ends) {
            for (row, meaning) in group.rows.iter().enumerate() {
                let Row::Constraint { constraint, .. } = meaning else { continue };
                if nlp.model.structure.constraints[*constraint].block == Block::Corner {
                    continue;
                }
                let (constraint, bounds) = (*constraint, bounds[row]);
                let values = &self.work.node.values[row * sites.len()..][*first..end];
                // Nearly all constraints hold nearly everywhere.
                let one =
                    wanted == Wanted::Violated && all_within(values, bounds) && sites[*first].point.phase.is_some();
                let values = if one { &values[..1] } else { values };
                for (Site { indices, point }, &value) in sites[*first..end].iter().zip(values) {
                    let elsewhere =
                        if point.phase.is_none() { parts.get(&(constraint, indices.clone())) } else { None };
                    let value = value + elsewhere.copied().unwrap_or(0.0);
                    visit(&Checked { constraint, point: *point, value, bounds, group: self.group, indices });
                }
            }
        }
    }
}

/// Whether all values are within bounds; false where one is not a number.
fn all_within(values: &[f64], (lower, upper): Pair) -> bool {
    // Without an exit from the loop the compiler makes vector instructions of it.
    values.iter().fold(true, |all, value| all & (lower <= *value) & (*value <= upper))
}
