//! `ntg.Settings` as the solver's settings.

use std::collections::BTreeMap;
use std::time::Duration;

use ntg_runtime::refine::Refinement;
use ntg_runtime::settings::{Between, InertiaCorrection, Method, Settings, Violations};
use pyo3::prelude::*;

use crate::errors;

/// The attributes of `ntg.Settings`.
#[derive(FromPyObject)]
pub(crate) struct Given {
    method: String,
    restoration: String,
    inertia_correction: String,
    tolerance: f64,
    constraint_tolerance: f64,
    max_iterations: usize,
    time_limit: Option<f64>,
    samples: usize,
    scales: BTreeMap<String, f64>,
    refine: Option<f64>,
    between: String,
    between_tolerance: f64,
}

impl Given {
    /// The settings, checked against their ranges.
    pub(crate) fn settings(self, py: Python<'_>) -> PyResult<Settings> {
        let invalid = |message: &str| errors::plain(py, "SettingsError", message);
        let none_of =
            |setting: &str, word: &str, all: &str| invalid(&format!("setting `{setting}`: `{word}` is none of {all}"));
        let method = match self.method.as_str() {
            "auto" => Method::Auto,
            "interior-point" => Method::InteriorPoint,
            "augmented-lagrangian" => Method::AugmentedLagrangian,
            "sqp" => Method::Sqp,
            other => {
                return Err(none_of("method", other, "`auto`, `interior-point`, `augmented-lagrangian`, `sqp`"));
            }
        };
        let restoration = match self.restoration.as_str() {
            "absolute" => Violations::Absolute,
            "squared" => Violations::Squared,
            other => return Err(none_of("restoration", other, "`absolute`, `squared`")),
        };
        let inertia_correction = match self.inertia_correction.as_str() {
            "by-element" => InertiaCorrection::ByElement,
            "by-shift" => InertiaCorrection::ByShift,
            other => return Err(none_of("inertia_correction", other, "`by-element`, `by-shift`")),
        };
        let between = match self.between.as_str() {
            "report" => Between::Report,
            "refuse" => Between::Refuse,
            "refine" => Between::Refine,
            other => return Err(none_of("between", other, "`report`, `refuse`, `refine`")),
        };
        let time_limit = self.time_limit.map(Duration::try_from_secs_f64).transpose();
        let time_limit = time_limit.map_err(|_| invalid("setting `time_limit`: a positive number of seconds"))?;
        let settings = Settings {
            method,
            restoration,
            inertia_correction,
            tolerance: self.tolerance,
            constraint_tolerance: self.constraint_tolerance,
            max_iterations: self.max_iterations,
            time_limit,
            samples: self.samples,
            scales: self.scales.into_iter().collect(),
            refine: self.refine.map(Refinement::to),
            between,
            between_tolerance: self.between_tolerance,
            ..Settings::default()
        };
        settings.validate().map_err(|error| invalid(&error.to_string()))?;
        Ok(settings)
    }
}
