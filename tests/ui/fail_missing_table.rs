//! A table whose file is not there, inline.
ntg::ntg! {
    problem P {
        duration T = 1;
        output x: spline(order = 5, intervals = 2);
        table drag(speed) = linear from "/nowhere/drag.csv";
        minimize integral(drag(der(x)));
    }
}

fn main() {}
