//! The program whose variables include the parameters, at a solution (docs/maths.md, section 16.1).
//!
//! Takes a solution and the parametric form of its problem; gives the transcription of that form with the point and
//! the multipliers of the solution, and how fast bounds move with parameters. The form is made once for a mesh: what
//! parameters decide are numbers at a solution. Finds: problems that are not of one spec.

use crate::problem::Problem;
use crate::solution::Inner;
use crate::transcribe::batch::{Batch, batches};
use crate::transcribe::frame::Frame;
use crate::transcribe::instances::family_members;
use crate::transcribe::layout::{Layout, Time, narrow};
use crate::transcribe::node::Site;
use crate::transcribe::points::Point;
use crate::transcribe::rows::{RowInfo, RowKey};
use crate::transcribe::{Kept, Model, SetupError, Transcription};
use ntg_nlp::BlockValues;
use ntg_structure::{Bounds, Call, Duration, Phase, Row, Start, Structure};
use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap, VecDeque};
use std::sync::Arc;

/// The parametric form of a problem on one mesh: all that the values of its parameters do not change.
pub(super) struct Form {
    /// The model of derivatives: that of the form, where times that nothing moves are 0.
    pub(super) moving: Arc<Model>,
    /// The variable that is each variable of the solution.
    pub(super) image: Arc<[u32]>,
    /// The row that is each row of the solution.
    pub(super) row_image: Arc<[u32]>,
    /// The first variable of each parameter.
    pub(super) parameters: Vec<u32>,
    /// What bounds are: 0, none, the values of the variables `held`, the results of the `calls`.
    held: Vec<u32>,
    calls: Vec<Batch>,
    /// The bounds of rows and variables.
    rows: Vec<Limit>,
    variables: Vec<Limit>,
    /// Variables whose bounds decide others' bounds: fixed starts and durations, in order of time.
    times: Vec<u32>,
}

/// The form at a solution. All vectors are those of the parametric program.
pub(super) struct AtSolution<'p> {
    pub(super) nlp: Transcription<'p>,
    pub(super) x: Vec<f64>,
    pub(super) row_multipliers: Vec<f64>,
    pub(super) bound_multipliers: Vec<f64>,
    bounds: Vec<Bound>,
}

/// The numbers of the bounds of a row or of a variable.
#[derive(Clone, Copy, Debug)]
struct Limit {
    lower: usize,
    upper: usize,
}

/// The number of the bound 0, and the number of none.
const ZERO: usize = 0;
const NONE: usize = 1;

/// A bound, and its derivatives by variables that stand for parameters and fixed times.
#[derive(Clone, Debug)]
struct Bound {
    value: f64,
    slope: Vec<(u32, f64)>,
}

/// How fast the bounds of a program move with one parameter: the rows and the variables whose bounds do.
#[derive(Clone, Debug, Default)]
pub(super) struct Rates {
    pub(super) rows: Vec<(usize, f64)>,
    pub(super) variables: Vec<(usize, f64)>,
}

impl Limit {
    /// The bound that a multiplier of this sign belongs to.
    fn of_multiplier(self, multiplier: f64) -> usize {
        if multiplier < 0.0 { self.upper } else { self.lower }
    }

    fn pair(self, bounds: &[Bound]) -> (f64, f64) {
        let or = |bound: usize, none: f64| if bound == NONE { none } else { bounds[bound].value };
        (or(self.lower, f64::NEG_INFINITY), or(self.upper, f64::INFINITY))
    }
}

