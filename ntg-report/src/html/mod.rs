//! One HTML page that needs no network: what a colleague should see of one run or several.
//!
//! Takes [`Run`]s; gives a page that holds its styles, its program (uPlot for charts over time, a
//! small one of ours for maps) and its data.

mod data;
mod ending;
mod estimate;
mod extremes;
mod spec;
mod study;
mod tables;

pub use ending::{ending, resolution};

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::figure;
use crate::run::{Independent, Run};

const STYLE: &str = include_str!("../assets/report.css");
const UPLOT_STYLE: &str = include_str!("../assets/uPlot.min.css");
const UPLOT: &str = include_str!("../assets/uPlot.iife.min.js");
const PROGRAM: &str = include_str!("../assets/report.js");
const MAP: &str = include_str!("../assets/map.js");
const SPACE: &str = include_str!("../assets/space.js");
const CLOCK: &str = include_str!("../assets/clock.js");

/// What stands in a page beside the runs.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// Pairs of quantities to draw as maps; empty for positions, where there are any.
    pub tracks: Vec<(String, String)>,
    /// Whether named expressions that only serve others are shown, too.
    pub all: bool,
}

/// The page about runs, each with its name. The first is shown in full, the others are compared.
///
/// # Errors
/// In words: no run, or a track of unknown quantities.
pub fn page(runs: &figure::Runs<'_>, page: &Page) -> Result<String, String> {
    let Some((_, first)) = runs.first() else { return Err("there is no run to report".to_owned()) };
    let data = data::charts(runs, page)?;
    let title = format!("{} · ntg report", first.problem);
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";
                title { (title) }
                style { (PreEscaped(UPLOT_STYLE)) (PreEscaped(STYLE)) }
            }
            body {
                (head(first))
                main {
                    (summary(first))
                    (study::explanation(first))
                    (study::minima(first))
                    (estimate::section(first))
                    (charts("residuals", "Residuals", &data.residuals, &first.independent))
                    @if runs.len() > 1 { (tables::comparison(runs)) }
                    (charts("tracks", "Tracks", &data.tracks, &first.independent))
                    (extremes::section(runs, page.all))
                    (charts("outputs", "Outputs", &data.outputs, &first.independent))
                    (charts("lets", "Named expressions", &data.lets, &first.independent))
                    (helpers(first, page.all))
                    (charts("constraints", "Constraints and their bounds", &data.constraints, &first.independent))
                    (charts("multipliers", "Multipliers", &data.multipliers, &first.independent))
                    @for (name, run) in runs { (spec::section(name, run, runs.len() > 1)) }
                    (tables::constraints(first))
                    (tables::quantities(first))
                    (charts("convergence", "Convergence", &data.convergence, &first.independent))
                    (tables::history(first))
                    (study::refinement(first))
                    (tables::discretisation(first))
                }
                footer { "Made by ntg " (env!("CARGO_PKG_VERSION")) ". Charts by uPlot (MIT licence, Leon Sorokin). This page needs no network." }
                script type="application/json" id="data" { (PreEscaped(data.json)) }
                script { (PreEscaped(UPLOT)) }
                script { (PreEscaped(MAP)) (PreEscaped(SPACE)) (PreEscaped(CLOCK)) (PreEscaped(PROGRAM)) }
            }
        }
    };
    Ok(markup.into_string())
}

fn head(run: &Run) -> Markup {
    html! {
        header {
            div.bar {
                h1 { (run.problem) }
                (ending::status(run))
                button #theme type="button" title="light or dark" { "◐" }
            }
            @let doc = run.doc.split("\n\n").next().unwrap_or("");
            @if !doc.is_empty() { p.doc { (tables::prose(doc)) } }
            nav {
                @for (anchor, name) in [("minima", "Local minima"), ("estimate", "Estimate"), ("tracks", "Tracks"), ("extremes", "Extremes"), ("outputs", "Outputs"), ("constraints", "Constraints"), ("spec", "Spec"), ("table", "Table"), ("convergence", "Convergence"), ("discretisation", "Discretisation")] {
                    a href={ "#" (anchor) } { (name) }
                }
            }
        }
    }
}

