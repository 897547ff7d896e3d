//! Blocks of constraints, loops in them, and what each constraint demands.

use super::Build;
use super::parts::Parts;
use crate::diagnostic::Code;
use crate::source::Span;
use crate::syntax::ast::{
    AtBlock, Block, BlockPlace, Boundary, Comparison, Constraint, Expr, For, Part, Relation, Softness, Statement,
};
use crate::syntax::grammar::{Pair, Rule};

/// A relation as it was taken to be meant, and its place.
type Sign = (Comparison, Span);

impl Build {
    pub(super) fn block(&mut self, pair: Pair<'_>) -> Block {
        let mut parts = Parts::of(pair);
        let mut head = Parts::of(parts.required(Rule::block_head));
        let place = match head.required(Rule::place).as_str() {
            "initial" => BlockPlace::Initial,
            "trajectory" => BlockPlace::Trajectory,
            "final" => BlockPlace::Final,
            "dynamics" => BlockPlace::Dynamics,
            "measure" => BlockPlace::Measure,
            _ => BlockPlace::Temporal,
        };
        let part = head.optional(Rule::part).map(|pair| self.part(pair));
        if let Some(part) = part.as_ref().filter(|_| place != BlockPlace::Trajectory) {
            let help = match place {
                BlockPlace::Dynamics => "equations of motion hold all the way: write `dynamics { ... }`",
                _ => "only `trajectory` has parts: write `trajectory from a to b { ... }`",
            };
            self.report(Code::Misplaced, part.span(), "this block has no parts", help);
        }
        let statements: Vec<Statement<Constraint>> = parts.map(|pair| self.statement(pair)).collect();
        self.deviations(&statements, place == BlockPlace::Measure);
        Block { place, part, statements }
    }

    /// `except final`, `from a to b`.
    fn part(&mut self, pair: Pair<'_>) -> Part {
        let span = self.span(&pair);
        let mut inner = pair.into_inner();
        let word = inner.next().expect("the grammar begins a part with a word");
        if word.as_rule() == Rule::kw_except {
            let ends = inner.filter(|pair| pair.as_rule() == Rule::end_word);
            let ends = ends.map(|end| if end.as_str() == "initial" { Boundary::Initial } else { Boundary::Final });
            return Part::Except { ends: ends.collect(), span };
        }
        let mut ends = inner.filter(|pair| pair.as_rule() == Rule::expression).map(|pair| self.expression(pair));
        let from = if word.as_rule() == Rule::kw_from { ends.next() } else { None };
        let to = ends.next();
        Part::Between { from, to, span }
    }

    pub(super) fn at_block(&mut self, pair: Pair<'_>) -> AtBlock {
        let mut parts = Parts::of(pair);
        let time = self.expression(Parts::of(parts.required(Rule::at_head)).required(Rule::expression));
        let statements: Vec<Statement<Constraint>> = parts.map(|pair| self.statement(pair)).collect();
        self.deviations(&statements, false);
        AtBlock { time, statements }
    }

    pub(in crate::syntax) fn statement(&mut self, pair: Pair<'_>) -> Statement<Constraint> {
        let inner = Parts::of(pair).any();
        match inner.as_rule() {
            Rule::repeated => Statement::For(self.repeated(inner, Self::statement)),
            _ => Statement::One(self.constraint(inner)),
        }
    }

