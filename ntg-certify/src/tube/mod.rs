//! Tubes: how far the true state is from the splines, where equations of motion hold at points only (docs/maths.md,
//! section 15.7).
//!
//! The true state starts where the splines start, has their inputs, and satisfies the equations at every time. It is
//! enclosed phase by phase: a reference that nearly satisfies the equations is computed, and what is between it and the
//! true state is bounded box by box of time. A later phase begins with what its predecessor ends with.
//!
//! What was found comes with what proves it again: `ntg-check` needs to find nothing.

mod evidence;
mod flow;
mod matrix;
mod reference;
mod show;
mod system;

use std::time::Instant;

use ntg_runtime::solution::Solution;
use ntg_structure::{Affine, Independent, PhaseRef, Unit};

use crate::certify::Certificate;
use crate::evaluate::{Machine, cell};
use crate::interval::Interval;
use crate::spline::Piece;
use crate::statement::Flat;
use crate::summary::Band;
pub use evidence::{Component, Evidence, Unknown};
pub use flow::Proof;
use flow::{Flow, Front, Step, Trouble, Turned, Window};
use reference::Rule;
use system::System;

/// How the tube of a phase ends.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// It reaches the end of the phase.
    Whole,
    /// It ends at this time, as it is shown; the words say why.
    At(f64, String),
    /// There is none; the words say why.
    None(String),
}

/// How far the true value of an output, or of a derivative of it, is from its spline.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// The output's name.
    pub name: String,
    /// Which derivative by time.
    pub derivative: usize,
    /// At no time of the tube more than this, in `unit` (by the second, for derivatives).
    pub most: f64,
    /// The same at the end of the phase; none where the tube does not reach it.
    pub at_end: Option<f64>,
    /// The true value less the spline, over time.
    pub bands: Vec<Band>,
    /// The output's unit.
    pub unit: Unit,
}

/// The tube of a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// The path of the phase; empty where it has no name.
    pub phase: String,
    /// Every component of the state, as far as the tube reaches.
    pub states: Vec<State>,
    /// How it ends.
    pub ending: Ending,
}

/// The tube around a trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct Tube {
    /// One for each phase.
    pub phases: Vec<Stretch>,
    /// What time is called and shown in.
    pub independent: Independent,
    /// How many boxes of time it has.
    pub boxes: usize,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// For every phase whose tube reaches its end, what proves it again.
    pub evidence: Vec<Evidence>,
}

impl Tube {
    /// Whether every phase with equations of motion has a tube to its end.
    pub fn is_whole(&self) -> bool {
        self.phases.iter().all(|stretch| stretch.ending == Ending::Whole || stretch.is_flat())
    }
}

/// The words for a phase without equations of motion.
const FLAT: &str = "it has no equation of motion that holds at points only";

impl Stretch {
    /// Whether the phase has no equations of motion: its splines are the true trajectory.
    pub fn is_flat(&self) -> bool {
        self.ending == Ending::None(FLAT.to_owned())
    }
}

/// The difference of a component of a phase's state at its end, in SI units of mission time.
#[derive(Clone, Debug)]
struct Handed {
    output: String,
    derivative: usize,
    by: Interval,
    /// Its number among the components of all tubes that reach their ends.
    number: usize,
}

/// Boxes of time in order, with what is known of each.
type Steps = Vec<(Window, Step)>;

/// Encloses the true state around the splines of a certificate, which is that of this solution.
pub fn tube(certificate: &Certificate, solution: &Solution) -> Tube {
    let began = Instant::now();
    let mut machine = Machine::new(&certificate.statement);
    machine.integrals = certificate.integrals.iter().map(|(value, _)| *value).collect();
    let before = predecessors(solution);
    let (mut handed, mut phases, mut boxes): (Vec<Option<Vec<Handed>>>, Vec<Stretch>, usize) = (vec![], vec![], 0);
    let mut evidence: Vec<Evidence> = vec![];
    for (phase, before) in before.iter().enumerate() {
        let of = Phase { machine: &machine, certificate, solution, phase };
        // What follows a phase without a tube has no state to begin with.
        let begin = before.map_or(Some(vec![]), |before| handed.get(before).cloned().flatten());
        let (stretch, ends, own) = of.stretch(begin, &mut evidence);
        boxes += own;
        handed.push(ends);
        phases.push(stretch);
    }
    let independent = solution.structure().independent.clone();
    Tube { phases, independent, boxes, seconds: began.elapsed().as_secs_f64(), evidence }
}

