//! Libraries: names in scopes of their own, findings with several sources, and the language's own against published
//! tables.

use std::collections::BTreeMap;

use crate::model_support::{Files, findings_with};
use ntg_compiler::diagnostic::Severity;
use ntg_compiler::source::Source;

const AIR: &str = "const scale = 8.5 [km];\nfn density(h [m]) [kg/m^3] = 1.225 [kg/m^3] * exp(-h / scale);\n\
    fn half(x) = x / 2;\nfn wrong(h [m]) [kg/m^3] = h;\ntable cd(mach) = monotone { 0: 0.2; 1: 0.5; 2: 0.4; }\n";

fn files() -> Files {
    Files(vec![
        ("air.ntg", AIR),
        ("models/air-3.ntg", "use \"../base.ntg\";\nfn density(h [m]) [kg/m^3] = base::sea * exp(-h / 8 [km]);\n"),
        ("base.ntg", "const sea = 1.2 [kg/m^3];\n"),
        ("models/tables.ntg", "table thrust(t [s]) [kN] = linear from \"thrust.csv\";\n"),
        ("models/thrust.csv", "0, 1\n2, 3\n"),
        ("a.ntg", "use \"b.ntg\";\nconst one = 1;\n"),
        ("b.ntg", "use \"a.ntg\";\nconst two = 2;\n"),
        ("whole.ntg", "problem Q { duration T = 1; }\n"),
        ("broken.ntg", "const a = ;\nparam b = 2;\nfn f(x) = x + y;\n"),
    ])
}

fn spec(uses: &str, text: &str) -> String {
    format!(
        "{uses}\nproblem P {{\n    duration T = 5 [s];\n    output h [m]: spline(order = 5, intervals = 2);\n    minimize integral(h^2);\n    {text}\n}}\n"
    )
}

#[track_caller]
fn found(uses: &str, text: &str) -> String {
    findings_with(&spec(uses, text), &files())
}

/// The constants that `let`s of a spec are worth, by name.
#[track_caller]
fn values(uses: &str, lets: &[(&str, String)]) -> BTreeMap<String, f64> {
    let mut text: String = lets.iter().map(|(name, value)| format!("    let {name} = {value};\n")).collect();
    text.push_str("    trajectory { h <= 1 [m]; }");
    let source = Source::new("spec.ntg", spec(uses, &text));
    let parsed = ntg_compiler::syntax::parse(&source).unwrap_or_else(|found| panic!("{}", found.render(&source)));
    let (problem, found) = ntg_compiler::model::build(&parsed, &source, &files());
    let rendered: Vec<String> = found.iter().map(|finding| finding.render(&source)).collect();
    let problem = problem.unwrap_or_else(|| panic!("{}", rendered.join("\n\n")));
    let world = crate::model_support::World { flat: &|_, _, _, _| 1.0, other: &|_| 1.0 };
    problem
        .named
        .iter()
        .map(|named| (named.name.clone(), crate::model_support::value(&problem, named.body, world)))
        .collect()
}

#[track_caller]
fn value(uses: &str, expression: &str) -> f64 {
    values(uses, &[("y", expression.to_owned())])["y"]
}

#[track_caller]
fn near(found: f64, wanted: f64, relative: f64) {
    assert!((found - wanted).abs() <= relative * wanted.abs(), "{found} is not {wanted}");
}

// ------------------------------------------------------------ names

#[test]
fn names_of_a_library_stand_behind_its_own() {
    near(value("use \"air.ntg\";", "air::density(8.5 [km])"), 1.225 * (-1.0_f64).exp(), 1e-14);
    near(value("use \"air.ntg\" as sky;", "sky :: density(0 [m]) + 0 * sky::scale / 1 [m^4/kg]"), 1.225, 1e-14);
    near(value("use \"air.ntg\"::{density, scale};", "density(scale)"), 1.225 * (-1.0_f64).exp(), 1e-14);
    near(value("use \"air.ntg\";", "air::cd(1) + partial(air::half(3), 3)"), 1.0, 1e-14);
}

