//! Problems whose answers are known: on paper, published, or from independent solvers.

use ntg::prelude::*;

mod specs {
    pub(crate) mod car {
        ntg::ntg_file!("specs/kinematic_car.ntg");
    }
    pub(crate) mod car_gauss {
        ntg::ntg_file!("specs/kinematic_car_gauss.ntg");
    }
    pub(crate) mod flight {
        ntg::ntg_file!("specs/low_observable.ntg");
    }
    pub(crate) mod flight_gauss {
        ntg::ntg_file!("specs/low_observable_gauss.ntg");
    }
    pub(crate) mod oscillator {
        ntg::ntg_file!("specs/van_der_pol.ntg");
    }
    pub(crate) mod oscillator_gauss {
        ntg::ntg_file!("specs/van_der_pol_gauss.ntg");
    }
}
use specs::{car, car_gauss, flight, flight_gauss, oscillator, oscillator_gauss};

#[track_caller]
fn close(found: f64, known: f64, relative: f64) {
    let error = (found / known - 1.0).abs();
    assert!(error <= relative, "{found}, but {known} is known: relative error {error:e}");
}

#[test]
fn van_der_pol_on_ntgs_grid_has_ntgs_optimum_and_coefficients() {
    let solution = oscillator::VanDerPol::default().solve(&Settings::default()).expect("it can be set up");
    assert!(solution.is_solved());
    close(solution.objective(), 1.702_214_262_83, 1e-8);
    let known = [1.0, 1.0, 0.393_739_92, -0.036_958, -0.439_532_08, -0.716_865_32, -0.244_974_18];
    for (found, known) in solution.untyped().coefficients().iter().zip(known) {
        assert!((found - known).abs() < 1e-6, "{found} but {known}");
    }
}

#[test]
fn van_der_pol_with_gauss_points() {
    let solution = oscillator_gauss::VanDerPolGauss::default().solve(&Settings::default()).expect("it can be set up");
    assert!(solution.is_solved());
    close(solution.objective(), 1.693_929_379_8, 1e-8);
    // With twelve points the rule is exact to this many digits: what the finer grid should see.
    close(solution.report().objective_fine, 1.693_972_422_16, 1e-5);
}

#[test]
fn the_lane_change_is_a_quintic_on_paper() {
    let solution = car::KinematicCar::default().solve(&Settings::default()).expect("it can be set up");
    close(solution.objective(), 2.457_581_141_949_49, 1e-8);
    let solution = car_gauss::KinematicCarGauss::default().solve(&Settings::default()).expect("it can be set up");
    close(solution.objective(), 2.4576, 1e-8);
    assert!((solution.y.at(2.5)).abs() < 1e-9 && (solution.x.at(2.5) - 20.0).abs() < 1e-9, "half way at half time");
}

/// The paper's two coarse routes: their way-points, km.
const ROUTES: [(f64, f64); 2] = [(-100.0, -15.0), (0.0, -100.0)];

#[test]
fn the_flight_on_the_papers_grid_from_both_routes() {
    for (x_via, y_via) in ROUTES {
        let on = flight::LowObservable { x_via, y_via, ..Default::default() };
        let solve = |problem: flight::LowObservable| {
            let solution = problem.solve(&Settings::default()).expect("it can be set up");
            assert!(solution.is_solved(), "{}", solution.report());
            solution
        };
        let unlimited = solve(flight::LowObservable { signature_max: 7.0, ..on.clone() });
        close(unlimited.objective(), 128.252_905_291, 1e-6);
        close(unlimited.duration_T(), 638.1103, 1e-6);
        let limited = solve(on.clone());
        close(limited.objective(), 130.907_227_498, 1e-6);
        close(limited.duration_T(), 644.6155, 1e-6);
        let detected = solve(flight::LowObservable { w_detection: 400.0, ..on });
        close(detected.objective(), 135.037_709_597, 1e-6);
    }
}

