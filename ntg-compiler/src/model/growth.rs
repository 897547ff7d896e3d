//! The work of the pass is in proportion to the text: counted in expressions, never timed, so that it says the same on
//! every machine. A keystroke in an editor costs this work.

use std::fmt::Write as _;

use super::Loader;
use super::elaborator::Elaborator;
use super::library::Libraries;
use crate::source::Source;
use crate::syntax;

/// A kind of spec: what it is called, and the spec of so many parts.
type Kind = (&'static str, fn(usize) -> String);

struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, _: &str) -> Result<String, String> {
        Err("there are none".to_owned())
    }
}

/// How many expressions are looked at for the derivatives of states, and how many are given a shape or a meaning.
fn work(text: &str) -> (usize, usize) {
    let source = Source::new("growth", text);
    let spec = syntax::parse(&source).expect("the spec can be read");
    let libraries = Libraries::load(&spec.uses, &source, &NoFiles);
    let mut pass = Elaborator::new(&libraries.joined, &NoFiles);
    pass.elaborate(&spec.problem, (&libraries, &spec.uses), &[]);
    assert!(!pass.has_failed(), "{:?}", pass.found);
    (pass.looks, pass.elaborated)
}

/// So many vehicles with states, vectors, definitions and functions of their own.
fn bodies(count: usize) -> String {
    let mut text = String::from(
        "use std::atmosphere; use std::gravity; problem Bodies { duration T = 100 [s]; \
         collocation gauss(points = 3, intervals = 4);",
    );
    for k in 1..=count {
        let _ = write!(
            text,
            "state r_{k}[3] [km], v_{k}[3] [km/s], m_{k} in 1 .. 2 [t]; input u_{k}[3] in -9 .. 9 [kN];
             fn pull_{k}(h [m], v [m/s]) [N] {{ let rho = atmosphere::density(h);  rho * v^2 * {k} [m^2] }}
             let height_{k} [km] = norm(r_{k}) - gravity::radius_earth;
             let drag_{k} [kN] = pull_{k}(height_{k}, hypot(v_{k}, 1 [m/s]));
             dynamics {{
                 der(r_{k}) == v_{k};
                 der(v_{k}) == gravity::earth(r_{k}) + (u_{k} - drag_{k} * v_{k} / hypot(v_{k}, 1 [m/s])) / m_{k};
                 der(m_{k}) == -norm(u_{k}) / 3 [km/s];
             }}
             initial {{ r_{k} == (6400, 0, 0) [km];  v_{k} == 0;  m_{k} == 2 [t]; }}
             trajectory {{ height_{k} >= 0; }}
             final {{ height_{k} == 80 [km]; }}
             maximize final(m_{k}) / 1 [t];"
        );
    }
    text + "}"
}

/// Functions that use one another, and definitions that use them.
fn functions(count: usize) -> String {
    let mut text = String::from(
        "problem Functions { duration T = 5; state x; collocation gauss(points = 3, intervals = 4); \
         fn f_1(a) = a; let y_1 = der(x);",
    );
    for k in 2..=count {
        let before = if k % 8 == 0 { 1 } else { k - 1 };
        let _ =
            write!(text, "fn f_{k}(a) {{ let b = f_{before}(a);  b * {k} + a }} let y_{k} = y_{before} + f_{k}(x);");
    }
    let _ = write!(text, "dynamics {{ der(x) == 1; }} minimize integral(y_{count}^2); initial {{ x == 0; }} }}");
    text
}

/// Phases copy what is common to them.
fn phases(count: usize) -> String {
    let mut text = String::from(
        "problem Phases { state x [m], v [m/s]; input u in -1 .. 1 [m/s^2]; collocation gauss(points = 3, intervals = 4); \
         let push = u * gain; dynamics { der(x) == v;  der(v) == push; }",
    );
    for k in 1..=count {
        let after = if k == 1 { String::new() } else { format!(" after p_{}", k - 1) };
        let _ = write!(
            text,
            "phase p_{k}{after} {{ duration in 1 .. 9 [s];  let gain = {k};  trajectory {{ x <= {k} [m]; }} }}"
        );
    }
    text + "minimize integral(u^2) / 1 [m^2/s^3]; initial { x == 0;  v == 0; } final { x == 1 [m]; } }"
}