#[test]
fn a_library_uses_others_from_its_own_folder() {
    near(value("use \"models/air-3.ntg\" as air;", "air::density(0 [m])"), 1.2, 1e-14);
    near(value("use \"models/tables.ntg\";", "tables::thrust(1 [s])"), 2000.0, 1e-14);
}

#[test]
fn a_library_sees_itself_and_never_the_spec() {
    let own = "const scale = 1 [m];  let y = air::density(8.5 [km]);";
    assert_eq!(found("use \"air.ntg\";", own), "");
    near(value("use \"air.ntg\";", "air::density(8.5 [km])"), 1.225 * (-1.0_f64).exp(), 1e-14);
}

#[test]
fn derivatives_are_counted_through_libraries() {
    let text = "use \"rates.ntg\";\nproblem P { duration T = 1; state x; input u; collocation gauss(points = 3, intervals = 4);\n\
        minimize integral(u^2); dynamics { rates::second(x) == u; } }";
    let source = Source::new("spec.ntg", text);
    let rates = Files(vec![("rates.ntg", "fn first(y) = der(y);\nfn second(y) { let v = first(y); der(v) }\n")]);
    let compiled = ntg_compiler::compile(&source, &rates).unwrap_or_else(|found| panic!("{}", found.render(&source)));
    assert_eq!(compiled.program.structure.phases[0].outputs[0].spline.order, 5);
}

#[test]
fn use_and_import_stay_names_and_a_colon_may_stand_before_a_blank() {
    let text =
        "output use, import: spline(order = 5, intervals = 2);  minimize as: integral(use^2 + import^2) * 1 [m^2];";
    assert_eq!(found("", text), "");
}

// ------------------------------------------------------------ findings

macro_rules! messages {
    ($($name:ident: $text:expr;)*) => {
        $(#[test]
        fn $name() {
            insta::assert_snapshot!(stringify!($name), $text);
        })*
    };
}

messages! {
    an_unknown_library: found("use std::atmosfere;\nuse std::rotation::about_x;\nuse numpy::linalg;\nuse std::nothing_like_it;", "");
    a_library_that_cannot_be_read: found("use \"nowhere.ntg\";", "");
    a_problem_is_no_library: found("use \"whole.ntg\";", "");
    libraries_in_a_circle: found("use \"a.ntg\";", "");
    a_file_whose_name_is_no_name: found("use \"models/air-3.ntg\";", "");
    a_broken_library: found("use \"broken.ntg\";", "");
    names_that_a_library_does_not_have: found("use \"air.ntg\";\nuse std::rotation::{about_w};", "let a = air::densty(h);\nlet b = sky::density(h);\nlet c = density(h);\nlet d = air + 1;\nlet e = air::scal;\nlet f = gravity::mu_earth;");
    an_argument_of_another_dimension: found("use \"air.ntg\";", "let a = air::density(5 [s]);");
    what_is_wrong_inside_a_library_is_shown_there: found("use \"air.ntg\";", "let a = air::wrong(h);");
    two_libraries_of_one_name: found("use \"air.ntg\";\nuse \"models/air-3.ntg\" as air;", "let a = 1;");
    forms_of_other_languages: match ntg_compiler::syntax::parse(&Source::new("spec.ntg", "import std.rotation;\nproblem P { }")) {
        Err(found) => found.render(&Source::new("spec.ntg", "import std.rotation;\nproblem P { }")),
        Ok(_) => String::new(),
    };
}

/// What is wrong with the syntax of a spec.
fn unread(text: &str) -> String {
    let source = Source::new("spec.ntg", text);
    ntg_compiler::syntax::parse(&source).map_or_else(|found| found.render(&source), |_| String::new())
}

messages! {
    forms_with_a_dot: unread("use std.rotation;\nuse std::atmosphere\nproblem P { let a = air.density(h); }");
}

/// What is found in a library by itself.
fn checked(text: &str) -> String {
    let source = Source::new("lib.ntg", text);
    let found = ntg_compiler::check_library(&source, &files());
    found.iter().map(|finding| finding.render(&source)).collect::<Vec<_>>().join("\n\n")
}

