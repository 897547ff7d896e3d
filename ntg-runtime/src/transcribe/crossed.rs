//! Poles that a motion crosses between the points of collocation (docs/maths.md, section 9).
//!
//! Takes the variables of a solution; gives the divisors that change their signs inside an interval of its curves, where an
//! equation that holds along a phase, or what is integrated along it, grows without limit. Such curves are no motion: a
//! quotient has finite values at all points however fast its divisor changes sign between two of them.

use super::Transcription;
use super::batch::{Batch, BatchWork, batches};
use super::elements::sites;
use super::error::SetupError;
use super::names;
use super::node::Site;
use super::points::Point;
use super::rows::group_bounds;
use super::singular::{Singular, each_probe, has_probes};
use ntg_splines::Side;
use ntg_structure::{Domain, Group, Place, Points, Row};

/// Stretches of an interval between places that are looked at. A choice: a divisor that is a polynomial of the order of splines in use changes its sign twice
/// between two of them where it hardly does.
const PLACES: usize = 8;
/// How often an interval between two places is halved about a change of sign, at most.
const HALVINGS: usize = 40;
/// Nearer to a place, in parts of the distance of places, a divisor is 0 there. A law: the tolerance.
const AT_PLACE: f64 = 1e-8;
/// The largest distance from the pole at which rows are compared, in parts of the distance of places. A choice: so near that
/// the pole outweighs what else is in the row.
const FAR: f64 = 1.0 / 1024.0;
/// How many distances there are, each a part of the one before.
const DISTANCES: i32 = 5;
const PART: f64 = 4.0;
/// Orders of poles that are looked for. A choice: formulas of physics have no higher ones.
const ORDERS: i32 = 3;
/// How far growth from one distance to the next may be from that of a pole, as a part. A law: a root of it grows by half as much,
/// a smooth row falls, and rounding of what cancels, as in `(1 - cos(x)) / x^2`, follows no power all along.
const OFF: f64 = 0.25;

/// Every expression with a divisor that changes its sign inside an interval of the curves of `x` so that they are no motion.
///
/// # Errors
/// [`SetupError`] for an index outside its family.
pub(crate) fn crossed(this: &Transcription, x: &[f64]) -> Result<Vec<Singular>, SetupError> {
    let mut found: Vec<Singular> = vec![];
    for (number, group) in this.model.structure.groups.iter().enumerate() {
        let own = this.elements.batches.iter().filter(|own| own.group == number);
        if !own.into_iter().any(|own| has_probes(this, &own.batch.node)) {
            continue;
        }
        // Other sets of points accompany these.
        let inside = |points: &Points, breakpoints: &[f64], phase: usize| match points {
            Points::Gauss { .. } | Points::Uniform { .. } => places(breakpoints, phase),
            Points::Breakpoints | Points::LeftLimits | Points::Times { .. } => vec![],
        };
        let sites = match group.domain {
            Domain::Path { .. } => sites(&this.frame(), group, inside)?,
            Domain::Mission | Domain::Start(_) | Domain::End(_) => continue,
        };
        let curves = Curves { this, group, x };
        for batch in batches(&this.frame(), &group.call, sites)? {
            if !has_probes(this, &batch.node) {
                continue;
            }
            for change in curves.changes(&batch) {
                let Some(pole) = curves.pole(&change)? else { continue };
                match found.iter_mut().find(|known| known.place == change.place) {
                    Some(known) => known.count += 1,
                    None => {
                        let point = names::point(&this.model.structure, &this.model.layout, &pole, x);
                        found.push(Singular { place: change.place, point, count: 1 });
                    }
                }
            }
        }
    }
    Ok(found)
}

/// Equally spaced places of every interval, its ends from inside.
fn places(breakpoints: &[f64], phase: usize) -> Vec<Point> {
    let place = |pair: &[f64], i: usize| match i {
        PLACES => Point { side: Side::Left, ..at(phase, pair[1]) },
        i => at(phase, pair[0] + (pair[1] - pair[0]) * i as f64 / PLACES as f64),
    };
    breakpoints.windows(2).flat_map(|pair| (0..=PLACES).map(move |i| place(pair, i))).collect()
}

fn at(phase: usize, tau: f64) -> Point {
    Point { phase: Some(phase), tau, side: Side::Right, weight: f64::NAN }
}

/// A divisor that has another sign at the next place.
struct Change {
    place: Place,
    /// Which of all probes of the group it is, and of which member of the reduction that it stands in.
    probe: usize,
    member: usize,
    site: Site,
    next: f64,
    /// The inverse of the divisor here.
    inverse: f64,
}

/// Rows and probes of a group along the curves of a solution.
#[derive(Clone, Copy)]
struct Curves<'a> {
    this: &'a Transcription<'a>,
    group: &'a Group,
    x: &'a [f64],
}

