//! What a certificate says of the spec's constraints, terms and named expressions, one entry for each, in units that a
//! person uses: what reports show.

use std::collections::BTreeMap;
use std::fmt;

use ntg_runtime::digits::decimals;
use ntg_structure::{Independent, Structure, Unit};

use crate::certify::{Certificate, Finding, Verdict};
use crate::interval::Interval;
use crate::statement::{Kind, Quantity, Subject};

/// What is proved of one constraint of the spec, over all of its members.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Its name, or its text in the spec.
    pub name: String,
    /// The worst of its members' verdicts, in `unit`.
    pub verdict: Verdict,
    /// Encloses all values of all members, in `unit`.
    pub values: (f64, f64),
    /// Where a bound is missed, in mission time as it is shown, and the value there.
    pub witness: Option<(f64, f64)>,
    /// What the time of the witness is in.
    pub independent: Independent,
    /// How many members and phases it has.
    pub members: usize,
    /// Whether it is about all times of a phase; else about ends or the whole.
    pub along: bool,
    /// The unit of all of these.
    pub unit: Unit,
}

/// The enclosure of a quantity over a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Where it begins, in mission time as it is shown.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// What no value is below,
    pub low: f64,
    /// and above.
    pub high: f64,
}

/// What is proved of a term of the objective or a named expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// Its name.
    pub name: String,
    /// Encloses all of its values, in `unit`.
    pub values: (f64, f64),
    /// Its enclosure over time; empty for a number.
    pub bands: Vec<Band>,
    /// The unit.
    pub unit: Unit,
}

/// Everything that a report shows of a certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// One for each constraint of the spec that has a row, in order.
    pub constraints: Vec<Proof>,
    /// For each of these its index in the structure.
    pub numbers: Vec<usize>,
    /// Terms of the objective, in the user's sense.
    pub terms: Vec<Bounds>,
    /// Named expressions, member by member and phase by phase.
    pub named: Vec<Bounds>,
    /// How many boxes of time were looked at.
    pub boxes: usize,
    /// How long that took.
    pub seconds: f64,
}

impl Certificate {
    /// What reports show.
    pub fn summary(&self, structure: &Structure) -> Summary {
        let (mut constraints, mut numbers) = (vec![], vec![]);
        for number in 0..structure.constraints.len() {
            if let Some(proof) = self.proof(structure, number) {
                constraints.push(proof);
                numbers.push(number);
            }
        }
        let of = |wanted: fn(&Kind) -> bool, sign: f64| {
            let own = self.each().filter(move |(subject, _)| wanted(&subject.kind));
            own.map(|(subject, finding)| self.bounds(&structure.independent, (subject, finding), sign)).collect()
        };
        Summary {
            constraints,
            numbers,
            terms: of(|kind| matches!(kind, Kind::Term(_)), if structure.maximize { -1.0 } else { 1.0 }),
            named: of(|kind| matches!(kind, Kind::Named(_)), 1.0),
            boxes: self.findings.iter().flat_map(|finding| &finding.covers).map(Vec::len).sum(),
            seconds: self.seconds,
        }
    }

    fn proof(&self, structure: &Structure, number: usize) -> Option<Proof> {
        let worst = self.constraint(number)?;
        let own = || self.each().filter(|(subject, _)| subject.kind == Kind::Constraint(number));
        let declared = &structure.constraints[number];
        let unit = declared.unit.factor;
        let values = values(own(), declared.sides > 0)?;
        let (subject, _) = own().find(|(_, finding)| std::ptr::eq(*finding, worst))?;
        let witness = worst
            .witness
            .and_then(|witness| self.witness_time(subject, &witness).map(|t| (t, witness.value.middle() / unit)))
            .map(|(t, value)| (structure.independent.shown(t), value));
        let verdict = match worst.verdict {
            Verdict::Within(residual) => Verdict::Within(residual / unit),
            Verdict::Refuted(least, most) => Verdict::Refuted(least / unit, most / unit),
            Verdict::Undecided(most) => Verdict::Undecided(most / unit),
            other => other,
        };
        let name = declared.name.as_deref().unwrap_or(&declared.place.text).to_owned();
        let values = (values.low() / unit, values.high() / unit);
        Some(Proof {
            name,
            verdict,
            values,
            witness,
            members: own().count(),
            along: matches!(subject.quantity, Quantity::Path(..)),
            unit: declared.unit.clone(),
            independent: structure.independent.clone(),
        })
    }

    fn bounds(&self, independent: &Independent, (subject, finding): (&Subject, &Finding), sign: f64) -> Bounds {
        let unit = subject.unit.factor;
        let of = |low: f64, high: f64| {
            let (low, high) = (sign * low / unit, sign * high / unit);
            (low.min(high), low.max(high))
        };
        let mut bands = vec![];
        if let Quantity::Path(_, phase, _) = subject.quantity {
            for leaf in finding.covers.iter().flatten() {
                let (low, high) = of(leaf.values.low(), leaf.values.high());
                let from = independent.shown(self.time(phase, leaf.cell, leaf.start()));
                let to = independent.shown(self.time(phase, leaf.cell, leaf.start() + leaf.length()));
                bands.push(Band { from, to, low, high });
            }
        }
        let values = of(finding.values.low(), finding.values.high());
        Bounds { name: subject.name.clone(), values, bands, unit: subject.unit.clone() }
    }
}

