//! Pictures of fleets: who flies where and arrives when, and how near they come to each other.

use std::path::Path;

use plotters::prelude::*;

use super::chart::{Axes, Line, Stroke, axes, draw, legend, limits};
use super::track::{Track, words};
use super::{BLUE, Drawn, GREEN, INK, PURPLE, VERMILION, picture, text};

/// A fleet that flew under some rule.
pub(crate) struct Fleet {
    pub(crate) rule: String,
    pub(crate) tracks: Vec<Track>,
}

impl Fleet {
    /// The least distance of any two while all of them fly, over time, km.
    pub(crate) fn least_distance(&self) -> Vec<(f64, f64)> {
        let last = self.tracks.iter().map(Track::end).fold(f64::INFINITY, f64::min);
        let least = |t: f64| {
            let places: Vec<(f64, f64)> = self.tracks.iter().map(|track| track.at(t)).collect();
            let pairs = places.iter().enumerate().flat_map(|(i, a)| places[i + 1..].iter().map(move |b| (a, b)));
            pairs.map(|(a, b)| (a.0 - b.0).hypot(a.1 - b.1)).fold(f64::INFINITY, f64::min)
        };
        (0..=600).map(|i| last * f64::from(i) / 600.0).map(|t| (t, least(t))).collect()
    }
}

const COLOURS: [RGBColor; 4] = [BLUE, VERMILION, GREEN, PURPLE];

/// One panel a fleet: tracks with a dot every 100 s, and the times of arrival beside the targets.
pub(crate) fn tracks(path: &Path, fleets: &[Fleet]) -> Drawn {
    let height = 132 + 430 * u32::try_from(fleets.len())?;
    let sentence = "Four aircraft under four rules. A dot every 100 s, beside each target the time of its strike. North is stretched.";
    let area = picture(path, height + 50, "A fleet and the times of its strikes", sentence)?;
    for (i, (fleet, area)) in fleets.iter().zip(area.split_evenly((fleets.len(), 1))).enumerate() {
        let east = if i + 1 == fleets.len() { "east [km]" } else { "" };
        let mut chart = axes(&area, Axes::new((east, -120.0..40.0), ("north [km]", -24.0..28.0)))?;
        let style = text(30).style(FontStyle::Bold).color(&INK);
        chart.draw_series([EmptyElement::at((-119.0, 27.0)) + Text::new(fleet.rule.clone(), (0, 0), style)])?;
        for (track, colour) in fleet.tracks.iter().zip(COLOURS.iter().cycle()) {
            draw(&mut chart, &[track.line("", *colour, Stroke::Solid)])?;
            track.dots(&mut chart, 100.0, *colour)?;
            let target = track.at(track.end());
            chart.draw_series([EmptyElement::at(target) + Cross::new((0, 0), 9, INK.stroke_width(3))])?;
            words(&mut chart, target, &format!("{:.1} s", track.end()), (26, -13))?;
        }
    }
    Ok(())
}

/// The least distance of any two over time.
pub(crate) fn distances(path: &Path, apart: f64, fleets: &[&Fleet]) -> Drawn {
    let sentence = "Distance of the two that are nearest to each other, while all fly. Both fleets strike at one time.";
    let area = picture(path, 900, "How near the aircraft come to each other", sentence)?;
    let looks = [(VERMILION, Stroke::Dashed), (BLUE, Stroke::Solid)];
    let line =
        |(fleet, look): (&&Fleet, (RGBColor, Stroke))| Line::new(&fleet.rule, look.0, look.1, fleet.least_distance());
    let lines: Vec<Line> = fleets.iter().zip(looks).map(line).collect();
    let area = legend(&area, &lines)?;
    let over = 0.0..600.0;
    let mut chart = axes(&area, Axes::new(("time [s]", over.clone()), ("least distance [km]", 0.0..14.0)))?;
    draw(&mut chart, &lines)?;
    limits(&mut chart, over, &[(apart, "least distance allowed")])
}
