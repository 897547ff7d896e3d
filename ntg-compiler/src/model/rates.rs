//! How often the equations of motion differentiate each state: what decides the splines of states.
//!
//! Takes the `dynamics` blocks that hold in a phase, gives the highest derivative of each of its outputs, definitions and
//! functions inserted.
//! Every definition, function and step is walked once for each order at which it is met, whatever the number of states
//! and of uses, so that the work is in proportion to the text.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use super::elaborator::Elaborator;
use super::mention::mentions_time;
use super::scope::{Allow, Context, Entity, ScopeId, look_up};
use crate::syntax::ast::{self, BlockPlace, Expr, ExprKind, ItemKind, Statement};

/// The highest derivative that is looked for: more than any spline has, which is told of where it is taken.
const MOST: usize = 32;

/// How deeply functions are looked into: elaboration refuses what is deeper.
const DEEPEST: usize = 500;

/// The highest derivative of each output, by its name; outputs that are not differentiated have 0.
pub(super) type Rates<'a> = HashMap<&'a str, usize>; // Looked up, never iterated.

/// What an expression needs of its surroundings, and how often differentiated.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Need<'a> {
    /// By its name.
    Output(&'a str),
    /// By its place among all.
    Definition(usize),
    /// An argument of the function whose body it is.
    Argument(usize),
}

/// What the body of a function needs, each with the orders at which it is needed.
pub(super) type Needs<'a> = Rc<Vec<(Need<'a>, usize)>>;

/// The needs of functions that were looked into, in the phase's scope; none while that is going on.
pub(super) type FunctionNeeds<'a> = HashMap<(usize, ScopeId), Option<Needs<'a>>>; // Looked up, never iterated.

/// A step of a value, and those before it.
struct Step<'a> {
    name: &'a str,
    value: &'a Expr,
    outer: Option<Rc<Step<'a>>>,
}

/// An expression that is differentiated so often.
struct Look<'a> {
    expr: &'a Expr,
    around: usize,
    steps: Option<Rc<Step<'a>>>,
}

