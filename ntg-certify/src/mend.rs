//! What is changed of constraints that a certificate does not prove (docs/maths.md, section 15.6).

use std::collections::BTreeMap;

use crate::certify::{Certificate, Finding};
use crate::change::{Change, Spared};
use crate::ends::Ends;
use crate::evaluate::{Here, Machine, cell};
use crate::guarantee::Guarantee;
use crate::interval::Interval;
use crate::jet::Jet;
use crate::prove::Leaf;
use crate::spline::Piece;
use crate::statement::{Kind, Quantity, Subject};

/// What one constraint misses, over all of its members.
#[derive(Clone, Copy, Default)]
struct Need {
    below: f64,
    above: f64,
    along: bool,
    scale: f64,
    ends: [Spared; 2],
    members: usize,
}

/// How many times what may be tightened at all is tightened ahead of more points; where more may be missed, still more points
/// are to follow. A fit to the specs.
const MOST: f64 = 4.0;

/// The size of bounds; 1 where both are 0.
pub(crate) fn size(required: Option<(f64, f64)>) -> f64 {
    let (low, high) = required.unwrap_or((0.0, 0.0));
    let most = [low, high].into_iter().filter(|b| b.is_finite()).fold(0.0, |most: f64, b| most.max(b.abs()));
    if most > 0.0 { most } else { 1.0 }
}

/// Changes every constraint that is not proved, and misses more than the `least` part of its size; whether any could be
/// changed. What is held at more points is tightened by what it may still miss there, if that is to be foreseen.
pub(crate) fn change(
    certificate: &Certificate,
    changes: &mut BTreeMap<usize, Change>,
    wanted: &Guarantee,
    (least, foresees): (f64, bool),
) -> bool {
    let mut changed = false;
    for (number, need) in needs(certificate, wanted) {
        let Need { below, above, along, scale, ends, members } = need;
        if !below.is_finite() || !above.is_finite() {
            continue; // It may have no value; no bound helps.
        }
        let [below, above] = [below, above].map(|missed| if missed <= least * scale { 0.0 } else { missed });
        if least > 0.0 && below.max(above) <= 0.0 {
            continue;
        }
        let change = changes.entry(number).or_default();
        let now = change.clone();
        change.members = members;
        (0..2).for_each(|end| change.ends[end] = change.ends[end].max(ends[end]));
        let worst = below.max(above);
        // What tightening has not made less needs more points, too.
        let coarse = if worst > 0.5 * now.missed && now.missed > 0.0 { 0.5 * worst } else { worst };
        let coarse = coarse.min(wanted.coarse * scale);
        let is_dense = along && worst > coarse;
        let foreseen = if is_dense { mark(certificate, (number, coarse), (&now, change), wanted.points) } else { 0.0 };
        change.missed = worst;
        let is_denser = change.levels != now.levels || change.times != now.times;
        // A quarter more: the trajectory moves a little when it is held back.
        let tightened = |own: f64, missed: f64| match (is_denser, missed > 0.0) {
            (_, false) => own,
            (false, true) => own + 1.25 * missed + wanted.margin * scale,
            // What was needed with fewer points is not needed any more.
            (true, true) if foresees => 0.25 * own + 1.25 * missed.min(foreseen).min(MOST * wanted.coarse * scale),
            (true, true) => own,
        };
        (change.below, change.above) = (tightened(change.below, below), tightened(change.above, above));
        changed = true;
    }
    changed
}

/// What each constraint that is not proved misses.
fn needs(certificate: &Certificate, wanted: &Guarantee) -> BTreeMap<usize, Need> {
    let machine = Machine::new(&certificate.statement);
    let ends = Ends::of(&machine);
    let mut needs: BTreeMap<usize, Need> = BTreeMap::new();
    let mut members: BTreeMap<usize, usize> = BTreeMap::new();
    for (subject, finding) in certificate.each() {
        let Kind::Constraint(number) = subject.kind else { continue };
        let along = matches!(subject.quantity, Quantity::Path(..));
        if along {
            *members.entry(number).or_insert(0) += 1;
        }
        if finding.verdict.holds() {
            continue;
        }
        let Some((low, high)) = finding.required else { continue };
        let below = if low.is_finite() { (low - finding.values.low()).max(0.0) } else { 0.0 };
        let above = if high.is_finite() { (finding.values.high() - high).max(0.0) } else { 0.0 };
        let scale = size(finding.required);
        let need = needs.entry(number).or_default();
        (need.below, need.above, need.scale) = (need.below.max(below), need.above.max(above), need.scale.max(scale));
        need.along |= along;
        for (end, last) in [false, true].into_iter().enumerate() {
            let spared = spared(&machine, &ends, (subject, finding), (last, wanted.margin * scale));
            need.ends[end] = need.ends[end].max(spared);
        }
    }
    for (number, need) in &mut needs {
        need.members = members.get(number).copied().unwrap_or(0);
    }
    needs
}

/// What is spared at an end of a constraint along a phase: something, where end conditions fix what it is there and it
/// meets a bound.
fn spared(
    machine: &Machine<'_>,
    ends: &Ends,
    (subject, finding): (&Subject, &Finding),
    (last, most): (bool, f64),
) -> Spared {
    let (Quantity::Path(function, phase, cells), Some((low, high))) = (&subject.quantity, finding.required) else {
        return Spared::Nothing;
    };
    let all = machine.statement.phases[*phase].cells();
    let reaches = if last { cells.end == all.end } else { cells.start == all.start };
    let needs = machine.needs(*function);
    let is_fixed = !needs.is_empty() && needs.iter().all(|flat| ends.fix(machine.statement.flats[*flat], last));
    let value = machine.number(*function, Some((*phase, last))).c[0];
    let near = |bound: f64| (value.low() - bound).abs() <= most && (value.high() - bound).abs() <= most;
    if !(reaches && is_fixed && (near(low) || near(high))) {
        return Spared::Nothing;
    }
    // A line has come half as far in the middle of the interval, a parabola a quarter: between the two.
    const HALFWAY: f64 = 0.4;
    let (middle, end) = beside(machine, (*function, *phase), if last { cells.end - 1 } else { cells.start }, last);
    let far = |at: f64| (at - value.middle()).abs();
    if far(middle) > HALFWAY * far(end) { Spared::Point } else { Spared::Interval }
}

