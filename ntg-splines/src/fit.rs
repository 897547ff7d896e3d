//! Least-squares fit of samples by a spline, with exact ends if wanted.
//!
//! Where the samples leave coefficients free (fewer samples than coefficients, long gaps), the
//! fit is the one of least curvature among the best: rows of weight 1e-8 ask the control
//! polygon to be straight and, between free ends, rows of weight 1e-12 ask it to be level
//! (docs/maths.md, section 1.4, equations 1.11 and 1.12). Where the samples decide, these rows
//! change the result by their weight squared, which is near rounding.
//!
//! Takes samples; gives coefficients. Samples that are not finite or whose weight is not
//! positive are left out. Afterwards: every coefficient is finite, whatever the samples.

use crate::banded::Banded;
use crate::basis::derivative;
use crate::knots::{Knots, MAX_ORDER, Side};

/// Weight of the rows that ask for a straight control polygon.
const STRAIGHT: f64 = 1e-8;
/// Weight of the rows that ask for a level control polygon.
const LEVEL: f64 = 1e-12;

/// One sampled value of the function to be fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Scaled time, within `0 ..= 1` (outside, the end intervals' polynomials are used).
    pub tau: f64,
    /// The value there, in the unit of the output.
    pub value: f64,
    /// What its squared error counts, positive; only ratios matter.
    pub weight: f64,
}

/// What holds at scaled time 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ends {
    /// Nothing: the ends are fitted like everything else.
    Free,
    /// The spline takes these values exactly.
    Exact {
        /// Value at 0.
        start: f64,
        /// Value at 1.
        end: f64,
    },
}

/// When functions are sampled, and what a squared error there counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Scaled time, as in [`Sample::tau`].
    pub tau: f64,
    /// As [`Sample::weight`].
    pub weight: f64,
}

/// What is known of one of several functions.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// Its value at every place, in the unit of the output.
    pub values: Vec<f64>,
    /// Its values at scaled time 0 and 1.
    pub ends: (f64, f64),
}

/// Coefficients of the spline that fits `samples` best in the sense of weighted least squares.
///
/// Without any usable sample it is the straight line between exact ends, or zero. End values
/// that are not finite are taken as [`Ends::Free`]. A single coefficient that must meet both
/// ends becomes their mean.
pub fn fit(knots: &Knots, samples: &[Sample], ends: Ends) -> Vec<f64> {
    let usable = |s: &&Sample| s.tau.is_finite() && s.value.is_finite() && s.weight.is_finite() && s.weight > 0.0;
    let usable = || samples.iter().filter(usable);
    let places: Vec<Place> = usable().map(|s| Place { tau: s.tau, weight: s.weight }).collect();
    let ends = match ends {
        Ends::Exact { start, end } if start.is_finite() && end.is_finite() => Some((start, end)),
        _ => None,
    };
    let column = Column::new(usable().map(|s| s.value).collect(), ends);
    column.sized(&solve(knots, &places, &[&column]), 0, 1)
}

/// Places at which a function is sampled to be fitted by a spline on these knots: the same number in every interval.
pub fn fit_places(knots: &Knots) -> Vec<Place> {
    /// Samples in an interval for each coefficient that acts there.
    const SAMPLES: usize = 4;
    let count = SAMPLES * knots.order();
    let in_interval = |pair: &[f64]| {
        let (start, width) = (pair[0], pair[1] - pair[0]);
        (0..count).map(move |i| Place { tau: start + width * (i as f64 + 0.5) / count as f64, weight: width })
    };
    knots.breakpoints().windows(2).flat_map(in_interval).collect()
}

