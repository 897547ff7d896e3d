//! What may and what may not stand in `temporal`, in bounds, along the way: each at its own token.
ntg::ntg! {
    problem OutOfPlace {
        output z [m]: spline(order = 5, intervals = 2);
        let v = der(z);
        variable limit in v .. 3 [m/s];
        minimize integral(v^2);
        phase a { duration in 1 .. 2 [s]; }
        phase b after a { duration in 1 .. v [s]; }
        temporal {
            z <= 3 [m];
            v * duration(a) <= 3 [m];
            t <= 3 [s];
            tau <= 1;
            a.z <= 3 [m];
            b.v <= 3 [m/s];
            final(a, v) <= limit;
        }
    }
}

ntg::ntg! {
    problem AlongTheWay {
        output z [m]: spline(order = 5, intervals = 2);
        let spent = integral(z^2);
        minimize integral(z - initial(z));
        phase a { duration in 1 .. 2 [s]; }
        phase b after a {
            duration in 1 .. 2 [s];
            trajectory { z^2 <= spent / 1 [s];  z >= final(a, z);  t <= 2 * end(a); }
        }
    }
}

ntg::ntg! {
    problem Relations {
        output z [m]: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase a { duration in 1 .. 2 [s]; }
        phase b after a { duration in 1 .. 2 [s]; }
        temporal { duration(a) = 1 [s];  end(a) < 2 [s];  1 [s] <= end(a) >= 2 [s]; }
    }
}

ntg::ntg! {
    problem Dimensions {
        output z [m]: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase a { duration in 1 .. 2 [m]; }
        phase b after a { duration in 1 .. 2 [s]; }
        temporal {
            end(b) - end(a) <= 30 [km];
            integral(b, der(z)) <= 40 [s];
            final(a, z) == end(a);
        }
    }
}

ntg::ntg! {
    problem Contradictions {
        output z [m]: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase a { duration in 1 .. 2 [s]; }
        phase b after a { duration in 1 .. 2 [s]; }
        temporal { early: end(b) <= 1 [s]; }
    }
}

ntg::ntg! {
    problem NeverTrue {
        duration T in 1 .. 2 [s];
        output z [m]: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        temporal { 3 [s] <= 2 [s]; }
    }
}

fn main() {}
