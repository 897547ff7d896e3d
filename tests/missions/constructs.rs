//! One spec with every construct for phases and agents, and what each of them promises.

use ntg::prelude::*;

ntg::ntg! {
    /// A scout looks at a depot; two trucks start when they must and arrive half a minute after it.
    problem Everything {
        const n = 2;
        param stop[n] = (6, 8) [km];
        param v_max = 0.3 [km/s];
        variable seen in 0 .. 2000 [s];

        agent scout {
            start = 10 [s];
            duration T in 100 .. 900 [s];
            output x, y [km]: spline(order = 5, intervals = 4, smoothness = 3);

            let speed [km/s] = hypot(der(x), der(y));

            phase covert {
                duration hidden in 60 .. 500 [s];
                let cap [km/s] = v_max / 2;
            }
            phase exposed after covert {
                duration = 60 [s];
                let cap [km/s] = v_max;
                output y: spline(order = 4, intervals = 2);
                output heat [km]: spline(order = 4, intervals = 4, smoothness = 1);
                collocation gauss(points = 4, equalities = 3);
                jump y;
                continuous x up to 1;
                initial { heat == 0; }
                trajectory { warms: der(heat) == speed; }
            }

            minimize scouting [km^2/s^3]: integral(der(x, 2)^2 + der(y, 2)^2);

            initial    { x == 0;  y == 0;  der(x) == 0.1 [km/s];  der(y) == 0; }
            trajectory { limit: speed <= cap; }
            final      { x == 30 [km];  y == 2 [km]; }

            guess { (x, y) through (0, 0), (15, 1), (30, 2) [km];  duration(covert) = 150 [s]; }
        }

        agent truck[i in 1 .. n] {
            start in 0 .. 600 [s];
            output x [km]: spline(order = 5, intervals = 2, smoothness = 3);
            phase load { duration in 20 .. 200 [s];  final { x == 0;  der(x) == 0; } }
            phase leg[k in 1 .. 2] after load {
                duration D in 20 .. 400 [s];
                final { there: x == stop[i] * k; }
            }
            minimize driving [km^2/s^3]: integral(der(x, 2)^2);
            initial { x == 0;  der(x) == 0; }
            final { der(x) == 0; }
            guess { x = 2 * stop[i] * tau;  start = 20 [s]; }
        }

        minimize haste [km^2/s^3]: 1e-4 [km^2/s^4] * sum(i in 1 .. n, end(truck[i]) - start(truck[i]));

        temporal {
            sight: end(scout) == seen;
            for i in 1 .. n { after_sight: end(truck[i]) - seen in 30 .. 60 [s]; }
            way: integral(scout.covert, speed) <= 25 [km];
            shown: final(scout.exposed, heat) <= 12 [km];
            slow: initial(truck[2].leg[2], der(x)) <= 0.1 [km/s];
            even: truck[1].leg[1].D == truck[1].leg[2].D;
            total: scout.T + scout.covert.hidden <= 900 [s];
        }

        guess { seen = 300 [s]; }
    }
}

fn everything() -> EverythingSolution {
    let solution = Everything::default().solve(&Settings::default()).expect("it can be set up");
    assert!(solution.is_solved(), "{}", solution.report());
    solution
}

/// Equal up to what a solver's tolerance leaves.
#[track_caller]
fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-5 * (1.0 + expected.abs()), "{found} instead of {expected}");
}

#[test]
fn phases_follow_one_another_and_change_what_they_say_they_change() {
    let solution = everything();
    let scout = &solution.scout;
    let (covert, exposed) = (&scout.covert, &scout.exposed);
    let event = covert.end();
    assert_eq!((scout.start(), exposed.start(), exposed.duration()), (10.0, event, 60.0));
    close(scout.duration_T(), covert.duration_hidden() + 60.0);

    // Outside the phases: each has its own bound on the speed, and `speed` is one function over both.
    close(covert.cap().at(event), 0.15);
    close(exposed.cap().at(event), 0.3);
    for k in 0..=20 {
        let t = scout.start() + scout.duration() * f64::from(k) / 20.0;
        assert!(scout.speed().at(t) <= scout.cap().at(t) + 1e-6, "at {t}");
    }
    // `continuous x up to 1`: by the splines two would be; `jump y`: nothing is.
    let joins =
        solution.report().constraints.iter().filter_map(|c| c.name.strip_prefix("scout.exposed.continuity of "));
    assert_eq!(joins.collect::<Vec<_>>(), ["x", "der(x, 1)"]);
    for order in [0, 1] {
        close(exposed.x.derivative(event, order), covert.x.derivative(event, order));
    }
    assert!((exposed.y.at(event) - covert.y.at(event)).abs() > 1e-3, "{}", exposed.y.at(event));
    // An output of one phase alone: the way that is flown there.
    close(exposed.heat.at(event), 0.0);
    assert!(exposed.heat.at(exposed.end()) > 1.0);
}

#[test]
fn members_of_families_are_reached_by_their_numbers() {
    let solution = everything();
    for (i, stop) in [(1, 6.0), (2, 8.0)] {
        let truck = solution.truck(i);
        assert!((0.0..=600.0).contains(&truck.start()));
        assert_eq!(truck.load.start(), truck.start());
        assert_eq!(truck.leg(1).start(), truck.load.end());
        assert_eq!(truck.leg(2).end(), truck.end());
        close(truck.load.x.at(truck.load.end()), 0.0);
        close(truck.leg(1).x.at(truck.leg(1).end()), stop);
        close(truck.x.at(truck.end()), 2.0 * stop);
    }
}

#[test]
fn temporal_constraints_bind_events_boundary_values_totals_and_variables() {
    let solution = everything();
    let (scout, second) = (&solution.scout, solution.truck(2));
    close(solution.seen(), scout.end());
    for i in [1, 2] {
        let wait = solution.truck(i).end() - solution.seen();
        assert!((30.0 - 1e-5..=60.0 + 1e-5).contains(&wait), "{wait}");
    }
    assert!(scout.exposed.heat.at(scout.end()) <= 12.0 + 1e-5);
    assert!(second.leg(2).x.derivative(second.leg(2).start(), 1) <= 0.1 + 1e-6);
    close(solution.truck(1).leg(1).duration_D(), solution.truck(1).leg(2).duration_D());
    assert!(scout.duration_T() + scout.covert.duration_hidden() <= 900.0 + 1e-4);
    // The way of the covert phase, by the trapezoid rule.
    let (covert, steps) = (&scout.covert, 2000);
    let step = covert.duration() / f64::from(steps);
    let speed = |k: i32| covert.speed().at(covert.start() + step * f64::from(k));
    let way: f64 = (0..steps).map(|k| step * (speed(k) + speed(k + 1)) / 2.0).sum();
    assert!(way <= 25.0 + 1e-3, "{way}");
    assert_eq!(solution.multiplier_after_sight().len(), 2);
}
