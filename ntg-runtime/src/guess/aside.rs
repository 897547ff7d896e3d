//! A guess through a place at which an equation between states has no slope is moved aside (docs/maths.md, section 8.5).
//!
//! A pendulum that swings up is guessed on the straight line from the bottom to the top, through its pivot: `x^2 + y^2 == 1` tells
//! nothing there. Takes the equations that hold along whole phases between values of outputs, and which outputs nobody guesses;
//! bends one of these to the side, by as much as the equation asks for where its slope is least.

use super::equations::is_equation_along;
use super::start::{Curve, apply, pointwise};
use crate::transcribe::elements::GroupBatch;
use crate::transcribe::layout::Layout;
use crate::transcribe::rows::RowKind;
use crate::transcribe::slots::Source;
use crate::transcribe::{Quantity, SetupError, Transcription, Workspace};
use nalgebra::DVector;
use ntg_nlp::{Evaluation, Nlp};
use ntg_structure::Degree;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::f64::consts::PI;

/// A slope of less than this part of the largest one along the guess is next to none. A choice: the straight line between two places
/// on a circle passes its centre as near as this where they are apart by 168 degrees.
const NONE: f64 = 0.1;
/// Steps of the iteration for the bend, each exact for parabolas.
const STEPS: usize = 8;
/// Bodies that hang on each other, one by one. A choice.
const SWEEPS: usize = 8;

/// Bends outputs that nobody guesses to the side where an equation would have next to no slope.
pub(super) fn bend(nlp: &Transcription, guessed: &[Curve], x: &mut [f64]) -> Result<(), SetupError> {
    let candidates = candidates(nlp);
    if !candidates.iter().flatten().any(|is_one| *is_one) {
        return Ok(());
    }
    let mut chains = Chains::new(nlp, guessed);
    let equations = equations(nlp, &candidates, &chains);
    equations.values().flat_map(|places| chains_of(places)).for_each(|chain| chains.all[chain].equations += 1);
    let mut program = Program::new(nlp);
    // A body that hangs on another one moves to the side with it, and then by its own length.
    for _ in 0..SWEEPS {
        let (mut bent, mut moves) = (BTreeSet::new(), vec![0.0; x.len()]);
        for places in equations.values() {
            let Some((chain, way)) = program.aside(places, (&chains, &bent), x)? else { continue };
            bent.insert(chain);
            moves.iter_mut().zip(way).for_each(|(sum, way)| *sum += way);
        }
        if bent.is_empty() {
            break;
        }
        x.iter_mut().zip(moves).for_each(|(x, way)| *x += way);
    }
    Ok(())
}

/// One row of an equation.
struct Place {
    phase: usize,
    tau: f64,
    row: usize,
    /// The entries of its gradient in the Jacobian of its block, each with the chain of the output.
    slots: Vec<(usize, usize)>,
}

/// By block and function, whether it is an equation between values of outputs alone along whole phases that is not linear.
fn candidates(nlp: &Transcription) -> Vec<Vec<bool>> {
    let structure = &nlp.model.structure;
    let is_one = |(group, block): (&GroupBatch, &ntg_nlp::Block), function: usize| {
        let declared = &structure.groups[group.group];
        let sources = group.batch.sources();
        let is_value = |slot: usize| matches!(sources.get(slot), Some(Source::Flat { derivative: 0, .. }));
        let mut slots = block.jacobian.iter().filter(|(of, _)| *of == function).map(|(_, slot)| *slot);
        is_equation_along(structure, declared, function)
            && group.degree[function] > Degree::Linear
            && slots.all(is_value)
    };
    let pairs = nlp.elements.batches.iter().zip(&nlp.elements.blocks);
    pairs.map(|pair| (0..pair.1.rows).map(|function| is_one(pair, function)).collect()).collect()
}

/// These equations: by constraint, indices and agent their rows in order of time.
fn equations(
    nlp: &Transcription,
    candidates: &[Vec<bool>],
    chains: &Chains,
) -> BTreeMap<(usize, Vec<i64>, usize), Vec<Place>> {
    let layout = &nlp.model.layout;
    let mut found: BTreeMap<_, Vec<Place>> = BTreeMap::new();
    for (row, info) in nlp.elements.rows.iter().enumerate() {
        let (RowKind::Constraint(constraint), Some(phase)) = (info.kind, info.point.phase) else { continue };
        let (number, element, function) = info.maker;
        if !candidates.get(number).is_some_and(|own| own[function]) {
            continue;
        }
        let block = &nlp.elements.blocks[number];
        let variables = block.variables(element);
        let own = block.jacobian.iter().enumerate().filter(|(_, (of, _))| *of == function);
        let slots = own.map(|(entry, (_, slot))| {
            let map = &block.map(element)[slot * variables.len()..][..variables.len()];
            let (variable, _) = variables.iter().zip(map).find(|(_, c)| **c != 0.0)?;
            Some((entry, *chains.owner.get(variable)?))
        });
        if let Some(slots) = slots.collect() {
            let key = (constraint, info.indices.clone(), layout.phases[phase].agent);
            found.entry(key).or_default().push(Place { phase, tau: info.point.tau, row, slots });
        }
    }
    let by_time = |one: &Place, other: &Place| one.phase.cmp(&other.phase).then(one.tau.total_cmp(&other.tau));
    found.values_mut().for_each(|places| places.sort_by(by_time));
    found
}

