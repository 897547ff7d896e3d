//! The compiler by its stages: the syntax, what a spec means and what is refused, generated code.
//!
//! One program, because each would be linked with all that it stands on; a file has one purpose.

mod codegen_features;
mod codegen_kernels;
mod codegen_problem;
mod codegen_support;
mod data;
mod format;
mod helps;
mod libraries;
mod mistakes;
mod mistakes_codes;
mod mistakes_words;
mod model_ambiguities;
mod model_conditions;
mod model_corners;
mod model_invariants;
mod model_limits;
mod model_meaning;
mod model_mission;
mod model_places;
mod model_reduced;
mod model_refusals;
mod model_robust;
mod model_scenarios;
mod model_soft;
mod model_specs;
mod model_support;
mod model_vectors;
mod syntax_accepts;
mod syntax_errors;
mod syntax_limits;
