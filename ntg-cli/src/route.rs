//! `--route "x, y: -100, -100; -100, -15; 5, -15 [km]"`: a coarse route as the first guess.

use ntg_interp::Interpreted;
use ntg_runtime::guess::Guess;
use ntg_runtime::problem::Problem;
use ntg_runtime::structure::{Structure, Unit};

use crate::runs;

/// What is wrong, and what is right.
const FORM: &str = "write OUTPUTS: POINT; POINT, such as `x, y: -100, -100; -100, -15; 5, -15 [km]`";

/// Adds a route to a guess. Numbers are in the outputs' declared units; a unit after the last
/// number holds for all numbers that have none of their own.
pub(crate) fn add(guess: Guess, problem: &Interpreted, route: &str) -> Result<Guess, String> {
    let say = |message: String| format!("--route {route}: {message}");
    let (names, points) = route.split_once(':').ok_or_else(|| say(FORM.to_owned()))?;
    let names = runs::names(names);
    let structure = problem.structure();
    let units: Vec<Unit> = names.iter().map(|name| unit(&structure, name)).collect::<Result<_, _>>().map_err(say)?;
    let points: Vec<&str> = points.split(';').map(str::trim).filter(|point| !point.is_empty()).collect();
    if points.len() < 2 {
        return Err(say(format!("a route has two points at least; {FORM}")));
    }
    let shared = points.last().and_then(|last| last.rfind('[').map(|at| &last[at..])).unwrap_or("");
    let read = |point: &&str| {
        let cells: Vec<&str> = point.split(',').map(str::trim).collect();
        if cells.len() != units.len() {
            return Err(format!("`{point}` has {} numbers for {} outputs; {FORM}", cells.len(), units.len()));
        }
        cells.iter().zip(&units).map(|(cell, unit)| number(cell, shared, unit)).collect::<Result<Vec<f64>, String>>()
    };
    let points = points.iter().map(read).collect::<Result<_, _>>().map_err(say)?;
    Ok(guess.polygon(names, points))
}

/// The declared unit of an output, with or without the path of its agent and its index.
fn unit(structure: &Structure, name: &str) -> Result<Unit, String> {
    let last = name.rsplit('.').next().unwrap_or(name);
    let base = last.split('[').next().unwrap_or(last);
    let mut outputs = structure.phases.iter().flat_map(|phase| &phase.outputs);
    if let Some(output) = outputs.find(|output| output.name == base) {
        return Ok(output.unit.clone());
    }
    let mut known: Vec<&str> = vec![];
    for output in structure.phases.iter().flat_map(|phase| &phase.outputs) {
        if !output.is_helper() && !known.contains(&output.name.as_str()) {
            known.push(&output.name);
        }
    }
    Err(format!("there is no output `{name}`; the outputs are: `{}`", known.join("`, `")))
}

/// One number, in the declared unit.
fn number(cell: &str, shared: &str, unit: &Unit) -> Result<f64, String> {
    let text = if cell.contains('[') { cell.to_owned() } else { format!("{cell} {shared}") };
    match ntg_interp::quantity(&text, unit)?[..] {
        [value] => Ok(unit.typed(value)),
        _ => Err(format!("`{cell}` is not one number; {FORM}")),
    }
}
