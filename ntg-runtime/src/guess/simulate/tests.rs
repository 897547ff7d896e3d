//! Known answers of the integration.

use super::radau::{Instant, Linear, Motion, Track, integrate};

/// Equations from a function that writes residuals and derivatives: at a time, of the values.
struct Closure<F> {
    orders: Vec<usize>,
    sizes: Vec<f64>,
    at: Vec<Instant>,
    function: F,
    /// Whether there is no time left.
    is_late: bool,
}

impl<F: Fn(f64, &[f64], &mut Linear)> Motion for Closure<F> {
    fn orders(&self) -> &[usize] {
        &self.orders
    }

    fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    fn is_late(&self) -> bool {
        self.is_late
    }

    fn place(&mut self, at: &[Instant]) -> Option<()> {
        self.at = at.to_vec();
        Some(())
    }

    fn evaluate(&mut self, values: &[Vec<f64>], out: &mut [Linear]) -> Option<()> {
        for ((at, values), out) in self.at.iter().zip(values).zip(out) {
            out.jacobian.clear();
            (self.function)(at.tau, values, out);
        }
        Some(())
    }
}

/// Integrates from these values; `breaks` are 0 and 1.
fn track(orders: &[usize], initial: &[f64], function: impl Fn(f64, &[f64], &mut Linear)) -> Option<Track> {
    let sizes = vec![1.0; orders.len()];
    let mut motion = Closure { orders: orders.to_vec(), sizes, at: vec![], function, is_late: false };
    integrate(&mut motion, initial.to_vec(), &[0.0, 1.0])
}

fn set(out: &mut Linear, row: usize, residual: f64, derivatives: &[(usize, f64)]) {
    out.residual[row] = residual;
    derivatives.iter().for_each(|(column, value)| out.jacobian.add(row, *column, *value));
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} in place of {expected}");
}

#[test]
fn what_is_stiff_takes_the_steps_of_what_is_slow() {
    // z' = -1e6 (z - cos 2 t) - 2 sin 2 t: the solution is cos 2 t.
    let found = track(&[1], &[1.0, 0.0], |t, v, out| {
        let phase = 2.0 * t;
        set(out, 0, v[1] + 1e6 * (v[0] - phase.cos()) + 2.0 * phase.sin(), &[(0, 1e6), (1, 1.0)]);
    });
    let found = found.expect("it can be followed");
    (0..=20).for_each(|i| close(found.at(0, f64::from(i) / 20.0), (f64::from(i) / 10.0).cos(), 1e-3));
    assert!(found.steps() < 50, "{} steps", found.steps());
}

#[test]
fn equations_of_second_order_are_followed() {
    // Three periods of z'' = -w^2 z, from 0 at speed w.
    let w = 6.0 * std::f64::consts::PI;
    let found = track(&[2], &[0.0, w, 0.0], |_, v, out| set(out, 0, v[2] + w * w * v[0], &[(0, w * w), (2, 1.0)]));
    let found = found.expect("it can be followed");
    (0..=30).for_each(|i| close(found.at(0, f64::from(i) / 30.0), (w * f64::from(i) / 30.0).sin(), 2e-3));
}

#[test]
fn a_substrate_that_runs_out_stays_positive() {
    // S' = -2 S / (K + S) from 1: K ln S + S = 1 - 2 t, so that hardly anything is left after half of the time.
    const K: f64 = 1e-4;
    let found = track(&[1], &[1.0, 0.0], |_, v, out| {
        let sum = K + v[0];
        set(out, 0, v[1] + 2.0 * v[0] / sum, &[(0, 2.0 * K / (sum * sum)), (1, 1.0)]);
    });
    let found = found.expect("it can be followed");
    close(found.at(0, 0.25), 0.5, 1e-3);
    (0..=100).for_each(|i| assert!(found.at(0, f64::from(i) / 100.0) > -1e-4));
    close(found.at(0, 1.0), 0.0, 1e-5);
}

#[test]
fn robertsons_reaction_ends_as_published() {
    // Over 40 s. Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.10.
    let found = track(&[1, 1, 1], &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], |_, v, out| {
        let [a, b, c] = [v[0], v[2], v[4]];
        let [slow, fast, mixed] = [0.04 * a, 3e7 * b * b, 1e4 * b * c];
        let t = 40.0;
        let by_b = [t * 1e4 * c, t * (6e7 * b + 1e4 * c), t * 6e7 * b];
        set(out, 0, v[1] + t * (slow - mixed), &[(0, t * 0.04), (2, -by_b[0]), (4, -t * 1e4 * b), (1, 1.0)]);
        set(out, 1, v[3] - t * (slow - mixed - fast), &[(0, -t * 0.04), (2, by_b[1]), (4, t * 1e4 * b), (3, 1.0)]);
        set(out, 2, v[5] - t * fast, &[(2, -by_b[2]), (5, 1.0)]);
    });
    let found = found.expect("it can be followed");
    close(found.at(0, 1.0), 0.715_827_068_8, 1e-4);
    close(found.at(1, 1.0), 0.918_553_476_4e-5, 1e-7);
    close(found.at(2, 1.0), 0.284_163_745_7, 1e-4);
}

#[test]
fn algebraic_outputs_follow() {
    // z' = -a, a = z^2, from 1: z = 1 / (1 + t).
    let found = track(&[1, 0], &[1.0, 0.0, 0.5], |_, v, out| {
        set(out, 0, v[1] + v[2], &[(1, 1.0), (2, 1.0)]);
        set(out, 1, v[2] - v[0] * v[0], &[(2, 1.0), (0, -2.0 * v[0])]);
    });
    let found = found.expect("it can be followed");
    (0..=10).map(|i| f64::from(i) / 10.0).for_each(|t| {
        close(found.at(0, t), 1.0 / (1.0 + t), 1e-4);
        close(found.at(1, t), 1.0 / (1.0 + t).powi(2), 2e-4);
    });
}

#[test]
fn what_has_no_end_has_no_simulation() {
    // z' = z^2 from 2 has no value after half of the time.
    let escape = |_, v: &[f64], out: &mut Linear| set(out, 0, v[1] - v[0] * v[0], &[(0, -2.0 * v[0]), (1, 1.0)]);
    assert!(track(&[1], &[2.0, 0.0], escape).is_none());
    // Nothing says what z' is.
    assert!(track(&[1], &[2.0, 0.0], |_, v, out| set(out, 0, v[0] - 2.0, &[(0, 1.0)])).is_none());
}

#[test]
fn a_motion_without_time_is_not_followed() {
    let decay = |_: f64, z: &[f64], out: &mut Linear| set(out, 0, z[1] + z[0], &[(0, 1.0), (1, 1.0)]);
    for is_late in [false, true] {
        let mut motion = Closure { orders: vec![1], sizes: vec![1.0], at: vec![], function: decay, is_late };
        assert_eq!(integrate(&mut motion, vec![1.0, -1.0], &[0.0, 1.0]).is_none(), is_late);
    }
}
