//! Where arguments of tables pass nodes between two points of the finer grid (docs/maths.md, section 9).
//!
//! Between its nodes a table is a smooth piece, so that what stands out of a limit that is read from one stands out at a node: a mast
//! on terrain may be narrower than the distance of any points. The nodes are known. So the arguments of the tables of a limit are
//! evaluated at the points, where one passes a node between two of them the place is found, and the limit is evaluated there.

use crate::transcribe::batch::{Batch, BatchWork, batches};
use crate::transcribe::node::Site;
use crate::transcribe::points::Point;
use crate::transcribe::{SetupError, Transcription};
use ntg_splines::Side;
use ntg_structure::{Arguments, TableAxis, TableSymmetry};

/// Most nodes of one axis that are looked at between two points; of more that are passed these are spread over all. A choice.
const MOST: usize = 16;
/// How often a place is corrected, by a line through the ends of the stretch in which it is. A choice: of an argument that is
/// a polynomial between two points the error is then below a ten thousandth of the stretch.
const CORRECTIONS: usize = 4;

/// The arguments of the tables of one group's limits, at the points of a part of the finer grid.
#[derive(Debug)]
pub(super) struct Passing {
    /// Which of `Structure::arguments` it is.
    number: usize,
    /// The same sites, by the shapes of this call.
    batches: Vec<(Batch, BatchWork)>,
}

/// A node that is passed.
struct Passed {
    site: Site,
    /// Which argument passes it.
    row: usize,
    node: f64,
    /// Two times between which it is, and the arguments there.
    ends: [(f64, f64); 2],
}

impl Passed {
    /// Where a line through both ends passes the node.
    fn place(&self) -> f64 {
        let [(from, before), (to, after)] = self.ends;
        let at = from + (to - from) * (self.node - before) / (after - before);
        if at >= from && at <= to { at } else { f64::midpoint(from, to) }
    }

    fn at(&self) -> Site {
        let point = Point { tau: self.place(), side: Side::Right, ..self.site.point };
        Site { point, ..self.site.clone() }
    }

    /// Takes in the argument at a time between both ends.
    fn narrow(&mut self, tau: f64, value: f64) {
        if value.is_finite() {
            let is_behind = (value < self.node) == (self.ends[0].1 < self.node);
            self.ends[usize::from(!is_behind)] = (tau, value);
        }
    }
}

impl Passing {
    /// The arguments of a group, counted as [`ntg_structure::Structure::group`] does; none where no limit has tables.
    pub(super) fn of(nlp: &Transcription, group: usize, sites: &[Site]) -> Result<Option<Self>, SetupError> {
        let structure = &nlp.model.structure;
        let is_own = |own: &Arguments| own.group + if own.shown { structure.groups.len() } else { 0 } == group;
        let Some(number) = structure.arguments.iter().position(is_own) else { return Ok(None) };
        let batches = batches(&nlp.frame(), &structure.arguments[number].call, sites.to_vec())?.into_iter();
        let batches = batches.map(|batch| {
            let work = batch.work();
            (batch, work)
        });
        Ok(Some(Self { number, batches: batches.collect() }))
    }

    /// Takes in other values of parameters.
    pub(super) fn take_data(&mut self, nlp: &Transcription) -> Result<(), SetupError> {
        let call = &nlp.model.structure.arguments[self.number].call;
        self.batches.iter_mut().try_for_each(|(batch, work)| batch.take_data_into(&nlp.frame(), call, work))
    }

    /// Adds the places at which nodes are passed.
    pub(super) fn nodes(&mut self, nlp: &Transcription, x: &[f64], found: &mut Vec<Site>) -> Result<(), SetupError> {
        let structure = &nlp.model.structure;
        let Arguments { call, axes, .. } = &structure.arguments[self.number];
        for (batch, work) in &mut self.batches {
            batch.values(nlp.problem, &nlp.model.tables, x, work);
            let mut passed = vec![];
            for (row, (table, axis)) in axes.iter().enumerate() {
                let Some(axis) = structure.tables.get(*table).and_then(|table| table.axes.get(*axis)) else { continue };
                let values = &work.node.values[row * batch.sites.len()..][..batch.sites.len()];
                passed.extend(stretches(&batch.sites, values).flat_map(|(site, ends)| {
                    let nodes = between(axis, ends[0].1, ends[1].1).into_iter();
                    nodes.map(move |node| Passed { site: site.clone(), row, node, ends })
                }));
            }
            for _ in 0..CORRECTIONS {
                if passed.is_empty() {
                    break;
                }
                let own = batches(&nlp.frame(), call, passed.iter().map(Passed::at).collect())?;
                // Sites of one shape are those of one batch, in their order.
                let [own] = &own[..] else { break };
                let mut work = own.work();
                own.values(nlp.problem, &nlp.model.tables, x, &mut work);
                for (element, passed) in passed.iter_mut().enumerate() {
                    let tau = passed.place();
                    passed.narrow(tau, work.node.values[passed.row * own.sites.len() + element]);
                }
            }
            found.extend(passed.iter().map(Passed::at));
        }
        Ok(())
    }
}

