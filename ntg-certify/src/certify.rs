//! From a statement to what is proved of it: one [`Finding`] for each subject.

use std::collections::BTreeMap;

use crate::evaluate::Machine;
use crate::interval::Interval;
use crate::prove::{self, Goal, Leaf, Options, Required, Search, Witness, integral, search};
use crate::statement::{Kind, Over, Quantity, Statement, Subject, Summand};
use crate::tube::Evidence;

/// What is known of the required bounds of a subject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// It has no bounds; what it can be is all there is to say.
    Bounded,
    /// Its bounds hold at every time, in real arithmetic.
    Proved,
    /// An equality: its two sides differ by no more than this at any time, in SI units.
    Within(f64),
    /// A bound is missed for certain: by at least the first, nowhere by more than the second.
    Refuted(f64, f64),
    /// Neither proved nor refuted; a bound is missed by no more than this, which is at the limit of what the
    /// arithmetic or the number of boxes can tell.
    Undecided(f64),
}

impl Verdict {
    /// Whether nothing is left to be wished.
    pub fn holds(&self) -> bool {
        matches!(self, Self::Bounded | Self::Proved | Self::Within(_))
    }
}

/// What was found of one subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What is known of its bounds.
    pub verdict: Verdict,
    /// Encloses every value that it takes; widened a little, so that another arithmetic finds it too.
    pub values: Interval,
    /// The bounds that it was to keep.
    pub required: Option<(f64, f64)>,
    /// Where a bound is missed, for what runs over a phase.
    pub witness: Option<Witness>,
    /// The boxes of each search: one for what runs over a phase, and one for each integral of a sum.
    pub covers: Vec<Vec<Leaf>>,
}

/// What is proved of a trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// What it is about.
    pub statement: Statement,
    /// What is known of the integrals that functions use, with the boxes of each of their summands.
    pub integrals: Vec<(Interval, Vec<Vec<Leaf>>)>,
    /// One for each subject.
    pub findings: Vec<Finding>,
    /// What proves tubes, where they were asked for.
    pub tubes: Vec<Evidence>,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// Bounds every subject of a statement.
pub fn certify(statement: Statement, options: &Options) -> Certificate {
    constraints(statement, options).completed(options)
}

/// Bounds the constraints of a statement; of terms and named expressions nothing is said yet.
pub fn constraints(statement: Statement, options: &Options) -> Certificate {
    let began = std::time::Instant::now();
    let mut machine = Machine::new(&statement);
    let mut integrals: Vec<(Interval, Vec<Vec<Leaf>>)> = vec![];
    // An integral may use those before it; one that is used before it is known has no bounds.
    for (number, summands) in statement.integrals.iter().enumerate() {
        let (value, covers) = sum(&machine, summands, options);
        let value = summed(value);
        machine.integrals[number] = value;
        integrals.push((value, covers));
    }
    let each = statement.subjects.iter().map(|subject| match subject.kind {
        Kind::Constraint(_) => finding(&machine, (subject, None), options),
        Kind::Term(_) | Kind::Named(_) => Finding::unknown(),
    });
    let findings = each.collect();
    let seconds = began.elapsed().as_secs_f64();
    drop(machine);
    Certificate { statement, integrals, findings, tubes: vec![], seconds }
}

impl Finding {
    /// Nothing is said.
    fn unknown() -> Self {
        Self { verdict: Verdict::Bounded, values: Interval::ENTIRE, required: None, witness: None, covers: vec![] }
    }
}

impl Certificate {
    /// With the bounds of terms and named expressions.
    #[must_use]
    pub fn completed(mut self, options: &Options) -> Self {
        let began = std::time::Instant::now();
        let mut machine = Machine::new(&self.statement);
        machine.integrals = self.integrals.iter().map(|(value, _)| *value).collect();
        // Members of a named expression are seen side by side: the range of all tells how finely each is to be known.
        let mut attained: BTreeMap<usize, Interval> = BTreeMap::new();
        for subject in &self.statement.subjects {
            let (Kind::Named(number), Quantity::Path(function, phase, cells)) = (subject.kind, &subject.quantity)
            else {
                continue;
            };
            if let Some(own) = prove::attained(&machine, (*function, *phase, cells.clone())) {
                let all = attained.entry(number).or_insert(own);
                *all = all.hull(own);
            }
        }
        for (subject, found) in self.statement.subjects.iter().zip(&mut self.findings) {
            if !matches!(subject.kind, Kind::Constraint(_)) {
                let elsewhere = if let Kind::Named(number) = subject.kind { attained.get(&number) } else { None };
                *found = finding(&machine, (subject, elsewhere.copied()), options);
            }
        }
        drop(machine);
        self.seconds += began.elapsed().as_secs_f64();
        self
    }

