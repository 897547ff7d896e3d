//! Helps that can be followed: what a message proposes, the compiler takes, and it is what was meant.

use crate::model_support::{Files, findings_with};

/// A problem with a text in it.
fn problem(text: &str) -> String {
    format!("problem P {{\n{text}\n}}\n")
}

/// The findings of a problem with a text in it.
#[track_caller]
fn told(text: &str) -> String {
    findings_with(&problem(text), &Files(vec![]))
}

/// How many errors are told.
fn errors(told: &str) -> usize {
    told.lines().filter(|line| line.starts_with("error[")).count()
}

/// Holds findings against their first line, the place of the first one and its help.
#[track_caller]
fn says(told: &str, message: &str, place: &str, help: &str) {
    let first = told.strip_prefix("not even parsed:\n").unwrap_or(told);
    assert!(first.starts_with(message), "{told}");
    let arrow = told.lines().find_map(|line| line.trim_start().strip_prefix("--> ")).unwrap_or_default();
    assert_eq!(arrow, place, "{told}");
    assert!(told.contains(&format!("= help: {help}\n")) || told.ends_with(&format!("= help: {help}")), "{told}");
}

const MOVING: &str =
    "    duration T = 5 [s];\n    output x [m]: spline(order = 5, intervals = 4);\n    minimize integral(der(x, 2)^2);";

#[test]
fn a_unit_keeps_its_prefix() {
    let pairs = [
        ("mOhm", "mohm"),
        ("MOhm", "Mohm"),
        ("mΩ", "mohm"),
        ("kΩ", "kohm"),
        ("m\u{2126}", "mohm"),
        ("Ω", "ohm"),
        ("mHZ", "mHz"),
        ("MHZ", "MHz"),
        ("mpa", "mPa"),
        ("Mpa", "MPa"),
        ("mwh", "mWh"),
        ("pWH", "pWh"),
        ("KG", "kg"),
        ("kNm", "kN*m"),
        ("msec", "ms"),
        ("hours", "h"),
        ("minutes", "min"),
        ("days", "day"),
        ("Newton", "N"),
        ("miles", "mi"),
        ("Watt", "W"),
    ];
    for (written, meant) in pairs {
        let text = format!("{MOVING}\n    param a = 3 [{written}];");
        let help = format!("did you mean `{meant}`?");
        says(&told(&text), "error[E040]: unknown unit `", "spec.ntg:5:18", &help);
        assert_eq!(told(&text.replace(&format!("[{written}]"), &format!("[{meant}]"))), "", "{meant}");
    }
}

#[test]
fn no_help_proposes_a_unit_with_a_root() {
    let root = "what is raised to the power 1/7 has the unit [m]; without it write";
    let text = format!("{MOVING}\n    let wind [m/s] = der(x) * (x / 10)^(1/7);");
    let message = "error[E044]: `wind` is declared as a speed [m/s], but it is a quantity in [m^(8/7)/s]";
    says(&told(&text), message, "spec.ntg:5:14", &format!("{root} `x / 10 [m]`"));
    assert_eq!(told(&text.replace("x / 10", "x / 10 [m]")), "");
    let roots = [
        ("let a = x^(1/7) + 1;", format!("{root} `x / 1 [m]`")),
        ("let a [m] = sqrt(x);", root.replace("1/7", "1/2") + " `x / 1 [m]`"),
        ("let a = exp(x^(1/7));", format!("{root} `x / 1 [m]`")),
        ("let b = x^(1/7);  let a [m] = 2 * b;", format!("{root} `x / 1 [m]`")),
    ];
    for (written, help) in roots {
        let told = told(&format!("{MOVING}\n    {written}"));
        assert!(told.ends_with(&format!("= help: {help}")), "{told}");
    }
}

#[test]
fn missing_nodes_are_as_many_as_columns() {
    let table = |rows: &str| format!("{MOVING}\n    table polar(a [deg], w [m/s]) = linear {{ {rows} }}");
    let few = told(&table("0: 1, 1, 1;  30: 2, 3, 3;"));
    let help = "write them first, in a row of their own, one for each of 3 columns: `w_1, w_2, w_3;`";
    says(&few, "error[E071]: the nodes of `w` are missing", "spec.ntg:5:44", help);
    let many = told(&table("0: 1, 1, 1, 2, 2, 2;  30: 2, 3, 3, 4, 4, 4;"));
    assert!(many.contains("one for each of 6 columns: `w_1, w_2, ..., w_6;`"), "{many}");
}

