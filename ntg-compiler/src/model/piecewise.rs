//! Piecewise linear tables that are convex or concave, as the largest or the least of their lines (docs/maths.md,
//! section 18).
//!
//! Takes a table of one argument with `linear` interpolation and the range of its argument. Where the table's slopes do not
//! fall over this range, it is the largest of the lines through its segments, to within rounding; where they do not rise,
//! the least of them. Equal slopes are one line. Outside of its nodes a table that keeps its end value has a slope of 0.

use ntg_structure::{Table, TableExtrapolation, TableMethod, TableSymmetry};

use super::corners::Corners;
use super::elaborator::Elaborator;
use super::ranges::Ranges;
use super::unknowns::is_given;
use crate::expr::{Node, NodeId};

/// By how much of the range of its values a table may miss the largest of its lines: a hundredth of what a solve is asked
/// for, and far above what is lost where numbers are written with twelve digits.
const NEGLIGIBLE: f64 = 1e-10;
/// By how much a number is lost in adding and multiplying a few, relative to the largest. A law.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Most lines of a table for which helpers stand; one of more stays as it is. A choice: for 100 points so many rows take seconds.
const MOST_LINES: usize = 1000;

/// `value + slope * (argument - node)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) slope: f64,
    node: f64,
    value: f64,
}

/// A table by its lines over the range of its argument, from left to right.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Lines {
    /// Those of which a convex table is the largest.
    pub(super) largest: Option<Vec<Line>>,
    /// Those of which a concave table is the least.
    pub(super) least: Option<Vec<Line>>,
}

/// A node and the value there.
type Point = (f64, f64);

impl Lines {
    /// The lines of a table whose argument stays within a range; without one it may be anything.
    pub(super) fn of(table: &Table, range: Option<(f64, f64)>) -> Option<Self> {
        let points = within(points(table)?, table, range)?;
        let largest = as_largest(&points);
        let mirrored: Vec<Point> = points.iter().map(|(node, value)| (*node, -value)).collect();
        let least = as_largest(&mirrored).map(|lines| {
            let own = |line: Line| Line { slope: -line.slope, value: -line.value, ..line };
            lines.into_iter().map(own).collect()
        });
        (largest.is_some() || least.is_some()).then_some(Self { largest, least })
    }
}

impl Lines {
    /// The line that a table is over the range of its argument, where it has no corner there; of a constant one anywhere.
    pub(super) fn only(table: &Table, range: Option<(f64, f64)>) -> Option<Line> {
        let one =
            |lines: Option<Vec<Line>>| lines.filter(|lines| lines.len() == 1).and_then(|lines| lines.first().copied());
        let own = points(table)?;
        let (node, value) = *own.first()?;
        if own.iter().all(|point| point.1 == value) {
            return Some(Line { slope: 0.0, node, value });
        }
        let lines = Self::of(table, range)?;
        one(lines.least)?;
        one(lines.largest)
    }
}

/// The nodes of a table with straight lines between them, those of an even argument on both sides.
fn points(table: &Table) -> Option<Vec<Point>> {
    let [axis] = table.axes.as_slice() else { return None };
    if table.method != TableMethod::Linear || table.replaceable || axis.nodes.len() != table.values.len() {
        return None;
    }
    let own: Vec<Point> = axis.nodes.iter().copied().zip(table.values.iter().copied()).collect();
    if axis.symmetry != TableSymmetry::Even {
        return Some(own);
    }
    let left = own.iter().rev().filter(|(node, _)| *node > 0.0).map(|(node, value)| (-node, *value));
    Some(left.chain(own.iter().copied()).collect())
}

/// The segments that meet a range, which go on outside of the nodes as the table does there.
fn within(mut points: Vec<Point>, table: &Table, range: Option<(f64, f64)>) -> Option<Vec<Point>> {
    let (least, most) = range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let (first, last) = (*points.first()?, *points.last()?);
    let width = last.0 - first.0;
    let (least, most) = (least + ROUNDING * width, most - ROUNDING * width);
    let (left, right) = (least < first.0, most > last.0);
    if left || right {
        if table.axes[0].symmetry == TableSymmetry::Periodic {
            return None;
        }
        if table.extrapolation == TableExtrapolation::Clamp {
            if left {
                points.insert(0, (first.0 - width, first.1));
            }
            if right {
                points.push((last.0 + width, last.1));
            }
        }
    }
    let begin = points.iter().rposition(|(node, _)| *node <= least).unwrap_or(0);
    let end = points.iter().position(|(node, _)| *node >= most).unwrap_or(points.len() - 1);
    (begin < end).then(|| points[begin..=end].to_vec())
}

