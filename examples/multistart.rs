//! Two problems with several local minima, each solved from sixteen starts: every minimum once, with
//! its objective and how many starts led to it.
//!
//! Run with `cargo run --release --bin multistart`; draws `pictures/multistart_flight.svg` and
//! `pictures/multistart_missile.svg`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Axes, Stroke, draw};
use drawing::minima::{Scene, tracks};
use drawing::radar::detection_over_ground;
use drawing::track::{Track, words};
use drawing::{Drawn, INK, flight};
use ntg::prelude::*;

ntg_file!("../specs/low_observable.ntg"); // Gives `LowObservable`, with a field for each parameter.
ntg_file!("../specs/missile_intercept.ntg");

/// How long the target of the missile is drawn, in seconds: longer than any minimum takes to hit it.
const TARGET_SEEN: f64 = 70.0;

fn main() -> Drawn {
    let (starts, settings) = (Starts { count: 16, ..Starts::default() }, Settings::default());

    // A limit of 7 is none: every way to the target is allowed, and several are local minima.
    let flights = LowObservable { signature_max: 7.0, ..LowObservable::default() }.multistart(&starts, &settings)?;
    println!("{}\n", flights.report);
    let scene = Scene {
        title: "Local minima of the flight past a radar",
        sentence: "Sixteen starts, no limit on the signature. The detours are minima on the grid: between its points they turn on the spot.",
        axes: Axes::new(("east [km]", -115.0..35.0), ("north [km]", -115.0..17.0)),
        height: 1450,
        map: Some((flight::detection(), |x, y| detection_over_ground(x.hypot(y), 0.0))),
    };
    let path = Path::new("pictures/multistart_flight.svg");
    tracks(
        path,
        scene,
        &flights,
        |found| Track::of(&found.x, &found.y),
        |chart| {
            words(chart, (0.0, 0.0), "radar", (18, -14))?;
            flight::places(chart)
        },
    )?;

    let shots = MissileIntercept::default().multistart(&starts, &settings)?;
    println!("{}\n", shots.report);
    let scene = Scene {
        title: "Local minima of the missile that must turn around",
        sentence: "Sixteen starts: both turns are found, and which one costs less.",
        axes: Axes::new(("east [km]", -14.0..40.0), ("north [km]", -8.0..26.0)),
        height: 1150,
        map: None,
    };
    let path = Path::new("pictures/multistart_missile.svg");
    let target = Track::moving(TARGET_SEEN, |t| (20.0 + 0.2 * t, 10.0));
    tracks(
        path,
        scene,
        &shots,
        |found| Track::of(&found.x, &found.y),
        |chart| {
            draw(chart, &[target.line("", INK, Stroke::Fine)])?;
            words(chart, (0.0, 10.0), "start, flying left", (20, -12))?;
            words(chart, (20.0, 10.0), "target, flying right", (0, -40))
        },
    )?;
    println!("The pictures are in pictures/.");
    Ok(())
}
