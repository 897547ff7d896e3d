//! The whole program in scaled variables, with its elements ready for work and its condensed matrix
//! (docs/maths.md, sections 5 and 11).
//!
//! ```text
//! x = D s,   rows = R c,   objective = w f
//! ```
//!
//! The *functions* of a program are numbered: the rows, then the objective (at [`System::objective`]), then one unused
//! function, to which padding refers, then the variables (from [`System::first_variable`] on). A bound on a variable is
//! thus a bound on a function whose derivative is 1. Vectors by variable end with one padding entry, which is 0.

use super::columns::{COLUMNS, Columns};
use super::elements::{Curvature, Elements, Held, Refinement, Rows, Weights};
use super::factor::{Factor, Regularised};
use super::ordering::Cliques;
use super::pattern::Pattern;
use super::storage::{BLOCK, Storage};
use super::supports::Supports;
use super::unknowns::Unknowns;
use crate::contract::{Block, Evaluation, Nlp, NotFinite};
use crate::options::Scaling;
use crate::scaling::{Scales, Slopes, beside, variation};
use std::sync::Arc;

/// A program, the symbolic analysis of its matrix, and its derivatives at the latest point. `W` is the program's
/// workspace.
pub(crate) struct System<W> {
    /// The patterns of the blocks that were analysed.
    patterns: Vec<Pattern>,
    elements: Elements,
    unknowns: Unknowns,
    storage: Storage,
    pub(crate) scales: Scales,
    /// The unfactorised matrix.
    matrix: Vec<f64>,
    /// The convexifying term: what makes every element of the matrix positive semidefinite.
    convexification: Vec<f64>,
    factor: Factor,
    workspace: W,
    /// Derivatives of the elements at the latest point.
    latest: Evaluation,
    /// Values at a trial point, and derivatives where the trial point was evaluated speculatively.
    trial: Evaluation,
    /// The point of the last evaluation, in the program's own units.
    x: Vec<f64>,
    /// Multipliers of rows in the program's own units.
    weights: Vec<f64>,
    /// Right-hand side and solution, by unknown.
    right_hand_side: Vec<f64>,
    /// The same for several right-hand sides, filled up; empty before the first.
    columns: Vec<Columns>,
    /// What the scales were chosen from; none where the program has changed since.
    scaled_by: Option<ScaledBy>,
}

/// What scales are chosen from.
struct ScaledBy {
    /// The scaled point.
    point: Vec<f64>,
    rule: Scaling,
    /// The sizes of the rows that the program gave.
    row_sizes: Vec<f64>,
    row_weights: Vec<f64>,
}

impl<W> System<W> {
    /// Analyses a program: supports, border rows, order of elimination, storage of the matrix. Variables that are `held`
    /// meet no other unknown.
    pub(crate) fn new<N: Nlp<Workspace = W>>(nlp: &N, held: Vec<bool>) -> Self {
        let (n, m) = (nlp.variables(), nlp.rows());
        let sizes = Scales::sizes(nlp.limits());
        let supports: Vec<Arc<Supports>> = nlp.blocks().iter().map(|block| Arc::new(Supports::new(block))).collect();
        let unknowns = Unknowns::new(nlp, &supports, held);
        let mut elements = Elements::new(nlp.blocks(), &supports, &unknowns, &sizes);
        let mut cliques = Cliques::default();
        elements.cliques(&unknowns, |list| cliques.add(list));
        let storage = Storage::new(n + unknowns.bordered.len(), nlp.globals()..n, &cliques);
        elements.locate(&unknowns, &storage);
        let (workspace, latest) = nlp.workspace();
        Self {
            patterns: nlp.blocks().iter().map(Pattern::of).collect(),
            elements,
            scales: Scales { variables: sizes, rows: vec![1.0; m], objective: 1.0, by_bounds: false },
            matrix: vec![0.0; storage.len],
            convexification: vec![0.0; storage.len],
            factor: Factor::new(&storage),
            right_hand_side: vec![0.0; storage.unknowns],
            workspace,
            trial: latest.clone(),
            latest,
            x: vec![0.0; n],
            weights: vec![0.0; m],
            columns: vec![],
            scaled_by: None,
            unknowns,
            storage,
        }
    }

