//! Blocks about a point of time or a part of the trajectory.
//!
//! Takes `at time { }`, `trajectory from a to b { }`, `trajectory except final { }`; fills `Problem::constraints`.
//! Finds: parts that are empty, parts without any point at which an equality could hold.

use ntg_structure::Block;

use super::constraints::Site;
use super::elaborator::Elaborator;
use super::problem::{Collocation, Constraint, Domain, Form, Instant, Part};
use super::scope::{Allow, Context, Point};
use super::time::Stretch;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{self, Boundary, Expr};

impl<'a> Elaborator<'a> {
    /// `at time { }`: conditions on values at a place, of the mission as those in `temporal`.
    pub(super) fn at_block(&mut self, scope: usize, block: &'a ast::AtBlock) {
        let (phase, Some(agent)) = (self.scopes[scope].phase, self.scopes[scope].agent) else {
            return; // Told of as standing at the wrong level.
        };
        let outer = match phase {
            Some(phase) => self.phase_context(phase, Allow::All, Point::Nowhere),
            None => self.agent_context(agent, Allow::All),
        };
        let outer = Context { lexical: scope, ..outer };
        let stretches = self.own_stretches(&outer, agent, phase);
        let Ok(spot) = self.spot(&outer, &block.time, &stretches) else { return };
        let inner = self.on(&outer, &spot.stretch, Point::MissionInside(spot.instant));
        let site = Site { block: Block::Temporal, agent: Some(agent), phase, part: Part::WHOLE };
        self.statements(&inner, &block.statements, &site);
    }

    /// The phase, or the members of all phases of the agent.
    fn own_stretches(&self, cx: &Context<'a>, agent: usize, phase: Option<usize>) -> Vec<Stretch> {
        match phase {
            Some(phase) => vec![Stretch { phase, agent: cx.agent.clone(), index: cx.phase.clone() }],
            None => self.members_of(self.stretches(agent, cx.agent.clone())),
        }
    }

    /// A part of the trajectory.
    pub(super) fn part_block(&mut self, scope: usize, agent: usize, block: &'a ast::Block, part: &'a ast::Part) {
        let phase = self.scopes[scope].phase;
        match part {
            ast::Part::Except { ends, .. } => match phase {
                Some(phase) => {
                    let part = without(ends, true, true);
                    self.along(scope, phase, None, block, part);
                }
                None => self.without_ends(scope, agent, block, ends),
            },
            ast::Part::Between { from, to, span } => {
                let outer = match phase {
                    Some(phase) => self.phase_context(phase, Allow::All, Point::Nowhere),
                    None => self.agent_context(agent, Allow::All),
                };
                let outer = Context { lexical: scope, ..outer };
                let stretches = self.own_stretches(&outer, agent, phase);
                let mut ends = [None; 2];
                for (end, time) in ends.iter_mut().zip([from, to]) {
                    let Some(time) = time else { continue };
                    // What is wrong with the first end is wrong with the other.
                    let Some(place) = self.end_of_part(&outer, time, &stretches) else { return };
                    *end = Some(place);
                }
                let [from, to] = ends;
                let from = from.unwrap_or((0, Instant::START));
                let to = to.unwrap_or((stretches.len().saturating_sub(1), Instant::END));
                if from >= to {
                    let message = "this part of the trajectory is empty: it ends where it begins, or before";
                    let finding = Diagnostic::new(Code::BoundsCross, *span, message);
                    self.report(finding.help("write the earlier time behind `from`, the later one behind `to`"));
                    return;
                }
                self.between(scope, block, &stretches, (from, to));
            }
        }
    }

    /// The stretch in which a time lies, and its place there; none where that was told of.
    fn end_of_part(&mut self, cx: &Context<'a>, time: &'a Expr, stretches: &[Stretch]) -> Option<(usize, Instant)> {
        let spot = self.spot(cx, time, stretches).ok()?;
        Some((spot.number, spot.instant))
    }