#[test]
fn the_flight_with_gauss_points_from_both_routes() {
    for (x_via, y_via) in ROUTES {
        let on = flight_gauss::LowObservableGauss { x_via, y_via, ..Default::default() };
        let limited = on.solve(&Settings::default()).expect("it can be set up");
        assert!(limited.is_solved(), "{}", limited.report());
        close(limited.objective(), 130.981_63, 1e-5);
        let worst = limited.report().violation.between;
        assert!(worst < 1e-3, "Gauss points hold between them: {worst:e}");
    }
    let unlimited = flight_gauss::LowObservableGauss { signature_max: 7.0, ..Default::default() };
    close(unlimited.solve(&Settings::default()).expect("it can be set up").objective(), 128.381_655, 1e-5);
    let detected = flight_gauss::LowObservableGauss { w_detection: 400.0, ..Default::default() };
    close(detected.solve(&Settings::default()).expect("it can be set up").objective(), 135.150_71, 1e-5);
}

#[test]
fn solving_is_deterministic_and_works_from_several_threads() {
    let solve = || {
        let report = solve(&flight::LowObservable::default(), &Settings::default()).expect("it can be set up");
        (report.iterations, report.solution.coefficients().to_vec())
    };
    let alone = solve();
    let threads: Vec<_> = (0..4).map(|_| std::thread::spawn(solve)).collect();
    for thread in threads {
        assert_eq!(thread.join().expect("a solve does not panic"), alone);
    }
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
    let file = solve(&oscillator::VanDerPol::default(), &Settings::default()).expect("it can be set up");
    let inline = solve(&inline::VanDerPol::default(), &Settings::default()).expect("it can be set up");
    assert_eq!(file.solution.coefficients(), inline.solution.coefficients());
    assert_eq!(file.objective.to_bits(), inline.objective.to_bits());
}

#[test]
fn an_integral_may_enter_nonlinearly_even_where_it_has_no_value_at_zero() {
    mod inline {
        ntg::ntg! {
            problem Straight {
                duration T = 1;
                output z: spline(order = 4, intervals = 3);
                maximize 1 / sqrt(integral(der(z)^2));
                initial { z == 0; }
                final   { z == 2; }
            }
        }
    }
    // The straight line has the least integral, 4.
    let report = solve(&inline::Straight::default(), &Settings::default()).expect("it can be set up");
    assert!(report.is_solved(), "{report}");
    close(report.objective, 0.5, 1e-8);
}

#[test]
fn families_stay_families_and_add_up() {
    mod inline {
        ntg::ntg! {
            problem Fleet {
                const N = 3;
                duration T = 2 [s];
                output x[1 .. N] [m]: spline(order = 4, intervals = 2);
                param goal[N] = (1, 2, 3) [m];
                let effort = sum(i in 1 .. N, der(x[i], 2)^2) / 1 [m^2/s^4];
                minimize integral(effort);
                initial { for i in 1 .. N { x[i] == 0;        der(x[i]) == 0; } }
                final   { for i in 1 .. N { x[i] == goal[i];  der(x[i]) == 0; } }
            }
        }
    }
    // Each moves rest to rest with the least effort, 12 d^2 / T^3.
    let report = solve(&inline::Fleet::default(), &Settings::default()).expect("it can be set up");
    assert!(report.is_solved(), "{report}");
    close(report.objective, 12.0 * (1.0 + 4.0 + 9.0) / 8.0, 1e-8);
}

#[test]
fn an_infeasible_signature_names_the_constraint_and_the_place() {
    let settings = Settings { max_iterations: 300, ..Settings::default() };
    let report = solve(&flight::LowObservable { signature_max: 1.6, ..Default::default() }, &settings).expect("setup");
    assert!(!report.is_solved());
    let words = report.to_string();
    assert!(words.contains("low_observable") && words.contains("t = "), "{words}");
}
