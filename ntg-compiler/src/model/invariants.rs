//! Equations along a phase that follow from the equations of motion (docs/maths.md, section 4.8).
//!
//! A unit quaternion beside its kinematics, a balance beside the rates of what it balances, a conserved energy: such an equation
//! is an invariant of the motion, which holds everywhere once it holds at the start. At every point of a mesh it would say again
//! what the equations of motion say there, or contradict them by the order of the mesh.
//! Takes equations of states alone along a whole phase. Those whose rate along the motion is 0, for all states and inputs or
//! wherever all of these equations hold, are imposed at the start of the phase, and noted; reports look at them everywhere.
//! Those that inputs keep are differentiated (`reduced`); those whose branches meet are left as they are (`regular`).

mod junctions;
mod motion;
pub(super) mod number;
mod reduced;
mod regular;
mod sample;
mod surface;

use std::rc::Rc;

use super::elaborator::Elaborator;
use super::problem::{At, Domain, Imposed, Leaf, PhaseAt, Problem};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{InputId, NodeId};
use crate::source::Span;
use junctions::Joined;
use motion::{Indices, Motion, each_member};
use ntg_structure::Block;
use number::Number;
use reduced::Kept;
use sample::{Budget, Draw, Point, State};
use surface::Row;

/// How points are drawn, each with another seed: numbers about 1, numbers of all sizes, and numbers that are positive, as
/// concentrations are. A rate that is not 0 is as small as rounding at one of them, `1e-14` of its terms, with a probability of
/// about `1e-14`, and at three of them with one of `1e-42`; a term that is smaller than that at all of them is not seen.
const DRAWS: [(f64, bool); 5] = [(0.0, false), (1.0, false), (3.0, false), (0.0, true), (2.0, true)];
/// Of them so many must tell.
const LEAST_TOLD: usize = 3;
/// A point at which it matters only what formulas are made of.
const ORDINARY: Draw = Draw { seed: 0, decades: 0.0, is_positive: true, is_turned: false };
/// The most members of all equations of a phase that are tried.
const MOST_MEMBERS: usize = 4096;
/// The most leaves of formulas that are evaluated for one spec. A choice: a spec of that many is compiled in seconds anyway.
const MOST_LEAVES: usize = 500_000;

/// An equation that follows from the equations of motion.
struct Invariant {
    constraint: usize,
    motion: Rc<Motion>,
    /// One of its members, with other indices than its own.
    row: Row,
    /// The states that its members are made of.
    states: Vec<State>,
}

/// An equation that may be an invariant.
struct Candidate {
    constraint: usize,
    rows: Vec<Row>,
}

