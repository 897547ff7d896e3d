//! The mistakes of people who come from CasADi, MATLAB, Modelica, JuMP, Dymos, acados or GPOPS, and what is said of each: docs/mistakes.md
//! is made of this table, and is held against it.
//!
//! `NTG_MISTAKES=write cargo test -p ntg-compiler --test compiler mistakes` writes the page anew: read the difference.

use std::fmt::Write as _;

use crate::mistakes_codes::{MEANING, NOTES, Section};
use crate::mistakes_words::WORDS;
use crate::model_support::Files;
use ntg_compiler::diagnostic::{Diagnostic, Severity};
use ntg_compiler::source::Source;

/// The problem that mistakes stand in, right without them.
const GOOD: &str = "problem Flight {
    const n = 3;
    duration T in 1 .. 60 [s];
    state r[3] [m], v[3] [m/s], m in 1 .. 2 [kg];
    input u[3] [N];
    output x, y [m]: spline(order = 5, intervals = 4);
    output w[3] [rad/s]: spline(order = 5, intervals = 4);
    collocation gauss(points = 3, intervals = 4);
    param A[3, 3] = ((1, 0, 0), (0, 1, 0), (0, 0, 1));
    param J[3, 3] = ((2, 0, 0), (0, 3, 0), (0, 0, 4)) [kg*m^2];
    param limit = 5 [m/s];
    fn half(a) = a / 2;
    minimize integral(norm(u)^2 / 1 [N^2*s] + norm(w)^2 * 1 [s]);
    dynamics { der(r) == v;  der(v) == u / m;  der(m) == -norm(u) / 3 [km/s]; }
    initial { r == 0;  v == 0;  m == 2 [kg];  x == 0;  y == 0; }
    final { x == 10 [m]; }
    HERE
}";

/// The equations of the good problem, in whose place those of a mistake may stand.
const EQUATIONS: &str = "dynamics { der(r) == v;  der(v) == u / m;  der(m) == -norm(u) / 3 [km/s]; }";

