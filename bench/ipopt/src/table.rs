//! What is printed: a line for each spec, then the totals.

use serde_json::{Map, Value, json};

/// From this many times IPOPT's iterations on a spec is named below the totals.
const MANY: f64 = 2.0;

/// Relative difference from which two optima are different ones.
const DIFFERENT: f64 = 1e-6;

/// The head of the table.
pub(crate) fn head() -> String {
    let solver = |name: &str| format!("{name:<26} {:>17} {:>6} {:>8}", "objective", "its", "cpu s");
    format!("{:<34} | {} | {} | ratio", "spec", solver("ntg"), solver("IPOPT"))
}

/// A spec's line.
pub(crate) fn line(name: &str, found: &Value) -> String {
    let solver = |one: &Value| {
        let status: String = one["status"].as_str().unwrap_or("–").chars().take(26).collect();
        let objective = one["objective"].as_f64().map_or("–".into(), number);
        let iterations = one["iterations"].as_u64().map_or("–".into(), |count| count.to_string());
        let seconds = one["cpu"].as_f64().map_or("–".into(), |seconds| format!("{seconds:.3}"));
        format!("{status:<26} {objective:>17} {iterations:>6} {seconds:>8}")
    };
    let mut more = ratio(found).map_or("–".into(), |ratio| format!("{ratio:.2}"));
    if let Some(worse) = difference(found).filter(|worse| worse.abs() > DIFFERENT) {
        more += &format!("  ntg {} by {:.1e}", if worse > 0.0 { "worse" } else { "better" }, worse.abs());
    }
    format!("{name:<34} | {} | {} | {more}", solver(&found["ntg"]), solver(&found["ipopt"]))
}

/// Eleven digits, as they are or with an exponent.
fn number(value: f64) -> String {
    let is_plain = (1e-3..1e6).contains(&value.abs()) || value == 0.0;
    if is_plain { format!("{value:.10}") } else { format!("{value:.9e}") }
}

fn is_solved(one: &Value) -> bool {
    one["solved"].as_bool() == Some(true)
}

fn both(found: &Value) -> bool {
    is_solved(&found["ntg"]) && is_solved(&found["ipopt"])
}

/// ntg's iterations over IPOPT's, where both solve; one iteration counts as one where there was none.
fn ratio(found: &Value) -> Option<f64> {
    let count = |one: &Value| one["iterations"].as_f64().map(|count| count.max(1.0));
    if both(found) { Some(count(&found["ntg"])? / count(&found["ipopt"])?) } else { None }
}

/// By how much ntg's optimum is worse, relative to IPOPT's, where both solve.
fn difference(found: &Value) -> Option<f64> {
    if !both(found) {
        return None;
    }
    let (ours, theirs) = (found["ntg"]["objective"].as_f64()?, found["ipopt"]["objective"].as_f64()?);
    let sign = if found["ipopt"]["maximize"].as_bool() == Some(true) { -1.0 } else { 1.0 };
    let size = ours.abs().max(theirs.abs());
    // Objectives that are nothing but rounding beside 1 are the same.
    if size < f64::EPSILON { Some(0.0) } else { Some(sign * (ours - theirs) / size.max(DIFFERENT)) }
}

/// Totals as data, for the file beside.
pub(crate) fn totals(all: &Map<String, Value>) -> Value {
    let names = |keep: &dyn Fn(&Value) -> bool| {
        all.iter().filter(|(_, found)| keep(found)).map(|(name, _)| name.clone()).collect::<Vec<_>>()
    };
    let sum = |solver: &str, key: &str| -> f64 {
        all.values().filter(|found| both(found)).filter_map(|found| found[solver][key].as_f64()).sum()
    };
    let solved = |solver: &'static str| move |found: &Value| is_solved(&found[solver]);
    let (ours, theirs) = (solved("ntg"), solved("ipopt"));
    json!({
        "specs": all.len(),
        "both": names(&both).len(),
        "only_ntg": names(&|found| ours(found) && !theirs(found)),
        "only_ipopt": names(&|found| !ours(found) && theirs(found)),
        "neither": names(&|found| !ours(found) && !theirs(found)),
        "iterations": { "ntg": sum("ntg", "iterations"), "ipopt": sum("ipopt", "iterations") },
        "cpu": { "ntg": sum("ntg", "cpu"), "ipopt": sum("ipopt", "cpu") },
        "many_iterations": names(&|found| ratio(found).is_some_and(|ratio| ratio > MANY)),
        "ntg_worse": names(&|found| difference(found).is_some_and(|worse| worse > DIFFERENT)),
        "ntg_better": names(&|found| difference(found).is_some_and(|worse| worse < -DIFFERENT)),
    })
}

