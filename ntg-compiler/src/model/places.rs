//! Places in time that are known before the solve: `at(time, e)`, `at time { }`, the ends of parts of a trajectory.
//!
//! Takes times on the clock `t` made of constants, durations and starts; gives the phase and the scaled time in it.
//! A time is a sum of a number and multiples of durations and starts. It has a known place in a phase where the time
//! since the phase's start is a multiple of its duration, or a number where its duration is one.
//! Finds: places that only the solve would tell, places outside (E093), delays (E094).

use super::elaborator::Elaborator;
use super::mention::{mentioned, mentions_time};
use super::problem::{Duration, Form, IndexId, Instant, Leaf, PhaseAt, Places, Start};
use super::scope::{Allow, Context, Entity, PROBLEM, Point};
use super::settle::Use;
use super::time::Stretch;
use super::value::{Flaw, OpenIndex, Value, What};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Binary, Fold, Node, NodeId, Unary};
use crate::source::Span;
use crate::syntax::ast::{Call, Expr, ExprKind};

/// A phase, and a place in it.
#[derive(Clone)]
pub(super) struct Spot {
    /// The phase with its members.
    pub(super) stretch: Stretch,
    /// Its number among the stretches that were looked at.
    pub(super) number: usize,
    /// The place.
    pub(super) instant: Instant,
}

/// A number of seconds and multiples of durations and starts that the solve finds.
#[derive(Clone, Default)]
struct Moment {
    seconds: f64,
    multiples: Vec<(Leaf, f64)>,
}

impl Moment {
    fn number(seconds: f64) -> Self {
        Self { seconds, multiples: Vec::new() }
    }

    fn of(leaf: Leaf) -> Self {
        Self { seconds: 0.0, multiples: vec![(leaf, 1.0)] }
    }

    fn plus(mut self, factor: f64, other: &Self) -> Self {
        self.seconds += factor * other.seconds;
        for (leaf, multiple) in &other.multiples {
            match self.multiples.iter_mut().find(|(own, _)| own == leaf) {
                Some((_, own)) => *own += factor * multiple,
                None => self.multiples.push((leaf.clone(), factor * multiple)),
            }
        }
        self.multiples.retain(|(_, multiple)| *multiple != 0.0);
        self
    }

    fn times(&self, factor: f64) -> Self {
        Self::default().plus(factor, self)
    }

    fn as_number(&self) -> Option<f64> {
        self.multiples.is_empty().then_some(self.seconds)
    }
}

/// The largest difference of a scaled time from one that is meant: that of some roundings.
const ROUNDING: f64 = 1e-12;

/// The most places that one formula may have, one for each value of an index.
const MOST_PLACES: i64 = 1_000_000;

/// The scaled time of what lies `since` after the start of something that lasts `lasting`.
fn scaled(since: &Moment, lasting: &Moment) -> Option<f64> {
    let tau = match (since.as_number(), lasting.as_number(), lasting.multiples.as_slice()) {
        (Some(0.0), _, _) => 0.0,
        (Some(seconds), Some(whole), _) => seconds / whole,
        (None, None, [(leaf, whole)]) => match since.multiples.as_slice() {
            [(own, multiple)] if own == leaf && since.seconds == 0.0 => multiple / whole,
            _ => return None,
        },
        _ => return None,
    };
    // Ends are ends in spite of roundings.
    let near = [0.0, 1.0].into_iter().find(|end: &f64| (tau - end).abs() <= ROUNDING);
    Some(near.unwrap_or(tau))
}

