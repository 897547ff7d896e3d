//! What does a whole solve cost? Every shipped spec, from its own guess: generated code beside the
//! interpreter; and the transcription and one quadratic program by themselves.
//!
//! Run with `cargo bench --bench solves`.

use criterion::{Criterion, criterion_group, criterion_main};
use ntg::prelude::*;
use ntg::runtime::nlp::sqp;
use ntg::runtime::transcribe::Transcription;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;

mod specs {
    pub(crate) mod car {
        ntg::ntg_file!("../specs/kinematic_car.ntg");
    }
    pub(crate) mod flight {
        ntg::ntg_file!("../specs/low_observable.ntg");
    }
    pub(crate) mod flight_gauss {
        ntg::ntg_file!("../specs/low_observable_gauss.ntg");
    }
    pub(crate) mod oscillator {
        ntg::ntg_file!("../specs/van_der_pol.ntg");
    }
}
use specs::{car::KinematicCar, flight::LowObservable, flight_gauss::LowObservableGauss, oscillator::VanDerPol};

struct NoTables;

impl Loader for NoTables {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("`{path}` is not needed here"))
    }
}

fn interpreted(text: &str) -> Interpreted {
    let compiled = ntg_compiler::compile(&Source::new("spec.ntg", text), &NoTables).expect("a good spec");
    Interpreted::new(&compiled.program)
}

fn solves(c: &mut Criterion) {
    let mut group = c.benchmark_group("solve");
    group.sample_size(20);
    let settings = Settings::default();
    let mut pair = |name: &str, generated: &dyn Problem, interpreted: &Interpreted| {
        for (how, problem) in [("generated", generated), ("interpreted", interpreted)] {
            group.bench_function(format!("{name}, {how}"), |b| {
                b.iter(|| assert!(solve(problem, &settings).expect("a good problem").is_solved()));
            });
        }
    };
    let flight_text = include_str!("../specs/low_observable.ntg");
    let mut unlimited = interpreted(flight_text);
    unlimited.set("signature_max", &[7.0]).expect("a parameter of the spec");
    pair("van der Pol", &VanDerPol::default(), &interpreted(include_str!("../specs/van_der_pol.ntg")));
    pair("kinematic car", &KinematicCar::default(), &interpreted(include_str!("../specs/kinematic_car.ntg")));
    let b1 = LowObservable { signature_max: 7.0, ..Default::default() };
    pair("flight without limit (B1)", &b1, &unlimited);
    pair("flight by continuation (B2)", &LowObservable::default(), &interpreted(flight_text));
    let gauss = interpreted(include_str!("../specs/low_observable_gauss.ntg"));
    pair("flight, Gauss points", &LowObservableGauss::default(), &gauss);
    group.finish();

    let mut group = c.benchmark_group("parts");
    let flight = LowObservable::default();
    group.bench_function("transcription of the flight", |b| {
        b.iter(|| Transcription::new(&flight).expect("a good problem"));
    });
    // A quadratic program by itself: the lane change is one, and is solved in one iteration.
    let car = KinematicCar::default();
    let nlp = Transcription::new(&car).expect("a good problem");
    let start = vec![0.0; 14];
    group.bench_function("one quadratic program (lane change)", |b| {
        let options = settings.solver_options();
        b.iter(|| assert!(sqp::solve(&nlp, &start, &options).status.is_solved()));
    });
    group.finish();
}

criterion_group!(benches, solves);
criterion_main!(benches);
