//! From a problem to a nonlinear program (docs/maths.md, section 4).
//!
//! Takes a [`Problem`] with the values of its parameters; gives a [`Transcription`], which is an
//! [`Nlp`](ntg_nlp::Nlp): variables are spline coefficients, free times, declared variables and
//! integrals; elements are the problem's functions at points of collocation.
//!
//! Finds, before any iteration: parameters that are not finite, tables and splines that do not
//! exist, indices outside families, durations that are not positive, bounds that cross, boundary
//! conditions that contradict each other. Afterwards: nothing of the structure has to be looked
//! up while solving; only slots are refreshed.

pub(crate) mod backward;
mod basis;
pub(crate) mod batch;
mod calls;
pub(crate) mod compose;
mod contradictions;
pub(crate) mod crossed;
mod curvatures;
pub(crate) mod deadline;
pub(crate) mod defaults;
mod durations;
pub(crate) mod elements;
mod error;
mod evaluate;
mod fault;
mod folded;
pub(crate) mod frame;
mod helper_sizes;
mod implied;
pub(crate) mod instances;
pub(crate) mod layout;
pub(crate) mod linear;
mod measured;
pub(crate) mod names;
pub(crate) mod node;
mod norm_slopes;
mod own_bounds;
pub(crate) mod points;
mod range_maps;
mod reduce;
pub(crate) mod relations;
pub(crate) mod relaxed;
mod repeated;
pub(crate) mod rows;
mod scale;
pub(crate) mod shape;
pub(crate) mod shifted;
mod shrinking;
pub(crate) mod singular;
mod sizes;
mod sizes_along;
pub(crate) mod slot_maps;
pub(crate) mod slots;
mod tables;
pub(crate) mod times;

pub use calls::{ElementCall, ElementInput};
pub use error::{SetupError, Why};
pub use evaluate::Workspace;
pub use singular::Singular;
pub(crate) use singular::singular;
pub use tables::interpolants;

use crate::problem::Problem;
use crate::status::NotFinite;
use contradictions::Decided;
use deadline::Deadline;
use durations::FreeDuration;
use elements::Elements;
use frame::Frame;
use layout::Layout;
use linear::LinearSystem;
use ntg_nlp::Limits;
use ntg_splines::Table;
use ntg_structure::{Angle, Degree, Place, Row, Structure, Unit};
use own_bounds::OwnBounds;
use rows::{RowInfo, RowKind};
pub(crate) use scale::{Quantity, is_beside_offset};
use std::sync::{Arc, OnceLock};
use times::Clock;

/// A problem with everything that its parameters decide, without its formulas.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    pub(crate) structure: Structure,
    /// Shared with the models before, as long as no table changes.
    pub(crate) tables: Arc<[Table]>,
    pub(crate) layout: Layout,
    pub(crate) clock: Clock,
}

/// A problem as a nonlinear program.
pub struct Transcription<'p> {
    pub(crate) problem: &'p dyn Problem,
    pub(crate) model: Arc<Model>,
    pub(crate) elements: Elements,
    pub(crate) limits: Limits,
    /// From where variables are measured, by their sizes; empty where all are from 0 (docs/maths.md, equation 5.5a).
    pub(crate) origin: Vec<f64>,
    /// Whether the settings say the size of a variable; empty before there are sizes.
    pub(crate) has_named_size: Vec<bool>,
    pub(crate) linear: LinearSystem,
    /// Durations that are variables, in their order.
    pub(crate) durations: Vec<FreeDuration>,
    /// Made when it is first asked for.
    own_bounds: OnceLock<OwnBounds>,
    /// When all that is to be known before the first iteration is to be known.
    pub(crate) until: Deadline,
}

/// A transcription without its problem, to be kept until the problem is solved again.
#[derive(Debug)]
pub(crate) struct Kept {
    pub(crate) model: Arc<Model>,
    pub(crate) elements: Elements,
    limits: Limits,
    linear: LinearSystem,
    durations: Vec<FreeDuration>,
}

/// What of a transcription another structure has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Change {
    /// Nothing.
    Nothing,
    /// Values of parameters and tables, and what they decide but for times.
    Data,
    /// Anything.
    All,
}

impl Kept {
    /// The transcription again; `problem` is the one that it had, or one that differs in parameters.
    pub(crate) fn of(self, problem: &dyn Problem) -> Transcription<'_> {
        let Self { model, elements, limits, linear, durations } = self;
        Transcription {
            problem,
            model,
            elements,
            limits,
            origin: vec![],
            has_named_size: vec![],
            linear,
            durations,
            own_bounds: OnceLock::new(),
            until: Deadline::default(),
        }
    }
}

