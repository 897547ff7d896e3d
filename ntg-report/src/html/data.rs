//! The numbers that the page's program draws, as short as they can be written.

use serde_json::{Value, json};

use super::Page;
use crate::figure::{self, Kind, Limit, Line, Panel, Runs, Shape, Space};
use crate::run::{Outline, Surface};

/// Numbers that all charts together may hold, so that a page stays below a megabyte.
const BUDGET: usize = 60_000;
/// Points of a line at most, and at least.
const MOST: usize = 401;
const LEAST: usize = 24;
/// Digits after the first one that a screen can show of a curve that begins near zero,
const DIGITS: usize = 6;
/// and at most of one that is nearly constant: its axis spans a part in 10^4.
const MOST_DIGITS: usize = 10;

/// Which charts there are, by section, and their data.
pub(super) struct Charts {
    pub(super) tracks: Vec<usize>,
    pub(super) outputs: Vec<usize>,
    pub(super) lets: Vec<usize>,
    pub(super) constraints: Vec<usize>,
    pub(super) multipliers: Vec<usize>,
    pub(super) convergence: Vec<usize>,
    pub(super) residuals: Vec<usize>,
    /// A JSON array of charts, safe inside a `script` element.
    pub(super) json: String,
}

/// All charts of a page.
pub(super) fn charts(runs: &Runs<'_>, page: &Page) -> Result<Charts, String> {
    let mut tracks = vec![];
    for (x, y) in &page.tracks {
        tracks.push(figure::track(runs, x, y)?);
    }
    if tracks.is_empty() {
        tracks.extend(figure::tracks(runs));
        tracks.extend(figure::side(runs));
    }
    let convergence = figure::convergence(runs);
    let convergence = if convergence.lines.iter().any(|l| !l.points.is_empty()) { vec![convergence] } else { vec![] };
    let sections = [
        tracks,
        figure::outputs(runs),
        figure::lets(runs, page.all),
        figure::constraints(runs),
        figure::multipliers(runs),
        convergence,
        figure::residuals(runs),
    ];
    let space = figure::space(runs);
    let lines: usize = sections.iter().flatten().map(|panel| panel.lines.len()).sum();
    let in_space = space.iter().map(|space| space.lines.len()).sum::<usize>();
    // Two numbers a point, and four in space.
    let points = (BUDGET / (2 * lines + 4 * in_space).max(1)).clamp(LEAST, MOST);
    let mut all: Vec<Value> = space.iter().map(|space| self::space(space, points)).collect();
    let mut ids = sections.map(|panels| {
        let first = all.len();
        all.extend(panels.iter().map(|panel| chart(panel, points)));
        (first..all.len()).collect::<Vec<usize>>()
    });
    if space.is_some() {
        ids[0].insert(0, 0);
    }
    // `</script>` in a name would end the element.
    let json = Value::Array(all).to_string().replace('<', "\\u003c");
    let [tracks, outputs, lets, constraints, multipliers, convergence, residuals] = ids;
    Ok(Charts { tracks, outputs, lets, constraints, multipliers, convergence, residuals, json })
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
        "least": figure::least_span(panel),
        "lines": panel.lines.iter().map(|line| self::line(line, points)).collect::<Vec<_>>(),
        "limits": panel.limits.iter().map(|limit| self::limit(limit, points)).collect::<Vec<_>>(),
        "shapes": panel.shapes.iter().map(shape).collect::<Vec<_>>(),
        "marks": panel.marks.iter().map(|(at, name)| json!([short(*at), name])).collect::<Vec<_>>(),
    })
}

/// Ordinate, name and the abscissas between which it holds; of a curve also its abscissas and ordinates.
fn limit(limit: &Limit, points: usize) -> Value {
    let Limit { at, name, over, curve } = limit;
    if curve.is_empty() {
        return json!([short(*at), name, short(over.0), short(over.1)]);
    }
    let keep = kept(curve.len(), points);
    let of = |pick: fn(&(f64, f64)) -> f64| keep.iter().map(|i| short(pick(&curve[*i]))).collect::<Vec<_>>();
    json!([short(*at), name, short(over.0), short(over.1), of(|p| p.0), of(|p| p.1)])
}

/// Kind, name, abscissas, ordinates, and the line to which alone it belongs.
fn shape(shape: &Shape) -> Value {
    let kind = match shape.kind {
        Kind::Area => "area",
        Kind::Border => "border",
        Kind::Contour => "contour",
        Kind::Ground => "ground",
        Kind::Place => "place",
    };
    let keep = kept(shape.points.len(), MOST);
    let of = |pick: fn(&(f64, f64)) -> f64| keep.iter().map(|i| short(pick(&shape.points[*i]))).collect::<Vec<_>>();
    json!([kind, shape.name, of(|p| p.0), of(|p| p.1), shape.of])
}

