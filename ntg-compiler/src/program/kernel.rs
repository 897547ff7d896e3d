//! Copies formulas of the model into a kernel, with its inputs by position and scaled time.
//!
//! Takes bodies over the problem's graph and the loops around them, gives a `KernelBody` with
//! exact first and second derivatives and the [`Call`] that says what its inputs are.
//! Afterwards: time derivatives are with respect to scaled time, divided by powers of the duration
//! (docs/maths.md, section 3); sums over families are reductions with kernels of their own;
//! integrals that are left are variables, whose defining pieces wait in the [`Lowering`].

use std::collections::{HashMap, HashSet};

use ntg_structure::{At, Call, Data, ReduceOp, Reduction, Slot};

use super::clocks::is_clock;
use super::derive::{Formulas, derive};
use super::environment::Environment;
use super::inputs::Inputs;
use super::lower::Lowering;
use super::names::identifier;
use crate::expr::{Dag, Fold, InputId, Map, Node, NodeId};
use crate::model::problem::{Leaf, Loop, PhaseAt};
use crate::source::Span;

/// Whether a kernel may depend on the variables of the optimisation problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// A function that is solved for.
    Solve,
    /// A function of which first derivatives are wanted.
    Slopes,
    /// A function that is only shown: no derivatives.
    Show,
    /// A function of parameters alone: bounds, durations, guesses. Durations are data there.
    Setup,
}

/// A function under the loops that bind its indices.
pub(super) struct Root<'a> {
    pub(super) body: NodeId,
    pub(super) loops: &'a [Loop],
    pub(super) label: String,
    /// Whether it is a norm with a limit, at whose tip nothing fails (docs/maths.md, section 11.14).
    pub(super) is_norm: bool,
}

/// Makes the kernel (or finds the equal one) and the call for several functions at one place.
pub(super) fn call(lowering: &mut Lowering<'_>, name: &str, mode: Mode, roots: &[Root<'_>]) -> Call {
    let (dag, inputs, origin) = (Dag::default(), Inputs::default(), Map::default());
    let mut copy = Copy { lowering, mode, dag, inputs, origin, in_clock: false };
    let values: Vec<NodeId> = roots.iter().map(|root| copy.expression(root.body, root.loops)).collect();
    let Copy { dag, inputs, origin, .. } = copy;
    let formulas = by_position(&dag, &values, &origin, &inputs);
    let names = inputs.names();
    let Inputs { slots, reductions, data, .. } = inputs;

    let formulas = Formulas { norms: values_of_norms(&formulas.values, roots), ..formulas };
    let (mut shape, mut body, probes) = derive(formulas, slots.len() + reductions.len(), data.len(), mode);
    shape.name = name.to_owned();
    shape.probes = probes.into_iter().map(|span| lowering.place(span)).collect();
    body.names = names;
    body.labels = roots.iter().map(|root| root.label.clone()).collect();
    Call { kernel: lowering.kernel(shape, body), slots, reductions, data }
}

/// Copies a graph so that the inputs come first, in their final order.
fn by_position(dag: &Dag, values: &[NodeId], origin: &Map<NodeId, Span>, inputs: &Inputs) -> Formulas {
    let positions = inputs.positions();
    let mut out = Dag::default();
    for position in 0..positions.len() {
        out.input(InputId(u32::try_from(position).expect("fewer than 2^32 inputs")));
    }
    let mut map: HashMap<NodeId, NodeId> = HashMap::new();
    let mut spans = Map::default();
    for id in dag.schedule(values) {
        let new = match dag.node(id) {
            Node::Input(input) => out.input(InputId(positions[input.0 as usize])),
            node => out.rebuild(node, |operand| map[&operand]),
        };
        map.insert(id, new);
        if let Some(span) = origin.get(&id) {
            spans.entry(new).or_insert(*span);
        }
    }
    Formulas { dag: out, values: values.iter().map(|v| map[v]).collect(), origin: spans, norms: vec![] }
}

