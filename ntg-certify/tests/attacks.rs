//! What must never happen: a false constraint that is proved, a false certificate that is accepted.
//! `cargo run --release -p ntg-certify --example attack` does the same with 1000 cases each.

#[path = "../examples/support/planted.rs"]
mod planted;

use ntg_certify::certify::certify;
use ntg_certify::prove::Options;
use ntg_certify::{Verdict, write};
use planted::Planted;

#[test]
fn a_constraint_that_fails_by_a_billionth_is_never_proved_and_one_that_holds_by_as_much_is() {
    let mut random = fastrand::Rng::with_seed(1);
    for case in 0..100 {
        let planted = Planted::new(&mut random, 3);
        let failing = certify(planted.limited(planted.most - 1e-9), &Options::default());
        assert!(matches!(failing.findings[0].verdict, Verdict::Refuted(least, _) if least > 0.9e-9), "case {case}");
        // Between the samples the maximum may be higher by the square of their distance.
        let holding = certify(planted.limited(planted.most + 1e-3), &Options::default());
        assert_eq!(holding.findings[0].verdict, Verdict::Proved, "case {case}");
        for certificate in [failing, holding] {
            let checked = ntg_check::verify(&write::text(&certificate));
            assert!(checked.is_ok(), "case {case}: {checked:?}");
        }
    }
}

#[test]
fn a_certificate_that_is_false_is_rejected_even_with_a_new_digest() {
    let mut random = fastrand::Rng::with_seed(2);
    let mut seen = std::collections::BTreeMap::new();
    while seen.values().sum::<usize>() < 200 {
        let planted = Planted::new(&mut random, 3);
        let sound = certify(planted.limited(planted.most + 0.01), &Options::default());
        assert!(ntg_check::verify_claims(&write::body(&sound)).is_ok());
        let Some((text, how)) = planted::spoilt(&mut random, &sound) else { continue };
        assert!(ntg_check::verify_claims(&text).is_err(), "{how}:\n{text}");
        *seen.entry(how).or_insert(0) += 1;
    }
    assert_eq!(seen.len(), 6, "{seen:?}");
}

#[test]
fn any_other_letter_is_seen_by_the_digest() {
    let mut random = fastrand::Rng::with_seed(3);
    let planted = Planted::new(&mut random, 3);
    let text = write::text(&certify(planted.limited(planted.most + 0.01), &Options::default()));
    assert!(ntg_check::verify(&text).is_ok());
    for case in 0..1000 {
        let at = random.usize(0..text.len() - 1);
        let letter = char::from(random.u8(b' '..b'~'));
        if text.as_bytes()[at] != letter as u8 {
            let changed = format!("{}{letter}{}", &text[..at], &text[at + 1..]);
            assert!(ntg_check::verify(&changed).is_err(), "case {case}: letter {at}");
        }
    }
}

#[test]
fn boxes_grow_with_the_intervals_alone() {
    let boxes = |intervals: usize| {
        let planted = Planted::new(&mut fastrand::Rng::with_seed(4), intervals);
        let certificate = certify(planted.limited(planted.most + 0.01), &Options::default());
        assert_eq!(certificate.findings[0].verdict, Verdict::Proved);
        certificate.findings.iter().flat_map(|finding| &finding.covers).map(Vec::len).sum::<usize>() as f64
    };
    let (few, many) = (boxes(64), boxes(1024));
    assert!(many <= 16.0 * 1.25 * few, "{few} boxes for 64 intervals, {many} for 1024");
}