    /// The system of a program. The analysis of `earlier` is used again where the patterns are the same; where the
    /// program `is_unchanged` but for limits, all of `earlier` is.
    pub(crate) fn for_program<N: Nlp<Workspace = W>>(
        earlier: Option<Self>,
        nlp: &N,
        is_unchanged: bool,
        held: Vec<bool>,
    ) -> Self {
        match earlier.filter(|system| system.unknowns.held == held) {
            Some(system) if is_unchanged && system.scales.variables == Scales::sizes(nlp.limits()) => system,
            Some(system) if is_unchanged || system.fits(nlp) => system.refit(nlp, is_unchanged),
            _ => Self::new(nlp, held),
        }
    }

    /// Whether a program has the patterns that were analysed.
    fn fits<N: Nlp<Workspace = W>>(&self, nlp: &N) -> bool {
        let same = |(pattern, block): (&Pattern, &Block)| pattern.is_of(block);
        (self.x.len(), self.weights.len()) == (nlp.variables(), nlp.rows())
            && self.patterns.len() == nlp.blocks().len()
            && self.patterns.iter().zip(nlp.blocks()).all(same)
    }

    /// The same analysis with the numbers of another program, whose workspace holds its data, or with other sizes.
    fn refit<N: Nlp<Workspace = W>>(mut self, nlp: &N, is_unchanged: bool) -> Self {
        let sizes = Scales::sizes(nlp.limits());
        self.elements.refill(nlp.blocks(), &sizes);
        self.scales =
            Scales { variables: sizes, rows: vec![1.0; self.weights.len()], objective: 1.0, by_bounds: false };
        if !is_unchanged {
            (self.workspace, _) = nlp.workspace();
        }
        self.scaled_by = None;
        self
    }

    /// The number of the objective among the functions.
    pub(crate) fn objective(&self) -> usize {
        self.weights.len()
    }

    /// The number of the first variable among the functions.
    pub(crate) fn first_variable(&self) -> usize {
        self.weights.len() + 2
    }

    /// How many functions there are.
    pub(crate) fn functions(&self) -> usize {
        self.first_variable() + self.x.len()
    }

    /// Chooses the scales of rows and objective by the slopes at a scaled point.
    pub(crate) fn choose_scales<N: Nlp<Workspace = W>>(
        &mut self,
        nlp: &N,
        scaled: &[f64],
        scaling: Scaling,
    ) -> Result<(), NotFinite> {
        self.unscale(nlp, scaled);
        self.weights.fill(0.0);
        nlp.derivatives(&self.x, 1.0, &self.weights, &mut self.workspace, &mut self.latest)?;
        let limits = nlp.limits();
        let (rows, weights) = (&limits.row_scale, &limits.row_weight);
        let same_rows = |by: &ScaledBy| by.row_sizes == *rows && by.row_weights == *weights;
        let same = |by: &ScaledBy| by.point == scaled && by.rule == scaling && same_rows(by);
        if self.scaled_by.as_ref().is_some_and(same) {
            self.elements.load(&self.latest.blocks);
            return Ok(());
        }
        let plain = Scales { rows: vec![1.0; self.weights.len()], objective: 1.0, ..self.scales.clone() };
        self.set_scales(nlp, plain);
        let slopes = self.slopes_beside(nlp);
        let slopes = self.slopes(nlp).beside(slopes, nlp, (&self.latest, &self.x));
        self.set_scales(nlp, Scales::from_slopes(nlp.limits(), scaling, &slopes));
        let (row_sizes, row_weights) = (rows.clone(), weights.clone());
        self.scaled_by = Some(ScaledBy { point: scaled.to_vec(), rule: scaling, row_sizes, row_weights });
        Ok(())
    }

    /// Moves to a point in the program's own units with the multipliers of its rows, and chooses scales by the slopes and
    /// the curvature there: one evaluation.
    pub(crate) fn at_solution<N: Nlp<Workspace = W>>(
        &mut self,
        nlp: &N,
        x: &[f64],
        row_multipliers: &[f64],
    ) -> Result<(), NotFinite> {
        let limits = nlp.limits();
        for (j, own) in self.x.iter_mut().enumerate() {
            *own = x[j].max(limits.lower[j]).min(limits.upper[j]);
        }
        self.weights.iter_mut().zip(row_multipliers).for_each(|(weight, y)| *weight = -y);
        nlp.derivatives(&self.x, 1.0, &self.weights, &mut self.workspace, &mut self.latest)?;
        let plain = Scales { rows: vec![1.0; self.weights.len()], objective: 1.0, ..self.scales.clone() };
        self.set_scales(nlp, plain);
        let mut rows = vec![0.0; self.weights.len() + 2];
        self.elements.slopes(&mut rows);
        rows.truncate(self.weights.len());
        let sizes = &self.scales.variables;
        let variation = variation(nlp.blocks(), &self.latest, sizes);
        let slopes = Slopes { rows, amplification: vec![], variation }.at_solution(nlp, &self.latest, sizes);
        let scales = Scales::from_slopes(limits, Scaling::Automatic, &slopes);
        let second = self.latest.blocks.iter_mut().flat_map(|block| &mut block.hessian);
        second.for_each(|entry| *entry *= scales.objective);
        self.set_scales(nlp, scales);
        self.scaled_by = None;
        Ok(())
    }

