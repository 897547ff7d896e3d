//! Coarse knots first: where the intervals are many, a solution on fewer of them is the start
//! (docs/maths.md, section 11.10).
//!
//! A rough guess (a polygon with corners) asks more of a method the finer the knots are, since corners
//! are sharper there. On few knots it is mended cheaply, and each finer level begins near its solution.

use super::budget::Budget;
use super::session::{FirstPoint, Session, Task, solution};
use crate::guess::{Guess, start};
use crate::solution::Solution;
use crate::transcribe::SetupError;
use ntg_nlp::Start;
use ntg_structure::{Points, Structure};

/// Up to so many intervals a problem is solved at once. This number and those below are fits to random routes of the
/// flight B1.
const FEW: usize = 24;
/// Up to so many intervals, small steps between the levels are cheap.
const SOME: usize = 32;

/// The levels on the way to fine knots.
#[derive(Clone, Copy, Debug)]
struct Levels {
    /// Up to so many intervals a coarser level is solved at once.
    few: usize,
    /// How many times more intervals the next level has.
    finer: usize,
}

/// Of minima that differ by little, small steps lead to the better one: nearly every random route of B1 with 32
/// intervals ends at the best minimum, where large steps lead most of them to one that is 1e-5 above it.
const SMALL: Levels = Levels { few: 12, finer: 2 };
const LARGE: Levels = Levels { few: FEW, finer: 4 };
/// With as few intervals as this, there is nothing coarser.
const FEWEST: usize = 2;

impl Session {
    /// A start near a solution of `structure`, found on coarser knots; none where the knots are few, the
    /// guess is a solution already, or the coarser problem has no solution. The coarser problem is kept for the next
    /// time.
    pub(super) fn start_from_coarse(
        &mut self,
        task: Task<'_>,
        structure: &Structure,
        budget: &mut Budget<'_>,
    ) -> Result<Option<Solution>, SetupError> {
        let most = intervals(structure);
        if most <= FEW {
            return Ok(None);
        }
        let levels = if most <= SOME { SMALL } else { LARGE };
        self.start_from_coarser(task, structure, levels, budget)
    }

    /// As [`Session::start_from_coarse`], on known levels.
    fn start_from_coarser(
        &mut self,
        task: Task<'_>,
        structure: &Structure,
        levels: Levels,
        budget: &mut Budget<'_>,
    ) -> Result<Option<Solution>, SetupError> {
        let most = intervals(structure);
        if most <= levels.few || task.guess.is_some_and(Guess::is_near) {
            return Ok(None);
        }
        let coarse = coarsened(structure, most.div_ceil(levels.finer));
        self.coarser.get_or_insert_default().rough_solution(task, &coarse, levels, budget)
    }

    /// A solution to a rough tolerance, to start from, on the mesh of `structure`.
    fn rough_solution(
        &mut self,
        task: Task<'_>,
        structure: &Structure,
        levels: Levels,
        budget: &mut Budget<'_>,
    ) -> Result<Option<Solution>, SetupError> {
        let earlier = self.start_from_coarser(task, structure, levels, budget)?;
        let Some(settings) = budget.coarse() else { return Ok(None) };
        let mut nlp = self.program(task.problem, structure)?;
        let (x, from) = match &earlier {
            Some(solution) => (start(&nlp, Some(&Guess::from(solution)))?, Start::Near),
            None => (start(&nlp, task.guess)?, Start::Cold),
        };
        match from {
            Start::Near => {
                let guess = start(&nlp, task.guess)?;
                nlp.set_scales_near(&x, &guess, &settings)?;
            }
            _ => nlp.set_scales(&x, &settings)?,
        }
        let outcome = self.solve_once(&nlp, FirstPoint { x: &x, from }, &settings);
        budget.spend(outcome.iterations);
        let solution = outcome.status.has_solution().then(|| solution(&nlp, outcome));
        self.kept = Some(nlp.keep());
        Ok(solution)
    }
}

/// A start near a solution of `structure` where no method came to one from the guess: from fewer and fewer
/// knots, on which a guess with loops and corners becomes a smooth curve.
pub(super) fn start_from_fewer(
    task: Task<'_>,
    structure: &Structure,
    budget: &mut Budget<'_>,
) -> Result<Option<Solution>, SetupError> {
    let mut most = intervals(structure);
    while most > FEWEST {
        most = most.div_ceil(2);
        let coarse = coarsened(structure, most);
        let found = Session::default().rough_solution(task, &coarse, LARGE, budget)?;
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

/// The most intervals of any output.
fn intervals(structure: &Structure) -> usize {
    let outputs = structure.phases.iter().flat_map(|phase| &phase.outputs);
    outputs.map(|output| output.spline.breakpoints.len() - 1).max().unwrap_or(0)
}

/// The same problem with at most `most` intervals, on breakpoints that it has already.
fn coarsened(structure: &Structure, most: usize) -> Structure {
    let mut coarse = structure.clone();
    for phase in &mut coarse.phases {
        let before = phase.outputs.iter().map(|o| o.spline.breakpoints.len() - 1).max().unwrap_or(1);
        for output in &mut phase.outputs {
            let breakpoints = &mut output.spline.breakpoints;
            let count = breakpoints.len() - 1;
            let stride = count.div_ceil(most.max(1));
            let kept = (0..count).step_by(stride).chain([count]).map(|i| breakpoints[i]);
            *breakpoints = kept.collect();
        }
        let after = phase.outputs.iter().map(|o| o.spline.breakpoints.len() - 1).max().unwrap_or(1);
        for points in &mut phase.points {
            if let Points::Uniform { points } = points {
                *points = ((*points - 1) * after).div_ceil(before) + 1;
            }
        }
    }
    coarse
}

#[cfg(test)]
mod tests {
    use super::*;
    use ntg_structure::{Output, Phase, Spline, Unit};

    fn phase(intervals: usize, points: usize) -> Phase {
        let breakpoints = (0..=intervals).map(|i| i as f64 / intervals as f64).collect();
        let spline = Spline { order: 5, smoothness: 3, breakpoints };
        let output =
            Output { name: "x".into(), doc: String::new(), unit: Unit::default(), family: None, vector: None, spline };
        Phase {
            name: None,
            agent: 0,
            family: None,
            after: None,
            duration: ntg_structure::Duration::Fixed(ntg_structure::Call::default()),
            duration_name: None,
            outputs: vec![output],
            points: vec![Points::Uniform { points }, Points::Breakpoints],
            place: ntg_structure::Place::default(),
        }
    }

    #[test]
    fn coarse_breakpoints_are_some_of_the_fine_ones_with_both_ends() {
        let structure = Structure { phases: vec![phase(100, 501), phase(3, 16)], ..Structure::default() };
        let coarse = coarsened(&structure, 25);
        let kept = &coarse.phases[0].outputs[0].spline.breakpoints;
        assert_eq!(kept.len(), 26);
        assert_eq!((kept[0], kept[1], kept[25]), (0.0, 0.04, 1.0));
        assert_eq!(coarse.phases[0].points[0], Points::Uniform { points: 126 });
        assert_eq!(coarse.phases[1], structure.phases[1], "few intervals stay");
    }
}