/// The lines of which a convex piecewise linear function is the largest; none where it is not convex.
///
/// By the lower hull of its nodes, of which none may be above the hull by more than is negligible.
/// Neighbouring segments of the hull are one line where the nodes between them miss it by no more. Cost: linear.
fn as_largest(points: &[Point]) -> Option<Vec<Line>> {
    let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(low, high), (_, y)| (low.min(*y), high.max(*y)));
    let negligible = NEGLIGIBLE * (high - low) + ROUNDING * low.abs().max(high.abs());
    let slope = |a: Point, b: Point| (b.1 - a.1) / (b.0 - a.0);
    let mut hull: Vec<Point> = vec![];
    for point in points {
        while let [.., a, b] = hull.as_slice()
            && slope(*a, *b) >= slope(*b, *point)
        {
            hull.pop();
        }
        hull.push(*point);
    }
    let mut segment = 0;
    for (node, value) in points {
        while segment + 2 < hull.len() && hull[segment + 1].0 <= *node {
            segment += 1;
        }
        let (a, b) = (hull[segment], *hull.get(segment + 1)?);
        if value - (a.1 + slope(a, b) * (node - a.0)) > negligible {
            return None;
        }
    }
    let mut lines = vec![];
    let mut start = hull[0];
    // The steepest line from the start that misses no node since by more than is negligible.
    let mut steepest = f64::INFINITY;
    for (at, point) in hull.iter().enumerate().skip(1) {
        steepest = steepest.min((point.1 + negligible - start.1) / (point.0 - start.0));
        let goes_on = hull.get(at + 1).is_some_and(|next| slope(start, *next) <= steepest);
        if !goes_on {
            lines.push(Line { slope: slope(start, *point), node: start.0, value: start.1 });
            (start, steepest) = (*point, f64::INFINITY);
        }
    }
    let is_finite = |line: &Line| line.slope.is_finite() && line.node.is_finite() && line.value.is_finite();
    lines.iter().all(is_finite).then_some(lines)
}

impl Elaborator<'_> {
    /// The lines of a node that is the value of a piecewise linear table, convex or concave where its argument is.
    pub(super) fn lines_of(&self, ranges: &mut Ranges, node: NodeId) -> Option<Lines> {
        let Node::Table { table, derivative, args } = self.problem.dag.node(node) else { return None };
        let ([argument], [0]) = (args.as_slice(), derivative.as_slice()) else { return None };
        let range = ranges.of_argument(&self.problem, *argument);
        Lines::of(self.problem.tables.get(*table as usize)?, range)
    }

    /// A node for each line of a table that is pushed down onto the largest of them, or up to the least.
    pub(super) fn lines_pushed(&mut self, pass: &mut Corners, table: NodeId, growing: bool) -> Option<Vec<NodeId>> {
        let Node::Table { args, .. } = self.problem.dag.node(table) else { return None };
        let argument = args[0];
        let lines = pass.tables.get(&table)?;
        let lines = (if growing { &lines.largest } else { &lines.least }).as_ref()?;
        if lines.len() > MOST_LINES {
            return None;
        }
        let along: Vec<NodeId> = lines.iter().map(|line| self.on_line(argument, *line)).collect();
        if pass.has_corners(argument) {
            along.iter().for_each(|line| self.corners_found(pass, *line));
        }
        Some(along)
    }

    /// The value of a line at an argument.
    pub(super) fn on_line(&mut self, argument: NodeId, line: Line) -> NodeId {
        let dag = &mut self.problem.dag;
        let (slope, node, value) = (dag.constant(line.slope), dag.constant(line.node), dag.constant(line.value));
        let beyond = dag.sub(argument, node);
        let rise = dag.mul(slope, beyond);
        dag.add(rise, value)
    }

    /// Whether a node is the value of a piecewise linear table, or its slope, at what is solved for.
    pub(super) fn is_piecewise(&self, node: NodeId) -> bool {
        let Node::Table { table, .. } = self.problem.dag.node(node) else { return false };
        let table = self.problem.tables.get(*table as usize);
        table.is_some_and(|table| table.method == TableMethod::Linear) && !is_given(&self.problem, node)
    }
}

