//! One node as a Rust expression.
//!
//! Takes a node of a kernel's graph, gives tokens that compute it with exactly its operations in
//! exactly its order: Rust neither reorders nor contracts floating-point arithmetic, so
//! parentheses are all that is needed, and only those that are needed are written.
//!
//! Everything beyond `+ - * /` is a call of the runtime's `math`, which every back end shares.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::data::{ToRust, float};
use crate::expr::{Binary, Dag, Node, NodeId, Unary};

/// How tightly an expression holds together, the loosest first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    /// `a + b`, `a - b`.
    Sum,
    /// `a * b`, `a / b`.
    Product,
    /// `-a`.
    Negation,
    /// A name, a literal, a call.
    Atom,
}

/// An expression and how tightly it holds together.
struct Expression {
    tokens: TokenStream,
    level: Level,
}

/// Says what nodes that are computed elsewhere are called.
pub(super) trait Names {
    /// The name of a node that is not to be written out in place.
    fn name(&self, id: NodeId) -> Option<&Ident>;

    /// Whether a node is one number for all lanes.
    fn is_number(&self, id: NodeId) -> bool;
}

/// The expression of a node; operands without a name are written out in place.
pub(super) fn write(dag: &Dag, id: NodeId, names: &impl Names) -> TokenStream {
    expression(dag, id, names).tokens
}

/// A node as a pack: its name, or its expression.
pub(super) fn packed(dag: &Dag, id: NodeId, names: &impl Names) -> TokenStream {
    let tokens = operand(dag, id, names).tokens;
    if names.is_number(id) {
        quote! { Pack::splat(simd, #tokens) }
    } else {
        tokens
    }
}

/// A node itself. Recursion ends at named operands, a few operations below.
fn expression(dag: &Dag, id: NodeId, names: &impl Names) -> Expression {
    match dag.node(id) {
        Node::Const(number) => constant(number.value()),
        Node::Unary(Unary::Neg, x) => {
            let x = operand(dag, *x, names).at_least(Level::Negation, true);
            Expression { tokens: quote! { -#x }, level: Level::Negation }
        }
        Node::Unary(op, x) => call(op.name(), &[*x], dag, names),
        Node::Binary(op, a, b) => match arithmetic(*op) {
            Some((mark, level)) => {
                let a = operand(dag, *a, names).at_least(level, false);
                let b = operand(dag, *b, names).at_least(level, true);
                Expression { tokens: quote! { #a #mark #b }, level }
            }
            None => call(op.name(), &[*a, *b], dag, names),
        },
        Node::Powi(x, n) => {
            if let (2 | 3, Some(x)) = (n, names.name(*x)) {
                let cube = (*n == 3).then(|| quote! { * #x });
                return Expression { tokens: quote! { #x * #x #cube }, level: Level::Product };
            }
            let x = operand(dag, *x, names).tokens;
            let n = i64::from(*n).to_rust();
            atom(quote! { math::powi(#x, #n) })
        }
        Node::Select { condition, then, otherwise } => call("select", &[*condition, *then, *otherwise], dag, names),
        // Inputs and look-ups have names, and no kernel holds a reduction: its result is an input.
        Node::Input(_) | Node::Table { .. } | Node::Reduce { .. } => atom(quote! { f64::NAN }),
    }
}

/// The look-up of several derivatives of one table at the same arguments: an array of as many.
pub(super) fn tables(dag: &Dag, ids: &[NodeId], names: &impl Names) -> TokenStream {
    let nodes = ids.iter().filter_map(|id| match dag.node(*id) {
        Node::Table { table, derivative, args } => Some((table, derivative, args)),
        _ => None,
    });
    let orders = nodes.clone().map(|(_, derivative, _)| {
        let orders = derivative.iter().map(|order| Literal::u8_unsuffixed(*order));
        quote! { [#(#orders),*] }
    });
    let Some((table, _, args)) = nodes.clone().next() else { return TokenStream::new() };
    let table = Literal::u32_unsuffixed(*table);
    let args = args.iter().map(|x| packed(dag, *x, names));
    quote! { math::table(simd, &tables[#table], [#(#args),*], [#(#orders),*]) }
}

/// An operand: its name, or the expression in its place.
fn operand(dag: &Dag, id: NodeId, names: &impl Names) -> Expression {
    match names.name(id) {
        Some(name) => atom(quote! { #name }),
        None => expression(dag, id, names),
    }
}

impl Expression {
    /// The tokens as an operand of an operation of this level, in parentheses unless they hold
    /// together more tightly; on the left, where Rust groups equals by itself, as tightly is
    /// enough.
    fn at_least(self, level: Level, right: bool) -> TokenStream {
        // A negation on the right would be legal, but `a - -b` is misread.
        let bare = if right { self.level > level && self.level != Level::Negation } else { self.level >= level };
        let tokens = self.tokens;
        if bare {
            tokens
        } else {
            quote! { (#tokens) }
        }
    }
}

/// A number; negative ones hold together as negations do.
fn constant(value: f64) -> Expression {
    let level = if value < 0.0 && value.is_finite() { Level::Negation } else { Level::Atom };
    Expression { tokens: float(value), level }
}

fn atom(tokens: TokenStream) -> Expression {
    Expression { tokens, level: Level::Atom }
}

/// A call; all arguments are numbers, or all are packs.
fn call(function: &str, args: &[NodeId], dag: &Dag, names: &impl Names) -> Expression {
    let function = format_ident!("{function}");
    let numbers = args.iter().all(|x| names.is_number(*x));
    let args = args.iter().map(|x| if numbers { operand(dag, *x, names).tokens } else { packed(dag, *x, names) });
    atom(quote! { math::#function(#(#args),*) })
}

/// The four operations that Rust writes with a mark.
fn arithmetic(op: Binary) -> Option<(TokenStream, Level)> {
    match op {
        Binary::Add => Some((quote! { + }, Level::Sum)),
        Binary::Sub => Some((quote! { - }, Level::Sum)),
        Binary::Mul => Some((quote! { * }, Level::Product)),
        Binary::Div => Some((quote! { / }, Level::Product)),
        _ => None,
    }
}
