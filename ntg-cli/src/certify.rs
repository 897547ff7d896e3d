//! `ntg certify`: what of a solution is proved for all times.

use std::path::{Path, PathBuf};

use ntg_certify::change::Spared;
use ntg_certify::guarantee::{self, Guaranteed, Task, guarantee, proved_from};
use ntg_certify::summary::Summary;
use ntg_certify::tube::{Ending, Tube};
use ntg_certify::{Certificate, Guarantee, write as file};
use ntg_interp::Interpreted;
use ntg_runtime::guess::Guess;
use ntg_runtime::report::{Report, Resolution};
use ntg_runtime::settings::Settings;
use serde_json::{Value, json};

use crate::arguments::Format;
use crate::printer::Printer;
use crate::watch::Interrupt;
use crate::{Exit, files, setup, write};

/// Solve a spec and prove its constraints for all times, not only at points.
///
/// Every constraint is proved, refuted with a time at which it fails, or left undecided at the limit of the
/// arithmetic. The certificate is a file that `ntg-check` proves again, without any code of ntg.
/// `--tube` also bounds how far the true state is from the splines, where equations of motion hold at points only.
/// Exit status: 0 when every constraint is proved, and the tube that was asked for reaches the end; 1 when not, 2 on
/// errors.
///
/// Examples:
///   ntg certify specs/gates.ntg
///   ntg certify specs/launch.ntg --tube
///   ntg certify specs/low_observable.ntg --guarantee -o mission.cert && ntg-check mission.cert
#[derive(clap::Args, Debug)]
#[command(verbatim_doc_comment)]
pub(crate) struct Arguments {
    /// The spec file.
    spec: PathBuf,
    /// Set a parameter, as in `ntg solve`.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,
    /// Where a constraint fails, tighten it or hold it at more points and solve again, until all is proved.
    #[arg(long)]
    guarantee: bool,
    /// Bound how far the true state, from the same start with the same inputs, is from the splines.
    #[arg(long)]
    tube: bool,
    /// Write the certificate.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
    /// How to print.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

pub(crate) fn run(arguments: &Arguments, printer: &Printer) -> Result<Exit, String> {
    if let Some(path) = &arguments.output {
        write::may_write(path, arguments.force)?;
    }
    let Some(spec) = files::compile(&arguments.spec, &arguments.set) else { return Err(String::new()) };
    let files::Spec { source, compiled, set, read } = spec;
    write::spares(arguments.output.as_slice(), &read)?;
    let mut problem = Interpreted::new(&compiled.program);
    set.put(&mut problem)?;
    let mut settings = Settings::default();
    let interrupt = Interrupt::install();
    interrupt.over(&mut settings);
    let task = Task { program: &compiled.program, problem: &problem, spec: &source.text };
    // Without `--guarantee` the first solve is all there is.
    let wanted =
        Guarantee { rounds: if arguments.guarantee { Guarantee::default().rounds } else { 0 }, ..Guarantee::default() };
    let mut found =
        guarantee(task, &Guess::default(), &settings, &wanted).map_err(|error| setup::words(&error, &source))?;
    let summary = found.certificate.summary(&compiled.program.structure);
    let tube = (arguments.tube && found.report.is_solved())
        .then(|| ntg_certify::tube(&found.certificate, &found.report.solution));
    match arguments.format {
        Format::Text => {
            let status = found.report.status.to_string();
            let words = status.strip_prefix(&found.report.status.label()).unwrap_or_default();
            let mut text = format!("{}: {}{words}\n{summary}", found.report.problem, found.report.ending());
            if arguments.guarantee {
                text.push_str(&of_guarantee(&found));
            }
            text.extend(tube.as_ref().map(ToString::to_string));
            printer.text(&text);
        }
        Format::Json => {
            let mut document = document(&summary);
            document["status"] = json!(found.report.status.to_string());
            document["resolution"] = json!(found.report.resolution().map(Resolution::word));
            document["objective"] = json!(found.report.objective);
            if arguments.guarantee {
                document["guarantee"] = cost(&found);
            }
            if let Some(tube) = &tube {
                document["tube"] = of_tube(tube);
            }
            printer.line(&format!("{document:#}"));
        }
    }
    let is_followed = tube.as_ref().is_none_or(Tube::is_whole);
    if let Some(path) = &arguments.output {
        if let Some(tube) = tube {
            found.certificate.statement.spec.push_str(&remarks(&tube));
            found.certificate.tubes = tube.evidence;
        }
        save(path, arguments.force, &found.certificate)?;
    }
    let is_resolved = found.report.resolution() != Some(Resolution::Unresolved);
    Ok(match found.report.is_solved() && is_resolved && summary.is_proved() && is_followed {
        true => Exit::Done,
        false if interrupt.is_pressed() => Exit::Interrupted,
        false => Exit::NotSolved,
    })
}

/// What a certificate says of a tube to people, below the spec.
fn remarks(tube: &Tube) -> String {
    let words = tube.to_string();
    let lines = words.lines().map(|line| format!("// {line}\n"));
    format!(
        "\n// What ntg certify found; the lines `component` have what ntg-check proves:\n{}",
        lines.collect::<String>()
    )
}

/// A tube for programs.
fn of_tube(tube: &Tube) -> Value {
    let state = |state: &ntg_certify::tube::State| {
        let bands: Vec<[f64; 4]> = state.bands.iter().map(|band| [band.from, band.to, band.low, band.high]).collect();
        json!({
            "name": state.label(), "unit": state.unit_label(),
            "most": state.most, "end": state.at_end, "bands": bands,
        })
    };
    let stretch = |stretch: &ntg_certify::tube::Stretch| {
        let (ending, time, why) = match &stretch.ending {
            Ending::Whole => ("whole", None, None),
            Ending::At(time, why) => ("at", Some(*time), Some(why.clone())),
            Ending::None(_) if stretch.is_flat() => ("flat", None, None),
            Ending::None(why) => ("none", None, Some(why.clone())),
        };
        json!({
            "phase": stretch.phase, "ending": ending, "time": time, "why": why,
            "states": stretch.states.iter().map(state).collect::<Vec<_>>(),
        })
    };
    json!({
        "whole": tube.is_whole(), "boxes": tube.boxes, "seconds": tube.seconds,
        "phases": tube.phases.iter().map(stretch).collect::<Vec<_>>(),
    })
}

/// Writes a certificate.
pub(crate) fn save(path: &Path, force: bool, certificate: &Certificate) -> Result<(), String> {
    write::whole(path, force, file::text(certificate).as_bytes())
}

/// Tightens and solves again, from a report.
pub(crate) fn mend<'p>(
    task: Task<'p>,
    report: Report,
    settings: &Settings,
) -> Result<Guaranteed<'p>, ntg_runtime::Error> {
    proved_from(task, report, settings, &Guarantee::default())
}

