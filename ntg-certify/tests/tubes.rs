//! Tubes: the true state, known in closed form or by integration, is inside, and what is inside is hardly more.

use std::path::{Path, PathBuf};

use ntg_certify::certify::certify;
use ntg_certify::prove::Options;
use ntg_certify::tube::{Ending, State, tube};
use ntg_certify::{Certificate, Tube, statement};
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::prelude::*;

struct Beside(PathBuf);

impl Loader for Beside {
    fn load(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(self.0.join(path)).map_err(|error| error.to_string())
    }
}

fn of_text(name: &str, text: &str, folder: PathBuf) -> (Report, Certificate) {
    let program =
        ntg_compiler::compile(&Source::new(name, text.to_owned()), &Beside(folder)).expect("a sound spec").program;
    let report = solve(&Interpreted::new(&program), &Settings::default()).expect("a problem");
    assert!(report.is_solved(), "{name}: {report}");
    let statement = statement(&program, &report.solution, text).expect("a solution");
    (report, certify(statement, &Options::default()))
}

fn followed(text: &str) -> (Report, Tube) {
    let (report, certificate) = of_text("here", text, PathBuf::new());
    let tube = tube(&certificate, &report.solution);
    (report, tube)
}

fn shipped(spec: &str) -> (Report, Certificate) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs");
    let text = std::fs::read_to_string(folder.join(spec)).expect("a spec");
    of_text(spec, &text, folder)
}

/// The bounds of a difference at a time.
fn band(state: &State, t: f64) -> (f64, f64) {
    let own = state.bands.iter().filter(|band| band.from <= t && t <= band.to);
    own.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), band| (low.min(band.low), high.max(band.high)))
}

/// Asserts that true values are inside, and that the tube is not wider than `much` times what it has to be.
fn holds(report: &Report, state: &State, truth: impl Fn(f64) -> f64, (slack, much): (f64, f64)) {
    let output = report.solution.output(&state.name).expect("an output");
    let (start, end) = (output.start(), output.end());
    let mut most: f64 = 0.0;
    for i in 0..=400 {
        let t = start + (end - start) * f64::from(i) / 400.0;
        let own = if state.derivative == 0 { output.at(t) } else { output.derivative(t, state.derivative) };
        let (difference, (low, high)) = (truth(t) - own, band(state, t));
        let name = state.label();
        assert!(
            low - slack <= difference && difference <= high + slack,
            "{name} at {t}: {difference:e} {low:e} {high:e}"
        );
        most = most.max(difference.abs());
    }
    assert!(state.most <= much * most + slack, "{}: {:e} for {most:e}", state.label(), state.most);
}

#[test]
fn the_error_of_a_linear_system_is_what_it_is() {
    let (report, tube) = followed(
        "problem Decay { duration T = 2; output x: spline(order = 4, intervals = 2, smoothness = 1); \
         output u: spline(order = 2, intervals = 1); collocation gauss(points = 3); \
         minimize integral(u^2); initial { x == 1; } trajectory { der(x) == u - x; } guess { x = 1; u = 0; } }",
    );
    assert!(tube.is_whole() && tube.phases.len() == 1 && tube.phases[0].states.len() == 1, "{tube}");
    let state = &tube.phases[0].states[0];
    assert!(state.most > 1e-5, "the spline of degree 3 is wrong: {tube}");
    holds(&report, state, |t| (-t).exp(), (1e-9, 1.3));
}

#[test]
fn a_turn_of_second_order_is_followed_through_phases() {
    // Two phases of a free oscillator; the second begins with what the first ends with.
    let (report, tube) = followed(
        "problem Turn { output x: spline(order = 5, intervals = 4, smoothness = 2); \
         output u: spline(order = 2, intervals = 1); collocation gauss(points = 3); \
         phase one { duration = 3; } phase two after one { duration = 4; } \
         minimize integral(u^2); initial { x == 1; der(x) == 0; } trajectory { der(x, 2) == u - x; } guess { x = 1; u = 0; } }",
    );
    assert!(tube.is_whole() && tube.phases.len() == 2, "{tube}");
    for stretch in &tube.phases {
        let [x, v] = &stretch.states[..] else { panic!("{tube}") };
        holds(&report, x, f64::cos, (1e-8, 1.3));
        holds(&report, v, |t| -t.sin(), (1e-8, 1.3));
    }
    let handed = tube.phases[0].states[0].at_end.expect("an end");
    let begin = tube.phases[1].states[0].bands[0];
    assert!(handed > 5e-8 && begin.low.abs().max(begin.high.abs()) >= 0.9 * handed, "{tube}");
}

