//! `--what nlp`: the optimisation problem's sizes, bounds, and pictures of its matrices.

use std::fmt::Write;

use ntg_runtime::nlp::{Assembly, Csc, Nlp};
use ntg_runtime::transcribe::Transcription;

/// Characters a side of a picture has at most.
const PICTURE: usize = 60;

pub(super) fn text(transcription: &Transcription<'_>) -> String {
    let (variables, rows) = (transcription.variables(), transcription.rows());
    let assembly = Assembly::new(variables, rows, transcription.blocks());
    let limits = transcription.limits();
    let (fixed, bounded) = kinds(&limits.lower, &limits.upper);
    let (equalities, inequalities) = kinds(&limits.row_lower, &limits.row_upper);
    let mut out = String::new();
    let mut line = |text: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{text}");
    };
    line(format!("variables:  {variables:>8}"));
    line(format!("  spline coefficients {:>6}", transcription.coefficients()));
    line(format!("  fixed               {fixed:>6}"));
    line(format!("  with bounds         {bounded:>6}"));
    line(format!("rows:       {rows:>8}"));
    line(format!("  equalities          {equalities:>6}"));
    line(format!("  inequalities        {inequalities:>6}"));
    line(format!("elements:   {:>8}", transcription.blocks().iter().map(|b| b.elements).sum::<usize>()));
    line(format!("\nJacobian: {}", described(&assembly.jacobian, rows * variables)));
    picture(&assembly.jacobian, false).into_iter().for_each(&mut line);
    let hessian = described(&assembly.hessian, variables * (variables + 1) / 2);
    line(format!("\nHessian of the Lagrangian, upper triangle: {hessian}"));
    picture(&assembly.hessian, true).into_iter().for_each(&mut line);
    out
}

/// How many ranges are single points, and how many others have an end.
fn kinds(lower: &[f64], upper: &[f64]) -> (usize, usize) {
    let pairs = || lower.iter().zip(upper);
    let points = pairs().filter(|(l, u)| l == u).count();
    (points, pairs().filter(|(l, u)| l != u && (l.is_finite() || u.is_finite())).count())
}

fn described(matrix: &Csc, places: usize) -> String {
    let entries = matrix.row.len();
    let share = 100.0 * entries as f64 / places.max(1) as f64;
    format!("{} rows, {} columns, {entries} entries ({share:.1} %)", matrix.rows, matrix.columns())
}

/// A matrix drawn small: `#` where a cell holds entries, `.` where it holds none.
fn picture(matrix: &Csc, is_symmetric: bool) -> Vec<String> {
    let (rows, columns) = (matrix.rows, matrix.columns());
    let (height, width) = (rows.min(PICTURE), columns.min(PICTURE));
    let mut cells = vec![vec!['.'; width]; height];
    for column in 0..columns {
        for (row, _) in matrix.column(column) {
            cells[row * height / rows][column * width / columns] = '#';
            if is_symmetric {
                cells[column * height / rows][row * width / columns] = '#';
            }
        }
    }
    cells.into_iter().map(|row| format!("  {}", row.into_iter().collect::<String>())).collect()
}