/// What a guarantee did and cost, in words.
pub(crate) fn of_guarantee(found: &Guaranteed<'_>) -> String {
    let rounds = found.rounds.len().saturating_sub(1);
    let more = format!("{rounds} more solve{}", if rounds == 1 { "" } else { "s" });
    let ending = match &found.ending {
        guarantee::Ending::Proved if found.rounds.len() == 1 => "Guarantee: everything was proved at once".to_owned(),
        guarantee::Ending::Proved => format!("Guarantee: proved after {more}"),
        guarantee::Ending::NotSolved => return "Guarantee: none, because there is no solution\n".to_owned(),
        guarantee::Ending::Rounds => format!("Guarantee: NOT had after {more}"),
        guarantee::Ending::Rounding => {
            format!(
                "Guarantee: NOT had for what is missed by rounding, where end conditions meet a bound; all else is proved after {more}"
            )
        }
        guarantee::Ending::Tightened(status) => {
            format!("Guarantee: NOT had; with its constraints tightened the problem ends with: {status}")
        }
    };
    let mut text = format!("{ending}; it costs {:+.2e} of the objective\n", found.cost());
    let structure = found.report.solution.structure();
    for (number, change) in &found.changes {
        let constraint = &structure.constraints[*number];
        let name = constraint.name.as_deref().unwrap_or(&constraint.place.text);
        let (unit, symbol) = (constraint.unit.factor, &constraint.unit.symbol);
        let mut done = vec![];
        if change.points() > 1 {
            let percent = (100.0 * change.share()).ceil();
            let points = change.points();
            done.push(format!("held at up to {points} times as many points in {percent} % of its time"));
        }
        match change.held() {
            0 => {}
            1 => done.push("held at 1 time besides".to_owned()),
            held => done.push(format!("held at {held} times besides")),
        }
        for (side, by) in [("lower", change.below), ("upper", change.above)] {
            if by > 0.0 {
                done.push(format!("{side} bound tightened by {:.2e} {symbol}", by / unit).trim_end().to_owned());
            }
        }
        let spared = change.ends.iter().zip(["start", "end"]).filter(|(spared, _)| **spared != Spared::Nothing);
        let spared: Vec<&str> = spared.map(|(_, end)| end).collect();
        if !spared.is_empty() {
            done.push(format!("but at its {}, where an end condition meets it", spared.join(" and ")));
        }
        text.push_str(&format!("  {name}: {}\n", done.join(", ")));
    }
    text
}

