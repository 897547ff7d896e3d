//! Corners of the objective for which helpers stand (docs/maths.md, section 18): known answers, the same by hand bit for
//! bit, and what nobody is to see of a helper.

use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::prelude::*;

struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("{path} is not there"))
    }
}

#[track_caller]
fn compiled(text: &str) -> Interpreted {
    let source = Source::new("test.ntg", text);
    match ntg_compiler::compile(&source, &NoFiles) {
        Ok(compiled) => Interpreted::new(&compiled.program),
        Err(found) => panic!("{}", found.iter().map(|d| d.render(&source)).collect::<Vec<_>>().join("\n")),
    }
}

#[track_caller]
fn report(text: &str) -> Report {
    solve(&compiled(text), &Settings::default()).expect("a problem that can be set up")
}

#[track_caller]
fn reaches(text: &str, objective: f64, tolerance: f64) {
    let report = report(text);
    assert!(report.is_solved(), "{report}");
    let missed = (report.objective - objective).abs();
    assert!(missed <= tolerance, "{} instead of {objective}, {missed:e} off", report.objective);
}

/// From 1 to 0, from rest to rest, in a given time.
const BLOCK: &str = "duration T = 3; state x, v; input u in -1 .. 1; dynamics { der(x) == v; der(v) == u; } \
    initial { x == 1; v == 0; } final { x == 0; v == 0; }";

/// Between full thrusts of `(3 - sqrt(5)) / 2` each nothing is burnt (M. Athans, P. Falb, *Optimal Control*, 1966); the
/// breakpoints lie at the switches.
#[test]
fn the_least_fuel_of_a_double_integrator() {
    let switch = (3.0 - 5.0_f64.sqrt()) / 6.0;
    let knots = format!("knots = (0, {switch}, {}, 1)", 1.0 - switch);
    reaches(
        &format!("problem P {{ {BLOCK} collocation gauss(points = 3, {knots}); minimize integral(abs(u)); }}"),
        3.0 - 5.0_f64.sqrt(),
        1e-6,
    );
    reaches(
        "problem P { duration T in 0.1 .. 20; state x, v; input u in -1 .. 1; \
         collocation gauss(points = 3, intervals = 20); minimize T + integral(abs(u)); \
         dynamics { der(x) == v; der(v) == u; } initial { x == 1; v == 0; } final { x == 0; v == 0; } \
         guess { x = 1 - tau; } }",
        12.0_f64.sqrt(),
        1e-4,
    );
}

/// Heat is worth less than comfort: the room is kept at its limit, against losses of 72 kWh.
#[test]
fn what_is_missed_by_more_than_0() {
    reaches(
        "problem P { domain t [h]; duration T = 24 [h]; state th [K]; input q in 0 .. 6 [kW]; \
         collocation gauss(points = 2, intervals = 48); \
         let out [K] = 5 [K] + 5 [K] * sin(2 * pi * (t - 9 [h]) / 24 [h]); \
         minimize energy: integral(q) / 1 [kWh]; \
         minimize discomfort: 2 * integral(max(0, 20 [K] - th)) / 1 [K*h]; \
         dynamics { 3 [kWh/K] * der(th) == q - 0.2 [kW/K] * (th - out); } initial { th == 20 [K]; } \
         final { th >= 20 [K]; } }",
        72.0,
        1e-6,
    );
}

/// A landing in the plane, 40 intervals: 186.721 m/s by IPOPT with `sqrt(a^2 + 1e-8)` on this mesh.
#[test]
fn the_least_velocity_that_a_landing_takes() {
    reaches(
        "problem P { duration T = 100 [s]; state r[2] [m], v[2] [m/s]; input a[2] [m/s^2]; \
         collocation gauss(points = 3, intervals = 40); minimize dv [m/s]: integral(norm(a)); \
         dynamics { der(r) == v; der(v) == a + (0, -1.62) [m/s^2]; } \
         initial { r == (-2000, 3000) [m]; v == (40, -20) [m/s]; } \
         trajectory { norm(a) <= 4 [m/s^2]; r[2] >= 0; } final { r == 0; v == 0; } }",
        186.721,
        1e-3,
    );
}