/// A body that turns, whose attitude took its unit from the rates.
const TURNING: &str =
    "    duration T = 5 [s];\n    state q[4], w[3] [deg/s];\n    collocation gauss(points = 3, intervals = 4);
    minimize integral(norm(w)^2);\n    dynamics { der(q) == 0.5 * q / 1 [s];  der(w) == 1 [deg/s^2] * q[1:3]; }
    initial { q == (1, 0, 0, 0); }";

#[test]
fn a_unit_from_another_name_of_the_list_is_told() {
    let help = "`q` took [deg/s] from `w`; write `q[4] [1], w[3] [deg/s]`";
    let whole = TURNING.replace("q[1:3]", "(q[1], q[2], q[3])");
    // Several clashes, one of them of `q` by itself: one mistake, told where it was made.
    let found = told(&whole);
    says(
        &found,
        "error[E096]: `q` takes the unit [deg/s] of the list",
        "spec.ntg:3:11",
        "write the unit that is meant: `q[4] [1]`",
    );
    assert_eq!(found.matches("error[").count(), 1, "{found}");
    // One alone may be the equation's.
    let found = told(&whole.replace("initial { q == (1, 0, 0, 0); }", "initial { q == 0; }"));
    assert!(found.contains("error[E041]") && !found.contains("E096") && !found.contains("* 1 [deg/s]`"), "{found}");
    assert_eq!(told(&whole.replace("q[4],", "q[4] [1],")), "");
    // Inside a library of the language the call is the place, and the library stands behind.
    let with = whole.replace("initial { q == (1, 0, 0, 0); }", "trajectory { rotation::matrix(q)[1, 1] >= 0; }");
    let with = with.replace("trajectory { rotation::matrix(q)[1, 1] >= 0; }", "let R = rotation::matrix(q);");
    let spec = format!("use std::rotation;\n{}", problem(&with));
    let found = findings_with(&spec, &Files(vec![]));
    let first = found.split("\n\n").find(|one| one.contains("rotation::matrix")).unwrap_or_default();
    says(first, "error[E041]: ", "spec.ntg:8:13", help);
    assert!(first.contains("::: std::rotation:"), "{first}");
}

#[test]
fn a_library_of_the_language_is_not_to_be_mended() {
    let spec = format!("use std::rotation;\n{}", problem(&format!("{MOVING}\n    let R = rotation::about_x(x);")));
    let found = findings_with(&spec, &Files(vec![]));
    let help = "give this function arguments of the units that its body needs";
    says(&found, "error[E042]: `cos` takes a pure number, this is a length [m]", "spec.ntg:6:13", help);
    assert!(found.contains("::: std::rotation:"), "{found}");
    assert_eq!(errors(&found), 1, "{found}");
}

#[test]
fn a_missing_library_is_told_once() {
    let text = "    duration T = 5 [s];\n    state q[4] [1], w[3] [1/s];
    collocation gauss(points = 3, intervals = 4);
    minimize integral(norm(w)^2);\n    let b = transpose(rotation::matrix(q)) * w;
    dynamics { der(q) == rotation::rate(q, w);  der(w) == b / 1 [s]; }";
    let missing = told(text);
    says(
        &missing,
        "error[E024]: unknown function `rotation::",
        if missing.contains("matrix`") { "spec.ntg:6:23" } else { "spec.ntg:7:26" },
        "write `use std::rotation;` before the problem",
    );
    assert_eq!(errors(&missing), 1, "{missing}");
    let short = findings_with(&format!("use rotation;\n{}", problem(text)), &Files(vec![]));
    says(&short, "error[E087]: there is no library `rotation`", "spec.ntg:1:5", "write `use std::rotation;`");
    assert_eq!(errors(&short), 1, "{short}");
    let right = findings_with(&format!("use std::rotation;\n{}", problem(text)), &Files(vec![]));
    assert_eq!(right, "");
    // What is not there has no size either.
    let unknown = told(&format!("{MOVING}\n    let a = transpose(turned(x)) * norm(twisted(x));"));
    assert!(!unknown.contains("E046"), "{unknown}");
    let constants = told(&format!("{MOVING}\n    let a = constants::g0 * x;  let b = constants::g0 / x;"));
    assert_eq!(errors(&constants), 1, "{constants}");
}

