//! Mistakes for the codes that no habit of another language leads to: a part of the table of `mistakes.rs`, in which
//! every code has an entry.

use crate::mistakes::sections;
use ntg_compiler::diagnostic::Code;

/// A section of the page: its title, what is written, and the code.
pub(crate) type Section = (&'static str, &'static [(&'static str, &'static str)]);

/// What the compiler refuses besides. What begins with `problem` is a whole spec.
pub(crate) const MEANING: Section = (
    "Names, scopes, splines and families",
    &[
        ("let a = (1 + 2;", "E003"),
        ("let a = 1);", "E004"),
        ("param a = 1e400;", "E007"),
        ("table drag(a) = linear from \"tables\\drag.csv\";", "E009"),
        ("guess { /// A straight line.\n    x = tau * 1 [m]; }", "E010"),
        ("param self = 1;", "E011"),
        ("trajectory { x <= y >= 0; }", "E014"),
        ("trajectory { for i in 1 ... 3 { r[i] >= 0; } }", "E015"),
        ("problem A { duration T = 1; } problem B { duration T = 1; }", "E019"),
        ("let a = 2 * half;", "E030"),
        ("param p[2] = (1, 2);  continuation p = (3, 2, 1);", "E033"),
        ("param k = 2;  let a = x^k;", "E043"),
        ("param a = 1 [km^99*km^99];", "E045"),
        ("minimize t / 1 [s];", "E051"),
        ("temporal { tau <= 1; }", "E051"),
        (
            "problem Two { output z: spline(order = 5, intervals = 2); minimize integral(z^2); phase a { duration = 1; \
             output w: spline(order = 5, intervals = 2); } phase b after a { duration = 1; trajectory { z <= a.w; } } }",
            "E053",
        ),
        ("output z: spline(order = 4, intervals = 2, smoothness = 4);", "E055"),
        ("problem Bare { duration T = 5; output z: spline(order = 4); minimize integral(z^2); }", "E055"),
        ("output z: spline(order = 4, knots = (0, 1, 2));", "E055"),
        ("input c: spline(order = 4, intervals = 0);", "E055"),
        ("variable z in 5 .. 1 [kg];", "E056"),
        ("trajectory { x in 10 .. -10 [m]; }", "E056"),
        (
            "final { der(x) == 0;  der(x, 2) == 0;  der(x, 3) == 0; }  initial { der(x) == 0;  der(x, 2) == 0;  \
             der(x, 3) == 0;  der(x, 4) == 0; }",
            "E058",
        ),
        ("problem Open { duration T = 5; output z: spline(order = 5, intervals = 2); initial { z == 1; } }", "E059"),
        ("maximize final(m) / 1 [kg];", "E061"),
        (
            "problem Many { duration T = 5; state z; collocation gauss(points = 65, intervals = 4); dynamics { der(z) == -z; } initial { z == 1; } }",
            "E062",
        ),
        (
            "problem Rule { duration T = 5; state z; collocation uniform(breakpoints = 41); dynamics { der(z) == -z; } initial { z == 1; } }",
            "E062",
        ),
        ("let a = partial(half(x), y);", "E063"),
        ("guess { x = 2 * y; }", "E065"),
        ("guess { limit = 3 [m/s]; }", "E065"),
        ("temporal { n <= 2; }", "E066"),
        ("problem Still { duration T in 1 .. 2; minimize T; }", "E067"),
        ("dynamics { der(r) == v;  der(v) == u / m;  m == 2 [kg]; }", "E069"),
        ("table drag(a) = monotone { 0: 1;  2: 3;  2: 4; }", "E070"),
        (
            "problem Round { output z: spline(order = 5, intervals = 2); minimize integral(z^2); phase a after b { duration = 1; } phase b after a { duration = 1; } }",
            "E081",
        ),
        (
            "problem Fork { output z: spline(order = 5, intervals = 2); minimize integral(z^2); phase a { duration = 1; } phase b { duration = 1; } }",
            "E082",
        ),
        (
            "problem Shared { agent a { duration T = 5; output z: spline(order = 5, intervals = 2); param k = 3; minimize integral(k * z^2); } }",
            "E083",
        ),
        (
            "problem None { agent a[i in 1 .. 0] { duration T = 5; output z: spline(order = 5, intervals = 2); minimize integral(z^2); } }",
            "E084",
        ),
        (
            "problem After { output z: spline(order = 5, intervals = 2); minimize integral(z^2); phase a[i in 1 .. 4] after a[i + 1] { duration = 1; } }",
            "E085",
        ),
        (
            "problem Whose { agent a { duration T = 5; output z: spline(order = 5, intervals = 2); } agent b { duration T = 5; output z: spline(order = 5, intervals = 2); } minimize integral(1); }",
            "E086",
        ),
        ("minimize integral(norm(der(u))^2) * 1 [s/N^2];", "E097"),
        ("trajectory { for i in 1 .. 1000000000 { x <= i * 1 [m]; } }", "E098"),
        (
            "problem Bead { duration T = 1; state x, y; input u, force; collocation gauss(points = 1, intervals = 4); minimize integral(u^2); dynamics { der(x, 2) == u - force; der(y, 2) == force; } initial { x == 0; } trajectory { x == y; } }",
            "E099",
        ),
    ],
);

