//! Tables: signatures, numbers in SI units, and what the interpolant does to them.
//!
//! Takes the `table` items, fills `Problem::tables`; files come through the loader.
//! Finds: nodes that do not increase, ragged rows, files that cannot be read, methods that do not
//! fit.
//! Afterwards: every table of the problem makes an interpolant.

use ntg_structure::{Table, TableAxis, TableExtrapolation, TableMethod, TableSymmetry, Unit};

use super::dimension::Dimension;
use super::elaborator::{Elaborator, TableSignature, doc_text};
use super::loading;
use super::scope::{Allow, Context, Entity, ScopeId};
use super::table_data::{FileFault, Numbers, Place, read};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{self, Expr, ItemKind, MethodKind, TableData};

/// The order of a `bspline` that names none: cubic.
const DEFAULT_ORDER: usize = 4;

impl<'a> Elaborator<'a> {
    /// All tables, wherever they stand.
    pub(super) fn all_tables(&mut self) {
        let blank = Table {
            name: String::new(),
            doc: String::new(),
            axes: Vec::new(),
            unit: Unit::default(),
            values: Vec::new(),
            method: TableMethod::Monotone,
            extrapolation: TableExtrapolation::Clamp,
            replaceable: false,
        };
        self.problem.tables = vec![blank; self.tables.len()];
        for scope in 0..self.scopes.len() {
            for item in self.items[scope] {
                let ItemKind::Table(table) = &item.kind else { continue };
                let Some(declared) = self.scopes[scope].names.get(table.name.text.as_str()).copied() else { continue };
                if let (Entity::Table(k), true) = (declared.entity, declared.span == table.name.span) {
                    self.table(scope, k, table, doc_text(&item.doc));
                }
            }
        }
    }

    fn table(&mut self, scope: ScopeId, k: usize, table: &'a ast::Table, doc: String) {
        let mut units: Vec<(Dimension, Unit)> = Vec::new();
        for unit in table.axes.iter().map(|axis| &axis.unit).chain([&table.unit]) {
            let Some(unit) = unit else {
                units.push((Dimension::NONE, Unit::default()));
                continue;
            };
            let Some((quantity, shown)) = self.unit(unit) else { return };
            units.push((quantity.dimension, shown));
        }
        let Some((value, axes)) = units.split_last() else { return };
        self.signatures[k] = TableSignature {
            axes: table.axes.iter().zip(axes).map(|(axis, unit)| (axis.name.text.clone(), Some(unit.0))).collect(),
            dimension: Some(value.0),
        };
        let numbers = match &table.data {
            TableData::Inline(rows) => self.inline_numbers(scope, table, rows, &units),
            TableData::File { path, span } => self.file_numbers(table, &self.beside(scope, path), *span, &units),
        };
        let method = self.method(scope, table);
        let (Some(numbers), Some(method)) = (numbers, method) else { return };
        if !self.increasing(table, &numbers, axes) {
            return;
        }
        let named = table.axes.iter().zip(axes).zip(numbers.nodes);
        let axes = named.map(|((axis, unit), nodes)| TableAxis {
            name: axis.name.text.clone(),
            unit: unit.1.clone(),
            nodes,
            symmetry: match axis.symmetry {
                None => TableSymmetry::Plain,
                Some(ast::Symmetry::Even) => TableSymmetry::Even,
                Some(ast::Symmetry::Periodic) => TableSymmetry::Periodic,
            },
        });
        let made = Table {
            name: self.shown_name(scope, &table.name.text),
            doc,
            axes: axes.collect(),
            unit: value.1.clone(),
            values: numbers.values,
            method,
            extrapolation: match table.method.extrapolate {
                Some(ast::Extrapolate::Linear) => TableExtrapolation::Linear,
                _ => TableExtrapolation::Clamp,
            },
            replaceable: table.is_param,
        };
        self.try_out(table, &made);
        self.problem.tables[k] = made;
    }