#[cfg(test)]
mod tests {
    use ntg_structure::{TableAxis, Unit};

    use super::*;

    fn table(points: &[Point]) -> Table {
        let axis = TableAxis {
            name: "x".to_owned(),
            unit: Unit::default(),
            nodes: points.iter().map(|point| point.0).collect(),
            symmetry: TableSymmetry::Plain,
        };
        Table {
            name: "f".to_owned(),
            doc: String::new(),
            axes: vec![axis],
            unit: Unit::default(),
            values: points.iter().map(|point| point.1).collect(),
            method: TableMethod::Linear,
            extrapolation: TableExtrapolation::Clamp,
            replaceable: false,
        }
    }

    /// How many lines a table is the largest of, and the least of.
    fn counts(table: &Table, range: Option<(f64, f64)>) -> (Option<usize>, Option<usize>) {
        let lines = Lines::of(table, range).unwrap_or_default();
        (lines.largest.map(|lines| lines.len()), lines.least.map(|lines| lines.len()))
    }

    const FUEL: [Point; 5] = [(0.0, 0.1), (10.0, 0.7), (20.0, 1.5), (30.0, 2.4), (40.0, 3.6)];

    #[test]
    fn a_convex_table_is_the_largest_of_its_lines() {
        let lines = Lines::of(&table(&FUEL), Some((0.0, 40.0))).and_then(|lines| lines.largest).expect("convex");
        assert_eq!(lines.len(), 4);
        let made = ntg_splines::Table::new(
            vec![ntg_splines::Axis::plain(FUEL.map(|point| point.0).to_vec())],
            FUEL.map(|point| point.1).to_vec(),
            ntg_splines::Method::Linear,
            ntg_splines::Extrapolation::Clamp,
        )
        .expect("sound");
        for x in (0..=400).map(|k| 0.1 * f64::from(k)) {
            let largest = lines.iter().map(|line| line.value + line.slope * (x - line.node));
            let largest = largest.fold(f64::NEG_INFINITY, f64::max);
            assert!((largest - made.eval(&[x], &[0])).abs() < 1e-14, "{x}: {largest}");
        }
    }

    #[test]
    fn what_a_table_is_outside_its_nodes_decides() {
        let mut fuel = table(&FUEL);
        // It keeps its end values: level again beyond 40.
        assert_eq!(counts(&fuel, None), (None, None));
        assert_eq!(counts(&fuel, Some((0.0, 41.0))), (None, None));
        assert_eq!(counts(&fuel, Some((-5.0, 40.0))), (Some(5), None));
        assert_eq!(counts(&fuel, Some((40.0, 50.0))), (Some(1), Some(1)));
        assert_eq!(counts(&fuel, Some((35.0, 50.0))), (None, Some(2)));
        assert_eq!(counts(&fuel, Some((60.0, 99.0))), (Some(1), Some(1)));
        fuel.extrapolation = TableExtrapolation::Linear;
        assert_eq!(counts(&fuel, None), (Some(4), None));
        fuel.axes[0].symmetry = TableSymmetry::Even;
        assert_eq!(counts(&fuel, None), (Some(8), None));
        fuel.axes[0].symmetry = TableSymmetry::Periodic;
        assert_eq!(counts(&fuel, None), (None, None));
        fuel.axes[0].symmetry = TableSymmetry::Plain;
        fuel.replaceable = true;
        assert_eq!(counts(&fuel, None), (None, None));
    }

    #[test]
    fn only_what_the_argument_reaches_must_be_convex() {
        let table = table(&[(0.0, 0.0), (1.0, 1.0), (2.0, 1.0), (3.0, 2.0), (4.0, 4.0)]);
        assert_eq!(counts(&table, Some((0.0, 4.0))), (None, None));
        assert_eq!(counts(&table, Some((1.0, 4.0))), (Some(3), None));
        assert_eq!(counts(&table, Some((1.5, 2.5))), (Some(2), None));
        assert_eq!(counts(&table, Some((0.5, 1.5))), (None, Some(2)));
        assert_eq!(counts(&table, Some((0.2, 0.3))), (Some(1), Some(1)));
        assert_eq!(counts(&table, Some((0.2, 0.2))), (Some(1), Some(1)));
    }