impl Curves<'_> {
    /// Where divisors change their signs inside an interval.
    fn changes(self, batch: &Batch) -> Vec<Change> {
        let mut work = batch.work();
        batch.values(self.this.problem, &self.this.model.tables, self.x, &mut work);
        let (mut found, mut visited) = (vec![], 0..);
        each_probe(self.this, (&batch.node, &work.node), &mut |node, _, place, values| {
            let probe = visited.next().unwrap_or_default();
            for (member, values) in values.chunks_exact(node.elements).enumerate() {
                for (pair, sites) in values.windows(2).zip(batch.sites.windows(2)) {
                    let [here, next] = [&sites[0], &sites[1]];
                    // A part of a branch is 0 where the branch is not taken.
                    if pair[0] * pair[1] < 0.0 && self.are_neighbours(here, next) {
                        let (place, site, next) = (place.clone(), here.clone(), next.point.tau);
                        found.push(Change { place, probe, member, site, next, inverse: pair[0] });
                    }
                }
            }
        });
        found
    }

    /// Whether two sites are places of one interval and one member.
    fn are_neighbours(self, a: &Site, b: &Site) -> bool {
        let phase = a.point.phase.unwrap_or_default();
        let breakpoints = &self.this.model.layout.phases[phase].breakpoints;
        let interval = |site: &Site| match site.point.side {
            Side::Left => breakpoints.partition_point(|breakpoint| *breakpoint < site.point.tau),
            Side::Right => breakpoints.partition_point(|breakpoint| *breakpoint <= site.point.tau),
        };
        a.is_of_member(b) && a.point.phase == b.point.phase && interval(a) == interval(b)
    }

    /// Where the divisor is 0 and a row grows as beside a pole, on both sides; none where none does.
    fn pole(self, change: &Change) -> Result<Option<Point>, SetupError> {
        let phase = change.site.point.phase.unwrap_or_default();
        let (mut low, mut high) = (change.site.point.tau, change.next);
        let step = high - low;
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            let inverse = self.inverse(change, middle)?;
            // The other sign, none at all, or no number: the change is not behind the middle.
            if inverse * change.inverse > 0.0 { low = middle } else { high = middle }
        }
        // A divisor that is 0 at a place itself, as a speed at the start, has either sign there by rounding.
        if (low - change.site.point.tau).min(change.next - low) < AT_PLACE * step {
            return Ok(None);
        }
        let is_pole = self.grows(change, (low, -step))? && self.grows(change, (low, step))?;
        Ok(is_pole.then(|| at(phase, low)))
    }

    /// Whether a row grows towards a time as beside a pole, from a distance of [`FAR`] steps on.
    fn grows(self, change: &Change, (tau, step): (f64, f64)) -> Result<bool, SetupError> {
        let distances = (0..DISTANCES).map(|number| step * FAR / PART.powi(number));
        let rows: Result<Vec<_>, _> = distances.map(|distance| self.rows(change, tau + distance)).collect();
        let rows = rows?;
        let is_of_order = |row: usize, order: i32| {
            rows.windows(3).all(|rows| {
                let [far, middle, near] = [rows[0][row], rows[1][row], rows[2][row]];
                let growth = ((near - middle) / (middle - far)).abs();
                (growth / PART.powi(order) - 1.0).abs() < OFF
            })
        };
        let count = rows.iter().map(Vec::len).min().unwrap_or(0);
        Ok((0..count).any(|row| (1..=ORDERS).any(|order| is_of_order(row, order))))
    }

    /// The batch of one member of the group at another time, evaluated.
    fn evaluated<T>(
        self,
        change: &Change,
        tau: f64,
        mut take: impl FnMut(&Batch, &BatchWork) -> T,
    ) -> Result<Option<T>, SetupError> {
        let phase = change.site.point.phase.unwrap_or_default();
        let site = Site { indices: change.site.indices.clone(), point: at(phase, tau) };
        let batches = batches(&self.this.frame(), &self.group.call, vec![site])?;
        Ok(batches.first().map(|batch| {
            let mut work = batch.work();
            batch.values(self.this.problem, &self.this.model.tables, self.x, &mut work);
            take(batch, &work)
        }))
    }

    /// The inverse of the divisor at another time.
    fn inverse(self, change: &Change, tau: f64) -> Result<f64, SetupError> {
        let own = |batch: &Batch, work: &BatchWork| {
            let (mut found, mut visited) = (f64::NAN, 0..);
            each_probe(self.this, (&batch.node, &work.node), &mut |_, _, _, values| {
                if visited.next() == Some(change.probe) {
                    found = values.get(change.member).copied().unwrap_or(f64::NAN);
                }
            });
            found
        };
        Ok(self.evaluated(change, tau, own)?.unwrap_or(f64::NAN))
    }

    /// The rows that hold all along a phase or are integrated, at another time.
    fn rows(self, change: &Change, tau: f64) -> Result<Vec<f64>, SetupError> {
        let bounds = group_bounds(&self.this.frame(), self.group, &change.site.indices)?;
        let counts = |row: &usize| match self.group.rows[*row] {
            Row::Constraint { .. } => bounds[*row].0 == bounds[*row].1,
            Row::Cost { .. } | Row::Part { .. } | Row::Integral { .. } => true,
        };
        let rows: Vec<usize> = (0..self.group.rows.len()).filter(counts).collect();
        let own = |_: &Batch, work: &BatchWork| rows.iter().map(|row| work.node.values[*row]).collect();
        Ok(self.evaluated(change, tau, own)?.unwrap_or_default())
    }
}
