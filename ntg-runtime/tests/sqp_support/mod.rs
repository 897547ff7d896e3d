//! Nonlinear programs written by hand for the tests: ordinary functions of *jets*, which carry exact
//! first and second derivatives.
#![allow(dead_code, unreachable_pub, reason = "each test file uses the part that it needs")]

use ntg_runtime::nlp::{Block, BlockValues, Evaluation, Limits, Nlp, NotFinite, Target};
use ntg_runtime::structure::{Degree, Place};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number with its gradient and Hessian.
#[derive(Clone, Debug)]
pub struct Jet {
    /// The number.
    pub v: f64,
    g: Vec<f64>,
    h: Vec<f64>,
}

impl Jet {
    fn variable(v: f64, index: usize, n: usize) -> Self {
        let mut g = vec![0.0; n];
        g[index] = 1.0;
        Self { v, g, h: vec![0.0; n * n] }
    }

    /// A constant with as many derivatives as this jet.
    pub fn constant(&self, v: f64) -> Self {
        Self { v, g: vec![0.0; self.g.len()], h: vec![0.0; self.h.len()] }
    }

    /// `f` of this jet, given its value and two derivatives.
    fn chain(&self, f: f64, df: f64, ddf: f64) -> Self {
        let n = self.g.len();
        let g = self.g.iter().map(|g| df * g).collect();
        let h = (0..n * n).map(|at| df * self.h[at] + ddf * self.g[at / n] * self.g[at % n]).collect();
        Self { v: f, g, h }
    }

    pub fn powi(&self, k: i32) -> Self {
        let (x, n) = (self.v, f64::from(k));
        let second = if k == 1 { 0.0 } else { n * (n - 1.0) * x.powi(k - 2) };
        self.chain(x.powi(k), n * x.powi(k - 1), second)
    }

    pub fn powf(&self, k: f64) -> Self {
        self.chain(self.v.powf(k), k * self.v.powf(k - 1.0), k * (k - 1.0) * self.v.powf(k - 2.0))
    }

    pub fn sqrt(&self) -> Self {
        self.powf(0.5)
    }

    pub fn exp(&self) -> Self {
        let e = self.v.exp();
        self.chain(e, e, e)
    }

    pub fn ln(&self) -> Self {
        self.chain(self.v.ln(), 1.0 / self.v, -1.0 / (self.v * self.v))
    }

    pub fn sin(&self) -> Self {
        self.chain(self.v.sin(), self.v.cos(), -self.v.sin())
    }

    pub fn cos(&self) -> Self {
        self.chain(self.v.cos(), -self.v.sin(), -self.v.cos())
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait<&Jet> for Jet { type Output = Jet; fn $method(self, o: &Jet) -> Jet { (&self).$method(o) } }
        impl $trait<Jet> for &Jet { type Output = Jet; fn $method(self, o: Jet) -> Jet { self.$method(&o) } }
        impl $trait<Jet> for Jet { type Output = Jet; fn $method(self, o: Jet) -> Jet { (&self).$method(&o) } }
        impl $trait<f64> for Jet { type Output = Jet; fn $method(self, o: f64) -> Jet { (&self).$method(&self.constant(o)) } }
        impl $trait<f64> for &Jet { type Output = Jet; fn $method(self, o: f64) -> Jet { self.$method(&self.constant(o)) } }
        impl $trait<Jet> for f64 { type Output = Jet; fn $method(self, o: Jet) -> Jet { o.constant(self).$method(&o) } }
        impl $trait<&Jet> for f64 { type Output = Jet; fn $method(self, o: &Jet) -> Jet { o.constant(self).$method(o) } }
    )*};
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl Add<&Jet> for &Jet {
    type Output = Jet;
    fn add(self, o: &Jet) -> Jet {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Jet { v: self.v + o.v, g: sum(&self.g, &o.g), h: sum(&self.h, &o.h) }
    }
}

impl Neg for &Jet {
    type Output = Jet;
    fn neg(self) -> Jet {
        self.chain(-self.v, -1.0, 0.0)
    }
}

