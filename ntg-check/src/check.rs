//! Every claim of a certificate, proved again.

use crate::evaluate::{Here, Piece, end_of, evaluate, halves, jets, piece};
use crate::interval::Interval;
use crate::jet::{Jet, mean, range};
use crate::read::{Certificate, Claim, Function, Input, Over, Quantity, end_cell};
use crate::real::Real;

/// How often a box is halved beyond what the certificate says, should it not do as it is.
const MORE: u32 = 6;

/// How many claims there are of each kind: `(proved, within a residual, refuted, undecided, bounded)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Checked {
    /// Constraints that hold at all times.
    pub proved: usize,
    /// Equalities that hold to within a residual.
    pub within: usize,
    /// Constraints that do not hold at the time that is named.
    pub refuted: usize,
    /// Constraints of which neither is claimed.
    pub undecided: usize,
    /// Quantities that are only bounded.
    pub bounded: usize,
}

/// Proves every claim again.
pub(crate) fn check(certificate: &Certificate) -> Result<Checked, String> {
    sound(certificate)?;
    let mut integrals = vec![];
    for claim in &certificate.integrals {
        integrals.push(quantity(certificate, claim, &integrals).map_err(|error| format!("{}: {error}", claim.name))?);
    }
    let mut checked = Checked::default();
    for claim in &certificate.claims {
        let wrong = |error| format!("`{}`: {error}", claim.name);
        let values = quantity(certificate, claim, &integrals).map_err(wrong)?;
        verdict(certificate, (claim, values), &integrals, &mut checked).map_err(wrong)?;
    }
    Ok(checked)
}

/// What every later step takes for granted.
fn sound(certificate: &Certificate) -> Result<(), String> {
    let rising = |numbers: &[Real], strictly: bool| {
        numbers.windows(2).all(|pair| pair[0] < pair[1] || (!strictly && pair[0] == pair[1]))
    };
    let ends = (Real::ZERO, Real::whole(1));
    for cuts in &certificate.phases {
        if cuts.len() < 2 || !rising(cuts, true) || (cuts[0], cuts[cuts.len() - 1]) != ends {
            return Err("the cuts of a phase do not rise from 0 to 1".to_owned());
        }
    }
    for spline in &certificate.splines {
        let (k, t) = (spline.order, &spline.knots);
        let counts = (1..=64).contains(&k) && t.len() == spline.coefficients.len() + k && t.len() >= 2 * k;
        if !counts || !rising(t, false) || (t[k - 1], t[t.len() - k]) != ends {
            return Err("a spline has no sound knots".to_owned());
        }
    }
    for table in &certificate.tables {
        let size = table.axes.iter().fold(1, |product: usize, axis| product.saturating_mul(axis.coefficients));
        let axes = table.axes.iter().all(|axis| {
            let begins: Vec<Real> = axis.cells.iter().map(|cell| cell.0).collect();
            !begins.is_empty()
                && (1..=64).contains(&axis.order)
                && rising(&begins, true)
                && axis.low < axis.high
                && axis.cells.iter().all(|cell| cell.1 > Real::ZERO)
                && axis.weights.len() == begins.len() * axis.order * axis.order
                && (begins.len() - 1).saturating_mul(axis.step).saturating_add(axis.order) == axis.coefficients
        });
        if !axes || size != table.coefficients.len() || table.axes.is_empty() {
            return Err("a table is not sound".to_owned());
        }
    }
    // Functions are made of functions before them alone: the reader knows no others.
    Ok(())
}

/// Checks that a claim's values enclose the quantity, and gives them.
fn quantity(certificate: &Certificate, claim: &Claim, integrals: &[Interval]) -> Result<Interval, String> {
    match &claim.quantity {
        Quantity::Path(function, phase, cells) => {
            let [cover] = &claim.covers[..] else { return Err("it needs one cover".to_owned()) };
            let partial = claim.verdict == "bounded" || claim.verdict == "undecided" || claim.verdict == "refuted";
            let walk = Walk { certificate, function: *function, phase: *phase, cells: *cells, integrals };
            walk.along((cover, 0), &mut |middle, all, _| {
                Ok((all.total || partial) && claim.values.encloses(range(middle, all)))
            })?;
        }
        Quantity::Sum(summands) => {
            let count = summands.iter().filter(|(_, over)| matches!(over, Over::Phase(_))).count();
            let found = |more| sum(certificate, (summands, &claim.covers), integrals, more);
            if claim.covers.len() != count
                || !(0..=MORE / 2)
                    .try_fold(false, |done, more| Ok::<_, String>(done || claim.values.encloses(found(more)?)))?
            {
                return Err("its value is not proved to be where it is claimed to be".to_owned());
            }
        }
    }
    Ok(claim.values)
}