    /// The numbers between braces, in SI units.
    fn inline_numbers(
        &mut self,
        scope: ScopeId,
        table: &'a ast::Table,
        rows: &'a ast::Rows,
        units: &[(Dimension, Unit)],
    ) -> Option<Numbers> {
        let arguments = table.axes.len();
        if arguments > 2 {
            let finding =
                Diagnostic::new(Code::WrongTable, rows.span, "a table of three arguments and more comes from a file");
            self.report(
                finding.help("write `from \"file.csv\"`: one row for each combination of nodes, then the value"),
            );
            return None;
        }
        let header = match (arguments, &rows.header) {
            (2, Some(header)) => Some(header),
            (1, None) => None,
            (2, None) => {
                let finding = Diagnostic::new(
                    Code::RaggedTable,
                    rows.span,
                    format!("the nodes of `{}` are missing", table.axes[1].name.text),
                );
                let columns = rows.rows.iter().map(|row| row.values.len()).max().unwrap_or_default();
                self.report(finding.help(missing_nodes(&table.axes[1].name.text, columns)));
                return None;
            }
            (_, Some(header)) => {
                let span = header.iter().map(|e| e.span).reduce(Span::to).unwrap_or(rows.span);
                let finding = Diagnostic::new(
                    Code::RaggedTable,
                    span,
                    format!("`{}` has one argument: this row has no node", table.name.text),
                );
                self.report(finding.help("write `node: value;` in each row"));
                return None;
            }
            _ => return None,
        };
        let width = header.map_or(1, Vec::len);
        let mut even = true;
        for row in &rows.rows {
            if row.values.len() != width {
                let plural = if row.values.len() == 1 { "value" } else { "values" };
                let message = format!("this row has {} {plural}, but {width} belong here", row.values.len());
                let mut finding = Diagnostic::new(Code::RaggedTable, row.span, message);
                if let Some(span) = header.and_then(|h| h.iter().map(|e| e.span).reduce(Span::to)) {
                    finding = finding.label(span, format!("one for each of these {width} nodes"));
                }
                let help = if row.values.len() < width { "add what is missing" } else { "remove what is too much" };
                self.report(finding.help(help));
                even = false;
            }
        }
        if !even {
            return None;
        }
        let (value_unit, axis_units) = units.split_last()?;
        let first: Vec<Option<f64>> =
            rows.rows.iter().map(|row| self.entry(scope, &row.node, &axis_units[0])).collect();
        let second: Vec<Option<f64>> =
            header.into_iter().flatten().map(|node| self.entry(scope, node, &axis_units[1])).collect();
        let values: Vec<Option<f64>> =
            rows.rows.iter().flat_map(|row| &row.values).map(|value| self.entry(scope, value, value_unit)).collect();
        let mut nodes = vec![first.into_iter().collect::<Option<Vec<f64>>>()?];
        let mut places: Vec<Vec<Place>> = vec![rows.rows.iter().map(|row| Place::Spec(row.node.span)).collect()];
        if let Some(header) = header {
            nodes.push(second.into_iter().collect::<Option<Vec<f64>>>()?);
            places.push(header.iter().map(|node| Place::Spec(node.span)).collect());
        }
        Some(Numbers { nodes, values: values.into_iter().collect::<Option<_>>()?, places })
    }

    /// A number in a table: without a unit of its own it has the declared one.
    fn entry(&mut self, scope: ScopeId, expr: &'a Expr, unit: &(Dimension, Unit)) -> Option<f64> {
        let constant = self.constant(&Context::of(scope, Allow::Constants), expr, "a number in a table")?;
        match constant.dimension {
            None => Some(constant.value),
            Some(d) if d.is_none() && constant.unit.is_none() => Some(constant.value * unit.1.factor),
            Some(d) if d == unit.0 => Some(constant.value),
            Some(d) => {
                let message = format!("this is {}, but {} is declared", d.describe(), unit.0.describe());
                let finding = Diagnostic::new(Code::WrongUnit, expr.span, message);
                self.report(finding.help("write the number without a unit: the table's declaration has it"));
                None
            }
        }
    }

    /// A path that a file names, from the folder of the spec.
    pub(super) fn beside(&self, scope: ScopeId, path: &str) -> String {
        self.folders.get(&scope).map_or_else(|| path.to_owned(), |folder| super::library::joined(folder, path))
    }

    /// The numbers of a file, in SI units.
    fn file_numbers(
        &mut self,
        table: &ast::Table,
        path: &str,
        span: Span,
        units: &[(Dimension, Unit)],
    ) -> Option<Numbers> {
        let text = self.text_of(path, span)?;
        let mut numbers = match read(&text, table.axes.len()) {
            Ok(numbers) => numbers,
            Err(fault) => {
                self.file_fault(path, span, &fault);
                return None;
            }
        };
        let (value, axes) = units.split_last()?;
        for (nodes, unit) in numbers.nodes.iter_mut().zip(axes) {
            nodes.iter_mut().for_each(|node| *node *= unit.1.factor);
        }
        numbers.values.iter_mut().for_each(|v| *v *= value.1.factor);
        Some(numbers)
    }

