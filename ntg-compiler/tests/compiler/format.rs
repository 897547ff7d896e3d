//! The canonical layout: nothing but white space changes, twice is once, and every shipped spec has it.

use std::fs;
use std::path::{Path, PathBuf};

use ntg_compiler::source::Source;
use ntg_compiler::syntax::{WIDTH, comments, format, parse};
use proptest::prelude::*;

const EVERYTHING: &str = include_str!("../syntax_specs/everything.ntg");

#[track_caller]
fn formatted(text: &str) -> String {
    let source = Source::new("spec.ntg", text);
    format(&source).unwrap_or_else(|found| panic!("{}\n{text}", found.render(&source)))
}

/// The words of a spec's comments, without the white space that a layout may change.
fn remarks(text: &str) -> Vec<String> {
    let all = comments(&Source::new("spec.ntg", text));
    all.into_iter().map(|comment| comment.text.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

/// What must hold for any spec that parses.
#[track_caller]
fn assert_lawful(text: &str) {
    let once = formatted(text);
    let (before, after) = (Source::new("s", text), Source::new("s", once.as_str()));
    let parsed = |source: &Source| parse(source).map(|spec| spec.without_spans());
    assert_eq!(parsed(&before), parsed(&after), "the meaning changed:\n{text}\n----\n{once}");
    assert_eq!(remarks(text), remarks(&once), "comments changed:\n{text}\n----\n{once}");
    let twice = formatted(&once);
    let differing = once.lines().zip(twice.lines()).position(|(a, b)| a != b);
    let around =
        |text: &str| text.lines().skip(differing.unwrap_or(0).saturating_sub(2)).take(6).collect::<Vec<_>>().join("\n");
    assert!(once == twice, "twice is not once:\n{}\n----\n{}", around(&once), around(&twice));
    assert!(once.ends_with("}\n") || !comments(&after).is_empty(), "{once}");
    assert!(!once.contains("\n\n\n") && !once.starts_with('\n'), "{once}");
    assert!(once.lines().all(|line| line.trim_end() == line), "{once}");
}

/// All `.ntg` files below a folder of the repository.
fn specs(folder: &str) -> Vec<PathBuf> {
    let mut found = vec![];
    let mut open = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder)];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
            let path = entry.expect("a readable folder").path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "ntg") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn every_shipped_spec_has_the_canonical_layout() {
    let specs = specs("specs");
    assert!(specs.len() >= 6, "{specs:?}");
    for path in specs {
        let text = fs::read_to_string(&path).expect("a readable spec");
        assert_eq!(formatted(&text), text, "run `ntg fmt {}`", path.display());
        assert_lawful(&text);
    }
}

#[test]
fn every_spec_of_the_tests_that_parses_keeps_its_meaning_and_its_comments() {
    let mut seen = 0;
    for folder in ["ntg-compiler/tests", "tests"] {
        for path in specs(folder) {
            let text = fs::read_to_string(&path).expect("a readable spec");
            if parse(&Source::new("s", text.as_str())).is_ok() {
                assert_lawful(&text);
                seen += 1;
            }
        }
    }
    assert!(seen > 50, "{seen}");
}

#[test]
fn a_spec_that_does_not_parse_has_no_layout() {
    let source = Source::new("spec.ntg", "problem P { let a = ; output x: spline(order = 3, intervals = 1) }");
    let found = format(&source).expect_err("two mistakes");
    assert_eq!(found.iter().count(), 2);
}

#[track_caller]
fn assert_layout(text: &str, expected: &str) {
    assert_eq!(formatted(text), expected);
    assert_lawful(text);
}

#[test]
fn blanks_and_line_breaks_are_those_of_the_language() {
    assert_layout(
        "problem P{const N=3;param a [ N ]=( 1,2 ,- 3 )[ km / s ^ 2 ];\n\n\n\noutput x[1..N],y [km]:spline(order=5);variable a ,b[2]in 0.. 1[kg];let v=- der( x [1],2 )* ( 2 ^ - 3 - 1..2 );}"
            .replace(" - 1..2", "")
            .as_str(),
        "problem P {
    const N = 3;
    param a[N] = (1, 2, -3) [km/s^2];

    output x[1 .. N], y [km]: spline(order = 5);
    variable a, b[2] in 0 .. 1 [kg];
    let v = -der(x[1], 2) * (2^-3);
}
",
    );
}

