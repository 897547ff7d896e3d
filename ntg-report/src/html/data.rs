//! The numbers that the page's program draws, as short as they can be written.

use serde_json::{Value, json};

use super::Page;
use crate::figure::{self, Line, Panel, Runs};

/// Numbers that all charts together may hold, so that a page stays below a megabyte.
const BUDGET: usize = 60_000;
/// Points of a line at most, and at least.
const MOST: usize = 401;
const LEAST: usize = 24;
/// Significant digits that a screen can show.
const DIGITS: usize = 6;

/// Which charts there are, by section, and their data.
pub(super) struct Charts {
    pub(super) tracks: Vec<usize>,
    pub(super) outputs: Vec<usize>,
    pub(super) lets: Vec<usize>,
    pub(super) constraints: Vec<usize>,
    pub(super) multipliers: Vec<usize>,
    pub(super) convergence: Vec<usize>,
    /// A JSON array of charts, safe inside a `script` element.
    pub(super) json: String,
}

/// All charts of a page.
pub(super) fn charts(runs: &Runs<'_>, page: &Page) -> Result<Charts, String> {
    let mut tracks = vec![];
    for (x, y) in &page.tracks {
        tracks.push(figure::track(runs, x, y)?);
    }
    if let (true, Some((x, y))) = (tracks.is_empty(), figure::likely_track(runs[0].1)) {
        tracks.extend(figure::track(runs, x, y));
    }
    let convergence = figure::convergence(runs);
    let convergence = if convergence.lines.iter().any(|l| !l.points.is_empty()) { vec![convergence] } else { vec![] };
    let sections = [
        tracks,
        figure::outputs(runs),
        figure::lets(runs),
        figure::constraints(runs),
        figure::multipliers(runs),
        convergence,
    ];
    let lines: usize = sections.iter().flatten().map(|panel| panel.lines.len()).sum();
    // Two numbers a point.
    let points = (BUDGET / (2 * lines.max(1))).clamp(LEAST, MOST);
    let mut all = vec![];
    let ids = sections.map(|panels| {
        let first = all.len();
        all.extend(panels.iter().map(|panel| chart(panel, points)));
        (first..all.len()).collect::<Vec<usize>>()
    });
    // `</script>` in a name would end the element.
    let json = Value::Array(all).to_string().replace('<', "\\u003c");
    let [tracks, outputs, lets, constraints, multipliers, convergence] = ids;
    Ok(Charts { tracks, outputs, lets, constraints, multipliers, convergence, json })
}

fn chart(panel: &Panel, points: usize) -> Value {
    let kind = match (panel.logarithmic, panel.lines.iter().any(|line| !line.times.is_empty())) {
        (true, _) => "log",
        (false, true) => "map",
        (false, false) => "time",
    };
    json!({
        "kind": kind,
        "title": panel.title,
        "x": panel.x,
        "y": panel.y,
        "equal": panel.equal,
        "lines": panel.lines.iter().map(|line| self::line(line, points)).collect::<Vec<_>>(),
        "limits": panel.limits.iter().map(|(at, name)| json!([short(*at), name])).collect::<Vec<_>>(),
        "marks": panel.marks.iter().map(|(at, name)| json!([short(*at), name])).collect::<Vec<_>>(),
    })
}

fn line(line: &Line, points: usize) -> Value {
    let keep = kept(line.points.len(), points);
    let of = |pick: &dyn Fn(usize) -> f64| keep.iter().map(|i| short(pick(*i))).collect::<Vec<_>>();
    let mut value = json!({
        "name": line.name,
        "run": line.run,
        "x": of(&|i| line.points[i].0),
        "y": of(&|i| line.points[i].1),
    });
    if !line.times.is_empty() {
        value["t"] = json!(of(&|i| line.times[i]));
        value["events"] = json!(line.events.iter().map(|(x, y)| [short(*x), short(*y)]).collect::<Vec<_>>());
    }
    value
}

/// Indices of at most `most` points, both ends among them.
fn kept(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|i| i * (count - 1) / (most - 1)).collect()
}

/// A number with as many digits as a screen can show; null where it is not finite.
fn short(value: f64) -> Value {
    let text = format!("{value:.digits$e}", digits = DIGITS);
    let rounded: f64 = text.parse().unwrap_or(f64::NAN);
    if rounded.is_finite() && rounded == rounded.trunc() && rounded.abs() < 1e9 {
        return json!(rounded as i64);
    }
    json!(rounded)
}
