//! Solutions of the points alone: whoever does not see them believes a wrong number.

use ntg::prelude::*;
use ntg::runtime::multistart::{Minimum, multistart};
use ntg::runtime::report::Resolution;

use crate::support::{Shipped, close};

fn resolution(text: &str) -> (Resolution, Report) {
    let report = Shipped::text(text).solve();
    (report.resolution().expect("there is a solution"), report)
}

/// A wheel that turns `turns` times beside a controlled speed: too few points alias it.
fn spinner(turns: f64, first_angle: f64, intervals: usize) -> String {
    let rate = std::f64::consts::TAU * turns / 10.0;
    format!(
        "problem Spin {{
            duration T = 10;
            state th, y;
            input u;
            collocation gauss(points = 3, intervals = {intervals});
            minimize integral(u^2);
            dynamics {{ der(th) == {rate};  der(y) == 10 * sin(th) + u; }}
            initial {{ th == {first_angle};  y == 0; }}
            final {{ y == 1; }}
        }}"
    )
}

#[test]
fn an_aliased_oscillation_is_seen_whatever_its_angle() {
    for first_angle in [0.0, 1000.0 * std::f64::consts::TAU] {
        for intervals in [10, 25, 80] {
            let (found, report) = resolution(&spinner(159.0, first_angle, intervals));
            assert_eq!(found, Resolution::Unresolved, "{intervals} from {first_angle}");
            assert!(report.to_string().starts_with("Spin: solved at the points, and not between them"), "{report}");
            assert!(report.advice.contains("intervals"), "{}", report.advice);
        }
        // Three points in a sixth of a turn see it.
        let (found, _) = resolution(&spinner(3.0, first_angle, 20));
        assert_eq!(found, Resolution::Fine, "from {first_angle}");
    }
}

#[test]
fn an_offset_hides_nothing() {
    // A body in air whose temperature swings eighty times; measured from 0 or in kelvin.
    let mut means = vec![];
    for offset in [0.0, 300.0, 3000.0] {
        let text = format!(
            "problem Heat {{
                duration T = 10;
                state b, q;
                collocation gauss(points = 3, intervals = 15);
                minimize integral((b - {offset})^2);
                dynamics {{ der(b) == 5 * ({offset} + 10 * sin(50 * t) - b);  der(q) == b - {offset}; }}
                initial {{ b == {offset};  q == 0; }}
            }}"
        );
        let (found, report) = resolution(&text);
        assert_eq!(found, Resolution::Unresolved, "from {offset}");
        means.push(report.constraints.iter().map(|constraint| constraint.mean_between).fold(0.0, f64::max));
    }
    assert!(means.iter().all(|mean| (mean / means[0] - 1.0).abs() < 0.2), "{means:?}");
}

#[test]
fn a_jump_over_an_obstacle_is_no_solution() {
    let text = "problem Post {
        duration T = 10;
        state x, y, vx, vy;
        input ax, ay;
        collocation gauss(points = 3, intervals = 10);
        minimize integral(ax^2 + ay^2);
        dynamics { der(x) == vx;  der(y) == vy;  der(vx) == ax;  der(vy) == ay; }
        initial { x == 0;  y == 0;  vx == 0;  vy == 0; }
        final { x == 10;  y == 0;  vx == 0;  vy == 0; }
        trajectory { post: (x - 5)^2 + y^2 >= 1; }
    }";
    let (found, report) = resolution(text);
    let around = (report.solution.output("y").expect("an output").at(5.0)).abs() > 0.9;
    assert!(around || found == Resolution::Unresolved, "{report}");
}

#[test]
fn one_jump_of_an_input_is_no_reason() {
    // A thrust that turns round in one interval of twenty.
    let text = "problem Turn {
        duration T in 0.1 .. 10;
        state x, v;
        input th;
        collocation gauss(points = 3, intervals = 21);
        minimize T;
        dynamics { der(x) == v;  der(v) == cos(th); }
        initial { x == 0;  v == 0; }
        final { x == 1;  v == 0; }
        trajectory { th in 0 .. 3.2; }
        guess { th = 1.6;  T = 2; }
    }";
    let (found, report) = resolution(text);
    assert!(report.is_solved() && found < Resolution::Unresolved, "{report}");
}

