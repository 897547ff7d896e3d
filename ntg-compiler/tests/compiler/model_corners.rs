//! Corners of the objective are not noted where helpers stand for them; derivatives that miss the jumps of what they are
//! taken of are refused.

use crate::model_support::findings;

const BLOCK: &str = "duration T = 3; state x, v; collocation gauss(points = 3, intervals = 5); \
    dynamics { der(x) == v; der(v) == u; } initial { x == 1; }";

#[track_caller]
fn said(rest: &str) -> Vec<String> {
    let text = format!("problem P {{ {BLOCK} {rest} }}");
    let found = findings(&text);
    let heads = found.lines().filter_map(|line| {
        let (code, message) = line.strip_prefix("error[").or_else(|| line.strip_prefix("note["))?.split_once("]: ")?;
        Some(format!("{code}: {message}"))
    });
    heads.collect()
}

/// The first help.
#[track_caller]
fn help(text: &str) -> String {
    let found = findings(text);
    let help = found.lines().find_map(|line| line.trim().strip_prefix("= help: "));
    help.unwrap_or_default().to_owned()
}

#[test]
fn a_corner_that_is_gone_is_not_noted() {
    const NOTE: &str = "N001: the gradient of `abs` may jump here";
    assert_eq!(said("input u; minimize integral(abs(u));"), [""; 0]);
    assert_eq!(said("input u; let f = abs(u); minimize integral(f) + max(final(x), 0);"), [""; 0]);
    assert_eq!(said("input u; minimize integral(u^2); trajectory { abs(u) <= 1; }"), [""; 0]);
    assert_eq!(said("input u; let f = abs(u); minimize integral(f); trajectory { f <= 1; }"), [""; 0]);
    assert_eq!(said("input u; minimize integral(u^2); temporal { integral(abs(u)) <= 1; }"), [""; 0]);
    assert_eq!(said("input u; minimize integral(abs(u - sin(3 * t)));"), [""; 0]);
    assert_eq!(said("input u; minimize integral(abs(u * v) + max(0, x^2 - v));"), [""; 0]);
    assert_eq!(said("input u; minimize integral(if u * v >= 0 { 2 * u * v } else { u * v });"), [""; 0]);
    assert_eq!(
        said("input u; minimize integral(if u <= 0 { 0.6 * (2 + sin(t)) * u } else { (2 + sin(t)) * u });"),
        [""; 0]
    );
    assert_eq!(said("table f(p) = linear { 0: 0; 1: 1; 2: 3; } input u in 0 .. 2; minimize integral(f(u));"), [""; 0]);
    assert_eq!(said("input u; minimize integral(u^2); trajectory { abs(u) >= 1; }"), [NOTE]);
    // Branches that do not meet, and those that are met by the larger slope below.
    assert_eq!(said("input u; minimize integral(if u >= 0 { u } else { 1 });").len(), 1);
    // A corner within that is pushed away from its corner is left.
    assert!(
        !said("input u[3]; minimize integral(u[1]^2); trajectory { sum(i in 1 .. 3, abs(u[i]) - abs(v)) <= 1; }")
            .is_empty()
    );
    // Beyond 3 it is another function, which no point near 1 tells.
    assert!(!said("input u; minimize integral(if u >= 0 { u * max(v, 3) / 3 } else { 0 });").is_empty());
    assert!(!said("input u; minimize integral(if u >= 0 { if v >= 3 { 5 } else { u } } else { 0 });").is_empty());
    assert!(!said("input u; minimize integral(if u >= 0 { u + exp(-1000 * v^2) } else { 0 });").is_empty());
    assert_eq!(said("input u in -1 .. 1; minimize integral(if u >= 0 { u } else { 2 * u });").len(), 1);
    assert_eq!(said("input u; minimize integral(u^2); trajectory { (1 + u) * abs(u) <= 1; }"), [NOTE]);
    assert_eq!(said("input u in -1 .. 1; maximize integral(abs(u));"), [NOTE]);
}

#[test]
fn a_derivative_that_misses_jumps_is_refused() {
    const LOST: &str = "E097: `u` may jump between intervals, and this derivative misses the jumps";
    assert_eq!(said("input u; minimize integral(der(u)^2);"), [LOST]);
    assert_eq!(said("input u; minimize integral(u^2); trajectory { der(u) in -1 .. 1; }"), [LOST]);
    assert_eq!(said("input u; let f = 2 * u; minimize integral(u^2); trajectory { der(f) <= 1; }"), [LOST]);
    assert_eq!(said("input u: continuous; minimize integral(der(u)^2);"), [""; 0]);
    // At an end there is one side alone, and one interval has no knots inside.
    assert_eq!(said("input u; minimize integral(u^2); final { der(u) == 0; }"), [""; 0]);
    assert_eq!(said("input u: spline(order = 4, intervals = 1); minimize integral(der(u)^2);"), [""; 0]);
    // The highest derivative of a state jumps, as it may.
    assert_eq!(said("input u; minimize integral(u^2 + der(v)^2);"), [""; 0]);
    assert_eq!(
        said("input u; minimize integral(der(x, 2)^2);"),
        ["E097: the derivative of `x` may jump between intervals, and this derivative misses the jumps"]
    );
}

