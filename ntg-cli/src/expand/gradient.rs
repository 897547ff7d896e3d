//! `--what gradient`: what each function depends on, and how.
//!
//! For every kernel its active variables (those that its derivatives are taken by), its other inputs, and for every
//! row its degree and a picture of its first derivatives; then the second derivatives' lower triangle.

use std::fmt::Write;

use ntg_compiler::program::{KernelBody, Program};
use ntg_structure::{Degree, Kernel};

/// The widest text of a row; the rest of a longer one is cut.
const LABEL: usize = 48;

pub(super) fn text(program: &Program) -> String {
    let mut out = String::from(
        "Active variables are what a function's derivatives are taken by; `x_2` is the second derivative of `x`\n\
         by the scaled time of its phase.\n",
    );
    for (kernel, body) in program.structure.kernels.iter().zip(&program.kernels) {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "\n{}", of_kernel(kernel, body));
    }
    out
}

fn of_kernel(kernel: &Kernel, body: &KernelBody) -> String {
    let names = |range: std::ops::Range<usize>| {
        let names: Vec<&str> = body.names.get(range).unwrap_or_default().iter().map(String::as_str).collect();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    };
    let mut lines = vec![
        format!("kernel {}: {}", kernel.name, counted(kernel.rows, "row")),
        format!("  active variables: {}", names(0..kernel.slots)),
        format!("  other inputs:     {}", names(kernel.slots..kernel.slots + kernel.data)),
    ];
    let head = |title: &str| format!("  {title:<LABEL$}  degree     d/d {}", names(0..kernel.slots).replace(',', ""));
    lines.push(if kernel.slots > 0 { head("row") } else { format!("  {:<LABEL$}  degree", "row") });
    for row in 0..kernel.rows {
        let label = cut(body.labels.get(row).map_or("", String::as_str));
        let degree = degree(kernel.degree.get(row).copied());
        let has = |slot| kernel.jacobian.contains(&(row, slot));
        let marks = (0..kernel.slots).map(|slot| mark(has(slot), &body.names[slot]));
        lines.push(format!("  {label:<LABEL$}  {degree:<9}      {}", marks.collect::<String>()));
    }
    if !kernel.hessian.is_empty() {
        lines.push(format!("  second derivatives: {} in the lower triangle", kernel.hessian.len()));
        for i in 0..kernel.slots {
            let has = |j| kernel.hessian.contains(&(i, j));
            let marks = (0..=i).map(|j| mark(has(j), &body.names[j]));
            lines.push(format!("  {:>LABEL$}                 {}", body.names[i], marks.collect::<String>()));
        }
    }
    lines.iter().map(|line| line.trim_end()).collect::<Vec<_>>().join("\n")
}

/// One cell of a picture, as wide as the name above it.
fn mark(is_there: bool, name: &str) -> String {
    let width = name.chars().count();
    format!("{:<width$} ", if is_there { "#" } else { "." })
}

fn degree(degree: Option<Degree>) -> &'static str {
    match degree {
        Some(Degree::Constant) => "constant",
        Some(Degree::Linear) => "linear",
        Some(Degree::Quadratic) => "quadratic",
        Some(Degree::Nonlinear) | None => "nonlinear",
    }
}

fn counted(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

/// The text on one line, cut to its column.
fn cut(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if line.chars().count() <= LABEL {
        return line;
    }
    line.chars().take(LABEL - 3).chain("...".chars()).collect()
}
