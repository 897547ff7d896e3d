//! The iterations of the interior-point method's first attempt, to read beside IPOPT's own print.

use crate::one::{Ask, MOVED, on_mesh};
use ntg_bench_program::program::moved_start;
use ntg_bench_program::{adapted, specs};
use ntg_runtime::settings::Settings;
use ntg_runtime::transcribe::Transcription;
use std::path::Path;
use std::time::Duration;

/// One line an iteration, of the first step of a continuation.
pub(crate) fn trace(spec: &Path, ask: &Ask) -> Result<(), String> {
    let problem = specs::problem(spec)?;
    let problem = on_mesh(&problem, ask);
    let step = &adapted::steps(&problem)[0];
    let mut nlp = Transcription::new(step).map_err(|error| error.to_string())?;
    let first = moved_start(&mut nlp, ask.start, MOVED)?;
    let settings = Settings {
        tolerance: ask.tolerance,
        time_limit: Some(Duration::from_secs_f64(ask.seconds)),
        ..Settings::default()
    };
    nlp.set_scales(&first, &settings).map_err(|error| error.to_string())?;
    let found = ntg_runtime::nlp::ipm::solve(&nlp, &first, &settings.solver_options());
    println!("iter objective          primal  dual    compl   barrier step    flags");
    for (iteration, record) in found.history.iter().enumerate() {
        let left = record.residuals.scaled;
        let flags = [(record.elastic, 'p'), (record.convexified, 'c'), (record.corrected, 's')];
        let flags: String = flags.iter().filter(|(is, _)| *is).map(|(_, flag)| flag).collect();
        println!(
            "{iteration:4} {:17.10e} {:.1e} {:.1e} {:.1e} {:.1e} {:.1e} {flags}",
            record.objective, left.primal, left.dual, left.complementarity, record.barrier, record.step
        );
    }
    println!("{}: {} iterations, objective {}", found.status, found.iterations, found.objective);
    Ok(())
}