    /// The text of a file.
    pub(super) fn text_of(&mut self, path: &str, span: Span) -> Option<String> {
        match self.loader.load(path) {
            Ok(text) => Some(text),
            Err(why) => {
                let finding = Diagnostic::new(Code::UnreadableTable, span, format!("`{path}` cannot be read: {why}"));
                self.report(finding.help(loading::help(&why, "the spec file")));
                None
            }
        }
    }

    fn file_fault(&mut self, path: &str, span: Span, fault: &FileFault) {
        let (code, message, help) = match fault {
            FileFault::NotANumber { line, text } => (
                Code::UnreadableTable,
                format!("`{path}`, line {line}: `{text}` is not a number"),
                "write numbers with commas between them; `#` starts a comment",
            ),
            FileFault::Ragged { line, found, expected } => (
                Code::RaggedTable,
                format!("`{path}`, line {line}: this row has {found} numbers, but {expected} belong here"),
                "write a node and one value for each node of the second argument",
            ),
            FileFault::Empty => (Code::RaggedTable, format!("`{path}` holds no rows"), "write one row for each node"),
            FileFault::Incomplete { expected, found } => (
                Code::RaggedTable,
                format!("`{path}`: the nodes have {expected} combinations, but there are {found} rows"),
                "write every combination of nodes once",
            ),
        };
        self.report(Diagnostic::new(code, span, message).help(help));
    }

    fn increasing(&mut self, table: &ast::Table, numbers: &Numbers, units: &[(Dimension, Unit)]) -> bool {
        let mut fine = true;
        for (k, nodes) in numbers.nodes.iter().enumerate() {
            let Some(i) = nodes.windows(2).position(|pair| pair[1] <= pair[0]) else { continue };
            fine = false;
            let name = &table.axes[k].name.text;
            let shown = |value: f64| format!("{}", (value / units[k].1.factor * 1e9).round() / 1e9);
            let message = format!(
                "the nodes of `{name}` do not increase: {} comes after {}",
                shown(nodes[i + 1]),
                shown(nodes[i])
            );
            let finding = match (&numbers.places[k][i + 1], &numbers.places[k][i], &table.data) {
                (Place::Spec(span), Place::Spec(before), _) => {
                    Diagnostic::new(Code::NodesNotIncreasing, *span, message)
                        .label(*before, "this node comes before it")
                }
                (Place::Line(line), _, TableData::File { span, path }) => {
                    Diagnostic::new(Code::NodesNotIncreasing, *span, format!("`{path}`, line {line}: {message}"))
                }
                _ => Diagnostic::new(Code::NodesNotIncreasing, table.name.span, message),
            };
            self.report(finding.help("sort the nodes, and write each once"));
        }
        fine
    }

    fn method(&mut self, scope: ScopeId, table: &'a ast::Table) -> Option<TableMethod> {
        let cx = Context::of(scope, Allow::Constants);
        let method = &table.method;
        let order = match &method.order {
            Some(order) => self.natural(&cx, order, "the order of a table")?,
            None => DEFAULT_ORDER,
        };
        match method.kind {
            MethodKind::Monotone => Some(TableMethod::Monotone),
            MethodKind::Linear => Some(TableMethod::Linear),
            MethodKind::Bspline => Some(TableMethod::Bspline { order }),
            MethodKind::FitBspline => {
                let Some(intervals) = &method.intervals else {
                    let finding = Diagnostic::new(Code::WrongTable, method.span, "how many intervals has the fit?");
                    self.report(
                        finding
                            .help("write `fit bspline(order = 4, intervals = (16, 6))`, one number for each argument"),
                    );
                    return None;
                };
                let counts: Vec<Option<usize>> =
                    intervals.elements.iter().map(|e| self.natural(&cx, e, "a number of intervals")).collect();
                let mut intervals = counts.into_iter().collect::<Option<Vec<usize>>>()?;
                if let [all] = intervals.as_slice() {
                    intervals = vec![*all; table.axes.len()];
                }
                Some(TableMethod::Fit { order, intervals })
            }
        }
    }
}

/// What to write where the nodes of the second argument are missing: one for each column.
fn missing_nodes(name: &str, columns: usize) -> String {
    // So many are written out.
    const SHOWN: usize = 4;
    let node = |k: usize| format!("{name}_{k}");
    let nodes: Vec<String> = match columns {
        0..=SHOWN => (1..=columns.max(1)).map(node).collect(),
        _ => vec![node(1), node(2), "...".to_owned(), node(columns)],
    };
    let each = if columns > 1 { format!(", one for each of {columns} columns") } else { String::new() };
    format!("write them first, in a row of their own{each}: `{};`", nodes.join(", "))
}
