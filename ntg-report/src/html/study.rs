//! Why there is no solution, which local minima there are, and how the mesh was refined.

use maud::{Markup, html};

use super::tables::{number, place_words, prose, seconds, small, with_unit};
use crate::run::Run;

/// The constraints that cannot hold together; nothing where there is nothing to explain.
pub(super) fn explanation(run: &Run) -> Markup {
    let Some(found) = &run.explanation else { return html! {} };
    html! {
        section #infeasible {
            h2 { "Why there is no solution" }
            p.advice { (prose(&capitalised(&found.words))) }
            @if !found.parts.is_empty() {
                div.scroll { table {
                    thead { tr { th { "constraint or bound" } th.n { "line" } th.n { "missed by" } th { "where" } } }
                    tbody { @for part in &found.parts {
                        tr {
                            td.name {
                                @if part.bound { (part.name) } @else { code { (part.name) } }
                                @if !part.bound && !part.indices.is_empty() { " " (format!("{:?}", part.indices)) }
                            }
                            td.n { @if part.line > 0 { (part.line) } }
                            td.n { @if part.amount != 0.0 { (with_unit(part.amount, &part.unit)) } @else { "–" } }
                            td { @if part.amount != 0.0 { (place_words(part.t, &part.phase, &run.independent).trim_start()) } @else { "holds only because others do not" } }
                        }
                    } }
                } }
                p.quiet { "Amounts are those of the least sum of violations near the last point, each relative to the size of its bounds." }
            }
        }
    }
}

/// The local minima that many starts found; nothing without.
pub(super) fn minima(run: &Run) -> Markup {
    let Some(found) = &run.starts else { return html! {} };
    html! {
        section #minima {
            h2 { "Local minima" }
            p { (found.solved) " of " (found.tried) " starts were solved, in " (seconds(found.seconds)) "." }
            @for note in &found.notes { p.advice { (prose(&capitalised(note))) } }
            @if !found.minima.is_empty() {
                div.scroll { table {
                    thead { tr {
                        th.n { "objective" } th.n { "starts" }
                        th.n title="largest violation, relative to the bounds" { "missed between points" } th { "first found from" }
                    } }
                    tbody { @for minimum in &found.minima {
                        tr {
                            td.n { (with_unit(minimum.objective, &run.objective_unit)) } td.n { (minimum.count) }
                            td.n { (small(minimum.violation_between)) } td { (minimum.from) }
                        }
                    } }
                } }
                p.quiet { "The best stands first; one that misses its constraints widely between the points is a minimum of this mesh alone." }
            }
        }
    }
}

/// The rounds of refinement; nothing without.
pub(super) fn refinement(run: &Run) -> Markup {
    let Some(found) = &run.refinement else { return html! {} };
    html! {
        section #refinement {
            h2 { "Refinement of the mesh" }
            p.advice[!found.met] { "To " (small(found.tolerance)) ": " (found.status) "." }
            div.scroll { table {
                thead { tr {
                    th.n { "round" } th.n { "intervals" } th.n { "variables" } th.n { "objective" }
                    th.n title="objective against its finer integral" { "quadrature" }
                    th.n title="of the finer integral since the round before" { "change" }
                    th.n title="largest, between points" { "violation" } th.n { "iterations" } th.n { "time" }
                } }
                tbody { @for (index, round) in found.rounds.iter().enumerate() {
                    tr {
                        td.n { (index + 1) } td.n { (round.intervals) } td.n { (round.variables) }
                        td.n { (number(round.objective)) } td.n { (small(round.quadrature)) }
                        td.n { @if round.change.is_finite() { (small(round.change)) } }
                        td.n { (small(round.violation)) } td.n { (round.iterations) } td.n { (seconds(round.seconds)) }
                    }
                } }
            } }
            p.quiet { "Errors are relative: of the cost as discretised against a finer integral, of that integral from round to round, and the largest violation between points." }
        }
    }
}

/// The first letter in upper case, and a full stop for the colon of a list.
fn capitalised(words: &str) -> String {
    let mut letters = words.trim_end_matches(':').chars();
    let first = letters.next().map(|letter| letter.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{Explanation, Part};

    #[test]
    fn the_index_of_a_member_stands_apart_from_its_name() {
        let part = Part { name: "v == 0".to_owned(), indices: vec![3], ..Part::default() };
        let found = Explanation { verdict: "conflict".to_owned(), parts: vec![part], ..Explanation::default() };
        let page = explanation(&Run { explanation: Some(found), ..Run::default() }).into_string();
        assert!(page.contains("<code>v == 0</code> [3]"), "{page}");
    }
}
