//! Scenarios as arrays: what a scenario declares gets its index first, and its blocks a loop around them.
//!
//! Takes the items of a problem, gives items without scenarios: `state x [m]` in `scenario plant[k in 1 .. S]` becomes
//! `state plant_x[1 .. S] [m]`, `trajectory { .. x .. }` becomes `trajectory { for k in 1 .. S { .. plant_x[k] .. } }`,
//! and a term of the objective the mean of its members or their sum by weights. `shared u;` stays, with the array's name.
//! Finds: scenarios beside agents, names declared twice, what is shared and no input, bounds that leave a unit open.

use std::borrow::Cow;

use super::rename::{Members, Rename, array};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::*;

/// The items, and what was found.
pub(super) fn expanded(problem: &Problem) -> (Cow<'_, Problem>, Vec<Diagnostic>) {
    let mut members = Members::new();
    collect(&problem.items, &mut members);
    if members.is_empty() {
        return (Cow::Borrowed(problem), vec![]);
    }
    let mut pass = Pass { members: &members, found: vec![] };
    let items = pass.items(&problem.items, true);
    (Cow::Owned(Problem { items, ..problem.clone() }), pass.found)
}

/// Every scenario of the problem and of its agents, with the span of its text.
pub(super) fn scenarios(items: &[Item]) -> Vec<(&Scenario, Span)> {
    let mut all = vec![];
    for item in items {
        match &item.kind {
            ItemKind::Scenario(scenario) => all.push((scenario, item.span)),
            ItemKind::Agent(agent) => all.extend(scenarios(&agent.items)),
            _ => {}
        }
    }
    all
}

/// Tells of the names of scenarios as they are written there, not as those of their arrays.
pub(super) fn in_own_words(finding: &mut Diagnostic, scenarios: &[(&Scenario, Span)]) {
    let holds = |span: &Span| span.start <= finding.span.start && finding.span.end <= span.end;
    // `jump` and `continuous` are about all members.
    let is_whole = finding.message.starts_with("there is no output");
    for (scenario, span) in scenarios {
        let is_inside = holds(span);
        for name in scenario.items.iter().flat_map(|item| declared(&item.kind)) {
            let written = format!("`{}`", array(&scenario.name.text, &name.text));
            let meant = match is_inside {
                true => format!("`{}`", name.text),
                false if is_whole => format!("`{}.{}`", scenario.name.text, name.text),
                false => format!("`{}[{}].{}`", scenario.name.text, scenario.family.index.text, name.text),
            };
            let texts = std::iter::once(&mut finding.message).chain(&mut finding.help);
            let texts = texts.chain(finding.labels.iter_mut().map(|(_, text)| text));
            texts.filter(|text| text.contains(&written)).for_each(|text| *text = text.replace(&written, &meant));
        }
    }
}

fn collect(items: &[Item], members: &mut Members) {
    for (scenario, _) in scenarios(items) {
        let names = scenario.items.iter().flat_map(|item| declared(&item.kind)).map(|name| name.text.clone());
        members.entry(scenario.name.text.clone()).or_default().extend(names);
    }
}

/// The names that an item declares.
fn declared(kind: &ItemKind) -> Vec<&Ident> {
    match kind {
        ItemKind::Const(it) => vec![&it.name],
        ItemKind::Param(it) => vec![&it.name],
        ItemKind::Variable(Variable { names }) | ItemKind::Output(Output { names, .. }) => {
            names.iter().map(|name| &name.name).collect()
        }
        ItemKind::Function(it) => vec![&it.name],
        ItemKind::Let(it) => vec![&it.name],
        ItemKind::Table(it) => vec![&it.name],
        ItemKind::Continuation(it) => vec![&it.name],
        ItemKind::Domain(it) => vec![&it.name],
        ItemKind::Duration(it) => it.name.iter().collect(),
        ItemKind::Phase(it) => vec![&it.name],
        ItemKind::Agent(it) => vec![&it.name],
        ItemKind::Scenario(it) => vec![&it.name],
        _ => vec![],
    }
}

struct Pass<'m> {
    members: &'m Members,
    found: Vec<Diagnostic>,
}

