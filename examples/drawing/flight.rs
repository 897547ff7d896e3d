//! Pictures of solved flights: the ground track over the radar's map, and what is flown over time.

use std::path::Path;

use ntg::runtime::{problem::Problem, solution::Solution};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::chart::{Axes, Chart, Line, Stroke, axes, draw, legend, limits};
use super::heat::{Scale, bar, fill, warm};
use super::radar::{ALTITUDE, detection_over_ground};
use super::{Drawn, GREY, INK, picture, text};

/// A flight, its look, and the coarse route from which it was found.
pub(crate) struct Flight {
    look: Line,
    route: Vec<(f64, f64)>,
    /// East and north of the radar, km.
    track: Vec<(f64, f64)>,
    /// Seconds, one for each point of the track.
    times: Vec<f64>,
    /// What each of [`PANELS`] shows, over time.
    histories: Vec<Vec<(f64, f64)>>,
}

impl Flight {
    /// A solved low-observability problem, by the names of its spec.
    pub(crate) fn of(look: Line, route: &[(f64, f64)], problem: &dyn Problem, solution: &Solution) -> Drawn<Self> {
        let times = solution.times(601);
        let (x, y) = (solution.output("x").ok_or("no output x")?, solution.output("y").ok_or("no output y")?);
        let track = times.iter().map(|t| (x.at(*t), y.at(*t))).collect();
        let mut histories = vec![];
        for panel in &PANELS {
            let signal = solution.signal(problem, panel.signal).ok_or(panel.signal)?;
            histories.push(times.iter().map(|t| (*t, signal.at(*t))).collect());
        }
        Ok(Self { look, route: route.to_vec(), track, times, histories })
    }

    fn line(&self, points: &[(f64, f64)]) -> Line {
        Line { points: points.to_vec(), ..self.look.clone() }
    }
}

/// The scale of a map of the probability of detection.
pub(crate) fn detection() -> Scale {
    Scale { name: "detection", edges: vec![0.0, 0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99, 1.0], palette: warm }
}

/// The ground tracks with their coarse routes, the first flight undermost.
pub(crate) fn ground_track(path: &Path, flights: &[Flight]) -> Drawn {
    let area = picture(
        path,
        1450,
        "A low-observable flight past a radar",
        "To show little it keeps the radar within 30 degrees of its nose. Both coarse routes lead to the same flight.",
    )?;
    let scale = detection();
    let tracks: Vec<Line> = flights.iter().map(|flight| flight.line(&flight.track)).collect();
    let routes: Vec<Line> = flights
        .iter()
        .filter(|flight| !flight.route.is_empty())
        .map(|flight| {
            let name = format!("coarse route of the {}", flight.look.name);
            Line::new(&name, flight.look.colour, Stroke::Fine, flight.route.clone())
        })
        .collect();
    let all: Vec<Line> = routes.iter().chain(&tracks).cloned().collect();
    let area = bar(&legend(&area, &all)?, &scale)?;
    let mut chart = axes(&area, Axes::new(("east [km]", -115.0..35.0), ("north [km]", -115.0..17.0)))?;
    fill(&mut chart, &scale, |x, y| detection_over_ground(x.hypot(y), 0.0))?;
    draw(&mut chart, &all)?;
    if let Some(flight) = flights.last() {
        time_ticks(&mut chart, flight)?;
    }
    landmarks(&mut chart)
}

/// A dot for each minute along a flight; every other one with its time.
fn time_ticks(chart: &mut Chart<'_, RangedCoordf64>, flight: &Flight) -> Drawn {
    let end = flight.times.last().copied().unwrap_or(0.0);
    for minute in 1..=(end / 60.0) as u32 {
        let time = 60.0 * f64::from(minute);
        let Some((_, place)) = flight.times.iter().zip(&flight.track).find(|(t, _)| **t >= time) else { break };
        let dot = EmptyElement::at(*place) + Circle::new((0, 0), 6, INK.filled());
        chart.draw_series([dot])?;
        if minute % 2 == 0 {
            let label = Text::new(format!("{time} s"), (16, 4), text(26).color(&INK));
            chart.draw_series([EmptyElement::at(*place) + label])?;
        }
    }
    Ok(())
}

/// Nearer to the radar than this, km, even the nose shows more than the limit of 4.2
/// (`f_in` of docs/maths.md, equation 10.2, at an elevation of 59.9 degrees and 12 km up).
const TOO_NEAR: f64 = 7.0;