impl<'a> Elaborator<'a> {
    /// `at(time, e)`, `at(path, time, e)`.
    pub(super) fn value_at(&mut self, cx: &Context<'a>, call: &'a Call, at: &[Form]) -> Value {
        let Some((path, time, of)) = self.at_arguments(call) else { return self.poison(call.span) };
        let span = call.span;
        if cx.allow < Allow::All {
            let text = self.text(span);
            return self.misplaced_value(What::Mission, span, &text, None);
        }
        if mentions_time(time, &self.problem.independent.name) {
            let text = self.text(of.span);
            return self.delay(span, &text);
        }
        let Some(stretches) = self.stretches_of(cx, path, span) else { return self.poison(span) };
        let stretches = self.members_of(stretches);
        let (stretch, point) = match self.spot(cx, time, &stretches) {
            Ok(spot) => (spot.stretch, Point::MissionInside(spot.instant)),
            Err(flawed) => match self.spots(cx, time, &stretches, flawed) {
                Ok(spots) => spots,
                Err(flawed) => return flawed,
            },
        };
        let inner = self.on(cx, &stretch, point);
        let value = self.element_or_zero(&inner, of, at);
        let value = self.placed(&inner, value);
        self.mark_event(span, self.text(span), false);
        value.map(value.node, value.dimension, span).shown_in(value.unit.clone())
    }

    /// The path, the time and the expression of an application of `at`.
    pub(super) fn at_arguments(
        &mut self,
        call: &'a Call,
    ) -> Option<(Option<&'a crate::syntax::ast::Path>, &'a Expr, &'a Expr)> {
        match call.arguments.as_slice() {
            [time, of] => Some((None, time, of)),
            [Expr { kind: ExprKind::Path(path), .. }, time, of] => Some((Some(path), time, of)),
            _ => {
                let message = "`at` takes a time and an expression";
                let finding = Diagnostic::new(Code::ArgumentCount, call.span, message);
                let time = self.example_of_time("2.5");
                let help = format!("write `at({time}, x)`, or with a phase or agent `at(uav[2], {time}, x)`");
                self.report(finding.help(help));
                None
            }
        }
    }

    /// Tells of an expression at another time than that at which it stands.
    pub(super) fn delay(&mut self, span: Span, what: &str) -> Value {
        let text = self.text(span);
        if text == format!("{what}(t)") {
            let message = format!("`{what}` is a function of time without saying so");
            let finding = Diagnostic::new(Code::NoFunction, span, message);
            return self.refuse(finding.help(format!("write `{what}`")), span);
        }
        let message = format!("a delay is not in the language: `{text}`");
        let help = format!(
            "a chain of states approximates it: `der(z1) == 2 * ({what} - z1) / d`, `der(z2) == 2 * (z1 - z2) / d`, ..."
        );
        self.refuse(Diagnostic::new(Code::Delay, span, message).help(help), span)
    }

    /// The same stretches with every family replaced by its members, in order of time.
    pub(super) fn members_of(&self, stretches: Vec<Stretch>) -> Vec<Stretch> {
        let mut all = Vec::new();
        for stretch in stretches {
            match &self.problem.phases[stretch.phase].family {
                Some(family) if stretch.index.is_none() => {
                    let members = family.first.constant..=family.last.constant;
                    all.extend(members.map(|k| Stretch { index: Some(Form::number(k)), ..stretch.clone() }));
                }
                _ => all.push(stretch),
            }
        }
        all
    }

    /// Where a time lies in these stretches; else a value that says why there is no such place.
    pub(super) fn spot(&mut self, cx: &Context<'a>, time: &'a Expr, stretches: &[Stretch]) -> Result<Spot, Value> {
        if !self.is_number(cx, time) {
            return Err(self.poison(time.span));
        }
        let outer = self.event.take();
        let value = self.value(&cx.at(Point::Nowhere).allowing(Allow::All), time);
        self.event = outer;
        if matches!(value.flaw, Some(Flaw::Open(_))) {
            return Err(value);
        }
        let settled = self.settle(value, Use::Place).and_then(|value| self.as_time(value, "a place in time"));
        let Some(value) = settled else { return Err(self.poison(time.span)) };
        let Some(moment) = self.moment(value.node) else {
            return Err(match self.index_in(value.node) {
                Some(index) => self.open(OpenIndex { index, cut: None, span: time.span }),
                None => self.no_place(time, stretches),
            });
        };
        self.spot_of(&moment, stretches).ok_or_else(|| self.no_spot(time, &moment, stretches))
    }

