//! Long specs of the kinds that people write, to any number of lines: for the measurements of the language server and
//! for the tests that its work is in proportion to the text.
//!
//! All but the flight use libraries. Each has `param knob = 1;` on a line of its own, at which something may be typed.

use std::fmt::Write as _;

/// The line at which something is typed.
pub(crate) const KNOB: &str = "    param knob = 1;";

/// A kind of spec: what it is called, and the spec of about so many lines.
pub(crate) type Shape = (&'static str, fn(usize) -> String);

/// All kinds.
pub(crate) const SHAPES: &[Shape] = &[
    ("flight", flight),
    ("bodies", bodies),
    ("chain", chain),
    ("functions", functions),
    ("agents", agents),
    ("phases", phases),
    ("families", families),
    ("scenario", scenario),
];

/// `count` times the text of `piece`, with its number.
fn repeated(count: usize, piece: impl Fn(usize) -> String) -> String {
    (1..=count).map(piece).collect()
}

/// The low-observability flight with more named expressions and constraints.
fn flight(lines: usize) -> String {
    let flight = include_str!("../../../specs/low_observable.ntg")
        .replace("    param reach", "    param knob = 1;\n    param reach");
    let (before, after) = flight.rsplit_once("    trajectory {\n").expect("the spec has a trajectory");
    let count = lines.saturating_sub(flight.lines().count()) / 4;
    let more = repeated(count, |i| {
        format!(
            "    /// Distance from a radar of the net.\n    let slant_{i} [km] = hypot(x - {i} [km], y + 3 [km], altitude);\n    \
             let seen_{i} = logistic((slant_{i} / 1 [km] - log(slant_{i} / 7 [km]) * signature) / 0.1);\n"
        )
    });
    let limits = repeated(count, |i| format!("        hidden_{i}: seen_{i} <= 2;\n"));
    format!("{before}{more}    trajectory {{\n{limits}{after}")
}

/// Rockets with attitude, one beside the other in one agent: many states, vectors and equations of motion.
fn bodies(lines: usize) -> String {
    let count = (lines / 36).max(1);
    let mut text = String::from(
        "use std::aero;\nuse std::atmosphere;\nuse std::gravity;\nuse std::rotation::{matrix, rate};\n\n\
         problem Bodies {\n    duration T in 60 .. 600 [s];\n    collocation gauss(points = 3, intervals = 10);\n",
    );
    let _ = writeln!(text, "{KNOB}");
    text.push_str(&repeated(count, |k| {
        format!(
            "
    /// Place and speed of body {k} in a frame that does not turn.
    state r_{k}[3] [km], v_{k}[3] [km/s], m_{k} in 1 .. 20 [t];
    /// Its attitude and how it turns.
    state q_{k}[4] [1], w_{k}[3] [rad/s];
    input u_{k}[3] in -200 .. 200 [kN]: continuous;
    input torque_{k}[3] in -5 .. 5 [kN*m];
    param area_{k} = 3 [m^2];
    param inertia_{k}[3, 3] = ((20, 0, 0), (0, 20, 0), (0, 0, 4)) [t*m^2];
    param exhaust_{k} = 3 [km/s];
    param from_{k}[3] = (6400, {k}, 0) [km];
    let height_{k} [km] = norm(r_{k}) - gravity::radius_earth;
    let speed_{k} [km/s] = hypot(v_{k}, 1 [m/s]);
    let density_{k} [kg/m^3] = atmosphere::density(height_{k});
    let mach_{k} = speed_{k} / atmosphere::sound(height_{k});
    let pressure_{k} [kPa] = aero::dynamic_pressure(density_{k}, speed_{k});
    let drag_{k} [kN] = aero::drag(density_{k}, v_{k}, area_{k}, 0.3 + 0.1 * mach_{k} * knob);
    let turned_{k} = matrix(q_{k});
    let spin_{k} = inertia_{k} * w_{k};
    dynamics {{
        der(r_{k}) == v_{k};
        der(v_{k}) == gravity::earth(r_{k}) + (turned_{k} * u_{k} + drag_{k}) / m_{k};
        der(m_{k}) == -norm(u_{k}) / exhaust_{k};
        der(q_{k}) == rate(q_{k}, w_{k});
        der(spin_{k}) == torque_{k} - cross(w_{k}, spin_{k});
    }}
    initial {{ r_{k} == from_{k};  v_{k} == 0;  m_{k} == 20 [t];  q_{k} == (1, 0, 0, 0);  w_{k} == 0; }}
    trajectory {{
        pressure_limit_{k}: pressure_{k} <= 60 [kPa];
        heat_{k}: aero::heating(density_{k}, speed_{k}, 1 [m]) <= 500 [kW/m^2];
        norm(w_{k})^2 <= 0.1 [rad^2/s^2];
    }}
    final {{ height_{k} == 80 [km];  w_{k} == 0; }}
    guess {{ r_{k} = (6400 [km] + 80 [km] * tau, {k} [km], 0);  v_{k} = (0.5, 0, 0) [km/s];  m_{k} = 18 [t];  q_{k} = (1, 0, 0, 0);  u_{k} = (100, 0, 0) [kN]; }}
"
        )
    }));
    text.push_str(&repeated(count, |k| format!("    maximize left_{k}: final(m_{k}) / 1 [t];\n")));
    text + "}\n"
}

/// Named expressions that are made of one another, and whose derivatives are taken.
fn chain(lines: usize) -> String {
    let count = (lines.saturating_sub(30) / 3).max(2);
    let mut text = String::from(
        "use std::constants;\nuse std::atmosphere;\n\nproblem Chain {\n    duration T = 10 [s];\n    \
         output x, y [m]: spline(order = 6, intervals = 10);\n    state s [m];\n    \
         collocation gauss(points = 3, intervals = 10);\n",
    );
    let _ = writeln!(text, "{KNOB}");
    text.push_str(
        "    let a_1 [m/s] = der(x);\n    let b_1 [m] = y + atmosphere::density(x) * 1 [m^4/kg];\n    let c_1 = b_1 / a_1;\n",
    );
    text.push_str(&repeated(count - 1, |k| {
        let n = k + 1;
        // The chain begins anew now and then: nobody names hundreds of things that are made of one another.
        let before = if k % 8 == 0 { 1 } else { k };
        format!(
            "    let a_{n} [m/s] = a_{before} + 0.1 * (b_{before} - x) / constants::standard_gravity / 1 [s] * 1 [m/s^2];\n    \
             let b_{n} [m] = hypot(b_{before}, x, {n} [m]);\n    \
             let c_{n} [m/s^2] = der(a_{n}) * sin(knob) + b_{n} / 2 [s^2];\n"
        )
    }));
    let _ = writeln!(
        text,
        "    minimize integral(c_{count}^2 + der(x, 3)^2 * 1 [s^2] + der(y, 2)^2 + a_{count}^2 / 1 [s^2]) / 1 [m^2/s^3];"
    );
    text.push_str("    dynamics { der(s) == a_1; }\n    initial { x == 0;  der(x) == 1 [m/s];  y == 0;  s == 0; }\n");
    text.push_str("    trajectory {\n        a_2 <= 100 [m/s];\n    }\n    final { x == 10 [m];  y == 5 [m]; }\n}\n");
    text
}

/// Functions with steps that use one another and libraries, each used several times.
fn functions(lines: usize) -> String {
    let count = (lines.saturating_sub(30) / 8).max(2);
    let mut text = String::from(
        "use std::aero;\nuse std::atmosphere;\n\nproblem Functions {\n    duration T in 10 .. 100 [s];\n    \
         state h [km], v[3] [m/s], m in 1 .. 2 [t];\n    input f[3] in -10 .. 10 [kN]: continuous;\n    \
         collocation gauss(points = 3, intervals = 10);\n",
    );
    let _ = writeln!(text, "{KNOB}");
    text.push_str("    fn lift_1(h [m], v [m/s]) [N] = aero::dynamic_pressure(atmosphere::density(h), v) * 1 [m^2];\n");
    text.push_str(&repeated(count - 1, |k| {
        let n = k + 1;
        let before = if k % 6 == 0 { 1 } else { k };
        format!(
            "    /// Lift after model {n}.\n    fn lift_{n}(h [m], v [m/s]) [N] {{\n        \
             let mach = v / atmosphere::sound(h);\n        let round = if mach <= 1 smooth 0.2 {{ mach^2 }} else {{ mach }};\n        \
             lift_{before}(h, v) * (1 + {n} * round)\n    }}\n    let by_{n} [kN] = lift_{n}(h, hypot(v, {n} [m/s]));\n"
        )
    }));
    text.push_str("    maximize final(h) / 1 [km];\n    dynamics {\n        der(h) == v[3];\n");
    let _ = writeln!(text, "        der(v) == (f + (0, by_{count}, by_2) * knob) / m - (0, 0, 9.81) [m/s^2];");
    text.push_str("        der(m) == -norm(f) / 3 [km/s];\n    }\n    initial { h == 0;  v == 0;  m == 2 [t]; }\n    trajectory {\n");
    text.push_str(&repeated(count - 1, |k| format!("        by_{} <= 100 [kN];\n", k + 1)));
    text + "    }\n    final { v[3] == 0; }\n}\n"
}

/// Agents with phases of their own.
fn agents(lines: usize) -> String {
    let count = (lines / 38).max(1);
    let mut text = String::from("use std::atmosphere;\nuse std::aero;\n\nproblem Agents {\n");
    let _ = writeln!(text, "{KNOB}");
    text.push_str("    param mass = 900 [kg];\n    param area = 2 [m^2];\n");
    text.push_str(&repeated(count, |k| {
        format!(
            "
    /// Vehicle {k}.
    agent uav_{k}[i in 1 .. 3] {{
        start in 0 .. 600 [s];
        output x, y [km]: spline(order = 5, intervals = 8, smoothness = 3);
        state h in 0.1 .. 12 [km], fuel in 0 .. 400 [kg];
        input climb in -20 .. 20 [m/s]: continuous;
        collocation gauss(points = 3, intervals = 8);
        let speed [km/s] = hypot(der(x), der(y), climb, 1 [m/s]);
        let pressure [kPa] = aero::dynamic_pressure(atmosphere::density(h), speed);
        let drag [kN] = pressure * area * 0.03 * knob;
        let curvature [1/km] = (der(x) * der(y, 2) - der(y) * der(x, 2)) / (der(x)^2 + der(y)^2 + 1 [m^2/s^2])^1.5;
        phase out {{
            duration in 60 .. 900 [s];
            trajectory {{ speed <= 0.25 [km/s]; }}
        }}
        phase strike after out {{
            duration = 40 [s];
            let noise = speed^2 / 1 [km^2/s^2];
            trajectory {{ noise <= 0.1; }}
        }}
        phase home after strike {{
            duration in 60 .. 900 [s];
            jump fuel;
            trajectory {{ drag <= 3 [kN]; }}
        }}
        minimize effort_{k}: integral(der(speed)^2) / 1 [km^2/s^3] + 1e-3 [1/s] * (end(home) - start(out));
        dynamics {{
            der(h) == climb;
            der(fuel) == -(drag * speed + mass * 9.81 [m/s^2] * climb) / 10 [MJ/kg];
        }}
        initial {{ x == i * 1 [km];  y == 0;  speed == 0.1 [km/s];  h == 1 [km];  fuel == 400 [kg]; }}
        trajectory {{ turn: -1 <= 5 [km] * curvature <= 1; }}
        final {{ x == 0;  y == 50 [km]; }}
        guess {{ (x, y) through (i * 1 [km], 0), (20 [km], 20 [km]), (0, 50 [km]);  h = 2 [km]; }}
    }}
"
        )
    }));
    text + "    temporal { gap: end(uav_1[2]) - end(uav_1[1]) >= 10 [s]; }\n}\n"
}

/// Phases one after another, with states and limits common to all and of their own.
fn phases(lines: usize) -> String {
    let count = (lines.saturating_sub(35) / 13).max(2);
    let mut text = String::from(
        "use std::gravity;\nuse std::atmosphere;\n\nproblem Phases {\n    state r[3] [km], v[3] [km/s], m in 1 .. 300 [t];\n    \
         input aim[3] in -1 .. 1: continuous;\n    collocation gauss(points = 3, intervals = 5);\n",
    );
    let _ = writeln!(text, "{KNOB}");
    text.push_str(
        "    let height [km] = norm(r) - gravity::radius_earth;
    let rho [kg/m^3] = atmosphere::density(height);
    let speed [km/s] = hypot(v, 1 [m/s]);
    let drag [kN] = -0.5 * rho * 1 [m^2] * speed * v * knob;
    let load [m/s^2] = thrust / m;
    let mach = speed / atmosphere::sound(height);
    dynamics {
        der(r) == v;
        der(v) == gravity::earth(r) + (thrust * aim + drag) / m;
        der(m) == -thrust * norm(aim) / 3 [km/s];
    }
    trajectory { load <= 60 [m/s^2];  0.5 * rho * speed^2 <= 50 [kPa];  mach <= 30; }
",
    );
    text.push_str(&repeated(count, |k| {
        let after = if k == 1 { String::new() } else { format!(" after burn_{}", k - 1) };
        format!(
            "
    /// Stage {k}.
    phase burn_{k}{after} {{
        duration in 10 .. 200 [s];
        param full_{k} = 5 [MN];
        let thrust [kN] = full_{k} / {k};
        initial {{ m <= 300 [t]; }}
        trajectory {{
            steep_{k}: aim[1] >= -0.5;
            high_{k}: height >= -1 [km];
        }}
        guess {{ r = (6400 [km] + {k} [km] * tau, 0 [km], 0 [km]);  v = (0, 0, 1) [km/s];  m = 100 [t];  aim = (1, 0, 0); }}
    }}
"
        )
        .replace(&format!("        param full_{k} = 5 [MN];\n"), "")
        .replace(&format!("full_{k}"), "5 [MN]")
    }));
    text.push_str("    maximize final(m) / 1 [t];\n    initial { r == (6400, 0, 0) [km];  v == 0; }\n    final { height == 200 [km]; }\n}\n");
    text
}

/// Families of arrays: vectors, matrices, sums and loops in loops.
fn families(lines: usize) -> String {
    let count = (lines / 21).max(1);
    let mut text = String::from(
        "use std::rotation;\nuse std::constants;\n\nproblem Families {\n    const n = 6;\n    duration T in 1 .. 10 [s];\n    \
         collocation gauss(points = 3, intervals = 10);\n",
    );
    let _ = writeln!(text, "{KNOB}");
    text.push_str(&repeated(count, |k| {
        format!(
            "
    /// Joints of arm {k}, and the places of its links.
    output q_{k}[1 .. n]: spline(order = 5, intervals = 8);
    output p_{k}[n, 3] [m]: spline(order = 5, intervals = 8);
    param goal_{k}[n] = (1, 2, 1, 2, 1, 2);
    let R_{k}[i in 1 .. n] = rotation::about_z(q_{k}[i]);
    let w_{k}[i in 1 .. n, 3] [rad/s] = if i == 1 {{ (0, 0, der(q_{k}[1])) }} else {{ R_{k}[i] * w_{k}[i - 1] + (0, 0, der(q_{k}[i])) }};
    let torque_{k}[i in 1 .. n] [N*m] = 1 [kg*m^2] * der(q_{k}[i], 2) + sum(j in 1 .. n, 5 [N*m] * knob * (q_{k}[i] - q_{k}[j]));
    let near_{k}[i in 1 .. n] [m] = smooth_max(j in 1 .. n, norm(p_{k}[i] - (0, 0, j * 1 [m])), 0.1 [m]);
    minimize effort_{k}: sum(i in 1 .. n, integral(torque_{k}[i]^2)) / 1 [N^2*m^2*s];
    minimize sum(i in 1 .. n, integral(norm(der(p_{k}[i], 2))^2)) / 1 [m^2/s^3];
    initial {{ for i in 1 .. n {{ q_{k}[i] == 0;  der(q_{k}[i]) == 0;  p_{k}[i] == (0, 0, i * 1 [m]); }} }}
    trajectory {{
        for i in 1 .. n {{ norm(w_{k}[i])^2 <= 9 [rad^2/s^2];  near_{k}[i] <= 50 [m]; }}
        for i in 1 .. n {{ for j in i + 1 .. n {{ apart_{k}: norm(p_{k}[i] - p_{k}[j]) >= 0.1 [m]; }} }}
    }}
    final {{ q_{k} == goal_{k};  for i in 1 .. n {{ der(q_{k}[i]) == 0;  p_{k}[i, 1] == 1 [m]; }} }}
    guess {{ for i in 1 .. n {{ q_{k}[i] = goal_{k}[i] * tau; }} }}
"
        )
    }));
    text + "}\n"
}

/// Scenarios of many plants.
fn scenario(lines: usize) -> String {
    let count = (lines / 22).max(1);
    let mut text = String::from(
        "use std::constants;\nuse std::atmosphere;\n\nproblem Scenarios {\n    const S = 10;\n    duration T = 4 [s];\n    \
         collocation gauss(points = 4, intervals = 12);\n",
    );
    let _ = writeln!(text, "{KNOB}");
    text.push_str(&repeated(count, |k| {
        format!(
            "    variable worst_{k} in 0 .. 100;

    /// Plant {k}.
    scenario plant_{k}[k in 1 .. S] {{
        let stiffness [1/s^2] = 4 [1/s^2] * (0.7 + 0.6 * (k - 1) / (S - 1));
        state x[2] [m], h [km];
        input u[2] in -8 .. 8 [m/s^2]: continuous;
        shared u until 1 [s];
        let rho [kg/m^3] = atmosphere::density(h);
        dynamics {{
            der(x, 2) == u - stiffness * x * knob;
            der(h) == 1 [m/s] * rho / 1 [kg/m^3];
        }}
        minimize effort_{k}: 0.01 [s^3/m^2] * integral(norm(u)^2);
        initial {{ x == 0;  der(x) == 0;  h == 1 [km]; }}
        trajectory {{ norm(x)^2 <= 100 [m^2]; }}
        final {{ miss_{k}: (x[1] / 1 [m] - 1)^2 + 0.5 * (der(x[2]) / 1 [m/s])^2 <= worst_{k}; }}
        guess {{ x = (1, 0) [m] * tau;  u = (4, 0) [m/s^2]; }}
    }}
    minimize worst_{k};
"
        )
    }));
    text + "}\n"
}
