//! The solution for people: the report, then a table of outputs and named expressions over time.

use ntg_runtime::problem::Problem;
use ntg_runtime::status::Status;
use ntg_runtime::structure::Unit;

use super::Solved;

/// How many rows of the table are printed at most.
const MOST_ROWS: usize = 21;
/// How wide a column is at least.
const LEAST_WIDTH: usize = 11;

pub(super) fn document(solved: &Solved<'_>) -> String {
    let mut lines: Vec<String> = solved.starts.map(|starts| format!("{starts}\n")).into_iter().collect();
    lines.push(led(solved));
    lines.extend(solved.explanation.map(ToString::to_string));
    lines.extend(
        solved.proved.map(|(summary, found)| format!("\n{summary}{}", crate::certify::of_guarantee(found).trim_end())),
    );
    lines.extend(solved.sensitivity.map(super::sensitivity::text));
    lines.push(String::new());
    let problem: &dyn Problem = solved.problem;
    let solution = &solved.report.solution;
    let trajectories = solution.trajectories();
    let signals = solution.signals(problem);
    for signal in signals.iter().filter(|s| s.is_constant()) {
        lines.push(format!("  {} = {}{}", signal.name(), number(signal.at(0.0)), spaced(signal.unit())));
    }

    let independent = &solution.structure().independent;
    let mut heads = vec![independent.heading()];
    heads.extend(trajectories.iter().map(|t| head(t.name(), t.unit())));
    heads.extend(signals.iter().filter(|s| !s.is_constant()).map(|s| head(s.name(), s.unit())));
    lines.push(heads.iter().map(|h| format!("{h:>w$}", w = width(h))).collect::<Vec<_>>().join(" "));
    for t in solution.times(solved.samples.min(MOST_ROWS)) {
        // What has not begun or has ended has no value.
        let mut row = vec![Some(independent.shown(t))];
        row.extend(trajectories.iter().map(|own| own.exists_at(t).then(|| own.at(t))));
        let moving = signals.iter().filter(|signal| !signal.is_constant());
        row.extend(moving.map(|own| own.exists_at(t).then(|| own.at(t))));
        let shown = row.iter().map(|value| value.map_or_else(|| "-".to_owned(), number));
        let cells = shown.zip(&heads).map(|(value, head)| format!("{value:>w$}", w = width(head)));
        lines.push(cells.collect::<Vec<_>>().join(" "));
    }
    if solved.samples > MOST_ROWS {
        lines.push(format!("(all {} samples: --format json)", solved.samples));
    }
    lines.join("\n")
}

/// The report; where it says that a problem is infeasible, its first line names the culprit.
fn led(solved: &Solved<'_>) -> String {
    let mut report = solved.report.clone();
    solved.report.advice_beside(solved.explanation).clone_into(&mut report.advice);
    let text = report.to_string();
    let conflict = solved.explanation.and_then(|explanation| explanation.conflict());
    let headline = conflict.filter(|conflict| conflict.settled).and_then(|conflict| conflict.headline());
    match (headline, &solved.report.status, text.split_once('\n')) {
        (Some(headline), Status::Infeasible { .. }, Some((_, rest))) => {
            format!("{}: {headline}\n{rest}", solved.report.problem)
        }
        _ => text,
    }
}

fn head(name: &str, unit: &Unit) -> String {
    if unit.symbol.is_empty() { name.to_owned() } else { format!("{name} [{}]", unit.symbol) }
}

fn width(head: &str) -> usize {
    head.chars().count().max(LEAST_WIDTH)
}

fn spaced(unit: &Unit) -> String {
    if unit.symbol.is_empty() { String::new() } else { format!(" {}", unit.symbol) }
}

/// Six significant digits, without an exponent where that is readable.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        let digits = if value == 0.0 { 1.0 } else { value.abs().log10().floor() + 1.0 };
        let decimals = (6.0 - digits).clamp(0.0, 9.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.5e}")
    }
}