    /// `for i in 1 .. N { ... }` around statements that `one` reads.
    pub(super) fn repeated<T>(&mut self, pair: Pair<'_>, one: fn(&mut Self, Pair<'_>) -> Statement<T>) -> For<T> {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let head = parts.required(Rule::for_head);
        let over = self.index_range(Parts::of(head).required(Rule::index_range));
        For { over, body: parts.map(|pair| one(self, pair)).collect(), span }
    }

    fn constraint(&mut self, pair: Pair<'_>) -> Constraint {
        let mut parts = Parts::of(pair);
        let doc = parts.optional(Rule::doc).map(|pair| self.doc(pair));
        let softness = parts.optional(Rule::softness).map(|pair| self.softness(pair));
        let name = parts.optional(Rule::constraint_name).map(|pair| self.name(&pair));
        let first = self.expression(parts.required(Rule::expression));
        let start = name.as_ref().map_or(first.span, |name| name.span);
        let (relation, mut end) = if let Some(pair) = parts.optional(Rule::bounds) {
            let bounds = self.bounds(pair);
            let end = bounds.span;
            (Relation::In { value: first, bounds }, end)
        } else {
            self.chain(first, &mut parts, "constraints")
        };
        let sigma = parts.optional(Rule::deviation);
        let sigma = sigma.map(|pair| self.expression(Parts::of(pair).required(Rule::expression)));
        end = sigma.as_ref().map_or(end, |sigma| sigma.span);
        Constraint { doc, softness, name, relation, sigma, span: start.to(end) }
    }

    /// Every statement of `measure` has a standard deviation and is an equality; no other one has.
    fn deviations(&mut self, statements: &[Statement<Constraint>], measured: bool) {
        for statement in statements {
            let constraint = match statement {
                Statement::For(inner) => {
                    self.deviations(&inner.body, measured);
                    continue;
                }
                Statement::One(constraint) => constraint,
            };
            let help = "write `at(2 [s], x) == 3 [m] sigma 0.1 [m];`";
            match (&constraint.sigma, measured) {
                (Some(sigma), false) => {
                    let help = "only `measure { ... }` has standard deviations; `soft(w): ...` may be missed";
                    self.report(Code::Misplaced, sigma.span, "a constraint holds: it has no `sigma`", help);
                }
                (None, true) => {
                    let message = "how uncertain is this measurement?";
                    self.report(Code::WrongMeasurement, constraint.span, message, help);
                }
                _ => {}
            }
            if !measured {
                continue;
            }
            if let Some(softness) = &constraint.softness {
                let message = "what is measured is missed anyway, at the price of its `sigma`";
                self.report(Code::WrongMeasurement, softness.span, message, "remove `soft(...):`");
            }
            let is_equality = matches!(constraint.relation, Relation::Compare { comparison: Comparison::Equal, .. });
            if !is_equality {
                let message = "a measurement is an equality";
                let help = format!("{help} limits stand in `trajectory {{ }}` or in bounds");
                self.report(Code::WrongMeasurement, constraint.span, message, help);
            }
        }
    }

    /// `soft(w)`, `soft(linear = w, square = v)`.
    fn softness(&mut self, pair: Pair<'_>) -> Softness {
        let whole = self.span(&pair);
        let mut parts = Parts::of(pair);
        if let Some(price) = parts.optional(Rule::expression) {
            let linear = Some(self.expression(price));
            return Softness { linear, square: None, span: whole };
        }
        let mut settings = self.settings("soft", parts.next());
        let (linear, square) = (settings.value(self, "linear"), settings.value(self, "square"));
        let before = self.found.len();
        settings.finish(self);
        if linear.is_none() && square.is_none() && self.found.len() == before {
            let help = "write `soft(200 [1/s]): x <= 1;`, or `soft(square = 50 [1/s]): x <= 1;`";
            self.report(Code::Setting, whole, "what does it cost to miss this constraint?", help);
        }
        Softness { linear, square, span: whole }
    }

    /// `a <= b`, `a <= b <= c`, and everything like it that must be refused.
    pub(super) fn chain(&mut self, first: Expr, parts: &mut Parts<'_>, of: &str) -> (Relation, Span) {
        let mut signs: Vec<Sign> = vec![];
        let mut others: Vec<Expr> = vec![];
        while let Some(pair) = parts.optional(Rule::relation) {
            signs.push(self.relation(&pair, of));
            others.push(self.expression(parts.required(Rule::expression)));
        }
        let all = others.last().map_or(first.span, |last| first.span.to(last.span));
        if let [(one, _), (other, at)] = signs[..]
            && (one != other || one == Comparison::Equal)
        {
            self.mixed(at);
        } else if let Some((_, at)) = signs.get(2) {
            self.mixed(*at);
        }
        let (comparison, comparison_span) = signs[0];
        let mut others = others.into_iter();
        let second = others.next().expect("the grammar puts an expression after each relation");
        let relation = match others.next() {
            None => Relation::Compare { left: first, comparison, comparison_span, right: second },
            Some(last) => Relation::Between { first, comparison, middle: second, last },
        };
        (relation, all)
    }

    fn relation(&mut self, pair: &Pair<'_>, of: &str) -> Sign {
        use Comparison::{AtLeast, AtMost, Equal};
        let span = self.span(pair);
        let (meant, help) = match pair.as_str() {
            "==" => return (Equal, span),
            "<=" => return (AtMost, span),
            ">=" => return (AtLeast, span),
            "<" => (AtMost, "write `<=`: numbers of a computer cannot tell the two apart"),
            ">" => (AtLeast, "write `>=`: numbers of a computer cannot tell the two apart"),
            "=<" => (AtMost, "write `<=`"),
            "=>" => (AtLeast, "write `>=`"),
            "=" => (Equal, "write `==`"),
            _ => (Equal, "say which side is meant, with `<=` or `>=`"),
        };
        let message = format!("`{}` is not a relation of {of}", pair.as_str());
        self.report(Code::WrongRelation, span, message, help);
        (meant, span)
    }

    fn mixed(&mut self, second: Span) {
        let help = "write `lo <= a <= hi`, `hi >= a >= lo`, or several constraints";
        self.report(Code::MixedChain, second, "these relations make no double bound", help);
    }
}
