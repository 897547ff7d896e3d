//! Pictures of missions in phases: a track whose look changes at events, and histories in which the
//! events are marked.

use std::ops::Range;
use std::path::Path;

use ntg::prelude::{Problem, Solution};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::chart::{Axes, Chart, Line, Stroke, axes, draw, legend};
use super::flight::detection;
use super::heat::{bar, fill};
use super::history::{Panel, panels};
use super::radar::detection_over_ground;
use super::track::words;
use super::{Area, Drawn, INK, picture};

/// Points of a history, and of a track from event to event.
const SAMPLES: u32 = 500;

/// An output or a named expression over the whole mission.
pub(crate) fn over_time(solution: &Solution, problem: &dyn Problem, name: &str) -> Drawn<Vec<(f64, f64)>> {
    let times = solution.times(SAMPLES as usize);
    if let Some(output) = solution.output(name) {
        return Ok(times.iter().map(|t| (*t, output.at(*t))).collect());
    }
    let signal = solution.signal(problem, name).ok_or_else(|| format!("nothing is called {name}"))?;
    Ok(times.iter().map(|t| (*t, signal.at(*t))).collect())
}

/// The track of two outputs in pieces, one for each phase; the looks are taken in turn.
pub(crate) fn legs(solution: &Solution, outputs: [&str; 2], looks: &[Line]) -> Drawn<Vec<Line>> {
    let (x, y) = (solution.output(outputs[0]), solution.output(outputs[1]));
    let (x, y) = (x.ok_or("no first output")?, y.ok_or("no second output")?);
    let phases = solution.phases();
    let pieces = phases.iter().zip((0..).zip(looks.iter().cycle())).map(|(phase, (i, look))| {
        let step = (phase.end - phase.start) / f64::from(SAMPLES);
        let times = (0..=SAMPLES).map(|k| phase.start + step * f64::from(k));
        let name = if i < looks.len() { look.name.clone() } else { String::new() };
        Line { name, points: times.map(|t| (x.at(t), y.at(t))).collect(), ..look.clone() }
    });
    Ok(pieces.collect())
}

/// The lines of a legend: those with a name, each name once.
pub(crate) fn key(lines: &[Line]) -> Vec<Line> {
    let mut key: Vec<Line> = vec![];
    for line in lines {
        if !line.name.is_empty() && key.iter().all(|known| known.name != line.name) {
            key.push(line.clone());
        }
    }
    key
}

/// Dots with the times at which phases end, beside a track.
pub(crate) fn events(
    chart: &mut Chart<'_, RangedCoordf64>,
    solution: &Solution,
    outputs: [&str; 2],
    shift: (i32, i32),
) -> Drawn {
    let (x, y) = (solution.output(outputs[0]), solution.output(outputs[1]));
    let (x, y) = (x.ok_or("no first output")?, y.ok_or("no second output")?);
    for phase in solution.phases() {
        let place = (x.at(phase.end), y.at(phase.end));
        chart.draw_series([EmptyElement::at(place) + Circle::new((0, 0), 8, INK.filled())])?;
        words(chart, place, &format!("{:.1} s", phase.end), shift)?;
    }
    Ok(())
}

/// Tracks past the radar of the paper at the origin, over the probability with which it detects the nose.
pub(crate) fn past_the_radar(
    path: &Path,
    title: [&str; 2],
    window: [Range<f64>; 2],
    lines: &[Line],
    solution: &Solution,
) -> Drawn {
    let area = picture(path, 1300, title[0], title[1])?;
    let scale = detection();
    let area = bar(&legend(&area, &key(lines))?, &scale)?;
    let [x, y] = window;
    let mut chart = axes(&area, Axes::new(("east [km]", x), ("north [km]", y)))?;
    fill(&mut chart, &scale, |x, y| detection_over_ground(x.hypot(y), 0.0))?;
    draw(&mut chart, lines)?;
    events(&mut chart, solution, ["x", "y"], (16, 8))?;
    chart.draw_series([TriangleMarker::new((0.0, 0.0), 14, INK.filled())])?;
    words(&mut chart, (0.0, 0.0), "radar", (18, -14))
}

/// Panels over time with a dotted upright line through all of them at each event.
pub(crate) fn histories(path: &Path, title: [&str; 2], over: Range<f64>, rows: &[Panel<'_>], times: &[f64]) -> Drawn {
    let area = picture(path, 260 + 380 * u32::try_from(rows.len())?, title[0], title[1])?;
    let lines: Vec<Line> = rows.iter().flat_map(|row| row.lines.clone()).collect();
    let area: Area<'_> = legend(&area, &key(&lines))?;
    let marked: Vec<Panel<'_>> = rows.iter().map(|row| with_events(row, times)).collect();
    panels(&area, ("time [s]", over), &marked)
}

fn with_events<'a>(row: &Panel<'a>, times: &[f64]) -> Panel<'a> {
    let upright = |t: &f64| Line::new("", INK, Stroke::Fine, vec![(*t, row.range.start), (*t, row.range.end)]);
    let lines = times.iter().map(upright).chain(row.lines.clone()).collect();
    Panel { name: row.name, range: row.range.clone(), lines, limits: row.limits }
}