messages! {
    a_library_is_checked_by_itself: checked("use \"base.ntg\";\nfn f(h [m], r[3] [km]) [m] = h + norm(r) + base::sea;\nfn g(x) = x^2;\nlet y = 2;\nconst z = 1 / 0;\n");
    a_function_that_states_its_arguments_is_tried: checked("fn f(h [m], r[3] [km]) [m] = h + norm(r) / 1 [s];\nfn g(v[3]) [2] = v;\nfn h(x [m]) = nothing(x);\n");
}

#[test]
fn the_languages_own_libraries_are_well_formed() {
    for name in ntg_compiler::standard::names() {
        let source = Source::new(name, ntg_compiler::standard::library(name).expect("it has a text"));
        let found = ntg_compiler::check_library(&source, &files());
        let errors: Vec<String> =
            found.iter().filter(|f| f.severity == Severity::Error).map(|f| f.render(&source)).collect();
        assert!(errors.is_empty(), "{}", errors.join("\n\n"));
        let formatted =
            ntg_compiler::syntax::format(&source).unwrap_or_else(|found| panic!("{}", found.render(&source)));
        assert_eq!(formatted, source.text, "{name} has not the layout of `ntg fmt`");
    }
}

// ------------------------------------------------------------ published tables

/// Geometric height [km], temperature [K], pressure [Pa], density [kg/m^3], speed of sound [m/s]: US Standard Atmosphere
/// 1976, tables I and III. Heights near corners of the temperature, which are rounded, are left out.
const ATMOSPHERE: [(f64, f64, f64, f64, f64); 14] = [
    (0.0, 288.150, 1.01325e5, 1.2250, 340.29),
    (1.0, 281.651, 8.9876e4, 1.1117, 336.43),
    (5.0, 255.676, 5.4048e4, 7.3643e-1, 320.55),
    (10.0, 223.252, 2.6500e4, 4.1351e-1, 299.53),
    (15.0, 216.650, 1.2111e4, 1.9476e-1, 295.07),
    (25.0, 221.552, 2.5492e3, 4.0084e-2, 298.39),
    (30.0, 226.509, 1.1970e3, 1.8410e-2, 301.71),
    (40.0, 250.350, 2.8714e2, 3.9957e-3, 317.19),
    (45.0, 264.164, 1.4910e2, 1.9663e-3, 325.82),
    (50.0, 270.650, 7.9779e1, 1.0269e-3, 329.80),
    (60.0, 247.021, 2.1959e1, 3.0968e-4, 315.07),
    (70.0, 219.585, 5.2209e0, 8.2829e-5, 297.06),
    (75.0, 208.399, 2.3881e0, 3.9921e-5, 289.40),
    (80.0, 198.639, 1.0525e0, 1.8458e-5, 282.54),
];

#[test]
fn the_atmosphere_is_that_of_the_published_tables() {
    let mut lets: Vec<(String, String)> = Vec::new();
    for (k, (height, ..)) in ATMOSPHERE.iter().enumerate() {
        for quantity in ["temperature", "pressure", "density", "sound"] {
            lets.push((format!("{quantity}_{k}"), format!("atmosphere::{quantity}({height} [km])")));
        }
    }
    let lets: Vec<(&str, String)> = lets.iter().map(|(name, text)| (name.as_str(), text.clone())).collect();
    let found = values("use std::atmosphere;", &lets);
    for (k, (_, temperature, pressure, density, sound)) in ATMOSPHERE.into_iter().enumerate() {
        near(found[&format!("temperature_{k}")], temperature, 1e-5);
        near(found[&format!("pressure_{k}")], pressure, 1e-4);
        near(found[&format!("density_{k}")], density, 1e-4);
        near(found[&format!("sound_{k}")], sound, 1e-4);
    }
    // Table III: dynamic viscosity at 0 and 10 km.
    near(value("use std::atmosphere;", "atmosphere::viscosity(0 [m])"), 1.7894e-5, 1e-4);
    near(value("use std::atmosphere;", "atmosphere::viscosity(10 [km])"), 1.4577e-5, 1e-4);
}

