//! A transcription as a sparse program in scaled quantities.
//!
//! ```text
//! minimise  w f(D z)   subject to   row_lower <= R c(D z) <= row_upper,   lower <= z <= upper,   x = D z
//! ```
//!
//! `D` holds the typical sizes of the variables (docs/maths.md, section 5). `R` and `w` are 1, or ntg's own row sizes and
//! objective factor for a solver that scales nothing itself. Multipliers are those of the scaled program.
//! Takes a [`Transcription`] and a start in SI units. Afterwards: no evaluation allocates.

use ntg_runtime::guess::start;
use ntg_runtime::nlp::{Assembly, Csc, Evaluation, Nlp, Scales};
use ntg_runtime::settings::{Scaling, Settings};
use ntg_runtime::transcribe::{Transcription, Workspace};
use std::time::{Duration, Instant};

/// How rows and objective are scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowSizes {
    /// Not at all: in SI units, for a solver that scales rows and objective itself.
    Si,
    /// As ntg scales them (docs/maths.md, equations 5.2 and 5.3).
    Ntg,
}

/// Bounds of a scaled program, infinite where there are none.
#[derive(Clone, Debug, Default)]
pub struct Bounds {
    /// Of the variables, from below.
    pub lower: Vec<f64>,
    /// Of the variables, from above.
    pub upper: Vec<f64>,
    /// Of the rows, from below.
    pub row_lower: Vec<f64>,
    /// Of the rows, from above.
    pub row_upper: Vec<f64>,
}

/// Places of the entries of a matrix.
#[derive(Clone, Debug, Default)]
pub struct Pattern {
    /// Row of each entry.
    pub rows: Vec<usize>,
    /// Column of each entry.
    pub columns: Vec<usize>,
}

/// A program at whatever point it is asked for. Evaluations give `None` where a number is not finite.
pub struct Program<'n, 'p> {
    nlp: &'n Transcription<'p>,
    scales: Scales,
    start: Vec<f64>,
    work: Workspace,
    at: Evaluation,
    assembly: Assembly,
    /// The present point, SI, and the multipliers of the last Hessian, of rows in SI.
    x: Vec<f64>,
    multipliers: Vec<f64>,
    /// Whether `at` holds values, and `assembly` first derivatives, at `x`.
    has_values: bool,
    has_first: bool,
    spent: Duration,
}

impl<'n, 'p> Program<'n, 'p> {
    /// The program of a transcription whose sizes are set (`Transcription::set_scales`); `start` in SI units.
    ///
    /// # Errors
    /// A function that is not finite at the start.
    pub fn new(nlp: &'n Transcription<'p>, start: &[f64], rows: RowSizes) -> Result<Self, String> {
        let (n, m) = (nlp.variables(), nlp.rows());
        let (mut work, mut at) = nlp.workspace();
        let mut assembly = Assembly::new(n, m, nlp.blocks());
        nlp.derivatives(start, 1.0, &vec![0.0; m], &mut work, &mut at).map_err(|error| error.to_string())?;
        assembly.first(nlp.blocks(), &at);
        assembly.hessian(nlp.blocks(), &at, |_, _, _| {});
        let scaling = match rows {
            RowSizes::Si => Scaling::Off,
            RowSizes::Ntg => Scaling::Automatic,
        };
        let mut trial = at.clone();
        let scales = Scales::of_program(nlp, start, scaling, (&at, &mut assembly), (&mut work, &mut trial));
        let start = start.iter().zip(&scales.variables).map(|(x, size)| x / size).collect();
        let (x, multipliers) = (vec![f64::NAN; n], vec![0.0; m]);
        let spent = Duration::ZERO;
        Ok(Self { nlp, scales, start, work, at, assembly, x, multipliers, has_values: false, has_first: false, spent })
    }

    /// How many variables there are.
    pub fn variables(&self) -> usize {
        self.nlp.variables()
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.nlp.rows()
    }

    /// The scaled start.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// What the objective was multiplied by.
    pub fn objective_factor(&self) -> f64 {
        self.scales.objective
    }

    /// A scaled point in SI units.
    pub fn in_si(&self, z: &[f64]) -> Vec<f64> {
        z.iter().zip(&self.scales.variables).map(|(z, size)| z * size).collect()
    }

    /// Scaled multipliers of the rows and of the variables' bounds as those of the program in SI units.
    pub fn multipliers_in_si(&self, rows: &[f64], bounds: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let by_objective = 1.0 / self.scales.objective;
        let rows = rows.iter().zip(&self.scales.rows).map(|(y, factor)| y * factor * by_objective).collect();
        let bounds = bounds.iter().zip(&self.scales.variables).map(|(y, size)| y / size * by_objective).collect();
        (rows, bounds)
    }

    /// The time that evaluations have taken, on the wall.
    pub fn spent(&self) -> Duration {
        self.spent
    }

    /// Scaled bounds.
    pub fn bounds(&self) -> Bounds {
        let scaled = self.scales.limits(self.nlp.limits());
        Bounds { lower: scaled.lower, upper: scaled.upper, row_lower: scaled.row_lower, row_upper: scaled.row_upper }
    }

    /// The objective.
    pub fn objective(&mut self, z: &[f64]) -> Option<f64> {
        self.timed(z, |own| {
            own.values()?;
            Some(own.at.objective * own.scales.objective)
        })
    }

