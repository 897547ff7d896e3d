//! Numbers of files: `from "gates.csv" columns 1 .. 3`, `rows("gates.csv")`.

use super::Build;
use super::parts::Parts;
use crate::diagnostic::Code;
use crate::syntax::ast::{Columns, Expr, ExprKind, File, FileName, Unit};
use crate::syntax::grammar::{Pair, Rule};

impl Build {
    /// The numbers of a file in a unit.
    pub(super) fn file(&mut self, pair: Pair<'_>, unit: Option<Unit>) -> Expr {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name = self.file_name(&parts.required(Rule::string));
        let columns = parts.optional(Rule::columns).map(|pair| self.columns(pair));
        Expr { kind: ExprKind::File(Box::new(File { name, unit, columns })), span }
    }

    fn columns(&mut self, pair: Pair<'_>) -> Columns {
        let span = self.span(&pair);
        let is_one = !pair.as_str().starts_with("columns");
        let mut parts = Parts::of(pair);
        let first = self.expression(parts.required(Rule::expression));
        let last = parts.optional(Rule::expression).map(|pair| self.expression(pair));
        match (is_one, &last) {
            (true, Some(_)) => {
                self.report(Code::Misplaced, span, "`column` is about one column", "write `columns 1 .. 3` for several")
            }
            (false, None) => {
                self.report(Code::Misplaced, span, "`columns` is about several columns", "write `column 1` for one")
            }
            _ => {}
        }
        Columns { first, last, span }
    }

    /// `rows("gates.csv")`
    pub(super) fn rows_of(&mut self, pair: Pair<'_>) -> ExprKind {
        ExprKind::Rows(self.file_name(&Parts::of(pair).required(Rule::string)))
    }

    fn file_name(&mut self, pair: &Pair<'_>) -> FileName {
        FileName { path: pair.as_str().trim_matches('"').to_owned(), span: self.span(pair) }
    }

    /// Tells of a unit behind a size whose values are written.
    pub(super) fn unit_without_file(&mut self, unit: Option<Unit>) {
        if let Some(unit) = unit {
            let message = "the unit of written values stands behind them";
            let help = "write `name[3] = (1, 2, 3) [m];`; behind the size it is that of a file's values";
            self.report(Code::Misplaced, unit.span, message, help);
        }
    }
}
