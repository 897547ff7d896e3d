//! Which members of outputs constraints hold for: of an array a limit on one element says nothing of the others.

use super::problem::{At, Bounds, Constraint, Domain, Form, Leaf, Loop, Part, Problem};
use crate::expr::{Node, NodeId};

/// A limit on an output itself, along a whole phase.
pub(super) struct Limit<'p> {
    /// The phase and the output's place in it.
    pub(super) output: (usize, usize),
    /// Whether that is no array.
    pub(super) is_single: bool,
    /// The members, first and last.
    members: (i64, i64),
    pub(super) constraint: &'p Constraint,
}

/// The members of what is no array.
const NO_ARRAY: (i64, i64) = (0, 0);

/// The limits on outputs that hold for all members of the families of agents and phases; of each the members.
pub(super) fn limits(problem: &Problem) -> Vec<Limit<'_>> {
    problem.constraints.iter().filter_map(|constraint| limit(problem, constraint)).collect()
}

fn limit<'p>(problem: &'p Problem, constraint: &'p Constraint) -> Option<Limit<'p>> {
    let (Domain::Path(_, Part::WHOLE), Node::Input(input)) = (&constraint.domain, problem.dag.node(constraint.body))
    else {
        return None;
    };
    let Leaf::Flat { phase, at: At::Here, output, order: 0, index } = problem.leaves.leaf(*input) else { return None };
    let own = problem.phases.get(phase.phase)?;
    let all = |form: &Option<Form>, family: Option<&Loop>| match (form, family) {
        (Some(form), Some(family)) => {
            let (first, last) = members(form, &constraint.loops)?;
            (first <= family.first.as_number()? && last >= family.last.as_number()?).then_some(())
        }
        _ => Some(()),
    };
    all(&phase.agent, problem.agents[own.agent].family.as_ref())?;
    all(&phase.index, own.family.as_ref())?;
    let members = index.as_ref().map_or(Some(NO_ARRAY), |index| members(index, &constraint.loops))?;
    Some(Limit { output: (phase.phase, *output), is_single: index.is_none(), members, constraint })
}

/// The values of a form: a number, or an index of a loop with ends that are numbers.
fn members(form: &Form, loops: &[Loop]) -> Option<(i64, i64)> {
    if let Some(number) = form.as_number() {
        return Some((number, number));
    }
    let over = loops.iter().find(|over| *form == Form::index(over.index))?;
    Some((over.first.as_number()?, over.last.as_number()?))
}

/// Between which numbers outputs stay, by phase and place, where limits say so for all their members; one of both may be infinite.
pub(super) fn ranges(problem: &Problem) -> Vec<((usize, usize), (f64, f64))> {
    let number = |end: Option<NodeId>| end.and_then(|end| problem.dag.is_constant(end));
    let mut limits: Vec<(Limit<'_>, (f64, f64))> = vec![];
    for limit in self::limits(problem) {
        let Bounds { lower, upper } = limit.constraint.bounds;
        let range = (number(lower).unwrap_or(f64::NEG_INFINITY), number(upper).unwrap_or(f64::INFINITY));
        limits.push((limit, range));
    }
    limits.sort_by_key(|(limit, _)| (limit.output, limit.members));
    let mut ranges = vec![];
    for own in limits.chunk_by(|(a, _), (b, _)| a.output == b.output) {
        let output = own[0].0.output;
        let (first, last) = problem.phases[output.0].outputs[output.1].family.unwrap_or(NO_ARRAY);
        let is_whole = |members: (i64, i64)| members.0 <= first && members.1 >= last;
        // Limits on all members hold together; of members with limits of their own the widest count.
        let whole = own.iter().filter(|(limit, _)| is_whole(limit.members)).map(|(_, range)| *range);
        let mut next = first;
        for (limit, _) in own.iter().filter(|(limit, _)| limit.members.0 <= limit.members.1) {
            if limit.members.0 <= next {
                next = next.max(limit.members.1.saturating_add(1));
            }
        }
        let widest = own.iter().map(|(_, range)| *range).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let range = whole.reduce(|a, b| (a.0.max(b.0), a.1.min(b.1))).or(widest.filter(|_| next > last));
        if let Some(range) = range {
            ranges.push((output, range));
        }
    }
    ranges
}
