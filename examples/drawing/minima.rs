//! Pictures of the local minima of one problem: a track for each, the best one broad and on top.

use std::path::Path;

use ntg::prelude::Minima;
use plotters::coord::types::RangedCoordf64;

use super::chart::{Axes, Chart, Line, Stroke, axes, draw, legend};
use super::heat::{Scale, bar, fill};
use super::track::Track;
use super::{BLUE, Drawn, GREEN, PURPLE, RGBColor, VERMILION, picture};

/// Looks of the minima after the best one, taken in turn.
const OTHERS: [(RGBColor, Stroke); 6] = [
    (VERMILION, Stroke::Dashed),
    (PURPLE, Stroke::Solid),
    (GREEN, Stroke::Dashed),
    (VERMILION, Stroke::Solid),
    (PURPLE, Stroke::Dashed),
    (GREEN, Stroke::Solid),
];

/// A function of the plane.
pub(crate) type Value = fn(f64, f64) -> f64;

/// What a picture of minima says, where it is drawn, over which map.
pub(crate) struct Scene<'a> {
    pub(crate) title: &'a str,
    pub(crate) sentence: &'a str,
    pub(crate) axes: Axes<'a>,
    pub(crate) height: u32,
    /// A function of the plane as a coloured background, with its scale.
    pub(crate) map: Option<(Scale, Value)>,
}

/// The tracks of all minima; `landmarks` draws what else one should see.
pub(crate) fn tracks<S>(
    path: &Path,
    scene: Scene<'_>,
    minima: &Minima<S>,
    track: impl Fn(&S) -> Track,
    landmarks: impl Fn(&mut Chart<'_, RangedCoordf64>) -> Drawn,
) -> Drawn {
    let lines = lines(minima, track);
    let mut area = legend(&picture(path, scene.height, scene.title, scene.sentence)?, &lines)?;
    if let Some((scale, _)) = &scene.map {
        area = bar(&area, scale)?;
    }
    let mut chart = axes(&area, scene.axes)?;
    if let Some((scale, of)) = &scene.map {
        fill(&mut chart, scale, of)?;
    }
    let (best, others) = lines.split_first().ok_or("no start was solved")?;
    // The best of the others lies uppermost of them.
    let others: Vec<Line> = others.iter().rev().cloned().collect();
    draw(&mut chart, &others)?;
    draw(&mut chart, &[Line { stroke: Stroke::Broad, ..best.clone() }, best.clone()])?;
    landmarks(&mut chart)
}

/// A line for each minimum, the best first, named by its objective and by how many starts led to it.
fn lines<S>(minima: &Minima<S>, track: impl Fn(&S) -> Track) -> Vec<Line> {
    let looks = std::iter::once((BLUE, Stroke::Solid)).chain(OTHERS.into_iter().cycle());
    let all = minima.solutions.iter().zip(&minima.report.minima).zip(looks);
    all.map(|((solution, minimum), (colour, stroke))| {
        let starts = if minimum.count == 1 { "start" } else { "starts" };
        let name = format!("{:.4} from {} {starts}", minimum.report.objective, minimum.count);
        track(solution).line(&name, colour, stroke)
    })
    .collect()
}