/// As [`fit`] with exact ends, for functions that are sampled at the same places, a value for each: the work is
/// hardly more than for one of them. In the order of the functions.
pub fn fit_all(knots: &Knots, places: &[Place], functions: &[Sampled]) -> Vec<Vec<f64>> {
    let at = |place: &Place| place.tau.is_finite() && place.weight.is_finite() && place.weight > 0.0;
    let known = |f: &Sampled| {
        let (start, end) = f.ends;
        f.values.iter().chain([&start, &end]).all(|value| value.is_finite())
    };
    if functions.is_empty() || !(places.iter().all(at) && functions.iter().all(known)) {
        let alone = |f: &Sampled| {
            let samples = places.iter().zip(&f.values);
            let samples = samples.map(|(place, &value)| Sample { tau: place.tau, value, weight: place.weight });
            fit(knots, &Vec::from_iter(samples), Ends::Exact { start: f.ends.0, end: f.ends.1 })
        };
        return functions.iter().map(alone).collect();
    }
    let columns: Vec<Column> = functions.iter().map(|f| Column::new(f.values.clone(), Some(f.ends))).collect();
    let fitted = solve(knots, places, &columns.iter().collect::<Vec<_>>());
    columns.iter().enumerate().map(|(i, column)| column.sized(&fitted, i, columns.len())).collect()
}

/// Values of order one, which keep sums of squares away from overflow and underflow.
struct Column {
    values: Vec<f64>,
    ends: Option<(f64, f64)>,
    /// What they were divided by.
    scale: f64,
}

impl Column {
    fn new(mut values: Vec<f64>, ends: Option<(f64, f64)>) -> Self {
        let given = values.iter().copied().chain(ends.into_iter().flat_map(|(a, b)| [a, b]));
        let scale = given.fold(0.0, |most: f64, value| most.max(value.abs()));
        let divisor = if scale == 0.0 { 1.0 } else { scale };
        values.iter_mut().for_each(|value| *value /= divisor);
        Self { values, ends: ends.map(|(start, end)| (start / divisor, end / divisor)), scale }
    }

    /// Its own of the fitted coefficients, coefficients × columns, in the size that it had.
    fn sized(&self, fitted: &[f64], column: usize, columns: usize) -> Vec<f64> {
        let own = fitted.iter().skip(column).step_by(columns);
        own.map(|c| (c * self.scale).clamp(f64::MIN, f64::MAX)).collect()
    }
}

/// The fits of columns that all have ends, or none: coefficients × columns.
fn solve(knots: &Knots, places: &[Place], columns: &[&Column]) -> Vec<f64> {
    let (count, greville) = (knots.coefficients(), knots.greville());
    let exact = columns.iter().all(|column| column.ends.is_some());
    let ends: Vec<(f64, f64)> = columns.iter().map(|column| column.ends.unwrap_or_default()).collect();
    if exact && count == 1 {
        return ends.iter().map(|(start, end)| 0.5 * (start + end)).collect();
    }
    if !exact && places.iter().all(|s| s.tau == places[0].tau) {
        return level(places, columns, count);
    }
    let line = |g: &f64, (start, end): &(f64, f64)| start + (end - start) * g;
    let fixed = usize::from(exact);
    if places.is_empty() || count == 2 * fixed {
        return greville.iter().flat_map(|g| ends.iter().map(|ends| line(g, ends)).collect::<Vec<_>>()).collect();
    }
    let mut rows = sample_rows(knots, places);
    rows.extend(straight(&greville).into_iter().map(|row| (row, None)));
    if !exact {
        rows.extend(level_rows(count).into_iter().map(|row| (row, None))); // Exact ends pin what is left free.
    }
    rows.sort_by_key(|(row, _)| row.start);
    let mut system = Banded::new(count - 2 * fixed, knots.order().max(3), columns.len());
    let mut sides = vec![0.0; columns.len()];
    for (mut row, sample) in rows {
        sides.fill(0.0);
        if let Some((sample, weight)) = sample {
            sides.iter_mut().zip(columns).for_each(|(side, column)| *side = weight * column.values[sample]);
        }
        if exact {
            fix_ends(&mut row, count, &ends, &mut sides);
        }
        system.add(row.start, &row.entries, &sides);
    }
    let mut fitted = system.solve();
    if exact {
        fitted.splice(0..0, ends.iter().map(|ends| ends.0));
        fitted.extend(ends.iter().map(|ends| ends.1));
    }
    for (column, ends) in ends.iter().enumerate() {
        let own = || (column..fitted.len()).step_by(columns.len());
        if !own().all(|i| fitted[i].is_finite()) {
            own().zip(&greville).for_each(|(i, g)| fitted[i] = line(g, ends));
        }
    }
    fitted
}