#[test]
fn a_spline_that_is_wrong_is_not_called_right() {
    let (report, mut certificate) = shipped("gallery/vanderpol.ntg");
    let right = tube(&certificate, &report.solution).phases[0].states[0].most;
    for by in [1e-6, 1e-4, 1e-2] {
        let spline = &mut certificate.statement.splines[0];
        let middle = spline.coefficients.len() / 2;
        spline.coefficients[middle] += by;
        let found = tube(&certificate, &report.solution);
        // A coefficient of a cubic is at least a third of what the spline moves by.
        assert!(found.phases[0].states[0].most >= by / 3.0 - right, "{by}: {found}");
        certificate.statement.splines[0].coefficients[middle] -= by;
    }
}

#[test]
fn equations_that_determine_nothing_have_no_tube_and_say_so() {
    let (_, tube) = followed(
        "problem Two { duration T = 1; output x, y: spline(order = 4, intervals = 2); \
         minimize integral(der(x)^2 + der(y)^2); initial { x == 0; y == 0; } final { x == 1; } \
         trajectory { der(x) == 2 * der(y); } guess { x = tau; y = 0; } }",
    );
    assert!(matches!(&tube.phases[0].ending, Ending::None(words) if words.contains("one equation")), "{tube}");
    assert!(!tube.is_whole() && tube.to_string().contains("residuals"), "{tube}");
    let flat = followed(
        "problem Flat { duration T = 1; output x: spline(order = 4, intervals = 2); \
         minimize integral(der(x)^2); initial { x == 0; } final { x == 1; } guess { x = tau; } }",
    )
    .1;
    assert!(flat.is_whole() && flat.phases[0].is_flat(), "{flat}");
}

/// Runge and Kutta's method of order 4 in equal steps, which end at breakpoints of the inputs.
fn integrate<const N: usize>(
    rate: impl Fn(f64, [f64; N]) -> [f64; N],
    start: [f64; N],
    (from, to): (f64, f64),
    steps: usize,
) -> Vec<(f64, [f64; N])> {
    let h = (to - from) / steps as f64;
    let plus = |x: [f64; N], k: [f64; N], by: f64| std::array::from_fn(|i| x[i] + by * k[i]);
    let (mut x, mut all) = (start, vec![(from, start)]);
    for i in 0..steps {
        // Inputs have kinks where steps end; stages stay inside.
        let t = from + h * i as f64;
        let inside = |t: f64| t.clamp(from + h * (i as f64 + 1e-9), from + h * (i as f64 + 1.0 - 1e-9));
        let k1 = rate(inside(t), x);
        let k2 = rate(t + h / 2.0, plus(x, k1, h / 2.0));
        let k3 = rate(t + h / 2.0, plus(x, k2, h / 2.0));
        let k4 = rate(inside(t + h), plus(x, k3, h));
        x = std::array::from_fn(|j| x[j] + h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]));
        all.push((t + h, x));
    }
    all
}

/// Asserts that an integrated trajectory is inside, and not far inside.
fn encloses<const N: usize>(report: &Report, tube: &Tube, truth: &[(f64, [f64; N])], slack: f64) {
    assert!(tube.is_whole(), "{tube}");
    for (c, state) in tube.phases[0].states.iter().enumerate() {
        let output = report.solution.output(&state.name).expect("an output");
        let mut most: f64 = 0.0;
        for (t, x) in truth.iter().step_by(7) {
            let (difference, (low, high)) = (x[c] - output.at(*t), band(state, *t));
            let inside = low - slack <= difference && difference <= high + slack;
            assert!(inside, "{} at {t}: {difference:e} is not in {low:e} .. {high:e}", state.name);
            most = most.max(difference.abs());
        }
        assert!(state.most <= 1.5 * most + 10.0 * slack, "{}: {:e} for {most:e}", state.name, state.most);
    }
}

#[test]
fn van_der_pol_by_states_is_inside() {
    let (report, certificate) = shipped("gallery/vanderpol.ntg");
    let found = tube(&certificate, &report.solution);
    let u = report.solution.output("u").expect("an input");
    let rate = |t: f64, [x, v]: [f64; 2]| [v, (1.0 - x * x) * v - x + u.at(t)];
    encloses(&report, &found, &integrate(rate, [1.0, 0.0], (0.0, u.end()), 4_000), 1e-9);
}

#[test]
fn the_pole_that_swings_up_is_inside() {
    let (report, certificate) = shipped("gallery/swing_up.ntg");
    let found = tube(&certificate, &report.solution);
    let force = report.solution.output("F").expect("an input");
    let rate = |t: f64, [_, th, v, w]: [f64; 4]| {
        let (sin, cos, f) = (th.sin(), th.cos(), force.at(t));
        let den = 1.1 - 0.1 * cos * cos;
        [
            v,
            w,
            (-0.08 * sin * w * w + 0.981 * cos * sin + f) / den,
            (-0.08 * cos * sin * w * w + f * cos + 1.1 * 9.81 * sin) / (0.8 * den),
        ]
    };
    let start = ["x", "th", "v", "w"].map(|name| report.solution.output(name).expect("a state").at(0.0));
    encloses(&report, &found, &integrate(rate, start, (0.0, force.end()), 8_000), 1e-8);
}
