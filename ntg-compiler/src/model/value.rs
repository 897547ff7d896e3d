//! What an expression is worth while it is being given a meaning: a node, its dimension, its place.
//!
//! Afterwards: whoever holds a [`Value`] without a flaw holds a node whose quantity is in SI units
//! of its dimension.

use std::rc::Rc;

use ntg_structure::Unit;

use super::dimension::Dimension;
use super::problem::IndexId;
use crate::expr::NodeId;
use crate::source::Span;

/// The meaning of an expression.
#[derive(Clone, Debug)]
pub(super) struct Value {
    /// What it computes; anything where there is a flaw.
    pub(super) node: NodeId,
    /// Its dimension; none where every dimension fits (the literal 0, a flaw).
    pub(super) dimension: Option<Dimension>,
    /// The unit in which a person would show it, where the spec suggests one.
    pub(super) unit: Option<Rc<Unit>>,
    /// Where it stands.
    pub(super) span: Span,
    /// Why it must not be used.
    pub(super) flaw: Option<Flaw>,
}

/// Why a value must not be used.
#[derive(Clone, Debug)]
pub(super) enum Flaw {
    /// A finding has told already.
    Reported,
    /// It depends on something that has no value here; who uses it tells, once.
    Misplaced(Rc<Misplaced>),
    /// Only for a known index it has a value; the loop over that index finds it (`repeat.rs`).
    Open(OpenIndex),
}

/// An index that must be known.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenIndex {
    /// Which.
    pub(super) index: IndexId,
    /// Where the formula changes, if only that must be known: below, at and above this value it is one formula.
    pub(super) cut: Option<i64>,
    /// What needs it.
    pub(super) span: Span,
}

/// Something that has no value where it stands.
#[derive(Clone, Debug)]
pub(super) struct Misplaced {
    /// Where it stands.
    pub(super) span: Span,
    /// What it is.
    pub(super) what: What,
    /// Its text.
    pub(super) text: String,
    /// Inside which definition the reason is found.
    pub(super) because: Option<(Span, String)>,
}

/// What kind of thing has no value here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum What {
    /// An output, or an expression of one.
    Trajectory,
    /// `t`.
    Time,
    /// `tau`.
    ScaledTime,
    /// A parameter, or a table that may be replaced.
    Parameter,
    /// A loop's index.
    Index,
    /// A declared variable.
    Variable,
    /// A duration, an event time, a boundary value or an integral.
    Mission,
}

impl Value {
    /// A flawless value.
    pub(super) fn new(node: NodeId, dimension: Dimension, span: Span) -> Self {
        Self { node, dimension: Some(dimension), unit: None, span, flaw: None }
    }

    /// The same, shown in a unit.
    pub(super) fn shown_in(mut self, unit: Option<Rc<Unit>>) -> Self {
        self.unit = unit;
        self
    }

    /// The same at another place, as where a name stands for it.
    pub(super) fn at(mut self, span: Span) -> Self {
        self.span = span;
        self
    }

    /// Another value made from this one: flaw and unit are inherited.
    pub(super) fn map(&self, node: NodeId, dimension: Option<Dimension>, span: Span) -> Self {
        Self { node, dimension, unit: None, span, flaw: self.flaw.clone() }
    }

    /// Whether it can be used.
    pub(super) fn is_sound(&self) -> bool {
        self.flaw.is_none()
    }

    /// Its dimension; that of a pure number where every dimension fits.
    pub(super) fn dimension_or_none(&self) -> Dimension {
        self.dimension.unwrap_or(Dimension::NONE)
    }
}

impl Flaw {
    /// The graver of two flaws: one that was told already hides one that was not.
    pub(super) fn join(a: &Option<Self>, b: &Option<Self>) -> Option<Self> {
        match (a, b) {
            (Some(Self::Reported), _) | (_, Some(Self::Reported)) => Some(Self::Reported),
            (Some(flaw), _) | (None, Some(flaw)) => Some(flaw.clone()),
            (None, None) => None,
        }
    }
}
