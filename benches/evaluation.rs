//! What does one point cost? Values, first and second derivatives of the low-observability flight's
//! functions: generated code, the interpreter, and hyper-dual numbers on the same formulas.
//!
//! Run with `cargo bench --bench evaluation`. Times are for 41 points, the paper's grid.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use ntg::runtime::problem::{Derivatives, Lanes, Problem};
use ntg::runtime::structure::{Data, Slot, Structure};
use ntg::runtime::transcribe::interpolants;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use num_dual::{DualNum, HyperDual64};

ntg::ntg_file!("../specs/low_observable.ntg");

/// Points of the paper's grid.
const POINTS: usize = 41;

/// Some typical state of the flight: position and scaled velocity and acceleration in SI units, duration.
struct Flight {
    x: [f64; 3],
    y: [f64; 3],
    duration: f64,
}

const FLIGHT: Flight = Flight { x: [-60e3, 110e3, 4e3], y: [-70e3, 80e3, -3e3], duration: 650.0 };

struct NoTables;

impl Loader for NoTables {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("`{path}` is not needed here"))
    }
}

/// Inputs of the path kernel, the same at every point.
fn inputs(structure: &Structure, kernel: usize) -> Vec<f64> {
    let group = structure.groups.iter().find(|g| g.call.kernel == kernel).expect("the kernel is used");
    let slots = group.call.slots.iter().map(|slot| match slot {
        Slot::Flat { output, derivative, .. } => [FLIGHT.x, FLIGHT.y][*output][*derivative],
        _ => FLIGHT.duration,
    });
    let data = group.call.data.iter().map(|data| match data {
        Data::Parameter { parameter, .. } => structure.parameters[*parameter].value[0],
        _ => FLIGHT.duration,
    });
    slots.chain(data).flat_map(|value| [value; POINTS]).collect()
}

fn evaluation(c: &mut Criterion) {
    let generated = LowObservable::default();
    let structure = generated.structure();
    let tables = interpolants(&structure.tables).expect("the spec's tables");
    let text = include_str!("../specs/low_observable.ntg");
    let compiled = ntg_compiler::compile(&Source::new("low_observable.ntg", text), &NoTables).expect("a good spec");
    let interpreted = Interpreted::new(&compiled.program);
    let kernel = structure.kernels.iter().position(|k| k.name == "path").expect("the path kernel");
    let shape = &structure.kernels[kernel];
    let inputs = inputs(&structure, kernel);
    let weights = vec![0.5; shape.rows * POINTS];
    let mut values = vec![0.0; shape.rows * POINTS];
    let mut jacobian = vec![0.0; shape.jacobian.len() * POINTS];
    let mut hessian = vec![0.0; shape.hessian.len() * POINTS];

    let mut group = c.benchmark_group("low observability, 41 points");
    group.throughput(Throughput::Elements(POINTS as u64));
    for (name, problem) in [("generated", &generated as &dyn Problem), ("interpreted", &interpreted)] {
        group.bench_function(format!("values, {name}"), |b| {
            b.iter(|| problem.values(kernel, POINTS, black_box(&inputs), &tables, &mut values));
        });
        group.bench_function(format!("values and derivatives, {name}"), |b| {
            b.iter(|| {
                let point = Lanes { lanes: POINTS, inputs: black_box(&inputs), weights: &weights };
                let out = Derivatives { values: &mut values, jacobian: &mut jacobian, hessian: &mut hessian };
                problem.derivatives(kernel, point, &tables, out);
            });
        });
    }
    group.bench_function("values and derivatives, hyper-dual pairs", |b| {
        b.iter(|| (0..POINTS).map(|_| hyper_dual_pairs(black_box(&FLIGHT))).sum::<f64>());
    });
    group.finish();
}

type D = HyperDual64;

/// The weighted sum of the flight's five functions, as the spec writes them.
fn flight(z: &[D; 7]) -> D {
    let [x0, x1, x2, y0, y1, y2, duration] = *z;
    let rate = duration.recip();
    let (vx, vy) = (x1 * rate, y1 * rate);
    let (ax, ay) = (x2 * rate * rate, y2 * rate * rate);
    let speed = (vx * vx + vy * vy).sqrt();
    let (east, north) = (-x0, -y0);
    let ahead = (east * vx + north * vy) / speed;
    let left = (north * vx - east * vy) / speed;
    let azimuth = left.atan2(ahead);
    let ground = (east * east + north * north).sqrt();
    let altitude = D::from(12e3);
    let elevation = altitude.atan2(ground);
    let slant = (ground * ground + altitude * altitude).sqrt() / 1000.0;
    let degrees = elevation * 180.0 / std::f64::consts::PI;
    // The cubic through the nose-in column of Table 1, by Newton's divided differences.
    let nose_in = ((degrees - 45.0) * 6.701940035273369e-6 - 2.222222222222223e-4) * (degrees - 20.0) * degrees
        + degrees * 0.05
        + 1.5;
    let logistic = |u: D| (D::from(1.0) + (-u).exp()).recip();
    let degree = std::f64::consts::PI / 180.0;
    let nose_out = logistic((elevation - 45.0 * degree) / (6.0 * degree)) + 5.5;
    let away = logistic((azimuth - 30.5 * degree) / degree) + logistic((-azimuth - 30.5 * degree) / degree);
    let signature = nose_in + (nose_out - nose_in) * away;
    let margin = slant.ln() - signature * (10.0_f64.ln() / 4.0) - 2.1477;
    let detection = logistic(-margin / 0.0634);
    let curvature = (vx * ay - vy * ax) / (vx * vx + vy * vy).powf(1.5);
    let cost = duration * 1e-4 * (speed * speed * 0.03 + signature * 20.0 + detection * 0.0);
    (cost + speed + curvature * 5000.0 + signature + duration) * 0.5
}

/// Gradient and Hessian one pair of variables at a time.
fn hyper_dual_pairs(at: &Flight) -> f64 {
    let values = [at.x[0], at.x[1], at.x[2], at.y[0], at.y[1], at.y[2], at.duration];
    let mut sum = 0.0;
    for i in 0..7 {
        for j in 0..=i {
            let mut z = values.map(HyperDual64::from);
            z[i].eps1 = 1.0;
            z[j].eps2 = 1.0;
            sum += flight(&z).eps1eps2;
        }
    }
    sum
}

criterion_group!(benches, evaluation);
criterion_main!(benches);