/// The values of all members. Where members have sides, that of a member is the largest or the least one of its sides at
/// each time, so that what bounds one side bounds it too.
fn values<'a>(own: impl Iterator<Item = (&'a Subject, &'a Finding)>, have_sides: bool) -> Option<Interval> {
    let mut members: BTreeMap<&str, Interval> = BTreeMap::new();
    for (subject, finding) in own {
        let (name, values) = (subject.name.as_str(), finding.values);
        let of_member = members.get(name).map(|known| match (have_sides, subject.bounds.1.is_some()) {
            (false, _) => known.hull(values),
            (true, true) => Interval::new(known.low().max(values.low()), known.high().max(values.high())),
            (true, false) => Interval::new(known.low().min(values.low()), known.high().min(values.high())),
        });
        members.insert(name, of_member.unwrap_or(values));
    }
    members.into_values().reduce(|a, b| a.hull(b))
}

impl Summary {
    /// Whether every constraint is proved, equalities to within their stated residual.
    pub fn is_proved(&self) -> bool {
        self.constraints.iter().all(|proof| proof.verdict.holds())
    }
}

impl Proof {
    /// One word: `proved`, `within`, `refuted`, `undecided`.
    pub fn word(&self) -> &'static str {
        match self.verdict {
            Verdict::Bounded | Verdict::Proved => "proved",
            Verdict::Within(_) => "within",
            Verdict::Refuted(..) => "refuted",
            Verdict::Undecided(_) => "undecided",
        }
    }

    /// The verdict in words, with its numbers.
    pub fn words(&self) -> String {
        let unit = if self.unit.symbol.is_empty() { String::new() } else { format!(" {}", self.unit.symbol) };
        match self.verdict {
            Verdict::Bounded | Verdict::Proved => "proved for all times".to_owned(),
            Verdict::Within(residual) => format!("missed by {residual:.1e}{unit} at most, proved"),
            Verdict::Refuted(least, most) => {
                let at = self.witness.map_or(String::new(), |(t, value)| {
                    let Independent { name, unit } = &self.independent;
                    format!(", value {} at {name} = {t:.4} {}", decimals(value, 6), unit.symbol).trim_end().to_owned()
                });
                format!("REFUTED: missed by {least:.3e} to {most:.3e}{unit}{at}")
            }
            Verdict::Undecided(most) if most.is_finite() => format!("undecided: missed by {most:.1e}{unit} at most"),
            Verdict::Undecided(_) => "undecided: no bound is known".to_owned(),
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = |word: &str| self.constraints.iter().filter(|proof| proof.word() == word).count();
        let open = count("refuted") + count("undecided");
        writeln!(
            f,
            "Between the points: {} ({} boxes of time, {:.3} s)",
            if open > 0 {
                format!("{open} of {} constraints not proved", self.constraints.len())
            } else if self.constraints.iter().any(|proof| proof.along && proof.word() == "within") {
                "every limit is proved for all times, and by how much equations are missed at most".to_owned()
            } else {
                "every constraint is proved for all times".to_owned()
            },
            self.boxes,
            self.seconds
        )?;
        let width = self.constraints.iter().map(|proof| proof.name.chars().count().min(MOST_NAME)).max().unwrap_or(0);
        for proof in &self.constraints {
            let name: String = proof.name.chars().take(MOST_NAME).collect();
            let values = match proof.verdict {
                Verdict::Within(_) => String::new(),
                _ => range(proof.values, SHOWN, &proof.unit.symbol),
            };
            writeln!(f, "{}", format!("  {name:<width$}  {:<22} {values}", proof.words()).trim_end())?;
        }
        for term in &self.terms {
            let name: String = term.name.chars().take(MOST_NAME).collect();
            writeln!(f, "  cost {name:<width$} {}", range(term.values, OF_COSTS, &term.unit.symbol).trim_end())?;
        }
        Ok(())
    }
}

/// Decimals of values, and of costs.
const SHOWN: i32 = 6;
const OF_COSTS: i32 = 9;

/// Both ends, rounded outward to so many decimals.
fn range((low, high): (f64, f64), decimals: i32, unit: &str) -> String {
    format!("in {} .. {} {unit}", rounded(low, decimals, -1.0), rounded(high, decimals, 1.0))
}

/// A number rounded downward (-1) or upward (1) to so many decimals; a very large one behind its first digit, with an exponent.
fn rounded(value: f64, decimals: i32, outward: f64) -> String {
    /// Where decimals without an exponent are longer than anyone reads, and no longer digits of the number.
    const LONG: f64 = 1e10;
    let places = decimals as usize;
    if !value.is_finite() {
        return value.to_string();
    }
    if value.abs() >= LONG {
        let nearest = format!("{value:.places$e}");
        let is_inward = nearest.parse().is_ok_and(|nearest: f64| (nearest - value) * outward < 0.0);
        let last = 10_f64.powi(value.abs().log10().floor() as i32 - decimals);
        return if is_inward { format!("{:.places$e}", value + outward * last) } else { nearest };
    }
    let scale = 10_f64.powi(decimals);
    // The last rounding may be wrong by one unit of the last place, far below a decimal that is shown.
    let shown = outward * (outward * value * scale).ceil() / scale + 0.0;
    format!("{shown:.places$}")
}

/// Letters of a name that a line shows.
const MOST_NAME: usize = 40;

#[cfg(test)]
mod tests {
    use super::range;

    #[test]
    fn ranges_are_rounded_outward_and_large_ones_have_an_exponent() {
        assert_eq!(range((-0.1234561, 2.0), 6, "m"), "in -0.123457 .. 2.000000 m");
        assert_eq!(range((1e300, 1.234_567_89e300), 6, ""), "in 1.000000e300 .. 1.234568e300 ");
        assert_eq!(range((-12_345_678_912.0, 1e308), 9, ""), "in -1.234567892e10 .. 1.000000000e308 ");
        assert_eq!(range((f64::NEG_INFINITY, f64::INFINITY), 6, "s"), "in -inf .. inf s");
    }
}