/// A body at 300 K in air that swings fifty times, to 310 K with the least of squared power.
fn heated(maximize: bool, intervals: usize) -> Report {
    let objective = if maximize { "maximize -1 * integral(q^2)" } else { "minimize integral(q^2)" };
    let text = format!(
        "problem Heat {{
            duration T = 36000;
            state b;
            input q in -50 .. 50;
            collocation gauss(points = 3, intervals = {intervals});
            {objective};
            dynamics {{ 1000 * der(b) == 5 * (300 + 10 * sin(2 * pi * t / 700) - b) + q; }}
            initial {{ b == 300; }}
            final {{ b == 310; }}
        }}"
    );
    Shipped::text(&text).solve()
}

/// What it is: the power that is least is `c exp(r t)`, `r = 5/1000 1/s`, and moves the end by `1/1000 integral of
/// exp(-r (T - t)) q`.
fn heat_known() -> f64 {
    let (r, w, duration) = (0.005_f64, std::f64::consts::TAU / 700.0, 36000.0_f64);
    // Without power from 300 K: the swing of the air, delayed, and what has died away.
    let swing = 10.0 * r / (r * r + w * w);
    let free = swing * (r * (w * duration).sin() - w * (w * duration).cos() + w * (-r * duration).exp());
    let reach = (1.0 - (-2.0 * r * duration).exp()) / (2.0 * r) / 1e6;
    (10.0 - free).powi(2) / reach
}

#[test]
fn what_equations_miss_is_a_correction_of_the_objective() {
    let known = heat_known();
    for intervals in [80, 100, 120] {
        let report = heated(false, intervals);
        let (off, rest) = (report.objective - known, report.objective + report.objective_correction - known);
        assert!(rest.abs() < 0.4 * off.abs(), "{intervals}: {} and {} for {known}", report.objective, rest + known);
        let turned = heated(true, intervals);
        assert!((turned.objective_correction + report.objective_correction).abs() < 1e-6 * known, "the user's sense");
    }
    let fine = heated(false, 400);
    assert!((fine.objective / known - 1.0).abs() < 1e-4 && fine.objective_correction.abs() < 1e-4 * known, "{fine}");
}

/// A mass is kicked once, for a hundredth of the time, and is to be at rest in the end.
fn kicked(begin: f64, intervals: usize) -> String {
    format!(
        "problem Kicked {{
            duration T = 10;
            state x, v;
            input u;
            collocation gauss(points = 3, intervals = {intervals});
            minimize integral(u^2);
            dynamics {{ der(x) == v;  der(v) == u + (if t in {begin} .. {begin} + 0.1 {{ 10 }} else {{ 0 }}); }}
            initial {{ x == 0;  v == 0; }}
            final {{ v == 0; }}
        }}"
    )
}

#[test]
fn a_pulse_that_no_point_sees_is_told_by_what_it_is_worth() {
    // The kick is a speed of 1, so that -0.1 is to be steered all the time: 0.1 in all. No point is within the kick.
    let (found, report) = resolution(&kicked(5.2, 10));
    assert!(report.objective < 1e-12, "{report}");
    assert_ne!(found, Resolution::Fine, "{report}");
    // A point is in the kick, and stands for an interval.
    let (found, report) = resolution(&kicked(5.05, 10));
    assert!(report.objective > 0.2, "{report}");
    assert_eq!(found, Resolution::Unresolved, "{report}");
    let warned = report.warnings().iter().any(|warning| warning.message.contains("the objective is about"));
    assert!(warned && report.objective_correction < -0.1, "{report}");
}

#[test]
fn a_thrust_that_turns_round_is_worth_nothing() {
    // It turns round in the middle of an interval, and the states there are missed: Gauss points have the end all the same.
    let text = "problem Reversal {
        duration T in 0.1 .. 10;
        state x, v;
        input u in -1 .. 2;
        collocation gauss(points = 3, intervals = 5);
        minimize T;
        dynamics { der(x) == v - 0.1 * x;  der(v) == u - 0.5 * v; }
        initial { x == 0;  v == 0; }
        final { x == 1;  v == 0; }
    }";
    let (found, report) = resolution(text);
    assert!(report.violation.between > 0.03, "{report}");
    assert!(report.objective_correction.abs() < 1e-9, "{}", report.objective_correction);
    assert_eq!(found, Resolution::Coarse, "{report}");
}

