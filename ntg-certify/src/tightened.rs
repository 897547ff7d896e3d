//! A problem with some of its constraints tightened, and held at more points.
//!
//! Kernels stay what they are: a tightened bound is the bound's own kernel with a number added, and a group that only
//! holds constraints is a selection of the rows of its kernel. Costs and integrals keep their points.

use std::collections::{BTreeMap, BTreeSet};

use ntg_runtime::problem::{Derivatives, Lanes, Problem};
use ntg_runtime::solution::Solution;
use ntg_splines::Table;
use ntg_structure::{Affine, Call, Domain, Group, Instant, Kernel, Loop, Points, Row, Structure};

use crate::change::{Change, SAME, Spared, cut, each_level, stretches};

/// A problem with changed constraints.
pub struct Tightened<'p> {
    problem: &'p dyn Problem,
    structure: Structure,
    kernels: usize,
    extra: Vec<Extra>,
    /// How many groups are the problem's own.
    own: usize,
    /// Groups of constraints that end conditions meet which hold them where they are tightened.
    inside: BTreeSet<usize>,
}

/// A kernel made of another.
enum Extra {
    /// Rows of a kernel without slots, each with a number added.
    Shifted { kernel: usize, rows: Vec<(usize, f64)> },
    /// Some rows of a kernel, with the entries of its Jacobian that are theirs.
    Rows { kernel: usize, rows: Vec<usize>, entries: Vec<usize> },
}

impl<'p> Tightened<'p> {
    /// Changes constraints, by their index in the structure. `again` leaves continuations out: the solve starts from a
    /// solution.
    pub fn new(problem: &'p dyn Problem, changes: &BTreeMap<usize, Change>, again: bool) -> Self {
        let structure = problem.structure();
        let (kernels, own) = (structure.kernels.len(), structure.groups.len());
        let mut made = Self { problem, structure, kernels, extra: vec![], own, inside: BTreeSet::new() };
        if again {
            made.structure.continuations.clear();
        }
        made.add_points(changes);
        made.add_insides(changes);
        for group in 0..made.structure.groups.len() {
            made.tighten(group, changes);
        }
        made
    }

    /// Adds a kernel of this shape.
    fn add(&mut self, shape: Kernel, extra: Extra) -> usize {
        self.structure.kernels.push(shape);
        self.extra.push(extra);
        self.structure.kernels.len() - 1
    }

    /// Gives each constraint of a group bounds of its own, changed.
    fn tighten(&mut self, number: usize, changes: &BTreeMap<usize, Change>) {
        let group = &mut self.structure.groups[number];
        let Some(bounds) = group.bounds.clone() else { return };
        let is_changed =
            |row: &Row| matches!(row, Row::Constraint { constraint, .. } if changes.contains_key(constraint));
        if !group.rows.iter().any(is_changed) {
            return;
        }
        let mut rows: Vec<(usize, f64)> = vec![];
        for row in &mut group.rows {
            let Row::Constraint { constraint, lower, upper } = row else { continue };
            let change = changes.get(constraint).cloned().unwrap_or_default();
            let stays = lower == upper || (change.spares_ends() && !self.inside.contains(&number));
            let is_equality = lower == upper;
            for (side, add) in [(&mut *lower, change.below), (&mut *upper, -change.above)] {
                if let Some(own) = side {
                    rows.push((*own, if stays { 0.0 } else { add }));
                    *own = rows.len() - 1;
                }
            }
            if is_equality && lower.is_some() {
                *upper = *lower; // An equality names the same row twice.
            }
        }
        let old = &self.structure.kernels[bounds.kernel];
        let shape =
            Kernel { rows: rows.len(), degree: rows.iter().map(|(row, _)| old.degree[*row]).collect(), ..old.clone() };
        let kernel = self.add(shape, Extra::Shifted { kernel: bounds.kernel, rows });
        self.structure.groups[number].bounds = Some(Call { kernel, ..bounds });
    }

    /// Adds groups that hold constraints at more points of their phases.
    fn add_points(&mut self, changes: &BTreeMap<usize, Change>) {
        for number in 0..self.own {
            let group = self.structure.groups[number].clone();
            let Domain::Path { phase, points, .. } = &group.domain else { continue };
            let own = &self.structure.phases[phase.phase];
            // Sets that accompany Gauss points hold the same constraints again.
            let nodes = match own.points[*points] {
                Points::Uniform { points } => Nodes { intervals: points.saturating_sub(1).max(1), are_held: true },
                Points::Gauss { points } => Nodes { intervals: most_intervals(own) * (points + 1), are_held: false },
                _ => continue,
            };
            for (change, rows) in alike(&group, changes) {
                for (members, times) in by_times(&group, &change, nodes) {
                    let set = self.set(phase.phase, Points::Times { times });
                    self.hold(&members, (set, &rows), (&change, true));
                }
            }
        }
    }

