//! From a program and its solution to the [`Statement`] of what holds.
//!
//! Families are expanded, and every call becomes functions whose inputs are splines and numbers. A constraint along a
//! phase that the transcription holds at several sets of points is one subject: it is to hold at all times.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Range;

use ntg_compiler::expr::Node as ExprNode;
use ntg_compiler::program::{KernelBody, Program};
use ntg_runtime::solution::{Meaning, Solution};
use ntg_runtime::transcribe::SetupError;
use ntg_splines::Extrapolation;
use ntg_structure::{At, Block, Call, Domain, Group, Instant, ReduceOp, Row, Slot, Structure};

use crate::statement::{
    Flat, Function, Graph, Input, Join, Kind, Node, Number, Over, Phase, Quantity, Spline, Statement, Subject, Summand,
    Table,
};

/// A member of an integral or a constraint.
type Member = (usize, Vec<i64>);

/// Spells out what a program says about a solution. `spec` is the text of the spec.
///
/// # Errors
/// [`SetupError`] where an index is outside its family, which a problem that was solved does not have.
pub fn statement(program: &Program, solution: &Solution, spec: &str) -> Result<Statement, SetupError> {
    let mut collector = Collector::new(program, solution, spec);
    collector.integrals()?;
    collector.constraints()?;
    collector.terms()?;
    collector.named()?;
    Ok(collector.out)
}

struct Collector<'a> {
    structure: &'a Structure,
    solution: &'a Solution,
    out: Statement,
    /// The first of the numbers that is a duration, and the first of each parameter.
    durations: usize,
    parameters: Vec<usize>,
    variables: usize,
    flats: HashMap<(usize, usize), usize>, // Looked up, never iterated.
    members: BTreeMap<Member, usize>,
}

impl<'a> Collector<'a> {
    fn new(program: &'a Program, solution: &'a Solution, spec: &str) -> Self {
        // Of a solution of a tightened problem the formulas are still those of the program.
        let structure = &program.structure;
        let mut out = Statement { problem: structure.name.clone(), spec: spec.to_owned(), ..Statement::default() };
        let mut parameters = vec![];
        for parameter in &solution.structure().parameters {
            parameters.push(out.numbers.len());
            out.numbers.extend(
                parameter
                    .value
                    .iter()
                    .enumerate()
                    .map(|(i, value)| Number { name: parameter.element(i), value: *value }),
            );
        }
        let durations = out.numbers.len();
        for phase in solution.phases() {
            let path = if phase.name.is_empty() { "the whole".to_owned() } else { phase.name.clone() };
            out.numbers.push(Number { name: format!("start({path})"), value: phase.start });
            out.numbers.push(Number { name: format!("duration({path})"), value: f64::NAN });
            let start = out.numbers.len() - 2;
            out.phases.push(Phase { name: phase.name, start, duration: start + 1, cuts: vec![] });
        }
        let variables = out.numbers.len();
        let coefficients = solution.spline_coefficients().len();
        out.numbers.extend(
            solution.coefficients()[coefficients..]
                .iter()
                .enumerate()
                .map(|(i, value)| Number { name: format!("variable {}", coefficients + i), value: *value }),
        );
        for view in solution.splines() {
            let (order, knots) = (view.knots.order(), view.knots.knots().to_vec());
            let (name, phase) = (view.name, view.phase);
            out.phases[phase].cuts.extend(view.knots.breakpoints());
            out.splines.push(Spline { name, phase, order, knots, coefficients: view.coefficients });
        }
        let places = places(structure);
        for (phase, duration) in out.phases.iter_mut().zip(solution.durations()) {
            phase.cuts.extend([0.0, 1.0]);
            phase.cuts.sort_by(f64::total_cmp);
            phase.cuts.dedup();
            for instant in &places {
                add_cut(&mut phase.cuts, instant.tau());
            }
            out.numbers[phase.duration].value = duration;
        }
        out.tables = structure
            .tables
            .iter()
            .zip(solution.tables())
            .map(|(declared, table)| Table {
                name: declared.name.clone(),
                axes: table.parts(),
                linear_outside: table.extrapolation() == Extrapolation::Linear,
                coefficients: table.coefficients().to_vec(),
            })
            .collect();
        out.graphs = program.kernels.iter().map(graph).collect();
        let (flats, members) = (HashMap::new(), BTreeMap::new());
        Self { structure, solution, out, durations, parameters, variables, flats, members }
    }

    /// Every member of a group's loops with where it is taken.
    fn sites(&self, group: &Group) -> Result<Vec<(Vec<i64>, Over)>, SetupError> {
        let members = Solution::members(&group.loops).into_iter();
        members.map(|indices| self.over(&group.domain, &indices).map(|over| (indices, over))).collect()
    }

