//! The walk over a syntax tree that collects its names: first all declarations, then all mentions.

use std::collections::HashMap;

use ntg_compiler::source::Span;
use ntg_compiler::syntax::ast::*;

use super::{Declaration, Derivative, Kind, Mention, Names, Scope as NameScope};

/// The names of a spec, mentions in no particular order.
pub(super) fn names(spec: &Spec) -> Names {
    let mut walk =
        Walk { names: Names::default(), locals: vec![], indices: vec![], in_function: false, opened: HashMap::new() };
    let problem = &spec.problem;
    let doc = problem.doc.as_ref().map(|doc| doc.text.clone());
    let root = walk.open(None, problem.span);
    let declaration = walk.declare(root, &problem.name, Kind::Problem, problem.span, doc, None);
    walk.names.declarations[declaration].inner = Some(root);
    walk.declarations(root, &problem.items);
    walk.items(root, &problem.items);
    walk.names
}

/// The names of a library, mentions in no particular order.
pub(super) fn library(library: &Library, all: Span) -> Names {
    let mut walk =
        Walk { names: Names::default(), locals: vec![], indices: vec![], in_function: false, opened: HashMap::new() };
    let root = walk.open(None, all);
    walk.declarations(root, &library.items);
    walk.items(root, &library.items);
    walk.names
}

/// The working state.
struct Walk {
    names: Names,
    /// Indices and arguments in sight, the innermost last.
    locals: Vec<usize>,
    /// The index ranges around the place.
    indices: Vec<Span>,
    in_function: bool,
    /// The scopes of agents and phases, by the places of their names.
    opened: HashMap<Span, usize>,
}

impl Walk {
    fn open(&mut self, parent: Option<usize>, span: Span) -> usize {
        self.names.scopes.push(NameScope { parent, span, closed: false, names: HashMap::new() });
        self.names.scopes.len() - 1
    }

    /// A name that its scope knows, mentioned where it is declared.
    fn declare(
        &mut self,
        scope: usize,
        name: &Ident,
        kind: Kind,
        statement: Span,
        doc: Option<String>,
        within: Option<Span>,
    ) -> usize {
        let declaration = Declaration { name: name.clone(), kind, scope, statement, doc, within, inner: None };
        self.names.declarations.push(declaration);
        let declaration = self.names.declarations.len() - 1;
        let is_known = within.is_none() && !matches!(kind, Kind::Term | Kind::Constraint | Kind::Problem);
        let mut declarations = vec![declaration];
        if is_known {
            // The same name again in this scope, or an output in a phase that has it from outside: one thing.
            declarations.extend(self.own(scope, &name.text));
            if kind == Kind::Output {
                let outer = self.outwards(self.names.scopes[scope].parent, &name.text);
                declarations.extend(outer.into_iter().filter(|o| self.names.declarations[*o].kind == Kind::Output));
            }
            self.names.scopes[scope].names.entry(name.text.clone()).or_default().push(declaration);
        }
        self.names.mentions.push(Mention { span: name.span, declarations });
        declaration
    }

    /// Everything that a scope's items declare, and what is in the scopes inside.
    fn declarations(&mut self, scope: usize, items: &[Item]) {
        for item in items {
            let doc = item.doc.as_ref().map(|doc| doc.text.clone());
            let kind = match &item.kind {
                ItemKind::Const(it) => (&it.name, Kind::Const),
                ItemKind::Param(it) => (&it.name, Kind::Param),
                ItemKind::Function(it) => (&it.name, Kind::Function),
                ItemKind::Let(it) => (&it.name, Kind::Let),
                ItemKind::Table(it) => (&it.name, Kind::Table),
                ItemKind::Continuation(it) => (&it.name, Kind::Param),
                ItemKind::Duration(Duration { name: Some(name), .. }) => (name, Kind::Duration),
                ItemKind::Variable(variable) => {
                    for name in &variable.names {
                        self.declare(scope, &name.name, Kind::Variable, item.span, doc.clone(), None);
                    }
                    continue;
                }
                ItemKind::Output(output) => {
                    for name in &output.names {
                        self.declare(scope, &name.name, Kind::Output, item.span, doc.clone(), None);
                    }
                    continue;
                }
                ItemKind::Phase(it) => {
                    self.segment_of_time(scope, &it.name, Kind::Phase, item, &it.items);
                    continue;
                }
                ItemKind::Agent(it) => {
                    self.segment_of_time(scope, &it.name, Kind::Agent, item, &it.items);
                    continue;
                }
                ItemKind::Scenario(it) => {
                    self.segment_of_time(scope, &it.name, Kind::Scenario, item, &it.items);
                    continue;
                }
                ItemKind::Domain(it) => (&it.name, Kind::Domain),
                _ => continue,
            };
            self.declare(scope, kind.0, kind.1, item.span, doc, None);
        }
    }

