//! How dependable the solver is on missions: four aircraft that keep 5 km apart, from 20 bowed guesses;
//! and the intercept from 20 way-points, with the turn that each of them finds.
//!
//! Run with `cargo run --release --bin robustness_missions`. The guesses are random, with a fixed seed.

use fastrand::Rng;
use ntg::prelude::*;

ntg_file!("../specs/multi_vehicle_separated.ntg");
ntg_file!("../specs/missile_intercept.ntg");

const GUESSES: usize = 20;
const SEED: u64 = 2003;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut random, settings) = (Rng::with_seed(SEED), Settings::default());
    let mut between = |low: f64, high: f64| low + (high - low) * random.f64();

    println!("four aircraft 5 km apart: {GUESSES} guesses, each aircraft bowed by up to 10 km to either side");
    let fleet = MultiVehicleSeparated::default();
    let mut found: Vec<String> = vec![];
    for _ in 0..GUESSES {
        let route = |mut guess: Guess, i: i32, bow: f64, at: f64| {
            let off = f64::from(i) - 2.5;
            let (start, end) = ([-100.0 - 3.0 * off.abs() + 6.0 * off, 12.0 * off], [10.0 * off.cos(), -6.0 * off]);
            let via = [start[0] + at * (end[0] - start[0]), start[1] + at * (end[1] - start[1]) + bow];
            guess = guess.route(&[&format!("x[{i}]"), &format!("y[{i}]")], &[start, via, end]);
            guess
        };
        let guess = (1..=4).fold(Guess::new(), |g, i| route(g, i, between(-10.0, 10.0), between(0.3, 0.7)));
        let solution = fleet.solve_from(&guess, &settings)?;
        let solved = if solution.is_solved() { format!("{:.4}", solution.objective()) } else { "not solved".into() };
        found.push(solved);
    }
    count(found);

    println!("\nintercept: {GUESSES} way-points in the box (-5, 0) .. (25, 25) km");
    let mut found: Vec<String> = vec![];
    for _ in 0..GUESSES {
        let (x_via, y_via) = (between(-5.0, 25.0), between(0.0, 25.0));
        let solution = MissileIntercept { x_via, y_via, ..Default::default() }.solve(&settings)?;
        let turned = solution.heading.at(solution.duration_T()) - 170.0;
        let turn = if turned < 0.0 { "right" } else { "left" };
        let words =
            if solution.is_solved() { format!("{:.4} s, {turn}", solution.objective()) } else { "not solved".into() };
        println!("  via ({x_via:6.2}, {y_via:5.2}) km: {words}, {} iterations", solution.report().iterations);
        found.push(words);
    }
    count(found);
    Ok(())
}

/// Prints what was found, each with how often.
fn count(mut found: Vec<String>) {
    found.sort_unstable();
    found.chunk_by(|a, b| a == b).for_each(|same| println!("  {:>2} times {}", same.len(), same[0]));
}
