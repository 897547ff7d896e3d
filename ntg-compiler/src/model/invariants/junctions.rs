//! Invariants where phases meet.
//!
//! An invariant that is imposed in the phase before, and whose states go on without a jump, is imposed in the next one already: at
//! its start the phase before ends, where the mesh misses the invariant by little and not by nothing, and a second row there would
//! contradict the first by so much.

use std::collections::HashMap;

use super::Invariant;
use super::motion::{Indices, Motion, each_member};
use super::sample::{Budget, Draw, Point};
use super::surface::Row;
use crate::expr::{Binary, Node, Scalar};
use crate::model::elaborator::Elaborator;
use crate::model::problem::{At, Form, Imposed, Leaf, Loop};
use ntg_structure::Block;

/// What goes on without a jump at the starts of phases: members of an output and an order of derivative, at the first member of
/// the phase or at those after it.
#[derive(Default)]
pub(super) struct Joined(HashMap<Start, Vec<Members>>); // Looked up, never iterated.

/// A phase, whether at members after its first, an output, and an order of derivative.
type Start = (usize, bool, usize, usize);

/// The first and the last member of an array; none for what is no array.
type Members = Option<(i64, i64)>;

impl Joined {
    fn is_joined(&self, (phase, is_inner): (usize, bool), output: usize, order: usize, member: Option<i64>) -> bool {
        let ranges = self.0.get(&(phase, is_inner, output, order));
        let holds = |range: &Members| match (range, member) {
            (None, None) => true,
            (Some((first, last)), Some(member)) => (*first..=*last).contains(&member),
            _ => false,
        };
        ranges.is_some_and(|ranges| ranges.iter().any(holds))
    }
}

/// At how many points two invariants must be one.
const POINTS: u64 = 3;

impl Elaborator<'_> {
    /// The rows of continuity, as `continuity` has made them.
    pub(super) fn joined_states(&self) -> Joined {
        let mut joined = Joined::default();
        for constraint in self.problem.constraints.iter().filter(|own| own.block == Block::Continuity) {
            let Node::Binary(Binary::Sub, after, _) = self.problem.dag.node(constraint.body) else { continue };
            let Node::Input(input) = self.problem.dag.node(*after) else { continue };
            let Leaf::Flat { phase, at: At::Start, output, index, order } = self.problem.leaves.leaf(*input) else {
                continue;
            };
            let is_inner = phase.index.as_ref().is_some_and(|form| form.as_number().is_none());
            let range = match index {
                None => None,
                Some(form) => match (form.as_number(), constraint.loops.last()) {
                    (Some(member), _) => Some((member, member)),
                    (None, Some(over)) if *form == Form::index(over.index) => {
                        Some((over.first.constant, over.last.constant))
                    }
                    _ => continue,
                },
            };
            joined.0.entry((phase.phase, is_inner, *output, *order)).or_default().push(range);
        }
        joined
    }

    /// Where an invariant is imposed, those of all phases being known.
    pub(super) fn imposed(&self, own: &Invariant, all: &[Invariant], joined: &Joined, budget: &mut Budget) -> Imposed {
        let phase = own.motion.phase;
        let loops = self.problem.constraints[own.constraint].loops.clone();
        let family = self.problem.phases[phase].family.clone();
        let is_joined = |is_inner: bool, state: &super::sample::State| {
            joined.is_joined((phase, is_inner), state.0.output, state.1, state.0.member)
        };
        let (inner, first) = match own.states.as_slice() {
            [] => (false, false),
            states => (states.iter().all(|s| is_joined(true, s)), states.iter().all(|s| is_joined(false, s))),
        };
        let before = self.problem.phases[phase].after.filter(|_| first);
        let follows = before.is_some_and(|before| {
            all.iter().any(|other| other.motion.phase == before && self.are_one(other, own, budget))
        });
        let place = family.and_then(|family| loops.iter().position(|over| over.index == family.index));
        match (place, inner, follows) {
            (None, _, true) | (Some(_), true, true) => Imposed::Nowhere,
            (Some(place), true, false) => {
                let mut loops = loops;
                loops[place].last = loops[place].first.clone();
                Imposed::AtStart(loops)
            }
            // That the first of several follows is seldom, and a row too many is taken.
            _ => Imposed::AtStart(loops),
        }
    }

    /// Whether the invariant of a phase, at its last member, says what that of the next one says at its first.
    fn are_one(&self, before: &Invariant, after: &Invariant, budget: &mut Budget) -> bool {
        let bound_loops = |of: &Invariant, last: bool| -> Vec<Loop> {
            let family = self.problem.phases[of.motion.phase].family.as_ref();
            let mut loops = self.problem.constraints[of.constraint].loops.clone();
            for over in loops.iter_mut().filter(|over| family.is_some_and(|family| family.index == over.index)) {
                let end = if last { over.last.clone() } else { over.first.clone() };
                (over.first, over.last) = (end.clone(), end);
            }
            loops
        };
        let members = |loops: &[Loop]| {
            let mut all = vec![];
            each_member(loops, &mut Indices::new(), &mut |indices| {
                all.push(indices.clone());
                all.len() < super::MOST_MEMBERS
            });
            all
        };
        let [first, second] = [members(&bound_loops(before, true)), members(&bound_loops(after, false))];
        first.len() == second.len()
            && first.into_iter().zip(second).all(|(a, b)| {
                (0..POINTS).all(|seed| {
                    let draw = Draw { seed, decades: 1.0, is_positive: seed == 0, is_turned: false };
                    let mut miss = |of: &Invariant, motion: &Motion, indices: Indices| {
                        let mut point = Point::new(&self.problem, motion, draw, budget);
                        Row { indices, ..of.row.clone() }.miss(&mut point)
                    };
                    let (a, b) = (miss(before, &before.motion, a.clone()), miss(after, &after.motion, b.clone()));
                    a.zip(b).is_some_and(|(a, b)| super::Number::binary(Binary::Sub, &a, &b).vanishes())
                })
            })
    }
}
