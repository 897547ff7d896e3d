//! Every slot as an affine function of the variables (docs/maths.md, section 4.3).
//!
//! Takes a [`Source`] and the point of evaluation; gives the variables it depends on with their
//! coefficients, and the part that depends on none. Derivatives of outputs are with respect to
//! scaled time.

use super::layout::{Layout, Time, narrow};
use super::node::Site;
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

/// The affine maps of all slots of some elements, laid out for evaluation.
#[derive(Clone, Debug, Default)]
pub(crate) struct SlotMaps {
    elements: usize,
    slots: usize,
    /// Where the terms of slot `s` of element `e` begin: entry `s * elements + e`.
    start: Vec<u32>,
    variables: Vec<u32>,
    coefficients: Vec<f64>,
    offset: Vec<f64>,
}

impl SlotMaps {
    /// Maps of `slots` slots for every element; `maps[e][s]`.
    pub(crate) fn new(slots: usize, maps: &[Vec<AffineMap>]) -> Self {
        let mut all = Self { elements: maps.len(), slots, start: vec![0], ..Self::default() };
        for slot in 0..slots {
            for element in maps {
                let map = &element[slot];
                all.offset.push(map.offset);
                all.variables.extend(map.terms.iter().map(|t| t.0));
                all.coefficients.extend(map.terms.iter().map(|t| t.1));
                all.start.push(narrow(all.variables.len()));
            }
        }
        all
    }

    /// The maps of the sources of every site, which all have equally many.
    pub(crate) fn of_sources<'a>(layout: &Layout, sites: &[Site], sources: impl Fn(usize) -> &'a [Source]) -> Self {
        let slots = if sites.is_empty() { 0 } else { sources(0).len() };
        let mut all = Self { elements: sites.len(), slots, start: vec![0], ..Self::default() };
        for slot in 0..slots {
            for (element, site) in sites.iter().enumerate() {
                let map = layout.affine(sources(element)[slot], &site.point);
                all.offset.push(map.offset);
                all.variables.extend(map.terms.iter().map(|t| t.0));
                all.coefficients.extend(map.terms.iter().map(|t| t.1));
                all.start.push(narrow(all.variables.len()));
            }
        }
        all
    }

    /// Writes slot `s` of element `e` to `u[s * elements + e]`.
    pub(crate) fn refresh(&self, x: &[f64], u: &mut [f64]) {
        let ends = self.start.windows(2);
        for ((value, offset), range) in u.iter_mut().zip(&self.offset).zip(ends) {
            let (first, last) = (range[0] as usize, range[1] as usize);
            let terms = self.variables[first..last].iter().zip(&self.coefficients[first..last]);
            *value = terms.fold(*offset, |sum, (variable, c)| sum + c * x[*variable as usize]);
        }
    }

    /// How many numbers `refresh` writes.
    pub(crate) fn len(&self) -> usize {
        self.slots * self.elements
    }
}