/// Neighbouring points of one member inside of one interval, with the times and the values there.
fn stretches<'a>(sites: &'a [Site], values: &'a [f64]) -> impl Iterator<Item = (&'a Site, [(f64, f64); 2])> {
    let pairs = sites.windows(2).zip(values.windows(2));
    let ends = pairs.map(|(sites, values)| (&sites[0], &sites[1], [values[0], values[1]]));
    // Breakpoints stand twice, once from either side.
    let follows = |one: &Site, next: &Site| {
        one.is_of_member(next) && one.point.phase == next.point.phase && one.point.tau < next.point.tau
    };
    ends.filter(move |(one, next, _)| follows(one, next))
        .map(|(one, next, values)| (one, [(one.point.tau, values[0]), (next.point.tau, values[1])]))
}

/// The nodes of an axis between two values, ends left out; at most [`MOST`].
fn between(axis: &TableAxis, one: f64, other: f64) -> Vec<f64> {
    let (low, high) = (one.min(other), one.max(other));
    if !(low < high && low.is_finite() && high.is_finite()) {
        return vec![];
    }
    let of = |nodes: &[f64], shift: f64| -> Vec<f64> {
        let from = nodes.partition_point(|node| node + shift <= low);
        let to = nodes.partition_point(|node| node + shift < high).max(from);
        spread(&nodes[from..to]).map(|node| node + shift).collect()
    };
    let nodes = &axis.nodes[..];
    let all: Vec<f64> = match (axis.symmetry, nodes) {
        (TableSymmetry::Plain, _) => of(nodes, 0.0),
        (TableSymmetry::Even, _) => {
            let mirrored: Vec<f64> = nodes.iter().rev().map(|node| -node).collect();
            let own = of(nodes, 0.0);
            of(&mirrored, 0.0).into_iter().filter(|node| *node != 0.0).chain(own).collect()
        }
        (TableSymmetry::Periodic, [first, .., last]) if last > first => {
            let period = last - first;
            let turns = ((low - first) / period).floor()..=((high - first) / period).floor();
            let count = (turns.end() - turns.start()).min(MOST as f64);
            // The last node is the first one again.
            let own = &nodes[..nodes.len() - 1];
            (0..=count as usize).flat_map(|turn| of(own, (turns.start() + turn as f64) * period)).collect()
        }
        (TableSymmetry::Periodic, _) => vec![],
    };
    spread(&all).collect()
}

/// All of a list, or [`MOST`] spread over it.
fn spread(list: &[f64]) -> impl Iterator<Item = f64> {
    let count = list.len().min(MOST);
    (0..count).map(move |i| list[i * list.len() / count.max(1)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use ntg_structure::Unit;

    fn axis(nodes: &[f64], symmetry: TableSymmetry) -> TableAxis {
        TableAxis { name: "u".to_owned(), unit: Unit::default(), nodes: nodes.to_vec(), symmetry }
    }

    #[test]
    fn nodes_between_two_values_are_those_of_the_axis_and_its_images() {
        let plain = axis(&[0.0, 1.0, 3.0], TableSymmetry::Plain);
        assert_eq!(between(&plain, 3.0, 0.5), [1.0]);
        assert_eq!(between(&plain, 0.0, 0.0), [0.0; 0]);
        assert_eq!(between(&plain, f64::NAN, 2.0), [0.0; 0]);
        let even = axis(&[0.0, 1.0, 3.0], TableSymmetry::Even);
        assert_eq!(between(&even, -1.5, 0.5), [-1.0, 0.0]);
        let periodic = axis(&[0.0, 1.0, 4.0], TableSymmetry::Periodic);
        assert_eq!(between(&periodic, 3.5, 8.5), [4.0, 5.0, 8.0]);
        assert_eq!(between(&periodic, -3.5, -2.5), [-3.0]);
    }

    #[test]
    fn of_very_many_nodes_some_are_spread_over_all() {
        let nodes: Vec<f64> = (0..1000).map(f64::from).collect();
        let some = between(&axis(&nodes, TableSymmetry::Plain), -1.0, 2000.0);
        assert_eq!((some.len(), some[0]), (MOST, 0.0));
        assert!(some[MOST - 1] > 900.0 && some.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(between(&axis(&[0.0, 1.0], TableSymmetry::Periodic), -1e6, 1e6).len(), MOST);
    }
}
