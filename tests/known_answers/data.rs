//! Arrays from files, constants from outside and measurements, against closed forms of least squares.

use ntg::prelude::*;
use ntg::runtime::report::Estimate;

use crate::support::{Shipped, close};

fn estimate(report: &Report) -> &Estimate {
    assert!(report.is_solved(), "{report}");
    report.estimate.as_ref().expect("the spec measures")
}

#[test]
fn a_straight_line_through_points_is_the_regression_line_with_its_deviations() {
    let times = [0.0_f64, 1.0, 2.5, 4.0, 5.0];
    let values = [1.0_f64, 2.5, 3.0, 6.5, 6.0];
    let sigmas = [0.5_f64, 1.0, 0.5, 2.0, 1.0];
    let report = Shipped::text(
        "problem Line {
            const time[5] = (0, 1, 2.5, 4, 5) [s];
            param seen[5] = (1, 2.5, 3, 6.5, 6) [m];
            param sigma[5] = (50, 100, 50, 200, 100) [cm];
            duration T = 5 [s];
            output x [m]: spline(order = 2, intervals = 1);
            variable offset [m];
            variable slope [m/s];
            temporal { initial(x) == offset;  initial(der(x)) == slope; }
            measure { for i in 1 .. 5 { track: at(time[i], x) == seen[i] sigma sigma[i]; } }
            guess { slope = 1 [m/s]; }
        }",
    )
    .solve();
    let sum = |term: &dyn Fn(usize) -> f64| (0..5).map(|i| term(i) / (sigmas[i] * sigmas[i])).sum::<f64>();
    let (s, st, stt) = (sum(&|_| 1.0), sum(&|i| times[i]), sum(&|i| times[i] * times[i]));
    let (sy, sty) = (sum(&|i| values[i]), sum(&|i| times[i] * values[i]));
    let determinant = s * stt - st * st;
    let (start, slope) = ((stt * sy - st * sty) / determinant, (s * sty - st * sy) / determinant);
    let chi2 = sum(&|i| (start + slope * times[i] - values[i]).powi(2));

    let found = estimate(&report);
    close(found.chi2, chi2, 1e-8);
    close(report.objective, chi2 / 2.0, 1e-8);
    let deviation = |name: &str| {
        let deviation = found.deviations.iter().find(|deviation| deviation.variable.name == name);
        let deviation = deviation.expect("a variable");
        (deviation.variable.value, deviation.sigma)
    };
    close(deviation("offset").0, start, 1e-8);
    close(deviation("slope").0, slope, 1e-8);
    close(deviation("offset").1, (stt / determinant).sqrt(), 1e-7);
    close(deviation("slope").1, (s / determinant).sqrt(), 1e-7);
    close(found.correlations[0][1], -st / (s * stt).sqrt(), 1e-7);
    let [track] = &found.measurements[..] else { panic!("{found:?}") };
    assert_eq!((track.name.as_str(), track.unit.symbol.as_str(), track.residuals.len()), ("track", "m", 5));
    for (i, residual) in track.residuals.iter().enumerate() {
        assert_eq!(residual.indices, [i as i64 + 1]);
        close(1.0 + residual.value, 1.0 + start + slope * times[i] - values[i], 1e-8);
        close(1.0 + residual.ratio, 1.0 + residual.value / sigmas[i], 1e-12);
    }
}

#[test]
fn two_opinions_of_a_number_are_weighed_by_their_deviations() {
    let report = Shipped::text(
        "problem Weighed {
            duration T = 1 [s];
            output x [m]: spline(order = 2, intervals = 1);
            variable mass in 0 .. 5 [kg];
            initial { x == 0; }
            final { x == 0; }
            measure {
                scales: mass == 1 [kg] sigma 300 [g];
                books: mass == (2, 2.5) [kg] sigma (0.4, 1) [kg];
            }
            guess { mass = 1 [kg]; }
        }",
    )
    .solve();
    let weights = [1.0 / 0.09, 1.0 / 0.16, 1.0];
    let all: f64 = weights.iter().sum();
    let mean = weights.iter().zip([1.0, 2.0, 2.5]).map(|(w, y)| w * y).sum::<f64>() / all;
    let found = estimate(&report);
    close(found.deviations[0].variable.value, mean, 1e-9);
    close(found.deviations[0].sigma, 1.0 / all.sqrt(), 1e-9);
    // Elements that are written out are one statement, whose residuals stand together.
    let sizes: Vec<usize> = found.measurements.iter().map(|measurement| measurement.residuals.len()).collect();
    assert_eq!(sizes, [1, 2]);
    let shares: f64 = found.measurements.iter().map(|measurement| measurement.share).sum();
    close(shares, 1.0, 1e-12);
}

