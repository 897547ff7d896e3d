//! Equations between states alone that inputs are there to keep (docs/maths.md, section 4.9).
//!
//! Takes the equations of a phase that are no invariants. Each is differentiated along the motion until inputs take part: that
//! derivative holds at the points in the place of the equation, and the equation and the derivatives before it at the ends of the
//! intervals, where a helper, a polynomial of as many coefficients in each interval, takes back what the mesh lets drift.
//! Equations whose inputs do not decide these derivatives, all together, are left as they are.

use std::rc::Rc;

use super::motion::Motion;
use super::number::Number;
use super::sample::{Budget, Draw, Point, State};
use super::surface::{self, Row};
use super::{Candidate, Invariant, Joined, LEAST_TOLD, ORDINARY, draws};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Binary, Map, Node, NodeId, Scalar, kinks};
use crate::model::elaborator::Elaborator;
use crate::model::epigraph::loops_within;
use crate::model::problem::{
    Bounds, Collocation, Constraint, Domain, Form, Imposed, Leaf, Loop, Output, Part, PhaseAt,
};
use crate::source::Span;
use ntg_structure::TableMethod;

/// How often an equation is differentiated at most. A choice: mechanics take two, a motor behind a gear with a spring four.
const MOST: usize = 6;
/// The step of central differences, relative to what is moved: as long as that they are far from rounding, beside large terms too.
const DIFFERENCE: f64 = 1e-3;
/// How many times longer steps are where rounding hides what they change. Choices: units of inputs are as far apart.
const FARTHER: [f64; 4] = [1.0, 1e9, 1e18, 1e27];
/// The most members of reduced equations of a phase. A choice: each is sampled.
const MOST_ROWS: usize = 512;

/// What becomes of equations that are no invariants.
#[derive(Default)]
pub(super) struct Kept {
    pub(super) reduced: Vec<Reduced>,
    /// The constraints that follow from the reduced ones.
    pub(super) implied: Vec<usize>,
}

/// An equation of states with its derivatives along the motion.
pub(super) struct Reduced {
    candidate: Candidate,
    motion: Rc<Motion>,
    /// The equation without its bound, and its derivatives, which are functions of states alone.
    levels: Vec<NodeId>,
    /// The first derivative with inputs, in which highest derivatives of states stand for what the equations of motion say.
    last: NodeId,
    /// The same with what they say.
    solved: NodeId,
    /// What all of them are equal to.
    zero: NodeId,
}

