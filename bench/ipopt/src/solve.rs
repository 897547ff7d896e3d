//! One solve by IPOPT: a program in, an end out.

use crate::library::{Ipopt, Value};
use ntg_bench_program::{Bounds, Program};

/// Bounds in the layout that IPOPT reads.
pub(crate) type Limits = Bounds;

/// What IPOPT asks of a program; `None` where a number is not finite.
pub(crate) trait Evaluations {
    /// The objective.
    fn objective(&mut self, x: &[f64]) -> Option<f64>;
    /// The objective's gradient.
    fn gradient(&mut self, x: &[f64], out: &mut [f64]) -> Option<()>;
    /// The rows.
    fn constraints(&mut self, x: &[f64], out: &mut [f64]) -> Option<()>;
    /// Rows and columns of the Jacobian's entries.
    fn jacobian_pattern(&self) -> (Vec<usize>, Vec<usize>);
    /// The Jacobian's entries.
    fn jacobian(&mut self, x: &[f64], out: &mut [f64]) -> Option<()>;
    /// Rows and columns of the entries of the Hessian's lower triangle.
    fn hessian_pattern(&self) -> (Vec<usize>, Vec<usize>);
    /// The entries of the lower triangle of the Hessian of `objective f + multipliers' c`.
    fn hessian(&mut self, x: &[f64], objective: f64, multipliers: &[f64], out: &mut [f64]) -> Option<()>;
}

impl Evaluations for Program<'_, '_> {
    fn objective(&mut self, x: &[f64]) -> Option<f64> {
        Program::objective(self, x)
    }
    fn gradient(&mut self, x: &[f64], out: &mut [f64]) -> Option<()> {
        Program::gradient(self, x, out)
    }
    fn constraints(&mut self, x: &[f64], out: &mut [f64]) -> Option<()> {
        Program::constraints(self, x, out)
    }
    fn jacobian_pattern(&self) -> (Vec<usize>, Vec<usize>) {
        let pattern = Program::jacobian_pattern(self);
        (pattern.rows, pattern.columns)
    }
    fn jacobian(&mut self, x: &[f64], out: &mut [f64]) -> Option<()> {
        Program::jacobian(self, x, out)
    }
    fn hessian_pattern(&self) -> (Vec<usize>, Vec<usize>) {
        let pattern = Program::hessian_pattern(self);
        (pattern.rows, pattern.columns)
    }
    fn hessian(&mut self, x: &[f64], objective: f64, multipliers: &[f64], out: &mut [f64]) -> Option<()> {
        Program::hessian(self, x, objective, multipliers, out)
    }
}

/// How a solve ended. Multipliers have IPOPT's signs: `grad f + J' y - z_lower + z_upper = 0`.
#[derive(Clone, Debug)]
pub(crate) struct End {
    /// `ApplicationReturnStatus` of IpReturnCodes.h.
    pub(crate) status: i32,
    /// How many iterations were made, those of the restoration included.
    pub(crate) iterations: usize,
    /// The objective at the end.
    pub(crate) objective: f64,
    /// The last point.
    pub(crate) x: Vec<f64>,
    /// The rows there.
    pub(crate) rows: Vec<f64>,
    /// Multipliers of the rows.
    pub(crate) row_multipliers: Vec<f64>,
    /// Multipliers of the variables' lower bounds, not negative.
    pub(crate) lower_multipliers: Vec<f64>,
    /// Multipliers of the variables' upper bounds, not negative.
    pub(crate) upper_multipliers: Vec<f64>,
}

impl End {
    /// Whether IPOPT reached its tolerance; its "acceptable level" is not that.
    pub(crate) fn is_solved(&self) -> bool {
        self.status == 0
    }

    /// The status by its name in IpReturnCodes.h, in words.
    pub(crate) fn words(&self) -> &'static str {
        match self.status {
            0 => "solved",
            1 => "acceptable",
            2 => "infeasible",
            3 => "search direction too small",
            4 => "diverging",
            5 => "stopped by user",
            6 => "feasible point found",
            -1 => "iteration limit",
            -2 => "restoration failed",
            -3 => "error in step computation",
            -4 | -5 => "time limit",
            -10 => "too few degrees of freedom",
            -11 => "invalid problem",
            -12 => "invalid option",
            -13 => "not finite",
            -102 => "out of memory",
            _ => "failed",
        }
    }
}

/// IPOPT's defaults but for the tolerance, the limit, and what would be printed.
pub(crate) fn options(tolerance: f64, seconds: f64, print_level: i32) -> Vec<(String, Value)> {
    vec![
        ("tol".into(), Value::Real(tolerance)),
        ("max_wall_time".into(), Value::Real(seconds)),
        ("print_level".into(), Value::Whole(print_level)),
        ("sb".into(), Value::Word("yes".into())),
    ]
}

/// Solves a program from its own start.
///
/// # Errors
/// What IPOPT refuses before it begins.
pub(crate) fn solve(ipopt: &Ipopt, program: &mut Program<'_, '_>, options: &[(String, Value)]) -> Result<End, String> {
    let start = program.start().to_vec();
    ipopt.solve(&mut program.bounds(), &start, program, options)
}
