//! Laws of the units: the same problem with outputs, variables and time counted in other units has the same optimum.
//!
//! A spec's meaning is rewritten before it becomes a program: each output `x` becomes `s x`, where `s` is a factor of its
//! own, time becomes `s t`, and bounds and guesses are divided. That is what a user does who counts in kilometres and
//! days. Factors that are powers of two round nothing: whatever changes then is a number of the method that has a unit.

mod shipped;

use ntg_compiler::expr::{Binary, InputId, Node, NodeId};
use ntg_compiler::model::problem::{Bounds, Duration, GuessKind, Leaf, Problem, Start};
use shipped::{Change, holds};
use std::collections::HashMap;

/// The units of a problem: how much of what the spec counts in one of the new units is.
struct Units {
    /// The base of all factors.
    base: f64,
    seed: u64,
    /// The factor of time.
    time: f64,
    has_outputs: bool,
    /// Outputs that stand in one route with an earlier one, and that one: the way along a polygon is measured by one unit.
    like: HashMap<String, String>,
}

impl Units {
    /// The factor of an output or a variable, by its name.
    fn of(&self, name: &str) -> f64 {
        if !self.has_outputs {
            return 1.0;
        }
        let name = self.like.get(name).map_or(name, String::as_str);
        let hash = name
            .bytes()
            .fold(self.seed, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29));
        self.base.powi(i32::try_from((hash >> 33) % 7).expect("small") - 3)
    }
}

/// The first output of each route, by the others.
fn together(problem: &Problem) -> HashMap<String, String> {
    let mut like = HashMap::new();
    for guess in &problem.guesses {
        if let GuessKind::Route { outputs, .. } = &guess.kind {
            outputs.iter().for_each(|(name, _)| {
                like.insert(name.clone(), outputs[0].0.clone());
            });
        }
    }
    like
}

/// Rewrites a problem.
struct Rewriting<'a> {
    problem: &'a mut Problem,
    units: &'a Units,
    images: HashMap<NodeId, NodeId>,
}

