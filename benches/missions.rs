//! What does a mission cost to solve? Fleets of growing size under each rule, and the missiles, from the
//! guesses of their specs; and what it costs to compile a spec, which must not grow with the fleet.
//!
//! Run with `cargo bench --bench missions`.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use ntg::prelude::*;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;

struct NoTables;

impl Loader for NoTables {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("`{path}` is not needed here"))
    }
}

const FREE: &str = include_str!("../specs/multi_vehicle.ntg");
const SIMULTANEOUS: &str = include_str!("../specs/multi_vehicle_simultaneous.ntg");
const LOOK: &str = include_str!("../specs/multi_vehicle_look_after_strike.ntg");
const SEPARATED: &str = include_str!("../specs/multi_vehicle_separated.ntg");

fn interpreted(text: &str) -> Interpreted {
    let compiled = ntg_compiler::compile(&Source::new("spec.ntg", text), &NoTables).expect("a good spec");
    Interpreted::new(&compiled.program)
}

/// The spec of a fleet with `n` aircraft.
fn fleet(text: &str, n: usize) -> String {
    text.replace("const N = 4;", &format!("const N = {n};"))
}

fn missions(c: &mut Criterion) {
    let settings = Settings::default();
    let mut group = c.benchmark_group("mission");
    group.sample_size(10);
    let rules =
        [("each on its own", FREE), ("all at one time", SIMULTANEOUS), ("in turn", LOOK), ("5 km apart", SEPARATED)];
    for (name, text, n) in rules.into_iter().flat_map(|(name, text)| [2, 4, 8].map(|n| (name, text, n))) {
        let problem = interpreted(&fleet(text, n));
        group.bench_function(BenchmarkId::new(name, n), |b| {
            b.iter(|| assert!(solve(&problem, &settings).expect("a good problem").is_solved()));
        });
    }
    for (name, text) in [
        ("strike and look", include_str!("../specs/strike_and_look.ntg")),
        ("intercept", include_str!("../specs/missile_intercept.ntg")),
        ("boost and coast", include_str!("../specs/missile_boost_coast.ntg")),
    ] {
        let problem = interpreted(text);
        group.bench_function(name, |b| {
            b.iter(|| assert!(solve(&problem, &settings).expect("a good problem").is_solved()));
        });
    }
    group.finish();

    let mut group = c.benchmark_group("compile");
    for n in [2, 8, 32] {
        let text = fleet(SEPARATED, n);
        group.bench_function(BenchmarkId::new("5 km apart", n), |b| b.iter(|| interpreted(&text)));
    }
    group.finish();
}

criterion_group!(benches, missions);
criterion_main!(benches);
