//! A fleet of four under four rules: each on its own, all at one time, each looking at what the one
//! before it has struck, and all at one time without ever coming near each other.
//!
//! Run with `cargo run --release --bin multi_vehicle`; draws into `pictures/`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::Drawn;
use drawing::fleet::{Fleet, distances, tracks};
use drawing::track::Track;
use ntg::prelude::*;
use ntg::runtime::report::Report;

ntg_file!("../specs/multi_vehicle.ntg");
ntg_file!("../specs/multi_vehicle_simultaneous.ntg");
ntg_file!("../specs/multi_vehicle_look_after_strike.ntg");
ntg_file!("../specs/multi_vehicle_separated.ntg");

fn main() -> Drawn {
    let settings = Settings::default();
    let free = MultiVehicle::default().solve(&settings)?;
    let simultaneous = MultiVehicleSimultaneous::default().solve(&settings)?;
    let look = MultiVehicleLookAfterStrike::default().solve(&settings)?;
    let separated = MultiVehicleSeparated::default().solve(&settings)?;

    let own_clock = |i| ["x", "y"].map(|name| format!("uav[{i}].{name}"));
    let one_clock = |i| ["x", "y"].map(|name| format!("{name}[{i}]"));
    let fleets = [
        fleet("each on its own", free.report(), own_clock)?,
        fleet("all at one time", simultaneous.report(), own_clock)?,
        fleet("each looks 30 to 60 s after the strike before it", look.report(), own_clock)?,
        fleet("all at one time, 5 km apart", separated.report(), one_clock)?,
    ];
    let price = simultaneous.multiplier_strike()[0].value;
    println!("\nTo strike at one time instead of a second apart costs {:.4} for the first two.", price.abs());
    tracks(Path::new("pictures/fleet_tracks.svg"), &fleets)?;
    distances(Path::new("pictures/fleet_distances.svg"), 5.0, &[&fleets[1], &fleets[3]])
}

/// Prints how a fleet fared; its aircraft's outputs are found by their paths.
fn fleet(rule: &str, report: &Report, paths: impl Fn(usize) -> [String; 2]) -> Drawn<Fleet> {
    if !report.is_solved() {
        return Err(format!("{rule}: {}", report.status).into());
    }
    let outputs = (1..=4).map(|i| paths(i).map(|path| report.solution.output(&path)));
    let tracks: Vec<Track> = outputs.filter_map(|[x, y]| Some(Track::of(&x?, &y?))).collect();
    let times: Vec<String> = tracks.iter().map(|track| format!("{:.2}", track.end())).collect();
    println!("{rule}: J = {:.7}, strikes after {} s", report.objective, times.join(", "));
    Ok(Fleet { rule: rule.to_owned(), tracks })
}
