//! Typical sizes of variables and rows (docs/maths.md, section 5).
//!
//! Takes the guess, bounds and units; gives positive numbers. The coefficients of one output in
//! one agent share one size, so that scaling commutes with the spline.

use super::error::SetupError;
use super::layout::Time;
use super::rows::RowKind;
use super::{Transcription, names};
use crate::settings::{Scaling, Settings};
use ntg_structure::Unit;

impl Transcription<'_> {
    /// Sets all sizes from a guess; `Settings::scales` takes precedence.
    ///
    /// # Errors
    /// A name in `Settings::scales` that is nothing's.
    pub fn set_scales(&mut self, guess: &[f64], settings: &Settings) -> Result<(), SetupError> {
        let automatic = settings.scaling == Scaling::Automatic;
        let mut scale = vec![1.0; self.limits.lower.len()];
        if automatic {
            self.automatic(guess, &mut scale);
        }
        for (name, size) in &settings.scales {
            self.named(name, *size, &mut scale)?;
        }
        self.limits.scale = scale;
        self.limits.row_scale = if automatic { self.row_scales() } else { vec![1.0; self.limits.row_lower.len()] };
        Ok(())
    }

    /// Equation 5.2: the largest guessed coefficient, guess or bound; else the unit.
    fn automatic(&self, guess: &[f64], scale: &mut [f64]) {
        let (structure, layout) = (&self.model.structure, &self.model.layout);
        for agent in &layout.agents {
            let phases = agent.phases.clone();
            for (name, index, unit, coefficients) in self.outputs_of(phases) {
                let _ = (name, index);
                let largest = coefficients.iter().fold(0.0, |most: f64, v| most.max(guess[*v as usize].abs()));
                let size = usable(largest, unit);
                coefficients.iter().for_each(|v| scale[*v as usize] = size);
            }
        }
        let seconds = Unit::default();
        for variable in layout.coefficients..layout.variables {
            let (lower, upper) = (self.limits.lower[variable], self.limits.upper[variable]);
            let size = guess[variable].abs();
            let bound = [lower, upper].iter().filter(|b| b.is_finite()).fold(0.0, |most: f64, b| most.max(b.abs()));
            scale[variable] = usable(if size > 0.0 { size } else { bound }, &seconds);
        }
        for (declared, first) in structure.variables.iter().zip(&layout.variable_first) {
            let count = super::instances::family_len(declared.family);
            for variable in *first as usize..*first as usize + count {
                if guess[variable] == 0.0 {
                    let bounds = [self.limits.lower[variable], self.limits.upper[variable]];
                    let bound = bounds.iter().filter(|b| b.is_finite()).fold(0.0, |most: f64, b| most.max(b.abs()));
                    scale[variable] = usable(bound, &declared.unit);
                }
            }
        }
    }

    /// Every output of some phases once, with the coefficients of all of them.
    fn outputs_of(&self, phases: std::ops::Range<usize>) -> Vec<(String, Option<i64>, &Unit, Vec<u32>)> {
        let mut found: Vec<(String, Option<i64>, &Unit, Vec<u32>)> = vec![];
        for phase in phases {
            let member = &self.model.layout.phases[phase];
            for output in &member.outputs {
                let declared = &self.model.structure.phases[member.phase].outputs[output.output];
                let known = found.iter_mut().find(|f| f.0 == declared.name && f.1 == output.index);
                match known {
                    Some(known) => known.3.extend(&output.coefficients),
                    None => {
                        let coefficients = output.coefficients.clone();
                        found.push((declared.name.clone(), output.index, &declared.unit, coefficients));
                    }
                }
            }
        }
        found
    }

    /// Equation 5.3: the larger bound; else the unit.
    fn row_scales(&self) -> Vec<f64> {
        let limits = &self.limits;
        let bounds = limits.row_lower.iter().zip(&limits.row_upper);
        let size = |((lower, upper), info): ((&f64, &f64), &super::rows::RowInfo)| {
            let bound = [lower, upper].iter().filter(|b| b.is_finite()).fold(0.0, |most: f64, b| most.max(b.abs()));
            match info.kind {
                RowKind::Constraint(c) => usable(bound, &self.model.structure.constraints[c].unit),
                RowKind::Integral(_) => {
                    let (block, element, _) = info.maker;
                    let variable = self.elements.blocks[block].variables(element)[0];
                    limits.scale.get(variable as usize).copied().unwrap_or(1.0)
                }
            }
        };
        bounds.zip(&self.elements.rows).map(size).collect()
    }

    /// Sets the size of everything that a name means: outputs, variables, durations.
    fn named(&self, name: &str, size: f64, scale: &mut [f64]) -> Result<(), SetupError> {
        let (structure, layout) = (&self.model.structure, &self.model.layout);
        let mut found = false;
        for (agent, member) in layout.agents.iter().enumerate() {
            let path = names::agent(structure, layout, agent);
            for (output, index, unit, coefficients) in self.outputs_of(member.phases.clone()) {
                if names::means(name, &path, &output, index) {
                    found = true;
                    coefficients.iter().for_each(|v| scale[*v as usize] = size * unit.factor);
                }
            }
            if let Time::Free(variable) = member.start
                && names::means(name, &path, "start", None)
            {
                found = true;
                scale[variable as usize] = size;
            }
        }
        for (phase, member) in layout.phases.iter().enumerate() {
            if let Time::Free(variable) = member.duration
                && names::means_duration(structure, layout, name, phase)
            {
                found = true;
                scale[variable as usize] = size;
            }
        }
        for (declared, first) in structure.variables.iter().zip(&layout.variable_first) {
            for (member, index) in super::instances::family_members(declared.family).into_iter().enumerate() {
                if names::means(name, "", &declared.name, index) {
                    found = true;
                    scale[*first as usize + member] = size * declared.unit.factor;
                }
            }
        }
        if found { Ok(()) } else { Err(names::unknown("a typical size", name, structure)) }
    }
}

/// A size that can be divided by: the given one if it is positive and finite, else the unit.
fn usable(size: f64, unit: &Unit) -> f64 {
    if size > f64::MIN_POSITIVE && size.is_finite() { size } else { unit.factor }
}
