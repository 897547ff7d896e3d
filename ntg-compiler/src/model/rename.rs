//! Walks over expressions and gives the names in them that belong to scenarios their array's name and index.
//!
//! Takes parts of a syntax tree, changes them in place: inside a scenario `x` becomes `plant_x[k]`, anywhere
//! `plant[2].x` becomes `plant_x[2]`. What an index, an argument or a step hides stays what it is.
//! Finds: paths into a scenario that lead nowhere, names of arrays that only the program has.

use std::collections::BTreeMap;

use super::suggest::nearest;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::*;

/// The names that each scenario declares.
pub(super) type Members = BTreeMap<String, Vec<String>>;

/// The name of the array that a name of a scenario becomes.
pub(super) fn array(scenario: &str, name: &str) -> String {
    format!("{scenario}_{name}")
}

/// See the module's header.
pub(super) struct Rename<'n> {
    scenarios: &'n Members,
    /// The scenario around, and its index.
    inside: Option<(&'n str, &'n Ident)>,
    /// Names bound around the place, the innermost last.
    locals: Vec<String>,
    /// Whether the index of the scenario was met.
    pub(super) meets_index: bool,
    pub(super) found: Vec<Diagnostic>,
}

impl<'n> Rename<'n> {
    pub(super) fn outside(scenarios: &'n Members) -> Self {
        Self { scenarios, inside: None, locals: vec![], meets_index: false, found: vec![] }
    }

    pub(super) fn inside(scenarios: &'n Members, scenario: &'n str, index: &'n Ident) -> Self {
        Self { inside: Some((scenario, index)), ..Self::outside(scenarios) }
    }

    // ------------------------------------------------------------ names

    /// Whether a name is that of something declared in the scenario around.
    fn is_own(&self, name: &str) -> Option<(&'n str, &'n Ident)> {
        let (scenario, index) = self.inside?;
        let is_hidden = self.locals.iter().any(|local| local == name);
        let own = self.scenarios.get(scenario).is_some_and(|names| names.iter().any(|own| own == name));
        (own && !is_hidden).then_some((scenario, index))
    }

    pub(super) fn path(&mut self, path: &mut Path) {
        path.segments.iter_mut().for_each(|segment| self.indices(&mut segment.indices));
        let Some(first) = path.segments.first_mut() else { return };
        if self.inside.is_some_and(|(_, index)| index.text == first.name.text) {
            self.meets_index = true;
        }
        if self.locals.contains(&first.name.text) {
            return;
        }
        if let Some((scenario, index)) = self.is_own(&first.name.text) {
            first.name.text = array(scenario, &first.name.text);
            first.indices.insert(0, member(index));
            return;
        }
        self.name_of_array(&first.name);
        if let Some(at) = path.segments.iter().position(|s| self.scenarios.contains_key(&s.name.text)) {
            self.name_of_member(path, at);
        }
    }

    /// Tells of `plant_x`, which is what `x` becomes, and no name of the spec: it would mean all members.
    fn name_of_array(&mut self, name: &Ident) {
        let all = self.scenarios.iter().flat_map(|(scenario, names)| names.iter().map(move |own| (scenario, own)));
        let mut meant = all.filter(|(scenario, own)| array(scenario, own) == name.text);
        let Some((scenario, own)) = meant.next() else { return };
        let finding = Diagnostic::new(Code::UnknownName, name.span, format!("unknown name `{}`", name.text));
        self.found.push(finding.help(match self.inside {
            Some((around, _)) if around == scenario => format!("the member's own is `{own}`"),
            _ => format!("a member's is `{scenario}[1].{own}`"),
        }));
    }

