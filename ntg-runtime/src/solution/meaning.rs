//! What the inputs of calls stand for at a solution, for programs that read the formulas themselves.
//!
//! A [`Structure`](ntg_structure::Structure) addresses families by index forms; here they are resolved to splines, numbers and members.

use super::{Inner, Solution};
use crate::transcribe::instances::{index_at, members, range};
use crate::transcribe::{SetupError, names};
use ntg_splines::{Knots, Table};
use ntg_structure::{At, Data, Loop, PhaseRef, Slot};
use std::sync::Arc;

/// What an input of a call stands for, at one member of the loops around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meaning {
    /// A derivative of an output by the scaled time of its phase.
    Flat {
        /// Which spline, as an index into [`Solution::splines`].
        spline: usize,
        /// Where it is taken.
        at: At,
        /// Which derivative; 0 is the output.
        derivative: usize,
    },
    /// The duration of a phase in seconds, as an index into [`Solution::phases`].
    Duration(usize),
    /// The start of a phase in seconds of mission time.
    Start(usize),
    /// A variable of the nonlinear program that belongs to no spline, as an index into [`Solution::coefficients`].
    Variable(usize),
    /// An integral that is a variable: which of `Structure::integrals`, and its value as discretised, as an index
    /// into [`Solution::coefficients`].
    Integral(usize, usize),
    /// A member of a parameter.
    Parameter(usize, usize),
    /// An index of a loop.
    Index(i64),
    /// The scaled time of the phase.
    Tau,
}

/// One output in one phase.
#[derive(Clone, Debug)]
pub struct SplineView<'a> {
    /// Its path: `uav[2].covert.x[1]`.
    pub name: String,
    /// The phase, as an index into [`Solution::phases`].
    pub phase: usize,
    /// Order, breakpoints and smoothness, in the scaled time of the phase.
    pub knots: &'a Knots,
    /// The coefficients, SI.
    pub coefficients: Vec<f64>,
}

impl Solution {
    /// All outputs of all phases, phase by phase.
    pub fn splines(&self) -> Vec<SplineView<'_>> {
        let (model, x) = (&self.inner.model, &self.inner.x);
        let mut found = vec![];
        for (phase, member) in model.layout.phases.iter().enumerate() {
            for (output, own) in member.outputs.iter().enumerate() {
                found.push(SplineView {
                    name: names::output(&model.structure, &model.layout, phase, output),
                    phase,
                    knots: &own.knots,
                    coefficients: own.coefficients.iter().map(|c| x[*c as usize]).collect(),
                });
            }
        }
        found
    }

    /// A coefficient of one of [`Solution::splines`], as an index into [`Solution::coefficients`].
    pub fn coefficient(&self, spline: usize, number: usize) -> Option<usize> {
        let mut outputs = self.inner.model.layout.phases.iter().flat_map(|phase| &phase.outputs);
        outputs.nth(spline)?.coefficients.get(number).map(|variable| *variable as usize)
    }

    /// The same solution with other [`Solution::coefficients`], near those that it has; none where they are not as many.
    pub fn with_coefficients(&self, x: Vec<f64>) -> Option<Self> {
        let own = &self.inner;
        (x.len() == own.x.len()).then(|| {
            let inner = Inner {
                model: Arc::clone(&own.model),
                x,
                rows: own.rows.clone(),
                row_multipliers: own.row_multipliers.clone(),
                bound_multipliers: own.bound_multipliers.clone(),
                sizes: own.sizes.clone(),
            };
            Self { inner: Arc::new(inner) }
        })
    }

    /// The durations of all phases in seconds, to the last bit.
    pub fn durations(&self) -> Vec<f64> {
        let layout = &self.inner.model.layout;
        (0..layout.phases.len()).map(|phase| layout.duration(phase, &self.inner.x)).collect()
    }

    /// The interpolants of the structure's tables, in order.
    pub fn tables(&self) -> &[Table] {
        &self.inner.model.tables
    }

    /// The indices of every member of nested loops, the last index running fastest.
    pub fn members(loops: &[Loop]) -> Vec<Vec<i64>> {
        members(loops)
    }

    /// The values of one more loop inside given indices.
    pub fn range(one: &Loop, indices: &[i64]) -> std::ops::RangeInclusive<i64> {
        range(one, indices)
    }

    /// Which of [`Solution::phases`] a reference means inside given indices.
    ///
    /// # Errors
    /// [`SetupError`] for an index outside its family.
    pub fn phase_index(&self, reference: &PhaseRef, indices: &[i64]) -> Result<usize, SetupError> {
        self.inner.model.layout.phase(self.structure(), reference, indices)
    }

    /// What a slot stands for inside given indices.
    ///
    /// # Errors
    /// [`SetupError`] for an index outside its family.
    pub fn slot(&self, slot: &Slot, indices: &[i64]) -> Result<Meaning, SetupError> {
        let (structure, layout) = (self.structure(), &self.inner.model.layout);
        Ok(match slot {
            Slot::Flat { phase, at, output, index, derivative } => {
                let phase = layout.phase(structure, phase, indices)?;
                let output = layout.output(structure, phase, *output, index_at(index.as_ref(), indices))?;
                let before: usize = layout.phases[..phase].iter().map(|p| p.outputs.len()).sum();
                Meaning::Flat { spline: before + output, at: *at, derivative: *derivative }
            }
            Slot::Duration(phase) => Meaning::Duration(layout.phase(structure, phase, indices)?),
            Slot::Start(phase) => Meaning::Start(layout.phase(structure, phase, indices)?),
            Slot::Variable { variable, index } => {
                let index = index_at(index.as_ref(), indices);
                Meaning::Variable(layout.variable(structure, *variable, index)? as usize)
            }
            Slot::Integral { integral, index } => {
                let index: Vec<i64> = index.iter().map(|affine| affine.at(indices)).collect();
                Meaning::Integral(*integral, layout.integral(structure, *integral, &index)? as usize)
            }
        })
    }

    /// The variable that is a member of an integral, as an index into [`Solution::coefficients`].
    ///
    /// # Errors
    /// [`SetupError`] for an index outside its family.
    pub fn integral(&self, integral: usize, index: &[i64]) -> Result<usize, SetupError> {
        Ok(self.inner.model.layout.integral(self.structure(), integral, index)? as usize)
    }

    /// What a datum stands for inside given indices.
    ///
    /// # Errors
    /// [`SetupError`] for an index outside its family or array.
    pub fn datum(&self, data: &Data, indices: &[i64]) -> Result<Meaning, SetupError> {
        let (structure, layout) = (self.structure(), &self.inner.model.layout);
        Ok(match data {
            Data::Parameter { parameter, index } => {
                let index = index.as_ref().map_or(1, |index| index.at(indices));
                let count = structure.parameters.get(*parameter).map_or(0, |p| p.value.len());
                let member = usize::try_from(index - 1).ok().filter(|member| *member < count);
                let member = member.ok_or_else(|| SetupError::malformed("a parameter has no such member"))?;
                Meaning::Parameter(*parameter, member)
            }
            Data::Index(index) => Meaning::Index(index.at(indices)),
            Data::Tau | Data::TauWithin => Meaning::Tau,
            Data::Duration(phase) => Meaning::Duration(layout.phase(structure, phase, indices)?),
            Data::Start(phase) => Meaning::Start(layout.phase(structure, phase, indices)?),
        })
    }
}