/// A feed that is 0 but at the start, over a volume that is 7 at least.
#[test]
fn a_quotient_that_is_large_in_one_interval_has_no_pole() {
    let spec = Shipped::text(
        "problem Feed { duration T = 40; state P, V in 1 .. 10; input F in 0 .. 1; collocation gauss(points = 3, intervals = 30);
         maximize final(P * V); dynamics { der(P) == 0.004 * (1 + 4 * sin(t * 10)) - P * F / V; der(V) == F; }
         initial { P == 0; V == 7; } trajectory { F >= if t <= 0.4 { 1 } else { 0 }; } guess { P = 0; V = 8; F = 0.02; } }",
    );
    let report = spec.solver().solve().expect("it can be set up");
    let told: Vec<String> = report.warnings().iter().map(ToString::to_string).collect();
    assert!(told.iter().all(|warning| !warning.contains("singular")), "{told:?}");
}

/// The length of the rod under a condition that always holds: no derivative is taken of it.
const CONDITIONAL: &str = "if y <= 5 { x^2 + y^2 } else { 25 } == 1;";

/// A pendulum by the tension of its rod, index 3: where its length holds at two Gauss points these converge to no solution, three
/// and more do.
fn by_its_rod(length: &str, (points, intervals): (usize, usize)) -> String {
    format!(
        "problem Rod {{
            duration T = 2;
            state x, y, u, w;
            input tension, push;
            collocation gauss(points = {points}, intervals = {intervals});
            minimize integral(push^2);
            dynamics {{
                der(x) == u;  der(y) == w;
                der(u) == -tension * x - push * y;  der(w) == -tension * y - 1 + push * x;
            }}
            trajectory {{ {length} }}
            initial {{ x == 0;  y == -1;  u == 0;  w == 0; }}
            final {{ x == 1;  y == 0;  u == 0;  w == 0; }}
        }}"
    )
}

/// The same by its angle.
fn by_its_angle() -> String {
    "problem Angle {
        duration T = 2;
        state a, w;
        input push;
        collocation gauss(points = 5, intervals = 20);
        minimize integral(push^2);
        dynamics { der(a) == w;  der(w) == push - sin(a); }
        initial { a == 0;  w == 0; }
        final { a == pi / 2;  w == 0; }
    }"
    .to_owned()
}

#[test]
fn a_scheme_that_does_not_converge_is_seen_on_any_mesh() {
    let optimum = resolution(&by_its_angle()).1.objective;
    for intervals in [9, 15, 40, 80] {
        let (found, report) = resolution(&by_its_rod(CONDITIONAL, (2, intervals)));
        assert!(report.objective > 5.0 * optimum, "{report}");
        assert_eq!(found, Resolution::Unresolved, "{intervals}: {report}");
        assert!(report.to_string().contains("depends on the mesh; on intervals half as long it is "), "{report}");
    }
    let conditional = [(3, 9), (3, 40), (4, 15), (5, 10)].map(|mesh| (CONDITIONAL, mesh));
    let reduced = [(2, 9), (2, 40), (3, 9), (4, 15)].map(|mesh| ("x^2 + y^2 == 1;", mesh));
    for (length, mesh) in conditional.into_iter().chain(reduced) {
        let (found, report) = resolution(&by_its_rod(length, mesh));
        assert!(found < Resolution::Unresolved, "{length} {mesh:?}: {report}");
        assert!((report.objective / optimum - 1.0).abs() < 2e-3, "{} for {optimum}", report.objective);
    }
}

/// What runs through decades on few points: growth from 1 to 1e6 by least effort, ln(1e6)^2 / 10, and a tumour that is brought down
/// to a millionth, 27.469 by its logarithm. Objectives of 17.9 and 23.1 were solved, with what shorter intervals say in a warning.
#[test]
fn decades_that_equations_do_not_follow_are_unresolved() {
    let growth = |points: usize, intervals: usize| {
        format!(
            "problem Growth {{
                duration T = 10;  state x in 1 .. 1e6;  input u;
                collocation gauss(points = {points}, intervals = {intervals});
                minimize integral(u^2);
                dynamics {{ der(x) == u * x; }}
                initial {{ x == 1; }}
                final {{ x == 1e6; }}
            }}"
        )
    };
    let tumour = "problem Tumour {
        duration T = 30;  state x in 1 ..;  input u in 0 .. 5;  collocation gauss(points = 4, intervals = 20);
        minimize integral(u^2);
        dynamics { der(x) == 0.5 * x * (1 - x / 1e9) - u * x; }
        initial { x == 1e8; }
        final { x == 1e2; }
    }";
    // The motion itself is left by 6 % of what it varies by.
    let decay = "problem Decay {
        duration T = 20;  state x in 0 ..;  input u;  collocation gauss(points = 3, intervals = 16);
        minimize integral(u^2);
        dynamics { der(x) == -u * x; }
        initial { x == 1e6; }
        final { x == 1; }
    }";
    let effort = 1e6_f64.ln().powi(2);
    let cases = [(growth(5, 10), effort / 10.0), (tumour.to_owned(), 27.469), (decay.to_owned(), effort / 20.0)];
    for (text, optimum) in cases {
        let (found, report) = resolution(&text);
        assert!((report.objective - optimum).abs() > 0.05 * optimum, "now it is solved: {report}");
        assert_eq!(found, Resolution::Unresolved, "{report}");
    }
    // A decade for each interval is followed: nothing is told of it.
    let (found, report) = resolution(&growth(5, 10).replace("1e6", "1e3"));
    assert!(
        found < Resolution::Unresolved && (report.objective * 10.0 / 1e3_f64.ln().powi(2) - 1.0).abs() < 0.01,
        "{report}"
    );
}

