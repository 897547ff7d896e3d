//! The shapes of expressions that were found before, by the contexts in which they were.
//!
//! Vectors are made element by element, and each element asks for the shapes of the expressions around it: without a
//! memory the work would grow with the square of the depth of an expression.

use super::problem::Form;
use super::scope::{Context, ScopeId};
use super::shape::Shape;
use crate::expr::Map;
use crate::syntax::ast::{Expr, ExprKind};

/// Shapes by expression and context.
pub(super) type KnownShapes = Map<ShapeKey, Option<Shape>>; // Looked up, never iterated.

/// Everything on which the shape of an expression without local names around it depends.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct ShapeKey {
    /// Its address in the syntax tree.
    expr: usize,
    scope: ScopeId,
    lexical: ScopeId,
    library: Option<ScopeId>,
    agent: Option<Form>,
    phase: Option<Form>,
}

impl ShapeKey {
    /// The key of an expression in a context; none where the shape is seen at once, or names of a loop or a function are
    /// around, which are others each time.
    pub(super) fn of(cx: &Context<'_>, expr: &Expr) -> Option<Self> {
        let is_made_of_others = matches!(
            expr.kind,
            ExprKind::Tuple(_)
                | ExprKind::Sum(_)
                | ExprKind::Product(_)
                | ExprKind::Power(..)
                | ExprKind::Call(_)
                | ExprKind::If(_)
                | ExprKind::Steps(_)
                | ExprKind::Reduce(_)
        );
        (is_made_of_others && cx.locals.is_none()).then(|| Self {
            expr: std::ptr::from_ref(expr).addr(),
            scope: cx.scope,
            lexical: cx.lexical,
            library: cx.library,
            agent: cx.agent.clone(),
            phase: cx.phase.clone(),
        })
    }
}