    fn over(&self, domain: &Domain, indices: &[i64]) -> Result<Over, SetupError> {
        Ok(match domain {
            Domain::Mission => Over::Nowhere,
            Domain::Start(phase) => Over::Start(self.solution.phase_index(phase, indices)?),
            Domain::End(phase) => Over::End(self.solution.phase_index(phase, indices)?),
            Domain::Path { phase, .. } => Over::Phase(self.solution.phase_index(phase, indices)?),
        })
    }

    /// The cells of a phase that a domain covers.
    fn cells(&self, phase: usize, domain: &Domain) -> Range<usize> {
        let phase = &self.out.phases[phase];
        match domain {
            Domain::Path { part, .. } => {
                let last = if part.to == Instant::END { phase.cells().end } else { cell_from(&phase.cuts, part.to) };
                cell_from(&phase.cuts, part.from)..last
            }
            _ => phase.cells(),
        }
    }

    /// Calls `add` with every row of every member of every group.
    fn rows(
        &mut self,
        mut add: impl FnMut(&mut Self, &Group, usize, (&[i64], Over)) -> Result<(), SetupError>,
    ) -> Result<(), SetupError> {
        let structure = self.structure;
        for group in structure.groups.iter().chain(&structure.shown) {
            for (indices, over) in self.sites(group)? {
                for row in 0..group.rows.len() {
                    add(self, group, row, (&indices, over))?;
                }
            }
        }
        Ok(())
    }

    /// Whether a group evaluates what the spec writes, in place of helpers.
    fn is_written(&self, group: &Group) -> bool {
        self.structure.shown.iter().any(|own| std::ptr::eq(own, group))
    }

    /// Integrals that enter nonlinearly: first a place for each member, then their summands.
    fn integrals(&mut self) -> Result<(), SetupError> {
        let structure = self.structure;
        for (number, integral) in structure.integrals.iter().enumerate() {
            for member in Solution::members(&integral.loops) {
                self.members.insert((number, member), self.out.integrals.len());
                self.out.integrals.push(vec![]);
            }
        }
        self.rows(|this, group, row, (indices, over)| {
            let Row::Integral { integral, index } = &group.rows[row] else { return Ok(()) };
            let index: Vec<i64> = index.iter().map(|affine| affine.at(indices)).collect();
            let function = this.function(&group.call, row, indices)?;
            if let Some(place) = this.members.get(&(*integral, index)) {
                this.out.integrals[*place].push(Summand { function, over });
            }
            Ok(())
        })
    }

    fn constraints(&mut self) -> Result<(), SetupError> {
        let mut parts: BTreeMap<Member, Vec<Summand>> = BTreeMap::new();
        let shown = self.structure.constraints_shown();
        self.rows(|this, group, row, (indices, over)| {
            let Row::Part { constraint, index } = &group.rows[row] else { return Ok(()) };
            if shown[*constraint] != this.is_written(group) {
                return Ok(());
            }
            let index = index.iter().map(|affine| affine.at(indices)).collect();
            let function = this.function(&group.call, row, indices)?;
            parts.entry((*constraint, index)).or_default().push(Summand { function, over });
            Ok(())
        })?;
        let mut known: BTreeSet<(usize, Vec<i64>, Option<usize>)> = BTreeSet::new(); // A constraint has one part.
        self.rows(|this, group, row, (indices, over)| {
            let Row::Constraint { constraint, lower, upper } = &group.rows[row] else { return Ok(()) };
            if this.structure.constraints[*constraint].block == Block::Corner {
                return Ok(()); // It holds at the points, and nothing is claimed between them.
            }
            if shown[*constraint] != this.is_written(group) {
                return Ok(());
            }
            let along = if let Over::Phase(phase) = over { Some(phase) } else { None };
            if along.is_some() && !known.insert((*constraint, indices.to_vec(), along)) {
                return Ok(());
            }
            let function = this.function(&group.call, row, indices)?;
            let quantity = match over {
                Over::Phase(phase) => Quantity::Path(function, phase, this.cells(phase, &group.domain)),
                over => {
                    let own = [Summand { function, over }];
                    let elsewhere = parts.get(&(*constraint, indices.to_vec())).filter(|_| over == Over::Nowhere);
                    Quantity::Sum(own.iter().chain(elsewhere.into_iter().flatten()).copied().collect())
                }
            };
            let bound = |this: &mut Self, row: &Option<usize>| match (row, &group.bounds) {
                (Some(row), Some(call)) => this.function(call, *row, indices).map(Some),
                _ => Ok(None),
            };
            let below = bound(this, lower)?;
            let above = if lower == upper { below } else { bound(this, upper)? };
            let declared = &this.structure.constraints[*constraint];
            let name = declared.name.as_deref().unwrap_or(&declared.place.text);
            let mut name = this.named_member(name, declared.shown_indices(indices), along);
            // The same text may stand at both ends.
            if let Over::Start(_) | Over::End(_) = over {
                name.push_str(if matches!(over, Over::Start(_)) { " at the start" } else { " at the end" });
            }
            let kind = Kind::Constraint(*constraint);
            this.out.subjects.push(Subject {
                kind,
                name,
                indices: indices.to_vec(),
                quantity,
                unit: declared.unit.clone(),
                bounds: (below, above),
            });
            Ok(())
        })
    }

