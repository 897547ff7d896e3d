//! How cost grows with the size of a problem.

use std::path::Path;

use super::chart::{Axes, Line, Stroke, axes, draw, legend};
use super::{BLUE, Drawn, GREEN, GREY, picture};

/// Milliseconds of solves by number of aircraft, under one rule.
pub(crate) struct Growth {
    pub(crate) rule: &'static str,
    pub(crate) found: Vec<(f64, f64)>,
}

impl Growth {
    /// Times relative to that of the first size.
    fn relative(&self) -> Vec<(f64, f64)> {
        let first = self.found.first().map_or(1.0, |found| found.1);
        self.found.iter().map(|(n, time)| (*n, time / first)).collect()
    }
}

/// Times relative to those of two aircraft, beside what grows in proportion.
pub(crate) fn growth(path: &Path, all: &[Growth]) -> Drawn {
    let sentence = "Time of a solve relative to that of two aircraft. In proportion: each aircraft costs the same.";
    let area = picture(path, 900, "What more aircraft cost", sentence)?;
    let mut lines = vec![Line::graph("in proportion", (GREY, Stroke::Fine), 2.0..32.0, |n| n / 2.0)];
    let looks = [(GREEN, Stroke::Broad), (BLUE, Stroke::Solid)];
    for (growth, look) in all.iter().zip(looks) {
        lines.push(Line::new(growth.rule, look.0, look.1, growth.relative()));
    }
    let dots: Vec<Line> =
        all.iter().zip(looks).map(|(growth, look)| Line::new("", look.0, Stroke::Dots, growth.relative())).collect();
    let most = lines.iter().flat_map(|line| &line.points).map(|point| point.1).fold(1.0, f64::max);
    let labels = Axes::new(("aircraft", 0.0..34.0), ("time, relative to 2", 0.0..1.1 * most));
    let mut chart = axes(&legend(&area, &lines)?, labels)?;
    draw(&mut chart, &lines)?;
    draw(&mut chart, &dots)
}
