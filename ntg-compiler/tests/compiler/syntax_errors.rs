//! What a person reads for each mistake, word for word, and that one mistake does not hide the next.

use std::collections::BTreeSet;

use ntg_compiler::diagnostic::{Code, Diagnostics};
use ntg_compiler::source::Source;
use ntg_compiler::syntax::{parse, parse_expression, parse_quantity};

/// The findings of a text that is no spec, rendered.
#[track_caller]
fn errors(text: &str) -> String {
    let source = Source::new("spec.ntg", text);
    parse(&source).expect_err("this text must be refused").render(&source)
}

/// The same for statements inside a problem.
#[track_caller]
fn inside(body: &str) -> String {
    errors(&format!("problem P {{\n{body}\n}}"))
}

/// Code, line and column of each finding, and nothing else.
#[track_caller]
fn places(text: &str) -> Vec<String> {
    let source = Source::new("spec.ntg", text);
    let found: Diagnostics = parse(&source).expect_err("this text must be refused");
    let place = |start| source.place(start);
    found.iter().map(|f| format!("{} {}:{}", f.code, place(f.span.start).line, place(f.span.start).column)).collect()
}

macro_rules! messages {
    ($($name:ident: $text:expr;)*) => {
        $(#[test]
        fn $name() {
            insta::assert_snapshot!(stringify!($name), $text);
        })*
    };
}

