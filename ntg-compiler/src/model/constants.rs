//! Compile-time numbers, and whole numbers that are affine in loop indices.
//!
//! Takes expressions, gives numbers or [`Form`]s.
//! Finds: what is no constant where only constants stand, what is no whole number, indices
//! outside their range.

use std::collections::HashMap;
use std::rc::Rc;

use ntg_structure::Unit;

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::mention::mentioned;
use super::problem::{Form, IndexId, Loop};
use super::scope::{Allow, Context, Entity, Meaning, ScopeId, look_up};
use super::value::{Value, What};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, Ident, IndexRange, MulOp, Sign};

/// A number that the compiler knows, in SI units.
#[derive(Clone)]
pub(super) struct Constant {
    pub(super) value: f64,
    pub(super) dimension: Option<Dimension>,
    pub(super) unit: Option<Rc<Unit>>,
}

/// Why an expression is no form.
enum NoForm {
    /// A finding has told.
    Told,
    /// It is made of other things than a form, which nobody has told.
    OtherShape,
}

/// The largest index or size: beyond it, nothing could be solved any more.
const LARGEST: i64 = 1_000_000_000;

impl Form {
    /// A number that depends on no index.
    pub fn number(constant: i64) -> Self {
        Self { constant, terms: Vec::new() }
    }

    /// An index itself.
    pub fn index(index: IndexId) -> Self {
        Self { constant: 0, terms: vec![(index, 1)] }
    }

    /// Its value, when it depends on no index.
    pub fn as_number(&self) -> Option<i64> {
        self.terms.is_empty().then_some(self.constant)
    }

    /// `self + factor * other`, if it does not overflow.
    pub(super) fn plus(&self, factor: i64, other: &Self) -> Option<Self> {
        let constant = self.constant.checked_add(other.constant.checked_mul(factor)?)?;
        let mut terms = self.terms.clone();
        for (index, coefficient) in &other.terms {
            let change = coefficient.checked_mul(factor)?;
            match terms.binary_search_by_key(index, |(i, _)| *i) {
                Ok(k) => terms[k].1 = terms[k].1.checked_add(change)?,
                Err(k) => terms.insert(k, (*index, change)),
            }
        }
        terms.retain(|(_, coefficient)| *coefficient != 0);
        Some(Self { constant, terms })
    }

    /// The same where an index has a value.
    pub(super) fn with(&self, index: IndexId, value: i64) -> Self {
        let factor = self.terms.iter().find(|(own, _)| *own == index).map_or(0, |(_, factor)| *factor);
        let constant = self.constant.saturating_add(factor.saturating_mul(value));
        Self { constant, terms: self.terms.iter().copied().filter(|(own, _)| *own != index).collect() }
    }

    /// The same with another form in the place of an index.
    pub(super) fn replacing(&self, index: IndexId, other: &Self) -> Self {
        let factor = self.terms.iter().find(|(own, _)| *own == index).map_or(0, |(_, factor)| *factor);
        let rest = self.with(index, 0);
        rest.plus(factor, other).unwrap_or(rest)
    }

    /// The same divided by a number that divides it.
    fn divided(&self, divisor: i64) -> Option<Self> {
        let exact = |n: i64| (divisor != 0 && n.checked_rem(divisor)? == 0).then(|| n / divisor);
        let terms = self.terms.iter().map(|(i, c)| Some((*i, exact(*c)?))).collect::<Option<_>>()?;
        Some(Self { constant: exact(self.constant)?, terms })
    }

    /// Its value for given indices; an index that is not given counts as 0.
    pub fn at(&self, indices: &HashMap<IndexId, i64>) -> i64 {
        let terms = self.terms.iter().map(|(i, c)| c.saturating_mul(indices.get(i).copied().unwrap_or(0)));
        terms.fold(self.constant, i64::saturating_add)
    }
}

impl<'a> Elaborator<'a> {
    /// A number that the compiler knows; `what` says for what it is needed.
    pub(super) fn constant(&mut self, cx: &Context<'a>, expr: &'a Expr, what: &str) -> Option<Constant> {
        self.constant_element(cx, expr, &[], what)
    }

    /// The same for one element of an expression.
    pub(super) fn constant_element(
        &mut self,
        cx: &Context<'a>,
        expr: &'a Expr,
        at: &[Form],
        what: &str,
    ) -> Option<Constant> {
        let value = self.element(&cx.allowing(Allow::Constants), expr, at);
        let value = self.settle_constant(value, what)?;
        let value = self.finite(value)?;
        let number = self.problem.dag.is_constant(value.node)?;
        Some(Constant { value: number, dimension: value.dimension, unit: value.unit })
    }

