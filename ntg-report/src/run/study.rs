//! What a solve says beside its solution: why there is none, what other starts found, and how its mesh was refined.

use serde::{Deserialize, Serialize};

use super::numbers;

/// Why there is no solution, as far as constraints are the reason.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Explanation {
    /// `conflict`, `consistent` (all constraints can hold together near the last point or the guess) or `unknown`.
    pub verdict: String,
    /// The same for a person.
    pub words: String,
    /// Whether every part of the conflict is known to be needed.
    pub minimal: bool,
    /// The least sum of relative violations.
    #[serde(with = "numbers::one")]
    pub violation: f64,
    /// The constraints and bounds that cannot hold together.
    pub parts: Vec<Part>,
}

/// A constraint or a bound of a conflict.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Part {
    /// Its name, or its text; for a bound what is bounded.
    pub name: String,
    /// Whether it is a bound of a duration, a start or a variable.
    pub bound: bool,
    /// The indices of the member that is violated most.
    pub indices: Vec<i64>,
    /// Line in the spec, from 1; 0 for none.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// By how much it is missed where the sum of violations is least; 0 for what holds there.
    #[serde(with = "numbers::one")]
    pub amount: f64,
    /// The unit of `amount`.
    pub unit: String,
    /// Seconds of mission time; none for what belongs to no point.
    pub t: Option<f64>,
    /// The phase's path.
    pub phase: String,
    /// All of this for a person.
    pub words: String,
}

/// What many starts found.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Starts {
    /// How many were tried.
    pub tried: usize,
    /// How many of them were solved.
    pub solved: usize,
    /// The local minima, the best first.
    pub minima: Vec<Minimum>,
    /// What a person should know about the choice of starts.
    pub notes: Vec<String>,
    /// Seconds of everything.
    #[serde(with = "numbers::one")]
    pub seconds: f64,
}

/// A local minimum.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Minimum {
    /// In the user's sense and unit.
    #[serde(with = "numbers::one")]
    pub objective: f64,
    /// How many starts led to it.
    pub count: usize,
    /// Where the first of them came from.
    pub from: String,
    /// The largest relative violation between the points.
    #[serde(with = "numbers::one")]
    pub violation_between: f64,
}

/// How a mesh was refined.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Refinement {
    /// Why it ended.
    pub status: String,
    /// Whether the tolerance is met.
    pub met: bool,
    /// The tolerance that was wanted.
    #[serde(with = "numbers::one")]
    pub tolerance: f64,
    /// The rounds in order.
    pub rounds: Vec<Round>,
}

/// One round of refinement.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Round {
    /// Knot intervals of all phases.
    pub intervals: usize,
    /// Variables of the nonlinear program.
    pub variables: usize,
    /// The objective as discretised.
    #[serde(with = "numbers::one")]
    pub objective: f64,
    /// The objective finely integrated.
    #[serde(with = "numbers::one")]
    pub objective_fine: f64,
    /// The relative difference of the two.
    #[serde(with = "numbers::one")]
    pub quadrature: f64,
    /// The relative change of the latter since the round before; none in the first.
    #[serde(with = "numbers::one")]
    pub change: f64,
    /// The largest relative violation between the points.
    #[serde(with = "numbers::one")]
    pub violation: f64,
    /// Iterations of its solve.
    pub iterations: usize,
    /// Seconds of its solve.
    #[serde(with = "numbers::one")]
    pub seconds: f64,
}

impl From<&ntg_runtime::explain::Explanation> for Explanation {
    fn from(found: &ntg_runtime::explain::Explanation) -> Self {
        use ntg_runtime::explain::Explanation as Found;
        let verdict = match found {
            Found::Conflict(_) => "conflict",
            Found::Consistent(_) => "consistent",
            Found::Unknown => "unknown",
        };
        let conflict = found.conflict();
        Self {
            verdict: verdict.to_owned(),
            words: found.to_string().lines().next().unwrap_or_default().to_owned(),
            minimal: conflict.is_some_and(|conflict| conflict.minimal),
            violation: conflict.map_or(f64::NAN, |conflict| conflict.violation),
            parts: conflict.iter().flat_map(|conflict| &conflict.parts).map(Part::from).collect(),
        }
    }
}

impl From<&ntg_runtime::explain::Part> for Part {
    fn from(part: &ntg_runtime::explain::Part) -> Self {
        Self {
            name: part.name.clone(),
            bound: part.is_bound,
            indices: part.indices.clone(),
            line: part.place.line,
            column: part.place.column,
            amount: part.amount,
            unit: part.unit.symbol.clone(),
            t: part.time.map(|time| part.independent.shown(time)),
            phase: part.phase.clone(),
            words: part.to_string(),
        }
    }
}

impl From<&ntg_runtime::multistart::MultiReport> for Starts {
    fn from(found: &ntg_runtime::multistart::MultiReport) -> Self {
        let minima = found.minima.iter().map(|minimum| Minimum {
            objective: minimum.report.objective,
            count: minimum.count,
            from: found.starts[minimum.first].origin.to_string(),
            violation_between: minimum.report.violation.between,
        });
        Self {
            tried: found.tried(),
            solved: found.solved(),
            minima: minima.collect(),
            notes: found.notes.clone(),
            seconds: found.seconds,
        }
    }
}

impl From<&ntg_runtime::refine::Refined> for Refinement {
    fn from(refined: &ntg_runtime::refine::Refined) -> Self {
        Self {
            status: refined.status.to_string(),
            met: refined.is_met(),
            tolerance: refined.tolerance,
            rounds: refined.rounds.iter().map(Round::from).collect(),
        }
    }
}

impl From<&ntg_runtime::refine::Round> for Round {
    fn from(round: &ntg_runtime::refine::Round) -> Self {
        Self {
            intervals: round.intervals,
            variables: round.variables,
            objective: round.objective,
            objective_fine: round.fine,
            quadrature: round.quadrature,
            change: round.change,
            violation: round.violation,
            iterations: round.iterations,
            seconds: round.seconds,
        }
    }
}