#[test]
fn what_the_measurements_leave_open_has_no_deviation() {
    let report = Shipped::text(
        "problem Open {
            duration T = 1 [s];
            output x [m]: spline(order = 2, intervals = 1);
            variable a in -5 .. 5 [m];
            variable b in -5 .. 5 [m];
            initial { x == 0; }
            final { x == 0; }
            measure { both: a + b == 1 [m] sigma 1 [m]; }
        }",
    )
    .solve();
    let found = estimate(&report);
    let why = found.unknown.as_deref().unwrap_or_default();
    assert!(found.deviations.is_empty() && why.contains("`a` and `b` together"), "{found:?}");
}

#[test]
fn the_probe_finds_drag_and_wind_within_three_deviations() {
    let report = Shipped::spec("probe").solve();
    let found = estimate(&report);
    close(found.chi2, 103.165_918, 1e-7);
    assert_eq!(found.count, 126);
    for (deviation, truth) in found.deviations.iter().zip([0.002, 10.0, -4.0]) {
        let missed = (deviation.variable.value - truth).abs();
        assert!(missed < 3.0 * deviation.sigma, "{deviation:?}");
        assert!(deviation.sigma < 0.02 * truth.abs(), "{deviation:?}");
    }
    let names: Vec<&str> = found.measurements.iter().map(|measurement| measurement.name.as_str()).collect();
    assert_eq!(names, ["place", "doppler", "wind_forecast"]);
}

#[test]
fn as_many_gates_are_flown_through_as_the_file_has_rows() {
    let report = Shipped::spec("gate_race").solve();
    assert!(report.is_solved(), "{report}");
    close(report.solution.time("T").expect("a duration"), 3.771_226, 1e-6);
    let gates = [[4.0, 2.0, 1.5], [8.0, 0.0, 3.0], [10.0, 5.0, 2.0], [6.0, 8.0, 4.0]];
    for (k, gate) in gates.iter().enumerate() {
        let end = report.solution.time(&format!("end(leg[{}])", k + 1)).expect("a leg");
        for (axis, middle) in gate.iter().enumerate() {
            let place = report.solution.output(&format!("r[{}]", axis + 1)).expect("an element").derivative(end, 0);
            assert!((place - middle).abs() < 0.3 + 1e-6, "gate {}, axis {}: {place}", k + 1, axis + 1);
        }
    }
}

#[test]
fn both_homes_read_the_same_file_and_measure_the_same() {
    mod file {
        ntg::ntg_file!("specs/probe.ntg");
    }
    mod inline {
        ntg::ntg! {
            problem Mean {
                const n = rows("specs/data/track_of_probe.csv");
                const time[n] [s] from "specs/data/track_of_probe.csv" column 1;
                param climb[n] [m/s] from "specs/data/track_of_probe.csv" column 5;
                duration T = 60 [s];
                output v [m/s]: spline(order = 4, intervals = 6);
                measure { for i in 1 .. n { climb: at(time[i], v) == climb[i] sigma 0.3 [m/s]; } }
            }
        }
    }
    let settings = Settings::default();
    let generated = solve(&file::Probe::default(), &settings).expect("it can be set up");
    let interpreted = Shipped::spec("probe").solve();
    assert_eq!(generated.objective.to_bits(), interpreted.objective.to_bits());
    assert_eq!(generated.estimate, interpreted.estimate);
    let mean = solve(&inline::Mean::default(), &settings).expect("it can be set up");
    assert_eq!(estimate(&mean).count, 31);
}

#[test]
fn a_constant_that_is_set_from_outside_is_as_if_it_were_written_so() {
    mod three {
        ntg::ntg_file!("specs/multi_vehicle.ntg", N = 3);
    }
    let generated = solve(&three::MultiVehicle::default(), &Settings::default());
    let written = Shipped::edited("multi_vehicle", &[("const N = 4;", "const N = 3;")]).solve();
    let generated = generated.expect("it can be set up");
    assert_eq!(generated.objective.to_bits(), written.objective.to_bits());
}
