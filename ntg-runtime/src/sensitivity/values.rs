//! Derivatives of times, variables, outputs and named expressions (docs/maths.md, section 16.3).

use super::Sensitivity;
use crate::problem::Problem;
use crate::solution::{Inner, Solution};
use crate::transcribe::batch::batches;
use crate::transcribe::node::Site;
use crate::transcribe::points::Point;
use crate::transcribe::slots::Source;
use ntg_nlp::BlockValues;
use ntg_nlp::sensitivity::Response;
use ntg_splines::Side;
use ntg_structure::{At, Unit};
use std::sync::Arc;

/// Derivatives of one number by all parameters that were asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    /// The unit of what is differentiated.
    pub unit: Unit,
    /// One a parameter, in `unit` per declared unit of the parameter.
    pub values: Vec<f64>,
}

/// A point of a phase, and how its scaled time moves with each parameter while the mission time stands still.
struct Moment {
    point: Point,
    rates: Vec<f64>,
}

impl Sensitivity {
    /// Derivatives of a number: `objective`, a time of [`Solution::event_times`], a declared variable, or a named
    /// expression that is one.
    pub fn of(&self, name: &str) -> Option<Gradient> {
        if name == "objective" {
            return Some(self.objective().clone());
        }
        let unit = self.solution.structure().independent.unit.clone();
        // Both are linear in the variables: what they are of the derivatives is their derivative.
        let time = |solution: &Solution| solution.time(name).map(|time| time / unit.factor);
        if self.solution.time(name).is_some() {
            return self.of_each(time).map(|values| Gradient { unit: unit.clone(), values });
        }
        if let Some(found) = self.solution.variables().into_iter().find(|variable| variable.name == name) {
            let values = self.of_each(|solution| solution.variable(name))?;
            return Some(Gradient { unit: found.unit, values });
        }
        let signal = self.at.signal(&*self.problem, name).filter(|signal| signal.is_constant())?;
        Some(Gradient { unit: signal.unit().clone(), values: self.named(name, 0.0)? })
    }

    /// Derivatives of an output or a named expression at a mission time in seconds, which stands still; at its very start
    /// and end (and beyond) those of the first and the last value, which move with the ends.
    pub fn at(&self, name: &str, time: f64) -> Option<Gradient> {
        self.derivative_at(name, time, 0)
    }

    /// As [`Sensitivity::at`], of a derivative of an output with respect to time, in its unit per second to the power of
    /// `order`.
    pub fn derivative_at(&self, name: &str, time: f64, order: usize) -> Option<Gradient> {
        if let Some(output) = self.at.output(name) {
            return Some(Gradient { unit: output.unit().clone(), values: self.output(name, time, order)? });
        }
        let signal = self.at.signal(&*self.problem, name).filter(|_| order == 0)?;
        Some(Gradient { unit: signal.unit().clone(), values: self.named(name, time)? })
    }

    /// What a linear function of the variables is of the derivatives by each parameter.
    fn of_each(&self, function: impl Fn(&Solution) -> Option<f64>) -> Option<Vec<f64>> {
        let at = |response: usize| Some(function(&self.direction(response))? * self.parameters[response].unit.factor);
        (0..self.responses.len()).map(at).collect()
    }

    /// The derivatives of the variables by one parameter, as if they were a solution.
    fn direction(&self, response: usize) -> Solution {
        Solution { inner: Arc::new(Inner::point(Arc::clone(&self.moving), self.responses[response].x.clone())) }
    }

    /// Equation 16.4.
    fn moment(&self, (phase, tau): (usize, f64), is_end: bool) -> Moment {
        let (layout, x) = (&self.at.inner.model.layout, &self.at.inner.x);
        let duration = layout.duration(phase, x);
        let moving = &self.moving.layout;
        let rate = |response: &Response| {
            let (start, length) = (moving.start(phase, &response.x), moving.duration(phase, &response.x));
            if is_end { 0.0 } else { -(start + tau * length) / duration }
        };
        let side = if tau == 1.0 { Side::Left } else { Side::Right };
        let point = Point { phase: Some(phase), tau, side, weight: f64::NAN };
        Moment { point, rates: self.responses.iter().map(rate).collect() }
    }

