//! `ntg plot`: a picture of what was found.

use std::path::PathBuf;

use ntg_report::figure::{self, Panel};
use ntg_report::{Run, draw, html, png};
use ntg_runtime::digits::decimals;

use crate::runs::{self, Inputs};
use crate::{Exit, write};

/// Draw outputs, named expressions, constraints with their bounds, and tracks.
///
/// Examples:
///   ntg plot specs/van_der_pol.ntg -o oscillator.svg
///   ntg plot mission.ntg --xy x,y --show speed -o track.png
///   ntg plot slow.json fast.json --show speed -o comparison.svg
///   ntg plot mission.ntg --starts 50 --xy x,y -o minima.svg     # every local minimum
#[derive(clap::Args, Debug)]
#[command(verbatim_doc_comment)]
pub(crate) struct Arguments {
    #[command(flatten)]
    inputs: Inputs,
    /// Where to write; `.svg` or `.png`.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Draw a track of two quantities, `x,y` or of a vector `"r[1],r[2]"`, with equal axes where they have the same unit.
    #[arg(long, value_name = "X,Y", value_parser = runs::pair)]
    xy: Vec<(String, String)>,
    /// Draw this quantity or constraint (by name) over time: of all agents and members, or of one
    /// (`striker.x`, `x[2]`); without `--show` and `--xy` everything is drawn, tracks first.
    #[arg(long, value_name = "NAME")]
    show: Vec<String>,
    /// Draw named expressions that only serve others, too: those without unit and documentation that stand in no
    /// constraint and in no objective.
    #[arg(long)]
    all: bool,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Svg,
    Png,
}

/// Pixels of a PNG for one unit of the SVG, whose text is meant for 1600 units across.
const SCALE: f32 = 1.0;

/// Digits of an objective behind the point.
pub(crate) const DECIMALS: usize = 6;

pub(crate) fn run(arguments: &Arguments) -> Result<Exit, String> {
    let kind = match arguments.output.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("svg") => Kind::Svg,
        Some("png") => Kind::Png,
        _ => return Err(format!("`{}`: plots are .svg or .png files", arguments.output.display())),
    };
    write::may_write(&arguments.output, arguments.force)?;
    let loaded = arguments.inputs.load(&arguments.output)?;
    let runs: Vec<(String, &Run)> = loaded.iter().map(|(name, run)| (name.clone(), run)).collect();
    let panels = panels(arguments, &runs)?;
    let names: Vec<&str> = runs.iter().map(|(_, run)| run.problem.as_str()).collect();
    let svg = draw::svg(names[0], &sentence(&runs), &panels)?;
    let bytes = match kind {
        Kind::Svg => svg.into_bytes(),
        Kind::Png => png::png(&svg, SCALE)?,
    };
    write::whole(&arguments.output, arguments.force, &bytes)?;
    Ok(Exit::Done)
}

fn panels(arguments: &Arguments, runs: &figure::Runs<'_>) -> Result<Vec<Panel>, String> {
    let mut panels = vec![];
    for (x, y) in &arguments.xy {
        panels.push(figure::track(runs, x, y)?);
    }
    let everything = arguments.show.is_empty() && arguments.xy.is_empty();
    let mut over_time = figure::outputs(runs);
    over_time.extend(figure::lets(runs, arguments.all || !everything));
    over_time.extend(figure::constraints(runs));
    if everything {
        panels.extend(figure::tracks(runs));
        panels.extend(figure::side(runs));
        panels.extend(over_time);
        return Ok(panels);
    }
    for name in &arguments.show.iter().flat_map(|one| runs::names(one)).collect::<Vec<_>>() {
        let mut named: Vec<Panel> = over_time.iter().filter(|panel| panel.title == *name).cloned().collect();
        if named.is_empty() {
            named = figure::quantity(runs, name);
        }
        if named.is_empty() {
            let mut known: Vec<&str> = vec![];
            for panel in &over_time {
                if !known.contains(&panel.title.as_str()) {
                    known.push(&panel.title);
                }
            }
            return Err(format!("there is no `{name}` over time; there are: `{}`", known.join("`, `")));
        }
        panels.extend(named);
    }
    Ok(panels)
}

/// What one should know before looking.
fn sentence(runs: &figure::Runs<'_>) -> String {
    let one = |run: &Run| {
        let unit = if run.objective_unit.is_empty() { String::new() } else { format!(" {}", run.objective_unit) };
        format!("{}, objective {}{unit}", html::ending(run), decimals(run.objective, DECIMALS))
    };
    if let [(_, best), others @ ..] = runs
        && let Some(found) = best.starts.as_ref().filter(|_| others.iter().all(|(_, run)| run.spec.is_none()))
    {
        // The names of minima, which the legend has, say their objectives.
        let minima = if found.minima.len() == 1 { "minimum" } else { "minima" };
        let (solved, tried, count) = (found.solved, found.tried, found.minima.len());
        return format!("{solved} of {tried} starts solved, {count} local {minima}; the best: {}", one(best));
    }
    match runs {
        [(_, run)] => one(run),
        several => several.iter().map(|(name, run)| format!("{name}: {}", one(run))).collect::<Vec<_>>().join("; "),
    }
}
