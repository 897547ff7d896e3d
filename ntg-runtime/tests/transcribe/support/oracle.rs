//! The program's derivatives, assembled densely from its elements, against finite differences.

use ntg_runtime::nlp::{Evaluation, Nlp, Target};

pub struct Dense {
    pub gradient: Vec<f64>,
    pub jacobian: Vec<Vec<f64>>,
    pub hessian: Vec<Vec<f64>>,
}

/// Sums `weight * E^T phi'` and `E^T K E` over all elements.
pub fn assemble(nlp: &impl Nlp, out: &Evaluation) -> Dense {
    let (n, m) = (nlp.variables(), nlp.rows());
    let mut dense = Dense { gradient: vec![0.0; n], jacobian: vec![vec![0.0; n]; m], hessian: vec![vec![0.0; n]; n] };
    for (block, values) in nlp.blocks().iter().zip(&out.blocks) {
        let count = block.elements;
        for e in 0..count {
            let (variables, map) = (block.variables(e), block.map(e));
            assert!(variables.windows(2).all(|w| w[0] < w[1]), "variables of an element increase");
            let column = |slot: usize, i: usize| map[slot * variables.len() + i];
            for (k, (row, slot)) in block.jacobian.iter().enumerate() {
                let slope = block.weight[row * count + e] * values.jacobian[k * count + e];
                for (i, v) in variables.iter().enumerate() {
                    let to = match block.target[row * count + e] {
                        Target::Objective => &mut dense.gradient[*v as usize],
                        Target::Row(r) => &mut dense.jacobian[r as usize][*v as usize],
                    };
                    *to += slope * column(*slot, i);
                }
            }
            for (k, (a, b)) in block.hessian.iter().enumerate() {
                let curve = values.hessian[k * count + e];
                for (i, v) in variables.iter().enumerate() {
                    for (j, w) in variables.iter().enumerate() {
                        let to = &mut dense.hessian[*v as usize][*w as usize];
                        *to += curve * column(*a, i) * column(*b, j);
                        if a != b {
                            *to += curve * column(*b, i) * column(*a, j);
                        }
                    }
                }
            }
        }
    }
    dense
}

/// Compares all derivatives at `x` with central differences.
#[track_caller]
pub fn check(nlp: &impl Nlp, x: &[f64]) {
    let (mut work, mut out) = nlp.workspace();
    let multipliers: Vec<f64> = (0..nlp.rows()).map(|i| 0.7 - 0.3 * ((i * 7 % 5) as f64)).collect();
    let at = |x: &[f64]| {
        let (mut work, mut out) = nlp.workspace();
        nlp.derivatives(x, 1.3, &multipliers, &mut work, &mut out).expect("the test points are in the domain");
        let dense = assemble(nlp, &out);
        let lagrangian: Vec<f64> = (0..x.len())
            .map(|j| {
                1.3 * dense.gradient[j] + (0..nlp.rows()).map(|i| multipliers[i] * dense.jacobian[i][j]).sum::<f64>()
            })
            .collect();
        (out.objective, out.rows, lagrangian)
    };
    nlp.derivatives(x, 1.3, &multipliers, &mut work, &mut out).expect("the test point is in the domain");
    let dense = assemble(nlp, &out);
    let values = {
        nlp.values(x, &mut work, &mut out).expect("finite");
        (out.objective, out.rows.clone())
    };
    let with_derivatives = at(x);
    assert_eq!(values, (with_derivatives.0, with_derivatives.1), "both evaluations give the same values");
    for j in 0..x.len() {
        let h = 1e-5 * x[j].abs().max(0.1);
        let (mut up, mut down) = (x.to_vec(), x.to_vec());
        up[j] += h;
        down[j] -= h;
        let (up, down) = (at(&up), at(&down));
        let near = |exact: f64, a: f64, b: f64, what: &str| {
            let slope = (a - b) / (2.0 * h);
            let scale = 1.0 + exact.abs() + a.abs();
            assert!((exact - slope).abs() < 2e-6 * scale, "{what}: {exact} against {slope}, variable {j}");
        };
        near(dense.gradient[j], up.0, down.0, "gradient");
        for i in 0..nlp.rows() {
            near(dense.jacobian[i][j], up.1[i], down.1[i], &format!("row {i}"));
        }
        for i in 0..x.len() {
            near(dense.hessian[i][j], up.2[i], down.2[i], "Hessian");
        }
    }
}

/// A point without symmetry: positive, so that durations and roots are in their domain.
pub fn somewhere(n: usize) -> Vec<f64> {
    (0..n).map(|i| 1.0 + 0.37 * (1.7 * i as f64).sin()).collect()
}
