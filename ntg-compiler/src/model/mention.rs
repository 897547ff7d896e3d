//! Which names an expression mentions where its own context holds.

use crate::syntax::ast::{Expr, ExprKind};

/// Whether the independent variable or `tau` occurs where an expression's own context holds.
pub(super) fn mentions_time(expr: &Expr, name: &str) -> bool {
    let mut open = vec![expr];
    while let Some(expr) = open.pop() {
        match &expr.kind {
            ExprKind::Time | ExprKind::ScaledTime => return true,
            ExprKind::Path(path) => match path.segments.as_slice() {
                [only] if only.name.text == name => return true,
                _ => {}
            },
            ExprKind::Neg(inner) | ExprKind::Der { of: inner, .. } => open.push(inner),
            ExprKind::Tuple(elements) => open.extend(elements),
            ExprKind::Sum(terms) => open.extend(terms.iter().map(|(_, term)| term)),
            ExprKind::Product(factors) => open.extend(factors.iter().map(|(_, factor)| factor)),
            ExprKind::Power(base, exponent) => open.extend([&**base, &**exponent]),
            ExprKind::Call(call) => open.extend(&call.arguments),
            _ => {}
        }
    }
    false
}

/// Names that stand alone and without index in an expression, whatever else happens. What is taken at other points
/// (`integral`, `initial`, `final`) or bound by an index is left out, and so are branches, which may not be chosen.
pub(super) fn mentioned(expr: &Expr) -> Vec<&str> {
    let mut names = Vec::new();
    let mut open = vec![expr];
    while let Some(expr) = open.pop() {
        match &expr.kind {
            ExprKind::Path(path) => {
                if let [only] = path.segments.as_slice()
                    && only.indices.is_empty()
                {
                    names.push(only.name.text.as_str());
                }
            }
            ExprKind::Neg(inner) | ExprKind::Der { of: inner, .. } => open.push(inner),
            ExprKind::Tuple(elements) => open.extend(elements),
            ExprKind::Sum(terms) => open.extend(terms.iter().map(|(_, term)| term)),
            ExprKind::Product(factors) => open.extend(factors.iter().map(|(_, factor)| factor)),
            ExprKind::Power(base, exponent) => open.extend([&**base, &**exponent]),
            ExprKind::Call(call) | ExprKind::Partial { of: call, .. } => open.extend(&call.arguments),
            ExprKind::If(conditional) => open.extend(conditional.branches[0].condition.sides()),
            // Steps may hide names.
            ExprKind::Steps(_)
            | ExprKind::Number(_)
            | ExprKind::Pi
            | ExprKind::Time
            | ExprKind::ScaledTime
            | ExprKind::File(_)
            | ExprKind::Rows(_)
            | ExprKind::Integral { .. }
            | ExprKind::Boundary { .. }
            | ExprKind::Event { .. }
            | ExprKind::Reduce(_) => {}
        }
    }
    names
}

/// Every name in an expression that is made of names, numbers and operations alone.
pub(super) fn names_in(expr: &Expr) -> Option<Vec<&str>> {
    let mut names = Vec::new();
    let mut open = vec![expr];
    while let Some(expr) = open.pop() {
        match &expr.kind {
            ExprKind::Path(path) => match path.segments.as_slice() {
                [only] if only.indices.is_empty() => names.push(only.name.text.as_str()),
                _ => return None,
            },
            ExprKind::Number(_) | ExprKind::Pi => {}
            ExprKind::Neg(inner) => open.push(inner),
            ExprKind::Sum(terms) => open.extend(terms.iter().map(|(_, term)| term)),
            ExprKind::Product(factors) => open.extend(factors.iter().map(|(_, factor)| factor)),
            ExprKind::Power(base, exponent) => open.extend([&**base, &**exponent]),
            _ => return None,
        }
    }
    Some(names)
}
