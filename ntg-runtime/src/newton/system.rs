//! The whole program in scaled variables, with its elements ready for work and its condensed matrix
//! (docs/maths.md, sections 5 and 11).
//!
//! ```text
//! x = D s,   rows = R c,   objective = w f
//! ```
//!
//! A list with one entry for each *quantity* holds the rows, the objective (at [`System::objective`]),
//! one entry that nobody reads, and the variables (from [`System::first_variable`] on): a bound on a
//! variable is a row whose derivative is 1.

use super::carriers::Carriers;
use super::elements::{Curvature, Elements, Rows, Weights};
use super::factor::{Factor, Sum};
use super::order::Order;
use super::pattern::Pattern;
use super::shape::Shape;
use crate::nlp::{Block, Evaluation, Nlp, NotFinite, Scales, Slopes};
use crate::settings::Scaling;

/// A program, its plans, and its derivatives at the latest point. `W` is the program's workspace.
pub(super) struct System<W> {
    /// What the plans were made for.
    made_for: Vec<Pattern>,
    elements: Elements,
    pub(super) order: Order,
    pub(super) shape: Shape,
    pub(super) scales: Scales,
    /// The unfactorised matrix.
    matrix: Vec<f64>,
    /// What makes its elements convex.
    change: Vec<f64>,
    pub(super) factor: Factor,
    work: W,
    /// Element derivatives at the latest point.
    at: Evaluation,
    /// Values at a trial point, and derivatives where they were asked for.
    trial: Evaluation,
    /// A point in the program's own units.
    x: Vec<f64>,
    /// Multipliers of rows in the program's own units.
    weights: Vec<f64>,
    /// Right-hand side and solution, by unknown.
    side: Vec<f64>,
    /// The scaled point at which scales were chosen, by which rule and from which sizes of rows; none where the
    /// program has changed since.
    scaled_at: Option<(Vec<f64>, Scaling, Vec<f64>)>,
}

impl<W> System<W> {
    /// Plans a program whose limits have their scales.
    pub(super) fn new<N: Nlp<Workspace = W>>(nlp: &N) -> Self {
        let (n, m) = (nlp.variables(), nlp.rows());
        let sizes = Scales::sizes(nlp.limits());
        let carriers: Vec<Carriers> = nlp.blocks().iter().map(Carriers::new).collect();
        let order = Order::new(nlp, &carriers);
        let mut elements = Elements::new(nlp.blocks(), &carriers, &order, &sizes);
        let mut cliques: Vec<u32> = vec![];
        let mut ends = vec![0];
        elements.cliques(&order, |list| {
            cliques.extend_from_slice(list);
            ends.push(cliques.len());
        });
        let lists = ends.windows(2).map(|range| &cliques[range[0]..range[1]]);
        let shape = Shape::new(order.band, [order.border, order.bordered.len()], lists);
        elements.place(&order, &shape);
        let (work, at) = nlp.workspace();
        Self {
            made_for: nlp.blocks().iter().map(Pattern::of).collect(),
            elements,
            scales: Scales { variables: sizes, rows: vec![1.0; m], objective: 1.0 },
            matrix: vec![0.0; shape.len],
            change: vec![0.0; shape.len],
            factor: Factor::new(&shape),
            side: vec![0.0; shape.unknowns()],
            work,
            trial: at.clone(),
            at,
            x: vec![0.0; n],
            weights: vec![0.0; m],
            scaled_at: None,
            order,
            shape,
        }
    }

    /// The plans of a program, made again only where `earlier` was made for another one. `is_same`: it was made for
    /// this one.
    pub(super) fn for_program<N: Nlp<Workspace = W>>(earlier: Option<Self>, nlp: &N, is_same: bool) -> Self {
        match earlier {
            Some(system) if is_same && system.scales.variables == Scales::sizes(nlp.limits()) => system,
            Some(system) if system.fits(nlp) => system.refit(nlp),
            _ => Self::new(nlp),
        }
    }

    /// Whether the plans are those of a program, but for its numbers.
    fn fits<N: Nlp<Workspace = W>>(&self, nlp: &N) -> bool {
        let same = |(pattern, block): (&Pattern, &Block)| pattern.is_of(block);
        (self.x.len(), self.weights.len()) == (nlp.variables(), nlp.rows())
            && self.made_for.len() == nlp.blocks().len()
            && self.made_for.iter().zip(nlp.blocks()).all(same)
    }

    /// The plans with the numbers of another program. Its workspace holds its data.
    fn refit<N: Nlp<Workspace = W>>(mut self, nlp: &N) -> Self {
        let sizes = Scales::sizes(nlp.limits());
        self.elements.refill(nlp.blocks(), &sizes);
        self.scales = Scales { variables: sizes, rows: vec![1.0; self.weights.len()], objective: 1.0 };
        (self.work, _) = nlp.workspace();
        self.scaled_at = None;
        self
    }

    /// The quantity that is the objective.
    pub(super) fn objective(&self) -> usize {
        self.weights.len()
    }

