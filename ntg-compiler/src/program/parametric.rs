//! Makes variables of a program's parameters (docs/maths.md, section 16.1).
//!
//! Takes a [`Program`], gives another one with the same formulas, in which everything that parameters decide is a
//! variable: the parameters themselves, and the durations and starts that they fix. What was a value is a bound on
//! both sides. All derivatives by parameters are then derivatives by slots, exact as all others are.
//!
//! Afterwards: behind the declared variables of the structure stand one for each parameter, in their order, and
//! one for the scaled time at which a named expression is evaluated; bounds and named expressions have first
//! derivatives; no function has second derivatives by two things that parameters decide; there are no guesses, no
//! continuations, no measurements and no probes.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

use ntg_structure::{
    Bounds, Call, Data, Duration, Kernel, Parameter, PhaseRef, Place, Reduction, Slot, Start, Structure, Unit, Variable,
};

use super::derive::{Formulas, derive};
use super::kernel::Mode;
use super::{KernelBody, Program};
use crate::expr::{Dag, InputId, Map, Node, NodeId};

/// The program whose variables include the parameters.
pub fn parametric(program: &Program) -> Program {
    let Program { structure, kernels } = program;
    let mut promotion = Promotion {
        structure,
        bodies: kernels,
        moving: moving_phases(structure),
        shapes: vec![],
        made: vec![],
        known: HashMap::new(),
    };
    let promoted = promotion.structure();
    let structure = Structure { kernels: promotion.shapes, ..promoted };
    Program { structure, kernels: promotion.made }
}

/// Where a call stands, which decides what becomes of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Use {
    /// In the objective or a constraint: first and second derivatives.
    Function,
    /// In a bound, a duration or a start: first derivatives.
    Bound,
    /// In a named expression: first derivatives, by scaled time too.
    Named,
}

struct Promotion<'a> {
    structure: &'a Structure,
    bodies: &'a [KernelBody],
    /// The phases (families) whose duration is fixed by parameters.
    moving: BTreeSet<usize>,
    shapes: Vec<Kernel>,
    made: Vec<KernelBody>,
    /// The new kernel of an old one, whose data of these positions are slots.
    known: HashMap<(usize, Vec<bool>, bool), usize>, // Looked up, never iterated.
}

impl Promotion<'_> {
    fn structure(&mut self) -> Structure {
        let mut out = self.structure.clone();
        for group in &mut out.groups {
            group.call = self.call(&group.call, Use::Function);
            group.bounds = group.bounds.as_ref().map(|call| self.call(call, Use::Bound));
        }
        for named in &mut out.named {
            named.call = self.call(&named.call, Use::Named);
        }
        for phase in &mut out.phases {
            phase.duration = match &phase.duration {
                Duration::Fixed(call) if depends(call) => Duration::Free(self.both(call)),
                Duration::Fixed(call) => Duration::Fixed(self.call(call, Use::Bound)),
                Duration::Free(bounds) => Duration::Free(self.bounds(bounds)),
            };
        }
        for agent in &mut out.agents {
            agent.start = match &agent.start {
                Start::Fixed(None) => Start::Fixed(None),
                Start::Fixed(Some(call)) => Start::Free(self.both(call)),
                Start::Free(bounds) => Start::Free(self.bounds(bounds)),
            };
        }
        for variable in &mut out.variables {
            variable.bounds = self.bounds(&variable.bounds);
        }
        out.variables.extend(self.structure.parameters.iter().map(variable));
        out.variables.push(Variable {
            name: "tau".into(),
            doc: "The scaled time at which a named expression is evaluated.".into(),
            unit: Unit::default(),
            family: None,
            bounds: Bounds::default(),
            place: Place::default(),
        });
        (out.guesses, out.continuations, out.measurements) = (vec![], vec![], vec![]);
        (out.shown, out.arguments) = (vec![], vec![]);
        out
    }

    /// Bounds of a value: the same from below and from above.
    fn both(&mut self, call: &Call) -> Bounds {
        Bounds { call: Some(self.call(call, Use::Bound)), lower: Some(0), upper: Some(0) }
    }

    fn bounds(&mut self, bounds: &Bounds) -> Bounds {
        Bounds { call: bounds.call.as_ref().map(|call| self.call(call, Use::Bound)), ..bounds.clone() }
    }

    /// The call whose data are slots where a parameter moves them.
    fn call(&mut self, call: &Call, purpose: Use) -> Call {
        let slots: Vec<Option<Slot>> = call.data.iter().map(|data| self.slot(data, purpose)).collect();
        let reductions = call
            .reductions
            .iter()
            .map(|reduction| Reduction { body: self.call(&reduction.body, purpose), ..reduction.clone() });
        Call {
            reductions: reductions.collect(),
            kernel: self.kernel(call, &slots, purpose),
            data: call
                .data
                .iter()
                .zip(&slots)
                .filter(|(_, slot)| slot.is_none())
                .map(|(data, _)| data.clone())
                .collect(),
            slots: call.slots.iter().cloned().chain(slots.into_iter().flatten()).collect(),
        }
    }

    /// The slot that a datum becomes.
    fn slot(&self, data: &Data, purpose: Use) -> Option<Slot> {
        let first = self.structure.variables.len();
        match data {
            Data::Parameter { parameter, index } => {
                Some(Slot::Variable { variable: first + parameter, index: self.index(*parameter, index.as_ref()) })
            }
            Data::Duration(phase) => self.moving.contains(&phase.phase).then(|| Slot::Duration(phase.clone())),
            Data::Start(phase) => Some(Slot::Start(phase.clone())),
            Data::Tau | Data::TauWithin if purpose == Use::Named => {
                Some(Slot::Variable { variable: first + self.structure.parameters.len(), index: None })
            }
            Data::Tau | Data::TauWithin | Data::Index(_) => None,
        }
    }

    /// A member of an array parameter has an index, a single number has none.
    fn index(&self, parameter: usize, index: Option<&ntg_structure::Affine>) -> Option<ntg_structure::Affine> {
        let array = self.structure.parameters.get(parameter).is_some_and(|parameter| parameter.array);
        array.then(|| index.cloned().unwrap_or_else(|| ntg_structure::Affine::constant(1)))
    }

    /// The number of the kernel whose data at these positions are slots, behind the slots that it had.
    fn kernel(&mut self, call: &Call, slots: &[Option<Slot>], purpose: Use) -> usize {
        let promoted: Vec<bool> = slots.iter().map(Option::is_some).collect();
        let second = purpose == Use::Function;
        let key = (call.kernel, promoted, second);
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let body = &self.bodies[call.kernel];
        let positions = positions(call, &key.1);
        let counts = (call.slots.len() + call.reductions.len() + key.1.iter().filter(|p| **p).count(), call.data.len());
        let data = call.slots.len() + call.reductions.len() + counts.1 - counts.0;
        let mode = if second { Mode::Solve } else { Mode::Slopes };
        let (mut shape, mut made, _) = derive(reordered(body, &positions), counts.0, data, mode);
        let held = call.slots.len()..call.slots.len() + key.1.iter().filter(|promoted| **promoted).count();
        without_held_second(&mut shape, &mut made, &held);
        shape.name.clone_from(&self.structure.kernels[call.kernel].name);
        made.names = vec![String::new(); body.names.len()];
        for (position, name) in positions.iter().zip(&body.names) {
            made.names[*position].clone_from(name);
        }
        made.labels.clone_from(&body.labels);
        let taken = self.shapes.iter().filter(|known| known.name.starts_with(&shape.name)).count();
        if taken > 0 {
            shape.name = format!("{}_v{}", shape.name, taken + 1);
        }
        self.shapes.push(shape);
        self.made.push(made);
        self.known.insert(key, self.made.len() - 1);
        self.made.len() - 1
    }
}

