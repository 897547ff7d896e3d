//! How well what was measured is met, and how certain that makes what was sought (docs/maths.md, section 17).
//!
//! Takes a transcription and its solution; gives residuals, their share of chi^2, and standard deviations of the
//! declared variables from the Hessian of the Lagrangian on the active constraints.

use crate::solution::{Solution, Value};
use crate::transcribe::{SetupError, Transcription};
use ntg_nlp::Multipliers;
use ntg_nlp::sensitivity::Sensitivity;
use ntg_structure::Unit;

/// What the measurements of a problem say.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Estimate {
    /// The sum of all squared ratios of residuals to their standard deviations.
    pub chi2: f64,
    /// How many numbers were measured.
    pub count: usize,
    /// The statements of `measure`, in the order of the spec.
    pub measurements: Vec<MeasurementReport>,
    /// The declared variables with their standard deviations; none where `unknown` says why.
    pub deviations: Vec<Deviation>,
    /// The correlations of the variables, row by row.
    pub correlations: Vec<Vec<f64>>,
    /// Why there are no standard deviations.
    pub unknown: Option<String>,
}

/// One statement of `measure`.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasurementReport {
    /// Its name, or its text in the spec.
    pub name: String,
    /// The unit of its residuals.
    pub unit: Unit,
    /// Its part of chi^2.
    pub chi2: f64,
    /// That part of the whole, from 0 to 1.
    pub share: f64,
    /// One for each number that was measured.
    pub residuals: Vec<Residual>,
}

/// By how much one measured number is missed.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// The indices of its loops: those of `for`, then the element of a vector.
    pub indices: Vec<i64>,
    /// The left side without the right one, in the unit.
    pub value: f64,
    /// The same as a multiple of the standard deviation.
    pub ratio: f64,
}

/// A variable with its standard deviation.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// The variable with its value and unit.
    pub variable: Value,
    /// Its standard deviation, in the unit.
    pub sigma: f64,
}

/// What the measurements say at a solution; nothing where none were made.
pub(super) fn estimate(
    nlp: &Transcription,
    solution: &Solution,
    is_solution: bool,
) -> Result<Option<Estimate>, SetupError> {
    if nlp.model.structure.measurements.is_empty() {
        return Ok(None);
    }
    let mut measurements = residuals(nlp, &solution.inner.x)?;
    let chi2: f64 = measurements.iter().map(|measurement| measurement.chi2).sum();
    for measurement in &mut measurements {
        measurement.share = if chi2 > 0.0 { measurement.chi2 / chi2 } else { 0.0 };
    }
    let count = measurements.iter().map(|measurement| measurement.residuals.len()).sum();
    let found = match is_solution {
        true => covariance(nlp, solution).and_then(|covariance| determined(covariance, solution)),
        false => Err("there is no solution".to_owned()),
    };
    let (covariance, unknown) = match found {
        Ok(covariance) => (covariance, None),
        Err(why) => (vec![], Some(why)),
    };
    let variables = solution.variables().into_iter();
    let sigma = |j: usize| covariance[j][j].max(0.0).sqrt();
    let deviations = variables.zip(0..covariance.len()).map(|(variable, j)| {
        let sigma = sigma(j) / variable.unit.factor;
        Deviation { variable, sigma }
    });
    let deviations: Vec<Deviation> = deviations.collect();
    let correlation = |j: usize, k: usize| match sigma(j) * sigma(k) {
        size if size > 0.0 && j != k => (covariance[j][k] / size).clamp(-1.0, 1.0),
        _ => f64::from(u8::from(j == k)),
    };
    let all = 0..covariance.len();
    let correlations = all.clone().map(|j| all.clone().map(|k| correlation(j, k)).collect()).collect();
    Ok(Some(Estimate { chi2, count, measurements, deviations, correlations, unknown }))
}

/// The residuals of all statements; members of one that were made one by one are together again.
fn residuals(nlp: &Transcription, x: &[f64]) -> Result<Vec<MeasurementReport>, SetupError> {
    let (structure, frame) = (&nlp.model.structure, nlp.frame());
    let mut found: Vec<(usize, MeasurementReport)> = vec![];
    for measurement in &structure.measurements {
        let term = &structure.terms[measurement.term];
        let values = frame.evaluate_members(&measurement.residual, &measurement.loops, x)?;
        let sigmas = frame.evaluate_members(&measurement.sigma, &measurement.loops, x)?;
        let at = found.iter().position(|(known, _)| *known == measurement.term).unwrap_or_else(|| {
            let name = term.name.clone().unwrap_or_else(|| super::cost::statement(&term.place.text));
            let unit = measurement.unit.clone();
            let report = MeasurementReport { name, unit, chi2: 0.0, share: 0.0, residuals: vec![] };
            found.push((measurement.term, report));
            found.len() - 1
        });
        let report = &mut found[at].1;
        for ((indices, value), (_, sigma)) in values.into_iter().zip(sigmas) {
            let ratio = value / sigma;
            report.chi2 += ratio * ratio;
            report.residuals.push(Residual { indices, value: value / report.unit.factor, ratio });
        }
    }
    Ok(found.into_iter().map(|(_, report)| report).collect())
}

/// A correlation so near to 1 is one: what is left of the variances is rounding.
const ONE: f64 = 1.0 - 1e-10;

/// The covariance, unless only two variables together are known.
fn determined(covariance: Vec<Vec<f64>>, solution: &Solution) -> Result<Vec<Vec<f64>>, String> {
    let variables = solution.variables();
    for (j, row) in covariance.iter().enumerate() {
        for (k, shared) in row.iter().enumerate().take(j) {
            if shared.abs() > ONE * (row[j] * covariance[k][k]).sqrt() && *shared != 0.0 {
                let (one, other) = (&variables[k].name, &variables[j].name);
                return Err(format!("what was measured tells `{one}` and `{other}` together, not apart"));
            }
        }
    }
    Ok(covariance)
}

/// The covariance of the declared variables, SI (docs/maths.md, equation 17.2).
fn covariance(nlp: &Transcription, solution: &Solution) -> Result<Vec<Vec<f64>>, String> {
    let inner = &solution.inner;
    let count = solution.variables().len();
    if count == 0 {
        return Ok(vec![]);
    }
    let first = nlp.model.layout.variable_first.first().map_or(0, |first| *first as usize);
    let multipliers = Multipliers { rows: &inner.row_multipliers, bounds: &inner.bound_multipliers };
    let mut factors = Sensitivity::new(nlp, &inner.x, multipliers).map_err(|why| why.to_string())?;
    if !factors.is_strict() {
        return Err("what was measured leaves a direction open in which nothing changes".to_owned());
    }
    let unit = |variable: usize| (0..inner.x.len()).map(|j| if j == variable { 1.0 } else { 0.0 }).collect();
    let units: Vec<Vec<f64>> = (first..first + count).map(unit).collect();
    let units: Vec<&[f64]> = units.iter().map(|unit| &unit[..]).collect();
    let adjoints = factors.adjoints(&units).map_err(|why| why.to_string())?;
    Ok(adjoints.into_iter().map(|adjoint| adjoint.x[first..first + count].to_vec()).collect())
}
