//! The meaning of operators and literals; dimensions are checked on the way.
//!
//! Takes `ast::Expr` and a context, gives a [`Value`].
//! Finds: sums of different dimensions, exponents that leave no dimension.
//! Sums and products are loops, so their length costs no stack.

use super::dimension::{Dimension, Ratio};
use super::elaborator::Elaborator;
use super::problem::Form;
use super::scope::Context;
use super::value::{Flaw, Value};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::NodeId;
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, MulOp, Number, Sign};

/// What `[g]` is, where an acceleration was meant.
pub(super) const GRAM: &str = "`g` is the gram; the acceleration of gravity is written `9.80665 [m/s^2]`";

impl<'a> Elaborator<'a> {
    /// The meaning of an expression that is one number.
    pub(super) fn value(&mut self, cx: &Context<'a>, expr: &'a Expr) -> Value {
        self.element(cx, expr, &[])
    }

    /// The meaning of one element of an expression: `at` has an index for each axis of its shape.
    pub(super) fn element(&mut self, cx: &Context<'a>, expr: &'a Expr, at: &[Form]) -> Value {
        let value = if self.enter(expr.span) { self.kind(cx, expr, at) } else { self.poison(expr.span) };
        self.leave();
        if value.is_sound() {
            self.origin(value.node, expr.span);
        }
        value.at(expr.span)
    }

    fn kind(&mut self, cx: &Context<'a>, expr: &'a Expr, at: &[Form]) -> Value {
        let span = expr.span;
        match &expr.kind {
            ExprKind::Number(number) => self.number(number, span),
            ExprKind::Pi => {
                let node = self.problem.dag.constant(std::f64::consts::PI);
                Value::new(node, Dimension::NONE, span)
            }
            ExprKind::Time => self.time(cx, span),
            ExprKind::ScaledTime => self.scaled_time(cx, span),
            ExprKind::Path(path) => self.path(cx, path, at),
            ExprKind::Tuple(elements) => self.tuple_element(cx, elements, at, span),
            ExprKind::Neg(inner) => {
                let value = self.element(cx, inner, at);
                let node = self.problem.dag.neg(value.node);
                value.map(node, value.dimension, span).shown_in(value.unit.clone())
            }
            ExprKind::Sum(terms) => self.sum(cx, terms, at, span),
            ExprKind::Product(factors) if !at.is_empty() => self.product_element(cx, factors, at, span),
            ExprKind::Product(factors) => self.product(cx, factors, span),
            ExprKind::Power(base, exponent) => self.power(cx, base, exponent, span),
            ExprKind::Call(call) => self.call(cx, call, at),
            ExprKind::If(conditional) => self.conditional(cx, conditional, at, span),
            ExprKind::Steps(steps) => self.behind_steps(cx, steps, at, span),
            ExprKind::Der { of, order } => self.derivative(cx, (of, at), order.as_deref(), span),
            ExprKind::Partial { of, argument } => self.partial(cx, of, argument, span),
            ExprKind::Integral { path, of } => self.integral(cx, path.as_ref(), (of, at), span),
            ExprKind::Boundary { boundary, path, of } => self.boundary(cx, *boundary, path.as_ref(), (of, at), span),
            ExprKind::Event { event, path } => self.event_time(cx, *event, path, span),
            ExprKind::Reduce(reduction) => self.reduction(cx, reduction, at, span),
            ExprKind::File(file) => self.file_element(cx, file, at, span),
            ExprKind::Rows(name) => self.count_of_rows(cx, name, span),
        }
    }

    fn number(&mut self, number: &'a Number, span: Span) -> Value {
        let Some(unit) = &number.unit else {
            let node = self.problem.dag.constant(number.value);
            let mut value = Value::new(node, Dimension::NONE, span);
            if number.value == 0.0 {
                value.dimension = None;
            }
            return value;
        };
        let Some((quantity, shown)) = self.shared_unit(unit) else { return self.poison(span) };
        let si = number.value * quantity.factor;
        if !si.is_finite() {
            let finding = Diagnostic::new(Code::NotFinite, span, "this number is too large in SI units")
                .help("use a smaller number, or another unit");
            return self.refuse(finding, span);
        }
        let node = self.problem.dag.constant(si);
        Value::new(node, quantity.dimension, span).shown_in(Some(shown))
    }