/// A sum of integrals and numbers, every box of a cover halved `more` times.
fn sum(
    certificate: &Certificate,
    (summands, covers): (&[(usize, Over)], &[Vec<String>]),
    integrals: &[Interval],
    more: u32,
) -> Result<Interval, String> {
    let (mut sum, mut covers) = (Interval::ZERO, covers.iter());
    for (function, over) in summands {
        match over {
            Over::Phase(phase) => {
                let cells = (0, certificate.phases[*phase].len() - 1);
                let walk = Walk { certificate, function: *function, phase: *phase, cells, integrals };
                let cover = covers.next().ok_or("a cover is missing")?;
                walk.along((cover, more), &mut |middle, all, length| {
                    sum = sum + if all.total { mean(middle, all) * length } else { Interval::ENTIRE };
                    Ok(true)
                })?;
            }
            Over::Nowhere => sum = sum + number(certificate, *function, None, integrals),
            Over::End(phase, last) => sum = sum + number(certificate, *function, Some((*phase, *last)), integrals),
        }
    }
    Ok(sum)
}

/// A function that depends on no time, or at an end of a phase.
fn number(certificate: &Certificate, function: usize, end: Option<(usize, bool)>, integrals: &[Interval]) -> Interval {
    let flats = |flat: usize| match end {
        Some((phase, last)) => end_of(certificate, flat, (end_cell(&certificate.phases[phase], last), last)),
        None => Jet::rough((Interval::ENTIRE, false)),
    };
    let tau = end.map_or(Interval::ENTIRE, |(_, last)| Interval::whole(i64::from(last)));
    let here = Here { flats: &flats, tau: Jet::constant(tau) };
    let value = evaluate(certificate, &certificate.functions[function], integrals, &here);
    if value.total { value.c[0] } else { Interval::ENTIRE }
}

fn verdict(
    certificate: &Certificate,
    (claim, values): (&Claim, Interval),
    integrals: &[Interval],
    checked: &mut Checked,
) -> Result<(), String> {
    let bound = |f: Option<usize>| f.map(|f| number(certificate, f, None, integrals));
    let (low, high) = (bound(claim.bounds.0), bound(claim.bounds.1));
    let meets = |low: Interval, high: Interval| (high - low).is_not_negative();
    match claim.verdict.as_str() {
        "proved" => {
            let equality = claim.bounds.0 == claim.bounds.1;
            if equality || !low.is_none_or(|low| meets(low, values)) || !high.is_none_or(|high| meets(values, high)) {
                return Err("its values are not within its bounds".to_owned());
            }
            checked.proved += 1;
        }
        "within" => {
            let (Some(bound), Some(residual)) = (low, claim.residual) else { return Err("no equality".to_owned()) };
            let room = Interval::point(residual).hull(Interval::point(-residual));
            if claim.bounds.0 != claim.bounds.1 || !room.encloses(values - bound) {
                return Err("its sides may differ by more".to_owned());
            }
            checked.within += 1;
        }
        "refuted" => {
            let value = match (&claim.quantity, &claim.witness) {
                (Quantity::Sum(_), _) => values,
                (Quantity::Path(function, phase, cells), Some((cell, halvings, part, value))) => {
                    let walk = Walk { certificate, function: *function, phase: *phase, cells: *cells, integrals };
                    let found = walk.middle(*cell, *halvings, *part)?;
                    if !found.total || !value.encloses(found.c[0]) {
                        return Err("the value at its witness is another".to_owned());
                    }
                    *value
                }
                _ => return Err("there is no witness".to_owned()),
            };
            let misses = |a: Interval, b: Interval| (a - b).is_positive();
            if !low.is_some_and(|low| misses(low, value)) && !high.is_some_and(|high| misses(value, high)) {
                return Err("its witness misses no bound".to_owned());
            }
            checked.refuted += 1;
        }
        "undecided" => checked.undecided += 1,
        "bounded" if low.is_none() && high.is_none() => checked.bounded += 1,
        _ => return Err(format!("`{}` cannot be claimed of it", claim.verdict)),
    }
    Ok(())
}

/// A function over some cells of a phase.
struct Walk<'a> {
    certificate: &'a Certificate,
    function: usize,
    phase: usize,
    /// The first of its cells, and the one behind the last.
    cells: (usize, usize),
    integrals: &'a [Interval],
}

/// A box: the pieces of the flats, that of scaled time, and its length.
struct Part {
    pieces: Vec<(usize, Piece)>,
    tau: Piece,
    length: Interval,
}

