//! One kernel as a type with up to three functions of arrays: straight lines, without loops or branches.
//!
//! Takes a kernel's shape and formulas, gives a type that implements `lanes::Values`,
//! `lanes::ValuesAndDerivatives`, `lanes::Probes`. Methods of a type, not function values: only they
//! are certain to be compiled into the loop that has the processor's instructions. A node that several
//! others need has a `let` of its own; one that a single other needs is written in its place as long
//! as the line stays short. Both passes are loops over the schedule, so a sum of any length is many
//! short lines, never one deep expression.
//!
//! Afterwards: the functions hold exactly the graph's operations, each once.

use std::collections::{HashMap, HashSet};

use ntg_structure::Kernel;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::expression::{self, Names};
use super::names::{Scope, ident};
use crate::expr::{Dag, InputId, Node, NodeId};
use crate::program::KernelBody;

/// The most operations that one line holds.
const LINE: usize = 6;

/// What is ours in every kernel function.
const OURS: [&str; 11] = ["simd", "z", "w", "tables", "out", "values", "jacobian", "hessian", "math", "lanes", "f64"];

/// A kernel's type, and what it implements.
pub(super) struct Functions {
    /// The items.
    pub(super) items: TokenStream,
    /// Whether anything is differentiated.
    pub(super) derivatives: bool,
    /// Whether anything is probed.
    pub(super) probes: bool,
}

/// Writes a kernel as a type of this name.
pub(super) fn functions(name: &str, shape: &Kernel, body: &KernelBody) -> Functions {
    let values = Function::new(body, &[("out", &body.values)]);
    let derivatives = (!body.jacobian.is_empty() || !body.hessian.is_empty()).then(|| {
        Function::new(body, &[("values", &body.values), ("jacobian", &body.jacobian), ("hessian", &body.hessian)])
    });
    let probes = (!body.probes.is_empty()).then(|| Function::new(body, &[("out", &body.probes)]));
    let kind = ident(name);
    let written = [
        Some(values.write(&kind, "Values", &results(body))),
        derivatives.as_ref().map(|f| f.write(&kind, "ValuesAndDerivatives", &derivatives_of(shape, body))),
        probes.as_ref().map(|f| f.write(&kind, "Probes", &probed(shape))),
    ];
    let implementations = written.into_iter().flatten();
    Functions {
        items: quote! { pub(super) struct #kind {} #(#implementations)* },
        derivatives: derivatives.is_some(),
        probes: probes.is_some(),
    }
}

/// The lines of documentation that say what each row is.
fn results(body: &KernelBody) -> Vec<String> {
    body.labels.iter().enumerate().map(|(row, label)| format!(" `out[{row}]`: {label}")).collect()
}

/// The lines that say what each derivative is.
fn derivatives_of(shape: &Kernel, body: &KernelBody) -> Vec<String> {
    let name = |slot: usize| body.names.get(slot).map_or("?", String::as_str);
    let first = shape.jacobian.iter().map(|&(row, slot)| format!("{row} by {}", name(slot)));
    let second = shape.hessian.iter().map(|&(i, j)| format!("{} {}", name(i), name(j)));
    let first = listed("`jacobian`, a row by an input", &first.collect::<Vec<_>>());
    let second = listed("`hessian` of the rows weighted by `w`", &second.collect::<Vec<_>>());
    first.into_iter().chain(second).collect()
}

/// `title: item, item, ...` as doc lines of about a hundred characters; nothing without items.
fn listed(title: &str, items: &[String]) -> Vec<String> {
    const WIDTH: usize = 100;
    let mut lines = vec![];
    let mut line = format!(" {title}: ");
    for (i, item) in items.iter().enumerate() {
        if line.chars().count() + item.chars().count() > WIDTH {
            lines.push(std::mem::replace(&mut line, " ".into()));
        }
        line.push_str(item);
        line.push_str(if i + 1 < items.len() { ", " } else { "." });
    }
    if !items.is_empty() {
        lines.push(line);
    }
    lines
}

/// The lines that say what is probed.
fn probed(shape: &Kernel) -> Vec<String> {
    let lines = shape.probes.iter().enumerate();
    lines.map(|(i, p)| format!(" `out[{i}]`: `{}` in line {}", p.text, p.line)).collect()
}

/// A function being written: which arrays it fills, and what it needs for that.
struct Function<'a> {
    body: &'a KernelBody,
    outputs: Vec<(&'static str, &'a [NodeId])>,
    /// Nodes outside of constants and inputs, operands first.
    schedule: Vec<NodeId>,
    /// The inputs that are needed, weights included, in order.
    inputs: Vec<(usize, Ident)>,
    /// The nodes that have a name here.
    names: Locals,
}

