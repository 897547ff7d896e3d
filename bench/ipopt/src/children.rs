//! One process for each spec and solver, ended where it does not keep its limit.

use crate::Arguments;
use serde_json::{Map, Value, json};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Seconds beyond its limit after which a solver is ended: setting up and reporting are not solving.
const GRACE: f64 = 20.0;

/// Pauses between two looks at a process.
const PAUSE: Duration = Duration::from_millis(2);

/// Compares all specs and calls `say` with each as it is there; the result is in the order of the specs.
///
/// # Errors
/// A process that cannot be started.
pub(crate) fn all(
    arguments: &Arguments,
    specs: &[PathBuf],
    known: &Map<String, Value>,
    say: impl Fn(&str, &Value) + Sync,
) -> Result<Map<String, Value>, String> {
    let next = AtomicUsize::new(0);
    let found: Mutex<Vec<Option<Value>>> = Mutex::new(vec![None; specs.len()]);
    let names = names(specs);
    let work = || -> Result<(), String> {
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(spec) = specs.get(i) else { return Ok(()) };
            let earlier = known.get(&names[i]).map(|known| known["ipopt"].clone());
            let theirs = match earlier {
                Some(earlier) => earlier,
                None => child(arguments, spec, "ipopt")?,
            };
            let one = json!({ "ntg": child(arguments, spec, "ntg")?, "ipopt": theirs });
            let mut found = found.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            say(&names[i], &one);
            found[i] = Some(one);
        }
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..arguments.jobs.max(1)).map(|_| scope.spawn(work)).collect();
        threads.into_iter().try_for_each(|thread| thread.join().map_err(|_| "a thread has failed".to_owned())?)
    })?;
    let found = found.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    Ok(names.into_iter().zip(found.into_iter().flatten()).collect())
}

/// File names without extension where that tells the specs apart, else whole paths.
fn names(specs: &[PathBuf]) -> Vec<String> {
    let stem = |path: &PathBuf| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let short: Vec<String> = specs.iter().map(stem).collect();
    let is_alone = |name: &String| short.iter().filter(|other| *other == name).count() == 1;
    let name = |(path, short): (&PathBuf, &String)| {
        if is_alone(short) { short.clone() } else { path.display().to_string() }
    };
    specs.iter().zip(&short).map(name).collect()
}

fn child(arguments: &Arguments, spec: &Path, solver: &str) -> Result<Value, String> {
    let own = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut command = Command::new(own);
    command.arg(spec).args(["--one", solver, "--method", &arguments.method]);
    command.arg("--library").arg(&arguments.library);
    command.args(["--time-limit", &arguments.time_limit.to_string(), "--tolerance", &arguments.tolerance.to_string()]);
    command.args(["--mesh", &arguments.mesh.to_string(), "--start", &arguments.start.to_string()]);
    command.args(["--print-level", &arguments.print_level.to_string()]);
    arguments.options.iter().for_each(|option| {
        command.args(["--ipopt", option]);
    });
    // One thread for all: what is compared is algorithms.
    command.envs([("OMP_NUM_THREADS", "1"), ("OPENBLAS_NUM_THREADS", "1")]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().map_err(|error| error.to_string())?;
    Ok(answer(child, Duration::from_secs_f64(arguments.time_limit + GRACE)))
}

/// The last line of a process's output, or how it ended without one.
fn answer(mut child: Child, limit: Duration) -> Value {
    let began = Instant::now();
    let output = child.stdout.take();
    let reader = std::thread::spawn(move || {
        let mut text = String::new();
        let read = output.map(|mut output| output.read_to_string(&mut text));
        read.and_then(Result::ok).map(|_| text)
    });
    let status = loop {
        match child.try_wait() {
            Ok(None) if began.elapsed() < limit => std::thread::sleep(PAUSE),
            Ok(Some(status)) => break status.to_string(),
            Ok(None) | Err(_) => {
                // It may have ended meanwhile.
                let _ = child.kill();
                let _ = child.wait();
                break format!("ended after {:.0} s", limit.as_secs_f64());
            }
        }
    };
    let text = reader.join().ok().flatten().unwrap_or_default();
    let lines = text.lines().rev();
    let found = lines.filter(|line| line.starts_with('{')).find_map(|line| serde_json::from_str(line).ok());
    // IPOPT's own words go through as they are.
    text.lines().filter(|line| !line.starts_with('{')).for_each(|line| println!("{line}"));
    found.unwrap_or_else(|| json!({ "solved": false, "status": status }))
}
