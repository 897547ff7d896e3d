//! `--set NAME=VALUE`: parameters in their declared units, or with a unit.

use ntg_compiler::diagnostic::{Code, Diagnostic};
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::problem::Problem;
use ntg_runtime::structure::{Structure, Unit};

/// Sets a parameter, all members of an array (`a=1,2,3`), or one member (`a[2]=1`).
pub(crate) fn set(problem: &mut Interpreted, assignment: &str) -> Result<(), String> {
    let say = |message: String| format!("--set {assignment}: {message}");
    let (target, text) = assignment
        .split_once('=')
        .filter(|(_, text)| !text.trim().is_empty())
        .ok_or_else(|| say("write NAME=VALUE, such as `v_max=0.2` or `v_max=\"200 [m/s]\"`".to_owned()))?;
    let (name, index) = target_of(target.trim()).map_err(&say)?;
    let structure = problem.structure();
    if let Some(found) = bounded(&structure).find(|bounded| *bounded == name) {
        return Err(say(format!("`{found}` is no parameter but declared with bounds: change them in the spec")));
    }
    let unit = structure.parameters.iter().find(|p| p.name == name).map(|p| p.unit.clone());
    let values = given(text, &unit.unwrap_or_default()).map_err(&say)?;
    let done = match (index, values.as_slice()) {
        (None, values) => problem.set(name, values),
        (Some(index), [value]) => problem.set_member(name, index, *value),
        (Some(index), values) => {
            return Err(say(format!("`{name}[{index}]` takes one value, but {} are given", values.len())));
        }
    };
    done.map_err(|error| say(error.to_string()))
}

/// The names of durations and variables.
fn bounded(structure: &Structure) -> impl Iterator<Item = &str> {
    let durations = structure.phases.iter().filter_map(|phase| phase.duration_name.as_deref());
    durations.chain(structure.variables.iter().map(|variable| variable.name.as_str()))
}

/// `name` or `name[index]`.
pub(crate) fn target_of(target: &str) -> Result<(&str, Option<i64>), String> {
    let Some((name, rest)) = target.split_once('[') else { return Ok((target, None)) };
    let index = rest.strip_suffix(']').and_then(|i| i.trim().parse().ok());
    let index =
        index.ok_or_else(|| format!("`{target}`: the index is a whole number in brackets, as in `{name}[2]`"))?;
    Ok((name.trim(), Some(index)))
}

/// Values in SI units.
pub(crate) fn given(text: &str, unit: &Unit) -> Result<Vec<f64>, String> {
    let source = Source::new("the command line", text);
    ntg_compiler::model::given(&source, unit).map_err(|found| {
        if found.iter().any(|finding| finding.code == Code::UnknownName) {
            let unit = if unit.symbol.is_empty() { "1" } else { &unit.symbol };
            return format!("write a number, alone or with a unit such as `1 [{unit}]`");
        }
        let one = |finding: &Diagnostic| match &finding.help {
            Some(help) => format!("{}; {help}", finding.message),
            None => finding.message.clone(),
        };
        format!("`{}`: {}", text.trim(), found.iter().map(one).collect::<Vec<_>>().join("; "))
    })
}