    /// The rows.
    pub fn constraints(&mut self, z: &[f64], out: &mut [f64]) -> Option<()> {
        self.timed(z, |own| {
            own.values()?;
            for ((out, row), factor) in out.iter_mut().zip(&own.at.rows).zip(&own.scales.rows) {
                *out = row * factor;
            }
            Some(())
        })
    }

    /// The gradient of the objective.
    pub fn gradient(&mut self, z: &[f64], out: &mut [f64]) -> Option<()> {
        self.timed(z, |own| {
            own.first()?;
            for ((out, slope), size) in out.iter_mut().zip(&own.assembly.gradient).zip(&own.scales.variables) {
                *out = slope * size * own.scales.objective;
            }
            Some(())
        })
    }

    /// Where the entries of the rows' Jacobian are.
    pub fn jacobian_pattern(&self) -> Pattern {
        let (rows, columns) = places(&self.assembly.jacobian);
        Pattern { rows, columns }
    }

    /// The entries of the rows' Jacobian.
    pub fn jacobian(&mut self, z: &[f64], out: &mut [f64]) -> Option<()> {
        self.timed(z, |own| {
            own.first()?;
            let Scales { variables, rows, .. } = &own.scales;
            scaled(&own.assembly.jacobian, rows, variables, out);
            Some(())
        })
    }

    /// Where the entries of the Lagrangian's Hessian are, of its lower triangle.
    pub fn hessian_pattern(&self) -> Pattern {
        // The assembly keeps the upper triangle: rows and columns change places.
        let (columns, rows) = places(&self.assembly.hessian);
        Pattern { rows, columns }
    }

    /// The entries of the lower triangle of the Hessian of `objective f + multipliers' c`.
    pub fn hessian(&mut self, z: &[f64], objective: f64, multipliers: &[f64], out: &mut [f64]) -> Option<()> {
        self.timed(z, |own| {
            for ((own, y), factor) in own.multipliers.iter_mut().zip(multipliers).zip(&own.scales.rows) {
                *own = y * factor;
            }
            own.derivatives(objective * own.scales.objective)?;
            own.assembly.hessian(own.nlp.blocks(), &own.at, |_, _, _| {});
            scaled(&own.assembly.hessian, &own.scales.variables, &own.scales.variables, out);
            Some(())
        })
    }

    /// Goes to a point and does something there.
    fn timed<T>(&mut self, z: &[f64], job: impl FnOnce(&mut Self) -> T) -> T {
        let began = Instant::now();
        let mut has_moved = false;
        for ((x, z), size) in self.x.iter_mut().zip(z).zip(&self.scales.variables) {
            has_moved |= *x != z * size;
            *x = z * size;
        }
        self.has_values &= !has_moved;
        self.has_first &= !has_moved;
        let done = job(self);
        self.spent += began.elapsed();
        done
    }

    fn values(&mut self) -> Option<()> {
        if !self.has_values {
            self.nlp.values(&self.x, &mut self.work, &mut self.at).ok()?;
            self.has_values = true;
        }
        Some(())
    }

    fn first(&mut self) -> Option<()> {
        if !self.has_first {
            self.multipliers.fill(0.0);
            self.derivatives(0.0)?;
        }
        Some(())
    }

    /// All derivatives at the present point with the present multipliers.
    fn derivatives(&mut self, objective: f64) -> Option<()> {
        self.nlp.derivatives(&self.x, objective, &self.multipliers, &mut self.work, &mut self.at).ok()?;
        if !self.has_first {
            self.assembly.first(self.nlp.blocks(), &self.at);
        }
        self.has_values = true;
        self.has_first = true;
        Some(())
    }
}

/// A transcription with the sizes that ntg gives it by default.
///
/// # Errors
/// What ntg says of a problem that it cannot set up.
pub fn set_sizes(nlp: &mut Transcription<'_>, start: &[f64]) -> Result<(), String> {
    nlp.set_scales(start, &Settings::default()).map_err(|error| error.to_string())
}

/// Start number `number` of a problem: 0 is the spec's own; each other one has every variable moved, by the same random
/// numbers for every solver, by up to `size` of its typical size, and stays within its bounds.
///
/// # Errors
/// What ntg says of a problem that has no start.
pub fn moved_start(nlp: &mut Transcription<'_>, number: u64, size: f64) -> Result<Vec<f64>, String> {
    let mut x = start(nlp, None).map_err(|error| error.to_string())?;
    set_sizes(nlp, &x)?;
    if number > 0 {
        let mut random = fastrand::Rng::with_seed(number);
        let limits = nlp.limits();
        for (j, x) in x.iter_mut().enumerate() {
            let step = size * limits.scale[j] * (2.0 * random.f64() - 1.0);
            *x = (*x + step).max(limits.lower[j]).min(limits.upper[j]);
        }
    }
    Ok(x)
}

/// Rows and columns of all entries, column by column.
fn places(matrix: &Csc) -> (Vec<usize>, Vec<usize>) {
    let columns = (0..matrix.columns()).flat_map(|j| matrix.column(j).map(move |_| j));
    (matrix.row.clone(), columns.collect())
}

/// The entries, each times a factor of its row and one of its column.
fn scaled(matrix: &Csc, rows: &[f64], columns: &[f64], out: &mut [f64]) {
    let mut out = out.iter_mut();
    for (j, size) in columns.iter().enumerate() {
        for ((i, entry), out) in matrix.column(j).zip(&mut out) {
            *out = entry * size * rows[i];
        }
    }
}
