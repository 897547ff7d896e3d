//! One kernel as three functions of arrays: straight lines, without loops or branches.
//!
//! Takes a kernel's shape and formulas, gives `..._values`, `..._derivatives`, `..._probes`, and
//! how each is called. A node that several others need has a `let` of its own; one that a single
//! other needs is written in its place as long as the line stays short. Both passes are loops over
//! the schedule, so a sum of any length is many short lines, never one deep expression.
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
const OURS: [&str; 10] = ["simd", "z", "w", "tables", "out", "values", "jacobian", "hessian", "math", "f64"];

/// A kernel's functions, and calls of them from `lanes`.
pub(super) struct Functions {
    /// The items.
    pub(super) items: TokenStream,
    /// What `lanes` calls for values.
    pub(super) values: TokenStream,
    /// What it calls for derivatives; none where nothing is differentiated.
    pub(super) derivatives: Option<TokenStream>,
    /// What it calls for probes; none where there are none.
    pub(super) probes: Option<TokenStream>,
}

/// Writes a kernel's functions under names that begin with `name`.
pub(super) fn functions(name: &str, shape: &Kernel, body: &KernelBody) -> Functions {
    let values = Function::new(body, &[("out", &body.values)]);
    let derivatives = (shape.slots > 0).then(|| {
        Function::new(body, &[("values", &body.values), ("jacobian", &body.jacobian), ("hessian", &body.hessian)])
    });
    let probes = (!body.probes.is_empty()).then(|| Function::new(body, &[("out", &body.probes)]));

    let titles = [("values", results(body)), ("derivatives", derivatives_of(shape, body)), ("probes", probed(shape))];
    let [in_values, in_derivatives, in_probes] = titles.map(|(what, doc)| (format!("{name}_{what}"), doc));
    let written = [
        Some(values.write(&in_values.0, &in_values.1)),
        derivatives.as_ref().map(|f| f.write(&in_derivatives.0, &in_derivatives.1)),
        probes.as_ref().map(|f| f.write(&in_probes.0, &in_probes.1)),
    ];
    Functions {
        items: written.into_iter().flatten().collect(),
        values: values.call(&in_values.0),
        derivatives: derivatives.map(|f| f.call(&in_derivatives.0)),
        probes: probes.map(|f| f.call(&in_probes.0)),
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
    tables: bool,
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
        let tables = needed.iter().any(|id| matches!(body.dag.node(*id), Node::Table { .. }));

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
        Self { body, outputs, schedule, inputs, names, tables }
    }

    /// The parameters of the function, as `(name, type)`.
    fn parameters(&self) -> Vec<(Ident, TokenStream)> {
        let array = |length: usize| {
            let length = Literal::usize_unsuffixed(length);
            quote! { [Pack<S>; #length] }
        };
        let (inputs, rows) = (array(self.body.inputs), array(self.body.values.len()));
        let mut parameters = vec![(ident("simd"), quote! { S }), (ident("z"), quote! { &#inputs })];
        if self.outputs.len() > 1 {
            parameters.push((ident("w"), quote! { &#rows }));
        }
        if self.tables {
            parameters.push((ident("tables"), quote! { &[Table] }));
        }
        for (name, roots) in &self.outputs {
            let results = array(roots.len());
            parameters.push((ident(name), quote! { &mut #results }));
        }
        parameters
    }

    fn write(&self, name: &str, doc: &[String]) -> TokenStream {
        let (name, dag) = (ident(name), &self.body.dag);
        let parameters = self.parameters().into_iter().map(|(name, kind)| quote! { #name: #kind });
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
            #(#[doc = #doc])*
            #[inline(always)]
            pub(super) fn #name<S: Simd>(#(#parameters),*) {
                #inputs
                #weights
                #(#lets)*
                #(#stores)*
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

    /// What `lanes` calls: the function itself, or a closure that adds the tables.
    fn call(&self, name: &str) -> TokenStream {
        let name = ident(name);
        if !self.tables {
            return quote! { kernels::#name };
        }
        let arguments: Vec<Ident> = self.parameters().into_iter().map(|(name, _)| name).collect();
        let of_lane = arguments.iter().filter(|name| *name != "tables");
        quote! { |#(#of_lane),*| kernels::#name(#(#arguments),*) }
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
