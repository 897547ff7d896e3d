//! What the unknowns of a saved run mean.

use ntg_runtime::structure::{Duration, Structure};
use serde_json::{Value, json};

/// What the meaning of `unknowns` depends on: two problems with equal layouts have the same ones.
pub fn layout(structure: &Structure) -> Value {
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
        json!({
            "name": phase.name,
            "family": phase.family.map(|f| (f.first, f.last)),
            "duration": if matches!(phase.duration, Duration::Free(_)) { "free" } else { "fixed" },
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