    fn set_scales<N: Nlp<Workspace = W>>(&mut self, nlp: &N, scales: Scales) {
        self.elements.scale(nlp.blocks(), &scales);
        self.elements.load(&self.latest.blocks);
        self.scales = scales;
    }

    /// The slopes beside the latest point; none where the program has no derivatives there.
    fn slopes_beside<N: Nlp<Workspace = W>>(&mut self, nlp: &N) -> Option<Slopes> {
        let start = self.x.clone();
        beside(&start, nlp.limits(), &self.scales.variables, &mut self.x);
        let probe = nlp.derivatives(&self.x, 1.0, &self.weights, &mut self.workspace, &mut self.trial);
        self.x = start;
        probe.ok()?;
        std::mem::swap(&mut self.latest, &mut self.trial);
        let slopes = self.slopes(nlp);
        std::mem::swap(&mut self.latest, &mut self.trial);
        Some(slopes)
    }

    /// The slopes at the latest point, with row factors of 1.
    fn slopes<N: Nlp<Workspace = W>>(&mut self, nlp: &N) -> Slopes {
        self.elements.load(&self.latest.blocks);
        let m = self.weights.len();
        let mut rows = vec![0.0; m + 2];
        self.elements.slopes(&mut rows);
        if !self.unknowns.bordered.is_empty() {
            let multipliers = vec![0.0; self.functions()];
            self.assemble(Weights { sigma: &multipliers, curvature: Curvature::None });
            self.unknowns.bordered.iter().for_each(|&row| rows[row] = 0.0);
            self.elements.border_slopes(&self.unknowns, &self.matrix, &mut rows);
        }
        rows.truncate(m);
        Slopes::of_rows(rows, nlp.limits(), nlp.blocks(), &self.latest, &self.scales.variables)
    }

    /// Raises entries of `out`, one a function, to the largest slopes of the scaled functions at the latest point by a
    /// scaled variable. Those of border rows are left.
    pub(crate) fn scaled_slopes(&mut self, out: &mut [f64]) {
        self.elements.slopes(out);
    }

    /// Writes a point in the program's own units, within the bounds to the last bit.
    fn unscale<N: Nlp<Workspace = W>>(&mut self, nlp: &N, scaled: &[f64]) {
        let limits = nlp.limits();
        for (j, x) in self.x.iter_mut().enumerate() {
            *x = (scaled[j] * self.scales.variables[j]).max(limits.lower[j]).min(limits.upper[j]);
        }
    }

    /// A scaled point in the program's own units.
    pub(crate) fn unscaled<N: Nlp<Workspace = W>>(&mut self, nlp: &N, scaled: &[f64]) -> &[f64] {
        self.unscale(nlp, scaled);
        &self.x
    }

    /// Writes the values of all functions at a scaled point.
    pub(crate) fn values<N: Nlp<Workspace = W>>(
        &mut self,
        nlp: &N,
        scaled: &[f64],
        out: &mut [f64],
    ) -> Result<(), NotFinite> {
        self.unscale(nlp, scaled);
        nlp.values(&self.x, &mut self.workspace, &mut self.trial)?;
        self.copy_values(&self.trial, scaled, out);
        Ok(())
    }

    /// Moves to a scaled point: writes the values of all functions, and computes the derivatives that the products and
    /// the matrix below need, the second ones weighted by the multipliers of all functions (of the objective, -1 or 0).
    pub(crate) fn derivatives<N: Nlp<Workspace = W>>(
        &mut self,
        nlp: &N,
        scaled: &[f64],
        multipliers: &[f64],
        out: &mut [f64],
    ) -> Result<(), NotFinite> {
        self.speculative_derivatives(nlp, scaled, multipliers, out)?;
        self.accept_speculative();
        Ok(())
    }

