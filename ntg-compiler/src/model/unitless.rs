//! Whether a spec writes any unit that is more than a pure number.
//!
//! A spec that never does is dimensionless throughout, time included (docs/language.md, section 2).
//! Angles alone do not make a difference: `[deg]` is a factor.

use super::units::quantity;
use crate::syntax::ast::*;

/// See the module's header.
pub(super) fn is_unitless(items: &[Item]) -> bool {
    let constant = |item: &Item| match &item.kind {
        ItemKind::Const(constant) => Some(constant.name.text.clone()),
        _ => None,
    };
    let mut look = Look { found: false, constants: items.iter().filter_map(constant).collect() };
    look.items(items);
    !look.found
}

struct Look {
    found: bool,
    /// The names of constants: one of them in brackets was meant as a size.
    constants: Vec<String>,
}

impl Look {
    fn items(&mut self, items: &[Item]) {
        for item in items {
            match &item.kind {
                ItemKind::Const(c) => self.expr(&c.value),
                ItemKind::Param(p) => self.values(&p.default),
                ItemKind::Variable(v) => self.names(&v.names),
                ItemKind::Output(o) => self.names(&o.names),
                ItemKind::Function(f) => {
                    f.parameters.iter().for_each(|argument| self.unit(&argument.unit));
                    self.unit(&f.unit);
                    self.expr(&f.body);
                }
                ItemKind::Let(l) => {
                    self.unit(&l.unit);
                    self.expr(&l.value);
                }
                ItemKind::Table(t) => {
                    self.unit(&t.unit);
                    t.axes.iter().for_each(|axis| self.unit(&axis.unit));
                }
                ItemKind::Continuation(c) => self.values(&c.values),
                ItemKind::Domain(d) => self.unit(&d.unit),
                ItemKind::Duration(d) => self.extent(&d.extent),
                ItemKind::Start(extent) => self.extent(extent),
                ItemKind::Scenario(s) => {
                    self.items(&s.items);
                    s.weight.iter().for_each(|weight| self.expr(weight));
                }
                ItemKind::Shared(s) => s.until.iter().for_each(|until| self.expr(until)),
                ItemKind::Phase(p) => self.items(&p.items),
                ItemKind::Agent(a) => self.items(&a.items),
                ItemKind::Objective(o) => {
                    self.unit(&o.unit);
                    self.expr(&o.value);
                }
                ItemKind::Block(b) => {
                    if let Some(Part::Between { from, to, .. }) = &b.part {
                        from.iter().chain(to).for_each(|end| self.expr(end));
                    }
                    self.statements(&b.statements, &mut Self::constraint);
                }
                ItemKind::At(a) => {
                    self.expr(&a.time);
                    self.statements(&a.statements, &mut Self::constraint);
                }
                ItemKind::Guess(g) => self.statements(&g.statements, &mut Self::guess),
                ItemKind::Jump(_) | ItemKind::Continuous(_) | ItemKind::Periodic(_) | ItemKind::Collocation(_) => {}
            }
        }
    }

    fn unit(&mut self, unit: &Option<Unit>) {
        let is_size = |unit: &Unit| match unit.factors.as_slice() {
            [UnitFactor { base: UnitBase::Symbol(name), power: 1, .. }] => self.constants.contains(&name.text),
            _ => false,
        };
        // A unit that is wrong was meant as one.
        self.found |= unit
            .as_ref()
            .filter(|unit| !is_size(unit))
            .is_some_and(|unit| !matches!(quantity(unit), Ok(q) if q.dimension.is_none()));
    }

    fn values(&mut self, values: &Values) {
        values.elements.iter().for_each(|value| self.expr(value));
    }

    fn names(&mut self, names: &[DeclaredName]) {
        for name in names {
            self.unit(&name.unit);
            self.bounds(&name.bounds);
        }
    }

    fn bounds(&mut self, bounds: &Option<Bounds>) {
        if let Some(bounds) = bounds {
            bounds.lower.iter().chain(&bounds.upper).for_each(|end| self.expr(end));
        }
    }

    fn extent(&mut self, extent: &Extent) {
        match extent {
            Extent::Fixed(value) => self.expr(value),
            Extent::Free(bounds) => bounds.lower.iter().chain(&bounds.upper).for_each(|end| self.expr(end)),
        }
    }

    fn statements<T>(&mut self, statements: &[Statement<T>], one: &mut dyn FnMut(&mut Self, &T)) {
        for statement in statements {
            match statement {
                Statement::One(inner) => one(self, inner),
                Statement::For(inner) => self.statements(&inner.body, one),
            }
        }
    }

    fn constraint(&mut self, constraint: &Constraint) {
        if let Some(softness) = &constraint.softness {
            softness.linear.iter().chain(&softness.square).for_each(|price| self.expr(price));
        }
        constraint.sigma.iter().for_each(|sigma| self.expr(sigma));
        match &constraint.relation {
            Relation::Compare { left, right, .. } => [left, right].into_iter().for_each(|e| self.expr(e)),
            Relation::Between { first, middle, last, .. } => {
                [first, middle, last].into_iter().for_each(|e| self.expr(e));
            }
            Relation::In { value, bounds } => {
                self.expr(value);
                bounds.lower.iter().chain(&bounds.upper).for_each(|end| self.expr(end));
            }
        }
    }

    fn guess(&mut self, guess: &GuessKind) {
        match guess {
            GuessKind::Assign(assign) => self.expr(&assign.value),
            GuessKind::Route(route) => {
                route.points.iter().flat_map(|p| &p.coordinates).for_each(|value| self.expr(value));
            }
        }
    }

    fn expr(&mut self, expr: &Expr) {
        let mut open = vec![expr];
        while let Some(expr) = open.pop() {
            if self.found {
                return;
            }
            match &expr.kind {
                ExprKind::Number(number) => self.unit(&number.unit),
                ExprKind::Neg(inner) | ExprKind::Der { of: inner, .. } => open.push(inner),
                ExprKind::Tuple(elements) => open.extend(elements),
                ExprKind::Sum(terms) => open.extend(terms.iter().map(|(_, term)| term)),
                ExprKind::Product(factors) => open.extend(factors.iter().map(|(_, factor)| factor)),
                ExprKind::Power(base, exponent) => open.extend([&**base, &**exponent]),
                ExprKind::Call(call) | ExprKind::Partial { of: call, .. } => open.extend(&call.arguments),
                ExprKind::Integral { of, .. } | ExprKind::Boundary { of, .. } => open.push(of),
                ExprKind::Reduce(reduction) => {
                    open.push(&reduction.body);
                    open.extend(&reduction.width);
                }
                ExprKind::If(conditional) => {
                    for branch in &conditional.branches {
                        open.extend(branch.condition.sides());
                        open.extend(&branch.smooth);
                        open.push(&branch.value);
                    }
                    open.push(&conditional.otherwise);
                }
                ExprKind::Steps(steps) => {
                    steps.lets.iter().for_each(|step| self.unit(&step.unit));
                    open.extend(steps.lets.iter().map(|step| &step.value));
                    open.push(&steps.value);
                }
                ExprKind::File(file) => self.unit(&file.unit),
                ExprKind::Pi
                | ExprKind::Time
                | ExprKind::ScaledTime
                | ExprKind::Path(_)
                | ExprKind::Event { .. }
                | ExprKind::Rows(_) => {}
            }
        }
    }
}