    /// Whether every constraint is proved, equalities to within their stated residual.
    pub fn is_proved(&self) -> bool {
        self.findings.iter().all(|finding| finding.verdict.holds())
    }

    /// Subjects with what was found of them.
    pub fn each(&self) -> impl Iterator<Item = (&Subject, &Finding)> {
        self.statement.subjects.iter().zip(&self.findings)
    }

    /// What is known of one constraint of the structure, over all of its members: the worst of them.
    pub fn constraint(&self, number: usize) -> Option<&Finding> {
        let own = self.each().filter(|(subject, _)| subject.kind == Kind::Constraint(number));
        own.map(|(_, finding)| finding).reduce(|a, b| if rank(&b.verdict) > rank(&a.verdict) { b } else { a })
    }

    /// A time within a phase, in seconds of mission time.
    pub fn time(&self, phase: usize, cell: usize, part: f64) -> f64 {
        let phase = &self.statement.phases[phase];
        let tau = phase.cuts[cell] + (phase.cuts[cell + 1] - phase.cuts[cell]) * part;
        let [start, duration] = [phase.start, phase.duration].map(|number| self.statement.numbers[number].value);
        start + duration * tau
    }

    /// The mission time of a witness.
    pub fn witness_time(&self, subject: &Subject, witness: &Witness) -> Option<f64> {
        let Quantity::Path(_, phase, _) = subject.quantity else { return None };
        Some(self.time(phase, witness.cell, (witness.part as f64 + 0.5) * 0.5_f64.powi(witness.halvings as i32)))
    }
}

/// How bad a verdict is, and among equals by how much.
fn rank(verdict: &Verdict) -> (u8, f64) {
    match *verdict {
        Verdict::Bounded => (0, 0.0),
        Verdict::Proved => (1, 0.0),
        Verdict::Within(residual) => (2, residual),
        Verdict::Undecided(missed) => (3, missed),
        Verdict::Refuted(missed, _) => (4, missed),
    }
}

/// What a bound of a subject is: its enclosure.
fn bound(machine: &Machine<'_>, function: Option<usize>) -> Option<Interval> {
    let value = machine.number(function?, None);
    Some(if value.total { value.c[0] } else { Interval::ENTIRE })
}

/// What is found of a subject, of which values may be known to be attained elsewhere.
fn finding(machine: &Machine<'_>, (subject, elsewhere): (&Subject, Option<Interval>), options: &Options) -> Finding {
    let (below, above) = (bound(machine, subject.bounds.0), bound(machine, subject.bounds.1));
    let equality = subject.bounds.0.is_some() && subject.bounds.0 == subject.bounds.1;
    let required = (below.is_some() || above.is_some()).then(|| Required {
        low: below.map_or(f64::NEG_INFINITY, Interval::high),
        high: above.map_or(f64::INFINITY, Interval::low),
    });
    match &subject.quantity {
        Quantity::Path(function, phase, cells) => {
            let goal = match required {
                Some(required) if !equality => Goal::Bounds(required),
                _ => Goal::Range(elsewhere),
            };
            let found = search(machine, (*function, *phase, cells.clone()), &goal, options);
            path(found, (required, equality), (below, subject.unit.factor))
        }
        Quantity::Sum(summands) => {
            let (value, covers) = sum(machine, summands, options);
            let value = if covers.is_empty() { value } else { summed(value) };
            let total = value.is_bounded();
            let verdict = match (required, equality) {
                (None, _) => Verdict::Bounded,
                (Some(_), true) => Verdict::Within(residual(outward(value), below, subject.unit.factor)),
                (Some(required), false) => judge(required.missed(value), total),
            };
            let values = within_required(value, (&verdict, required), subject.unit.factor);
            let required = required.map(|r| (r.low, r.high));
            Finding { verdict, values, required, witness: None, covers }
        }
    }
}