impl Pass<'_> {
    fn items(&mut self, items: &[Item], in_problem: bool) -> Vec<Item> {
        let has_agents = in_problem && items.iter().any(|item| matches!(item.kind, ItemKind::Agent(_)));
        let mut all = vec![];
        for item in items {
            match &item.kind {
                ItemKind::Scenario(scenario) if has_agents => {
                    let finding =
                        Diagnostic::new(Code::WrongLevel, scenario.head, "`scenario` means nothing beside agents");
                    self.found.push(finding.help("move it into the agent that it belongs to"));
                }
                ItemKind::Scenario(scenario) => {
                    self.is_new(scenario, items);
                    self.scenario(scenario, &mut all);
                }
                ItemKind::Agent(agent) => {
                    let mut agent = Agent { items: self.items(&agent.items, false), ..agent.clone() };
                    if let Some(over) = &mut agent.family {
                        let mut rename = Rename::outside(self.members);
                        [&mut over.first, &mut over.last].into_iter().for_each(|end| rename.expr(end));
                    }
                    all.push(Item { kind: ItemKind::Agent(agent), ..item.clone() });
                }
                _ => {
                    let mut item = item.clone();
                    let mut rename = Rename::outside(self.members);
                    rename.item(&mut item.kind);
                    self.found.append(&mut rename.found);
                    all.push(item);
                }
            }
        }
        all
    }

    /// Tells of a scenario that has the name of something else.
    fn is_new(&mut self, scenario: &Scenario, items: &[Item]) {
        let same = items.iter().flat_map(|item| declared(&item.kind)).find(|name| name.text == scenario.name.text);
        if let Some(first) = same.filter(|first| first.span != scenario.name.span) {
            let message = format!("`{}` is declared twice", scenario.name.text);
            let finding = Diagnostic::new(Code::DeclaredTwice, scenario.name.span, message)
                .label(scenario.name.span, "declared again here")
                .label(first.span, "first declared here");
            self.found.push(finding.help("give one of them another name"));
        }
    }

    fn scenario(&mut self, scenario: &Scenario, all: &mut Vec<Item>) {
        for item in &scenario.items {
            let mut rename = Rename::inside(self.members, &scenario.name.text, &scenario.family.index);
            let mut further = None;
            let kind = match item.kind.clone() {
                ItemKind::Output(output) => ItemKind::Output(self.output((scenario, item), output, &mut further)),
                ItemKind::Variable(variable) => {
                    ItemKind::Variable(self.variable((scenario, item), variable, &mut further))
                }
                ItemKind::Let(mut named) => {
                    rename.named(&mut named);
                    named.name.text = array(&scenario.name.text, &named.name.text);
                    named.shape = Some(with_axis(scenario, named.shape, true));
                    ItemKind::Let(named)
                }
                ItemKind::Block(mut block) => {
                    rename.statements(&mut block.statements, &mut Rename::constraint);
                    weigh_prices(scenario, &mut block.statements);
                    block.statements = vec![each(scenario, block.statements, item.span)];
                    ItemKind::Block(block)
                }
                ItemKind::At(mut at) => {
                    rename.statements(&mut at.statements, &mut Rename::constraint);
                    weigh_prices(scenario, &mut at.statements);
                    at.statements = vec![each(scenario, at.statements, item.span)];
                    ItemKind::At(at)
                }
                ItemKind::Guess(mut guess) => {
                    rename.statements(&mut guess.statements, &mut Rename::guess);
                    guess.statements = vec![each(scenario, guess.statements, item.span)];
                    ItemKind::Guess(guess)
                }
                ItemKind::Objective(mut objective) => {
                    rename.expr(&mut objective.value);
                    objective.value = summed(scenario, objective.value);
                    ItemKind::Objective(objective)
                }
                ItemKind::Periodic(mut periodic) => {
                    periodic.outputs.iter_mut().for_each(|output| rename.whole(output, &scenario.family));
                    ItemKind::Periodic(periodic)
                }
                ItemKind::Shared(shared) => ItemKind::Shared(self.shared(scenario, shared)),
                // What may not stand in a scenario was told of when it was read.
                _ => continue,
            };
            self.found.append(&mut rename.found);
            all.push(Item { doc: item.doc.clone(), kind, span: item.span });
            all.extend(further);
        }
    }

    /// The outputs as arrays; bounds that depend on the member as constraints.
    fn output(
        &mut self,
        (scenario, item): (&Scenario, &Item),
        mut output: Output,
        further: &mut Option<Item>,
    ) -> Output {
        let mut statements = vec![];
        for name in &mut output.names {
            let own = name.name.clone();
            name.name.text = array(&scenario.name.text, &own.text);
            if let Some(bounds) = self.bounds(scenario, &own, &mut name.bounds) {
                if name.unit.is_none() {
                    let message = format!("the unit of `{}` is not told by bounds that depend on the member", own.text);
                    let finding = Diagnostic::new(Code::WrongUnit, own.span, message);
                    self.found.push(finding.help(format!("write it before them: `{} [1] in ...`", own.text)));
                }
                statements.push(Statement::One(bounds));
            }
            name.shape = Some(with_axis(scenario, name.shape.take(), false));
        }
        *further = held(scenario, item, BlockPlace::Trajectory, statements);
        output
    }

    fn variable(
        &mut self,
        (scenario, item): (&Scenario, &Item),
        mut variable: Variable,
        further: &mut Option<Item>,
    ) -> Variable {
        let mut statements = vec![];
        for name in &mut variable.names {
            let own = name.name.clone();
            name.name.text = array(&scenario.name.text, &own.text);
            statements.extend(self.bounds(scenario, &own, &mut name.bounds).map(Statement::One));
            name.shape = Some(with_axis(scenario, name.shape.take(), false));
        }
        *further = held(scenario, item, BlockPlace::Temporal, statements);
        variable
    }

    /// Takes bounds out of a declaration if they depend on the member: a constraint instead.
    fn bounds(&mut self, scenario: &Scenario, name: &Ident, bounds: &mut Option<Bounds>) -> Option<Constraint> {
        let mut rename = Rename::inside(self.members, &scenario.name.text, &scenario.family.index);
        let mut renamed = bounds.clone()?;
        rename.bounds(&mut renamed);
        self.found.append(&mut rename.found);
        if renamed == *bounds.as_ref()? && !rename.meets_index {
            return None;
        }
        *bounds = None;
        let span = name.span.to(renamed.span);
        let segment = Segment { name: name.clone(), indices: vec![], span: name.span };
        let mut path = Path { segments: vec![segment], span: name.span };
        Rename::inside(self.members, &scenario.name.text, &scenario.family.index).path(&mut path);
        let value = Expr { kind: ExprKind::Path(path), span: name.span };
        let relation = Relation::In { value, bounds: renamed };
        Some(Constraint { doc: None, softness: None, name: None, relation, sigma: None, span })
    }

    /// What is shared, by the names of its arrays.
    fn shared(&mut self, scenario: &Scenario, mut shared: Shared) -> Shared {
        shared.inputs.retain_mut(|input| {
            let declaration = scenario.items.iter().find_map(|item| match &item.kind {
                ItemKind::Output(output) => {
                    output.names.iter().any(|name| name.name.text == input.name.text).then_some(output.role)
                }
                _ => None,
            });
            let message = match declaration {
                Some(Role::Input | Role::Output) => {
                    input.name.text = array(&scenario.name.text, &input.name.text);
                    return true;
                }
                Some(Role::State) => {
                    format!("`{}` is a state, which each member has from its own equations", input.name.text)
                }
                None => format!("`{}` is no input of the scenario `{}`", input.name.text, scenario.name.text),
            };
            let finding = Diagnostic::new(Code::UnknownName, input.name.span, message);
            self.found.push(
                finding.help("only inputs that the scenario declares are shared; what stands outside is common anyway"),
            );
            false
        });
        shared
    }
}