/// The phase that each one follows, by number. An agent's phases are numbered one after the other.
fn predecessors(solution: &Solution) -> Vec<Option<usize>> {
    let structure = solution.structure();
    let mut found: Vec<Option<usize>> = (0..solution.phases().len()).map(|phase| phase.checked_sub(1)).collect();
    for (phase, own) in structure.phases.iter().enumerate().filter(|(_, own)| own.after.is_none()) {
        let members = structure.agents[own.agent].family.map_or(vec![None], |family| {
            (family.first..=family.last).map(|index| Some(Affine::constant(index))).collect()
        });
        for agent in members {
            let index = own.family.map(|family| Affine::constant(family.first));
            if let Ok(first) = solution.phase_index(&PhaseRef { phase, agent, index }, &[]) {
                found[first] = None;
            }
        }
    }
    found
}

struct Phase<'a> {
    machine: &'a Machine<'a>,
    certificate: &'a Certificate,
    solution: &'a Solution,
    phase: usize,
}

/// How often a cell is halved at most.
const MOST_HALVINGS: u32 = 10;

/// A component that stays below this part of its unit is compared with that part.
const LEAST_SIZE: f64 = 1e-3;

impl Phase<'_> {
    /// The tube, what it hands to the next phase, and its boxes; with evidence where it reaches the end.
    fn stretch(
        &self,
        begin: Option<Vec<Handed>>,
        evidence: &mut Vec<Evidence>,
    ) -> (Stretch, Option<Vec<Handed>>, usize) {
        let name = self.machine.statement.phases[self.phase].name.clone();
        let none = |words: String| Stretch { phase: name.clone(), states: vec![], ending: Ending::None(words) };
        let system = match System::of(self.machine, self.phase) {
            Ok(Some(system)) => system,
            // Without equations the splines are the true trajectory, as long as they begin where the true state is.
            Ok(None) => return (none(FLAT.to_owned()), begin.filter(Vec::is_empty), 0),
            Err(words) => return (none(words), None, 0),
        };
        let Some(begin) = begin else {
            return (none("the phase before it has no tube to its end".to_owned()), None, 0);
        };
        let flow = Flow { machine: self.machine, system: &system, rule: Rule::new(), scales: self.scales(&system) };
        let (steps, trouble) = self.follow(&flow, &begin);
        let states = self.states(&system, &steps, trouble.is_none());
        let boxes = steps.len();
        let (ending, ends) = match trouble {
            None => {
                let known = evidence.iter().map(|own| own.components.len()).sum();
                let handed = steps.last().map(|(_, step)| self.handed(&system, step, known));
                evidence.push(self.evidence(&system, steps, &begin));
                (Ending::Whole, handed)
            }
            Some((window, trouble)) => {
                let part = window.part as f64 * 0.5_f64.powi(window.halvings as i32);
                (Ending::At(self.shown(window.cell, part), trouble.words().to_owned()), None)
            }
        };
        (Stretch { phase: name, states, ending }, ends, boxes)
    }

    /// Steps from box to box, halving where one fails, to the end or to a box that cannot be halved any more.
    fn follow(&self, flow: &Flow<'_>, begin: &[Handed]) -> (Steps, Option<(Window, Trouble)>) {
        let phase = &self.machine.statement.phases[self.phase];
        let mut steps: Steps = vec![];
        let mut front = None;
        for number in phase.cells() {
            let mut waiting = vec![self.window(flow.system, number)];
            while let Some(window) = waiting.pop() {
                let from = front.get_or_insert_with(|| self.front(flow, &window, begin));
                match flow.step(&window, from, window.halvings == MOST_HALVINGS) {
                    Ok(step) => {
                        front = Some(step.front.clone());
                        steps.push((window, step));
                    }
                    Err(_) if window.halvings < MOST_HALVINGS => {
                        let [first, second] = window.halves();
                        waiting.extend([second, first]);
                    }
                    Err(trouble) => return (steps, Some((window, trouble))),
                }
            }
        }
        (steps, None)
    }

    /// A cell with the splines on it.
    fn window(&self, system: &System, number: usize) -> Window {
        let statement = self.machine.statement;
        let cuts = &statement.phases[self.phase].cuts;
        let (low, high) = (Interval::point(cuts[number]), Interval::point(cuts[number + 1]));
        let piece = |spline, derivative| cell(statement, Flat { spline, derivative }, number);
        Window {
            cell: number,
            halvings: 0,
            part: 0,
            tau: Piece::line(low, high),
            length: high - low,
            inputs: system.inputs.iter().map(|flat| cell(statement, statement.flats[*flat], number)).collect(),
            components: system.components().map(|(unknown, k)| piece(unknown.spline, k)).collect(),
            highest: system.unknowns.iter().map(|unknown| piece(unknown.spline, unknown.order)).collect(),
        }
    }

    /// Where the phase begins: where its splines begin, and what is handed to it.
    fn front(&self, flow: &Flow<'_>, first: &Window, begin: &[Handed]) -> Front {
        let mut start = vec![];
        let mut differences = vec![];
        for ((unknown, k), spline) in flow.system.components().zip(&first.components) {
            let handed = self.handed_to((unknown.spline, k), begin);
            let more = handed.map_or(Interval::ZERO, |handed| handed.by * self.seconds(k));
            let exact = spline.first() + more;
            start.push(exact.middle());
            differences.push(exact - Interval::point(exact.middle()));
        }
        Front { start, differences: Turned::upright(flow.scaled(differences.into_iter())) }
    }

    /// What a component begins with.
    fn handed_to<'h>(&self, (spline, derivative): (usize, usize), begin: &'h [Handed]) -> Option<&'h Handed> {
        begin.iter().find(|handed| handed.derivative == derivative && handed.output == self.own_name(spline))
    }

    fn handed(&self, system: &System, step: &Step, known: usize) -> Vec<Handed> {
        let each = system.components().zip(&step.at_end).enumerate();
        each.map(|(c, ((unknown, derivative), by))| {
            let by = by.over(self.seconds(derivative));
            Handed { output: self.own_name(unknown.spline), derivative, by, number: known + c }
        })
        .collect()
    }

    /// A power of the phase's duration: derivatives are by scaled time.
    fn seconds(&self, power: usize) -> Interval {
        let statement = self.machine.statement;
        let duration = statement.numbers[statement.phases[self.phase].duration].value;
        Interval::point(duration).integer_power(power as i32)
    }

    /// The name of an output without the path of its phase.
    fn own_name(&self, spline: usize) -> String {
        let statement = self.machine.statement;
        let (name, path) = (&statement.splines[spline].name, &statement.phases[self.phase].name);
        name.strip_prefix(path.as_str()).map_or(name.as_str(), |rest| rest.trim_start_matches('.')).to_owned()
    }

    /// The sizes of components and highest derivatives over the phase.
    fn scales(&self, system: &System) -> (Vec<f64>, Vec<f64>) {
        let statement = self.machine.statement;
        let size = |spline: usize, derivative: usize| {
            let cells = statement.phases[self.phase].cells();
            let sizes = cells.map(|number| cell(statement, Flat { spline, derivative }, number).hull().size());
            let most = sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
            most.max(LEAST_SIZE * self.unit(spline).factor.abs())
        };
        (
            system.components().map(|(unknown, k)| size(unknown.spline, k)).collect(),
            system.unknowns.iter().map(|unknown| size(unknown.spline, unknown.order)).collect(),
        )
    }

    /// The unit of an output.
    fn unit(&self, spline: usize) -> Unit {
        let name = &self.machine.statement.splines[spline].name;
        self.solution.output(name).map_or(Unit { symbol: String::new(), factor: 1.0 }, |output| output.unit().clone())
    }

    fn states(&self, system: &System, steps: &[(Window, Step)], is_whole: bool) -> Vec<State> {
        let splines = &self.machine.statement.splines;
        let each = system.components().enumerate();
        each.map(|(c, (unknown, derivative))| {
            let unit = self.unit(unknown.spline);
            let by = self.seconds(derivative) * Interval::point(unit.factor);
            let band = |(window, step): &(Window, Step)| {
                let length = 0.5_f64.powi(window.halvings as i32);
                let part = window.part as f64 * length;
                let values = step.over[c].over(by);
                let (from, to) = (self.shown(window.cell, part), self.shown(window.cell, part + length));
                Band { from, to, low: values.low(), high: values.high() }
            };
            let bands: Vec<Band> = steps.iter().map(band).collect();
            let most = bands.iter().fold(0.0, |most: f64, band| most.max(band.high).max(-band.low));
            let at_end = steps.last().filter(|_| is_whole).map(|(_, step)| step.at_end[c].over(by).size());
            State { name: splines[unknown.spline].name.clone(), derivative, most, at_end, bands, unit }
        })
        .collect()
    }

    fn shown(&self, cell: usize, part: f64) -> f64 {
        self.solution.structure().independent.shown(self.certificate.time(self.phase, cell, part))
    }
}
