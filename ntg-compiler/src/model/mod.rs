//! From what was written to what is meant: names, dimensions, times, tables, one graph.
//!
//! Takes `ast::Spec`, gives [`problem::Problem`]. Small passes collect what is declared, one pass
//! elaborates every expression (`elaborator`, `expression`), and `check` looks at the whole.
//! All findings are told at once: a name that is wrong does not hide the next.
//! Afterwards: no names are left in expressions, every dimension is right, and everything is in SI units.

mod acknowledged;
mod always;
pub(crate) mod angles;
mod arguments;
mod bare_angles;
mod bodies;
mod borrowed;
mod branches;
mod check;
mod clamps;
mod collocated;
mod conditions;
mod cones;
mod constants;
mod constraints;
mod continuity;
mod corners;
mod covered;
mod declarations;
mod definitions;
mod degenerate;
mod derivatives;
mod dimension;
mod dynamics;
mod elaborator;
mod element;
mod element_text;
mod epigraph;
mod expression;
mod families;
mod files;
mod fixed_terms;
mod function_habits;
mod functions;
mod given;
#[cfg(test)]
mod growth;
mod guess;
mod guess_checks;
mod helps;
mod impulses;
mod independent;
mod invariants;
mod kinds;
mod knots_apart;
mod known_shapes;
mod library;
mod listed;
pub mod loading;
mod measure;
mod mention;
mod mission;
mod monotone;
mod named;
mod names;
pub(crate) mod norms;
mod objective;
mod order;
mod outputs;
mod paired;
mod parametric_ranges;
mod part_ends;
mod parts;
mod paths;
mod periodic;
mod piecewise;
mod places;
pub mod problem;
mod quantities;
mod ranges;
mod rates;
mod reductions;
mod relaxed;
mod rename;
mod repeat;
mod resting;
mod rewritten;
mod route;
mod rows;
mod scenarios;
mod scope;
mod settle;
mod shape;
mod shape_calls;
mod shape_names;
mod shared;
mod shown_unit;
mod sides;
mod signs;
mod size;
mod smoothed;
mod soft;
mod steps;
mod straight;
mod suggest;
mod table_data;
mod table_report;
mod tables;
mod time;
pub mod tools;
mod trial;
mod unitless;
mod units;
mod unknowns;
mod unrolled;
mod value;
mod vectors;
mod weighted;
mod widths;
mod windows;

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::source::{Source, Span};
use crate::syntax::{self, ast};
use elaborator::{Elaborator, doc_text};
pub use given::{Given, constants, given};
use library::Libraries;
use problem::Problem;

/// Gets the text of the files that a spec names; the compiler reads none itself. Loaders of files read them by [`loading::text`].
pub trait Loader {
    /// The text of a file whose path is as the spec writes it, or why it cannot be had.
    ///
    /// # Errors
    /// A reason for a person, such as `no such file`.
    fn load(&self, path: &str) -> Result<String, String>;
}

/// The meaning of a spec, and everything found on the way: errors, then there is no problem, and
/// notes, which are in `Problem::notes` too.
pub fn build(spec: &ast::Spec, source: &Source, loader: &dyn Loader) -> (Option<Problem>, Vec<Diagnostic>) {
    build_with(spec, source, loader, &[])
}

/// As [`build`], with other values of some constants.
pub fn build_with(
    spec: &ast::Spec,
    source: &Source,
    loader: &dyn Loader,
    given: &[Given],
) -> (Option<Problem>, Vec<Diagnostic>) {
    let libraries = Libraries::load(&spec.uses, source, loader);
    let (mut problem, found) = elaborated(spec, &libraries, loader, given);
    let mut found = acknowledged::left(spec, libraries.told(found, None));
    let failed = found.iter().any(|finding| finding.severity == Severity::Error);
    found.sort_by_key(|finding| (finding.span.start, finding.span.end));
    problem.notes = found.iter().filter(|finding| finding.severity != Severity::Error).cloned().collect();
    ((!failed).then_some(problem), found)
}

