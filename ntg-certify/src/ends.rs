//! What end conditions fix at the ends of splines.
//!
//! A solver meets an end condition to rounding, so that no bound is kept which it meets with equality. The first
//! coefficient of a spline is its value at the start, and where derivatives vanish there, so many more coefficients equal
//! it: written with these values to the last bit, the spline meets the condition exactly (docs/maths.md, section 15.6).

use std::collections::BTreeMap;

use ntg_runtime::solution::Solution;

use crate::evaluate::{Here, Machine};
use crate::interval::Interval;
use crate::jet::Jet;
use crate::statement::{Flat, Input, Kind, Node, Over, Quantity, Statement, Subject};

/// For each spline, at its start or at its end, the value and how many of the lowest derivatives vanish.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ends(BTreeMap<(usize, bool), (f64, usize)>);

impl Ends {
    /// What the end conditions of a statement fix.
    pub(crate) fn of(machine: &Machine<'_>) -> Self {
        let mut values: BTreeMap<(usize, bool), f64> = BTreeMap::new();
        let mut vanishing: BTreeMap<(usize, bool), Vec<usize>> = BTreeMap::new();
        for subject in machine.statement.subjects.iter().filter(|subject| matches!(subject.kind, Kind::Constraint(_))) {
            let Some((flat, last, function)) = alone(machine, subject) else { continue };
            let Some(bound) = subject.bounds.0.map(|bound| machine.number(bound, None)).filter(|bound| bound.total)
            else {
                continue;
            };
            let (bound, own) = (bound.c[0], machine.statement.flats[flat]);
            if own.derivative == 0 && is_the_flat(machine.statement, function) && bound.width() == 0.0 {
                values.insert((own.spline, last), bound.low());
            } else if own.derivative > 0 && bound == Interval::ZERO && vanishes_with(machine, function, flat) {
                vanishing.entry((own.spline, last)).or_default().push(own.derivative);
            }
        }
        let each = values.into_iter().map(|(end, value)| {
            let zero = vanishing.get(&end).map_or(&[][..], |own| own);
            let count = (1..).take_while(|derivative| zero.contains(derivative)).count();
            (end, (value, count))
        });
        Self(each.collect())
    }

    /// Whether the end condition fixes this derivative, to the last bit.
    pub(crate) fn fix(&self, flat: Flat, last: bool) -> bool {
        self.0.get(&(flat.spline, last)).is_some_and(|(_, vanishing)| flat.derivative <= *vanishing)
    }

    /// The solution with what is fixed to the last bit; none where it has that, or differs by more than the `margin` part
    /// of its size.
    pub(crate) fn exactly(&self, solution: &Solution, margin: f64) -> Option<Solution> {
        let (mut x, mut is_other) = (solution.coefficients().to_vec(), false);
        let splines = solution.splines();
        for (&(spline, last), &(value, vanishing)) in &self.0 {
            let Some(view) = splines.get(spline) else { continue };
            let count = view.coefficients.len();
            let size = view.coefficients.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
            for number in (0..=vanishing).take_while(|number| *number < count) {
                let number = if last { count - 1 - number } else { number };
                let Some(variable) = solution.coefficient(spline, number) else { continue };
                if x[variable] != value && (x[variable] - value).abs() <= margin * size {
                    (x[variable], is_other) = (value, true);
                }
            }
        }
        solution.with_coefficients(x).filter(|_| is_other)
    }
}

/// The one flat at one end that an equality is about, with its function.
fn alone(machine: &Machine<'_>, subject: &Subject) -> Option<(usize, bool, usize)> {
    let Quantity::Sum(summands) = &subject.quantity else { return None };
    let [summand] = summands[..] else { return None };
    if subject.bounds.0.is_none() || subject.bounds.0 != subject.bounds.1 {
        return None;
    }
    let mut found = None;
    for input in machine.inputs(summand.function) {
        let own = match (input, summand.over) {
            (Input::Flat(flat), Over::Start(_)) | (Input::Start(flat), _) => (*flat, false),
            (Input::Flat(flat), Over::End(_)) | (Input::End(flat), _) => (*flat, true),
            (Input::Number(_) | Input::Value(_), _) => continue,
            _ => return None,
        };
        if found.replace(own).is_some() {
            return None;
        }
    }
    found.map(|(flat, last)| (flat, last, summand.function))
}

/// Whether a function of one flat is that flat.
fn is_the_flat(statement: &Statement, function: usize) -> bool {
    let own = &statement.functions[function];
    let graph = &statement.graphs[own.graph];
    let Node::Input(input) = graph.nodes[graph.rows[own.row]] else { return false };
    matches!(own.inputs.get(input), Some(Input::Flat(_) | Input::Start(_) | Input::End(_)))
}

/// Whether a function is 0 where its one flat is.
fn vanishes_with(machine: &Machine<'_>, function: usize, flat: usize) -> bool {
    let mut flats = vec![None; machine.statement.flats.len()];
    flats[flat] = Some(Jet::<1>::constant(Interval::ZERO));
    // A flat that is named at an end is looked up there, and is not what is put here.
    let is_here = machine.inputs(function).all(|input| !matches!(input, Input::Start(_) | Input::End(_)));
    let value = machine.evaluate(function, &Here { flats, tau: Jet::constant(Interval::ENTIRE) });
    is_here && value.total && value.c[0] == Interval::ZERO
}
