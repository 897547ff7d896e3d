//! Walking over every span of a syntax tree.
//!
//! Two trees mean the same text when they are equal after their spans are erased: so a formatter's
//! round trip is tested, and so are the two homes of a spec. The patterns below name every field, so
//! that a field added to the tree cannot be forgotten here.

use super::ast::*;
use crate::source::Span;

impl Spec {
    /// The same spec with every span empty at 0: equal trees are equally written, up to white space,
    /// comments and redundant parentheses.
    #[must_use]
    pub fn without_spans(&self) -> Self {
        let mut spec = self.clone();
        spec.uses.erase();
        spec.problem.erase();
        spec
    }
}

impl Library {
    /// The same library with every span empty at 0.
    #[must_use]
    pub fn without_spans(&self) -> Self {
        let mut library = self.clone();
        library.uses.erase();
        library.items.erase();
        library
    }
}

impl Expr {
    /// The same expression with every span empty at 0.
    #[must_use]
    pub fn without_spans(&self) -> Self {
        let mut expr = self.clone();
        expr.erase();
        expr
    }
}

/// Sets every span to empty at 0.
trait Erase {
    fn erase(&mut self);
}

impl Erase for Span {
    fn erase(&mut self) {
        *self = Self::default();
    }
}

impl<T: Erase> Erase for Vec<T> {
    fn erase(&mut self) {
        self.iter_mut().for_each(Erase::erase);
    }
}

impl<T: Erase> Erase for Option<T> {
    fn erase(&mut self) {
        self.iter_mut().for_each(Erase::erase);
    }
}

impl<T: Erase> Erase for Box<T> {
    fn erase(&mut self) {
        (**self).erase();
    }
}

impl<A: Erase, B: Erase> Erase for (A, B) {
    fn erase(&mut self) {
        self.0.erase();
        self.1.erase();
    }
}

/// What holds no span.
macro_rules! spanless {
    ($($type:ty),* $(,)?) => {
        $(impl Erase for $type {
            fn erase(&mut self) {}
        })*
    };
}

spanless!(String, f64, bool, i32, Sign, MulOp, Boundary, Event, ReduceOp, Comparison, BlockPlace);
spanless!(Symmetry, MethodKind, Extrapolate, CollocationKind, Sense, Role);

/// A structure, by all of its fields.
macro_rules! structures {
    ($($type:ident { $($field:ident),* })*) => {
        $(impl Erase for $type {
            fn erase(&mut self) {
                let Self { $($field),* } = self;
                $($field.erase();)*
            }
        })*
    };
}

structures! {
    Use { target, target_span, names, alias, span }
    Problem { doc, name, items, span }
    Doc { text, span }
    Item { doc, kind, span }
    Const { name, shape, value }
    Shape { axes, span }
    ShapeAxis { index, first, last, span }
    Param { name, shape, default }
    Values { elements, is_tuple, span }
    Variable { names }
    Bounds { lower, upper, span }
    Output { role, names, course }
    DeclaredName { name, shape, unit, bounds, span }
    Spline { order, intervals, knots, smoothness, span }
    Function { name, parameters, shape, unit, body }
    Argument { name, shape, unit }
    Conditional { branches, otherwise }
    Branch { condition, smooth, value, span }
    Steps { lets, value }
    File { name, unit, columns }
    FileName { path, span }
    Columns { first, last, span }
    Let { name, shape, unit, value }
    Table { is_param, name, axes, unit, method, data }
    Axis { name, symmetry, unit, span }
    Method { kind, order, intervals, extrapolate, span }
    Rows { header, rows, span }
    Row { node, values, span }
    Continuation { name, values }
    IndependentVariable { name, unit }
    Duration { name, extent }
    Phase { name, family, after, items }
    Agent { name, family, items }
    Scenario { name, family, weight, items, head }
    Shared { inputs, until }
    Jump { outputs }
    Continuous { outputs, up_to }
    Periodic { outputs, up_to }
    Collocation { kind, points, equalities, inequalities, intervals, knots }
    Objective { sense, name, unit, value }
    Block { place, part, statements }
    AtBlock { time, statements }
    Constraint { doc, softness, name, relation, sigma, span }
    Softness { linear, square, span }
    Guess { statements }
    Assign { target, value, span }
    Route { outputs, points, span }
    Point { coordinates, span }
    Ident { text, span }
    Segment { name, indices, span }
    Index { first, last, span }
    Path { segments, span }
    IndexRange { index, first, last, span }
    Unit { factors, span }
    UnitFactor { op, base, power, span }
    Expr { kind, span }
    Number { value, unit }
    Call { function, arguments, span }
    Reduction { op, over, body, width }
}

impl<T: Erase> Erase for For<T> {
    fn erase(&mut self) {
        let Self { over, body, span } = self;
        over.erase();
        body.erase();
        span.erase();
    }
}

/// A choice, by all of its variants with all of their fields.
macro_rules! choices {
    ($($type:ident $(<$t:ident>)? {
        $($single:ident($inner:ident)),* ; $($record:ident { $($field:ident),* }),* ; $($plain:ident),*
    })*) => {
        $(impl $(<$t: Erase>)? Erase for $type $(<$t>)? {
            fn erase(&mut self) {
                match self {
                    $(Self::$single($inner) => $inner.erase(),)*
                    $(Self::$record { $($field),* } => { $($field.erase();)* })*
                    $(Self::$plain => {})*
                }
            }
        })*
    };
}

choices! {
    ItemKind {
        Const(x), Param(x), Variable(x), Output(x), Function(x), Let(x), Table(x), Continuation(x), Domain(x),
        Duration(x), Start(x), Phase(x), Agent(x), Scenario(x), Jump(x), Continuous(x), Periodic(x), Shared(x),
        Collocation(x), Objective(x), Block(x), At(x), Guess(x);;
    }
    UseTarget { Module(x), File(x);; }
    TableData { Inline(x); File { path, span }; }
    Part { ; Except { ends, span }, Between { from, to, span }; }
    Extent { Fixed(x), Free(x);; }
    Course { Spline(x);; Held, Continuous, Collocated }
    Statement<T> { One(x), For(x);; }
    Relation {
        ;
        Compare { left, comparison, comparison_span, right },
        Between { first, comparison, middle, last },
        In { value, bounds };
    }
    GuessKind { Assign(x), Route(x);; }
    Target { Path(x); Event { event, path, span }; }
    UnitBase { Symbol(x), Group(x);; One }
}

impl Erase for ExprKind {
    fn erase(&mut self) {
        match self {
            Self::Pi | Self::Time | Self::ScaledTime => {}
            Self::Number(x) => x.erase(),
            Self::Path(x) => x.erase(),
            Self::Neg(x) => x.erase(),
            Self::Tuple(x) => x.erase(),
            Self::Sum(x) => x.erase(),
            Self::Product(x) => x.erase(),
            Self::Call(x) => x.erase(),
            Self::Reduce(x) => x.erase(),
            Self::If(x) => x.erase(),
            Self::Steps(x) => x.erase(),
            Self::File(x) => x.erase(),
            Self::Rows(x) => x.erase(),
            Self::Power(base, exponent) => {
                base.erase();
                exponent.erase();
            }
            Self::Der { of, order } => {
                of.erase();
                order.erase();
            }
            Self::Partial { of, argument } => {
                of.erase();
                argument.erase();
            }
            Self::Integral { path, of } | Self::Boundary { boundary: _, path, of } => {
                path.erase();
                of.erase();
            }
            Self::Event { event: _, path } => path.erase(),
        }
    }
}
