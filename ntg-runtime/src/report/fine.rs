//! Constraints and cost on a finer grid (docs/maths.md, section 9).
//!
//! Takes a point and how much finer; evaluates every group again, integrands at composite Gauss
//! points, constraints at equally spaced points with both one-sided limits at breakpoints.
//! Integrals that are variables are first replaced by their finer values.

use crate::transcribe::batch::batches;
use crate::transcribe::elements::sites;
use crate::transcribe::node::Site;
use crate::transcribe::points::{Point, fine_quadrature, fine_set};
use crate::transcribe::rows::group_bounds;
use crate::transcribe::{SetupError, Transcription};
use ntg_structure::{Domain, Group, Row};
use std::collections::BTreeMap;

/// A constraint's value somewhere, with its bounds, SI.
pub(super) struct Checked {
    pub(super) constraint: usize,
    pub(super) point: Point,
    pub(super) value: f64,
    pub(super) bounds: (f64, f64),
    /// The group of the structure that computes it.
    pub(super) group: usize,
    /// The indices of the loops around it.
    pub(super) indices: Vec<i64>,
}

/// The problem on the finer grid.
#[derive(Default)]
pub(super) struct Fine {
    /// Minimised value of every term, SI.
    pub(super) terms: Vec<f64>,
    /// Every constraint everywhere.
    pub(super) checked: Vec<Checked>,
}

/// Constraint and member of a row that has parts elsewhere.
type Member = (usize, Vec<i64>);

impl Fine {
    pub(super) fn new(nlp: &Transcription, x: &[f64], samples: usize) -> Result<Self, SetupError> {
        let structure = &nlp.model.structure;
        let mut fine = Self { terms: vec![0.0; structure.terms.len()], ..Self::default() };
        let x = integrals(nlp, x, samples)?;
        let mut parts: BTreeMap<Member, f64> = BTreeMap::new();
        for group in &structure.groups {
            integrands(nlp, group, &x, samples, |row, site, value| match row {
                Row::Cost { term } => {
                    if let Some(sum) = fine.terms.get_mut(*term) {
                        *sum += value;
                    }
                }
                Row::Part { constraint, index } => {
                    let index = index.iter().map(|affine| affine.at(&site.indices)).collect();
                    *parts.entry((*constraint, index)).or_insert(0.0) += value;
                }
                Row::Constraint { .. } | Row::Integral { .. } => {}
            })?;
        }
        for group in 0..structure.groups.len() {
            fine.check(nlp, group, &x, samples, &parts)?;
        }
        Ok(fine)
    }

    fn check(
        &mut self,
        nlp: &Transcription,
        index: usize,
        x: &[f64],
        samples: usize,
        parts: &BTreeMap<Member, f64>,
    ) -> Result<(), SetupError> {
        let group = &nlp.model.structure.groups[index];
        if !group.rows.iter().any(|row| matches!(row, Row::Constraint { .. })) {
            return Ok(());
        }
        let frame = nlp.frame();
        let sites = sites(&frame, group, |points, breakpoints, phase| fine_set(points, breakpoints, phase, samples))?;
        for (batch, _) in batches(&frame, &group.call, sites)? {
            let mut work = batch.work();
            batch.values(nlp.problem, &nlp.model.tables, x, &mut work);
            let mut bounds = (vec![], vec![]);
            for (element, site) in batch.sites.iter().enumerate() {
                if element == 0 || bounds.0 != site.indices {
                    bounds = (site.indices.clone(), group_bounds(&frame, group, &site.indices)?);
                }
                for (row, meaning) in group.rows.iter().enumerate() {
                    let Row::Constraint { constraint, .. } = meaning else { continue };
                    let indices = site.indices.clone();
                    let mut value = work.node.values[row * batch.sites.len() + element];
                    if site.point.phase.is_none() {
                        value += parts.get(&(*constraint, site.indices.clone())).copied().unwrap_or(0.0);
                    }
                    let (constraint, point) = (*constraint, site.point);
                    let bounds = bounds.1[row];
                    self.checked.push(Checked { constraint, point, value, bounds, group: index, indices });
                }
            }
        }
        Ok(())
    }
}

/// The variables with every integral replaced by its finer value.
fn integrals(nlp: &Transcription, x: &[f64], samples: usize) -> Result<Vec<f64>, SetupError> {
    /// Integrals may depend on integrals.
    const NESTING: usize = 3;
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let mut x = x.to_vec();
    for _ in 0..if structure.integrals.is_empty() { 0 } else { NESTING } {
        let mut sums: BTreeMap<u32, f64> = BTreeMap::new();
        let mut failed = None;
        for group in &structure.groups {
            integrands(nlp, group, &x, samples, |row, site, value| {
                let Row::Integral { integral, index } = row else { return };
                let index: Vec<i64> = index.iter().map(|affine| affine.at(&site.indices)).collect();
                match layout.integral(structure, *integral, &index) {
                    Ok(variable) => *sums.entry(variable).or_insert(0.0) += value,
                    Err(error) => failed = Some(error),
                }
            })?;
        }
        if let Some(error) = failed {
            return Err(error);
        }
        sums.into_iter().for_each(|(variable, value)| x[variable as usize] = value);
    }
    Ok(x)
}

/// Calls `add` with every row that adds to a sum, its value times its weight.
fn integrands(
    nlp: &Transcription,
    group: &Group,
    x: &[f64],
    samples: usize,
    mut add: impl FnMut(&Row, &Site, f64),
) -> Result<(), SetupError> {
    if !group.rows.iter().any(|row| !matches!(row, Row::Constraint { .. })) {
        return Ok(());
    }
    let frame = nlp.frame();
    let sites =
        sites(&frame, group, |points, breakpoints, phase| fine_quadrature(points, breakpoints, phase, samples))?;
    for (batch, _) in batches(&frame, &group.call, sites)? {
        let mut work = batch.work();
        batch.values(nlp.problem, &nlp.model.tables, x, &mut work);
        for (row, meaning) in group.rows.iter().enumerate() {
            for (element, site) in batch.sites.iter().enumerate() {
                let weight = if matches!(group.domain, Domain::Path { .. }) { site.point.weight } else { 1.0 };
                add(meaning, site, weight * work.node.values[row * batch.sites.len() + element]);
            }
        }
    }
    Ok(())
}
