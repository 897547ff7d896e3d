//! A quadrotor through gates: the course from above, and what its motors do.
//!
//! Run with `cargo run --release --bin gates`; draws into `pictures/`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Axes, Line, Stroke, axes, draw, legend};
use drawing::history::Panel;
use drawing::phases::{events, histories, key, legs, over_time};
use drawing::{BLUE, Drawn, INK, VERMILION, picture};
use ntg::prelude::*;

ntg_file!("../specs/gates.ntg");

fn main() -> Drawn {
    let course = Gates::default();
    let flight = course.solve(&Settings::default())?;
    println!("{}", flight.report());
    let looks = [("odd legs", BLUE), ("even legs", VERMILION)];
    let looks = looks.map(|(name, colour)| Line::new(name, colour, Stroke::Solid, vec![]));
    let mut lines = legs(flight.untyped(), ["x", "y"], &looks)?;
    for i in 0..course.gate_x.len() - 1 {
        // A gate is 1.6 m wide, across the direction in which it is passed.
        let (sin, cos) = course.gate_heading[i].to_radians().sin_cos();
        let post = |side: f64| (course.gate_x[i] - 0.8 * side * sin, course.gate_y[i] + 0.8 * side * cos);
        lines.push(Line::new("gates", INK, Stroke::Broad, vec![post(-1.0), post(1.0)]));
    }
    let folder = Path::new("pictures");
    let path = folder.join("gates_from_above.svg");
    let words = "An eight from rest to rest, with the least snap; each gate is passed in its middle and squarely.";
    let area = legend(&picture(&path, 1050, "A quadrotor flies through gates, seen from above", words)?, &key(&lines))?;
    let mut chart = axes(&area, Axes::new(("x [m]", -1.5..16.0), ("y [m]", -5.0..5.0)))?;
    draw(&mut chart, &lines)?;
    events(&mut chart, flight.untyped(), ["x", "y"], (18, 14))?;

    let row = |name, signal, range, limits| -> Drawn<Panel<'_>> {
        let points = over_time(flight.untyped(), &course, signal)?;
        Ok(Panel { name, range, lines: vec![Line::new("", BLUE, Stroke::Solid, points)], limits })
    };
    let rows = [
        row("height [m]", "z", 0.0..4.5, &[])?,
        row("speed [m/s]", "speed", 0.0..10.0, &[])?,
        row("thrust [m/s^2]", "thrust", 0.0..24.0, &[(18.6, "largest"), (3.0, "least")])?,
        row("tilt [deg]", "tilt", 0.0..80.0, &[(60.0, "largest")])?,
    ];
    let title =
        ["What the quadrotor does", "Dotted upright: the gates. Thrust and tilt reach their limits in the turns."];
    let times: Vec<f64> = flight.untyped().phases().iter().map(|leg| leg.end).collect();
    histories(&folder.join("gates_over_time.svg"), title, 0.0..7.5, &rows, &times)
}
