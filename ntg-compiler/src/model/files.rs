//! Arrays from files: `param gate[n, 3] [m] from "gates.csv" columns 1 .. 3;`, `rows("gates.csv")`.
//!
//! Takes files through the loader, gives shapes and numbers in SI units. A file is read once; its rows are those of a
//! table, comments and blank lines left out.
//! Finds: files that cannot be read (E072), rows of different lengths (E071), sizes other than declared and columns that
//! are not there (E074).

use std::rc::Rc;

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::problem::Form;
use super::scope::{Allow, Context};
use super::shape::{Ends, Shape};
use super::table_data::{FileFault, lines};
use super::units::Quantity;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{ExprKind, File, FileName, Unit};

/// The numbers of a file, all rows equally long.
pub(super) struct Contents {
    rows: Vec<Vec<f64>>,
    columns: usize,
}

/// The columns of a file that an array takes.
struct Chosen {
    contents: Rc<Contents>,
    /// The first of them, counted from 0.
    first: usize,
    count: usize,
}

/// A unit that is none: the numbers are pure.
const PURE: Quantity = Quantity { dimension: Dimension::NONE, factor: 1.0 };

impl<'a> Elaborator<'a> {
    /// Holds the sizes of constants against those of their files.
    pub(super) fn file_sizes(&mut self) {
        for definition in 0..self.definitions.len() {
            let declared = &self.definitions[definition];
            let (ExprKind::File(file), Some(shape), name) = (&declared.value.kind, declared.shape, declared.name)
            else {
                continue;
            };
            let cx = self.home(&Context::of(declared.scope, Allow::Constants), declared.scope);
            let axes = self.declared_axes(&cx, shape);
            self.fits_file(&cx, &name.text, (&axes, shape.span), file);
        }
    }

    /// Whether a file has the size that is declared for what it fills; told where it has not.
    pub(super) fn fits_file(
        &mut self,
        cx: &Context<'a>,
        name: &str,
        (axes, span): (&[Ends], Span),
        file: &'a File,
    ) -> bool {
        let Some(chosen) = self.chosen(cx, file) else { return false };
        let sizes: Option<Vec<i64>> = axes.iter().map(Ends::extent).collect();
        let Some(sizes) = sizes else { return false };
        let path = &file.name.path;
        let (rows, columns) = (chosen.contents.rows.len() as i64, chosen.count as i64);
        let plural = |count: i64, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        let (message, help) = match sizes[..] {
            [wanted] | [wanted, _] if wanted != rows => (
                format!("\"{path}\" has {}, `{name}` has {wanted}", plural(rows, "row")),
                format!("take the size from the file: `const n = rows(\"{path}\");`"),
            ),
            [_] if columns == 1 => return true,
            [_, wanted] if columns == wanted => return true,
            [_] | [_, _] => {
                let wanted = sizes.get(1).copied().unwrap_or(1);
                let which = file.columns.as_ref().map_or(format!("\"{path}\" has"), |columns| {
                    format!("`{}` of \"{path}\" are", self.text(columns.span))
                });
                let message = format!("{which} {}, `{name}` has {wanted}", plural(columns, "column"));
                (message, "choose by `column 1` or `columns 1 .. 3`; a matrix is declared as `[n, 3]`".to_owned())
            }
            _ => (
                format!("\"{path}\" has rows and columns, `{name}` has {} axes", sizes.len()),
                "declare a vector, `[n]`, or a matrix, `[n, 3]`".to_owned(),
            ),
        };
        let finding = Diagnostic::new(Code::FileSize, file.name.span, message)
            .label(span, format!("`{name}` has this size"))
            .label(file.name.span, format!("{} of {}", plural(rows, "row"), plural(columns, "number")));
        self.report(finding.help(help));
        false
    }

    /// The shape of an array that a file fills: a vector of one column, else a matrix.
    pub(super) fn file_shape(&mut self, cx: &Context<'a>, file: &'a File) -> Option<Shape> {
        let chosen = self.chosen(cx, file)?;
        let rows = chosen.contents.rows.len() as i64;
        Some(Shape::Of(if chosen.count == 1 { vec![rows] } else { vec![rows, chosen.count as i64] }))
    }

    /// An element of an array that a file fills: which row and, in a matrix, which column.
    pub(super) fn file_element(&mut self, cx: &Context<'a>, file: &'a File, at: &[Form], span: Span) -> Value {
        let mut known = Vec::with_capacity(at.len());
        for form in at {
            match self.known(form, span) {
                Ok(number) => known.push(usize::try_from(number - 1).ok()),
                Err(open) => return open,
            }
        }
        let Some(chosen) = self.chosen(cx, file) else { return self.poison(span) };
        let (row, column) = match known[..] {
            [Some(row)] => (row, 0),
            [Some(row), Some(column)] => (row, column),
            // Sizes that do not fit were told of.
            _ => return self.poison(span),
        };
        let cells = chosen.contents.rows.get(row).filter(|_| column < chosen.count);
        let Some(number) = cells.and_then(|cells| cells.get(chosen.first + column)) else { return self.poison(span) };
        let number = *number;
        let Some((quantity, shown)) = self.unit_of_file(file.unit.as_ref()) else { return self.poison(span) };
        let node = self.problem.dag.constant(number * quantity.factor);
        Value::new(node, quantity.dimension, span).shown_in(shown.map(Rc::new))
    }

