//! A point of a phase with pseudo-random values: what formulas are there, the motion included.
//!
//! Every quantity has a value of its own, the same wherever it is met: an element of an output by the output's name, so that
//! it is the same in all phases. Highest derivatives of states are what the equations of motion say.

use std::collections::HashMap;

use super::motion::{Element, Indices, Motion, element};
use super::number::{Number, fraction, mixed, table};
use crate::expr::{Environment, InputId, NodeId, eval_in};
use crate::model::problem::{At, Form, IndexId, Leaf, Problem};

/// How values are drawn.
#[derive(Clone, Copy)]
pub(super) struct Draw {
    pub(super) seed: u64,
    /// The decades to each side of 1 that values lie in.
    pub(super) decades: f64,
    pub(super) is_positive: bool,
    /// Whether conditions take the other branches.
    pub(super) is_turned: bool,
}

/// How much may be evaluated yet.
#[derive(Debug)]
pub(super) struct Budget(usize);

impl Budget {
    pub(super) fn new(leaves: usize) -> Self {
        Self(leaves)
    }

    /// Takes some; whether there were as many.
    fn take(&mut self, leaves: usize) -> bool {
        let is_left = self.0 >= leaves;
        self.0 = self.0.saturating_sub(leaves);
        is_left
    }

    pub(super) fn is_spent(&self) -> bool {
        self.0 == 0
    }
}

/// The value of an element's derivative.
pub(super) type State = (Element, usize);

/// A point; see the module's header.
pub(super) struct Point<'p> {
    problem: &'p Problem,
    motion: &'p Motion,
    draw: Draw,
    budget: &'p mut Budget,
    indices: Indices,
    /// States that were put elsewhere.
    pub(super) moved: HashMap<State, f64>, // Looked up, never iterated.
    /// By what states may be off, in the sizes in which they are drawn.
    pub(super) blur: f64,
    /// The states that were met, in order.
    pub(super) met: Vec<State>,
    /// What was met that no equation determines, inputs and highest derivatives without an equation of their own, where these have
    /// values.
    pub(super) free: Option<Vec<State>>,
    rates: HashMap<Element, Number>, // Looked up, never iterated.
    open: Vec<Element>,
}

const NO_NUMBER: f64 = f64::NAN;

impl<'p> Point<'p> {
    pub(super) fn new(problem: &'p Problem, motion: &'p Motion, draw: Draw, budget: &'p mut Budget) -> Self {
        let (indices, moved, met, rates, open) = (Indices::new(), HashMap::new(), vec![], HashMap::new(), vec![]);
        Self { problem, motion, draw, budget, indices, moved, blur: 0.0, met, free: None, rates, open }
    }

    /// The value of a node under loops whose indices have values; none where there is none.
    pub(super) fn value(&mut self, node: NodeId, indices: &Indices) -> Option<Number> {
        let outer = std::mem::replace(&mut self.indices, indices.clone());
        let value = eval_in(&self.problem.dag, &[node], self);
        self.indices = outer;
        value
            .ok()
            .map(|values| values[0])
            .filter(|number: &Number| number.value.is_finite() && number.error.is_finite())
    }

    /// Puts states elsewhere.
    pub(super) fn put(&mut self, state: State, value: f64) {
        self.moved.insert(state, value);
        self.rates.clear();
    }

    /// Where a state is.
    pub(super) fn state(&self, state: &State) -> f64 {
        self.moved.get(state).copied().unwrap_or_else(|| self.drawn_state(state))
    }

    /// The size in which a state is drawn: one of the unit in which its output is declared, by one of time.
    pub(super) fn size(&self, (at, order): &State) -> f64 {
        let unit = self.problem.phases[self.motion.phase].outputs[at.output].unit.factor;
        unit / self.problem.independent.unit.factor.powi(i32::try_from(*order).unwrap_or(i32::MAX))
    }

    fn drawn_state(&self, state: &State) -> f64 {
        let (at, order) = state;
        let name = &self.problem.phases[self.motion.phase].outputs[at.output].name;
        let name = name.bytes().fold(0, |seed, byte| mixed(seed ^ u64::from(byte)));
        let numbers = [at.agent, at.member].map(|number| number.map_or(u64::MAX, i64::cast_unsigned));
        self.size(state) * self.drawn(numbers.into_iter().chain([*order as u64]).fold(name, |seed, n| mixed(seed ^ n)))
    }

    /// The value of what no equation determines.
    fn freed(&mut self, state: State) -> Option<Number> {
        self.free.as_mut()?.push(state);
        Some(Number::new(self.state(&state)))
    }

    /// The value of something by its key.
    fn drawn(&self, key: u64) -> f64 {
        let Draw { seed, decades, is_positive, .. } = self.draw;
        let seed = mixed(key ^ mixed(seed));
        let size = 10_f64.powf(decades * (2.0 * fraction(seed) - 1.0)) * (0.5 + fraction(mixed(seed)));
        if is_positive || mixed(mixed(seed)) & 1 == 0 { size } else { -size }
    }