#[test]
fn a_forgotten_derivative_is_told() {
    let text = "    duration T = 5 [s];\n    state el [deg], v [m/s];\n    input a [m/s^2];
    collocation gauss(points = 3, intervals = 4);
    minimize integral(a^2);\n    dynamics { el == 2 [deg/s];  der(v) == a; }";
    let help = "write the derivative of the state: `der(el) == ...`";
    says(&told(text), "error[E041]: a pure number cannot be compared with a rate [1/s]", "spec.ntg:7:16", help);
    let turned = told(&text.replace("el == 2 [deg/s]", "el == 2 [deg/s^2]"));
    assert!(turned.contains("write the second derivative of the state: `der(el, 2) == ...`"), "{turned}");
    // Of an input there is none to forget.
    let input = told(&text.replace("der(v) == a", "a == v"));
    assert!(!input.contains("der(a)"), "{input}");
}

/// A problem in hours, with states and an input, whose equations may be replaced.
const DAY: &str = "    duration T = 10 [h];\n    state x [m], y[3] [m];\n    input u: held;
    collocation gauss(points = 3, intervals = 20);
    minimize integral(u^2);\n    dynamics { der(x) == 1 [m/h];  der(y) == (1, 1, 1) [m/h]; }";

/// What is told of a day with a statement more, which stands on line 8.
#[track_caller]
fn of_day(statement: &str) -> String {
    told(&format!("{DAY}\n    {statement}"))
}

#[test]
fn an_element_without_an_equation_is_named() {
    let with = |equations: &str| told(&DAY.replace("der(y) == (1, 1, 1) [m/h];", equations));
    let cases = [
        ("der(y[2 .. 3]) == (1, 1) [m/h];", "y[1]"),
        ("der(y[1]) == 1 [m/h];  der(y[3]) == 1 [m/h];", "y[2]"),
        ("for i in 1 .. 2 { der(y[i]) == 1 [m/h]; }", "y[3]"),
        ("for i in 1 .. 2 { der(y[4 - i]) == 1 [m/h]; }", "y[1]"),
    ];
    for (equations, name) in cases {
        let message = format!("error[E068]: 3 equations for 4 elements of states: `{name}` has none");
        let help = "write `dynamics { der(x) == ...; }`; what is chosen freely is an `input`";
        says(&with(equations), &message, "spec.ntg:3:18", help);
    }
    let matrix = DAY.replace("y[3] [m]", "y[2, 2] [m]");
    let matrix = told(&matrix.replace("der(y) == (1, 1, 1) [m/h];", "for i in 1 .. 2 { der(y[i, i]) == 1 [m/h]; }"));
    assert!(matrix.contains("3 equations for 5 elements of states: `y[1, 2]` has none"), "{matrix}");
}

#[test]
fn the_order_of_a_derivative_is_told_once() {
    let found = told(&DAY.replace("der(x)", "der(x, t)"));
    let message = "error[E064]: a derivative is with respect to time without saying so, `t` stands for its order";
    says(&found, message, "spec.ntg:7:23", "write `der(x)`, `der(x, 2)`");
    assert_eq!(errors(&found), 1, "{found}");
}

#[test]
fn one_value_for_each_index_is_a_family() {
    let family = of_day("let g[1 .. 3] = 3;");
    let help = "a value for each index is written `let g[i in 1 .. 3] = 3;`";
    says(&family, "error[E046]: the shapes do not fit: `g` has 3 elements, `3` is a number", "spec.ntg:8:9", help);
    assert_eq!(of_day("let g[i in 1 .. 3] = 3;"), "");
}

#[test]
fn a_name_is_told_once_in_a_statement() {
    let found = of_day("trajectory { y[i + 2] - y[i] >= 0; }");
    assert!(found.starts_with("error[E020]: unknown name `i`\n --> spec.ntg:8:20"), "{found}");
    assert_eq!(errors(&found), 1, "{found}");
    assert_eq!(errors(&of_day("trajectory { y[i] >= 0;  x >= y[i]; }")), 2);
}

#[test]
fn a_part_of_the_time_stands_in_place_of_a_condition() {
    let habit = "an `if` is a value and holds no constraints: ";
    let part = "write `trajectory from 6 [h] { ... }`";
    let bounds = of_day("trajectory { if t >= 6 [h] { x in 0 .. 5 [m]; }  x >= 0; }");
    says(&bounds, "error[E001]: expected an operator or `}`, found `in`", "spec.ntg:8:36", &format!("{habit}{part}"));
    let below = of_day("trajectory { if t <= 6 [h] { x <= 5 [m]; } }");
    assert!(below.contains("write `trajectory to 6 [h] { ... }`"), "{below}");
    assert_eq!(of_day("trajectory from 6 [h] { x in 0 .. 5 [m]; }"), "");
    assert_eq!(of_day("trajectory to 6 [h] { x <= 5 [m]; }"), "");
    let other = of_day("trajectory { if x >= 6 [m] { u <= 5; } }");
    assert!(other.contains("over a part of the time write `trajectory from a to b { ... }`, or a phase"), "{other}");
}

