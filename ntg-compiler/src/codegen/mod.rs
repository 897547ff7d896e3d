//! A program as Rust: what `ntg!` expands to, and what `ntg expand` prints.
//!
//! Takes a `Program`, gives items. Knows Rust and the names of the runtime, no calculus: every
//! formula is already there.
//!
//! ```text
//! pub use van_der_pol_ntg::{VanDerPol, VanDerPolSolution};
//! mod van_der_pol_ntg {
//!     pub struct VanDerPol { .. }          problem.rs    parameters in their declared units
//!     pub struct VanDerPolSolution { .. }  solution.rs   outputs as fields, the rest as methods,
//!                                          members.rs    each a question to the untyped solution
//!     mod contract { .. }                  problem.rs    `impl Kernels for VanDerPol`
//!     mod structure { .. }                 data.rs       everything but the formulas
//!     mod kernels { .. }                   function.rs   the formulas
//! }
//! ```
//!
//! Nothing but the public types leaves the module. Names of the spec and names of the runtime
//! never meet in one scope: where the user's types are, the runtime's are written with their path.
//!
//! Afterwards: the same program gives the same tokens; their number grows with the formulas, never
//! with breakpoints or the sizes of families.

mod data;
mod expression;
mod function;
mod kernels;
mod members;
mod names;
mod parameters;
mod problem;
mod solution;
mod structure;
mod tree;

use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

use crate::program::Program;
use names::ident_at;
pub use parameters::in_unit;

/// The items that a spec expands to.
pub fn generate(program: &Program) -> TokenStream {
    generate_at(program, &|_| Span::call_site())
}

/// What the generated type of a problem is called.
pub fn type_name(problem: &str) -> Ident {
    ident_at(problem, Span::call_site())
}

/// As [`generate`]; identifiers that stand for a name in the spec take the place that `place_of`
/// gives for that name, so that rustc's own messages about them point at the spec.
pub fn generate_at(program: &Program, place_of: &dyn Fn(&str) -> Span) -> TokenStream {
    let name = &program.structure.name;
    let kernels = kernels::kernels(program);
    let problem = problem::problem(program, &kernels, place_of);
    let solution = solution::solution(program, place_of);
    let structure = structure::structure(&program.structure);

    let public = ident_at(name, place_of(name));
    let of_solution = solution::type_name(name);
    let module = format_ident!("{}_ntg", names::snake(public.to_string().trim_start_matches("r#")));
    let functions = kernels.items;
    quote! {
        #[allow(unreachable_pub, unused_imports, reason = "a program need not use both")]
        pub use #module::{#public, #of_solution};

        #[allow(
            dead_code, missing_docs, non_camel_case_types, non_snake_case, unreachable_pub, unused_imports,
            unused_variables, confusable_idents, mixed_script_confusables,
            clippy::all, clippy::pedantic, clippy::nursery,
            reason = "generated from a spec, whose author chose the names"
        )]
        mod #module {
            #problem
            #solution
            #structure
            #functions
        }
    }
}