/// What grows by itself is far easier by its logarithm, and the advice says so.
#[test]
fn what_runs_through_decades_is_advised_to_be_a_logarithm() {
    let growth = |states: &str, motion: &str| {
        Shipped::text(&format!(
            "problem Growth {{
                duration T = 20;  state {states};  input u;  collocation gauss(points = 4, intervals = 12);
                minimize integral(u^2);
                {motion}
            }}"
        ))
        .solve()
    };
    let plain = growth("x", "dynamics { der(x) == u * x; } initial { x == 1; } final { x == 1e6; }");
    assert_eq!(plain.resolution(), Some(Resolution::Unresolved), "{plain}");
    assert!(plain.advice.contains("`x` runs through 6 decades: write its logarithm"), "{}", plain.advice);
    let logarithm = growth("z", "dynamics { der(z) == u; } initial { z == 0; } final { z == log(1e6); }");
    assert!((logarithm.objective / (1e6_f64.ln().powi(2) / 20.0) - 1.0).abs() < 1e-9, "{logarithm}");
}

/// A unit vector that turns round: on the points its rate may jump at no cost, and of many starts one finds that.
#[test]
fn of_many_starts_the_best_is_a_motion() {
    let shipped = Shipped::text(
        "problem Turn {
            duration T = 60 [s];  state c, s [1], om [rad/s];  input al [rad/s^2];  collocation gauss(points = 3, intervals = 40);
            minimize integral(al^2);
            dynamics { der(c) == -s * om;  der(s) == c * om;  der(om) == al; }
            initial { c == 1;  s == 0;  om == 0; }
            final { c == -1;  s == 0;  om == 0; }
        }",
    );
    let starts = Starts { count: 10, ..Starts::default() };
    let found = multistart(shipped.problem(), &starts, &Settings::default()).expect("it can be set up");
    let is_unresolved = |minimum: &Minimum| minimum.report.resolution() == Some(Resolution::Unresolved);
    // Half a turn: 12 pi^2 / T^3.
    let best = 12.0 * std::f64::consts::PI.powi(2) / 60.0_f64.powi(3);
    assert!((found.minima[0].report.objective / best - 1.0).abs() < 1e-3 && !is_unresolved(&found.minima[0]));
    let first = found.minima.iter().position(is_unresolved).unwrap_or(found.minima.len());
    assert!(found.minima[first..].iter().all(is_unresolved));
    for (number, minimum) in found.minima.iter().enumerate() {
        let own = found.starts.iter().filter(|start| start.minimum == Some(number));
        assert!(own.clone().count() == minimum.count && own.clone().all(|start| start.objective.is_finite()));
    }
}

/// A tank in equilibrium and a circular orbit vary by the rounding of their sizes, and miss their ends by as much.
#[test]
fn what_rests_far_from_nothing_misses_nothing() {
    for size in [1.0, 1.5e8, 4e-9] {
        let tank = format!(
            "problem Tank {{
                const H = {size} [km];
                duration T = 81 [day];
                state h [km];
                collocation gauss(points = 5, intervals = 5);
                minimize final(h / H);
                dynamics {{ der(h) == 0.01 [1/day] * H * (1 - sqrt(h / H)); }}
                initial {{ h == H; }}
            }}"
        );
        let orbit = format!(
            "problem Orbit {{
                const R = {size} [km];  const V = {size} [km] / 10 [day];
                duration T = 146 [day];
                state r [km], th [1], vr, vt [km/day];
                minimize final(th);
                dynamics {{
                    der(r) == vr;  der(th) == vt / r;
                    der(vr) == vt^2 / r - R * V^2 / r^2;  der(vt) == -vr * vt / r;
                }}
                initial {{ r == R; th == 0; vr == 0; vt == V; }}
                collocation gauss(points = 5, intervals = 60);
            }}"
        );
        for (text, known) in [(tank, 1.0), (orbit, 14.6)] {
            let (found, report) = resolution(&text);
            assert!(found == Resolution::Fine && (report.objective / known - 1.0).abs() < 1e-6, "{report}\n{text}");
        }
    }
}

