//! A saved run: everything that plots, reports and later solves want to know of a solve.
//!
//! The fields are those of docs/solution-format.md. What an older or hand-written file does not
//! say is empty. Numbers that are not finite are `null` in the file and NaN here.

pub(crate) mod bounding;
mod estimate;
mod layout;
mod measured;
mod multipliers;
mod numbers;
pub(crate) mod reading;
mod record;
mod scene;
pub(crate) mod sides;
mod study;
mod vectors;

pub use estimate::{Deviation, Estimate, Measurement, Residual};
pub use layout::layout;
pub use record::Recording;
pub use scene::{Ball, Coordinate, Level, Moving, Outline, Place, Scene, Surface};
pub use study::{Explanation, Minimum, Part, Refinement, Round, Starts};
pub use vectors::{NamedArray, arrays, elements, gathered, members};

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What the file says it is.
pub const FORMAT: &str = "ntg-solution";
/// The version that this program writes. It reads the earlier one too, in which elements of arrays had entries of their own.
pub const VERSION: u64 = 2;

/// What is wrong with the version of a file; none where it can be read.
pub fn unknown_version(version: &Value) -> Option<String> {
    let is_known = version.as_u64().is_some_and(|version| (1..=VERSION).contains(&version));
    (!is_known).then(|| format!("has version {version}; this program reads versions 1 to {VERSION}"))
}

/// One solve.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Run {
    /// Always [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u64,
    /// The problem's name.
    pub problem: String,
    /// The problem's documentation.
    pub doc: String,
    /// `solved`, or why the solve ended.
    pub status: String,
    /// Whether a solution of the points is one of the problem: `fine`, `coarse` or `unresolved`; empty where there is none, and in
    /// older files.
    pub resolution: String,
    /// The largest relative violation between the points of which nothing is said; 0 in older files, see [`Run::tolerance`].
    #[serde(with = "numbers::one")]
    pub between_tolerance: f64,
    /// What everything is a function of; every time is in its unit.
    pub independent: Independent,
    /// What to try next; empty when solved.
    pub advice: String,
    /// What is to be known beside the status, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// In the user's sense and unit.
    #[serde(with = "numbers::one")]
    pub objective: f64,
    /// The unit of objectives.
    pub objective_unit: String,
    /// The objective integrated on a finer grid.
    #[serde(with = "numbers::one")]
    pub objective_fine: f64,
    /// What of the objective is 0, in its unit; infinite where it depends on nothing.
    #[serde(with = "numbers::one")]
    pub objective_zero: f64,
    /// The objective's terms.
    pub terms: Vec<Term>,
    /// Iterations of all steps of a continuation.
    pub iterations: usize,
    /// Seconds of the solve.
    #[serde(with = "numbers::one")]
    pub seconds: f64,
    /// Largest relative violations.
    pub violation: Violation,
    /// Why there is no solution; none where there is one, or nobody asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explanation: Option<Explanation>,
    /// What the starts found of which this is the best; none where there was one start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub starts: Option<Starts>,
    /// How the mesh was refined; none where it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refinement: Option<Refinement>,
    /// What the measurements say; none where nothing was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimate: Option<Estimate>,
    /// What the meaning of `unknowns` depends on.
    pub layout: Value,
    /// All variables of the optimisation problem, SI.
    #[serde(with = "numbers::many")]
    pub unknowns: Vec<f64>,
    /// How much the minimised objective changes by the active bound of each row of the optimisation problem, SI; empty in
    /// files from before it was saved.
    #[serde(with = "numbers::many", default)]
    pub row_multipliers: Vec<f64>,
    /// Outputs by path.
    #[serde(with = "vectors::by_array")]
    pub outputs: IndexMap<String, Series>,
    /// Named expressions by path.
    #[serde(with = "vectors::by_array")]
    pub lets: IndexMap<String, Series>,
    /// Durations and event times by name.
    pub times: IndexMap<String, f64>,
    /// Phases in order.
    pub phases: Vec<Phase>,
    /// Declared variables.
    #[serde(with = "vectors::by_array")]
    pub variables: IndexMap<String, Quantity>,
    /// Parameters as they were for this run.
    pub parameters: IndexMap<String, Values>,
    /// The constraints, in the order of the spec.
    pub constraints: Vec<Constraint>,
    /// The steps of a continuation; one without.
    pub history: Vec<Step>,
    /// Every iteration.
    pub convergence: Vec<Iteration>,
    /// The optimisation problem's size.
    pub discretisation: Discretisation,
    /// What moves where, and what it passes.
    #[serde(skip_serializing_if = "Scene::is_empty")]
    pub scene: Scene,
    /// The spec.
    pub spec: Option<Spec>,
}