/// What each node is called.
#[derive(Default)]
struct Locals {
    idents: HashMap<NodeId, Ident>, // Looked up, never iterated.
    numbers: HashSet<NodeId>,       // The same.
}

impl Locals {
    /// Notes a node that no input enters; its operands come first.
    fn add_if_number(&mut self, dag: &Dag, id: NodeId) {
        let mut number = !matches!(dag.node(id), Node::Input(_) | Node::Table { .. });
        dag.node(id).for_each_operand(|x| number &= self.numbers.contains(&x));
        if number {
            self.numbers.insert(id);
        }
    }
}

impl Names for Locals {
    fn name(&self, id: NodeId) -> Option<&Ident> {
        self.idents.get(&id)
    }

    fn is_number(&self, id: NodeId) -> bool {
        self.numbers.contains(&id)
    }
}

impl<'a> Function<'a> {
    fn new(body: &'a KernelBody, outputs: &[(&'static str, &'a [NodeId])]) -> Self {
        let outputs = outputs.to_vec();
        let roots: Vec<NodeId> = outputs.iter().flat_map(|(_, roots)| roots.iter().copied()).collect();
        let needed = body.dag.schedule(&roots);

        let mut names = Locals::default();
        needed.iter().for_each(|id| names.add_if_number(&body.dag, *id));
        let mut inputs = vec![];
        let idents = input_idents(body);
        for id in &needed {
            if let Node::Input(InputId(i)) = body.dag.node(*id)
                && let Some(name) = idents.get(*i as usize)
            {
                inputs.push((*i as usize, name.clone()));
                names.idents.insert(*id, name.clone());
            }
        }
        inputs.sort_by_key(|(i, _)| *i);

        let written: Vec<NodeId> = needed.into_iter().filter(|id| is_operation(&body.dag, *id)).collect();
        let in_place = in_place(&body.dag, &written, &roots);
        let schedule: Vec<NodeId> = written.into_iter().filter(|id| !in_place.contains(id)).collect();
        for (i, id) in schedule.iter().enumerate() {
            names.idents.insert(*id, ident(&format!("t{}", i + 1)));
        }
        Self { body, outputs, schedule, inputs, names }
    }

    /// How many numbers the function takes and gives: the arguments of the trait.
    fn sizes(&self) -> Vec<Literal> {
        let results = self.outputs.iter().map(|(_, roots)| roots.len());
        std::iter::once(self.body.inputs).chain(results).map(Literal::usize_unsuffixed).collect()
    }