/// What was found of a function along a phase.
fn path(
    found: Search,
    (required, equality): (Option<Required>, bool),
    (below, unit): (Option<Interval>, f64),
) -> Finding {
    let total = found.leaves.iter().all(|leaf| leaf.total);
    let verdict = match required {
        None => Verdict::Bounded,
        Some(_) if equality => {
            Verdict::Within(if total { residual(outward(found.values), below, unit) } else { f64::INFINITY })
        }
        Some(required) => {
            let least = found.witness.map_or(0.0, |witness| required.surely_missed(witness.value));
            judge((least, found.missed), total)
        }
    };
    let values = within_required(found.values, (&verdict, required), unit);
    let required = required.map(|r| (r.low, r.high));
    Finding { verdict, values, required, witness: found.witness, covers: vec![found.leaves] }
}

fn judge((least, most): (f64, f64), total: bool) -> Verdict {
    let most = if total { most } else { f64::INFINITY };
    if least > 0.0 {
        Verdict::Refuted(least, most)
    } else if most <= 0.0 {
        Verdict::Proved
    } else {
        Verdict::Undecided(most)
    }
}

/// A sine that all but vanishes is known to sixty bits of what it is multiplied with, and not of itself; factors of
/// thousands of units are common.
const OF_UNIT: f64 = 1e-14;

/// The largest difference of values from the two ends of what they should be, with [`OF_UNIT`] of room.
fn residual(values: Interval, bound: Option<Interval>, unit: f64) -> f64 {
    let size = (values - bound.unwrap_or(Interval::ENTIRE)).size();
    (Interval::point(size) + Interval::point(OF_UNIT * unit.abs())).high()
}

/// Four to eight units of the last place.
const ROUNDINGS: f64 = 1e-15;

/// Widened by some roundings: an arithmetic of more digits finds its enclosure inside.
pub(crate) fn outward(values: Interval) -> Interval {
    let slack = ROUNDINGS * values.size();
    Interval::new(values.low() - slack - f64::MIN_POSITIVE, values.high() + slack + f64::MIN_POSITIVE)
}

/// As [`outward`], and by a part of its own width: sums of many boxes are as wide as their rests, which another
/// arrangement of the same operations finds a little larger.
fn summed(values: Interval) -> Interval {
    let slack = 0.01 * values.width();
    outward(if slack.is_finite() { Interval::new(values.low() - slack, values.high() + slack) } else { values })
}

/// What a certificate claims: the enclosure, widened, but not beyond bounds that are proved.
fn within_required(values: Interval, (verdict, required): (&Verdict, Option<Required>), unit: f64) -> Interval {
    let wide = outward(values);
    match (verdict, required) {
        // Of an equality as much more as its residual has.
        (Verdict::Within(_), _) => wide + Interval::of_constants(-1.0, 1.0) * (OF_UNIT * unit.abs()),
        (Verdict::Proved, Some(required)) => wide.within(required.low, required.high).unwrap_or(values),
        _ => wide,
    }
}

impl Required {
    /// By how much a value that is known misses the bounds: at least, and at most.
    fn missed(&self, value: Interval) -> (f64, f64) {
        (self.surely_missed(value), self.missed_at_most(value))
    }

    /// By how much a value misses the bounds at least, if by more than some roundings: what less is missed, another
    /// arithmetic may not find.
    fn surely_missed(&self, value: Interval) -> f64 {
        if self.missed_at_least(outward(value)) > 0.0 { self.missed_at_least(value) } else { 0.0 }
    }
}

/// A sum of integrals and numbers, with the boxes of each integral.
fn sum(machine: &Machine<'_>, summands: &[Summand], options: &Options) -> (Interval, Vec<Vec<Leaf>>) {
    let (mut total, mut covers) = (Interval::ZERO, vec![]);
    for summand in summands {
        let at = |end| {
            let value = machine.number(summand.function, end);
            if value.total { value.c[0] } else { Interval::ENTIRE }
        };
        let value = match summand.over {
            Over::Nowhere => at(None),
            Over::Start(phase) => at(Some((phase, false))),
            Over::End(phase) => at(Some((phase, true))),
            Over::Phase(phase) => {
                let (value, found) = integral(machine, (summand.function, phase), options);
                covers.push(found.leaves);
                value
            }
        };
        total = total + value;
    }
    (total, covers)
}
