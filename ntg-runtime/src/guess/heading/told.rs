//! What rows say of an angle that is turned from its guess.

use super::rows::{Boundary, slots, variable};
use super::{Angle, LEAST};
use crate::transcribe::Transcription;
use ntg_nlp::{Evaluation, Nlp};
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// An equation holds with sine and cosine alone where that is missed by less than this part of them. Rounding.
pub(super) const EXACT: f64 = 1e-9;
/// Equations tell both sine and cosine where the lesser eigenvalue of their normal equations is above this part of the larger one.
/// A choice.
const TOLD: f64 = 1e-3;
/// Limits hold where they are missed by less than this part of what the angle changes them by, and two angles that one equation tells
/// are one where their cosines differ by less. Rounding.
const ROUNDING: f64 = 1e-6;

/// What an equation says of an angle that is turned by `δ`: `offset + cosine cos δ + sine sin δ == 0`.
#[derive(Clone, Copy)]
pub(super) struct Equation {
    offset: f64,
    cosine: f64,
    sine: f64,
}

impl Equation {
    /// What the angle changes it by at most.
    pub(super) fn size(&self) -> f64 {
        self.cosine.hypot(self.sine)
    }

    /// The value where the angle is turned.
    fn at(&self, turned: f64) -> f64 {
        self.offset + self.cosine * turned.cos() + self.sine * turned.sin()
    }

    /// The angles at which it holds; none where it holds at no angle, or any.
    fn solutions(&self) -> Option<Vec<f64>> {
        let (middle, cosine) = (self.sine.atan2(self.cosine), -self.offset / self.size());
        if cosine.is_nan() || cosine.abs() > 1.0 + ROUNDING {
            return None;
        }
        if 1.0 - cosine.abs() < ROUNDING {
            return Some(vec![if cosine > 0.0 { middle } else { middle + PI }]);
        }
        Some(vec![middle - cosine.acos(), middle + cosine.acos()])
    }
}

/// The program where angles are turned from a guess.
pub(super) struct Turned<'a> {
    pub(super) nlp: &'a Transcription<'a>,
    /// By no, a half, a quarter, three quarters and an eighth of a turn; the first two with derivatives.
    at: [Evaluation; 5],
}

impl<'a> Turned<'a> {
    /// Turns all of some angles; none where something is not finite.
    pub(super) fn new(nlp: &'a Transcription<'a>, angles: &[Angle], x: &[f64]) -> Option<Self> {
        let (mut work, mut at) = nlp.workspace();
        let no_multipliers = vec![0.0; nlp.rows()];
        let mut evaluate = |part: f64, with_slopes: bool| {
            let mut x = x.to_vec();
            for angle in angles {
                angle.output.coefficients.iter().for_each(|v| x[*v as usize] += part * angle.turn);
            }
            match with_slopes {
                true => nlp.derivatives(&x, 0.0, &no_multipliers, &mut work, &mut at).ok()?,
                false => nlp.values(&x, &mut work, &mut at).ok()?,
            }
            Some(at.clone())
        };
        let (east, west) = (evaluate(0.0, true)?, evaluate(0.5, true)?);
        Some(Self { nlp, at: [east, west, evaluate(0.25, false)?, evaluate(0.75, false)?, evaluate(0.125, false)?] })
    }

    /// What a row says of the angle that is turned in it; none where it knows more of the angle than sine and cosine, or where one
    /// of some inputs stands beside both.
    pub(super) fn equation(&self, row: usize, inputs: &BTreeSet<u32>) -> Option<Equation> {
        let value = self.value(row, inputs)?;
        Some(Equation { offset: value.offset - self.nlp.limits.row_lower[row], ..value })
    }

    /// By how much boundary conditions turn an angle: to where equations alone are met, or to the one of two such angles at which
    /// limits hold.
    pub(super) fn end(&self, rows: &Boundary, inputs: &BTreeSet<u32>) -> Option<f64> {
        let equations: Option<Vec<Equation>> = rows.equations.iter().map(|row| self.equation(*row, inputs)).collect();
        let equations = equations?;
        if let Some((cosine, sine)) = direction(&equations) {
            return Some(sine.atan2(cosine));
        }
        let largest = equations.iter().max_by(|a, b| a.size().total_cmp(&b.size()))?;
        let (lower, upper) = (&self.nlp.limits.row_lower, &self.nlp.limits.row_upper);
        let holds = |row: &usize, by: f64| {
            self.value(*row, inputs).is_none_or(|limit| {
                let (value, rounding) = (limit.at(by), ROUNDING * limit.size());
                lower[*row] - rounding <= value && value <= upper[*row] + rounding
            })
        };
        let mut possible = largest.solutions()?;
        possible.retain(|by| rows.limits.iter().all(|row| holds(row, *by)));
        if let [only] = possible[..] { Some(only) } else { None }
    }

    /// The value of a row by the angle that is turned in it.
    fn value(&self, row: usize, inputs: &BTreeSet<u32>) -> Option<Equation> {
        let (number, element, function) = self.nlp.elements.rows[row].maker;
        let block = &self.nlp.elements.blocks[number];
        let lane = function * block.elements + element;
        let [east, west, north, south, between] =
            self.at.each_ref().map(|at| block.weight[lane] * at.blocks[number].values[lane]);
        let (cosine, sine) = ((east - west) / 2.0, (north - south) / 2.0);
        let middle = f64::midpoint(east, west);
        let size = [east, west, north, south].iter().fold(0.0_f64, |most, own| most.max(own.abs()));
        let other = (middle - f64::midpoint(north, south)).abs();
        let missed = other.max((middle + FRAC_1_SQRT_2 * (cosine + sine) - between).abs());
        let mut inputs = slots(self.nlp, (number, function))
            .filter(|(_, slot, _)| variable(block, element, *slot).is_some_and(|v| inputs.contains(&v)));
        let is_beside = |entry: usize| {
            let [one, other] =
                [0, 1].map(|turn| self.at[turn].blocks[number].jacobian[entry * block.elements + element]);
            (one + other).abs() > LEAST * one.abs().max(other.abs())
        };
        let is_told = missed <= EXACT * size && !inputs.any(|(entry, ..)| is_beside(entry));
        is_told.then_some(Equation { offset: middle, cosine, sine })
    }
}

/// Cosine and sine that equations tell, by least squares, each equation as large as what the angle changes it by; none where they
/// tell one of them alone.
pub(super) fn direction(equations: &[Equation]) -> Option<(f64, f64)> {
    let (mut cc, mut cs, mut ss, mut c, mut s) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for own in equations {
        let size = own.size();
        let (cosine, sine, offset) = (own.cosine / size, own.sine / size, own.offset / size);
        cc += cosine * cosine;
        cs += cosine * sine;
        ss += sine * sine;
        c -= cosine * offset;
        s -= sine * offset;
    }
    let (determinant, trace) = (cc * ss - cs * cs, cc + ss);
    (determinant > TOLD * trace * trace).then(|| ((ss * c - cs * s) / determinant, (cc * s - cs * c) / determinant))
}
