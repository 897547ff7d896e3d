//! A program whose objective is to stay near a point, and some of whose rows do not count
//! (docs/maths.md, equation 13.1).
//!
//! ```text
//! minimise over x   1/2 sum over variables of ((x_j - x0_j) / s_j)^2
//! subject to        the bounds of the variables and of the rows that are kept
//! ```
//!
//! Solved with elastic bounds at a price that makes the objective small beside any violation, it
//! gives the least sum of violations, and of all points with that sum the nearest one.

use crate::transcribe::layout::narrow;
use ntg_nlp::{Block, BlockValues, Evaluation, Limits, Nlp, NotFinite, Scales, Target};

/// What becomes of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Row {
    /// A definition or a joint: it gives way last.
    Firm,
    /// An equation of motion or a value that is simply fixed: it gives way where limits and targets do not help.
    Held,
    /// A limit or a target: it gives way first.
    Elastic,
    /// It does not count.
    Free,
}

impl Row {
    /// How much a violation counts. Powers of a number that is larger than the points of most trajectories: a limit
    /// that is violated all along gives way before an equation of motion that is violated at one point.
    pub(super) fn weight(self) -> f64 {
        match self {
            Self::Firm => 1e4,
            Self::Held => 1e2,
            Self::Elastic => 1.0,
            Self::Free => 0.0,
        }
    }
}

/// The program near a point.
pub(super) struct Nearest<'a, N: Nlp> {
    nlp: &'a N,
    limits: Limits,
    blocks: Vec<Block>,
    /// The point, and the sizes of the variables.
    x0: Vec<f64>,
    sizes: Vec<f64>,
}

impl<'a, N: Nlp> Nearest<'a, N> {
    /// `factors` make the rows comparable ([`ntg_nlp::scaling::row_factors`]).
    pub(super) fn new(nlp: &'a N, x0: &[f64], (rows, factors): (&[Row], &[f64])) -> Self {
        let mut limits = nlp.limits().clone();
        limits.row_weight = factors.to_vec();
        for (i, row) in rows.iter().enumerate() {
            match row {
                Row::Free => (limits.row_lower[i], limits.row_upper[i]) = (f64::NEG_INFINITY, f64::INFINITY),
                counted => limits.row_weight[i] *= counted.weight(),
            }
        }
        let sizes = Scales::sizes(&limits);
        let mut blocks = nlp.blocks().to_vec();
        for block in &mut blocks {
            // The objective of the program itself does not count.
            let own = block.weight.iter_mut().zip(&block.target).filter(|(_, to)| **to == Target::Objective);
            own.for_each(|(weight, _)| *weight = 0.0);
        }
        blocks.push(distances(x0, &sizes));
        Self { nlp, limits, blocks, x0: x0.to_vec(), sizes }
    }

    /// Adds the distance to what the program itself has computed.
    fn finish(&self, x: &[f64], inner: &Evaluation, out: &mut Evaluation) {
        out.rows.copy_from_slice(&inner.rows);
        for (to, from) in out.blocks.iter_mut().zip(&inner.blocks) {
            to.values.copy_from_slice(&from.values);
            to.jacobian.copy_from_slice(&from.jacobian);
            to.hessian.copy_from_slice(&from.hessian);
        }
        out.objective = 0.0;
        let Some(own) = out.blocks.last_mut() else { return };
        for (j, x) in x.iter().enumerate() {
            let distance = (x - self.x0[j]) / self.sizes[j];
            own.values[j] = 0.5 * distance * distance;
            own.jacobian[j] = distance;
            out.objective += own.values[j];
        }
    }
}

/// One element a variable: half the square of its distance.
fn distances(x0: &[f64], sizes: &[f64]) -> Block {
    let count = x0.len();
    Block {
        elements: count,
        slots: 1,
        rows: 1,
        jacobian: vec![(0, 0)],
        hessian: vec![(0, 0)],
        variable_start: (0..=count).collect(),
        variables: (0..count).map(narrow).collect(),
        map_start: (0..=count).collect(),
        map: sizes.iter().map(|size| 1.0 / size).collect(),
        offset: x0.iter().zip(sizes).map(|(x, size)| -x / size).collect(),
        target: vec![Target::Objective; count],
        weight: vec![1.0; count],
    }
}

impl<N: Nlp> Nlp for Nearest<'_, N> {
    type Workspace = (N::Workspace, Evaluation);

    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn globals(&self) -> usize {
        self.nlp.globals()
    }

    fn workspace(&self) -> (Self::Workspace, Evaluation) {
        let (work, inner) = self.nlp.workspace();
        let mut out = inner.clone();
        let zeros = || vec![0.0; self.x0.len()];
        out.blocks.push(BlockValues { values: zeros(), jacobian: zeros(), hessian: zeros() });
        ((work, inner), out)
    }

    fn values(&self, x: &[f64], work: &mut Self::Workspace, out: &mut Evaluation) -> Result<(), NotFinite> {
        let (work, inner) = work;
        self.nlp.values(x, work, inner)?;
        self.finish(x, inner, out);
        Ok(())
    }

    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Self::Workspace,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite> {
        let (work, inner) = work;
        self.nlp.derivatives(x, 0.0, multipliers, work, inner)?;
        self.finish(x, inner, out);
        if let Some(own) = out.blocks.last_mut() {
            own.hessian.fill(objective_weight);
        }
        Ok(())
    }
}
