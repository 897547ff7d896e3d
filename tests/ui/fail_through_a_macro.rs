//! Tokens that come through `macro_rules!` are underlined where the user wrote them.
macro_rules! with_cost {
    ($cost:expr) => {
        ntg::ntg! {
            problem P {
                duration T = 1;
                output x: spline(order = 5, intervals = 2);
                minimize integral($cost);
            }
        }
    };
}

with_cost!(1.0 + nope);

fn main() {}
