//! The tube of a driven pendulum, spoilt: claims that are false are rejected for what the tube says alone.

use ntg_certify::certify::{Certificate, certify};
use ntg_certify::jet::COUNT;
use ntg_certify::prove::Options;
use ntg_certify::spline::BSpline;
use ntg_certify::statement::{Node, Statement};
use ntg_certify::{Interval, Verdict, statement, tube, write};
use ntg_compiler::expr::Unary;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::prelude::*;

/// `x'' = u - d x' - k sin(x)`: an unknown of order 2, whose spline is wrong by some 10^-5.
const SPEC: &str = "problem Pendulum { param d = 0.3; param k = 2; duration T = 4; \
     output x: spline(order = 6, intervals = 8, smoothness = 3); output u: spline(order = 3, intervals = 4); \
     collocation gauss(points = 3); minimize integral(u^2); initial { x == 1; der(x) == 0; } final { x == 0; } \
     trajectory { motion: der(x, 2) == u - d * der(x) - k * sin(x); } guess { x = 1; u = 0; } }";

struct NoFiles;

impl ntg_compiler::model::Loader for NoFiles {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("{path}: there are no files"))
    }
}

/// The certificate of the solved pendulum, of which nothing is claimed but its tube.
pub(crate) fn pendulum() -> Certificate {
    let Ok(compiled) = ntg_compiler::compile(&Source::new("pendulum", SPEC.to_owned()), &NoFiles) else {
        panic!("a sound spec")
    };
    let program = compiled.program;
    let report = solve(&Interpreted::new(&program), &Settings::default()).expect("a problem");
    assert!(report.is_solved(), "{report}");
    let mut certificate =
        certify(statement(&program, &report.solution, SPEC).expect("a solution"), &Options::default());
    let found = tube(&certificate, &report.solution);
    assert!(found.is_whole(), "{found}");
    certificate.tubes = found.evidence;
    for finding in &mut certificate.findings {
        (finding.values, finding.required, finding.witness) = (Interval::ENTIRE, None, None);
        if finding.verdict != Verdict::Bounded {
            finding.verdict = Verdict::Undecided(f64::INFINITY);
        }
    }
    certificate
}

/// The true `x` and `x'` less the splines, at many times from the start to the end: Runge and Kutta's method of order 4.
pub(crate) fn differences(of: &Statement) -> Vec<[f64; 2]> {
    /// Steps in a cell; the method is then right to some 10^-12.
    const STEPS: usize = 200;
    let number = |name: &str| of.numbers.iter().find(|own| own.name == name).expect("a number").value;
    let (d, k, seconds) = (number("d"), number("k"), of.numbers[of.phases[0].duration].value);
    let bend = of.graphs.iter().flat_map(|graph| &graph.nodes).find_map(|node| match node {
        Node::Unary(Unary::Sin, _) => Some(f64::sin as fn(f64) -> f64),
        Node::Unary(Unary::Tanh, _) => Some(f64::tanh as fn(f64) -> f64),
        Node::Unary(Unary::Atan, _) => Some(f64::atan as fn(f64) -> f64),
        _ => None,
    });
    let bend = bend.expect("a function");
    let spline = |name: &str| of.splines.iter().find(|own| own.name == name).expect("a spline");
    let cuts = &of.phases[0].cuts;
    // A polynomial of s from -1 to 1.
    let piece = |name: &str, derivative: usize, cell: usize| -> Vec<f64> {
        let own = spline(name);
        let own = BSpline { order: own.order, knots: &own.knots, coefficients: &own.coefficients };
        own.piece(derivative, cuts[cell], cuts[cell + 1]).jets::<COUNT>().0.c.iter().map(|c| c.middle()).collect()
    };
    let at = |piece: &[f64], part: f64| piece.iter().rev().fold(0.0, |sum, c| sum * (2.0 * part - 1.0) + c);
    let mut all = vec![];
    let mut state = [at(&piece("x", 0, 0), 0.0), at(&piece("x", 1, 0), 0.0) / seconds];
    for cell in 0..cuts.len() - 1 {
        let (u, x, v) = (piece("u", 0, cell), piece("x", 0, cell), piece("x", 1, cell));
        let h = (cuts[cell + 1] - cuts[cell]) * seconds / STEPS as f64;
        let rate = |part: f64, [x, v]: [f64; 2]| [v, at(&u, part) - d * v - k * bend(x)];
        for step in 0..STEPS {
            let part = |add: f64| (step as f64 + add) / STEPS as f64;
            let plus = |rate: [f64; 2], by: f64| [state[0] + by * rate[0], state[1] + by * rate[1]];
            all.push([state[0] - at(&x, part(0.0)), state[1] - at(&v, part(0.0)) / seconds]);
            let first = rate(part(0.0), state);
            let second = rate(part(0.5), plus(first, h / 2.0));
            let third = rate(part(0.5), plus(second, h / 2.0));
            let fourth = rate(part(1.0), plus(third, h));
            state =
                std::array::from_fn(|i| state[i] + h / 6.0 * (first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i]));
        }
        all.push([state[0] - at(&x, 1.0), state[1] - at(&v, 1.0) / seconds]);
    }
    all
}

