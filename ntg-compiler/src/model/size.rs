//! How large the program would be: what is counted before anything of it is made.
//!
//! Takes the finished problem.
//! Finds: a problem of which unknowns, rows and members of sums need more memory than there is.
//! Families and loops are counted, never run through; only nested loops of unequal length are, up to [`MOST_VISITS`].

use std::collections::HashMap;

use super::check::{coefficients, members};
use super::elaborator::Elaborator;
use super::problem::{Bounds, Collocation, Domain, Duration, IndexId, Leaf, Loop, Part, PhaseAt};
use super::scope::{Allow, Point};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Node, NodeId};
use crate::source::Span;

/// The most unknowns and rows. A memory budget of 4 GB: a fit of 2.5 to 4 kB for each of them, bounds, derivatives and
/// factors of the solver included.
const MOST: i64 = 1_000_000;
/// So many values inside sums and costs take the memory of one row: a fit of 0.4 to 2 kB for each.
const VALUES_OF_A_ROW: i64 = 4;
/// The most members that are counted one by one, and then only where the length of a loop changes with an outer index.
const MOST_VISITS: i64 = 2 * MOST;

/// What one statement makes.
#[derive(Clone, Copy, Default)]
struct Size {
    unknowns: i64,
    rows: i64,
    /// Evaluations that are no rows: members of sums, points of integrals, costs, what is shown.
    values: i64,
}

impl Size {
    fn plus(self, other: Self) -> Self {
        Self {
            unknowns: self.unknowns.saturating_add(other.unknowns),
            rows: self.rows.saturating_add(other.rows),
            values: self.values.saturating_add(other.values),
        }
    }

    /// As much memory as so many rows.
    fn weight(self) -> i64 {
        self.unknowns.saturating_add(self.rows).saturating_add(self.values / VALUES_OF_A_ROW)
    }

    fn words(self) -> String {
        let parts = [
            (self.unknowns, "unknown", "unknowns"),
            (self.rows, "row", "rows"),
            (self.values, "value in sums and costs", "values in sums and costs"),
        ];
        let parts: Vec<String> = parts
            .iter()
            .filter(|(count, ..)| *count > 0)
            .map(|(count, one, many)| format!("{} {}", grouped(*count), if *count == 1 { one } else { many }))
            .collect();
        match parts.split_last() {
            Some((last, [])) => last.clone(),
            Some((last, before)) => format!("{} and {last}", before.join(", ")),
            None => String::new(),
        }
    }
}

