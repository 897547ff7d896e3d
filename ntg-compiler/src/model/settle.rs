//! The end of an expression: what has no value where the expression stands is told here.
//!
//! Takes a value, gives it back if it can be used.

use super::elaborator::Elaborator;
use super::value::{Flaw, Misplaced, Value, What};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;

/// Where an expression stands that belongs to no point of the trajectory.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Use<'s> {
    /// A term of the objective.
    Objective,
    /// A constraint in `temporal`.
    Temporal,
    /// A side of a measurement.
    Measured,
    /// A bound of a variable, a duration or a start time; which one in words.
    Bound(&'s str),
    /// Where only constants stand; for what in words.
    Constant(&'s str),
    /// A guess.
    Guess,
    /// A constraint at a point.
    Point,
    /// A place in time.
    Place,
}

impl Elaborator<'_> {
    /// A value that can be used; what is wrong with it is told.
    pub(super) fn settle(&mut self, value: Value, place: Use<'_>) -> Option<Value> {
        match &value.flaw {
            None => Some(value),
            Some(Flaw::Reported) => None,
            Some(Flaw::Open(open)) => {
                self.opened.get_or_insert(*open);
                None
            }
            Some(Flaw::Misplaced(misplaced)) => {
                let mut finding = misplacement(misplaced, place);
                if place == Use::Objective && misplaced.what == What::Trajectory && !misplaced.text.contains('.') {
                    let whole = self.text(self.as_one_number(misplaced.span));
                    finding =
                        finding.help(format!("write `integral({whole})`, `initial({whole})` or `final({whole})`"));
                }
                self.report(finding);
                None
            }
        }
    }

    /// What stands around a name and makes one number of it: `dot(u, u)` around `u`, with the power behind it.
    fn as_one_number(&self, name: Span) -> Span {
        let text = &self.source.text;
        let (before, after) = (&text[..name.start as usize], &text[name.end as usize..]);
        let mut whole = name;
        let opens = before.rfind('(').filter(|at| !before[*at..].contains([')', ';', '{']));
        let closes = after.find(')').filter(|at| !after[..*at].contains(['(', ';', '}']));
        for function in ["dot", "norm"] {
            if let (Some(opens), Some(closes)) = (opens, closes)
                && let Some(rest) = before[..opens].strip_suffix(function)
                && !rest.ends_with(|c: char| c.is_alphanumeric() || c == '_')
            {
                whole = Span { start: rest.len() as u32, end: name.end + closes as u32 + 1 };
            }
        }
        let power =
            text[whole.end as usize..].strip_prefix('^').map(|rest| rest.bytes().take_while(u8::is_ascii_digit));
        match power.map(Iterator::count) {
            Some(digits) if digits > 0 => Span { end: whole.end + 1 + digits as u32, ..whole },
            _ => whole,
        }
    }

    /// As [`Elaborator::settle`], for what must be constant.
    pub(super) fn settle_constant(&mut self, value: Value, what: &str) -> Option<Value> {
        self.settle(value, Use::Constant(what))
    }
}

fn misplacement(misplaced: &Misplaced, place: Use<'_>) -> Diagnostic {
    let text = &misplaced.text;
    let nature = match misplaced.what {
        What::Trajectory => format!("`{text}` varies along the trajectory"),
        What::Time => format!("`{text}` varies along the trajectory"),
        What::ScaledTime => format!("`{text}` runs from 0 to 1 along each phase"),
        What::Parameter => format!("`{text}` may change without recompiling"),
        What::Index => format!("`{text}` is the index of a loop"),
        What::Variable => format!("`{text}` is found only by solving"),
        What::Mission => format!("`{text}` is known only after solving"),
    };
    let wanted = match place {
        Use::Objective => "an objective is a single number".to_owned(),
        Use::Temporal => "a `temporal` constraint belongs to no single point".to_owned(),
        Use::Measured => "a measurement is taken at a time".to_owned(),
        Use::Bound(what) => format!("{what} is made of constants and parameters"),
        Use::Constant(what) => format!("{what} must be known when the spec is compiled"),
        Use::Guess => "a guess is made of parameters, `tau`, `t` and guessed durations".to_owned(),
        Use::Place => "a place in time is made of constants and durations".to_owned(),
        Use::Point => "there is no phase here that it could belong to".to_owned(),
    };
    let code = match (misplaced.what, place) {
        (_, Use::Constant(_)) => Code::NotConstant,
        (_, Use::Guess) => Code::NotGuessable,
        (What::Time | What::ScaledTime, _) => Code::TimeOutOfPlace,
        (What::Trajectory, Use::Point) => Code::ForeignTrajectory,
        (What::Trajectory, _) => Code::VariesAlong,
        (What::Parameter | What::Index | What::Variable | What::Mission, _) => Code::NotConstant,
    };
    let mut finding = Diagnostic::new(code, misplaced.span, format!("{nature}, but {wanted}"));
    if let Some((span, because)) = &misplaced.because {
        finding = finding.label(misplaced.span, "used here").label(*span, because.clone());
    }
    finding.help(remedy(misplaced, place))
}

fn remedy(misplaced: &Misplaced, place: Use<'_>) -> String {
    let text = &misplaced.text;
    match (misplaced.what, place) {
        (What::Trajectory | What::Time, Use::Objective | Use::Temporal) => match text.rsplit_once('.') {
            Some((path, inner)) => {
                format!("write `initial({path}, {inner})`, `final({path}, {inner})` or `integral({path}, {inner})`")
            }
            None if misplaced.what == What::Time => format!("write the name of the duration, or `final({text})`"),
            None => format!("write `integral({text})`, `initial({text})` or `final({text})`"),
        },
        (What::Trajectory, Use::Measured) => match text.rsplit_once('.') {
            Some((path, inner)) => format!("say when: `at({path}, time, {inner})`"),
            None => format!("say when: `at(time[i], {text})`, inside `for i in 1 .. n {{ ... }}`"),
        },
        (What::ScaledTime, Use::Objective | Use::Temporal) => {
            format!("write it inside `integral(...)`, where `{text}` has a value at every point")
        }
        (What::Parameter, Use::Constant(_)) => format!("declare it by `const {text} = ...;`"),
        (What::Index, Use::Constant(_)) => "write a number or a `const`".to_owned(),
        (_, Use::Constant(_)) => "write numbers and names of `const`s only".to_owned(),
        (_, Use::Bound(_)) => "write a constant here, and what depends on more as a constraint".to_owned(),
        (_, Use::Guess) => "write a number, or an expression of `tau` that comes near it".to_owned(),
        (_, Use::Point) => match text.rsplit_once('.') {
            Some((path, inner)) => format!("write `final({path}, {inner})` in `temporal`, or let both share one agent"),
            None => "write it inside a phase".to_owned(),
        },
        (_, Use::Place) => "write a time such as `2.5 [s]`, or a multiple of the duration such as `0.5 * T`".to_owned(),
        (_, Use::Objective | Use::Temporal | Use::Measured) => "write it in another block".to_owned(),
    }
}