messages! {
    numbers: inside("let a = 5s;\nlet a = 1_000;\nlet a = 0x1F;\nlet a = 1.;\nlet a = 1.e5;\nlet a = .5;\nlet a = 1.5.2;\nlet a = 2e;\nlet a = 3em;");
    numbers_with_points: inside("let a = 1e5.0;\nlet a = 1e5.;\nlet a = 2.5E-3.00;\nlet a = 2e0.5;\nlet a = 1.2e3.75;\nlet a = 1.e-5;\nlet a = 1.;");
    a_number_that_overflows: inside("let a = 1e400;");
    ranges_of_other_languages: inside("variable m in 1...2;\nvariable n in 1..=2;");
    primes: inside("let v = x';\nlet a = x'';\nlet s = 'text';");
    words_of_other_languages: inside("parameter m = 2;\nReal x;\nobjective: T;\nsubject_to x;\node x;\nstate r(3);\nstate r[1:3];\nstate r[3] m;\nlet a = u' * u;\nlet b = J \\ u;\nlet c = r[1](t - 1);\ninitial { r := 0; }");
    characters: inside("trajectory { x ≤ 1; x ≥ 1; x ≠ 1; x² == 1; }\nlet a = 30°;\nlet b = ∫x;\nlet c = a && b;\nlet d = x % 3;\nlet e = a − b;\nlet f = a\u{a0}+ b;\nlet g = 😀;\nlet h = a#b;\nlet i = !a;");
    strings: inside("table q(a) = linear from\"a.csv\";\ntable q(a) = linear from \"a.csv\"x;\ntable q(a) = linear from \"a\\b.csv\";");
    a_string_that_never_ends: inside("table q(a) = linear from \"a.csv;\nlet b = 1;");
    refused_comments: errors("//! one\nproblem P {\n/** two */ let a = 1;\n/*! three */\n}");
    a_comment_that_never_ends: errors("problem P { let a = 1;\n/* /* */\n}");
    documentation_of_nothing: inside("guess {\n/// one\nx = 1; }\nlet a = 1 +\n/// two\n2;\ntrajectory { x <= 1;\n/// three\n}\n/// four");
    names_that_cannot_be: inside("let _a = 1;\nlet _ = 1;\nlet self = 1;\nlet Self = 1;\nlet super = 1;\nlet crate = 1;");
    reserved_words_as_names: inside("let table = 1;\nparam start = 1;\nlet t = 1;\nlet if = 1;\noutput x, unit: spline(order = 3);\nfn f(in) = 1;\nphase final { }\nlet a = b * let;\nfinal { if: x == 1; }\nguess { use = 2; }");
    relations: inside("trajectory { x < 1; x > 1; x != 1; x = 1; x =< 1; x => 1; }");
    chains: inside("trajectory { a <= b >= c; a == b == c; a <= b == c; a <= b <= c <= d; }");
    an_expression_is_missing: inside("let a = ;\nlet b = x + ;\nlet c = x + * y;\nlet d = f();\nlet e = f(1,);\nlet g = +1;\nlet h = 2 ** 3;\nlet i = [1, 2];\nlet j = (1, 2);\nlet k = 5 km;");
    a_semicolon_is_missing: inside("let a = 1\nlet b = 2;\ninitial { x == 1 }\nfinal { x == 1\n  y == 1; }\nlet c = x // comment\n/// doc\nlet d = x let e = 1;\nphase p { duration = 5 [s] }\nlet f = 2");
    a_semicolon_is_missing_between_relations: inside("state x, z [m];\ninput speed [km/h];\ninitial { x == 0 z == 0; }\nfinal { speed <= 100 [km/h] z in 0 .. 1; }\ninitial { x == 0 der(z) == 0; }\nfinal { x == 2 m <= 3; }\nfinal { x == 2 km; }\nguess { x = 1 z = 2; }\ntrajectory { for i in 1 .. 3 { x == i z <= i; } }\nfinal { x == 2 z; }");
    deviations_of_other_languages: inside("measure { x ~ normal(3, 1); }\nmeasure { x == 3 ± 1; }\nmeasure { x == 3 sigma = 1 [cm]; }\nmeasure { x == 3 std 1 [cm]; }\nmeasure { for i in 1 .. 3 { x == seen[i] uncertainty 1 [cm]; } }");
    parentheses_that_are_never_closed: inside("let a = (1 + 2;\nlet b = f(x, [1;\nlet c = x[1;\nlet d = 1;");
    a_block_that_is_never_closed: errors("problem P {\n  trajectory {\n    a <= 1;\n  output x: spline(order = 3);\n  final { x == 1; }\n}");
    a_phase_that_is_never_closed: errors("problem P {\n  phase a { duration = 5;\n  phase b after a { duration = 5; }\n}");
    a_problem_that_is_never_closed: errors("problem P {\n  let a = 1;\n");
    brackets_that_close_nothing: inside("let a = 1);\nlet b = (1];\nlet c = 2;");
    a_brace_that_closes_nothing: errors("problem P { let a = 1; } }");
    nesting: inside(&format!("let a = {}1{};", "(".repeat(140), ")".repeat(140)));
    units: inside("let a = 5 [];\nlet b = 5 [k m];\nlet c = 5 [m^0.5];\nlet d = 5 [m^1/2];\nlet e = 5 [m^1000];\nlet f = (x) [km];\nlet g[1 .. N] = 3;\nlet h = 5 [m**2];");
    units_without_their_numbers: inside("param rho in 0 .. [kg/m^3];\nvariable a in 0 .. [kg/m^3];\nvariable b in 2 [m] .. [m];\nstate c in .. [m/s], d in [m] .. 3 [m];\nparam e = [m/s^2];\nduration T = [s];\nduration S in 1 .. [min];\ntrajectory { x <= [km]; v in 0 .. [km/h]; y == [deg] sigma 3 [deg]; }");
    lists_of_what_has_values: inside("variable a in 0 .. 1, b = 2;\nvariable c d;\nvariable e,;\nparam f, g = 1;\nparam h = 1, i = 2;\nconst j = 1, k = 2;\nlet l = 1, m = 2;\nlet n, o = 3;\nduration T, S = 3;\ncontinuation p, q = (1, 2);");
    lists_in_expressions: inside("let a = (1, 2) + 3;\nparam p[2] = 1, 2;\nlet b = (x, y) [km];");
    applications: inside("let a = der(x, 1, 2);\nlet b = sum(1);\nlet c = sin(i in 1 .. 2, x);\nlet d = end(3);\nlet e = partial(x, y);\nlet f = integral(1, x);\nlet g = smooth_max(i in 1 .. 2, x);\nlet h = max(i in 1 .. 2, x, y);\nlet k = initial(p, x, y);\nlet l = start;");
    conditions: inside("let a = if x <= 1 { 2 };\nlet b = if x < 1 { 2 } else { 3 };\nlet c = if (x <= 1) 2 else 3;\nlet d = if 0 <= x <= 1 { 2 } else { 3 };\nlet e = if x <= 1 and y <= 2 { 3 } else { 4 };\nlet f = if x { 1 } else { 2 };\nlet g = if x <= 1 { 2; } else { 3; };\nlet h = x <= 1 ? 2 : 3;\nlet i = if x <= 1 then 2 else 3;\nlet j = if x <= 1 { 2 } elseif x <= 2 { 3 } else { 4 };\nlet k = if not x <= 1 { 2 } else { 3 };\nlet l = if x = 1 { 2 } else { 3 };\nlet m = 2 * (if (x <= 1 { 2 } else { 3 });\nlet n = if x <= 1 smooth { 2 } else { 3 };\ntrajectory { if x <= 1 { y <= 2; } else { y <= 3; } }\nif x <= 1 { let o = 3; }");
    functions_with_steps: inside("fn f(x) = { let y = x; y };\nfn g(x) { let y = x; y; }\nfn h(x) { y = x; y }\nfn i(x) { let y = x; return y }\nfn j(x) { let y[k in 1 .. 3] = x; y }\nfn k(x: m) = x;\nfn l(x [m]): N = x;\nfn m(x) -> 3 = x;\nfn n(x) { }\nfn o(i in 1 .. 3) = i;\nlet p = 1;");
    settings: inside("output x: spline(ordr = 3, order = (1, 2), smoothness = 1, smoothness = 2, foo = 1);\ncollocation gaus;\ncollocation uniform(points = 3, breakpoints = 3);\ncollocation uniform(equalities = 3);\ntable f(x) = lineer { 0: 1; }\ntable f(x) = fit monotone { 0: 1; }\ntable f(x) = monotone(order = 3, extrapolate = never) { 0: 1; }");
    rows: inside("table f(x) = linear { 0: 1; 1 2; 3, 4; 5, 6: 7; 8: 9 }");
    guesses: inside("guess { (x, y) through (1, 2), (3); x == 1; x; 3 = x; let a = 1; x through; }");
    words_that_begin_no_statement: inside("trajctory { x <= 1; }\nvelocity = 3;\nx <= 3;\nfor i in 1 .. 3 { x == 1; }\nunit a = 3;\n3;\n;");
    statements_in_the_wrong_place: inside("trajectory { let a = 1; initial { x == 1; } }\nphase p { phase q { } agent a { } start = 1; }\nagent a { agent b { } }\njump x;\ncontinuous x up to 1;\nproblem Q { }");
    points_of_time: inside("at { x == 1; }\nat 2 [s] x == 1;\nat 2, 3 { x == 1; }\ntrajectory except { }\ntrajectory except start { }\ntrajectory from { }\ntrajectory from 1 until 2 { }\ntrajectory at 2 { }\nperiodic;\nperiodic x up 2;\nfinal { at 2 { } }\ninitial from 0 to 1 { x == 0; }\ndynamics to 1 { x == 0; }\ntrajectory { soft(): x <= 1; soft(cubic = 2): x <= 1; soft(1, 2): x <= 1; soft 3: x <= 1; soft(2) x <= 1; }");
    domains_and_scenarios: inside("domain;\ndomain s;\ndomain s = [m];\ndomain tau [m];\nscenario p { }\nscenario p[3] { }\nscenario p[k in 1 .. 3] weights q { }\nscenario p[k in 1 .. 3] weight { }\nscenario q[k in 1 .. 3] { const a = 1; param b = 1; table f(x) = linear { 0: 1; } fn g(x) = x; duration 5; start = 1; phase r { } agent s { } scenario u[i in 1 .. 2] { } jump x; continuous x up to 1; collocation gauss(points = 3); domain w; continuation c = (1, 2); problem v { } }\nshared u;\nphase a { shared u; domain s; scenario p[k in 1 .. 3] { } }\nagent b { domain s; }\nscenario v[k in 1 .. 3] { shared; shared u till 3; shared u until; shared u[1], w until 2 * 3; }");
    declarations: inside("output x;\noutput x: splin(order = 3);\noutput x[3]: spline(order = 3);\nduration 5;\nlet a == 3;\nconst 3 = x;\nfn f = 3;\nminimize a = b;\nphase p x { }\ntable f() = linear { }\nvariable v in ..;\nvariable v in 1;\ntrajectory { x; for i 1 .. 3 { x <= ; } }\ncontinuous x to 1;");
    no_problem: errors("// nothing\n");
    two_problems: errors("problem P { }\nproblem Q { }");
    no_problem_but_statements: errors("let a = 1;");
    a_problem_without_a_name_or_brace: errors("problem { let a = 1 }") + "\n\n" + &errors("problem P let a = 1;");
    long_lines_are_cut: inside(&format!("let a = {} x' {};", "x + ".repeat(60), "+ x".repeat(60)));
}

