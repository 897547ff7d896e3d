//! Every slot as an affine function of the variables (docs/maths.md, section 4.3).
//!
//! Takes a [`Source`] and the point of evaluation; gives the variables it depends on with their
//! coefficients, and the part that depends on none. Derivatives of outputs are with respect to
//! scaled time. [`SlotMaps`](super::slot_maps::SlotMaps) lays out those of many elements.

use super::layout::{Layout, Time};
use super::points::Point;
use ntg_splines::basis::derivative;
use ntg_splines::{MAX_ORDER, Side};
use ntg_structure::At;

/// The concrete thing that a slot stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Source {
    /// An output's derivative: indices into the layout's phases and that phase's outputs.
    Flat { phase: usize, at: At, output: usize, derivative: usize },
    /// A phase's duration.
    Duration(usize),
    /// The time at which a phase starts.
    Start(usize),
    /// A variable of the program.
    Global(u32),
}

/// `offset + sum of coefficient * x[variable]`, each variable once.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct AffineMap {
    pub(crate) terms: Vec<(u32, f64)>,
    pub(crate) offset: f64,
}

impl AffineMap {
    /// The value for known variables.
    pub(crate) fn value(&self, x: &[f64]) -> f64 {
        self.terms.iter().fold(self.offset, |sum, &(variable, c)| sum + c * x[variable as usize])
    }

    fn add(&mut self, time: Time) {
        match time {
            Time::Fixed(value) => self.offset += value,
            Time::Free(variable) => self.terms.push((variable, 1.0)),
        }
    }
}

impl Layout {
    /// The affine map of one slot at one point.
    pub(crate) fn affine(&self, source: Source, here: &Point) -> AffineMap {
        let mut map = AffineMap::default();
        match source {
            Source::Flat { phase, at, output, derivative } => {
                let point = match at {
                    At::Here => *here,
                    At::Start => Point::start(phase),
                    At::End => Point::end(phase),
                    At::Inside(instant) => Point::inside(phase, instant, &self.phases[phase].breakpoints),
                    // Sources are about one member; the frame has looked its place up.
                    At::Among { .. } => Point::NONE,
                };
                map.terms = self.basis(phase, output, derivative, point.tau, point.side);
            }
            Source::Duration(phase) => map.add(self.phases[phase].duration),
            // docs/maths.md, equation 3.4.
            Source::Start(phase) => {
                map.add(self.agents[self.phases[phase].agent].start);
                for earlier in self.before(phase) {
                    map.add(self.phases[earlier].duration);
                }
            }
            Source::Global(variable) => map.terms.push((variable, 1.0)),
        }
        map
    }

    /// The basis values of one output at one point, with the variables that they multiply
    /// (docs/maths.md, equation 4.5).
    pub(crate) fn basis(&self, phase: usize, output: usize, order: usize, tau: f64, side: Side) -> Vec<(u32, f64)> {
        let output = &self.phases[phase].outputs[output];
        let knots = &output.knots;
        let interval = knots.interval(tau, side);
        let mut row = [0.0; MAX_ORDER];
        derivative(knots.knots(), knots.order(), knots.span(interval), tau, order, &mut row);
        let first = knots.support_start(interval);
        let active = &output.coefficients[first..first + knots.order()];
        active.iter().copied().zip(row).filter(|&(_, value)| value != 0.0).collect()
    }

    /// The value of one output's derivative with respect to scaled time.
    pub(crate) fn flat(&self, phase: usize, output: usize, order: usize, at: (f64, Side), x: &[f64]) -> f64 {
        self.basis(phase, output, order, at.0, at.1).iter().map(|&(v, b)| b * x[v as usize]).sum()
    }
}

impl Source {
    /// The output whose derivative this is.
    pub(crate) fn without_derivative(self) -> Self {
        match self {
            Self::Flat { phase, at, output, .. } => Self::Flat { phase, at, output, derivative: 0 },
            other => other,
        }
    }
}
