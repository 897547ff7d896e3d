//! Known answers: problems of W. Hock and K. Schittkowski, *Test Examples for Nonlinear Programming
//! Codes* (1981), by their numbers there, and examples on which methods of this kind are known to fail.

use crate::support::{FREE, Jet, dense};
use ntg_nlp::closures::Program;
use ntg_nlp::sqp::solve;
use ntg_nlp::{Options, Outcome, Status, ipm, method};

const INF: f64 = f64::INFINITY;

#[track_caller]
fn solved(program: &Program, start: &[f64], objective: f64) -> Outcome {
    for (name, outcome) in [
        ("interior point", ipm::solve(program, start, &Options::default())),
        ("automatic", method::solve(program, start, &Options::default())),
    ] {
        trace(&outcome);
        println!("{name}: iterations {} {}", outcome.iterations, outcome.status);
        assert_eq!(outcome.status, Status::Solved, "{name}: {:?} after {}", outcome.residuals, outcome.iterations);
        assert!(
            (outcome.objective - objective).abs() <= 1e-6 * (1.0 + objective.abs()),
            "{name}: {}",
            outcome.objective
        );
    }
    let outcome = solve(program, start, &Options::default());
    trace(&outcome);
    println!("iterations {} qps {} {}", outcome.iterations, outcome.qps, outcome.status);
    assert_eq!(outcome.status, Status::Solved, "{:?} after {}", outcome.residuals, outcome.iterations);
    assert!((outcome.objective - objective).abs() <= 1e-7 * (1.0 + objective.abs()), "{}", outcome.objective);
    outcome
}

/// What every iteration was, for whoever sets `TRACE`.
fn trace(outcome: &Outcome) {
    if std::env::var_os("TRACE").is_none() {
        return;
    }
    for record in &outcome.history {
        println!(
            "{:14.8e} p {:8.1e} d {:8.1e} c {:8.1e} step {:8.1e} mu {:7.1e} {}{}{}",
            record.objective,
            record.residuals.scaled.primal,
            record.residuals.scaled.dual,
            record.residuals.scaled.complementarity,
            record.step,
            record.barrier,
            if record.elastic { "elastic " } else { "" },
            if record.exact { "exact " } else { "" },
            if record.corrected { "corrected" } else { "" }
        );
    }
}

#[track_caller]
fn near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-7 * (1.0 + expected.abs()), "{found} is not {expected}");
    }
}

#[test]
fn hs6_curved_equality() {
    let p = dense(&[FREE; 2], &[(0.0, 0.0)], |x| vec![(1.0 - &x[0]).powi(2), 10.0 * (x[1] - x[0].powi(2))]);
    let found = solved(&p, &[-1.2, 1.0], 0.0);
    near(&found.x, &[1.0, 1.0]);
}

#[test]
fn hs7_logarithm() {
    let p = dense(&[FREE; 2], &[(4.0, 4.0)], |x| {
        let one = 1.0 + x[0].powi(2);
        vec![one.ln() - x[1], one.powi(2) + x[1].powi(2)]
    });
    let found = solved(&p, &[2.0, 2.0], -(3.0_f64.sqrt()));
    // dJ/d4: J = -sqrt(b - 1), so -1 / (2 sqrt 3).
    near(&found.row_multipliers, &[-0.5 / 3.0_f64.sqrt()]);
}

#[test]
fn hs10_inequality() {
    let p = dense(&[FREE; 2], &[(0.0, INF)], |x| {
        let c = -3.0 * x[0].powi(2) + 2.0 * (x[0] * x[1]) - x[1].powi(2) + 1.0;
        vec![x[0] - x[1], c]
    });
    near(&solved(&p, &[-10.0, 10.0], -1.0).x, &[0.0, 1.0]);
}

#[test]
fn hs12_inequality() {
    let p = dense(&[FREE; 2], &[(0.0, INF)], |x| {
        let f = 0.5 * x[0].powi(2) + x[1].powi(2) - x[0] * x[1] - 7.0 * &x[0] - 7.0 * &x[1];
        vec![f, 25.0 - 4.0 * x[0].powi(2) - x[1].powi(2)]
    });
    let found = solved(&p, &[0.0, 0.0], -30.0);
    near(&found.x, &[2.0, 3.0]);
    near(&found.row_multipliers, &[0.5]);
}

