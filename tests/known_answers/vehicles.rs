//! The language's constructs at work outside the paper: a quadrotor, a rocket, a net of radars.

use ntg::prelude::*;

use crate::support::{Shipped, close, joins_hold, jump};

#[test]
fn gates_are_passed_at_the_optimum_of_an_independent_solver() {
    let report = Shipped::spec("gates").precisely().solve();
    // CasADi 3.8.2 with IPOPT at 1e-11, on Bernstein polynomials: 7.7455635858 s.
    close(report.objective, 7.745_563_586, 1e-8);
    let legs: Vec<f64> = report.phases().iter().map(|leg| leg.end - leg.start).collect();
    for (found, known) in
        legs.iter().zip([1.266_294_8, 1.389_743_6, 0.911_700_4, 0.911_700_4, 1.389_743_6, 1.266_294_8])
    {
        close(*found, known, 1e-6);
    }
    joins_hold(&report, 8, 4);
}

#[test]
fn least_snap_is_smoother_than_it_was_asked_to_be() {
    // Only derivatives up to the snap are joined. Without limits on the acceleration, that the next one is
    // continuous too follows from optimality alone: gates fix positions and directions of flight only.
    let free = Shipped::spec("gates").with("thrust_min", &[0.0]).with("thrust_max", &[1e3]).with("tilt_max", &[89.0]);
    let report = free.solve();
    for pair in report.phases().windows(2) {
        for output in ["x", "y", "z"] {
            let size = report.solution.output(output).expect("an output").derivative(pair[0].end, 5).abs();
            let jump = jump(&report, output, pair[0].end, (8, 5));
            assert!(jump.abs() < 1e-4 * size.max(1.0), "{output} after {}: {jump:e} beside {size:e}", pair[0].name);
        }
    }
}

#[test]
fn a_rocket_carries_the_payload_of_an_independent_solver() {
    let report = Shipped::spec("launch").solve();
    // CasADi 3.8.2 with IPOPT at 1e-10, 30 intervals a stage with three Gauss points, free steering.
    close(report.objective, 736.835_366, 1e-6);
    close(report.solution.time("duration(third)").expect("a duration"), 176.410_656_5, 1e-6);
    let fine = Shipped::edited("launch", &[("const l = 8;", "const l = 14;")]).solve();
    close(fine.objective, 736.835_366, 1e-8);

    // Mass drops by what is dropped, and by nothing else.
    let stages = report.phases();
    close(jump(&report, "m", stages[0].end, (2, 0)), -2.0, 1e-9);
    close(jump(&report, "m", stages[1].end, (2, 0)), -0.5, 1e-9);
    for output in ["x", "z"] {
        for order in 0..=1 {
            let jump = jump(&report, output, stages[0].end, (5, order));
            assert!(jump.abs() < 1e-9, "{output}, derivative {order}: {jump:e}");
        }
    }
}

#[test]
fn a_net_of_radars_is_passed_through_the_saddle() {
    let report = Shipped::spec("radar_net").solve();
    close(report.objective, 502.396_865, 1e-7);
    // The saddle is at x = 2, y = -14 km; straight on, the ridge is 2 km high.
    let over = |x: f64| {
        let (east, north) = (report.solution.output("x"), report.solution.output("y"));
        let (east, north) = (east.expect("an output"), north.expect("an output"));
        let times = report.solution.times(1001);
        let time = times.into_iter().find(|t| east.at(*t) >= x).expect("it gets there");
        (north.at(time), report.solution.output("z").expect("an output").at(time))
    };
    let (north, altitude) = over(2.0);
    assert!(north < -10.0 && altitude < 1200.0, "{north} km north, {altitude} m up");
}
