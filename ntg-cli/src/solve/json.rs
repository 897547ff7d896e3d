//! The solution for programs. Numbers that are not finite are null.

use ntg_report::run::{gathered, members};
use ntg_runtime::problem::Problem;
use ntg_runtime::report::{ConstraintReport, Doubt, Report, Resolution, Worst};
use ntg_runtime::structure::{Independent, Parameter};
use serde_json::{Map, Value, json};

use super::Solved;

pub(super) fn document(solved: &Solved<'_>) -> Value {
    let report = solved.report;
    let solution = &report.solution;
    let independent = &solution.structure().independent;
    let shown = |time: f64| independent.shown(time);
    let mut document = json!({
        "problem": report.problem,
        "status": report.status.label(),
        "ending": report.ending(),
        "resolution": report.resolution().map(Resolution::word),
        "advice": report.advice_beside(solved.explanation),
        "independent": { "name": independent.name, "unit": independent.unit.symbol },
        "objective": report.objective,
        "objective_unit": report.objective_unit.symbol,
        "objective_fine": report.objective_fine,
        "objective_correction": report.objective_correction,
        "terms": report.terms.iter().map(|t| json!({
            "name": t.name, "value": t.value, "fine": t.fine, "unit": t.unit.symbol,
        })).collect::<Vec<_>>(),
        "iterations": report.iterations,
        "seconds": { "compile": solved.compile_seconds, "solve": report.seconds },
        "violation": { "points": report.violation.points, "between": report.violation.between },
        "times": solution.event_times().into_iter().map(|(name, t)| (name, json!(shown(t)))).collect::<Map<_, _>>(),
        "phases": solution.phases().into_iter().map(|p| json!({ "name": p.name, "start": shown(p.start), "end": shown(p.end) })).collect::<Vec<_>>(),
        "variables": gathered(solution.variables().into_iter().map(|v| {
            (v.name, json!({ "unit": v.unit.symbol, "value": v.value }))
        }).collect()),
        "parameters": solution.structure().parameters.iter().map(parameter).collect::<Map<_, _>>(),
        "outputs": gathered(outputs(solved)),
        "lets": gathered(lets(solved)),
        "constraints": report.constraints.iter().map(|c| constraint(c, independent)).collect::<Vec<_>>(),
        "warnings": report.warnings().iter().map(|w| json!({
            "message": w.message, "expression": w.place.text, "line": w.place.line, "column": w.place.column,
            "constraint": w.constraint, "t": w.time.map(shown),
        })).collect::<Vec<_>>(),
        "findings": solved.notes.iter().map(|note| crate::check::json::finding(solved.source, note)).collect::<Vec<_>>(),
        "history": history(report),
    });
    if let Some(estimate) = &report.estimate {
        document["estimate"] = json!(ntg_report::run::Estimate::from(estimate));
    }
    if let Some(explanation) = solved.explanation {
        document["explanation"] = json!(ntg_report::run::Explanation::from(explanation));
    }
    if let Some((summary, found)) = solved.proved {
        for (number, proof) in summary.numbers.iter().zip(&summary.constraints) {
            document["constraints"][*number]["proof"] = crate::certify::proof(proof);
        }
        document["certificate"] = crate::certify::document(summary);
        document["guarantee"] = crate::certify::cost(found);
    }
    if let Some(sensitivity) = solved.sensitivity {
        document["sensitivity"] = super::sensitivity::document(sensitivity, solved.samples);
    }
    if let Some(confirmation) = &report.confirmation {
        let (name, of, missed) = match &confirmation.doubt {
            Doubt::Motion(output) => ("output", output.as_str(), "defects"),
            Doubt::Limit(limit) => ("limit", report.constraints[*limit].name.as_str(), "missed"),
            Doubt::Objective => ("of", "objective", "missed"),
        };
        document["confirmation"] = json!({
            (name): of, (missed): confirmation.missed, "halvings": confirmation.halvings,
            "status": confirmation.status.label(), "objective": confirmation.objective,
            "iterations": confirmation.iterations, "seconds": confirmation.seconds,
            "refuted": confirmation.refutes(report.cost()),
        });
    }
    if let Some(refined) = &report.refined {
        document["refinement"] = json!(ntg_report::run::Refinement::from(refined));
    }
    if let Some(starts) = solved.starts {
        document["starts"] = super::starts::document(starts);
    }
    document
}

fn parameter(parameter: &Parameter) -> (String, Value) {
    let shown = parameter.value.iter().map(|v| json!(parameter.unit.typed(*v))).collect();
    (parameter.name.clone(), json!({ "unit": parameter.unit.symbol, "value": members(shown, &parameter.shape()) }))
}

fn outputs(solved: &Solved<'_>) -> Map<String, Value> {
    let trajectories = solved.report.solution.trajectories().into_iter();
    trajectories
        .map(|trajectory| {
            let (t, value): (Vec<f64>, Vec<f64>) = trajectory.sample(solved.samples).into_iter().unzip();
            let unit = &trajectory.unit().symbol;
            (trajectory.name().to_owned(), json!({ "unit": unit, "t": shown(solved, &t), "value": value }))
        })
        .collect()
}

/// Times in the unit of the independent variable.
fn shown(solved: &Solved<'_>, times: &[f64]) -> Vec<f64> {
    let independent = &solved.report.solution.structure().independent;
    times.iter().map(|time| independent.shown(*time)).collect()
}

fn lets(solved: &Solved<'_>) -> Map<String, Value> {
    let times = solved.report.solution.times(solved.samples);
    let problem: &dyn Problem = solved.problem;
    let signals = solved.report.solution.signals(problem).into_iter();
    signals
        .map(|signal| {
            let unit = &signal.unit().symbol;
            let shown = if signal.is_constant() {
                json!({ "unit": unit, "value": signal.at(0.0) })
            } else {
                let own: Vec<f64> = times.iter().copied().filter(|t| signal.exists_at(*t)).collect();
                json!({ "unit": unit, "t": shown(solved, &own), "value": signal.values(&own) })
            };
            (signal.name().to_owned(), shown)
        })
        .collect()
}

fn constraint(constraint: &ConstraintReport, independent: &Independent) -> Value {
    let shown = |time: f64| independent.shown(time);
    let worst = |worst: &Option<Worst>| {
        worst.as_ref().map(|w| {
            json!({
                "violation": w.violation, "relative": w.relative, "value": w.value, "t": w.time.map(shown), "phase": w.phase,
            })
        })
    };
    json!({
        "name": constraint.name,
        "line": constraint.place.line,
        "column": constraint.place.column,
        "unit": constraint.unit.symbol,
        "points": worst(&constraint.points),
        "between": worst(&constraint.between),
        "multiplier": constraint.multiplier.as_ref().map(|m| {
            let per = if m.density { independent.unit.factor } else { 1.0 };
            json!({ "value": m.value * per, "density": m.density, "t": m.time.map(shown) })
        }),
        "sensitivity": constraint.sensitivity,
    })
}

fn history(report: &Report) -> Vec<Value> {
    let steps = report.history.iter();
    steps
        .map(|step| {
            let parameters = step.parameters.iter();
            json!({
                "parameters": parameters.map(|p| (p.name.clone(), json!(p.value))).collect::<Map<_, _>>(),
                "status": step.status.to_string(),
                "objective": step.objective,
                "iterations": step.iterations,
                "seconds": step.seconds,
            })
        })
        .collect()
}
