//! Runs a compiled problem without rustc.
//!
//! Takes a `Program` of the compiler, gives a `Problem` of the runtime: each kernel becomes a
//! *tape*, a list of operations on registers, and each operation runs over many points at once
//! (docs/maths.md, section 2.6).
//! Tape and generated code compute the same operations in the same order through the same `math`
//! module, so that they agree bit for bit.

mod embedded;
mod finding;
mod parameters;
mod run;
mod tape;
mod text;

pub use embedded::{Embedded, Spec};
pub use finding::finding;
pub use parameters::{Place, SetError};
pub use text::{bracketed, quantity, target};

use std::sync::{Arc, Mutex, OnceLock};

use ntg_compiler::program::{KernelBody, Program, parametric};
use ntg_runtime::problem::{Derivatives, Lanes, Parametric, Problem};
use ntg_splines::Table;
use ntg_structure::Structure;

use run::{Columns, run};
use tape::Tape;

/// A problem that is interpreted. Parameters are set by name; see [`Interpreted::set`].
///
/// Clones have parameters of their own and share the tapes.
pub struct Interpreted {
    structure: Structure,
    kernels: Arc<[Tapes]>,
    /// The formulas, and the form in which parameters are variables, which is made where it is asked for.
    formulas: Arc<Formulas>,
    /// Registers that a finished call has left for the next: one set for each thread at work.
    spare: Mutex<Vec<Vec<f64>>>,
}

/// What tapes were made of.
struct Formulas {
    kernels: Vec<KernelBody>,
    parametric: OnceLock<Interpreted>,
}

/// The three functions of one kernel.
struct Tapes {
    values: Tape,
    derivatives: Tape,
    probes: Tape,
}

impl Interpreted {
    /// Makes the tapes of all kernels.
    pub fn new(program: &Program) -> Self {
        let kernels = (program.kernels.iter())
            .map(|body| {
                let all = [&body.values[..], &body.jacobian, &body.hessian].concat();
                Tapes {
                    values: Tape::new(&body.dag, &body.values),
                    derivatives: Tape::new(&body.dag, &all),
                    probes: Tape::new(&body.dag, &body.probes),
                }
            })
            .collect();
        let formulas = Arc::new(Formulas { kernels: program.kernels.clone(), parametric: OnceLock::new() });
        Self { structure: program.structure.clone(), kernels, formulas, spare: Mutex::new(Vec::new()) }
    }

    fn with_registers(&self, work: impl FnOnce(&mut Vec<f64>)) {
        let lock = || self.spare.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let mut registers = lock().pop().unwrap_or_default();
        work(&mut registers);
        lock().push(registers);
    }
}

impl Clone for Interpreted {
    fn clone(&self) -> Self {
        let (kernels, formulas) = (Arc::clone(&self.kernels), Arc::clone(&self.formulas));
        Self { structure: self.structure.clone(), kernels, formulas, spare: Mutex::default() }
    }
}

impl Parametric for Interpreted {
    fn parametric(&self) -> Arc<dyn Problem + Send + Sync> {
        let made = self.formulas.parametric.get_or_init(|| {
            let (structure, kernels) = (self.structure.clone(), self.formulas.kernels.clone());
            Interpreted::new(&parametric(&Program { structure, kernels }))
        });
        let mut form = made.clone();
        form.structure.parameters.clone_from(&self.structure.parameters);
        form.structure.tables.clone_from(&self.structure.tables);
        Arc::new(form)
    }
}

impl Problem for Interpreted {
    fn structure(&self) -> Structure {
        self.structure.clone()
    }

    fn update(&self, structure: &mut Structure) {
        if *structure != self.structure {
            structure.clone_from(&self.structure);
        }
    }

    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], values: &mut [f64]) {
        let input = Columns { lanes, first: inputs, second: &[] };
        self.with_registers(|registers| run(&self.kernels[kernel].values, input, tables, registers, &mut [values]));
    }

    fn derivatives(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>) {
        let input = Columns { lanes: point.lanes, first: point.inputs, second: point.weights };
        let mut parts = [out.values, out.jacobian, out.hessian];
        self.with_registers(|registers| {
            run(&self.kernels[kernel].derivatives, input, tables, registers, &mut parts);
        });
    }

    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]) {
        let input = Columns { lanes, first: inputs, second: &[] };
        self.with_registers(|registers| run(&self.kernels[kernel].probes, input, tables, registers, &mut [probes]));
    }
}