    /// The quantity that is the first variable.
    pub(super) fn first_variable(&self) -> usize {
        self.weights.len() + 2
    }

    /// How many quantities there are.
    pub(super) fn quantities(&self) -> usize {
        self.first_variable() + self.x.len()
    }

    /// Chooses the scales of rows and objective by the slopes at a scaled point.
    pub(super) fn rescale<N: Nlp<Workspace = W>>(
        &mut self,
        nlp: &N,
        scaled: &[f64],
        scaling: Scaling,
    ) -> Result<(), NotFinite> {
        self.unscale(nlp, scaled);
        self.weights.fill(0.0);
        nlp.derivatives(&self.x, 1.0, &self.weights, &mut self.work, &mut self.at)?;
        let rows = &nlp.limits().row_scale;
        if self.scaled_at.as_ref().is_some_and(|(at, by, of)| *at == scaled && *by == scaling && of == rows) {
            self.elements.take(&self.at.blocks);
            return Ok(());
        }
        let plain = Scales { rows: vec![1.0; self.weights.len()], objective: 1.0, ..self.scales.clone() };
        self.set_scales(nlp, plain);
        let slopes = self.slopes();
        self.set_scales(nlp, Scales::from_slopes(nlp.limits(), scaling, &slopes));
        self.scaled_at = Some((scaled.to_vec(), scaling, rows.clone()));
        Ok(())
    }

    fn set_scales<N: Nlp<Workspace = W>>(&mut self, nlp: &N, scales: Scales) {
        self.elements.scale(nlp.blocks(), &scales);
        self.elements.take(&self.at.blocks);
        self.scales = scales;
    }

    /// The slopes at the latest point, with row factors of 1.
    fn slopes(&mut self) -> Slopes {
        let (m, n) = (self.weights.len(), self.x.len());
        let mut rows = vec![0.0; m + 2];
        self.elements.slopes(&mut rows);
        rows.truncate(m);
        let mut multipliers = vec![0.0; self.quantities()];
        self.assemble(Weights { sigma: &multipliers, curvature: Curvature::Exact });
        let columns = (0..n).map(|j| self.order.unknown[j] as usize);
        let curvature = columns.map(|u| self.matrix[self.shape.position(u, u)].abs()).fold(0.0, f64::max);
        for (row, slope) in rows.iter_mut().enumerate() {
            let Some(border) = self.order.border_row[row] else { continue };
            let unknown = self.order.band + self.order.border + border as usize;
            *slope = self.shape.row(unknown).map(|at| self.matrix[at].abs()).fold(0.0, f64::max);
        }
        multipliers[m] = 1.0;
        let mut gradient = vec![0.0; n + 1];
        self.gradient(&multipliers, &mut gradient);
        let objective = gradient[..n].iter().fold(0.0, |most: f64, g| most.max(g.abs()));
        Slopes { rows, objective, curvature }
    }

    /// Writes a point in the program's own units, within the bounds to the last bit.
    fn unscale<N: Nlp<Workspace = W>>(&mut self, nlp: &N, scaled: &[f64]) {
        let limits = nlp.limits();
        for (j, x) in self.x.iter_mut().enumerate() {
            *x = (scaled[j] * self.scales.variables[j]).max(limits.lower[j]).min(limits.upper[j]);
        }
    }

    /// A scaled point in the program's own units.
    pub(super) fn point<N: Nlp<Workspace = W>>(&mut self, nlp: &N, scaled: &[f64]) -> &[f64] {
        self.unscale(nlp, scaled);
        &self.x
    }

    /// Writes all quantities at a scaled point.
    pub(super) fn values<N: Nlp<Workspace = W>>(
        &mut self,
        nlp: &N,
        scaled: &[f64],
        out: &mut [f64],
    ) -> Result<(), NotFinite> {
        self.unscale(nlp, scaled);
        nlp.values(&self.x, &mut self.work, &mut self.trial)?;
        self.copy_quantities(&self.trial, scaled, out);
        Ok(())
    }

    /// Moves to a scaled point with multipliers of all quantities: all quantities, and derivatives
    /// for the methods below.
    pub(super) fn derivatives<N: Nlp<Workspace = W>>(
        &mut self,
        nlp: &N,
        scaled: &[f64],
        multipliers: &[f64],
        out: &mut [f64],
    ) -> Result<(), NotFinite> {
        self.derivatives_ahead(nlp, scaled, multipliers, out)?;
        self.move_ahead();
        Ok(())
    }

    /// As [`System::derivatives`], but the methods below stay with the latest point until
    /// [`System::move_ahead`].
    pub(super) fn derivatives_ahead<N: Nlp<Workspace = W>>(
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
        nlp.derivatives(&self.x, self.scales.objective, &self.weights, &mut self.work, &mut self.trial)?;
        self.copy_quantities(&self.trial, scaled, out);
        Ok(())
    }

    /// Moves to the point of [`System::derivatives_ahead`], which was the last to be evaluated.
    pub(super) fn move_ahead(&mut self) {
        std::mem::swap(&mut self.at, &mut self.trial);
        self.elements.take(&self.at.blocks);
    }

