//! Mistakes about phases and families of them: each at its own token.
ntg::ntg! {
    problem Order {
        output z: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase climb { duration in 1 .. 2; }
        phase cruise after clim { duration in 1 .. 2; }
    }
}

ntg::ntg! {
    problem Fork {
        output z: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase climb { duration in 1 .. 2; }
        phase left after climb { duration in 1 .. 2; }
        phase right after climb { duration in 1 .. 2; }
    }
}

ntg::ntg! {
    problem TwoStarts {
        output z: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase first { duration in 1 .. 2; }
        phase second { duration in 1 .. 2; }
    }
}

ntg::ntg! {
    problem Circle {
        output z: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase a { duration in 1 .. 2; }
        phase b after c { duration in 1 .. 2; }
        phase c after b { duration in 1 .. 2; }
    }
}

ntg::ntg! {
    problem CircleOfFamilies {
        output z: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase low[i in 1 .. 2] after high[i - 1] { duration = 1; }
        phase high[i in 1 .. 2] after low[i] { duration = 1; }
    }
}

ntg::ntg! {
    problem Families {
        output z: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase leg[i in 1 .. 0] { duration in 1 .. 2;  final { z == i; } }
    }
}

ntg::ntg! {
    problem Members {
        output z: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        phase leg[i in 1 .. 4] after leg[i + 1] { duration in 1 .. 2; }
        phase home after leg[3] { duration in 1 .. 2; }
    }
}

ntg::ntg! {
    problem Within {
        output z: spline(order = 5, intervals = 2);
        let speed = der(z);
        minimize integral(speed^2);
        phase calm { duration T = -5;  output w: spline(order = 4, intervals = 2); }
        phase quick after calm {
            jump zz;
            continuous speed up to 1;
            continuous z up to 5;
            trajectory { z <= calm.w;  speed <= end(calm);  z >= final(calm, z); }
        }
        phase slow after quick { duration in 1 .. 2;  minimize z; }
    }
}

ntg::ntg! {
    problem Templates {
        output z: spline(order = 5, intervals = 2);
        minimize integral(force^2);
        let force = mass * der(z, 2);
        phase full { duration in 1 .. 2;  let mass = 2; }
        phase empty after full { duration in 3 .. 2; }
    }
}

ntg::ntg! {
    problem Sums {
        output z: spline(order = 5, intervals = 2);
        minimize integral(der(z, 2)^2);
        duration T in 10 .. 20 [s];
        phase a { duration in 1 .. 2 [s]; }
        phase b after a { duration in 1 .. 2 [s]; }
    }
}

fn main() {}
