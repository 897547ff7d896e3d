//! The typed solution: outputs are fields, everything else that has a name is a method.
//!
//! Takes a `Program`, gives `VanDerPolSolution` and one such struct for each named agent and
//! phase, nested as in the spec: `solution.x`, `solution.covert.x`, `solution.uav(1).x`.
//! A member of a family is reached by a call, anything single by a field. Vectors and matrices are fields and
//! methods: `solution.r.at(t)` and `solution.r().at(t)` are `[f64; 3]`. All of them share the
//! runtime's untyped solution and ask it by path; the paths are the spec's own.
//!
//! Fields are the user's names and one of ours that begins with `_`, as no name of a spec does.
//! Among methods ours come first: a `let report` is reached as `report_()`.

use ntg_structure::{Domain, Family, Named, Structure, Unit, Variable};
use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

use super::members::{self, Question, Shape};
use super::names::{self, camel, ident_at};
use super::parameters::{doc_lines, unit_in_words};
use super::tree::{Kind, Scope, scopes};
use crate::program::Program;

/// Methods that are ours.
const OURS: [&str; 12] = [
    "objective",
    "is_solved",
    "has_solution",
    "status",
    "times",
    "report",
    "untyped",
    "start",
    "end",
    "duration",
    "new",
    "clone",
];

/// `VanDerPolSolution`.
pub(super) fn type_name(problem: &str) -> Ident {
    format_ident!("{}Solution", names::ident(problem).to_string().trim_start_matches("r#"))
}

/// The problem's methods that solve it.
pub(super) fn solve(structure: &Structure, name: &Ident) -> TokenStream {
    let solution = type_name(&structure.name);
    quote! {
        impl #name {
            /// Solves the problem from the guess of the spec. Ask the solution's `is_solved` whether
            /// one was found; if not, it is the point at which the solver stopped.
            ///
            /// # Errors
            /// The problem cannot be set up with these parameters, or a setting is out of its range.
            pub fn solve(
                &self,
                settings: &::ntg::runtime::settings::Settings,
            ) -> ::core::result::Result<#solution, ::ntg::runtime::Error> {
                ::ntg::runtime::solve(self, settings).map(|report| #solution::new(self, report))
            }

            /// Solves the problem from a guess of the program: a route, an earlier solution, or
            /// coefficients.
            ///
            /// # Errors
            /// As `solve`; and the guess does not fit the problem.
            pub fn solve_from(
                &self,
                guess: &::ntg::runtime::guess::Guess,
                settings: &::ntg::runtime::settings::Settings,
            ) -> ::core::result::Result<#solution, ::ntg::runtime::Error> {
                ::ntg::runtime::solve_from(self, guess, settings).map(|report| #solution::new(self, report))
            }

            /// A solver of this problem that keeps whatever does not change between solves: for a problem that is
            /// solved again and again with other parameters, each time from the last solution.
            pub fn solver(
                &self,
                settings: &::ntg::runtime::settings::Settings,
            ) -> ::ntg::runtime::Solver<Self, #solution> {
                ::ntg::runtime::Solver::typed(::core::clone::Clone::clone(self), settings, #solution::new)
            }

            /// Solves the problem from many starts, side by side, and gives every local minimum
            /// that was found once, the best first.
            ///
            /// # Errors
            /// As `solve`. A start that fails is counted and is no error.
            pub fn multistart(
                &self,
                starts: &::ntg::runtime::multistart::Starts,
                settings: &::ntg::runtime::settings::Settings,
            ) -> ::core::result::Result<::ntg::runtime::multistart::Minima<#solution>, ::ntg::runtime::Error> {
                let found = ::ntg::runtime::multistart::multistart(self, starts, settings)?;
                Ok(::ntg::runtime::multistart::Minima::new(found, |report| #solution::new(self, report)))
            }
        }
    }
}

/// The solution's struct, and those of the agents and phases within.
pub(super) fn solution(program: &Program, place_of: &dyn Fn(&str) -> Span) -> TokenStream {
    let structure = &program.structure;
    let mut types = names::Scope::with(&[]);
    types.take(&structure.name, |_| false);
    let own = type_name(&structure.name);
    types.take(&own.to_string(), |_| false);
    let writer = Writer { structure, place_of };

    let mut items = vec![];
    // A list of scopes still to be written, instead of a recursion.
    let mut open = vec![(scopes(structure), own)];
    while let Some((scope, name)) = open.pop() {
        let children: Vec<Ident> = scope.children.iter().map(|child| writer.child_type(child, &mut types)).collect();
        items.push(writer.scope(&scope, &name, &children));
        open.extend(scope.children.into_iter().zip(children).rev());
    }
    quote! {
        #(#items)*

        /// What a solution of this problem has by construction.
        fn known<T>(found: ::core::option::Option<T>) -> T {
            found.expect("a solution knows the names of its problem")
        }
    }
}

