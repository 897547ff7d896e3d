//! Tubes: how far what satisfies equations of motion is from the splines of a phase (docs/maths.md, section 15.7).
//!
//! A certificate has, for every box of time, a reference near the splines and sets that the differences from it are
//! claimed not to leave. That they do not, and what the differences at the end of the box are, is proved here.

use crate::boxes::{Part, Walk};
use crate::check::number;
use crate::evaluate::{evaluate, jets, needs};
use crate::interval::Interval;
use crate::jet::{Jet, range};
use crate::read::{Certificate, Flat, Quantity, Sound, Step, Tube};

type Rows = Vec<Vec<Interval>>;

/// How many powers of the rates make the transition over a box; the next one bounds the rest.
const POWERS: i64 = 8;

/// A tube, and the equations of motion: functions, and the numbers that they equal.
struct System<'a> {
    certificate: &'a Certificate,
    integrals: &'a [Interval],
    tube: &'a Tube,
    equations: Vec<(usize, Interval)>,
}

/// Between two boxes, the components are in these rows times these numbers, of which the last is 1.
type Front = (Rows, Vec<Interval>);

/// Proves a tube; `ends` has the differences at the end of the components of those before it, by mission time, and gets
/// its own.
pub(crate) fn tube(certificate: &Certificate, tube: &Tube, known: &[Interval], ends: &mut Vec<Interval>) -> Sound<()> {
    let cells = (0, certificate.phases[tube.phase].len() - 1);
    let system = System::of(certificate, known, tube)?;
    let functions: Vec<usize> = system.equations.iter().map(|equation| equation.0).collect();
    let mut walk = Walk::of(certificate, &functions, tube.phase, cells);
    walk.flats.extend(tube.components.iter().map(|own| own.flat));
    let first = walk.part((0, 0, 0))?;
    let (mut rows, mut extents) = (vec![], vec![]);
    for (c, own) in tube.components.iter().enumerate() {
        let start = tube.steps.first().and_then(|step| step.start.get(c)).ok_or("no box is described")?;
        rows.push([&unit(tube.components.len(), c)[..], &[*start]].concat());
        let handed = own.begin.map_or(Interval::ZERO, |number| ends.get(number).copied().unwrap_or(Interval::ENTIRE));
        extents.push(first.piece(own.flat)[0] + handed * system.unit(own.flat) - *start);
    }
    extents.push(Interval::whole(1));
    let (mut steps, mut front) = (tube.steps.iter(), (rows, extents));
    walk.along(&tube.cover, &mut |part| {
        front = system.step(part, steps.next().ok_or("a box is not described")?, &front)?;
        Ok(())
    })?;
    let last = walk.part((cells.1 - 1, 0, 0))?;
    for (own, row) in tube.components.iter().zip(&front.0) {
        let spline = last.piece(own.flat).pop().unwrap_or(Interval::ENTIRE);
        let apart = (dot(row, &front.1) - spline).over(system.unit(own.flat));
        if !own.bounds[1].encloses(apart) {
            return Err("its end may be missed".to_owned());
        }
        ends.push(apart);
    }
    Ok(())
}

impl<'a> System<'a> {
    /// Makes sure that no equation of motion is left out, and that there are as many as unknowns.
    fn of(certificate: &'a Certificate, known: &'a [Interval], tube: &'a Tube) -> Sound<Self> {
        let cells = (0, certificate.phases[tube.phase].len() - 1);
        let (mut equations, mut flats) = (vec![], vec![]);
        for (number_of, claim) in certificate.claims.iter().enumerate() {
            let (Quantity::Path(f, phase, own), Some(bound)) = (&claim.quantity, claim.bounds.0) else { continue };
            let needed = needs(certificate, &[*f]);
            if (*phase, *own) != (tube.phase, cells) || claim.bounds.1 != Some(bound) {
                continue;
            } else if tube.equations.contains(&number_of) {
                equations.push((*f, number(certificate, bound, known)));
                flats.extend(needed);
            } else if needed.iter().any(|flat| flat.1 > 0) {
                return Err(format!("claim {number_of} is left out"));
            }
        }
        let low = |flat: &Flat| tube.highest.iter().all(|own| own.0 != flat.0 || flat.1 <= own.1);
        let single = |own: &Flat| tube.highest.iter().filter(|other| other.0 == own.0).count() == 1;
        let counts = [equations.len(), tube.equations.len()] == [tube.highest.len(); 2];
        if !counts || tube.components.is_empty() || !flats.iter().all(low) || !tube.highest.iter().all(single) {
            return Err("its equations do not determine its unknowns".to_owned());
        }
        Ok(Self { certificate, integrals: known, tube, equations })
    }