    /// As [`System::derivatives`] for a trial point: products and matrix stay those of the latest point until
    /// [`System::accept_speculative`].
    pub(crate) fn speculative_derivatives<N: Nlp<Workspace = W>>(
        &mut self,
        nlp: &N,
        scaled: &[f64],
        multipliers: &[f64],
        out: &mut [f64],
    ) -> Result<(), NotFinite> {
        self.unscale(nlp, scaled);
        for ((weight, multiplier), factor) in self.weights.iter_mut().zip(multipliers).zip(&self.scales.rows) {
            *weight = -multiplier * factor;
        }
        let weight = -multipliers[self.objective()] * self.scales.objective;
        nlp.derivatives(&self.x, weight, &self.weights, &mut self.workspace, &mut self.trial)?;
        self.copy_values(&self.trial, scaled, out);
        Ok(())
    }

    /// Moves to the point of [`System::speculative_derivatives`], which must be the last that was evaluated.
    pub(crate) fn accept_speculative(&mut self) {
        std::mem::swap(&mut self.latest, &mut self.trial);
        self.elements.load(&self.latest.blocks);
    }

    /// Writes the values of all functions at the latest point, whose scaled variables are `scaled`.
    pub(crate) fn latest_values(&self, scaled: &[f64], out: &mut [f64]) {
        self.copy_values(&self.latest, scaled, out);
    }

    fn copy_values(&self, from: &Evaluation, scaled: &[f64], out: &mut [f64]) {
        for ((out, row), factor) in out.iter_mut().zip(&from.rows).zip(&self.scales.rows) {
            *out = row * factor;
        }
        out[self.objective()] = self.scales.objective * from.objective;
        out[self.first_variable()..].copy_from_slice(&scaled[..self.x.len()]);
    }

    /// Marks the functions that are equalities, for the products that concern equalities only.
    pub(crate) fn mark_equalities(&mut self, equalities: impl Iterator<Item = usize>) {
        let mut is_equality = vec![false; self.functions()];
        equalities.for_each(|function| is_equality[function] = true);
        self.elements.mark_equalities(&is_equality);
    }

    /// Writes `J^T multipliers`, the sum over functions of multiplier times gradient; `out` has one entry a variable
    /// and the padding entry.
    pub(crate) fn transposed_product(&mut self, multipliers: &[f64], out: &mut [f64]) {
        self.transposed_product_of(Rows::All, multipliers, out);
    }

    /// As [`System::transposed_product`], where only equalities have multipliers.
    pub(crate) fn transposed_product_of_equalities(&mut self, multipliers: &[f64], out: &mut [f64]) {
        self.transposed_product_of(Rows::Equalities, multipliers, out);
    }

    fn transposed_product_of(&mut self, rows: Rows, multipliers: &[f64], out: &mut [f64]) {
        let n = self.x.len();
        out[..n].copy_from_slice(&multipliers[self.first_variable()..]);
        out[n] = 0.0;
        self.elements.transposed_product(rows, multipliers, out);
        out[n] = 0.0;
    }

    /// Writes `J direction`, the change of all functions along a direction, which ends with the padding entry.
    pub(crate) fn product(&mut self, direction: &[f64], out: &mut [f64]) {
        self.product_of(Rows::All, direction, out);
    }

    /// As [`System::product`], where only the change of equalities is needed; the other entries are undefined.
    pub(crate) fn product_of_equalities(&mut self, direction: &[f64], out: &mut [f64]) {
        self.product_of(Rows::Equalities, direction, out);
    }

    fn product_of(&mut self, rows: Rows, direction: &[f64], out: &mut [f64]) {
        let first = self.first_variable();
        out[..first].fill(0.0);
        self.elements.product(rows, direction, out);
        out[first..].copy_from_slice(&direction[..self.x.len()]);
    }

    /// Builds the matrix at the latest point. Border rows need [`System::set_border_diagonal`] besides.
    pub(crate) fn assemble(&mut self, weights: Weights<'_>) {
        self.storage.clear(&mut self.matrix);
        self.elements.assemble(weights, &mut self.matrix);
        for (variable, weight) in weights.sigma[self.first_variable()..].iter().enumerate() {
            self.matrix[self.storage.position(variable, variable)] += weight;
        }
        // What nothing depends on stays where it is, and makes no matrix singular.
        for &variable in &self.unknowns.unused {
            self.matrix[self.storage.position(variable as usize, variable as usize)] += 1.0;
        }
    }

    /// Computes the convexifying term. Precondition: [`System::assemble`] with the same `sigma`.
    pub(crate) fn convexify(&mut self, sigma: &[f64]) {
        self.convexification.fill(0.0);
        self.elements.convexify(sigma, &mut self.convexification);
    }