    fn keyed(&self, what: u64, numbers: &[Option<i64>]) -> Number {
        let key = numbers.iter().fold(mixed(what), |seed, n| mixed(seed ^ n.map_or(u64::MAX, i64::cast_unsigned)));
        Number::new(self.drawn(key))
    }

    /// The highest derivative of a state.
    fn rate(&mut self, at: Element) -> Option<Number> {
        if let Some(known) = self.rates.get(&at) {
            return Some(*known);
        }
        let motion = self.motion;
        let (equation, indices) = motion.equation(&at)?;
        if self.open.contains(&at) {
            return None;
        }
        self.open.push(at);
        let [factor, rest, bound] =
            [equation.factor, equation.rest, equation.bound].map(|node| self.value(node, indices));
        self.open.pop();
        let missing = <Number as crate::expr::Scalar>::binary(crate::expr::Binary::Sub, &bound?, &rest?);
        let rate = <Number as crate::expr::Scalar>::binary(crate::expr::Binary::Div, &missing, &factor?);
        self.rates.insert(at, rate);
        Some(rate)
    }

    fn parameter(&self, parameter: usize, index: Option<i64>) -> Number {
        let drawn = self.keyed(u64::MAX - 1, &[Some(parameter as i64), index]);
        let member = index.map_or(Some(0), |index| usize::try_from(index - 1).ok());
        let own = member.and_then(|member| self.problem.parameters[parameter].value.get(member).copied());
        // About as large as it is.
        let is_size = |own: &f64| own.is_finite() && *own != 0.0;
        own.filter(is_size).map_or(drawn, |own| Number::new(own * (0.5 + fraction(drawn.value.to_bits()))))
    }
}

impl Point<'_> {
    fn leaf(&mut self, input: InputId) -> Number {
        if !self.budget.take(1) {
            return Number::new(NO_NUMBER);
        }
        let leaf = self.problem.leaves.leaf(input);
        let at = |form: &Option<Form>| form.as_ref().map(|form| form.at(&self.indices));
        match leaf {
            Leaf::Flat { phase, at: At::Here, output, order, .. } if phase.phase == self.motion.phase => {
                let Some((element, _)) = element(leaf, &self.indices) else { return Number::new(NO_NUMBER) };
                let highest = self.motion.order(*output);
                if highest.is_some_and(|highest| *order > highest) {
                    return Number::new(NO_NUMBER);
                }
                let state = (element, *order);
                if highest == Some(*order) {
                    let rate = self.rate(element);
                    return rate.or_else(|| self.freed(state)).unwrap_or(Number::new(NO_NUMBER));
                }
                if highest.is_none() {
                    return self.freed(state).unwrap_or_else(|| Number::new(self.state(&state)));
                }
                self.met.push(state);
                Number::new(self.state(&state)).blurred(self.blur * self.size(&state))
            }
            Leaf::Flat { phase, index, .. } => {
                self.keyed(u64::from(input.0) + 16, &[at(&phase.agent), at(&phase.index), at(index)])
            }
            Leaf::Time(phase) => self.keyed(0, &[at(&phase.agent)]),
            Leaf::Tau => Number::new(fraction(self.draw.seed ^ self.motion.phase as u64)),
            Leaf::Duration(phase) => {
                let own = self.keyed(1, &[Some(phase.phase as i64), at(&phase.agent), at(&phase.index)]);
                Number::new(own.value.abs())
            }
            Leaf::Start(phase) => self.keyed(2, &[Some(phase.phase as i64), at(&phase.agent), at(&phase.index)]),
            Leaf::Parameter { parameter, index } => self.parameter(*parameter, at(index)),
            Leaf::Variable { variable, index } => {
                let drawn = self.keyed(3, &[Some(*variable as i64), at(index)]);
                Number::new(drawn.value * self.problem.variables[*variable].unit.factor)
            }
            Leaf::Index(form) => Number::exact(form.at(&self.indices) as f64),
            Leaf::Integral { phase, .. } => self.keyed(u64::from(input.0) + 16, &[at(&phase.agent), at(&phase.index)]),
            Leaf::Symbol(_) => Number::new(NO_NUMBER),
        }
    }
}

impl Environment<Number> for Point<'_> {
    fn input(&mut self, input: InputId) -> Number {
        let number = self.leaf(input);
        number.turned(self.draw.is_turned)
    }

    fn table(&mut self, number: u32, args: &[Number], derivative: &[u8]) -> Option<Number> {
        Some(table(number, args, derivative))
    }

    fn range(&mut self, range: u32) -> Option<Vec<i64>> {
        let over = self.problem.ranges.get(range as usize)?;
        let (first, last) = (over.first.at(&self.indices), over.last.at(&self.indices));
        let count = usize::try_from(last.saturating_sub(first).saturating_add(1)).unwrap_or(0);
        self.budget.take(count).then(|| (first..=last).collect())
    }

    fn bind(&mut self, index: u32, value: Option<i64>) -> Option<i64> {
        let index = IndexId(index);
        match value {
            Some(value) => self.indices.insert(index, value),
            None => self.indices.remove(&index),
        }
    }
}
