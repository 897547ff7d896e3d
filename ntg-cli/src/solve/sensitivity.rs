//! `--sensitivity`: derivatives by parameters, for people and for programs.

use ntg_interp::Interpreted;
use ntg_runtime::report::Report;
use ntg_runtime::sensitivity::{Gradient, Sensitivity, SensitivityError, Weak};
use serde_json::{Map, Value, json};

use super::text::number;
use crate::terminal;

/// How wide a column is at least.
const LEAST_WIDTH: usize = 12;

/// Derivatives by the wanted parameters, or why there are none.
pub(super) fn differentiated(
    wanted: Option<&[String]>,
    report: &Report,
    problem: &Interpreted,
) -> Option<Result<Sensitivity, SensitivityError>> {
    let names: Vec<&str> = wanted?.iter().flat_map(|text| listed(text)).filter(|name| !name.is_empty()).collect();
    Some(match names.is_empty() || !report.has_solution() {
        true => report.sensitivity(problem),
        false => report.solution.sensitivity_by(problem, &names),
    })
}

/// The names of a list; the indices of an element of a matrix have commas too.
fn listed(text: &str) -> impl Iterator<Item = &str> {
    let mut is_inside = false;
    let parts = text.split(move |c| {
        is_inside = if is_inside { c != ']' } else { c == '[' };
        c == ',' && !is_inside
    });
    parts.map(str::trim)
}

/// What is differentiated, with its derivatives: the objective, durations, variables, named numbers, and outputs at
/// their ends.
fn numbers(sensitivity: &Sensitivity) -> Vec<(String, Gradient)> {
    let solution = sensitivity.solution();
    let mut names: Vec<String> = solution.event_times().into_iter().map(|(name, _)| name).collect();
    names.extend(solution.variables().into_iter().map(|variable| variable.name));
    names.extend(
        solution.signals(sensitivity.problem()).iter().filter(|s| s.is_constant()).map(|s| s.name().to_owned()),
    );
    let mut found = vec![("objective".to_owned(), sensitivity.objective().clone())];
    found.extend(names.into_iter().filter_map(|name| sensitivity.of(&name).map(|gradient| (name, gradient))));
    for output in solution.trajectories() {
        let end = sensitivity.at(output.name(), output.end());
        found.extend(end.map(|gradient| (format!("final({})", output.name()), gradient)));
    }
    found
}

/// A table: one line for everything that is differentiated, one column a parameter.
pub(super) fn text(sensitivity: &Result<Sensitivity, SensitivityError>, width: Option<usize>) -> String {
    let sensitivity = match sensitivity {
        Ok(found) => found,
        Err(error) => return terminal::folded(&format!("\nno derivatives by parameters: {error}"), width),
    };
    if sensitivity.parameters().is_empty() {
        return "\nno derivatives by parameters: the problem has none".to_owned();
    }
    let named = |name: &str, unit: &str| if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") };
    let rows: Vec<(String, Gradient)> =
        numbers(sensitivity).into_iter().map(|(name, g)| (named(&name, &g.unit.symbol), g)).collect();
    let first = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let names = std::iter::once("").chain(rows.iter().map(|(name, _)| name.as_str()));
    let mut columns = vec![names.map(|name| format!("  {name:first$}")).collect::<Vec<String>>()];
    columns.extend(sensitivity.parameters().iter().enumerate().map(|(k, p)| {
        let head = format!("{:>LEAST_WIDTH$}", named(&p.name, &p.unit.symbol));
        std::iter::once(head).chain(rows.iter().map(|(_, gradient)| number(gradient.values[k]))).collect()
    }));
    let said = |line: &str| terminal::folded(line, width);
    let head = said("derivatives by parameters, in these units for one unit of the parameter:");
    let mut lines = vec![String::new(), head];
    lines.extend(terminal::table(&columns, width));
    if !sensitivity.is_strict() {
        lines.push(said(
            "  the minimum is not strict: derivatives but the objective's are of the solution that moves least",
        ));
    }
    lines.extend(sensitivity.weak().iter().map(|weak| said(&format!("  {}", words(weak)))));
    lines.join("\n")
}

fn words(weak: &Weak) -> String {
    let point = match (weak.points, weak.point.as_str()) {
        (_, "") => String::new(),
        (1, point) => format!(" ({point})"),
        (points, point) => format!(" ({points} points, first {point})"),
    };
    format!("{} is only just active or inactive{point}: derivatives may be one-sided", weak.name)
}

pub(super) fn document(sensitivity: &Result<Sensitivity, SensitivityError>, samples: usize) -> Value {
    let sensitivity = match sensitivity {
        Ok(found) => found,
        Err(error) => return json!({ "error": error.to_string() }),
    };
    let number = |(name, gradient): (String, Gradient)| {
        (name, json!({ "unit": gradient.unit.symbol, "values": gradient.values }))
    };
    let solution = sensitivity.solution();
    let curve = |name: &str, unit: &str, times: Vec<f64>| {
        let values: Vec<Vec<f64>> =
            times.iter().filter_map(|t| sensitivity.at(name, *t)).map(|gradient| gradient.values).collect();
        let times: Vec<f64> = times.iter().map(|time| solution.structure().independent.shown(*time)).collect();
        json!({ "unit": unit, "t": times, "values": values })
    };
    let outputs = solution.trajectories().into_iter().map(|output| {
        let times = output.sample(samples).into_iter().map(|(t, _)| t).collect();
        (output.name().to_owned(), curve(output.name(), &output.unit().symbol, times))
    });
    let signals = solution.signals(sensitivity.problem()).into_iter().filter_map(|signal| {
        let (start, end) = signal.span()?;
        let last = samples.saturating_sub(1).max(1);
        let times = (0..samples).map(|i| start + (end - start) * i as f64 / last as f64).collect();
        Some((signal.name().to_owned(), curve(signal.name(), &signal.unit().symbol, times)))
    });
    json!({
        "parameters": sensitivity.parameters().iter().map(|p| json!({
            "name": p.name, "unit": p.unit.symbol, "value": p.value,
        })).collect::<Vec<_>>(),
        "strict": sensitivity.is_strict(),
        "weak": sensitivity.weak().iter().map(|weak| json!({
            "name": weak.name, "point": weak.point, "points": weak.points, "words": words(weak),
        })).collect::<Vec<_>>(),
        "numbers": numbers(sensitivity).into_iter().map(number).collect::<Map<_, _>>(),
        "outputs": outputs.collect::<Map<_, _>>(),
        "lets": signals.collect::<Map<_, _>>(),
    })
}