/// A term of the objective.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Term {
    /// Its name or text.
    pub name: String,
    /// As discretised.
    #[serde(with = "numbers::one")]
    pub value: f64,
    /// On the finer grid.
    #[serde(with = "numbers::one")]
    pub fine: f64,
    /// The unit of both.
    pub unit: String,
}

/// Largest relative violations.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Violation {
    /// At the points of the transcription.
    #[serde(with = "numbers::one")]
    pub points: f64,
    /// Between them.
    #[serde(with = "numbers::one")]
    pub between: f64,
}

/// A quantity over time, or a single number (no times).
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Series {
    /// The unit's symbol; empty for a pure number.
    pub unit: String,
    /// SI units in one unit.
    pub factor: f64,
    /// Its documentation in the spec.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub doc: String,
    /// Whether it is a named expression that only serves others: pictures leave it out unless asked.
    #[serde(skip_serializing_if = "is_false")]
    pub helper: bool,
    /// Mission times, increasing.
    #[serde(with = "numbers::many", skip_serializing_if = "Vec::is_empty")]
    pub t: Vec<f64>,
    /// Values in the unit.
    #[serde(serialize_with = "numbers::many::serialize", deserialize_with = "numbers::one_or_many")]
    pub value: Vec<f64>,
    /// Proved bounds, stretch by stretch: from, to, no value below, none above. Empty where nobody asked.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<[f64; 4]>,
}

/// The independent variable: mission time in seconds, unless the spec has another domain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Independent {
    /// Its name.
    pub name: String,
    /// The unit's symbol; empty for a pure number.
    pub unit: String,
    /// SI units in one unit.
    pub factor: f64,
}

impl Default for Independent {
    fn default() -> Self {
        Self { name: "t".to_owned(), unit: "s".to_owned(), factor: 1.0 }
    }
}

impl Independent {
    /// The head of an axis or a column: `t [s]`.
    pub fn heading(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{} [{}]", self.name, self.unit) }
    }

    /// What a density is per: `second`, `m`.
    pub fn per(&self) -> String {
        match self.unit.as_str() {
            "s" => "per second".to_owned(),
            "" => format!("per unit of {}", self.name),
            unit => format!("per {unit}"),
        }
    }
}

/// A phase and its times.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Phase {
    /// Its path.
    pub name: String,
    /// When it starts.
    pub start: f64,
    /// When it ends.
    pub end: f64,
}

/// A number with its unit.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Quantity {
    /// The unit's symbol.
    pub unit: String,
    /// SI units in one unit.
    pub factor: f64,
    /// In the unit.
    #[serde(with = "numbers::one")]
    pub value: f64,
}

/// The values of a parameter.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(try_from = "numbers::Written", into = "numbers::Written")]
pub struct Values {
    /// The unit's symbol.
    pub unit: String,
    /// In the unit; several for an array, of a matrix row by row.
    pub value: Vec<f64>,
    /// How many there are by each index; empty for a number.
    pub shape: Vec<usize>,
}

/// One constraint of the spec.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Constraint {
    /// Its name, or its text.
    pub name: String,
    /// `initial`, `trajectory`, `final`, `temporal` or `continuity`.
    pub block: String,
    /// Line in the spec, from 1; 0 for none.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// Its text, on one line, cut where it is long.
    pub text: String,
    /// The unit of values, bounds and violations.
    pub unit: String,
    /// Where it is violated most at the points.
    pub points: Option<Worst>,
    /// Where it is violated most between them.
    pub between: Option<Worst>,
    /// The largest multiplier.
    pub multiplier: Option<Multiplier>,
    /// `dJ*/d(bound)` when the bound moves everywhere.
    #[serde(with = "numbers::one")]
    pub sensitivity: f64,
    /// Its members over time.
    pub members: Vec<Member>,
    /// What is proved of it for all times; none where nobody asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proof: Option<Proof>,
}

