//! How many elements an expression has along each axis: numbers, vectors, matrices.
//!
//! Takes expressions, gives a [`Shape`]; no node is made, so that a vector stays a rule that gives an element for an
//! index (`element.rs`). Names that nothing has count as numbers: whoever elaborates them tells.
//! Finds: shapes that do not fit (E046), vectors where one number is needed (E047).

use super::elaborator::Elaborator;
use super::functions::{Builtin, builtin};
use super::problem::{Form, IndexId};
use super::scope::{Context, Entity, Meaning, Point, ScopeId, look_up};
use super::vectors::{VectorFunction, vector_function};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{Call, Expr, ExprKind, MulOp, Path, ReduceOp, Segment, Sign};

/// How many elements something has.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Shape {
    /// As many as are wanted: the literal 0.
    Any,
    /// This many along each axis: none for a number, one for a vector, rows and columns for a matrix.
    Of(Vec<i64>),
}

/// The first and the last index of an axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Ends {
    pub(super) first: Form,
    pub(super) last: Form,
}

impl Ends {
    /// `1 .. n`
    pub(super) fn to(n: i64) -> Self {
        Self { first: Form::number(1), last: Form::number(n) }
    }

    /// `first .. last`
    pub(super) fn between(first: i64, last: i64) -> Self {
        Self { first: Form::number(first), last: Form::number(last) }
    }

    /// How many indices there are, where the ends say so.
    pub(super) fn extent(&self) -> Option<i64> {
        let extent = self.last.plus(-1, &self.first)?.as_number()?;
        Some((extent + 1).max(0))
    }

    /// Both ends, where they are numbers.
    pub(super) fn numbers(&self) -> Option<(i64, i64)> {
        self.first.as_number().zip(self.last.as_number())
    }
}

/// What a function makes of its arguments' shapes, as far as it is known.
pub(super) type FunctionKey = (usize, Vec<Shape>, ScopeId);

impl Shape {
    /// One number.
    pub(super) const NUMBER: Self = Self::Of(Vec::new());

    /// How many axes there are; a literal 0 is a number where it may be one.
    pub(super) fn axes(&self) -> &[i64] {
        match self {
            Self::Any => &[],
            Self::Of(axes) => axes,
        }
    }

    /// Whether it may be one number.
    pub(super) fn is_number(&self) -> bool {
        self.axes().is_empty()
    }

    /// The shape of two things that must have one; none where they do not fit.
    fn joined(&self, other: &Self) -> Option<Self> {
        match (self, other) {
            (Self::Any, shape) | (shape, Self::Any) => Some(shape.clone()),
            (a, b) => (a == b).then(|| a.clone()),
        }
    }

    /// `3`, `3 x 3`: the numbers of elements.
    pub(super) fn sizes(&self) -> String {
        self.axes().iter().map(i64::to_string).collect::<Vec<_>>().join(" x ")
    }

    /// What a person calls it: `a number`, `a vector of 3`, `a matrix of 3 x 3`.
    pub(super) fn describe(&self) -> String {
        match self.axes() {
            [] => "a number".to_owned(),
            [n] => format!("a vector of {n}"),
            [_, _] => format!("a matrix of {}", self.sizes()),
            _ => format!("an array of {}", self.sizes()),
        }
    }
}

impl<'a> Elaborator<'a> {
    /// The shape of an expression; none where something in it was told of.
    pub(super) fn shape(&mut self, cx: &Context<'a>, expr: &'a Expr) -> Option<Shape> {
        let shape = if self.deeper(expr.span) { self.shape_kind(cx, expr) } else { None };
        self.leave();
        shape
    }

    /// Whether an expression is one number; told where it is not.
    pub(super) fn is_number(&mut self, cx: &Context<'a>, expr: &'a Expr) -> bool {
        let Some(shape) = self.shape(cx, expr) else { return false };
        if !shape.is_number() {
            self.no_number(expr.span, &shape);
        }
        shape.is_number()
    }

    /// Tells of a vector where one number is needed.
    pub(super) fn no_number(&mut self, span: Span, shape: &Shape) {
        let text = self.text(span);
        let message = format!("one number is needed here, `{text}` is {}", shape.describe());
        let is_name = text.chars().all(|c| c.is_alphanumeric() || c == '_');
        let element = if shape.axes().len() == 1 { "[1]" } else { "[1, 1]" };
        let help = match (is_name, shape.axes().len()) {
            (true, 1) => format!("`norm({text})` is its length, `{text}{element}` an element"),
            (true, _) => format!("`{text}{element}` is an element"),
            (false, 1) => format!("`norm({text})` is its length; give it a name by `let` to take an element of it"),
            (false, _) => "give it a name by `let` to take an element of it".to_owned(),
        };
        self.report(Diagnostic::new(Code::NoNumber, span, message).help(help));
    }

