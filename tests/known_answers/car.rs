//! The kinematic car's lane change, NTG's second example.

use ntg::prelude::*;

use crate::support::close;

mod grid {
    ntg::ntg_file!("specs/kinematic_car.ntg");
}
mod gauss {
    ntg::ntg_file!("specs/kinematic_car_gauss.ntg");
}

#[test]
fn the_lane_change_is_a_quintic_on_paper() {
    let solution = grid::KinematicCar::default().solve(&Settings::default()).expect("it can be set up");
    close(solution.objective(), 2.457_581_141_949_49, 1e-8);
    let solution = gauss::KinematicCarGauss::default().solve(&Settings::default()).expect("it can be set up");
    close(solution.objective(), 2.4576, 1e-8);
    assert!((solution.y.at(2.5)).abs() < 1e-9 && (solution.x.at(2.5) - 20.0).abs() < 1e-9, "half way at half time");
}