#[test]
fn the_pressure_between_the_nodes_follows_the_standards_formula() {
    // Layer by layer: p (T_b / T)^(g M / R L), or an exponential where the temperature stays.
    let layers = [
        (0.0, 288.15, -6.5),
        (11.0, 216.65, 0.0),
        (20.0, 216.65, 1.0),
        (32.0, 228.65, 2.8),
        (47.0, 270.65, 0.0),
        (51.0, 270.65, -2.8),
        (71.0, 214.65, -2.0),
    ];
    let exact = |z: f64| {
        let h = z * 6356.766 / (6356.766 + z);
        let mut log = 101_325.0_f64.ln();
        for (k, (base, temperature, lapse)) in layers.into_iter().enumerate() {
            let top = layers.get(k + 1).map_or(f64::INFINITY, |next| next.0);
            let up = h.min(top) - base;
            let factor = 9.80665 * 28.9644 / 8.31432;
            log -= match lapse {
                0.0 => factor * up / temperature,
                _ => factor / lapse * ((temperature + lapse * up) / temperature).ln(),
            };
            if h <= top {
                break;
            }
        }
        log.exp()
    };
    let heights: Vec<f64> = (0..170).map(|k| 0.25 + 0.5 * f64::from(k)).collect();
    let lets: Vec<(String, String)> =
        heights.iter().enumerate().map(|(k, z)| (format!("p{k}"), format!("atmosphere::pressure({z} [km])"))).collect();
    let lets: Vec<(&str, String)> = lets.iter().map(|(name, text)| (name.as_str(), text.clone())).collect();
    let found = values("use std::atmosphere;", &lets);
    for (k, z) in heights.iter().enumerate() {
        near(found[&format!("p{k}")], exact(*z), 2e-4);
    }
}

#[test]
fn gravity_is_that_of_the_published_ellipsoid() {
    // WGS 84: normal gravity, without the turning of the Earth, at the equator and at the pole (semi-minor axis
    // 6356.7523142 km); harmonics above the second are left out, about 1e-5 of it.
    let turning = 7.292_115e-5_f64.powi(2) * 6_378_137.0;
    near(value("use std::gravity;", "norm(gravity::earth((6378.137, 0, 0) [km]))"), 9.780_325_335_9 + turning, 2e-5);
    near(value("use std::gravity;", "norm(gravity::earth((0, 0, 6356.7523142) [km]))"), 9.832_184_937_8, 2e-5);
    near(
        value("use std::gravity;", "norm(gravity::point((0, 7000, 0) [km], gravity::mu_earth))"),
        3.986_004_418e14 / 4.9e13,
        1e-14,
    );
    // Elsewhere it is the gradient of the potential mu / r (1 - J2 (a / r)^2 (3 sin^2 - 1) / 2), by differences.
    let potential = |r: [f64; 3]| {
        let d = r.iter().map(|x| x * x).sum::<f64>().sqrt();
        let sine = r[2] / d;
        3.986_004_418e14 / d * (1.0 - 1.082_629_82e-3 * (6_378_137.0 / d).powi(2) * (3.0 * sine * sine - 1.0) / 2.0)
    };
    let place = [4.0e6, 3.0e6, 5.0e6];
    for k in 0..3 {
        let moved = |by: f64| {
            let mut moved = place;
            moved[k] += by;
            potential(moved)
        };
        let slope = (moved(100.0) - moved(-100.0)) / 200.0;
        let along = ["(1, 0, 0)", "(0, 1, 0)", "(0, 0, 1)"][k];
        near(
            value("use std::gravity;", &format!("dot(gravity::earth((4000, 3000, 5000) [km]), {along})")),
            slope,
            1e-7,
        );
    }
}

