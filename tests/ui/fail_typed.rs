//! Solutions of missions used wrongly: rustc's own words, about the names of the spec.
use ntg::prelude::*;

ntg::ntg! {
    problem Mission {
        param track = 100 [m];
        agent uav[i in 1 .. 2] {
            output x [m]: spline(order = 5, intervals = 2);
            phase covert { duration in 1 .. 60 [s]; }
            phase leg[k in 1 .. 2] after covert { duration in 1 .. 60 [s]; }
            minimize integral(der(x, 2)^2);
            initial { x == 0; }
            final { x == track; }
        }
        agent base { duration T in 1 .. 60 [s];  output h [m]: spline(order = 5, intervals = 2);  initial { h == 0; } }
        temporal { together: end(uav[1]) == end(uav[2]); }
    }
}

fn main() {
    let solution = Mission::default().solve(&Settings::default()).unwrap();
    let _ = solution.uav.end();
    let _ = solution.uav(1).cover.x.at(0.0);
    let _ = solution.uav("first").x;
    let _ = solution.base(1);
    let _ = solution.multiplier_togetherness();
}