    /// The parameters of the function.
    fn parameters(&self) -> Vec<TokenStream> {
        let array = |length: usize| {
            let length = Literal::usize_unsuffixed(length);
            quote! { [Pack<S>; #length] }
        };
        let (inputs, rows) = (array(self.body.inputs), array(self.body.values.len()));
        let mut parameters = vec![quote! { simd: S }, quote! { tables: &[Table] }, quote! { z: &#inputs }];
        if self.outputs.len() > 1 {
            parameters.push(quote! { w: &#rows });
        }
        for (name, roots) in &self.outputs {
            let (name, results) = (ident(name), array(roots.len()));
            parameters.push(quote! { #name: &mut #results });
        }
        parameters
    }

    /// The implementation of one of the traits of `lanes`.
    fn write(&self, kind: &Ident, implements: &str, doc: &[String]) -> TokenStream {
        let (implements, dag) = (ident(implements), &self.body.dag);
        let (sizes, parameters) = (self.sizes(), self.parameters());
        let inputs = self.pattern("z", 0, self.body.inputs);
        let weights = self.pattern("w", self.body.inputs, self.body.values.len());
        let mut done = HashSet::new(); // Asked, never iterated.
        let lets = self.schedule.iter().filter_map(|id| {
            let name = &self.names.idents[id];
            let Some(look_up) = look_up(dag, *id) else {
                let value = expression::write(dag, *id, &self.names);
                return Some(quote! { let #name = #value; });
            };
            // All derivatives of a table at the same place come from one look-up.
            let together: Vec<NodeId> =
                self.schedule.iter().copied().filter(|other| self::look_up(dag, *other) == Some(look_up)).collect();
            let names = together.iter().map(|id| &self.names.idents[id]);
            let value = expression::tables(dag, &together, &self.names);
            done.insert(look_up).then(|| quote! { let [#(#names),*] = #value; })
        });
        let stores = self.outputs.iter().flat_map(|(array, roots)| {
            let array = ident(array);
            roots.iter().enumerate().map(move |(i, root)| {
                let i = Literal::usize_unsuffixed(i);
                let value = expression::packed(dag, *root, &self.names);
                quote! { #array[#i] = #value; }
            })
        });
        quote! {
            impl lanes::#implements<#(#sizes),*> for #kind {
                #(#[doc = #doc])*
                #[inline(always)]
                fn at<S: Simd>(#(#parameters),*) {
                    #inputs
                    #weights
                    #(#lets)*
                    #(#stores)*
                }
            }
        }
    }

    /// `let [x_0, _, T] = *z;`: those inputs among `first ..` that are needed, by name.
    fn pattern(&self, array: &str, first: usize, length: usize) -> TokenStream {
        let needed = self.inputs.iter().filter(|(i, _)| (first..first + length).contains(i));
        let mut names: Vec<TokenStream> = vec![];
        for (i, name) in needed {
            names.resize(i - first, quote! { _ });
            names.push(quote! { #name });
        }
        if names.is_empty() {
            return TokenStream::new();
        }
        if names.len() < length {
            names.push(quote! { .. });
        }
        let array = ident(array);
        quote! { let [#(#names),*] = *#array; }
    }
}

/// What inputs and weights are called, by number: as `KernelBody::names` says, away from what is
/// ours.
fn input_idents(body: &KernelBody) -> Vec<Ident> {
    let mut scope = Scope::with(&OURS);
    let numbered = |name: &str| {
        name.strip_prefix(['t', 'w']).is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_digit()))
    };
    let inputs = (0..body.inputs).map(|i| match body.names.get(i) {
        Some(name) => ident(&scope.take(name, numbered)),
        None => ident(&scope.take(&format!("input_{i}"), numbered)),
    });
    let inputs: Vec<Ident> = inputs.collect();
    let weights = (0..body.values.len()).map(|row| ident(&format!("w{row}")));
    inputs.into_iter().chain(weights).collect()
}

/// Whether a node computes anything.
fn is_operation(dag: &Dag, id: NodeId) -> bool {
    !matches!(dag.node(id), Node::Const(_) | Node::Input(_))
}

/// Table and arguments of a node that looks a table up.
fn look_up(dag: &Dag, id: NodeId) -> Option<(u32, &[NodeId])> {
    match dag.node(id) {
        Node::Table { table, args, .. } => Some((*table, args)),
        _ => None,
    }
}

/// The operations that are written where they are used: those that are used once, by a result or
/// by an operation whose line has room for them. A look-up never is: it may give several results.
fn in_place(dag: &Dag, operations: &[NodeId], roots: &[NodeId]) -> HashSet<NodeId> {
    let mut uses: HashMap<NodeId, usize> = HashMap::new(); // Looked up, never iterated.
    for id in operations {
        dag.node(*id).for_each_operand(|x| *uses.entry(x).or_default() += 1);
    }
    for root in roots {
        *uses.entry(*root).or_default() += 1;
    }

    let mut in_place: HashSet<NodeId> =
        roots.iter().copied().filter(|root| uses[root] == 1 && look_up(dag, *root).is_none()).collect();
    let mut length: HashMap<NodeId, usize> = HashMap::new();
    for id in operations {
        let mut line = 1;
        dag.node(*id).for_each_operand(|x| {
            let own = length.get(&x).copied().unwrap_or(0);
            if own > 0 && uses[&x] == 1 && line + own <= LINE && look_up(dag, x).is_none() {
                line += own;
                in_place.insert(x);
            }
        });
        length.insert(*id, line);
    }
    in_place
}
