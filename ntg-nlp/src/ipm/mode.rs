//! How violations are treated: never accepted without gain (the filter), or at a price (docs/maths.md, sections 11.5,
//! 11.6 and 11.11).

use super::augmented::AugmentedLagrangian;
use super::penalty::Penalty;
use super::relaxed::Relaxed;
use super::restoration::Restoration;

/// The mode of an iteration.
#[derive(Debug)]
pub(super) enum Mode {
    /// Steps are searched by the filter.
    Filter,
    /// Feasibility is restored; the objective does not count.
    Restoration(Restoration),
    /// Rows are elastic, with an exact penalty.
    Penalty(Penalty),
    /// Rows may be violated at the price of an augmented Lagrangian.
    Augmented(AugmentedLagrangian),
}

impl Mode {
    /// The price of violations; none in the filter's mode.
    pub(super) fn relaxed(&self) -> Option<&dyn Relaxed> {
        match self {
            Self::Filter => None,
            Self::Restoration(restoration) => Some(&*restoration.price),
            Self::Penalty(penalty) => Some(penalty),
            Self::Augmented(augmented) => Some(augmented),
        }
    }

    /// As [`Mode::relaxed`], to be changed.
    pub(super) fn relaxed_mut(&mut self) -> Option<&mut dyn Relaxed> {
        match self {
            Self::Filter => None,
            Self::Restoration(restoration) => Some(&mut *restoration.price),
            Self::Penalty(penalty) => Some(penalty),
            Self::Augmented(augmented) => Some(augmented),
        }
    }

    /// The restoration, where feasibility is restored.
    pub(super) fn restoration(&self) -> Option<&Restoration> {
        match self {
            Self::Restoration(restoration) => Some(restoration),
            _ => None,
        }
    }

    /// Whether the multipliers are those of a stationary point of the program once the residuals vanish: rows of an exact
    /// penalty and of a restoration have others.
    pub(super) fn has_own_multipliers(&self) -> bool {
        matches!(self, Self::Filter | Self::Augmented(_))
    }
}
