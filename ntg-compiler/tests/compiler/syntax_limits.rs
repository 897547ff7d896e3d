//! Size, depth and arbitrary text: the parser stays linear, within a small stack, and never panics.

use ntg_compiler::source::Source;
use ntg_compiler::syntax::ast::*;
use ntg_compiler::syntax::{MAX_DEPTH, comments, parse, parse_expression, parse_quantity};
use proptest::prelude::*;

const EVERYTHING: &str = include_str!("../syntax_specs/everything.ntg");

/// Runs on a stack of the size that Rust gives its threads.
fn on_a_small_stack<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    let thread = std::thread::Builder::new().stack_size(2 << 20).spawn(work).expect("a thread can be started");
    thread.join().expect("the work does not overflow the stack")
}

/// A pass that is linear takes seconds, a quadratic one would take hours: that it ends is the claim.
#[test]
fn sums_and_products_of_200_000_terms_take_a_linear_time_and_no_stack() {
    let (sum, sign) = on_a_small_stack(|| {
        let terms: Vec<String> = (0..200_000).map(|i| format!("x * {i} / y")).collect();
        let expr = parse_expression(&Source::new("long", terms.join(" - "))).expect("it is an expression");
        let copy = expr.without_spans();
        let equal = copy == expr.without_spans();
        let ExprKind::Sum(terms) = &copy.kind else { panic!("a sum") };
        (terms.len(), equal && terms[1].0 == Sign::Minus)
    });
    assert_eq!((sum, sign), (200_000, true));
}

#[test]
fn long_specs_take_a_linear_time() {
    let statements: String = (0..20_000).map(|i| format!("  let a{i} = sin(b[{i}] + 1 [km]) ^ 2;\n")).collect();
    let spec = parse(&Source::new("long", format!("problem P {{\n{statements}}}"))).expect("it is a spec");
    assert_eq!(spec.problem.items.len(), 20_000);
}

/// Each way of nesting, `depth` deep in brackets, signs or powers.
fn nests(depth: usize) -> [String; 10] {
    let calls = |open: &str, close: &str, n: usize| format!("{}x{}", open.repeat(n), close.repeat(n));
    [
        calls("(", ")", depth),
        calls("sin(", ")", depth),
        calls("sum(i in 1 .. N, ", ")", depth),
        calls("a[", "]", depth),
        calls("-", "", depth),
        calls("2^", "", depth),
        calls("(-2^", ")", depth / 3),
        calls("if a <= ", " { 1 } else { 2 }", depth - 1),
        calls("if a <= b { 1 } else { ", " }", depth),
        format!("1 [{}m{}]", "(".repeat(depth - 1), ")".repeat(depth - 1)),
    ]
}

#[test]
fn nesting_to_the_limit_fits_a_small_stack_and_one_more_is_refused() {
    on_a_small_stack(|| {
        for text in nests(MAX_DEPTH) {
            let source = Source::new("deep", text);
            let expr = parse_expression(&source).unwrap_or_else(|found| panic!("{}", found.render(&source)));
            assert_eq!(expr.clone(), expr);
        }
        for text in nests(MAX_DEPTH + 3).into_iter().chain(nests(30_000)) {
            let found = parse_expression(&Source::new("deep", text)).expect_err("too deep");
            assert_eq!(found.first().code.text(), "E005");
        }
    });
}

#[test]
fn blocks_nest_to_the_limit_too() {
    on_a_small_stack(|| {
        let loops = MAX_DEPTH - 2;
        let text = format!(
            "problem P {{ trajectory {{ {} x <= 1; {} }} }}",
            "for i in 1 .. 2 { ".repeat(loops),
            "} ".repeat(loops)
        );
        assert!(parse(&Source::new("deep", text.as_str())).is_ok());
        // The recovery walks the same depth.
        let broken = text.replace("x <= 1", "x <= ");
        assert_eq!(parse(&Source::new("deep", broken)).expect_err("broken").first().code.text(), "E001");
    });
}

#[test]
fn a_long_text_of_mistakes_is_reported() {
    let junk = ["a;", "let a = ;\n", "5s ", "≤", "(;", "'", "}", "{", "x <= ;", "\"\n", "/*", "///\n", "1..=2;", "[)"];
    for piece in junk {
        let text = format!("problem P {{ {} }}", piece.repeat(100_000 / piece.len()));
        let source = Source::new("junk", text);
        let found = parse(&source).expect_err("junk");
        let shown: usize = found.iter().take(3).map(|finding| finding.render(&source).len()).sum();
        assert!(found.iter().count() <= 300 && shown < 10_000, "{piece}: {} {shown}", found.iter().count());
    }
}

/// Reads and renders; the spans of all findings must lie in the text.
fn must_not_panic(text: &str) {
    let source = Source::new("any", text);
    let findings = [parse(&source).err(), parse_expression(&source).err(), parse_quantity(&source).err()];
    for finding in findings.iter().flatten().flatten() {
        let (start, end) = (finding.span.start as usize, finding.span.end as usize);
        assert!(start <= end && end <= text.len(), "{finding:?}");
        assert!(text.is_char_boundary(start) && text.is_char_boundary(end), "{finding:?}");
        let _ = finding.render(&source);
        let _ = finding.render_with(&source, true);
    }
    let _ = comments(&source);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    #[test]
    fn arbitrary_text_does_not_panic(text in any::<String>()) {
        must_not_panic(&text);
        must_not_panic(&format!("problem P {{ {text}"));
        must_not_panic(&format!("problem P {{ {text} }}"));
    }

    #[test]
    fn arbitrary_tokens_do_not_panic(
        tokens in prop::collection::vec(prop::sample::select(vec![
            "problem", "P", "{", "}", "(", ")", "[", "]", ";", ":", ",", "=", "==", "<=", "<", "..", ".", "-", "^", "*", "+",
            "x", "1", "2.5", "let", "output", "spline", "in", "for", "sum", "der", "trajectory", "guess", "through", "table",
            "param", "phase", "after", "minimize", "///\n", "//\n", "/*", "*/", "\"", "'", "≤", "ẋ", "\u{feff}", "\r\n", "5s",
        ]), 0..60),
        body in any::<bool>(),
    ) {
        let text = tokens.join(" ");
        must_not_panic(&if body { format!("problem P {{ {text} }}") } else { text });
    }

    #[test]
    fn truncated_and_mutated_specs_do_not_panic(
        cut in 0..EVERYTHING.len(),
        at in 0..EVERYTHING.len(),
        length in 0..40_usize,
        piece in prop::sample::select(vec!["", "}", "{", "(", ")", ";", "\"", "/*", "≤", "let", "'", "in", "\u{0}", "]", "1."]),
    ) {
        let boundary = |byte: usize| EVERYTHING.floor_char_boundary(byte.min(EVERYTHING.len()));
        must_not_panic(&EVERYTHING[..boundary(cut)]);
        let (start, end) = (boundary(at), boundary(at + length));
        must_not_panic(&format!("{}{piece}{}", &EVERYTHING[..start], &EVERYTHING[end..]));
    }
}