    fn segment_of_time(&mut self, scope: usize, name: &Ident, kind: Kind, item: &Item, items: &[Item]) {
        let doc = item.doc.as_ref().map(|doc| doc.text.clone());
        let declaration = self.declare(scope, name, kind, item.span, doc, None);
        let inner = self.open(Some(scope), item.span);
        self.names.scopes[inner].closed = kind == Kind::Scenario;
        self.names.declarations[declaration].inner = Some(inner);
        self.opened.insert(name.span, inner);
        self.declarations(inner, items);
    }

    // ------------------------------------------------------------ looking up

    /// The declarations of a name in one scope.
    fn own(&self, scope: usize, name: &str) -> Vec<usize> {
        self.names.scopes[scope].names.get(name).cloned().unwrap_or_default()
    }

    fn outwards(&self, mut scope: Option<usize>, name: &str) -> Vec<usize> {
        while let Some(at) = scope {
            let own = self.own(at, name);
            if !own.is_empty() {
                return own;
            }
            scope = self.names.scopes[at].parent;
        }
        vec![]
    }

    /// What a name stands for in a scope: its own or an outer declaration, and those of the scopes inside.
    fn look_up(&self, scope: usize, name: &str) -> Vec<usize> {
        let mut found = self.outwards(Some(scope), name);
        for inner in scope + 1..self.names.scopes.len() {
            if self.names.is_within(inner, scope) && !self.names.scopes[inner].closed {
                found.extend(self.own(inner, name));
            }
        }
        found
    }

    fn mention(&mut self, name: &Ident, declarations: Vec<usize>) {
        if !declarations.is_empty() {
            self.names.mentions.push(Mention { span: name.span, declarations });
        }
    }

    fn name(&mut self, scope: usize, name: &Ident) -> Vec<usize> {
        let is = |at: &&usize| self.names.declarations[**at].name.text == name.text;
        let found = match self.locals.iter().rev().find(is) {
            Some(local) => vec![*local],
            None => self.look_up(scope, &name.text),
        };
        self.mention(name, found.clone());
        found
    }

    /// The names of a path; gives the scope that its end opens.
    fn path(&mut self, scope: usize, path: &Path) -> usize {
        let mut inside = None;
        for segment in &path.segments {
            let found = match inside {
                None => self.name(scope, &segment.name),
                Some(inner) => {
                    let found = self.look_up(inner, &segment.name.text);
                    self.mention(&segment.name, found.clone());
                    found
                }
            };
            self.indices(scope, &segment.indices);
            inside = found.iter().find_map(|at| self.names.declarations[*at].inner).or(inside);
        }
        inside.unwrap_or(scope)
    }

    fn segment(&mut self, scope: usize, segment: &Segment) {
        self.name(scope, &segment.name);
        self.indices(scope, &segment.indices);
    }

    fn indices(&mut self, scope: usize, indices: &[Index]) {
        for index in indices {
            self.expr(scope, &index.first);
            index.last.iter().for_each(|last| self.expr(scope, last));
        }
    }

    // ------------------------------------------------------------ items

