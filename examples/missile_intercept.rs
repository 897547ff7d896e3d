//! A missile that must turn around may turn either way. Both ways are tried, and compared.
//!
//! Run with `cargo run --release --bin missile_intercept`; draws `pictures/missile_intercept.svg`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::Stroke;
use drawing::history::{Panel, samples};
use drawing::missile::{Look, Scene, Shot, shots};
use drawing::track::Track;
use drawing::{BLUE, Drawn, VERMILION};
use ntg::prelude::*;

ntg_file!("../specs/missile_intercept.ntg");

fn main() -> Drawn {
    let right = turn("turning right", 20.0, ((BLUE, Stroke::Solid), (20, -44)))?;
    let left = turn("turning left", 0.0, ((VERMILION, Stroke::Dashed), (20, 16)))?;
    let better = if right.1 < left.1 { &right } else { &left };
    println!("{} is better, by {:.2} s.", better.0.name, (right.1 - left.1).abs());

    let lateral = Panel {
        name: "lateral [m/s^2]",
        range: -200.0..200.0,
        lines: vec![],
        limits: &[(150.0, "largest to the left"), (-150.0, "largest to the right")],
    };
    let distance = Panel { name: "distance [km]", range: 0.0..40.0, lines: vec![], limits: &[] };
    let scene = Scene {
        title: "Turn right or left to hit a target that flies away behind you",
        sentence: "It starts at (0, 10) km, flying left; dots every 10 s. Both turns are minima; the right one costs less.",
        x: ("east [km]", -14.0..52.0),
        y: ("north [km]", -8.0..26.0),
        every: 10.0,
        last: 65.0,
        panels: vec![lateral, distance],
    };
    shots(Path::new("pictures/missile_intercept.svg"), scene, &[right.0, left.0])
}

/// The flight that is found from a way-point north or south of the start, and its cost.
fn turn(name: &str, y_via: f64, (look, words): Look) -> Drawn<(Shot, f64)> {
    let solution = MissileIntercept { y_via, ..Default::default() }.solve(&Settings::default())?;
    if !solution.is_solved() {
        return Err(format!("{name}: {}", solution.status()).into());
    }
    println!("{name}: J = {:.5} s, hit after {:.4} s", solution.objective(), solution.duration_T());
    let end = solution.duration_T();
    let histories = [solution.a(), solution.distance()].map(|signal| samples(&signal, 0.0, end)).to_vec();
    let target = Track::moving(end, |t| (20.0 + 0.2 * t, 10.0));
    let missile = Track::of(&solution.x, &solution.y);
    Ok((Shot { name: name.to_owned(), look, missile, target, words, histories }, solution.objective()))
}