/// What is proved of a constraint for all times, over all of its members.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Proof {
    /// `proved`, `within`, `refuted` or `undecided`.
    pub verdict: String,
    /// The same in words, with numbers.
    pub words: String,
    /// No value is below,
    #[serde(with = "numbers::one")]
    pub low: f64,
    /// and none above, in the constraint's unit.
    #[serde(with = "numbers::one")]
    pub high: f64,
}

impl Proof {
    /// Whether the constraint holds at all times; an equality to within its residual.
    pub fn holds(&self) -> bool {
        matches!(self.verdict.as_str(), "proved" | "within")
    }
}

impl Constraint {
    /// Whether some value is at a bound or beyond it, so that there is something to pay for.
    pub fn reaches_a_bound(&self) -> bool {
        /// A bound that is nearer than this, relative to its size, is reached.
        const REACHED: f64 = 1e-5;
        let near = |bound: f64| REACHED * bound.abs().max(1.0);
        self.members.iter().any(|member| {
            let low = |value: f64| member.lower.is_some_and(|bound| value <= bound + near(bound));
            let high = |value: f64| member.upper.is_some_and(|bound| value >= bound - near(bound));
            member.value.iter().any(|value| low(*value) || high(*value))
        })
    }
}

/// A largest violation.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Worst {
    /// In the constraint's unit.
    #[serde(with = "numbers::one")]
    pub violation: f64,
    /// Relative to the scale of the bounds.
    #[serde(with = "numbers::one")]
    pub relative: f64,
    /// The value there.
    #[serde(with = "numbers::one")]
    pub value: f64,
    /// Mission time.
    pub t: Option<f64>,
    /// The phase's path.
    pub phase: String,
    /// Which member of the constraint: the indices of the loops around it, those over the elements of its vectors last.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub indices: Vec<i64>,
}

/// A multiplier `dJ*/d(bound)`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Multiplier {
    /// In units of the objective per unit of the constraint, per unit of time where it is a density.
    #[serde(with = "numbers::one")]
    pub value: f64,
    /// Whether it is a density over time.
    pub density: bool,
    /// Mission time.
    pub t: Option<f64>,
}

/// One member of a constraint in one phase.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Member {
    /// Its phase and indices, `uav[2].covert [3]`; empty where there is one only.
    pub name: String,
    /// The lower bound; none for none.
    pub lower: Option<f64>,
    /// The upper bound; none for none.
    pub upper: Option<f64>,
    /// Mission times; empty for a constraint at no point.
    #[serde(with = "numbers::many")]
    pub t: Vec<f64>,
    /// Values on the finer grid.
    #[serde(with = "numbers::many")]
    pub value: Vec<f64>,
    /// Seconds at which there are multipliers.
    #[serde(with = "numbers::many")]
    pub multiplier_t: Vec<f64>,
    /// Multipliers there.
    #[serde(with = "numbers::many")]
    pub multiplier: Vec<f64>,
    /// Both ends of every interval, where multipliers are densities,
    #[serde(with = "numbers::many", skip_serializing_if = "Vec::is_empty")]
    pub mean_t: Vec<f64>,
    /// and the mean density between them, twice.
    #[serde(with = "numbers::many", skip_serializing_if = "Vec::is_empty")]
    pub mean: Vec<f64>,
    /// The limit where it is a function of time and what it limits has a name; `value` is then the difference of both.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub curve: Option<Curve>,
}

/// A limit over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Curve {
    /// The path of what is limited.
    pub of: String,
    /// Whether it is not to be above, or not to be below.
    pub upper: bool,
    /// The limit at the member's times,
    #[serde(with = "numbers::many")]
    pub limit: Vec<f64>,
    /// and what is limited there.
    #[serde(with = "numbers::many")]
    pub value: Vec<f64>,
}

