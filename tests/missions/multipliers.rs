//! A multiplier is the change of the optimum with a bound: against central differences of optima.

use ntg::prelude::*;
use ntg_interp::Interpreted;

use crate::{compile, solved};

/// Three vehicles on rails that are in a hurry, and one law that binds them, with the parameter `p`.
fn fleet(p: &str, law: &str) -> String {
    format!(
        "problem Fleet {{
            param p = {p};
            agent a[i in 1 .. 3] {{
                duration T in 1 .. 100 [s];
                output x [m]: spline(order = 5, intervals = 2, smoothness = 3);
                minimize integral(der(x, 2)^2) + 0.5 [m^2/s^5] * T^2;
                initial {{ x == 0;  der(x) == 0; }}
                final   {{ x >= 10 [m] * i;  der(x) == 0; }}
                guess   {{ x = 10 [m] * i * tau;  T = 8 [s]; }}
            }}
            temporal {{ law: {law}; }}
        }}"
    )
}

/// The optimum where `p` is `value`, in SI units.
fn at(problem: &mut Interpreted, value: f64) -> Report {
    problem.set("p", &[value]).expect("the parameter of the law");
    solved(problem)
}

/// Asserts that the multiplier of `law` is `sign` times the slope of the optimum over `p`.
#[track_caller]
fn agrees(text: &str, sign: f64) {
    let mut problem = Interpreted::new(&compile(text).program);
    let p = problem.structure().parameters.iter().find(|p| p.name == "p").expect("the parameter p").clone();
    let middle = p.value[0];
    let step = 1e-3 * middle.abs();
    let slope = (at(&mut problem, middle + step).objective - at(&mut problem, middle - step).objective) / (2.0 * step);
    let report = at(&mut problem, middle);
    let law = report.constraints.iter().find(|c| c.name.ends_with("law")).expect("the law");
    // From units of the constraint to SI, as the parameter was set.
    let found = law.sensitivity / law.unit.factor;
    assert!(found.abs() > 1e-3, "the law does not bind:\n{report}");
    let error = (found - sign * slope).abs() / slope.abs();
    assert!(error < 1e-5, "the multiplier is {found}, the slope {slope}, sign {sign}, error {error:e}:\n{text}");
    let rows: f64 = report.solution.multipliers(&law.name).iter().map(|m| m.value).sum();
    let at_no_point = law.multiplier.as_ref().is_some_and(|m| !m.density && m.time.is_none());
    assert!(!at_no_point || (rows - law.sensitivity).abs() <= 1e-12 * rows.abs(), "{rows} {}", law.sensitivity);
}

/// Left to themselves, the vehicles arrive after 5.1, 6.8 and 8.0 s: each law binds.
const LAWS: [(&str, &str, f64); 14] = [
    ("1 [s]", "end(a[2]) == end(a[1]) + p", 1.0),
    // The difference of the sides is held at 0; to raise that bound is to lower `p`.
    ("1 [s]", "end(a[1]) + p == end(a[2])", -1.0),
    ("1 [s]", "end(a[2]) - end(a[1]) == p", 1.0),
    ("1 [s]", "end(a[2]) - end(a[1]) <= p", 1.0),
    ("1 [s]", "p >= end(a[2]) - end(a[1])", 1.0),
    ("5 [s]", "end(a[2]) - end(a[1]) >= p", 1.0),
    ("5 [s]", "p <= end(a[2]) - end(a[1])", 1.0),
    ("1 [s]", "0.5 [s] <= end(a[2]) - end(a[1]) <= p", 1.0),
    ("5 [s]", "p <= end(a[2]) - end(a[1]) <= 9 [s]", 1.0),
    ("5 [s]", "9 [s] >= end(a[2]) - end(a[1]) >= p", 1.0),
    ("2 [s]", "end(a[3]) - end(a[1]) in 0 .. p", 1.0),
    ("0.04 [min]", "duration(a[3]) - duration(a[1]) <= p", 1.0),
    ("4 [m^2/s^3]", "integral(a[1], der(x, 2)^2) + integral(a[2], der(x, 2)^2) <= p", 1.0),
    ("35 [m]", "final(a[1], x) + final(a[2], x) >= p", 1.0),
];

#[test]
fn of_event_times_totals_and_boundary_values() {
    for (p, law, sign) in LAWS {
        agrees(&fleet(p, law), sign);
    }
}

#[test]
fn of_a_maximum_as_of_a_minimum() {
    for (p, law, sign) in LAWS {
        let text = fleet(p, law).replace("minimize integral(der(x, 2)^2) +", "maximize -integral(der(x, 2)^2) -");
        agrees(&text, sign);
    }
}

#[test]
fn of_a_bound_along_the_way_moved_everywhere_at_once() {
    let law = "trajectory { law: -9 [km/h] <= der(x) <= p; } minimize";
    agrees(&fleet("9 [km/h]", "end(a[1]) >= 0").replace("law:", "").replacen("minimize", law, 1), 1.0);
    let law = "trajectory { law: der(x, 2) >= p; } minimize";
    agrees(&fleet("-0.5 [m/s^2]", "end(a[1]) >= 0").replace("law:", "").replacen("minimize", law, 1), 1.0);
}

#[test]
fn of_the_ends_of_phases_and_of_named_terms_with_units() {
    agrees(
        "problem Errand {
            param p = 0.4 [min];
            output x [m]: spline(order = 5, intervals = 2, smoothness = 3);
            minimize effort [J/kg/min]: integral(der(x, 2)^2);
            phase out             { duration in 1 .. 60 [s];  final { x == 50 [m]; } }
            phase back after out  { duration in 1 .. 60 [s]; }
            temporal { law: end(back) <= p; }
            initial { x == 0;  der(x) == 0; }
            final   { x == 0;  der(x) == 0; }
            guess { duration(out) = 12 [s];  duration(back) = 10 [s];  x = 80 [m] * tau * (1 - tau); }
        }",
        1.0,
    );
}

#[test]
fn of_the_bound_of_a_variable() {
    let text = "problem Spring {
        param p = 0.3 [N/m];
        variable stiffness in p .. 9 [N/m];
        duration T = 3 [s];
        output z [m]: spline(order = 5, intervals = 2, smoothness = 3);
        minimize integral((1 [kg] * der(z, 2) + stiffness * z)^2) / 1 [N^2*s] + 20 * stiffness / 1 [N/m];
        initial { z == 1 [m];  der(z) == 0; }
        final   { z == 0;      der(z) == 0; }
    }";
    let mut problem = Interpreted::new(&compile(text).program);
    let slope = (at(&mut problem, 0.3003).objective - at(&mut problem, 0.2997).objective) / 6e-4;
    let found = at(&mut problem, 0.3).solution.bound_multiplier("stiffness").expect("the variable");
    assert!((found / slope - 1.0).abs() < 1e-5, "{found} but the slope is {slope}");
}