    /// The places of a time that depends on the index of a loop, one for each of its values: so the members of the loop
    /// stay one formula. `flawed` says which index it is; where there is no such formula it comes back.
    fn spots(
        &mut self,
        cx: &Context<'a>,
        time: &'a Expr,
        stretches: &[Stretch],
        flawed: Value,
    ) -> Result<(Stretch, Point), Value> {
        let Some(Flaw::Open(open)) = &flawed.flaw else { return Err(flawed) };
        let index = open.index;
        let ends = cx.loops.iter().find(|over| over.index == index);
        let ends = ends.and_then(|over| over.first.as_number().zip(over.last.as_number()));
        let Some((first, last)) = ends.filter(|(first, last)| last - first < MOST_PLACES) else { return Err(flawed) };
        let mut instants = Vec::new();
        let mut found: Option<Spot> = None;
        for k in first..=last {
            let known = cx.knowing(index, k);
            let spot = self.spot(&known, time, stretches)?;
            match &found {
                // The formula changes with the phase: the loop is parted there.
                Some(before) if before.number != spot.number => {
                    return Err(self.open(OpenIndex { index, cut: Some(k), span: time.span }));
                }
                Some(_) => {}
                None => found = Some(spot.clone()),
            }
            instants.push(spot.instant);
        }
        let Some(Spot { stretch, .. }) = found else { return Err(flawed) };
        let wanted = Places { first, instants };
        let places = self.problem.places.iter().position(|known| *known == wanted).unwrap_or_else(|| {
            self.problem.places.push(wanted);
            self.problem.places.len() - 1
        });
        Ok((stretch, Point::MissionAmong { places, index }))
    }

    /// The place of a moment: in the later of two stretches that meet there, at the end of the last one.
    fn spot_of(&self, moment: &Moment, stretches: &[Stretch]) -> Option<Spot> {
        for (number, stretch) in stretches.iter().enumerate() {
            let is_last = number + 1 == stretches.len();
            let inside = |tau: &f64| *tau >= 0.0 && (*tau < 1.0 || (*tau == 1.0 && is_last));
            if let Some(tau) = self.since(moment, stretch).filter(inside) {
                return Some(Spot { stretch: stretch.clone(), number, instant: Instant::new(tau) });
            }
        }
        None
    }

    /// The scaled time of a moment in a stretch, where it is known; it may lie outside.
    fn since(&self, moment: &Moment, stretch: &Stretch) -> Option<f64> {
        let begin = self.start_of(&stretch.at());
        scaled(&moment.clone().plus(-1.0, &begin), &self.lasting(&stretch.at()))
    }

    /// A time as a sum of a number and multiples of durations and starts, if it is one.
    fn moment(&self, node: NodeId) -> Option<Moment> {
        let dag = &self.problem.dag;
        Some(match dag.node(node).clone() {
            Node::Const(number) => Moment::number(number.value()),
            Node::Input(input) => match self.problem.leaves.leaf(input) {
                Leaf::Duration(at) => self.lasting(at),
                Leaf::Start(at) => self.start_of(at),
                _ => return None,
            },
            Node::Unary(Unary::Neg, a) => self.moment(a)?.times(-1.0),
            Node::Binary(Binary::Add, a, b) => self.moment(a)?.plus(1.0, &self.moment(b)?),
            Node::Binary(Binary::Sub, a, b) => self.moment(a)?.plus(-1.0, &self.moment(b)?),
            Node::Binary(Binary::Mul, a, b) => match (dag.is_constant(a), dag.is_constant(b)) {
                (Some(factor), _) => self.moment(b)?.times(factor),
                (_, Some(factor)) => self.moment(a)?.times(factor),
                _ => return None,
            },
            Node::Binary(Binary::Div, a, b) => {
                let divisor = dag.is_constant(b)?;
                let Moment { seconds, multiples } = self.moment(a)?;
                let multiples = multiples.into_iter().map(|(leaf, multiple)| (leaf, multiple / divisor)).collect();
                Moment { seconds: seconds / divisor, multiples }
            }
            Node::Reduce { fold: Fold::Sum, index, range, body } => self.sum_of_members(IndexId(index), range, body)?,
            _ => return None,
        })
    }