    /// What stands behind the names of a list.
    fn declared_names(&mut self, scope: usize, names: &[DeclaredName]) {
        for name in names {
            self.size(scope, &name.shape);
            name.bounds.iter().for_each(|bounds| self.bounds(scope, bounds));
        }
    }

    /// The ends of the axes of a declared size.
    fn size(&mut self, scope: usize, shape: &Option<Shape>) {
        for axis in shape.iter().flat_map(|shape| &shape.axes) {
            axis.first.iter().for_each(|first| self.expr(scope, first));
            self.expr(scope, &axis.last);
        }
    }

    /// A definition with the indices of its family, which are known in its value.
    fn named(&mut self, scope: usize, it: &Let, span: Span) {
        self.size(scope, &it.shape);
        let (locals, indices) = (self.locals.len(), self.indices.len());
        for axis in it.shape.iter().flat_map(|shape| &shape.axes) {
            let Some(index) = &axis.index else { continue };
            let local = self.declare(scope, index, Kind::Index, axis.span, None, Some(span));
            self.locals.push(local);
            self.indices.push(axis.span);
        }
        self.expr(scope, &it.value);
        self.locals.truncate(locals);
        self.indices.truncate(indices);
    }

    fn items(&mut self, scope: usize, items: &[Item]) {
        for item in items {
            self.item(scope, item);
        }
    }

    fn item(&mut self, scope: usize, item: &Item) {
        match &item.kind {
            ItemKind::Const(it) => {
                self.size(scope, &it.shape);
                self.expr(scope, &it.value);
            }
            ItemKind::Param(it) => {
                self.size(scope, &it.shape);
                self.values(scope, &it.default);
            }
            ItemKind::Variable(it) => self.declared_names(scope, &it.names),
            ItemKind::Output(it) => {
                self.declared_names(scope, &it.names);
                if let Course::Spline(spline) = &it.course {
                    let settings = [&spline.order, &spline.intervals, &spline.smoothness];
                    settings.into_iter().flatten().for_each(|setting| self.expr(scope, setting));
                    spline.knots.iter().for_each(|knots| self.values(scope, knots));
                }
            }
            ItemKind::Function(it) => self.function(scope, it, item.span),
            ItemKind::Let(it) => self.named(scope, it, item.span),
            ItemKind::Table(it) => self.table(scope, it),
            ItemKind::Continuation(it) => self.values(scope, &it.values),
            ItemKind::Duration(it) => self.extent(scope, &it.extent),
            ItemKind::Start(it) => self.extent(scope, it),
            ItemKind::Phase(it) => {
                let inner = self.opened.get(&it.name.span).copied().unwrap_or(scope);
                let after = |walk: &mut Self| {
                    it.after.iter().for_each(|after| walk.segment(scope, after));
                    walk.items(inner, &it.items);
                };
                match &it.family {
                    Some(over) => self.over(scope, over, item.span, after),
                    None => after(self),
                }
            }
            ItemKind::Agent(it) => {
                let inner = self.opened.get(&it.name.span).copied().unwrap_or(scope);
                match &it.family {
                    Some(over) => self.over(scope, over, item.span, |walk| walk.items(inner, &it.items)),
                    None => self.items(inner, &it.items),
                }
            }
            ItemKind::Scenario(it) => {
                let inner = self.opened.get(&it.name.span).copied().unwrap_or(scope);
                self.over(scope, &it.family, item.span, |walk| {
                    it.weight.iter().for_each(|weight| walk.expr(scope, weight));
                    walk.items(inner, &it.items);
                });
            }
            ItemKind::Shared(it) => {
                it.inputs.iter().for_each(|input| self.segment(scope, input));
                it.until.iter().for_each(|until| self.expr(scope, until));
            }
            ItemKind::Domain(_) => {}
            ItemKind::Jump(it) => it.outputs.iter().for_each(|output| _ = self.path(scope, output)),
            ItemKind::Continuous(it) => {
                it.outputs.iter().for_each(|output| _ = self.path(scope, output));
                self.expr(scope, &it.up_to);
            }
            ItemKind::Periodic(it) => {
                it.outputs.iter().for_each(|output| self.segment(scope, output));
                it.up_to.iter().for_each(|up_to| self.expr(scope, up_to));
            }
            ItemKind::Collocation(it) => {
                let settings = [&it.points, &it.equalities, &it.intervals];
                settings.into_iter().flatten().for_each(|points| self.expr(scope, points));
                it.knots.iter().for_each(|knots| self.values(scope, knots));
            }
            ItemKind::Objective(it) => {
                if let Some(name) = &it.name {
                    self.declare(scope, name, Kind::Term, item.span, None, None);
                }
                self.expr(scope, &it.value);
            }
            ItemKind::Block(it) => {
                if let Some(Part::Between { from, to, .. }) = &it.part {
                    from.iter().chain(to).for_each(|end| self.expr(scope, end));
                }
                self.statements(scope, &it.statements, &Self::constraint);
            }
            ItemKind::At(it) => {
                self.expr(scope, &it.time);
                self.statements(scope, &it.statements, &Self::constraint);
            }
            ItemKind::Guess(it) => self.statements(scope, &it.statements, &Self::guess),
        }
    }

