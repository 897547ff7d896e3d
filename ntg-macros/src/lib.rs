//! The macros of ntg: a shell around the compiler.
//!
//! Takes tokens or a path, gives what `ntg_compiler` makes of them, with rustc's errors at the
//! user's own words. No mathematics here.

mod expand;
mod include;
mod report;
mod span_map;

/// Compiles a spec that is written in place.
///
/// ```text
/// ntg::ntg! {
///     /// From rest to rest with the least effort.
///     problem RestToRest {
///         duration T = 2 [s];
///         param distance = 1 [m];
///         output x [m]: spline(order = 6, intervals = 4);
///         minimize integral(der(x, 2)^2);
///         initial { x == 0;  der(x) == 0; }
///         final   { x == distance;  der(x) == 0; }
///     }
/// }
/// ```
///
/// The expansion holds two types:
///
/// - `RestToRest`, with a public field for each `param` in its declared unit, `Default` for the
///   defaults of the spec, and `solve`;
/// - `RestToRestSolution`, with a public field for each `output` and a method for everything else
///   that has a name.
///
/// The text is the same as in a spec file. Errors underline the words that they are about, as many
/// as there are in one build. Tables are read relative to the crate's `Cargo.toml`, and cargo
/// rebuilds the crate when one of them changes.
#[proc_macro]
pub fn ntg(spec: proc_macro::TokenStream) -> proc_macro::TokenStream {
    expand::inline(spec.into()).into()
}

/// Compiles a spec file; the path is relative to the crate's `Cargo.toml`.
///
/// ```text
/// ntg::ntg_file!("specs/van_der_pol.ntg");
/// ```
///
/// gives what [`ntg!`] would give for the file's text. Errors name the file, line and column, with
/// a picture of the place. cargo rebuilds the crate when the file changes, or a table that it reads
/// (those are relative to the spec file).
///
/// Numbers that the spec declares by `const`, sizes among them, may have other values, in their unit or with a unit:
///
/// ```text
/// ntg::ntg_file!("specs/chain.ntg", links = 50, gravity = 3.7 [m/s^2]);
/// ```
#[proc_macro]
pub fn ntg_file(path: proc_macro::TokenStream) -> proc_macro::TokenStream {
    expand::file(path.into()).into()
}
