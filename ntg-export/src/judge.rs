//! How far a point is from a solution, measured without a solver.
//!
//! With multipliers `y` of the rows, what is left of the Lagrangian's gradient in each variable,
//!
//! ```text
//! r = grad f(x) - J(x)' y,
//! ```
//!
//! is the multiplier of that variable's bounds (positive: of the lower one), so nothing else has to be known. Where the bound
//! that a multiplier belongs to is infinite, the multiplier is an error of stationarity; where it is finite, its product
//! with the distance to it is an error of complementarity (Nocedal and Wright, *Numerical Optimization*, theorem 12.1).
//! Errors are given as they are, and relative to sizes that do not depend on units: that of an inequality is the bound that is
//! missed, where it is not 0 (docs/maths.md, equation 9.3); that of other rows is the largest of the bounds
//! and of the terms `J[i][j] size[j]`, with the typical sizes of the variables; stationarity's is the largest of the terms
//! `grad f[j] size[j]` and `J[i][j] y[i] size[j]` of the whole program; complementarity's is that and the objective.

use ntg_runtime::nlp::{Assembly, Limits, Nlp, NotFinite};
use ntg_runtime::status::Bounded;

/// How far beside a point the size of an objective is looked for: a part of the variables' typical sizes.
const BESIDE: f64 = 0.01;
/// A bound below this part of the terms of its row is what rounding leaves of 0, as `cos(90 [deg])` is. A law: some thousand
/// roundings.
const NOTHING: f64 = 1e-12;
/// The golden ratio, whose multiples are spread evenly.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// A violated row or bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Missed {
    /// Which.
    pub of: Bounded,
    /// The value.
    pub value: f64,
    /// By how much its nearer bound is missed, SI.
    pub violation: f64,
    /// The same by the bound, or by the size of the row's terms.
    pub relative: f64,
}

/// One error, as it is and by sizes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// In the program's own units.
    pub absolute: f64,
    /// By the sizes above.
    pub relative: f64,
}

/// What there is to say of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// The minimised objective, SI.
    pub objective: f64,
    /// Rows and bounds that are missed at all, the worst by relative violation first.
    pub missed: Vec<Missed>,
    /// Stationarity and complementarity, where multipliers were given.
    pub optimality: Option<[Residual; 2]>,
}

impl Judgement {
    /// The largest relative violation; 0 where all is met.
    pub fn violation(&self) -> f64 {
        self.missed.first().map_or(0.0, |missed| missed.relative)
    }
}

/// A point, and multipliers of the rows where there are any: `d(minimised objective) / d(bound)`.
#[derive(Clone, Copy, Debug)]
pub struct Point<'a> {
    /// One number a variable, SI.
    pub x: &'a [f64],
    /// One number a row.
    pub multipliers: Option<&'a [f64]>,
}

/// Judges a point; the program's variables have their typical sizes.
///
/// # Errors
/// A function that is not finite there.
pub fn judge<N: Nlp>(nlp: &N, point: Point<'_>) -> Result<Judgement, NotFinite> {
    let (n, m) = (nlp.variables(), nlp.rows());
    let (mut work, mut at) = nlp.workspace();
    nlp.derivatives(point.x, 1.0, &vec![0.0; m], &mut work, &mut at)?;
    let mut assembly = Assembly::of_slopes(n, m, nlp.blocks());
    assembly.first(nlp.blocks(), &at);
    let mut sizes = vec![0.0_f64; m];
    each(&assembly, |i, j, slope| sizes[i] = sizes[i].max((slope * nlp.limits().scale[j]).abs()));
    let missed = missed(nlp, point.x, &at.rows, &sizes);
    let optimality = point.multipliers.map(|y| {
        let size = objective_size(nlp, point.x);
        let judged = Optimality { limits: nlp.limits(), assembly: &assembly, x: point.x, rows: &at.rows, size };
        judged.residuals(y, at.objective)
    });
    Ok(Judgement { objective: at.objective, missed, optimality })
}

/// The largest term of the objective's gradient beside a point; none where that is not finite.
fn objective_size<N: Nlp>(nlp: &N, x: &[f64]) -> Option<f64> {
    // Fractions of 1 that repeat nowhere, so that what is symmetric at the point is not so here.
    let part = |j: usize| (GOLDEN * (j + 1) as f64).fract() - 0.5;
    let sizes = &nlp.limits().scale;
    let beside: Vec<f64> = x.iter().zip(sizes).enumerate().map(|(j, (x, size))| x + BESIDE * size * part(j)).collect();
    let (mut work, mut at) = nlp.workspace();
    nlp.derivatives(&beside, 1.0, &vec![0.0; nlp.rows()], &mut work, &mut at).ok()?;
    let mut assembly = Assembly::of_slopes(x.len(), nlp.rows(), nlp.blocks());
    assembly.first(nlp.blocks(), &at);
    Some(largest_term(&assembly.gradient, sizes))
}