impl Part {
    fn halves(&self) -> [Self; 2] {
        let both = |(flat, piece): &(usize, Piece)| {
            let (left, right) = halves(piece);
            ((*flat, left), (*flat, right))
        };
        let (left, right) = self.pieces.iter().map(both).unzip();
        let (before, after) = halves(&self.tau);
        let length = self.length.scaled(-1);
        [Self { pieces: left, tau: before, length }, Self { pieces: right, tau: after, length }]
    }
}

/// Takes the jets in the middle and everywhere, and the length; says whether the box will do.
type Judge<'a> = dyn FnMut(&Jet, &Jet, Interval) -> Result<bool, String> + 'a;

impl Walk<'_> {
    fn cell(&self, cell: usize) -> Result<Part, String> {
        let (certificate, cuts) = (self.certificate, &self.certificate.phases[self.phase]);
        let mut flats = vec![];
        let mut open: Vec<&Function> = vec![&certificate.functions[self.function]];
        while let Some(function) = open.pop() {
            for input in &function.inputs {
                match input {
                    Input::Flat(flat, None) if !flats.contains(flat) => flats.push(*flat),
                    Input::Join(_, members) => open.extend(members.iter().map(|f| &certificate.functions[*f])),
                    _ => {}
                }
            }
        }
        let own = |flat: &usize| certificate.splines[certificate.flats[*flat].0].phase == self.phase;
        if !flats.iter().all(own) {
            return Err("a spline of another phase is used".to_owned());
        }
        let pieces = flats.iter().map(|flat| piece(certificate, certificate.flats[*flat], cell).map(|p| (*flat, p)));
        let ends = [cuts[cell], cuts[cell + 1]].map(Interval::point);
        Ok(Part { pieces: pieces.collect::<Result<_, _>>()?, tau: ends.to_vec(), length: ends[1] - ends[0] })
    }

    fn jets(&self, part: &Part) -> (Jet, Jet) {
        let all: Vec<(usize, (Jet, Jet))> = part.pieces.iter().map(|(flat, piece)| (*flat, jets(piece))).collect();
        let nothing = Jet::rough((Interval::ENTIRE, false));
        let find = |flat: usize| all.iter().find(|(own, _)| *own == flat).map_or((nothing, nothing), |(_, jets)| *jets);
        let function = &self.certificate.functions[self.function];
        let (tau_middle, tau_all) = jets(&part.tau);
        let middle = Here { flats: &|flat| find(flat).0, tau: tau_middle };
        let everywhere = Here { flats: &|flat| find(flat).1, tau: tau_all };
        let evaluate = |here: &Here<'_>| evaluate(self.certificate, function, self.integrals, here);
        (evaluate(&middle), evaluate(&everywhere))
    }

    /// The function in the middle of a box.
    fn middle(&self, cell: usize, halvings: u32, number: u64) -> Result<Jet, String> {
        if !(self.cells.0..self.cells.1).contains(&cell) || halvings > 63 || number >> halvings != 0 {
            return Err("its witness is at no time".to_owned());
        }
        let mut part = self.cell(cell)?;
        for bit in (0..halvings).rev() {
            let [left, right] = part.halves();
            part = if number >> bit & 1 == 1 { right } else { left };
        }
        Ok(self.jets(&part).0)
    }

    /// Goes through the boxes of a cover: for each cell a tree, `/` for a box that is halved (the first half first), `.`
    /// for one that is not.
    fn along(&self, (cover, more): (&[String], u32), judge: &mut Judge<'_>) -> Result<(), String> {
        if cover.is_empty() || self.cells.0 + cover.len() != self.cells.1 {
            return Err("its cover does not cover all times".to_owned());
        }
        for (cell, tree) in (self.cells.0..).zip(cover) {
            let mut open = vec![self.cell(cell)?];
            for letter in tree.chars() {
                let part = open.pop().ok_or("a cover has too many boxes")?;
                match letter {
                    '/' => open.extend(part.halves().into_iter().rev()),
                    '.' => self.judge(&part, judge, (more, MORE))?,
                    _ => return Err("a cover has an unknown sign".to_owned()),
                }
            }
            if !open.is_empty() {
                return Err("a cover leaves times out".to_owned());
            }
        }
        Ok(())
    }

    /// Judges a box, after so many halvings; it may be halved `MORE` times beyond.
    fn judge(&self, part: &Part, judge: &mut Judge<'_>, (first, more): (u32, u32)) -> Result<(), String> {
        if first == 0 {
            let (middle, all) = self.jets(part);
            if judge(&middle, &all, part.length)? {
                return Ok(());
            }
            if more == 0 {
                return Err("its values are not proved to be where they are claimed to be".to_owned());
            }
        }
        let left = if first > 0 { (first - 1, more) } else { (0, more - 1) };
        part.halves().iter().try_for_each(|half| self.judge(half, judge, left))
    }
}
