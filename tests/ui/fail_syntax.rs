//! Three broken statements: three errors in one build, each at its own token.
ntg::ntg! {
    problem P {
        output x: spline(order = );
        minimize integral(x +);
        final { x = 2; }
    }
}

fn main() {}
