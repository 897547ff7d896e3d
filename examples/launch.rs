//! A rocket of three stages into orbit: height, speed, mass and direction of thrust over time.
//!
//! Run with `cargo run --release --bin launch`; draws `pictures/launch.svg`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Line, Stroke};
use drawing::history::Panel;
use drawing::phases::{histories, over_time};
use drawing::{BLUE, Drawn};
use ntg::prelude::*;

ntg_file!("../specs/launch.ntg");

fn main() -> Drawn {
    let rocket = Launch::default();
    let flight = rocket.solve(&Settings::default())?;
    if !flight.is_solved() {
        return Err(format!("{}", flight.status()).into());
    }
    println!("{}", flight.report());
    println!("into orbit: {:.3} kg, after a third burn of {:.3} s", flight.objective(), flight.third.duration());
    let row = |name, signal, range, limits| -> Drawn<Panel<'_>> {
        let points = over_time(flight.untyped(), &rocket, signal)?;
        Ok(Panel { name, range, lines: vec![Line::new("", BLUE, Stroke::Solid, points)], limits })
    };
    let rows = [
        row("altitude [km]", "altitude", 0.0..250.0, &[(200.0, "the orbit")])?,
        row("speed [km/s]", "speed", 0.0..10.0, &[(7.784, "of a circular orbit")])?,
        row("mass [t]", "m", 0.0..32.0, &[])?,
        row("steering [deg]", "steering", -40.0..100.0, &[(0.0, "level at the launch site")])?,
        row("pressure [kPa]", "pressure", 0.0..60.0, &[])?,
    ];
    let title = [
        "Three stages into a circular orbit 200 km up",
        "Dotted upright: a stage is dropped. The mass jumps; position, speed and direction of thrust do not.",
    ];
    let stages = [flight.first.end(), flight.second.end(), flight.third.end()];
    histories(Path::new("pictures/launch.svg"), title, 0.0..480.0, &rows, &stages)
}
