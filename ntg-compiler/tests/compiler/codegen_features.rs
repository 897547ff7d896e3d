//! Each feature of the language as Rust, by the smallest spec that shows it.
//!
//! The first line of each snapshot is the spec; below it stands the part of the generated code in
//! which the feature shows.

use ntg_compiler::codegen::generate;
use ntg_compiler::compile;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;

/// One table file.
struct Files;

impl Loader for Files {
    fn load(&self, path: &str) -> Result<String, String> {
        if path == "drag.csv" {
            Ok("# Mach, coefficient\n0, 0.2\n1, 0.5\n2, 0.4\n".into())
        } else {
            Err("no such file".into())
        }
    }
}

/// The generated code of `problem P { items }`, formatted.
#[track_caller]
fn expand(items: &str) -> String {
    let source = Source::new("p.ntg", format!("problem P {{\n{items}\n}}"));
    let compiled = compile(&source, &Files).unwrap_or_else(|found| panic!("{}", found.render(&source)));
    let tokens = generate(&compiled.program);
    prettyplease::unparse(&syn::parse2(tokens).expect("generated code parses as Rust"))
}

/// The items that begin with one of `starts`, each up to the line that closes it.
#[track_caller]
fn shown(items: &str, starts: &[&str]) -> String {
    let text = expand(items);
    let lines: Vec<&str> = text.lines().collect();
    let mut shown = format!("{items}\n");
    for start in starts {
        let first = lines.iter().position(|line| line.trim_start().starts_with(start));
        let first = first.unwrap_or_else(|| panic!("no `{start}` in\n{text}"));
        let indent = lines[first].len() - lines[first].trim_start().len();
        let closing = ["}", "};", "];"].map(|end| format!("{}{end}", " ".repeat(indent)));
        let ends = |line: &&str| closing.iter().any(|closing| closing == line);
        let last = match lines[first].ends_with(';') {
            true => first,
            false => first + lines[first..].iter().position(ends).expect("the item ends"),
        };
        shown.push('\n');
        lines[first..=last].iter().for_each(|line| {
            shown.push_str(line.get(indent..).unwrap_or(line));
            shown.push('\n');
        });
    }
    shown
}

/// Snapshots: a name that is the claim, a spec, and what is shown.
macro_rules! snapshots {
    ($($name:ident: $spec:expr => [$($start:expr),+];)*) => {
        $(#[test] fn $name() {
            insta::assert_snapshot!(shown($spec, &[$($start),+]));
        })*
    };
}