    fn function(&mut self, scope: usize, function: &Function, span: Span) {
        let before = self.locals.len();
        self.size(scope, &function.shape);
        for parameter in &function.parameters {
            self.size(scope, &parameter.shape);
            let local = self.declare(scope, &parameter.name, Kind::Argument, span, None, Some(span));
            self.locals.push(local);
        }
        self.in_function = true;
        self.expr(scope, &function.body);
        self.in_function = false;
        self.locals.truncate(before);
    }

    fn table(&mut self, scope: usize, table: &Table) {
        table.method.order.iter().for_each(|order| self.expr(scope, order));
        table.method.intervals.iter().for_each(|intervals| self.values(scope, intervals));
        if let TableData::Inline(rows) = &table.data {
            rows.header.iter().flatten().for_each(|node| self.expr(scope, node));
            for row in &rows.rows {
                self.expr(scope, &row.node);
                row.values.iter().for_each(|value| self.expr(scope, value));
            }
        }
    }

    fn extent(&mut self, scope: usize, extent: &Extent) {
        match extent {
            Extent::Fixed(value) => self.expr(scope, value),
            Extent::Free(bounds) => self.bounds(scope, bounds),
        }
    }

    fn bounds(&mut self, scope: usize, bounds: &Bounds) {
        [&bounds.lower, &bounds.upper].into_iter().flatten().for_each(|end| self.expr(scope, end));
    }

    fn values(&mut self, scope: usize, values: &Values) {
        values.elements.iter().for_each(|element| self.expr(scope, element));
    }

    /// Does something in sight of an index.
    fn over(&mut self, scope: usize, range: &IndexRange, within: Span, inside: impl FnOnce(&mut Self)) {
        self.expr(scope, &range.first);
        self.expr(scope, &range.last);
        let local = self.declare(scope, &range.index, Kind::Index, range.span, None, Some(within));
        self.locals.push(local);
        self.indices.push(range.span);
        inside(self);
        self.indices.pop();
        self.locals.pop();
    }

    // ------------------------------------------------------------ statements

    fn statements<T>(&mut self, scope: usize, statements: &[Statement<T>], one: &dyn Fn(&mut Self, usize, &T)) {
        for statement in statements {
            match statement {
                Statement::One(it) => one(self, scope, it),
                Statement::For(it) => {
                    self.over(scope, &it.over, it.span, |walk| walk.statements(scope, &it.body, one));
                }
            }
        }
    }

    fn constraint(&mut self, scope: usize, constraint: &Constraint) {
        if let Some(name) = &constraint.name {
            let doc = constraint.doc.as_ref().map(|doc| doc.text.clone());
            self.declare(scope, name, Kind::Constraint, constraint.span, doc, None);
        }
        if let Some(softness) = &constraint.softness {
            softness.linear.iter().chain(&softness.square).for_each(|price| self.expr(scope, price));
        }
        constraint.relation.sides().into_iter().chain(&constraint.sigma).for_each(|side| self.expr(scope, side));
    }