    /// The rows of a block from one place to another; whole families of phases stay families.
    fn between(
        &mut self,
        scope: usize,
        block: &'a ast::Block,
        stretches: &[Stretch],
        (from, to): ((usize, Instant), (usize, Instant)),
    ) {
        let part_of = |number: usize| {
            let first = if number == from.0 { from.1 } else { Instant::START };
            let last = if number == to.0 { to.1 } else { Instant::END };
            let within = number >= from.0 && number <= to.0 && first < last;
            within.then_some(Part { from: first, to: last, ..Part::WHOLE })
        };
        let mut number = 0;
        while number < stretches.len() {
            let phase = stretches[number].phase;
            let members = stretches[number..].iter().take_while(|stretch| stretch.phase == phase).count();
            let parts: Vec<Option<Part>> = (number..number + members).map(part_of).collect();
            let is_family = stretches[number].index.as_ref().is_some_and(|form| form.as_number().is_some());
            if !is_family || parts.iter().all(|part| *part == Some(Part::WHOLE)) {
                if let Some(part) = parts[0] {
                    self.along(scope, phase, None, block, part);
                }
            } else {
                for (stretch, part) in stretches[number..].iter().zip(parts) {
                    if let Some(part) = part {
                        self.along(scope, phase, stretch.index.clone(), block, part);
                    }
                }
            }
            number += members;
        }
    }

    /// The rows of a block in all phases of an agent, without the very first or last point.
    fn without_ends(&mut self, scope: usize, agent: usize, block: &'a ast::Block, ends: &[Boundary]) {
        let phases = self.agents[agent].phases.clone();
        for (k, phase) in phases.iter().enumerate() {
            let (is_first, is_last) = (k == 0, k + 1 == phases.len());
            let Some(family) = self.problem.phases[*phase].family.clone() else {
                self.along(scope, *phase, None, block, without(ends, is_first, is_last));
                continue;
            };
            let (first, last) = (family.first.constant, family.last.constant);
            if !is_first && !is_last {
                self.along(scope, *phase, None, block, Part::WHOLE);
                continue;
            }
            for member in first..=last {
                let part = without(ends, is_first && member == first, is_last && member == last);
                self.along(scope, *phase, Some(Form::number(member)), block, part);
            }
        }
    }

    /// The rows of a block in a phase, or in one member of it.
    fn along(&mut self, scope: usize, phase: usize, member: Option<Form>, block: &'a ast::Block, part: Part) {
        let agent = self.phases[phase].agent;
        let cx = match member {
            None => self.phase_context(phase, Allow::All, Point::Path),
            Some(member) => {
                let outer = self.agent_context(agent, Allow::All);
                Context { scope: self.phases[phase].scope, phase: Some(member), point: Point::Path, ..outer }
            }
        };
        let site = Site { block: Block::Trajectory, agent: Some(agent), phase: Some(phase), part };
        let before = self.problem.constraints.len();
        self.statements(&Context { lexical: scope, ..cx }, &block.statements, &site);
        if !part.is_whole() && self.opened.is_none() {
            self.check_points(before, phase, &part);
        }
    }

    /// Tells of equalities in a part so short that none of the points at which they hold lies in it.
    fn check_points(&mut self, from: usize, phase: usize, part: &Part) {
        let Collocation::Gauss { equalities, .. } = self.problem.phases[phase].collocation else { return };
        let is_equality = |c: &&Constraint| c.bounds.lower.is_some() && c.bounds.lower == c.bounds.upper;
        let mut rows = self.problem.constraints[from..].iter();
        let Some(row) = rows.find(|c| is_equality(c) && matches!(c.domain, Domain::Path(..))) else { return };
        let outputs = &self.problem.phases[phase].outputs;
        let mut cuts: Vec<f64> = outputs.iter().flat_map(|output| output.spline.breakpoints.clone()).collect();
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let nodes = ntg_splines::gauss(equalities).nodes;
        let is_inside = |tau: f64| tau > part.from.tau() && tau < part.to.tau();
        let holds =
            cuts.windows(2).any(|cell| nodes.iter().any(|node| is_inside(cell[0] + (cell[1] - cell[0]) * node)));
        if holds {
            return;
        }
        let message = "no point at which an equality holds lies in this part of the trajectory";
        let finding = Diagnostic::new(Code::WrongPoints, row.span, message);
        self.report(finding.help("make the part longer or the intervals shorter; at one time write `at time { ... }`"));
    }
}

/// All of a phase but for the ends that are left out, where the phase has them.
fn without(ends: &[Boundary], is_first: bool, is_last: bool) -> Part {
    let leaves = |end| ends.contains(&end);
    Part {
        with_first: !(is_first && leaves(Boundary::Initial)),
        with_last: !(is_last && leaves(Boundary::Final)),
        ..Part::WHOLE
    }
}