    /// A set of points of a phase, added where there is none alike.
    fn set(&mut self, phase: usize, points: Points) -> usize {
        let sets = &mut self.structure.phases[phase].points;
        sets.iter().position(|own| *own == points).unwrap_or_else(|| {
            sets.push(points);
            sets.len() - 1
        })
    }

    /// Adds groups that hold tightened constraints at their own points, but for where they are spared.
    fn add_insides(&mut self, changes: &BTreeMap<usize, Change>) {
        for number in 0..self.own {
            let group = self.structure.groups[number].clone();
            let Domain::Path { points, .. } = &group.domain else { continue };
            for (change, rows) in alike(&group, changes) {
                if change.spares_ends() && change.below.max(change.above) > 0.0 {
                    self.hold(&group, (*points, &rows), (&change, false));
                }
            }
        }
    }

    /// Adds groups that hold some rows of a group at other points where a change does not spare it, or `everywhere`.
    fn hold(&mut self, group: &Group, (set, rows): (usize, &[usize]), (change, everywhere): (&Change, bool)) {
        let Domain::Path { phase, part, .. } = &group.domain else { return };
        let copy = self.selection(group, rows);
        let (from, to) = inside(&self.structure.phases[phase.phase], change.ends);
        for (times, is_inside) in [((0.0, from), false), ((from, to), true), ((to, 1.0), false)] {
            let Some(mut part) = cut(part, times).filter(|_| is_inside || everywhere) else { continue };
            if is_inside {
                part.with_first &= change.ends[0] == Spared::Nothing || part.from != Instant::START;
                part.with_last &= change.ends[1] == Spared::Nothing || part.to != Instant::END;
                self.inside.insert(self.structure.groups.len());
            }
            let domain = Domain::Path { phase: phase.clone(), points: set, part };
            self.structure.groups.push(Group { domain, ..copy.clone() });
        }
    }

    /// Some rows of a group.
    fn selection(&mut self, group: &Group, rows: &[usize]) -> Group {
        let old = &self.structure.kernels[group.call.kernel];
        let place = |row: usize| rows.iter().position(|own| *own == row);
        let entries: Vec<usize> = (0..old.jacobian.len()).filter(|e| place(old.jacobian[*e].0).is_some()).collect();
        let shape = Kernel {
            rows: rows.len(),
            jacobian: entries
                .iter()
                .filter_map(|e| place(old.jacobian[*e].0).map(|row| (row, old.jacobian[*e].1)))
                .collect(),
            degree: rows.iter().map(|row| old.degree[*row]).collect(),
            ..old.clone()
        };
        let kernel = self.add(shape, Extra::Rows { kernel: group.call.kernel, rows: rows.to_vec(), entries });
        Group {
            call: Call { kernel, ..group.call.clone() },
            rows: rows.iter().map(|row| group.rows[*row].clone()).collect(),
            ..group.clone()
        }
    }

    fn extra(&self, kernel: usize) -> Option<&Extra> {
        kernel.checked_sub(self.kernels).and_then(|extra| self.extra.get(extra))
    }

    /// How many rows a kernel of the problem itself has.
    fn rows(&self, kernel: usize) -> usize {
        self.structure.kernels[kernel].rows
    }
}

/// The inequalities of a group that are changed, by what is done to them.
fn alike(group: &Group, changes: &BTreeMap<usize, Change>) -> Vec<(Change, Vec<usize>)> {
    let mut found: Vec<(Change, Vec<usize>)> = vec![];
    let mut held: BTreeSet<usize> = BTreeSet::new();
    for (row, meaning) in group.rows.iter().enumerate() {
        let Row::Constraint { constraint, lower, upper } = meaning else { continue };
        let Some(change) = changes.get(constraint).filter(|_| lower != upper && held.insert(*constraint)) else {
            continue;
        };
        match found.iter_mut().find(|(own, _)| own == change) {
            Some((_, rows)) => rows.push(row),
            None => found.push((change.clone(), vec![row])),
        }
    }
    found
}

/// Equally spaced points of which levels have multiples.
#[derive(Clone, Copy)]
struct Nodes {
    /// Into how many parts they divide a phase.
    intervals: usize,
    /// Whether a group holds its constraints at them.
    are_held: bool,
}

/// The members of a group that are held at more times: the group itself where all have the same, a group for each member
/// else.
fn by_times(group: &Group, change: &Change, nodes: Nodes) -> Vec<(Group, Vec<Instant>)> {
    let members = Solution::members(&group.loops);
    let times: Vec<Vec<Instant>> = members.iter().map(|member| times(change, member, nodes)).collect();
    if let Some(first) = times.first().filter(|first| times.iter().all(|own| own == *first)) {
        return if first.is_empty() { vec![] } else { vec![(group.clone(), first.clone())] };
    }
    let held = members.iter().zip(times).filter(|(_, times)| !times.is_empty());
    held.map(|(member, times)| (alone(group, member), times)).collect()
}

