//! The program whose variables include the parameters, at a solution (docs/maths.md, section 16.1).
//!
//! Takes a solution and the parametric form of its problem; gives the transcription of that form with the point and
//! the multipliers of the solution, and how fast every bound moves with every parameter. Finds: problems that are not
//! of one spec.

use crate::problem::Problem;
use crate::solution::Inner;
use crate::transcribe::batch::batches;
use crate::transcribe::frame::Frame;
use crate::transcribe::instances::family_members;
use crate::transcribe::layout::{Layout, Time, narrow};
use crate::transcribe::node::Site;
use crate::transcribe::points::Point;
use crate::transcribe::rows::{RowInfo, RowKind};
use crate::transcribe::{Kept, SetupError, Transcription};
use ntg_nlp::BlockValues;
use ntg_splines::Side;
use ntg_structure::{Bounds, Call, Duration, Row, Start, Structure};
use std::collections::hash_map::Entry;
use std::collections::{HashMap, VecDeque};

/// A program at a solution. All vectors are those of the parametric program.
pub(super) struct AtSolution<'p> {
    pub(super) nlp: Transcription<'p>,
    pub(super) x: Vec<f64>,
    pub(super) row_multipliers: Vec<f64>,
    pub(super) bound_multipliers: Vec<f64>,
    /// The bounds of rows and variables that parameters may move.
    pub(super) rows: Vec<Limit>,
    pub(super) variables: Vec<Limit>,
    /// The variable that is each variable of the solution.
    pub(super) image: Vec<u32>,
    /// The row that is each row of the solution.
    pub(super) row_image: Vec<u32>,
    /// The first variable of each parameter.
    pub(super) parameters: Vec<u32>,
    /// Variables whose bounds decide others' bounds: fixed starts and durations, in order of time.
    times: Vec<u32>,
}

/// The bounds of a row or of a variable.
#[derive(Clone, Debug, Default)]
pub(super) struct Limit {
    lower: Bound,
    upper: Bound,
}

/// A bound, and its derivatives by variables that stand for parameters and fixed times.
#[derive(Clone, Debug)]
struct Bound {
    value: f64,
    slope: Vec<(u32, f64)>,
}

impl Default for Bound {
    fn default() -> Self {
        Self { value: f64::NAN, slope: vec![] }
    }
}

impl Limit {
    /// How fast the bound moves that a multiplier of this sign belongs to, where the held variables move so.
    pub(super) fn rate(&self, multiplier: f64, held: &[f64]) -> f64 {
        let bound = if multiplier < 0.0 { &self.upper } else { &self.lower };
        bound.slope.iter().map(|(variable, slope)| slope * held[*variable as usize]).sum()
    }

    fn pair(&self) -> (f64, f64) {
        let or = |value: f64, none: f64| if value.is_nan() { none } else { value };
        (or(self.lower.value, f64::NEG_INFINITY), or(self.upper.value, f64::INFINITY))
    }
}