/// The size of what a scenario declares: its members first.
fn with_axis(scenario: &Scenario, shape: Option<Shape>, named: bool) -> Shape {
    let IndexRange { index, first, last, span } = &scenario.family;
    let index = named.then(|| index.clone());
    let axis = ShapeAxis { index, first: Some(first.clone()), last: last.clone(), span: *span };
    match shape {
        Some(mut shape) => {
            shape.axes.insert(0, axis);
            shape
        }
        None => Shape { axes: vec![axis], span: *span },
    }
}

/// Statements for each member.
fn each<T>(scenario: &Scenario, body: Vec<Statement<T>>, span: Span) -> Statement<T> {
    Statement::For(For { over: scenario.family.clone(), body, span })
}

/// A block of constraints for each member, if there are any.
fn held(scenario: &Scenario, item: &Item, place: BlockPlace, body: Vec<Statement<Constraint>>) -> Option<Item> {
    if body.is_empty() {
        return None;
    }
    let block = Block { place, part: None, statements: vec![each(scenario, body, item.span)] };
    Some(Item { doc: None, kind: ItemKind::Block(block), span: item.span })
}

/// The prices of soft constraints times the weights of the members, as their other costs.
fn weigh_prices(scenario: &Scenario, statements: &mut [Statement<Constraint>]) {
    for statement in statements {
        match statement {
            Statement::For(inner) => weigh_prices(scenario, &mut inner.body),
            Statement::One(Constraint { softness: Some(softness), .. }) => {
                for price in softness.linear.iter_mut().chain(&mut softness.square) {
                    *price = weighed(scenario, price.clone());
                }
            }
            Statement::One(_) => {}
        }
    }
}

/// The sum over the members by their weights, or their mean.
fn summed(scenario: &Scenario, value: Expr) -> Expr {
    let span = value.span;
    let body = weighed(scenario, value);
    let reduction = Reduction { op: ReduceOp::Sum, over: scenario.family.clone(), body, width: None };
    Expr { kind: ExprKind::Reduce(Box::new(reduction)), span }
}

/// A member's part of a sum by weights, or of a mean.
fn weighed(scenario: &Scenario, value: Expr) -> Expr {
    let span = value.span;
    let IndexRange { first, last, .. } = &scenario.family;
    let body = match &scenario.weight {
        Some(weight) => vec![(MulOp::Multiply, weight.clone()), (MulOp::Multiply, value)],
        None => {
            let one = Expr { kind: ExprKind::Number(Number { value: 1.0, unit: None }), span: last.span };
            let count = vec![(Sign::Plus, last.clone()), (Sign::Minus, first.clone()), (Sign::Plus, one)];
            let count = Expr { kind: ExprKind::Sum(count), span: last.span };
            vec![(MulOp::Multiply, value), (MulOp::Divide, count)]
        }
    };
    Expr { kind: ExprKind::Product(body), span }
}
