//! 1000 planted violations of 1e-9, 1000 false certificates, the same of tubes, and how time grows with intervals.
//!
//! `cargo run --release -p ntg-certify --example attack [COUNT]`

#[path = "support/pendulum.rs"]
mod pendulum;
#[path = "support/planted.rs"]
mod planted;

use std::collections::BTreeMap;
use std::time::Instant;

use ntg_certify::certify::certify;
use ntg_certify::prove::Options;
use ntg_certify::{Verdict, write};
use planted::Planted;

fn main() {
    let count = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(1000);
    let (mut random, mut proved) = (fastrand::Rng::with_seed(11), 0);
    for _ in 0..count {
        let planted = Planted::new(&mut random, 4);
        let found = certify(planted.limited(planted.most - 1e-9), &Options::default());
        proved += usize::from(found.findings[0].verdict == Verdict::Proved);
    }
    println!("{count} constraints that fail by 1e-9: {proved} proved");
    let (mut tried, mut accepted): (BTreeMap<&str, usize>, usize) = (BTreeMap::new(), 0);
    while tried.values().sum::<usize>() < count {
        let planted = Planted::new(&mut random, 4);
        let sound = certify(planted.limited(planted.most + 0.01), &Options::default());
        if let Some((text, how)) = planted::spoilt(&mut random, &sound) {
            accepted += usize::from(ntg_check::verify_claims(&text).is_ok());
            *tried.entry(how).or_insert(0) += 1;
        }
    }
    println!("{count} false certificates with sound digests {tried:?}: {accepted} accepted");
    tubes(count);
    for intervals in [16, 64, 256, 1024] {
        let planted = Planted::new(&mut fastrand::Rng::with_seed(4), intervals);
        let began = Instant::now();
        let found = certify(planted.limited(planted.most + 0.01), &Options::default());
        let certified = began.elapsed().as_secs_f64();
        let (text, began) = (write::text(&found), Instant::now());
        let checked = ntg_check::verify(&text).is_ok();
        let boxes: usize = found.findings.iter().flat_map(|f| &f.covers).map(Vec::len).sum();
        println!(
            "{intervals} intervals: {boxes} boxes, {certified:.4} s ({:.1} us an interval), checked in {:.3} s: {checked}",
            1e6 * certified / intervals as f64,
            began.elapsed().as_secs_f64(),
        );
    }
}

/// False claims about the tube of a pendulum, and scratches in what proves it.
fn tubes(count: usize) {
    let (sound, mut random) = (pendulum::pendulum(), fastrand::Rng::with_seed(12));
    let began = Instant::now();
    let text = write::text(&sound);
    let checked = ntg_check::verify(&text);
    println!(
        "the tube of a pendulum: {} bytes, checked in {:.3} s: {checked:?}",
        text.len(),
        began.elapsed().as_secs_f64()
    );
    let accepts = |of: &ntg_certify::Certificate| usize::from(ntg_check::verify_claims(&write::body(of)).is_ok());
    let violated: usize = (0..count).map(|_| accepts(&pendulum::violated(&mut random, &sound, 1e-9))).sum();
    println!("{count} tubes that are missed by 1e-9: {violated} accepted");
    let (mut tried, mut accepted, mut true_ones): (BTreeMap<&str, usize>, usize, usize) = (BTreeMap::new(), 0, 0);
    while tried.values().sum::<usize>() < count {
        let (spoilt, how) = pendulum::spoilt(&mut random, &sound);
        if pendulum::missed(&spoilt) > 1e-10 {
            accepted += accepts(&spoilt);
            *tried.entry(how).or_insert(0) += 1;
        } else {
            true_ones += 1;
        }
    }
    println!(
        "{count} tubes of something else {tried:?}: {accepted} accepted; {true_ones} that happened to be true are left out"
    );
    let scratched = (0..count).filter(|_| ntg_check::verify_claims(&pendulum::scratched(&mut random, &sound)).is_ok());
    println!("{count} scratches in the proof, with the same true claims: {} accepted", scratched.count());
}
