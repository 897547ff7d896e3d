//! Nonlinear programs written by hand for the tests: ordinary functions of *jets*, which carry exact
//! first and second derivatives. Operations are not inlined: programs of thousands of them compile faster.
#![allow(dead_code, unreachable_pub, unused_macros, reason = "each test file uses the part that it needs")]

/// Makes of every function of a method a test of each method.
macro_rules! of_all_methods {
    ($($law:ident)*) => {
        mod interior_point {
            $(#[test] fn $law() { super::$law(ntg_nlp::Method::InteriorPoint) })*
        }
        mod augmented_lagrangian {
            $(#[test] fn $law() { super::$law(ntg_nlp::Method::AugmentedLagrangian) })*
        }
        mod sqp {
            $(#[test] fn $law() { super::$law(ntg_nlp::Method::Sqp) })*
        }
    };
}

use ntg_nlp::closures::{Element, Functions, Program};
use std::iter::{Product, Sum};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The most slots of a function of jets.
const MOST: usize = 16;

/// A number with its gradient and Hessian by at most [`MOST`] slots.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// The number.
    pub v: f64,
    slots: usize,
    g: [f64; MOST],
    h: [[f64; MOST]; MOST],
}

impl Jet {
    fn variable(v: f64, index: usize, slots: usize) -> Self {
        assert!(slots <= MOST, "{slots} slots");
        let mut g = [0.0; MOST];
        g[index] = 1.0;
        Self { v, slots, g, h: [[0.0; MOST]; MOST] }
    }

    /// A constant with as many derivatives as this jet.
    #[inline(never)]
    pub fn constant(&self, v: f64) -> Self {
        Self { v, slots: self.slots, g: [0.0; MOST], h: [[0.0; MOST]; MOST] }
    }

    /// A jet whose derivatives are given entry by entry.
    fn of(&self, v: f64, g: impl Fn(usize) -> f64, h: impl Fn(usize, usize) -> f64) -> Self {
        let mut jet = self.constant(v);
        for i in 0..self.slots {
            jet.g[i] = g(i);
            for j in 0..self.slots {
                jet.h[i][j] = h(i, j);
            }
        }
        jet
    }

    /// `f` of this jet, given its value and two derivatives.
    #[inline(never)]
    pub fn chain(&self, f: f64, df: f64, ddf: f64) -> Self {
        self.of(f, |i| df * self.g[i], |i, j| df * self.h[i][j] + ddf * self.g[i] * self.g[j])
    }

    pub fn square(&self) -> Self {
        self.powi(2)
    }

    pub fn powi(&self, k: i32) -> Self {
        let (x, n) = (self.v, f64::from(k));
        let second = if k == 1 { 0.0 } else { n * (n - 1.0) * x.powi(k - 2) };
        self.chain(x.powi(k), n * x.powi(k - 1), second)
    }

    pub fn powf(&self, k: f64) -> Self {
        self.chain(self.v.powf(k), k * self.v.powf(k - 1.0), k * (k - 1.0) * self.v.powf(k - 2.0))
    }

    /// With the derivative 0 at the corner.
    pub fn abs(&self) -> Self {
        let slope = if self.v == 0.0 { 0.0 } else { self.v.signum() };
        self.chain(self.v.abs(), slope, 0.0)
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
        impl $trait<&Jet> for Jet { type Output = Jet; #[inline(never)] fn $method(self, o: &Jet) -> Jet { (&self).$method(o) } }
        impl $trait<Jet> for &Jet { type Output = Jet; #[inline(never)] fn $method(self, o: Jet) -> Jet { self.$method(&o) } }
        impl $trait<Jet> for Jet { type Output = Jet; #[inline(never)] fn $method(self, o: Jet) -> Jet { (&self).$method(&o) } }
        impl $trait<f64> for Jet { type Output = Jet; #[inline(never)] fn $method(self, o: f64) -> Jet { (&self).$method(&self.constant(o)) } }
        impl $trait<f64> for &Jet { type Output = Jet; #[inline(never)] fn $method(self, o: f64) -> Jet { self.$method(&self.constant(o)) } }
        impl $trait<Jet> for f64 { type Output = Jet; #[inline(never)] fn $method(self, o: Jet) -> Jet { o.constant(self).$method(&o) } }
        impl $trait<&Jet> for f64 { type Output = Jet; #[inline(never)] fn $method(self, o: &Jet) -> Jet { o.constant(self).$method(o) } }
    )*};
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl Add<&Jet> for &Jet {
    type Output = Jet;
    #[inline(never)]
    fn add(self, o: &Jet) -> Jet {
        self.of(self.v + o.v, |i| self.g[i] + o.g[i], |i, j| self.h[i][j] + o.h[i][j])
    }
}

impl Sum for Jet {
    /// The sum of at least one jet.
    fn sum<I: Iterator<Item = Jet>>(jets: I) -> Jet {
        jets.reduce(|a, b| a + b).expect("a jet")
    }
}

impl Product for Jet {
    /// The product of at least one jet.
    fn product<I: Iterator<Item = Jet>>(jets: I) -> Jet {
        jets.reduce(|a, b| a * b).expect("a jet")
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
    #[inline(never)]
    fn sub(self, o: &Jet) -> Jet {
        self + (-o)
    }
}

impl Mul<&Jet> for &Jet {
    type Output = Jet;
    #[inline(never)]
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the rule of products")]
    fn mul(self, o: &Jet) -> Jet {
        let second =
            |i: usize, j: usize| self.h[i][j] * o.v + self.v * o.h[i][j] + self.g[i] * o.g[j] + self.g[j] * o.g[i];
        self.of(self.v * o.v, |i| self.g[i] * o.v + self.v * o.g[i], second)
    }
}

impl Div<&Jet> for &Jet {
    type Output = Jet;
    #[inline(never)]
    fn div(self, o: &Jet) -> Jet {
        self * o.chain(1.0 / o.v, -1.0 / (o.v * o.v), 2.0 / (o.v * o.v * o.v))
    }
}

/// Functions of jets as a closure that writes values, gradients and Hessians.
pub fn of_jets(functions: impl Fn(&[Jet]) -> Vec<Jet> + Sync) -> impl Fn(&[f64], &mut Functions) + Sync {
    move |u, out| {
        let slots: Vec<Jet> = (0..u.len()).map(|i| Jet::variable(u[i], i, u.len())).collect();
        for (row, jet) in functions(&slots).iter().enumerate() {
            out.set_value(row, jet.v);
            out.set_gradient(row, &jet.g[..u.len()]);
            for (to, from) in out.hessian_mut(row).chunks_mut(u.len()).zip(&jet.h) {
                to.copy_from_slice(&from[..u.len()]);
            }
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