/// The sum of distances to numbers is least at their median.
#[test]
fn a_fit_by_least_absolute_deviations_is_the_median() {
    let text = "problem P { duration T = 1; output x: spline(order = 2, intervals = 1); variable c; \
        const data[5] = (1, 2, 3, 10, 50); minimize sum(i in 1 .. 5, abs(c - data[i])); initial { x == 0; } final { x == 0; } }";
    let report = report(text);
    assert!(report.is_solved(), "{report}");
    let c = report.solution.variable("c").expect("a variable");
    assert!((c - 3.0).abs() < 1e-5 && (report.objective - 57.0).abs() < 1e-6, "{c}, {}", report.objective);
}

const RACE: &str = "duration T = 1; state x, y; variable a in 0 .. 1; collocation gauss(points = 2, intervals = 2); \
    dynamics { der(x) == a; der(y) == 1 - 3 * a; } initial { x == 0; y == 0; }";

/// `a` and `1 - 3 a` are equal at a quarter.
#[test]
fn the_worst_of_several_ends() {
    reaches(&format!("problem P {{ {RACE} minimize max(final(x), final(y)); }}"), 0.25, 1e-7);
    reaches(&format!("problem P {{ {RACE} maximize min(final(x), final(y)); }}"), 0.25, 1e-7);
    reaches(&format!("problem P {{ {RACE} minimize abs(final(x) - final(y)) + final(x); }}"), 0.25, 1e-7);
}

#[test]
fn members_have_helpers_of_their_own() {
    let two = "duration T = 3; state x[2], v[2]; input u[2] in -1 .. 1; collocation gauss(points = 3, intervals = 20); \
        dynamics { der(x) == v; der(v) == u; } initial { x == (1, 0.5); v == 0; } final { x == 0; v == 0; }";
    let one = |x: f64| {
        let text = format!(
            "problem P {{ {BLOCK} collocation gauss(points = 3, intervals = 20); minimize integral(abs(u)); }}"
        );
        report(&text.replace("x == 1", &format!("x == {x}"))).objective
    };
    let sum = one(1.0) + one(0.5);
    reaches(&format!("problem P {{ {two} minimize sum(i in 1 .. 2, integral(abs(u[i]))); }}"), sum, 1e-6);
    reaches(&format!("problem P {{ {two} minimize integral(sum(i in 1 .. 2, abs(u[i]))); }}"), sum, 1e-6);
}

/// What the manual says that it becomes, written out: the same solution, bit for bit.
#[test]
fn by_hand_it_is_the_same() {
    // Limits of a declaration come behind all blocks: as a block they come before, as before the rows of a helper.
    let block = BLOCK.replace("input u in -1 .. 1;", "input u; trajectory { u in -1 .. 1; }");
    let common = format!("{block} collocation gauss(points = 3, intervals = 12, inequalities = points);");
    let short = report(&format!("problem P {{ {common} minimize integral(abs(u)); }}"));
    let long = report(&format!(
        "problem P {{ {common} output s: spline(order = 3, intervals = 12, smoothness = 0); minimize integral(s); \
         trajectory {{ s - u >= 0; s + u >= 0; }} }}"
    ));
    assert_eq!(short.objective.to_bits(), long.objective.to_bits());
    assert_eq!(short.solution.coefficients(), long.solution.coefficients());
}

#[test]
fn nobody_sees_a_helper() {
    let text = format!(
        "problem P {{ {BLOCK} collocation gauss(points = 3, intervals = 12); \
        minimize fuel: integral(abs(u)) + abs(final(x)); }}"
    );
    let report = report(&text);
    let names: Vec<String> = report.solution.trajectories().iter().map(|one| one.name().to_owned()).collect();
    assert_eq!(names, ["x", "v", "u"]);
    assert!(report.solution.variables().is_empty());
    assert!(report.constraints.iter().all(|constraint| !constraint.place.text.contains("abs")), "{report}");
    assert!(!report.to_string().contains("corner"), "{report}");
    // Between the points the cost is that of what was written: more than the sum at the points has, and not it.
    assert!((report.objective_fine - report.objective).abs() > 1e-6, "{report}");
}

