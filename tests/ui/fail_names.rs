//! Two unknown names, one after a name of several bytes: columns are characters.
ntg::ntg! {
    problem P {
        duration T = 1;
        output ẋ: spline(order = 5, intervals = 2); // a comment keeps the columns honest
        minimize integral(ẋ^2 + der(w)^2);
        final { /* ẋẋẋ */ ẋẋ == 0; }
    }
}

fn main() {}
