//! An inline spec may stand in a function, beside others, and use words of Rust and of the
//! generated code as names; a crate that denies warnings builds with it.
#![deny(warnings)]

use ntg::prelude::Settings;

ntg::ntg! {
    /// Every name here means something to Rust or to the generated code.
    problem Vec {
        duration Some = 1;
        param type = 2;
        output structure, values: spline(order = 4, intervals = 2);
        let t1 = structure * type;
        let report = values + t1;
        minimize integral(der(structure)^2 + der(values)^2 + report^2);
        initial { structure == 1; }
        trajectory { objective: values <= 2; }
    }
}

#[test]
fn names_of_rust_and_of_ours_are_names_like_others() {
    let solution = Vec { r#type: 3.0 }.solve(&Settings::default()).expect("it can be set up");
    assert!(solution.is_solved(), "{}", solution.status());
    // A method of ours keeps its name; the spec's has `_` after it.
    let report = solution.values.at(0.5) + 3.0 * solution.structure.at(0.5);
    assert!((solution.report_().at(0.5) - report).abs() < 1e-12);
    assert_eq!(solution.report().problem, "Vec");
    assert_eq!(solution.duration_Some(), 1.0);
    assert!(!solution.multiplier_objective().is_empty());
}

#[test]
fn a_spec_may_stand_in_a_function() {
    ntg::ntg! {
        problem Inner {
            duration T = 1;
            output x: spline(order = 4, intervals = 2);
            minimize integral(der(x)^2);
            initial { x == 0; }
            final { x == 1; }
        }
    }
    let solution = Inner::default().solve(&Settings::default()).expect("it can be set up");
    assert!((solution.objective() - 1.0).abs() < 1e-9); // A straight line.
}

/// A spec whose cost is the caller's.
macro_rules! costing {
    ($name:ident, $cost:expr) => {
        ntg::ntg! {
            problem $name {
                duration T = 1;
                output x: spline(order = 4, intervals = 1);
                minimize integral(2 * $cost);
                initial { x == 3; }
            }
        }
    };
}

costing!(Costing, (x - 1) ^ 2 + der(x) ^ 2 - 1);

#[test]
fn a_macro_keeps_the_precedence_of_what_it_is_given() {
    let solution = Costing::default().solve(&Settings::default()).expect("it can be set up");
    // By hand: x - 1 = 2 cosh(1 - t) / cosh(1), with cost 2 (4 tanh(1) - 1).
    let optimum = 2.0 * (4.0 * 1.0_f64.tanh() - 1.0);
    assert!((solution.objective() - optimum).abs() < 1e-2 * optimum, "{}", solution.objective());
}
