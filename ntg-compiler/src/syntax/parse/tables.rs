//! Tables: arguments, method, rows or a file.

use super::Build;
use super::parts::Parts;
use crate::diagnostic::Code;
use crate::syntax::ast::{
    Axis, Expr, ExprKind, Extrapolate, Method, MethodKind, Row, Rows, Symmetry, Table, TableData, Values,
};
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::words::nearest;

impl Build {
    pub(super) fn table(&mut self, pair: Pair<'_>) -> Table {
        let mut parts = Parts::of(pair);
        let head = parts.required(Rule::table_head);
        let data = parts.any();
        let is_param = head.clone().into_inner().next().is_some_and(|first| first.as_rule() == Rule::kw_param);
        let mut head = Parts::of(head);
        let name = self.name(&head.required(Rule::name));
        let mut axes = vec![];
        while let Some(pair) = head.optional(Rule::axis) {
            axes.push(self.axis(pair));
        }
        let unit = head.optional(Rule::unit).map(|pair| self.unit(pair));
        let method = self.method(head.required(Rule::method));
        let data = match data.as_rule() {
            Rule::rows => TableData::Inline(self.rows(data)),
            _ => TableData::File { path: data.as_str().trim_matches('"').to_owned(), span: self.span(&data) },
        };
        Table { is_param, name, axes, unit, method, data }
    }

    fn axis(&mut self, pair: Pair<'_>) -> Axis {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::axis_name));
        let symmetry = parts.optional(Rule::symmetry).map(|pair| match pair.as_str() {
            "even" => Symmetry::Even,
            _ => Symmetry::Periodic,
        });
        Axis { name, symmetry, unit: parts.optional(Rule::unit).map(|pair| self.unit(pair)), span }
    }

    fn method(&mut self, pair: Pair<'_>) -> Method {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let fit = parts.optional(Rule::kw_fit).is_some();
        let name = parts.required(Rule::name);
        let (owner, kind) = match (name.as_str(), fit) {
            ("monotone", false) => ("monotone", MethodKind::Monotone),
            ("linear", false) => ("linear", MethodKind::Linear),
            ("bspline", false) => ("bspline", MethodKind::Bspline),
            ("bspline", true) => ("fit bspline", MethodKind::FitBspline),
            _ => self.unknown_method(&name, fit),
        };
        let mut settings = self.settings(owner, parts.next());
        let (mut order, mut intervals) = (None, None);
        if matches!(kind, MethodKind::Bspline | MethodKind::FitBspline) {
            order = settings.value(self, "order");
        }
        if kind == MethodKind::FitBspline {
            intervals = settings.values(self, "intervals");
        }
        let extrapolate = settings.values(self, "extrapolate").and_then(|values| self.extrapolate(&values));
        settings.finish(self);
        Method { kind, order, intervals, extrapolate, span }
    }

    /// Reports the method; `fit bspline` takes every setting there is, so nothing more is said.
    fn unknown_method(&mut self, name: &Pair<'_>, fit: bool) -> (&'static str, MethodKind) {
        let (word, span) = (name.as_str(), self.span(name));
        let help = if fit {
            "write `fit bspline(...)`: only splines are fitted".into()
        } else {
            match nearest(word, ["monotone", "bspline", "linear"].into_iter()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => "write `monotone`, `bspline`, `fit bspline` or `linear`".into(),
            }
        };
        self.report(Code::Setting, span, format!("`{word}` is no method of interpolation"), help);
        ("fit bspline", MethodKind::FitBspline)
    }

    fn extrapolate(&mut self, values: &Values) -> Option<Extrapolate> {
        let word = match &values.elements[..] {
            [Expr { kind: ExprKind::Path(path), .. }] => match &path.segments[..] {
                [only] if only.indices.is_empty() => only.name.text.as_str(),
                _ => "",
            },
            _ => "",
        };
        match word {
            "clamp" => Some(Extrapolate::Clamp),
            "linear" => Some(Extrapolate::Linear),
            _ => {
                let help = "write `extrapolate = clamp` or `extrapolate = linear`";
                self.report(Code::Setting, values.span, "a table cannot be extrapolated so", help);
                None
            }
        }
    }

    fn rows(&mut self, pair: Pair<'_>) -> Rows {
        let span = self.span(&pair);
        let (mut header, mut rows) = (None, vec![]);
        for (index, pair) in Parts::of(pair).enumerate() {
            match self.row(pair, index == 0) {
                TableRow::Header(cells) => header = Some(cells),
                TableRow::Row(row) => rows.push(row),
                TableRow::Refused => {}
            }
        }
        Rows { header, rows, span }
    }

    /// One row; only the first may be a header.
    pub(in crate::syntax) fn row(&mut self, pair: Pair<'_>, is_first: bool) -> TableRow {
        let mut parts = Parts::of(pair);
        let mut left = self.cells(parts.required(Rule::cells));
        let right = parts.optional(Rule::cells).map(|pair| self.cells(pair));
        let span = left[0].span.to(right.as_ref().and_then(|cells| cells.last()).unwrap_or(&left[left.len() - 1]).span);
        match right {
            Some(values) if left.len() == 1 => TableRow::Row(Row { node: left.swap_remove(0), values, span }),
            Some(_) => {
                let help = "write the node of the first argument, a colon, and the values";
                self.report(Code::Unexpected, left[1].span, "a row has one node before its colon", help);
                TableRow::Refused
            }
            None if is_first => TableRow::Header(left),
            None => {
                let help = "write `node: values;`; only the first row holds the nodes of the second argument";
                self.report(Code::Unexpected, span, "a row begins with its node and a colon", help);
                TableRow::Refused
            }
        }
    }

    fn cells(&mut self, pair: Pair<'_>) -> Vec<Expr> {
        Parts::of(pair).map(|pair| self.expression(pair)).collect()
    }
}

/// What a row of a table turned out to be.
pub(in crate::syntax) enum TableRow {
    Header(Vec<Expr>),
    Row(Row),
    Refused,
}