/// About what a function is in the middle of a cell beside an end of the phase, and where the cell has its other end.
fn beside(machine: &Machine<'_>, (function, phase): (usize, usize), number: usize, last: bool) -> (f64, f64) {
    let at = |part: f64| number_at(machine, (function, phase), (number, part)).middle();
    (at(0.5), at(if last { 0.0 } else { 1.0 }))
}

/// About what a function is at a part of a cell.
fn number_at(machine: &Machine<'_>, (function, phase): (usize, usize), (number, part): (usize, f64)) -> Interval {
    let cuts = &machine.statement.phases[phase].cuts;
    let tau = Piece::line(Interval::point(cuts[number]), Interval::point(cuts[number + 1]));
    let mut flats = vec![None; machine.statement.flats.len()];
    for flat in machine.needs(function) {
        let piece = cell(machine.statement, machine.statement.flats[flat], number);
        flats[flat] = Some(Jet::<1>::constant(Interval::point(piece.near(part))));
    }
    machine.evaluate(function, &Here { flats, tau: Jet::constant(Interval::point(tau.near(part))) }).c[0]
}

/// Holds a constraint at more points where it may miss its bounds by more than can be tightened. Gives what it may still
/// miss there then, and what it misses elsewhere: between points that falls with the square of their distance. Where more
/// points did not suffice before, as at kinks, one more is where most is missed: a quarter is, on both sides of it.
fn mark(
    certificate: &Certificate,
    (number, coarse): (usize, f64),
    (now, change): (&Change, &mut Change),
    points: usize,
) -> f64 {
    let machine = Machine::new(&certificate.statement);
    let (mut left, most): (f64, u8) = (0.0, points.max(1).ilog2() as u8);
    for (subject, finding) in certificate.each().filter(|(subject, _)| subject.kind == Kind::Constraint(number)) {
        let (Quantity::Path(function, phase, _), Some((low, high))) = (&subject.quantity, finding.required) else {
            continue;
        };
        let cuts = &certificate.statement.phases[*phase].cuts;
        let member = &subject.indices[..];
        let missed = |values: Interval| (low - values.low()).max(values.high() - high);
        let at = |cell: usize, part: f64| missed(number_at(&machine, (*function, *phase), (cell, part)));
        // Of boxes that follow each other, and miss it, that in which it is missed most.
        let (mut worst, mut summits): (Option<(f64, &Leaf)>, Vec<&Leaf>) = (None, vec![]);
        for leaf in finding.covers.iter().flatten() {
            let own = missed(leaf.values);
            let tau = |part: f64| cuts[leaf.cell] + (cuts[leaf.cell + 1] - cuts[leaf.cell]) * part;
            let times = (tau(leaf.start()), tau(leaf.start() + leaf.length()));
            let is_missed = own > coarse;
            if is_missed && now.level(member, times.0) > 0 {
                let value = at(leaf.cell, leaf.start() + 0.5 * leaf.length());
                if worst.is_none_or(|(most, _)| value > most) {
                    worst = Some((value, leaf));
                }
                left = left.max(0.25 * own);
                continue;
            }
            summits.extend(worst.take().map(|(_, leaf)| leaf));
            if !is_missed {
                left = left.max(own);
                continue;
            }
            let more = doublings(own / coarse);
            change.mark(now, (member, times.0, times.1), (more, most));
            left = left.max(own / f64::from(1_u32 << (2 * u32::from(more.min(most)))));
        }
        for leaf in summits.into_iter().chain(worst.map(|(_, leaf)| leaf)) {
            let part = largest(|part| at(leaf.cell, part), (leaf.start(), leaf.length()));
            change.hold(member, cuts[leaf.cell] + (cuts[leaf.cell + 1] - cuts[leaf.cell]) * part);
        }
    }
    left
}

/// Where a function is largest in a box in which it has one summit: by thirds.
fn largest(at: impl Fn(f64) -> f64, (start, length): (f64, f64)) -> f64 {
    /// A third of a box is left out each time: to a millionth of it.
    const STEPS: usize = 34;
    let (mut from, mut to) = (start, start + length);
    for _ in 0..STEPS {
        let third = (to - from) / 3.0;
        if at(from + third) < at(to - third) { from += third } else { to -= third }
    }
    0.5 * (from + to)
}

/// How often the distance of points is to be halved for what is missed to fall by about this factor, with its square; at
/// most three times at once: eight times as many points cost about eight times as much.
fn doublings(factor: f64) -> u8 {
    (0.5 * factor.log2()).round().clamp(1.0, 3.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_as_many_points_miss_a_quarter() {
        let found: Vec<u8> = [1.1, 4.0, 7.9, 8.1, 16.0, 100.0, 1e9].into_iter().map(doublings).collect();
        assert_eq!(found, [1, 1, 1, 2, 2, 3, 3]);
    }

    #[test]
    fn the_size_of_bounds_is_the_larger_finite_one() {
        assert_eq!(size(Some((-3.0, 2.0))), 3.0);
        assert_eq!(size(Some((f64::NEG_INFINITY, 0.0))), 1.0);
        assert_eq!(size(None), 1.0);
    }
}