/// All coefficients equal to the weighted mean: what samples at a single time say.
fn level(places: &[Place], columns: &[&Column], count: usize) -> Vec<f64> {
    let heaviest = heaviest(places);
    let total: f64 = places.iter().map(|s| s.weight / heaviest).sum();
    let mean = |column: &&Column| {
        let sum: f64 = places.iter().zip(&column.values).map(|(s, value)| s.weight / heaviest * value).sum();
        if (sum / total).is_finite() { sum / total } else { 0.0 }
    };
    let means: Vec<f64> = columns.iter().map(mean).collect();
    means.repeat(count)
}

/// The weight that the others are relative to.
fn heaviest(places: &[Place]) -> f64 {
    places.iter().fold(f64::MIN_POSITIVE, |most, s| most.max(s.weight))
}

/// One equation: `sum of entries[j] coefficient[start + j] =` its right-hand side, 0 unless the caller says so.
pub(crate) struct Row {
    pub(crate) start: usize,
    pub(crate) entries: Vec<f64>,
}

/// One row for each sample: its right-hand side is the sample's value times the weight.
fn sample_rows(knots: &Knots, places: &[Place]) -> Vec<(Row, Option<(usize, f64)>)> {
    let heaviest = heaviest(places);
    let row = |(sample, place): (usize, &Place)| {
        let interval = knots.interval(place.tau, Side::Right);
        let mut basis = [0.0; MAX_ORDER];
        derivative(knots.knots(), knots.order(), knots.span(interval), place.tau, 0, &mut basis);
        let weight = (place.weight / heaviest).sqrt();
        let entries = basis[..knots.order()].iter().map(|b| weight * b).collect();
        (Row { start: knots.support_start(interval), entries }, Some((sample, weight)))
    };
    places.iter().enumerate().map(row).collect()
}

/// Asks the control polygon over the Greville abscissae to be straight (equation 1.11).
pub(crate) fn straight(greville: &[f64]) -> Vec<Row> {
    let width = (greville[greville.len() - 1] - greville[0]) / greville.len() as f64;
    let row = |(start, g): (usize, &[f64])| {
        let (before, after) = (g[1] - g[0], g[2] - g[1]);
        // Curvature of the polygon, squared and integrated; the cap keeps short intervals
        // from outweighing the samples.
        let stiffness = width.powf(1.5) * (2.0 * (before + after)).sqrt() / (before * after);
        let weight = STRAIGHT * stiffness.min(10.0);
        let entries = [after, -(before + after), before].map(|e| weight * e / (before + after));
        Row { start, entries: entries.into() }
    };
    greville.windows(3).enumerate().map(row).collect()
}

/// Asks the control polygon to be level (equation 1.12).
pub(crate) fn level_rows(count: usize) -> Vec<Row> {
    (1..count).map(|i| Row { start: i - 1, entries: vec![-LEVEL, LEVEL] }).collect()
}

/// Moves the first and the last of `count` coefficients, which are known, to the right-hand
/// sides, and counts the others from the second on.
fn fix_ends(row: &mut Row, count: usize, ends: &[(f64, f64)], sides: &mut [f64]) {
    let after = row.start + row.entries.len();
    if after == count {
        let entry = row.entries.pop().unwrap_or(0.0);
        sides.iter_mut().zip(ends).for_each(|(side, (_, end))| *side -= end * entry);
    }
    if row.start == 0 {
        let entry = row.entries.remove(0);
        sides.iter_mut().zip(ends).for_each(|(side, (start, _))| *side -= start * entry);
    } else {
        row.start -= 1;
    }
}