/// A vector in so many parentheses, each of which asks for shapes.
fn nested(count: usize) -> String {
    let (open, close) = ("2 * (s + ".repeat(count), ")".repeat(count));
    format!(
        "problem Nested {{ duration T = 5; output r[3], s[3]: spline(order = 5, intervals = 4); \
         let y = {open}r{close}; minimize integral(norm(der(r, 2))^2 + norm(y)^2); }}"
    )
}

/// Definitions made of names that are none, each like no other.
fn unknown(count: usize) -> String {
    let definitions: String = (0..count).map(|k| format!("let a{k} = unknown_{k} * f_{k}(x);")).collect();
    format!("problem Unknown {{ duration T = 5; output x: spline(order = 5, intervals = 4); {definitions} }}")
}

/// As many branches as there are numbers; `is_continuous` says whether they meet.
fn chain(count: usize, is_continuous: bool) -> String {
    let mut branches = String::new();
    for k in 1..=count {
        let value = if is_continuous { format!("{k} * x - {}", k * (k - 1) / 2) } else { format!("{k} * x^2 + {k}") };
        let _ = write!(branches, "if x <= {k} {{ {value} }} else ");
    }
    let last = if is_continuous { format!("{} * x - {}", count + 1, count * (count + 1) / 2) } else { "x".to_owned() };
    format!(
        "problem Chain {{ duration T = 5; state x; input u; collocation gauss(points = 3, intervals = 4); \
         dynamics {{ der(x) == u + 0.001 * ({branches} {{ {last} }}); }} minimize integral(u^2); initial {{ x == 0; }} }}"
    )
}

/// How many nodes a spec has become.
fn nodes(text: &str) -> usize {
    let source = Source::new("growth", text);
    let spec = syntax::parse(&source).expect("the spec can be read");
    let (problem, found) = super::build(&spec, &source, &NoFiles);
    problem.unwrap_or_else(|| panic!("{found:?}")).dag.len()
}

#[test]
fn a_chain_of_branches_is_compared_once_a_branch() {
    for is_continuous in [false, true] {
        let [first, second, third] = [30, 60, 90].map(|count| nodes(&chain(count, is_continuous)));
        assert!(third - second <= second - first + 30, "{is_continuous}: {first}, {second}, {third}");
    }
}

#[test]
fn very_many_unknown_names_are_held_against_few() {
    let among = |count: usize| {
        let text = unknown(count);
        let source = Source::new("growth", text.as_str());
        let spec = syntax::parse(&source).expect("the spec can be read");
        let libraries = Libraries::load(&spec.uses, &source, &NoFiles);
        let mut pass = Elaborator::new(&libraries.joined, &NoFiles);
        pass.elaborate(&spec.problem, (&libraries, &spec.uses), &[]);
        assert_eq!(pass.found.len(), 2 * count, "each is told");
        pass.searched.get().1
    };
    let [first, second, third] = [300, 600, 900].map(among);
    assert!(third - second <= second - first, "{first}, {second}, {third}");
}

#[test]
fn work_is_in_proportion_to_the_text() {
    let kinds: [Kind; 4] = [("bodies", bodies), ("functions", functions), ("phases", phases), ("nested", nested)];
    for (name, spec) in kinds {
        let [first, second, third] = [32, 64, 96].map(|count| work(&spec(count)));
        // As much text again takes as much work again.
        let steps = [(first.0, second.0, third.0), (first.1, second.1, third.1)];
        for (first, second, third) in steps {
            assert!(third - second <= second - first + 8, "{name}: {first}, {second}, {third}");
        }
    }
}