/// The times at which a member is held besides its own points, rising.
fn times(change: &Change, member: &[i64], nodes: Nodes) -> Vec<Instant> {
    let levels = change.levels_of(member);
    let mut times: Vec<f64> = change.times_of(member).collect();
    for level in each_level(&levels) {
        let count = nodes.intervals << level;
        for (from, to) in stretches(&levels, level) {
            times.extend([from, to]);
            let (first, last) = ((from * count as f64).ceil() as usize, (to * count as f64).floor() as usize);
            times.extend((first..=last).map(|node| node as f64 / count as f64));
        }
    }
    let is_held = |tau: f64| {
        let node = tau * nodes.intervals as f64;
        nodes.are_held && (node - node.round()).abs() <= SAME * nodes.intervals as f64
    };
    times.retain(|tau| !is_held(*tau));
    times.sort_by(f64::total_cmp);
    times.dedup_by(|later, earlier| *later - *earlier <= SAME);
    times.into_iter().map(Instant::new).collect()
}

/// One member of a group.
fn alone(group: &Group, member: &[i64]) -> Group {
    let only = |index: &i64| Loop { first: Affine::constant(*index), last: Affine::constant(*index) };
    Group { loops: member.iter().map(only).collect(), ..group.clone() }
}

/// Scaled times between which bounds are tightened: without the first and the last interval where these are spared.
fn inside(phase: &ntg_structure::Phase, ends: [Spared; 2]) -> (f64, f64) {
    let inner = |own: &[f64]| own.iter().copied().filter(|tau| *tau > 0.0 && *tau < 1.0).collect::<Vec<f64>>();
    let all: Vec<f64> = phase.outputs.iter().flat_map(|output| inner(&output.spline.breakpoints)).collect();
    let from = if ends[0] == Spared::Interval { all.iter().copied().fold(1.0, f64::min) } else { 0.0 };
    let to = if ends[1] == Spared::Interval { all.iter().copied().fold(from, f64::max) } else { 1.0 };
    (from, to)
}

/// The intervals of the output that has most.
fn most_intervals(phase: &ntg_structure::Phase) -> usize {
    phase.outputs.iter().map(|output| output.spline.breakpoints.len() - 1).max().unwrap_or(1)
}

/// Copies columns of `lanes` numbers.
fn select(from: &[f64], columns: impl Iterator<Item = (usize, f64)>, lanes: usize, to: &mut [f64]) {
    for (to, (column, add)) in to.chunks_exact_mut(lanes.max(1)).zip(columns) {
        for (to, from) in to.iter_mut().zip(&from[column * lanes..][..lanes]) {
            *to = from + add;
        }
    }
}

impl Problem for Tightened<'_> {
    fn structure(&self) -> Structure {
        self.structure.clone()
    }

    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], values: &mut [f64]) {
        let (own, rows): (usize, Vec<(usize, f64)>) = match self.extra(kernel) {
            None => return self.problem.values(kernel, lanes, inputs, tables, values),
            Some(Extra::Shifted { kernel, rows }) => (*kernel, rows.clone()),
            Some(Extra::Rows { kernel, rows, .. }) => (*kernel, rows.iter().map(|row| (*row, 0.0)).collect()),
        };
        let mut all = vec![0.0; self.rows(own) * lanes];
        self.values(own, lanes, inputs, tables, &mut all);
        select(&all, rows.into_iter(), lanes, values);
    }

    fn derivatives(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>) {
        let (own, rows, entries): (usize, Vec<(usize, f64)>, &[usize]) = match self.extra(kernel) {
            None => return self.problem.derivatives(kernel, point, tables, out),
            Some(Extra::Shifted { kernel, rows }) => (*kernel, rows.clone(), &[]),
            Some(Extra::Rows { kernel, rows, entries }) => {
                (*kernel, rows.iter().map(|row| (*row, 0.0)).collect(), entries)
            }
        };
        let lanes = point.lanes;
        let mut weights = vec![0.0; self.rows(own) * lanes];
        for ((row, _), weight) in rows.iter().zip(point.weights.chunks_exact(lanes.max(1))) {
            // A row that stands for two bounds has the weights of both.
            weights[row * lanes..][..lanes].iter_mut().zip(weight).for_each(|(sum, weight)| *sum += weight);
        }
        let mut values = vec![0.0; self.rows(own) * lanes];
        let mut jacobian = vec![0.0; self.structure.kernels[own].jacobian.len() * lanes];
        let all = Derivatives { values: &mut values, jacobian: &mut jacobian, hessian: out.hessian };
        self.derivatives(own, Lanes { weights: &weights, ..point }, tables, all);
        select(&values, rows.into_iter(), lanes, out.values);
        select(&jacobian, entries.iter().map(|entry| (*entry, 0.0)), lanes, out.jacobian);
    }

    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]) {
        let own = match self.extra(kernel) {
            None => return self.problem.probes(kernel, lanes, inputs, tables, probes),
            Some(Extra::Shifted { kernel, .. } | Extra::Rows { kernel, .. }) => *kernel,
        };
        self.probes(own, lanes, inputs, tables, probes);
    }
}
