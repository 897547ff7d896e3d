//! Builds problems from text, and evaluates their expressions at given values of the leaves.

use std::collections::HashMap;

use ntg_compiler::diagnostic::{Diagnostic, Severity};
use ntg_compiler::expr::{Environment, Node, NodeId, eval_in};
use ntg_compiler::model::problem::{At, Form, Leaf, Problem};
use ntg_compiler::model::{Loader, build};
use ntg_compiler::program::Program;
use ntg_compiler::source::Source;
use ntg_compiler::syntax::parse;
use ntg_splines::{Axis, Extrapolation, Method, Symmetry};
use ntg_structure::{Place, TableExtrapolation, TableMethod, TableSymmetry};

/// Files by path.
pub(crate) struct Files(pub(crate) Vec<(&'static str, &'static str)>);

impl Loader for Files {
    fn load(&self, path: &str) -> Result<String, String> {
        let found = self.0.iter().find(|(name, _)| *name == path);
        found.map(|(_, text)| (*text).to_owned()).ok_or_else(|| "no such file".to_owned())
    }
}

/// The problem that a good spec means.
#[track_caller]
pub(crate) fn good(text: &str) -> Problem {
    let source = Source::new("spec.ntg", text);
    let spec = parse(&source).unwrap_or_else(|found| panic!("{}", found.render(&source)));
    let (problem, found) = build(&spec, &source, &Files(vec![]));
    let rendered: Vec<String> = found.iter().map(|finding| finding.render(&source)).collect();
    problem.unwrap_or_else(|| panic!("{}", rendered.join("\n\n")))
}

/// The program of a good spec, without the places and the texts of the spec.
#[track_caller]
pub(crate) fn program(text: &str) -> Program {
    let source = Source::new("spec.ntg", text);
    let compiled = ntg_compiler::compile(&source, &Files(vec![]));
    let mut program = compiled.unwrap_or_else(|found| panic!("{}", found.render(&source))).program;
    let structure = &mut program.structure;
    structure.constraints.iter_mut().for_each(|constraint| constraint.place = Place::default());
    // What has no name of its own is called by the text of its element.
    let is_name = |name: &String| !name.contains(' ');
    structure.constraints.iter_mut().for_each(|constraint| constraint.name = constraint.name.take().filter(is_name));
    structure.terms.iter_mut().for_each(|term| term.place = Place::default());
    structure.variables.iter_mut().for_each(|variable| variable.place = Place::default());
    structure.agents.iter_mut().for_each(|agent| agent.place = Place::default());
    structure.phases.iter_mut().for_each(|phase| phase.place = Place::default());
    structure.integrals.iter_mut().for_each(|integral| integral.place = Place::default());
    structure.kernels.iter_mut().for_each(|kernel| kernel.probes.fill(Place::default()));
    structure.corners.clear();
    program.kernels.iter_mut().for_each(|kernel| kernel.labels.clear());
    program
}

/// Holds a problem against what the model promises: without errors there is one, and nothing in it
/// came from something that was refused.
#[track_caller]
pub(crate) fn assert_consistent(text: &str, problem: Option<&Problem>, found: &[Diagnostic]) {
    let failed = found.iter().any(|finding| finding.severity == Severity::Error);
    assert_eq!(problem.is_none(), failed, "{text}");
    let Some(problem) = problem else { return };
    let bounds = problem.constraints.iter().flat_map(|c| [c.bounds.lower, c.bounds.upper]).flatten();
    let bodies = problem.constraints.iter().map(|c| c.body);
    let rest = problem.objective.iter().map(|t| t.body).chain(problem.named.iter().map(|n| n.body));
    let roots: Vec<NodeId> = bounds.chain(bodies).chain(rest).collect();
    for id in problem.dag.schedule(&roots) {
        assert!(!problem.dag.is_constant(id).is_some_and(f64::is_nan), "a refused value is left in {text}");
        if let Node::Input(input) = problem.dag.node(id) {
            assert!(!matches!(problem.leaves.leaf(*input), Leaf::Symbol(_)), "a placeholder is left in {text}");
        }
    }
}

/// All findings of a spec, as a person sees them.
#[track_caller]
pub(crate) fn findings_with(text: &str, files: &dyn Loader) -> String {
    let source = Source::new("spec.ntg", text);
    let spec = match parse(&source) {
        Ok(spec) => spec,
        Err(found) => return format!("not even parsed:\n{}", found.render(&source)),
    };
    let (problem, found) = build(&spec, &source, files);
    assert_consistent(text, problem.as_ref(), &found);
    let rendered: Vec<String> = found.iter().map(|finding| finding.render(&source)).collect();
    rendered.join("\n\n")
}

/// As [`findings_with`], without files.
pub(crate) fn findings(text: &str) -> String {
    findings_with(text, &Files(vec![]))
}

