//! What is given before the solve: parameters, indices, and times on a clock that nothing free moves.

use super::problem::{Duration, Leaf, Problem, Start};
use crate::expr::{self, Degree, NodeId};

/// The degree of a node in what is solved for.
fn degree(problem: &Problem, node: NodeId) -> Degree {
    expr::degree(&problem.dag, node, |input| !is_given_leaf(problem, problem.leaves.leaf(input)))
}

/// Whether a node does not change while the problem is solved.
pub(super) fn is_given(problem: &Problem, node: NodeId) -> bool {
    degree(problem, node) == Degree::Constant
}

/// Whether a node is affine in what is solved for, and not given.
pub(super) fn is_affine(problem: &Problem, node: NodeId) -> bool {
    degree(problem, node) == Degree::Linear
}

/// Whether a leaf is given before the solve.
pub(super) fn is_given_leaf(problem: &Problem, leaf: &Leaf) -> bool {
    match leaf {
        Leaf::Parameter { .. } | Leaf::Index(_) | Leaf::Tau => true,
        Leaf::Time(at) | Leaf::Start(at) => is_clock_given(problem, at.phase),
        Leaf::Duration(at) => matches!(problem.phases[at.phase].duration, Duration::Fixed(_)),
        _ => false,
    }
}

/// Whether a phase begins and ends at times that are given.
fn is_clock_given(problem: &Problem, phase: usize) -> bool {
    let agent = &problem.agents[problem.phases[phase].agent];
    matches!(agent.start, Start::Fixed(_))
        && agent.phases.iter().all(|phase| matches!(problem.phases[*phase].duration, Duration::Fixed(_)))
}