    /// The whole duration of a family of phases, as totals hold it.
    fn sum_of_members(&self, index: IndexId, range: u32, body: NodeId) -> Option<Moment> {
        let over = &self.problem.ranges[range as usize];
        let (first, last) = (over.first.as_number()?, over.last.as_number()?);
        let Node::Input(input) = self.problem.dag.node(body) else { return None };
        let Leaf::Duration(at) = self.problem.leaves.leaf(*input) else { return None };
        if at.index != Some(Form::index(index)) {
            return None;
        }
        let member = |k: i64| self.lasting(&PhaseAt { index: Some(Form::number(k)), ..at.clone() });
        Some((first..=last).fold(Moment::default(), |sum, k| sum.plus(1.0, &member(k))))
    }

    /// How long a phase lasts.
    fn lasting(&self, at: &PhaseAt) -> Moment {
        let known = match self.problem.phases[at.phase].duration {
            Duration::Fixed(node) => self.problem.dag.is_constant(node),
            Duration::Free(_) => None,
        };
        known.map_or_else(|| Moment::of(Leaf::Duration(at.clone())), Moment::number)
    }

    /// When a phase starts: the start of its agent and the durations of the phases before it.
    fn start_of(&self, at: &PhaseAt) -> Moment {
        let agent = self.problem.phases[at.phase].agent;
        let order = &self.problem.agents[agent].phases;
        let first = order.first().copied().unwrap_or(at.phase);
        let known = match &self.problem.agents[agent].start {
            Start::Fixed(None) => Some(0.0),
            Start::Fixed(Some(node)) => self.problem.dag.is_constant(*node),
            Start::Free(_) => None,
        };
        let first_index = self.problem.phases[first].family.as_ref().map(|over| over.first.clone());
        let first_at = PhaseAt { phase: first, agent: at.agent.clone(), index: first_index };
        let mut start = known.map_or_else(|| Moment::of(Leaf::Start(first_at)), Moment::number);
        for phase in order {
            let family = self.problem.phases[*phase].family.as_ref();
            let this = |index: Option<Form>| PhaseAt { phase: *phase, agent: at.agent.clone(), index };
            let members = family.map(|over| over.first.constant..=over.last.constant);
            let until = match (*phase == at.phase, &at.index) {
                (true, None) => return start,
                (true, Some(form)) => match form.as_number() {
                    Some(member) => Some(member),
                    None => return Moment::of(Leaf::Start(at.clone())),
                },
                (false, _) => None,
            };
            match members {
                Some(members) => {
                    let before = members.take_while(|k| until.is_none_or(|until| *k < until));
                    let lasting = |k: i64| self.lasting(&this(Some(Form::number(k))));
                    start = before.fold(start, |sum, k| sum.plus(1.0, &lasting(k)));
                }
                None => start = start.plus(1.0, &self.lasting(&this(None))),
            }
            if until.is_some() {
                return start;
            }
        }
        start
    }

    /// A loop index that occurs in a node.
    fn index_in(&self, node: NodeId) -> Option<IndexId> {
        self.problem.dag.inputs_of(&[node]).into_iter().find_map(|input| match self.problem.leaves.leaf(input) {
            Leaf::Index(form) => form.terms.first().map(|(index, _)| *index),
            _ => None,
        })
    }

    /// A place in a phase as one would write it.
    pub(super) fn place_in_words(&self, phase: usize, tau: f64) -> String {
        let at = PhaseAt { phase, agent: None, index: None };
        let name = self.problem.phases[phase].duration_name.as_deref().unwrap_or("duration");
        match (self.start_of(&at).as_number(), self.lasting(&at).as_number()) {
            (Some(start), Some(lasting)) => {
                let shown = (start + tau * lasting) / self.clock().factor;
                self.example_of_time(&((shown * 1e6).round() / 1e6).to_string())
            }
            _ => format!("{} * {name}", (tau * 1e6).round() / 1e6),
        }
    }

