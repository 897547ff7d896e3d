//! Agents, phases, variables, guesses: the model's families by position, their bounds as calls.

use ntg_structure as out;
use ntg_structure::{Call, Structure};

use super::environment::{Environment, loops as positions};
use super::kernel::{Mode, Root, call};
use super::lower::Lowering;
use crate::expr::NodeId;
use crate::model::angles::angles;
use crate::model::norms::norms;
use crate::model::problem::{Bounds, Domain, Duration, GuessKind, GuessScope, Loop, Start};

/// Everything but groups, kernels, integrals and named expressions.
pub(super) fn structure(lowering: &mut Lowering<'_>) -> Structure {
    let problem = &lowering.problem;
    let mut structure = Structure {
        name: problem.name.clone(),
        doc: problem.doc.clone(),
        source: lowering.source_name().to_owned(),
        maximize: problem.maximize,
        objective_unit: problem.objective_unit.clone(),
        independent: problem.independent.clone(),
        parameters: problem.parameters.clone(),
        tables: problem.tables.clone(),
        places: problem.places.clone(),
        shared: problem.shared.clone(),
        ..Structure::default()
    };
    structure.terms = terms(lowering);
    structure.corners = lowering.problem.corners.iter().map(|span| lowering.place(*span)).collect();
    structure.relaxations = relaxations(lowering);
    structure.constraints = constraints(lowering);
    structure.norms = norms(&lowering.problem);
    structure.angles = angles(&lowering.problem);
    structure.variables = variables(lowering);
    structure.agents = agents(lowering);
    structure.phases = phases(lowering);
    structure.guesses = guesses(lowering);
    structure.continuations = (lowering.problem.continuations.iter())
        .map(|c| out::Continuation { parameter: c.parameter, steps: c.steps.clone() })
        .collect();
    structure
}

/// All with helpers.
fn relaxations(lowering: &Lowering<'_>) -> Vec<out::Relaxation> {
    let relaxation = |own: &crate::model::problem::Relaxation| out::Relaxation {
        equation: own.equation,
        other: own.other,
        helpers: own.helpers.clone(),
        corners: own.corners.iter().map(|span| lowering.place(*span)).collect(),
        exact_first: own.exact_first,
        is_exact: false,
    };
    lowering.problem.relaxations.iter().map(relaxation).collect()
}

fn terms(lowering: &Lowering<'_>) -> Vec<out::Term> {
    let term = |t: &crate::model::problem::Term| out::Term {
        name: t.name.clone(),
        place: lowering.place(t.span),
        unit: t.unit.clone(),
    };
    lowering.problem.objective.iter().map(term).collect()
}

fn constraints(lowering: &Lowering<'_>) -> Vec<out::Constraint> {
    let constraint = |c: &crate::model::problem::Constraint| out::Constraint {
        name: c.name.clone(),
        place: lowering.place(c.span),
        block: c.block,
        unit: c.unit.clone(),
        sides: c.sides,
    };
    lowering.problem.constraints.iter().map(constraint).collect()
}

fn variables(lowering: &mut Lowering<'_>) -> Vec<out::Variable> {
    let list = lowering.problem.variables.clone();
    list.into_iter()
        .map(|v| out::Variable {
            bounds: bounds(lowering, &v.bounds, v.family.as_slice(), &v.name),
            place: lowering.place(v.span),
            name: v.name,
            doc: v.doc,
            unit: v.unit,
            family: v.family.as_ref().map(|over| out::Family { grid: v.grid, ..family(over) }),
        })
        .collect()
}

fn agents(lowering: &mut Lowering<'_>) -> Vec<out::Agent> {
    let list = lowering.problem.agents.clone();
    list.into_iter()
        .map(|a| {
            let loops: Vec<Loop> = a.family.iter().cloned().collect();
            let start = match &a.start {
                Start::Fixed(None) => out::Start::Fixed(None),
                Start::Fixed(Some(time)) => out::Start::Fixed(Some(setup(lowering, "start", &[*time], &loops))),
                Start::Free(limits) => out::Start::Free(bounds(lowering, limits, &loops, "start")),
            };
            out::Agent {
                name: a.name,
                family: a.family.as_ref().map(family),
                start,
                duration_name: a.duration_name,
                place: lowering.place(a.span),
            }
        })
        .collect()
}

fn phases(lowering: &mut Lowering<'_>) -> Vec<out::Phase> {
    let list = lowering.problem.phases.clone();
    list.into_iter()
        .map(|p| {
            let agent = lowering.problem.agents[p.agent].family.clone();
            let loops: Vec<Loop> = agent.into_iter().chain(p.family.clone()).collect();
            let duration = match &p.duration {
                Duration::Fixed(time) => out::Duration::Fixed(setup(lowering, "duration", &[*time], &loops)),
                Duration::Free(limits) => out::Duration::Free(bounds(lowering, limits, &loops, "duration")),
            };
            let output = |o: crate::model::problem::Output| out::Output {
                name: o.name,
                doc: o.doc,
                unit: o.unit,
                family: o.family.map(|(first, last)| out::Family { first, last, grid: o.grid }),
                vector: o.vector,
                spline: o.spline,
            };
            out::Phase {
                name: p.name,
                agent: p.agent,
                family: p.family.as_ref().map(family),
                after: p.after,
                duration,
                duration_name: p.duration_name,
                outputs: p.outputs.into_iter().map(output).collect(),
                points: Vec::new(),
                place: lowering.place(p.span),
            }
        })
        .collect()
}

