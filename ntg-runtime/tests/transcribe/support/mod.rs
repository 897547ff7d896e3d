//! Hand-made problems: a structure and kernels as closures over jets.
#![expect(unreachable_pub, reason = "modules of a test are not seen from outside")]

pub mod jet;
pub mod oracle;
pub mod problems;

use jet::Jet;
use ntg_runtime::problem::{Derivatives, Lanes, Problem};
use ntg_runtime::splines::Table;
use ntg_runtime::structure::*;

pub type Formula = fn(&[Jet]) -> Vec<Jet>;

/// A problem made by hand.
#[derive(Default)]
pub struct Double {
    pub structure: Structure,
    pub formulas: Vec<Formula>,
}

impl Double {
    /// Adds a kernel with dense patterns; every row has the same degree.
    pub fn kernel(&mut self, inputs: (usize, usize), rows: usize, degree: Degree, formula: Formula) -> usize {
        let (slots, data) = inputs;
        let jacobian = (0..rows).flat_map(|r| (0..slots).map(move |s| (r, s))).collect();
        let curved = degree > Degree::Linear;
        let hessian = (0..slots).flat_map(|i| (0..=i).map(move |j| (i, j))).filter(|_| curved).collect();
        let probes = (0..rows).map(|r| place(&format!("probe {r}"))).collect();
        let name = format!("kernel_{}", self.formulas.len());
        let degree = vec![degree; rows];
        self.structure.kernels.push(Kernel { name, slots, data, rows, jacobian, hessian, degree, probes });
        self.formulas.push(formula);
        self.formulas.len() - 1
    }

    /// A call of a parameter's value.
    pub fn parameter(&mut self, name: &str, value: &[f64], unit: Unit) -> usize {
        let array = value.len() > 1;
        let value = value.to_vec();
        self.structure.parameters.push(Parameter {
            name: name.into(),
            doc: String::new(),
            unit,
            array,
            grid: None,
            value,
        });
        self.structure.parameters.len() - 1
    }

    /// A call that gives back the values of some parameters.
    pub fn values_of(&mut self, parameters: &[usize]) -> Call {
        let data: Vec<Data> = parameters.iter().map(|p| Data::Parameter { parameter: *p, index: None }).collect();
        let kernel = self.kernel((0, data.len()), data.len(), Degree::Constant, |u| u.to_vec());
        Call { kernel, data, ..Call::default() }
    }

    /// A call that gives constants, by way of a new parameter each.
    pub fn constants(&mut self, values: &[f64]) -> Call {
        let name = |i: usize| format!("constant {i}");
        let parameters: Vec<usize> =
            values.iter().enumerate().map(|(i, v)| self.parameter(&name(i), &[*v], Unit::default())).collect();
        self.values_of(&parameters)
    }

    pub fn constraint(&mut self, name: &str, block: Block) -> usize {
        let unit = Unit::default();
        self.structure.constraints.push(Constraint {
            name: Some(name.into()),
            place: place(name),
            block,
            unit,
            sides: 0,
        });
        self.structure.constraints.len() - 1
    }

    pub fn term(&mut self, name: &str) -> usize {
        self.structure.terms.push(Term { name: Some(name.into()), place: place(name), unit: Unit::default() });
        self.structure.terms.len() - 1
    }

    fn jets(&self, kernel: usize, inputs: &[f64], lanes: usize, lane: usize) -> Vec<Jet> {
        let shape = &self.structure.kernels[kernel];
        let n = shape.slots;
        let input = |i: usize| inputs[i * lanes + lane];
        let jets: Vec<Jet> = (0..n)
            .map(|i| Jet::variable(input(i), i, n))
            .chain((n..n + shape.data).map(|i| Jet::constant(input(i), n)))
            .collect();
        (self.formulas[kernel])(&jets)
    }
}

impl Problem for Double {
    fn structure(&self) -> Structure {
        self.structure.clone()
    }

    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], _: &[Table], values: &mut [f64]) {
        for lane in 0..lanes {
            for (r, row) in self.jets(kernel, inputs, lanes, lane).iter().enumerate() {
                values[r * lanes + lane] = row.v;
            }
        }
    }

    fn derivatives(&self, kernel: usize, point: Lanes<'_>, _: &[Table], out: Derivatives<'_>) {
        let shape = &self.structure.kernels[kernel];
        let lanes = point.lanes;
        for lane in 0..lanes {
            let rows = self.jets(kernel, point.inputs, lanes, lane);
            for (r, row) in rows.iter().enumerate() {
                out.values[r * lanes + lane] = row.v;
            }
            for (k, (r, s)) in shape.jacobian.iter().enumerate() {
                out.jacobian[k * lanes + lane] = rows[*r].g[*s];
            }
            for (k, (i, j)) in shape.hessian.iter().enumerate() {
                let weighted = rows.iter().enumerate();
                let weighted = weighted.map(|(r, row)| point.weights[r * lanes + lane] * row.h[i * shape.slots + j]);
                out.hessian[k * lanes + lane] = weighted.sum();
            }
        }
    }

    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]) {
        self.values(kernel, lanes, inputs, tables, probes);
    }
}

pub fn place(text: &str) -> Place {
    Place { line: 1, column: 1, text: text.into() }
}

/// A phase of the only agent, or of a family.
pub fn phase(family: bool, phase: usize) -> PhaseRef {
    PhaseRef { phase, agent: family.then(|| Affine::index(0)), index: None }
}

/// The derivative of an output in a phase.
pub fn flat(phase: PhaseRef, at: At, output: usize, derivative: usize) -> Slot {
    Slot::Flat { phase, at, output, index: None, derivative }
}

pub fn agent(name: Option<&str>, family: Option<Family>) -> Agent {
    Agent { name: name.map(Into::into), family, start: Start::Fixed(None), duration_name: None, place: place("agent") }
}

pub fn output(name: &str, order: usize, intervals: usize, smoothness: usize) -> Output {
    let breakpoints = (0..=intervals).map(|i| i as f64 / intervals as f64).collect();
    let spline = Spline { order, smoothness, breakpoints };
    Output { name: name.into(), doc: String::new(), unit: Unit::default(), family: None, vector: None, spline }
}

pub fn phase_of(agent: usize, name: Option<&str>, duration: Duration, outputs: Vec<Output>, points: usize) -> Phase {
    Phase {
        name: name.map(Into::into),
        agent,
        family: None,
        after: None,
        duration,
        duration_name: None,
        outputs,
        points: vec![Points::Gauss { points }, Points::Breakpoints],
        place: place("phase"),
    }
}

pub fn group(domain: Domain, call: Call, rows: Vec<Row>) -> Group {
    Group { loops: vec![], domain, call, rows, bounds: None }
}

/// An equality between a row and bound `bound`.
pub fn equal(constraint: usize, bound: usize) -> Row {
    Row::Constraint { constraint, lower: Some(bound), upper: Some(bound) }
}