    /// A value that the compiler could compute; what is not finite is told.
    pub(super) fn finite(&mut self, value: Value) -> Option<Value> {
        if self.problem.dag.is_constant(value.node).is_some() {
            return Some(value);
        }
        let message = "the compiler finds no finite value for this constant";
        self.report(
            Diagnostic::new(Code::NotFinite, value.span, message)
                .help("check it for a division by zero, a logarithm or root of a negative number, or a table"),
        );
        None
    }

    /// A whole number that depends on nothing but constants and indices in sight.
    pub(super) fn form(&mut self, cx: &Context<'a>, expr: &'a Expr) -> Option<Form> {
        let form = self.affine(cx, expr);
        if let Err(NoForm::OtherShape) = form {
            self.report(
                Diagnostic::new(Code::NotWhole, expr.span, "this is not a whole number made of constants and indices")
                    .help("write something like `2`, `N`, `i + 1` or `2 * i - 1`"),
            );
        }
        form.ok().filter(|form| self.is_small(form, expr.span))
    }

    /// A whole number that depends on no index.
    pub(super) fn whole(&mut self, cx: &Context<'a>, expr: &'a Expr, what: &str) -> Option<i64> {
        let constant = self.constant(cx, expr, what)?;
        let number = constant.value;
        let pure = constant.dimension.is_none_or(|d| d.is_none());
        if pure && number.fract() == 0.0 && number.abs() <= LARGEST as f64 {
            return Some(number as i64);
        }
        let this = if pure { number.to_string() } else { constant.dimension.unwrap_or(Dimension::NONE).describe() };
        // However often a constant is used so, it is wrong once.
        if let Some((name, value)) = self.constant_named(cx, expr) {
            let message = format!("`{name}` must be a whole number, this is {this}");
            let finding =
                Diagnostic::new(Code::NotWhole, value, message).label(expr.span, format!("it is {what} here"));
            self.report(finding.help("write a whole number without a unit, or use another constant there"));
            return None;
        }
        let message = format!("{what} must be a whole number, this is {this}");
        self.report(Diagnostic::new(Code::NotWhole, expr.span, message).help("write a whole number without a unit"));
        None
    }

    /// The name of the constant that an expression is, and the place of its value; none of a library's.
    fn constant_named(&self, cx: &Context<'a>, expr: &'a Expr) -> Option<(&'a str, Span)> {
        let ExprKind::Path(path) = &expr.kind else { return None };
        let [only] = path.segments.as_slice() else { return None };
        let name = only.name.text.as_str();
        let is_own = only.indices.is_empty() && cx.local(name).is_none() && cx.library.is_none();
        let (scope, declared) = look_up(&self.scopes, cx.names(), name).filter(|_| is_own)?;
        match declared.entity {
            Entity::Definition(k) if self.definitions[k].is_const && !self.scopes[scope].is_library => {
                Some((name, self.definitions[k].value.span))
            }
            _ => None,
        }
    }

    fn is_small(&mut self, form: &Form, span: Span) -> bool {
        let small = |n: &i64| n.abs() <= LARGEST;
        let fine = small(&form.constant) && form.terms.iter().all(|(_, c)| small(c));
        if !fine {
            let message = format!("an index or size beyond {LARGEST}");
            self.report(Diagnostic::new(Code::NotWhole, span, message).help("use a smaller number"));
        }
        fine
    }

    /// As `form`; silent where only the shape is wrong.
    fn affine(&mut self, cx: &Context<'a>, expr: &'a Expr) -> Result<Form, NoForm> {
        match &expr.kind {
            ExprKind::Path(path) if path.segments.len() == 1 && path.segments[0].indices.is_empty() => {
                match self.index_in_sight(cx, &path.segments[0].name.text) {
                    Some(form) => Ok(form),
                    None => self.whole_leaf(cx, expr),
                }
            }
            ExprKind::Neg(inner) => Form::default().plus(-1, &self.affine(cx, inner)?).ok_or(NoForm::OtherShape),
            ExprKind::Sum(terms) => {
                let mut total = Form::default();
                for (sign, term) in terms {
                    let term = self.affine(cx, term)?;
                    let sign = if *sign == Sign::Plus { 1 } else { -1 };
                    total = total.plus(sign, &term).ok_or(NoForm::OtherShape)?;
                }
                Ok(total)
            }
            ExprKind::Product(factors) => {
                let mut total = Form::number(1);
                for (op, factor) in factors {
                    let factor = self.affine(cx, factor)?;
                    let joined = match op {
                        MulOp::Multiply => match (total.as_number(), factor.as_number()) {
                            (_, Some(number)) => Form::default().plus(number, &total),
                            (Some(number), None) => Form::default().plus(number, &factor),
                            (None, None) => None,
                        },
                        MulOp::Divide => factor.as_number().and_then(|divisor| total.divided(divisor)),
                    };
                    total = joined.ok_or(NoForm::OtherShape)?;
                }
                Ok(total)
            }
            // What is not affine in an index is no form; without an index it may be a constant.
            _ if mentioned(expr).iter().any(|name| self.index_in_sight(cx, name).is_some()) => Err(NoForm::OtherShape),
            _ => self.whole_leaf(cx, expr),
        }
    }

