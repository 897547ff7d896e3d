//! Phases in a circle, a path that leads nowhere, and a trajectory quantity in `temporal`.
mod circle {
    ntg::ntg! {
        problem P {
            output z: spline(order = 5, intervals = 2);
            minimize integral(z^2);
            phase climb after cruise { duration in 1 .. 2; }
            phase cruise after climb { duration in 1 .. 2; }
        }
    }
}
mod paths {
    ntg::ntg! {
        problem P {
            agent uav[i in 1 .. 2] { duration T in 1 .. 2; output z: spline(order = 5, intervals = 2); minimize integral(z^2); }
            temporal { end(uv[1]) <= 2; end(uav[3]) <= 2; uav[1].z <= 2; }
        }
    }
}
mod event {
    ntg::ntg! {
        problem P {
            output z: spline(order = 5, intervals = 2);
            minimize integral(z^2);
            phase a { duration in 1 .. 2; }
            phase b after a { duration in 1 .. 2; trajectory { z <= end(a); } }
        }
    }
}

fn main() {}
