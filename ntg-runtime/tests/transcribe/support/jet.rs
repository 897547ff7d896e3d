//! Numbers that carry exact first and second derivatives, for test kernels.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value with gradient and Hessian by the kernel's inputs.
#[derive(Clone, Debug)]
pub struct Jet {
    pub v: f64,
    pub g: Vec<f64>,
    pub h: Vec<f64>,
}

impl Jet {
    pub fn constant(v: f64, n: usize) -> Self {
        Self { v, g: vec![0.0; n], h: vec![0.0; n * n] }
    }

    pub fn variable(v: f64, i: usize, n: usize) -> Self {
        let mut jet = Self::constant(v, n);
        jet.g[i] = 1.0;
        jet
    }

    /// A function of one jet, given its value and first two derivatives.
    pub fn chain(&self, v: f64, d: f64, dd: f64) -> Self {
        let n = self.g.len();
        let g = self.g.iter().map(|g| d * g).collect();
        let h = (0..n * n).map(|k| d * self.h[k] + dd * self.g[k / n] * self.g[k % n]).collect();
        Self { v, g, h }
    }

    pub fn sin(&self) -> Self {
        self.chain(self.v.sin(), self.v.cos(), -self.v.sin())
    }

    pub fn exp(&self) -> Self {
        self.chain(self.v.exp(), self.v.exp(), self.v.exp())
    }

    pub fn sqrt(&self) -> Self {
        let root = self.v.sqrt();
        self.chain(root, 0.5 / root, -0.25 / (root * self.v))
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Self { v: self.v + o.v, g: sum(&self.g, &o.g), h: sum(&self.h, &o.h) }
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let n = self.g.len();
        let g = (0..n).map(|i| self.v * o.g[i] + o.v * self.g[i]).collect();
        let mixed = |i: usize, j: usize| self.g[i] * o.g[j] + self.g[j] * o.g[i];
        let h = (0..n * n).map(|k| self.v * o.h[k] + o.v * self.h[k] + mixed(k / n, k % n)).collect();
        Self { v: self.v * o.v, g, h }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    fn mul(self, o: f64) -> Self {
        let v = self.v * o;
        self.chain(v, o, 0.0)
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Div for Jet {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let inverse = o.chain(1.0 / o.v, -1.0 / (o.v * o.v), 2.0 / o.v.powi(3));
        self * inverse
    }
}
