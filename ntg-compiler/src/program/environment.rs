//! Which loop binds which index: turns the model's index forms into positions.

use ntg_structure::{Affine, At, Loop as OutLoop, PhaseRef};

use crate::model::problem::{Form, IndexId, Loop, PhaseAt};

/// The indices of the loops around an expression, the outermost first.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Environment {
    indices: Vec<IndexId>,
}

impl Environment {
    pub(super) fn of(loops: &[Loop]) -> Self {
        Self { indices: loops.iter().map(|l| l.index).collect() }
    }

    pub(super) fn affine(&self, form: &Form) -> Affine {
        let mut terms: Vec<(usize, i64)> = form
            .terms
            .iter()
            .filter_map(|(index, factor)| {
                let position = self.indices.iter().rposition(|i| i == index);
                debug_assert!(position.is_some(), "the model binds every index it uses");
                Some((position?, *factor))
            })
            .collect();
        terms.sort_unstable();
        Affine { constant: form.constant, terms }
    }

    /// A point with the position of its index in place of the index itself.
    pub(super) fn at(&self, at: At) -> At {
        let At::Among { places, index } = at else { return at };
        let position = self.indices.iter().rposition(|i| i.0 as usize == index);
        debug_assert!(position.is_some(), "the model binds every index it uses");
        At::Among { places, index: position.unwrap_or_default() }
    }

    pub(super) fn range(&self, range: &Loop) -> OutLoop {
        OutLoop { first: self.affine(&range.first), last: self.affine(&range.last) }
    }

    pub(super) fn phase(&self, at: &PhaseAt) -> PhaseRef {
        PhaseRef {
            phase: at.phase,
            agent: at.agent.as_ref().map(|f| self.affine(f)),
            index: at.index.as_ref().map(|f| self.affine(f)),
        }
    }
}

/// Loops by position, each in terms of those before it.
pub(super) fn loops(list: &[Loop]) -> Vec<OutLoop> {
    (0..list.len()).map(|k| Environment::of(&list[..k]).range(&list[k])).collect()
}

/// The indices of all loops as they are: which member a function is of its own family.
pub(super) fn identity(count: usize) -> Vec<Affine> {
    (0..count).map(Affine::index).collect()
}
