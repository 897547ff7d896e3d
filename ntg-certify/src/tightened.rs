//! A problem with some of its constraints tightened, and held at more points.
//!
//! Kernels stay what they are: a tightened bound is the bound's own kernel with a number added, and a group that only
//! holds constraints is a selection of the rows of its kernel. Costs and integrals keep their points.

use std::collections::BTreeMap;

use ntg_runtime::problem::{Derivatives, Lanes, Problem};
use ntg_splines::Table;
use ntg_structure::{Call, Domain, Group, Instant, Kernel, Part, Points, Row, Structure};

/// What is done to one constraint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// By how much its lower bound is raised, SI.
    pub below: f64,
    /// By how much its upper bound is lowered, SI.
    pub above: f64,
    /// How many times as many points hold it along a phase, where `parts` says so; 1 adds none.
    pub points: usize,
    /// In which of the [`PARTS`] equal parts of its phases more points are, bit by bit.
    pub parts: u64,
}

/// Into how many equal parts of scaled time a phase is divided for points that are added.
pub const PARTS: usize = 64;

impl Change {
    /// Marks the parts that lie between two scaled times, and their neighbours.
    pub(crate) fn mark(&mut self, from: f64, to: f64) {
        let part = |tau: f64| ((tau * PARTS as f64) as usize).min(PARTS - 1);
        for own in part(from).saturating_sub(1)..=(part(to) + 1).min(PARTS - 1) {
            self.parts |= 1 << own;
        }
    }

    /// The part of its phases' time in which more points are.
    pub fn share(&self) -> f64 {
        f64::from(self.parts.count_ones()) / PARTS as f64
    }

    /// Marked parts that follow each other, as stretches of scaled time inside a part of the phase.
    fn stretches(&self, within: &Part) -> Vec<Part> {
        let is_marked = |own: usize| own < PARTS && self.parts >> own & 1 == 1;
        let firsts = (0..PARTS).filter(|own| is_marked(*own) && (*own == 0 || !is_marked(own - 1)));
        let stretch = |first: usize| {
            let end = (first..=PARTS).find(|own| !is_marked(*own)).unwrap_or(PARTS);
            let (from, to) = (first as f64 / PARTS as f64, end as f64 / PARTS as f64);
            let mut part = *within;
            if from > part.from.tau() {
                (part.from, part.with_first) = (Instant::new(from), true);
            }
            if to < part.to.tau() {
                (part.to, part.with_last) = (Instant::new(to), true);
            }
            (part.from.tau() < part.to.tau()).then_some(part)
        };
        firsts.filter_map(stretch).collect()
    }
}

/// A problem with changed constraints.
pub struct Tightened<'p> {
    problem: &'p dyn Problem,
    structure: Structure,
    kernels: usize,
    extra: Vec<Extra>,
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
        let kernels = structure.kernels.len();
        let mut made = Self { problem, structure, kernels, extra: vec![] };
        if again {
            made.structure.continuations.clear();
        }
        made.add_points(changes);
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
    fn tighten(&mut self, group: usize, changes: &BTreeMap<usize, Change>) {
        let group = &mut self.structure.groups[group];
        let Some(bounds) = group.bounds.clone() else { return };
        let is_changed =
            |row: &Row| matches!(row, Row::Constraint { constraint, .. } if changes.contains_key(constraint));
        if !group.rows.iter().any(is_changed) {
            return;
        }
        let mut rows: Vec<(usize, f64)> = vec![];
        for row in &mut group.rows {
            let Row::Constraint { constraint, lower, upper } = row else { continue };
            let change = changes.get(constraint).copied().unwrap_or_default();
            let equality = lower == upper;
            for (side, add) in [(&mut *lower, change.below), (&mut *upper, -change.above)] {
                if let Some(own) = side {
                    rows.push((*own, if equality { 0.0 } else { add }));
                    *own = rows.len() - 1;
                }
            }
            if equality && lower.is_some() {
                *upper = *lower; // An equality names the same row twice.
            }
        }
        let old = &self.structure.kernels[bounds.kernel];
        let shape =
            Kernel { rows: rows.len(), degree: rows.iter().map(|(row, _)| old.degree[*row]).collect(), ..old.clone() };
        let index = self.add(shape, Extra::Shifted { kernel: bounds.kernel, rows });
        // The group was found above; adding a kernel moves no group.
        for own in self.structure.groups.iter_mut().filter(|own| own.bounds.as_ref() == Some(&bounds)) {
            if own.rows.iter().any(is_changed) {
                own.bounds = Some(Call { kernel: index, ..bounds.clone() });
                break;
            }
        }
    }

    /// Adds groups that hold constraints at more points of their phases.
    fn add_points(&mut self, changes: &BTreeMap<usize, Change>) {
        let wanted = |constraint: &usize| changes.get(constraint).filter(|change| change.points > 1);
        let mut held: Vec<(usize, usize)> = vec![]; // Constraints with more points, in phases.
        for number in 0..self.structure.groups.len() {
            let group = self.structure.groups[number].clone();
            let Domain::Path { phase, points, part } = &group.domain else { continue };
            let own = &self.structure.phases[phase.phase];
            let intervals = most_intervals(own);
            // Sets that accompany Gauss points hold the same constraints again.
            let (Points::Uniform { points: count } | Points::Gauss { points: count }) = own.points[*points] else {
                continue;
            };
            let is_uniform = matches!(own.points[*points], Points::Uniform { .. });
            let mut by_factor: BTreeMap<(usize, u64), Vec<usize>> = BTreeMap::new();
            for (row, meaning) in group.rows.iter().enumerate() {
                let Row::Constraint { constraint, lower, upper } = meaning else { continue };
                if lower != upper
                    && !held.contains(&(*constraint, number))
                    && let Some(change) = wanted(constraint)
                {
                    by_factor.entry((change.points, change.parts)).or_default().push(row);
                    held.push((*constraint, number));
                }
            }
            for ((factor, parts), rows) in by_factor {
                let stretches = if is_uniform { count.saturating_sub(1).max(1) } else { intervals * (count + 1) };
                let more = Points::Uniform { points: stretches * factor + 1 };
                let set = self.structure.phases[phase.phase].points.len();
                self.structure.phases[phase.phase].points.push(more);
                let copy = self.selection(&group, &rows);
                for part in (Change { parts, ..Change::default() }).stretches(part) {
                    let domain = Domain::Path { phase: phase.clone(), points: set, part };
                    self.structure.groups.push(Group { domain, ..copy.clone() });
                }
            }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marked_parts_are_stretches_of_time() {
        let mut change = Change::default();
        assert!(change.stretches(&Part::WHOLE).is_empty());
        change.mark(0.0, 0.01);
        change.mark(0.5, 0.5);
        let found: Vec<(f64, f64)> =
            change.stretches(&Part::WHOLE).iter().map(|part| (part.from.tau(), part.to.tau())).collect();
        assert_eq!(found, [(0.0, 2.0 / 64.0), (31.0 / 64.0, 34.0 / 64.0)]);
        assert_eq!(change.share(), 5.0 / 64.0);
        change.mark(0.0, 1.0);
        assert_eq!(change.stretches(&Part::WHOLE), [Part::WHOLE]);
        let half = Part { to: Instant::new(0.5), with_last: false, ..Part::WHOLE };
        assert_eq!(change.stretches(&half), [half]);
    }
}