#[test]
fn a_value_that_has_a_unit_gets_no_second_one() {
    for (text, help) in [
        ("param a [deg] = 1;", "write `param a = 1 [deg];`"),
        ("param a [deg] = 1 [rad];", "write `param a = 1 [rad];`"),
        ("param a [m/s] = 36 [km/h];", "write `param a = 36 [km/h];`"),
        ("param k[2] = (1, 2); param a [deg] = k[2];", "write `param a = k[2] [deg];`"),
    ] {
        assert!(told(text).contains(help), "{}", told(text));
    }
}

#[test]
fn words_without_names_are_helped() {
    let cases = [("periodic;", "periodic x, y;"), ("continuous;", "continuous x up to 1;"), ("jump;", "jump x, y;")];
    for (written, meant) in cases {
        let found = of_day(written);
        assert!(found.contains("error[E001]: expected ") && found.contains(", found `;`\n --> spec.ntg:8:"), "{found}");
        assert!(found.contains(&format!(": `{meant}`")), "{found}");
    }
}

#[test]
fn means_and_interpolants_are_helped() {
    let found = of_day("let m = mean(x);");
    let help = "over the whole time write `integral(x) / T`; of elements `sum(i in 1 .. n, x[i]) / n`";
    says(&found, "error[E024]: unknown function `mean`", "spec.ntg:8:13", help);
    let found = told(&format!("{DAY}\n    let m = average(x);").replace("duration T", "duration day"));
    assert!(found.contains("`integral(x) / day`"), "{found}");
    assert_eq!(of_day("temporal { integral(x) / T <= 90 [m]; }"), "");
    let found = of_day("let m = interp2(x, u);");
    let help = "write `table f(x, y) = linear { ... }` in the problem, and here `f(x, y)`";
    says(&found, "error[E024]: unknown function `interp2`", "spec.ntg:8:13", help);
}

#[test]
fn times_are_told_in_the_unit_of_the_spec() {
    let scenario = "    collocation gauss(points = 3, intervals = 4);\n    scenario c[k in 1 .. 3] {
        state x [m];\n        input u [m/s]: held;\n        shared u until 1.3 [h];
        dynamics { der(x) == u * k; }\n        initial { x == 0; }\n        minimize integral(u^2);\n    }";
    let found =
        told(&format!("    duration T = 10 [h];\n{}", scenario.replace("        minimize integral(u^2);\n", "")));
    assert!(found.contains("the nearest ends are 0 [h] and 2.5 [h]"), "{found}");
    let bare = of_day("start = 3;");
    assert!(bare.contains("give it a unit: `3 [h]`"), "{bare}");
}

#[test]
fn nodes_are_told_as_they_are_written() {
    let even = of_day("table f(a even [deg]) = linear { -30: 1;  0: 1; }");
    let message = "error[E073]: `f`: `a` is even, so its nodes must not be negative, but the first one is -30 [deg]";
    says(&even, message, "spec.ntg:8:13", "leave the negative nodes out: `even` mirrors the others");
    assert!(even.contains("--- the first node"), "{even}");
    let second = of_day("table f(b, a even [deg]) = linear { -30, 0;  0: 1, 2;  1: 1, 3; }");
    assert!(second.contains("`a` is even") && second.contains("--- the first node"), "{second}");
    let open = of_day("table f(a periodic [h]) [km] = linear { 0: 1;  12: 3;  24: 2; }");
    assert!(open.contains("but they are 1 [km] and 2 [km]") && open.contains("the last node"), "{open}");
}

#[test]
fn arguments_that_say_two_things_are_told_apart() {
    let with = |text: &str| told(&format!("{MOVING}\n    fn f(a, b) = a^3 * b;\n    {text}"));
    says(
        &with("let p = partial(f(x, x), x);"),
        "error[E063]: `x` is more than one argument of `f(x, x)`",
        "spec.ntg:6:30",
        "name the argument as it is declared: `a` or `b`; the derivative by both is the sum of the two",
    );
    assert_eq!(errors(&with("let p = partial(f(x, x), a) + partial(f(x, x), b);")), 0);
    assert!(with("let p = atan(x, 2 [m]);").contains("= help: the angle of a point is `atan2(y, x)`"));
}

