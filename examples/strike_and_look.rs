//! One strikes, another looks at the result no less than a while later; beside the answer on paper.
//!
//! Run with `cargo run --release --bin strike_and_look`; draws `pictures/strike_and_look.svg`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
mod drawing;

use std::path::Path;

use drawing::chart::{Line, Stroke};
use drawing::history::{Panel, samples};
use drawing::phases::histories;
use drawing::{BLUE, Drawn, VERMILION};
use ntg::prelude::*;

ntg_file!("../specs/strike_and_look.ntg");

/// Effort and time of the two, going 80 and 60 far from rest to rest in so much time.
fn on_paper(strike: f64, look: f64) -> f64 {
    look + 12.0 * 80.0_f64.powi(2) / strike.powi(3) + 12.0 * 60.0_f64.powi(2) / look.powi(3)
}

fn main() -> Drawn {
    let problem = StrikeAndLook::default();
    let solution = problem.solve(&Settings::default())?;
    println!("{}", solution.report());
    let (striker, looker) = (&solution.striker, &solution.looker);
    let (strike, look) = (striker.end(), looker.end());
    println!("strike at {strike:.8}, look at {look:.8}: J = {:.10}", solution.objective());
    println!("the formula gives for these times  {:.10}", on_paper(strike, look));
    let price = solution.multiplier_look()[0].value;
    println!("a gap that is longer by one costs {price:.4} more");

    let line = |name, colour, stroke, points| Line::new(name, colour, stroke, points);
    let both = |of_striker, of_looker| {
        vec![line("striker", BLUE, Stroke::Solid, of_striker), line("looker", VERMILION, Stroke::Dashed, of_looker)]
    };
    let rows = [
        Panel {
            name: "position",
            range: 0.0..100.0,
            lines: both(striker.x.sample(301), looker.x.sample(301)),
            limits: &[(80.0, "to strike here"), (60.0, "to look from here")],
        },
        Panel {
            name: "acceleration",
            range: -1.2..1.2,
            lines: both(samples(&striker.a(), 0.0, strike), samples(&looker.a(), 0.0, look)),
            limits: &[],
        },
    ];
    let sentence = format!(
        "Dotted upright: the strike at {strike:.2}, the look at {look:.2}, no less than {} later. All effort is linear in time.",
        problem.gap
    );
    let title = ["Strike, then look", &sentence];
    histories(Path::new("pictures/strike_and_look.svg"), title, 0.0..40.0, &rows, &[strike, look])
}