impl Elaborator<'_> {
    /// The equations among candidates that can be reduced, and those that follow from these and need no rows.
    pub(super) fn reduced(&mut self, motion: &Rc<Motion>, left: Vec<Candidate>, budget: &mut Budget) -> Kept {
        let none = Kept::default();
        let Collocation::Gauss { equalities, .. } = self.problem.phases[motion.phase].collocation else { return none };
        if !self.problem.shared.is_empty() || left.iter().map(|own| own.rows.len()).sum::<usize>() > MOST_ROWS {
            return none;
        }
        let derived = left.into_iter().filter_map(|own| self.derived(motion, own));
        let mut kept = Kept { reduced: derived.collect(), implied: vec![] };
        loop {
            let dependent = self.dependent(motion, &kept.reduced, budget);
            if budget.is_spent() {
                return none;
            }
            if dependent.is_empty() {
                break;
            }
            let is_dependent = |own: &Reduced| dependent.contains(&own.candidate.constraint);
            // A velocity follows from a position, and never a position from a velocity.
            let mut by_index: Vec<usize> =
                (0..kept.reduced.len()).filter(|k| is_dependent(&kept.reduced[*k])).rev().collect();
            by_index.sort_by_key(|k| kept.reduced[*k].levels.len());
            match by_index.into_iter().find(|k| self.is_implied(motion, &kept.reduced, *k, budget)) {
                Some(k) => kept.implied.push(kept.reduced.remove(k).candidate.constraint),
                None => kept.reduced.retain(|own| !is_dependent(own)),
            }
        }
        let few = kept.reduced.iter().filter(|own| own.levels.len() > equalities);
        let few: Vec<(Span, usize)> =
            few.map(|own| (self.problem.constraints[own.candidate.constraint].span, own.levels.len())).collect();
        if few.is_empty() {
            return kept;
        }
        few.into_iter().for_each(|(span, count)| self.too_few_points(span, count));
        none
    }

    /// Whether an equation and its derivatives hold wherever those of all others do.
    fn is_implied(&self, motion: &Rc<Motion>, all: &[Reduced], which: usize, budget: &mut Budget) -> bool {
        let rows = |own: &Reduced| -> Vec<Row> {
            let row = |member: &Row, level: &NodeId| Row { body: *level, bound: own.zero, ..member.clone() };
            own.candidate
                .rows
                .iter()
                .flat_map(|member| own.levels.iter().map(move |level| row(member, level)))
                .collect()
        };
        let others: Vec<Row> = (0..all.len()).filter(|k| *k != which).flat_map(|k| rows(&all[k])).collect();
        let own = rows(&all[which]);
        let mut told = 0;
        for draw in draws(400, motion.has_branches) {
            let mut point = Point::new(&self.problem, motion, draw, budget);
            let mut states: Vec<State> =
                own.iter().chain(&others).filter_map(|row| surface::states(row, &mut point)).flatten().collect();
            states.sort_unstable();
            states.dedup();
            if !surface::reach(&others.iter().collect::<Vec<_>>(), &states, &mut point, surface::STEPS) {
                continue;
            }
            if !own.iter().all(|row| row.miss(&mut point).is_some_and(Number::is_rounding)) {
                return false;
            }
            told += 1;
        }
        told >= LEAST_TOLD
    }

    /// An equation with its derivatives; none where it is not smooth, or has none with inputs.
    fn derived(&mut self, motion: &Rc<Motion>, candidate: Candidate) -> Option<Reduced> {
        let row = candidate.rows.first()?;
        let (body, bound) = (row.body, row.bound);
        let Domain::Path(phase, _) = self.problem.constraints[candidate.constraint].domain.clone() else { return None };
        let mut level = self.problem.dag.sub(body, bound);
        let zero = self.problem.dag.constant(0.0);
        let mut levels = vec![];
        while levels.len() < MOST {
            if !self.is_continuous(level) {
                return None;
            }
            levels.push(level);
            let last = self.rate_along(level, &phase);
            let solved = self.solved(motion, last)?;
            if self.problem.dag.is_constant(solved).is_some() {
                return None;
            }
            if !self.is_between_states(motion, solved) {
                return Some(Reduced { candidate, motion: motion.clone(), levels, last, solved, zero });
            }
            level = solved;
        }
        None
    }

    /// Whether a formula has neither corners nor derivatives of tables that jump.
    fn is_continuous(&self, node: NodeId) -> bool {
        let jumps = |id: &NodeId| match self.problem.dag.node(*id) {
            Node::Table { table, derivative, .. } => {
                let smoothness = match self.problem.tables[*table as usize].method {
                    TableMethod::Linear => 0,
                    TableMethod::Monotone => 1,
                    TableMethod::Bspline { order } | TableMethod::Fit { order, .. } => order.saturating_sub(2),
                };
                derivative.iter().map(|order| usize::from(*order)).sum::<usize>() > smoothness
            }
            _ => false,
        };
        kinks(&self.problem.dag, &[node]).is_empty() && !self.problem.dag.schedule(&[node]).iter().any(jumps)
    }

    /// Whether a formula has tables, which are random numbers at points that are drawn.
    fn has_tables(&self, nodes: &[NodeId]) -> bool {
        self.problem.dag.schedule(nodes).iter().any(|id| matches!(self.problem.dag.node(*id), Node::Table { .. }))
    }

    /// Whether all that moves in a formula are states without their highest derivatives.
    fn is_between_states(&self, motion: &Motion, node: NodeId) -> bool {
        self.problem.dag.all_inputs(node, |input| match self.problem.leaves.leaf(input) {
            Leaf::Flat { output, order, .. } => motion.order(*output).is_some_and(|highest| *order < highest),
            _ => true,
        })
    }

    /// A formula with what the equations of motion say in the place of highest derivatives; those without an equation of their own
    /// remain. None where one cannot be put there.
    fn solved(&mut self, motion: &Motion, node: NodeId) -> Option<NodeId> {
        let mut images = Map::default(); // Looked up, never iterated.
        for input in self.problem.dag.inputs_of(&[node]) {
            let leaf = self.problem.leaves.leaf(input).clone();
            let Leaf::Flat { output, order, .. } = &leaf else { continue };
            if motion.order(*output) != Some(*order) {
                continue;
            }
            let Some((equation, forms)) = motion.equation_of(&leaf) else {
                // Decided by equations that hold several, or by none.
                if motion.moves(*output) {
                    continue;
                }
                return None;
            };
            let known = self.problem.dag.sub(equation.bound, equation.rest);
            let mut image = self.problem.dag.div(known, equation.factor);
            let has_sums = |id: &NodeId| matches!(self.problem.dag.node(*id), Node::Reduce { .. });
            let is_same = |(index, form): &(_, Form)| *form == Form::index(*index);
            if !forms.iter().all(is_same) && self.problem.dag.schedule(&[image]).iter().any(has_sums) {
                return None;
            }
            for (index, form) in &forms {
                image = self.with_index(image, (*index, form))?;
            }
            images.insert(input, image);
        }
        Some(self.problem.dag.substitute(&[node], |input| images.get(&input).copied())[0])
    }

    /// The equations whose last derivatives inputs do not decide, all of them together.
    fn dependent(&mut self, motion: &Rc<Motion>, all: &[Reduced], budget: &mut Budget) -> Vec<usize> {
        let zero = self.problem.dag.constant(0.0);
        let mut rows: Vec<Row> = vec![];
        let (mut is_first, mut is_top) = (vec![], vec![]);
        for own in all {
            for member in &own.candidate.rows {
                for (k, level) in own.levels.iter().enumerate() {
                    is_first.push(k == 0);
                    is_top.push(k + 1 == own.levels.len());
                    let (equation, indices) = (own.candidate.constraint, member.indices.clone());
                    rows.push(Row { equation, body: *level, bound: zero, rate: own.solved, indices });
                }
            }
        }
        // Two equations of other states may be kept by one input.
        let touched = |row: &Row, point: &mut Point<'_>| {
            let mut all = surface::states(row, point)?;
            point.free = Some(vec![]);
            let value = point.value(row.rate, &row.indices);
            all.extend(point.free.take()?);
            value.map(|_| all)
        };
        let groups = surface::groups(&rows, &touched, &mut Point::new(&self.problem, motion, ORDINARY, budget));
        let mut dependent: Vec<usize> = vec![];
        let mut seen = vec![false; rows.len()];
        for (members, mut states) in groups {
            states.retain(|(of, order)| motion.order(of.output).is_some_and(|highest| *order < highest));
            members.iter().for_each(|k| seen[*k] = true);
            let chosen = |is: &[bool]| members.iter().filter(|k| is[**k]).map(|k| &rows[*k]).collect();
            let [own, tops]: [Vec<&Row>; 2] = [chosen(&is_first), chosen(&is_top)];
            // Where tables take part no step leads to the equations.
            let formulas: Vec<NodeId> = own.iter().chain(&tops).flat_map(|row| [row.body, row.rate]).collect();
            let has_tables = self.has_tables(&formulas);
            let is_decided = |draw: Draw, budget: &mut Budget| {
                let mut point = Point::new(&self.problem, motion, draw, budget);
                let is_there = has_tables || surface::reach(&own, &states, &mut point, surface::STEPS);
                is_there && are_decided(&tops, &mut point) == Some(true)
            };
            if !draws(200, motion.has_branches).any(|draw| is_decided(draw, budget)) {
                dependent.extend(own.iter().map(|row| row.equation));
            }
        }
        dependent.extend(rows.iter().zip(seen).filter(|(_, seen)| !seen).map(|(row, _)| row.equation));
        dependent
    }

    /// What is imposed of each reduced equation in place of it, and notes of them.
    pub(super) fn impose_reduced(&mut self, all: Vec<Reduced>, joined: &Joined, budget: &mut Budget) {
        let mut levels: Vec<(usize, Invariant)> = vec![];
        let zero = self.problem.dag.constant(0.0);
        for (number, own) in all.iter().enumerate() {
            for level in &own.levels {
                let row = Row { body: *level, bound: zero, rate: own.solved, ..own.candidate.rows[0].clone() };
                let mut point = Point::new(&self.problem, &own.motion, ORDINARY, budget);
                row.miss(&mut point);
                let mut states = std::mem::take(&mut point.met);
                states.dedup();
                let constraint = own.candidate.constraint;
                levels.push((number, Invariant { constraint, motion: own.motion.clone(), row, states }));
            }
        }
        let (numbers, levels): (Vec<usize>, Vec<Invariant>) = levels.into_iter().unzip();
        let imposed: Vec<Imposed> = levels.iter().map(|own| self.imposed(own, &levels, joined, budget)).collect();
        let mut told: Vec<Span> = vec![];
        for (number, own) in all.iter().enumerate() {
            let constraint = self.problem.constraints[own.candidate.constraint].clone();
            let Domain::Path(phase, _) = &constraint.domain else { continue };
            let Some(helper) = self.drift((number, own), phase, &constraint.loops, constraint.span) else { continue };
            let own_levels = numbers.iter().zip(&levels).zip(&imposed).filter(|((of, _), _)| **of == number);
            for (order, ((_, level), imposed)) in own_levels.enumerate() {
                let at = Imposed::AtBreakpoints(parts(imposed, &constraint.loops));
                if order == 0 {
                    self.problem.constraints[own.candidate.constraint].imposed = at;
                    continue;
                }
                let domain = Domain::Path(phase.clone(), Part::WHOLE);
                let row = (level.row.body, Bounds { lower: Some(zero), upper: Some(zero) });
                self.hold(domain, constraint.loops.clone(), row, constraint.span);
                self.name_derivative(&constraint, order);
                self.problem.constraints.last_mut().expect("one was added").imposed = at;
            }
            let body = self.problem.dag.sub(own.last, helper);
            let row = (body, Bounds { lower: Some(zero), upper: Some(zero) });
            self.hold(Domain::Path(phase.clone(), Part::WHOLE), constraint.loops.clone(), row, constraint.span);
            self.name_derivative(&constraint, own.levels.len());
            if !told.contains(&constraint.span) {
                told.push(constraint.span);
                self.note_reduced(constraint.span, own.levels.len());
            }
        }
    }

    /// A polynomial in each interval with as many coefficients as a reduced equation has levels; none where the ends of its loops
    /// are not numbers.
    fn drift(
        &mut self,
        (number, own): (usize, &Reduced),
        phase: &PhaseAt,
        loops: &[Loop],
        span: Span,
    ) -> Option<NodeId> {
        let loops = loops_within(loops, Some(phase));
        if loops.iter().any(|over| over.first.as_number().is_none() || over.last.as_number().is_none()) {
            return None;
        }
        let members = self.members_missed(&loops, span)?;
        let count = own.levels.len();
        let (name, doc) = (format!("drift({})", number + 1), format!("What the mesh misses of `{}`.", self.text(span)));
        let unit = self.rate_unit(&self.problem.constraints[own.candidate.constraint].unit, count);
        let spline = self.slack_spline(phase.phase, count);
        let helper = Output { name, doc, unit, family: None, grid: None, vector: None, spline, span };
        Some(self.helper_output(phase, members, helper))
    }

    /// Names the last row after the equation of which it is a derivative.
    fn name_derivative(&mut self, of: &Constraint, order: usize) {
        let whose = of.name.clone().unwrap_or_else(|| self.text(of.span).to_owned());
        let name = if order == 1 { format!("rate of {whose}") } else { format!("derivative {order} of {whose}") };
        let unit = self.rate_unit(&of.unit, order);
        if let Some(row) = self.problem.constraints.last_mut() {
            (row.name, row.unit) = (Some(name), unit);
        }
    }

    fn too_few_points(&mut self, span: Span, count: usize) {
        let message = format!(
            "this equation is between states alone, and inputs take part when it is differentiated {}: fewer points than that do \
             not hold it",
            times(count)
        );
        let help = format!("write `collocation gauss(points = {count}, ...)`, or more");
        self.report(Diagnostic::new(Code::FewPoints, span, message).help(help));
    }

    fn note_reduced(&mut self, span: Span, count: usize) {
        let message = format!(
            "this equation is between states alone, and inputs take part when it is differentiated {}: that derivative holds at \
             the points, and the equation at the ends of the intervals",
            times(count)
        );
        let help = "nothing is to be done: what is given at the ends of a phase must agree with the equation and with its derivatives";
        self.report(Diagnostic::new(Code::Reduced, span, message).help(help));
    }
}