#[test]
fn no_blank_follows_a_parenthesis_that_opens() {
    assert_layout(
        "problem P {
    let a = 3 * (b - ( if t <= 1 { 0 } else { c })) + sum(i in 1 .. 2, ( if i == 1 { 0 } else { d[i] }));
}
",
        "problem P {
    let a = 3 * (b - (if t <= 1 { 0 } else { c })) + sum(i in 1 .. 2, (if i == 1 { 0 } else { d[i] }));
}
",
    );
}

#[test]
fn places_parts_and_prices_read_as_they_are_spoken() {
    assert_layout(
        "problem P {
at 2.5[s]{x==3[m];}
at T/2{ y == 1; }
trajectory from 0.4*T to T-1[s]{quiet:x<=1;}
trajectory except initial,final { x >= 0; }
periodic x,y[2] up to 1;
trajectory { soft( 200[1/s] ):rail:x in -1..1;
soft(linear=1,square = 2): x<=1; soft:x<=2; }
temporal { at( T/3,x )<=2; }
}",
        "problem P {
    at 2.5 [s]                           { x == 3 [m]; }
    at T / 2                             { y == 1; }
    trajectory from 0.4 * T to T - 1 [s] { quiet: x <= 1; }
    trajectory except initial, final     { x >= 0; }
    periodic x, y[2] up to 1;
    trajectory {
        soft(200 [1/s]): rail: x in -1 .. 1;
        soft(linear = 1, square = 2): x <= 1;  soft: x <= 2;
    }
    temporal { at(T / 3, x) <= 2; }
}
",
    );
}

#[test]
fn domains_and_scenarios_read_as_they_are_spoken() {
    assert_layout(
        "problem P{domain   s[m];duration S=1 [m];scenario plant [ k in 1..S ]weight p[ k ]{state x[m];shared u,w[1]
          until 1[m];final{x<=k;}}
          scenario b[k in 1..2]{output y:spline(order=3);}  scenario longer[k in 1..2] weight 0.5 {output z:spline(order=3);} }",
        "problem P {
    domain s [m];
    duration S = 1 [m];
    scenario plant[k in 1 .. S] weight p[k] {
        state x [m];
        shared u, w[1] until 1 [m];
        final { x <= k; }
    }
    scenario b[k in 1 .. 2]                 { output y: spline(order = 3); }
    scenario longer[k in 1 .. 2] weight 0.5 { output z: spline(order = 3); }
}
",
    );
}

#[test]
fn blocks_stay_on_one_line_or_on_several_as_their_author_wrote_them() {
    assert_layout(
        "problem P {
  initial{x==1;der(x)==0;}
  final { x == 2 ; }
  trajectory {
     x <= 1; y <= 1;
     for i in 1..3 {x<=i;}
     y>=0; }
  guess {}
}",
        "problem P {
    initial { x == 1;  der(x) == 0; }
    final   { x == 2; }
    trajectory {
        x <= 1;  y <= 1;
        for i in 1 .. 3 { x <= i; }
        y >= 0;
    }
    guess { }
}
",
    );
}

#[test]
fn statements_side_by_side_stand_under_one_another() {
    assert_layout(
        "problem P { initial {
    x == 0 [m]; der(x) == 8 [m/s]; der(x, 2) == 0;
    y == -2 [m]; der(y) == 0; der(y, 2) == 0;
    } }",
        "problem P {
    initial {
        x == 0 [m];   der(x) == 8 [m/s];  der(x, 2) == 0;
        y == -2 [m];  der(y) == 0;        der(y, 2) == 0;
    }
}
",
    );
}

#[test]
fn phases_and_terms_of_the_objective_are_columns() {
    assert_layout(
        "problem P {
    phase up { duration = 1; }
    phase cruise after up { duration = 1; }
    minimize time: T;
    minimize effort [kg]: integral(u^2);
}",
        "problem P {
    phase up              { duration = 1; }
    phase cruise after up { duration = 1; }
    minimize time:        T;
    minimize effort [kg]: integral(u^2);
}
",
    );
}