    fn sum(&mut self, cx: &Context<'a>, terms: &'a [(Sign, Expr)], at: &[Form], span: Span) -> Value {
        let mut total: Option<Value> = None;
        for (sign, term) in terms {
            let value = if at.is_empty() { self.value(cx, term) } else { self.element_or_zero(cx, term, at) };
            let Some(so_far) = total else {
                total = Some(value);
                continue;
            };
            let verb = if *sign == Sign::Plus { "add" } else { "subtract" };
            let node = match sign {
                Sign::Plus => self.problem.dag.add(so_far.node, value.node),
                Sign::Minus => self.problem.dag.sub(so_far.node, value.node),
            };
            total = Some(self.alike(verb, so_far, &value, node));
        }
        total.unwrap_or_else(|| self.poison(span))
    }

    /// Joins two values that must have one dimension; the result stands where both do.
    pub(super) fn alike(&mut self, verb: &str, a: Value, b: &Value, node: NodeId) -> Value {
        let span = a.span.to(b.span);
        let mut flaw = Flaw::join(&a.flaw, &b.flaw);
        if self.clash(verb, &a, b) {
            flaw = Some(Flaw::Reported);
        }
        if flaw.is_none() {
            self.origin(node, span);
        }
        let unit = a.unit.or_else(|| b.unit.clone());
        // Once told, a clash is not told again for the rest of the sum.
        let dimension = if matches!(flaw, Some(Flaw::Reported)) { None } else { a.dimension.or(b.dimension) };
        Value { node, dimension, unit, span, flaw }
    }

    /// Tells when two values have different dimensions.
    pub(super) fn clash(&mut self, verb: &str, a: &Value, b: &Value) -> bool {
        let (Some(left), Some(right)) = (a.dimension, b.dimension) else { return false };
        if left == right {
            return false;
        }
        let (this, that) = (left.describe(), right.describe());
        let message = match verb {
            "add" => format!("{that} cannot be added to {this}"),
            "subtract" => format!("{that} cannot be subtracted from {this}"),
            "compare" => format!("{this} cannot be compared with {that}"),
            "if" => format!("one branch of an `if` is {this}, another one {that}"),
            _ => format!("{this} and {that} cannot be joined by `{verb}`"),
        };
        // Two statements are no expression to underline as a whole.
        let between = Span { start: a.span.end.min(b.span.end), end: a.span.start.max(b.span.start) };
        let apart = self.source.slice(between).contains([';', '}']);
        let whole = if apart { b.span } else { a.span.to(b.span) };
        let finding = Diagnostic::new(Code::DimensionMismatch, whole, message)
            .label(a.span, format!("this is {this}"))
            .label(b.span, format!("this is {that}"));
        let finding = finding.help(self.mend(verb, a, b));
        self.report(finding);
        true
    }

    /// How to mend a clash of dimensions, as well as can be guessed.
    fn mend(&self, verb: &str, a: &Value, b: &Value) -> String {
        if let Some(help) = self.forgotten_rate(a, b).filter(|_| verb == "compare") {
            return help;
        }
        if verb == "add" && [a, b].iter().any(|side| self.text(side.span).contains(" sigma ")) {
            let unit = [a, b].iter().find_map(|side| side.dimension.filter(|dimension| !dimension.is_none()));
            let unit = unit.map_or_else(String::new, |unit| format!(", `e / 1 [{unit}]`"));
            return format!("beside `measure` the objective is a pure number: divide its other terms{unit}");
        }
        let ends = [a, b].into_iter().flat_map(|side| [self.text(side.span), self.other_end(side.span)]);
        if let Some(help) = ends.into_iter().find_map(|text| unit_of_divisor(&text)) {
            return help;
        }
        let bare = |v: &Value| v.dimension == Some(Dimension::NONE) && self.problem.dag.is_constant(v.node).is_some();
        let unit_of = |v: &Value| match &v.unit {
            Some(unit) => unit.symbol.clone(),
            None => v.dimension_or_none().to_string(),
        };
        for (number, other) in [(a, b), (b, a)] {
            let text = self.text(number.span);
            if bare(number) && text.parse::<f64>().is_ok() {
                return format!("give the number a unit: `{text} [{}]`", unit_of(other));
            }
        }
        for (number, other) in [(a, b), (b, a)] {
            if number.dimension == Some(Dimension::NONE) {
                let text = self.grouped(number.span);
                if text.starts_with('(') && text.ends_with(')') && is_numbers(&text) {
                    return format!("a unit stands behind the list: `{text} [{}]`", unit_of(other));
                }
                let is_list = text.rsplit_once('[').is_some_and(|(list, _)| list.trim_end().ends_with(')'));
                if text.ends_with(']') && is_list {
                    let unit = unit_of(other);
                    return format!(
                        "a unit behind a list is that of its bare numbers; a formula in it is multiplied by `1 [{unit}]`"
                    );
                }
                return format!("multiply the pure number by a unit: `{text} * 1 [{}]`", unit_of(other));
            }
        }
        let is_acceleration = |v: &Value| v.dimension == Some(Dimension::of([0, 1, -2, 0, 0, 0, 0]));
        let in_grams = |v: &Value| matches!(&v.unit, Some(unit) if unit.symbol == "g");
        if [(a, b), (b, a)].iter().any(|(grams, other)| in_grams(grams) && is_acceleration(other)) {
            return GRAM.to_owned();
        }
        let is_temperature = |v: &Value| v.dimension == Some(Dimension::of([0, 0, 0, 0, 1, 0, 0]));
        for (coulombs, other) in [(a, b), (b, a)] {
            // `[C]` and `[F]` beside a temperature are meant as degrees.
            if is_temperature(other)
                && matches!(&coulombs.unit, Some(unit) if matches!(unit.symbol.as_str(), "C" | "F"))
            {
                let symbol = coulombs.unit.as_ref().map_or("", |unit| unit.symbol.as_str());
                let name = if symbol == "C" { "coulomb" } else { "farad" };
                return format!(
                    "`{symbol}` is the {name}; temperatures count from absolute zero: `293.15 [K]` for 20 degrees Celsius"
                );
            }
        }
        "bring both to the same dimension: check units, powers and missing factors".to_owned()
    }

