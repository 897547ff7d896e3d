//! What a soft constraint becomes: an amount that is not negative, two rows, and a price in the objective.

use crate::model_support::{findings, program};

/// Holds two specs with common declarations against each other; names that no text has are left out.
#[track_caller]
fn same(common: &str, short: &str, long: &str) {
    let nameless = |text: &str| {
        let mut program = program(&format!("problem P {{ {common} {text} }}"));
        let structure = &mut program.structure;
        // What is only shown stands behind everything else.
        structure.shown.clear();
        structure.constraints.iter_mut().for_each(|constraint| constraint.name = None);
        structure.phases.iter_mut().flat_map(|phase| &mut phase.outputs).for_each(|output| output.doc.clear());
        structure.variables.iter_mut().for_each(|variable| variable.doc.clear());
        program
    };
    let (short, long) = (nameless(short), nameless(long));
    let (mut short, own) = (short, long.kernels.len());
    short.structure.kernels.truncate(own);
    assert_eq!(short.structure, long.structure);
    assert_eq!(short.kernels[..own], long.kernels[..]);
}

const CART: &str = "duration T in 1 .. 5 [s]; collocation gauss(points = 4, intervals = 5, inequalities = points); state p [m]; input u [m/s^2]; \
    param w = 3 [1/(m*s)]; dynamics { der(p, 2) == u; } minimize integral(u^2) * 1 [s^3/m^2]; \
    minimize integral(p^2) * 1 [1/(m^2*s)];";

#[test]
fn along_the_way_it_is_missed_by_an_output() {
    same(
        CART,
        "trajectory { soft(w): rail: p in -1 .. 2 [m]; }",
        "output rail_miss [m]: spline(order = 4, intervals = 5, smoothness = 0); \
         trajectory { rail_miss >= 0;  rail: p + rail_miss >= -1 [m];  rail: p - rail_miss <= 2 [m]; } \
         minimize rail: w * integral(rail_miss);",
    );
    same(
        CART,
        "trajectory { soft(linear = 2 [1/(m*s)], square = 5 [1/(m^2*s)]): rail: p <= 2 [m]; }",
        "output rail_miss [m]: spline(order = 4, intervals = 5, smoothness = 0); \
         trajectory { rail_miss >= 0;  rail: p - rail_miss <= 2 [m]; } \
         minimize rail: 2 [1/(m*s)] * integral(rail_miss) + 5 [1/(m^2*s)] * integral(rail_miss^2);",
    );
    same(
        "duration T = 5 [s]; collocation uniform(breakpoints = 11); output p [m]: spline(order = 5, intervals = 4); \
         minimize integral(p^2) * 1 [1/(m^2*s)];",
        "trajectory { soft(4 [1/(m*s)]): rail: p <= 2 [m]; }",
        "output rail_miss [m]: spline(order = 2, intervals = 10); \
         trajectory { rail_miss >= 0;  rail: p - rail_miss <= 2 [m]; } minimize rail: 4 [1/(m*s)] * integral(rail_miss);",
    );
}

#[test]
fn at_one_time_it_is_missed_by_a_variable() {
    same(
        CART,
        "final { soft(square = 50 [1/m^2]): aim: p == 3 [m]; }",
        "variable aim_miss [m] in 0 ..; final { aim: p + aim_miss >= 3 [m];  aim: p - aim_miss <= 3 [m]; } \
         minimize aim: 50 [1/m^2] * aim_miss^2;",
    );
    same(
        &format!("{CART} minimize at(0.4 * T, p) / 1 [m];"),
        "at 0.4 * T { soft(5 [1/m]): p >= 1 [m]; }",
        "variable miss [m] in 0 ..; temporal { at(0.4 * T, p) + miss >= 1 [m]; } minimize 5 [1/m] * miss;",
    );
}

const FLEET: &str = "const n = 3; duration T = 5 [s]; collocation gauss(points = 3, inequalities = points); \
    output r[1 .. n] [m]: spline(order = 5, intervals = 4); param w[n] = (1, 2, 3) [1/(m*s)]; param a[n] = 1 [m]; \
    minimize integral(norm(der(r, 2))^2) * 1 [s^3/m^2];";