impl Elaborator<'_> {
    /// Finds invariants, says where they are imposed, and notes them.
    pub(super) fn invariants(&mut self) {
        if self.has_failed() {
            return;
        }
        let mut budget = Budget::new(MOST_LEAVES);
        let (mut found, mut reduced, mut implied) = (vec![], vec![], vec![]);
        for phase in 0..self.problem.phases.len() {
            let (kept, left) = self.invariants_of(phase, &mut budget);
            found.extend(kept);
            reduced.extend(left.reduced);
            implied.extend(left.implied);
        }
        if found.is_empty() && reduced.is_empty() {
            return;
        }
        let joined = self.joined_states();
        self.impose_reduced(reduced, &joined, &mut budget);
        for constraint in implied {
            self.problem.constraints[constraint].imposed = Imposed::Nowhere;
            self.note_implied(self.problem.constraints[constraint].span);
        }
        let imposed: Vec<Imposed> = found.iter().map(|own| self.imposed(own, &found, &joined, &mut budget)).collect();
        let mut told: Vec<Span> = vec![];
        for (own, imposed) in found.iter().zip(imposed) {
            self.problem.constraints[own.constraint].imposed = imposed;
            let span = self.problem.constraints[own.constraint].span;
            if !told.contains(&span) {
                told.push(span);
                self.note_invariant(span, &found);
            }
        }
    }

    fn note_invariant(&mut self, span: Span, found: &[Invariant]) {
        let of_span = |k: &usize| self.problem.constraints[*k].span == span;
        let is_written = |k: &usize| self.problem.constraints[*k].block != Block::Corner;
        let all = (0..self.problem.constraints.len()).filter(of_span).filter(is_written).count();
        let own = found.iter().map(|own| own.constraint).filter(of_span).count();
        let message = match own {
            own if own < all => format!(
                "{own} of {all} rows of this equation follow from the equations of motion once they hold at the start, and are \
                 imposed there alone"
            ),
            _ => "this equation follows from the equations of motion once it holds at the start, and is imposed there alone"
                .to_owned(),
        };
        let help = "nothing is to be done: reports look at it everywhere; in `initial { }` it would say the same";
        self.report(Diagnostic::new(Code::Invariant, span, message).help(help));
    }

    fn note_implied(&mut self, span: Span) {
        let message = "this equation follows from the others along the phase, and is imposed by them";
        let help = "nothing is to be done: reports look at it everywhere";
        self.report(Diagnostic::new(Code::Invariant, span, message).help(help));
    }

    fn invariants_of(&mut self, phase: usize, budget: &mut Budget) -> (Vec<Invariant>, Kept) {
        let mut motion = self.states_in_motion(phase);
        if !motion.has_states() {
            return (vec![], Kept::default());
        }
        let of_states = |this: &Self, k: &usize| this.is_of_states(*k, &motion);
        let numbers: Vec<usize> = (0..self.problem.constraints.len()).filter(|k| of_states(self, k)).collect();
        if numbers.is_empty() {
            return (vec![], Kept::default());
        }
        self.find_equations(&mut motion);
        let mut candidates: Vec<Candidate> = numbers.into_iter().map(|k| self.candidate(k)).collect();
        candidates.retain(|own| !own.rows.is_empty());
        if candidates.iter().map(|own| own.rows.len()).sum::<usize>() > MOST_MEMBERS {
            return (vec![], Kept::default());
        }
        let rates: Vec<NodeId> = candidates.iter().flat_map(|own| own.rows.first()).map(|row| row.rate).collect();
        motion.find_branches(&self.problem.dag, &rates);
        let motion = Rc::new(motion);
        let mut regular = vec![];
        for own in candidates {
            let vanishes = always_vanishes(&self.problem, &motion, &own, budget);
            if vanishes || self.is_regular(&motion, &own, budget) {
                regular.push((own, vanishes));
            }
        }
        let (candidates, vanishes): (Vec<Candidate>, Vec<bool>) = regular.into_iter().unzip();
        let problem = &self.problem;
        let holds = together(problem, &motion, &candidates, vanishes, budget);
        if budget.is_spent() {
            return (vec![], Kept::default());
        }
        let (kept, left): (Vec<_>, Vec<_>) = candidates.into_iter().zip(holds).partition(|(_, holds)| *holds);
        let mut invariant = |own: Candidate| {
            let mut point = Point::new(problem, &motion, ORDINARY, budget);
            own.rows.iter().for_each(|row| {
                row.miss(&mut point);
            });
            let mut states = std::mem::take(&mut point.met);
            states.dedup();
            Invariant { constraint: own.constraint, motion: motion.clone(), row: own.rows[0].clone(), states }
        };
        let kept = kept.into_iter().map(|(own, _)| invariant(own)).collect();
        let reduced = self.reduced(&motion, left.into_iter().map(|(own, _)| own).collect(), budget);
        (kept, reduced)
    }

    /// Whether a constraint is an equation along all of a phase between its states, without their highest derivatives.
    fn is_of_states(&self, k: usize, motion: &Motion) -> bool {
        if self.equation_along(k, motion.phase).is_none() {
            return false;
        }
        let mut states = 0;
        let is_wanted = |input: InputId| match self.problem.leaves.leaf(input) {
            Leaf::Flat { phase, at: At::Here, output, order, .. } => {
                states += 1;
                phase.phase == motion.phase && motion.order(*output).is_some_and(|highest| *order < highest)
            }
            Leaf::Flat { .. } | Leaf::Integral { .. } | Leaf::Symbol(_) => false,
            _ => true,
        };
        self.problem.dag.all_inputs(self.problem.constraints[k].body, is_wanted) && states > 0
    }

    fn candidate(&mut self, k: usize) -> Candidate {
        let constraint = self.problem.constraints[k].clone();
        let Domain::Path(phase, _) = &constraint.domain else { return Candidate { constraint: k, rows: vec![] } };
        let (body, bound) = (constraint.body, constraint.bounds.lower.unwrap_or(constraint.body));
        let rate = self.rate_along(body, phase);
        let mut rows = vec![];
        each_member(&constraint.loops, &mut Indices::new(), &mut |indices| {
            rows.push(Row { equation: k, body, bound, rate, indices: indices.clone() });
            rows.len() <= MOST_MEMBERS
        });
        Candidate { constraint: k, rows }
    }

    /// The derivative of a formula of states with respect to time, by the chain rule.
    fn rate_along(&mut self, body: NodeId, phase: &PhaseAt) -> NodeId {
        let mut rates = crate::expr::Map::default(); // Looked up, never iterated.
        for input in self.problem.dag.inputs_of(&[body]) {
            let rate = match self.problem.leaves.leaf(input).clone() {
                Leaf::Flat { phase, at, output, index, order } => {
                    self.leaf(Leaf::Flat { phase, at, output, index, order: order + 1 })
                }
                Leaf::Time(_) => self.problem.dag.constant(1.0),
                Leaf::Tau => {
                    let (one, duration) = (self.problem.dag.constant(1.0), self.leaf(Leaf::Duration(phase.clone())));
                    self.problem.dag.div(one, duration)
                }
                _ => continue,
            };
            rates.insert(input, rate);
        }
        self.pushed(body, &rates)
    }
}