/// Where a corner is pushed away from its tip, or its weight has no known sign, it stays, and a solve that comes to no end
/// names it.
#[test]
fn other_corners_stay_and_are_named() {
    let corners = |objective: &str| {
        let text =
            format!("problem P {{ {BLOCK} param w = 1; collocation gauss(points = 3, intervals = 12); {objective} }}");
        let structure = compiled(&text).structure().clone();
        structure.corners.iter().map(|place| place.text.clone()).collect::<Vec<_>>()
    };
    assert_eq!(corners("minimize w * integral(abs(u));"), Vec::<String>::new());
    assert_eq!(corners("maximize integral(abs(u));"), ["abs(u)"]);
    assert_eq!(corners("minimize integral(x * abs(u));"), ["abs(u)"]);
    assert_eq!(corners("minimize integral(u^2); trajectory { abs(u) <= 2; }"), Vec::<String>::new());
    assert_eq!(corners("minimize integral(u^2); trajectory { abs(u) >= 2; }"), ["abs(u)"]);
    assert_eq!(corners("minimize integral(abs(u)); trajectory { x * abs(u) <= 2; }"), ["abs(u)"]);
    // Where a factor vanishes with it, it is none.
    assert_eq!(corners("minimize integral(abs(u)); trajectory { u * abs(u) <= 2; }"), Vec::<String>::new());
    assert_eq!(corners("minimize integral((1 + x^2) * abs(u) + exp(-t) * max(x, v, 0));"), Vec::<String>::new());

    let text = format!(
        "problem P {{ {BLOCK} collocation gauss(points = 3, intervals = 60); \
        minimize integral(u^2 + 5 * abs(u) * sin(7 * x)); }}"
    );
    let few = Settings { max_iterations: 3, ..Settings::default() };
    let report = solve(&compiled(&text), &few).expect("a problem that can be set up");
    assert!(!report.has_solution() && report.advice.contains("`abs(u)` (line 1)"), "{}", report.advice);
}

#[test]
fn a_weight_below_0_is_refused() {
    let text = format!(
        "problem P {{ {BLOCK} param w = 1; collocation gauss(points = 3, intervals = 12); \
        minimize w * integral(abs(u)); }}"
    );
    let mut problem = compiled(&text);
    problem.assign("w", "-1").expect("a parameter");
    let Err(error) = solve(&problem, &Settings::default()) else { panic!("it was solved") };
    assert!(error.to_string().contains("w >= 0, the weight of a corner"), "{error}");
}

/// `|u| + |v| <= 1` from rest to rest over 1: `v' = 1 - v` up to the middle, `t - 1 + exp(-t) = 1/2` there. With 1.5 of fuel
/// at most and thrusts of 1 the motion coasts at 0.75.
#[test]
fn corners_of_limits_are_rows() {
    let block = |rest: &str| {
        format!(
            "problem P {{ duration T in 0.1 .. 20; state x, v; input u in -1 .. 1; minimize T; \
             dynamics {{ der(x) == v; der(v) == u; }} initial {{ x == 0; v == 0; }} final {{ x == 1; v == 0; }} {rest} }}"
        )
    };
    let mut half = 1.2_f64;
    (0..50).for_each(|_| half -= (half - 1.5 + (-half).exp()) / (1.0 - (-half).exp()));
    let text = |limit: &str| block(&format!("collocation gauss(points = 3, intervals = 40); trajectory {{ {limit} }}"));
    for limit in ["abs(u) + abs(v) <= 1;", "1 - abs(v) >= max(u, -u);", "min(1 - u - v, 1 + u - v) >= 0; v >= 0;"] {
        reaches(&text(limit), 2.0 * half, 1e-5);
        assert!(report(&text(limit)).iterations <= 60, "{limit}");
    }
    let knots = 0.75 / (25.0 / 12.0);
    for limit in ["integral(abs(u)) <= 1.5;", "sqrt(integral(max(u, -u))) <= sqrt(1.5);"] {
        let knots = format!("collocation gauss(points = 3, knots = (0, {knots}, {}, 1));", 1.0 - knots);
        reaches(&block(&format!("{knots} temporal {{ {limit} }}")), 25.0 / 12.0, 1e-6);
    }
}