impl<'p> Transcription<'p> {
    /// Transcribes a problem with the present values of its parameters.
    ///
    /// # Errors
    /// [`SetupError`]: what parameters decide and cannot be solved.
    pub fn new(problem: &'p dyn Problem) -> Result<Self, SetupError> {
        Self::with(problem, problem.structure())
    }

    /// Transcribes a problem with parameters as in `structure` (one step of a continuation).
    pub(crate) fn with(problem: &'p dyn Problem, structure: Structure) -> Result<Self, SetupError> {
        Self::within(problem, structure, Deadline::default())
    }

    /// As [`Transcription::with`], where it does not take longer.
    pub(crate) fn within(problem: &'p dyn Problem, structure: Structure, until: Deadline) -> Result<Self, SetupError> {
        let tables = interpolants(&structure.tables)?.into();
        until.check()?;
        let model = Model::new(problem, structure, tables)?;
        until.check()?;
        let frame = model.frame(problem);
        let mut bounds = rows::variable_bounds(&frame)?;
        let elements = elements::elements(&frame, until)?;
        let Decided { system: linear, met, longest } = contradictions::decided(&frame, &elements, &mut bounds)?;
        until.check()?;
        let mut limits = limits(&model.structure, &elements, (&bounds, &met));
        limits.angles = angles(&model.structure, &model.layout);
        limits.definitions = elements.definitions(&model.layout, &limits);
        let kept = Kept { model: Arc::new(model), elements, limits, linear, durations: vec![] };
        let mut transcription = Self { until, ..kept.of(problem) };
        transcription.limits.alike = transcription.alike();
        until.check()?;
        transcription.find_durations(&longest);
        until.check()?;
        transcription.limits.shrinking = transcription.shrinking();
        Ok(transcription)
    }

    /// What formulas know of an output of a phase, if it is an angle.
    pub(crate) fn angle(&self, (phase, output): (usize, usize)) -> Option<&Angle> {
        let member = &self.model.layout.phases[phase];
        let declared = (member.phase, member.outputs[output].output);
        self.model.structure.angles.iter().find(|angle| (angle.phase, angle.output) == declared)
    }

    /// Bounds along a phase on single outputs, looked for once.
    pub(crate) fn own_bounds(&self) -> &OwnBounds {
        self.own_bounds.get_or_init(|| OwnBounds::of(self))
    }

    /// Changes to another structure of the same problem, and makes anew only what differs.
    ///
    /// # Errors
    /// As [`Transcription::new`]. The transcription is then that of neither.
    pub(crate) fn take(&mut self, structure: &Structure) -> Result<Change, SetupError> {
        let own = &self.model.structure;
        if own == structure {
            return Ok(Change::Nothing);
        }
        if !differs_in_data_only(own, structure) {
            *self = Self::with(self.problem, structure.clone())?;
            return Ok(Change::All);
        }
        let tables = match own.tables == structure.tables {
            true => Arc::clone(&self.model.tables),
            false => interpolants(&structure.tables)?.into(),
        };
        let model = Model::new(self.problem, structure.clone(), tables)?;
        if !model.clock.is_same(&self.model.clock) {
            *self = Self::with(self.problem, model.structure)?;
            return Ok(Change::All);
        }
        let frame = model.frame(self.problem);
        let mut bounds = rows::variable_bounds(&frame)?;
        self.elements.take_data(&frame)?;
        let decided = contradictions::decided(&frame, &self.elements, &mut bounds)?;
        self.linear = decided.system;
        let Limits { alike, angles, .. } = std::mem::take(&mut self.limits);
        self.limits = Limits { alike, angles, ..limits(&model.structure, &self.elements, (&bounds, &decided.met)) };
        self.limits.definitions = self.elements.definitions(&self.model.layout, &self.limits);
        self.model = Arc::new(model);
        self.own_bounds = OnceLock::new();
        self.find_durations(&decided.longest);
        self.limits.shrinking = self.shrinking();
        Ok(Change::Data)
    }

    /// Takes what rounding left of values that boundary conditions alone decide: a level of -1e-22 has no root where it starts at 0.
    pub(crate) fn round_to_known_ends(&self, x: &mut [f64]) {
        /// What is so near, by its size, is rounding. A law: that of a sum of tens of terms.
        const ROUNDING: f64 = 64.0 * f64::EPSILON;
        let outputs = self.model.layout.phases.iter().flat_map(|phase| &phase.outputs);
        for variable in outputs.flat_map(|output| [output.coefficients.first(), output.coefficients.last()]).flatten() {
            let of = *variable as usize;
            let known = self.linear.value(&slots::AffineMap { terms: vec![(*variable, 1.0)], offset: 0.0 });
            if let Some(value) = known.filter(|value| (value - x[of]).abs() <= ROUNDING * self.limits.scale[of]) {
                x[of] = value;
            }
        }
    }

