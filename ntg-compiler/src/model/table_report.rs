//! Builds a table's interpolant once, and says what it does to the data.
//!
//! Takes a table in SI units.
//! Finds: tables that have no interpolant; notes how well a fit meets its data, and where a
//! gradient jumps because a table keeps an end value that it reaches with a slope.

use ntg_splines::{Axis, Extrapolation, Method, Symmetry, TableError};
use ntg_structure::{Table, TableExtrapolation, TableMethod, TableSymmetry, Unit};

use super::elaborator::Elaborator;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast;

/// The part of the range of a table's values that is not worth a note: rounding, mostly.
const NEGLIGIBLE: f64 = 1e-6;

/// The least and the largest value of a table.
fn range(table: &Table) -> (f64, f64) {
    table.values.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)))
}

impl Elaborator<'_> {
    /// Builds the interpolant once, to see that it exists and how well it follows its data.
    pub(super) fn try_out(&mut self, declared: &ast::Table, table: &Table) {
        let axes = table.axes.iter().map(|axis| Axis {
            nodes: axis.nodes.clone(),
            symmetry: match axis.symmetry {
                TableSymmetry::Plain => Symmetry::Plain,
                TableSymmetry::Even => Symmetry::Even,
                TableSymmetry::Periodic => Symmetry::Periodic,
            },
        });
        let method = match &table.method {
            TableMethod::Monotone => Method::Monotone,
            TableMethod::Bspline { order } => Method::Bspline { order: *order },
            TableMethod::Fit { order, intervals } => Method::Fit { order: *order, intervals: intervals.clone() },
            TableMethod::Linear => Method::Linear,
        };
        let outside = match table.extrapolation {
            TableExtrapolation::Clamp => Extrapolation::Clamp,
            TableExtrapolation::Linear => Extrapolation::Linear,
        };
        match ntg_splines::Table::new(axes.collect(), table.values.clone(), method, outside) {
            Ok(made) => {
                self.fit_note(declared, table, &made);
                self.end_slopes(declared, table, &made);
            }
            Err(error) => self.wrong_table(declared, table, &error),
        }
    }

    fn wrong_table(&mut self, declared: &ast::Table, table: &Table, error: &TableError) {
        let axis = |k: usize| declared.axes.get(k).map(|axis| axis.span);
        let order = declared.method.order.as_ref().map(|order| order.span);
        let (span, help) = match *error {
            TableError::TooFewNodes { axis: k, .. } => (axis(k), "write two nodes at least"),
            TableError::EvenNegative { axis: k, .. } => {
                (axis(k), "leave the negative nodes out: `even` mirrors the others")
            }
            TableError::PeriodicNotClosed { axis: k, .. } => (axis(k), "repeat the first values at the last node"),
            TableError::Order { .. } => (order, "write an order such as 4, which is cubic"),
            TableError::MonotoneArguments { .. } => {
                (Some(declared.method.span), "write `bspline(order = 4)` or `linear`")
            }
            _ => (Some(declared.method.span), "choose another method, or other nodes"),
        };
        let argument = |k: usize| declared.axes.get(k).map_or("", |axis| axis.name.text.as_str());
        let in_unit = |value: f64, unit: &Unit| {
            let shown = (value / unit.factor * 1e9).round() / 1e9;
            if unit.symbol.is_empty() { shown.to_string() } else { format!("{shown} [{}]", unit.symbol) }
        };
        // Numbers as they stand in the spec, not in SI units.
        let what = match *error {
            TableError::EvenNegative { axis, node } => format!(
                "`{}` is even, so its nodes must not be negative, but the first one is {}",
                argument(axis),
                in_unit(node, &table.axes[axis].unit)
            ),
            TableError::PeriodicNotClosed { axis, first, last } => format!(
                "`{}` is periodic, so its last node must repeat the values of the first, but they are {} and {}",
                argument(axis),
                in_unit(first, &table.unit),
                in_unit(last, &table.unit)
            ),
            _ => error.to_string(),
        };
        let message = format!("`{}`: {what}", declared.name.text);
        let mut finding = Diagnostic::new(Code::WrongTable, span.unwrap_or(declared.name.span), message);
        let (nodes, of): (&[usize], usize) = match *error {
            TableError::EvenNegative { axis, .. } => (&[0], axis),
            TableError::PeriodicNotClosed { axis, .. } => (&[0, table.axes[axis].nodes.len() - 1], axis),
            _ => (&[], 0),
        };
        let places = nodes.iter().filter_map(|node| node_of(declared, of, *node));
        for (place, label) in places.zip(["the first node", "the last node"]) {
            finding = finding.label(place, label);
        }
        self.report(finding.help(help));
    }

    fn fit_note(&mut self, declared: &ast::Table, table: &Table, made: &ntg_splines::Table) {
        if !matches!(table.method, TableMethod::Fit { .. } | TableMethod::Bspline { .. }) {
            return;
        }
        let report = made.fit_report();
        let (low, high) = range(table);
        if report.largest_error.max(report.largest_overshoot) <= NEGLIGIBLE * (high - low) {
            return;
        }
        let unit = if table.unit.symbol.is_empty() { String::new() } else { format!(" [{}]", table.unit.symbol) };
        let shown = |value: f64| format!("{}{unit}", significant(value / table.unit.factor));
        // What is rounding is not worth a word.
        let told = |amount: f64, verb: &str| {
            (amount > NEGLIGIBLE * (high - low)).then(|| format!("{verb} by at most {}", shown(amount)))
        };
        let misses = told(report.largest_error, "misses its values");
        let overshoots =
            told(report.largest_overshoot, if misses.is_some() { "overshoots them" } else { "overshoots its values" });
        let amounts: Vec<String> = misses.into_iter().chain(overshoots).collect();
        let message = format!("`{}` {}", table.name, amounts.join(" and "));
        let finding = Diagnostic::new(Code::FitReport, declared.method.span, message);
        self.report(finding.help("`monotone` meets every value and never overshoots"));
    }

    /// Notes where a table that keeps its end value has a slope there.
    fn end_slopes(&mut self, declared: &ast::Table, table: &Table, made: &ntg_splines::Table) {
        if table.extrapolation == TableExtrapolation::Linear || table.method == TableMethod::Linear {
            return;
        }
        let (low, high) = range(table);
        let mut jumping: Vec<usize> = vec![];
        for (k, axis) in table.axes.iter().enumerate() {
            let ends: &[usize] = match axis.symmetry {
                TableSymmetry::Plain => &[0, axis.nodes.len() - 1],
                TableSymmetry::Even => &[axis.nodes.len() - 1],
                TableSymmetry::Periodic => &[],
            };
            let width = axis.nodes[axis.nodes.len() - 1] - axis.nodes[0];
            let least = NEGLIGIBLE * (high - low) / width;
            let steep = ends.iter().any(|end| steepest(table, made, k, axis.nodes[*end]) > least);
            if steep {
                jumping.push(k);
            }
        }
        // One note for a table: all its axes are mended by one word.
        let Some(first) = jumping.first() else { return };
        let names: Vec<String> = jumping.iter().map(|k| format!("`{}`", table.axes[*k].name)).collect();
        let (names, verb) = (names.join(" or "), if jumping.len() > 1 { "leave their" } else { "leaves its" });
        let message = format!("the gradient of `{}` jumps where {names} {verb} nodes", table.name);
        let finding = Diagnostic::new(Code::GradientJumps, declared.axes[*first].span, message);
        self.report(
            finding.help("the table keeps its end value there; `extrapolate = linear` goes on with the end slope"),
        );
    }
}

