//! The members of a typed solution, each a question to the runtime's untyped one.
//!
//! Everything that generated code asks of `::ntg::runtime::solution` is in this file. Questions
//! are names with the path of their agent or phase: `x`, `x[3]`, `uav[2].x`, `covert.x`. The structs of
//! agents and phases hold that path as `_path`; the problem's own needs none.

use ntg_structure::{Family, Grid, Unit};
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::data::ToRust;
use super::parameters::unit_in_words;

/// What a method asks for.
#[derive(Clone, Copy)]
pub(super) enum Question {
    /// A named expression along an agent's time.
    Signal,
    /// A named expression that is a number.
    Number,
    /// A declared variable.
    Variable,
    /// A named duration of the problem.
    Duration,
}

/// The elements of a vector, or of a matrix row by row.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    /// All elements.
    pub(super) family: Family,
}

impl Shape {
    /// `Vector<T, 3>`, `Matrix<T, 4, 3>`.
    fn kind(self, of: &TokenStream) -> TokenStream {
        let count = Literal::usize_unsuffixed(self.family.len());
        let Some(grid) = self.family.grid else { return quote! { ::ntg::runtime::solution::Vector<#of, #count> } };
        let columns = usize::try_from(grid.columns).unwrap_or(0);
        let rows = Literal::usize_unsuffixed(self.family.len() / columns.max(1));
        let columns = Literal::usize_unsuffixed(columns);
        quote! { ::ntg::runtime::solution::Matrix<#of, #rows, #columns> }
    }

    /// The value for what each element is at its index `i`.
    fn value(self, one: &TokenStream) -> TokenStream {
        let Family { first, last, grid } = self.family;
        let (first, last) = (first.to_rust(), last.to_rust());
        let name = if grid.is_some() {
            quote! { Matrix }
        } else {
            quote! { Vector }
        };
        quote! { ::ntg::runtime::solution::#name::new(#first, (#first..=#last).map(|i| #one).collect()) }
    }
}

/// The type of an output's field.
pub(super) fn trajectory(shape: Option<Shape>) -> TokenStream {
    let one = quote! { ::ntg::runtime::solution::Trajectory };
    shape.map_or_else(|| one.clone(), |shape| shape.kind(&one))
}

/// The value of an output's field, in a function that has `solution`, and `path` where it is not the
/// problem's own.
pub(super) fn output(name: &str, shape: Option<Shape>, in_root: bool) -> TokenStream {
    let family = shape.map(|shape| shape.family);
    let path = path(name, family, if in_root { None } else { Some(quote! { path }) });
    let one = quote! { known(solution.output(#path)) };
    shape.map_or_else(|| one.clone(), |shape| shape.value(&one))
}

/// A documented method that asks a question.
pub(super) fn method(
    (ident, doc): (&Ident, &[String]),
    (question, name): (Question, &str),
    family: Option<Family>,
    in_root: bool,
) -> TokenStream {
    let path = path(name, family, if in_root { None } else { Some(quote! { self._path }) });
    let signal = quote! { known(self._solution.signal(&*self._problem, #path)) };
    let (answer, kind) = match question {
        Question::Signal => (signal, quote! { ::ntg::runtime::solution::Signal<'_> }),
        Question::Number => (quote! { #signal.at(0.0) }, quote! { f64 }),
        Question::Variable => (quote! { known(self._solution.variable(#path)) }, quote! { f64 }),
        Question::Duration => (quote! { known(self._solution.time(#path)) }, quote! { f64 }),
    };
    let shape = family.filter(|_| matches!(question, Question::Signal)).map(|family| Shape { family });
    let (answer, kind) = match shape {
        Some(shape) => (shape.value(&answer), shape.kind(&kind)),
        None => (members(family, answer), in_family(kind, family)),
    };
    quote! {
        #(#[doc = #doc])*
        pub fn #ident(&self) -> #kind {
            #answer
        }
    }
}

/// The duration of an agent or phase under the name that the spec gives it.
pub(super) fn own_duration(ident: &Ident, doc: &[String]) -> TokenStream {
    quote! {
        #(#[doc = #doc])*
        pub fn #ident(&self) -> f64 {
            self.duration()
        }
    }
}

/// `one`, or the family of what it is for each index `i`.
pub(super) fn members(family: Option<Family>, one: TokenStream) -> TokenStream {
    let Some(Family { first, last, .. }) = family else { return one };
    let (first, last) = (first.to_rust(), last.to_rust());
    quote! { ::ntg::runtime::solution::Family::new(#first, (#first..=#last).map(|i| #one).collect()) }
}

fn in_family(kind: TokenStream, family: Option<Family>) -> TokenStream {
    if family.is_some() {
        quote! { ::ntg::runtime::solution::Family<#kind> }
    } else {
        kind
    }
}

/// `"x"`, `&format!("{}.x[{i}]", self._path)`: the path of a thing; `p[{}, {}]` of an element of a matrix.
pub(super) fn path(name: &str, family: Option<Family>, within: Option<TokenStream>) -> TokenStream {
    let grid = family.and_then(|family| Some((family.first, family.grid?)));
    let index = match (family, grid) {
        (_, Some(_)) => "[{}, {}]",
        (Some(_), None) => "[{i}]",
        (None, None) => "",
    };
    let elements = grid.map(|(first, Grid { row, column, columns })| {
        let [first, row, column, columns] = [first, row, column, columns.max(1)].map(Literal::i64_unsuffixed);
        quote! { , #row + (i - #first) / #columns, #column + (i - #first) % #columns }
    });
    match within {
        None if index.is_empty() => {
            let name = Literal::string(name);
            quote! { #name }
        }
        None => {
            let format = Literal::string(&format!("{name}{index}"));
            quote! { &::std::format!(#format #elements) }
        }
        Some(within) => {
            let format = Literal::string(&format!("{{}}.{name}{index}"));
            quote! { &::std::format!(#format, #within #elements) }
        }
    }
}

/// What every problem's solution answers.
pub(super) fn of_problem(objective: &Unit) -> TokenStream {
    let doc = format!(" The objective, in the sense in which the spec states it. {}.", unit_in_words(objective));
    quote! {
        #[doc = #doc]
        pub fn objective(&self) -> f64 {
            self._report.objective
        }

        /// Whether a solution was found within the tolerances; `status` says what happened otherwise.
        pub fn is_solved(&self) -> bool {
            self._report.is_solved()
        }

        /// Whether there is a solution, within the tolerances or at least to 1e-6 (`Status::Acceptable`).
        pub fn has_solution(&self) -> bool {
            self._report.has_solution()
        }

        /// Why the solve ended; it says so in words, and `advice` what to try next.
        pub fn status(&self) -> &::ntg::runtime::status::Status {
            &self._report.status
        }

        /// `count` equally spaced times from the start to the end of the whole mission, in seconds.
        pub fn times(&self, count: usize) -> ::std::vec::Vec<f64> {
            self._solution.times(count)
        }

        /// How the solve went: why it ended, cost, violations at and between the points.
        pub fn report(&self) -> &::ntg::runtime::report::Report {
            &self._report
        }

        /// The solution as every problem has it, by names: to save it, or to start from it.
        pub fn untyped(&self) -> &::ntg::runtime::solution::Solution {
            &self._solution
        }
    }
}

/// A method that gives a constraint's multipliers; `full` is its name with its path.
pub(super) fn multiplier(ident: &Ident, name: &str, full: &str) -> TokenStream {
    let doc = format!(" Multipliers of `{name}`: how the optimum changes with its bound, at each member and point.");
    quote! {
        #[doc = #doc]
        pub fn #ident(&self) -> ::std::vec::Vec<::ntg::runtime::report::Multiplier> {
            self._solution.multipliers(#full)
        }
    }
}

/// What every agent and phase answers.
pub(super) fn of_stretch() -> TokenStream {
    let time = |what: &str| {
        let format = Literal::string(&format!("{what}({{}})"));
        quote! { known(self._solution.time(&::std::format!(#format, self._path))) }
    };
    let [start, end, duration] = ["start", "end", "duration"].map(time);
    quote! {
        /// When it starts, in seconds of mission time.
        pub fn start(&self) -> f64 {
            #start
        }

        /// When it ends, in seconds of mission time.
        pub fn end(&self) -> f64 {
            #end
        }

        /// How long it lasts, in seconds.
        pub fn duration(&self) -> f64 {
            #duration
        }
    }
}
