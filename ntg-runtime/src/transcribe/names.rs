//! What agents, phases, outputs and points are called when a person reads about them.

use super::error::SetupError;
use super::layout::{Layout, Time};
use super::points::Point;
use crate::digits::brief;
use ntg_structure::{Family, Structure};

/// `name`, or `name[index]` for a member of a family.
pub(crate) fn indexed(name: &str, index: Option<i64>) -> String {
    index.map_or_else(|| name.to_owned(), |index| format!("{name}[{index}]"))
}

/// `name`, or a member of an array with its indices in the spec: `name[3]`, `name[2, 1]`.
pub(crate) fn member(name: &str, family: Option<Family>, index: Option<i64>) -> String {
    match (family, index) {
        (Some(family), Some(index)) => format!("{name}{}", family.index(index)),
        _ => indexed(name, index),
    }
}

/// `first.second`, or whichever is not empty.
pub(crate) fn join(first: &str, second: &str) -> String {
    match (first.is_empty(), second.is_empty()) {
        (true, _) => second.to_owned(),
        (_, true) => first.to_owned(),
        _ => format!("{first}.{second}"),
    }
}

/// `uav[2]`; empty for the unnamed agent.
pub(crate) fn agent(structure: &Structure, layout: &Layout, agent: usize) -> String {
    let member = &layout.agents[agent];
    structure.agents[member.agent].name.as_deref().map_or_else(String::new, |name| indexed(name, member.index))
}

/// `uav[2].leg[3]`, `covert`; empty for the unnamed phase of the unnamed agent.
pub(crate) fn phase(structure: &Structure, layout: &Layout, phase: usize) -> String {
    let member = &layout.phases[phase];
    let own =
        structure.phases[member.phase].name.as_deref().map_or_else(String::new, |name| indexed(name, member.index));
    join(&agent(structure, layout, member.agent), &own)
}

/// `uav[2].covert.x[1]`.
pub(crate) fn output(structure: &Structure, layout: &Layout, phase: usize, output: usize) -> String {
    let member = &layout.phases[phase];
    let found = &member.outputs[output];
    let declared = &structure.phases[member.phase].outputs[found.output];
    join(&self::phase(structure, layout, phase), &self::member(&declared.name, declared.family, found.index))
}

/// "phase `covert`, t = 12.5 s (tau = 0.25)", for known variables; empty for no point.
pub(crate) fn point(structure: &Structure, layout: &Layout, at: &Point, x: &[f64]) -> String {
    let Some(phase) = at.phase else { return String::new() };
    let t = layout.start(phase, x) + at.tau * layout.duration(phase, x);
    let place = structure.independent.place(t, brief);
    match self::phase(structure, layout, phase) {
        name if name.is_empty() => format!("{place} (tau = {})", brief(at.tau)),
        name => format!("phase `{name}`, {place} (tau = {})", brief(at.tau)),
    }
}

/// As `point`, when the variables are not known: the time only where all durations are fixed.
pub(crate) fn fixed_point(structure: &Structure, layout: &Layout, at: &Point) -> String {
    let Some(phase) = at.phase else { return String::new() };
    let name = match self::phase(structure, layout, phase) {
        name if name.is_empty() => name,
        name => format!(" of phase `{name}`"),
    };
    if at.weight.is_nan() && (at.tau == 0.0 || at.tau == 1.0) {
        return format!("the {}{name}", if at.tau == 0.0 { "start" } else { "end" });
    }
    match (layout.fixed_start(phase), layout.phases[phase].duration) {
        (Some(start), Time::Fixed(duration)) => {
            format!("{}{name}", structure.independent.place(start + at.tau * duration, brief))
        }
        _ => format!("tau = {}{name}", brief(at.tau)),
    }
}

/// Whether a name that a program gives means this thing: by its name, for a family also without
/// index, and with or without the path of its agent.
pub(crate) fn means(given: &str, path: &str, name: &str, index: Option<i64>) -> bool {
    means_member(given, path, (name, None), index)
}

/// As [`means`], of a member of an array.
pub(crate) fn means_member(
    given: &str,
    path: &str,
    (name, family): (&str, Option<Family>),
    index: Option<i64>,
) -> bool {
    let bare = given.strip_prefix(path).and_then(|rest| rest.strip_prefix('.')).unwrap_or(given);
    bare == name || bare == member(name, family, index)
}

/// Whether a name means a phase's duration: the phase's path or name, or the name of its duration.
pub(crate) fn means_duration(structure: &Structure, layout: &Layout, given: &str, phase: usize) -> bool {
    let member = &layout.phases[phase];
    let declared = &structure.phases[member.phase];
    let path = agent(structure, layout, member.agent);
    let own = [&declared.name, &declared.duration_name];
    own.into_iter().flatten().any(|name| means(given, &path, name, member.index))
        || (!given.is_empty() && given == self::phase(structure, layout, phase))
}

/// A name that a program gives and nothing bears.
pub(crate) fn unknown(what: &str, name: &str, structure: &Structure) -> SetupError {
    let outputs =
        structure.phases.iter().flat_map(|p| p.outputs.iter().filter(|o| !o.is_helper()).map(|o| o.name.as_str()));
    let durations =
        structure.phases.iter().flat_map(|p| p.name.as_deref().into_iter().chain(p.duration_name.as_deref()));
    let whole = structure.agents.iter().filter_map(|agent| agent.duration_name.as_deref());
    let variables = structure.variables.iter().filter(|v| !v.is_helper()).map(|v| v.name.as_str());
    let mut known: Vec<&str> = vec![];
    for candidate in outputs.chain(durations).chain(whole).chain(variables) {
        if !known.contains(&candidate) {
            known.push(candidate);
        }
    }
    let known: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
    SetupError::Guess { message: format!("{what} is given for `{name}`, which is none of {}", known.join(", ")) }
}