/// Totals for a person.
pub(crate) fn summary(all: &Map<String, Value>) -> String {
    let totals = totals(all);
    let list =
        |key: &str| -> Vec<&str> { totals[key].as_array().into_iter().flatten().filter_map(Value::as_str).collect() };
    let named = |what: &str, key: &str| match list(key) {
        names if names.is_empty() => format!("{what}: 0"),
        names => format!("{what}: {} ({})", names.len(), names.join(", ")),
    };
    let pair = |key: &str| (totals[key]["ntg"].as_f64().unwrap_or(0.0), totals[key]["ipopt"].as_f64().unwrap_or(0.0));
    let (its, cpu) = (pair("iterations"), pair("cpu"));
    let mut lines = vec![
        format!("{} specs, solved by both: {}", totals["specs"], totals["both"]),
        named("only ntg", "only_ntg"),
        named("only IPOPT", "only_ipopt"),
        named("neither", "neither"),
        format!("of those that both solve, iterations: ntg {}, IPOPT {}, ratio {:.2}", its.0, its.1, its.0 / its.1),
        format!("processor seconds: ntg {:.2}, IPOPT {:.2}, ratio {:.3}", cpu.0, cpu.1, cpu.0 / cpu.1),
        named("ntg's optimum is worse", "ntg_worse"),
        named("ntg's optimum is better", "ntg_better"),
    ];
    let many = all.iter().filter_map(|(name, found)| Some((name, ratio(found)?))).filter(|(_, ratio)| *ratio > MANY);
    let mut many: Vec<_> = many.collect();
    many.sort_by(|a, b| b.1.total_cmp(&a.1));
    lines.push(format!("more than {MANY} times IPOPT's iterations: {}", many.len()));
    lines.extend(many.iter().map(|(name, ratio)| format!("  {name}: {ratio:.2}")));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(objective: f64, iterations: usize) -> Value {
        json!({ "solved": true, "objective": objective, "iterations": iterations, "cpu": 0.5 })
    }

    fn failed() -> Value {
        json!({ "solved": false, "status": "time limit" })
    }

    #[test]
    fn totals_count_iterations_where_both_solve() {
        let mut all = Map::new();
        all.insert("a".into(), json!({ "ntg": solved(1.0, 30), "ipopt": solved(1.0, 10) }));
        all.insert("b".into(), json!({ "ntg": solved(2.0, 10), "ipopt": solved(1.0, 20) }));
        all.insert("c".into(), json!({ "ntg": failed(), "ipopt": solved(1.0, 99) }));
        all.insert("d".into(), json!({ "ntg": solved(1.0, 99), "ipopt": failed() }));
        let totals = totals(&all);
        assert_eq!(totals["both"], 2);
        assert_eq!(totals["iterations"], json!({ "ntg": 40.0, "ipopt": 30.0 }));
        assert_eq!((&totals["only_ntg"], &totals["only_ipopt"]), (&json!(["d"]), &json!(["c"])));
        assert_eq!((&totals["many_iterations"], &totals["ntg_worse"]), (&json!(["a"]), &json!(["b"])));
    }

    #[test]
    fn a_larger_maximum_is_better() {
        let mut theirs = solved(1.0, 1);
        theirs["maximize"] = json!(true);
        assert_eq!(difference(&json!({ "ntg": solved(2.0, 1), "ipopt": theirs })), Some(-0.5));
    }
}
