//! Pictures of solved flights: the ground track over the radar's map, and what is flown over time.

use std::path::Path;

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::chart::{Axes, Chart, Line, Stroke, axes, draw, legend, limits};
use super::heat::{Scale, bar, fill, warm};
use super::radar::{ALTITUDE, detection_over_ground};
use super::{Drawn, GREY, INK, picture, text};

/// What is flown at one time.
#[derive(Clone, Copy)]
pub(crate) struct Moment {
    /// Seconds.
    pub(crate) time: f64,
    /// East and north of the radar, km.
    pub(crate) place: (f64, f64),
    pub(crate) signature: f64,
    /// Degrees.
    pub(crate) azimuth: f64,
    pub(crate) detection: f64,
    /// km/s.
    pub(crate) speed: f64,
    /// 1/km, positive to the left.
    pub(crate) curvature: f64,
}

/// A flight, its look, and the coarse route from which it was found.
pub(crate) struct Flight {
    pub(crate) name: String,
    pub(crate) colour: RGBColor,
    pub(crate) stroke: Stroke,
    pub(crate) route: Vec<(f64, f64)>,
    pub(crate) moments: Vec<Moment>,
}

impl Flight {
    fn line(&self, point: impl Fn(&Moment) -> (f64, f64)) -> Line {
        Line::new(&self.name, self.colour, self.stroke, self.moments.iter().map(point).collect())
    }
}

/// The ground tracks with their coarse routes, the first flight undermost.
pub(crate) fn ground_track(path: &Path, flights: &[Flight]) -> Drawn {
    let area = picture(
        path,
        1450,
        "A low-observable flight past a radar",
        "Where the nose cannot be kept on the radar, the aircraft spirals in: at the limit, 30 degrees off the nose.",
    )?;
    let edges = vec![0.0, 0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99, 1.0];
    let scale = Scale { name: "detection", edges, palette: warm };
    let tracks: Vec<Line> = flights.iter().map(|flight| flight.line(|moment| moment.place)).collect();
    let routes: Vec<Line> = flights
        .iter()
        .filter(|flight| !flight.route.is_empty())
        .map(|flight| {
            let name = format!("coarse route of the {}", flight.name);
            Line::new(&name, flight.colour, Stroke::Fine, flight.route.clone())
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
    let end = flight.moments.last().map_or(0.0, |moment| moment.time);
    for minute in 1..=(end / 60.0) as u32 {
        let time = 60.0 * f64::from(minute);
        let Some(moment) = flight.moments.iter().find(|moment| moment.time >= time) else { break };
        let dot = EmptyElement::at(moment.place) + Circle::new((0, 0), 6, INK.filled());
        chart.draw_series([dot])?;
        if minute % 2 == 0 {
            let label = Text::new(format!("{time} s"), (16, 4), text(26).color(&INK));
            chart.draw_series([EmptyElement::at(moment.place) + label])?;
        }
    }
    Ok(())
}

/// Nearer to the radar than this, km, even the nose shows more than the limit of 4.2
/// (docs/maths.md, section 10.3).
const TOO_NEAR: f64 = 7.0;

/// Start, target circle of 1 km, the radar, and where it must not be approached.
fn landmarks(chart: &mut Chart<'_, RangedCoordf64>) -> Drawn {
    let circle = |centre: (f64, f64), radius: f64| {
        let angles = (0..=72).map(|i| f64::from(i).to_radians() * 5.0);
        angles.map(|angle| (centre.0 + radius * angle.cos(), centre.1 + radius * angle.sin())).collect::<Vec<_>>()
    };
    chart.draw_series(LineSeries::new(circle((5.0, -15.0), 1.0), INK.stroke_width(3)))?;
    chart.draw_series(DashedLineSeries::new(circle((0.0, 0.0), TOO_NEAR), 5, 7, INK.stroke_width(3)))?;
    let note = Text::new("no heading is low enough", (0, 0), text(26).color(&INK));
    chart.draw_series([EmptyElement::at((TOO_NEAR + 1.0, 4.0)) + note])?;
    let marks = [((-100.0, -100.0), "start", (-40, 22)), ((5.0, -15.0), "target, within 1 km", (24, 0))];
    for (place, name, shift) in marks {
        let label = Text::new(name, shift, text(28).color(&INK));
        chart.draw_series([EmptyElement::at(place) + label])?;
    }
    let radar = EmptyElement::at((0.0, 0.0))
        + TriangleMarker::new((0, 0), 14, INK.filled())
        + Text::new("radar", (20, -26), text(28).color(&INK));
    chart.draw_series([radar])?;
    let note = format!("colour: probability of detection, nose at the radar, {ALTITUDE} km up");
    chart.draw_series([EmptyElement::at((-113.0, 14.0)) + Text::new(note, (0, 0), text(26).color(&GREY))])?;
    Ok(())
}

/// One panel of a history: what it shows, over which range, between which limits.
struct Panel {
    name: &'static str,
    range: (f64, f64),
    limits: &'static [(f64, &'static str)],
    value: fn(&Moment) -> f64,
}

const PANELS: [Panel; 5] = [
    Panel { name: "signature", range: (0.0, 7.0), limits: &[(4.2, "largest allowed, 4.2")], value: |m| m.signature },
    Panel {
        name: "azimuth [deg]",
        range: (-60.0, 60.0),
        limits: &[(30.5, "the cliff of Table 1"), (-30.5, "the cliff of Table 1")],
        value: |m| m.azimuth,
    },
    Panel { name: "detection", range: (0.0, 1.1), limits: &[], value: |m| m.detection },
    Panel {
        name: "speed [km/s]",
        range: (0.05, 0.30),
        limits: &[(0.10, "slowest"), (0.25, "fastest")],
        value: |m| m.speed,
    },
    Panel {
        name: "curvature [1/km]",
        range: (-0.3, 0.3),
        limits: &[(0.2, "left turn of 5 km"), (-0.2, "right turn of 5 km")],
        value: |m| m.curvature,
    },
];

/// Signature, azimuth, detection, speed and curvature over time, one above the other.
pub(crate) fn history(path: &Path, flights: &[Flight]) -> Drawn {
    let area = picture(path, 2100, "What is flown, and what the radar sees", "The limits are dotted.")?;
    let area = legend(&area, &flights.iter().map(|flight| flight.line(|_| (0.0, 0.0))).collect::<Vec<_>>())?;
    let last = flights.iter().filter_map(|flight| flight.moments.last()).fold(0.0, |t, m| f64::max(t, m.time));
    let over = 0.0..(last / 50.0).ceil() * 50.0;
    for (i, (panel, area)) in PANELS.iter().zip(area.split_evenly((PANELS.len(), 1))).enumerate() {
        let x = if i + 1 == PANELS.len() { "time [s]" } else { "" };
        let labels = Axes::new((x, over.clone()), (panel.name, panel.range.0..panel.range.1));
        let mut chart = axes(&area, labels)?;
        let lines: Vec<Line> = flights.iter().map(|flight| flight.line(|m| (m.time, (panel.value)(m)))).collect();
        draw(&mut chart, &lines)?;
        limits(&mut chart, over.clone(), panel.limits)?;
    }
    Ok(())
}
