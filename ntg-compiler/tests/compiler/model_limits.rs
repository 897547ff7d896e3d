//! Large and deep specs are given a meaning, or refused, without exhausting time or stack.

use std::fmt::Write;

use crate::model_support::{World, findings, good, named, value};
use ntg_compiler::model::problem::At;

fn problem(items: &str) -> String {
    format!("problem P {{ duration T = 5; output z: spline(order = 5, intervals = 2); minimize 0; {items} }}")
}

fn two(_: &str, _: Option<i64>, _: usize, _: At) -> f64 {
    2.0
}

const WORLD: World<'static> = World { flat: &two, other: &|_| 5.0 };

#[test]
fn a_chain_of_ten_thousand_definitions_needs_no_stack() {
    let mut items = "let a0 = z;".to_owned();
    for k in 1..10_000 {
        write!(items, "let a{k} = a{} + 1;", k - 1).expect("strings take everything");
    }
    let p = good(&problem(&items));
    assert_eq!(value(&p, named(&p, "a9999"), WORLD), 10_001.0);
}

#[test]
fn a_sum_of_two_hundred_thousand_terms_is_an_ordinary_one() {
    let terms = vec!["z"; 200_000].join(" + ");
    let p = good(&problem(&format!("let a = {terms};")));
    assert_eq!(value(&p, named(&p, "a"), WORLD), 400_000.0);
}

#[test]
fn functions_nested_too_deeply_are_refused() {
    let mut items = "fn f0(u) = u;".to_owned();
    for k in 1..5_000 {
        write!(items, "fn f{k}(u) = -(1 + sin(f{}(u)));", k - 1).expect("strings take everything");
    }
    items += "let a = f4999(z);";
    let found = findings(&problem(&items));
    assert!(found.contains("E092"), "{found}");
}

#[test]
fn nested_brackets_and_functions_together_fit_the_stack() {
    let deep = |inner: &str| format!("{}{inner}{}", "sin(-".repeat(60), ")".repeat(60));
    let mut items = format!("fn f0(u) = {};", deep("u"));
    for k in 1..20 {
        write!(items, "fn f{k}(u) = {};", deep(&format!("f{}(u)", k - 1))).expect("strings take everything");
    }
    items += "let a = f19(z);";
    let found = findings(&problem(&items));
    assert!(found.contains("E092"), "{found}");
}

#[test]
fn a_family_that_is_defined_by_other_members_of_itself_is_refused() {
    for body in ["a[2 * i - 1]", "a[i]", "a[1]"] {
        let found = findings(&problem(&format!("let a[i in 1 .. 1] = z + {body};")));
        let refused = ["E023", "E027", "E092"].iter().any(|code| found.contains(code));
        assert!(refused, "{body}: {found}");
    }
}

#[test]
fn many_nested_loops_are_looked_through_in_time() {
    let mut items = "output w[1 .. 9]: spline(order = 4, intervals = 1); trajectory {".to_owned();
    for k in 0..60 {
        write!(items, "for i{k} in 1 .. 9 {{").expect("strings take everything");
    }
    items += "w[i59] <= 1;";
    items += &"}".repeat(60);
    items += "}";
    let found = findings(&problem(&items));
    // 9^60 members: they are counted, which takes no time, and are too many.
    assert!(found.contains("error[E098]") && found.matches("error").count() == 1, "{found}");
}