impl Rewriting<'_> {
    fn node(&mut self, node: NodeId) -> NodeId {
        if let Some(image) = self.images.get(&node) {
            return *image;
        }
        let inputs = self.problem.dag.inputs_of(&[node]);
        let replaced: HashMap<InputId, NodeId> =
            inputs.into_iter().filter_map(|input| Some((input, self.leaf(input)?))).collect();
        let image = self.problem.dag.substitute(&[node], |input| replaced.get(&input).copied())[0];
        self.images.insert(node, image);
        image
    }

    /// What stands for an input, where it changes.
    fn leaf(&mut self, input: InputId) -> Option<NodeId> {
        let leaf = self.problem.leaves.leaf(input).clone();
        let time = self.units.time;
        let (leaf, factor) = match leaf {
            Leaf::Flat { ref phase, output, order, .. } => {
                let factor = self.units.of(&self.problem.phases[phase.phase].outputs[output].name);
                let time = time.powi(i32::try_from(order).expect("small"));
                (leaf, factor / time)
            }
            Leaf::Time(_) | Leaf::Duration(_) | Leaf::Start(_) => (leaf, time),
            Leaf::Variable { variable, .. } => (leaf, self.units.of(&self.problem.variables[variable].name)),
            Leaf::Integral { phase, integrand } => {
                let integrand = self.node(integrand);
                (Leaf::Integral { phase, integrand }, time)
            }
            Leaf::Tau | Leaf::Parameter { .. } | Leaf::Index(_) | Leaf::Symbol(_) => return None,
        };
        let input = self.problem.leaves.id(leaf);
        let node = self.problem.dag.input(input);
        Some(self.times(node, factor))
    }

    fn times(&mut self, node: NodeId, factor: f64) -> NodeId {
        let factor = self.problem.dag.constant(factor);
        self.problem.dag.binary(Binary::Mul, factor, node)
    }

    fn divided(&mut self, node: NodeId, factor: f64) -> NodeId {
        let node = self.node(node);
        self.times(node, 1.0 / factor)
    }

    fn bounds(&mut self, bounds: &Bounds, factor: f64) -> Bounds {
        let mut side = |node: Option<NodeId>| node.map(|node| self.divided(node, factor));
        let (lower, upper) = (side(bounds.lower), side(bounds.upper));
        Bounds { lower, upper }
    }

    /// The constant factor of a body that is one output, and the output.
    fn bare(&self, body: NodeId) -> Option<(f64, NodeId)> {
        let Node::Binary(Binary::Mul, a, b) = self.problem.dag.node(body) else { return None };
        let (factor, node) = match (self.problem.dag.is_constant(*a), self.problem.dag.is_constant(*b)) {
            (Some(factor), None) => (factor, *b),
            (None, Some(factor)) => (factor, *a),
            _ => return None,
        };
        matches!(self.problem.dag.node(node), Node::Input(_)).then_some((factor, node))
    }

    fn rewrite(&mut self) {
        for k in 0..self.problem.constraints.len() {
            let constraint = self.problem.constraints[k].clone();
            let was_bare = matches!(self.problem.dag.node(constraint.body), Node::Input(_));
            let body = self.node(constraint.body);
            let (factor, body) = self.bare(body).filter(|_| was_bare).unwrap_or((1.0, body));
            let bounds = self.bounds(&constraint.bounds, factor);
            let constraint = &mut self.problem.constraints[k];
            (constraint.body, constraint.bounds) = (body, bounds);
        }
        for k in 0..self.problem.objective.len() {
            self.problem.objective[k].body = self.node(self.problem.objective[k].body);
        }
        for k in 0..self.problem.named.len() {
            self.problem.named[k].body = self.node(self.problem.named[k].body);
        }
        for k in 0..self.problem.measurements.len() {
            let measurement = self.problem.measurements[k].clone();
            let (residual, sigma) = (self.node(measurement.residual), self.node(measurement.sigma));
            let cost = self.node(measurement.cost);
            let measurement = &mut self.problem.measurements[k];
            (measurement.residual, measurement.sigma, measurement.cost) = (residual, sigma, cost);
        }
        self.times_of_phases();
        self.guesses();
    }

    fn times_of_phases(&mut self) {
        let time = self.units.time;
        for k in 0..self.problem.variables.len() {
            let factor = self.units.of(&self.problem.variables[k].name);
            self.problem.variables[k].bounds = self.bounds(&self.problem.variables[k].bounds.clone(), factor);
        }
        for k in 0..self.problem.agents.len() {
            self.problem.agents[k].start = match self.problem.agents[k].start.clone() {
                Start::Fixed(at) => Start::Fixed(at.map(|at| self.divided(at, time))),
                Start::Free(bounds) => Start::Free(self.bounds(&bounds, time)),
            };
        }
        for k in 0..self.problem.phases.len() {
            self.problem.phases[k].duration = match self.problem.phases[k].duration.clone() {
                Duration::Fixed(at) => Duration::Fixed(self.divided(at, time)),
                Duration::Free(bounds) => Duration::Free(self.bounds(&bounds, time)),
            };
        }
    }

    fn guesses(&mut self) {
        let time = self.units.time;
        for k in 0..self.problem.guesses.len() {
            let kind = match self.problem.guesses[k].kind.clone() {
                GuessKind::Output { output, index, value } => {
                    let value = self.divided(value, self.units.of(&output));
                    GuessKind::Output { output, index, value }
                }
                GuessKind::Route { outputs, points } => {
                    let factors: Vec<f64> = outputs.iter().map(|(name, _)| self.units.of(name)).collect();
                    let mut one = |point: Vec<NodeId>| -> Vec<NodeId> {
                        point.into_iter().zip(&factors).map(|(value, factor)| self.divided(value, *factor)).collect()
                    };
                    let points = points.into_iter().map(&mut one).collect();
                    GuessKind::Route { outputs, points }
                }
                GuessKind::Duration(value) => GuessKind::Duration(self.divided(value, time)),
                GuessKind::Start(value) => GuessKind::Start(self.divided(value, time)),
                GuessKind::Variable(variable, index, value) => {
                    let factor = self.units.of(&self.problem.variables[variable].name);
                    GuessKind::Variable(variable, index, self.divided(value, factor))
                }
            };
            self.problem.guesses[k].kind = kind;
        }
    }
}

/// Counts a problem in units of a base, by a seed, with time in a power of it; without outputs, in a unit of time alone.
fn other_units(problem: &mut Problem, (base, seed, time): (f64, u64, i32), has_outputs: bool) -> bool {
    let units = &Units { base, seed, time: base.powi(time), has_outputs, like: together(problem) };
    Rewriting { problem, units, images: HashMap::new() }.rewrite();
    true
}

#[test]
fn other_units_change_no_optimum() {
    let changes = [
        Change::meant("outputs in powers of 8", |problem| other_units(problem, (8.0, 1, 0), true)),
        Change::meant("all in powers of 10, time in 1000", |problem| other_units(problem, (10.0, 5, 3), true)),
        Change::meant("time in thousandths", |problem| other_units(problem, (10.0, 1, -3), false)),
    ];
    holds(&changes, &[], 60);
}