/// The values that are norms with limits.
fn values_of_norms(values: &[NodeId], roots: &[Root<'_>]) -> Vec<NodeId> {
    let own = values.iter().zip(roots).filter(|(_, root)| root.is_norm).map(|(value, _)| *value);
    // What is a norm with a limit and a part of the objective is one with a tip.
    own.filter(|own| values.iter().zip(roots).all(|(value, root)| value != own || root.is_norm)).collect()
}

struct Copy<'a, 'b> {
    lowering: &'a mut Lowering<'b>,
    mode: Mode,
    dag: Dag,
    inputs: Inputs,
    origin: Map<NodeId, Span>, // Looked up, never iterated.
    /// Whether a condition of time alone is copied: at the end of an interval it is asked within the interval (docs/maths.md, 3.5).
    in_clock: bool,
}

impl Copy<'_, '_> {
    /// Copies one expression; what stands inside a reduction goes to that reduction's own kernel.
    fn expression(&mut self, root: NodeId, loops: &[Loop]) -> NodeId {
        let mut map: HashMap<NodeId, NodeId> = HashMap::new();
        let (order, clocks) = self.outside_clocks(root);
        for id in order {
            let node = self.lowering.problem.dag.node(id).clone();
            let new = match &node {
                Node::Select { condition, then, otherwise } if clocks.contains(condition) => {
                    let around = std::mem::replace(&mut self.in_clock, true);
                    let condition = self.expression(*condition, loops);
                    self.in_clock = around;
                    self.dag.select(condition, map[then], map[otherwise])
                }
                Node::Input(input) => {
                    let leaf = self.lowering.problem.leaves.leaf(*input).clone();
                    self.leaf(&leaf, id, loops)
                }
                Node::Reduce { fold, range, body, .. } => self.reduce(*fold, *range, *body, loops),
                _ => self.dag.rebuild(&node, |operand| map[&operand]),
            };
            map.insert(id, new);
            if let Some(span) = self.lowering.problem.origin.get(&id) {
                self.origin.entry(new).or_insert(*span);
            }
        }
        map[&root]
    }

    /// The nodes below a root, operands first, without those that only conditions of time alone are made of, and these conditions.
    fn outside_clocks(&self, root: NodeId) -> (Vec<NodeId>, HashSet<NodeId>) {
        let dag = &self.lowering.problem.dag;
        let mut order = dag.schedule_outside(&[root]);
        let mut clocks = HashSet::new();
        if !self.in_clock {
            let conditions = order.iter().filter_map(|id| match dag.node(*id) {
                Node::Select { condition, .. } => Some(*condition),
                _ => None,
            });
            clocks.extend(conditions.filter(|condition| is_clock(&self.lowering.problem, *condition)));
        }
        if !clocks.is_empty() {
            let mut needed = HashSet::from([root]);
            // Operands stand before what they are operands of.
            for id in order.iter().rev() {
                match dag.node(*id) {
                    _ if !needed.contains(id) => {}
                    Node::Select { condition, then, otherwise } if clocks.contains(condition) => {
                        needed.extend([*then, *otherwise]);
                    }
                    node => needed.extend(node.operands()),
                }
            }
            order.retain(|id| needed.contains(id));
        }
        (order, clocks)
    }

    fn leaf(&mut self, leaf: &Leaf, id: NodeId, loops: &[Loop]) -> NodeId {
        let environment = Environment::of(loops);
        match leaf {
            Leaf::Flat { phase, at, output, index, order } => {
                let slot = Slot::Flat {
                    phase: environment.phase(phase),
                    at: environment.at(*at),
                    output: *output,
                    index: index.as_ref().map(|form| environment.affine(form)),
                    derivative: *order,
                };
                let name = &self.lowering.problem.phases[phase.phase].outputs[*output].name;
                let place = match at {
                    At::Here => String::new(),
                    At::Start => "_start".to_owned(),
                    At::End => "_end".to_owned(),
                    At::Inside(_) | At::Among { .. } => "_at".to_owned(),
                };
                let name = identifier(&format!("{name}{place}_{order}"));
                let scaled = self.inputs.slot(slot, &name);
                let scaled = self.input(scaled);
                self.real_time(scaled, phase, *order, &environment)
            }
            Leaf::Time(phase) => {
                let (start, duration) = (self.start(phase, &environment), self.duration(phase, &environment));
                let tau = self.tau();
                let elapsed = self.dag.mul(tau, duration);
                self.dag.add(start, elapsed)
            }
            Leaf::Tau => self.tau(),
            Leaf::Duration(phase) => self.duration(phase, &environment),
            Leaf::Start(phase) => self.start(phase, &environment),
            Leaf::Parameter { parameter, index } => {
                let name = identifier(&self.lowering.problem.parameters[*parameter].name);
                let index = index.as_ref().map(|form| environment.affine(form));
                self.data(Data::Parameter { parameter: *parameter, index }, &format!("{name}_p"))
            }
            Leaf::Variable { variable, index } => {
                let name = identifier(&self.lowering.problem.variables[*variable].name);
                let slot =
                    Slot::Variable { variable: *variable, index: index.as_ref().map(|form| environment.affine(form)) };
                let input = self.inputs.slot(slot, &format!("{name}_v"));
                self.input(input)
            }
            Leaf::Index(form) if form.terms.is_empty() => self.dag.constant(form.constant as f64),
            Leaf::Index(form) => self.data(Data::Index(environment.affine(form)), "index_i"),
            Leaf::Integral { .. } => {
                let (integral, index) = self.lowering.integral(id, loops);
                let input = self.inputs.slot(Slot::Integral { integral, index }, &format!("integral_{integral}"));
                self.input(input)
            }
            // The model leaves none; a zero keeps this total without a panic.
            Leaf::Symbol(_) => self.dag.constant(0.0),
        }
    }

    fn tau(&mut self) -> NodeId {
        if self.in_clock { self.data(Data::TauWithin, "tau_within") } else { self.data(Data::Tau, "tau") }
    }

    /// `x^(j)` in real time is the derivative in scaled time over `T^j`.
    fn real_time(&mut self, scaled: NodeId, phase: &PhaseAt, order: usize, environment: &Environment) -> NodeId {
        if order == 0 {
            return scaled;
        }
        let duration = self.duration(phase, environment);
        let one = self.dag.constant(1.0);
        let rate = self.dag.div(one, duration);
        let rate = self.dag.powi(rate, i32::try_from(order).expect("orders of derivatives are small"));
        self.dag.mul(scaled, rate)
    }

    fn duration(&mut self, phase: &PhaseAt, environment: &Environment) -> NodeId {
        let reference = environment.phase(phase);
        let named = &self.lowering.problem.phases[phase.phase].duration_name;
        let name = format!("{}_d", identifier(named.as_deref().unwrap_or("T")));
        if self.mode != Mode::Setup && self.lowering.duration_is_free(phase.phase) {
            let input = self.inputs.slot(Slot::Duration(reference), &name);
            self.input(input)
        } else {
            self.data(Data::Duration(reference), &name)
        }
    }

    fn start(&mut self, phase: &PhaseAt, environment: &Environment) -> NodeId {
        let reference = environment.phase(phase);
        if self.lowering.start_is_zero(phase.phase) {
            self.dag.constant(0.0)
        } else if self.mode != Mode::Setup && self.lowering.start_is_free(phase.phase) {
            let input = self.inputs.slot(Slot::Start(reference), "start_d");
            self.input(input)
        } else {
            self.data(Data::Start(reference), "start_d")
        }
    }

    fn reduce(&mut self, fold: Fold, range: u32, body: NodeId, loops: &[Loop]) -> NodeId {
        let range = self.lowering.problem.ranges[range as usize].clone();
        let over = Environment::of(loops).range(&range);
        let mut inner = loops.to_vec();
        inner.push(range);
        let op = match fold {
            Fold::Sum => ReduceOp::Sum,
            Fold::Product => ReduceOp::Product,
            Fold::Min => ReduceOp::Min,
            Fold::Max => ReduceOp::Max,
        };
        let root = Root { body, loops: &inner, label: "member".to_owned(), is_norm: false };
        let body = call(self.lowering, "member", self.mode, &[root]);
        let name = match op {
            ReduceOp::Sum => "sum_r",
            ReduceOp::Product => "product_r",
            ReduceOp::Min => "min_r",
            ReduceOp::Max => "max_r",
        };
        let input = self.inputs.reduction(Reduction { op, over, body }, name);
        self.input(input)
    }

    fn data(&mut self, data: Data, name: &str) -> NodeId {
        let input = self.inputs.data(data, name);
        self.input(input)
    }

    fn input(&mut self, provisional: usize) -> NodeId {
        self.dag.input(InputId(u32::try_from(provisional).expect("fewer than 2^32 inputs")))
    }
}
