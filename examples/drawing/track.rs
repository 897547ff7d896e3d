//! Tracks over the ground, with dots that tell the time along them.

use ntg::runtime::solution::Trajectory;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::chart::{Chart, Line, Stroke};
use super::{Drawn, INK, text};

/// Places over time.
#[derive(Clone)]
pub(crate) struct Track {
    points: Vec<(f64, f64)>,
    times: Vec<f64>,
}

impl Track {
    /// Two outputs of one agent, over its time.
    pub(crate) fn of(x: &Trajectory, y: &Trajectory) -> Self {
        Self::moving(x.end(), |t| (x.at(t), y.at(t)))
    }

    /// Something that moves as a function of time says, until `end`.
    pub(crate) fn moving(end: f64, place: impl Fn(f64) -> (f64, f64)) -> Self {
        let times: Vec<f64> = (0..=600).map(|i| end * f64::from(i) / 600.0).collect();
        Self { points: times.iter().map(|t| place(*t)).collect(), times }
    }

    pub(crate) fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// Where it is at a time, to the nearest of its points.
    pub(crate) fn at(&self, t: f64) -> (f64, f64) {
        let after = self.times.partition_point(|known| *known < t).min(self.points.len().saturating_sub(1));
        self.points.get(after).copied().unwrap_or_default()
    }

    pub(crate) fn line(&self, name: &str, colour: RGBColor, stroke: Stroke) -> Line {
        Line::new(name, colour, stroke, self.points.clone())
    }

    /// A dot every so many seconds.
    pub(crate) fn dots(&self, chart: &mut Chart<'_, RangedCoordf64>, every: f64, colour: RGBColor) -> Drawn {
        for i in 0..=(self.end() / every) as u32 {
            let dot = EmptyElement::at(self.at(every * f64::from(i))) + Circle::new((0, 0), 6, colour.filled());
            chart.draw_series([dot])?;
        }
        Ok(())
    }
}

/// Words at a place, moved by so many pixels.
pub(crate) fn words(chart: &mut Chart<'_, RangedCoordf64>, at: (f64, f64), words: &str, shift: (i32, i32)) -> Drawn {
    let label = Text::new(words.to_owned(), shift, text(26).color(&INK));
    chart.draw_series([EmptyElement::at(at) + label])?;
    Ok(())
}
