//! A car changes lane: outputs, and what follows from them, with units.
//!
//! Run with `cargo run --release --bin kinematic_car`; draws `pictures/kinematic_car.svg`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Axes, Line, Stroke, axes, draw};
use drawing::{BLUE, Drawn, VERMILION, picture};
use ntg::prelude::*;

ntg_file!("../specs/kinematic_car.ntg"); // Gives `KinematicCar` and `KinematicCarSolution`.

fn main() -> Drawn {
    let solution = KinematicCar::default().solve(&Settings::default())?;
    println!("{}", solution.report());

    let (heading, speed, steering) = (solution.heading(), solution.speed(), solution.steering());
    println!(
        "{:>6} {:>8} {:>8} {:>14} {:>12} {:>15}",
        "t [s]", "x [m]", "y [m]", "heading [deg]", "speed [m/s]", "steering [deg]"
    );
    for t in solution.times(11) {
        let (x, y) = (solution.x.at(t), solution.y.at(t));
        println!("{t:6.2} {x:8.3} {y:8.3} {:14.3} {:12.4} {:15.4}", heading.at(t), speed.at(t), steering.at(t));
    }

    let times = solution.times(501);
    let track = times.iter().map(|t| (solution.x.at(*t), solution.y.at(*t))).collect();
    let angle = times.iter().map(|t| (solution.x.at(*t), steering.at(*t))).collect();
    let path = Path::new("pictures/kinematic_car.svg");
    let sentence = "Track of the rear axle, and the angle of the front wheels along it, at 8 m/s.";
    let area = picture(path, 1100, "A car changes lane", sentence)?;
    let (upper, lower) = area.split_vertically(480);
    let track_axes = Axes::new(("", 0.0..40.0), ("y [m]", -2.5..2.5));
    draw(&mut axes(&upper, track_axes)?, &[Line::new("track", BLUE, Stroke::Solid, track)])?;
    let steering_axes = Axes::new(("x [m]", 0.0..40.0), ("steering angle [deg]", -4.0..4.0));
    draw(&mut axes(&lower, steering_axes)?, &[Line::new("steering", VERMILION, Stroke::Solid, angle)])?;
    println!("\nDrew {}.", path.display());
    Ok(())
}
