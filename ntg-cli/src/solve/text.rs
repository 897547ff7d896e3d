//! The solution for people: the report, then a table of outputs and named expressions over time.

use ntg_runtime::problem::Problem;
use ntg_runtime::status::Status;
use ntg_runtime::structure::Unit;

use super::Solved;
use crate::terminal;

/// How many rows of the table are printed at most.
const MOST_ROWS: usize = 21;
/// How deep the table of refinement stands.
const INDENT: usize = 4;
/// How wide a column is at least.
const LEAST_WIDTH: usize = 11;

pub(super) fn document(solved: &Solved<'_>) -> String {
    let mut lines: Vec<String> = solved.starts.map(|starts| format!("{starts}\n")).into_iter().collect();
    lines.push(led(solved));
    lines.extend(solved.explanation.map(ToString::to_string));
    lines.extend(
        solved.proved.map(|(summary, found)| format!("\n{summary}{}", crate::certify::of_guarantee(found).trim_end())),
    );
    let mut lines = vec![terminal::folded(&lines.join("\n"), solved.width)];
    lines.extend(solved.sensitivity.map(|found| super::sensitivity::text(found, solved.width)));
    lines.push(String::new());
    let problem: &dyn Problem = solved.problem;
    let solution = &solved.report.solution;
    let trajectories = solution.trajectories();
    let signals = solution.signals(problem);
    for signal in signals.iter().filter(|s| s.is_constant()) {
        let line = format!("  {} = {}{}", signal.name(), number(signal.at(0.0)), spaced(signal.unit()));
        lines.push(terminal::folded(&line, solved.width));
    }

    let times = solution.times(solved.samples.min(MOST_ROWS));
    let independent = &solution.structure().independent;
    let shown = times.iter().map(|t| Some(independent.shown(*t))).collect();
    let mut columns = vec![column(independent.heading(), shown)];
    // What has not begun or has ended has no value.
    columns.extend(trajectories.iter().map(|own| {
        let values = times.iter().map(|t| own.exists_at(*t).then(|| own.at(*t)));
        column(head(own.name(), own.unit()), values.collect())
    }));
    columns.extend(signals.iter().filter(|signal| !signal.is_constant()).map(|own| {
        let values = times.iter().map(|t| own.exists_at(*t).then(|| own.at(*t)));
        column(head(own.name(), own.unit()), values.collect())
    }));
    lines.extend(terminal::table(&columns, solved.width));
    if solved.samples > MOST_ROWS {
        lines.push(format!("(all {} samples: --format json)", solved.samples));
    }
    lines.join("\n")
}

/// The report; where it says that a problem is infeasible, its first line names the culprit.
fn led(solved: &Solved<'_>) -> String {
    let mut report = solved.report.clone();
    solved.report.advice_beside(solved.explanation).clone_into(&mut report.advice);
    let mut text = report.to_string();
    if let Some(refined) = report.refined.as_ref().filter(|_| solved.width.is_some()) {
        // Folded between words, a table is none.
        let inner = solved.width.map(|width| width.saturating_sub(INDENT));
        let rows = terminal::table(&refined.columns(), inner);
        let rows = rows.iter().map(|row| format!("{:INDENT$}{row}", "").trim_end().to_owned());
        let table = std::iter::once(refined.headline()).chain(rows).collect::<Vec<_>>().join("\n");
        text = text.replace(&refined.to_string(), &table);
    }
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

/// A column of the table: its head, then its values, those that are alike with as many digits as tell them apart.
fn column(head: String, values: Vec<Option<f64>>) -> Vec<String> {
    let known = || values.iter().copied().flatten().filter(|value| value.is_finite());
    let (digits, greatest) = (digits(known()), known().fold(0.0_f64, |most, value| most.max(value.abs())));
    let shown = |value: &f64| if value.abs() < ROUNDED * greatest { 0.0 } else { *value };
    let cells = values.iter().map(|value| value.as_ref().map_or_else(|| "-".to_owned(), |v| rounded(shown(v), digits)));
    std::iter::once(format!("{head:>LEAST_WIDTH$}")).chain(cells).collect()
}

fn spaced(unit: &Unit) -> String {
    if unit.symbol.is_empty() { String::new() } else { format!(" {}", unit.symbol) }
}

/// Significant digits of a number for people.
const DIGITS: i32 = 6;
/// How many digits are shown of what the values of a column vary by.
const OWN_DIGITS: i32 = 4;
/// Values that vary by less than this part of them are the same but for what a solve leaves.
const SAME: f64 = 1e-8;
/// What is less than this part of the greatest of a column is a zero that was rounded.
const ROUNDED: f64 = 1e-14;

/// How many significant digits tell the values of a column apart.
fn digits(values: impl Iterator<Item = f64>) -> i32 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let share = (high - low) / low.abs().max(high.abs());
    if share > SAME { DIGITS.max(OWN_DIGITS - share.log10().floor() as i32) } else { DIGITS }
}

/// Six significant digits, without an exponent where that is readable.
pub(super) fn number(value: f64) -> String {
    rounded(value, DIGITS)
}

/// So many significant digits; where they reach behind the point, or nearly, without an exponent.
fn rounded(value: f64, significant: i32) -> String {
    if value == 0.0 || (1e-3..10_f64.powi(significant)).contains(&value.abs()) {
        let digits = if value == 0.0 { 1 } else { value.abs().log10().floor() as i32 + 1 };
        let decimals = (significant - digits).clamp(0, 9) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.*e}", significant as usize - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(values: &[f64]) -> Vec<String> {
        column("x [m]".to_owned(), values.iter().copied().map(Some).collect())
    }

    #[test]
    fn values_far_from_their_origin_are_told_apart() {
        assert_eq!(cells(&[5e6, 5_000_001.5, 5_000_003.0])[1..], ["5000000.0000", "5000001.5000", "5000003.0000"]);
        assert_eq!(cells(&[-2e13, -2e13 + 1e9])[1..], ["-2.00000000e13", "-1.99990000e13"]);
        assert_eq!(cells(&[300.0, 300.002])[1..], ["300.0000000", "300.0020000"]);
    }

    #[test]
    fn others_have_six_digits_also_what_is_constant_but_for_a_rounding() {
        assert_eq!(cells(&[0.0, 1.5, 30.0])[1..], ["0.00000", "1.50000", "30.0000"]);
        assert_eq!(cells(&[-3e-16, 1e-9, 30.0])[1..], ["0.00000", "1.00000e-9", "30.0000"]);
        assert_eq!(cells(&[300.0, 300.0 + 1e-9])[1..], ["300.000", "300.000"]);
        assert_eq!(cells(&[5e6, 5e6, f64::NAN])[1..], ["5.00000e6", "5.00000e6", "NaN"]);
        assert_eq!(cells(&[0.0, 0.0])[1..], ["0.00000", "0.00000"]);
        assert_eq!(column("x".to_owned(), vec![None, Some(1e-7)]), ["          x", "-", "1.00000e-7"]);
    }
}