#[test]
fn words_and_quotes_of_other_languages_are_led_to_ours() {
    let begins = [
        ("measurements { x == 1 [m] sigma 1 [m]; }", "what was measured stands in `measure { }`"),
        ("use std::rotation;", "libraries stand before the problem: `use std::constants;`"),
    ];
    for (text, help) in begins {
        let found = told(&format!("{MOVING}\n    {text}"));
        assert!(found.contains(&format!("= help: {help}")), "{found}");
    }
    let quoted = told(&format!("{MOVING}\n    param seen[2] [m] from 'tank.csv' column 2;"));
    says(
        &quoted,
        "error[E008]: `'` is not part of the language",
        "spec.ntg:5:28",
        "a string stands in double quotes: `\"tank.csv\"`",
    );
    assert_eq!(errors(&quoted), 1, "{quoted}");
    // A prime behind a name is a derivative still.
    let prime = told(&format!("{MOVING}\n    initial {{ x' == 0 [m/s]; }}  final {{ x' == 0 [m/s]; }}"));
    assert!(prime.contains("write `der(x)` for the derivative"), "{prime}");
}

#[test]
fn characters_that_nobody_sees_are_named_and_to_be_removed() {
    for (c, name) in [('\0', "U+0000"), ('\u{200b}', "U+200B"), ('\u{feff}', "U+FEFF"), ('\u{202e}', "U+202E")] {
        let found = told(&format!("{MOVING}\n    {c}param a = 1;"));
        let message = format!("error[E008]: the character {name} is not part of the language");
        says(&found, &message, "spec.ntg:5:5", "remove it");
    }
}

#[test]
fn a_unit_behind_a_quotient_belongs_to_the_divisor() {
    let curve = |range: &str| told(&format!("{MOVING}\n    variable k in {range};"));
    let help = "a unit belongs to the number before it, here to 300 alone: write `1 [1/m] / 300`";
    says(&curve("-1/300 .. 1/300 [1/m]"), "error[E041]: ", "spec.ntg:5:19", help);
    assert_eq!(errors(&curve("-1 [1/m] / 300 .. 1 [1/m] / 300")), 0);
    let start = told(&format!("{MOVING}\n    initial {{ der(x) == 1/2 [m/s]; }}"));
    says(
        &start,
        "error[E041]: ",
        "spec.ntg:5:15",
        "a unit belongs to the number before it, here to 2 alone: write `1 [m/s] / 2`",
    );
}

#[test]
fn what_is_measured_is_minimised_as_a_pure_number() {
    let measuring = "    duration T = 5 [s];\n    output x [m]: spline(order = 5, intervals = 4);
    measure { at(2 [s], x) == 3 [m] sigma 1 [cm]; }\n    ";
    let both = told(&format!("{measuring}maximize final(x) / 1 [m];"));
    let help = "a problem with `measure` is minimised: change the sign of the term and write `minimize`";
    says(&both, "error[E061]: a problem is minimised or maximised, not both", "spec.ntg:5:5", help);
    let help = "beside `measure` the objective is a pure number: divide its other terms, `e / 1 [m]`";
    let length = told(&format!("{measuring}minimize final(x);"));
    says(&length, "error[E041]: a length [m] cannot be added to a pure number", "spec.ntg:5:14", help);
    assert_eq!((errors(&both), errors(&length)), (1, 1));
    assert_eq!(told(&format!("{measuring}minimize final(x) / 1 [m];")), "");
}

#[test]
fn the_time_of_all_members_is_not_held_against_the_bounds_of_one() {
    let text = "    duration T in 2 .. 30 [s];\n    output x [m]: spline(order = 5, intervals = 1, smoothness = 3);
    phase leg[i in 1 .. 3] after leg[i - 1] { duration in 0.2 .. 5 [s]; }\n    minimize T;
    initial { x == 0;  der(x) == 0; }\n    final { x == 5 [m]; }\n    trajectory { der(x, 2) in -1 .. 1 [m/s^2]; }";
    assert_eq!(told(&format!("{text}\n    guess {{ T = 10 [s]; }}")), "");
    let member = told(&format!("{text}\n    guess {{ duration(leg[2]) = 10 [s]; }}"));
    assert!(member.starts_with("note[N010]: `duration(leg[2])` is guessed above its upper bound"), "{member}");
}

