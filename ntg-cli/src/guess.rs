//! `--guess FILE`: starts from a saved solution.

use std::path::Path;

use ntg_interp::Interpreted;
use ntg_report::run::{FORMAT, elements, layout, unknown_version};
use ntg_runtime::guess::Guess;
use ntg_runtime::problem::Problem;
use ntg_runtime::structure::{Structure, Unit};
use serde_json::Value;

use crate::files;
use crate::runs::SAVED;

/// Reads a saved solution as a guess for a problem: its unknowns where the splines are the same,
/// its sampled outputs, durations and variables otherwise.
pub(crate) fn read(path: &Path, problem: &Interpreted) -> Result<Guess, String> {
    of(&saved(path)?, path, problem)
}

/// Where the splines of a guess come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The same unknowns.
    Unknowns,
    /// The samples of other splines.
    OtherSplines,
    /// The samples of a file that says nothing of its splines.
    SamplesAlone,
}

/// As [`read`], with where the splines come from, and the multipliers of the rows where they are the same; none in files
/// from before they were saved.
pub(crate) fn read_point(path: &Path, problem: &Interpreted) -> Result<(Guess, Origin, Option<Vec<f64>>), String> {
    let saved = saved(path)?;
    let origin = match has_unknowns(&saved, &problem.structure()) {
        true => Origin::Unknowns,
        false if saved["layout"].is_null() || saved["unknowns"].is_null() => Origin::SamplesAlone,
        false => Origin::OtherSplines,
    };
    let is_same = origin == Origin::Unknowns;
    let multipliers = numbers(&saved["row_multipliers"]).filter(|multipliers| is_same && !multipliers.is_empty());
    Ok((of(&saved, path, problem)?, origin, multipliers))
}

/// Whether a file has the unknowns of these splines.
fn has_unknowns(saved: &Value, structure: &Structure) -> bool {
    saved["layout"] == layout(structure) && saved["unknowns"].is_array()
}

/// A saved solution of a version that can be read, with an entry for each element of its arrays.
fn saved(path: &Path) -> Result<Value, String> {
    let mut saved: Value = serde_json::from_str(&files::json(path)?)
        .map_err(|e| format!("`{}` is not JSON: {e}; {SAVED}", path.display()))?;
    if saved["format"] != FORMAT {
        return Err(format!("`{}` is no saved solution (its \"format\" is not \"{FORMAT}\"); {SAVED}", path.display()));
    }
    if let Some(error) = unknown_version(&saved["version"]) {
        return Err(format!("`{}` {error}", path.display()));
    }
    for key in ["outputs", "variables"] {
        if let Some(entries) = saved.get_mut(key).and_then(Value::as_object_mut) {
            *entries = elements(std::mem::take(entries));
        }
    }
    Ok(saved)
}

/// The guess that a saved solution is. That of a problem without a common output is none.
fn of(saved: &Value, path: &Path, problem: &Interpreted) -> Result<Guess, String> {
    let structure = problem.structure();
    let damaged = |what: String| format!("`{}` is damaged: {what}", path.display());
    if let Some(what) = wrong_factor(saved) {
        return Err(damaged(what));
    }
    if has_unknowns(saved, &structure) {
        let Some(unknowns) = numbers(&saved["unknowns"]) else {
            return Err(format!("`{}`: not all of `unknowns` are finite numbers", path.display()));
        };
        check_units(saved, path, &structure)?;
        return Ok(Guess::saved(unknowns));
    }
    let mut guess = Guess::new();
    let own = structure.phases.iter().flat_map(|p| &p.outputs).filter(|output| !output.is_helper());
    let known: Vec<&str> = own.map(|output| output.name.as_str()).collect();
    let saved_outputs = || saved["outputs"].as_object().into_iter().flatten();
    if !known.is_empty() && !saved_outputs().any(|(name, _)| known.contains(&base(name).as_str())) {
        let mut theirs: Vec<String> = saved_outputs().map(|(name, _)| format!("`{}`", base(name))).collect();
        theirs.dedup();
        return Err(format!(
            "`{}` is the solution of another problem: it has {}, and none of the outputs of `{}`",
            path.display(),
            if theirs.is_empty() { "no outputs".to_owned() } else { theirs.join(", ") },
            problem.structure().name
        ));
    }
    check_units(saved, path, &structure)?;
    for (name, output) in saved_outputs() {
        let base = base(name);
        let base = base.as_str();
        let declared = structure.phases.iter().flat_map(|p| &p.outputs).find(|output| output.name == base);
        if let Some(declared) = declared {
            let (t, value) = samples(output).map_err(|what| damaged(format!("`{name}` {what}")))?;
            let scale = scale(output, &declared.unit);
            guess = guess.output(name, move |tau| scale * interpolate(&t, &value, tau));
        }
    }
    // What a saved time is in: seconds, unless it says otherwise.
    let unit = saved["independent"]["factor"].as_f64().unwrap_or(1.0);
    for phase in &structure.phases {
        let name = phase.duration_name.iter().chain(&phase.name);
        let free = matches!(phase.duration, ntg_runtime::structure::Duration::Free(_));
        for name in name.take(usize::from(free)) {
            if let Some(seconds) =
                saved["times"][name].as_f64().or(saved["times"][format!("duration({name})")].as_f64())
            {
                guess = guess.duration(name, seconds * unit);
            }
        }
    }
    for variable in &structure.variables {
        if let Some(value) = saved["variables"][&variable.name]["value"].as_f64() {
            guess = guess.variable(&variable.name, scale(&saved["variables"][&variable.name], &variable.unit) * value);
        }
    }
    Ok(guess)
}