/// Whether the rate of an equation is 0 for all states and inputs, whatever branches conditions take.
fn always_vanishes(problem: &Problem, motion: &Motion, own: &Candidate, budget: &mut Budget) -> bool {
    own.rows.iter().all(|row| {
        let mut told = Told::default();
        for draw in draws(1, motion.has_branches) {
            let Some(rate) = Point::new(problem, motion, draw, budget).value(row.rate, &row.indices) else { continue };
            if !rate.is_rounding() {
                return false;
            }
            told.add(draw, rate);
        }
        told.is_enough(motion)
    })
}

/// How many points have told of a rate that it vanishes, with the branches that conditions take there and with the others.
#[derive(Clone, Copy, Default)]
struct Told([usize; 2]);

impl Told {
    fn add(&mut self, draw: Draw, rate: Number) {
        self.0[usize::from(draw.is_turned)] += usize::from(rate.vanishes());
    }

    fn is_enough(self, motion: &Motion) -> bool {
        self.0[0] >= LEAST_TOLD && (self.0[1] >= LEAST_TOLD || !motion.has_branches)
    }
}

/// Points to draw, each with the one at which conditions take the other branches, where there are any.
fn draws(first: u64, has_branches: bool) -> impl Iterator<Item = Draw> {
    let both = (first..).zip(DRAWS).flat_map(|(seed, (decades, is_positive))| {
        [false, true].map(|is_turned| Draw { seed, decades, is_positive, is_turned })
    });
    both.filter(move |draw| has_branches || !draw.is_turned)
}

/// Which equations hold everywhere once all of these hold: first all are thought to, then those that are left go out.
fn together(
    problem: &Problem,
    motion: &Motion,
    candidates: &[Candidate],
    vanishes: Vec<bool>,
    budget: &mut Budget,
) -> Vec<bool> {
    let mut holds = vec![true; candidates.len()];
    if vanishes.iter().all(|vanishes| *vanishes) {
        return holds;
    }
    loop {
        let kept = candidates.iter().zip(&holds).filter(|(_, holds)| **holds);
        let rows: Vec<Row> = kept.flat_map(|(own, _)| own.rows.iter().cloned()).collect();
        let left = leaving(problem, motion, &rows, budget);
        let goes = |k: usize| holds[k] && !vanishes[k] && left.contains(&candidates[k].constraint);
        let out: Vec<usize> = (0..candidates.len()).filter(|k| goes(*k)).collect();
        if out.is_empty() || budget.is_spent() {
            return holds;
        }
        out.into_iter().for_each(|k| holds[k] = false);
    }
}

/// The equations that the motion leaves from points at which all rows hold, and those for which there are no such points.
fn leaving(problem: &Problem, motion: &Motion, rows: &[Row], budget: &mut Budget) -> Vec<usize> {
    let groups = surface::groups(rows, &surface::states, &mut Point::new(problem, motion, ORDINARY, budget));
    let mut left: Vec<usize> = vec![];
    let mut seen = vec![false; rows.len()];
    for (members, states) in groups {
        members.iter().for_each(|k| seen[*k] = true);
        let own: Vec<&Row> = members.iter().map(|k| &rows[*k]).collect();
        let mut told = vec![Told::default(); own.len()];
        let mut leaves = vec![false; own.len()];
        for draw in draws(100, motion.has_branches) {
            let mut point = Point::new(problem, motion, draw, budget);
            if !surface::reach(&own, &states, &mut point, surface::STEPS) {
                continue;
            }
            for (k, row) in own.iter().enumerate() {
                let Some(rate) = point.value(row.rate, &row.indices) else { continue };
                leaves[k] |= !rate.is_rounding();
                told[k].add(draw, rate);
            }
        }
        let goes = |k: &usize| leaves[*k] || !told[*k].is_enough(motion);
        left.extend((0..own.len()).filter(goes).map(|k| own[k].equation));
    }
    left.extend(rows.iter().zip(seen).filter(|(_, seen)| !seen).map(|(row, _)| row.equation));
    left
}