/// A corner has as many members as sides, of which nobody hears; its multipliers are those of both.
#[test]
fn the_sides_of_a_limit_are_seen_by_nobody() {
    let text = format!(
        "problem P {{ {BLOCK} collocation gauss(points = 3, intervals = 12); minimize (final(x) + 1)^2; \
         trajectory {{ for i in 1 .. 2 {{ thrust: i * abs(u) <= 1; }} }} }}"
    )
    .replace("final { x == 0; v == 0; }", "final { v == 0; }");
    let problem = compiled(&text);
    let report = solve(&problem, &Settings::default()).expect("a problem that can be set up");
    let thrust = report.constraints.iter().find(|own| own.name == "thrust").expect("a constraint");
    assert!(thrust.points.as_ref().is_some_and(|worst| worst.indices.len() == 1), "{thrust:?}");
    let traces = report.solution.traces(&problem, 4).expect("the problem that was solved");
    let own: Vec<_> = traces.iter().filter(|trace| trace.indices.len() == 1).collect();
    assert_eq!(own.iter().map(|trace| &trace.indices[..]).collect::<Vec<_>>(), [[1], [2]]);
    let (least, most) = own[1].points.iter().fold((f64::MAX, f64::MIN), |(a, b), (_, v)| (a.min(*v), b.max(*v)));
    assert!(least >= 0.0 && (most - 1.0).abs() < 1e-6, "{least} {most}");
    let of_rows: f64 = report.solution.multipliers("thrust").iter().map(|multiplier| multiplier.value.abs()).sum();
    assert!(of_rows > 1e-3 && thrust.sensitivity < 0.0, "{of_rows} {thrust:?}");
    // Two members, and in each interval three Gauss points and both ends.
    assert_eq!(report.solution.multipliers("thrust").len(), 2 * 12 * 5);
}

/// A corner in a limit is what its rows are by hand.
#[test]
fn a_limit_with_corners_is_its_rows_bit_for_bit() {
    let text = |limits: &str| {
        format!(
            "problem P {{ {BLOCK} collocation gauss(points = 3, intervals = 12); minimize integral(u^2); \
             trajectory {{ {limits} }} }}"
        )
    };
    let corner = report(&text("for i in 1 .. 1 { 1.1 * abs(u) <= 1; }"));
    let rows = report(&text("for i in 1 .. 2 { 1.1 * ((3 - 2 * i) * u) <= 1; }"));
    assert!(corner.is_solved() && corner.iterations == rows.iterations, "{corner}{rows}");
    assert!((corner.objective - rows.objective).abs() <= 1e-12 * rows.objective, "{corner}{rows}");
}

/// A limit whose corners stay asks nothing of its weights.
#[test]
fn a_weight_of_corners_that_stay_may_be_below_0() {
    let text = |sides: &str| {
        format!(
            "problem P {{ {BLOCK} param w = 1; collocation gauss(points = 3, intervals = 12); \
             minimize integral(u^2) + integral(abs(u)); trajectory {{ w * ({sides}) <= 9; }} }}"
        )
    };
    let many = "abs(u) + abs(v) + abs(x) + abs(u - v) + abs(u + v) + abs(u - x) + abs(u + x)";
    for (sides, is_set) in [("abs(u) + abs(v)", false), (many, true)] {
        let mut problem = compiled(&text(sides));
        problem.assign("w", "-1").expect("a parameter");
        assert_eq!(solve(&problem, &Settings::default()).is_ok(), is_set, "{sides}");
    }
}

/// Of a difference of parameters the defaults say that it is not negative; who sets them otherwise is told, wherever it is a weight.
#[test]
fn a_difference_of_parameters_that_is_a_weight_must_stay_positive() {
    for cost in [
        "if u >= 0 { buy * u } else { sell * u }",
        "if u <= 0 { sell * u } else { buy * u }",
        "sell * u + (buy - sell) * max(0, u)",
        "(buy - sell) * abs(u)",
        // The first condition is no corner: the weight of the other term is held all the same.
        "(if v >= 0 { buy * v } else { sell }) + (buy - sell) * abs(u)",
    ] {
        let text = format!(
            "problem P {{ {BLOCK} param buy = 0.3; param sell = 0.1; collocation gauss(points = 3, intervals = 12); \
             minimize integral({cost} + 0.1 * u^2); }}"
        );
        let mut problem = compiled(&text);
        assert!(solve(&problem, &Settings::default()).is_ok(), "{cost}");
        problem.assign("sell", "0.2").expect("a parameter");
        assert!(solve(&problem, &Settings::default()).is_ok(), "{cost}");
        problem.assign("sell", "0.4").expect("a parameter");
        let refused = solve(&problem, &Settings::default()).expect_err(cost).to_string();
        assert!(refused.contains("a weight of a corner, made of") && refused.contains("sell"), "{cost}: {refused}");
    }
}

