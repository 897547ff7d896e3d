//! What was measured: points beside the curves, and residuals.

use super::{Limit, Line, Panel, Runs, label, with_unit};
use crate::run::Measurement;

/// When, what, and with which standard deviation.
type Measured = (f64, f64, f64);

/// The points that were measured of a quantity, a line for each statement.
pub(super) fn of(runs: &Runs<'_>, run: usize, path: &str) -> Vec<Line> {
    let Some(estimate) = &runs[run].1.estimate else { return vec![] };
    let lines = estimate.measurements.iter().map(|measurement| {
        let own = measurement.residuals.iter().filter(|residual| residual.of == path);
        let points =
            own.filter_map(|residual| Some((residual.t?, residual.measured?, residual.sigma.unwrap_or(f64::NAN))));
        let name = label(runs, run, &format!("{}: {path}", name(measurement)));
        line(name, run, points.collect())
    });
    lines.filter(|line| !line.points.is_empty()).collect()
}

/// One panel for each statement whose numbers were measured at times: what the model has too much, with its deviation.
pub fn residuals(runs: &Runs<'_>) -> Vec<Panel> {
    let mut panels: Vec<Panel> = vec![];
    for (index, (_, run)) in runs.iter().enumerate() {
        for measurement in run.estimate.iter().flat_map(|estimate| &estimate.measurements) {
            let mut groups: Vec<(&str, Vec<Measured>)> = vec![];
            for residual in &measurement.residuals {
                let Some(t) = residual.t else { continue };
                let point = (t, residual.value, (residual.value / residual.ratio).abs());
                match groups.iter_mut().find(|(of, _)| *of == residual.of) {
                    Some((_, points)) => points.push(point),
                    None => groups.push((&residual.of, vec![point])),
                }
            }
            let lines = groups.into_iter().map(|(of, points)| line(label(runs, index, of), index, points));
            let lines: Vec<Line> = lines.collect();
            if lines.is_empty() {
                continue;
            }
            let title = super::short(&measurement.name);
            let y = with_unit("residual", &measurement.unit);
            match panels.iter_mut().find(|panel| panel.title == title && panel.y == y) {
                Some(panel) => panel.lines.extend(lines),
                None => panels.push(Panel { title, x: run.independent.heading(), y, lines, ..Panel::default() }),
            }
        }
    }
    for panel in &mut panels {
        let times = panel.lines.iter().flat_map(|line| &line.points).map(|(t, _)| *t);
        let over = times.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| (low.min(t), high.max(t)));
        panel.limits = vec![Limit { at: 0.0, over, ..Limit::default() }];
    }
    panels
}

/// A statement's name, or a word where it has none but its text.
fn name(measurement: &Measurement) -> &str {
    let is_name = measurement.name.chars().all(|letter| letter.is_alphanumeric() || matches!(letter, '_' | '.'));
    if is_name { &measurement.name } else { "measured" }
}

/// Points in order of time.
fn line(name: String, run: usize, mut points: Vec<Measured>) -> Line {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sigmas = points.iter().map(|point| point.2).collect();
    Line { name, run, points: points.into_iter().map(|(t, value, _)| (t, value)).collect(), sigmas, ..Line::default() }
}
