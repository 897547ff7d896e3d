//! The members of a typed solution, each a question to the untyped one.
//!
//! Everything that generated code asks of `::ntg::runtime::Solution` is in this file. Questions
//! are paths: `x`, `x[3]`, `covert.x`, `uav[2].leg[1].x`.

use ntg_structure::{Family, Unit};
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::data::ToRust;
use super::parameters::unit_in_words;

/// What a question is about.
#[derive(Clone, Copy)]
pub(super) enum Question {
    /// An output along the scope.
    Output,
    /// A named expression along the scope.
    Named,
    /// A named expression that is a number.
    Number,
    /// A declared variable.
    Variable,
    /// A named duration.
    Duration,
    /// The multipliers of a named constraint.
    Multiplier,
}

impl Question {
    /// The method of the untyped solution.
    fn method(self) -> TokenStream {
        match self {
            Self::Output => quote! { output },
            Self::Named => quote! { named },
            Self::Number => quote! { number },
            Self::Variable => quote! { variable },
            Self::Duration => quote! { duration },
            Self::Multiplier => quote! { multiplier },
        }
    }

    /// The type of the answer.
    fn answer(self) -> TokenStream {
        match self {
            Self::Output | Self::Named => quote! { ::ntg::runtime::Trajectory },
            Self::Multiplier => quote! { ::ntg::runtime::Multiplier },
            Self::Number | Self::Variable | Self::Duration => quote! { f64 },
        }
    }
}

/// The type of an answer, or of a family of answers.
pub(super) fn kind(question: Question, family: Option<Family>) -> TokenStream {
    let answer = question.answer();
    match family {
        None => answer,
        Some(_) => quote! { ::ntg::runtime::Family<#answer> },
    }
}

/// The expression that asks `solution` for `name` below `path`, both local variables.
/// The solution knows every name of the structure that it was made from.
pub(super) fn ask(question: Question, name: &str, family: Option<Family>, in_root: bool) -> TokenStream {
    let method = question.method();
    let path = path(name, family.is_some(), in_root);
    let one = quote! { solution.#method(#path).expect("the solution knows the names of its problem") };
    match family {
        None => one,
        Some(family) => members(family, &one),
    }
}

/// A family of what `one` is for the index `i`.
pub(super) fn members(Family { first, last }: Family, one: &TokenStream) -> TokenStream {
    let (first, last) = (first.to_rust(), last.to_rust());
    quote! { ::ntg::runtime::Family::new(#first, (#first..=#last).map(|i| #one).collect()) }
}

/// `"x"`, `&format!("{path}.x[{i}]")`: the path of a thing in this scope.
pub(super) fn path(name: &str, indexed: bool, in_root: bool) -> TokenStream {
    let index = if indexed { "[{i}]" } else { "" };
    match (indexed, in_root) {
        (false, true) => {
            let name = Literal::string(name);
            quote! { #name }
        }
        (_, true) => {
            let format = Literal::string(&format!("{name}{index}"));
            quote! { &::std::format!(#format) }
        }
        (_, false) => {
            let format = Literal::string(&format!("{{path}}.{name}{index}"));
            quote! { &::std::format!(#format) }
        }
    }
}

/// A documented method that asks a question.
pub(super) fn method(
    ident: &Ident,
    doc: &[String],
    question: Question,
    name: &str,
    family: Option<Family>,
    in_root: bool,
) -> TokenStream {
    let (answer, kind) = (ask(question, name, family, in_root), kind(question, family));
    let path = (!in_root).then(|| quote! { let path = &self._path; });
    quote! {
        #(#[doc = #doc])*
        pub fn #ident(&self) -> #kind {
            let solution = &self._solution;
            #path
            #answer
        }
    }
}

/// What every problem's solution answers.
pub(super) fn of_problem(objective: &Unit) -> TokenStream {
    let doc = format!(" The objective, in the sense in which the spec states it. {}.", unit_in_words(objective));
    quote! {
        #[doc = #doc]
        pub fn objective(&self) -> f64 {
            self._solution.objective()
        }

        /// `count` equally spaced times from the start to the end of the whole mission, in seconds.
        pub fn times(&self, count: usize) -> ::std::vec::Vec<f64> {
            self._solution.times(count)
        }

        /// How the solve went: why it ended, cost, violations at and between the points.
        pub fn report(&self) -> &::ntg::runtime::Report {
            self._solution.report()
        }

        /// The solution as every problem has it, by names: to save it, or to start from it.
        pub fn untyped(&self) -> &::ntg::runtime::Solution {
            &self._solution
        }
    }
}

/// What every agent and phase answers.
pub(super) fn of_stretch() -> TokenStream {
    quote! {
        /// When it starts, in seconds of mission time.
        pub fn start(&self) -> f64 {
            self._solution.start(&self._path).expect("the solution knows the names of its problem")
        }

        /// When it ends, in seconds of mission time.
        pub fn end(&self) -> f64 {
            self._solution.end(&self._path).expect("the solution knows the names of its problem")
        }

        /// How long it lasts, in seconds.
        pub fn duration(&self) -> f64 {
            self.end() - self.start()
        }
    }
}
