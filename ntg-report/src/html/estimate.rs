//! What measurements say: the variables with their standard deviations, and how well each statement is met.

use maud::{Markup, html};

use super::tables::{number, prose, with_unit};
use crate::run::{Estimate, Measurement, Run};

/// The estimate; nothing where nothing was measured.
pub(super) fn section(run: &Run) -> Markup {
    let Some(found) = &run.estimate else { return html! {} };
    html! {
        section #estimate {
            h2 { "Estimate" }
            p {
                "chi² is " (number(found.chi2)) " for " (found.count)
                @if found.count == 1 { " measured number." } @else { " measured numbers." }
                " Where the model and the deviations are right, the two are about equal."
            }
            @if let Some(why) = &found.unknown { p.advice { "There are no standard deviations: " (prose(why)) "." } }
            (deviations(found))
            (measurements(found))
        }
    }
}

fn deviations(found: &Estimate) -> Markup {
    html! {
        @if !found.deviations.is_empty() {
            div.scroll { table {
                thead { tr {
                    th { "variable" } th.n { "estimate" } th.n { "standard deviation" } th { "unit" }
                    @if found.deviations.len() > 1 { @for name in found.deviations.keys() { th.n title="correlation" { "with " (name) } } }
                } }
                tbody { @for (row, (name, deviation)) in found.deviations.iter().enumerate() {
                    tr {
                        td.name { (name) } td.n { (number(deviation.value)) } td.n { (number(deviation.sigma)) } td { (deviation.unit) }
                        @if found.deviations.len() > 1 {
                            @for correlation in found.correlations.get(row).into_iter().flatten() { td.n { (format!("{correlation:.2}")) } }
                        }
                    }
                } }
            } }
        }
    }
}

fn measurements(found: &Estimate) -> Markup {
    html! {
        div.scroll { table {
            thead { tr {
                th { "measured" } th.n { "numbers" } th.n { "share of chi²" }
                th.n title="root of the mean square of residuals over their deviations" { "mean ratio" }
                th.n title="residual over its deviation" { "largest ratio" } th.n { "largest residual" }
            } }
            tbody { @for measurement in &found.measurements {
                tr {
                    td.name { (measurement.name) } td.n { (measurement.residuals.len()) }
                    td.n { (format!("{:.0} %", 100.0 * measurement.share)) }
                    td.n { (format!("{:.2}", (measurement.chi2 / measurement.residuals.len().max(1) as f64).sqrt())) }
                    (worst(measurement))
                }
            } }
        } }
    }
}

/// The residual that is the most of its standard deviations.
fn worst(measurement: &Measurement) -> Markup {
    let worst = measurement.residuals.iter().max_by(|a, b| a.ratio.abs().total_cmp(&b.ratio.abs()));
    html! {
        @if let Some(worst) = worst {
            td.n {
                (format!("{:.2}", worst.ratio))
                @if !worst.indices.is_empty() { (format!(" at {:?}", worst.indices)) }
            }
            td.n { (with_unit(worst.value, &measurement.unit)) }
        } @else { td {} td {} }
    }
}