    /// Writes all quantities at the latest point, which this scaled one is.
    pub(super) fn quantities_here(&self, scaled: &[f64], out: &mut [f64]) {
        self.copy_quantities(&self.at, scaled, out);
    }

    fn copy_quantities(&self, at: &Evaluation, scaled: &[f64], out: &mut [f64]) {
        for ((out, row), factor) in out.iter_mut().zip(&at.rows).zip(&self.scales.rows) {
            *out = row * factor;
        }
        out[self.objective()] = self.scales.objective * at.objective;
        out[self.first_variable()..].copy_from_slice(&scaled[..self.x.len()]);
    }

    /// Learns which quantities are equalities, for what concerns them alone.
    pub(super) fn find_equalities(&mut self, equalities: &[(usize, f64)]) {
        let mut is_equality = vec![false; self.quantities()];
        equalities.iter().for_each(|(of, _)| is_equality[*of] = true);
        self.elements.find_equalities(&is_equality);
    }

    /// Writes `sum over quantities of multiplier * gradient`; `out` has an entry for each variable
    /// and one for nobody.
    pub(super) fn gradient(&mut self, multipliers: &[f64], out: &mut [f64]) {
        self.gradient_of(Rows::All, multipliers, out);
    }

    /// As [`System::gradient`], where only equalities have multipliers.
    pub(super) fn gradient_of_equalities(&mut self, multipliers: &[f64], out: &mut [f64]) {
        self.gradient_of(Rows::Equalities, multipliers, out);
    }

    fn gradient_of(&mut self, rows: Rows, multipliers: &[f64], out: &mut [f64]) {
        let n = self.x.len();
        out[..n].copy_from_slice(&multipliers[self.first_variable()..]);
        out[n] = 0.0;
        self.elements.gradient(rows, multipliers, out);
        out[n] = 0.0;
    }

    /// Writes the change of all quantities along a direction, which ends with a 0 for nobody.
    pub(super) fn along(&mut self, direction: &[f64], out: &mut [f64]) {
        self.along_of(Rows::All, direction, out);
    }

    /// As [`System::along`], where only the change of equalities is wanted; the others' is undefined.
    pub(super) fn along_equalities(&mut self, direction: &[f64], out: &mut [f64]) {
        self.along_of(Rows::Equalities, direction, out);
    }

    fn along_of(&mut self, rows: Rows, direction: &[f64], out: &mut [f64]) {
        let first = self.first_variable();
        out[..first].fill(0.0);
        self.elements.along(rows, direction, out);
        out[first..].copy_from_slice(&direction[..self.x.len()]);
    }

    /// Builds the matrix at the latest point. Rows of the border need [`System::set_border`] besides.
    pub(super) fn assemble(&mut self, weights: Weights<'_>) {
        self.shape.clear(&mut self.matrix);
        self.elements.assemble(weights, &mut self.matrix);
        for (weight, &unknown) in weights.sigma[self.first_variable()..].iter().zip(&self.order.unknown) {
            let at = self.shape.position(unknown as usize, unknown as usize);
            self.matrix[at] += weight;
        }
    }

    /// Finds what makes each element of the matrix convex. Before: [`System::assemble`] with the same `sigma`.
    pub(super) fn make_convex(&mut self, sigma: &[f64]) {
        self.change.fill(0.0);
        self.elements.make_convex(sigma, &mut self.change);
    }

    /// Sets the diagonal of a row of the border to `-compliance`.
    pub(super) fn set_border(&mut self, border: usize, compliance: f64) {
        let unknown = self.order.band + self.order.border + border;
        let at = self.shape.position(unknown, unknown);
        self.matrix[at] = -compliance;
    }

    /// Factorises the matrix with a share of what [`System::make_convex`] has found, and a shift of the variables;
    /// whether it has the signs of a minimum.
    pub(super) fn factorise(&mut self, share: f64, shift: f64) -> bool {
        let change = if share == 0.0 { &[][..] } else { &self.change };
        let sum = Sum { matrix: &self.matrix, change, share, shift };
        self.factor.factorise(&self.shape, &sum) == Some(self.order.bordered.len())
    }

    /// Solves with the factors: `right` by variable and by row of the border; gives the solution the
    /// same way.
    pub(super) fn solve(&mut self, variables: &mut [f64], rows: &mut [f64]) {
        for (value, &unknown) in variables.iter().zip(&self.order.unknown) {
            self.side[unknown as usize] = *value;
        }
        let first = self.order.band + self.order.border;
        self.side[first..].copy_from_slice(rows);
        self.factor.solve(&self.shape, &mut self.side);
        for (value, &unknown) in variables.iter_mut().zip(&self.order.unknown) {
            *value = self.side[unknown as usize];
        }
        rows.copy_from_slice(&self.side[first..]);
    }

    /// The element derivatives and rows of the latest point, in the program's own units.
    pub(super) fn latest(&self) -> &Evaluation {
        &self.at
    }
}
