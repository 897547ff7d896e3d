//! Phases meet in real time, and event times add up.

use ntg::prelude::*;
use ntg_interp::Interpreted;

use crate::{compile, shipped, solved};

/// Joins of several kinds: between free durations, between splines of different order and knots, in a
/// family, with less continuity asked for, with none.
const TOUR: &str = "problem Tour {
    const stops = 3;
    param place[stops] = (1, 4, 2) [km];
    agent bus[i in 1 .. 2] {
        start in 0 .. 100 [s];
        output x [km], y [m]: spline(order = 6, intervals = 3, smoothness = 4);
        output s: spline(order = 5, intervals = 2, smoothness = 3);
        let v [km/h] = der(x);
        phase leg[k in 1 .. stops] after leg[k - 1] {
            duration D in 20 .. 400 [s];
            final { x == i * place[k];  y == 10 [m] * i * k; }
        }
        phase home after leg[stops] {
            duration back in 20 .. 400 [s];
            output x: spline(order = 5, intervals = 4, smoothness = 3);
            continuous y up to 1;
            jump s;
        }
        minimize integral(der(x, 2)^2 + 1e3 * der(y, 2)^2) / 1 [m^2/s^3];
        minimize integral((s - x / 1 [km])^2 + 1e4 [s^4] * der(s, 2)^2) / 1 [s] + 1e-6 * (end(home) / 1 [s])^2;
        initial { x == 0;  v == 0;  y == 0; }
        final   { x == 0;  v == 0;  y == 0; }
    }
    temporal { start(bus[2]) >= end(bus[1].leg[1]);  end(bus[2]) - end(bus[1]) <= 60 [s]; }
}";

/// Highest derivative that is continuous at a join, by output and by the phase after it.
const CONTINUOUS: [(&str, bool, usize); 5] =
    [("x", false, 3), ("y", false, 3), ("s", false, 2), ("x", true, 2), ("y", true, 1)];

fn tour() -> (Interpreted, Report) {
    let problem = Interpreted::new(&compile(TOUR).program);
    let report = solved(&problem);
    (problem, report)
}

fn missile() -> (Interpreted, Report) {
    let problem = Interpreted::new(&compile(&shipped("missile_boost_coast")).program);
    let report = solve(&problem, &Settings::default()).expect("it can be set up");
    assert!(report.is_solved(), "{report}");
    (problem, report)
}

#[test]
fn outputs_are_continuous_at_every_join_to_1e_9_in_declared_units() {
    let (_, report) = tour();
    let solution = &report.solution;
    for i in 1..=2 {
        let phases = ["leg[1]", "leg[2]", "leg[3]", "home"].map(|phase| format!("bus[{i}].{phase}"));
        for pair in phases.windows(2) {
            let home = pair[1].ends_with("home");
            for (name, _, order) in CONTINUOUS.into_iter().filter(|(_, at_home, _)| *at_home == home) {
                let [before, after] =
                    [&pair[0], &pair[1]].map(|phase| solution.output(&format!("{phase}.{name}")).expect("an output"));
                let join = before.end();
                assert_eq!(join, after.start());
                for j in 0..=order {
                    let (left, right) = (before.derivative(join, j), after.derivative(join, j));
                    assert!((left - right).abs() < 1e-9, "{}: {left} then {right}, derivative {j}", after.name());
                }
                // In scaled time, where derivatives of all orders are of one size.
                let jump = before.derivative(join, order + 1) - after.derivative(join, order + 1);
                let scaled = jump * (after.end() - join).powi(order as i32 + 1);
                assert!(scaled.abs() > 1e-4, "{}: continuity ends at derivative {order}: {scaled}", after.name());
            }
        }
        // Nothing was asked of `s` where the way home begins.
        let [before, after] =
            ["leg[3]", "home"].map(|phase| solution.output(&format!("bus[{i}].{phase}.s")).expect("an output"));
        assert!((before.at(before.end()) - after.at(after.start())).abs() > 1e-4, "`jump s` lets it jump");
    }
}

#[test]
fn shipped_phases_meet_too() {
    let report = missile().1;
    for name in ["x", "h", "v", "path_angle"] {
        let [boost, coast] =
            ["boost", "coast"].map(|phase| report.solution.output(&format!("{phase}.{name}")).expect("an output"));
        assert!((boost.at(boost.end()) - coast.at(coast.start())).abs() < 1e-9, "{name}");
    }
}

