//! Clarabel behind two small doors: quadratic programs, and factors of a symmetric matrix.
//!
//! This is the only file that names clarabel. A [`QuadraticSolver`] keeps its symbolic work between
//! programs of one pattern. Its equilibration is that of the first data, so an answer is believed
//! only after its residuals are computed from the program itself; otherwise the solver is built
//! anew and asked once more.

use crate::sparse::Csc;
use clarabel::algebra::CscMatrix;
use clarabel::qdldl::{QDLDLFactorisation, QDLDLSettingsBuilder};
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// Relative size of residuals up to which an answer is believed.
const BELIEVED: f64 = 1e-5;
/// Interior-point tolerance: a hundredth of the accuracy at which steps are useful.
const TOLERANCE: f64 = 1e-9;
/// Interior-point iterations; convex programs of this kind need 10 to 40.
const ITERATIONS: u32 = 100;

/// Minimise `x^T P x / 2 + q^T x` subject to `A x + s = b`, where the first `equalities` entries of
/// `s` are zero and the others not negative.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadratic<'a> {
    /// Upper triangle, positive semidefinite.
    pub(super) p: &'a Csc,
    pub(super) q: &'a Vec<f64>,
    pub(super) a: &'a Csc,
    pub(super) b: &'a Vec<f64>,
    pub(super) equalities: usize,
}

/// What became of a quadratic program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Minimiser and multipliers satisfy the optimality conditions.
    Solved,
    /// No point satisfies the constraints, or hardly any.
    Infeasible,
    /// The objective falls without limit.
    Unbounded,
    /// No answer worth believing.
    Failed,
}

/// The last answer, and the solver that gave it.
#[derive(Default)]
pub(super) struct QuadraticSolver {
    solver: Option<DefaultSolver<f64>>,
    /// The minimiser.
    pub(super) x: Vec<f64>,
    /// Multipliers: `P x + q + A^T z = 0`, not negative for inequalities.
    pub(super) z: Vec<f64>,
    /// Slacks.
    pub(super) s: Vec<f64>,
    stationarity: Vec<f64>,
    feasibility: Vec<f64>,
}

impl QuadraticSolver {
    /// Solves a program; its patterns must be those of the first one.
    pub(super) fn solve(&mut self, problem: &Quadratic<'_>) -> Verdict {
        let fresh = !self.update(problem);
        if fresh && !self.build(problem) {
            return Verdict::Failed;
        }
        let verdict = self.run(problem);
        if fresh || verdict == Verdict::Solved {
            return verdict;
        }
        if self.build(problem) { self.run(problem) } else { Verdict::Failed }
    }

    /// Hands new data to the solver; false when there is none or it refuses.
    fn update(&mut self, problem: &Quadratic<'_>) -> bool {
        let Some(solver) = &mut self.solver else { return false };
        solver.update_P(&problem.p.value).is_ok()
            && solver.update_q(problem.q).is_ok()
            && solver.update_A(&problem.a.value).is_ok()
            && solver.update_b(problem.b).is_ok()
    }

    fn build(&mut self, problem: &Quadratic<'_>) -> bool {
        let options = DefaultSettings {
            verbose: false,
            max_iter: ITERATIONS,
            presolve_enable: false,
            input_sparse_dropzeros: false,
            tol_gap_abs: TOLERANCE,
            tol_gap_rel: TOLERANCE,
            tol_feas: TOLERANCE,
            max_threads: 1,
            direct_solve_method: "qdldl".to_string(),
            ..DefaultSettings::default()
        };
        let inequalities = problem.b.len() - problem.equalities;
        let mut cones = Vec::new();
        if problem.equalities > 0 {
            cones.push(SupportedConeT::ZeroConeT(problem.equalities));
        }
        if inequalities > 0 {
            cones.push(SupportedConeT::NonnegativeConeT(inequalities));
        }
        let (p, a) = (matrix(problem.p), matrix(problem.a));
        self.solver = DefaultSolver::new(&p, problem.q, &a, problem.b, &cones, options).ok();
        self.solver.is_some()
    }

    fn run(&mut self, problem: &Quadratic<'_>) -> Verdict {
        let Some(solver) = &mut self.solver else { return Verdict::Failed };
        solver.solve();
        match solver.solution.status {
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => return Verdict::Infeasible,
            SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => return Verdict::Unbounded,
            _ => {}
        }
        let solution = &solver.solution;
        copy(&solution.x, &mut self.x);
        copy(&solution.z, &mut self.z);
        copy(&solution.s, &mut self.s);
        // Whatever the status says, the residuals decide: some good answers are called otherwise.
        if self.residual(problem) <= BELIEVED { Verdict::Solved } else { Verdict::Failed }
    }

    /// The largest relative residual of the optimality conditions; infinite if not a number.
    fn residual(&mut self, problem: &Quadratic<'_>) -> f64 {
        let size = |v: &[f64]| v.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
        copy(problem.q, &mut self.stationarity);
        problem.p.add_symmetric_product(1.0, &self.x, &mut self.stationarity);
        problem.a.add_transposed_product(1.0, &self.z, &mut self.stationarity);
        copy(problem.b, &mut self.feasibility);
        problem.a.add_product(-1.0, &self.x, &mut self.feasibility);
        let mut worst = size(&self.stationarity) / (1.0 + size(problem.q) + size(&self.z));
        let (primal_unit, dual_unit) = (1.0 + size(&self.x), 1.0 + size(&self.z));
        for (i, slack) in self.feasibility.iter().enumerate() {
            let miss = if i < problem.equalities { slack.abs() } else { -slack };
            worst = worst.max(miss / primal_unit);
            if i >= problem.equalities {
                worst = worst.max((self.z[i] * slack).abs() / (primal_unit * dual_unit)).max(-self.z[i] / dual_unit);
            }
        }
        let sum: f64 = self.stationarity.iter().chain(&self.feasibility).sum();
        if sum.is_finite() { worst } else { f64::INFINITY }
    }
}

fn copy(from: &[f64], to: &mut Vec<f64>) {
    to.clear();
    to.extend_from_slice(from);
}

fn matrix(csc: &Csc) -> CscMatrix<f64> {
    CscMatrix::new(csc.rows, csc.columns(), csc.start.clone(), csc.row.clone(), csc.value.clone())
}

/// Factors `L D L^T` of a symmetric matrix whose pattern does not change.
pub(super) struct Factors {
    factors: Option<QDLDLFactorisation<f64>>,
    entries: Vec<usize>,
}

impl Factors {
    /// Chooses an order of elimination for a matrix given by its upper triangle, in which every
    /// column has an entry.
    pub(super) fn new(upper: &Csc) -> Self {
        let options = QDLDLSettingsBuilder::default().logical(true).regularize_enable(false).build().ok();
        let factors = options.and_then(|options| QDLDLFactorisation::new(&matrix(upper), Some(options)).ok());
        Self { factors, entries: (0..upper.row.len()).collect() }
    }

    /// Factorises for new values; the number of positive pivots, or none when a pivot is zero.
    pub(super) fn factorise(&mut self, upper: &Csc) -> Option<usize> {
        let factors = self.factors.as_mut()?;
        factors.update_values(&self.entries, &upper.value);
        factors.refactor().ok()?;
        if factors.D.iter().all(|pivot| pivot.is_finite() && *pivot != 0.0) {
            Some(factors.D.iter().filter(|pivot| **pivot > 0.0).count())
        } else {
            None
        }
    }

    /// Replaces `b` by the solution for it.
    pub(super) fn solve(&mut self, b: &mut [f64]) {
        if let Some(factors) = &mut self.factors {
            factors.solve(b);
        }
    }
}