    /// Everything but the problem.
    pub(crate) fn keep(self) -> Kept {
        let Self { model, elements, limits, linear, durations, .. } = self;
        Kept { model, elements, limits, linear, durations }
    }

    /// How many of the variables are spline coefficients; the others (free durations, free
    /// starts, declared variables, integrals) follow them.
    pub fn coefficients(&self) -> usize {
        self.model.layout.coefficients
    }

    /// Whether every constraint is linear: then points that violate them least have no others beside them.
    pub(crate) fn is_linear(&self) -> bool {
        let groups = &self.model.structure.groups;
        let is_cost = |row: &Row| matches!(row, Row::Cost { .. });
        self.elements.batches.iter().all(|batch| {
            let rows = groups[batch.group].rows.iter().zip(&batch.degree);
            rows.into_iter().all(|(row, degree)| is_cost(row) || matches!(degree, Degree::Constant | Degree::Linear))
        })
    }

    /// Everything that gives calls their meaning.
    pub(crate) fn frame(&self) -> Frame<'_> {
        self.model.frame(self.problem)
    }

    /// An entry of an evaluation at `x` that is not finite, in the user's words: the subexpression, and the point in time.
    pub fn in_words(&self, what: ntg_nlp::NotFinite, x: &[f64]) -> NotFinite {
        fault::words(self, what, x)
    }

    /// What row `row` of the program is, in the user's words: "`turn` at t = 12.5 s".
    pub fn row_name(&self, row: usize) -> String {
        let Some(info) = self.elements.rows.get(row) else { return format!("row {row}") };
        let structure = &self.model.structure;
        let words = match info.kind {
            RowKind::Constraint(constraint) => {
                rows::constraint_words(&structure.constraints[constraint], &info.indices)
            }
            RowKind::Integral(integral) => format!("the integral `{}`", structure.integrals[integral].place.text),
        };
        match names::fixed_point(structure, &self.model.layout, &info.point) {
            point if point.is_empty() => words,
            point => format!("{words} at {point}"),
        }
    }

    /// The unit of the spec in which row `row` is shown.
    pub fn row_unit(&self, row: usize) -> Unit {
        match self.elements.rows.get(row).map(|info| info.kind) {
            Some(RowKind::Constraint(constraint)) => self.model.structure.constraints[constraint].unit.clone(),
            Some(RowKind::Integral(_)) | None => Unit::default(),
        }
    }

    /// The unit of the spec in which variable `variable` of the program is shown.
    pub fn variable_unit(&self, variable: usize) -> Unit {
        let (structure, layout) = (&self.model.structure, &self.model.layout);
        let is = |candidate: u32| candidate as usize == variable;
        for phase in &layout.phases {
            if let Some(member) = phase.outputs.iter().find(|member| member.coefficients.iter().any(|c| is(*c))) {
                return structure.phases[phase.phase].outputs[member.output].unit.clone();
            }
        }
        let times =
            layout.phases.iter().map(|phase| phase.duration).chain(layout.agents.iter().map(|agent| agent.start));
        if times.into_iter().any(|time| matches!(time, layout::Time::Free(v) if is(v))) {
            return structure.independent.unit.clone();
        }
        let mut variables = structure.variables.iter().zip(&layout.variable_first);
        let found = variables.find(|(declared, first)| {
            let members = instances::family_members(declared.family).len();
            variable.checked_sub(**first as usize).is_some_and(|member| member < members)
        });
        found.map_or_else(Unit::default, |(declared, _)| declared.unit.clone())
    }

    /// What variable `variable` of the program is, in the user's words.
    pub fn variable_name(&self, variable: usize) -> String {
        let (structure, layout) = (&self.model.structure, &self.model.layout);
        let is = |candidate: u32| candidate as usize == variable;
        for phase in 0..layout.phases.len() {
            for (output, member) in layout.phases[phase].outputs.iter().enumerate() {
                if let Some(i) = member.coefficients.iter().position(|c| is(*c)) {
                    return format!("coefficient {} of `{}`", i + 1, names::output(structure, layout, phase, output));
                }
            }
            if matches!(layout.phases[phase].duration, layout::Time::Free(v) if is(v)) {
                return format!("the duration of {}", times::phase_words(structure, layout, phase));
            }
        }
        if let Some(agent) = layout.agents.iter().position(|a| matches!(a.start, layout::Time::Free(v) if is(v))) {
            return format!("the start of agent `{}`", names::agent(structure, layout, agent));
        }
        for (declared, first) in structure.variables.iter().zip(&layout.variable_first) {
            let members = instances::family_members(declared.family);
            if let Some(index) = variable.checked_sub(*first as usize).and_then(|m| members.get(m)) {
                return format!("variable `{}`", names::member(&declared.name, declared.family, *index));
            }
        }
        for (declared, (first, members)) in
            structure.integrals.iter().zip(layout.integral_first.iter().zip(&layout.integral_members))
        {
            if variable.checked_sub(*first as usize).is_some_and(|m| m < members.len()) {
                return format!("the integral `{}`", declared.place.text);
            }
        }
        format!("variable {variable}")
    }
}

