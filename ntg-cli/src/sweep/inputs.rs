//! Parameter sets from ranges and tables.

use std::path::Path;

use ntg_interp::{Interpreted, Place, quantity, target};
use ntg_runtime::problem::Problem;
use ntg_runtime::structure::Parameter;
use ntg_sweep::{Range, grid};

use super::dispersion;
use crate::values::Assignments;
use crate::{files, reading};

/// How a range is written.
const FORM: &str = "a range is NAME=FIRST:LAST:COUNT, such as `v_max=0.2:0.3:11` or `v_max=\"200:300:11 [m/s]\"`";

/// What is set, and to which values, in declared units.
pub(super) struct Sets {
    pub(super) names: Vec<String>,
    pub(super) rows: Vec<Vec<f64>>,
}

/// The assignments that hold for all rows: those without a range.
pub(super) fn fixed(set: &[String]) -> Vec<String> {
    set.iter().filter(|text| !text.contains(':')).cloned().collect()
}

/// All parameter sets: every row of the table with every combination of the ranges and with every sample of what is
/// dispersed. The problem takes the values that hold for all rows.
pub(super) fn sets(
    problem: &mut Interpreted,
    (assignments, from): (&Assignments, Option<&Path>),
    dispersion: &dispersion::Dispersed,
) -> Result<Sets, String> {
    let set = &assignments.parameters;
    for assignment in fixed(set) {
        assignments.put_one(problem, &assignment).map_err(|message| match assignment.contains("..") {
            true => format!("{message}; {FORM}"),
            false => message,
        })?;
    }
    let mut names = vec![];
    let mut rows = vec![vec![]];
    if let Some(path) = from {
        (names, rows) = table(problem, path)?;
    }
    let mut ranges = vec![];
    for text in set.iter().filter(|text| text.contains(':')) {
        let (name, range) = range(problem, text).map_err(|message| format!("--set {text}: {message}"))?;
        names.push(name);
        ranges.push(range);
    }
    let samples = dispersion.samples(problem)?;
    names.extend(samples.names);
    if names.is_empty() {
        return Err("nothing is varied; give a range, such as `--set v_max=0.2:0.3:11`, a table with --from, or what \
                    is dispersed with --disperse"
            .into());
    }
    if let Some(name) = names.iter().enumerate().find_map(|(i, name)| names[..i].contains(name).then_some(name)) {
        return Err(format!("`{name}` is varied twice"));
    }
    let rows = product(&product(&rows, &grid(&ranges)?), &samples.rows);
    if rows.is_empty() {
        return Err("there is no parameter set: the table has no rows, or a range no values".into());
    }
    Ok(Sets { names, rows })
}

/// Every row with every other one, the others running fastest.
fn product(rows: &[Vec<f64>], others: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let joined = |row: &Vec<f64>| {
        let one = |more: &Vec<f64>| row.iter().chain(more).copied().collect();
        others.iter().map(one).collect::<Vec<Vec<f64>>>()
    };
    rows.iter().flat_map(joined).collect()
}

/// Where the number of a parameter or member stands.
pub(super) fn place(problem: &Interpreted, name: &str) -> Result<Place, String> {
    parameter(problem, name)?;
    let (base, indices) = target(name)?;
    problem.place(base, &indices).map_err(|error| error.to_string())
}

/// The parameter that a name or member belongs to.
pub(super) fn parameter(problem: &Interpreted, name: &str) -> Result<Parameter, String> {
    let (base, _) = target(name)?;
    let structure = problem.structure();
    let known: Vec<String> = structure.parameters.iter().map(|p| p.name.clone()).collect();
    structure.parameters.into_iter().find(|p| p.name == base).ok_or_else(|| match known.is_empty() {
        true => format!("`{base}` cannot be varied: the problem has no parameters"),
        false => format!("there is no parameter `{base}`; the parameters are: `{}`", known.join("`, `")),
    })
}

/// One number, in the declared unit of a parameter.
fn number(parameter: &Parameter, text: &str) -> Result<f64, String> {
    match quantity(text, &parameter.unit)?[..] {
        [value] => Ok(parameter.unit.typed(value)),
        _ => Err(format!("`{text}` is not one number")),
    }
}

/// `name=first:last:count [unit]`.
fn range(problem: &Interpreted, text: &str) -> Result<(String, Range), String> {
    let (name, range) = text.split_once('=').ok_or(FORM)?;
    let name = name.trim();
    let (range, unit) = range.find('[').map_or((range, ""), |at| range.split_at(at));
    let [first, last, count] = range.split(':').map(str::trim).collect::<Vec<_>>()[..] else {
        return Err(FORM.to_owned());
    };
    let parameter = parameter(problem, name)?;
    let end = |text: &str| number(&parameter, format!("{text} {unit}").trim());
    let count: usize = count.parse().map_err(|_| format!("`{count}` is no number of values; {FORM}"))?;
    let range = Range { first: end(first)?, last: end(last)?, count };
    // Whatever is wrong with the name shows here and not in every row.
    place(problem, name)?;
    Ok((name.to_owned(), range))
}

type Read = (Vec<String>, Vec<Vec<f64>>);

/// A table of parameter sets.
fn table(problem: &Interpreted, path: &Path) -> Result<Read, String> {
    if let Err(error) = reading::checked(path) {
        return Err(files::unread_of(path, "csv", &error));
    }
    let table = ntg_sweep::read(path)?;
    if table.names.is_empty() {
        let shown = path.display();
        return Err(format!(
            "`{shown}` is empty; its first line names parameters, and every further one is a set of values"
        ));
    }
    // An index has no blank before its bracket.
    if let Some(name) = table.names.iter().find(|name| name.contains(" [")) {
        return Err(format!(
            "`{}`: a column is called as its parameter, without the unit of `{name}`: numbers are in declared units, or each has \
             its own, as `1 [m/s]`",
            path.display()
        ));
    }
    let parameters = table.names.iter().map(|name| parameter(problem, name)).collect::<Result<Vec<_>, _>>();
    let parameters = parameters.map_err(|message| format!("`{}`: {message}", path.display()))?;
    let mut rows = vec![];
    for (line, row) in table.rows.iter().enumerate() {
        let mut set = vec![];
        for ((name, parameter), cell) in table.names.iter().zip(&parameters).zip(row) {
            // Bare numbers, the usual case, need no parser.
            let value = cell.parse().ok().filter(|value: &f64| value.is_finite());
            let value = value.map_or_else(|| number(parameter, cell), Ok);
            set.push(
                value.map_err(|message| format!("`{}`: row {line}, `{name}` = `{cell}`: {message}", path.display()))?,
            );
        }
        rows.push(set);
    }
    for name in &table.names {
        place(problem, name).map_err(|message| format!("`{}`: {message}", path.display()))?;
    }
    Ok((table.names, rows))
}