    fn whole_leaf(&mut self, cx: &Context<'a>, expr: &'a Expr) -> Result<Form, NoForm> {
        self.whole(cx, expr, "an index or size").map(Form::number).ok_or(NoForm::Told)
    }

    /// The form of a name, if it is an index.
    pub(super) fn index_in_sight(&self, cx: &Context<'a>, name: &str) -> Option<Form> {
        match cx.local(name) {
            Some(Meaning::Index(form)) => return Some(form.clone()),
            Some(Meaning::Argument(_) | Meaning::Lazy(_) | Meaning::Shaped(_)) => return None,
            None => {}
        }
        let mut next = Some(cx.names());
        while let Some(id) = next {
            let scope = &self.scopes[id];
            if scope.names.contains_key(name) {
                return None;
            }
            if scope.index.is_some_and(|index| index.text == name) {
                // An agent that is its own one phase has an agent's index.
                let of_phase = scope.phase.is_some_and(|phase| self.phases[phase].item.is_some());
                return if of_phase { cx.phase.clone() } else { cx.agent.clone() };
            }
            next = scope.parent;
        }
        None
    }

    /// Where a family around a scope declares its index of this name, if nothing nearer has the name.
    fn family_index(&self, scope: ScopeId, name: &str) -> Option<Span> {
        let mut next = Some(scope);
        while let Some(scope) = next.map(|id| &self.scopes[id]) {
            if scope.names.contains_key(name) {
                return None;
            }
            if let Some(index) = scope.index.filter(|index| index.text == name) {
                return Some(index.span);
            }
            next = scope.parent;
        }
        None
    }

    /// A loop and the context inside it.
    pub(super) fn range(&mut self, cx: &Context<'a>, range: &'a IndexRange) -> Option<(Loop, Context<'a>)> {
        let name = range.index.text.as_str();
        self.bind_index(cx, &range.index);
        let first = self.form(cx, &range.first);
        let last = self.form(cx, &range.last);
        let over = self.new_index(first?, last?);
        let meaning = Meaning::Index(Form::index(over.index));
        Some((over.clone(), cx.inside(over).with(name, meaning)))
    }

    /// Tells of an index that hides another name.
    pub(super) fn bind_index(&mut self, cx: &Context<'a>, index: &'a Ident) {
        let name = index.text.as_str();
        self.index_names.entry(name).or_insert(index.span);
        // The index of a family is hidden from what stands inside the family: a definition of the whole problem is taken in each of
        // its members, and means its own indices.
        let family = self.family_index(cx.library.unwrap_or(cx.lexical), name);
        let hidden = cx.local(name).is_some() || family.is_some();
        let declared = look_up(&self.scopes, cx.library.unwrap_or(cx.lexical), name).map(|(_, declared)| declared);
        if hidden || declared.is_some() {
            let mut finding = Diagnostic::new(Code::DeclaredTwice, index.span, format!("`{name}` is declared twice"))
                .label(index.span, "declared again as an index here");
            let first = declared.filter(|_| !hidden).map(|declared| declared.span).or(family);
            if let Some(first) = first {
                finding = finding.label(first, "first declared here");
            }
            self.report(finding.help("give the index another name"));
        }
    }

    /// An index as a number.
    pub(super) fn index_value(&mut self, cx: &Context<'a>, form: &Form, text: &str, span: Span) -> Value {
        if let Some(number) = form.as_number() {
            let node = self.problem.dag.constant(number as f64);
            return Value::new(node, Dimension::NONE, span);
        }
        if cx.allow == Allow::Constants {
            return self.misplaced_value(What::Index, span, text, Some(Dimension::NONE));
        }
        let node = self.leaf(super::problem::Leaf::Index(form.clone()));
        Value::new(node, Dimension::NONE, span)
    }

