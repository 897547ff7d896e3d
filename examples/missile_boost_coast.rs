//! Boost and coast to a target: acceleration to spare, little of it, and a target that pulls up.
//!
//! Run with `cargo run --release --bin missile_boost_coast`; draws `pictures/missile_boost_coast.svg`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Line, Stroke};
use drawing::history::{Panel, samples};
use drawing::missile::{Look, Scene, Shot, shots};
use drawing::track::Track;
use drawing::{BLUE, Drawn, GREEN, INK, VERMILION};
use ntg::prelude::*;

ntg_file!("../specs/missile_boost_coast.ntg");

/// When the motor stops, as the spec has it.
const BURN_OUT: f64 = 6.0;

fn main() -> Drawn {
    let spare = MissileBoostCoast::default();
    let little = MissileBoostCoast { a_max: 30.0, ..spare.clone() };
    let evading = MissileBoostCoast { pull_up: 20.0, ..spare.clone() };
    let flights = [
        shot("300 m/s^2 allowed", ((BLUE, Stroke::Broad), (20, 16)), &spare)?,
        shot("30 m/s^2 allowed", ((VERMILION, Stroke::Solid), (20, 48)), &little)?,
        shot("target pulls up", ((GREEN, Stroke::Dashed), (20, -44)), &evading)?,
    ];
    let panel = |name, range: std::ops::Range<f64>, limits| {
        let event = vec![(BURN_OUT, range.start), (BURN_OUT, range.end)];
        Panel { name, range, lines: vec![Line::new("", INK, Stroke::Fine, event)], limits }
    };
    let scene = Scene {
        title: "Six seconds of thrust, then coasting to an oncoming target",
        sentence: "Dots every 2 s. Dotted upright: the motor stops, the thrust jumps, and drag slows the missile.",
        x: ("downrange [km]", -0.5..22.0),
        y: ("height [km]", 4.0..14.5),
        every: 2.0,
        last: 22.0,
        panels: vec![
            panel("speed [m/s]", 0.0..1400.0, &[]),
            panel("thrust [kN]", -2.0..22.0, &[]),
            panel("drag [kN]", 0.0..6.0, &[]),
            panel("normal acc. [m/s^2]", -60.0..100.0, &[(30.0, ""), (-30.0, "limits where 30 m/s^2 are allowed")]),
        ],
    };
    shots(Path::new("pictures/missile_boost_coast.svg"), scene, &flights)
}

/// The flight of a missile, each phase up to its own ends, so that jumps are seen.
fn shot(name: &str, (look, words): Look, missile: &MissileBoostCoast) -> Drawn<Shot> {
    let solution = missile.solve(&Settings::default())?;
    if !solution.is_solved() {
        return Err(format!("{name}: {}", solution.status()).into());
    }
    let (boost, coast) = (&solution.boost, &solution.coast);
    println!("{name}: hit after {:.5} s at {:.0} m/s", coast.end(), solution.v.at(coast.end()));
    let both = [(boost.thrust(), coast.thrust()), (boost.drag(), coast.drag()), (boost.a_n(), coast.a_n())];
    let along = both.map(|(b, c)| [samples(&b, 0.0, boost.end()), samples(&c, coast.start(), coast.end())].concat());
    let target = Track::moving(coast.end(), |t| (solution.target_x().at(t), solution.target_h().at(t)));
    let missile = Track::of(&solution.x, &solution.h);
    let histories = [vec![solution.v.sample(601)], along.to_vec()].concat();
    Ok(Shot { name: name.to_owned(), look, missile, target, words, histories })
}