/// Tracks in space with what lies there, the third coordinate up.
fn space(space: &Space, points: usize) -> Value {
    let [a, b, up] = space.order;
    let turned = |at: &[f64]| [a, b, up].map(|axis| short(at.get(axis).copied().unwrap_or(f64::NAN)));
    let lines = space.lines.iter().map(|line| {
        let keep = kept(line.points.len(), points);
        let of = |axis: usize| keep.iter().map(|i| short(line.points[*i][axis])).collect::<Vec<_>>();
        json!({
            "name": line.name,
            "run": line.run,
            "x": of(0),
            "y": of(1),
            "z": of(2),
            "t": keep.iter().map(|i| short(line.times[*i])).collect::<Vec<_>>(),
            "events": line.events.iter().map(|at| at.map(short)).collect::<Vec<_>>(),
        })
    });
    let scenes = || std::iter::once((None, &space.scene)).chain(space.own.iter().map(|(of, scene)| (Some(*of), scene)));
    json!({
        "kind": "space",
        "title": space.title,
        "axes": space.axes,
        "equal": space.equal,
        "lines": lines.collect::<Vec<_>>(),
        "places": scenes().flat_map(|(of, scene)| scene.places.iter().map(move |place| {
            json!([place.name, turned(&place.at), of])
        })).collect::<Vec<_>>(),
        "surfaces": scenes().flat_map(|(of, scene)| scene.surfaces.iter().map(move |s| surface(s, of))).collect::<Vec<_>>(),
        "outlines": scenes().flat_map(|(of, scene)| scene.outlines.iter().map(move |o| outline(o, of))).collect::<Vec<_>>(),
        "balls": scenes().flat_map(|(of, scene)| scene.balls.iter().map(move |ball| json!({
            "name": ball.name, "out": ball.keep_out, "of": of, "centre": turned(&ball.centre),
            "half": ball.half_axes.iter().map(|half| turned(half)).collect::<Vec<_>>(),
        }))).collect::<Vec<_>>(),
    })
}

fn surface(surface: &Surface, of: Option<usize>) -> Value {
    let many = |values: &[f64]| values.iter().map(|value| short(*value)).collect::<Vec<_>>();
    json!({
        "name": surface.name, "floor": surface.is_ground(), "of": of,
        "x": many(&surface.x), "y": many(&surface.y), "z": many(&surface.z),
    })
}

fn outline(outline: &Outline, of: Option<usize>) -> Value {
    let points = |line: &Vec<[f64; 2]>| line.iter().map(|at| at.map(short)).collect::<Vec<_>>();
    json!({ "name": outline.name, "out": outline.keep_out, "of": of, "lines": outline.lines.iter().map(points).collect::<Vec<_>>() })
}

fn line(line: &Line, points: usize) -> Value {
    let keep = kept(line.points.len(), points);
    let of = |pick: &dyn Fn(usize) -> f64| keep.iter().map(|i| short(pick(*i))).collect::<Vec<_>>();
    let digits = digits(line.points.iter().map(|point| point.1));
    let mut value = json!({
        "name": line.name,
        "run": line.run,
        "x": of(&|i| line.points[i].0),
        "y": keep.iter().map(|i| rounded(line.points[*i].1, digits)).collect::<Vec<_>>(),
    });
    if let Some(like) = line.like {
        value["like"] = json!(like);
    }
    if !line.sigmas.is_empty() {
        value["sigma"] = json!(keep.iter().map(|i| short(line.sigmas[*i])).collect::<Vec<_>>());
    }
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

/// Digits after the first one so that rounding is no step of a curve: as many more as its values have in common.
fn digits(values: impl Iterator<Item = f64>) -> usize {
    let finite = values.filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let common = (low.abs().max(high.abs()) / (high - low)).log10();
    // NaN, of a constant as of nothing, is no digit.
    DIGITS + (common.max(0.0).ceil() as usize).min(MOST_DIGITS - DIGITS)
}

/// A number with as many digits as a screen can show; null where it is not finite.
fn short(value: f64) -> Value {
    rounded(value, DIGITS)
}

fn rounded(value: f64, digits: usize) -> Value {
    let text = format!("{value:.digits$e}");
    let rounded: f64 = text.parse().unwrap_or(f64::NAN);
    if rounded.is_finite() && rounded == rounded.trunc() && rounded.abs() < 1e9 {
        return json!(rounded as i64);
    }
    json!(rounded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_no_step_of_a_nearly_constant_curve() {
        let points: Vec<(f64, f64)> = (0..100).map(|k| (f64::from(k), 250.0 - 1e-8 * f64::from(k))).collect();
        let drawn = line(&Line { points: points.clone(), ..Line::default() }, MOST);
        let values: Vec<f64> = drawn["y"].as_array().expect("numbers").iter().filter_map(Value::as_f64).collect();
        // A thousandth of what the axis spans at least.
        assert!(values.iter().zip(&points).all(|(drawn, (_, exact))| (drawn - exact).abs() < 1e-3 * 0.025 * 1e-2));
        assert_eq!((digits([0.0, 1.0].into_iter()), digits([250.0, 250.0].into_iter())), (DIGITS, MOST_DIGITS));
        assert_eq!((digits([9.0, 10.0].into_iter()), digits([].into_iter())), (DIGITS + 1, DIGITS));
    }
}