/// One walk: through the equations of a phase, or through the body of a function.
struct Walk<'a> {
    /// The scope of the phase.
    own: ScopeId,
    /// Where names are looked up: `own`, or the library whose text it is.
    scope: ScopeId,
    /// The parameters of the function whose body it is.
    parameters: &'a [ast::Argument],
    /// How many functions are around.
    depth: usize,
    open: Vec<Look<'a>>,
    /// Steps that were met, by their expression and order.
    seen: HashSet<(*const Expr, usize)>,
    met: HashSet<(Need<'a>, usize)>,
    needs: Vec<(Need<'a>, usize)>,
}

impl<'a> Walk<'a> {
    fn new(own: ScopeId, scope: ScopeId, depth: usize) -> Self {
        let (open, seen, met, needs) = (vec![], HashSet::new(), HashSet::new(), vec![]);
        Self { own, scope, parameters: &[], depth, open, seen, met, needs }
    }

    fn push(&mut self, expr: &'a Expr, around: usize, steps: Option<&Rc<Step<'a>>>) {
        if around <= MOST {
            self.open.push(Look { expr, around, steps: steps.cloned() });
        }
    }

    fn need(&mut self, need: Need<'a>, around: usize) {
        if around <= MOST && self.met.insert((need, around)) {
            self.needs.push((need, around));
        }
    }
}

impl<'a> Elaborator<'a> {
    /// The highest derivative of a state in the equations of a phase, definitions and functions inserted.
    pub(super) fn highest_rate(&mut self, phase: usize, name: &str) -> usize {
        if !self.rates.contains_key(&phase) {
            let rates = self.rates_of(phase);
            self.rates.insert(phase, rates);
        }
        self.rates[&phase].get(name).copied().unwrap_or(0)
    }

    fn rates_of(&mut self, phase: usize) -> Rates<'a> {
        let own = self.phases[phase].scope;
        let mut walk = Walk::new(own, own, 0);
        for block in self.equation_blocks(phase) {
            sides(&block.statements, &mut |expr| walk.push(expr, 0, None));
        }
        self.walk(&mut walk);
        let mut rates = Rates::new();
        let mut next = 0;
        while let Some((need, around)) = walk.needs.get(next).copied() {
            next += 1;
            match need {
                Need::Output(name) => {
                    let highest = rates.entry(name).or_default();
                    *highest = around.max(*highest);
                }
                Need::Definition(definition) => {
                    walk.push(self.definitions[definition].value, around, None);
                    self.walk(&mut walk);
                }
                Need::Argument(_) => {} // The equations are in no function.
            }
        }
        rates
    }

    /// Looks at everything that is open, and at what is found on the way.
    fn walk(&mut self, walk: &mut Walk<'a>) {
        while let Some(look) = walk.open.pop() {
            self.looks += 1;
            let Look { expr, around, steps } = look;
            let steps = steps.as_ref();
            match &expr.kind {
                ExprKind::Path(path) => self.name_met(walk, path, around, steps),
                ExprKind::Der { of, order } => {
                    let times = order.as_ref().map_or(Some(1), |order| self.quiet_whole(walk.scope, order));
                    let times = times.and_then(|times| usize::try_from(times).ok()).unwrap_or(1);
                    walk.push(of, around.saturating_add(times), steps);
                }
                ExprKind::Neg(inner) => walk.push(inner, around, steps),
                ExprKind::Tuple(elements) => elements.iter().for_each(|element| walk.push(element, around, steps)),
                ExprKind::Sum(terms) => terms.iter().for_each(|(_, term)| walk.push(term, around, steps)),
                ExprKind::Product(factors) => factors.iter().for_each(|(_, factor)| walk.push(factor, around, steps)),
                ExprKind::Power(base, exponent) => {
                    walk.push(base, around, steps);
                    walk.push(exponent, around, steps);
                }
                ExprKind::Reduce(reduction) => {
                    walk.push(&reduction.body, around, steps);
                    reduction.width.iter().for_each(|width| walk.push(width, around, steps));
                }
                ExprKind::Call(call) | ExprKind::Partial { of: call, .. } => self.call_met(walk, call, around, steps),
                ExprKind::If(conditional) => {
                    for branch in &conditional.branches {
                        branch.condition.sides().into_iter().for_each(|side| walk.push(side, around, steps));
                        walk.push(&branch.value, around, steps);
                    }
                    walk.push(&conditional.otherwise, around, steps);
                }
                ExprKind::Steps(inner) => {
                    let mut steps = steps.cloned();
                    for step in &inner.lets {
                        steps = Some(Rc::new(Step { name: &step.name.text, value: &step.value, outer: steps }));
                    }
                    walk.push(&inner.value, around, steps.as_ref());
                }
                ExprKind::Number(_)
                | ExprKind::Pi
                | ExprKind::Time
                | ExprKind::ScaledTime
                | ExprKind::File(_)
                | ExprKind::Rows(_)
                | ExprKind::Integral { .. }
                | ExprKind::Boundary { .. }
                | ExprKind::Event { .. } => {}
            }
        }
    }

    fn name_met(&mut self, walk: &mut Walk<'a>, path: &'a ast::Path, around: usize, steps: Option<&Rc<Step<'a>>>) {
        let [only] = path.segments.as_slice() else { return };
        let text = only.name.text.as_str();
        let mut next = steps;
        while let Some(step) = next {
            if step.name == text {
                if walk.seen.insert((std::ptr::from_ref(step.value), around)) {
                    walk.push(step.value, around, step.outer.as_ref());
                }
                return;
            }
            next = step.outer.as_ref();
        }
        if let Some(argument) = walk.parameters.iter().position(|parameter| parameter.name.text == text) {
            return walk.need(Need::Argument(argument), around);
        }
        match look_up(&self.scopes, walk.scope, text).map(|(_, declared)| declared.entity) {
            Some(Entity::Output) => walk.need(Need::Output(text), around),
            // Constants hold no state.
            Some(Entity::Definition(definition)) if !self.definitions[definition].is_const => {
                walk.need(Need::Definition(definition), around);
            }
            _ => {}
        }
    }

    fn call_met(&mut self, walk: &mut Walk<'a>, call: &'a ast::Call, around: usize, steps: Option<&Rc<Step<'a>>>) {
        let entity = look_up(&self.scopes, walk.scope, &call.function.text).map(|(_, declared)| declared.entity);
        let Some(Entity::Function(function)) = entity else {
            return call.arguments.iter().for_each(|argument| walk.push(argument, around, steps));
        };
        for (need, inside) in self.function_needs(function, walk).iter() {
            let around = around.saturating_add(*inside);
            match need {
                Need::Argument(argument) => {
                    call.arguments.get(*argument).into_iter().for_each(|expr| walk.push(expr, around, steps));
                }
                other => walk.need(*other, around),
            }
        }
    }

    /// What the body of a function needs; nothing of one that is being looked into, which is refused elsewhere.
    fn function_needs(&mut self, function: usize, around: &Walk<'a>) -> Needs<'a> {
        let home = self.functions[function].scope;
        let scope = if self.scopes[home].is_library { home } else { around.own };
        if let Some(known) = self.function_needs.get(&(function, around.own)) {
            return known.clone().unwrap_or_default();
        }
        if around.depth >= DEEPEST {
            return Needs::default();
        }
        self.function_needs.insert((function, around.own), None);
        let declared = self.functions[function].function;
        let mut walk = Walk::new(around.own, scope, around.depth + 1);
        walk.parameters = &declared.parameters;
        walk.push(&declared.body, 0, None);
        self.walk(&mut walk);
        let needs: Needs<'a> = Rc::new(walk.needs);
        self.function_needs.insert((function, around.own), Some(needs.clone()));
        needs
    }

    /// The order of a derivative; what is wrong with it is told where it is taken.
    fn quiet_whole(&mut self, scope: ScopeId, order: &'a Expr) -> Option<i64> {
        if let Some(number) = order.signed_literal() {
            return Some(number.value as i64);
        }
        if mentions_time(order, &self.problem.independent.name) {
            return None;
        }
        self.whole(&Context::of(scope, Allow::Constants), order, "the order of a derivative")
    }

    /// The blocks of equations that hold in a phase: its own, and those of its agent.
    pub(super) fn equation_blocks(&self, phase: usize) -> Vec<&'a ast::Block> {
        let (scope, agent) = (self.phases[phase].scope, self.phases[phase].agent);
        let common = self.agents[agent].scope;
        let mut scopes = vec![common];
        if scope != common {
            scopes.push(scope);
        }
        let items = scopes.into_iter().flat_map(|scope| self.items[scope]);
        let blocks = items.filter_map(|item| match &item.kind {
            ItemKind::Block(block) if block.place == BlockPlace::Dynamics => Some(block),
            _ => None,
        });
        blocks.collect()
    }
}

/// Calls `visit` with both sides of every relation.
fn sides<'a>(statements: &'a [Statement<ast::Constraint>], visit: &mut dyn FnMut(&'a Expr)) {
    for statement in statements {
        match statement {
            Statement::For(inner) => sides(&inner.body, visit),
            Statement::One(constraint) => constraint.relation.sides().into_iter().for_each(&mut *visit),
        }
    }
}
