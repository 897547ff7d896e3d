//! What linear boundary conditions fix before anything is solved.
//!
//! Takes linear equalities `sum of c[i] x[i] + constant = 0`; keeps them in echelon form by
//! Gaussian elimination with the largest coefficient as pivot. Finds: equations that contradict
//! those before them. Afterwards: the value of any linear combination that they determine.

use super::slots::AffineMap;
use std::collections::{BTreeMap, BTreeSet};

/// A coefficient smaller than this part of the numbers that it comes from is rounding. Those of other variables say nothing of it:
/// they have other units.
const NEGLIGIBLE: f64 = 1e-11;
/// A residual larger than this part of the numbers it comes from is a contradiction.
const CONTRADICTION: f64 = 1e-8;

/// `sum of terms + constant`, and the size of the numbers that went into the constant.
#[derive(Clone, Debug, Default)]
pub(crate) struct Combination {
    terms: BTreeMap<u32, Coefficient>,
    pub(crate) constant: f64,
    size: f64,
}

/// A coefficient, and the size of the numbers that went into it.
#[derive(Clone, Copy, Debug, Default)]
struct Coefficient {
    value: f64,
    size: f64,
}

impl Coefficient {
    /// Whether it is more than rounding.
    fn is_something(&self) -> bool {
        self.value.abs() > NEGLIGIBLE * self.size
    }
}

/// Equations in echelon form: no equation holds the pivot of one before it.
#[derive(Clone, Debug, Default)]
pub(crate) struct LinearSystem {
    equations: Vec<(u32, Combination)>,
    /// The equation of each pivot.
    equation_of: BTreeMap<u32, usize>,
}

impl From<&AffineMap> for Combination {
    fn from(map: &AffineMap) -> Self {
        let mut sum = Self { constant: map.offset, size: map.offset.abs(), ..Self::default() };
        map.terms.iter().for_each(|(variable, c)| sum.add(*variable, *c));
        sum
    }
}

impl Combination {
    /// Only a constant.
    pub(crate) fn constant(constant: f64) -> Self {
        Self { constant, size: constant.abs(), ..Self::default() }
    }

    /// Adds `c x[variable]`.
    pub(crate) fn add(&mut self, variable: u32, c: f64) {
        self.add_coefficient(variable, Coefficient { value: c, size: c.abs() });
    }

    fn add_coefficient(&mut self, variable: u32, by: Coefficient) {
        let own = self.terms.entry(variable).or_default();
        *own = Coefficient { value: own.value + by.value, size: own.size + by.size };
    }

    /// Adds `times` another combination.
    pub(crate) fn add_scaled(&mut self, times: f64, other: &Self) {
        for (variable, Coefficient { value, size }) in &other.terms {
            self.add_coefficient(*variable, Coefficient { value: times * value, size: times.abs() * size });
        }
        self.constant += times * other.constant;
        self.size += times.abs() * other.size;
    }

    /// The least and the greatest value for variables within their bounds.
    pub(crate) fn range(&self, bounds: &[(f64, f64)]) -> (f64, f64) {
        self.parts(bounds).fold((self.constant, self.constant), |(least, most), (_, c, part)| {
            // A variable that has cancelled out may be unbounded.
            if c == 0.0 { (least, most) } else { (least + part.0, most + part.1) }
        })
    }

    /// Each variable, its coefficient, and the least and the greatest value of their product for the variable within its bounds.
    fn parts<'a>(&'a self, bounds: &'a [(f64, f64)]) -> impl Iterator<Item = (u32, f64, (f64, f64))> + 'a {
        self.terms.iter().map(|(variable, Coefficient { value: c, .. })| {
            let (lower, upper) = bounds[*variable as usize];
            let (a, b) = if *c < 0.0 { (upper, lower) } else { (lower, upper) };
            (*variable, *c, (c * a, c * b))
        })
    }

    /// How large a variable may be at most, where the combination stays within `within` and the others within their bounds. None
    /// where that does not limit it.
    pub(crate) fn greatest(&self, variable: u32, within: (f64, f64), bounds: &[(f64, f64)]) -> Option<f64> {
        let own = self.terms.get(&variable)?.value;
        let others = self.parts(bounds).filter(|(other, c, _)| *other != variable && *c != 0.0);
        let (least, most) =
            others.fold((self.constant, self.constant), |(least, most), (.., part)| (least + part.0, most + part.1));
        let greatest = if own > 0.0 { (within.1 - least) / own } else { (within.0 - most) / own };
        greatest.is_finite().then_some(greatest)
    }

    fn largest(&self) -> Option<(u32, f64)> {
        let larger = |best: Option<(u32, f64)>, (v, c): (&u32, &Coefficient)| match best {
            Some((_, held)) if held.abs() >= c.value.abs() => best,
            _ => Some((*v, c.value)),
        };
        self.terms.iter().fold(None, larger)
    }

    /// How far the constant may be from a bound by rounding alone.
    pub(crate) fn tolerance(&self) -> f64 {
        CONTRADICTION * self.size
    }
}

impl LinearSystem {
    /// Adds the equation `row = 0`.
    ///
    /// # Errors
    /// The residual that is left where the equations so far make it impossible.
    pub(crate) fn add(&mut self, row: &Combination) -> Result<(), f64> {
        let reduced = self.reduce(row);
        match reduced.largest() {
            Some((pivot, _)) => {
                self.equation_of.insert(pivot, self.equations.len());
                self.equations.push((pivot, reduced));
                Ok(())
            }
            None if reduced.constant.abs() > reduced.tolerance() => Err(reduced.constant),
            None => Ok(()),
        }
    }