/// Whether two structures of one problem differ in values of parameters and tables, guesses and steps of a
/// continuation at most.
fn differs_in_data_only(a: &Structure, b: &Structure) -> bool {
    let sizes = |structure: &Structure| structure.parameters.iter().map(|p| p.value.len()).collect::<Vec<_>>();
    (&a.name, a.maximize, &a.variables, &a.agents, &a.phases)
        == (&b.name, b.maximize, &b.variables, &b.agents, &b.phases)
        && (&a.kernels, &a.groups, &a.constraints) == (&b.kernels, &b.groups, &b.constraints)
        && (&a.norms, &a.angles) == (&b.norms, &b.angles)
        && (&a.terms, &a.integrals) == (&b.terms, &b.integrals)
        && sizes(a) == sizes(b)
}

/// The coefficients of outputs that are angles and do not move, with the change that is a radian: a spline is between its
/// coefficients.
fn angles(structure: &Structure, layout: &Layout) -> Vec<(u32, f64)> {
    let outputs = layout.phases.iter().flat_map(|phase| phase.outputs.iter().map(move |output| (phase.phase, output)));
    let radian = |phase: usize, output: usize| {
        let mut angles = structure.angles.iter().filter(|angle| !angle.moves);
        angles.find(|angle| (angle.phase, angle.output) == (phase, output)).map(|angle| angle.radian)
    };
    let each = outputs.filter_map(|(phase, output)| Some((radian(phase, output.output)?, &output.coefficients)));
    each.flat_map(|(radian, coefficients)| coefficients.iter().map(move |variable| (*variable, radian))).collect()
}

/// Bounds without sizes, and without those of rows that boundary conditions meet.
fn limits(structure: &Structure, elements: &Elements, (bounds, met): (&[(f64, f64)], &[usize])) -> Limits {
    let (mut row_lower, mut row_upper) = (elements.lower.clone(), elements.upper.clone());
    for &row in met {
        (row_lower[row], row_upper[row]) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    let is_norm = |row: &RowInfo| matches!(row.kind, RowKind::Constraint(c) if structure.norms.contains(&c));
    Limits {
        lower: bounds.iter().map(|b| b.0).collect(),
        upper: bounds.iter().map(|b| b.1).collect(),
        scale: vec![1.0; bounds.len()],
        alike: vec![],
        doubtful: vec![],
        relation: elements.relations.of_row.clone(),
        row_lower,
        row_upper,
        norms: if structure.norms.is_empty() { vec![] } else { elements.rows.iter().map(is_norm).collect() },
        definitions: vec![],
        shrinking: vec![],
        angles: vec![],
        row_scale: vec![1.0; elements.rows.len()],
        row_weight: vec![],
        objective_size: None,
        negligible: if is_estimate(structure) { NEGLIGIBLE } else { 0.0 },
    }
}

/// Half a sum of squared ratios to standard deviations that is this far above its least has variables within a ten thousandth of
/// their standard deviations (docs/maths.md, section 17). A choice.
const NEGLIGIBLE: f64 = 1e-8;

/// Whether all that is minimised are residuals of measurements.
fn is_estimate(structure: &Structure) -> bool {
    let is_measured = |term: usize| structure.measurements.iter().any(|measurement| measurement.term == term);
    !structure.terms.is_empty() && (0..structure.terms.len()).all(is_measured)
}

impl Model {
    fn new(problem: &dyn Problem, structure: Structure, tables: Arc<[Table]>) -> Result<Self, SetupError> {
        for parameter in &structure.parameters {
            for (i, value) in parameter.value.iter().enumerate() {
                if !value.is_finite() {
                    let what = format!("parameter `{}`", parameter.element(i));
                    return Err(SetupError::NotFinite { what, value: *value, place: Place::default() });
                }
            }
        }
        let mut layout = Layout::new(&structure)?;
        times::fix(problem, &structure, &tables, &mut layout)?;
        let clock = Clock::fixed(&layout);
        Ok(Self { structure, tables, layout, clock })
    }

    /// Everything that gives calls their meaning.
    pub(crate) fn frame<'a>(&'a self, problem: &'a dyn Problem) -> Frame<'a> {
        let Self { structure, tables, layout, clock } = self;
        Frame { problem, structure, tables, layout, clock }
    }
}