/// What every part of the solution needs.
struct Writer<'a> {
    structure: &'a Structure,
    place_of: &'a dyn Fn(&str) -> Span,
}

impl Writer<'_> {
    /// `LowObservableCovert` for the phase `covert` of the problem `LowObservable`.
    fn child_type(&self, scope: &Scope<'_>, types: &mut names::Scope) -> Ident {
        let path: String = scope.path.iter().map(|(name, _)| camel(name)).collect();
        names::ident(&types.take(&format!("{}{path}", self.structure.name), |_| false))
    }

    fn ident(&self, name: &str) -> Ident {
        ident_at(name, (self.place_of)(name))
    }

    /// The struct of one scope, how it is made, and its methods.
    fn scope(&self, scope: &Scope<'_>, name: &Ident, children: &[Ident]) -> TokenStream {
        let in_root = scope.kind == Kind::Problem;
        let mut parts = Parts { fields: vec![], values: vec![], methods: vec![], names: names::Scope::with(&OURS) };
        for output in &scope.outputs {
            let ident = self.ident(&output.name);
            let doc = doc_lines(&output.doc, &in_unit(&output.unit));
            let shape = output.family.map(|family| Shape { family });
            let (kind, value) = (members::trajectory(shape), members::output(&output.name, shape, in_root));
            parts.fields.push(quote! { #(#[doc = #doc])* pub #ident: #kind });
            parts.values.push(quote! { #ident: #value });
            if shape.is_some() {
                let method = parts.method(self, &output.name);
                parts.methods.push(quote! {
                    #(#[doc = #doc])*
                    pub fn #method(&self) -> &#kind {
                        &self.#ident
                    }
                });
            }
        }
        for (child, kind) in scope.children.iter().zip(children) {
            self.child(child, kind, in_root, &mut parts);
        }
        self.methods(scope, &mut parts);

        let problem = names::ident(&self.structure.name);
        let Parts { fields, values, methods, .. } = parts;
        let make = if in_root { make_root(&problem, &values) } else { make_child(&problem, &values) };
        let own = match in_root {
            true => quote! { _report: ::std::sync::Arc<::ntg::runtime::report::Report>, },
            false => quote! { _path: ::std::string::String, },
        };
        let doc = self.title(scope);
        quote! {
            #[doc = #doc]
            #[derive(Clone, Debug)]
            pub struct #name {
                #(#fields,)*
                _problem: ::std::sync::Arc<#problem>,
                _solution: ::ntg::runtime::solution::Solution,
                #own
            }

            impl #name {
                #make
                #(#methods)*
            }
        }
    }

    /// An agent or phase within: a field, or for a family a field of ours and a method that takes
    /// the index.
    fn child(&self, child: &Scope<'_>, kind: &Ident, in_root: bool, parts: &mut Parts) {
        let Some((name, family)) = child.path.last().copied() else { return };
        let path = members::path(name, family, (!in_root).then(|| quote! { path }));
        let one = quote! { #kind::new(&problem, &solution, #path) };
        let ident = self.ident(name);
        let Some(Family { first, last, .. }) = family else {
            let doc = format!(" What happens in `{name}`.");
            parts.fields.push(quote! { #[doc = #doc] pub #ident: #kind });
            parts.values.push(quote! { #ident: #one });
            return;
        };
        let (field, value) = (format_ident!("_{}", name), members::members(family, one));
        parts.fields.push(quote! { #field: ::ntg::runtime::solution::Family<#kind> });
        parts.values.push(quote! { #field: #value });
        let ident = parts.method(self, name);
        let doc = format!(" What `{name}[index]` does; `index` is in {first}..={last}.");
        parts.methods.push(quote! {
            #[doc = #doc]
            ///
            /// # Panics
            /// If there is no such member, as for a slice.
            pub fn #ident(&self, index: i64) -> &#kind {
                &self.#field[index]
            }
        });
    }

    /// Everything in a scope that is no field.
    fn methods(&self, scope: &Scope<'_>, parts: &mut Parts) {
        let in_root = scope.kind == Kind::Problem;
        if in_root {
            parts.methods.push(members::of_problem(&self.structure.objective_unit));
            for variable in self.structure.variables.iter().filter(|variable| !variable.is_helper()) {
                self.variable(variable, parts);
            }
        } else {
            parts.methods.push(members::of_stretch());
        }
        for named in &scope.named {
            self.named(named, in_root, parts);
        }
        for duration in &scope.durations {
            let ident = parts.method(self, &format!("duration_{duration}"));
            let doc = [format!(" The duration `{duration}`, in seconds.")];
            parts.methods.push(match in_root {
                true => members::method((&ident, &doc), (Question::Duration, duration), None, true),
                false => members::own_duration(&ident, &doc),
            });
        }
        self.multipliers(scope, parts);
    }

    fn variable(&self, variable: &Variable, parts: &mut Parts) {
        let ident = parts.method(self, &variable.name);
        let doc = doc_lines(&variable.doc, &in_unit(&variable.unit));
        parts.methods.push(members::method(
            (&ident, &doc),
            (Question::Variable, &variable.name),
            variable.family,
            true,
        ));
    }

    fn named(&self, named: &Named, in_root: bool, parts: &mut Parts) {
        let ident = parts.method(self, &named.name);
        let doc = doc_lines(&named.doc, &in_unit(&named.unit));
        let question = if named.domain == Domain::Mission { Question::Number } else { Question::Signal };
        parts.methods.push(members::method((&ident, &doc), (question, &named.name), named.family, in_root));
    }

    /// A method for each constraint of this scope that has a name.
    fn multipliers(&self, scope: &Scope<'_>, parts: &mut Parts) {
        let path: Vec<&str> = scope.path.iter().map(|(name, _)| *name).collect();
        let path = path.join(".");
        let mut written: Vec<&str> = vec![];
        for full in self.structure.constraints.iter().filter_map(|constraint| constraint.name.as_deref()) {
            // The rows of a vector are called `burn[1]`, `burn[2]`: one name for all of them.
            let full = full.split('[').next().unwrap_or(full);
            let (before, name) = full.rsplit_once('.').unwrap_or(("", full));
            if before != path || written.contains(&full) {
                continue;
            }
            written.push(full);
            let ident = parts.method(self, &format!("multiplier_{name}"));
            parts.methods.push(members::multiplier(&ident, name, full));
        }
    }

    fn title(&self, scope: &Scope<'_>) -> String {
        let path: Vec<&str> = scope.path.iter().map(|(name, _)| *name).collect();
        match path.is_empty() {
            true => format!(" A solution of [`{}`].", names::ident(&self.structure.name)),
            false => format!(" What `{}` does in a solution of [`{}`].", path.join("."), self.structure.name),
        }
    }
}

/// A scope's struct being written.
struct Parts {
    fields: Vec<TokenStream>,
    values: Vec<TokenStream>,
    methods: Vec<TokenStream>,
    names: names::Scope,
}

impl Parts {
    /// The name of a method for a name of the spec.
    fn method(&mut self, writer: &Writer<'_>, name: &str) -> Ident {
        ident_at(&self.names.take(name, |_| false), (writer.place_of)(name))
    }
}

/// How the problem's solution is made.
fn make_root(problem: &Ident, values: &[TokenStream]) -> TokenStream {
    quote! {
        fn new(problem: &#problem, report: ::ntg::runtime::report::Report) -> Self {
            let problem = ::std::sync::Arc::new(::std::clone::Clone::clone(problem));
            let solution = ::std::clone::Clone::clone(&report.solution);
            Self {
                #(#values,)*
                _problem: problem,
                _solution: solution,
                _report: ::std::sync::Arc::new(report),
            }
        }
    }
}

/// How an agent or phase of it is made.
fn make_child(problem: &Ident, values: &[TokenStream]) -> TokenStream {
    quote! {
        fn new(
            problem: &::std::sync::Arc<#problem>,
            solution: &::ntg::runtime::solution::Solution,
            path: &str,
        ) -> Self {
            Self {
                #(#values,)*
                _problem: ::std::clone::Clone::clone(problem),
                _solution: ::std::clone::Clone::clone(solution),
                _path: ::std::convert::From::from(path),
            }
        }
    }
}

fn in_unit(unit: &Unit) -> String {
    format!("{}.", unit_in_words(unit))
}