#[test]
fn hs14_both_kinds() {
    let p = dense(&[FREE; 2], &[(0.0, INF), (-1.0, -1.0)], |x| {
        let f = (&x[0] - 2.0).powi(2) + (&x[1] - 1.0).powi(2);
        vec![f, 1.0 - 0.25 * x[0].powi(2) - x[1].powi(2), x[0] - 2.0 * &x[1]]
    });
    let root = 7.0_f64.sqrt();
    let found = solved(&p, &[2.0, 2.0], 9.0 - 2.875 * root);
    near(&found.x, &[0.5 * (root - 1.0), 0.25 * (root + 1.0)]);
}

#[test]
fn hs21_bounds() {
    let p = dense(&[(2.0, 50.0), (-50.0, 50.0)], &[(10.0, INF)], |x| {
        vec![0.01 * x[0].powi(2) + x[1].powi(2) - 100.0, 10.0 * &x[0] - x[1]]
    });
    let found = solved(&p, &[-1.0, -1.0], -99.96);
    near(&found.x, &[2.0, 0.0]);
    near(&found.bound_multipliers, &[0.04, 0.0]);
}

#[test]
fn hs26_singular_hessian() {
    let p = dense(&[FREE; 3], &[(3.0, 3.0)], |x| {
        let f = (x[0] - x[1]).powi(2) + (x[1] - x[2]).powi(4);
        vec![f, (1.0 + x[1].powi(2)) * x[0] + x[2].powi(4)]
    });
    solved(&p, &[-2.6, 2.0, 2.0], 0.0);
}

#[test]
fn hs28_quadratic() {
    let p = dense(&[FREE; 3], &[(1.0, 1.0)], |x| {
        let f = (x[0] + x[1]).powi(2) + (x[1] + x[2]).powi(2);
        vec![f, x[0] + 2.0 * &x[1] + 3.0 * &x[2]]
    });
    let found = solved(&p, &[-4.0, 1.0, 1.0], 0.0);
    near(&found.x, &[0.5, -0.5, 0.5]);
    assert!(found.iterations <= 2);
}

#[test]
fn hs35_quadratic_with_bounds() {
    let p = dense(&[(0.0, INF); 3], &[(-INF, 3.0)], |x| {
        let f = 9.0 - 8.0 * &x[0] - 6.0 * &x[1] - 4.0 * &x[2]
            + 2.0 * x[0].powi(2)
            + 2.0 * x[1].powi(2)
            + x[2].powi(2)
            + 2.0 * (x[0] * x[1])
            + 2.0 * (x[0] * x[2]);
        vec![f, x[0] + x[1] + 2.0 * &x[2]]
    });
    let found = solved(&p, &[0.5; 3], 1.0 / 9.0);
    near(&found.x, &[4.0 / 3.0, 7.0 / 9.0, 4.0 / 9.0]);
    near(&found.row_multipliers, &[-2.0 / 9.0]);
}

#[test]
fn hs39_linear_objective() {
    let p = dense(&[FREE; 4], &[(0.0, 0.0); 2], |x| {
        vec![-&x[0], x[1] - x[0].powi(3) - x[2].powi(2), x[0].powi(2) - x[1] - x[3].powi(2)]
    });
    near(&solved(&p, &[2.0; 4], -1.0).x[..2], &[1.0, 1.0]);
}

#[test]
fn hs43_rosen_suzuki() {
    let p = dense(&[FREE; 4], &[(-INF, 8.0), (-INF, 10.0), (-INF, 5.0)], |x| {
        let s: Vec<Jet> = x.iter().map(|x| x.powi(2)).collect();
        let f = s[0] + s[1] + 2.0 * &s[2] + s[3] - 5.0 * &x[0] - 5.0 * &x[1] - 21.0 * &x[2] + 7.0 * &x[3];
        vec![
            f,
            s[0] + s[1] + s[2] + s[3] + x[0] - x[1] + x[2] - x[3],
            s[0] + 2.0 * &s[1] + s[2] + 2.0 * &s[3] - x[0] - x[3],
            2.0 * &s[0] + s[1] + s[2] + 2.0 * &x[0] - x[1] - x[3],
        ]
    });
    let found = solved(&p, &[0.0; 4], -44.0);
    near(&found.x, &[0.0, 1.0, 2.0, -1.0]);
    near(&found.row_multipliers, &[-1.0, 0.0, -2.0]);
}

