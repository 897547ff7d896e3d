//! Mistakes about agents, families of them, and the paths to them: each at its own token.
ntg::ntg! {
    problem Levels {
        duration T = 5;
        output z: spline(order = 5, intervals = 2);
        agent one {
            duration T = 5;
            output z: spline(order = 5, intervals = 2);
            param a = 3;
            minimize integral(z^2);
        }
        trajectory { one.z <= 3; }
        initial { one.z == 0; }
    }
}

ntg::ntg! {
    problem Nobody {
        agent uav[i in 1 .. 0] {
            duration T = 5;
            output z: spline(order = 5, intervals = 2);
            minimize integral(z^2);
        }
    }
}

ntg::ntg! {
    problem Which {
        agent one { duration T in 1 .. 2;  output z: spline(order = 5, intervals = 2); }
        agent two { duration in 1 .. 2;    output z: spline(order = 5, intervals = 2); }
        minimize integral(1);
        minimize integral(z^2);
        guess { z = 3;  duration = 2;  one.z = 3;  T = 1.5; }
    }
}

ntg::ntg! {
    problem Paths {
        agent uav[i in 1 .. 3] {
            output z: spline(order = 5, intervals = 2);
            minimize integral(z^2);
            phase leg[k in 1 .. 2] after leg[k - 1] { duration in 1 .. 2; }
        }
        agent car { duration T in 1 .. 2;  output z: spline(order = 5, intervals = 2); }
        temporal {
            end(uvv[1]) <= 3;
            end(uav) <= 3;
            end(uav[4]) <= 3;
            end(uav[1].leg[3]) <= 3;
            start(uav[1].lag[1]) <= 3;
            duration(car.leg) <= 3;
            end(car[1]) <= 3;
            end(leg[1]) <= 3;
            final(uav[0], z) <= 3;
            integral(car, speed) <= 3;
            for i in 1 .. 3 { end(uav[i]) <= end(uav[i + 1]); }
        }
    }
}

ntg::ntg! {
    problem Starts {
        agent one {
            start in 5 .. 2;
            duration T in 1 .. 2;
            output z [m]: spline(order = 5, intervals = 2);
            minimize integral(z^2) + start(one);
        }
        agent two {
            start = z;
            duration T in 1 .. 2;
            output z [m]: spline(order = 5, intervals = 2);
            minimize start(z);
        }
    }
}

fn main() {}