#[test]
fn rows_of_a_table_are_columns() {
    assert_layout(
        "problem P { param table f(a even [deg],b)[kN]=monotone{
   0,30,180; // nodes
   0:1.5,2,3.25;
  90 :-6.5,2e3,1;
}
table g(s)=linear{0:1;5:2;}
table h(s)=linear from \"h.csv\";
}",
        "problem P {
    param table f(a even [deg], b) [kN] = monotone {
               0,  30,  180;  // nodes
         0:  1.5,   2, 3.25;
        90: -6.5, 2e3,    1;
    }
    table g(s) = linear { 0: 1; 5: 2; }
    table h(s) = linear from \"h.csv\";
}
",
    );
}

#[test]
fn comments_stay_where_they_are() {
    assert_layout(
        "// A licence.

/// What it is.
problem P { // opened
      // above
  const a = 1;   // one
  const long_name = 1; /* two */  // three
                       // goes on
  /* a block
     of two lines */
  let b = a // why
     + 1; /* c */ let d = 2;

  let e = 1 // behind the semicolon
  ;
  // the last
} // closed
// after",
        "// A licence.

/// What it is.
problem P {  // opened
    // above
    const a = 1;          // one
    const long_name = 1;  /* two */ // three
                          // goes on
    /* a block
       of two lines */
    let b = a // why
        + 1;
    /* c */ let d = 2;

    let e = 1;  // behind the semicolon
    // the last
}  // closed
// after
",
    );
}

#[test]
fn comments_between_the_lines_of_a_documentation_stay_comments() {
    assert_layout(
        "/* one */ /* two */ /// What it is.
problem P {
    /// a
    /* b */ /* c */
    /// d
    const a = 1;
    /* e */ /// f
    /* g */ const b = 2;
    trajectory { z <= 1; /// h
        z >= 0;
        /// i
        /* j */ /* k */ /// l
        soft: der(z) <= 1; }
}
",
        "/* one */  /* two */
/// What it is.
problem P {
    /// a
    /* b */
    /* c */
    /// d
    const a = 1;
    /* e */
    /// f
    /* g */ const b = 2;
    trajectory {
        z <= 1;
        /// h
        z >= 0;
        /// i
        /* j */
        /* k */
        /// l
        soft: der(z) <= 1;
    }
}
",
    );
}

#[test]
fn long_lines_break_at_the_loosest_operators() {
    let a = "a_rather_long_name";
    let product = [a; 3].join("*");
    let text = format!(
        "problem P {{ let s = {product} + {product} - hypot({a}, {product}, {product}); trajectory {{ turn: {product} + {a} <= {product} + {product}; }}
    param v = ({}) [km];
    guess {{ (x, y) through {}; }} }}",
        ["-1000.5"; 30].join(","),
        ["(-100, -15)"; 12].join(",")
    );
    assert_layout(
        &text,
        "problem P {
    let s = a_rather_long_name * a_rather_long_name * a_rather_long_name
        + a_rather_long_name * a_rather_long_name * a_rather_long_name
        - hypot(
            a_rather_long_name,
            a_rather_long_name * a_rather_long_name * a_rather_long_name,
            a_rather_long_name * a_rather_long_name * a_rather_long_name
        );
    trajectory {
        turn: a_rather_long_name * a_rather_long_name * a_rather_long_name + a_rather_long_name
            <= a_rather_long_name * a_rather_long_name * a_rather_long_name
                + a_rather_long_name * a_rather_long_name * a_rather_long_name;
    }
    param v = (-1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5,
        -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5,
        -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5, -1000.5) [km];
    guess {
        (x, y) through (-100, -15), (-100, -15), (-100, -15), (-100, -15), (-100, -15), (-100, -15), (-100, -15),
            (-100, -15), (-100, -15), (-100, -15), (-100, -15), (-100, -15);
    }
}
",
    );
}

#[test]
fn line_breaks_are_kept_in_kind_and_the_byte_order_mark_is_dropped() {
    let text = "\u{feff}/// A.\r\nproblem P {\r\n/* b\r\n c */ const a = 1; }";
    let once = formatted(text);
    assert_eq!(once, "/// A.\r\nproblem P {\r\n    /* b\r\n c */ const a = 1;\r\n}\r\n");
    assert_eq!(formatted(&once), once);
}

#[test]
fn sums_of_any_length_take_no_stack() {
    let terms = vec!["x"; 50_000].join(" + ");
    let once = formatted(&format!("problem P {{ let a = {terms}; }}"));
    assert_eq!(once.lines().count(), 50_002);
}