/// What is written, where it stands in the problem (`EQUATIONS` or an item), and the code.
const MISTAKES: &[Section] = &[
    (
        "Derivatives",
        &[
            ("let a = x';", "E008"),
            ("let a = 0.5 * x'^2;", "E008"),
            ("let a = x''(0);", "E008"),
            ("let a = x'(T);", "E008"),
            ("let a = xdot;", "E020"),
            ("let a = x_dot;", "E020"),
            ("let a = xddot;", "E020"),
            ("let a = dx;", "E020"),
            ("let a = dx/dt;", "E020"),
            ("let a = diff(x);", "E024"),
            ("let a = ddt(x);", "E024"),
            ("let a = dot(x);", "E025"),
            ("let a = der(der(x), 2, 3);", "E001"),
            ("let a = der(x, n / 2);", "E027"),
            ("trajectory { der(x, 7) <= 1; }", "E054"),
            ("let a = der(x, t);", "E064"),
            ("let a = deriv(x, t);", "E024"),
            ("let a = der x;", "E001"),
            ("let a = ẏ;", "E020"),
            ("trajectory { r.x <= 1 [m]; }", "E080"),
            ("let a = Pi * x;", "E020"),
            ("param a 120;", "E001"),
            ("let a = d/dt(x);", "E020"),
            ("let a = dx_dt;", "E020"),
            ("let a = ddx;", "E020"),
            ("let a = der2(x);", "E024"),
            ("let a = der(x)(0);", "E001"),
            ("der(x) = v;", "E001"),
            ("ẋ == v;", "E017"),
            ("d(x)/dt == v;", "E017"),
        ],
    ),
    (
        "Functions of time",
        &[
            ("let a = x(t);", "E024"),
            ("initial { x(0) == 0; }", "E024"),
            ("final { x(T) == 1 [m]; }", "E024"),
            ("minimize x^2;", "E050"),
            ("minimize fuel = integral(x);", "E001"),
            ("minimize integral(x^2, 0, T) / 1 [m^2*s];", "E001"),
            ("trajectory { final(x) <= 1 [m]; }", "E052"),
            ("param a = x;", "E029"),
            ("temporal { x <= 3 [m]; }", "E050"),
            ("initial { x(t0) == 0; }", "E024"),
            ("minimize tf;", "E020"),
            ("minimize duration;", "E001"),
            ("let a = sin(time);", "E020"),
            ("maximize x.final / 1 [m];", "E012"),
            ("initial: x == 0;", "E001"),
            ("at t = 3 [s] { x == 1 [m]; }", "E001"),
            ("start { x == 1 [m]; }", "E001"),
            ("end { x == 1 [m]; }", "E001"),
            ("at_end { x == 1 [m]; }", "E001"),
            ("begin { x == 1 [m]; }", "E001"),
            ("terminal: x == 1 [m];", "E017"),
            ("x(0) == 0;", "E017"),
            ("x(T) = 1 [m];", "E017"),
            ("always { x <= 11 [m]; }", "E001"),
            ("at end { x == 1 [m]; }", "E001"),
            ("at start { x == 1 [m]; }", "E001"),
            ("at { x == 1 [m]; }", "E001"),
            ("at 3 [s]: x == 1 [m];", "E001"),
            ("at 3 [s], 4 [s] { x == 1 [m]; }", "E001"),
            ("at t >= 3 [s] { x == 1 [m]; }", "E001"),
            ("at x == 3 [m] { y == 1 [m]; }", "E001"),
            ("at(T / 2, x) == 1 [m];", "E001"),
            ("final { final: x == 1 [m]; }", "E012"),
            ("trajectory { trajectory: x <= 1 [m]; }", "E012"),
            ("minimize duration: T;", "E012"),
            ("final { r(T) == 3 [m]; }", "E024"),
            ("initial { r(0) == 0; }", "E024"),
            ("let a = x(3 [s]);", "E024"),
            ("let a = x(T / 2);", "E024"),
            ("let z = x * y;  temporal { z(T) <= 3 [m^2]; }", "E024"),
            ("final { x(end) == 0; }", "E001"),
            ("initial { x0 == 0; }", "E020"),
            ("final { x_f == 0; }", "E020"),
            ("initial { x[0] == 0; }", "E026"),
            ("final { x[T] == 0; }", "E026"),
            ("let a = integral(x, t);", "E080"),
        ],
    ),
    (
        "Vectors and matrices",
        &[
            ("let a = A.T * r;", "E080"),
            ("let a = A' * r;", "E008"),
            ("param a[3] = [1, 0, 0];", "E001"),
            ("param a[3] = {1, 0, 0};", "E001"),
            ("let a = v * v;", "E046"),
            ("let a = v^2;", "E047"),
            ("let a = v .* v;", "E001"),
            ("let a = A @ r;", "E008"),
            ("let a = r + 1 [m];", "E046"),
            ("let a = cross((1, 0), (0, 1));", "E046"),
            ("let a = r(1);", "E024"),
            ("let a = r[0];", "E028"),
            ("let a = r[4];", "E028"),
            ("let a = norm(r[1, 3]);", "E026"),
            ("const N = 3; let g[N] = 3;", "E044"),
            ("let a = r[:, 1];", "E001"),
            ("let a = r[1:2];", "E001"),
            ("let a = r[end];", "E001"),
            ("trajectory { r(:) >= 0; }", "E001"),
            ("initial { r == (1, 2, 3); }", "E041"),
            ("initial { r == (1 [m], 2, 3); }", "E048"),
            ("param a[3] = ones(3, 1);", "E024"),
            ("let a = A[1][2];", "E001"),
            ("let a = [1; 2; 3];", "E001"),
            ("let a = [x; r[1] 3];", "E001"),
            ("let a = dot([x; y], r);", "E001"),
            ("let a = foo + r; let b = a[1] + 2 [m]; let c = a + r;", "E020"),
            ("let a = inv(A) * r;", "E024"),
            ("let a = mtimes(A, r);", "E024"),
            ("let a = eye(3);", "E024"),
            ("let a = vertcat(x, y);", "E024"),
            ("let a = norm(r, 2);", "E025"),
            ("let a = (x, der(x));", "E048"),
            ("let a = r * A;", "E046"),
            ("let a = abs(r);", "E047"),
            ("let g[1 .. 3] = 3;", "E046"),
            ("let z[i] = r[i];", "E040"),
            ("let z[i in 3] = r[i];", "E018"),
            ("let z = for i in 1 .. 3 { r[i] };", "E012"),
            ("let z = (r[i] for i in 1 .. 3);", "E001"),
            ("let z = [r[i] for i in 1 .. 3];", "E001"),
            ("let z[] = r;", "E001"),
            ("let a = transpose(rotation::matrix((1, 0, 0, 0))) * r;", "E024"),
        ],
    ),
    (
        "Units",
        &[
            ("final { y == 5; }", "E041"),
            ("final { r == (1, 2, 3); }", "E041"),
            ("trajectory { J * der(w) == cross(r, u) + 1; }", "E046"),
            ("param I = 2 [kg*m2];", "E040"),
            ("param I = 2 [kgm^2];", "E040"),
            ("param a = 30 [degree];", "E040"),
            ("param a = 3 m/s;", "E001"),
            ("param a = 30 [°];", "E008"),
            ("let a = x + T;", "E041"),
            ("let a = sin(x);", "E042"),
            ("let a = exp(x);", "E042"),
            ("let a [m] = der(x);", "E044"),
            ("trajectory { x in 0 .. 5 [s]; }", "E041"),
            ("param a[3] = (1 [m], 2 [m/s], 0);", "E041"),
            ("let a = x^m;", "E042"),
            ("trajectory { x^2 >= 0.2^2 [m^2]; }", "E042"),
            ("let a = sind(30);", "E024"),
            ("let a = clip(x / 1 [m], -1, 1);", "E024"),
            ("trajectory { integral(x^2) <= 3 [m^2*s]; }", "E052"),
            ("let a = (2 * n, 0, 0) [m] + r;", "E048"),
            ("param a [kg] = 1;", "E027"),
            ("param a: kg = 1;", "E001"),
            ("param a = \"1 kg\";", "E001"),
            ("param a = 1 (kg);", "E001"),
            ("param a = 9.81 * [m/s^2];", "E001"),
            ("param a = 9.81 [m/s**2];", "E018"),
            ("param a = 2 [N.m];", "E018"),
            ("param a = 20 [degC];", "E040"),
            ("param hot = 300 [K];  let a = hot - 27 [C];", "E041"),
            ("param a = 9,81 [m];", "E001"),
            ("let a = x [km];", "E026"),
            ("let a = v [m/s];", "E026"),
            ("let a = norm(v) [m/s];", "E001"),
            ("let a = norm(v) in [km/h];", "E001"),
            ("let a = 3 [m] [s];", "E001"),
            ("let a = [m/s] 3;", "E001"),
            ("let a = m * [N];", "E001"),
            ("const a [m] = 8;", "E027"),
            ("trajectory { x in 0 .. [km]; }", "E001"),
            ("param rho = [kg/m^3];", "E001"),
            ("param a = 3 [Kmol];", "E040"),
            ("param a = 22 [mOhm];", "E040"),
            ("param a = 22 [mΩ];", "E040"),
            ("param a = 5 [m·s];", "E008"),
            ("param a = 5 [pounds];", "E040"),
            ("param a = 5 [slug];", "E040"),
            ("param a = 5 [in];", "E040"),
            ("param a = 3 [g0];", "E040"),
            ("param a = 3 [kgf];", "E040"),
            ("param a = 3 [rps];", "E040"),
            ("param a = 1 [year];", "E040"),
            ("param a = 30 [grad];", "E040"),
            ("param a = 3 [dB];", "E040"),
            ("trajectory { der(x, 2) <= 3 [g]; }", "E041"),
            ("let a [g] = der(x, 2);", "E044"),
            ("param a = 20 [°C];", "E008"),
            ("param a = 20 [°/s];", "E008"),
            ("param a = 3 [10^3*m];", "E018"),
            ("param a = 3 [];", "E018"),
            ("let a [m/s] = der(x) * (x / 10)^(1/7);", "E044"),
            (
                "output z [parsec]: spline(order = 5, intervals = 4); trajectory { z <= 3 [m]; der(z) <= 1 [m/s]; }",
                "E040",
            ),
        ],
    ),
    (
        "Signs and words",
        &[
            ("final { y = 0; }", "E013"),
            ("trajectory { x < 5 [m]; }", "E013"),
            ("trajectory { x =< 5 [m]; }", "E013"),
            ("trajectory { x != 5 [m]; }", "E013"),
            ("trajectory { x ≤ 5 [m]; }", "E008"),
            ("trajectory { x ⩽ 5 [m]; }", "E008"),
            ("trajectory { x ≈ 0; }", "E008"),
            ("trajectory { x === 0; }", "E001"),
            ("trajectory { x <> 0; }", "E001"),
            ("trajectory { x, y <= 20 [m]; }", "E001"),
            ("trajectory { x; }", "E001"),
            ("trajectory { x == ; }", "E001"),
            ("trajectory { x between 0 and 1; }", "E001"),
            ("trajectory { x <= 5 [m] && y <= 5 [m]; }", "E008"),
            ("let a == x;", "E001"),
            ("let a := x;", "E001"),
            ("let a = x**2;", "E001"),
            ("let a = .5 * x;", "E006"),
            ("let a = 1_000 * x;", "E006"),
            ("let a = x ? y : x;", "E008"),
            ("let a = x 2;", "E001"),
            ("let a = (x)(y);", "E001"),
            ("let a = sin x;", "E001"),
            ("let a = sin^2(2);", "E001"),
            ("let a = exp^2;", "E020"),
            ("let a = sqr(x);", "E024"),
            ("let a = step(x);", "E024"),
            ("let a = x % 2;", "E008"),
            ("subject to { x <= 5 [m]; }", "E001"),
            ("subject_to(x <= 5 [m]);", "E017"),
            ("constraints { x <= 5 [m]; }", "E001"),
            ("s.t. { x <= 5 [m]; }", "E001"),
            ("require { x <= 5 [m]; }", "E001"),
            ("minimize T subject to x <= 5 [m];", "E001"),
            ("minimise integral(x^2) / 1 [m^2*s];", "E001"),
            ("parameter a = 1;", "E001"),
            ("control c in -1 .. 1;", "E001"),
            ("var a in 0 .. 1;", "E001"),
            ("equation der(x) == y;", "E017"),
            ("import std::gravity;", "E001"),
            ("from std import gravity;", "E001"),
            ("import numpy as np;", "E001"),
            ("let a = np.sin(1);", "E001"),
            ("let a = math.pi;", "E012"),
            ("let a = about_x(1);", "E024"),
            ("let a = x / earth_radius;", "E020"),
            ("let mu_earths = 1;  let a = mu_earth;", "E020"),
            ("fn periods(a) = a;  let a = period(1, 2);", "E024"),
            ("@constraint(model, x <= 5 [m]);", "E008"),
            ("N = 20;", "E001"),
            ("solver ipopt;", "E001"),
            ("opti.minimize(T);", "E001"),
            ("m.Obj(x^2);", "E001"),
            ("x1 = SX.sym(1, 3);", "E001"),
            ("phase.add_state('z', units='m');", "E008"),
            ("cost = integral(x^2);", "E001"),
            ("minimize: T;", "E001"),
            ("minimize integral(x^2) dt;", "E001"),
            ("minimize mayer(T) + lagrange(x);", "E024"),
            ("path { x <= 1 [m]; }", "E001"),
            ("tf in 1 .. 60 [s];", "E001"),
            ("t in [0, T], time;", "E001"),
            ("let mut z = x;", "E001"),
            ("param = 3;", "E001"),
            ("param p = ;", "E001"),
            ("minimize T + ;", "E001"),
            ("minimize { x; }", "E001"),
            ("minimize T / 1 [s], 2 * m / 1 [kg];", "E001"),
            ("trajectory { x <= 5 [m], y <= 5 [m]; }", "E001"),
            ("trajectory { x <= 5 [m] and y <= 5 [m]; }", "E001"),
            ("let a = x > 1 [m];", "E001"),
            ("let a = true;", "E020"),
            ("let a(b) = b^2;", "E001"),
            ("let a = x", "E002"),
            ("let a = x;  let b = a y;", "E001"),
            ("% the mass\n    param a = 1;", "E008"),
            ("# the mass\n    param a = 1;", "E008"),
            ("let pi = 3.14;", "E012"),
            ("param t = 3;", "E012"),
            ("let sin = x;", "E022"),
            ("let x = 2;", "E021"),
        ],
    ),
    (
        "Sums, loops and conditions",
        &[
            ("let a = sum(i in 1:3, r[i]);", "E001"),
            ("let a = sum(i in 1 .. 3);", "E001"),
            ("let a = sum(r[i], i, 1, 3);", "E025"),
            ("let a = sum(r[i] for i in 1:3);", "E001"),
            ("trajectory { if x <= 1 [m] { y <= 1 [m]; } }", "E001"),
            ("trajectory { y >= 0 if x <= 1 [m]; }", "E001"),
            ("trajectory { for i = 1:3 { r[i] >= 0; } }", "E001"),
            ("trajectory { for i in range(3) { r[i] >= 0; } }", "E001"),
            ("trajectory { for i in 2 { r[i] >= 0; } }", "E001"),
            ("trajectory { for i in n { r[i] >= 0; } }", "E001"),
            ("trajectory { for i in 1 to 3 { r[i] >= 0; } }", "E001"),
            ("trajectory { for i in (1 .. 3) { r[i] >= 0; } }", "E001"),
            ("trajectory { for (i in 1 .. 3) { r[i] >= 0; } }", "E001"),
            ("trajectory { for (i = 1; i <= 3; i++) { r[i] >= 0; } }", "E001"),
            ("trajectory { for each i in 1 .. 3 { r[i] >= 0; } }", "E001"),
            ("trajectory { for i in 1 .. n, j in 1 .. n { r[i] >= 0; } }", "E001"),
            ("trajectory { for i in 1 .. n: r[i] >= 0; }", "E001"),
            ("trajectory { r[i] >= 0 for i in 1 .. 3; }", "E001"),
            ("trajectory { forall i in 1 .. 3 { r[i] >= 0; } }", "E001"),
            ("let a = if x <= 1 [m] then 1 else 2;", "E001"),
            ("let a = if x <= 1 [m] { 1 };", "E001"),
            ("let a = if_else(x, 1, 2);", "E024"),
            ("let a = r[i];", "E020"),
            ("trajectory { if t >= 6 [s] { x in 0 .. 1 [m]; } }", "E001"),
            ("temporal { mean(x) <= 1 [m]; }", "E024"),
            ("let a = interp2(x, y);", "E024"),
            ("fn f(a) = return a;", "E001"),
            ("trajectory { for i in {1,2,3} { r[i] >= 0; } }", "E001"),
            ("trajectory { for i in 1, 2, 3 { r[i] >= 0; } }", "E001"),
            ("guess { for i in {1,2,3} { r[i] = tau * 1 [m]; } }", "E001"),
            ("let a = sum(i in {1,2,3}, r[i]);", "E001"),
            ("let z[i in {1, 2, 3}] = r[i];", "E001"),
            ("phase leg[i in {1,2}] { duration = 1 [s]; }", "E001"),
            ("let a = sum{i in 1 .. 3} r[i];", "E001"),
            ("let a = sum(i = 1:3, r[i]);", "E001"),
            ("let a = max(r[i] for i in 1 .. 3);", "E001"),
            ("trajectory { for i in 1 .. 3 do r[i] >= 0; end }", "E001"),
            ("trajectory { for i in 1 .. 3 loop r[i] >= 0; end for; }", "E001"),
            ("trajectory { while x <= 3 [m] { y >= 0; } }", "E001"),
            ("trajectory { for i in 1 .. length(r) { r[i] >= 0; } }", "E024"),
            ("trajectory { x <= 1 [m] when t >= 3 [s]; }", "E001"),
            ("trajectory { x <= 1 [m] on [2 [s], 3 [s]]; }", "E001"),
            ("trajectory { x <= 1 [m] during [2 [s], 3 [s]]; }", "E001"),
            ("trajectory { x <= 1 [m] until 3 [s]; }", "E001"),
            ("trajectory { x <= 1 [m] for t in 0 .. 3 [s]; }", "E001"),
            ("trajectory on [2, 3] [s] { x <= 1 [m]; }", "E001"),
            ("trajectory during 2 [s] .. 3 [s] { x <= 1 [m]; }", "E001"),
            ("during 2 .. 3 [s] { x <= 1 [m]; }", "E001"),
            ("fn f(a): a^2;", "E001"),
            ("fn f(a) => a^2;", "E001"),
            ("fn f(a, b = 2) = a;", "E001"),
            ("f = lambda a: a^2;", "E001"),
            ("function f(a) = a;", "E001"),
        ],
    ),
    (
        "Dynamics, bounds and splines",
        &[
            ("dynamics { der(r) == v;  der(v) == u / m; }", "E068"),
            ("dynamics { der(r) == v;  der(v) == u / m;  der(m) == -norm(u) / 3 [km/s];  der(x) == 0; }", "E068"),
            ("dynamics { der(r) == v;  der(v) == u;  der(m) == -norm(u) / 3 [km/s]; }", "E041"),
            ("dynamics { der(r) = v;  der(v) == u / m;  der(m) == -norm(u) / 3 [km/s]; }", "E013"),
            ("dynamics { der(r) == v;  der(v) == u / m;  m <= 2 [kg]; }", "E068"),
            ("state z;", "E068"),
            ("output z [m];", "E001"),
            ("output z: spline(5, 4);", "E001"),
            ("output z: spline(degree = 4, intervals = 4);", "E016"),
            ("variable z = 3;", "E001"),
            ("variable z in [0, 1];", "E001"),
            ("variable z in (0, 1);", "E001"),
            ("input z in (-2, 2) [N*m];", "E001"),
            ("input -1 <= z <= 1;", "E001"),
            ("input z bounds -1 .. 1;", "E001"),
            ("duration T = free;", "E021"),
            ("variable z in [0, inf];", "E001"),
            ("variable z in 0 .. inf;", "E020"),
            ("variable z = 0 .. 1;", "E001"),
            ("variable z >= 0;", "E001"),
            ("trajectory { y in [-1, 1] [km]; }", "E001"),
            ("param z in 0 .. 1;", "E001"),
            ("param p, q = 1;", "E001"),
            ("param p = 1, q = 2;", "E001"),
            ("variable p, q = 2;", "E001"),
            ("variable p in 0 .. 1 q in 0 .. 2;", "E001"),
            ("variable p, q in 0 .. 10 [m], s [m/s];", "E096"),
            ("state z = 0;", "E001"),
            ("state z(start = 0);", "E001"),
            ("state z: 0 .. 3;", "E001"),
            ("input z: piecewise_constant;", "E001"),
            ("input z : real;", "E001"),
            ("state real z;", "E001"),
            ("state vector z[3];", "E001"),
            ("param a : real = 1;", "E001"),
            ("state z[3], q[3] = 0;", "E001"),
            ("variable z: 0 .. 1;", "E001"),
            ("state z: continuous;", "E001"),
            ("duration S = 1 .. 9 [s];", "E001"),
            ("duration S;", "E001"),
            ("duration S [s] in 1 .. 20;", "E001"),
            ("duration S in 1 to 20 [s];", "E001"),
            ("duration S in 1 .. 20, R in 2 .. 3;", "E001"),
            ("phase coast { duration in -1 .. 20 [s]; }", "E060"),
            ("let z;", "E001"),
            ("let z in 0 .. 3;", "E001"),
            ("let (z, q) = (1, 2);", "E001"),
            ("trajectory { rail: soft(3): x <= 11 [m]; }", "E001"),
            ("trajectory { x <= 11 [m] soft 3; }", "E001"),
            ("trajectory { soft(x <= 11 [m]); }", "E001"),
            ("soft { x <= 11 [m]; }", "E001"),
            ("measure { at(T / 2, x) - 3 [m] sigma 1 [cm]; }", "E001"),
            ("estimate { x == 3 [m]; }", "E001"),
            ("measure at(T / 2, x) == 3 [m] sigma 1 [m];", "E001"),
            ("collocation gauss(3, 20);", "E001"),
            ("const k = 2.5;  output z[1 .. k]: spline(order = 4, intervals = 2);", "E027"),
            ("phase coast follows boost { }", "E001"),
            ("table drag(a) = { 0: 1;  2: 3; }", "E001"),
            ("table drag(a) = linear { 0: 1, 2: 3 }", "E001"),
            ("table drag(a) = interp1((0, 2), (1, 3));", "E001"),
            ("table drag(a even [deg]) = linear { -30: 1;  0: 1; }", "E073"),
            ("table drag(a [deg], v [m/s]) = linear { 0: 1, 2;  30: 3, 4; }", "E071"),
            ("dynamics { r == v;  der(v) == u / m;  der(m) == -norm(u) / 3 [km/s]; }", "E041"),
            ("periodic;", "E001"),
            ("state z [m] periodic;", "E001"),
            ("output z: periodic spline(order = 5, intervals = 4);", "E001"),
            ("output z: spline(order = 5, intervals = 4, periodic = 1);", "E016"),
            ("input z: periodic;", "E001"),
            ("periodic(x);", "E001"),
            ("periodic der(x);", "E012"),
            ("periodic x up 1;", "E001"),
            ("trajectory { periodic x; }", "E001"),
            ("table drag(a [deg] periodic) = linear { 0: 1;  360: 1; }", "E001"),
            ("cyclic x;", "E001"),
            ("input c: held in 0 .. 1;", "E001"),
            ("phase coast { in 1 .. 9 [s]; }", "E001"),
            ("guess { x = [0, 1]; }", "E001"),
            ("guess { x = 0 .. 1; }", "E001"),
            ("guess { x, y through (0, 0), (1, 2) [m]; }", "E001"),
            ("output [p, q] [m]: spline(order = 5, intervals = 4);", "E001"),
            ("terminal { x == 1 [m]; }", "E001"),
            ("let a = x.dot;", "E080"),
            ("minimize T + 0.01 * integral(norm(u)^2) / 1 [N^2*s];", "E041"),
            ("final { x == 11 [m]; }", "E057"),
            ("param a = sqrt(-1);", "E032"),
            ("guess { x = linspace(0, 1, 5); }", "E024"),
            ("guess { x = 1 [m];  x = 2 [m]; }", "E021"),
            ("guess { T = -5 [s]; }", "E060"),
            ("guess { x in 0 .. 1 [m]; }", "E001"),
            ("guess { der(x) = 1 [m/s]; }", "E001"),
            ("guess x = 1 [m];", "E001"),
            ("initial_guess { x = 1 [m]; }", "E001"),
        ],
    ),
];

