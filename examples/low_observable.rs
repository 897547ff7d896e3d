//! The low-observability flight of AFRL-VA-WP-TP-2003-303, from both of the paper's coarse routes, on
//! the paper's grid and with Gauss points; and every picture of it.
//!
//! Run with `cargo run --release --bin low_observable`; draws into `pictures/`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Line, Stroke};
use drawing::flight::{Flight, ground_track, history};
use drawing::{BLUE, Drawn, GREEN, VERMILION, paper};
use ntg::prelude::*;

ntg_file!("../specs/low_observable.ntg"); // Gives `LowObservable`, with a field for each parameter.
ntg_file!("../specs/low_observable_gauss.ntg");

const START: (f64, f64) = (-100.0, -100.0);
const TARGET: (f64, f64) = (5.0, -15.0);
const ROUTES: [(&str, (f64, f64)); 2] = [("(a)", (-100.0, -15.0)), ("(b)", (0.0, -100.0))];

fn main() -> Drawn {
    let settings = Settings::default();
    let problem = LowObservable { signature_max: 7.0, ..LowObservable::default() };
    let free = problem.solve(&settings)?;
    println!("no limit on the signature: J = {:.9}, T = {:.4} s", free.objective(), free.duration_T());
    let look = Line::new("flight without a limit", GREEN, Stroke::Dashed, vec![]);
    let mut flights = vec![Flight::of(look, &[], &problem, free.untyped())?];

    for ((name, via), (colour, stroke)) in ROUTES.into_iter().zip([(BLUE, Stroke::Broad), (VERMILION, Stroke::Solid)]) {
        let problem = LowObservable { x_via: via.0, y_via: via.1, ..LowObservable::default() };
        let grid = problem.solve(&settings)?;
        let gauss = LowObservableGauss { x_via: via.0, y_via: via.1, ..LowObservableGauss::default() };
        let gauss = gauss.solve(&settings)?;
        if !(grid.is_solved() && gauss.is_solved()) {
            return Err(format!("route {name}: {}; with Gauss points: {}", grid.status(), gauss.status()).into());
        }
        println!("\nsignature at most 4.2, coarse route {name}, 41 breakpoints:\n{}", grid.report());
        println!("route {name}, 41 breakpoints: J = {:.9}, T = {:.4} s", grid.objective(), grid.duration_T());
        println!("route {name}, Gauss points:   J = {:.9}, T = {:.4} s", gauss.objective(), gauss.duration_T());
        let look = Line::new(&format!("flight from route {name}"), colour, stroke, vec![]);
        flights.push(Flight::of(look, &[START, via, TARGET], &problem, grid.untyped())?);
    }

    let folder = Path::new("pictures");
    ground_track(&folder.join("ground_track.svg"), &flights)?;
    history(&folder.join("flight_over_time.svg"), &flights)?;
    paper::figures(folder)?;
    println!("\nThe pictures are in {}.", folder.canonicalize()?.display());
    Ok(())
}
