//! Lines along which a function of two coordinates has a value: marching squares.
//!
//! Takes a function and a rectangle; gives lines whose points lie on the level to a small part of a grid's cell. Cells
//! at whose corners the function is not finite are left out.

use indexmap::IndexMap;

/// Cells in each direction.
const CELLS: usize = 100;
/// Halvings of an edge of the grid in which the level is crossed.
const HALVINGS: usize = 14;

/// A rectangle: least and greatest of both coordinates.
pub(crate) type Rectangle = [(f64, f64); 2];

/// A function on the nodes of a grid.
pub(crate) struct Grid {
    rectangle: Rectangle,
    values: Vec<f64>,
}

/// Two neighbouring nodes, the lesser first.
type Edge = (usize, usize);

impl Grid {
    /// Evaluates a function.
    pub(crate) fn new(rectangle: Rectangle, function: impl Fn(&[[f64; 2]]) -> Vec<f64>) -> Self {
        let nodes: Vec<[f64; 2]> = (0..(CELLS + 1) * (CELLS + 1)).map(|node| place(&rectangle, node)).collect();
        Self { values: function(&nodes), rectangle }
    }

    /// Round values of which lines show how the function runs in a part of the rectangle, about seven; none for a constant.
    pub(crate) fn levels(&self, core: &Rectangle) -> Vec<f64> {
        let is_within = |at: [f64; 2]| at.iter().zip(core).all(|(at, (low, high))| low <= at && at <= high);
        let nodes = self.values.iter().enumerate().filter(|(node, _)| is_within(place(&self.rectangle, *node)));
        levels(nodes.map(|(_, value)| *value))
    }

    /// Lines of one value. The first point stands again at the end of a closed line.
    pub(crate) fn lines(&self, level: f64, function: impl Fn(&[[f64; 2]]) -> Vec<f64>) -> Vec<Vec<[f64; 2]>> {
        let mut neighbours: IndexMap<Edge, Vec<Edge>> = IndexMap::new();
        for (a, b) in self.segments(level) {
            neighbours.entry(a).or_default().push(b);
            neighbours.entry(b).or_default().push(a);
        }
        let edges: Vec<Edge> = neighbours.keys().copied().collect();
        let points = self.crossings(&edges, level, function);
        let [(left, right), (low, high)] = self.rectangle;
        let tolerance = 4e-4 * (right - left).max(high - low);
        let at = |edge: &Edge| neighbours.get_index_of(edge).map_or([f64::NAN; 2], |index| points[index]);
        joined(&neighbours).iter().map(|line| simplified(&line.iter().map(at).collect::<Vec<_>>(), tolerance)).collect()
    }

    /// Pairs of edges between which the level runs through a cell.
    fn segments(&self, level: f64) -> Vec<(Edge, Edge)> {
        let mut found = vec![];
        for i in 0..CELLS {
            for j in 0..CELLS {
                let first = i * (CELLS + 1) + j;
                // Around the cell.
                let corners = [first, first + 1, first + CELLS + 2, first + CELLS + 1];
                if corners.iter().any(|node| !self.values[*node].is_finite()) {
                    continue;
                }
                let above = corners.map(|node| self.values[node] > level);
                let crossed = (0..4).filter(|k| above[*k] != above[(k + 1) % 4]);
                let crossed: Vec<Edge> = crossed.map(|k| edge(corners[k], corners[(k + 1) % 4])).collect();
                match crossed[..] {
                    [a, b] => found.push((a, b)),
                    [a, b, c, d] => {
                        // A saddle: its middle says which corners belong together.
                        let middle = corners.iter().map(|node| self.values[*node]).sum::<f64>() / 4.0;
                        let joins_first = (middle > level) == above[0];
                        found.extend(if joins_first { [(a, b), (c, d)] } else { [(d, a), (b, c)] });
                    }
                    _ => {}
                }
            }
        }
        found
    }

    /// Where the level crosses edges.
    fn crossings(&self, edges: &[Edge], level: f64, function: impl Fn(&[[f64; 2]]) -> Vec<f64>) -> Vec<[f64; 2]> {
        let mut ends: Vec<([f64; 2], [f64; 2])> =
            edges.iter().map(|(a, b)| (place(&self.rectangle, *a), place(&self.rectangle, *b))).collect();
        let middle = |(a, b): &([f64; 2], [f64; 2])| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        for _ in 0..HALVINGS {
            let middles: Vec<[f64; 2]> = ends.iter().map(middle).collect();
            let values = function(&middles);
            for (k, end) in ends.iter_mut().enumerate() {
                let same = (values[k] > level) == (self.values[edges[k].0] > level);
                *(if same { &mut end.0 } else { &mut end.1 }) = middles[k];
            }
        }
        ends.iter().map(middle).collect()
    }
}

/// About this many lines of one function are drawn.
const LINES: f64 = 7.0;