/// By how much the claims of a certificate about its tube are missed at some time; above 0 they are false.
pub(crate) fn missed(of: &Certificate) -> f64 {
    let all = differences(&of.statement);
    let out = |bound: Interval, x: f64| (x - bound.high()).max(bound.low() - x);
    let each = of.tubes[0].components.iter().enumerate().map(|(c, own)| {
        let during = all.iter().map(|x| out(own.bounds[0], x[c])).fold(f64::NEG_INFINITY, f64::max);
        during.max(out(own.bounds[1], all[all.len() - 1][c]))
    });
    each.fold(f64::NEG_INFINITY, f64::max)
}

/// The same with a claim that is missed by so much at a time.
pub(crate) fn violated(random: &mut fastrand::Rng, sound: &Certificate, by: f64) -> Certificate {
    let (mut spoilt, all) = (sound.clone(), differences(&sound.statement));
    let c = random.usize(0..2);
    let which = random.usize(0..2);
    let truth = if which == 0 { random.usize(0..all.len()) } else { all.len() - 1 };
    let (truth, bound) = (all[truth][c], &mut spoilt.tubes[0].components[c].bounds[which]);
    *bound = if random.bool() {
        Interval::new(bound.low().min(truth - 2.0 * by), truth - by)
    } else {
        Interval::new(truth + by, bound.high().max(truth + 2.0 * by))
    };
    spoilt
}

/// A certificate with a tube of something else, and a word about what was changed.
pub(crate) fn spoilt(random: &mut fastrand::Rng, sound: &Certificate) -> (Certificate, &'static str) {
    let mut out = sound.clone();
    let part = |random: &mut fastrand::Rng| 10_f64.powf(-3.0 * random.f64()) * if random.bool() { 1.0 } else { -1.0 };
    let how = match random.u8(0..6) {
        0 => {
            let by = 10_f64.powf(-8.0 * random.f64());
            out = violated(random, sound, by * 1e-2);
            "radii"
        }
        1 => {
            let x = out.statement.splines.iter_mut().find(|own| own.name == "x").expect("a spline");
            let place = random.usize(0..2);
            x.coefficients[place] += part(random);
            "initial values"
        }
        2 => {
            let spline = random.usize(0..out.statement.splines.len());
            let coefficients = &mut out.statement.splines[spline].coefficients;
            let place = random.usize(0..coefficients.len());
            coefficients[place] += part(random);
            "coefficients"
        }
        3 => {
            let name = if random.bool() { "d" } else { "k" };
            let own = out.statement.numbers.iter_mut().find(|own| own.name == name).expect("a number");
            own.value += part(random);
            "parameters"
        }
        4 => {
            let duration = out.statement.phases[0].duration;
            out.statement.numbers[duration].value += part(random);
            "times"
        }
        _ => {
            let other = if random.bool() { Unary::Tanh } else { Unary::Atan };
            for node in out.statement.graphs.iter_mut().flat_map(|graph| &mut graph.nodes) {
                if let Node::Unary(operation @ Unary::Sin, _) = node {
                    *operation = other;
                }
            }
            "formulas"
        }
    };
    (out, how)
}

/// The text with another letter or number in what proves the tube; the claims stay as they are.
pub(crate) fn scratched(random: &mut fastrand::Rng, sound: &Certificate) -> String {
    let mut out = sound.clone();
    let boxes = &mut out.tubes[0].boxes;
    let own = random.usize(0..boxes.len());
    match random.u8(0..4) {
        0 => {
            let other = random.usize(0..boxes.len());
            boxes.swap(own, other);
        }
        1 => drop(boxes.remove(own)),
        2 => boxes[own].1 = random.u32(0..4),
        _ => {
            let proof = &mut boxes[own].2;
            let lists =
                [&mut proof.start, &mut proof.highest, &mut proof.inside, &mut proof.slack, &mut proof.directions];
            let list = lists.into_iter().nth(random.usize(0..5)).expect("five lists");
            let place = random.usize(0..list.len());
            match random.u8(0..3) {
                0 => drop(list.remove(place)),
                1 => list[place] = f64::from_bits(random.u64(..)),
                _ => list[place] *= random.f64() * 4.0 - 1.0,
            }
        }
    }
    write::body(&out)
}
