//! What a problem *is*, as plain data: the contract between the compiler and every back end.
//!
//! A [`Structure`] says everything about a problem except the formulas: its parameters, agents,
//! phases and splines, which functions are evaluated where, and which row of the optimisation
//! problem each result belongs to.
//! The formulas are *kernels*, addressed by number: straight-line functions whose code is
//! generated Rust, an interpreter's tape, or whatever a later back end brings.
//!
//! Families (arrays, `for`, `sum`, families of agents and phases) stay families: a [`Call`] names
//! its inputs through [`Affine`] index expressions, and a [`Loop`] says which values the indices
//! take. Nothing here grows with the number of members or of collocation points.
//!
//! All numbers are in SI units; a [`Unit`] is how a person sees them.
//! The crate depends on nothing and computes nothing but what a number is in a unit.

mod call;
pub mod constant;
mod group;
mod guess;
mod index;
mod kernel;
mod mission;
mod part;
mod quantity;

pub use call::{At, Call, Data, PhaseRef, ReduceOp, Reduction, Slot};
pub use group::{
    Angle, Arguments, Block, Constraint, Domain, Group, Helper, Integral, Measurement, Named, Relaxation, Row, Term,
};
pub use guess::{Continuation, Guess, GuessKind, GuessScope};
pub use index::{Affine, Family, Grid, Loop};
pub use kernel::{Degree, Kernel};
pub use mission::{
    Agent, Bounds, Duration, Output, Parameter, Phase, Points, Shared, Spline, Start, Table, TableAxis,
    TableExtrapolation, TableMethod, TableSymmetry, Variable,
};
pub use part::{Instant, Part, Places};
pub use quantity::{Independent, Place, Unit, as_typed};

/// A whole problem, without its formulas.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Structure {
    /// The problem's name, as in `problem VanDerPol { }`.
    pub name: String,
    /// The problem's documentation, one string of lines.
    pub doc: String,
    /// How the spec is called in messages: a file's path as the user wrote it.
    pub source: String,
    /// `true` when the spec says `maximize`: kernels hold the negated terms, reports negate back.
    pub maximize: bool,
    /// The unit in which the objective is reported.
    pub objective_unit: Unit,
    /// What everything is a function of.
    pub independent: Independent,
    /// Parameters, in the order in which they were declared; their values form one flat vector.
    pub parameters: Vec<Parameter>,
    /// Tables, addressed by number in kernels.
    pub tables: Vec<Table>,
    /// Outputs of which members have coefficients in common.
    pub shared: Vec<Shared>,
    /// Free numbers that are constant in time.
    pub variables: Vec<Variable>,
    /// Independent timelines; a problem without agents has one, unnamed.
    pub agents: Vec<Agent>,
    /// Phases of all agents, each agent's in order of time.
    pub phases: Vec<Phase>,
    /// Places that differ from member to member of a loop.
    pub places: Vec<Places>,
    /// The shapes of the kernels.
    pub kernels: Vec<Kernel>,
    /// Which kernel is called where, and what becomes of its rows.
    pub groups: Vec<Group>,
    /// Costs and constraints as the spec writes them, for reports, where helpers stand for corners in `groups`.
    pub shown: Vec<Group>,
    /// Where tables of limits are evaluated, for reports: between the points, limits are looked at where the arguments pass
    /// nodes.
    pub arguments: Vec<Arguments>,
    /// Where a gradient may jump in what is solved, but for corners of `relaxations`.
    pub corners: Vec<Place>,
    /// Equations with corners for which helpers stand.
    pub relaxations: Vec<Relaxation>,
    /// Terms of the objective, for reports.
    pub terms: Vec<Term>,
    /// What was measured: parts of terms whose residuals are reported.
    pub measurements: Vec<Measurement>,
    /// Constraints as the user wrote them, for reports.
    pub constraints: Vec<Constraint>,
    /// The constraints, by number, that bound the norm of a vector, times or over smooth factors: a solver poses their
    /// squares (docs/maths.md, section 11.14).
    pub norms: Vec<usize>,
    /// The outputs that formulas know by their sines and cosines alone: a solver turns them by little at once
    /// (docs/maths.md, section 11.15).
    pub angles: Vec<Angle>,
    /// Integrals that enter a function nonlinearly: each is a variable with a defining row.
    pub integrals: Vec<Integral>,
    /// Named expressions.
    pub named: Vec<Named>,
    /// Initial guesses, in the order of the spec.
    pub guesses: Vec<Guess>,
    /// Parameters that are solved for in turn.
    pub continuations: Vec<Continuation>,
}