/// One step of a continuation.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Step {
    /// The parameters of the step.
    pub parameters: IndexMap<String, f64>,
    /// How it ended.
    pub status: String,
    /// Its objective.
    #[serde(with = "numbers::one")]
    pub objective: f64,
    /// Its iterations.
    pub iterations: usize,
    /// Its seconds.
    #[serde(with = "numbers::one")]
    pub seconds: f64,
}

/// One iteration.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Iteration {
    /// The step of the continuation, from 1.
    pub step: usize,
    /// Iterations completed in the step.
    pub iteration: usize,
    /// The minimised objective.
    #[serde(with = "numbers::one")]
    pub objective: f64,
    /// Largest scaled violation.
    #[serde(with = "numbers::one")]
    pub primal: f64,
    /// Largest scaled component of the Lagrangian's gradient.
    #[serde(with = "numbers::one")]
    pub dual: f64,
    /// Length of the last step.
    #[serde(with = "numbers::one")]
    pub length: f64,
}

/// The size of the optimisation problem.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Discretisation {
    /// Variables.
    pub variables: usize,
    /// Of these, spline coefficients.
    pub coefficients: usize,
    /// Constraint rows.
    pub rows: usize,
    /// Splines and points of each phase of the spec.
    pub phases: Vec<Grid>,
}

/// Splines and points of one phase (family) of the spec.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Grid {
    /// Agent and phase; empty without names.
    pub name: String,
    /// The points, in words.
    pub points: String,
    /// The splines, in words, by output.
    pub splines: IndexMap<String, String>,
}

/// The spec's text.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Spec {
    /// The file's name as the user wrote it.
    pub name: String,
    /// The whole text.
    pub text: String,
    /// What the compiler had to say.
    pub findings: Vec<Finding>,
}

/// A finding of the compiler.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Finding {
    /// Its code.
    pub code: String,
    /// `error`, `warning` or `note`.
    pub severity: String,
    /// What was found.
    pub message: String,
    /// What to write instead.
    pub help: String,
    /// Its line.
    pub line: usize,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
fn is_false(value: &bool) -> bool {
    !*value
}

impl Run {
    /// Reads a saved run.
    ///
    /// # Errors
    /// In words: text that is no JSON, no saved run, or of another version.
    pub fn read(text: &str) -> Result<Self, String> {
        let value: Value = serde_json::from_str(text).map_err(|e| format!("is not JSON: {e}"))?;
        if value["format"] != FORMAT {
            return Err(format!("is no saved solution (its \"format\" is not \"{FORMAT}\")"));
        }
        if let Some(error) = unknown_version(&value["version"]) {
            return Err(error);
        }
        let value = vectors::in_present_form(value);
        let mut run: Self = serde_json::from_value(value).map_err(|e| format!("is damaged: {e}"))?;
        if run.scene.is_empty() {
            // A file of an earlier version knows no vectors, but names.
            run.scene = crate::scene::named(&run);
        }
        Ok(run)
    }

    /// The run as a JSON document.
    pub fn text(&self) -> String {
        // Plain data with string keys always has a JSON form.
        serde_json::to_string(self).unwrap_or_default() + "\n"
    }

    /// Whether a solution was found within the tolerances.
    pub fn is_solved(&self) -> bool {
        self.status == "solved"
    }

    /// Whether a solution was found within 1e-6, though not within the tolerances.
    pub fn is_acceptable(&self) -> bool {
        self.status == "acceptable"
    }

    /// Whether there is a solution: solved, acceptable, or at least stationary.
    pub fn has_solution(&self) -> bool {
        self.is_solved() || self.is_acceptable() || self.status == "stationary"
    }

    /// The largest relative violation between the points of which nothing is said: what the run was told, or what holds
    /// without a word.
    pub fn tolerance(&self) -> f64 {
        let default = || ntg_runtime::settings::Settings::default().between_tolerance;
        if self.between_tolerance > 0.0 { self.between_tolerance } else { default() }
    }

    /// Whether it is solved and there is nothing to warn of.
    pub fn is_sound(&self) -> bool {
        self.is_solved() && self.warnings.is_empty()
    }
}
