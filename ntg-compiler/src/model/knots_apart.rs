//! Equations between splines on different knots that leave nothing free (docs/maths.md, section 4).
//!
//! Equations hold at the points of every interval of all knots together, and a spline is one polynomial in each interval of its own
//! knots: where it has fewer of them, the same coefficients are to meet an equation again and again. Takes equations along whole
//! phases, those together that share outputs. Where they are more than the coefficients of their outputs, notes each none of whose
//! outputs has the knots of all of its outputs. Few as they are, such coefficients may meet them all: in what is left of the
//! splines, the motions that are smooth at the knots of each. A coarse spline beside a fine one that has its knots is what it
//! says, as a mass that falls evenly.

use std::collections::{BTreeMap, BTreeSet};

use super::elaborator::Elaborator;
use super::epigraph::loops_within;
use super::problem::{At, Collocation, Constraint, Domain, Imposed, Leaf, Part};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use ntg_structure::Spline;

/// Breakpoints nearer than this are one. A law: rounding of a quotient in scaled time.
const SAME: f64 = 1e-12;

/// An equation along a phase.
struct Equation {
    span: Span,
    /// How many equations it is at one point.
    members: usize,
    /// The outputs in it.
    outputs: BTreeSet<usize>,
}

/// Equations that share outputs.
#[derive(Default)]
struct Joined {
    equations: Vec<Equation>,
    outputs: BTreeSet<usize>,
}

impl Elaborator<'_> {
    /// Notes equations between splines on different knots that are more than what could meet them.
    pub(super) fn knots_apart(&mut self) {
        for phase in 0..self.problem.phases.len() {
            let Collocation::Gauss { equalities, .. } = self.problem.phases[phase].collocation else { continue };
            let outputs = &self.problem.phases[phase].outputs;
            let (all, most) = self.breakpoints_together(phase, 0..outputs.len());
            if all == most {
                continue;
            }
            let intervals = all.saturating_sub(1);
            let mut noted = vec![];
            for joined in self.joined_equations(phase) {
                let members: usize = joined.equations.iter().map(|equation| equation.members).sum();
                let rows = members.saturating_mul(equalities).saturating_mul(intervals);
                let coefficients: usize = joined.outputs.iter().map(|output| self.coefficients(phase, *output)).sum();
                if rows <= coefficients {
                    continue;
                }
                let is_apart = |equation: &&Equation| {
                    let (all, most) = self.breakpoints_together(phase, equation.outputs.iter().copied());
                    all > most
                };
                for equation in joined.equations.iter().filter(is_apart) {
                    let own = equation.outputs.iter().map(|output| {
                        let output = &outputs[*output];
                        format!("`{}` has {}", output.name, counted(output.spline.breakpoints.len().saturating_sub(1)))
                    });
                    let message = format!(
                        "{}, and the points of an equation are in each of {intervals}, those of all knots together: {rows} equations \
                         for {coefficients} coefficients",
                        own.collect::<Vec<_>>().join(", ")
                    );
                    noted.push(Diagnostic::new(Code::KnotsApart, equation.span, message).help(
                        "give all splines of the phase the same intervals: those without their own have those of `collocation`",
                    ));
                }
            }
            noted.into_iter().for_each(|finding| self.report(finding));
        }
    }

    /// How many breakpoints some outputs of a phase have together, and the one that has most.
    fn breakpoints_together(&self, phase: usize, outputs: impl Iterator<Item = usize>) -> (usize, usize) {
        let (mut all, mut most) = (vec![], 0);
        for output in outputs {
            let own = &self.problem.phases[phase].outputs[output].spline.breakpoints;
            most = most.max(own.len());
            all.extend(own);
        }
        all.sort_by(f64::total_cmp);
        all.dedup_by(|next, last| (*next - *last).abs() < SAME);
        (all.len(), most)
    }

    /// How many coefficients an output has, all members of it.
    fn coefficients(&self, phase: usize, output: usize) -> usize {
        let output = &self.problem.phases[phase].outputs[output];
        let Spline { order, smoothness, breakpoints } = &output.spline;
        let intervals = breakpoints.len().saturating_sub(1);
        let own = intervals.saturating_mul(order.saturating_sub(*smoothness)).saturating_add(*smoothness);
        let members = output.family.map_or(1, |(first, last)| usize::try_from(last - first + 1).unwrap_or(0));
        own.saturating_mul(members)
    }

    /// The equations of a phase, those together that share outputs.
    fn joined_equations(&self, phase: usize) -> Vec<Joined> {
        let mut groups: BTreeMap<usize, Joined> = BTreeMap::new();
        // The group of each output.
        let mut of: BTreeMap<usize, usize> = BTreeMap::new();
        let equations = self.problem.constraints.iter().filter_map(|own| self.equation(phase, own));
        for (number, equation) in equations.enumerate() {
            let before: BTreeSet<usize> =
                equation.outputs.iter().filter_map(|output| of.get(output).copied()).collect();
            let mut joined = Joined::default();
            for group in before {
                let other = groups.remove(&group).unwrap_or_default();
                joined.equations.extend(other.equations);
                joined.outputs.extend(other.outputs);
            }
            joined.outputs.extend(&equation.outputs);
            joined.equations.push(equation);
            joined.outputs.iter().for_each(|output| _ = of.insert(*output, number));
            groups.insert(number, joined);
        }
        groups.into_values().collect()
    }

    /// A constraint as an equation along all of a phase, if it is one; none where its members are not known.
    fn equation(&self, phase: usize, own: &Constraint) -> Option<Equation> {
        let Domain::Path(at, part) = &own.domain else { return None };
        let is_equation = own.bounds.lower.is_some() && own.bounds.lower == own.bounds.upper;
        if at.phase != phase || *part != Part::WHOLE || !is_equation || own.imposed != Imposed::Everywhere {
            return None;
        }
        let mut members = 1_usize;
        for over in loops_within(&own.loops, Some(at)) {
            let (first, last) = (over.first.as_number()?, over.last.as_number()?);
            members = members.saturating_mul(usize::try_from(last - first + 1).unwrap_or(0));
        }
        let inputs = self.problem.dag.inputs_of(&[own.body]).into_iter();
        let outputs = inputs.filter_map(|input| match self.problem.leaves.leaf(input) {
            Leaf::Flat { phase, at: At::Here, output, .. } if phase.phase == at.phase => Some(*output),
            _ => None,
        });
        Some(Equation { span: own.span, members, outputs: outputs.collect() })
    }
}

fn counted(intervals: usize) -> String {
    if intervals == 1 { "1 interval".to_owned() } else { format!("{intervals} intervals") }
}
