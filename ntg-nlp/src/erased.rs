//! Programs whose type is forgotten, so that the methods are compiled once.
//!
//! Generic code is compiled for each type that it is called with, and a method is ten thousand lines: for every kind of program,
//! for those in other forms ([`crate::posed`]) and with other sizes ([`crate::sizes`]). What a method asks of a program are
//! whole evaluations, beside which a call through a table of functions is nothing. So what is public forgets the type of its
//! program at once ([`Own`]), and what is below is compiled for [`Erased`] alone. No number changes.

use crate::contract::{Block, Evaluation, Limits, Nlp, NotFinite};
use std::any::Any;

/// A workspace, whose type is known to its program.
pub(crate) type Buffers = Box<dyn Any + Send>;

/// [`Nlp`] for a type that is not known.
pub(crate) trait Program: Sync {
    fn limits(&self) -> &Limits;
    fn blocks(&self) -> &[Block];
    fn globals(&self) -> usize;
    fn workspace(&self) -> (Buffers, Evaluation);
    fn values(&self, x: &[f64], work: &mut Buffers, out: &mut Evaluation) -> Result<(), NotFinite>;
    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Buffers,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite>;
}

/// A program of whatever type.
#[derive(Clone, Copy)]
pub(crate) struct Erased<'a>(&'a dyn Program);

impl<'a> Erased<'a> {
    pub(crate) fn of(program: &'a dyn Program) -> Self {
        Self(program)
    }
}

impl Nlp for Erased<'_> {
    type Workspace = Buffers;

    fn limits(&self) -> &Limits {
        self.0.limits()
    }

    fn blocks(&self) -> &[Block] {
        self.0.blocks()
    }

    fn globals(&self) -> usize {
        self.0.globals()
    }

    fn workspace(&self) -> (Buffers, Evaluation) {
        self.0.workspace()
    }

    fn values(&self, x: &[f64], work: &mut Buffers, out: &mut Evaluation) -> Result<(), NotFinite> {
        self.0.values(x, work, out)
    }

    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Buffers,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite> {
        self.0.derivatives(x, objective_weight, multipliers, work, out)
    }
}

/// A program of a caller.
pub(crate) struct Own<'a, N>(pub(crate) &'a N);

impl<N: Nlp> Own<'_, N> {
    /// The workspace as what it is. One of a program of another type, which no caller can hand over, is made anew.
    fn own<'w>(&self, work: &'w mut Buffers) -> &'w mut N::Workspace {
        if !work.is::<N::Workspace>() {
            *work = Box::new(self.0.workspace().0);
        }
        work.downcast_mut().expect("it is of this type")
    }
}

impl<N: Nlp> Program for Own<'_, N> {
    fn limits(&self) -> &Limits {
        self.0.limits()
    }

    fn blocks(&self) -> &[Block] {
        self.0.blocks()
    }

    fn globals(&self) -> usize {
        self.0.globals()
    }

    fn workspace(&self) -> (Buffers, Evaluation) {
        let (work, at) = self.0.workspace();
        (Box::new(work), at)
    }

    fn values(&self, x: &[f64], work: &mut Buffers, out: &mut Evaluation) -> Result<(), NotFinite> {
        self.0.values(x, self.own(work), out)
    }

    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Buffers,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite> {
        self.0.derivatives(x, objective_weight, multipliers, self.own(work), out)
    }
}