    fn shape_kind(&mut self, cx: &Context<'a>, expr: &'a Expr) -> Option<Shape> {
        match &expr.kind {
            ExprKind::Number(number) if number.value == 0.0 && number.unit.is_none() => Some(Shape::Any),
            ExprKind::Number(_) | ExprKind::Pi | ExprKind::Time | ExprKind::ScaledTime | ExprKind::Event { .. } => {
                Some(Shape::NUMBER)
            }
            ExprKind::Path(path) => self.path_shape(cx, path),
            ExprKind::Tuple(elements) => self.tuple_shape(cx, elements),
            ExprKind::Neg(inner) => self.shape(cx, inner),
            ExprKind::Sum(terms) => self.sum_shape(cx, terms),
            ExprKind::Product(factors) => self.product_shapes(cx, factors).map(|shapes| last(&shapes)),
            ExprKind::Power(base, exponent) => {
                let shape = self.shape(cx, base)?;
                if !shape.is_number() {
                    let text = self.text(base.span);
                    let message = format!("one number is needed here, `{text}` is {}", shape.describe());
                    let help = match shape.axes().len() {
                        1 => format!("the square of its length is `dot({text}, {text})` or `norm({text})^2`"),
                        _ => format!("a product of matrices is `{text} * {text}`"),
                    };
                    self.report(Diagnostic::new(Code::NoNumber, base.span, message).help(help));
                    return None;
                }
                self.is_number(cx, exponent).then_some(Shape::NUMBER)
            }
            ExprKind::Call(call) => self.call_shape(cx, call),
            ExprKind::Der { of, .. } => self.shape(cx, of),
            ExprKind::Partial { .. } => Some(Shape::NUMBER),
            ExprKind::Integral { path, of } | ExprKind::Boundary { path, of, .. } => {
                // What is wrong with a path is told of here, and must not hide what else is wrong.
                let stretches = self.stretches_of(cx, path.as_ref(), expr.span).unwrap_or_default();
                let Some(first) = stretches.first() else { return Some(Shape::NUMBER) };
                let inner = self.on(cx, first, Point::Path);
                self.shape(&inner, of)
            }
            ExprKind::Reduce(reduction) => {
                let index = self.unknown_index();
                let inner = cx.with(&reduction.over.index.text, Meaning::Index(index));
                let shape = self.shape(&inner, &reduction.body)?;
                if reduction.op != ReduceOp::Sum && !shape.is_number() {
                    self.no_number(reduction.body.span, &shape);
                    return None;
                }
                Some(shape)
            }
        }
    }

    /// An index of which only the name is known.
    pub(super) fn unknown_index(&mut self) -> Form {
        self.unknown_indices += 1;
        Form::index(IndexId(u32::MAX - self.unknown_indices))
    }

    pub(super) fn tuple_shape(&mut self, cx: &Context<'a>, elements: &'a [Expr]) -> Option<Shape> {
        let mut joined = Shape::Any;
        let mut first: Option<&Expr> = None;
        for element in elements {
            let shape = self.shape(cx, element)?;
            joined = match joined.joined(&shape) {
                Some(joined) => joined,
                None => {
                    let first = first.unwrap_or(element);
                    self.misfit_shapes((first.span, &joined), (element.span, &shape), "elements of a list are alike");
                    return None;
                }
            };
            if shape != Shape::Any && first.is_none() {
                first = Some(element);
            }
        }
        let mut axes = vec![elements.len() as i64];
        axes.extend(joined.axes());
        Some(Shape::Of(axes))
    }

    fn sum_shape(&mut self, cx: &Context<'a>, terms: &'a [(Sign, Expr)]) -> Option<Shape> {
        let mut joined = Shape::Any;
        let mut first: Option<&Expr> = None;
        for (_, term) in terms {
            let shape = self.shape(cx, term)?;
            match joined.joined(&shape) {
                Some(both) => joined = both,
                None => {
                    let first = first.unwrap_or(term);
                    let help = "add what has the same size: a number is not spread over the elements of a vector";
                    self.misfit_shapes((first.span, &joined), (term.span, &shape), help);
                    return None;
                }
            }
            if shape != Shape::Any && first.is_none() {
                first = Some(term);
            }
        }
        Some(joined)
    }

