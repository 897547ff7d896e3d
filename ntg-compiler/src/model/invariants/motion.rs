//! The equations of motion of a phase, solved for the derivatives that they determine.
//!
//! Takes the equations along a whole phase that hold one derivative of highest order of one element of a state, times a
//! factor without such derivatives: `der(x) == f`, `m * der(v, 1) == F`. Others determine no derivative by themselves and are
//! left out.
//! Afterwards: every element of a state that has such an equation leads to it.

use std::collections::HashMap;

use crate::expr::{Dag, NodeId, gradient, kinks};
use crate::model::elaborator::Elaborator;
use crate::model::problem::{At, Collocation, Domain, Form, IndexId, Leaf, Loop};
use crate::syntax::ast::Role;

/// The values of indices.
pub(super) type Indices = HashMap<IndexId, i64>; // Looked up, never iterated.

/// An element of an output of one member of a phase: members of agent and phase, the output, and the element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Element {
    pub(super) agent: Option<i64>,
    pub(super) index: Option<i64>,
    pub(super) output: usize,
    pub(super) member: Option<i64>,
}

/// An equation that determines a derivative: `factor * derivative + rest == bound`.
#[derive(Clone, Copy)]
pub(super) struct Equation {
    pub(super) factor: NodeId,
    pub(super) rest: NodeId,
    pub(super) bound: NodeId,
}

/// The equations of motion of one phase.
pub(super) struct Motion {
    pub(super) phase: usize,
    /// For each output that is a state whose spline is that of the collocation: how often it is differentiated.
    orders: Vec<Option<usize>>,
    equations: Vec<Equation>,
    /// The derivative that each equation determines, under the loops of its constraint.
    leaves: Vec<Leaf>,
    /// The outputs whose highest derivatives stand in equations.
    moved: Vec<usize>,
    of: HashMap<Element, (usize, Indices)>, // Looked up, never iterated.
    /// Whether a condition stands in the equations, or in what is asked about.
    pub(super) has_branches: bool,
}

/// The most elements whose equations are looked for.
const MOST_ELEMENTS: usize = 20_000;

impl Motion {
    /// How often a state is differentiated in the equations of motion.
    pub(super) fn order(&self, output: usize) -> Option<usize> {
        self.orders.get(output).copied().flatten()
    }

    /// What determines the highest derivative of an element.
    pub(super) fn equation(&self, element: &Element) -> Option<(Equation, &Indices)> {
        self.of.get(element).map(|(equation, indices)| (self.equations[*equation], indices))
    }

    /// Whether a highest derivative of an output stands in any equation.
    pub(super) fn moves(&self, output: usize) -> bool {
        self.moved.contains(&output)
    }

    /// What determines a highest derivative whose indices may be open: the equation, and a form for each of its indices. None
    /// where there is no equation, or another one for other members.
    pub(super) fn equation_of(&self, leaf: &Leaf) -> Option<(Equation, Vec<(IndexId, Form)>)> {
        let Leaf::Flat { phase, output, index, .. } = leaf else { return None };
        let is_closed =
            [&phase.agent, &phase.index, index].into_iter().flatten().all(|form| form.as_number().is_some());
        if is_closed && let Some((own, _)) = element(leaf, &Indices::new()) {
            let (number, indices) = self.of.get(&own)?;
            let forms = indices.iter().map(|(index, value)| (*index, Form::number(*value))).collect();
            return Some((self.equations[*number], forms));
        }
        let mut own = self
            .leaves
            .iter()
            .zip(&self.equations)
            .filter(|(leaf, _)| matches!(leaf, Leaf::Flat { output: own, .. } if own == output));
        let ((Leaf::Flat { phase: of, index: member, .. }, equation), None) = (own.next()?, own.next()) else {
            return None;
        };
        let pairs = [(&of.agent, &phase.agent), (&of.index, &phase.index), (member, index)];
        let mut forms = vec![];
        for (own, wanted) in pairs {
            match (own, wanted) {
                (None, None) => {}
                (Some(own), Some(wanted)) => match own.terms.as_slice() {
                    [(index, 1)] => forms.push((*index, wanted.plus(-1, &Form::number(own.constant))?)),
                    _ if own == wanted => {}
                    _ => return None,
                },
                _ => return None,
            }
        }
        Some((*equation, forms))
    }

    /// Looks for conditions in the equations and in what is asked about.
    pub(super) fn find_branches(&mut self, dag: &Dag, asked: &[NodeId]) {
        let nodes = |own: &Equation| [own.factor, own.rest, own.bound];
        let roots: Vec<NodeId> = self.equations.iter().flat_map(nodes).chain(asked.iter().copied()).collect();
        self.has_branches = !kinks(dag, &roots).is_empty();
    }

