//! Van der Pol's oscillator: from a spec file to a report, a table and a picture.
//!
//! Run with `cargo run --release --bin van_der_pol`; draws `pictures/van_der_pol.svg`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Axes, Line, Stroke, axes, draw, legend};
use drawing::{BLUE, Drawn, GREEN, VERMILION, picture};
use ntg::prelude::*;

ntg_file!("../specs/van_der_pol.ntg"); // Gives `VanDerPol` and `VanDerPolSolution`.

fn main() -> Drawn {
    let solution = VanDerPol::default().solve(&Settings::default())?;
    println!("{}", solution.report());

    println!("{:>6} {:>9} {:>9} {:>9}", "t", "z", "z'", "u");
    for t in solution.times(11) {
        println!("{t:6.2} {:9.4} {:9.4} {:9.4}", solution.z.at(t), solution.z.derivative(t, 1), solution.u().at(t));
    }
    draw_solution(&solution)
}

fn draw_solution(solution: &VanDerPolSolution) -> Drawn {
    let (z, u, times) = (&solution.z, solution.u(), solution.times(501));
    let line = |name, look: (_, _), value: &dyn Fn(f64) -> f64| {
        Line::new(name, look.0, look.1, times.iter().map(|t| (*t, value(*t))).collect())
    };
    let lines = [
        line("position z", (BLUE, Stroke::Solid), &|t| z.at(t)),
        line("speed z'", (GREEN, Stroke::Dashed), &|t| z.derivative(t, 1)),
        line("input u", (VERMILION, Stroke::Fine), &|t| u.at(t)),
    ];
    let path = Path::new("pictures/van_der_pol.svg");
    let sentence = "From z = 1 at rest, with least effort, to z' = z + 1 after 5 units of time.";
    let area = picture(path, 800, "The driven van der Pol oscillator", sentence)?;
    let area = legend(&area, &lines)?;
    draw(&mut axes(&area, Axes::new(("time", 0.0..5.0), ("z, z', u", -1.2..1.2)))?, &lines)?;
    println!("\nDrew {}.", path.display());
    Ok(())
}