#[test]
fn ends_of_functions_of_time_are_written_as_the_helps_say() {
    for right in
        ["initial { initial(x) == 0;  x == 0; }", "final { final(x) == 0; }", "temporal { at(T / 2, x) == 0; }"]
    {
        let findings = told(&format!("{MOVING}\n    {right}"));
        assert_eq!(errors(&findings), 0, "{findings}");
    }
    let text = format!("{MOVING}\n    let d = a / 2;\n    let b = d2 / 3;");
    assert!(!told(&text).contains("der("), "{}", told(&text));
}

#[test]
fn a_size_of_zero_is_told_once_where_it_is_declared() {
    for declaration in ["state z[0] [m];", "output z[0] [m]: spline(order = 5, intervals = 4);", "param z[0] = 1;"] {
        let told = told(&format!("{MOVING}\n    {declaration}\n    let w = z;"));
        let column = declaration.find('0').expect("a size") + 5;
        let help = "a vector is declared with how many elements it has, `[3]`, which are counted from 1; one number is \
                    declared without a size";
        says(&told, "error[E028]: a size of 0: there are no elements", &format!("spec.ntg:5:{column}"), help);
        assert_eq!(errors(&told), 1, "{told}");
    }
}

#[test]
fn points_of_a_route_that_are_wrong_in_one_way_are_one_mistake() {
    let of = |points: &str| {
        told(&format!(
            "{MOVING}\n    output y [m]: spline(order = 5, intervals = 4);\n    guess {{ (x, y) through {points} [m]; }}"
        ))
    };
    let help = "give each point one coordinate for each output";
    let told = of("0, 1");
    says(&told, "error[E017]: this point has one coordinate, the route has 2 outputs", "spec.ntg:6:28", help);
    assert_eq!(errors(&told), 1, "{told}");
    assert_eq!(errors(&of("0, (1, 2, 3), 4, (1, 2), (4, 5, 6)")), 2);
}

#[test]
fn the_help_of_a_fork_names_the_last_member_of_a_family() {
    let of = |first: &str| {
        let phases = format!(
            "output x [m]: spline(order = 5, intervals = 4);\n phase {first} {{ duration = 1 [s]; }}\n \
             phase c after q {{ duration = 1 [s]; }}\n phase q {{ duration = 1 [s]; }}"
        );
        told(&format!("const n = 3;\n {phases}\n minimize integral(der(x, 2)^2);"))
    };
    let family = of("p[i in 1 .. n] after p[i - 1]");
    assert!(family.contains("write `phase q after p[n]`, or start another agent"), "{family}");
    assert!(
        !told(
            "const n = 3; output x [m]: spline(order = 5, intervals = 4); phase p[i in 1 .. n] after p[i - 1] { \
        duration = 1 [s]; } phase q after p[n] { duration = 1 [s]; } minimize integral(der(x, 2)^2);"
        )
        .contains("error")
    );
    let single = of("p");
    assert!(single.contains("write `phase q after p`, or start another agent"), "{single}");
}

#[test]
fn a_negative_size_is_told_as_it_is() {
    let found = told(&format!("const n = -1;  param goal[n] = (1, 2, 3) [m];\n{MOVING}"));
    assert!(found.contains("`goal` has the size -1, but its default has 3"), "{found}");
    assert!(found.contains("= help: a size is a whole number, and not negative"), "{found}");
}

#[test]
fn the_manual_says_which_code_a_habit_of_other_languages_has() {
    use ntg_compiler::diagnostic::Code;
    let entry = |code: Code| code.manual().to_owned();
    for (text, code, written) in [
        ("let a = if x <= 1 [m] and x >= 0 { 1 } else { 2 };", Code::Unexpected, "`if a <= 1 and b <= 1`"),
        ("let a = if not x <= 1 [m] { 1 } else { 2 };", Code::Unexpected, "`if not a <= 1`"),
        ("let a = 3(x + 1 [m]);", Code::Unexpected, "`3(x + 1)`"),
        ("let y = 2;  let a = x(y + 1);", Code::NoFunction, "`x(y + 1)`"),
        ("let a = der(x, 1.5);", Code::NotWhole, "orders"),
        ("let a = der(x, 33);", Code::WrongOrder, "from 0 to 32"),
    ] {
        let found = told(&format!("{MOVING}\n{text}"));
        assert!(found.contains(&format!("error[{}]", code.text())), "{text}:\n{found}");
        assert!(entry(code).contains(written), "{text}: the entry of {} lacks {written}", code.text());
    }
    assert!(!entry(Code::WrongRelation).contains(" and "), "a relation with `and` has E001");
}
