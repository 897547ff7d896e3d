//! No real number escapes its enclosure: operations against exact rationals, functions against multi-precision.
//! `cargo run --release -p ntg-certify --example million_cases` does the same with 10^6 cases.

#[path = "../examples/support/cases.rs"]
mod cases;

#[test]
fn operations_enclose_exact_rationals() {
    let mut random = fastrand::Rng::with_seed(1);
    for case in 0..5_000 {
        assert_eq!(cases::arithmetic(&mut random), None, "case {case}");
    }
}

#[test]
fn elementary_functions_enclose_multi_precision() {
    let (mut random, mut reference) = (fastrand::Rng::with_seed(2), cases::Reference::new());
    for case in 0..1_000 {
        assert_eq!(cases::elementary(&mut random, &mut reference), None, "case {case}");
        assert_eq!(cases::binary(&mut random, &mut reference), None, "case {case}");
    }
    let (units, name) = reference.worst;
    assert!(units > 0.0 && 2.0 * units <= f64::from(ntg_certify::elementary::UNITS), "{name}: {units} units");
}