    /// The text of the upper end of a range whose lower end is at a place; empty where it is none.
    fn other_end(&self, lower: Span) -> String {
        let all = self.source.span();
        let after = self.source.slice(Span { start: lower.end, end: all.end });
        let upper = after.trim_start().strip_prefix("..").and_then(|upper| upper.split_inclusive(']').next());
        upper.map(|upper| upper.trim().to_owned()).unwrap_or_default()
    }

    fn product(&mut self, cx: &Context<'a>, factors: &'a [(MulOp, Expr)], span: Span) -> Value {
        let mut total: Option<Value> = None;
        for (op, factor) in factors {
            let value = self.value(cx, factor);
            let Some(so_far) = total else {
                total = Some(value);
                continue;
            };
            total = Some(self.multiplied(*op, so_far, &value));
        }
        total.unwrap_or_else(|| self.poison(span))
    }

    pub(super) fn multiplied(&mut self, op: MulOp, a: Value, b: &Value) -> Value {
        let span = a.span.to(b.span);
        let mut flaw = Flaw::join(&a.flaw, &b.flaw);
        let (node, dimension) = match op {
            MulOp::Multiply => {
                let dimension = a.dimension.zip(b.dimension).map(|(p, q)| p.times(&q));
                (self.problem.dag.mul(a.node, b.node), dimension)
            }
            MulOp::Divide => {
                if flaw.is_none() && self.problem.dag.is(b.node, 0.0) {
                    let finding = Diagnostic::new(Code::NotFinite, span, "division by zero")
                        .label(b.span, "this is 0")
                        .help("divide by something else");
                    self.report(finding);
                    flaw = Some(Flaw::Reported);
                }
                let dimension = a.dimension.zip(b.dimension).map(|(p, q)| p.over(&q));
                (self.problem.dag.div(a.node, b.node), dimension)
            }
        };
        // A multiple of something is shown as that something is.
        let pure = |v: &Value| v.unit.is_none() && v.dimension == Some(Dimension::NONE);
        let unit = match op {
            _ if pure(b) => a.unit,
            MulOp::Multiply if pure(&a) => b.unit.clone(),
            _ => None,
        };
        if flaw.is_none() {
            self.origin(node, span);
        }
        Value { node, dimension, unit, span, flaw }
    }

