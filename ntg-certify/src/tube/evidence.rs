//! What proves a tube again (docs/certificate-format.md).

use super::flow::Proof;
use super::system::System;
use super::{Handed, Phase, Steps};
use crate::certify::outward;
use crate::interval::Interval;

/// What proves the tube of a phase again.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// Which phase.
    pub phase: usize,
    /// The subjects that are its equations of motion.
    pub equations: Vec<usize>,
    /// What they determine.
    pub unknowns: Vec<Unknown>,
    /// All of their components, one after the other.
    pub components: Vec<Component>,
    /// For each box of time its cell, how often this is halved, and what proves the box.
    pub boxes: Vec<(usize, u32, Proof)>,
}

/// An output that the equations determine.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// Its spline.
    pub spline: usize,
    /// The highest derivative in the equations: the number of its components.
    pub order: usize,
}

/// A component of the state.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// What a person calls it.
    pub name: String,
    /// The component, counted over all tubes, with whose difference at the end it begins.
    pub begin: Option<usize>,
    /// The true value less the spline, at all times and at the end: SI units of mission time.
    pub bounds: [Interval; 2],
}

/// What part of their width bounds are widened by, so that another arithmetic finds what it does inside.
const ROOM: f64 = 1e-3;

impl Phase<'_> {
    /// What proves the steps of a tube that reaches the end.
    pub(super) fn evidence(&self, system: &System, steps: Steps, begin: &[Handed]) -> Evidence {
        let components = system.components().enumerate().map(|(c, (unknown, derivative))| {
            let all = steps.iter().map(|(_, step)| step.over[c]).reduce(Interval::hull);
            let end = steps.last().map(|(_, step)| step.at_end[c]);
            let seconds = self.seconds(derivative);
            let bounds = [all, end].map(|bound| bound.map_or(Interval::ENTIRE, |bound| roomy(bound.over(seconds))));
            let own = &self.machine.statement.splines[unknown.spline].name;
            let begin = self.handed_to((unknown.spline, derivative), begin).map(|handed| handed.number);
            Component { name: super::show::label(own, derivative), begin, bounds }
        });
        let components = components.collect();
        let unknowns = system.unknowns.iter().map(|own| Unknown { spline: own.spline, order: own.order }).collect();
        let boxes = steps.into_iter().map(|(window, step)| (window.cell, window.halvings, step.proof)).collect();
        Evidence { phase: self.phase, equations: system.subjects.clone(), unknowns, components, boxes }
    }
}

fn roomy(bound: Interval) -> Interval {
    let slack = ROOM * bound.width();
    outward(Interval::new(bound.low() - slack, bound.high() + slack))
}