fn times(count: usize) -> String {
    match count {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        _ => format!("{count} times"),
    }
}

/// For which members and in which parts a level is imposed, where at the start of the phase it is imposed as said.
fn parts(at_start: &Imposed, loops: &[Loop]) -> Vec<(Vec<Loop>, Part)> {
    let later = Part { with_first: false, ..Part::WHOLE };
    match at_start {
        Imposed::AtStart(first) if *first != loops => {
            let mut others = loops.to_vec();
            for (over, first) in others.iter_mut().zip(first).filter(|(over, first)| over.last != first.last) {
                over.first = first.last.plus(1, &Form::number(1)).unwrap_or_else(|| over.first.clone());
            }
            vec![(first.clone(), Part::WHOLE), (others, later)]
        }
        Imposed::Nowhere => vec![(loops.to_vec(), later)],
        _ => vec![(loops.to_vec(), Part::WHOLE)],
    }
}

/// Whether what is free decides all rows: their slopes by it are independent. None where a row has no value.
fn are_decided(rows: &[&Row], point: &mut Point<'_>) -> Option<bool> {
    point.free = Some(vec![]);
    values(rows, point)?;
    let mut free = point.free.replace(vec![])?;
    free.sort_unstable();
    free.dedup();
    let columns: Vec<Vec<f64>> = free.iter().map(|state| slopes(rows, *state, point)).collect();
    let mut slopes: Vec<Vec<f64>> = (0..rows.len()).map(|row| columns.iter().map(|own| own[row]).collect()).collect();
    balance(&mut slopes);
    Some(surface::rank(slopes) == rows.len())
}