impl Neg for Jet {
    type Output = Jet;
    fn neg(self) -> Jet {
        -&self
    }
}

impl Sub<&Jet> for &Jet {
    type Output = Jet;
    fn sub(self, o: &Jet) -> Jet {
        self + &(-o)
    }
}

impl Mul<&Jet> for &Jet {
    type Output = Jet;
    fn mul(self, o: &Jet) -> Jet {
        let n = self.g.len();
        let g = (0..n).map(|i| self.g[i] * o.v + self.v * o.g[i]).collect();
        let mixed = |at: usize| self.g[at / n] * o.g[at % n] + self.g[at % n] * o.g[at / n];
        let h = (0..n * n).map(|at| self.h[at] * o.v + self.v * o.h[at] + mixed(at)).collect();
        Jet { v: self.v * o.v, g, h }
    }
}

impl Div<&Jet> for &Jet {
    type Output = Jet;
    fn div(self, o: &Jet) -> Jet {
        self * &o.chain(1.0 / o.v, -1.0 / (o.v * o.v), 2.0 / (o.v * o.v * o.v))
    }
}

/// The functions of one element: slots to rows.
pub type Functions = Box<dyn Fn(&[Jet]) -> Vec<Jet> + Sync>;

/// One element: its variables, its map (row by row), its offsets, where its rows go, and its weights.
pub struct Element {
    pub variables: Vec<u32>,
    pub map: Vec<f64>,
    pub offset: Vec<f64>,
    pub target: Vec<Target>,
    pub weight: Vec<f64>,
}

/// A program made of blocks of jets' functions.
pub struct Program {
    pub blocks: Vec<Block>,
    functions: Vec<Functions>,
    pub limits: Limits,
}

/// No bound.
pub const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

impl Program {
    /// A program without functions.
    pub fn new(bounds: &[(f64, f64)], row_bounds: &[(f64, f64)]) -> Self {
        let (lower, upper) = bounds.iter().copied().unzip();
        let (row_lower, row_upper) = row_bounds.iter().copied().unzip();
        let (scale, row_scale) = (vec![1.0; bounds.len()], vec![1.0; row_bounds.len()]);
        let limits = Limits { lower, upper, scale, row_lower, row_upper, row_scale };
        Self { blocks: Vec::new(), functions: Vec::new(), limits }
    }

    /// A program whose functions are one element: first the objective, then the rows.
    pub fn dense(
        bounds: &[(f64, f64)],
        row_bounds: &[(f64, f64)],
        functions: impl Fn(&[Jet]) -> Vec<Jet> + Sync + 'static,
    ) -> Self {
        let (n, m) = (bounds.len(), row_bounds.len());
        let element = Element {
            variables: (0..n as u32).collect(),
            map: (0..n * n).map(|at| if at / n == at % n { 1.0 } else { 0.0 }).collect(),
            offset: vec![0.0; n],
            target: (0..=m as u32).map(|i| if i == 0 { Target::Objective } else { Target::Row(i - 1) }).collect(),
            weight: vec![1.0; m + 1],
        };
        let mut program = Self::new(bounds, row_bounds);
        program.block(n, m + 1, &[element], functions);
        program
    }

    /// Adds elements of one shape.
    pub fn block(
        &mut self,
        slots: usize,
        rows: usize,
        elements: &[Element],
        functions: impl Fn(&[Jet]) -> Vec<Jet> + Sync + 'static,
    ) {
        let mut block = Block {
            elements: elements.len(),
            slots,
            rows,
            jacobian: (0..rows).flat_map(|row| (0..slots).map(move |slot| (row, slot))).collect(),
            hessian: (0..slots).flat_map(|i| (0..=i).map(move |j| (i, j))).collect(),
            degree: vec![Degree::Nonlinear; rows],
            variable_start: vec![0],
            map_start: vec![0],
            tau: vec![f64::NAN; elements.len()],
            ..Block::default()
        };
        for element in elements {
            block.variables.extend(&element.variables);
            block.variable_start.push(block.variables.len());
            block.map.extend(&element.map);
            block.map_start.push(block.map.len());
        }
        block.offset = (0..slots).flat_map(|slot| elements.iter().map(move |e| e.offset[slot])).collect();
        block.target = (0..rows).flat_map(|row| elements.iter().map(move |e| e.target[row])).collect();
        block.weight = (0..rows).flat_map(|row| elements.iter().map(move |e| e.weight[row])).collect();
        self.blocks.push(block);
        self.functions.push(Box::new(functions));
    }