    /// The value of a combination, if the equations determine it.
    pub(crate) fn known(&self, row: &Combination) -> Option<Combination> {
        if !row.terms.is_empty() && self.equations.is_empty() {
            return None;
        }
        let reduced = self.reduce(row);
        reduced.terms.is_empty().then_some(reduced)
    }

    /// The value of an affine map, if the equations determine it.
    pub(crate) fn value(&self, map: &AffineMap) -> Option<f64> {
        self.known(&map.into()).map(|row| row.constant)
    }

    fn reduce(&self, row: &Combination) -> Combination {
        let mut row = row.clone();
        let numbers = |row: &Combination| -> BTreeSet<usize> {
            row.terms.keys().filter_map(|variable| self.equation_of.get(variable).copied()).collect()
        };
        // An equation brings in pivots of later ones only, so all are taken in their order.
        let mut due = numbers(&row);
        while let Some(number) = due.pop_first() {
            let (pivot, equation) = &self.equations[number];
            if let Some(c) = row.terms.remove(pivot).filter(Coefficient::is_something) {
                let times = -c.value / equation.terms[pivot].value;
                row.add_scaled(times, equation);
                row.terms.remove(pivot);
                due.extend(numbers(equation).range(number + 1..));
            }
        }
        row.terms.retain(|_, c| c.is_something());
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(terms: &[(u32, f64)], constant: f64) -> Combination {
        (&AffineMap { terms: terms.to_vec(), offset: constant }).into()
    }

    #[test]
    fn two_equations_determine_two_unknowns() {
        let mut system = LinearSystem::default();
        system.add(&row(&[(0, 1.0), (1, 2.0)], -5.0)).expect("the first equation contradicts nothing");
        assert!(system.known(&row(&[(0, 1.0)], 0.0)).is_none());
        system.add(&row(&[(0, 3.0), (1, -1.0)], -1.0)).expect("x = 1, y = 2 solves both");
        let sum = system.known(&row(&[(0, 1.0), (1, 1.0)], 0.5)).expect("both are determined");
        assert!((sum.constant - 3.5).abs() < 1e-12);
    }

    #[test]
    fn what_is_left_of_a_coefficient_by_rounding_says_nothing() {
        // The rate, the curvature and the place of a spline at its end, in SI of a move of 0.8 us.
        let mut system = LinearSystem::default();
        let (rate, curvature) = (5.0 / 0.7996e-6, 20.0 / (0.7996e-6 * 0.7996e-6));
        let curved = |times: f64| {
            let own = curvature * times;
            row(&[(3, own * 1.1), (4, -own * 2.3), (5, own * 1.2)], 0.0)
        };
        let all = [row(&[(4, -rate), (5, rate)], 0.0), curved(1.0), row(&[(5, 1.0)], -1.613)];
        assert!(all.iter().all(|row| system.add(row).is_ok()));
        for times in [0.1, 0.3, 0.7, 1.0 / 3.0, 1.0 / 7.0, 1.0 / 11.0] {
            let known = system.known(&curved(times)).expect("all three are determined");
            assert!(known.constant.abs() <= known.tolerance(), "{times}: {known:?}");
        }
    }

    #[test]
    fn a_repeated_equation_is_no_contradiction_and_a_shifted_one_is() {
        let mut system = LinearSystem::default();
        system.add(&row(&[(0, 0.1), (3, 0.7)], -0.3)).expect("the first equation contradicts nothing");
        assert!(system.add(&row(&[(0, 0.3), (3, 2.1)], -0.9)).is_ok());
        let residual = system.add(&row(&[(0, 0.1), (3, 0.7)], -0.4)).expect_err("the constants differ");
        assert!((residual + 0.1).abs() < 1e-12);
    }

    #[test]
    fn coefficients_of_other_units_are_no_rounding_of_each_other() {
        let mut system = LinearSystem::default();
        system.add(&row(&[(0, 1.0), (2, 3e12)], -9e6)).expect("the first equation contradicts nothing");
        system.add(&row(&[(1, 1.0), (2, 3e12)], -12e6)).expect("x[0] and x[1] are free");
        assert!(system.known(&row(&[(2, 1.0)], 0.0)).is_none());
        let apart = system.known(&row(&[(1, 1.0), (0, -1.0)], 0.0)).expect("both equations have the same x[2]");
        assert!((apart.constant - 3e6).abs() < 1e-6);
    }

    #[test]
    fn a_variable_is_at_most_what_the_others_leave() {
        let row = row(&[(0, 2.0), (1, -1.0)], 1.0);
        let bounds = [(0.0, f64::INFINITY), (0.0, 5.0)];
        assert_eq!(row.greatest(0, (f64::NEG_INFINITY, 4.0), &bounds), Some(4.0));
        assert_eq!(row.greatest(0, (0.0, f64::INFINITY), &bounds), None);
        assert_eq!(row.greatest(1, (-7.0, f64::INFINITY), &bounds), None);
        assert_eq!(row.greatest(1, (-7.0, 4.0), &[(0.0, 1.0), bounds[1]]), Some(10.0));
        assert_eq!(row.greatest(2, (0.0, 0.0), &bounds), None);
    }

    #[test]
    fn rounding_of_large_numbers_is_no_contradiction() {
        // Three equations for two unknowns, the last the sum of the others up to rounding.
        let mut system = LinearSystem::default();
        let (a, b) = (row(&[(0, 0.1), (1, 1e5)], -4e7 / 3.0), row(&[(0, 0.3), (1, 1e5)], -4e7 / 7.0));
        let mut sum = a.clone();
        sum.add_scaled(1.0, &b);
        sum.constant += 1e-9;
        assert!([a, b, sum].iter().all(|row| system.add(row).is_ok()));
    }
}
