//! The paper's section 4: hidden until an event, exposed after it, from both coarse routes.
//!
//! Run with `cargo run --release --bin low_observable_phases`; draws into `pictures/`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Line, Stroke};
use drawing::history::Panel;
use drawing::phases::{histories, legs, over_time, past_the_radar};
use drawing::{BLUE, Drawn, GREEN, VERMILION};
use ntg::prelude::*;

ntg_file!("../specs/low_observable_phases.ntg");

const ROUTES: [(f64, f64); 2] = [(-100.0, -15.0), (0.0, -100.0)];

fn main() -> Drawn {
    let look = |name, colour, stroke| Line::new(name, colour, stroke, vec![]);
    let route = |name, via| Line::new(name, GREEN, Stroke::Fine, vec![(-100.0, -100.0), via, (5.0, -15.0)]);
    let mut tracks = vec![route("coarse routes (a) and (b)", ROUTES[0]), route("", ROUTES[1])];
    let covert = [look("covert: signature at most 4.2", BLUE, Stroke::Broad), look("", BLUE, Stroke::Solid)];
    let exposed = [look("exposed: at most 6.5", VERMILION, Stroke::Broad), look("", VERMILION, Stroke::Solid)];
    let runs = [look("from coarse route (a)", BLUE, Stroke::Broad), look("from route (b)", VERMILION, Stroke::Solid)];
    let panel = |name, range, limits| Panel { name, range, lines: vec![], limits };
    let mut rows = [
        panel("signature", 0.0..7.5, &[(4.2, "before the event"), (6.5, "after it")]),
        panel("azimuth [deg]", -20.0..100.0, &[(30.5, "the cliff of Table 1")]),
        panel("speed [km/s]", 0.05..0.30, &[(0.10, "slowest"), (0.25, "fastest")]),
    ];
    let mut last = None;
    for (i, (x_via, y_via)) in ROUTES.into_iter().enumerate() {
        let problem = LowObservablePhases { x_via, y_via, ..LowObservablePhases::default() };
        let flight = problem.solve(&Settings::default())?;
        println!("via ({x_via}, {y_via}) km:\n{}", flight.report());
        tracks.extend(legs(flight.untyped(), ["x", "y"], &[covert[i].clone(), exposed[i].clone()])?);
        for (row, name) in rows.iter_mut().zip(["signature", "azimuth", "speed"]) {
            let points = over_time(flight.untyped(), &problem, name)?;
            row.lines.push(Line { points, ..runs[i].clone() });
        }
        last = Some(flight);
    }
    let flight = last.ok_or("no route")?;
    let title = [
        "Hidden for ten minutes, exposed for forty seconds",
        "Both coarse routes lead to one flight. At the event it may show more, and turns from the radar to the target.",
    ];
    let folder = Path::new("pictures");
    let window = [-110.0..40.0, -110.0..10.0];
    past_the_radar(&folder.join("phases_ground_track.svg"), title, window, &tracks, flight.untyped())?;
    let title =
        ["What the radar sees", "Dotted upright: the event, after which the signature may rise from 4.2 to 6.5."];
    histories(&folder.join("phases_over_time.svg"), title, 0.0..650.0, &rows, &[flight.covert.end()])
}
