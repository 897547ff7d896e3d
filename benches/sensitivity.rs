//! What the time of the low-observability flight owes to every parameter, and the flight for a slower aircraft without
//! another solve.
//!
//! Run with `cargo run --release --example sensitivity`.

use ntg::prelude::*;

ntg::ntg_file!("../specs/low_observable.ntg");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let flight = LowObservable { signature_max: 7.0, ..LowObservable::default() };
    let solution = flight.solve(&Settings::default())?;
    let by = solution.report().sensitivity(&flight)?;
    let time = by.of("T").ok_or("the duration is called T")?;
    println!("the flight takes {:.2} s, and longer by", solution.duration_T());
    for (parameter, slope) in by.parameters().iter().zip(&time.values).filter(|(_, slope)| **slope != 0.0) {
        println!("{slope:12.5} s for each {} more of {}", unit(&parameter.unit.symbol), parameter.name);
    }

    let slower = LowObservable { v_max: flight.v_max - 0.002, ..flight.clone() };
    let predicted = by.predict(&slower)?;
    let true_one = slower.solve(&Settings::default())?;
    let end = |solution: &Solution| solution.end() - solution.start();
    println!(
        "with v_max lower by 0.002 km/s: predicted {:.3} s, solved {:.3} s",
        end(&predicted),
        true_one.duration_T()
    );
    Ok(())
}

fn unit(symbol: &str) -> &str {
    if symbol.is_empty() { "unit" } else { symbol }
}