/// One output in all phases of its agent.
struct Chain<'a> {
    output: Quantity<'a>,
    is_guessed: bool,
    /// How many equations between values of outputs depend on it.
    equations: usize,
}

impl Chain<'_> {
    /// The coefficients of a half wave over the whole time of the agent.
    fn bend(&self, layout: &Layout) -> Result<Vec<f64>, SetupError> {
        let mut direction = vec![0.0; layout.variables];
        let function = pointwise(|part| Ok((PI * part).sin()));
        let curve = |&(phase, output)| Curve { phase, output, whole: true, function: function.clone() };
        apply(layout, &Vec::from_iter(self.output.members.iter().map(curve)), &mut direction)?;
        Ok(direction)
    }
}

/// The outputs of all agents.
struct Chains<'a> {
    all: Vec<Chain<'a>>,
    /// The chain of a coefficient.
    owner: HashMap<u32, usize>, // Looked up, never iterated.
}

impl<'a> Chains<'a> {
    fn new(nlp: &'a Transcription, guessed: &[Curve]) -> Self {
        let guessed: BTreeSet<_> = guessed.iter().map(|curve| (curve.phase, curve.output)).collect();
        let mut chains = Self { all: vec![], owner: HashMap::new() };
        let agents = nlp.model.layout.agents.iter();
        for output in agents.flat_map(|agent| nlp.outputs_of(agent.phases.clone())) {
            for variable in &output.coefficients {
                chains.owner.entry(*variable).or_insert(chains.all.len());
            }
            let is_guessed = output.members.iter().any(|member| guessed.contains(member));
            chains.all.push(Chain { output, is_guessed, equations: 0 });
        }
        chains
    }

    /// The chains of an equation, each with the largest value that is guessed of those of its unit, or its unit where that is 0.
    fn sizes(&self, places: &[Place], x: &[f64]) -> BTreeMap<usize, f64> {
        let unit = |chain: usize| self.all[chain].output.unit;
        let largest = |chain: usize| {
            let coefficients = self.all[chain].output.coefficients.iter();
            coefficients.fold(0.0_f64, |most, variable| most.max(x[*variable as usize].abs()))
        };
        let own: BTreeMap<usize, f64> = chains_of(places).into_iter().map(|chain| (chain, largest(chain))).collect();
        let size = |chain: usize| {
            let alike = own.iter().filter(|(other, _)| unit(**other) == unit(chain));
            let most = alike.fold(0.0_f64, |most, (_, size)| most.max(*size));
            if most > 0.0 { most } else { unit(chain).factor }
        };
        own.keys().map(|chain| (*chain, size(*chain))).collect()
    }
}

/// How steep an equation is along a guess.
struct Standing {
    /// The least slope as a part of the largest one.
    least: f64,
    /// The place that is nearest to it.
    at: usize,
}

/// Evaluations of the program.
struct Program<'a> {
    nlp: &'a Transcription<'a>,
    work: Workspace,
    at: Evaluation,
    no_multipliers: Vec<f64>,
}

impl<'a> Program<'a> {
    fn new(nlp: &'a Transcription<'a>) -> Self {
        let (work, at) = nlp.workspace();
        Self { nlp, work, at, no_multipliers: vec![0.0; nlp.rows()] }
    }

    /// Which output that is not bent yet goes to the side, and by how much, where an equation has next to no slope; none where it
    /// has one, or where nothing gives it one.
    fn aside(
        &mut self,
        places: &[Place],
        (chains, bent): (&Chains, &BTreeSet<usize>),
        x: &[f64],
    ) -> Result<Option<(usize, Vec<f64>)>, SetupError> {
        let sizes = chains.sizes(places, x);
        let Some(singular) = self.standing(places, &sizes, x).filter(|standing| standing.least < NONE) else {
            return Ok(None);
        };
        let (mut most, mut best) = (NONE, None);
        // What fewer equations depend on first: the end of a chain of bodies, not its middle.
        let mut open = Vec::from_iter(sizes.keys().copied().filter(|chain| !chains.all[*chain].is_guessed));
        open.retain(|chain| !bent.contains(chain));
        open.sort_by_key(|chain| chains.all[*chain].equations);
        for chain in open {
            let direction = chains.all[chain].bend(&self.nlp.model.layout)?;
            let Some(by) = self.root(places[singular.at].row, (&direction, sizes[&chain]), x) else { continue };
            let way = Vec::from_iter(direction.iter().map(|way| by * way));
            let Some(standing) = self.standing(places, &sizes, &sum(x, &way)) else { continue };
            // Of outputs that are as good the first one is taken, whatever rounding says.
            if standing.least > most * (1.0 + NONE) {
                (most, best) = (standing.least, Some((chain, way)));
            }
        }
        Ok(best)
    }

