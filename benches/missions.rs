//! What does a mission cost to solve? Fleets of growing size under each rule, flights in phases past a radar,
//! courses, and the missiles; and what it costs to compile a spec, which must not grow with the fleet.
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

/// A mission: its name, its spec, and parameters, in SI units, that are not at their defaults.
type Mission = (&'static str, &'static str, &'static [(&'static str, f64)]);

const PHASES: &str = include_str!("../specs/low_observable_phases.ntg");
const COSINE: &str = include_str!("../specs/low_observable_phases_cosine.ntg");
const INTERCEPT: &str = include_str!("../specs/missile_intercept.ntg");
const BOOST_COAST: &str = include_str!("../specs/missile_boost_coast.ntg");

const MISSIONS: [Mission; 13] = [
    ("hidden, then exposed; route a", PHASES, &[]),
    ("hidden, then exposed; route b", PHASES, &[("x_via", 0.0), ("y_via", -100e3)]),
    ("the same as an angle; route a", COSINE, &[]),
    ("the same as an angle; route b", COSINE, &[("x_via", 0.0), ("y_via", -100e3)]),
    ("low, high, low, high", include_str!("../specs/low_observable_alternation.ntg"), &[]),
    ("lock loss", include_str!("../specs/low_observable_lock_loss.ntg"), &[]),
    ("gates", include_str!("../specs/gates.ntg"), &[]),
    ("launch", include_str!("../specs/launch.ntg"), &[]),
    ("strike and look", include_str!("../specs/strike_and_look.ntg"), &[]),
    ("intercept, turning right", INTERCEPT, &[]),
    ("intercept, turning left", INTERCEPT, &[("y_via", 0.0)]),
    ("boost and coast, 300 m/s^2", BOOST_COAST, &[]),
    ("boost and coast, 30 m/s^2", BOOST_COAST, &[("a_max", 30.0)]),
];

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
    for (name, text, changes) in MISSIONS {
        let mut problem = interpreted(text);
        for (parameter, value) in changes {
            problem.set(parameter, &[*value]).expect("a parameter of the spec");
        }
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
