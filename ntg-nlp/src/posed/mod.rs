//! Rows that are posed in another form with the same solutions, in which Newton steps lead further.
//!
//! ```text
//! mod         the program with all of them; what comes back is that of the program itself
//!   squares   norms as squares
//!   durations rows over durations that may vanish, times powers of them
//! ```

mod durations;
mod squares;

use crate::contract::{Block, Evaluation, Limits, Nlp, NotFinite};
use crate::erased::{Buffers, Erased, Program};
use crate::outcome::{Multipliers, Outcome, Start};
use crate::status::{Bounded, Status};
use durations::Durations;
pub(crate) use durations::Form;
use squares::{Squares, root};
use std::sync::{Mutex, PoisonError};

/// The program with rows in other forms.
pub(crate) struct Posed<'a> {
    nlp: &'a Erased<'a>,
    limits: Limits,
    /// The blocks with room for more second derivatives; empty where they are those of the program.
    blocks: Vec<Block>,
    squares: Squares,
    durations: Durations,
    /// The multipliers of the program's rows in an evaluation.
    multipliers: Mutex<Vec<f64>>,
}

impl<'a> Posed<'a> {
    /// The program in the forms that are meant for a start; none where all rows stay what they are.
    pub(crate) fn of(nlp: &'a Erased<'a>, start: &[f64], form: Form) -> Option<Self> {
        let mut blocks = vec![];
        let squares = Squares::of(nlp, start);
        let norms = squares.norms.iter().map(|norm| norm.row).collect();
        let durations = Durations::of(nlp, (form, &norms), &mut blocks);
        if squares.norms.is_empty() && durations.is_empty() {
            return None;
        }
        let mut limits = nlp.limits().clone();
        limits.row_scale.resize(nlp.rows(), 1.0);
        squares.bound(&mut limits);
        durations.bound(&mut limits);
        Some(Self { nlp, limits, blocks, squares, durations, multipliers: Mutex::new(vec![0.0; nlp.rows()]) })
    }

    /// What a start knows, of the posed rows; `with` solves from there. The outcome is that of the program itself.
    pub(crate) fn solve(
        &self,
        start: &[f64],
        from: Start<'_>,
        with: impl FnOnce(&Erased<'_>, Start<'_>) -> Outcome,
    ) -> Outcome {
        let mut rows: Vec<f64>;
        let from = match from {
            Start::Warm(multipliers) if multipliers.rows.len() == self.nlp.rows() => {
                rows = multipliers.rows.to_vec();
                self.slopes(start, |row, slope| rows[row] /= slope);
                Start::Warm(Multipliers { rows: &rows, ..multipliers })
            }
            from => from,
        };
        let outcome = with(&Erased::of(self), from);
        self.unposed(start, outcome)
    }

    /// How posed rows grow with those of the program at a point; norms not at all where that has no values.
    fn slopes(&self, x: &[f64], mut each: impl FnMut(usize, f64)) {
        let (mut work, mut at) = self.nlp.workspace();
        if self.nlp.values(x, &mut work, &mut at).is_ok() {
            self.squares.slopes(self.nlp.limits(), &at.rows).for_each(|(row, slope)| each(row, slope));
        }
        self.durations.slopes(x).for_each(|(row, slope)| each(row, slope));
    }

    fn unposed(&self, start: &[f64], mut outcome: Outcome) -> Outcome {
        let Outcome { x, row_multipliers, row_factors, status, .. } = &mut outcome;
        self.slopes(x, |row, slope| {
            row_multipliers[row] *= slope;
            row_factors[row] *= slope;
        });
        // What a row over durations that have become short is missed by counts as it did at the start.
        self.durations.counted(start, x).for_each(|(row, counted)| row_factors[row] *= counted);
        if status.has_solution() && !self.durations.hold(self.nlp, x, row_factors) {
            *status = Status::StepTooSmall;
        }
        let is_norm = |of: Bounded| self.squares.norms.iter().any(|norm| of == Bounded::Row(norm.row));
        match status {
            Status::Infeasible { rows } => {
                for missed in rows.iter_mut().filter(|missed| is_norm(missed.of)) {
                    (missed.value, missed.bound) = (root(missed.value), root(missed.bound));
                    missed.violation = (missed.value - missed.bound).abs();
                }
                for (row, slope, bound) in self.durations.bounds(self.nlp.limits(), x) {
                    for missed in rows.iter_mut().filter(|missed| missed.of == Bounded::Row(row)) {
                        (missed.value, missed.bound) = (missed.value / slope + bound, bound);
                        missed.violation /= slope;
                    }
                }
            }
            Status::Contradiction { bounds } => {
                for crossing in bounds.iter_mut().filter(|crossing| is_norm(crossing.of)) {
                    (crossing.lower, crossing.upper) = (root(crossing.lower), root(crossing.upper));
                }
            }
            _ => {}
        }
        outcome
    }
}

/// Which rows are the value of one function of one element.
fn sole_rows<N: Nlp>(nlp: &N) -> Vec<bool> {
    let mut count = vec![0_usize; nlp.rows()];
    let targets = nlp.blocks().iter().flat_map(|block| &block.target);
    targets.filter_map(|target| target.row()).for_each(|row| count[row] += 1);
    count.into_iter().map(|count| count == 1).collect()
}

impl Program for Posed<'_> {
    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn blocks(&self) -> &[Block] {
        if self.blocks.is_empty() { self.nlp.blocks() } else { &self.blocks }
    }

    fn globals(&self) -> usize {
        self.nlp.globals()
    }

    fn workspace(&self) -> (Buffers, Evaluation) {
        let (work, mut at) = self.nlp.workspace();
        for (values, block) in at.blocks.iter_mut().zip(&self.blocks) {
            values.hessian.resize(block.hessian.len() * block.elements, 0.0);
        }
        (work, at)
    }

    fn values(&self, x: &[f64], work: &mut Buffers, out: &mut Evaluation) -> Result<(), NotFinite> {
        self.nlp.values(x, work, out)?;
        self.squares.pose_values(self.blocks(), out);
        self.durations.pose_values(self.blocks(), x, out);
        Ok(())
    }

    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Buffers,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite> {
        let mut own = self.multipliers.lock().unwrap_or_else(PoisonError::into_inner);
        own.copy_from_slice(multipliers);
        if !self.squares.norms.is_empty() {
            self.nlp.values(x, work, out)?;
            self.squares.multipliers(&out.rows, &mut own);
        }
        self.durations.multipliers(x, &mut own);
        self.durations.clear(self.blocks(), out);
        self.nlp.derivatives(x, objective_weight, &own, work, out)?;
        drop(own);
        self.squares.pose_derivatives(self.blocks(), multipliers, out);
        self.squares.pose_values(self.blocks(), out);
        self.durations.pose_derivatives(self.blocks(), x, multipliers, out);
        self.durations.pose_values(self.blocks(), x, out);
        Ok(())
    }
}
