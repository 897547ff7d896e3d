//! What measurements say: by how much each is missed, and how certain that makes what was sought.

use indexmap::IndexMap;
use ntg_runtime::report;
use serde::{Deserialize, Serialize};

use super::numbers;

/// What the measurements of a problem say at its solution.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Estimate {
    /// The sum of all squared ratios of residuals to their standard deviations.
    #[serde(with = "numbers::one")]
    pub chi2: f64,
    /// How many numbers were measured.
    pub count: usize,
    /// The statements of `measure`, in the order of the spec.
    pub measurements: Vec<Measurement>,
    /// The declared variables; none where `unknown` says why.
    pub deviations: IndexMap<String, Deviation>,
    /// The correlations of the variables, row by row.
    #[serde(with = "numbers::rows")]
    pub correlations: Vec<Vec<f64>>,
    /// Why there are no standard deviations.
    pub unknown: Option<String>,
}

/// One statement of `measure`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Measurement {
    /// Its name, or its text in the spec.
    pub name: String,
    /// The unit of its residuals.
    pub unit: String,
    /// Its part of chi^2.
    #[serde(with = "numbers::one")]
    pub chi2: f64,
    /// That part of the whole, from 0 to 1.
    #[serde(with = "numbers::one")]
    pub share: f64,
    /// One for each number that was measured.
    pub residuals: Vec<Residual>,
}

/// By how much one measured number is missed.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Residual {
    /// The indices of its loops: those of `for`, then the element of a vector.
    pub indices: Vec<i64>,
    /// The left side without the right one, in the unit.
    #[serde(with = "numbers::one")]
    pub value: f64,
    /// The same as a multiple of the standard deviation.
    #[serde(with = "numbers::one")]
    pub ratio: f64,
    /// When it was measured; none where that is no one time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub t: Option<f64>,
    /// The path of the output or named expression that was measured; empty where it is no single one.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub of: String,
    /// What was measured of it, in its unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<f64>,
    /// The standard deviation, in the same unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma: Option<f64>,
}

/// A variable with its standard deviation.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Deviation {
    /// The unit of both numbers.
    pub unit: String,
    /// The estimate.
    #[serde(with = "numbers::one")]
    pub value: f64,
    /// Its standard deviation.
    #[serde(with = "numbers::one")]
    pub sigma: f64,
}

impl Estimate {
    /// The same as JSON, with the fields of a saved run.
    pub fn text(&self) -> String {
        // Plain data with string keys always has a JSON form.
        serde_json::to_string(self).unwrap_or_default()
    }
}

impl From<&report::Estimate> for Estimate {
    fn from(found: &report::Estimate) -> Self {
        let deviations = found.deviations.iter().map(|deviation| {
            let variable = &deviation.variable;
            let (unit, value) = (variable.unit.symbol.clone(), variable.value);
            (variable.name.clone(), Deviation { unit, value, sigma: deviation.sigma })
        });
        Self {
            chi2: found.chi2,
            count: found.count,
            measurements: found.measurements.iter().map(Into::into).collect(),
            deviations: deviations.collect(),
            correlations: found.correlations.clone(),
            unknown: found.unknown.clone(),
        }
    }
}

impl From<&report::MeasurementReport> for Measurement {
    fn from(found: &report::MeasurementReport) -> Self {
        let residuals = found.residuals.iter().map(|residual| Residual {
            indices: residual.indices.clone(),
            value: residual.value,
            ratio: residual.ratio,
            ..Residual::default()
        });
        Self {
            name: found.name.clone(),
            unit: found.unit.symbol.clone(),
            chi2: found.chi2,
            share: found.share,
            residuals: residuals.collect(),
        }
    }
}