    /// Tells of a time that is made of more than constants and durations.
    fn no_place(&mut self, time: &Expr, stretches: &[Stretch]) -> Value {
        let text = self.text(time.span);
        let message =
            format!("where `{text}` lies is not known before the solve: a place is made of constants and durations");
        let is_parameter = |name: &&str| {
            let declared = self.scopes[PROBLEM].names.get(*name);
            declared.is_some_and(|declared| matches!(declared.entity, Entity::Parameter(_)))
        };
        let own = match &time.kind {
            ExprKind::Path(path) => path.segments.first().map(|segment| segment.name.text.as_str()),
            _ => None,
        };
        let help = match mentioned(time).into_iter().chain(own).find(is_parameter) {
            Some(name) => format!("`{name}` may change without recompiling: declare it by `const`"),
            None => self.place_help(stretches),
        };
        self.refuse(Diagnostic::new(Code::UnknownPlace, time.span, message).help(help), time.span)
    }

    /// Tells of a time that lies outside, or whose place the solve finds.
    fn no_spot(&mut self, time: &Expr, moment: &Moment, stretches: &[Stretch]) -> Value {
        let text = self.text(time.span);
        let known: Option<Vec<f64>> = stretches.iter().map(|stretch| self.since(moment, stretch)).collect();
        let in_phase = stretches.len() == 1 && self.phases[stretches[0].phase].item.is_some();
        let name = &self.problem.independent.name;
        let clock = format!("times are on the clock `{name}`, which does not begin anew with a phase");
        let finding = if let Some(known) = known {
            let side = if known.iter().all(|tau| *tau < 0.0) { "before it begins" } else { "after it ends" };
            let what = if in_phase { "the phase" } else { "the trajectory" };
            let finding =
                Diagnostic::new(Code::UnknownPlace, time.span, format!("`{text}` lies outside of {what}, {side}"));
            match in_phase {
                true => finding.help(format!("{clock}: write `start(phase) + ...`")),
                false => finding.help("write a time between its start and its end"),
            }
        } else if stretches.len() > 1 {
            let message = format!("where `{text}` lies is not known before the solve: some durations are not known");
            Diagnostic::new(Code::UnknownPlace, time.span, message).help(self.place_help(stretches))
        } else {
            let phase = &self.problem.phases[stretches[0].phase];
            let counted_from_zero = moment.multiples.len() <= 1;
            let start_is_open = self.start_of(&stretches[0].at()).as_number().is_none();
            let unknown_start = in_phase && start_is_open && counted_from_zero;
            let why = match phase.duration {
                _ if unknown_start => "its start is not known",
                Duration::Fixed(_) => "its duration is made of parameters",
                Duration::Free(_) => "its duration is free",
            };
            let message = format!("where `{text}` lies in the phase is not known before the solve: {why}");
            let help = match &phase.name {
                Some(name) if unknown_start => format!("{clock}: write `start({name}) + {text}`"),
                _ => self.place_help(stretches),
            };
            Diagnostic::new(Code::UnknownPlace, time.span, message).help(help)
        };
        self.refuse(finding, time.span)
    }

    /// What to write for a place that is known.
    fn place_help(&self, stretches: &[Stretch]) -> String {
        let [only] = stretches else {
            return "end a phase there, and write `end(phase)`".to_owned();
        };
        let phase = &self.problem.phases[only.phase];
        let known = matches!(phase.duration, Duration::Fixed(node) if self.problem.dag.is_constant(node).is_some());
        match (&phase.duration_name, known) {
            (_, true) => "write a time between its start and its end".to_owned(),
            (Some(name), false) => format!("end a phase there, or write a multiple of `{name}`"),
            (None, false) => "end a phase there, or name the duration and write a multiple of it".to_owned(),
        }
    }
}