fn files() -> Files {
    let two = ("two.csv", "1, 2\n3, 4\n5, 6\n");
    Files(vec![two, ("a.ntg", "use \"b.ntg\"; const k = 1;"), ("b.ntg", "use \"a.ntg\"; const l = 1;")])
}

/// The sections of the page.
pub(crate) fn sections() -> impl Iterator<Item = &'static Section> {
    MISTAKES.iter().chain([&WORDS, &MEANING, &NOTES])
}

fn found(spec: &str) -> Vec<Diagnostic> {
    match ntg_compiler::check_with(&Source::new("spec.ntg", spec), &files(), &[]) {
        Ok((_, notes)) => notes,
        Err(found) => found.into_iter().collect(),
    }
}

/// The problem with a mistake in it, or the whole problem that is one.
fn with(written: &str) -> String {
    match written.split([' ', '{']).next() {
        Some("problem") => written.to_owned(),
        Some("dynamics") => GOOD.replace(EQUATIONS, written).replace("HERE", ""),
        Some("use") => format!("{written}\n{}", GOOD.replace("HERE", "")),
        _ => GOOD.replace("HERE", written),
    }
}

/// The first error of a mistake, or the note that it is there for.
fn first(written: &str, code: &str) -> Option<Diagnostic> {
    let note = code.starts_with('N');
    let meant =
        |finding: &Diagnostic| if note { finding.code.text() == code } else { finding.severity == Severity::Error };
    found(&with(written)).into_iter().find(meant)
}