/// What is noted, and may be meant.
pub(crate) const NOTES: Section = (
    "What is noted",
    &[
        ("trajectory { abs(der(x)) >= 1 [m/s]; }", "N001"),
        ("trajectory { der(y, 4) <= 1 [m/s^4]; }", "N002"),
        ("table drag(a) = fit bspline(order = 3, intervals = 1) { 0: 0;  1: 1;  2: 0;  3: 1;  4: 0; }", "N003"),
        ("temporal { n <= 3; }", "N004"),
        ("trajectory { x^2 >= 0; }", "N004"),
        (
            "problem Begin { duration T = 5; output z: spline(order = 5, intervals = 2); minimize integral(der(z, 2)^2); final { z == 1; } }",
            "N005",
        ),
        ("output z, q [m], k [kg]: spline(order = 5, intervals = 4);", "N006"),
        ("input a, b in -1 .. 1;", "N007"),
        ("const N = 3;  output k[N]: spline(order = 5, intervals = 4);", "N008"),
        ("variable a [deg];  temporal { a <= 90; }", "N009"),
        ("guess { T = 70 [s]; }", "N010"),
        ("trajectory { soft: x <= 11 [m]; }", "N011"),
        (
            "problem Balance { duration T = 5; state a, b; collocation gauss(points = 3, intervals = 4); minimize final(a); dynamics { der(a) == -a; der(b) == a; } initial { a == 1; } trajectory { a + b == 1; } }",
            "N012",
        ),
        (
            "problem Bead { duration T = 1; state x, y; input u, force; collocation gauss(points = 3, intervals = 4); minimize integral(u^2); dynamics { der(x, 2) == u - force; der(y, 2) == force; } initial { x == 0; } trajectory { x == y; } }",
            "N013",
        ),
        (
            "problem Knots { duration T = 1; state x; output v: spline(order = 4, intervals = 5); collocation gauss(points = 4, intervals = 4); minimize integral(der(v)^2); dynamics { der(x) == v; } initial { x == 0; } }",
            "N014",
        ),
    ],
);

/// Codes without an entry, and why.
const WITHOUT: &[(&str, &str)] = &[
    ("E005", "128 brackets are no line of a table"),
    ("E090", "4 GiB of text are none either"),
    ("E091", "the smallest such spec has dozens of functions"),
    ("E092", "the smallest such spec has hundreds of levels"),
    ("E100", "no spec is known that has it"),
];

#[test]
fn every_code_has_an_entry() {
    let has = |code: &str| sections().any(|(_, mistakes)| mistakes.iter().any(|(_, of)| *of == code));
    let without = |code: &str| WITHOUT.iter().any(|(of, _)| *of == code);
    let missing: Vec<&str> =
        Code::ALL.iter().map(|code| code.text()).filter(|code| !has(code) && !without(code)).collect();
    assert!(missing.is_empty(), "add a mistake for each to a section of the page: {missing:?}");
    let both: Vec<&str> = WITHOUT.iter().map(|(code, _)| *code).filter(|code| has(code)).collect();
    assert!(both.is_empty(), "these have an entry, and are listed as having none: {both:?}");
}
