//! Pictures of missiles and their targets.

use std::ops::Range;
use std::path::Path;

use plotters::prelude::*;

use super::chart::{Axes, Line, Stroke, axes, draw, legend};
use super::history::{Panel, panels};
use super::track::{Track, words};
use super::{Drawn, INK, picture};

/// How a flight is drawn, and where its words stand.
pub(crate) type Look = ((RGBColor, Stroke), (i32, i32));

/// One flight to a hit.
pub(crate) struct Shot {
    pub(crate) name: String,
    pub(crate) look: (RGBColor, Stroke),
    pub(crate) missile: Track,
    pub(crate) target: Track,
    /// Where its words stand, in pixels from the place of the hit.
    pub(crate) words: (i32, i32),
    /// For each panel, what it shows over time.
    pub(crate) histories: Vec<Vec<(f64, f64)>>,
}

impl Shot {
    fn line(&self, points: &[(f64, f64)]) -> Line {
        Line::new(&self.name, self.look.0, self.look.1, points.to_vec())
    }
}

/// What a picture of shots says: title, sentence, where it is drawn, and the panels beneath the tracks,
/// whose lines come from the shots.
pub(crate) struct Scene<'a> {
    pub(crate) title: &'a str,
    pub(crate) sentence: &'a str,
    pub(crate) x: (&'a str, Range<f64>),
    pub(crate) y: (&'a str, Range<f64>),
    /// Seconds between dots on the tracks.
    pub(crate) every: f64,
    pub(crate) last: f64,
    pub(crate) panels: Vec<Panel<'a>>,
}

/// Height of the tracks' panel and of each panel over time.
const TRACKS: u32 = 840;
const HISTORY: u32 = 380;

/// Tracks with dots at equal times, which show both speed and who is where; beneath them the histories.
pub(crate) fn shots(path: &Path, mut scene: Scene<'_>, shots: &[Shot]) -> Drawn {
    let height = 200 + TRACKS + HISTORY * u32::try_from(scene.panels.len())?;
    let area = picture(path, height, scene.title, scene.sentence)?;
    let mut names: Vec<Line> = shots.iter().map(|shot| shot.line(&[])).collect();
    names.push(Line::new("target", INK, Stroke::Fine, vec![]));
    let (upper, lower) = legend(&area, &names)?.split_vertically(TRACKS);
    let mut chart = axes(&upper, Axes::new(scene.x, scene.y))?;
    for shot in shots {
        draw(&mut chart, &[shot.target.line("", INK, Stroke::Fine), shot.missile.line("", shot.look.0, shot.look.1)])?;
        shot.target.dots(&mut chart, scene.every, INK)?;
        shot.missile.dots(&mut chart, scene.every, shot.look.0)?;
        let hit = shot.missile.at(shot.missile.end());
        chart.draw_series([EmptyElement::at(hit) + Cross::new((0, 0), 12, INK.stroke_width(4))])?;
        words(&mut chart, hit, &format!("{}: hit after {:.2} s", shot.name, shot.missile.end()), shot.words)?;
    }
    for (i, panel) in scene.panels.iter_mut().enumerate() {
        panel.lines.extend(shots.iter().map(|shot| shot.line(&shot.histories[i])));
    }
    panels(&lower, ("time [s]", 0.0..scene.last), &scene.panels)
}
