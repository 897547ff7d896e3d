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
use crate::options::Options;
use crate::outcome::{Multipliers, Outcome, Start};
use crate::scaling::row_factors;
use crate::status::{Bounded, Status};
use durations::Durations;
use squares::{Squares, root};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// How often a program is posed again with shorter durations. A choice.
const SHORTER: usize = 3;
/// How long each such solve may take. A choice: it begins at a solution but for some rows.
const AGAIN: usize = 100;

/// The program with rows in other forms.
pub(crate) struct Posed<'a> {
    nlp: &'a Erased<'a>,
    limits: Limits,
    /// The blocks with room for more second derivatives; empty where they are those of the program.
    blocks: Vec<Block>,
    squares: Squares,
    durations: Durations,
    /// How rows over durations grew with those of the program at the start.
    begun: Vec<(usize, f64)>,
    /// The multipliers of the program's rows in an evaluation.
    multipliers: Mutex<Vec<f64>>,
}

impl<'a> Posed<'a> {
    /// The program in the forms that are meant for a start; none where all rows stay what they are.
    pub(crate) fn of(nlp: &'a Erased<'a>, start: &[f64]) -> Option<Self> {
        let mut blocks = vec![];
        let squares = Squares::of(nlp, start);
        let norms = squares.norms.iter().map(|norm| norm.row).collect();
        let durations = Durations::of(nlp, &norms, &mut blocks);
        if squares.norms.is_empty() && durations.is_empty() {
            return None;
        }
        let mut limits = nlp.limits().clone();
        limits.row_scale.resize(nlp.rows(), 1.0);
        squares.bound(&mut limits);
        durations.bound(&mut limits);
        let (begun, multipliers) = (vec![], Mutex::new(vec![0.0; nlp.rows()]));
        Some(Self { nlp, limits, blocks, squares, durations, begun, multipliers })
    }

    /// Solves the posed program by `with`, and again where a duration has become so short that its rows do not hold by the
    /// slopes that they have themselves. The outcome is that of the program itself.
    pub(crate) fn solve(
        mut self,
        start: &[f64],
        from: Start<'_>,
        options: &Options,
        mut with: impl FnMut(&Erased<'_>, &[f64], Start<'_>, &Options) -> Outcome,
    ) -> Outcome {
        let began = Instant::now();
        let mut outcome = self.solve_once(start, from, |posed, from| with(posed, start, from, options));
        for round in 0..=SHORTER {
            let factors = self.durations.factors(&outcome, start);
            factors.iter().for_each(|(row, factor)| outcome.row_factors[*row] = *factor);
            let is_end = round == SHORTER || !outcome.status.has_solution();
            if is_end || self.durations.hold(self.nlp, &outcome.x, &factors) {
                break;
            }
            self.durations.shorten(&outcome.x);
            self.weigh(&outcome.x, &factors);
            let (left, from) = (options.after(began.elapsed()), Start::Warm(outcome.multipliers()));
            let most = options.max_iterations.saturating_sub(outcome.iterations).min(AGAIN);
            let left = Options { max_iterations: most, ..left };
            let next = self.solve_once(&outcome.x, from, |posed, from| with(posed, &outcome.x, from, &left));
            let (iterations, is_better) = (outcome.iterations + next.iterations, next.status.has_solution());
            outcome = if is_better { next } else { outcome };
            (outcome.iterations, outcome.seconds) = (iterations, began.elapsed().as_secs_f64());
            if !is_better {
                break;
            }
        }
        outcome
    }

    /// Weighs rows over durations so that they have these factors in a solve from `x`.
    fn weigh(&mut self, x: &[f64], factors: &[(usize, f64)]) {
        let mut weights = std::mem::take(&mut self.limits.row_weight);
        weights.resize(self.nlp.rows(), 1.0);
        let own = row_factors(&Erased::of(&*self), x);
        for ((row, factor), (_, slope)) in factors.iter().zip(self.durations.slopes(x)) {
            weights[*row] = factor / (slope * own[*row]);
        }
        self.limits.row_weight = weights;
    }

    /// What a start knows, of the posed rows; `with` solves from there. The outcome is that of the program itself.
    fn solve_once(
        &mut self,
        start: &[f64],
        from: Start<'_>,
        with: impl FnOnce(&Erased<'_>, Start<'_>) -> Outcome,
    ) -> Outcome {
        self.begun = self.durations.slopes(start).collect();
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
        self.unposed(outcome)
    }

    /// How posed rows grow with those of the program at a point; norms not at all where that has no values.
    fn slopes(&self, x: &[f64], mut each: impl FnMut(usize, f64)) {
        let (mut work, mut at) = self.nlp.workspace();
        if self.nlp.values(x, &mut work, &mut at).is_ok() {
            self.squares.slopes(self.nlp.limits(), &at.rows).for_each(|(row, slope)| each(row, slope));
        }
        self.durations.slopes(x).for_each(|(row, slope)| each(row, slope));
    }

    fn unposed(&self, mut outcome: Outcome) -> Outcome {
        let Outcome { x, row_multipliers, row_factors, status, .. } = &mut outcome;
        self.slopes(x, |row, slope| {
            row_multipliers[row] *= slope;
            row_factors[row] *= slope;
        });
        // What a row over durations that have become short is missed by counts as it did at the start.
        for ((row, begun), (_, slope)) in self.begun.iter().zip(self.durations.slopes(x)) {
            row_factors[*row] *= begun / slope;
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