impl Elaborator<'_> {
    /// Tells when the problem is too large to be solved, at the statement that makes it so more than others.
    pub(super) fn check_size(&mut self) {
        let parts = self.sizes();
        let all = parts.iter().fold(Size::default(), |all, (_, size)| all.plus(*size));
        if all.weight() <= MOST {
            return;
        }
        let Some((span, largest)) = parts.into_iter().max_by_key(|(_, size)| size.weight()) else { return };
        let message = format!("this problem is too large to be solved: {}", all.words());
        let limit = grouped(MOST);
        let finding = Diagnostic::new(Code::TooLarge, span, message).label(span, format!("{} here", largest.words()));
        self.report(finding.help(format!(
            "write fewer members, intervals or points: a problem has at most {limit} unknowns and rows, which need about \
             4 GB; {VALUES_OF_A_ROW} values in sums and costs count as one"
        )));
    }

    fn sizes(&self) -> Vec<(Span, Size)> {
        let problem = &self.problem;
        let mut sizes = Vec::new();
        for (k, phase) in problem.phases.iter().enumerate() {
            let copies = count(&self.phase_context(k, Allow::All, Point::Nowhere).loops);
            let free = i64::from(matches!(phase.duration, Duration::Free(_)));
            sizes.push((phase.span, Size { unknowns: copies.saturating_mul(free), ..Size::default() }));
            for output in &phase.outputs {
                let elements = output.family.map_or(1, |(first, last)| (last - first).saturating_add(1).max(0));
                let each = whole(coefficients(&output.spline));
                let unknowns = copies.saturating_mul(elements).saturating_mul(each);
                sizes.push((output.span, Size { unknowns, ..Size::default() }));
            }
        }
        for variable in &problem.variables {
            let unknowns = variable.family.as_ref().map_or(1, |family| count(std::slice::from_ref(family)));
            sizes.push((variable.span, Size { unknowns, ..Size::default() }));
        }
        for constraint in &problem.constraints {
            let rows =
                count(&constraint.loops).saturating_mul(self.collocated_rows(&constraint.domain, &constraint.bounds));
            let times = self.evaluation_points(&constraint.domain);
            let mut values = self.inner(constraint.body, &constraint.loops).saturating_mul(times);
            for bound in [constraint.bounds.lower, constraint.bounds.upper].into_iter().flatten() {
                values = values.saturating_add(self.inner(bound, &constraint.loops));
            }
            sizes.push((constraint.span, Size { rows, values, ..Size::default() }));
        }
        let measured = problem.measurements.iter().map(|m| (m.span, &m.loops, m.cost));
        let costs = problem.objective.iter().map(|term| (term.span, &term.loops, term.body)).chain(measured);
        let guesses = problem.guesses.iter().map(|guess| (problem.span, count(&guess.loops)));
        let costs = costs.map(|(span, loops, body)| (span, self.evaluations(body, loops)));
        let named = problem.named.iter().map(|named| {
            let times = self.evaluation_points(&named.domain);
            (named.span, self.evaluations(named.body, &named.loops).saturating_mul(times))
        });
        let shown = costs.chain(named).chain(guesses);
        sizes.extend(shown.map(|(span, values)| (span, Size { values, ..Size::default() })));
        sizes
    }

    /// How often an expression and what it sums up are evaluated under given loops, at one point.
    fn evaluations(&self, body: NodeId, loops: &[Loop]) -> i64 {
        count(loops).saturating_add(self.inner(body, loops))
    }

    /// How often the members of sums and the integrands inside an expression are evaluated.
    fn inner(&self, body: NodeId, loops: &[Loop]) -> i64 {
        let problem = &self.problem;
        let mut all: i64 = 0;
        for node in problem.dag.schedule_outside(&[body]) {
            let own = match problem.dag.node(node) {
                Node::Reduce { range, body, .. } => {
                    let mut loops = loops.to_vec();
                    loops.push(problem.ranges[*range as usize].clone());
                    self.evaluations(*body, &loops)
                }
                Node::Input(input) => match problem.leaves.leaf(*input) {
                    Leaf::Integral { phase, integrand } => {
                        let points = self.quadrature(phase.phase);
                        self.evaluations(*integrand, loops).saturating_mul(points)
                    }
                    _ => 0,
                },
                _ => 0,
            };
            all = all.saturating_add(own);
        }
        all
    }

    /// How many rows a constraint makes for one member.
    fn collocated_rows(&self, domain: &Domain, bounds: &Bounds) -> i64 {
        let Domain::Path(at, part) = domain else { return 1 };
        let intervals = self.intervals(at, part);
        match self.problem.phases[at.phase].collocation {
            Collocation::Uniform { points } => whole(points),
            Collocation::Gauss { equalities, .. } if bounds.lower.is_some() && bounds.lower == bounds.upper => {
                intervals.saturating_mul(whole(equalities))
            }
            Collocation::Gauss { points, ends, .. } => {
                intervals.saturating_mul(whole(points) + i64::from(ends)).saturating_add(i64::from(ends))
            }
        }
    }

    /// At how many points an expression is evaluated.
    fn evaluation_points(&self, domain: &Domain) -> i64 {
        match domain {
            Domain::Path(at, _) => self.quadrature(at.phase),
            _ => 1,
        }
    }

    fn quadrature(&self, phase: usize) -> i64 {
        match self.problem.phases[phase].collocation {
            Collocation::Uniform { points } => whole(points),
            Collocation::Gauss { points, .. } => {
                let at = PhaseAt { phase, agent: None, index: None };
                self.intervals(&at, &Part::WHOLE).saturating_mul(whole(points))
            }
        }
    }

    /// How many intervals a part of a phase has: of its finest output, since breakpoints mostly coincide.
    fn intervals(&self, at: &PhaseAt, part: &Part) -> i64 {
        let (from, to) = (part.from.tau(), part.to.tau());
        let within = |breakpoints: &[f64]| breakpoints.windows(2).filter(|w| w[1] > from && w[0] < to).count();
        let outputs = &self.problem.phases[at.phase].outputs;
        whole(outputs.iter().map(|output| within(&output.spline.breakpoints)).max().unwrap_or(1))
    }
}