/// Where a node of an argument stands in the spec, if it stands there.
fn node_of(declared: &ast::Table, axis: usize, node: usize) -> Option<Span> {
    let ast::TableData::Inline(rows) = &declared.data else { return None };
    match axis {
        0 => rows.rows.get(node).map(|row| row.node.span),
        _ => rows.header.as_ref()?.get(node).map(|node| node.span),
    }
}

/// The largest slope in argument `k` at the node `end`, over the nodes of the other arguments.
fn steepest(table: &Table, made: &ntg_splines::Table, k: usize, end: f64) -> f64 {
    let mut derivative = vec![0_u8; table.axes.len()];
    derivative[k] = 1;
    let mut most: f64 = 0.0;
    let mut index = vec![0_usize; table.axes.len()];
    loop {
        let mut args: Vec<f64> = index.iter().zip(&table.axes).map(|(i, axis)| axis.nodes[*i]).collect();
        args[k] = end;
        most = most.max(made.eval(&args, &derivative).abs());
        let next = (0..index.len()).filter(|a| *a != k).find(|a| index[*a] + 1 < table.axes[*a].nodes.len());
        let Some(next) = next else { return most };
        index[next] += 1;
        index.iter_mut().take(next).for_each(|i| *i = 0);
    }
}

/// A number with three significant digits.
fn significant(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}