/// An equation with a corner has its own name, value, multipliers and violations in reports, and its helper has none.
#[test]
fn an_equation_with_a_corner_is_reported_as_it_is_written() {
    let report = report(
        "problem P { duration T = 3; state x, v, E; input u in -1 .. 1; collocation gauss(points = 3, intervals = 12); \
         minimize final(E); dynamics { der(x) == v; der(v) == u; counted: der(E) == abs(u); } \
         initial { x == 1; v == 0; E == 0; } final { x == 0; v == 0; } }",
    );
    assert!(report.is_solved(), "{report}");
    let counted = report.constraints.iter().find(|own| own.name == "counted").expect("it is reported");
    assert!(counted.is_equation);
    assert!(counted.points.as_ref().is_some_and(|worst| worst.relative < 1e-6), "{counted:?}");
    // An effort more at any time is worth as much in the end.
    let multipliers = report.solution.multipliers("counted");
    assert_eq!(multipliers.len(), 36);
    for multiplier in multipliers {
        assert!((multiplier.value.abs() - 1.0).abs() < 1e-6, "{multiplier:?}");
    }
    let names: Vec<String> = report.constraints.iter().map(|own| own.name.clone()).collect();
    assert!(names.iter().all(|name| !name.contains("corner")), "{names:?}");
    let told = report.to_string();
    assert!(!told.contains("corner("), "{told}");
}

/// Which form is posed first: nothing holds a trajectory at a corner of states alone.
#[test]
fn equations_whose_corners_are_of_states_alone_are_posed_as_written_first() {
    let first = |rate: &str| {
        let problem = compiled(&format!(
            "problem P {{ duration T = 1; state x, v; input u; dynamics {{ der(x) == v; der(v) == {rate}; }} \
             collocation gauss(points = 2, intervals = 2); minimize integral(u^2); initial {{ x == 0; v == 0; }} }}"
        ));
        problem.structure().relaxations.iter().map(|own| own.exact_first).collect::<Vec<_>>()
    };
    assert_eq!(first("u - abs(v)"), [true]);
    assert_eq!(first("u + max(0, -x)"), [true]);
    assert_eq!(first("abs(u) - v"), [false]);
    assert_eq!(first("abs(u * v) + abs(x)"), [false]);
    assert_eq!(first("u - norm((x, v)) * v"), [false; 0]);
}

/// A point at which a helper is not what it stands for is told of: a solution, and that with all signs turned.
#[test]
fn an_equation_that_is_missed_as_it_is_written_is_named() {
    let missed = |text: &str| {
        let problem = compiled(text);
        let report = solve(&problem, &Settings::default()).expect("it can be set up");
        assert!(report.is_solved(), "{report}");
        let nlp = ntg_runtime::transcribe::Transcription::new(&problem).expect("it transcribes");
        let solution = report.solution.coefficients();
        let turned: Vec<f64> = solution.iter().map(|x| -x).collect();
        let names = |x: &[f64]| nlp.missed_as_written(x).into_iter().map(|(name, _)| name).collect::<Vec<_>>();
        (names(solution), names(&turned))
    };
    let fuel = "problem P { duration T = 3; state x, v, E; input u in -1 .. 1; collocation gauss(points = 3, intervals = 12); \
        minimize final(E); dynamics { der(x) == v; der(v) == u; counted: der(E) == abs(u); } \
        initial { x == 1; v == 0; E == 0; } final { x == 0; v == 0; } }";
    assert_eq!(missed(fuel), (vec![], vec!["counted".to_owned()]));
    let way = "problem P { duration T = 4; state x, s; input u[2]; collocation gauss(points = 3, intervals = 10); \
        minimize integral(dot(u, u)); dynamics { der(x) == u[1]; length: der(s) == norm(u); } \
        initial { x == 0; s == 0; } final { x == 3; s == 6; } }";
    assert_eq!(missed(way), (vec![], vec!["length".to_owned()]));
}