impl<'p> AtSolution<'p> {
    /// The parametric program at a solution. `kept` is that of another solution of the same problem; what has not changed
    /// is not made anew.
    pub(super) fn new(problem: &'p dyn Problem, kept: Option<Kept>, solution: &Inner) -> Result<Self, SetupError> {
        let own = &solution.model;
        let full = with_mesh(problem.structure(), &own.structure)?;
        let bare = without_bounds(&full);
        let mut nlp = match kept.map(|kept| kept.of(problem)) {
            Some(mut nlp) => {
                nlp.take(&bare)?;
                nlp
            }
            None => Transcription::with(problem, bare)?,
        };
        let layout = &nlp.model.layout;
        let image = images(&own.structure, &own.layout, layout)?;
        let parameters = layout.variable_first[own.structure.variables.len()..].to_vec();
        let x = point(solution, layout, (&image, &parameters));
        let row_image = row_images(&solution.rows, &nlp.elements.rows)?;
        let mut row_multipliers = vec![0.0; nlp.elements.rows.len()];
        for (row, multiplier) in row_image.iter().zip(&solution.row_multipliers) {
            row_multipliers[*row as usize] = *multiplier;
        }
        let mut bound_multipliers = vec![0.0; x.len()];
        for (variable, multiplier) in image.iter().zip(&solution.bound_multipliers) {
            bound_multipliers[*variable as usize] = *multiplier;
        }
        let rows = row_limits(&nlp, &full, &x)?;
        let (mut variables, times) = variable_limits(&nlp, &full, &x)?;
        for variable in held(&own.structure, &parameters) {
            let value = Bound { value: x[variable as usize], slope: vec![(variable, 1.0)] };
            variables[variable as usize] = Limit { lower: value.clone(), upper: value };
        }
        (nlp.limits.row_lower, nlp.limits.row_upper) = rows.iter().map(Limit::pair).unzip();
        (nlp.limits.lower, nlp.limits.upper) = variables.iter().map(Limit::pair).unzip();
        nlp.set_scales(&x, &crate::settings::Settings::default())?;
        Ok(Self { nlp, x, row_multipliers, bound_multipliers, rows, variables, image, row_image, parameters, times })
    }

    /// How fast every variable moves that parameters hold, by one of these variables.
    pub(super) fn held(&self, parameter: u32) -> Vec<f64> {
        let mut rates = vec![0.0; self.x.len()];
        rates[parameter as usize] = 1.0;
        for variable in &self.times {
            let rate = self.variables[*variable as usize].rate(0.0, &rates);
            rates[*variable as usize] = rate;
        }
        rates
    }
}

/// The variables that stand for parameters, and the one for the scaled time.
fn held(own: &Structure, parameters: &[u32]) -> Vec<u32> {
    let counts = own.parameters.iter().map(|parameter| narrow(parameter.value.len())).chain([1]);
    parameters.iter().zip(counts).flat_map(|(first, count)| *first..first + count).collect()
}

/// The structure of the parametric form with the mesh, the parameters and the tables of a solution.
fn with_mesh(mut full: Structure, own: &Structure) -> Result<Structure, SetupError> {
    let fits = full.phases.len() == own.phases.len()
        && full.parameters.len() == own.parameters.len()
        && full.variables.len() == own.variables.len() + own.parameters.len() + 1
        && full.groups.len() == own.groups.len();
    if !fits {
        return Err(SetupError::malformed("the parametric form is that of another problem"));
    }
    for (phase, solved) in full.phases.iter_mut().zip(&own.phases) {
        phase.outputs.clone_from(&solved.outputs);
        phase.points.clone_from(&solved.points);
    }
    full.parameters.clone_from(&own.parameters);
    full.tables.clone_from(&own.tables);
    Ok(full)
}

/// The structure with every bound left out: what parameters decide is free.
fn without_bounds(full: &Structure) -> Structure {
    let mut bare = full.clone();
    for group in &mut bare.groups {
        group.bounds = None;
        for row in &mut group.rows {
            if let Row::Constraint { lower, upper, .. } = row {
                (*lower, *upper) = (None, None);
            }
        }
    }
    let free = |bounds: &mut Bounds| *bounds = Bounds::default();
    bare.variables.iter_mut().for_each(|variable| free(&mut variable.bounds));
    for phase in &mut bare.phases {
        if let Duration::Free(bounds) = &mut phase.duration {
            free(bounds);
        }
    }
    for agent in &mut bare.agents {
        if let Start::Free(bounds) = &mut agent.start {
            free(bounds);
        }
    }
    bare
}