    /// Equation 16.5.
    fn output(&self, name: &str, time: f64, order: usize) -> Option<Vec<f64>> {
        let trajectory = self.at.output(name)?;
        let (phase, tau, output) = trajectory.place(time)?;
        let is_end = !(trajectory.start() < time && time < trajectory.end());
        let moment = self.moment((phase, tau), is_end);
        let (layout, x) = (&self.at.inner.model.layout, &self.at.inner.x);
        let at = (moment.point.tau, moment.point.side);
        let (value, slope) = (layout.flat(phase, output, order, at, x), layout.flat(phase, output, order + 1, at, x));
        let duration = layout.duration(phase, x);
        let power = i32::try_from(order).unwrap_or(i32::MAX);
        let scale = crate::math::powi(duration, power);
        let each = self.responses.iter().zip(&moment.rates).zip(&self.parameters);
        let values = each.map(|((response, rate), parameter)| {
            let own = layout.flat(phase, output, order, at, &response.x);
            let stretched = f64::from(power) * value * self.moving.layout.duration(phase, &response.x) / duration;
            (own + slope * rate - stretched) / scale * parameter.unit.factor / trajectory.unit().factor
        });
        Some(values.collect())
    }

    /// Equation 16.6.
    fn named(&self, name: &str, time: f64) -> Option<Vec<f64>> {
        let signal = self.at.signal(&*self.problem, name)?;
        let place = signal.place(time)?;
        let is_end = signal.span().is_none_or(|(start, end)| !(start < time && time < end));
        let moment = place.phase.map(|phase| self.moment(phase, is_end));
        let model = &self.at.inner.model;
        let point = moment.as_ref().map_or(Point::NONE, |moment| moment.point);
        let site = Site { indices: place.indices, point };
        let mut x = self.at.inner.x.clone();
        // The last declared variable of the parametric form is the scaled time.
        let tau = *model.layout.variable_first.last()?;
        x[tau as usize] = if point.tau.is_nan() { 0.0 } else { point.tau };
        let frame = model.frame(&*self.problem);
        let call = &model.structure.named[place.named].call;
        let batch = batches(&frame, call, vec![site]).ok()?.pop()?;
        let kernels = &model.structure.kernels;
        let [jacobian, hessian] = batch.patterns(kernels);
        let mut out = BlockValues {
            values: vec![0.0; batch.node.rows],
            jacobian: vec![0.0; jacobian.len()],
            hessian: vec![0.0; hessian.len()],
        };
        batch.derivatives(&*self.problem, kernels, &model.tables, &x, &mut batch.work(), &mut out);
        let mut values = vec![0.0; self.responses.len()];
        for ((_, slot), slope) in jacobian.into_iter().zip(&out.jacobian) {
            // How fast the slot moves with scaled time.
            let along = match batch.sources()[slot] {
                Source::Flat { phase, at: At::Here, output, derivative } => {
                    model.layout.flat(phase, output, derivative + 1, (point.tau, point.side), &x)
                }
                Source::Global(variable) if variable == tau => 1.0,
                _ => 0.0,
            };
            let map = model.layout.affine(batch.sources()[slot], &point);
            for (parameter, value) in values.iter_mut().enumerate() {
                let own: f64 = map.terms.iter().map(|(j, c)| c * self.responses[parameter].x[*j as usize]).sum();
                let rate = moment.as_ref().map_or(0.0, |moment| moment.rates[parameter]);
                *value += slope * (own + along * rate);
            }
        }
        let factor = |parameter: usize| self.parameters[parameter].unit.factor / signal.unit().factor;
        Some(values.into_iter().enumerate().map(|(parameter, value)| value * factor(parameter)).collect())
    }
}

impl Sensitivity {
    /// The parametric form, for those who evaluate more of it.
    pub fn problem(&self) -> &dyn Problem {
        &*self.problem
    }
}
