//! The shape of one member of a call: which distinct slots it has, and how many members each of
//! its reductions has.
//!
//! Elements of one block must have one shape. Two members of a call have the same [`Shape`] when
//! their reductions have equally many members and the same slots coincide (docs/maths.md,
//! section 4.5); they differ in *which* slots these are.

use super::error::SetupError;
use super::frame::Frame;
use super::instances::range;
use super::layout::narrow;
use super::node::Site;
use super::slots::Source;
use ntg_structure::Call;

/// Numbers of members and positions of slots, in the order in which a call is walked.
pub(crate) type Shape = Vec<u32>;

/// One member of a call.
#[derive(Clone, Debug, Default)]
pub(crate) struct Traced {
    /// What distinguishes blocks.
    pub(crate) shape: Shape,
    /// What the element's slots stand for.
    pub(crate) sources: Vec<Source>,
}

/// Walks a call and its reductions for one member.
pub(crate) fn trace(frame: &Frame, call: &Call, site: &Site) -> Result<Traced, SetupError> {
    let mut traced = Traced::default();
    if call.reductions.is_empty() {
        // The kernel's own slots are the element's, even where two of them coincide.
        for slot in &call.slots {
            traced.sources.push(frame.source(slot, site)?);
        }
    } else {
        walk(frame, call, site, &mut traced)?;
    }
    Ok(traced)
}

fn walk(frame: &Frame, call: &Call, site: &Site, traced: &mut Traced) -> Result<(), SetupError> {
    for slot in &call.slots {
        let source = frame.source(slot, site)?;
        let position = traced.sources.iter().position(|s| *s == source).unwrap_or_else(|| {
            traced.sources.push(source);
            traced.sources.len() - 1
        });
        traced.shape.push(narrow(position));
    }
    for reduction in &call.reductions {
        let counter = traced.shape.len();
        traced.shape.push(0);
        for value in range(&reduction.over, &site.indices) {
            traced.shape[counter] += 1;
            walk(frame, &reduction.body, &site.inside(value), traced)?;
        }
    }
    Ok(())
}