/// What a spec means with its libraries, and what was found, in places of the joined text.
fn elaborated(
    spec: &ast::Spec,
    libraries: &Libraries,
    loader: &dyn Loader,
    given: &[Given],
) -> (Problem, Vec<Diagnostic>) {
    let pass = |problem: &ast::Problem| elaborated_once(problem, (libraries, &spec.uses), loader, given);
    let (problem, found) = pass(&spec.problem);
    let found = borrowed::told_once(&spec.problem, &libraries.joined, found, &|other| pass(other).1);
    (problem, without_lists(found))
}

/// Without what is said of elements of a list that is of several kinds: that is told of the list.
fn without_lists(mut found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mixed = found.iter().filter(|finding| finding.code == Code::MixedVector).map(|finding| finding.span);
    let mixed: Vec<Span> = mixed.collect();
    found.retain(|own| own.code != Code::DimensionMismatch || !mixed.iter().any(|list| own.span.contains(*list)));
    found
}

fn elaborated_once(
    spec: &ast::Problem,
    (libraries, uses): (&Libraries, &[ast::Use]),
    loader: &dyn Loader,
    given: &[Given],
) -> (Problem, Vec<Diagnostic>) {
    let (expanded, misplaced) = scenarios::expanded(spec);
    let mut pass = Elaborator::new(&libraries.joined, loader);
    pass.elaborate(&expanded, (libraries, uses), given);
    let Elaborator { mut found, problem, .. } = pass;
    let scenarios = scenarios::scenarios(&spec.items);
    found.iter_mut().for_each(|finding| scenarios::in_own_words(finding, &scenarios));
    // What leads nowhere in a scenario has no meaning elsewhere either.
    found.retain(|finding| {
        misplaced.iter().all(|other| !(other.span.start <= finding.span.start && finding.span.end <= other.span.end))
    });
    found.extend(misplaced);
    (problem, found)
}

/// Everything found in a library by itself: each function that states its arguments is tried with such arguments.
pub fn check_library(source: &Source, loader: &dyn Loader) -> Vec<Diagnostic> {
    let library = match syntax::parse_library(source, 0) {
        Ok(library) => library,
        Err(found) => return found.into_iter().collect(),
    };
    let around = trial::around(&library);
    let mut found = match syntax::parse(&around) {
        Ok(spec) => {
            let libraries = Libraries::of_library(source, &around, loader);
            let (_, found) = elaborated(&trial::using(spec), &libraries, loader, &[]);
            libraries.told(found, Some(0))
        }
        Err(_) => vec![], // A name that makes no spec was told of.
    };
    found.sort_by_key(|finding| (finding.span.start, finding.span.end));
    found
}

impl<'a> Elaborator<'a> {
    /// The pass, step by step; each needs what the ones before it have found.
    fn elaborate(
        &mut self,
        problem: &'a ast::Problem,
        (libraries, uses): (&'a Libraries, &'a [ast::Use]),
        given: &[Given],
    ) {
        self.problem.name.clone_from(&problem.name.text);
        self.problem.doc = doc_text(&problem.doc);
        self.problem.span = problem.name.span;
        if unitless::is_unitless(&problem.items) {
            self.time = dimension::Dimension::NONE;
            self.problem.independent.unit = ntg_structure::Unit::default();
        }
        self.independent(&problem.items);
        self.declarations(problem);
        self.independent_named(&problem.items);
        if !libraries.uses.is_empty() {
            self.libraries(libraries, uses);
        }
        self.constants_from_outside(given);
        self.order_phases();
        self.file_sizes();
        self.parameters();
        self.continuations();
        self.all_tables();
        self.skeleton();
        self.outputs();
        self.variables();
        self.durations();
        self.shared();
        self.shapes = Some(known_shapes::KnownShapes::default());
        self.continuity();
        self.periodic();
        self.objective();
        self.constraints();
        self.named();
        self.guesses();
        self.part_ends();
        self.orders_needed();
        self.jumps_noted();
        self.check();
        self.always_holding();
        self.knots_apart();
        self.invariants();
        self.corners();
    }
}
