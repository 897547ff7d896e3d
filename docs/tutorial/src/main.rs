//! Plans a courier's flight, and plans it again every ten seconds while the customer walks away.

use ntg::prelude::*;

ntg_file!("courier.ntg");

/// Seconds between two plans.
const STEP: f64 = 10.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Keeps whatever stays the same from one plan to the next.
    let mut planner = Courier::default().solver(&Settings::default());
    let mut flight = planner.solve()?;

    for plan in 1..=5 {
        if !flight.is_solved() {
            return Err(flight.status().to_string().into());
        }
        let courier = &mut planner.problem; // Parameters are fields, in their declared units.
        println!(
            "plan {plan}: from ({:.0}, {:.0}) m at {:.1} m/s, there in {:.1} s",
            courier.x_start,
            courier.y_start,
            flight.speed().at(0.0),
            flight.duration_T(),
        );

        // Fly for a while; the customer walks north.
        courier.x_start = flight.x.at(STEP);
        courier.y_start = flight.y.at(STEP);
        courier.vx_start = flight.x.derivative(STEP, 1);
        courier.vy_start = flight.y.derivative(STEP, 1);
        courier.y_customer += 1.5 * STEP;

        // The rest of the last plan is nearly right: start from it.
        let rest = flight.duration_T() - STEP;
        let (x, y) = (flight.x.clone(), flight.y.clone());
        let guess = Guess::new()
            .output("x", move |tau| x.at(STEP + tau * rest))
            .output("y", move |tau| y.at(STEP + tau * rest))
            .duration("T", rest);
        flight = planner.solve_from(&guess)?;
    }
    Ok(())
}