/// A value for a name, a member, an order of derivative and a point.
pub(crate) type Flat = dyn Fn(&str, Option<i64>, usize, At) -> f64;

/// What leaves are worth.
#[derive(Clone, Copy)]
pub(crate) struct World<'w> {
    /// Outputs and their derivatives.
    pub(crate) flat: &'w Flat,
    /// Everything else, by a word such as `T`, `tau`, `v_max`, `v_max[2]`.
    pub(crate) other: &'w dyn Fn(&str) -> f64,
}

struct Reality<'w> {
    problem: &'w Problem,
    world: World<'w>,
    indices: HashMap<u32, i64>,
}

impl Reality<'_> {
    fn form(&self, form: &Form) -> i64 {
        form.constant + form.terms.iter().map(|(index, c)| c * self.indices[&index.0]).sum::<i64>()
    }
}

impl Environment<f64> for Reality<'_> {
    fn input(&mut self, input: ntg_compiler::expr::InputId) -> f64 {
        match self.problem.leaves.leaf(input).clone() {
            Leaf::Flat { phase, at, output, index, order } => {
                let name = &self.problem.phases[phase.phase].outputs[output].name;
                (self.world.flat)(name, index.map(|form| self.form(&form)), order, at)
            }
            Leaf::Time(_) => (self.world.other)("t"),
            Leaf::Tau => (self.world.other)("tau"),
            Leaf::Duration(_) => (self.world.other)("T"),
            Leaf::Start(_) => (self.world.other)("start"),
            Leaf::Parameter { parameter, index } => {
                let declared = &self.problem.parameters[parameter];
                index.map_or(declared.value[0], |form| declared.value[self.form(&form) as usize - 1])
            }
            Leaf::Variable { variable, .. } => (self.world.other)(&self.problem.variables[variable].name),
            Leaf::Index(form) => self.form(&form) as f64,
            Leaf::Integral { integrand, .. } => {
                // A constant integrand over the duration; enough for tests.
                value_at(self.problem, integrand, self.world, &self.indices) * (self.world.other)("T")
            }
            Leaf::Symbol(_) => panic!("a placeholder is left"),
        }
    }

    fn table(&mut self, table: u32, args: &[f64], derivative: &[u8]) -> Option<f64> {
        let table = self.problem.tables.get(table as usize)?;
        let axes = table.axes.iter().map(|axis| Axis {
            nodes: axis.nodes.clone(),
            symmetry: match axis.symmetry {
                TableSymmetry::Plain => Symmetry::Plain,
                TableSymmetry::Even => Symmetry::Even,
                TableSymmetry::Periodic => Symmetry::Periodic,
            },
        });
        let method = match &table.method {
            TableMethod::Monotone => Method::Monotone,
            TableMethod::Bspline { order } => Method::Bspline { order: *order },
            TableMethod::Fit { order, intervals } => Method::Fit { order: *order, intervals: intervals.clone() },
            TableMethod::Linear => Method::Linear,
        };
        let outside = match table.extrapolation {
            TableExtrapolation::Clamp => Extrapolation::Clamp,
            TableExtrapolation::Linear => Extrapolation::Linear,
        };
        let made = ntg_splines::Table::new(axes.collect(), table.values.clone(), method, outside);
        Some(made.expect("a table that the compiler let pass").eval(args, derivative))
    }

    fn range(&mut self, range: u32) -> Option<Vec<i64>> {
        let over = self.problem.ranges.get(range as usize)?;
        Some((self.form(&over.first)..=self.form(&over.last)).collect())
    }

    fn bind(&mut self, index: u32, value: Option<i64>) -> Option<i64> {
        match value {
            Some(value) => self.indices.insert(index, value),
            None => self.indices.remove(&index),
        }
    }
}

/// A node's value in a world, for given values of loop indices.
pub(crate) fn value_at(problem: &Problem, node: NodeId, world: World<'_>, indices: &HashMap<u32, i64>) -> f64 {
    let mut reality = Reality { problem, world, indices: indices.clone() };
    eval_in(&problem.dag, &[node], &mut reality).expect("tables and ranges are known")[0]
}

/// A node's value in a world.
pub(crate) fn value(problem: &Problem, node: NodeId, world: World<'_>) -> f64 {
    value_at(problem, node, world, &HashMap::new())
}

/// The body of a named expression.
#[track_caller]
pub(crate) fn named(problem: &Problem, name: &str) -> NodeId {
    problem.named.iter().find(|named| named.name == name).unwrap_or_else(|| panic!("no `{name}`")).body
}

/// Asserts that two numbers agree to rounding.
#[track_caller]
pub(crate) fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-12 * (1.0 + a.abs().max(b.abs())), "{a} is not {b}");
}