fn largest_term(gradient: &[f64], sizes: &[f64]) -> f64 {
    gradient.iter().zip(sizes).map(|(g, size)| (g * size).abs()).fold(0.0, f64::max)
}

/// Calls `visit` with row, column and value of each entry of the Jacobian.
fn each(assembly: &Assembly, mut visit: impl FnMut(usize, usize, f64)) {
    for j in 0..assembly.jacobian.columns() {
        assembly.jacobian.column(j).for_each(|(i, slope)| visit(i, j, slope));
    }
}

/// How far a value is outside its bounds.
fn outside(value: f64, lower: f64, upper: f64) -> f64 {
    (lower - value).max(value - upper).max(0.0)
}

fn missed<N: Nlp>(nlp: &N, x: &[f64], rows: &[f64], sizes: &[f64]) -> Vec<Missed> {
    let limits = nlp.limits();
    let size = |lower: f64, upper: f64, least: f64| {
        let bounds = [lower, upper].into_iter().filter(|bound| bound.is_finite()).map(f64::abs);
        bounds.fold(least, f64::max)
    };
    let one = |of, value: f64, (lower, upper): (f64, f64), least: f64| {
        let violation = outside(value, lower, upper);
        let bound = if value < lower { lower } else { upper };
        let is_meant = lower != upper && bound.abs() > NOTHING * least;
        let size = if is_meant { bound.abs() } else { size(lower, upper, least) };
        let relative = if size > 0.0 { violation / size } else { violation };
        Missed { of, value, violation, relative }
    };
    let of_row = |i: usize| one(Bounded::Row(i), rows[i], (limits.row_lower[i], limits.row_upper[i]), sizes[i]);
    let of_variable = |j: usize| one(Bounded::Variable(j), x[j], (limits.lower[j], limits.upper[j]), limits.scale[j]);
    let all = (0..rows.len()).map(of_row).chain((0..x.len()).map(of_variable));
    let mut missed: Vec<Missed> = all.filter(|missed| missed.violation > 0.0).collect();
    missed.sort_by(|a, b| b.relative.total_cmp(&a.relative));
    missed
}

/// A point with its derivatives.
struct Optimality<'a> {
    limits: &'a Limits,
    assembly: &'a Assembly,
    x: &'a [f64],
    rows: &'a [f64],
    /// The objective's size beside the point, where it is known.
    size: Option<f64>,
}

impl Optimality<'_> {
    fn residuals(&self, y: &[f64], objective: f64) -> [Residual; 2] {
        let limits = self.limits;
        let mut left = self.assembly.gradient.clone();
        let mut largest = largest_term(&left, &limits.scale).max(self.size.unwrap_or(0.0));
        if largest == 0.0 && self.size.is_some() {
            return [Residual::default(); 2];
        }
        each(self.assembly, |i, j, slope| {
            left[j] -= slope * y[i];
            largest = largest.max((slope * y[i] * limits.scale[j]).abs());
        });
        let mut found = [Residual::default(); 2];
        for (j, multiplier) in left.iter().enumerate() {
            let bounds = (limits.lower[j], limits.upper[j]);
            add(&mut found, *multiplier, limits.scale[j], (self.x[j], bounds));
        }
        // A multiplier without a bound counts by what it would move: one typical change of its row.
        for (i, multiplier) in y.iter().enumerate() {
            let bounds = (limits.row_lower[i], limits.row_upper[i]);
            add(&mut found, *multiplier, limits.row_scale[i], (self.rows[i], bounds));
        }
        let [stationarity, complementarity] = &mut found;
        stationarity.relative /= positive(largest);
        complementarity.relative = complementarity.absolute / positive(largest.max(objective.abs()));
        found
    }
}

/// Adds a multiplier to stationarity or to complementarity.
fn add(found: &mut [Residual; 2], multiplier: f64, size: f64, (value, (lower, upper)): (f64, (f64, f64))) {
    let bound = if multiplier > 0.0 { lower } else { upper };
    let [stationarity, complementarity] = found;
    if bound.is_finite() {
        let product = (multiplier * (value - bound)).abs();
        complementarity.absolute = complementarity.absolute.max(product);
    } else {
        stationarity.absolute = stationarity.absolute.max(multiplier.abs());
        stationarity.relative = stationarity.relative.max((multiplier * size).abs());
    }
}

fn positive(size: f64) -> f64 {
    if size > 0.0 { size } else { 1.0 }
}
