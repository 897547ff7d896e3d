//! Designs of experiments: points of the unit cube, and the distributions that they are mapped to.
//!
//! The same seed gives the same points on every machine: only functions of `ntg_runtime::math` are used.

use std::str::FromStr;

use ntg_runtime::math;

use crate::quantile;
use crate::sobol;

/// How points are laid out in the unit cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// Independent random points.
    MonteCarlo,
    /// Along each axis one point in each of as many equal intervals as there are points, elsewhere at random
    /// (M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21, 239 (1979)).
    LatinHypercube,
    /// The Sobol sequence, shifted at random; best with a power of two points.
    Sobol,
}

impl Design {
    /// `count` points of `dimensions` coordinates, each within 0 and 1, both excluded.
    ///
    /// # Errors
    /// In words: more dimensions than the Sobol sequence has here.
    pub fn points(self, count: usize, dimensions: usize, seed: u64) -> Result<Vec<Vec<f64>>, String> {
        let mut random = fastrand::Rng::with_seed(seed);
        let points = match self {
            Self::MonteCarlo => (0..count).map(|_| (0..dimensions).map(|_| random.f64()).collect()).collect(),
            Self::LatinHypercube => latin(count, dimensions, &mut random),
            Self::Sobol => sobol::points(count, dimensions, &mut random)?,
        };
        Ok(inside(points))
    }
}

/// Away from 0 and 1, where some distributions are infinite, by half of the last bit of a random number.
fn inside(mut points: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let least = f64::EPSILON / 4.0;
    points.iter_mut().flatten().for_each(|u| *u = u.clamp(least, 1.0 - f64::EPSILON / 2.0));
    points
}

fn latin(count: usize, dimensions: usize, random: &mut fastrand::Rng) -> Vec<Vec<f64>> {
    let mut points = vec![vec![0.0; dimensions]; count];
    for dimension in 0..dimensions {
        let mut cells: Vec<usize> = (0..count).collect();
        random.shuffle(&mut cells);
        for (point, cell) in points.iter_mut().zip(cells) {
            point[dimension] = (cell as f64 + random.f64()) / count as f64;
        }
    }
    points
}

/// How a parameter is dispersed, its numbers in one unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Mean and standard deviation.
    Normal(f64, f64),
    /// A normal distribution cut off at both ends.
    Truncated {
        /// Mean and standard deviation before it was cut.
        normal: (f64, f64),
        /// Least and greatest.
        ends: (f64, f64),
        /// The parts of the whole normal distribution that lie below the ends.
        parts: (f64, f64),
    },
    /// Least and greatest.
    Uniform(f64, f64),
    /// Least, most likely, greatest.
    Triangular(f64, f64, f64),
    /// The logarithm is normal: median and standard deviation of the logarithm.
    Lognormal(f64, f64),
}

/// How distributions are written.
const FORMS: &str = "normal(MEAN, DEVIATION), normal(MEAN, DEVIATION, LEAST, GREATEST), uniform(LEAST, GREATEST), \
                         triangular(LEAST, LIKELIEST, GREATEST) or lognormal(MEDIAN, DEVIATION OF THE LOGARITHM)";