/// The times and values of a saved output, or what is wrong with them.
fn samples(output: &Value) -> Result<(Vec<f64>, Vec<f64>), String> {
    let list =
        |key: &str| numbers(&output[key]).ok_or_else(|| format!("has a `{key}` that is no list of finite numbers"));
    let (t, value) = (list("t")?, list("value")?);
    if t.len() != value.len() {
        return Err(format!("has {} times in `t` and {} numbers in `value`", t.len(), value.len()));
    }
    if t.is_empty() {
        return Err("has no samples".to_owned());
    }
    if let Some(pair) = t.windows(2).find(|pair| pair[1] < pair[0]) {
        return Err(format!("has times that fall, from {} to {}", pair[0], pair[1]));
    }
    Ok((t, value))
}

/// The first factor of a unit that is none.
fn wrong_factor(saved: &Value) -> Option<String> {
    let entries = ["outputs", "variables"].iter().flat_map(|key| saved[*key].as_object().into_iter().flatten());
    let all = entries.map(|(name, entry)| (name.as_str(), entry)).chain([("independent", &saved["independent"])]);
    let mut wrong = all.filter_map(|(name, entry)| Some((name, entry["factor"].as_f64()?))).filter(|(_, f)| *f <= 0.0);
    wrong.next().map(|(name, factor)| format!("the `factor` of `{name}` is {factor}, and not positive"))
}

/// The last name of a path, without indices.
fn base(path: &str) -> String {
    let last = path.rsplit('.').next().unwrap_or(path);
    last.split('[').next().unwrap_or(last).to_owned()
}

/// Refuses what has a name of the problem and another dimension than it has there.
fn check_units(saved: &Value, path: &Path, structure: &Structure) -> Result<(), String> {
    let refused = |name: &str, theirs: &str, own: &Unit| {
        let told = |symbol: &str| if symbol.is_empty() { "a pure number".to_owned() } else { format!("in [{symbol}]") };
        format!(
            "`{}` is the solution of another problem: it has `{name}` {}, and `{}` has it {}",
            path.display(),
            told(theirs),
            structure.name,
            told(&own.symbol)
        )
    };
    let fits = |name: &str, saved: &Value, own: &Unit| match (saved["unit"].as_str(), factor(saved, own)) {
        (Some(unit), None) => Err(refused(name, unit, own)),
        _ => Ok(()),
    };
    let declared = || structure.phases.iter().flat_map(|phase| &phase.outputs);
    for (name, output) in saved["outputs"].as_object().into_iter().flatten() {
        if let Some(own) = declared().find(|own| own.name == base(name)) {
            fits(&base(name), output, &own.unit)?;
        }
    }
    for own in &structure.variables {
        fits(&own.name, &saved["variables"][&own.name], &own.unit)?;
    }
    let independent = &structure.independent;
    fits(saved["independent"]["name"].as_str().unwrap_or(&independent.name), &saved["independent"], &independent.unit)
}

/// What saved values are multiplied by: they are in the unit that they were saved in, the guess is in the declared one.
fn scale(saved: &Value, declared: &Unit) -> f64 {
    factor(saved, declared).unwrap_or(1.0)
}

/// A saved unit in declared ones; one where the file names none, none where the two are of different dimensions.
fn factor(saved: &Value, declared: &Unit) -> Option<f64> {
    let Some(symbol) = saved["unit"].as_str() else {
        return Some(saved["factor"].as_f64().map_or(1.0, |factor| factor / declared.factor));
    };
    let one = format!("1 [{}]", if symbol.is_empty() { "1" } else { symbol });
    let si = ntg_interp::quantity(&one, declared).ok()?;
    Some(si.first()? / declared.factor)
}

fn numbers(list: &Value) -> Option<Vec<f64>> {
    list.as_array()?.iter().map(Value::as_f64).collect()
}

/// The value at a fraction of the samples' time, linear between samples.
fn interpolate(t: &[f64], value: &[f64], tau: f64) -> f64 {
    let (Some(first), Some(last)) = (t.first(), t.last()) else { return 0.0 };
    let at = first + tau * (last - first);
    let right = t.partition_point(|x| *x < at).clamp(1, t.len().max(2) - 1);
    match (t.get(right - 1), t.get(right), value.get(right - 1), value.get(right)) {
        (Some(a), Some(b), Some(x), Some(y)) if b > a => x + (y - x) * ((at - a) / (b - a)).clamp(0.0, 1.0),
        (_, _, Some(x), _) => *x,
        _ => 0.0,
    }
}