#[test]
fn each_element_is_missed_by_its_own_amount() {
    same(
        FLEET,
        "trajectory { for i in 1 .. n { soft(w[i]): near: r[i] <= a[i]; } }",
        "output near_miss[1 .. n] [m]: spline(order = 3, intervals = 4, smoothness = 0); \
         trajectory { for i in 1 .. n { near_miss[i] >= 0; }  for i in 1 .. n { near: r[i] - near_miss[i] <= a[i]; } } \
         minimize near: sum(i in 1 .. n, w[i] * integral(near_miss[i]));",
    );
    let kernels = |text: &str| program(&format!("problem P {{ {FLEET} {text} }}")).kernels.len();
    let by_index = kernels("final { for i in 1 .. n { soft(5 [1/m]): r[i] <= a[i]; } }");
    assert_eq!(kernels("final { soft(5 [1/m]): r <= a; }"), by_index);
}

#[test]
fn a_triangle_of_indices_is_made_row_by_row() {
    let text =
        "trajectory { for i in 1 .. n - 1 { for j in i + 1 .. n { soft(2 [1/(m*s)]): gap: r[i] - r[j] >= 1 [m]; } } }";
    let program = program(&format!("problem P {{ {FLEET} {text} }}"));
    let outputs: Vec<(&str, i64)> = program.structure.phases[0].outputs[1..]
        .iter()
        .map(|output| (output.name.as_str(), output.family.map_or(0, |family| family.last)))
        .collect();
    assert_eq!(outputs, [("gap_miss_1", 2), ("gap_miss_2", 1)]);
}

#[test]
fn every_phase_has_its_own_part_of_one_amount() {
    let text = "collocation gauss(points = 3); output x [m]: spline(order = 5, intervals = 4); minimize integral(x^2) * 1 [1/(m^2*s)]; \
        phase a { duration in 1 .. 2 [s]; } phase leg[i in 1 .. 3] after a { duration in 1 .. 2 [s]; } \
        trajectory { soft(2 [1/(m*s)]): low: x >= 1 [m]; } initial { x == 0; }";
    let program = program(&format!("problem P {{ {text} }}"));
    let names: Vec<Vec<&str>> = program
        .structure
        .phases
        .iter()
        .map(|phase| phase.outputs.iter().map(|output| output.name.as_str()).collect())
        .collect();
    assert_eq!(names, [["x", "low_miss"], ["x", "low_miss"]]);
    assert_eq!(program.structure.terms.len(), 3);
}

#[test]
fn what_is_missed_takes_a_name_that_is_free() {
    let text =
        "param rail_miss = 3; trajectory { soft(w): rail: p <= 2 [m];  soft(w): p >= -2 [m];  soft(w): p >= -3 [m]; }";
    let program = program(&format!("problem P {{ {CART} {text} }}"));
    let names: Vec<&str> = program.structure.phases[0].outputs[2..].iter().map(|output| output.name.as_str()).collect();
    assert_eq!(names, ["rail_miss_2", "miss", "miss_2"]);
}

#[test]
fn soft_stays_a_name_without_parenthesis_and_colon() {
    let text = "fn soft(a) = a * 2; trajectory { soft: p <= 2 [m];  soft(p) <= 3 [m];  soft(w): soft: p >= -3 [m]; }";
    let found = findings(&format!("problem P {{ {CART} {text} initial {{ p == 0; }} }}"));
    // Who names a constraint so may have forgotten its price.
    assert_eq!((found.matches("note[N011]").count(), found.matches("error").count()), (1, 0), "{found}");
}

#[test]
fn members_before_and_behind_a_condition_on_their_index_are_missed_each_by_itself() {
    let program = program(
        "problem P { duration T = 1; output x[1 .. 5]: spline(order = 4, intervals = 2); minimize integral(x[1]^2); \
         final { for i in 1 .. 5 { soft(1): low: x[i] >= if i == 3 { 1 } else { 2 }; } } }",
    );
    let members =
        |variable: &ntg_structure::Variable| variable.family.map_or(1, |family| family.last - family.first + 1);
    assert_eq!(program.structure.variables.iter().map(members).sum::<i64>(), 5);
}