#[test]
fn every_code_of_the_syntax_is_reached() {
    let texts = [
        "let a = ;",
        "let a = 1 let b = 2;",
        "let a = (1;",
        "let a = 1);",
        "let a = 5s;",
        "let a = 1e999;",
        "let a = x';",
        "table f(x) = linear from\"a\";",
        "//! x",
        "let _x = 1;",
        "let in = 1;",
        "trajectory { x < 1; }",
        "trajectory { a <= b >= c; }",
        "variable x in 1...2;",
        "collocation foo;",
        "jump x;",
        "let a = 1 [m^x];",
        "} problem Q {",
    ];
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    for body in texts.iter().map(|text| (*text).to_owned()).chain([format!("let a = {}1;", "-".repeat(200))]) {
        let source = Source::new("spec.ntg", format!("problem P {{ {body}\n}}"));
        seen.extend(parse(&source).expect_err("each is a mistake").iter().map(|finding| finding.code.text()));
    }
    let syntax = Code::ALL.iter().map(|code| code.text()).filter(|text| *text < "E020" && text.starts_with('E'));
    assert_eq!(seen, syntax.collect());
}

#[test]
fn each_broken_statement_is_found_and_the_good_ones_are_not_blamed() {
    let text = "problem P {
  let a = 1 +;
  let b = 2;
  phase one {
    duration = ;
    trajectory { x <= ; y <= 2; for i in 1 .. { z == 1; z = 1; } w << 1; }
    let c = 3
    let d = (4;
  }
  guess { x = ; y = 1; }
  table f(x) = linear { 0: 1; 1: ; 2: 3; }
  let e = 5;
}";
    let wanted = [
        "E001 2:14",
        "E001 5:16",
        "E001 6:23",
        "E001 6:47",
        "E013 6:59",
        "E001 6:69",
        "E002 7:14",
        "E003 8:13",
        "E001 10:15",
        "E001 11:34",
    ];
    assert_eq!(places(text), wanted);
}