/// What a guarantee did and cost, for programs.
pub(crate) fn cost(found: &Guaranteed<'_>) -> Value {
    json!({
        "proved": found.ending == guarantee::Ending::Proved,
        "cost": found.cost(),
        "rounds": found.rounds.iter().map(|round| json!({
            "objective": round.objective, "open": round.open, "missed": round.missed,
            "iterations": round.iterations,
            "seconds": { "solve": round.solve, "certify": round.certify },
            "processor": { "solve": round.processor.0, "certify": round.processor.1 },
        })).collect::<Vec<_>>(),
        "changes": found.changes.iter().map(|(number, change)| json!({
            "constraint": found.report.solution.structure().constraints[*number].name,
            "line": found.report.solution.structure().constraints[*number].place.line,
            "points": change.points(), "share": change.share(), "times": change.held(), "lower_raised": change.below, "upper_lowered": change.above,
        })).collect::<Vec<_>>(),
    })
}

/// Puts proofs beside the constraints of a saved run, and bands beside its named expressions.
pub(crate) fn into_run(summary: &Summary, run: &mut ntg_report::Run) {
    for (number, proof) in summary.numbers.iter().zip(&summary.constraints) {
        let (low, high) = proof.values;
        let own = ntg_report::run::Proof { verdict: proof.word().to_owned(), words: proof.words(), low, high };
        if let Some(constraint) = run.constraints.get_mut(*number) {
            constraint.proof = Some(own);
        }
    }
    for named in &summary.named {
        // `speed in uav[1].covert` belongs to `uav[1].speed`, and where the agent has no name to `speed`.
        let (name, path) = named.name.split_once(" in ").unwrap_or((&named.name, ""));
        let agent = path.split('.').next().unwrap_or_default();
        let key = if run.lets.contains_key(name) { name.to_owned() } else { format!("{agent}.{name}") };
        if let Some(series) =
            run.lets.get_mut(&key).filter(|_| named.values.0.is_finite() && named.values.1.is_finite())
        {
            series.bands.extend(named.bands.iter().map(|band| [band.from, band.to, band.low, band.high]));
        }
    }
}

/// Proofs for programs. Numbers that are not finite are null.
pub(crate) fn document(summary: &Summary) -> Value {
    let bounds = |all: &[ntg_certify::summary::Bounds]| -> Vec<Value> {
        let one = |b: &ntg_certify::summary::Bounds| {
            let bands: Vec<[f64; 4]> = b.bands.iter().map(|band| [band.from, band.to, band.low, band.high]).collect();
            json!({ "name": b.name, "unit": b.unit.symbol, "low": b.values.0, "high": b.values.1, "bands": bands })
        };
        all.iter().map(one).collect()
    };
    json!({
        "proved": summary.is_proved(),
        "constraints": summary.constraints.iter().map(proof).collect::<Vec<_>>(),
        "terms": bounds(&summary.terms),
        "lets": bounds(&summary.named),
        "boxes": summary.boxes,
        "seconds": summary.seconds,
    })
}

/// What is proved of one constraint, for programs.
pub(crate) fn proof(proof: &ntg_certify::summary::Proof) -> Value {
    use ntg_certify::Verdict;
    let (missed, residual) = match proof.verdict {
        Verdict::Refuted(least, most) => (Some([least, most]), None),
        Verdict::Undecided(most) => (Some([0.0, most]), None),
        Verdict::Within(residual) => (None, Some(residual)),
        Verdict::Proved | Verdict::Bounded => (None, None),
    };
    json!({
        "name": proof.name, "verdict": proof.word(), "unit": proof.unit.symbol, "along": proof.along,
        "low": proof.values.0, "high": proof.values.1, "missed": missed, "residual": residual,
        "witness": proof.witness.map(|(t, value)| json!({ "t": t, "value": value })),
    })
}