    fn guess(&mut self, scope: usize, guess: &GuessKind) {
        match guess {
            GuessKind::Assign(assign) => {
                match &assign.target {
                    Target::Path(path) | Target::Event { path: Some(path), .. } => _ = self.path(scope, path),
                    Target::Event { path: None, .. } => {}
                }
                self.expr(scope, &assign.value);
            }
            GuessKind::Route(route) => {
                route.outputs.iter().for_each(|path| _ = self.path(scope, path));
                route.points.iter().flat_map(|point| &point.coordinates).for_each(|e| self.expr(scope, e));
            }
        }
    }

    // ------------------------------------------------------------ expressions

    fn expr(&mut self, scope: usize, expr: &Expr) {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Pi | ExprKind::Time | ExprKind::ScaledTime | ExprKind::Rows(_) => {}
            ExprKind::File(file) => {
                let columns = file.columns.iter();
                columns.flat_map(|c| [&c.first].into_iter().chain(&c.last)).for_each(|end| self.expr(scope, end));
            }
            ExprKind::Path(path) => _ = self.path(scope, path),
            ExprKind::Tuple(elements) => elements.iter().for_each(|element| self.expr(scope, element)),
            ExprKind::Neg(inner) => self.expr(scope, inner),
            ExprKind::Sum(terms) => terms.iter().for_each(|(_, term)| self.expr(scope, term)),
            ExprKind::Product(factors) => factors.iter().for_each(|(_, factor)| self.expr(scope, factor)),
            ExprKind::Power(base, exponent) => {
                self.expr(scope, base);
                self.expr(scope, exponent);
            }
            ExprKind::Call(call) => self.call(scope, call),
            ExprKind::If(conditional) => {
                for branch in &conditional.branches {
                    branch.condition.sides().into_iter().for_each(|side| self.expr(scope, side));
                    branch.smooth.iter().for_each(|width| self.expr(scope, width));
                    self.expr(scope, &branch.value);
                }
                self.expr(scope, &conditional.otherwise);
            }
            ExprKind::Steps(steps) => self.steps(scope, steps, expr.span),
            ExprKind::Der { of, order } => {
                let (indices, in_function) = (self.indices.clone(), self.in_function);
                self.names.derivatives.push(Derivative { span: expr.span, scope, indices, in_function });
                self.expr(scope, of);
                order.iter().for_each(|order| self.expr(scope, order));
            }
            ExprKind::Partial { of, argument } => {
                self.call(scope, of);
                self.expr(scope, argument);
            }
            ExprKind::Integral { path, of } | ExprKind::Boundary { path, of, .. } => {
                let inside = path.as_ref().map_or(scope, |path| self.path(scope, path));
                self.expr(inside, of);
            }
            ExprKind::Event { path, .. } => _ = self.path(scope, path),
            ExprKind::Reduce(reduction) => self.over(scope, &reduction.over, expr.span, |walk| {
                walk.expr(scope, &reduction.body);
                reduction.width.iter().for_each(|width| walk.expr(scope, width));
            }),
        }
    }

    /// Names for the steps of a value, each known in those behind it.
    fn steps(&mut self, scope: usize, steps: &Steps, within: Span) {
        let before = self.locals.len();
        for step in &steps.lets {
            self.named(scope, step, within);
            let statement = step.name.span.to(step.value.span);
            let local = self.declare(scope, &step.name, Kind::Step, statement, None, Some(within));
            self.locals.push(local);
        }
        self.expr(scope, &steps.value);
        self.locals.truncate(before);
    }

    fn call(&mut self, scope: usize, call: &Call) {
        self.name(scope, &call.function);
        call.arguments.iter().for_each(|argument| self.expr(scope, argument));
    }
}