/// Numbers, words and marks of a spec, as the language parts them; comments left out.
fn tokens(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = vec![];
    for line in text.lines() {
        if line.trim_start().starts_with("///") {
            tokens.push(format!("{}\n", line.trim()));
            continue;
        }
        let mut rest = line.split("//").next().unwrap_or("").trim();
        while let Some(first) = rest.chars().next() {
            let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '\u{307}';
            let joined = ["..", "==", "<=", ">=", "::"].iter().find(|joined| rest.starts_with(**joined));
            let string = rest.starts_with('"').then(|| rest[1..].find('"').map_or(rest.len(), |end| end + 2));
            // Numbers with a fraction or an exponent are one token.
            let number = first.is_ascii_digit().then(|| {
                let end = rest.find(|c: char| !is_word(c) && c != '.').unwrap_or(rest.len());
                rest[..end].find("..").unwrap_or(end)
            });
            let word = || rest.find(|c| !is_word(c)).filter(|end| *end > 0);
            let end = string.or(number).or(joined.map(|joined| joined.len()));
            let end =
                end.unwrap_or_else(|| if is_word(first) { word().unwrap_or(rest.len()) } else { first.len_utf8() });
            tokens.push(rest[..end].to_owned());
            rest = rest[end..].trim_start();
        }
    }
    tokens
}

/// What an author may put between two tokens.
fn gap() -> impl Strategy<Value = &'static str> {
    prop_oneof![
        12 => Just(" "),
        3 => Just("\n"),
        1 => Just("\n\n\n"),
        1 => Just(" \t "),
        1 => Just(" // a remark\n"),
        1 => Just("\n// above\n"),
        1 => Just(" /* b */ "),
        1 => Just("\n   /* two\n        lines */\n"),
        1 => Just("\n/* one */ /* other */\n"),
    ]
}

/// An expression of the language, often longer than a line.
fn expression() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        Just("x".to_owned()),
        Just("a_name_that_takes_its_place".to_owned()),
        Just("12.5e-3 [km/(s^2 * kg)]".to_owned()),
        Just("y[i + 1]".to_owned()),
        Just("tau".to_owned()),
    ];
    leaf.prop_recursive(6, 60, 6, |inner| {
        let two = (inner.clone(), inner.clone());
        let many = prop::collection::vec(inner.clone(), 1..6);
        prop_oneof![
            (two.clone(), prop::sample::select(vec!["+", "-", "*", "/"]))
                .prop_map(|((a, b), op)| format!("{a}{op}{b}")),
            inner.clone().prop_map(|a| format!("({a})")),
            inner.clone().prop_map(|a| format!("-({a})^2")),
            inner.clone().prop_map(|a| format!("der({a},2)")),
            two.prop_map(|(a, b)| format!("sum(i in 1..{a},{b})")),
            many.prop_map(|list| format!("hypot({})", list.join(","))),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_white_space_and_comments_between_the_tokens_keep_the_laws(gaps in prop::collection::vec(gap(), 1..90)) {
        let tokens = tokens(EVERYTHING);
        let mut text = String::new();
        for (token, gap) in tokens.iter().zip(gaps.iter().cycle()) {
            text.push_str(token);
            text.push_str(gap);
        }
        prop_assume!(parse(&Source::new("s", text.as_str())).is_ok());
        assert_lawful(&text);
    }

    #[test]
    fn generated_expressions_keep_the_laws_and_the_line_length(
        a in expression(), b in expression(), c in expression(), gap in gap(),
    ) {
        let text = format!(
            "problem P {{ let v{gap}= {a};{gap}minimize cost: {b};\nfor_{gap}}}",
        ).replace(&format!("for_{gap}"), &format!("trajectory {{ name: {c} <= {a};{gap}{b} in {a} .. {c}; }}"));
        assert_lawful(&text);
        if !gap.contains('/') {
            let once = formatted(&text);
            let too_long = once.lines().find(|line| line.chars().count() > WIDTH);
            prop_assert!(too_long.is_none(), "{}", once);
        }
    }

    #[test]
    fn any_text_is_laid_out_or_refused(text in "\\PC{0,200}") {
        let _ = format(&Source::new("s", text));
    }
}
