//! Boost and coast to a target: acceleration to spare, little of it, and a target that pulls up.
//!
//! Run with `cargo run --release --example missile_boost_coast`; draws `pictures/missile_boost_coast.svg`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::Stroke;
use drawing::history::{Panel, samples};
use drawing::missile::{Scene, Shot, shots};
use drawing::track::Track;
use drawing::{BLUE, Drawn, GREEN, VERMILION};
use ntg::prelude::*;
use plotters::style::RGBColor;

ntg_file!("specs/missile_boost_coast.ntg");

fn main() -> Drawn {
    let missile = MissileBoostCoast::default();
    let flights = [
        shot("300 m/s^2 allowed", (BLUE, Stroke::Broad), &missile)?,
        shot("30 m/s^2 allowed", (VERMILION, Stroke::Solid), &MissileBoostCoast { a_max: 30.0, ..missile.clone() })?,
        shot("target pulls up", (GREEN, Stroke::Dashed), &MissileBoostCoast { pull_up: 20.0, ..missile.clone() })?,
    ];
    let panel = |name, range, limits| Panel { name, range, lines: vec![], limits };
    let scene = Scene {
        title: "Six seconds of thrust, then coasting to an oncoming target",
        sentence: "Dots every 2 s. When the motor stops, the thrust jumps and drag alone slows the missile.",
        x: ("downrange [km]", -0.5..22.0),
        y: ("height [km]", 4.0..14.5),
        every: 2.0,
        last: 22.0,
        panels: vec![
            panel("speed [m/s]", 0.0..1400.0, &[]),
            panel("thrust [kN]", -2.0..22.0, &[]),
            panel("drag [kN]", 0.0..6.0, &[]),
            panel("across [m/s^2]", -60.0..100.0, &[(30.0, "limit of 30"), (-30.0, "limit of 30")]),
        ],
    };
    shots(Path::new("pictures/missile_boost_coast.svg"), scene, &flights)
}

/// The flight of a missile, each phase up to its own ends, so that jumps are seen.
fn shot(name: &str, look: (RGBColor, Stroke), missile: &MissileBoostCoast) -> Drawn<Shot> {
    let solution = missile.solve(&Settings::default())?;
    if !solution.is_solved() {
        return Err(format!("{name}: {}", solution.status()).into());
    }
    let (boost, coast) = (&solution.boost, &solution.coast);
    println!("{name}: hit after {:.5} s at {:.0} m/s", coast.end(), solution.v.at(coast.end()));
    let histories = [(boost.thrust(), coast.thrust()), (boost.drag(), coast.drag()), (boost.a_n(), coast.a_n())];
    let along =
        histories.map(|(b, c)| [samples(&b, 0.0, boost.end()), samples(&c, coast.start(), coast.end())].concat());
    let (x, h) = (solution.target_x(), solution.target_h());
    let target = Track::moving(coast.end(), |t| (x.at(t), h.at(t)));
    let missile = Track::of(&solution.x, &solution.h);
    Ok(Shot {
        name: name.to_owned(),
        look,
        missile,
        target,
        histories: [vec![solution.v.sample(601)], along.to_vec()].concat(),
    })
}
