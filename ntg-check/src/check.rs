//! Every claim of a certificate, proved again.

use std::collections::BTreeMap;

use crate::boxes::{Part, Walk};
use crate::evaluate::evaluate;
use crate::interval::Interval;
use crate::jet::{Jet, mean, range};
use crate::read::{Certificate, Claim, Quantity, Sound};
use crate::real::Real;
use crate::tube::tube;

/// How often a box is halved beyond what the certificate says, should it not do as it is.
const MORE: u32 = 6;

/// How many claims there are of each kind: `proved` constraints hold at all times, equalities hold `within` a residual,
/// `refuted` constraints do not hold at the time that is named, of the `undecided` neither is claimed, quantities are
/// only `bounded`, and `tubes` bound the true state of a phase.
pub type Checked = BTreeMap<String, usize>;

/// Proves every claim again.
pub(crate) fn check(certificate: &Certificate) -> Sound<Checked> {
    sound(certificate)?;
    let (mut checked, mut integrals, mut ends) = (Checked::new(), vec![], vec![]);
    for (number, claim) in certificate.claims.iter().enumerate() {
        prove(certificate, claim, &integrals).map_err(|error| format!("claim {number}: {error}"))?;
        *checked.entry(claim.verdict.clone()).or_default() += 1;
        integrals.push(if let Quantity::Sum(_) = claim.quantity { claim.values } else { Interval::ENTIRE });
    }
    for (number, own) in certificate.tubes.iter().enumerate() {
        tube(certificate, own, &integrals, &mut ends).map_err(|error| format!("tube {number}: {error}"))?;
        *checked.entry("tubes".to_owned()).or_default() += 1;
    }
    Ok(checked)
}

/// What every later step takes for granted.
fn sound(certificate: &Certificate) -> Sound<()> {
    let rising = |numbers: &[Real], strictly: bool| {
        numbers.windows(2).all(|pair| pair[0] < pair[1] || (!strictly && pair[0] == pair[1]))
    };
    let ends = (Real::ZERO, Real::whole(1));
    let phases = certificate
        .phases
        .iter()
        .all(|cuts| cuts.len() >= 2 && rising(cuts, true) && (cuts[0], cuts[cuts.len() - 1]) == ends);
    let splines = certificate.splines.iter().all(|spline| {
        let (k, t) = (spline.order, &spline.knots);
        let counts = (1..=64).contains(&k) && t.len() == spline.coefficients.len() + k && t.len() >= 2 * k;
        counts && rising(t, false) && (t[k - 1], t[t.len() - k]) == ends
    });
    let axes = certificate.tables.iter().flat_map(|table| &table.axes).all(|axis| {
        let begins: Vec<Real> = axis.cells.iter().map(|cell| cell.0).collect();
        !begins.is_empty()
            && (1..=64).contains(&axis.order)
            && rising(&begins, true)
            && axis.low < axis.high
            && axis.cells.iter().all(|cell| cell.1 > Real::ZERO)
            && axis.weights.len() == begins.len() * axis.order * axis.order
            && (begins.len() - 1).saturating_mul(axis.step).saturating_add(axis.order) == axis.coefficients
    });
    let tables = certificate.tables.iter().all(|table| {
        let size = table.axes.iter().fold(1, |product: usize, axis| product.saturating_mul(axis.coefficients));
        size == table.coefficients.len() && !table.axes.is_empty()
    });
    // Functions are made of functions before them alone: the reader knows no others.
    let parts = [(phases, "the cuts of a phase"), (splines, "the knots of a spline"), (axes && tables, "a table")];
    parts.iter().try_for_each(|(sound, what)| if *sound { Ok(()) } else { Err(format!("{what} cannot be")) })
}

