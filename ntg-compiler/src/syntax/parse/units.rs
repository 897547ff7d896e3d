//! Units and numbers.

use super::Build;
use super::parts::Parts;
use crate::diagnostic::Code;
use crate::syntax::ast::{MulOp, Number, Unit, UnitBase, UnitFactor};
use crate::syntax::grammar::{Pair, Rule};

/// No quantity of physics has a higher power; beyond it lies a slip of the pen.
const LARGEST_POWER: i32 = 99;

impl Build {
    pub(super) fn number(&mut self, pair: Pair<'_>) -> Number {
        let mut parts = Parts::of(pair);
        let numeral = parts.required(Rule::numeral);
        let value = numeral.as_str().parse().expect("the grammar's numbers are Rust's");
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        Number { value, unit }
    }

    pub(super) fn unit(&mut self, pair: Pair<'_>) -> Unit {
        let span = self.span(&pair);
        Unit { factors: self.unit_product(Parts::of(pair).required(Rule::unit_product)), span }
    }

    fn unit_product(&mut self, pair: Pair<'_>) -> Vec<UnitFactor> {
        let mut op = MulOp::Multiply;
        let mut factors = vec![];
        for part in Parts::of(pair) {
            match part.as_rule() {
                Rule::unit_operator => op = if part.as_str() == "/" { MulOp::Divide } else { MulOp::Multiply },
                _ => factors.push(self.unit_factor(op, part)),
            }
        }
        factors
    }

    fn unit_factor(&mut self, op: MulOp, pair: Pair<'_>) -> UnitFactor {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let base = parts.any();
        let base = match base.as_rule() {
            Rule::unit_one => UnitBase::One,
            Rule::unit_symbol => UnitBase::Symbol(self.name(&base)),
            _ => UnitBase::Group(self.unit_product(Parts::of(base).required(Rule::unit_product))),
        };
        let power = parts.optional(Rule::unit_power).map_or(1, |pair| self.unit_power(pair));
        UnitFactor { op, base, power, span }
    }

    fn unit_power(&mut self, pair: Pair<'_>) -> i32 {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let negative = parts.optional(Rule::minus).is_some();
        let power = parts.required(Rule::unit_digits).as_str().parse().unwrap_or(i32::MAX);
        if power > LARGEST_POWER {
            let help = format!("the largest power of a unit is {LARGEST_POWER}");
            self.report(Code::MalformedUnit, span, "this power is too large", help);
            return 1;
        }
        if negative { -power } else { power }
    }
}