/// For every variable of the solution the one of the parametric program.
fn images(structure: &Structure, own: &Layout, other: &Layout) -> Result<Vec<u32>, SetupError> {
    let another = || SetupError::malformed("the parametric form has other variables");
    if own.coefficients != other.coefficients || own.phases.len() != other.phases.len() {
        return Err(another());
    }
    let mut image: Vec<u32> = (0..narrow(own.variables)).collect();
    let mut time = |own: Time, other: Time| {
        if let (Time::Free(from), Time::Free(to)) = (own, other) {
            image[from as usize] = to;
        }
    };
    own.phases.iter().zip(&other.phases).for_each(|(own, other)| time(own.duration, other.duration));
    own.agents.iter().zip(&other.agents).for_each(|(own, other)| time(own.start, other.start));
    for ((variable, from), to) in structure.variables.iter().zip(&own.variable_first).zip(&other.variable_first) {
        (0..narrow(family_members(variable.family).len())).for_each(|i| image[(from + i) as usize] = to + i);
    }
    let integrals = own.integral_first.iter().zip(&other.integral_first).zip(&own.integral_members);
    for ((from, to), members) in integrals {
        (0..narrow(members.len())).for_each(|i| image[(from + i) as usize] = to + i);
    }
    Ok(image)
}

/// The solution as a point of the parametric program.
fn point(solution: &Inner, layout: &Layout, (image, parameters): (&[u32], &[u32])) -> Vec<f64> {
    let own = &solution.model;
    let mut x = vec![0.0; layout.variables];
    for (variable, value) in image.iter().zip(&solution.x) {
        x[*variable as usize] = *value;
    }
    let mut time = |own: Time, other: Time| {
        if let (Time::Fixed(value), Time::Free(to)) = (own, other) {
            x[to as usize] = value;
        }
    };
    own.layout.phases.iter().zip(&layout.phases).for_each(|(own, other)| time(own.duration, other.duration));
    own.layout.agents.iter().zip(&layout.agents).for_each(|(own, other)| time(own.start, other.start));
    for (parameter, first) in own.structure.parameters.iter().zip(parameters) {
        x[*first as usize..][..parameter.value.len()].copy_from_slice(&parameter.value);
    }
    x
}

/// What a row stands for, where, and for which members.
type RowKey<'a> = (bool, usize, &'a [i64], Option<usize>, u64, bool);

fn key(row: &RowInfo) -> RowKey<'_> {
    let (integral, number) = match row.kind {
        RowKind::Constraint(number) => (false, number),
        RowKind::Integral(number) => (true, number),
    };
    let Point { phase, tau, side, .. } = row.point;
    (integral, number, &row.indices, phase, tau.to_bits(), side == Side::Left)
}

/// For every row of the solution the one of the parametric program, whose elements may have other shapes.
fn row_images<'a>(own: &'a [RowInfo], other: &'a [RowInfo]) -> Result<Vec<u32>, SetupError> {
    let mut places: HashMap<RowKey<'a>, VecDeque<u32>> = HashMap::new();
    for (place, row) in other.iter().enumerate() {
        places.entry(key(row)).or_default().push_back(narrow(place));
    }
    let image = |row: &'a RowInfo| places.get_mut(&key(row)).and_then(VecDeque::pop_front);
    let found: Option<Vec<u32>> = own.iter().map(image).collect();
    found
        .filter(|found| found.len() == other.len())
        .ok_or_else(|| SetupError::malformed("the parametric form has other rows"))
}