    #[test]
    fn slopes_that_differ_by_rounding_are_one() {
        // Ten segments of the slope 1/3, with the rounding of thirds and of a tenth.
        let straight: Vec<Point> = (0..=10).map(|k| (0.1 * f64::from(k), 7.0 + 0.1 * f64::from(k) / 3.0)).collect();
        assert_eq!(counts(&table(&straight), Some((0.0, 1.0))), (Some(1), Some(1)));
        let mut bent = straight.clone();
        bent.push((2.0, 8.0));
        assert_eq!(counts(&table(&bent), Some((0.0, 2.0))), (Some(2), None));
        // A slope that falls by 1e-12 of itself is none that falls, one by 1e-6 is.
        let fall = |fall: f64| table(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0 - fall), (3.0, 4.0)]);
        assert_eq!(counts(&fall(1e-12), Some((0.0, 3.0))), (Some(2), None));
        assert_eq!(counts(&fall(1e-6), Some((0.0, 3.0))), (None, None));
        // A large offset hides no corner.
        let offset = table(&[(0.0, 1e6), (1.0, 1e6 + 1.0), (2.0, 1e6 + 1.999), (3.0, 1e6 + 4.0)]);
        assert_eq!(counts(&offset, Some((0.0, 3.0))), (None, None));
    }

    #[test]
    fn many_nodes_of_a_parabola_stay_exact() {
        let parabola: Vec<Point> = (0..=500).map(|k| (f64::from(k), f64::from(k * k))).collect();
        assert_eq!(counts(&table(&parabola), Some((0.0, 500.0))), (Some(500), None));
        // Bends that are rounding do not add up.
        let mut drifting: Vec<Point> = vec![(0.0, 0.0)];
        for k in 1..=10_000 {
            let (node, value) = drifting[drifting.len() - 1];
            drifting.push((node + 1.0, value + 1.0 + 1e-10 * f64::from(k)));
        }
        let lines = Lines::of(&table(&drifting), Some((0.0, 1e4))).and_then(|lines| lines.largest).expect("convex");
        assert!((10..200).contains(&lines.len()), "{}", lines.len());
        for (x, y) in drifting {
            let largest = lines.iter().map(|line| line.value + line.slope * (x - line.node));
            let largest = largest.fold(f64::NEG_INFINITY, f64::max);
            assert!((largest - y).abs() <= 2e-6, "{x}: {largest} for {y}");
        }
    }

    #[test]
    fn a_straight_table_is_one_line_where_its_ends_are_not_reached_or_go_on() {
        let mut straight = table(&[(-5.0, -11.5), (0.0, 0.0), (10.0, 23.0)]);
        let slope = |table: &Table, range| Lines::only(table, range).map(|line| line.slope);
        assert_eq!(slope(&straight, Some((-5.0, 10.0))), Some(2.3));
        assert_eq!(slope(&straight, Some((11.0, 12.0))), Some(0.0));
        assert_eq!(slope(&straight, Some((-5.0, 11.0))), None);
        assert_eq!(slope(&straight, None), None);
        straight.extrapolation = TableExtrapolation::Linear;
        assert_eq!(slope(&straight, None), Some(2.3));
        straight.values[1] = 1e-6;
        assert_eq!(slope(&straight, None), None);
        let mut constant = table(&[(0.0, 3.0), (1.0, 3.0), (4.0, 3.0)]);
        constant.axes[0].symmetry = TableSymmetry::Periodic;
        assert_eq!(slope(&constant, None), Some(0.0));
    }

    #[test]
    fn jumps_and_numbers_without_end_are_no_lines() {
        let jump = [(-1.0, 0.0), (0.0, 0.0), (1e-308, 1e308), (1.0, 1e308)];
        assert_eq!(counts(&table(&jump), Some((-1.0, 1.0))), (None, None));
        assert_eq!(counts(&table(&[(0.0, f64::MAX), (1.0, -f64::MAX)]), Some((0.0, 1.0))), (None, None));
        assert_eq!(counts(&table(&[]), None), (None, None));
    }
}