#[test]
fn a_missing_semicolon_is_reported_behind_its_own_statement() {
    assert_eq!(places("problem P {\n  let a = x   // comment\n\n  // more\n  let b = 2;\n}"), ["E002 2:12"]);
    assert_eq!(places("problem P {\n  final { x == 1   }\n}"), ["E002 2:17"]);
    assert_eq!(places("problem P {\n  let a = 1\n}"), ["E002 2:12"]);
}

#[test]
fn an_operator_at_the_beginning_of_a_line_goes_on_with_the_statement() {
    assert!(parse(&Source::new("s", "problem P { let a = b\n + c\n - d; }")).is_ok());
}

#[test]
fn columns_count_characters_and_the_byte_order_mark_none() {
    assert_eq!(places("\u{feff}problem P { let ẋẋ = 5s; }"), ["E006 1:22"]); // `ẋ` here is one character.
    assert_eq!(places("problem P {\r\n  let a = 5s;\r\n}"), ["E006 2:11"]);
}

#[test]
fn what_comes_from_the_command_line_is_refused_in_the_same_words() {
    let source = Source::new("v_max", "250 m/s");
    insta::assert_snapshot!("command_line_quantity", parse_quantity(&source).expect_err("no quantity").render(&source));
    let source = Source::new("objective", "z^2 +");
    insta::assert_snapshot!(
        "command_line_expression",
        parse_expression(&source).expect_err("no expression").render(&source)
    );
}

#[test]
fn line_breaks_of_windows_and_tabs_are_shown_as_blanks() {
    insta::assert_snapshot!(errors("problem P {\r\n\tlet a = ;\r\n}"));
}

#[test]
fn colour_adds_only_colour() {
    let source = Source::new("spec.ntg", "problem P { let a = ; }");
    let found = parse(&source).expect_err("a mistake");
    let coloured = found.render_with(&source, true);
    let mut plain = String::new();
    let mut rest = coloured.as_str();
    while let Some((before, after)) = rest.split_once('\u{1b}') {
        plain.push_str(before);
        rest = after.split_once('m').map_or("", |(_, rest)| rest);
    }
    assert_ne!(coloured, found.render(&source));
    assert_eq!(plain + rest, found.render(&source));
}
