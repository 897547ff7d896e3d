//! What changes over time: panels one above the other, over one axis.

use std::ops::Range;

use ntg::runtime::solution::Signal;

use super::chart::{Axes, Line, axes, draw, limits};
use super::{Area, Drawn};

/// One panel: what it shows, over which range, its lines, and dotted limits with their names.
pub(crate) struct Panel<'a> {
    pub(crate) name: &'a str,
    pub(crate) range: Range<f64>,
    pub(crate) lines: Vec<Line>,
    pub(crate) limits: &'a [(f64, &'a str)],
}

/// Draws panels of equal height; the last one carries the name of the axis.
pub(crate) fn panels(area: &Area<'_>, x: (&str, Range<f64>), panels: &[Panel<'_>]) -> Drawn {
    for (i, (panel, area)) in panels.iter().zip(area.split_evenly((panels.len(), 1))).enumerate() {
        let name = if i + 1 == panels.len() { x.0 } else { "" };
        let mut chart = axes(&area, Axes::new((name, x.1.clone()), (panel.name, panel.range.clone())))?;
        draw(&mut chart, &panel.lines)?;
        limits(&mut chart, x.1.clone(), panel.limits)?;
    }
    Ok(())
}

/// A named expression from `start` to `end`, at both of which it may jump.
pub(crate) fn samples(signal: &Signal<'_>, start: f64, end: f64) -> Vec<(f64, f64)> {
    let times = (0..=300).map(|i| start + (end - start) * f64::from(i) / 300.0);
    times.map(|t| (t, signal.at(t))).collect()
}