#[test]
fn the_least_change_is_said() {
    let help = |rest: &str| help(&format!("problem P {{ {BLOCK} {rest} }}"));
    assert_eq!(help("input u; minimize integral(der(u)^2);"), "declare it `input u: continuous`, which does not jump");
    assert_eq!(
        help("input u: spline(order = 4, intervals = 5, smoothness = 1); minimize integral(der(u, 2)^2);"),
        "declare `u: spline(order = 4, smoothness = 2, ...)`, whose derivative of order 1 does not jump"
    );
}

#[test]
fn a_size_that_is_read_as_a_unit() {
    let text = "problem P { const N = 3; duration T = 1; state y[N]; collocation gauss(points = 3, intervals = 5); \
        minimize sum(i in 1 .. N, integral(y[i]^2)); dynamics { for i in 1 .. N { der(y[i]) == -y[i]; } } }";
    let found = findings(text);
    assert!(found.contains("error[E026]") && !found.contains("error[E044]"), "{found}");
    assert!(found.contains("help: `y[N]` is read as a quantity in N; as a size write `y[1 .. N]`"), "{found}");
}

#[test]
fn a_corner_where_a_factor_vanishes_is_none() {
    let with = |drag: &str| {
        said(&format!("param k = 0.1; input u; minimize integral(u^2); trajectory {{ {drag} + u in -9 .. 9; }}"))
    };
    for smooth in [
        "abs(v) * v",
        "0.1 * abs(v) * v",
        "k * v * abs(v) / 2",
        "abs(k * v) * v^3",
        "abs(v - x) * (x - v)",
        "abs(v)^3",
        "abs(v)^1.5",
        "max(0, v - x)^2",
        "max(v, 0) * v * (1 + x)",
        "max(v, x) * sin(v - x)",
        "abs(v) * max(v, 0)",
        "sign(v) * v^2",
        "v * exp(-abs(v))",
        "v / (1 + abs(v))",
        "(k + abs(v)) * tanh(v)",
        "(if x <= 0 smooth 0.1 { abs(v) } else { 2 * abs(v) }) * v",
    ] {
        assert_eq!(with(smooth), [""; 0], "{smooth}");
    }
    for corner in [
        "abs(v)",
        "abs(v) * x",
        "abs(v) * (1 + v)",
        "v / abs(v)",
        "abs(v) / v",
        "abs(v)^0.5 * x",
        "max(v, x) * v",
        "max(v, x)^2",
        "max(1, v)^2",
        "sign(v) * v",
        "sqrt(abs(v)) * v",
        "abs(v) * v + abs(v)",
        "abs(abs(v) - 1) * v",
        "1 / (1 + abs(v)) + abs(v) * v",
    ] {
        assert!(!with(corner).is_empty(), "{corner}");
    }
    // What is only shown is judged by itself, what is used where it is used.
    assert_eq!(said("input u; let a = abs(v); minimize integral(u^2); trajectory { a * v + u <= 9; }"), [""; 0]);
    assert_eq!(said("input u; let a = abs(v) * v; minimize integral(u^2);"), [""; 0]);
    assert_eq!(said("input u; let a = abs(v); minimize integral(u^2);").len(), 1);
    // Its derivative by time is none of its kind.
    let rate = said("input u; minimize integral(u^2); trajectory { der(abs(v) * v) + u <= 9; }");
    assert!(rate.iter().any(|note| note.starts_with("N001")), "{rate:?}");
}

/// Equations with corners have a form without; what stays is noted.
#[test]
fn corners_of_equations_are_gone() {
    let equation =
        |rate: &str| said(&format!("state m; input u; minimize integral(u^2); dynamics {{ der(m) == {rate}; }}"));
    for rate in [
        "-abs(u)",
        "min(0.9 * u, u / 0.9)",
        "0.9 * max(u, 0) - max(-u, 0) / 0.9",
        "if u >= 0 { 0.9 * u } else { u / 0.9 }",
        "-abs(u) / (1 + m^2) + v * max(0, u * v)",
        "max(u, v, m)",
        "-hypot(u, v)",
        "1 - abs(v)",
        "exp(-abs(u))",
        "1 / (1 + abs(u))",
        "min(1, max(-1, u))",
        "max(0, abs(u) - 0.3)",
        "if u >= 0 { 0.9 * u * v } else { u * v / 0.9 }",
        "if u >= 0 { u * v^2 } else { u }",
    ] {
        assert_eq!(equation(rate), [""; 0], "{rate}");
    }
    for rate in [
        "if u >= 0 { u * v } else { u * v + u^2 * v }",
        "max(0, sqrt(abs(u)))",
        "if u >= 0 { 1 } else { u }",
        "sqrt(abs(u))",
    ] {
        assert!(!equation(rate).is_empty(), "{rate}");
    }
    assert_eq!(said("input u; minimize integral(u^2); temporal { integral(abs(u)) == 1; }"), [""; 0]);
    assert_eq!(said("input u; variable b; minimize b; temporal { b == integral(abs(u)); }"), [""; 0]);
}