/// The bounds of all rows.
fn row_limits(nlp: &Transcription, full: &Structure, x: &[f64]) -> Result<Vec<Limit>, SetupError> {
    let frame = nlp.frame();
    let mut known: HashMap<(usize, &[i64]), Vec<Bound>> = HashMap::new();
    let zero = || Bound { value: 0.0, slope: vec![] };
    let mut limits = vec![];
    for row in &nlp.elements.rows {
        let (block, _, own) = row.maker;
        let group = nlp.elements.batches.get(block).map(|batch| (batch.group, &full.groups[batch.group]));
        let Some((number, group)) = group else {
            // The definition of an integral.
            limits.push(Limit { lower: zero(), upper: zero() });
            continue;
        };
        let Row::Constraint { lower, upper, .. } = &group.rows[own] else {
            return Err(SetupError::malformed("a row is made by what is no constraint"));
        };
        let found = match known.entry((number, &row.indices[..])) {
            Entry::Occupied(found) => found.into_mut(),
            Entry::Vacant(place) => {
                place.insert(group.bounds.as_ref().map_or(Ok(vec![]), |call| bounds(&frame, call, &row.indices, x))?)
            }
        };
        let pick = |at: &Option<usize>| at.and_then(|at| found.get(at).cloned()).unwrap_or_default();
        limits.push(Limit { lower: pick(lower), upper: pick(upper) });
    }
    Ok(limits)
}

/// The bounds of all variables; and those that fixed starts and durations are, in order of time.
fn variable_limits(nlp: &Transcription, full: &Structure, x: &[f64]) -> Result<(Vec<Limit>, Vec<u32>), SetupError> {
    let (frame, layout) = (nlp.frame(), &nlp.model.layout);
    let mut limits = vec![Limit::default(); x.len()];
    let mut times = vec![];
    let limit = |declared: &Bounds, indices: &[i64]| -> Result<Limit, SetupError> {
        let found = declared.call.as_ref().map_or(Ok(vec![]), |call| bounds(&frame, call, indices, x))?;
        let pick = |at: Option<usize>| at.and_then(|at| found.get(at).cloned()).unwrap_or_default();
        Ok(Limit { lower: pick(declared.lower), upper: pick(declared.upper) })
    };
    for agent in &layout.agents {
        if let (Start::Free(declared), Time::Free(variable)) = (&full.agents[agent.agent].start, agent.start) {
            limits[variable as usize] = limit(declared, &Vec::from_iter(agent.index))?;
            times.push((declared, variable));
        }
        for phase in agent.phases.clone() {
            let member = &layout.phases[phase];
            if let (Duration::Free(declared), Time::Free(variable)) =
                (&full.phases[member.phase].duration, member.duration)
            {
                limits[variable as usize] = limit(declared, &frame.phase_indices(phase))?;
                times.push((declared, variable));
            }
        }
    }
    for (declared, first) in full.variables.iter().zip(&layout.variable_first) {
        for (member, index) in family_members(declared.family).into_iter().enumerate() {
            limits[*first as usize + member] = limit(&declared.bounds, &Vec::from_iter(index))?;
        }
    }
    let is_fixed = |declared: &Bounds| declared.call.is_some() && declared.lower == declared.upper;
    Ok((limits, times.into_iter().filter(|(declared, _)| is_fixed(declared)).map(|(_, variable)| variable).collect()))
}

/// The results of a call that depends on held variables alone, with their derivatives.
fn bounds(frame: &Frame, call: &Call, indices: &[i64], x: &[f64]) -> Result<Vec<Bound>, SetupError> {
    let site = Site { indices: indices.to_vec(), point: Point::NONE };
    let mut found = vec![];
    for batch in batches(frame, call, vec![site])? {
        let kernels = &frame.structure.kernels;
        let [jacobian, hessian] = batch.patterns(kernels);
        let mut out = BlockValues {
            values: vec![0.0; batch.node.rows],
            jacobian: vec![0.0; jacobian.len()],
            hessian: vec![0.0; hessian.len()],
        };
        batch.derivatives(frame.problem, kernels, frame.tables, x, &mut batch.work(), &mut out);
        found.extend(out.values.iter().map(|value| Bound { value: *value, slope: vec![] }));
        for ((row, slot), slope) in jacobian.into_iter().zip(&out.jacobian) {
            let terms = frame.layout.affine(batch.sources()[slot], &Point::NONE).terms;
            found[row].slope.extend(terms.into_iter().map(|(variable, c)| (variable, slope * c)));
        }
    }
    Ok(found)
}
