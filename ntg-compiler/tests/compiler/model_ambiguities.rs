//! Texts that could be read in two ways, each beside a text that can be read in one alone: both are the same problem,
//! the same structure and the same kernels. Places and the texts of the spec are left out.

use crate::model_support::{Files, program};
use ntg_compiler::source::Source;

/// Declarations of the problem around, with words of the language as names where they may be names.
const AROUND: &str = "duration T = 4 [s]; output x, y: spline(order = 5, intervals = 4); output r[3] [m]: spline(order = 5, \
    intervals = 4); const n = 3; param a = 2; param c = 3; fn soft(u) = 2 * u; minimize integral(x^2 + y^2) / 1 [s];";

/// What is written, and what it means.
const READ_AS: &[(&str, &str)] = &[
    // A bracket behind a list is a unit: only names have indices.
    ("trajectory { r in (1, 2, 3) [km] .. 5 [km]; }", "trajectory { r in (1000 [m], 2000 [m], 3000 [m]) .. 5 [km]; }"),
    // The unit behind a list serves its bare numbers.
    ("trajectory { r <= 2 * (sin(a) * 1 [m], 1, 0) [m]; }", "trajectory { r <= (2 * sin(a) * 1 [m], 2 [m], 0 [m]); }"),
    // A name behind the price, one without it, and a call.
    ("trajectory { soft: x <= 1; }", "trajectory { kept: x <= 1; }"),
    ("trajectory { soft(10) <= x; }", "trajectory { 20 <= x; }"),
    ("final { soft(10): soft: x <= 1; }", "final { soft(linear = 10): soft: x <= 1; }"),
    // A word is the keyword behind a complete expression, and a name in its place.
    (
        "param smooth = 2; param unit = 3; trajectory { (if x <= smooth smooth unit { y } else { x }) <= 1; }",
        "param smooth = 2; param unit = 3; trajectory { (if x <= (smooth) smooth (unit) { y } else { x }) <= 1; }",
    ),
    (
        "param sigma = 2; measure { m: final(x) == sigma sigma sigma; }",
        "param sigma = 2; measure { m: final(x) == (sigma) sigma (sigma); }",
    ),
    (
        "const from = 1 [s]; const to = 3 [s]; trajectory from from to to { x <= 1; }",
        "trajectory from 1 [s] to 3 [s] { x <= 1; }",
    ),
    // No expression begins with a brace, so one ends it.
    (
        "trajectory { for i in 1 .. if n == 3 { 2 } else { 1 } { r[i] >= 0; } }",
        "trajectory { for i in 1 .. 2 { r[i] >= 0; } }",
    ),
    // A statement, a name and a function.
    ("at (2.5 [s]) { x == 1; }", "temporal { at(2.5 [s], x) == 1; }"),
    ("const at = 1 [s]; at at { x == 1; }", "const at = 1 [s]; at (at) { x == 1; }"),
    ("fn at(p, q) = p + q; trajectory { at(a, x) <= 9; }", "trajectory { a + x <= 9; }"),
    // A bracket with one name is a unit in an output, whatever that name is.
    ("const m = 2; output k[m]: spline(order = 4, intervals = 2);", "output k [m]: spline(order = 4, intervals = 2);"),
    // Bounds hand no unit to other names.
    (
        "output p [1], q in 1 .. 2 [kg]: spline(order = 4, intervals = 2);",
        "output p: spline(order = 4, intervals = 2); output q in 1 .. 2 [kg]: spline(order = 4, intervals = 2);",
    ),
];

#[test]
fn what_could_be_read_in_two_ways_is_read_in_one() {
    for (short, long) in READ_AS {
        let nameless = |text: &str| {
            let mut program = program(&format!("problem P {{ {AROUND} {text} }}"));
            program.structure.constraints.iter_mut().for_each(|constraint| constraint.name = None);
            program
        };
        let (short_one, long_one) = (nameless(short), nameless(long));
        assert!(short_one.kernels == long_one.kernels, "{short}");
        assert!(short_one.structure.groups == long_one.structure.groups, "{short}");
        assert!(short_one.structure.phases == long_one.structure.phases, "{short}");
    }
}

#[test]
fn what_has_no_one_reading_is_refused() {
    for (text, code) in [
        ("measure { final(x) == 1 +- 5; }", "E095"),
        ("let z = { 1 };", "E001"),
        ("trajectory { r <= sin(a)[1]; }", "E001"),
        ("output k[n]: spline(order = 4, intervals = 2);", "E040"),
        ("output p, q in 1 .. 2 [kg]: spline(order = 4, intervals = 2);", "E096"),
    ] {
        let source = Source::new("spec.ntg", format!("problem P {{ {AROUND} {text} }}"));
        let found = ntg_compiler::compile(&source, &Files(vec![])).err().map(|found| found.into_iter().next());
        assert_eq!(found.flatten().map(|finding| finding.code.text()), Some(code), "{text}");
    }
}