#[test]
fn rotations_are_rotations() {
    let of = |text: &str| value("use std::rotation;\nuse std::rotation::{about_x, about_z};", text);
    let q = "(0.5, 0.1, -0.7, 0.5)"; // Of length 1.
    // Lengths stay, and a quaternion about an axis is the matrix about it.
    near(of(&format!("norm(rotation::matrix({q}) * (1, 2, 3))")), 14.0_f64.sqrt(), 1e-14);
    near(
        of("dot(rotation::matrix((cos(0.2), 0, 0, sin(0.2))) * (1, 2, 3), (4, 5, 6))"),
        of("dot(about_z(0.4) * (1, 2, 3), (4, 5, 6))"),
        1e-14,
    );
    near(
        of("dot(rotation::matrix((cos(0.2), sin(0.2), 0, 0)) * (1, 2, 3), (4, 5, 6))"),
        of("dot(about_x(0.4) * (1, 2, 3), (4, 5, 6))"),
        1e-14,
    );
    // The product of quaternions is the product of matrices, and the conjugate turns back.
    let p = "(0.8, 0, 0.6, 0)";
    let both = of(&format!("dot(rotation::matrix(rotation::product({p}, {q})) * (1, 2, 3), (4, 5, 6))"));
    near(both, of(&format!("dot(rotation::matrix({p}) * (rotation::matrix({q}) * (1, 2, 3)), (4, 5, 6))")), 1e-13);
    near(of(&format!("norm(rotation::product({q}, rotation::conjugate({q})) - (1, 0, 0, 0)) + 1")), 1.0, 1e-14);
    // Yaw, pitch, roll: the nose of a body that pitches up by 30 deg points up (third axis down).
    near(of("dot(rotation::euler(0, 30 [deg], 0) * (1, 0, 0), (0, 0, -1))"), 0.5, 1e-14);
    // The rate is that of the matrix: d/dt (R v) = R (w x v).
    let rate = of(&format!(
        "dot(rotation::matrix({q} + 1e-6 * rotation::rate({q}, (0.3, -0.2, 0.5))) * (1, 2, 3) - rotation::matrix({q}) * (1, 2, 3), (4, 5, 6)) / 1e-6"
    ));
    near(rate, of(&format!("dot(rotation::matrix({q}) * cross((0.3, -0.2, 0.5), (1, 2, 3)), (4, 5, 6))")), 1e-5);
}

#[test]
fn orbits_and_forces_of_the_air_are_those_of_handbooks() {
    let of = |text: &str| value("use std::orbit;\nuse std::gravity;\nuse std::aero;\nuse std::constants;", text);
    // A geostationary orbit: a sidereal day, 3.0747 km/s.
    near(of("orbit::period(42164.17 [km], gravity::mu_earth)"), 86164.1, 1e-6);
    near(of("orbit::circular_speed(42164.17 [km], gravity::mu_earth)"), 3074.66, 1e-6);
    near(of("orbit::escape_speed(gravity::radius_earth, gravity::mu_earth)"), 11_179.88, 1e-6);
    // At perigee of an ellipse with a = 24396 km, e = 0.7283 (a transfer to geostationary orbit).
    let state = "(6628, 0, 0) [km], (0, orbit::speed(6628 [km], 24396 [km], gravity::mu_earth), 0), gravity::mu_earth";
    near(of(&format!("orbit::semi_major_axis({state})")), 24_396e3, 1e-12);
    near(of(&format!("dot(orbit::eccentricity({state}), (1, 0, 0))")), 1.0 - 6628.0 / 24396.0, 1e-12);
    near(of("norm(orbit::momentum((6628, 0, 0) [km], (0, 10, 0) [km/s]))"), 6.628e10, 1e-14);
    // 100 m/s at the ground: 6125 Pa; a plate of 2 m^2 with coefficient 1.28.
    near(of("aero::dynamic_pressure(1.225, 100 [m/s])".replace("1.225", "1.225 [kg/m^3]").as_str()), 6125.0, 1e-14);
    near(of("norm(aero::drag(1.225 [kg/m^3], (60, 0, 80) [m/s], 2 [m^2], 1.28))"), 15_680.0, 1e-9);
    near(of("aero::stagnation(216.65 [K], 2)"), 389.97, 1e-12);
    near(of("aero::polar(0.5, 0.02, 0.04)"), 0.03, 1e-14);
    // 7.5 km/s at 4e-5 kg/m^3 into a nose of 0.5 m: 657 kW/m^2.
    near(of("aero::heating(4e-5 [kg/m^3], 7.5 [km/s], 0.5 [m])"), 657_130.0, 1e-4);
    near(of("constants::astronomical_unit / constants::speed_of_light"), 499.004_784, 1e-8);
}