/// The places of the flight, and where the radar must not be approached.
fn landmarks(chart: &mut Chart<'_, RangedCoordf64>) -> Drawn {
    chart.draw_series(DashedLineSeries::new(circle((0.0, 0.0), TOO_NEAR), 5, 7, INK.stroke_width(3)))?;
    let note = format!("radar; within {TOO_NEAR} km no heading is low enough");
    let style = text(26).color(&INK).pos(Pos::new(HPos::Right, VPos::Bottom));
    chart.draw_series([EmptyElement::at((34.0, 9.0)) + Text::new(note, (0, 0), style)])?;
    places(chart)
}

/// Start, target circle of 1 km, the radar, and what the colours are.
pub(crate) fn places(chart: &mut Chart<'_, RangedCoordf64>) -> Drawn {
    chart.draw_series(LineSeries::new(circle((5.0, -15.0), 1.0), INK.stroke_width(3)))?;
    let marks = [((-100.0, -100.0), "start", (-40, 22)), ((5.0, -15.0), "target, within 1 km", (24, 0))];
    for (place, name, shift) in marks {
        let label = Text::new(name, shift, text(28).color(&INK));
        chart.draw_series([EmptyElement::at(place) + label])?;
    }
    chart.draw_series([TriangleMarker::new((0.0, 0.0), 14, INK.filled())])?;
    let colours =
        ["colour: probability of detection".to_owned(), format!("with the nose at the radar, {ALTITUDE} km up")];
    for (line, words) in (0..).zip(colours) {
        let words = Text::new(words, (0, 32 * line), text(26).color(&GREY));
        chart.draw_series([EmptyElement::at((-25.0, -104.5)) + words])?;
    }
    Ok(())
}

fn circle(centre: (f64, f64), radius: f64) -> Vec<(f64, f64)> {
    let angles = (0..=72).map(|i| f64::from(i).to_radians() * 5.0);
    angles.map(|angle| (centre.0 + radius * angle.cos(), centre.1 + radius * angle.sin())).collect()
}

/// One panel of a history: what it is called, which named expression of the spec it shows, over
/// which range, between which limits.
struct Panel {
    name: &'static str,
    signal: &'static str,
    range: (f64, f64),
    limits: &'static [(f64, &'static str)],
}

const PANELS: [Panel; 5] = [
    Panel { name: "signature", signal: "signature", range: (0.0, 7.0), limits: &[(4.2, "largest allowed, 4.2")] },
    Panel {
        name: "azimuth [deg]",
        signal: "azimuth",
        range: (-60.0, 120.0),
        limits: &[(30.5, "the cliff of Table 1"), (-30.5, "the cliff of Table 1")],
    },
    Panel { name: "detection", signal: "detection", range: (0.0, 1.1), limits: &[] },
    Panel {
        name: "speed [km/s]",
        signal: "speed",
        range: (0.05, 0.30),
        limits: &[(0.10, "slowest"), (0.25, "fastest")],
    },
    Panel {
        name: "curvature [1/km]",
        signal: "curvature",
        range: (-0.3, 0.3),
        limits: &[(0.2, "left turn of 5 km"), (-0.2, "right turn of 5 km")],
    },
];

/// Signature, azimuth, detection, speed and curvature over time, one above the other.
pub(crate) fn history(path: &Path, flights: &[Flight]) -> Drawn {
    let area = picture(
        path,
        2100,
        "What is flown, and what the radar sees",
        "The limit keeps the radar within 30 degrees of the nose, where the free flight turns away. Limits are dotted.",
    )?;
    let area = legend(&area, &flights.iter().map(|flight| flight.look.clone()).collect::<Vec<_>>())?;
    let last = flights.iter().filter_map(|flight| flight.times.last()).copied().fold(0.0, f64::max);
    let over = 0.0..(last / 50.0).ceil() * 50.0;
    for (i, (panel, area)) in PANELS.iter().zip(area.split_evenly((PANELS.len(), 1))).enumerate() {
        let x = if i + 1 == PANELS.len() { "time [s]" } else { "" };
        let labels = Axes::new((x, over.clone()), (panel.name, panel.range.0..panel.range.1));
        let mut chart = axes(&area, labels)?;
        let lines: Vec<Line> = flights.iter().map(|flight| flight.line(&flight.histories[i])).collect();
        draw(&mut chart, &lines)?;
        limits(&mut chart, over.clone(), panel.limits)?;
    }
    Ok(())
}