    /// Writes `C direction` with the convexifying term `C`, by variable; the padding entry becomes 0.
    pub(crate) fn convexification_product(&self, direction: &[f64], out: &mut [f64]) {
        let padded = &self.storage.padded[..self.x.len()];
        let mut along = vec![0.0; BLOCK * self.storage.columns()];
        let mut product = along.clone();
        padded.iter().zip(direction).for_each(|(&at, d)| along[at] = *d);
        self.storage.add_product(&self.convexification, &along, &mut product);
        out.fill(0.0);
        out.iter_mut().zip(padded).for_each(|(out, &at)| *out = product[at]);
    }

    /// Sets the diagonal entry of a border row to `-compliance`.
    pub(crate) fn set_border_diagonal(&mut self, border: usize, compliance: f64) {
        let unknown = self.unknowns.variables + border;
        self.matrix[self.storage.position(unknown, unknown)] = -compliance;
    }

    /// Factorises the matrix plus a fraction of the convexifying term and a shift of the variables' diagonal; whether
    /// its inertia is that of a minimum.
    pub(crate) fn factorise(&mut self, fraction: f64, shift: f64) -> bool {
        let negative = self.unknowns.bordered.len();
        self.factorise_any(fraction, shift, negative) == Some(negative)
    }

    /// As [`System::factorise`], whatever the inertia is, as long as not more than `most` pivots are negative; how many are.
    pub(crate) fn factorise_any(&mut self, fraction: f64, shift: f64, most: usize) -> Option<usize> {
        let convexification = if fraction == 0.0 { &[][..] } else { &self.convexification };
        let sum =
            Regularised { matrix: &self.matrix, convexification, fraction, shift, variables: self.unknowns.variables };
        self.factor.factorise(&self.storage, &sum, most)
    }

    /// Replaces the right-hand side, by variable and by border row, by the solution.
    pub(crate) fn solve(&mut self, variables: &mut [f64], rows: &mut [f64]) {
        let (first, second) = self.right_hand_side.split_at_mut(self.unknowns.variables);
        first.copy_from_slice(&variables[..self.unknowns.variables]);
        second.copy_from_slice(rows);
        self.factor.solve(&self.storage, &mut self.right_hand_side);
        let (first, second) = self.right_hand_side.split_at(self.unknowns.variables);
        variables[..self.unknowns.variables].copy_from_slice(first);
        rows.copy_from_slice(second);
    }

    /// As [`System::solve`], for several right-hand sides.
    pub(crate) fn solve_columns(&mut self, variables: &mut [Columns], rows: &mut [Columns]) {
        self.columns.clear();
        self.columns.resize(BLOCK * self.storage.columns(), Columns::default());
        let unknowns = || variables.iter().take(self.unknowns.variables).chain(&*rows);
        for (value, &padded) in unknowns().zip(&self.storage.padded) {
            self.columns[padded] = *value;
        }
        self.factor.solve_columns(&self.storage, &mut self.columns);
        let unknowns = variables.iter_mut().take(self.unknowns.variables).chain(rows);
        for (value, &padded) in unknowns.zip(&self.storage.padded) {
            *value = self.columns[padded];
        }
    }

    /// What a step leaves of residuals; bounds of variables are functions whose derivative is 1, and count as condensed.
    pub(crate) fn refine(&mut self, to: &mut Refinement<'_>) {
        self.elements.refine(to);
        let first = self.first_variable();
        for (j, (step, pull)) in to.step.iter().zip(&mut *to.pull).take(self.x.len()).enumerate() {
            if to.held[first + j] != Held::No {
                let left = &mut to.rows[first + j];
                for k in 0..COLUMNS {
                    left[k] -= step[k];
                    pull[k] += to.penalty * left[k];
                }
            }
        }
    }

    /// The point of the last evaluation, in the program's own units, whether or not that evaluation succeeded.
    pub(crate) fn last_point(&self) -> &[f64] {
        &self.x
    }

    /// Which variables meet no other unknown.
    pub(crate) fn held(&self) -> &[bool] {
        &self.unknowns.held
    }

    /// The rows of the program that are unknowns of the border.
    pub(crate) fn border_rows(&self) -> &[usize] {
        &self.unknowns.bordered
    }

    /// The derivatives of the elements and the rows at the latest point, in the program's own units.
    pub(crate) fn latest(&self) -> &Evaluation {
        &self.latest
    }
}
