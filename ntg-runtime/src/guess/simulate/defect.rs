//! By how much a solution leaves its own equations of motion (docs/maths.md, equation 9.3d).

use super::motion::{Along, Equations};
use super::radau::{Motion, integrate};
use crate::transcribe::Transcription;
use ntg_splines::Side;

/// What is no variation: an output is at rest below this part of its size, a derivative below this part of itself and of the
/// size in one phase. A choice.
const AT_REST: f64 = 1e-3;

/// What varies by less than this part of its largest value varies by rounding, as in (5.5a). A choice.
const ROUNDING: f64 = 1e-10;

/// By how much an output leaves the equations of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Defect {
    /// The phase as a member.
    pub(crate) phase: usize,
    /// The output as a member of the phase.
    pub(crate) output: usize,
    /// The sum over intervals, relative to what the output or its derivative varies by in the phase; infinite where the motion
    /// cannot be followed through an interval.
    pub(crate) relative: f64,
    /// Of outputs that keep their sign and run through decades, as what grows from little: the largest sum over intervals of the
    /// logarithms, relative to those that are run through; 0 where there are none.
    pub(crate) of_decades: f64,
}

/// What runs through so many times its least value runs through decades. A choice.
const DECADES: f64 = 1e3;
/// Below this part of its largest value an output counts as that. A law: simulations are exact to a hundredth of it.
const LITTLE: f64 = 1e-4;

/// An output that keeps its sign.
#[derive(Clone, Copy)]
struct Signed {
    least: f64,
    most: f64,
    keeps_sign: bool,
    missed: f64,
}

impl Signed {
    fn of(start: f64) -> Self {
        Self { least: start, most: start, keeps_sign: start != 0.0, missed: 0.0 }
    }

    /// With one more end of an interval, and where the motion leads there.
    fn add(&mut self, end: f64, simulated: f64) {
        self.keeps_sign &= end * self.least > 0.0;
        let of_two = |a: f64, b: f64, is_less: bool| if (a.abs() < b.abs()) == is_less { a } else { b };
        (self.least, self.most) = (of_two(self.least, end, true), of_two(self.most, end, false));
        let floor = LITTLE * self.most.abs();
        let logarithm = |value: f64| (value * self.most.signum()).max(floor).ln();
        self.missed += (logarithm(end) - logarithm(simulated)).abs();
    }

    /// What is missed of the decades; 0 where there are few, or the sign changes.
    fn relative(&self) -> f64 {
        let span = self.most / self.least;
        if self.keeps_sign && span > DECADES { self.missed / span.min(1.0 / LITTLE).ln() } else { 0.0 }
    }
}

/// The largest defect of all outputs that equations move: over the intervals of a phase, the sum of the distances between
/// where the solution `x` ends an interval and where its equations lead from the interval's start, with its own inputs. None
/// where the equations of no phase decide how it moves.
pub(crate) fn defect(nlp: &Transcription, x: &[f64]) -> Option<Defect> {
    let along = Along::of(nlp)?;
    let phases = (0..nlp.model.layout.phases.len()).filter_map(|phase| of_phase(nlp, &along, phase, x));
    phases.reduce(larger)
}

fn larger(one: Defect, other: Defect) -> Defect {
    let of_decades = one.of_decades.max(other.of_decades);
    Defect { of_decades, ..if other.relative > one.relative { other } else { one } }
}

/// The largest defect in one phase.
fn of_phase<'a>(nlp: &'a Transcription, along: &Along<'a>, phase: usize, x: &'a [f64]) -> Option<Defect> {
    let layout = &nlp.model.layout;
    let mut equations = Equations::new(nlp, along, phase, x)?;
    let columns: Vec<(usize, usize)> = equations.columns.keys().copied().collect();
    let at = |tau: f64, side: Side| -> Vec<f64> {
        let value = |(output, of): &(usize, usize)| layout.flat(phase, *output, *of, (tau, side), x);
        columns.iter().map(value).collect()
    };
    let mut low = at(0.0, Side::Right);
    if !equations.decide(&low) {
        return None;
    }
    let mut high = low.clone();
    let mut signed: Vec<Signed> = low.iter().map(|start| Signed::of(*start)).collect();
    let mut missed = vec![0.0; columns.len()];
    for pair in layout.phases[phase].breakpoints.windows(2) {
        let end = at(pair[1], Side::Left);
        match integrate(&mut equations, at(pair[0], Side::Right), pair) {
            Some(track) => {
                missed.iter_mut().zip(end.iter().zip(&track.end)).for_each(|(m, (a, b))| *m += (a - b).abs());
                signed.iter_mut().zip(end.iter().zip(&track.end)).for_each(|(own, (a, b))| own.add(*a, *b));
            }
            None => missed.fill(f64::INFINITY),
        }
        for (value, (low, high)) in end.iter().zip(low.iter_mut().zip(&mut high)) {
            (*low, *high) = (low.min(*value), high.max(*value));
        }
    }
    let sizes = equations.sizes();
    let moving = equations.outputs.iter().zip(&equations.orders).zip(sizes);
    let states = moving.flat_map(|((output, order), size)| (0..*order).map(move |of| (*output, of, *size)));
    let own = states.map(|(output, of, size)| {
        let column = equations.columns[&(output, of)];
        // By scaled time; the value of an output may be far from 0 while it rests.
        let largest = high[column].abs().max(low[column].abs());
        let own = if of == 0 { 0.0 } else { largest };
        let rest = (AT_REST * size.max(own)).max(ROUNDING * largest);
        let of_decades = if of == 0 { signed[column].relative() } else { 0.0 };
        Defect { phase, output, relative: missed[column] / (high[column] - low[column]).max(rest), of_decades }
    });
    own.reduce(larger)
}
