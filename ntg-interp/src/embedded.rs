//! A spec that a program carries with it, to differentiate what its generated code has solved.
//!
//! Takes the text of a spec as `ntg!` or `ntg_file!` has read it, with its files and its constants; gives the form of
//! the problem in which parameters are variables ([`Parametric`]).
//! Generated code holds no second set of kernels for that form: the text is compiled again where it is asked for, once
//! in a process. Both back ends agree bit for bit, so the derivatives are those of the interpreter.

use std::sync::{Arc, OnceLock};

use ntg_compiler::model::{Given, Loader};
use ntg_compiler::program::Program;
use ntg_compiler::source::Source;
use ntg_runtime::problem::{Parametric, Problem};
use ntg_structure::Structure;

use crate::Interpreted;

/// What a macro has read.
#[derive(Clone, Copy, Debug)]
pub struct Spec {
    /// The name of the spec, as findings give it.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
    /// Libraries and tables: paths as the spec writes them, and texts.
    pub files: &'static [(&'static str, &'static str)],
    /// Constants with other values than those of the text: names and values.
    pub given: &'static [(&'static str, &'static str)],
}

/// A spec, and the problem that it is, once that has been asked for.
pub struct Embedded {
    spec: Spec,
    problem: OnceLock<Interpreted>,
}

impl Embedded {
    /// Nothing is compiled yet.
    pub const fn new(spec: Spec) -> Self {
        Self { spec, problem: OnceLock::new() }
    }

    /// The parametric form, with the parameters and the tables of `structure`.
    ///
    /// A text that does not compile, which no macro lets pass, is a problem of nothing: whoever differentiates a
    /// solution refuses it as that of another problem.
    pub fn parametric(&self, structure: Structure) -> Arc<dyn Problem + Send + Sync> {
        let mut problem = self.problem.get_or_init(|| self.spec.interpreted()).clone();
        problem.structure.parameters = structure.parameters;
        problem.structure.tables = structure.tables;
        problem.parametric()
    }
}

impl Spec {
    fn interpreted(&self) -> Interpreted {
        let source = Source::new(self.name, self.text);
        let given = self.given.iter().map(|(name, text)| Given { name: (*name).into(), text: (*text).into() });
        let compiled = ntg_compiler::compile_with(&source, self, &given.collect::<Vec<_>>());
        Interpreted::new(&compiled.map_or_else(|_| Program::default(), |compiled| compiled.program))
    }
}

impl Loader for Spec {
    fn load(&self, path: &str) -> Result<String, String> {
        let known = self.files.iter().find(|(name, _)| *name == path);
        known.map(|(_, text)| (*text).to_owned()).ok_or_else(|| format!("`{path}`: it is not in the program"))
    }
}