    /// How much more a derivative is by mission time than by scaled time, inverted.
    fn unit(&self, flat: Flat) -> Interval {
        self.certificate.durations[self.tube.phase].power(flat.1 as u32)
    }

    /// From where a box begins to where it ends (docs/maths.md, equations 15.11 to 15.13).
    fn step(&self, part: &Part, step: &Step, (before, extents): &Front) -> Sound<Front> {
        let (components, count, width) = (&self.tube.components, self.tube.components.len(), extents.len());
        let lists = [step.start.len(), step.inside.len(), step.slack.len(), step.directions.len()];
        let unknowns = self.tube.highest.len();
        if lists != [count, count, unknowns, count * count] || step.highest.len() < unknowns {
            return Err("a box is not described in full".to_owned());
        }
        let reference = self.reference(part, step);
        let inside = [&step.inside[..], &[Interval::whole(1)]].concat();
        let mut rates = self.rates(&reference, step, &inside)?;
        // Columns: the directions, the constants, and all differences, which bound the rest of the series.
        let mut term = before.clone();
        for (c, own) in components.iter().enumerate() {
            term[c][width - 1] = term[c][width - 1] - step.start[c];
            let during = part.length.hull(Interval::ZERO);
            let reached = dot(&term[c], extents) + during * dot(&rates[c], &inside);
            let (near, spline) = (jets(&reference.piece(own.flat)), jets(&part.piece(own.flat)));
            let apart = range(&(near.0 - spline.0), &(near.1 - spline.1)) + reached;
            if !step.inside[c].encloses(reached) {
                return Err("the differences may leave their box".to_owned());
            }
            if !own.bounds[0].encloses(apart.over(self.unit(own.flat))) {
                return Err("it may be left".to_owned());
            }
            term[c].push(step.inside[c]);
        }
        term.push([vec![Interval::ZERO; width - 1], vec![Interval::whole(1); 2]].concat());
        rates.push(vec![Interval::ZERO; count + 1]);
        let mut image = term.clone();
        for k in 1..=POWERS {
            term = times(&rates, &term, part.length.over(Interval::whole(k)));
            image.iter_mut().zip(&term).for_each(|(row, more)| (0..width).for_each(|j| row[j] = row[j] + more[j]));
        }
        let rest = times(&rates, &term, part.length.over(Interval::whole(POWERS + 1)));
        let mut after: Rows = step.directions.chunks(count).map(<[_]>::to_vec).collect();
        let mut inverse = after.clone();
        image.truncate(count);
        for (c, own) in components.iter().enumerate() {
            image[c][width - 1] = image[c][width - 1] + rest[c][width];
            image[c].truncate(width);
            inverse[c].extend(unit(count, c));
            after[c].extend(reference.piece(own.flat).pop());
        }
        let inverse = solved(inverse).ok_or("its directions are not proved to be independent")?;
        let turned = times(&inverse, &image, Interval::whole(1));
        Ok((after, turned.iter().map(|row| dot(row, extents)).chain([Interval::whole(1)]).collect()))
    }

    /// The box with the reference instead of the splines: the highest derivatives, integrated (docs/maths.md, equation
    /// 15.8).
    fn reference(&self, part: &Part, step: &Step) -> Part {
        let (mut pieces, components) = (vec![], &self.tube.components);
        let length = step.highest.len() / self.tube.highest.len();
        for (highest, given) in self.tube.highest.iter().zip(step.highest.chunks(length)) {
            let mut above = given.to_vec();
            pieces.push((*highest, above.clone()));
            for (own, start) in components.iter().zip(&step.start).rev().filter(|(own, _)| own.flat.0 == highest.0) {
                let by = part.length.over(Interval::whole(above.len() as i64));
                let mut integral = vec![*start];
                above.iter().for_each(|b| integral.push(integral[integral.len() - 1] + *b * by));
                pieces.push((own.flat, integral.clone()));
                above = integral;
            }
        }
        // The first one that is found is the one that counts.
        pieces.extend(part.pieces.iter().cloned());
        Part { pieces, length: part.length }
    }