impl FromStr for Distribution {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{}`: a distribution is {FORMS}", text.trim());
        let (name, rest) = text.trim().split_once('(').ok_or_else(wrong)?;
        let numbers = rest.strip_suffix(')').ok_or_else(wrong)?.split(',').map(|number| number.trim().parse::<f64>());
        let numbers = numbers.collect::<Result<Vec<_>, _>>().map_err(|_| wrong())?;
        if numbers.iter().any(|number| !number.is_finite()) {
            return Err(wrong());
        }
        let found = match (name.trim(), &numbers[..]) {
            ("normal", &[mean, deviation]) => Self::Normal(mean, deviation),
            ("normal", &[mean, deviation, least, greatest]) => {
                let part = |end: f64| quantile::probability((end - mean) / deviation);
                let (normal, ends) = ((mean, deviation), (least, greatest));
                Self::Truncated { normal, ends, parts: (part(least), part(greatest)) }
            }
            ("uniform", &[least, greatest]) => Self::Uniform(least, greatest),
            ("triangular", &[least, likeliest, greatest]) => Self::Triangular(least, likeliest, greatest),
            ("lognormal", &[median, deviation]) => Self::Lognormal(median, deviation),
            _ => return Err(wrong()),
        };
        found.check().map_err(|what| format!("`{}`: {what}", text.trim()))?;
        Ok(found)
    }
}

impl Distribution {
    fn check(self) -> Result<(), &'static str> {
        let ordered = |least: f64, greatest: f64| match least < greatest {
            true => Ok(()),
            false => Err("the least value must be smaller than the greatest"),
        };
        let deviates = |deviation: f64| match deviation > 0.0 {
            true => Ok(()),
            false => Err("the deviation must be positive"),
        };
        match self {
            Self::Normal(_, deviation) => deviates(deviation),
            Self::Truncated { normal, ends, .. } => deviates(normal.1).and(ordered(ends.0, ends.1)),
            Self::Uniform(least, greatest) => ordered(least, greatest),
            Self::Triangular(least, likeliest, greatest) if (least..=greatest).contains(&likeliest) => {
                ordered(least, greatest)
            }
            Self::Triangular(..) => Err("the likeliest value must lie between the least and the greatest"),
            Self::Lognormal(median, deviation) if median > 0.0 => deviates(deviation),
            Self::Lognormal(..) => Err("the median must be positive"),
        }
    }

    /// The value below which lies the part `u` of all, within 0 and 1.
    pub fn quantile(self, u: f64) -> f64 {
        match self {
            Self::Normal(mean, deviation) => mean + deviation * quantile::normal(u),
            Self::Truncated { normal: (mean, deviation), ends, parts: (below, above) } => {
                let inner = (below + (above - below) * u).clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0);
                (mean + deviation * quantile::normal(inner)).clamp(ends.0, ends.1)
            }
            Self::Uniform(least, greatest) => least * (1.0 - u) + greatest * u,
            Self::Triangular(least, likeliest, greatest) => {
                let (whole, left) = (greatest - least, likeliest - least);
                match u * whole < left {
                    true => least + math::sqrt(u * whole * left),
                    false => greatest - math::sqrt((1.0 - u) * whole * (greatest - likeliest)),
                }
            }
            Self::Lognormal(median, deviation) => median * math::exp(deviation * quantile::normal(u)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DESIGNS: [Design; 3] = [Design::MonteCarlo, Design::LatinHypercube, Design::Sobol];

    #[test]
    fn the_same_seed_gives_the_same_points_and_another_one_others() {
        for design in DESIGNS {
            let points = |seed| design.points(64, 5, seed).expect("points");
            assert_eq!(points(1), points(1));
            assert_ne!(points(1), points(2));
            assert!(points(3).iter().flatten().all(|u| (0.0..1.0).contains(u) && *u > 0.0));
        }
        assert!(Design::Sobol.points(1, 1000, 1).expect_err("too many").contains("latin-hypercube"));
    }

    #[test]
    fn every_interval_of_every_axis_has_one_point() {
        for design in [Design::LatinHypercube, Design::Sobol] {
            let points = design.points(64, 7, 5).expect("points");
            for axis in 0..7 {
                let mut cells: Vec<usize> = points.iter().map(|point| (point[axis] * 64.0) as usize).collect();
                cells.sort_unstable();
                assert_eq!(cells, (0..64).collect::<Vec<_>>(), "{design:?}, axis {axis}");
            }
        }
    }

    #[test]
    fn quantiles_have_the_moments_of_their_distributions() {
        // Mean and variance by the midpoint rule over the quantiles.
        let law = |text: &str, mean: f64, variance: f64| {
            let distribution: Distribution = text.parse().unwrap_or_else(|words| panic!("{words}"));
            const N: usize = 20_000;
            let values = (0..N).map(|i| distribution.quantile((i as f64 + 0.5) / N as f64));
            let (sum, squares) = values.fold((0.0, 0.0), |(s, q), v| (s + v, q + (v - mean).powi(2)));
            let (found, spread) = (sum / N as f64, squares / N as f64);
            assert!((found - mean).abs() < 2e-4 * variance.sqrt() + 1e-12, "{text}: {found}");
            assert!((spread / variance - 1.0).abs() < 2e-3, "{text}: {spread}");
        };
        law("normal(3, 2)", 3.0, 4.0);
        law("uniform(-1, 5)", 2.0, 3.0);
        law("triangular(0, 1, 4)", 5.0 / 3.0, (0.0 + 1.0 + 16.0 - 0.0 - 0.0 - 4.0) / 18.0);
        law("lognormal(2, 0.25)", 2.0 * (0.03125_f64).exp(), 4.0 * (0.0625_f64).exp() * ((0.0625_f64).exp() - 1.0));
        // Symmetric about its mean; variance 1 - 2 phi(1) / (2 Phi(1) - 1) for one deviation on either side.
        law("normal(0, 1, -1, 1)", 0.0, 1.0 - 2.0 * 0.241_970_724_519_143_37 / 0.682_689_492_137_085_9);
    }

    #[test]
    fn what_is_no_distribution_is_said_in_words() {
        for (text, words) in [
            ("gauss(1, 2)", "a distribution is normal(MEAN"),
            ("normal(1)", "a distribution is"),
            ("normal(1, 2", "a distribution is"),
            ("normal(1, nan)", "a distribution is"),
            ("normal(1, 0)", "must be positive"),
            ("uniform(2, 1)", "smaller"),
            ("triangular(0, 5, 1)", "likeliest"),
            ("lognormal(-1, 1)", "median"),
        ] {
            let said = text.parse::<Distribution>().expect_err(text);
            assert!(said.contains(words), "{said}");
        }
    }
}
