//! `--what structure`: kernels, elements, and the shape of the optimisation problem.

use std::fmt::Write;

use ntg_compiler::program::Program;
use ntg_runtime::nlp::{Assembly, Nlp, Pattern};
use ntg_runtime::transcribe::Transcription;

/// Kernels, elements, and the shape of the optimisation problem.
pub(super) fn text(program: &Program, transcription: &Transcription<'_>) -> String {
    let mut out = String::new();
    let mut line = |text: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{text}");
    };
    line(format!("{:<16} {:>6} {:>6} {:>6} {:>9} {:>9}", "kernel", "slots", "data", "rows", "jacobian", "hessian"));
    for kernel in &program.structure.kernels {
        let (jacobian, hessian) = (kernel.jacobian.len(), kernel.hessian.len());
        let (name, slots, data, rows) = (&kernel.name, kernel.slots, kernel.data, kernel.rows);
        line(format!("{name:<16} {slots:>6} {data:>6} {rows:>6} {jacobian:>9} {hessian:>9}"));
    }
    line(String::new());
    line(format!("spline coefficients in order of time: {}", transcription.coefficients()));
    line(format!("elements: {}", transcription.blocks().iter().map(|b| b.elements).sum::<usize>()));
    let assembly = Assembly::new(transcription.variables(), transcription.rows(), transcription.blocks());
    line(Pattern::of(&assembly).to_string());
    out
}
