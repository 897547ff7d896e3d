//! Low, high, low, high: the paper's equation 26, and how to keep a radar from tracking.
//!
//! Run with `cargo run --release --bin low_observable_alternation`; draws into `pictures/`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Line, Stroke};
use drawing::history::Panel;
use drawing::phases::{histories, legs, over_time, past_the_radar};
use drawing::{BLUE, Drawn, VERMILION};
use ntg::prelude::*;

ntg_file!("../specs/low_observable_alternation.ntg");
ntg_file!("../specs/low_observable_lock_loss.ntg");

fn main() -> Drawn {
    let alternation = LowObservableAlternation::default();
    let flight = alternation.solve(&Settings::default())?;
    println!("{}", flight.report());
    let title = [
        "Two exposures of a minute, a minute of hiding between them",
        "Hidden, the radar is within 30 degrees of the nose: the aircraft spirals in. Exposed, it crosses to its target.",
    ];
    draw("alternation", title, &alternation, flight.untyped(), ("signature", 0.0..7.5, &[(4.2, "while hidden")]))?;

    let lock_loss = LowObservableLockLoss::default();
    let flight = lock_loss.solve(&Settings::default())?;
    println!("{}", flight.report());
    let title = [
        "Tacking: never seen for more than 40 s, hidden for 45 s in between",
        "Each time the radar begins to track, the aircraft turns its nose to it, until the track is dropped.",
    ];
    draw("lock_loss", title, &lock_loss, flight.untyped(), ("detection", 0.0..1.15, &[(0.1, "while hidden")]))
}

type Shown<'a> = (&'a str, std::ops::Range<f64>, &'a [(f64, &'a str)]);

/// The ground track near the radar, and what it sees over time.
fn draw(name: &str, title: [&str; 2], problem: &dyn Problem, flight: &Solution, shown: Shown<'_>) -> Drawn {
    let looks = [("hidden", BLUE), ("in sight", VERMILION)];
    let looks = looks.map(|(name, colour)| Line::new(name, colour, Stroke::Solid, vec![]));
    let folder = Path::new("pictures");
    let tracks = legs(flight, ["x", "y"], &looks)?;
    let window = [-105.0..15.0, -105.0..5.0];
    past_the_radar(&folder.join(format!("{name}_ground_track.svg")), title, window, &tracks, flight)?;
    let row = |name, signal, range, limits| -> Drawn<Panel<'_>> {
        Ok(Panel {
            name,
            range,
            lines: vec![Line { points: over_time(flight, problem, signal)?, ..looks[0].clone() }],
            limits,
        })
    };
    let mut rows = vec![row(shown.0, shown.0, shown.1, shown.2)?];
    rows.push(row("azimuth [deg]", "azimuth", -10.0..110.0, &[(30.5, "the cliff of Table 1")])?);
    rows.push(row("speed [km/s]", "speed", 0.05..0.30, &[(0.25, "fastest")])?);
    rows.iter_mut().flat_map(|row| &mut row.lines).for_each(|line| line.name.clear());
    let events: Vec<f64> = flight.phases().iter().map(|leg| leg.end).collect();
    histories(&folder.join(format!("{name}_over_time.svg")), title, 0.0..560.0, &rows, &events)
}