    fn slots(&self, block: usize, e: usize, x: &[f64]) -> Vec<Jet> {
        let block = &self.blocks[block];
        let (variables, map) = (block.variables(e), block.map(e));
        let width = variables.len();
        let slot = |s: usize| {
            let sum: f64 = variables.iter().enumerate().map(|(k, v)| map[s * width + k] * x[*v as usize]).sum();
            Jet::variable(sum + block.offset[s * block.elements + e], s, block.slots)
        };
        (0..block.slots).map(slot).collect()
    }

    fn evaluate(&self, x: &[f64], weights: Option<(f64, &[f64])>, out: &mut Evaluation) -> Result<(), NotFinite> {
        out.objective = 0.0;
        out.rows.fill(0.0);
        let mut sum = 0.0;
        for (number, block) in self.blocks.iter().enumerate() {
            for e in 0..block.elements {
                let jets = (self.functions[number])(&self.slots(number, e, x));
                let values = &mut out.blocks[number];
                let mut hessian = vec![0.0; block.slots * block.slots];
                for (row, jet) in jets.iter().enumerate() {
                    let lane = row * block.elements + e;
                    let weight = block.weight[lane];
                    values.values[lane] = jet.v;
                    sum += jet.v;
                    let factor = match block.target[lane] {
                        Target::Objective => {
                            out.objective += weight * jet.v;
                            weights.map_or(0.0, |(objective, _)| objective)
                        }
                        Target::Row(i) => {
                            out.rows[i as usize] += weight * jet.v;
                            weights.map_or(0.0, |(_, rows)| rows[i as usize])
                        }
                    };
                    if weights.is_some() {
                        for slot in 0..block.slots {
                            values.jacobian[(row * block.slots + slot) * block.elements + e] = jet.g[slot];
                            sum += jet.g[slot];
                        }
                        hessian.iter_mut().zip(&jet.h).for_each(|(out, h)| *out += factor * weight * h);
                    }
                }
                for (entry, &(i, j)) in block.hessian.iter().enumerate() {
                    values.hessian[entry * block.elements + e] = hessian[i * block.slots + j];
                    sum += hessian[i * block.slots + j];
                }
            }
        }
        if sum.is_finite() { Ok(()) } else { Err(not_finite(sum)) }
    }
}

/// What the tests' programs say when a number is not finite.
fn not_finite(value: f64) -> NotFinite {
    NotFinite { place: Place { text: "a function".into(), ..Place::default() }, value, point: String::new() }
}

impl Nlp for Program {
    type Workspace = ();

    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn workspace(&self) -> ((), Evaluation) {
        let values = |block: &Block| BlockValues {
            values: vec![f64::NAN; block.rows * block.elements],
            jacobian: vec![f64::NAN; block.jacobian.len() * block.elements],
            hessian: vec![f64::NAN; block.hessian.len() * block.elements],
        };
        let blocks = self.blocks.iter().map(values).collect();
        ((), Evaluation { objective: 0.0, rows: vec![0.0; self.limits.row_lower.len()], blocks })
    }

    fn values(&self, x: &[f64], _: &mut (), out: &mut Evaluation) -> Result<(), NotFinite> {
        self.evaluate(x, None, out)
    }

    fn derivatives(&self, x: &[f64], w: f64, rows: &[f64], _: &mut (), out: &mut Evaluation) -> Result<(), NotFinite> {
        self.evaluate(x, Some((w, rows)), out)
    }

    fn row_name(&self, row: usize) -> String {
        format!("row {row}")
    }

    fn variable_name(&self, variable: usize) -> String {
        format!("x[{variable}]")
    }
}
