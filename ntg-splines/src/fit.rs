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

/// Coefficients of the spline that fits `samples` best in the sense of weighted least squares.
///
/// Without any usable sample it is the straight line between exact ends, or zero. End values
/// that are not finite are taken as [`Ends::Free`]. A single coefficient that must meet both
/// ends becomes their mean.
pub fn fit(knots: &Knots, samples: &[Sample], ends: Ends) -> Vec<f64> {
    let usable = |s: &&Sample| s.tau.is_finite() && s.value.is_finite() && s.weight.is_finite() && s.weight > 0.0;
    let samples: Vec<Sample> = samples.iter().filter(usable).copied().collect();
    let ends = match ends {
        Ends::Exact { start, end } if start.is_finite() && end.is_finite() => Some((start, end)),
        _ => None,
    };
    // Values of order one keep sums of squares away from overflow and underflow.
    let given = samples.iter().map(|s| s.value).chain(ends.into_iter().flat_map(|(a, b)| [a, b]));
    let scale = given.fold(0.0, |most: f64, value| most.max(value.abs()));
    if scale == 0.0 {
        return vec![0.0; knots.coefficients()];
    }
    let samples: Vec<Sample> = samples.iter().map(|s| Sample { value: s.value / scale, ..*s }).collect();
    let ends = ends.map(|(start, end)| (start / scale, end / scale));

    let fitted = solve(knots, &samples, ends);
    fitted.iter().map(|c| (c * scale).clamp(f64::MIN, f64::MAX)).collect()
}

/// The fit for values of order one.
fn solve(knots: &Knots, samples: &[Sample], ends: Option<(f64, f64)>) -> Vec<f64> {
    let (count, greville) = (knots.coefficients(), knots.greville());
    let (start, end) = match ends {
        Some((start, end)) if count == 1 => return vec![0.5 * (start + end)],
        Some(ends) => ends,
        None if samples.iter().all(|s| s.tau == samples[0].tau) => return level(samples, count),
        None => (0.0, 0.0),
    };
    let line = || greville.iter().map(|g| start + (end - start) * g).collect();
    let fixed = usize::from(ends.is_some());
    if samples.is_empty() || count == 2 * fixed {
        return line();
    }
    let mut rows = sample_rows(knots, samples);
    rows.extend(straight(&greville));
    if fixed == 0 {
        rows.extend(level_rows(count)); // Exact ends already pin what a straight polygon leaves free.
    }
    rows.sort_by_key(|row| row.start);
    let mut system = Banded::new(count - 2 * fixed, knots.order().max(3), 1);
    for mut row in rows {
        if fixed == 1 {
            fix_ends(&mut row, count, start, end);
        }
        system.add(row.start, &row.entries, &[row.side]);
    }
    let mut fitted = system.solve();
    if fixed == 1 {
        fitted.insert(0, start);
        fitted.push(end);
    }
    if fitted.iter().all(|c| c.is_finite()) { fitted } else { line() }
}

/// All coefficients equal to the weighted mean: what samples at a single time say.
fn level(samples: &[Sample], count: usize) -> Vec<f64> {
    let heaviest = samples.iter().fold(f64::MIN_POSITIVE, |most, s| most.max(s.weight));
    let total: f64 = samples.iter().map(|s| s.weight / heaviest).sum();
    let mean = samples.iter().map(|s| s.weight / heaviest * s.value).sum::<f64>() / total;
    vec![if mean.is_finite() { mean } else { 0.0 }; count]
}

/// One equation: `sum of entries[j] coefficient[start + j] = side`.
pub(crate) struct Row {
    pub(crate) start: usize,
    pub(crate) entries: Vec<f64>,
    pub(crate) side: f64,
}

/// One row for each sample.
fn sample_rows(knots: &Knots, samples: &[Sample]) -> Vec<Row> {
    let heaviest = samples.iter().fold(f64::MIN_POSITIVE, |most, s| most.max(s.weight));
    let row = |sample: &Sample| {
        let interval = knots.interval(sample.tau, Side::Right);
        let mut basis = [0.0; MAX_ORDER];
        derivative(knots.knots(), knots.order(), knots.span(interval), sample.tau, 0, &mut basis);
        let weight = (sample.weight / heaviest).sqrt();
        let entries = basis[..knots.order()].iter().map(|b| weight * b).collect();
        Row { start: knots.support_start(interval), entries, side: weight * sample.value }
    };
    samples.iter().map(row).collect()
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
        Row { start, entries: entries.into(), side: 0.0 }
    };
    greville.windows(3).enumerate().map(row).collect()
}

/// Asks the control polygon to be level (equation 1.12).
pub(crate) fn level_rows(count: usize) -> Vec<Row> {
    (1..count).map(|i| Row { start: i - 1, entries: vec![-LEVEL, LEVEL], side: 0.0 }).collect()
}

/// Moves the first and the last of `count` coefficients, which are known, to the right-hand
/// side, and counts the others from the second on.
fn fix_ends(row: &mut Row, count: usize, start: f64, end: f64) {
    let after = row.start + row.entries.len();
    if after == count {
        row.side -= end * row.entries.pop().unwrap_or(0.0);
    }
    if row.start == 0 {
        row.side -= start * row.entries.remove(0);
    } else {
        row.start -= 1;
    }
}