    fn terms(&mut self) -> Result<(), SetupError> {
        let mut terms: Vec<Vec<Summand>> = vec![vec![]; self.structure.terms.len()];
        let shown = self.structure.terms_shown();
        self.rows(|this, group, row, (indices, over)| {
            let Row::Cost { term } = &group.rows[row] else { return Ok(()) };
            if shown[*term] != this.is_written(group) {
                return Ok(());
            }
            let function = this.function(&group.call, row, indices)?;
            terms[*term].push(Summand { function, over });
            Ok(())
        })?;
        for (term, summands) in terms.into_iter().enumerate() {
            let declared = &self.structure.terms[term];
            let name = declared.name.as_deref().unwrap_or(&declared.place.text).to_owned();
            let (kind, quantity) = (Kind::Term(term), Quantity::Sum(summands));
            let unit = declared.unit.clone();
            self.out.subjects.push(Subject { kind, name, indices: vec![], quantity, unit, bounds: (None, None) });
        }
        Ok(())
    }

    fn named(&mut self) -> Result<(), SetupError> {
        let structure = self.structure;
        for (number, named) in structure.named.iter().enumerate() {
            for indices in Solution::members(&named.loops) {
                let over = self.over(&named.domain, &indices)?;
                let function = self.function(&named.call, 0, &indices)?;
                let (quantity, along) = match over {
                    Over::Phase(phase) => {
                        (Quantity::Path(function, phase, self.cells(phase, &named.domain)), Some(phase))
                    }
                    over => (Quantity::Sum(vec![Summand { function, over }]), None),
                };
                let name = self.named_member(&named.name, &indices, along);
                let (kind, unit) = (Kind::Named(number), named.unit.clone());
                self.out.subjects.push(Subject { kind, name, indices, quantity, unit, bounds: (None, None) });
            }
        }
        Ok(())
    }

    fn named_member(&self, name: &str, indices: &[i64], phase: Option<usize>) -> String {
        let path = phase.map_or("", |phase| self.out.phases[phase].name.as_str());
        // The path of the phase says its own indices, which are those of the outermost loops.
        let own = &indices[path.matches('[').count().min(indices.len())..];
        let members: String = own.iter().map(|index| format!("[{index}]")).collect();
        if path.is_empty() { format!("{name}{members}") } else { format!("{name}{members} in {path}") }
    }

    /// One result of a call as a function.
    fn function(&mut self, call: &Call, row: usize, indices: &[i64]) -> Result<usize, SetupError> {
        let mut inputs = vec![];
        for slot in &call.slots {
            let meaning = self.solution.slot(slot, indices)?;
            inputs.push(self.input(meaning, slot_member(slot, indices)));
        }
        for reduction in &call.reductions {
            let mut members = vec![];
            for value in Solution::range(&reduction.over, indices) {
                let inner: Vec<i64> = indices.iter().copied().chain([value]).collect();
                members.push(self.function(&reduction.body, 0, &inner)?);
            }
            let join = match reduction.op {
                ReduceOp::Sum => Join::Sum,
                ReduceOp::Product => Join::Product,
                ReduceOp::Min => Join::Min,
                ReduceOp::Max => Join::Max,
            };
            inputs.push(Input::Join(join, members));
        }
        for data in &call.data {
            let meaning = self.solution.datum(data, indices)?;
            inputs.push(self.input(meaning, vec![]));
        }
        self.out.functions.push(Function { graph: call.kernel, row, inputs });
        Ok(self.out.functions.len() - 1)
    }