#[test]
fn hs71_product() {
    let p = dense(&[(1.0, 5.0); 4], &[(25.0, INF), (40.0, 40.0)], |x| {
        let f = x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2];
        let squares = x[0].powi(2) + x[1].powi(2) + x[2].powi(2) + x[3].powi(2);
        vec![f, x[0] * x[1] * x[2] * x[3], squares]
    });
    let found = solved(&p, &[1.0, 5.0, 5.0, 1.0], 17.014_017_289_156);
    near(&found.x, &[1.0, 4.742_999_643_7, 3.821_149_978_9, 1.379_408_293_2]);
    near(&found.row_multipliers, &[0.552_293_659_5, -0.161_468_564_3]);
    near(&found.bound_multipliers[..1], &[1.087_871_212_6]);
}

#[test]
fn hs76_quadratic() {
    let rows = [(-INF, 5.0), (-INF, 4.0), (1.5, INF)];
    let p = dense(&[(0.0, INF); 4], &rows, |x| {
        let f = x[0].powi(2) + 0.5 * x[1].powi(2) + x[2].powi(2) + 0.5 * x[3].powi(2) - x[0] * x[2] + x[2] * x[3]
            - x[0]
            - 3.0 * &x[1]
            + x[2]
            - x[3];
        vec![f, x[0] + 2.0 * &x[1] + x[2] + x[3], 3.0 * &x[0] + x[1] + 2.0 * &x[2] - x[3], x[1] + 4.0 * &x[2]]
    });
    near(&solved(&p, &[0.5; 4], -4.681_818_181_818).x, &[3.0 / 11.0, 23.0 / 11.0, 0.0, 6.0 / 11.0]);
}

#[test]
fn hs100_seven_variables() {
    let rows = [(-INF, 127.0), (-INF, 282.0), (-INF, 196.0), (-INF, 0.0)];
    let p = dense(&[FREE; 7], &rows, |x| {
        let f = (&x[0] - 10.0).powi(2)
            + 5.0 * (&x[1] - 12.0).powi(2)
            + x[2].powi(4)
            + 3.0 * (&x[3] - 11.0).powi(2)
            + 10.0 * x[4].powi(6)
            + 7.0 * x[5].powi(2)
            + x[6].powi(4)
            - 4.0 * (x[5] * x[6])
            - 10.0 * &x[5]
            - 8.0 * &x[6];
        vec![
            f,
            2.0 * x[0].powi(2) + 3.0 * x[1].powi(4) + x[2] + 4.0 * x[3].powi(2) + 5.0 * &x[4],
            7.0 * &x[0] + 3.0 * &x[1] + 10.0 * x[2].powi(2) + x[3] - x[4],
            23.0 * &x[0] + x[1].powi(2) + 6.0 * x[5].powi(2) - 8.0 * &x[6],
            4.0 * x[0].powi(2) + x[1].powi(2) - 3.0 * (x[0] * x[1]) + 2.0 * x[2].powi(2) + 5.0 * &x[5] - 11.0 * &x[6],
        ]
    });
    solved(&p, &[1.0, 2.0, 0.0, 4.0, 0.0, 1.0, 1.0], 680.630_057_374_4);
}

#[test]
fn hs104_reactor() {
    let p = dense(&[(0.1, 10.0); 8], &[(0.0, INF); 5], |x| {
        let ratio = |a: usize, b: usize| 0.4 * (x[a].powf(0.67) * x[b].powf(-0.67));
        let f = ratio(0, 6) + ratio(1, 7) + 10.0 - x[0] - x[1];
        vec![
            f,
            1.0 - 0.0588 * (x[4] * x[6]) - 0.1 * &x[0],
            1.0 - 0.0588 * (x[5] * x[7]) - 0.1 * &x[0] - 0.1 * &x[1],
            1.0 - 4.0 * (x[2] / x[4]) - 2.0 * (x[2].powf(-0.71) / x[4]) - 0.0588 * (x[2].powf(-1.3) * x[6]),
            1.0 - 4.0 * (x[3] / x[5]) - 2.0 * (x[3].powf(-0.71) / x[5]) - 0.0588 * (x[3].powf(-1.3) * x[7]),
            f - 1.0,
        ]
    });
    solved(&p, &[6.0, 3.0, 0.4, 0.2, 6.0, 6.0, 1.0, 0.5], 3.951_163_439_6);
}

#[test]
fn maratos_effect_does_not_shorten_steps() {
    // M. J. D. Powell's form: full Newton steps raise objective and violation both.
    let p = dense(&[FREE; 2], &[(1.0, 1.0)], |x| {
        let r = x[0].powi(2) + x[1].powi(2);
        vec![2.0 * (&r - 1.0) - x[0], r]
    });
    let found = solved(&p, &[0.8, 0.6], -1.0);
    near(&found.x, &[1.0, 0.0]);
    near(&found.row_multipliers, &[1.5]);
    assert!(found.iterations <= 10, "{}", found.iterations);
}