snapshots! {
    a_time_derivative_is_one_in_scaled_time_over_the_duration:
        "duration T in 1 .. 9; output x: spline(order = 4, intervals = 1); minimize integral(der(x, 2)^2);"
        => ["mod kernels"];
    a_fixed_duration_is_data_and_not_differentiated:
        "duration T = 5; output x: spline(order = 4, intervals = 1); minimize integral(der(x)^2);"
        => ["static GROUPS", "mod kernels"];
    units_are_folded_into_the_numbers:
        "duration T = 2 [min]; output x [km]: spline(order = 4, intervals = 1); minimize integral(der(x)^2); \
         trajectory { der(x) <= 36 [km/h]; }"
        => ["static PHASES", "mod kernels"];
    a_parameter_is_a_field_and_an_input:
        "duration T = 1 [s]; param v = 0.25 [km/s]; output x [km]: spline(order = 4, intervals = 1); minimize integral((der(x) - v)^2);"
        => ["pub struct P {", "impl ::core::default::Default", "fn update(&self", "mod kernels"];
    an_array_of_parameters_is_indexed_from_one:
        "duration T = 1; param a[3] = (1, 2, 4); output x[1 .. 3]: spline(order = 3, intervals = 1); \
         minimize sum(i in 1 .. 3, integral((x[i] - a[i])^2));"
        => ["pub struct P {", "fn update(&self", "static GROUPS"];
    a_variable_has_bounds_and_a_method:
        "duration T = 1 [s]; variable m in 1 .. 5 [kg]; output x: spline(order = 3, intervals = 1); minimize m / 1 [kg] + integral(x^2) / 1 [s];"
        => ["static VARIABLES", "pub fn m(&self)"];
    an_array_of_outputs_is_a_family:
        "duration T = 1; output x[1 .. 3]: spline(order = 3, intervals = 1); minimize integral(x[1]^2); \
         trajectory { for i in 1 .. 2 { x[i] <= x[i + 1]; } }"
        => ["pub struct PSolution", "fn new(", "static GROUPS"];
    a_sum_is_a_reduction_over_one_kernel:
        "duration T = 1; output x[1 .. 9]: spline(order = 3, intervals = 1); \
         minimize integral(sum(i in 1 .. 9, x[i]^2)^2);"
        => ["static GROUPS", "mod kernels"];
    a_function_is_inlined:
        "duration T = 1; output x: spline(order = 3, intervals = 1); fn bump(u, w) = 1 / (1 + exp(-u / w)); \
         minimize integral(bump(x, 2) * x);"
        => ["mod kernels"];
    a_named_expression_is_a_method_and_a_kernel:
        "duration T = 1 [s]; output x [km]: spline(order = 4, intervals = 1); /// How fast.\nlet speed [km/s] = abs(der(x)); \
         minimize integral(x^2);"
        => ["pub fn speed(&self)", "static NAMED"];
    a_table_is_evaluated_with_its_exact_derivatives:
        "duration T = 1; output x: spline(order = 3, intervals = 1); table f(s) = monotone { 0: 1; 1: 2; 3: 5; } \
         minimize integral(f(x)^2);"
        => ["static TABLES", "mod kernels"];
    a_table_from_a_file_is_data_in_the_code:
        "duration T = 1; output x: spline(order = 3, intervals = 1); table drag(mach) = linear from \"drag.csv\"; \
         minimize integral(drag(x)^2);"
        => ["static TABLES"];
    a_replaceable_table_is_a_field:
        "duration T = 1 [s]; output x: spline(order = 3, intervals = 1); param table f(s [m]) [km] = linear { 0: 1; 1: 2; } \
         minimize integral((f(x * 1 [m]) / 1 [m])^2);"
        => ["pub struct P {", "pub struct FTable", "fn update(&self"];
    a_double_bound_is_one_row_with_two_bounds:
        "duration T = 1; param a = 2; output x: spline(order = 3, intervals = 1); minimize integral(x^2); \
         trajectory { band: -a <= x * a <= 3 * a; }"
        => ["static GROUPS", "static CONSTRAINTS", "pub fn multiplier_band"];
    the_four_blocks_have_their_domains:
        "duration T in 1 .. 2; output x: spline(order = 3, intervals = 1); minimize integral(x^2); \
         initial { x == 1; } trajectory { x >= -1; } final { x == 2; } temporal { integral(x) <= 3; }"
        => ["static GROUPS"];
    uniform_collocation_has_its_own_points:
        "duration T = 1; output x: spline(order = 3, intervals = 2); collocation uniform(breakpoints = 41); minimize integral(x^2);"
        => ["static PHASES"];
    an_integral_that_enters_nonlinearly_is_a_variable:
        "duration T = 1; output x: spline(order = 3, intervals = 1); minimize integral(x)^2 + integral(x^2);"
        => ["static INTEGRALS", "static GROUPS"];
    maximize_negates_the_kernel_and_says_so:
        "duration T = 1; output x: spline(order = 3, intervals = 1); maximize gain: integral(x - x^2);"
        => ["pub(super) static STRUCTURE", "mod kernels"];
    a_guess_is_a_route_or_an_expression:
        "param via = 2; duration T in 1 .. 9; output x, y, z: spline(order = 3, intervals = 1); \
         minimize integral(x^2 + y^2 + z^2); \
         guess { (x, y) through (0, 0), (1, via), (3, 0); z = 1 - tau; T = 4; }"
        => ["static GUESSES"];
    a_continuation_declares_a_parameter:
        "duration T = 1 [s]; output x: spline(order = 3, intervals = 1); continuation width = (20, 5, 1) [deg]; \
         minimize integral((x - width)^2);"
        => ["pub struct P {", "static CONTINUATIONS"];
    what_may_fail_is_probed:
        "duration T = 1; output x: spline(order = 3, intervals = 1); minimize integral(sqrt(x) + 1 / x);"
        => ["mod kernels"];
    a_partial_derivative_is_taken_at_its_argument:
        "duration T = 1; output x: spline(order = 3, intervals = 1); fn f(s, w) = s^3 * w; minimize integral(partial(f(x, 2), x)^2);"
        => ["mod kernels"];
    phases_nest_in_the_solution_and_share_their_kernels:
        "output x: spline(order = 4, intervals = 1); minimize integral(der(x, 2)^2); \
         phase a { duration d in 1 .. 2; } phase b after a { duration d in 1 .. 2; }"
        => ["pub struct PSolution", "static PHASES", "static GROUPS"];
    a_family_of_phases_is_one_phase_with_members:
        "param gate[3] = (1, 3, 2); output x: spline(order = 4, intervals = 1); minimize integral(der(x, 2)^2); \
         phase leg[i in 1 .. 3] after leg[i - 1] { duration d in 1 .. 2; final { x == gate[i]; } }"
        => ["impl PSolution", "impl PLeg", "static PHASES", "static GROUPS"];
    a_phase_has_its_own_spline_and_a_jump_lifts_continuity:
        "output x, y: spline(order = 4, intervals = 2); minimize integral(der(x, 2)^2 + y^2); phase a { duration = 1; } \
         phase b after a { duration = 1; output x: spline(order = 3, intervals = 1); jump y; continuous x up to 0; }"
        => ["static PHASES", "static CONSTRAINTS"];
    a_phase_may_have_its_own_points_and_outputs:
        "output x: spline(order = 4, intervals = 2); minimize integral(der(x, 2)^2); phase a { duration = 1; } \
         phase b after a { duration = 1; collocation gauss(points = 4, equalities = 3); \
         output e: spline(order = 4, intervals = 2, smoothness = 1); initial { e == 0; } trajectory { der(e) == x^2; } final { e <= 3; } }"
        => ["static PHASES", "static GROUPS"];
    time_and_scaled_time_are_those_of_the_agent_and_the_phase:
        "output x: spline(order = 4, intervals = 1); minimize integral((x - t)^2 + tau * x); \
         phase a { duration in 1 .. 2; } phase b after a { duration in 1 .. 2; }"
        => ["mod kernels", "static GROUPS"];
    a_template_is_resolved_in_each_phase:
        "output x: spline(order = 4, intervals = 1); minimize integral(force^2); let force = mass * der(x, 2); \
         phase a { duration = 1; let mass = 2; } phase b after a { duration in 1 .. 2; let mass = 2 - t / 10; }"
        => ["static NAMED"];
    a_family_of_agents_has_one_start_each:
        "agent uav[i in 1 .. 3] { start in 0 .. 60 [s]; duration T in 1 .. 9 [s]; output x [m]: spline(order = 4, intervals = 1); \
         let gone = integral(x); minimize integral(der(x, 2)^2); }"
        => ["static AGENTS", "impl PSolution", "impl PUav", "static NAMED"];
    a_fixed_start_is_data:
        "agent one { start = 10 [s]; duration T in 1 .. 9 [s]; output x [m]: spline(order = 4, intervals = 1); minimize integral(t * der(x, 2)^2); } \
         agent two { start = one_s; duration T = 5 [s]; output x [m]: spline(order = 4, intervals = 1); minimize integral(t * der(x, 2)^2); } \
         param one_s = 3 [s];"
        => ["static AGENTS"];
    numbers_of_a_phase_are_named_by_its_path:
        "output x: spline(order = 4, intervals = 1); minimize integral(der(x, 2)^2); variable v in 1 .. 2; \
         phase a { duration D in 1 .. 2; let late = 2 * D; } phase b after a { duration in 1 .. 2; } \
         temporal { a.D <= v; a.late >= duration(b); }"
        => ["static GROUPS"];
    event_times_meet_in_temporal:
        "agent a { output x: spline(order = 4, intervals = 1); minimize integral(der(x, 2)^2); \
         phase p { duration in 1 .. 2; } phase q after p { duration in 1 .. 2; } } \
         agent b { start in 0 .. 9; duration T in 1 .. 2; output x: spline(order = 4, intervals = 1); minimize integral(x^2); } \
         temporal { start(b) == end(a.p); wait: end(a) - b.T in 0 .. 3; }"
        => ["static GROUPS"];
    boundary_values_and_totals_are_those_of_their_path:
        "agent a[i in 1 .. 2] { duration T in 1 .. 2; output x: spline(order = 4, intervals = 1); minimize integral(x^2); } \
         temporal { initial(a[2], x) == final(a[1], 2 * x); integral(a[1], x) <= 3; }"
        => ["static GROUPS"];
    a_duration_beside_phases_is_their_sum:
        "output x: spline(order = 4, intervals = 1); duration T in 3 .. 4; minimize integral(x^2) + T; \
         phase leg[i in 1 .. 3] after leg[i - 1] { duration in 1 .. 2; }"
        => ["static GROUPS", "static AGENTS"];
    guesses_name_phases_agents_and_starts:
        "agent a[i in 1 .. 2] { start in 0 .. 5; output x, y: spline(order = 3, intervals = 1); minimize integral(x^2 + y^2); \
         phase p { duration in 1 .. 9; guess { x = tau; } } phase q after p { duration in 1 .. 9; } \
         guess { (x, y) through (0, 0), (i, 1); duration(p) = 4; start = i; } } \
         guess { duration(a[1].q) = 5; for i in 1 .. 2 { a[i].y = tau; } }"
        => ["static GUESSES"];
}

#[test]
fn the_same_spec_gives_the_same_bytes() {
    let spec = "param a[2] = (1, 2); duration T in 1 .. 9; output x, y: spline(order = 5, intervals = 3); \
                let r = hypot(x, y); minimize integral(r^2 + exp(x) * a[1]); trajectory { sin(r) <= a[2]; }";
    assert_eq!(expand(spec), expand(spec));
}

#[test]
fn size_grows_with_formulas_and_not_with_intervals_or_members() {
    let of_size = |intervals: usize, members: usize| {
        let spec = format!(
            "const N = {members}; duration T = 1; output x[1 .. N]: spline(order = 4, intervals = {intervals}); \
             minimize sum(i in 1 .. N, integral(der(x[i])^2)); trajectory {{ for i in 1 .. N - 1 {{ x[i] <= x[i + 1]; }} }}"
        );
        generate(
            &compile(&Source::new("p.ntg", format!("problem P {{ {spec} }}")), &Files).expect("it compiles").program,
        )
        .to_string()
        .split_whitespace()
        .count()
    };
    assert_eq!(of_size(8, 5), of_size(80, 500));
}