    fn input(&mut self, meaning: Meaning, member: Vec<i64>) -> Input {
        match meaning {
            Meaning::Flat { spline, at, derivative } => {
                let flat = self.flat(spline, derivative);
                match at {
                    At::Here => Input::Flat(flat),
                    // What is meant is about one member, whose place was looked up.
                    At::Start | At::Among { .. } => Input::Start(flat),
                    At::End => Input::End(flat),
                    At::Inside(instant) => {
                        let phase = self.out.splines[spline].phase;
                        Input::Inside(flat, cell_from(&self.out.phases[phase].cuts, instant))
                    }
                }
            }
            Meaning::Start(phase) => Input::Number(self.durations + 2 * phase),
            Meaning::Duration(phase) => Input::Number(self.durations + 2 * phase + 1),
            Meaning::Variable(variable) => {
                Input::Number(self.variables + variable - self.solution.spline_coefficients().len())
            }
            Meaning::Integral(integral, variable) => match self.members.get(&(integral, member)) {
                Some(place) => Input::Integral(*place),
                None => Input::Number(self.variables + variable - self.solution.spline_coefficients().len()),
            },
            Meaning::Parameter(parameter, member) => Input::Number(self.parameters[parameter] + member),
            Meaning::Index(index) => Input::Value(index as f64),
            Meaning::Tau => Input::Tau,
        }
    }

    fn flat(&mut self, spline: usize, derivative: usize) -> usize {
        let flats = &mut self.out.flats;
        *self.flats.entry((spline, derivative)).or_insert_with(|| {
            flats.push(Flat { spline, derivative });
            flats.len() - 1
        })
    }
}

/// A place nearer to a cut than this is that cut.
const SAME: f64 = 1e-12;

fn add_cut(cuts: &mut Vec<f64>, tau: f64) {
    let at = cuts.partition_point(|cut| *cut < tau - SAME);
    if cuts.get(at).is_none_or(|cut| (cut - tau).abs() > SAME) {
        cuts.insert(at, tau);
    }
}

/// The cell that begins at a place, which is one of the cuts.
fn cell_from(cuts: &[f64], instant: Instant) -> usize {
    cuts.partition_point(|cut| *cut < instant.tau() - SAME).min(cuts.len().saturating_sub(2))
}

/// All places inside phases that a structure names.
fn places(structure: &Structure) -> BTreeSet<Instant> {
    let mut found: BTreeSet<Instant> = structure.places.iter().flat_map(|places| &places.instants).copied().collect();
    let named = structure.named.iter().map(|named| (&named.domain, &named.call, None));
    let groups = structure.groups.iter().chain(&structure.shown);
    let groups = groups.map(|group| (&group.domain, &group.call, group.bounds.as_ref()));
    for (domain, call, bounds) in named.chain(groups) {
        if let Domain::Path { part, .. } = domain {
            found.extend([part.from, part.to]);
        }
        let mut open: Vec<&Call> = bounds.into_iter().chain([call]).collect();
        while let Some(call) = open.pop() {
            open.extend(call.reductions.iter().map(|reduction| &reduction.body));
            found.extend(call.slots.iter().filter_map(|slot| match slot {
                Slot::Flat { at: At::Inside(instant), .. } => Some(*instant),
                _ => None,
            }));
        }
    }
    found
}

/// Which member of an integral a slot means.
fn slot_member(slot: &Slot, indices: &[i64]) -> Vec<i64> {
    match slot {
        Slot::Integral { index, .. } => index.iter().map(|affine| affine.at(indices)).collect(),
        _ => vec![],
    }
}

/// The values of a kernel, without its derivatives.
fn graph(body: &KernelBody) -> Graph {
    let mut place: HashMap<ntg_compiler::expr::NodeId, usize> = HashMap::new(); // Looked up, never iterated.
    let mut nodes = vec![];
    for id in body.dag.schedule(&body.values) {
        let of = |x: &ntg_compiler::expr::NodeId| place[x];
        let node = match body.dag.node(id) {
            ExprNode::Const(number) => Node::Const(number.value()),
            ExprNode::Input(input) => Node::Input(input.0 as usize),
            ExprNode::Unary(op, x) => Node::Unary(*op, of(x)),
            ExprNode::Binary(op, a, b) => Node::Binary(*op, of(a), of(b)),
            ExprNode::Powi(x, n) => Node::Powi(of(x), *n),
            ExprNode::Select { condition, then, otherwise } => Node::Select(of(condition), of(then), of(otherwise)),
            ExprNode::Table { table, derivative, args } => {
                Node::Table(*table as usize, derivative.clone(), args.iter().map(of).collect())
            }
            // Lowering has turned every reduction into an input; a NaN proves nothing.
            ExprNode::Reduce { .. } => Node::Const(f64::NAN),
        };
        place.insert(id, nodes.len());
        nodes.push(node);
    }
    Graph { nodes, rows: body.values.iter().map(|value| place[value]).collect() }
}