/// The numbers that one looks at first.
fn summary(run: &Run) -> Markup {
    let unit = &run.objective_unit;
    html! {
        section #summary {
            (ending::cost(run))
            (ending::missed(run))
            @if !run.advice.is_empty() { p.advice { "Try: " (tables::prose(&run.advice)) } }
            dl.cards {
                (card("objective", &tables::with_unit(run.objective, unit), "as discretised"))
                (card("finely integrated", &tables::with_unit(run.objective_fine, unit), "closer to what following it would cost"))
                (card("violation at points", &tables::small(run.violation.points), "largest, relative to the bounds"))
                (card("between points", &tables::small(run.violation.between), "largest, on a finer grid"))
                @if let Some(last) = run.convergence.last() { (card("stationarity", &tables::small(last.dual), "largest part of the Lagrangian's gradient at the reported point, scaled")) }
                (card("iterations", &run.iterations.to_string(), "over all steps"))
                (card("computing time", &tables::seconds(run.seconds), "of the solve"))
            }
            @if run.terms.len() > 1 { (tables::terms(run)) }
        }
    }
}

fn card(name: &str, value: &str, note: &str) -> Markup {
    html! { div.card title=(note) { dt { (name) } dd { (value) } } }
}

/// Which named expressions are not drawn.
fn helpers(run: &Run, all: bool) -> Markup {
    let mut names: Vec<&str> = vec![];
    for (path, _) in run.lets.iter().filter(|(_, series)| series.helper && !all) {
        if !names.contains(&figure::base(path)) {
            names.push(figure::base(path));
        }
    }
    html! {
        @if !names.is_empty() {
            p.quiet {
                "Not drawn, because they only serve other expressions: "
                @for (number, name) in names.iter().enumerate() { @if number > 0 { ", " } code { (name) } }
                ". " code { "ntg report --all" } " draws them, too; so does a comment " code { "///" } " before one of them."
            }
        }
    }
}

/// Places where the page's program draws; nothing where there is nothing to draw.
fn charts(anchor: &str, title: &str, ids: &[usize], independent: &Independent) -> Markup {
    html! {
        @if !ids.is_empty() {
            section id=(anchor) {
                h2 { (title) }
                @if anchor == "multipliers" { p.quiet {
                    "Of limits along a trajectory: densities, the mean of each interval. Their integral is dJ*/d(bound) of the table below."
                } }
                @if anchor == "residuals" { p.quiet {
                    "The model without what was measured, with the standard deviation to both sides: two of three bars should reach across zero."
                } }
                @if anchor == "tracks" { div #clock data-name=(independent.name) data-unit=(independent.unit) {} }
                div.charts { @for id in ids { figure.chart data-chart=(id) {} } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_printed_page_is_light_and_as_wide_as_its_sheet() {
        for event in ["\"beforeprint\", () => print(true)", "\"afterprint\", () => print(false)"] {
            assert!(PROGRAM.contains(event), "{event}");
        }
        assert!(PROGRAM.contains("wear(!on && worn)"));
        assert!(STYLE.contains(":root.paper body { width: 17.5cm;"));
    }

    #[test]
    fn nothing_is_left_out_without_a_word() {
        assert!(PROGRAM.contains("`beyond the picture: ${beyond.join"), "limits far from the values");
        for selector in [".scroll {", ".scroll.tall, .chart.crowded .u-legend {"] {
            let rule = STYLE.rsplit(selector).next().and_then(|rest| rest.split('}').next());
            assert!(rule.is_some_and(|rule| rule.contains("no-repeat local")), "{selector} has a shadow: {rule:?}");
        }
        for picture in [MAP, SPACE] {
            assert!(picture.contains("taken.some((other) =>"), "names of places do not lie over each other");
        }
    }

    #[test]
    fn the_buttons_of_the_clock_need_no_signs_of_a_font() {
        assert!(!CLOCK.contains(['▶', '⏸']) && CLOCK.contains("<svg"));
    }

    #[test]
    fn what_users_write_wraps_wherever_it_may_be_longer_than_a_narrow_page() {
        for selector in [".u-legend th, .u-legend td {", "p, li, h2, h3 {", ".status {", "td.name {", "h1 {"] {
            let rule = STYLE.split(selector).nth(1).and_then(|rest| rest.split('}').next());
            assert!(rule.is_some_and(|rule| rule.contains("overflow-wrap: anywhere")), "{selector} {rule:?}");
        }
    }
}