impl Form {
    /// The form of a problem on the mesh of a solution, with its transcription.
    pub(super) fn new<'p>(problem: &'p dyn Problem, solution: &Inner) -> Result<(Self, Transcription<'p>), SetupError> {
        let own = &solution.model;
        let full = with_mesh(problem.structure(), &own.structure)?;
        let nlp = Transcription::with(problem, without_bounds(&full))?;
        let layout = &nlp.model.layout;
        let image = images(&own.structure, &own.layout, layout)?;
        let parameters = layout.variable_first[own.structure.variables.len()..].to_vec();
        let row_image = row_images(&solution.rows, &nlp.elements.rows)?;
        let held = held(&own.structure, &parameters);
        let mut calls = Calls { found: vec![], next: NONE + 1 + held.len() };
        let rows = row_limits(&nlp, &full, &mut calls)?;
        let (mut variables, times) = variable_limits(&nlp, &full, &mut calls)?;
        for (variable, bound) in held.iter().zip(NONE + 1..) {
            variables[*variable as usize] = Limit { lower: bound, upper: bound };
        }
        let (moving, calls) = (Arc::new(moving(&nlp.model)), calls.found);
        let (image, row_image) = (image.into(), row_image.into());
        Ok((Self { moving, image, row_image, parameters, held, calls, rows, variables, times }, nlp))
    }

    /// Whether this is the form for a solution of the same problem.
    pub(super) fn fits(&self, transcription: &Kept, solution: &Inner) -> bool {
        let (form, own) = (&transcription.model.structure, &solution.model.structure);
        let phases = |(a, b): (&Phase, &Phase)| a.outputs == b.outputs && a.points == b.points;
        let members = |structure: &Structure| structure.parameters.iter().map(|p| p.value.len()).collect::<Vec<_>>();
        let rows = &transcription.elements.rows;
        let same = |(own, image): (&RowInfo, &u32)| own.key() == rows[*image as usize].key();
        form.phases.len() == own.phases.len()
            && form.phases.iter().zip(&own.phases).all(phases)
            && form.tables == own.tables
            && members(form) == members(own)
            && self.image.len() == solution.x.len()
            && self.row_image.len() == solution.rows.len()
            && solution.rows.iter().zip(&*self.row_image).all(same)
    }

    /// The form at a solution.
    pub(super) fn at<'p>(&self, mut nlp: Transcription<'p>, solution: &Inner) -> AtSolution<'p> {
        let x = point(solution, &nlp.model.layout, (&self.image, &self.parameters));
        let mut row_multipliers = vec![0.0; nlp.elements.rows.len()];
        for (row, multiplier) in self.row_image.iter().zip(&solution.row_multipliers) {
            row_multipliers[*row as usize] = *multiplier;
        }
        let (mut bound_multipliers, mut sizes) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        let own = solution.bound_multipliers.iter().zip(&solution.sizes);
        for (variable, (multiplier, size)) in self.image.iter().zip(own) {
            (bound_multipliers[*variable as usize], sizes[*variable as usize]) = (*multiplier, *size);
        }
        let constant = |value: f64| Bound { value, slope: vec![] };
        let mut bounds = vec![constant(0.0), constant(f64::NAN)];
        bounds.extend(self.held.iter().map(|held| Bound { value: x[*held as usize], slope: vec![(*held, 1.0)] }));
        self.calls.iter().for_each(|call| results(&nlp.frame(), call, &x, &mut bounds));
        (nlp.limits.row_lower, nlp.limits.row_upper) = self.rows.iter().map(|limit| limit.pair(&bounds)).unzip();
        (nlp.limits.lower, nlp.limits.upper) = self.variables.iter().map(|limit| limit.pair(&bounds)).unzip();
        nlp.set_scales_at(&x, &sizes);
        AtSolution { nlp, x, row_multipliers, bound_multipliers, bounds }
    }

    /// How fast the bounds of rows and variables move that multipliers belong to, for each of these parameters.
    pub(super) fn rates(&self, program: &AtSolution<'_>, parameters: &[u32]) -> Vec<Rates> {
        let mut moved: HashMap<u32, Vec<(usize, f64)>> = HashMap::new(); // Looked up, never iterated.
        for (number, parameter) in parameters.iter().enumerate() {
            moved.entry(*parameter).or_default().push((number, 1.0));
        }
        let total = |moved: &HashMap<u32, Vec<(usize, f64)>>, bound: &Bound| {
            let terms = bound.slope.iter().filter_map(|(variable, slope)| Some((moved.get(variable)?, slope)));
            let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
            for (number, rate, slope) in terms.flat_map(|(rates, slope)| rates.iter().map(move |(k, r)| (*k, r, slope)))
            {
                *sum.entry(number).or_default() += slope * rate;
            }
            sum.into_iter().filter(|(_, rate)| *rate != 0.0).collect::<Vec<_>>()
        };
        for time in &self.times {
            let rates = total(&moved, &program.bounds[self.variables[*time as usize].lower]);
            moved.insert(*time, rates);
        }
        let of_bounds: Vec<_> = program.bounds.iter().map(|bound| total(&moved, bound)).collect();
        let mut found = vec![Rates::default(); parameters.len()];
        for (row, (limit, multiplier)) in self.rows.iter().zip(&program.row_multipliers).enumerate() {
            let rates = &of_bounds[limit.of_multiplier(*multiplier)];
            rates.iter().for_each(|(number, rate)| found[*number].rows.push((row, *rate)));
        }
        for (variable, (limit, multiplier)) in self.variables.iter().zip(&program.bound_multipliers).enumerate() {
            let rates = &of_bounds[limit.of_multiplier(*multiplier)];
            rates.iter().for_each(|(number, rate)| found[*number].variables.push((variable, *rate)));
        }
        found
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
    for (number, solved) in own.relaxations.iter().enumerate() {
        full.pose(number, solved.is_exact);
    }
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

/// For every row of the solution the one of the parametric program, whose elements may have other shapes.
fn row_images<'a>(own: &'a [RowInfo], other: &'a [RowInfo]) -> Result<Vec<u32>, SetupError> {
    let mut places: HashMap<RowKey<'a>, VecDeque<u32>> = HashMap::new();
    for (place, row) in other.iter().enumerate() {
        places.entry(row.key()).or_default().push_back(narrow(place));
    }
    let image = |row: &'a RowInfo| places.get_mut(&row.key()).and_then(VecDeque::pop_front);
    let found: Option<Vec<u32>> = own.iter().map(image).collect();
    found
        .filter(|found| found.len() == other.len())
        .ok_or_else(|| SetupError::malformed("the parametric form has other rows"))
}