    /// The shapes of the products of the first factor, the first two, and so on.
    pub(super) fn product_shapes(&mut self, cx: &Context<'a>, factors: &'a [(MulOp, Expr)]) -> Option<Vec<Shape>> {
        let mut shapes: Vec<Shape> = Vec::with_capacity(factors.len());
        let mut span = factors.first()?.1.span;
        for (op, factor) in factors {
            let shape = self.shape(cx, factor)?;
            let Some(left) = shapes.last() else {
                shapes.push(shape);
                continue;
            };
            let product = match (op, left.axes(), shape.axes()) {
                (_, _, []) => left.clone(),
                (MulOp::Multiply, [], _) => shape,
                (MulOp::Multiply, [n, m], [k]) if m == k => Shape::Of(vec![*n]),
                (MulOp::Multiply, [n, m], [k, l]) if m == k => Shape::Of(vec![*n, *l]),
                (MulOp::Multiply, [_], [_]) => {
                    let (this, that) = (self.text(span), self.text(factor.span));
                    let message = format!("`{this} * {that}` has no one meaning: both are vectors");
                    let finding = Diagnostic::new(Code::ShapeMismatch, span.to(factor.span), message);
                    self.report(finding.help("a product of two vectors is `dot(a, b)` or `cross(a, b)`"));
                    return None;
                }
                _ => {
                    let left = left.clone();
                    let help = product_help(*op, &left, &shape);
                    self.misfit_shapes((span, &left), (factor.span, &shape), help);
                    return None;
                }
            };
            shapes.push(product);
            span = span.to(factor.span);
        }
        Some(shapes)
    }

    /// Tells of two shapes that do not fit.
    pub(super) fn misfit_shapes(&mut self, (a, left): (Span, &Shape), (b, right): (Span, &Shape), help: &str) {
        let (this, that) = (self.text(a), self.text(b));
        let message = match (left.is_number(), right.is_number()) {
            (true, _) => {
                format!("the shapes do not fit: `{this}` is a number, `{that}` has {} elements", right.sizes())
            }
            (_, true) => format!("the shapes do not fit: `{this}` has {} elements, `{that}` is a number", left.sizes()),
            _ => {
                format!("the shapes do not fit: `{this}` has {} elements, `{that}` has {}", left.sizes(), right.sizes())
            }
        };
        let whole = if a.start <= b.start { a.to(b) } else { b.to(a) };
        let between = Span { start: a.end.min(b.end), end: a.start.max(b.start) };
        let apart = self.source.slice(between).contains([';', '}']);
        let finding = Diagnostic::new(Code::ShapeMismatch, if apart { b } else { whole }, message)
            .label(a, format!("this is {}", left.describe()))
            .label(b, format!("this is {}", right.describe()));
        self.report(finding.help(help));
    }