    /// `plant[2].x`: the segment `at` names a scenario.
    fn name_of_member(&mut self, path: &mut Path, at: usize) {
        let scenario = path.segments[at].name.clone();
        let names = &self.scenarios[&scenario.text];
        let example = names.first().map_or("x", String::as_str);
        let Some(own) = path.segments.get(at + 1).map(|segment| segment.name.clone()) else {
            let message = format!("`{}` is a scenario, not a value", scenario.text);
            let help = format!("write what you mean of it: `{}[1].{example}`", scenario.text);
            self.found.push(Diagnostic::new(Code::NoValue, path.span, message).help(help));
            return;
        };
        if !names.contains(&own.text) {
            let message = format!("the scenario `{}` has no `{}`", scenario.text, own.text);
            let help = match nearest(&own.text, names.iter().map(String::as_str)) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!(
                    "its names are {}",
                    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
                ),
            };
            self.found.push(Diagnostic::new(Code::UnknownName, path.span, message).help(help));
            return;
        }
        if path.segments[at].indices.len() != 1 {
            let message = format!("`{}` has members: which one is meant?", scenario.text);
            let help = format!("write `{0}[1].{1}` or `{0}[k].{1}`", scenario.text, own.text);
            self.found.push(Diagnostic::new(Code::WrongIndices, path.segments[at].span, message).help(help));
            return;
        }
        let outer = path.segments.remove(at);
        let segment = &mut path.segments[at];
        segment.name.text = array(&scenario.text, &own.text);
        segment.indices.splice(0..0, outer.indices);
        segment.span = outer.span.to(segment.span);
    }

    /// A name without a path, all of whose members are meant: only of an element of it an index is written.
    pub(super) fn whole(&mut self, segment: &mut Segment, family: &IndexRange) {
        self.indices(&mut segment.indices);
        let Some((scenario, _)) = self.is_own(&segment.name.text) else { return };
        segment.name.text = array(scenario, &segment.name.text);
        if !segment.indices.is_empty() {
            let all = Index { first: family.first.clone(), last: Some(family.last.clone()), span: segment.span };
            segment.indices.insert(0, all);
        }
    }

    /// `plant.x`, which is about all members, or `plant[2].x`.
    fn all_members(&mut self, path: &mut Path) {
        let is_whole = matches!(path.segments.as_slice(), [scenario, own] if scenario.indices.is_empty()
            && self.scenarios.get(&scenario.name.text).is_some_and(|names| names.contains(&own.name.text)));
        if !is_whole {
            return self.path(path);
        }
        let scenario = path.segments.remove(0);
        let segment = &mut path.segments[0];
        segment.name.text = array(&scenario.name.text, &segment.name.text);
        segment.span = scenario.span.to(segment.span);
    }

    fn indices(&mut self, indices: &mut [Index]) {
        for index in indices {
            self.expr(&mut index.first);
            index.last.iter_mut().for_each(|last| self.expr(last));
        }
    }

    /// Does something where a name is bound.
    fn binding(&mut self, name: &Ident, inside: impl FnOnce(&mut Self)) {
        self.locals.push(name.text.clone());
        inside(self);
        self.locals.pop();
    }

    // ------------------------------------------------------------ items

    pub(super) fn items(&mut self, items: &mut [Item]) {
        items.iter_mut().for_each(|item| self.item(&mut item.kind));
    }

    /// Everything in an item but the items of scenarios.
    pub(super) fn item(&mut self, kind: &mut ItemKind) {
        match kind {
            ItemKind::Const(it) => self.expr(&mut it.value),
            ItemKind::Param(it) => self.values(&mut it.default),
            ItemKind::Variable(Variable { names }) | ItemKind::Output(Output { names, .. }) => {
                names.iter_mut().flat_map(|name| &mut name.bounds).for_each(|bounds| self.bounds(bounds));
            }
            ItemKind::Function(it) => {
                let before = self.locals.len();
                self.locals.extend(it.parameters.iter().map(|parameter| parameter.name.text.clone()));
                self.expr(&mut it.body);
                self.locals.truncate(before);
            }
            ItemKind::Let(it) => self.named(it),
            ItemKind::Continuation(it) => self.values(&mut it.values),
            ItemKind::Duration(it) => self.extent(&mut it.extent),
            ItemKind::Start(it) => self.extent(it),
            ItemKind::Phase(it) => match &it.family {
                Some(over) => self.binding(&over.index, |this| this.items(&mut it.items)),
                None => self.items(&mut it.items),
            },
            ItemKind::Agent(it) => match &it.family {
                Some(over) => self.binding(&over.index, |this| this.items(&mut it.items)),
                None => self.items(&mut it.items),
            },
            ItemKind::Objective(it) => self.expr(&mut it.value),
            ItemKind::Block(it) => {
                if let Some(Part::Between { from, to, .. }) = &mut it.part {
                    from.iter_mut().chain(to).for_each(|end| self.expr(end));
                }
                self.statements(&mut it.statements, &mut Self::constraint);
            }
            ItemKind::At(it) => {
                self.expr(&mut it.time);
                self.statements(&mut it.statements, &mut Self::constraint);
            }
            ItemKind::Guess(it) => self.statements(&mut it.statements, &mut Self::guess),
            ItemKind::Jump(it) => it.outputs.iter_mut().for_each(|output| self.all_members(output)),
            ItemKind::Continuous(it) => it.outputs.iter_mut().for_each(|output| self.all_members(output)),
            ItemKind::Shared(it) => it.until.iter_mut().for_each(|until| self.expr(until)),
            ItemKind::Table(_)
            | ItemKind::Domain(_)
            | ItemKind::Scenario(_)
            | ItemKind::Periodic(_)
            | ItemKind::Collocation(_) => {}
        }
    }

    pub(super) fn named(&mut self, it: &mut Let) {
        let before = self.locals.len();
        let indices = it.shape.iter().flat_map(|shape| &shape.axes).filter_map(|axis| axis.index.as_ref());
        self.locals.extend(indices.map(|index| index.text.clone()));
        self.expr(&mut it.value);
        self.locals.truncate(before);
    }

    pub(super) fn statements<T>(&mut self, statements: &mut [Statement<T>], one: &mut dyn FnMut(&mut Self, &mut T)) {
        for statement in statements {
            match statement {
                Statement::One(inner) => one(self, inner),
                Statement::For(inner) => {
                    self.range(&mut inner.over);
                    self.locals.push(inner.over.index.text.clone());
                    self.statements(&mut inner.body, one);
                    self.locals.pop();
                }
            }
        }
    }

    pub(super) fn constraint(&mut self, constraint: &mut Constraint) {
        if let Some(softness) = &mut constraint.softness {
            softness.linear.iter_mut().chain(&mut softness.square).for_each(|price| self.expr(price));
        }
        self.relation(&mut constraint.relation);
        constraint.sigma.iter_mut().for_each(|sigma| self.expr(sigma));
    }

    pub(super) fn guess(&mut self, guess: &mut GuessKind) {
        match guess {
            GuessKind::Assign(assign) => {
                if let Target::Path(path) = &mut assign.target {
                    self.path(path);
                }
                self.expr(&mut assign.value);
            }
            GuessKind::Route(route) => {
                route.outputs.iter_mut().for_each(|output| self.path(output));
                route.points.iter_mut().flat_map(|point| &mut point.coordinates).for_each(|value| self.expr(value));
            }
        }
    }

    fn extent(&mut self, extent: &mut Extent) {
        match extent {
            Extent::Fixed(value) => self.expr(value),
            Extent::Free(bounds) => self.bounds(bounds),
        }
    }

    // ------------------------------------------------------------ expressions

    fn values(&mut self, values: &mut Values) {
        values.elements.iter_mut().for_each(|value| self.expr(value));
    }

    pub(super) fn bounds(&mut self, bounds: &mut Bounds) {
        bounds.lower.iter_mut().chain(&mut bounds.upper).for_each(|end| self.expr(end));
    }

    fn range(&mut self, range: &mut IndexRange) {
        self.expr(&mut range.first);
        self.expr(&mut range.last);
    }

    fn relation(&mut self, relation: &mut Relation) {
        match relation {
            Relation::Compare { left, right, .. } => [left, right].into_iter().for_each(|side| self.expr(side)),
            Relation::Between { first, middle, last, .. } => {
                [first, middle, last].into_iter().for_each(|side| self.expr(side));
            }
            Relation::In { value, bounds } => {
                self.expr(value);
                self.bounds(bounds);
            }
        }
    }

    pub(super) fn expr(&mut self, expr: &mut Expr) {
        match &mut expr.kind {
            ExprKind::Number(_)
            | ExprKind::Pi
            | ExprKind::Time
            | ExprKind::ScaledTime
            | ExprKind::File(_)
            | ExprKind::Rows(_) => {}
            ExprKind::Path(path) => self.path(path),
            ExprKind::Tuple(elements) => elements.iter_mut().for_each(|element| self.expr(element)),
            ExprKind::Neg(inner) => self.expr(inner),
            ExprKind::Sum(terms) => terms.iter_mut().for_each(|(_, term)| self.expr(term)),
            ExprKind::Product(factors) => factors.iter_mut().for_each(|(_, factor)| self.expr(factor)),
            ExprKind::Power(base, exponent) => [base, exponent].into_iter().for_each(|part| self.expr(part)),
            ExprKind::Call(call) => call.arguments.iter_mut().for_each(|argument| self.expr(argument)),
            ExprKind::Der { of, order } => {
                self.expr(of);
                order.iter_mut().for_each(|order| self.expr(order));
            }
            // The argument is told by its name.
            ExprKind::Partial { of, .. } => of.arguments.iter_mut().for_each(|argument| self.expr(argument)),
            ExprKind::Integral { path, of } | ExprKind::Boundary { path, of, .. } => {
                path.iter_mut().for_each(|path| self.places(path));
                self.expr(of);
            }
            ExprKind::Event { path, .. } => self.places(path),
            ExprKind::Reduce(reduction) => {
                self.range(&mut reduction.over);
                reduction.width.iter_mut().for_each(|width| self.expr(width));
                self.locals.push(reduction.over.index.text.clone());
                self.expr(&mut reduction.body);
                self.locals.pop();
            }
            ExprKind::If(conditional) => {
                for branch in &mut conditional.branches {
                    self.relation(&mut branch.condition);
                    branch.smooth.iter_mut().for_each(|width| self.expr(width));
                    self.expr(&mut branch.value);
                }
                self.expr(&mut conditional.otherwise);
            }
            ExprKind::Steps(steps) => {
                let before = self.locals.len();
                for step in &mut steps.lets {
                    self.named(step);
                    self.locals.push(step.name.text.clone());
                }
                self.expr(&mut steps.value);
                self.locals.truncate(before);
            }
        }
    }

    /// A path to a phase or an agent: only its indices are values.
    fn places(&mut self, path: &mut Path) {
        path.segments.iter_mut().for_each(|segment| self.indices(&mut segment.indices));
    }
}

/// The member of the scenario that an index stands for.
fn member(index: &Ident) -> Index {
    let span = index.span;
    let segment = Segment { name: index.clone(), indices: vec![], span };
    let first = Expr { kind: ExprKind::Path(Path { segments: vec![segment], span }), span };
    Index { first, last: None, span }
}