    fn power(&mut self, cx: &Context<'a>, base: &'a Expr, exponent: &'a Expr, span: Span) -> Value {
        let base = self.value(cx, base);
        let exponent = self.value(cx, exponent);
        let flaw = Flaw::join(&base.flaw, &exponent.flaw);
        let node = self.power_node(base.node, exponent.node);
        if matches!(flaw, Some(Flaw::Reported)) {
            return self.poison(span);
        }
        if let Some(dimension) = exponent.dimension
            && !dimension.is_none()
        {
            let message = format!("an exponent must be a pure number, this is {}", dimension.describe());
            let help = match self.unit_of_power(&base, &exponent, dimension) {
                Some(whole) => format!("here the unit is that of the exponent: write `{whole}`"),
                None => format!("divide it by a unit: `{} / 1 [{dimension}]`", self.grouped(exponent.span)),
            };
            let finding = Diagnostic::new(Code::NotPure, exponent.span, message).help(help);
            return self.refuse(finding, span);
        }
        let dimension = match base.dimension {
            Some(dimension) if !dimension.is_none() => match self.rational(&exponent) {
                Some(ratio) => {
                    self.note_root(&base, span, ratio);
                    Some(dimension.power(ratio))
                }
                None => return self.wild_exponent(&base, &exponent, span),
            },
            other => other,
        };
        // A zero raised to zero or less is no zero any more.
        let dimension = dimension.or_else(|| (!self.problem.dag.is(node, 0.0)).then_some(Dimension::NONE));
        Value { node, dimension, unit: None, span, flaw }
    }

    /// A power; an even one of the length of a vector has no root.
    fn power_node(&mut self, base: NodeId, exponent: NodeId) -> NodeId {
        let even = self.problem.dag.is_constant(exponent).filter(|exponent| exponent.rem_euclid(2.0) == 0.0);
        match (even, self.squares.get(&base).copied()) {
            (Some(exponent), Some(square)) => {
                let half = self.problem.dag.constant(exponent / 2.0);
                self.problem.dag.pow(square, half)
            }
            _ => self.problem.dag.pow(base, exponent),
        }
    }

    /// The exponent as a small rational number, if the compiler knows it.
    fn rational(&self, exponent: &Value) -> Option<Ratio> {
        self.problem.dag.is_constant(exponent.node).and_then(Ratio::of)
    }

    /// What is meant by `0.2^2 [m^2]`: a power of a number whose exponent has the unit of the power.
    fn unit_of_power(&self, base: &Value, exponent: &Value, dimension: Dimension) -> Option<String> {
        let (base_text, exponent_text) = (self.grouped(base.span), self.text(exponent.span));
        let (power, unit) = exponent_text.split_once('[')?;
        let power: i32 = power.trim().parse().ok().filter(|power| *power > 1)?;
        let is_pure = base.unit.is_none() && base.dimension_or_none().is_none();
        let root = dimension.power(Ratio::of(1.0 / f64::from(power))?);
        let symbol = unit.trim_end().strip_suffix(']')?.trim();
        let (of, own) = symbol.rsplit_once('^')?;
        let is_power = own.trim().parse() == Ok(power) && !of.contains(['*', '/', '^']);
        (is_pure && !root.is_none() && is_power).then(|| format!("({base_text} [{}])^{power}", of.trim()))
    }

    fn wild_exponent(&mut self, base: &Value, exponent: &Value, span: Span) -> Value {
        let dimension = base.dimension_or_none();
        let unit = base.unit.as_ref().map_or_else(|| dimension.to_string(), |unit| unit.symbol.clone());
        let message = format!("{} needs an exponent that is a known ratio of whole numbers", dimension.describe());
        let finding = Diagnostic::new(Code::WildExponent, exponent.span, message)
            .label(base.span, format!("this is {}", dimension.describe()))
            .label(exponent.span, "the dimension of the power depends on this")
            .help(format!("make the base a pure number: `({} / 1 [{unit}]) ^ ...`", self.grouped(base.span)));
        self.refuse(finding, span)
    }
}

/// Whether a list holds bare numbers alone: `(1, -2.5, 3)`.
fn is_numbers(list: &str) -> bool {
    list.trim_matches(['(', ')']).split(',').all(|element| element.trim().parse::<f64>().is_ok())
}

/// Of `1/300 [1/m]`, whose unit is that of 300: what to write where that was not meant.
fn unit_of_divisor(text: &str) -> Option<String> {
    let (quotient, unit) = text.strip_suffix(']')?.rsplit_once('[')?;
    let (above, below) = quotient.rsplit_once('/')?;
    let (above, below) = (above.trim(), below.trim());
    [above, below].iter().all(|number| number.parse::<f64>().is_ok()).then(|| {
        format!("a unit belongs to the number before it, here to {below} alone: write `{above} [{unit}] / {below}`")
    })
}