/// A parabola through three points within a limit leaves it by as much as its input jumps; what is missed in one interval of many says
/// nothing of the solution, be the limit one of the input alone, of it and a state, or of its square. An input that leaves its limit in
/// every interval does.
#[test]
fn an_input_leaves_its_limit_where_it_turns_round() {
    let turn = |limit: &str, points: usize, intervals: usize| {
        resolution(&format!(
            "problem Turn {{
                duration T in 0.1 .. 10;  state x, v, z;  input a;
                collocation gauss(points = {points}, intervals = {intervals}, inequalities = points);
                minimize T;  dynamics {{ der(x) == v;  der(v) == a;  der(z) == 1; }}
                initial {{ x == 0;  v == 0;  z == 1; }}  final {{ x == 1;  v == 0; }}
                trajectory {{ {limit} }}
            }}"
        ))
    };
    let limits = ["a in -1 .. 1;", "a^2 <= 1;", "abs(a) <= 1;", "(a * z)^2 <= z^2;", "a^2 + (v / 10)^2 <= 1;"];
    for (points, intervals) in [(2, 17), (3, 11), (4, 25), (5, 7)] {
        for limit in limits {
            let (found, report) = turn(limit, points, intervals);
            assert!(found < Resolution::Unresolved, "{limit}, {points} of {intervals}: {report}");
            assert!((report.objective - 2.0).abs() < 0.05, "{limit}: {report}");
        }
    }
    let (found, report) = resolution(
        "problem Aliased {
            duration T = 20;  state x;  input a in -1 .. 1;
            collocation gauss(points = 2, intervals = 20, inequalities = points);
            minimize integral((a - 3 * sin(2 * pi * t))^2);  dynamics { der(x) == a; }  initial { x == 0; }
        }",
    );
    assert!(report.constraints.iter().any(|own| own.mean_between > 0.05), "{report}");
    assert_eq!(found, Resolution::Unresolved, "{report}");
}

/// A bound that is a declared variable is the measure of what is missed, as a number in its place is.
#[test]
fn a_variable_is_a_bound_as_a_number_is() {
    for (top, limit) in [("variable top in 0 .. 1000 [g*m^2/s^2];", "top"), ("", "20 [g*m^2/s^2]")] {
        let goal = if top.is_empty() { "integral(dot(u, u))" } else { "top" };
        let (found, report) = resolution(&format!(
            "problem Detumble {{
                state w[3] [1/s];  input u[3] [g*m^2/s^2];  {top}  duration T = 130 [s];
                collocation gauss(points = 2, intervals = 28, inequalities = points);
                param J[3] = (5, 5, 8) [kg*m^2];
                dynamics {{ diagonal(J) * der(w) == u - cross(w, diagonal(J) * w); }}
                trajectory {{ norm(u) <= {limit}; }}
                initial {{ w == (0.1080160886, 0.1712433094, -0.2689048052) [1/s]; }}  final {{ w == 0; }}
                minimize {goal};
            }}"
        ));
        assert!(found < Resolution::Unresolved, "{limit}: {report}");
        let limit = report.constraints.iter().find(|own| own.name.contains("norm")).expect("it is one");
        let between = limit.between.as_ref().expect("it is checked").relative;
        assert!(between < 0.05, "{between}");
    }
}

/// So it is beside limits without a variable, and where the limit varies by far more: two posts, as far from both as may be.
#[test]
fn a_clearance_is_missed_by_a_part_of_itself() {
    for (half, far, intervals) in [(96.5, 1324.7, 10), (40.0, 900.0, 8), (10.0, 300.0, 10)] {
        let (found, report) = resolution(&format!(
            "problem Posts {{
                duration T = 20 [s];
                output x, y [m]: spline(order = 4, intervals = {intervals});
                variable m [m];
                param half = {half} [m];
                param far = {far} [m];
                maximize m;
                initial {{ x == -far;  y == 0.03 * half; }}
                final {{ x == far;  y == 0.03 * half; }}
                trajectory {{
                    upper: hypot(x, y - half) >= m;  lower: hypot(x, y + half) >= m;
                    hypot(der(x), der(y)) <= 6 * far / T;  y in -half .. half;
                }}
            }}"
        ));
        let clearance = report.solution.variable("m").expect("a variable");
        for name in ["upper", "lower"] {
            let own = report.constraints.iter().find(|own| own.name == name).expect("it is one");
            let between = own.between.as_ref().expect("it is checked");
            assert!(between.violation > 0.02 * clearance, "the points step over the posts: {report}");
            close(between.relative, between.violation / clearance, 1e-2);
        }
        assert!(found > Resolution::Fine, "{report}");
    }
}

