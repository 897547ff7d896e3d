//! The unit in which values, bounds and misses of a constraint are shown.
//!
//! Takes the sides of a constraint. Gives the unit of the first side that has one; else a unit of their dimension in which
//! something is declared that the constraint names; else the rate of such a unit; else the first unit of their dimension
//! in which anything of the spec is declared; else that of the SI. A pure number is shown as a number.

use ntg_structure::Unit;

use super::dimension::{Dimension, Ratio};
use super::elaborator::Elaborator;
use super::units;
use super::value::Value;

/// A name of the spec with what it is declared in.
struct DeclaredUnit<'s> {
    name: &'s str,
    dimension: Dimension,
    unit: Unit,
}

/// Derivatives in constraints are of these orders.
const ORDERS: std::ops::RangeInclusive<usize> = 1..=4;

impl Elaborator<'_> {
    /// The unit in which a constraint between these values is shown; the side that is bounded comes first.
    pub(super) fn shown(&self, values: &[&Value]) -> Unit {
        if let Some(unit) = values.iter().find_map(|value| value.unit.as_ref()) {
            return (**unit).clone();
        }
        let dimension = values.iter().find_map(|value| value.dimension).unwrap_or(Dimension::NONE);
        if dimension.is_none() {
            return units::si(&dimension);
        }
        let declared = self.declared_units();
        let texts: Vec<String> = values.iter().map(|value| self.text(value.span)).collect();
        let is_word = |letter: char| letter.is_alphanumeric() || letter == '_';
        let named = |own: &&DeclaredUnit<'_>| {
            texts.iter().any(|text| text.split(|letter| !is_word(letter)).any(|word| word == own.name))
        };
        let fits = |own: &&DeclaredUnit<'_>| own.dimension == dimension;
        let known = declared.iter().filter(named).find(fits).map(|own| own.unit.clone());
        let known = known.or_else(|| declared.iter().filter(named).find_map(|own| self.rate_of(own, dimension)));
        let known = known.or_else(|| declared.iter().find(fits).map(|own| own.unit.clone()));
        known.unwrap_or_else(|| units::si(&dimension))
    }

    /// The unit of a derivative of something, if it has this dimension.
    fn rate_of(&self, own: &DeclaredUnit<'_>, dimension: Dimension) -> Option<Unit> {
        let order = ORDERS.into_iter().find(|order| {
            let power = i64::try_from(*order).map_or(Ratio::whole(0), Ratio::whole);
            own.dimension.over(&self.time.power(power)) == dimension
        })?;
        let rate = self.rate_unit(&own.unit, order);
        // `m/s/m` is better said as `1/s`.
        let is_plain = own.unit.symbol.contains('/') && rate.factor == 1.0;
        (!self.time.is_none()).then(|| if is_plain { units::si(&dimension) } else { rate })
    }

    /// What is declared with a unit of its own in the spec itself: outputs, variables, parameters, named expressions.
    fn declared_units(&self) -> Vec<DeclaredUnit<'_>> {
        let phases = self.problem.phases.iter().zip(&self.output_dimensions);
        let outputs = phases.flat_map(|(phase, dimensions)| phase.outputs.iter().zip(dimensions));
        let outputs =
            outputs.filter_map(|(output, dimension)| Some((&*output.name, (*dimension)?, output.unit.clone())));
        let variables = self.variables.iter().zip(&self.problem.variables);
        let variables = variables
            .filter_map(|((name, dimension), own)| Some((name.name.text.as_str(), (*dimension)?, own.unit.clone())));
        let parameters = self.parameters.iter().zip(&self.problem.parameters);
        let parameters =
            parameters.filter_map(|((name, dimension), own)| Some((&*name.text, (*dimension)?, own.unit.clone())));
        let own = self.definitions.iter().filter(|own| self.main.is_none_or(|end| own.span.start < end));
        let definitions = own.filter_map(|own| {
            let quantity = units::quantity(own.unit?).ok()?;
            Some((own.name.text.as_str(), quantity.dimension, units::shown(own.unit?, &quantity, self.source)))
        });
        let all = outputs.chain(variables).chain(definitions).chain(parameters);
        all.filter(|(.., unit)| !unit.symbol.is_empty())
            .map(|(name, dimension, unit)| DeclaredUnit { name, dimension, unit })
            .collect()
    }
}