    /// The shape of the sides of a relation: numbers may stand beside vectors.
    pub(super) fn sides(&mut self, cx: &Context<'a>, sides: &[&'a Expr]) -> Option<Shape> {
        let mut joined = Shape::NUMBER;
        let mut first: Option<&Expr> = None;
        let mut sound = true;
        for side in sides {
            let Some(shape) = self.shape(cx, side) else {
                sound = false;
                continue;
            };
            match (shape.is_number(), first) {
                (true, _) => {}
                (false, None) => (joined, first) = (shape, Some(*side)),
                (false, Some(_)) if shape == joined => {}
                (false, Some(other)) => {
                    let help = "compare what has the same size, or with one number for every element";
                    self.misfit_shapes((other.span, &joined), (side.span, &shape), help);
                    return None;
                }
            }
        }
        sound.then_some(joined)
    }

    // ------------------------------------------------------------------------------------------------ names

    fn path_shape(&mut self, cx: &Context<'a>, path: &'a Path) -> Option<Shape> {
        let (segment, outer) = path.segments.split_last()?;
        let name = segment.name.text.as_str();
        if !outer.is_empty() {
            let Some(inner) = self.enter_path(cx, outer) else { return Some(Shape::NUMBER) };
            let inner = Context { lexical: inner.scope, point: Point::Nowhere, ..inner };
            return match self.inside(inner.scope, name) {
                Some(entity) => self.entity_shape(&inner, entity, segment),
                None => Some(Shape::NUMBER),
            };
        }
        match cx.local(name) {
            Some(Meaning::Shaped(shape)) => {
                let shape = shape.clone();
                return self.indexed_shape(cx, segment, &whole_axes(&shape), shape);
            }
            Some(Meaning::Lazy(lazy)) => {
                let shape = lazy.shape.clone();
                return self.indexed_shape(cx, segment, &whole_axes(&shape), shape);
            }
            Some(_) => return Some(Shape::NUMBER),
            None => {}
        }
        if self.index_in_sight(cx, name).is_some() {
            return Some(Shape::NUMBER);
        }
        match look_up(&self.scopes, cx.scope, name) {
            Some((_, declared)) => self.entity_shape(cx, declared.entity, segment),
            None => Some(Shape::NUMBER),
        }
    }

    fn entity_shape(&mut self, cx: &Context<'a>, entity: Entity, segment: &'a Segment) -> Option<Shape> {
        let axes = self.axes_of(cx, entity, &segment.name.text)?;
        self.indexed_shape(cx, segment, &axes, Shape::NUMBER)
    }

    /// The axes of what a name stands for.
    pub(super) fn axes_of(&mut self, cx: &Context<'a>, entity: Entity, name: &str) -> Option<Vec<Ends>> {
        match entity {
            Entity::Definition(definition) => self.definition_axes(cx, definition),
            Entity::Parameter(parameter) => Some(self.parameter_axes.get(parameter).cloned().unwrap_or_default()),
            Entity::Variable(variable) => Some(self.variable_axes.get(variable).cloned().unwrap_or_default()),
            Entity::Output => Some(self.output_axes_of(cx, name)),
            _ => Some(Vec::new()),
        }
    }

    /// The axes of an output seen from a context.
    fn output_axes_of(&self, cx: &Context<'a>, name: &str) -> Vec<Ends> {
        let scope = &self.scopes[cx.scope];
        let home = scope.phase.or_else(|| self.agents[scope.agent?].phases.first().copied());
        let Some(home) = home else { return Vec::new() };
        let outputs = self.problem.phases.get(home).map(|phase| phase.outputs.as_slice()).unwrap_or_default();
        let Some(output) = outputs.iter().position(|output| output.name == name) else { return Vec::new() };
        self.output_axes.get(home).and_then(|axes| axes.get(output)).cloned().unwrap_or_default()
    }

    /// What is left of the axes of a name when its indices are taken; `whole` where no axes are and none is taken.
    pub(super) fn indexed_shape(
        &mut self,
        cx: &Context<'a>,
        segment: &'a Segment,
        axes: &[Ends],
        whole: Shape,
    ) -> Option<Shape> {
        if axes.is_empty() || segment.indices.len() > axes.len() {
            return Some(if segment.indices.is_empty() { whole } else { Shape::NUMBER });
        }
        let mut left = Vec::new();
        for index in &segment.indices {
            let Some(last) = &index.last else { continue };
            let ends = Ends { first: self.form(cx, &index.first)?, last: self.form(cx, last)? };
            left.push(self.extent(&ends, index.span)?);
        }
        for ends in &axes[segment.indices.len()..] {
            left.push(self.extent(ends, segment.span)?);
        }
        Some(Shape::Of(left))
    }

    /// How many indices lie between two ends; told where no number says so.
    fn extent(&mut self, ends: &Ends, span: Span) -> Option<i64> {
        let extent = ends.extent();
        match extent {
            Some(extent) if extent > 0 => return Some(extent),
            Some(_) => {
                let message = format!("`{}` has no elements", self.text(span));
                self.report(
                    Diagnostic::new(Code::IndexOutside, span, message).help("write `first .. last`, both included"),
                );
            }
            None => {
                let message = format!("how many elements `{}` has depends on an index", self.text(span));
                let help = "write both ends with the same index, `i .. i + 2`, or take one element";
                self.report(Diagnostic::new(Code::NotWhole, span, message).help(help));
            }
        }
        None
    }

    // ------------------------------------------------------------------------------------------- definitions

    /// The axes of a definition: those of its family, then those of its members.
    pub(super) fn definition_axes(&mut self, cx: &Context<'a>, definition: usize) -> Option<Vec<Ends>> {
        let mut axes = Vec::new();
        let declared = self.definitions[definition].shape;
        let outside = Context { locals: None, ..cx.clone() };
        let mut sized = false;
        for axis in declared.iter().flat_map(|shape| &shape.axes) {
            let first = match &axis.first {
                Some(first) => self.form(&outside, first)?,
                None => Form::number(1),
            };
            let last = self.form(&outside, &axis.last)?;
            sized |= axis.index.is_none();
            axes.push(Ends { first, last });
        }
        if !sized {
            let shape = self.member_shape(cx, definition)?;
            axes.extend(shape.axes().iter().map(|n| Ends::to(*n)));
        }
        Some(axes)
    }

    /// The shape of a member of a definition, from its value.
    pub(super) fn member_shape(&mut self, cx: &Context<'a>, definition: usize) -> Option<Shape> {
        let key = (definition, cx.scope);
        if let Some(known) = self.member_shapes.get(&key) {
            return known.clone();
        }
        // What needs itself is a number here; whoever elaborates it tells of the circle.
        self.member_shapes.insert(key, Some(Shape::NUMBER));
        self.warm_shapes(cx, definition);
        let lexical = self.definitions[definition].scope;
        let mut inner = Context { locals: None, lexical, ..cx.clone() };
        for index in self.definitions[definition].indices() {
            let unknown = self.unknown_index();
            inner = inner.with(&index.text, Meaning::Index(unknown));
        }
        let value = self.definitions[definition].value;
        let shape = self.shape(&inner, value);
        self.member_shapes.insert(key, shape.clone());
        shape
    }

    // ----------------------------------------------------------------------------------------------- calls

    pub(super) fn call_shape(&mut self, cx: &Context<'a>, call: &'a Call) -> Option<Shape> {
        let name = call.function.text.as_str();
        match look_up(&self.scopes, cx.scope, name).map(|(_, declared)| declared.entity) {
            Some(Entity::Function(function)) => {
                let shapes =
                    call.arguments.iter().map(|argument| self.shape(cx, argument)).collect::<Option<Vec<_>>>()?;
                self.function_shape(cx, function, call, shapes)
            }
            Some(Entity::Table(_)) => self.numbers_only(cx, call),
            _ => match (builtin(name), vector_function(name)) {
                (Some(builtin), _) => self.builtin_shape(cx, builtin, call),
                (None, Some(function)) => self.vector_shape(cx, function, call),
                (None, None) => Some(Shape::NUMBER),
            },
        }
    }

    fn numbers_only(&mut self, cx: &Context<'a>, call: &'a Call) -> Option<Shape> {
        let mut sound = true;
        for argument in &call.arguments {
            sound &= self.is_number(cx, argument);
        }
        sound.then_some(Shape::NUMBER)
    }

    fn builtin_shape(&mut self, cx: &Context<'a>, builtin: Builtin, call: &'a Call) -> Option<Shape> {
        if !builtin.takes_vectors() {
            return self.numbers_only(cx, call);
        }
        for argument in &call.arguments {
            let shape = self.shape(cx, argument)?;
            if shape.axes().len() > 1 {
                self.no_number(argument.span, &shape);
                return None;
            }
        }
        Some(Shape::NUMBER)
    }

    /// The shape of what a function of the spec gives for arguments of these shapes.
    fn function_shape(
        &mut self,
        cx: &Context<'a>,
        function: usize,
        call: &'a Call,
        shapes: Vec<Shape>,
    ) -> Option<Shape> {
        let (declared, scope) = (self.functions[function].function, self.functions[function].scope);
        if declared.parameters.len() != shapes.len() {
            return Some(Shape::NUMBER); // Whoever applies it tells.
        }
        let key: FunctionKey = (function, shapes, cx.scope);
        if let Some(known) = self.function_shapes.get(&key) {
            return known.clone();
        }
        // A function that uses itself is told of when it is applied.
        self.function_shapes.insert(key.clone(), Some(Shape::NUMBER));
        let mut inner = Context { locals: None, lexical: scope, ..cx.clone() };
        for (parameter, shape) in declared.parameters.iter().zip(&key.1) {
            inner = inner.with(&parameter.text, Meaning::Shaped(shape.clone()));
        }
        let before = self.found.len();
        let shape = self.shape(&inner, &declared.body);
        self.tell_use(before, call);
        self.function_shapes.insert(key, shape.clone());
        shape
    }

    fn vector_shape(&mut self, cx: &Context<'a>, function: VectorFunction, call: &'a Call) -> Option<Shape> {
        let (least, most) = function.arity();
        if !self.arity(call, least, most) {
            return None;
        }
        if function == VectorFunction::Identity {
            let n = self.whole(cx, &call.arguments[0], "the size of a matrix")?;
            return (1..=super::vectors::LARGEST_MATRIX).contains(&n).then(|| Shape::Of(vec![n, n])).or_else(|| {
                let message = format!("a matrix of {n} x {n} has no use here");
                let finding = Diagnostic::new(Code::NotWhole, call.arguments[0].span, message);
                self.report(finding.help("write a size such as 3"));
                None
            });
        }
        let shapes = call.arguments.iter().map(|argument| self.shape(cx, argument)).collect::<Option<Vec<_>>>()?;
        for (argument, shape) in call.arguments.iter().zip(&shapes) {
            let wanted = if function == VectorFunction::Transpose { 2 } else { 1 };
            if shape.axes().len() != wanted {
                self.wrong_argument(function, argument.span, shape, wanted);
                return None;
            }
        }
        let first = &call.arguments[0];
        if matches!(function, VectorFunction::Dot | VectorFunction::Cross) && shapes[0] != shapes[1] {
            let help = "both vectors have one size";
            self.misfit_shapes((first.span, &shapes[0]), (call.arguments[1].span, &shapes[1]), help);
            return None;
        }
        let n = shapes[0].axes()[0];
        if matches!(function, VectorFunction::Cross | VectorFunction::Skew) && n != 3 {
            let message = format!(
                "`{}` is about vectors of 3, `{}` is {}",
                call.function.text,
                self.text(first.span),
                shapes[0].describe()
            );
            let help = match (function, n) {
                (VectorFunction::Cross, 2) => "in the plane write `a[1] * b[2] - a[2] * b[1]`",
                _ => "write vectors with three elements",
            };
            self.report(Diagnostic::new(Code::ShapeMismatch, call.span, message).help(help));
            return None;
        }
        Some(match function {
            VectorFunction::Dot | VectorFunction::Norm | VectorFunction::Sum => Shape::NUMBER,
            VectorFunction::Cross => Shape::Of(vec![3]),
            VectorFunction::Skew => Shape::Of(vec![3, 3]),
            VectorFunction::Diagonal | VectorFunction::Identity => Shape::Of(vec![n, n]),
            VectorFunction::Outer => Shape::Of(vec![n, shapes[1].axes()[0]]),
            VectorFunction::Transpose => Shape::Of(vec![shapes[0].axes()[1], n]),
        })
    }

    fn wrong_argument(&mut self, function: VectorFunction, span: Span, shape: &Shape, wanted: usize) {
        let (name, text) = (function.name(), self.text(span));
        let wanted = if wanted == 2 { "a matrix" } else { "a vector" };
        let message = format!("`{name}` takes {wanted}, `{text}` is {}", shape.describe());
        let help = match (function, shape.axes().len()) {
            (VectorFunction::Sum, _) => "over an index write `sum(i in 1 .. N, ...)`".to_owned(),
            (VectorFunction::Norm, 0) => {
                format!("the size of a number is `abs({text})`, that of several `hypot(a, b)`")
            }
            (VectorFunction::Transpose, 1) => {
                "a vector stands for a row and for a column: leave it as it is".to_owned()
            }
            _ => "a vector is a name with elements, or a list `(a, b, c)`".to_owned(),
        };
        self.report(Diagnostic::new(Code::ShapeMismatch, span, message).help(help));
    }
}

/// The axes of a value, counted from 1.
pub(super) fn whole_axes(shape: &Shape) -> Vec<Ends> {
    shape.axes().iter().map(|n| Ends::to(*n)).collect()
}

fn last(shapes: &[Shape]) -> Shape {
    shapes.last().cloned().unwrap_or(Shape::NUMBER)
}

/// What to write instead of a product whose factors do not fit.
fn product_help(op: MulOp, left: &Shape, right: &Shape) -> &'static str {
    match (op, left.axes().len(), right.axes().len()) {
        (MulOp::Divide, _, _) => "divide by a number, such as `norm(v)`",
        (_, 1, 2) => "a matrix stands before its vector: `transpose(A) * v`",
        _ => "the second has as many rows as the first has columns; `transpose(A)` exchanges both",
    }
}