/// Calls whose results are bounds, and the number of the next bound.
struct Calls {
    found: Vec<Batch>,
    next: usize,
}

impl Calls {
    /// The number of the first result of a call.
    fn add(&mut self, frame: &Frame, call: &Call, indices: &[i64]) -> Result<usize, SetupError> {
        let first = self.next;
        for batch in batches(frame, call, vec![Site { indices: indices.to_vec(), point: Point::NONE }])? {
            self.next += batch.node.rows;
            self.found.push(batch);
        }
        Ok(first)
    }

    fn limit(&mut self, frame: &Frame, declared: &Bounds, indices: &[i64]) -> Result<Limit, SetupError> {
        let first = declared.call.as_ref().map(|call| self.add(frame, call, indices)).transpose()?;
        Ok(limit(first, declared.lower, declared.upper))
    }
}

/// Two results of the call whose first result has a number.
fn limit(first: Option<usize>, lower: Option<usize>, upper: Option<usize>) -> Limit {
    let number = |at: Option<usize>| first.zip(at).map_or(NONE, |(first, at)| first + at);
    Limit { lower: number(lower), upper: number(upper) }
}

/// The bounds of all rows.
fn row_limits(nlp: &Transcription, full: &Structure, calls: &mut Calls) -> Result<Vec<Limit>, SetupError> {
    let frame = nlp.frame();
    let mut known: HashMap<(usize, &[i64]), Option<usize>> = HashMap::new();
    let mut limits = vec![];
    for row in &nlp.elements.rows {
        let (block, _, own) = row.maker;
        let group = nlp.elements.batches.get(block).map(|batch| (batch.group, &full.groups[batch.group]));
        let Some((number, group)) = group else {
            // The definition of an integral.
            limits.push(Limit { lower: ZERO, upper: ZERO });
            continue;
        };
        let Row::Constraint { constraint, lower, upper } = &group.rows[own] else {
            return Err(SetupError::malformed("a row is made by what is no constraint"));
        };
        if !full.is_posed(*constraint) {
            limits.push(Limit { lower: NONE, upper: NONE });
            continue;
        }
        let first = match known.entry((number, &row.indices[..])) {
            Entry::Occupied(found) => *found.get(),
            Entry::Vacant(place) => {
                let call = group.bounds.as_ref();
                *place.insert(call.map(|call| calls.add(&frame, call, &row.indices)).transpose()?)
            }
        };
        limits.push(limit(first, *lower, *upper));
    }
    Ok(limits)
}

