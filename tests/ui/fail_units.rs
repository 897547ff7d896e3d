//! Kilometres added to seconds: from the first token of the sum to its last, both sides named.
ntg::ntg! {
    problem P {
        duration T = 5 [s];
        output x [km]: spline(order = 5, intervals = 2);
        minimize integral(der(x)^2);
        final { x + 3 * T <= 2 [km]; }
    }
}

fn main() {}
