//! A tube that is false is never accepted. `cargo run --release -p ntg-certify --example attack` tries 1000 each.

#[path = "../examples/support/pendulum.rs"]
mod pendulum;

use std::collections::BTreeMap;

use ntg_certify::write;

#[test]
fn a_tube_that_is_missed_by_a_billionth_is_rejected_and_the_true_one_is_accepted() {
    let (sound, mut random) = (pendulum::pendulum(), fastrand::Rng::with_seed(1));
    assert!(pendulum::missed(&sound) < 0.0, "{}", pendulum::missed(&sound));
    let checked = ntg_check::verify(&write::text(&sound)).expect("a sound certificate");
    assert_eq!(checked["tubes"], 1);
    for case in 0..100 {
        let violated = pendulum::violated(&mut random, &sound, 1e-9);
        assert!(pendulum::missed(&violated) > 0.9e-9, "case {case}");
        let rejected = ntg_check::verify(&write::text(&violated)).expect_err("a false tube");
        assert!(rejected.starts_with("tube 0"), "case {case}: {rejected}");
    }
}

#[test]
fn the_tube_of_something_else_is_rejected() {
    let (sound, mut random) = (pendulum::pendulum(), fastrand::Rng::with_seed(2));
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for case in 0..200 {
        let (spoilt, how) = pendulum::spoilt(&mut random, &sound);
        let accepted = ntg_check::verify(&write::text(&spoilt)).is_ok();
        // Runge and Kutta's own error is far below.
        if pendulum::missed(&spoilt) > 1e-10 {
            assert!(!accepted, "case {case}: {how}");
            *seen.entry(how).or_default() += 1;
        }
    }
    assert!(seen.len() == 6 && seen.values().sum::<usize>() > 150, "{seen:?}");
}

#[test]
fn a_proof_that_is_scratched_proves_the_same_or_nothing() {
    let (sound, mut random) = (pendulum::pendulum(), fastrand::Rng::with_seed(3));
    let mut rejected = 0;
    for _ in 0..200 {
        // The claims are untouched, so that what is accepted is true.
        rejected += usize::from(ntg_check::verify_claims(&pendulum::scratched(&mut random, &sound)).is_err());
    }
    assert!(rejected > 120, "{rejected}");
}

#[test]
fn no_equation_and_no_unknown_can_be_left_out() {
    let text = write::body(&pendulum::pendulum());
    assert!(ntg_check::verify_claims(&text).is_ok());
    let lines = |keep: &dyn Fn(&str) -> bool| {
        text.lines().filter(|line| keep(line)).fold(String::new(), |all, line| all + line + "\n")
    };
    for missing in ["unknown", "component", "box"] {
        assert!(ntg_check::verify_claims(&lines(&|line| !line.starts_with(missing))).is_err(), "{missing}");
    }
    let tube = text.lines().find(|line| line.starts_with("tube ")).expect("a tube");
    let words: Vec<&str> = tube.split(' ').collect();
    let without = format!("{} {} 0 {}", words[0], words[1], words[4..].join(" "));
    let left_out = ntg_check::verify_claims(&text.replace(tube, &without)).expect_err("an equation is missing");
    assert!(left_out.contains("left out"), "{left_out}");
}
