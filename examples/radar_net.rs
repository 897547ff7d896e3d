//! Through a net of radars, low over a mountain ridge: the map, the height, and what each radar sees.
//!
//! Run with `cargo run --release --bin radar_net`; draws into `pictures/`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Axes, Line, Stroke, axes, draw, legend};
use drawing::heat::{Scale, bar, fill, warm};
use drawing::history::Panel;
use drawing::phases::{histories, key, legs, over_time};
use drawing::track::words;
use drawing::{BLUE, Drawn, GREEN, INK, PURPLE, RGBColor, VERMILION, picture};
use ntg::prelude::*;
use ntg::runtime::transcribe::interpolants;

ntg_file!("../specs/radar_net.ntg");

const COLOURS: [RGBColor; 4] = [BLUE, VERMILION, GREEN, PURPLE];

fn main() -> Drawn {
    let net = RadarNet::default();
    let flight = net.solve(&Settings::default())?;
    println!("{}", flight.report());
    let tables = interpolants(&net.structure().tables)?;
    // The table is in SI units, as everything inside.
    let ground = |x: f64, y: f64| tables[0].eval(&[1e3 * x, 1e3 * y], &[0, 0]) / 1e3;
    map(&net, flight.untyped(), ground)?;
    over(&net, &flight, ground)
}

/// The flight over the ground, and the reach of each radar.
fn map(net: &RadarNet, flight: &Solution, ground: impl Fn(f64, f64) -> f64) -> Drawn {
    let mut lines = legs(flight, ["x", "y"], &[Line::new("flight", INK, Stroke::Solid, vec![])])?;
    for (i, colour) in COLOURS.into_iter().enumerate() {
        let at = |a: f64| (net.x_radar[i] + net.reach[i] * a.cos(), net.y_radar[i] + net.reach[i] * a.sin());
        let circle = (0..=120).map(|k| at(f64::from(k) * 3.0_f64.to_radians())).collect();
        lines.push(Line::new(&format!("reach of radar {}", i + 1), colour, Stroke::Dashed, circle));
    }
    let (title, sentence) = (
        "Past four radars, through the saddle of a ridge",
        "In the open each radar detects one aircraft in two at its circle. Flying low, this one is seen by hardly any.",
    );
    let path = Path::new("pictures/radar_net_map.svg");
    let area = legend(&picture(path, 1250, title, sentence)?, &key(&lines))?;
    let scale = Scale::even("ground [km]", 0.0..2.6, 13, warm);
    let mut chart = axes(&bar(&area, &scale)?, Axes::new(("east [km]", -60.0..60.0), ("north [km]", -45.0..45.0)))?;
    fill(&mut chart, &scale, ground)?;
    draw(&mut chart, &lines)?;
    for (i, place) in net.x_radar.iter().copied().zip(net.y_radar).enumerate() {
        words(&mut chart, place, &format!("radar {}", i + 1), (-36, -12))?;
    }
    Ok(())
}

/// Over time: how high it flies above which ground, and how well each radar sees it.
fn over(net: &RadarNet, flight: &RadarNetSolution, ground: impl Fn(f64, f64) -> f64) -> Drawn {
    let line = |name: &str, look: (_, _), signal: &str| -> Drawn<Line> {
        Ok(Line::new(name, look.0, look.1, over_time(flight.untyped(), net, signal)?))
    };
    let profile = |t: f64| (t, 1e3 * ground(flight.x.at(t), flight.y.at(t)));
    let below = flight.times(400).into_iter().map(profile).collect();
    let height = vec![Line::new("ground", GREEN, Stroke::Broad, below), line("flight", (INK, Stroke::Solid), "z")?];
    let seen = (1..)
        .zip(COLOURS)
        .map(|(i, colour)| line(&format!("radar {i}"), (colour, Stroke::Solid), &format!("detection[{i}]")));
    let rows = [
        Panel { name: "altitude [m]", range: 0.0..1500.0, lines: height, limits: &[] },
        Panel { name: "detection", range: 0.0..0.5, lines: seen.collect::<Drawn<_>>()?, limits: &[] },
    ];
    let title = [
        "Low over the ground",
        "Never less than 150 m above it. Only on the ridge is it seen at all, and then for a minute.",
    ];
    histories(Path::new("pictures/radar_net_over_time.svg"), title, 0.0..500.0, &rows, &[])
}
