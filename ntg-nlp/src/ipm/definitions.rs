//! Rows that define a variable are met at every trial point (docs/maths.md, section 11.18; line 9 of Algorithm 11).
//!
//! ```text
//! v <- v - c / (dc/dv)        for a row c = v - sum = 0, of a constant slope by v      (11.20)
//! ```

use super::state::State;
use crate::contract::{Definition, Nlp, NotFinite};

/// How often what rows define is computed. A choice: sums that hold defined variables are right after the second time; what is
/// nested deeper is left to the method.
const ROUNDS: usize = 2;
/// A change below this part of a variable is rounding: sums have tens of terms. A choice.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl<N: Nlp> State<'_, N> {
    /// Writes the values of all functions at the trial point, whose defined variables become what rows say.
    pub(super) fn defined_trial_values(&mut self) -> Result<(), NotFinite> {
        self.system.values(self.nlp, &self.trial.x, &mut self.trial.values)?;
        for _ in 0..ROUNDS {
            if !self.define_trial() {
                break;
            }
            self.system.values(self.nlp, &self.trial.x, &mut self.trial.values)?;
        }
        Ok(())
    }

    /// Sets the defined variables of the trial point by (11.20); whether one has changed.
    fn define_trial(&mut self) -> bool {
        let (scales, trial) = (&self.system.scales, &mut self.trial);
        let mut has_changed = false;
        for &Definition { row, variable } in &self.nlp.limits().definitions {
            let (row, variable) = (row as usize, variable as usize);
            let change = trial.values[row] / (scales.rows[row] * scales.variables[variable]);
            if change.abs() > ROUNDING * trial.x[variable].abs() {
                trial.x[variable] -= change;
                has_changed = true;
            }
        }
        has_changed
    }
}