    /// Whether there are states to look at.
    pub(super) fn has_states(&self) -> bool {
        self.orders.iter().any(Option::is_some)
    }
}

/// Calls `visit` with the values of all indices of nested loops, beside those given, until it says that it is enough.
pub(super) fn each_member(loops: &[Loop], indices: &mut Indices, visit: &mut dyn FnMut(&Indices) -> bool) -> bool {
    let Some((over, inner)) = loops.split_first() else { return visit(indices) };
    let (first, last) = (over.first.at(indices), over.last.at(indices));
    for value in first..=last {
        indices.insert(over.index, value);
        if !each_member(inner, indices, visit) {
            return false;
        }
    }
    true
}

/// The element that a leaf is of, where indices have values.
pub(super) fn element(leaf: &Leaf, indices: &Indices) -> Option<(Element, usize)> {
    let Leaf::Flat { phase, output, index, order, .. } = leaf else { return None };
    let at = |form: &Option<Form>| form.as_ref().map(|form| form.at(indices));
    let element = Element { agent: at(&phase.agent), index: at(&phase.index), output: *output, member: at(index) };
    Some((element, *order))
}

impl Elaborator<'_> {
    /// The states of a phase and how often they are differentiated; their equations are not looked for yet.
    pub(super) fn states_in_motion(&self, phase: usize) -> Motion {
        let outputs = &self.problem.phases[phase].outputs;
        let mut orders = vec![None; outputs.len()];
        if let Collocation::Gauss { equalities, .. } = self.problem.phases[phase].collocation {
            for (role, name) in self.declared_outputs(phase) {
                let Some(k) = outputs.iter().position(|output| output.name == name.name.text) else { continue };
                // A spline of its own may be freer than its equations determine it.
                let spline = &outputs[k].spline;
                let is_determined = spline.smoothness > 0 && spline.order == equalities + spline.smoothness;
                orders[k] = (role == Role::State && is_determined).then_some(spline.smoothness);
            }
        }
        Motion {
            phase,
            orders,
            equations: vec![],
            leaves: vec![],
            moved: vec![],
            of: HashMap::new(),
            has_branches: false,
        }
    }

    /// Finds the equations of motion.
    pub(super) fn find_equations(&mut self, motion: &mut Motion) {
        for k in 0..self.problem.constraints.len() {
            let Some(bound) = self.equation_along(k, motion.phase) else { continue };
            for input in self.problem.dag.inputs_of(&[self.problem.constraints[k].body]) {
                if let Leaf::Flat { output, order, .. } = self.problem.leaves.leaf(input)
                    && motion.order(*output) == Some(*order)
                {
                    motion.moved.push(*output);
                }
            }
            let Some((leaf, equation)) = self.solved_for(k, bound, motion) else { continue };
            let number = motion.equations.len();
            motion.equations.push(equation);
            motion.leaves.push(leaf.clone());
            let loops = self.problem.constraints[k].loops.clone();
            each_member(&loops, &mut Indices::new(), &mut |indices| {
                if let Some((element, _)) = element(&leaf, indices) {
                    motion.of.entry(element).or_insert_with(|| (number, indices.clone()));
                }
                motion.of.len() < MOST_ELEMENTS
            });
        }
    }

    /// The value of an equation that holds along all of a phase.
    pub(super) fn equation_along(&self, k: usize, phase: usize) -> Option<NodeId> {
        let constraint = &self.problem.constraints[k];
        let bound = constraint.bounds.lower.filter(|lower| constraint.bounds.upper == Some(*lower))?;
        let Domain::Path(at, part) = &constraint.domain else { return None };
        (at.phase == phase && part.is_whole() && constraint.sides == 0).then_some(bound)
    }

    fn solved_for(&mut self, k: usize, bound: NodeId, motion: &Motion) -> Option<(Leaf, Equation)> {
        let body = self.problem.constraints[k].body;
        let mut only = None;
        for input in self.problem.dag.inputs_of(&[body]) {
            let leaf = self.problem.leaves.leaf(input);
            let Leaf::Flat { phase, at: At::Here, output, order, .. } = leaf else { continue };
            if phase.phase == motion.phase && motion.order(*output).is_some_and(|highest| *order >= highest) {
                let is_highest = motion.order(*output) == Some(*order);
                if only.is_some() || !is_highest {
                    return None;
                }
                only = Some((input, leaf.clone()));
            }
        }
        let (input, leaf) = only?;
        let dag = &mut self.problem.dag;
        let factor = gradient(dag, body, &[input]).ok()?[0];
        let zero = dag.constant(0.0);
        if factor == zero || dag.inputs_of(&[factor]).contains(&input) {
            return None;
        }
        let rest = dag.substitute(&[body], |other| (other == input).then_some(zero))[0];
        Some((leaf, Equation { factor, rest, bound }))
    }
}
