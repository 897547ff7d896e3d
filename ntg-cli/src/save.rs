//! Saved solutions: JSON with a version, described in docs/solution-format.md.

use std::path::Path;

use ntg_interp::Interpreted;
use ntg_runtime::problem::Problem;
use ntg_runtime::report::Report;
use ntg_runtime::structure::Structure;
use serde_json::{Map, Value, json};

/// What the file says it is.
pub(crate) const FORMAT: &str = "ntg-solution";
/// The version that this program writes and reads.
pub(crate) const VERSION: u64 = 1;
/// Samples of each output, for problems with other splines.
const SAMPLES: usize = 401;

/// Writes the solution.
pub(crate) fn write(path: &Path, force: bool, problem: &Interpreted, report: &Report) -> Result<(), String> {
    crate::write::whole(path, force, format!("{:#}\n", document(problem, report)).as_bytes())
}

fn document(problem: &Interpreted, report: &Report) -> Value {
    let solution = &report.solution;
    let outputs = solution.trajectories().into_iter().map(|trajectory| {
        let (t, value): (Vec<f64>, Vec<f64>) = trajectory.sample(SAMPLES).into_iter().unzip();
        let sampled =
            json!({ "unit": trajectory.unit().symbol, "factor": trajectory.unit().factor, "t": t, "value": value });
        (trajectory.name().to_owned(), sampled)
    });
    json!({
        "format": FORMAT,
        "version": VERSION,
        "problem": report.problem,
        "status": if report.is_solved() { "solved".to_owned() } else { report.status.to_string() },
        "objective": report.objective,
        "layout": layout(&problem.structure()),
        "unknowns": solution.coefficients(),
        "outputs": outputs.collect::<Map<_, _>>(),
        "times": solution.event_times().into_iter().map(|(n, t)| (n, json!(t))).collect::<Map<_, _>>(),
        "variables": solution.variables().into_iter().map(|v| {
            (v.name, json!({ "unit": v.unit.symbol, "factor": v.unit.factor, "value": v.value }))
        }).collect::<Map<_, _>>(),
    })
}

/// What the meaning of `unknowns` depends on: two problems with equal layouts have the same ones.
pub(crate) fn layout(structure: &Structure) -> Value {
    let families = structure.agents.iter().map(|a| json!([a.name, a.family.map(|f| (f.first, f.last))]));
    let phases = structure.phases.iter().map(|phase| {
        let outputs = phase.outputs.iter().map(|o| {
            json!({
                "name": o.name,
                "family": o.family.map(|f| (f.first, f.last)),
                "order": o.spline.order,
                "smoothness": o.spline.smoothness,
                "breakpoints": o.spline.breakpoints,
            })
        });
        let free = matches!(phase.duration, ntg_runtime::structure::Duration::Free(_));
        json!({
            "name": phase.name,
            "family": phase.family.map(|f| (f.first, f.last)),
            "duration": if free { "free" } else { "fixed" },
            "outputs": outputs.collect::<Vec<_>>(),
        })
    });
    json!({
        "agents": families.collect::<Vec<_>>(),
        "phases": phases.collect::<Vec<_>>(),
        "variables": structure.variables.iter().map(|v| v.name.clone()).collect::<Vec<_>>(),
        "integrals": structure.integrals.len(),
    })
}