/// Round numbers between the least and the greatest of some values.
pub(crate) fn levels(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let finite = values.filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if high.is_infinite() || high - low <= 1e-6 * high.abs().max(low.abs()) {
        return vec![];
    }
    let raw = (high - low) / LINES;
    let power = 10.0_f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|m| m * power >= raw).unwrap_or(10.0) * power;
    let first = (low / step).ceil();
    (0..=LINES as usize).map(|k| (first + k as f64) * step).filter(|level| *level <= high).collect()
}

/// Where a node of the grid is.
fn place([(left, right), (low, high)]: &Rectangle, node: usize) -> [f64; 2] {
    let (i, j) = (node / (CELLS + 1), node % (CELLS + 1));
    let along = |first: f64, last: f64, k: usize| first + (last - first) * k as f64 / CELLS as f64;
    [along(*left, *right, i), along(*low, *high, j)]
}

fn edge(a: usize, b: usize) -> Edge {
    (a.min(b), a.max(b))
}

/// Chains of neighbours: open ones from an end, then closed ones.
fn joined(neighbours: &IndexMap<Edge, Vec<Edge>>) -> Vec<Vec<Edge>> {
    let mut seen = vec![false; neighbours.len()];
    let mut lines = vec![];
    let open = neighbours.iter().filter(|(_, next)| next.len() == 1).map(|(edge, _)| *edge);
    for start in open.chain(neighbours.keys().copied()) {
        let (mut line, mut here) = (vec![], Some(start));
        while let Some(edge) = here {
            let Some(index) = neighbours.get_index_of(&edge).filter(|index| !seen[*index]) else { break };
            seen[index] = true;
            line.push(edge);
            let next = neighbours[index].iter().copied();
            here = next.into_iter().find(|edge| neighbours.get_index_of(edge).is_some_and(|index| !seen[index]));
        }
        let closes = line.len() > 2 && line.last().is_some_and(|last| neighbours[last].contains(&start));
        if closes {
            line.push(start);
        }
        if line.len() > 1 {
            lines.push(line);
        }
    }
    lines
}

/// The line without points that lie within a tolerance of their neighbours' chords (Douglas and Peucker).
fn simplified(line: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let mut keep = vec![false; line.len()];
    // A closed line is cut in its middle: its ends are one point.
    let middle = line.len() / 2;
    let mut open = vec![(0, middle), (middle, line.len() - 1)];
    while let Some((from, to)) = open.pop() {
        (keep[from], keep[to]) = (true, true);
        let (a, b) = (line[from], line[to]);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
        let off = |at: [f64; 2]| (dx * (at[1] - a[1]) - dy * (at[0] - a[0])).abs() / length;
        let worst = (from + 1..to).max_by(|i, j| off(line[*i]).total_cmp(&off(line[*j])));
        if let Some(worst) = worst.filter(|worst| off(line[*worst]) > tolerance) {
            open.extend([(from, worst), (worst, to)]);
        }
    }
    line.iter().zip(keep).filter(|(_, keep)| *keep).map(|(at, _)| *at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(function: fn(f64, f64) -> f64, level: f64) -> Vec<Vec<[f64; 2]>> {
        let all = |points: &[[f64; 2]]| points.iter().map(|[x, y]| function(*x, *y)).collect::<Vec<_>>();
        Grid::new([(-4.0, 4.0), (-3.0, 3.0)], all).lines(level, all)
    }

    #[test]
    fn a_circle_is_one_closed_line_of_its_radius() {
        let found = lines(|x, y| x.hypot(y), 2.0);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].first(), found[0].last());
        assert!(found[0].len() < 200, "{} points", found[0].len());
        assert!(found[0].iter().all(|[x, y]| (x.hypot(*y) - 2.0).abs() < 1e-4));
    }

    #[test]
    fn a_straight_border_is_two_points_and_a_saddle_two_lines() {
        let found = lines(|_, y| y, 1.0);
        assert_eq!(found.len(), 1);
        assert!(found[0].len() <= 3 && found[0].iter().all(|at| (at[1] - 1.0).abs() < 1e-4), "{found:?}");
        let found = lines(|x, y| x * y, 0.3);
        assert_eq!(found.len(), 2);
        assert!(found.iter().flatten().all(|[x, y]| (x * y - 0.3).abs() < 1e-3));
    }

    #[test]
    fn levels_are_round_and_lie_within() {
        assert_eq!(levels([0.3, 7.2, f64::NAN].into_iter()), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        assert_eq!(levels([-0.04, 0.11].into_iter()).len(), 3, "in steps of 0.05");
        assert!(levels([2.0, 2.0].into_iter()).is_empty() && levels([f64::NAN].into_iter()).is_empty());
    }

    #[test]
    fn where_a_function_is_not_finite_there_is_no_line() {
        assert!(lines(|x, _| if x > -10.0 { f64::NAN } else { x }, 0.0).is_empty());
        let half = lines(|x, y| if y < 0.0 { f64::NAN } else { x }, 0.5);
        assert!(half.len() == 1 && half[0].iter().all(|at| at[1] >= 0.0));
    }
}