#[test]
fn event_times_add_up() {
    let (_, report) = tour();
    let solution = &report.solution;
    let time = |name: &str| solution.time(name).unwrap_or_else(|| panic!("no time {name}"));
    let near = |a: f64, b: f64| assert!((a - b).abs() <= 1e-12 * b.abs(), "{a} and {b}");
    for i in 1..=2 {
        let bus = format!("bus[{i}]");
        let phases = ["leg[1]", "leg[2]", "leg[3]", "home"].map(|phase| format!("{bus}.{phase}"));
        near(time(&format!("start({bus})")), time(&format!("start({})", phases[0])));
        near(time(&format!("end({bus})")), time(&format!("end({})", phases[3])));
        near(phases.iter().map(|p| time(&format!("duration({p})"))).sum(), time(&format!("duration({bus})")));
        for pair in phases.windows(2) {
            near(time(&format!("end({})", pair[0])), time(&format!("start({})", pair[1])));
        }
        for phase in phases.iter().map(String::as_str).chain([bus.as_str()]) {
            let [start, end, length] = ["start", "end", "duration"].map(|what| time(&format!("{what}({phase})")));
            near(start + length, end);
        }
        near(time(&format!("{bus}.leg[2].D")), time(&format!("duration({bus}.leg[2])")));
        near(time(&format!("{bus}.home.back")), time(&format!("duration({bus}.home)")));
    }
    assert!(time("start(bus[2])") >= time("end(bus[1].leg[1])") - 1e-6);
    assert!(solution.phases().iter().all(|phase| phase.start < phase.end));
}

#[test]
fn a_phase_is_seen_alone_and_an_agent_as_one() {
    let (problem, report) = tour();
    let solution = &report.solution;
    let output = |path: &str| solution.output(path).unwrap_or_else(|| panic!("no output {path}"));
    let (whole, leg, home) = (output("bus[1].x"), output("bus[1].leg[2].x"), output("bus[1].home.x"));
    assert_eq!((whole.start(), whole.end()), (output("bus[1].leg[1].x").start(), home.end()));
    for t in [0.1, 0.5, 0.9].map(|part| leg.start() + part * (leg.end() - leg.start())) {
        assert_eq!(whole.at(t).to_bits(), leg.at(t).to_bits());
    }
    // Outside its time a phase keeps the value that it has at its own end.
    assert_eq!(leg.at(leg.end() + 50.0), leg.at(leg.end()));
    assert_eq!(leg.derivative(leg.start() - 50.0, 1), leg.derivative(leg.start(), 1));
    // The third derivative jumps where the family ends: each side has its own.
    let join = home.start();
    let before = output("bus[1].leg[3].x");
    assert_eq!(whole.derivative(join, 3).to_bits(), home.derivative(join, 3).to_bits());
    assert!((before.derivative(join, 3) - home.derivative(join, 3)).abs() > 1e-9);

    let signal = |path: &str| solution.signal(&problem, path).unwrap_or_else(|| panic!("no signal {path}"));
    let (v, home_v) = (signal("bus[1].v"), signal("bus[1].home.v"));
    let middle = 0.5 * (home.start() + home.end());
    assert_eq!(v.at(middle).to_bits(), home_v.at(middle).to_bits());
    assert!((v.at(middle) - 3600.0 * whole.derivative(middle, 1)).abs() < 1e-9, "km/h");
    assert_eq!(home_v.at(0.0), home_v.at(home.start()));
    assert!(solution.output("bus[1].home.nothing").is_none() && solution.signal(&problem, "bus[3].v").is_none());
}

#[test]
fn what_phases_define_each_for_itself_runs_through_all_of_them() {
    let (problem, report) = missile();
    let solution = report.solution;
    let at = |name: &str, t: f64| solution.signal(&problem, name).expect("a named expression").at(t);
    assert_eq!((at("thrust", 3.0), at("thrust", 10.0)), (18.0, 0.0));
    assert!((at("mass", 3.0) - 125.0).abs() < 1e-9 && at("mass", 10.0) == 100.0);
    // One value on each side of the burn-out.
    assert_eq!((at("boost.thrust", 6.0), at("coast.thrust", 6.0)), (18.0, 0.0));
}