#[test]
fn waechter_and_biegler_example() {
    // Interior-point methods with a line search and without restoration fail here from this start.
    let p = dense(&[FREE, (0.0, INF), (0.0, INF)], &[(0.0, 0.0); 2], |x| {
        vec![x[0], x[0].powi(2) - x[1] - 1.0, x[0] - x[2] - 0.5]
    });
    // Restoration of feasibility leads away from the bounds.
    let (start, options) = ([-2.0, 3.0, 1.0], Options::default());
    let outcomes = [ipm::solve(&p, &start, &options), solve(&p, &start, &options), method::solve(&p, &start, &options)];
    for outcome in outcomes {
        assert_eq!(outcome.status, Status::Solved);
        near(&outcome.x, &[1.0, 0.0, 0.5]);
    }
}

#[test]
fn dependent_equalities_are_tolerated() {
    let p = dense(&[FREE; 3], &[(1.0, 1.0), (2.0, 2.0), (1.0, 1.0)], |x| {
        let sum = x[0] + x[1] + x[2];
        vec![x[0].powi(2) + 2.0 * x[1].powi(2) + 3.0 * x[2].powi(2), sum, 2.0 * &sum, sum]
    });
    let found = solved(&p, &[5.0, -3.0, 2.0], 6.0 / 11.0);
    // Only the combination of the three multipliers is determined.
    let y = &found.row_multipliers;
    near(&[y[0] + 2.0 * y[1] + y[2]], &[12.0 / 11.0]);
}

#[test]
fn inequalities_that_sit_on_their_bounds_beside_an_equality_are_tolerated() {
    // The equality x = 1 makes both inequalities exactly active, whatever y does.
    let p = dense(&[FREE; 2], &[(1.0, 1.0), (-INF, 1.0), (1.0, INF)], |x| {
        vec![(&x[1] - 2.0).powi(2) + x[1].powi(4), x[0], x[0].powi(3), x[0].powi(2)]
    });
    // Newton's method on 2 (y - 2) + 4 y^3 = 0, which has one root.
    let y = (0..50).fold(1.0_f64, |y, _| y - (2.0 * (y - 2.0) + 4.0 * y.powi(3)) / (2.0 + 12.0 * y * y));
    near(&solved(&p, &[3.0, -4.0], (y - 2.0).powi(2) + y.powi(4)).x, &[1.0, y]);
}

#[test]
fn nonconvex_objective_ends_at_a_minimum() {
    // The origin is a saddle; the minima are (+-1, 0).
    let p = dense(&[FREE; 2], &[], |x| vec![x[0].powi(4) - 2.0 * x[0].powi(2) + x[1].powi(2)]);
    let found = solved(&p, &[0.1, 1.0], -1.0);
    near(&[found.x[0].abs()], &[1.0]);
}

#[test]
fn nonconvex_quadratic_in_a_box_ends_at_a_vertex() {
    let p = dense(&[(-1.0, 2.0); 2], &[], |x| vec![-(x[0].powi(2)) - x[1].powi(2) - 0.1 * &x[0]]);
    let found = solved(&p, &[0.5, 0.5], -8.2);
    near(&found.bound_multipliers, &[-4.1, -4.0]);
}

#[test]
fn rosenbrock() {
    let p = dense(&[FREE; 2], &[], |x| vec![100.0 * (x[1] - x[0].powi(2)).powi(2) + (1.0 - &x[0]).powi(2)]);
    near(&solved(&p, &[-1.2, 1.0], 0.0).x, &[1.0, 1.0]);
}

#[test]
fn multiplier_is_the_derivative_of_the_optimum_by_the_bound() {
    let at = |bound: f64| {
        let p = dense(&[(0.0, INF); 2], &[(bound, INF)], |x| {
            vec![x[0].powi(2) + x[1].powi(4) + x[0].exp(), &x[0] * 3.0 + x[1].exp()]
        });
        let found = solve(&p, &[1.0, 1.0], &Options { tolerance: 1e-11, ..Options::default() });
        assert_eq!(found.status, Status::Solved);
        (found.objective, found.row_multipliers[0])
    };
    let (h, b) = (1e-4, 6.0);
    let difference = (at(b + h).0 - at(b - h).0) / (2.0 * h);
    assert!((difference - at(b).1).abs() < 1e-6, "{difference} {}", at(b).1);
}