    /// Tells when an index leaves `first ..= last` for some members of the loops around it.
    pub(super) fn check_index(
        &mut self,
        cx: &Context<'a>,
        form: &Form,
        ends: (i64, i64),
        name: &str,
        span: Span,
    ) -> bool {
        // While only shapes are looked for, indices of sums have no range.
        let unknown = |index: &IndexId| index.0 >= u32::MAX - self.unknown_indices;
        if self.unknown_indices > 0 && form.terms.iter().any(|(index, _)| unknown(index)) {
            return true;
        }
        if self.may_not_be_chosen {
            return true; // The value of the branch that is chosen is looked at for itself.
        }
        // A total over a family of phases has its members, as a loop has.
        let of_totals = self.total_indices.values().map(|range| &self.problem.ranges[*range as usize]);
        let loops: Vec<Loop> = cx.loops.iter().chain(of_totals).cloned().collect();
        let Some((least, most)) = extremes(form, &loops) else { return true };
        let (first, last) = ends;
        let outside = if least < first { least } else { most };
        if (first..=last).contains(&outside) {
            return true;
        }
        let text = self.text(span);
        let value = if form.as_number().is_some() { String::new() } else { format!(" (where it is {outside})") };
        let message = format!("`{text}`{value} is outside the indices of `{name}`");
        let members =
            if last < first { "it has no members".to_owned() } else { format!("its indices are {first} .. {last}") };
        self.report(Diagnostic::new(Code::IndexOutside, span, message).help(members));
        false
    }
}

/// The least and greatest values of a form over the members of the loops; none where there are no
/// members.
pub(super) fn extremes(form: &Form, loops: &[Loop]) -> Option<(i64, i64)> {
    let ends: Option<Vec<(i64, i64)>> =
        loops.iter().map(|over| over.first.as_number().zip(over.last.as_number())).collect();
    if let Some(ends) = ends {
        return extremes_between(form, loops, &ends);
    }
    let mut search = Search { form, loops, indices: HashMap::new(), found: None, budget: 50_000, visits: 0 };
    search.descend(0);
    search.found
}

/// The same where every loop runs from a number to a number: a form is least and greatest at their ends.
fn extremes_between(form: &Form, loops: &[Loop], ends: &[(i64, i64)]) -> Option<(i64, i64)> {
    if ends.iter().any(|(first, last)| first > last) {
        return None;
    }
    let (mut least, mut most) = (form.constant, form.constant);
    for (index, factor) in &form.terms {
        let Some(at) = loops.iter().rposition(|over| over.index == *index) else { continue };
        let (a, b) = (factor.saturating_mul(ends[at].0), factor.saturating_mul(ends[at].1));
        (least, most) = (least.saturating_add(a.min(b)), most.saturating_add(a.max(b)));
    }
    Some((least, most))
}

struct Search<'s> {
    form: &'s Form,
    loops: &'s [Loop],
    indices: HashMap<IndexId, i64>, // Looked up, never iterated.
    found: Option<(i64, i64)>,
    budget: usize,
    visits: usize,
}

/// Members visited at most: with many loops even their ends alone are too many.
const MAX_VISITS: usize = 200_000;

impl Search<'_> {
    /// Visits the members of loop `k` and of those inside it. A form is affine, so in the innermost
    /// loop, and once the budget is spent in every loop, only the ends are visited.
    fn descend(&mut self, k: usize) {
        let Some(over) = self.loops.get(k) else {
            let value = self.form.at(&self.indices);
            self.found = Some(self.found.map_or((value, value), |(a, b)| (a.min(value), b.max(value))));
            return;
        };
        let (first, last) = (over.first.at(&self.indices), over.last.at(&self.indices));
        self.visits += 1;
        if first > last || self.visits > MAX_VISITS {
            return;
        }
        let ends_only = k + 1 == self.loops.len() || last - first > 10_000;
        let visit = |search: &mut Self, value: i64| {
            search.indices.insert(over.index, value);
            search.budget = search.budget.saturating_sub(1);
            search.descend(k + 1);
        };
        if ends_only {
            visit(self, first);
            visit(self, last);
        } else {
            let mut value = first;
            while value <= last {
                visit(self, value);
                value = if self.budget == 0 && value < last { last } else { value + 1 };
            }
        }
    }
}
