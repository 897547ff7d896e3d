//! What measurements say of outputs, for a first guess (docs/maths.md, section 8.1).
//!
//! Takes statements `measure`; gives values of outputs at times. Counted are residuals of one output at a place in time that
//! are linear in it: what it is where the residual is 0.

use super::Transcription;
use super::batch::batches;
use super::instances::members;
use super::node::Site;
use super::points::Point;
use super::slots::Source;
use ntg_structure::{At, Slot};
use std::collections::HashMap;

/// By so much of its slope a residual may differ from a line. A law: roundings of its value.
const LINEAR: f64 = 1e-9;

/// Scaled times and values of outputs, by phase and output of the layout.
#[derive(Debug, Default)]
pub(super) struct Measured(HashMap<(usize, usize), Vec<(f64, f64)>>); // Looked up, never iterated.

impl Measured {
    pub(super) fn of(nlp: &Transcription) -> Self {
        let frame = nlp.frame();
        let mut found = Self::default();
        for measurement in &nlp.model.structure.measurements {
            let call = &measurement.residual;
            let [slot @ Slot::Flat { derivative: 0, .. }] = &call.slots[..] else { continue };
            let sites = members(&measurement.loops).into_iter().map(|indices| Site { indices, point: Point::NONE });
            // What is wrong with a call, the transcription has told.
            let Ok(batches) = batches(&frame, call, sites.collect()) else { continue };
            for batch in batches {
                let mut work = batch.node.work();
                let mut residuals = |value: f64| {
                    batch.node.values(nlp.problem, &nlp.model.tables, &vec![value; batch.slots.len()], &mut work);
                    work.values[..batch.sites.len()].to_vec()
                };
                let values = residuals(0.0).into_iter().zip(residuals(1.0)).zip(residuals(2.0));
                for (((zero, one), two), site) in values.zip(&batch.sites) {
                    let slope = one - zero;
                    let is_linear = slope != 0.0
                        && slope.is_finite()
                        && (two - one - slope).abs() <= LINEAR * slope.abs().max(zero.abs());
                    if let (true, Ok(Source::Flat { phase, at, output, .. })) = (is_linear, frame.source(slot, site)) {
                        let tau = match at {
                            At::Start => 0.0,
                            At::End => 1.0,
                            At::Inside(instant) => instant.tau(),
                            At::Here | At::Among { .. } => continue,
                        };
                        found.0.entry((phase, output)).or_default().push((tau, -zero / slope));
                    }
                }
            }
        }
        found
    }

    /// What is known of an output of a phase.
    pub(super) fn values(&self, phase: usize, output: usize) -> &[(f64, f64)] {
        self.0.get(&(phase, output)).map_or(&[], Vec::as_slice)
    }
}