    /// How steep an equation is, by sizes of its outputs, at its places and between them; none where it is flat everywhere.
    fn standing(&mut self, places: &[Place], sizes: &BTreeMap<usize, f64>, x: &[f64]) -> Option<Standing> {
        // Where the program is not finite elsewhere this is an error, after everything is written.
        let _ = self.nlp.derivatives(x, 0.0, &self.no_multipliers, &mut self.work, &mut self.at);
        let slopes = Vec::from_iter(places.iter().map(|place| self.slopes(place, sizes)));
        let largest = slopes.iter().fold(0.0_f64, |most, slopes| most.max(slopes.norm()));
        let mut least = Standing { least: f64::INFINITY, at: 0 };
        for (at, own) in slopes.iter().enumerate() {
            let next = places.get(at + 1).filter(|next| next.phase == places[at].phase).map(|_| &slopes[at + 1]);
            let (slope, part) = next.map_or((own.norm(), 0.0), |next| least_between(own, next));
            if slope < least.least {
                least = Standing { least: slope, at: if part > 0.5 { at + 1 } else { at } };
            }
        }
        (largest > 0.0).then_some(Standing { least: least.least / largest, ..least })
    }

    /// The gradient of a row by its outputs, times their sizes; 0 where it is not finite, as that of a norm at 0.
    fn slopes(&self, place: &Place, sizes: &BTreeMap<usize, f64>) -> DVector<f64> {
        let (number, element, _) = self.nlp.elements.rows[place.row].maker;
        let (jacobian, elements) = (&self.at.blocks[number].jacobian, self.nlp.elements.blocks[number].elements);
        let entries = |chain: usize| place.slots.iter().filter(move |(_, of)| *of == chain);
        let slope = |(chain, size): (&usize, &f64)| {
            size * entries(*chain).map(|(entry, _)| jacobian[entry * elements + element]).sum::<f64>()
        };
        let slopes = DVector::from_iterator(sizes.len(), sizes.iter().map(slope));
        if slopes.iter().all(|slope| slope.is_finite()) { slopes } else { DVector::zeros(sizes.len()) }
    }

    /// How far to go along a direction until a row holds, on the side to which what is missed falls more steeply; none where it does
    /// not fall.
    fn root(&mut self, row: usize, (direction, size): (&[f64], f64), x: &[f64]) -> Option<f64> {
        let first = self.missed(row, x).filter(|first| *first != 0.0)?;
        let mut fall = |by: f64| {
            let way = Vec::from_iter(direction.iter().map(|way| by * way));
            Some(1.0 - self.missed(row, &sum(x, &way))? / first)
        };
        let (up, down) = (fall(size)?, fall(-size)?);
        let mut by = if down > up * (1.0 + NONE) { -size } else { size };
        for _ in 0..STEPS {
            let part = fall(by).filter(|part| *part > 0.0)?;
            by /= part.sqrt();
        }
        by.is_finite().then_some(by)
    }

    /// By how much an equation is missed.
    fn missed(&mut self, row: usize, x: &[f64]) -> Option<f64> {
        let _ = self.nlp.values(x, &mut self.work, &mut self.at);
        let (number, element, function) = self.nlp.elements.rows[row].maker;
        let block = &self.nlp.elements.blocks[number];
        let lane = function * block.elements + element;
        let missed = block.weight[lane] * self.at.blocks[number].values[lane] - self.nlp.limits.row_lower[row];
        missed.is_finite().then_some(missed)
    }
}

/// The chains of an equation.
fn chains_of(places: &[Place]) -> BTreeSet<usize> {
    places.iter().flat_map(|place| place.slots.iter().map(|(_, chain)| *chain)).collect()
}

fn sum(x: &[f64], way: &[f64]) -> Vec<f64> {
    x.iter().zip(way).map(|(x, way)| x + way).collect()
}

/// The least norm on the straight line from one vector to another, and where it is.
fn least_between(one: &DVector<f64>, other: &DVector<f64>) -> (f64, f64) {
    let way = other - one;
    let square = way.norm_squared();
    let part = if square > 0.0 { (-one.dot(&way) / square).clamp(0.0, 1.0) } else { 0.0 };
    ((one + way * part).norm(), part)
}
