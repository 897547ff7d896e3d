//! Fleets whose aircraft are bound together by the times of their events, and by their distances.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// A spec of fleets with `n` aircraft: a change of one constant.
fn fleet(spec: &str, n: usize) -> Shipped {
    Shipped::edited(spec, &[("const N = 4;", &format!("const N = {n};"))])
}

/// Optima for 2, 4 and 8 aircraft, from an independent solver.
#[track_caller]
fn optima(spec: &str, known: [f64; 3]) -> [Report; 3] {
    let sizes = [2, 4, 8];
    let solved = sizes.map(|n| fleet(spec, n).solve());
    for (report, known) in solved.iter().zip(known) {
        close(report.objective, known, 1e-7);
    }
    solved
}

/// When each aircraft arrives.
fn arrivals(report: &Report) -> Vec<f64> {
    let times = report.solution.event_times();
    times.into_iter().filter(|(name, _)| name.starts_with("end(uav[")).map(|(_, seconds)| seconds).collect()
}

#[test]
fn each_on_its_own() {
    optima("multi_vehicle", [193.775_976_122_3, 383.219_223_193_7, 791.656_341_211_7]);
}

#[test]
fn all_at_one_time() {
    let solved = optima("multi_vehicle_simultaneous", [193.839_844_209_6, 383.841_844_699_8, 796.375_874_768_1]);
    for report in solved {
        let times = arrivals(&report);
        assert!(times.iter().all(|t| (t - times[0]).abs() < 1e-6), "{times:?}");
    }
}

#[test]
fn each_looks_after_the_strike_before_it() {
    let solved = optima("multi_vehicle_look_after_strike", [194.162_401_557_0, 386.990_781_662_4, 832.255_407_913_8]);
    for report in solved {
        let times = arrivals(&report);
        let gaps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(gaps.iter().all(|gap| (30.0 - 1e-6..=60.0 + 1e-6).contains(gap)), "{gaps:?}");
    }
}

#[test]
fn all_at_one_time_and_never_near_each_other() {
    let solved = optima("multi_vehicle_separated", [193.976_968_959_7, 384.353_967_663_9, 798.446_150_268_3]);
    for (report, n) in solved.into_iter().zip([2, 4, 8]) {
        let output = |name: &str, i: usize| report.solution.output(&format!("{name}[{i}]")).expect("an aircraft");
        let positions: Vec<_> = (1..=n).map(|i| (output("x", i), output("y", i))).collect();
        let mut least = f64::INFINITY;
        for t in report.solution.times(41) {
            for (i, (x, y)) in positions.iter().enumerate() {
                let others = positions[i + 1..].iter();
                least = others.map(|(u, v)| (x.at(t) - u.at(t)).hypot(y.at(t) - v.at(t))).fold(least, f64::min);
            }
        }
        assert!((least - 5.0).abs() < 1e-6, "{n} aircraft come within {least} km of each other");
    }
}

mod strike_and_look {
    ntg::ntg_file!("specs/strike_and_look.ntg");
}

#[test]
fn strike_and_look_is_solved_on_paper() {
    let solution = strike_and_look::StrikeAndLook::default().solve(&Settings::default()).expect("it can be set up");
    assert!(solution.is_solved(), "{}", solution.report());
    close(solution.objective(), 40.500_166_977_2, 1e-8);
    close(solution.striker.end(), 22.587_833_55, 1e-6);
    close(solution.looker.end(), 32.587_833_55, 1e-6);
    // With the earlier time free, the cost grows with the gap as it does with the looker's time alone.
    let of_gap = 1.0 - 3.0 * 12.0 * 60.0_f64.powi(2) / 32.587_833_55_f64.powi(4);
    let multipliers = solution.multiplier_look();
    assert_eq!(multipliers.len(), 1);
    close(multipliers[0].value, of_gap, 1e-6);
    // Each flies the cubic through its ends.
    let (x, end) = (&solution.striker.x, solution.striker.end());
    for t in [0.1, 0.3, 0.5, 0.8].map(|part| part * end) {
        let part = t / end;
        close(x.at(t), 80.0 * part * part * (3.0 - 2.0 * part), 1e-9);
    }
}