/// The least peak of what can be followed exactly is what the mesh leaves of it, and no measure.
#[test]
fn a_peak_that_only_the_mesh_leaves_is_resolved() {
    for (amplitude, rate, intervals) in [(2.627, 3.627, 6), (2.627, 3.627, 8), (666.0, 2.5, 8)] {
        let text = format!(
            "problem Fit {{
                duration T = 1.833;
                variable p;
                state x;
                input u;
                collocation gauss(points = 3, intervals = {intervals});
                let wanted = {amplitude} * exp(-{rate} * t);
                dynamics {{ der(x) == u; }}
                trajectory {{ abs(x - wanted) <= p; }}
                minimize p;
            }}"
        );
        let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
        assert!(report.is_solved() && report.objective < 1e-3 * amplitude, "{report}");
        assert_eq!(report.resolution(), Some(Resolution::Fine), "{report}");
    }
}

/// What holds a speed over hills is as large as the force that does, whatever the force is divided by.
#[test]
fn what_holds_a_speed_has_the_size_of_its_force() {
    for rate in [
        "der(v) == (f - 0.022 [m/s^2] - 1e-5 [1/m] * v^2 - 9.81 [m/s^2] * grade) / v;",
        "v * der(v) == f - 0.022 [m/s^2] - 1e-5 [1/m] * v^2 - 9.81 [m/s^2] * grade;",
    ] {
        let (found, report) = resolution(&format!(
            "problem Train {{
                domain s [km];  duration S = 40 [km];
                state v in 3 .. 110 [m/s], t_run [s];  input f in -0.5 .. 0.8 [m/s^2];
                collocation gauss(points = 3, intervals = 14);
                let grade = 0.00033 + 0.00088 * sin(2 * pi * s / 10 [km]);
                dynamics {{ {rate}  der(t_run) == 1 / v; }}
                initial {{ v == 27.8 [m/s]; t_run == 0; }}  final {{ v == 27.8 [m/s]; t_run <= 1438.85 [s]; }}
                minimize integral(f);
            }}"
        ));
        assert!(found < Resolution::Unresolved && (report.objective / 1318.63 - 1.0).abs() < 1e-4, "{report}");
    }
}

/// A spring that swings several times in the guessed time is at rest at all points whatever it does between them: what shorter
/// intervals find tells where to begin again. The least time is 3.0753713 s, by arcs of circles round `F / k` in the phase plane.
#[test]
fn a_motion_that_shorter_intervals_refute_is_found_from_there() {
    for (units, intervals) in [(true, 30), (true, 36), (false, 30)] {
        let unit = |unit: &'static str| if units { unit } else { "" };
        let (length, rate, force, mass) = (unit("[mm]"), unit("[kn]"), unit("[kN]"), unit("[t]"));
        // In SI without units.
        let scale = |with: f64, without: f64| if units { with } else { without };
        let report = Shipped::text(&format!(
            "problem Spring {{
                param stiffness = 149000.0 {};
                initial {{ x == {} {length};  v == {} {rate}; }}
                final {{ x == 0;  v == 0; }}
                collocation gauss(points = 2, intervals = {intervals});
                input F in -{f} {force} .. {f} {force};
                duration T in 0 ..;
                let v {rate} = der(x);
                param mass = {} {mass};
                minimize time {}: T;
                state x {length};
                dynamics {{ mass * der(x, 2) + stiffness * x == F; }}
            }}",
            unit("[N/m]"),
            scale(-935.551_170_5, -0.935_551_170_5),
            scale(122.651_520_5, 63.097_393_4),
            scale(5.6, 5600.0),
            unit("[s]"),
            f = scale(180.0, 180_000.0),
        ))
        .solve();
        assert!((3.05..3.12).contains(&report.objective), "{units}, {intervals}\n{report}");
    }
}
