//! A coarse search over the plane, for the global shape of a route (docs/maths.md, section 12.3).
//!
//! ```text
//! vehicle, guess -> Grid -> Speeds -> Prices (the spec's own functions on every move) -> cheapest path -> start
//! ```
//!
//! Moves are straight; a state is a cell, a heading and a phase. What a move costs is the spec's
//! own integrand, and its own trajectory constraints as penalties, evaluated by the problem's
//! kernels. Durations come from the path that is found, and the search is repeated with them. A
//! third coordinate stays as it is guessed.

mod grid;
mod path;
mod poses;
mod prices;
mod rates;

use super::vehicles::Vehicle;
use crate::guess::{Curve, apply, finish, pointwise, set};
use crate::transcribe::{SetupError, Transcription};
use grid::Grid;
use path::Path;
use poses::Poses;
use prices::Prices;
use std::rc::Rc;

/// Searches for the first route: its length decides the durations, and these the next one.
const ROUNDS: usize = 2;

/// A vehicle with what moves cost it, and the paths that are known.
struct Task<'a> {
    vehicle: &'a Vehicle,
    grid: Grid,
    prices: Prices,
    known: Vec<Path>,
}

/// At most `count` starts, the cheapest route first, each turned away from those before it.
pub(super) fn routes(
    nlp: &Transcription,
    vehicles: &[Vehicle],
    guess: &[f64],
    count: usize,
) -> Result<Vec<Vec<f64>>, SetupError> {
    if count == 0 {
        return Ok(vec![]);
    }
    let (mut tasks, mut x) = (vec![], guess.to_vec());
    for vehicle in vehicles {
        tasks.extend(first(nlp, vehicle, &mut x)?);
    }
    if tasks.is_empty() {
        return Ok(vec![]);
    }
    let mut starts = vec![finish(nlp, x.clone())?];
    while starts.len() < count {
        let mut fresh = false;
        for task in &mut tasks {
            let Some(path) = path::cheapest(&task.grid, &task.prices, &task.known) else { continue };
            fresh |= !task.known.iter().any(|other| other.same(&path));
            follow(nlp, task.vehicle, &path, &mut x)?;
            task.known.push(path);
        }
        if !fresh {
            break;
        }
        starts.push(finish(nlp, x.clone())?);
    }
    Ok(starts)
}

/// The first path of one vehicle, which is put with its durations into `x`; none where there is none,
/// or where straight moves cannot nearly meet the constraints.
fn first<'a>(nlp: &Transcription, vehicle: &'a Vehicle, x: &mut [f64]) -> Result<Option<Task<'a>>, SetupError> {
    let Some(grid) = Grid::new(nlp, vehicle, x) else { return Ok(None) };
    let poses = Poses::moves(&grid);
    let mut task = None;
    for _ in 0..ROUNDS {
        if !prices::settle(nlp, vehicle, &grid, x)? {
            return Ok(None);
        }
        let prices = Prices::new(nlp, vehicle, (&grid, &poses), x)?;
        let Some(path) = path::cheapest(&grid, &prices, &[]) else { break };
        follow(nlp, vehicle, &path, x)?;
        task = Some(Task { vehicle, grid: grid.clone(), prices, known: vec![path] });
    }
    Ok(task)
}

/// Durations and curves of a path.
fn follow(nlp: &Transcription, vehicle: &Vehicle, path: &Path, x: &mut [f64]) -> Result<(), SetupError> {
    let layout = &nlp.model.layout;
    let phases = layout.agents[vehicle.agent].phases.clone();
    for (phase, seconds) in phases.clone().zip(&path.durations) {
        set(layout.phases[phase].duration, *seconds, x);
    }
    let mut curves = vec![];
    for (number, phase) in phases.enumerate() {
        for (axis, output) in vehicle.members[number].iter().enumerate().take(grid::AXES) {
            let leg = Rc::new(path.legs[number].clone());
            let function = pointwise(move |tau| Ok(leg.at(axis, tau)));
            curves.push(Curve { phase, output: *output, whole: false, function });
        }
    }
    apply(layout, &curves, x)
}
