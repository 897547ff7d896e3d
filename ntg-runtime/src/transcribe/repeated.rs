//! Constraints that scenarios have in common are rows once.
//!
//! Where members of an array share coefficients (`Structure::shared`), a constraint on what is shared alone is the
//! same function of the same variables for all of them: its row for the first member says it. A second row would make
//! the Jacobian lose rank. Two rows count as the same only when they read the same parameters, not just equal ones, so
//! that other values of parameters change nothing here.

use super::error::SetupError;
use super::frame::Frame;
use super::node::Site;
use ntg_structure::{At, Call, Data, Group, Row, Slot};
use std::collections::HashSet;

/// The sites of a group without those whose rows are there already.
pub(crate) fn without_repetitions(frame: &Frame, group: &Group, sites: Vec<Site>) -> Result<Vec<Site>, SetupError> {
    if !may_repeat(frame, group) {
        return Ok(sites);
    }
    let mut known = HashSet::new(); // Asked, never iterated.
    let mut kept = Vec::with_capacity(sites.len());
    for site in sites {
        let mut key = vec![];
        slots(frame, &group.call, &site, &mut key)?;
        data(frame, &group.call, &site, &mut key)?;
        if let Some(bounds) = &group.bounds {
            data(frame, bounds, &site, &mut key)?;
        }
        if known.insert(key) {
            kept.push(site);
        }
    }
    Ok(kept)
}

/// Whether a group makes rows of its own for several members from something that is shared.
fn may_repeat(frame: &Frame, group: &Group) -> bool {
    let is_shared = |slot: &Slot| match slot {
        Slot::Flat { phase, output, .. } => {
            frame.structure.shared.iter().any(|shared| (shared.phase, shared.output) == (phase.phase, *output))
        }
        _ => false,
    };
    let makes_a_row = |row: &Row| match row {
        Row::Constraint { constraint, .. } => !has_parts(frame, *constraint),
        _ => false,
    };
    !frame.structure.shared.is_empty()
        && !group.loops.is_empty()
        && group.call.reductions.is_empty()
        && group.call.slots.iter().any(is_shared)
        && group.rows.iter().all(makes_a_row)
}

/// Whether other elements add to the rows of a constraint.
fn has_parts(frame: &Frame, constraint: usize) -> bool {
    let rows = frame.structure.groups.iter().flat_map(|group| &group.rows);
    let mut parts = rows.filter_map(|row| match row {
        Row::Part { constraint, .. } => Some(*constraint),
        _ => None,
    });
    parts.any(|part| part == constraint)
}

/// What the slots are as functions of the variables.
fn slots(frame: &Frame, call: &Call, site: &Site, key: &mut Vec<u64>) -> Result<(), SetupError> {
    for slot in &call.slots {
        let map = frame.layout.affine(frame.source(slot, site)?, &site.point);
        key.push(map.terms.len() as u64);
        key.extend(map.terms.iter().flat_map(|(variable, factor)| [u64::from(*variable), factor.to_bits()]));
        key.push(map.offset.to_bits());
        // Where coefficients are all shared, times still tell phases apart.
        if let Slot::Flat { at: At::Here, .. } = slot {
            key.push(site.point.phase.map_or(u64::MAX, |phase| phase as u64));
        }
    }
    Ok(())
}

/// Which data are read.
fn data(frame: &Frame, call: &Call, site: &Site, key: &mut Vec<u64>) -> Result<(), SetupError> {
    let indices = &site.indices;
    for data in &call.data {
        match data {
            Data::Parameter { parameter, index } => {
                key.extend([0, *parameter as u64, index.as_ref().map_or(0, |index| index.at(indices)) as u64]);
            }
            Data::Index(index) => key.extend([1, index.at(indices) as u64]),
            Data::Tau => key.extend([2, site.point.tau.to_bits()]),
            Data::TauWithin => key.extend([5, frame.tau_within(site).to_bits()]),
            Data::Duration(phase) => key.extend([3, frame.layout.phase(frame.structure, phase, indices)? as u64]),
            Data::Start(phase) => key.extend([4, frame.layout.phase(frame.structure, phase, indices)? as u64]),
        }
    }
    Ok(())
}