/// How many members nested loops have on every level, the empty ones of inner levels included: all of them are visited.
fn count(loops: &[Loop]) -> i64 {
    let mut visits = 0;
    // Too many to be visited: at most so many, on the level that has the most.
    let most = || (1..=loops.len()).map(|levels| members(&loops[..levels])).max().unwrap_or(1);
    counted(loops, &mut HashMap::new(), &mut visits).unwrap_or_else(most)
}

/// The same, exactly; none after too many visits. `indices` holds the values of the outer ones.
fn counted(loops: &[Loop], indices: &mut HashMap<IndexId, i64>, visits: &mut i64) -> Option<i64> {
    let Some((over, inner)) = loops.split_first() else { return Some(1) };
    let (first, last) = (over.first.at(indices), over.last.at(indices));
    let own = last.saturating_sub(first).saturating_add(1).max(0);
    let names = |form: &super::problem::Form| form.terms.iter().any(|(index, _)| *index == over.index);
    if !inner.iter().any(|over| names(&over.first) || names(&over.last)) {
        indices.insert(over.index, first);
        return Some(own.saturating_mul(counted(inner, indices, visits)?.max(1)));
    }
    let mut all: i64 = 0;
    for value in first..=last {
        *visits += 1;
        if *visits > MOST_VISITS {
            return None;
        }
        indices.insert(over.index, value);
        all = all.saturating_add(counted(inner, indices, visits)?.max(1));
    }
    Some(all)
}

fn whole(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}

/// A number with blanks between its thousands: `1 400 010`.
fn grouped(number: i64) -> String {
    let digits = number.to_string();
    let first = digits.len() % 3;
    let (head, tail) = digits.split_at(first);
    let groups = tail.as_bytes().chunks(3).map(|group| String::from_utf8_lossy(group).into_owned());
    let parts: Vec<String> = std::iter::once(head.to_owned()).filter(|head| !head.is_empty()).chain(groups).collect();
    parts.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::problem::Form;

    fn over(index: u32, first: Form, last: Form) -> Loop {
        Loop { index: IndexId(index), first, last }
    }

    #[test]
    fn loops_are_counted_as_their_members_are_made() {
        let number = Form::number;
        let square = [over(0, number(1), number(4)), over(1, number(0), number(9))];
        assert_eq!(count(&square), 40);
        let triangle = [over(0, number(1), number(4)), over(1, Form::index(IndexId(0)), number(4))];
        assert_eq!(count(&triangle), 4 + 3 + 2 + 1);
        let empty_inside = [over(0, number(1), number(1_000_000_000)), over(1, number(1), number(0))];
        assert_eq!(count(&empty_inside), 1_000_000_000);
        assert_eq!(count(&[]), 1);
    }

    #[test]
    fn many_unequal_loops_are_not_run_through() {
        let number = Form::number;
        let huge = [over(0, number(1), number(1 << 30)), over(1, Form::index(IndexId(0)), number(1 << 30))];
        assert!(count(&huge) >= 1 << 58);
        let empty = [over(0, number(1), number(1 << 30)), over(1, Form::index(IndexId(0)), number(0))];
        assert_eq!(count(&empty), 1 << 30);
    }

    #[test]
    fn numbers_are_grouped_by_thousands() {
        let texts: Vec<String> = [7, 1_000, 1_400_010, 51_000_000_000].into_iter().map(grouped).collect();
        assert_eq!(texts, ["7", "1 000", "1 400 010", "51 000 000 000"]);
    }
}