/// Residuals and standard deviations with their kernels.
pub(super) fn measurements(lowering: &mut Lowering<'_>) -> Vec<out::Measurement> {
    let list = lowering.problem.measurements.clone();
    list.into_iter()
        .map(|m| {
            let root = Root { body: m.residual, loops: &m.loops, label: "residual".to_owned(), is_norm: false };
            out::Measurement {
                term: m.term,
                unit: m.unit,
                loops: positions(&m.loops),
                residual: call(lowering, "residual", Mode::Show, &[root]),
                sigma: setup(lowering, "sigma", &[m.sigma], &m.loops),
            }
        })
        .collect()
}

/// Named expressions with their kernels.
pub(super) fn named(lowering: &mut Lowering<'_>) -> Vec<out::Named> {
    let list = lowering.problem.named.clone();
    list.into_iter()
        .map(|n| {
            let environment = Environment::of(&n.loops);
            let domain = match &n.domain {
                Domain::Mission => out::Domain::Mission,
                Domain::Start(phase) => out::Domain::Start(environment.phase(phase)),
                Domain::End(phase) => out::Domain::End(environment.phase(phase)),
                Domain::Path(phase, part) => {
                    out::Domain::Path { phase: environment.phase(phase), points: 0, part: *part }
                }
            };
            let last = n.loops.last().filter(|_| n.family).map(family);
            let root = Root { body: n.body, loops: &n.loops, label: n.name.clone(), is_norm: false };
            let call = call(lowering, &format!("let_{}", super::names::identifier(&n.name)), Mode::Show, &[root]);
            out::Named {
                name: n.name,
                doc: n.doc,
                unit: n.unit,
                family: last,
                agent: n.agent,
                loops: positions(&n.loops),
                domain,
                call,
            }
        })
        .collect()
}

fn guesses(lowering: &mut Lowering<'_>) -> Vec<out::Guess> {
    let list = lowering.problem.guesses.clone();
    list.into_iter()
        .map(|g| {
            let environment = Environment::of(&g.loops);
            let member = |index: &Option<crate::model::problem::Form>| index.as_ref().map(|f| environment.affine(f));
            let scope = match &g.scope {
                GuessScope::Phase(phase) => out::GuessScope::Phase(environment.phase(phase)),
                GuessScope::Agent(agent, index) => out::GuessScope::Agent { agent: *agent, index: member(index) },
            };
            let mut value = |node: NodeId| setup(lowering, "guess", &[node], &g.loops);
            let kind = match &g.kind {
                GuessKind::Output { output, index, value: node } => {
                    out::GuessKind::Output { output: output.clone(), index: member(index), value: value(*node) }
                }
                GuessKind::Duration(node) => out::GuessKind::Duration { value: value(*node) },
                GuessKind::Start(node) => out::GuessKind::Start { value: value(*node) },
                GuessKind::Variable(variable, index, node) => {
                    out::GuessKind::Variable { variable: *variable, index: member(index), value: value(*node) }
                }
                GuessKind::Route { outputs, points } => out::GuessKind::Route {
                    outputs: outputs.iter().map(|(name, index)| (name.clone(), member(index))).collect(),
                    points: points.len(),
                    values: setup(lowering, "route", &points.concat(), &g.loops),
                },
            };
            out::Guess { loops: positions(&g.loops), scope, kind }
        })
        .collect()
}

fn bounds(lowering: &mut Lowering<'_>, limits: &Bounds, loops: &[Loop], name: &str) -> out::Bounds {
    let rows: Vec<NodeId> = limits.lower.iter().chain(&limits.upper).copied().collect();
    if rows.is_empty() {
        return out::Bounds::default();
    }
    out::Bounds {
        call: Some(setup(lowering, &format!("bounds_{}", super::names::identifier(name)), &rows, loops)),
        lower: limits.lower.map(|_| 0),
        upper: limits.upper.map(|_| rows.len() - 1),
    }
}

fn setup(lowering: &mut Lowering<'_>, name: &str, rows: &[NodeId], loops: &[Loop]) -> Call {
    let roots: Vec<Root<'_>> =
        rows.iter().map(|row| Root { body: *row, loops, label: name.to_owned(), is_norm: false }).collect();
    call(lowering, name, Mode::Setup, &roots)
}

/// The members of a declared family: its ends are constants.
fn family(range: &Loop) -> out::Family {
    out::Family::of(range.first.constant, range.last.constant)
}