impl Structure {
    /// Gives a parameter these values, in SI units, in the memory that it has where their number is the same.
    ///
    /// # Panics
    /// There is no such parameter.
    pub fn set_parameter(&mut self, parameter: usize, value: &[f64]) {
        self.parameters[parameter].value.clear();
        self.parameters[parameter].value.extend_from_slice(value);
    }

    /// Poses an equation with corners as it is written, or with helpers.
    ///
    /// # Panics
    /// There is no such relaxation.
    pub fn pose(&mut self, relaxation: usize, is_exact: bool) {
        let own = &mut self.relaxations[relaxation];
        if std::mem::replace(&mut own.is_exact, is_exact) == is_exact {
            return;
        }
        let (one, other) = (own.equation, own.other);
        for row in self.groups.iter_mut().flat_map(|group| &mut group.rows) {
            if let Row::Constraint { constraint, .. } | Row::Part { constraint, .. } = row {
                *constraint = match *constraint {
                    own if own == one => other,
                    own if own == other => one,
                    own => own,
                };
            }
        }
    }

    /// Where a gradient may jump in what is posed.
    pub fn corners_posed(&self) -> impl Iterator<Item = &Place> {
        let exact = self.relaxations.iter().filter(|own| own.is_exact);
        self.corners.iter().chain(exact.flat_map(|own| &own.corners))
    }

    /// Whether a constraint is posed: all are but equations in their other form, and what holds helpers beside their corners where
    /// no equation has them, or at 0 where one has.
    pub fn is_posed(&self, constraint: usize) -> bool {
        let mut is_needed = None;
        for own in &self.relaxations {
            if own.other == constraint {
                return false;
            }
            for helper in &own.helpers {
                if helper.at_zero == constraint && !own.is_exact {
                    return false;
                }
                if helper.sides.contains(&constraint) || helper.bounds.contains(&constraint) {
                    is_needed = Some(is_needed == Some(true) || !own.is_exact);
                }
            }
        }
        is_needed != Some(false)
    }

    /// A group by its number: those of `groups`, then those of `shown`.
    pub fn group(&self, number: usize) -> &Group {
        self.groups.get(number).unwrap_or_else(|| &self.shown[number - self.groups.len()])
    }

    /// The terms that reports evaluate by `shown`.
    pub fn terms_shown(&self) -> Vec<bool> {
        let mut shown = vec![false; self.terms.len()];
        for row in self.shown.iter().flat_map(|group| &group.rows) {
            if let Row::Cost { term } = row
                && let Some(shown) = shown.get_mut(*term)
            {
                *shown = true;
            }
        }
        shown
    }

    /// The constraints that reports evaluate by `shown`.
    pub fn constraints_shown(&self) -> Vec<bool> {
        let mut shown = vec![false; self.constraints.len()];
        for row in self.shown.iter().flat_map(|group| &group.rows) {
            if let Row::Constraint { constraint, .. } | Row::Part { constraint, .. } = row
                && let Some(shown) = shown.get_mut(*constraint)
            {
                *shown = true;
            }
        }
        shown
    }
}

/// Whether a name is that of a helper of the compiler: no name in a spec has a parenthesis.
pub fn is_helper(name: &str) -> bool {
    name.contains('(')
}
