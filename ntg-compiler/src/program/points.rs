//! At which points of a phase a function is needed (docs/maths.md, section 4).

use ntg_structure::{Block, Points, is_helper};

use super::clocks::is_clock;
use super::pieces::{Piece, Role};
use crate::expr::Node;
use crate::model::problem::{Collocation, Domain, Imposed, Leaf, PhaseAt, Problem};

/// The point sets at which a piece along a phase is evaluated.
///
/// Integrands stand at quadrature points, equalities at the collocation points, inequalities at
/// the quadrature points and at both ends of every interval: once where the function is
/// continuous, from both sides where a derivative in it jumps; `inequalities = points` leaves the ends out.
/// What holds a helper above a corner, or is missed by an amount of its own, is needed where integrands stand, and nowhere
/// else (section 18).
pub(super) fn point_sets(problem: &Problem, phase: &PhaseAt, piece: &Piece) -> Vec<Points> {
    let (points, equalities, ends) = match problem.phases[phase.phase].collocation {
        Collocation::Uniform { points } => return vec![Points::Uniform { points }],
        Collocation::Gauss { points, equalities, ends } => (points, equalities, ends),
    };
    match &piece.role {
        Role::AtBreakpoints { .. } => vec![Points::Breakpoints],
        Role::Constraint { constraint, .. } if is_at_integrands(problem, *constraint, piece) => {
            vec![Points::Gauss { points }]
        }
        Role::Constraint { bounds, .. } if bounds.lower.is_some() && bounds.lower == bounds.upper => {
            vec![Points::Gauss { points: equalities }]
        }
        Role::Constraint { .. } if !ends => vec![Points::Gauss { points }],
        Role::Constraint { .. } => {
            let mut sets = vec![Points::Gauss { points }, Points::Breakpoints];
            if jumps(problem, phase, piece) {
                sets.push(Points::LeftLimits);
            }
            sets
        }
        _ => vec![Points::Gauss { points }],
    }
}

/// Whether a row holds a helper above a corner, or stands at the points of the integrands for another reason.
fn is_at_integrands(problem: &Problem, constraint: usize, piece: &Piece) -> bool {
    let own = &problem.constraints[constraint];
    let is_corner = own.block == Block::Corner;
    own.imposed == Imposed::AtIntegrands
        || is_corner
            && problem.dag.inputs_of(&[piece.body]).into_iter().any(|input| match problem.leaves.leaf(input) {
                Leaf::Flat { phase, output, .. } => is_helper(&problem.phases[phase.phase].outputs[*output].name),
                _ => false,
            })
}

/// Whether the piece jumps at interior breakpoints: it holds a derivative that does, or a condition of time.
fn jumps(problem: &Problem, at: &PhaseAt, piece: &Piece) -> bool {
    let Domain::Path(..) = piece.domain else { return false };
    let outputs = &problem.phases[at.phase].outputs;
    if outputs.iter().all(|output| output.spline.breakpoints.len() <= 2) {
        return false;
    }
    problem.dag.schedule(&[piece.body]).iter().any(|id| match problem.dag.node(*id) {
        Node::Select { condition, .. } => is_clock(problem, *condition),
        Node::Input(input) => match problem.leaves.leaf(*input) {
            Leaf::Flat { phase, output, order, .. } => {
                let spline = &problem.phases[phase.phase].outputs[*output].spline;
                spline.breakpoints.len() > 2 && *order >= spline.smoothness
            }
            _ => false,
        },
        _ => false,
    })
}
