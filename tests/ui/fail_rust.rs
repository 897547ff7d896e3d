//! A spec that is right, used wrongly: rustc's own words, about the user's own names.
ntg::ntg! {
    problem Rest {
        duration T = 1 [s];
        param distance = 1 [m];
        output x [m]: spline(order = 6, intervals = 2);
        minimize integral(der(x, 2)^2);
        initial { x == 0;  der(x) == 0; }
        final { x == distance;  der(x) == 0; }
    }
}

fn main() {
    let _ = Rest { distance: "far" };
    let _ = Rest::default().distence;
}
