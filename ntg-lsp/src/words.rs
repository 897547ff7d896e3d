//! Expressions of the compiler's graph in the words of the language, for people to read.

use ntg_compiler::expr::{Binary, Fold, Node, NodeId, Unary};
use ntg_compiler::model::problem::{At, Form, Leaf, PhaseAt, Problem};

/// Characters after which an expression is cut: it is to be glanced at.
const LONGEST: usize = 400;

/// Precedences: sums, products, signs, powers, everything else.
const SUM: u8 = 0;
const PRODUCT: u8 = 1;
const SIGN: u8 = 2;
const POWER: u8 = 3;
const ATOM: u8 = 4;

/// An expression as text, cut where it becomes long.
pub fn expression(problem: &Problem, node: NodeId) -> String {
    let mut writer = Writer { problem, text: String::new() };
    writer.node(node, SUM);
    writer.text
}

struct Writer<'a> {
    problem: &'a Problem,
    text: String,
}

impl Writer<'_> {
    fn put(&mut self, text: &str) {
        self.text.push_str(text);
    }

    /// Writes a node, in parentheses if it binds more loosely than `least`.
    fn node(&mut self, node: NodeId, least: u8) {
        if self.text.len() > LONGEST {
            if !self.text.ends_with("...") {
                self.put("...");
            }
            return;
        }
        let parts = self.problem.dag.node(node).clone();
        let own = strength(&parts);
        if own < least {
            self.put("(");
        }
        self.bare(&parts);
        if own < least {
            self.put(")");
        }
    }

    fn bare(&mut self, node: &Node) {
        match node {
            Node::Const(number) => self.put(&number.value().to_string()),
            Node::Input(input) => {
                let leaf = self.problem.leaves.leaf(*input).clone();
                let words = self.leaf(&leaf);
                self.put(&words);
            }
            Node::Unary(Unary::Neg, x) => {
                self.put("-");
                self.node(*x, SIGN);
            }
            Node::Unary(op, x) => self.call(op.name(), &[*x]),
            Node::Binary(op, a, b) => self.binary(*op, *a, *b),
            Node::Powi(x, exponent) => {
                self.node(*x, ATOM);
                self.put(&format!("^{exponent}"));
            }
            Node::Select { condition, then, otherwise } => self.call("select", &[*condition, *then, *otherwise]),
            Node::Table { table, derivative, args } => {
                let name = self.problem.tables.get(*table as usize).map_or("table", |table| table.name.as_str());
                let primes: String = derivative.iter().map(|order| "'".repeat(usize::from(*order))).collect();
                self.call(&format!("{name}{primes}"), args);
            }
            Node::Reduce { fold, body, .. } => {
                let fold = match fold {
                    Fold::Sum => "sum",
                    Fold::Product => "prod",
                    Fold::Min => "min",
                    Fold::Max => "max",
                };
                self.call(fold, &[*body]);
            }
        }
    }

    fn binary(&mut self, op: Binary, a: NodeId, b: NodeId) {
        let (sign, left, right) = match op {
            Binary::Add => (" + ", SUM, SUM),
            Binary::Sub => (" - ", SUM, PRODUCT),
            Binary::Mul => (" * ", PRODUCT, PRODUCT),
            Binary::Div => (" / ", PRODUCT, SIGN),
            Binary::Pow => ("^", ATOM, ATOM),
            Binary::Atan2 | Binary::Hypot | Binary::Min | Binary::Max => return self.call(op.name(), &[a, b]),
            Binary::LessEq => (" <= ", PRODUCT, PRODUCT),
        };
        self.node(a, left);
        self.put(sign);
        self.node(b, right);
    }

    fn call(&mut self, name: &str, args: &[NodeId]) {
        self.put(name);
        self.put("(");
        for (i, arg) in args.iter().enumerate() {
            self.put(if i > 0 { ", " } else { "" });
            self.node(*arg, SUM);
        }
        self.put(")");
    }

    fn leaf(&self, leaf: &Leaf) -> String {
        match leaf {
            Leaf::Flat { phase, at, output, index, order } => {
                let outputs = self.problem.phases.get(phase.phase).map(|phase| phase.outputs.as_slice());
                let name = outputs.and_then(|o| o.get(*output)).map_or("output", |output| output.name.as_str());
                let value = match (member(name, index.as_ref()), order) {
                    (name, 0) => name,
                    (name, 1) => format!("der({name})"),
                    (name, order) => format!("der({name}, {order})"),
                };
                match at {
                    At::Here => value,
                    At::Start => format!("initial({value})"),
                    At::End => format!("final({value})"),
                    At::Among { .. } => format!("at(.., {value})"),
                    At::Inside(instant) => format!("at({} * {}, {value})", instant.tau(), self.duration(phase)),
                }
            }
            Leaf::Time(_) => "t".to_owned(),
            Leaf::Tau => "tau".to_owned(),
            Leaf::Duration(phase) => self.duration(phase),
            Leaf::Start(phase) => format!("start({})", self.phase(phase)),
            Leaf::Parameter { parameter, index } => {
                let name = self.problem.parameters.get(*parameter).map_or("param", |p| p.name.as_str());
                member(name, index.as_ref())
            }
            Leaf::Variable { variable, index } => {
                let name = self.problem.variables.get(*variable).map_or("variable", |v| v.name.as_str());
                member(name, index.as_ref())
            }
            Leaf::Index(index) => form(index),
            Leaf::Integral { .. } => "integral(...)".to_owned(),
            Leaf::Symbol(_) => "...".to_owned(),
        }
    }

    fn duration(&self, phase: &PhaseAt) -> String {
        let declared = self.problem.phases.get(phase.phase).and_then(|phase| phase.duration_name.clone());
        declared.unwrap_or_else(|| format!("duration({})", self.phase(phase)))
    }

    fn phase(&self, phase: &PhaseAt) -> String {
        let name = self.problem.phases.get(phase.phase).and_then(|phase| phase.name.as_deref());
        member(name.unwrap_or_default(), phase.index.as_ref())
    }
}

fn strength(node: &Node) -> u8 {
    match node {
        Node::Const(number) if number.value() < 0.0 => SIGN,
        Node::Unary(Unary::Neg, _) => SIGN,
        Node::Binary(Binary::Add | Binary::Sub, ..) => SUM,
        Node::Binary(Binary::Mul | Binary::Div | Binary::LessEq, ..) => PRODUCT,
        Node::Binary(Binary::Pow, ..) | Node::Powi(..) => POWER,
        _ => ATOM,
    }
}

fn member(name: &str, index: Option<&Form>) -> String {
    index.map_or_else(|| name.to_owned(), |index| format!("{name}[{}]", form(index)))
}

/// An index; the compiler knows indices by number, so the first is shown as `i`, the next as `j`.
fn form(form: &Form) -> String {
    let mut text = String::new();
    for ((_, factor), letter) in form.terms.iter().zip('i'..='z') {
        let sign = if text.is_empty() { "" } else { " + " };
        let factor = if *factor == 1 { String::new() } else { format!("{factor} * ") };
        text.push_str(&format!("{sign}{factor}{letter}"));
    }
    match (text.is_empty(), form.constant) {
        (true, constant) => constant.to_string(),
        (false, 0) => text,
        (false, constant) if constant < 0 => format!("{text} - {}", -constant),
        (false, constant) => format!("{text} + {constant}"),
    }
}