/// Checks that a claim's values enclose the quantity, and that its verdict follows from them.
fn prove(certificate: &Certificate, claim: &Claim, integrals: &[Interval]) -> Sound<()> {
    match &claim.quantity {
        Quantity::Path(function, phase, cells) => {
            let [cover] = &claim.covers[..] else { return Err("it needs one cover".to_owned()) };
            let partial = claim.verdict == "bounded" || claim.verdict == "undecided" || claim.verdict == "refuted";
            let mut judge = |part: &Part| {
                let (middle, all) = part.jets(certificate, *function, integrals);
                (all.total || partial) && claim.values.encloses(range(&middle, &all))
            };
            Walk::of(certificate, &[*function], *phase, *cells)
                .along(cover, &mut |part| judged(part, &mut judge, (0, MORE)))?;
        }
        Quantity::Sum(summands) => {
            let mut more = 0;
            while !claim.values.encloses(sum(certificate, (claim, summands), integrals, more)?) {
                more += 1;
                if more > MORE / 2 {
                    return Err("its value is not proved to be where it is claimed to be".to_owned());
                }
            }
        }
    }
    verdict(certificate, claim, integrals)
}

type Terms<'a> = (&'a Claim, &'a [(usize, Option<usize>)]);

/// A sum of integrals and numbers, every box of a cover halved `more` times.
fn sum(certificate: &Certificate, (claim, summands): Terms<'_>, integrals: &[Interval], more: u32) -> Sound<Interval> {
    let (mut sum, mut covers) = (Interval::ZERO, claim.covers.iter());
    for (function, over) in summands {
        let Some(phase) = over else {
            sum = sum + number(certificate, *function, integrals);
            continue;
        };
        let mut add = |part: &Part| {
            let (middle, all) = part.jets(certificate, *function, integrals);
            sum = sum + if all.total { mean(&middle, &all) * part.length } else { Interval::ENTIRE };
            true
        };
        let cells = (0, certificate.phases[*phase].len() - 1);
        Walk::of(certificate, &[*function], *phase, cells)
            .along(covers.next().ok_or("a cover is missing")?, &mut |part| judged(part, &mut add, (more, MORE)))?;
    }
    Ok(sum)
}

/// Judges a box, after so many halvings; it may be halved some times beyond.
fn judged(part: &Part, judge: &mut dyn FnMut(&Part) -> bool, (first, more): (u32, u32)) -> Sound<()> {
    if first == 0 && judge(part) {
        return Ok(());
    }
    if more == 0 {
        return Err("its values are not proved to be where they are claimed to be".to_owned());
    }
    let left = if first > 0 { (first - 1, more) } else { (0, more - 1) };
    part.halves().iter().try_for_each(|half| judged(half, judge, left))
}

/// A function that depends on no time.
pub(crate) fn number(certificate: &Certificate, function: usize, integrals: &[Interval]) -> Interval {
    evaluate(certificate, function, integrals, &|_| Jet::NOTHING).known()
}

fn verdict(certificate: &Certificate, claim: &Claim, integrals: &[Interval]) -> Sound<()> {
    let bound = |f: Option<usize>| f.map(|f| number(certificate, f, integrals));
    let (low, high) = (bound(claim.bounds.0), bound(claim.bounds.1));
    let equality = claim.bounds.0 == claim.bounds.1;
    let holds = match (claim.verdict.as_str(), &claim.quantity) {
        ("proved", _) => {
            let meets = |low: Interval, high: Interval| (high - low).is_not_negative();
            !equality
                && low.is_none_or(|low| meets(low, claim.values))
                && high.is_none_or(|high| meets(claim.values, high))
        }
        ("within", _) => equality && low.is_some() && claim.values.ends.is_some(),
        ("refuted", quantity) => {
            let value = match quantity {
                Quantity::Path(function, phase, cells) => {
                    let place = claim.witness.ok_or("there is no witness")?;
                    let part = Walk::of(certificate, &[*function], *phase, *cells).part(place)?;
                    part.jets(certificate, *function, integrals).0.known()
                }
                Quantity::Sum(_) => claim.values,
            };
            low.is_some_and(|low| (low - value).is_positive()) || high.is_some_and(|high| (value - high).is_positive())
        }
        ("undecided", _) => true,
        (verdict, _) => verdict == "bounded" && low.is_none() && high.is_none(),
    };
    if holds { Ok(()) } else { Err(format!("it is not `{}`", claim.verdict)) }
}