/// The bounds of all variables; and those that fixed starts and durations are, in order of time.
fn variable_limits(
    nlp: &Transcription,
    full: &Structure,
    calls: &mut Calls,
) -> Result<(Vec<Limit>, Vec<u32>), SetupError> {
    let (frame, layout) = (nlp.frame(), &nlp.model.layout);
    let mut limits = vec![Limit { lower: NONE, upper: NONE }; layout.variables];
    let mut times = vec![];
    for agent in &layout.agents {
        if let (Start::Free(declared), Time::Free(variable)) = (&full.agents[agent.agent].start, agent.start) {
            limits[variable as usize] = calls.limit(&frame, declared, &Vec::from_iter(agent.index))?;
            times.push((declared, variable));
        }
        for phase in agent.phases.clone() {
            let member = &layout.phases[phase];
            if let (Duration::Free(declared), Time::Free(variable)) =
                (&full.phases[member.phase].duration, member.duration)
            {
                limits[variable as usize] = calls.limit(&frame, declared, &frame.phase_indices(phase))?;
                times.push((declared, variable));
            }
        }
    }
    for (declared, first) in full.variables.iter().zip(&layout.variable_first) {
        for (member, index) in family_members(declared.family).into_iter().enumerate() {
            limits[*first as usize + member] = calls.limit(&frame, &declared.bounds, &Vec::from_iter(index))?;
        }
    }
    let is_fixed = |declared: &Bounds| declared.call.is_some() && declared.lower == declared.upper;
    Ok((limits, times.into_iter().filter(|(declared, _)| is_fixed(declared)).map(|(_, variable)| variable).collect()))
}

/// Adds the results of a call that depends on held variables alone, with their derivatives.
fn results(frame: &Frame, batch: &Batch, x: &[f64], bounds: &mut Vec<Bound>) {
    let kernels = &frame.structure.kernels;
    let [jacobian, hessian] = batch.patterns(kernels);
    let mut out = BlockValues {
        values: vec![0.0; batch.node.rows],
        jacobian: vec![0.0; jacobian.len()],
        hessian: vec![0.0; hessian.len()],
    };
    batch.derivatives(frame.problem, kernels, frame.tables, x, &mut batch.work(), &mut out);
    let first = bounds.len();
    bounds.extend(out.values.iter().map(|value| Bound { value: *value, slope: vec![] }));
    for ((row, slot), slope) in jacobian.into_iter().zip(&out.jacobian) {
        let terms = frame.layout.affine(batch.sources()[slot], &Point::NONE).terms;
        bounds[first + row].slope.extend(terms.into_iter().map(|(variable, c)| (variable, slope * c)));
    }
}

/// The model in which derivatives of times are looked up as times are: what is fixed does not move.
fn moving(model: &Model) -> Model {
    let mut moving = model.clone();
    let still = |time: &mut Time| {
        if let Time::Fixed(seconds) = time {
            *seconds = 0.0;
        }
    };
    moving.layout.phases.iter_mut().for_each(|phase| still(&mut phase.duration));
    moving.layout.agents.iter_mut().for_each(|agent| still(&mut agent.start));
    moving
}