    /// The derivatives of the differences are these rows times the differences and 1; the differences of the highest
    /// derivatives stay where they are said to (docs/maths.md, equations 15.9 to 15.11).
    fn rates(&self, reference: &Part, step: &Step, inside: &[Interval]) -> Sound<Rows> {
        let components = self.tube.components.iter().map(|own| own.flat);
        let unknown: Vec<Flat> = self.tube.highest.iter().copied().chain(components).collect();
        let apart = [&step.slack[..], &step.inside].concat();
        let around = |flat: Flat| {
            let by = unknown.iter().position(|own| *own == flat).map_or(Interval::ZERO, |own| apart[own]);
            reference.piece(flat).into_iter().reduce(Interval::hull).unwrap_or(Interval::ENTIRE) + by
        };
        let mut rows: Rows = vec![];
        for (function, bound) in &self.equations {
            let used = needs(self.certificate, &[*function]);
            let slope = |by: &Flat| {
                let here = |flat: Flat| Jet::of(&[around(flat), Interval::whole((flat == *by).into())]);
                let found = evaluate(self.certificate, *function, self.integrals, &here);
                if found.total { found.c[1] } else { Interval::ENTIRE }
            };
            let (middle, all) = reference.jets(self.certificate, *function, self.integrals);
            let missed = if all.total { range(&middle, &all) - *bound } else { Interval::ENTIRE };
            let slopes = unknown.iter().map(|by| if used.contains(by) { slope(by) } else { Interval::ZERO });
            rows.push(slopes.chain([missed]).collect());
        }
        let highest = solved(rows).ok_or("the equations are not proved to determine the highest derivatives")?;
        let highest: Rows = highest.iter().map(|row| row.iter().map(|x| -*x).collect()).collect();
        if !highest.iter().zip(&step.slack).all(|(row, slack)| slack.encloses(dot(row, inside))) {
            return Err("the highest derivatives may leave their box".to_owned());
        }
        let mut rates = vec![];
        for own in &unknown[highest.len()..] {
            let next = unknown.iter().position(|next| *next == (own.0, own.1 + 1)).unwrap_or(0);
            let chain = || unit(inside.len(), next - highest.len());
            rates.push(highest.get(next).cloned().unwrap_or_else(chain));
        }
        Ok(rates)
    }
}

/// Reduces rows whose first columns are a square matrix until it is the identity, and gives the others: all solutions for
/// all matrices and right-hand sides inside; none where a matrix is not proved to be regular.
fn solved(mut rows: Rows) -> Option<Rows> {
    let size = rows.len();
    for k in 0..size {
        let least = |row: &Vec<Interval>| row[k].abs().ends.map(|ends| ends.0);
        let pivot = (k..size).filter(|i| !rows[*i][k].has_zero()).max_by_key(|i| least(&rows[*i]))?;
        rows.swap(k, pivot);
        let own: Vec<Interval> = rows[k].iter().map(|x| x.over(rows[k][k])).collect();
        for row in rows.iter_mut() {
            let factor = row[k];
            (k + 1..row.len()).for_each(|j| row[j] = row[j] - factor * own[j]);
        }
        rows[k] = own;
    }
    Some(rows.into_iter().map(|row| row[size..].to_vec()).collect())
}

/// Zeros, but for a one.
fn unit(size: usize, at: usize) -> Vec<Interval> {
    (0..size).map(|j| Interval::whole((j == at).into())).collect()
}

fn dot(a: &[Interval], b: &[Interval]) -> Interval {
    a.iter().zip(b).fold(Interval::ZERO, |sum, (a, b)| sum + *a * *b)
}

/// The product, and a number.
fn times(a: &Rows, b: &Rows, by: Interval) -> Rows {
    let columns: Rows = (0..b[0].len()).map(|j| b.iter().map(|row| row[j]).collect()).collect();
    a.iter().map(|row| columns.iter().map(|column| dot(row, column) * by).collect()).collect()
}
