//! Nonlinear programs written by hand for the tests: ordinary functions of *jets*, which carry exact
//! first and second derivatives.
#![allow(dead_code, unreachable_pub, reason = "each test file uses the part that it needs")]

use ntg_nlp::closures::{Element, Functions, Program};
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

/// Functions of jets as a closure that writes values, gradients and Hessians.
pub fn of_jets(functions: impl Fn(&[Jet]) -> Vec<Jet> + Sync) -> impl Fn(&[f64], &mut Functions) + Sync {
    move |u, out| {
        let slots: Vec<Jet> = (0..u.len()).map(|i| Jet::variable(u[i], i, u.len())).collect();
        for (row, jet) in functions(&slots).iter().enumerate() {
            out.set_value(row, jet.v);
            out.set_gradient(row, &jet.g);
            out.set_hessian(row, &jet.h);
        }
    }
}

/// A program whose functions are one element: first the objective, then the rows.
pub fn dense(
    bounds: &[(f64, f64)],
    row_bounds: &[(f64, f64)],
    functions: impl Fn(&[Jet]) -> Vec<Jet> + Sync + 'static,
) -> Program {
    Program::dense(bounds, row_bounds, of_jets(functions))
}

/// Adds elements of one shape whose functions are jets' functions.
pub fn block(
    program: &mut Program,
    [slots, rows]: [usize; 2],
    elements: &[Element],
    functions: impl Fn(&[Jet]) -> Vec<Jet> + Sync + 'static,
) {
    program.add_block(slots, rows, elements, of_jets(functions));
}

/// No bound.
pub const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