/// Leaves out second derivatives by two of the slots that are held, since parameters decide them: how their multipliers move
/// nobody asks, and of the others' only how they move with them. Reductions, which stand behind, are not held.
fn without_held_second(shape: &mut Kernel, body: &mut KernelBody, held: &Range<usize>) {
    let kept: Vec<bool> = shape.hessian.iter().map(|(i, j)| !(held.contains(i) && held.contains(j))).collect();
    let mut of = kept.iter();
    shape.hessian.retain(|_| of.next().is_some_and(|kept| *kept));
    let mut of = kept.iter();
    body.hessian.retain(|_| of.next().is_some_and(|kept| *kept));
}

/// The variable that a parameter becomes.
fn variable(parameter: &Parameter) -> Variable {
    Variable {
        name: parameter.name.clone(),
        doc: parameter.doc.clone(),
        unit: parameter.unit.clone(),
        family: parameter.family(),
        bounds: Bounds::default(),
        place: Place::default(),
    }
}

/// The phases (families) whose duration depends on a parameter.
fn moving_phases(structure: &Structure) -> BTreeSet<usize> {
    let phases = structure.phases.iter().enumerate();
    let moving = phases.filter(|(_, phase)| matches!(&phase.duration, Duration::Fixed(call) if depends(call)));
    moving.map(|(number, _)| number).collect()
}

/// Whether a call without slots depends on a parameter, as far as its inputs say.
fn depends(call: &Call) -> bool {
    let moves = |data: &Data| matches!(data, Data::Parameter { .. } | Data::Duration(PhaseRef { .. }) | Data::Start(_));
    call.data.iter().any(moves) || call.reductions.iter().any(|reduction| depends(&reduction.body))
}

/// Where every input of a kernel goes: slots, promoted data, reductions, other data.
fn positions(call: &Call, promoted: &[bool]) -> Vec<usize> {
    let (slots, reductions) = (call.slots.len(), call.reductions.len());
    let count = promoted.iter().filter(|promoted| **promoted).count();
    let (mut next_slot, mut next_data) = (slots, slots + count + reductions);
    let mut positions: Vec<usize> = (0..slots).chain(slots + count..slots + count + reductions).collect();
    for promoted in promoted {
        let next = if *promoted { &mut next_slot } else { &mut next_data };
        positions.push(*next);
        *next += 1;
    }
    positions
}

/// The values of a kernel with its inputs at other positions.
fn reordered(body: &KernelBody, positions: &[usize]) -> Formulas {
    let id = |position: usize| InputId(u32::try_from(position).expect("fewer than 2^32 inputs"));
    let mut dag = Dag::default();
    for position in 0..positions.len() {
        dag.input(id(position));
    }
    let mut image: HashMap<NodeId, NodeId> = HashMap::new();
    for node in body.dag.schedule(&body.values) {
        let new = match body.dag.node(node) {
            Node::Input(input) => dag.input(id(positions[input.0 as usize])),
            other => dag.rebuild(other, |operand| image[&operand]),
        };
        image.insert(node, new);
    }
    Formulas {
        dag,
        values: body.values.iter().map(|value| image[value]).collect(),
        origin: Map::default(),
        norms: vec![],
    }
}