fn page() -> String {
    let mut page = String::from(
        "# Mistakes of newcomers\n\nWhat people write who come from CasADi, MATLAB, Modelica, JuMP, Dymos, acados or GPOPS, and what ntg says of it.\n\
         This page is made by a test, so the words are those of the compiler.\n\
         [coming-from.md](coming-from.md) puts whole problems side by side; [errors.md](errors.md) explains the codes.\n",
    );
    for (title, mistakes) in sections() {
        let _ = write!(page, "\n## {title}\n\n| written | said | help |\n|---|---|---|\n");
        for (written, code) in *mistakes {
            let Some(finding) = first(written, code) else { continue };
            let cell = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|");
            let (code, message) = (finding.code.text(), cell(&finding.message));
            let help = finding.help.as_deref().map(cell).unwrap_or_default();
            let _ = writeln!(page, "| `{}` | {code}: {message} | {help} |", cell(written));
        }
    }
    page
}

#[test]
fn the_problem_around_is_right() {
    let found = found(&GOOD.replace("HERE", ""));
    assert!(found.iter().all(|finding| finding.severity != Severity::Error), "{found:?}");
}

#[test]
fn every_mistake_has_the_code_of_the_table_and_a_place() {
    let mut wrong = String::new();
    let mistakes: Vec<&(&str, &str)> = sections().flat_map(|(_, mistakes)| *mistakes).collect();
    assert!(mistakes.len() >= 150);
    for (written, code) in mistakes {
        let Some(finding) = first(written, code) else {
            let _ = writeln!(wrong, "{written}: nothing is said");
            continue;
        };
        let spec = with(written);
        let own = if written.starts_with("dynamics") { spec.find("dynamics") } else { spec.find(written) };
        let after = own.is_some_and(|own| finding.span.start as usize >= own) || written.starts_with("dynamics");
        if finding.code.text() != *code || finding.help.is_none() || !after {
            let _ = writeln!(wrong, "{written}: {} {} | {:?}", finding.code.text(), finding.message, finding.help);
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

/// Mistakes that are told with more than one error: of two names.
const SEVERAL: &[&str] = &["let a = dx/dt;", "let a = d/dt(x);"];

#[test]
fn one_mistake_is_told_once() {
    let mut several = String::new();
    for (written, code) in sections().flat_map(|(_, mistakes)| *mistakes) {
        let found = found(&with(written));
        let errors: Vec<&Diagnostic> = found.iter().filter(|finding| finding.severity == Severity::Error).collect();
        if (errors.len() > 1) != SEVERAL.contains(written) || (code.starts_with('N') && !errors.is_empty()) {
            let messages: Vec<&str> = errors.iter().map(|finding| finding.message.as_str()).collect();
            let _ = writeln!(several, "{written}: {messages:?}");
        }
    }
    assert!(several.is_empty(), "\n{several}");
}

#[test]
fn the_page_says_what_the_compiler_says() {
    let path = format!("{}/../docs/mistakes.md", env!("CARGO_MANIFEST_DIR"));
    let page = page();
    if std::env::var_os("NTG_MISTAKES").is_some_and(|word| word == "write") {
        std::fs::write(&path, &page).expect("the page can be written");
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == page, "docs/mistakes.md is not what the compiler says: see the head of this test");
}

#[test]
fn libraries_in_a_circle_are_named() {
    let found = found(&format!("use \"a.ntg\";\n{}", GOOD.replace("HERE", "")));
    assert_eq!(found[0].code.text(), "E087");
    assert!(found[0].message.contains("circle"), "{}", found[0].message);
}