    /// All numbers of an array that a file fills, by rows and in SI units, with their dimension and unit.
    pub(super) fn file_numbers_of(
        &mut self,
        cx: &Context<'a>,
        file: &'a File,
    ) -> Option<(Vec<f64>, Dimension, Option<ntg_structure::Unit>)> {
        let chosen = self.chosen(cx, file)?;
        let (quantity, shown) = self.unit_of_file(file.unit.as_ref())?;
        let rows = chosen.contents.rows.iter();
        let numbers = rows.flat_map(|row| &row[chosen.first..chosen.first + chosen.count]);
        Some((numbers.map(|number| number * quantity.factor).collect(), quantity.dimension, shown))
    }

    /// `rows("gates.csv")`
    pub(super) fn count_of_rows(&mut self, cx: &Context<'a>, name: &FileName, span: Span) -> Value {
        let Some(contents) = self.contents(cx, name) else { return self.poison(span) };
        let node = self.problem.dag.constant(contents.rows.len() as f64);
        Value::new(node, Dimension::NONE, span)
    }

    fn unit_of_file(&mut self, unit: Option<&'a Unit>) -> Option<(Quantity, Option<ntg_structure::Unit>)> {
        match unit {
            None => Some((PURE, None)),
            Some(unit) => self.unit(unit).map(|(quantity, shown)| (quantity, Some(shown))),
        }
    }

    /// The columns that are meant, counted from 0, the last one excluded; what is wrong with them is told.
    fn chosen(&mut self, cx: &Context<'a>, file: &'a File) -> Option<Chosen> {
        let contents = self.contents(cx, &file.name)?;
        let Some(columns) = &file.columns else {
            let count = contents.columns;
            return Some(Chosen { contents, first: 0, count });
        };
        let cx = cx.allowing(Allow::Constants);
        let first = self.whole(&cx, &columns.first, "the number of a column")?;
        let last = match &columns.last {
            Some(last) => self.whole(&cx, last, "the number of a column")?,
            None => first,
        };
        let all = contents.columns as i64;
        if first >= 1 && first <= last && last <= all {
            let count = (last - first + 1) as usize;
            return Some(Chosen { contents, first: first as usize - 1, count });
        }
        let path = &file.name.path;
        let (message, help) = match (first < 1, last > all) {
            (true, _) => ("columns are counted from 1".to_owned(), "write `column 1` for the first one".to_owned()),
            (_, true) => (
                format!("\"{path}\" has {all} column{}, not {last}", if all == 1 { "" } else { "s" }),
                "numbers are parted by commas; count them in a row of the file".to_owned(),
            ),
            _ => (
                format!("`{}` are no columns: the last is before the first", self.text(columns.span)),
                format!("write `columns {last} .. {first}`"),
            ),
        };
        self.report(Diagnostic::new(Code::FileSize, columns.span, message).help(help));
        None
    }

    /// The numbers of a file; what is wrong with it is told once.
    fn contents(&mut self, cx: &Context<'a>, name: &FileName) -> Option<Rc<Contents>> {
        let path = self.beside(cx.library.unwrap_or(cx.lexical), &name.path);
        if let Some(known) = self.files.get(&path) {
            return known.clone();
        }
        let text = self.text_of(&path, name.span);
        let read = text.and_then(|text| match contents(&text) {
            Ok(contents) => Some(Rc::new(contents)),
            Err(fault) => {
                self.array_fault(&path, name.span, &fault);
                None
            }
        });
        self.files.insert(path, read.clone());
        read
    }

    fn array_fault(&mut self, path: &str, span: Span, fault: &FileFault) {
        let (code, message, help) = match fault {
            FileFault::NotANumber { line, text } => (
                Code::UnreadableTable,
                format!("`{path}`, line {line}: `{text}` is not a number"),
                "write numbers with commas between them; `#` starts a comment, such as a line of titles",
            ),
            FileFault::Ragged { line, found, expected } => (
                Code::RaggedTable,
                format!("`{path}`, line {line}: this row has {found} numbers, the first one has {expected}"),
                "write as many numbers in every row",
            ),
            FileFault::Empty | FileFault::Incomplete { .. } => {
                (Code::RaggedTable, format!("`{path}` holds no rows"), "write one row for each element")
            }
        };
        self.report(Diagnostic::new(code, span, message).help(help));
    }
}

/// The rows of a file.
fn contents(text: &str) -> Result<Contents, FileFault> {
    let lines = lines(text, false)?;
    let columns = lines.first().ok_or(FileFault::Empty)?.cells.len();
    match lines.iter().find(|line| line.cells.len() != columns) {
        Some(line) => Err(FileFault::Ragged { line: line.number, found: line.cells.len(), expected: columns }),
        None => Ok(Contents { rows: lines.into_iter().map(|line| line.cells).collect(), columns }),
    }
}