/// The slopes of rows by something free; 0 where rounding leaves nothing else, however far it moves. Beside other terms an input may
/// be next to nothing: a tension in the units of a pendulum of a nanometre.
fn slopes(rows: &[&Row], state: State, point: &mut Point<'_>) -> Vec<f64> {
    let at = point.state(&state);
    let mut known: Vec<Option<f64>> = vec![None; rows.len()];
    for farther in FARTHER {
        let step = DIFFERENCE * surface::size(at) * farther;
        point.put(state, at + step);
        let above = values(rows, point);
        point.put(state, at - step);
        let below = values(rows, point);
        point.put(state, at);
        let Some((above, below)) = above.zip(below) else { break };
        for (slope, (above, below)) in known.iter_mut().zip(above.iter().zip(&below)) {
            let change = Number::binary(Binary::Sub, above, below);
            if slope.is_none() && !change.is_rounding() {
                *slope = Some(change.value / (2.0 * step));
            }
        }
        if !known.contains(&None) {
            break;
        }
    }
    known.into_iter().map(Option::unwrap_or_default).collect()
}

/// Scales rows, columns and rows again by their largest entries: units make no difference.
fn balance(slopes: &mut [Vec<f64>]) {
    let largest = |entries: &mut dyn Iterator<Item = &f64>| {
        let most = entries.fold(0.0_f64, |most, slope| most.max(slope.abs()));
        if most > 0.0 { most } else { 1.0 }
    };
    let rows = |slopes: &mut [Vec<f64>]| {
        for row in slopes {
            let most = largest(&mut row.iter());
            row.iter_mut().for_each(|slope| *slope /= most);
        }
    };
    rows(slopes);
    for column in 0..slopes.first().map_or(0, Vec::len) {
        let most = largest(&mut slopes.iter().map(|row| &row[column]));
        slopes.iter_mut().for_each(|row| row[column] /= most);
    }
    rows(slopes);
}

fn values(rows: &[&Row], point: &mut Point<'_>) -> Option<Vec<Number>> {
    rows.iter().map(|row| point.value(row.rate, &row.indices)).collect()
}
