//! The driven van der Pol oscillator, NTG's first example.

use ntg::prelude::*;

use crate::support::{Shipped, close};

mod grid {
    ntg::ntg_file!("specs/van_der_pol.ntg");
}
mod gauss {
    ntg::ntg_file!("specs/van_der_pol_gauss.ntg");
}

#[test]
fn van_der_pol_on_ntgs_grid_has_ntgs_optimum_and_coefficients() {
    let solution = grid::VanDerPol::default().solve(&Settings::default()).expect("it can be set up");
    assert!(solution.is_solved());
    close(solution.objective(), 1.702_214_262_83, 1e-8);
    let known = [1.0, 1.0, 0.393_739_92, -0.036_958, -0.439_532_08, -0.716_865_32, -0.244_974_18];
    for (found, known) in solution.untyped().coefficients().iter().zip(known) {
        assert!((found - known).abs() < 1e-6, "{found} but {known}");
    }
}

#[test]
fn van_der_pol_with_gauss_points() {
    let solution = gauss::VanDerPolGauss::default().solve(&Settings::default()).expect("it can be set up");
    assert!(solution.is_solved());
    close(solution.objective(), 1.693_929_379_8, 1e-8);
    // With twelve points the rule is exact to this many digits: what the finer grid should see.
    close(solution.report().objective_fine, 1.693_972_422_16, 1e-5);
}

#[test]
fn inline_file_and_interpreter_give_the_same_numbers() {
    mod inline {
        ntg::ntg! {
            problem VanDerPol {
                duration T = 5;
                output z: spline(order = 5, intervals = 2, smoothness = 3);
                collocation uniform(breakpoints = 20);
                let u = der(z, 2) + z - (1 - z^2) * der(z);
                minimize integral(0.5 * (z^2 + der(z)^2 + u^2));
                initial { z == 1;  der(z) == 0; }
                final   { der(z) - z == 1; }
                guess { z = 1; }
            }
        }
    }
    let file = solve(&grid::VanDerPol::default(), &Settings::default()).expect("it can be set up");
    let inline = solve(&inline::VanDerPol::default(), &Settings::default()).expect("it can be set up");
    assert_eq!(file.solution.coefficients(), inline.solution.coefficients());
    assert_eq!(file.objective.to_bits(), inline.objective.to_bits());
    let interpreted = Shipped::spec("van_der_pol").solve();
    assert_eq!(file.solution.coefficients(), interpreted.solution.coefficients());
}
