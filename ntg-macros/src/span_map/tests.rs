//! Laws of the layout, without rustc: proc-macro2 keeps lines and columns by itself.

use ntg_compiler::source::Source;
use ntg_compiler::syntax;

use super::*;

fn tokens(text: &str) -> TokenStream {
    text.parse().expect("legal tokens")
}

fn invisible(text: &str) -> TokenTree {
    TokenTree::Group(Group::new(Delimiter::None, tokens(text)))
}

/// What a spec looks like: two names with more bytes than characters, comments, ranges.
const SPEC: &str = "problem P { // a comment\n    output ẋ, ψ [km]: spline(order = 5); /* gone */ minimize ẋ^2;\n\
                    \x20   final { 1..2 <= ψ; 0 .. 1 == -ẋ; }\n}\n";

#[test]
fn every_token_is_where_it_was_written() {
    let map = SpanMap::layout(tokens(SPEC));
    let blank = |text: &str| text.replace("// a comment", "").replace("/* gone */", "          ");
    let lines = |text: &str| text.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>();
    assert_eq!(lines(&map.text), lines(&blank(SPEC)));
}

#[test]
fn a_range_finds_its_first_and_last_token() {
    let map = SpanMap::layout(tokens(SPEC));
    let start = map.text.find("minimize").expect("it is there");
    let end = map.text.find("^2").expect("it is there") + 2;
    let (first, last) = map.ends(start..end);
    assert_eq!((first.start().line, first.start().column), (2, 52));
    assert_eq!((last.end().line, last.end().column), (2, 64)); // Columns are characters, from 0.
}

#[test]
fn an_empty_range_is_the_token_there_or_the_one_before() {
    let map = SpanMap::layout(tokens("ab  cd"));
    let column = |byte| map.ends(byte..byte).0.start().column;
    assert_eq!([0, 1, 2, 3, 4, 5, 6, 99].map(column), [0, 0, 0, 0, 4, 4, 4, 4]);
    SpanMap::layout(TokenStream::new()).ends(0..0); // There is none: the call itself.
}

#[test]
fn doc_comments_are_comments_again() {
    let text = "/// Says \"what\" it \\is.\n///\n/// Twice.\nproblem P { /// x\n output x; }";
    assert_eq!(SpanMap::layout(tokens(text)).text.trim_end(), text);
    for refused in
        ["//! inner\nproblem", "/** block */ problem", "/*! inner block */ problem", "/** two\nlines */ problem"]
    {
        assert_eq!(SpanMap::layout(tokens(refused)).text.trim_end(), refused);
    }
}

#[test]
fn an_attribute_is_no_comment() {
    assert_eq!(SpanMap::layout(tokens("#[doc = \"x\"] a")).text.trim_end(), "#[doc = \"x\"] a");
}

#[test]
fn an_invisible_group_keeps_its_precedence() {
    let mut stream = tokens("minimize 2 *");
    stream.extend([invisible("a + b")]);
    stream.extend(tokens("^ 2 ;"));
    assert_eq!(SpanMap::layout(stream).text, "minimize 2 * ( a + b ) ^ 2 ; ");
}

#[test]
fn an_invisible_group_of_one_token_is_that_token() {
    let stream: TokenStream = [invisible("0.25")].into_iter().chain(tokens("[km]")).collect();
    assert_eq!(SpanMap::layout(stream).text, "0.25 [ km ] ");
}

#[test]
fn tokens_out_of_order_stand_in_a_row_and_marks_stay_joined() {
    let text = tokens("a == 1..b; /// c\n d");
    let mut reversed: Vec<TokenTree> = tokens("second first").into_iter().collect();
    reversed.reverse();
    let stream: TokenStream = reversed.into_iter().chain(text).collect();
    assert_eq!(SpanMap::layout(stream).text, "first second a == 1 .. b ; /// c\nd ");
}

#[test]
fn neighbours_never_run_into_one_another() {
    // Two words at one place, as `macro_rules!` may give them.
    let word = |text: &str| TokenTree::Ident(proc_macro2::Ident::new(text, Span::call_site()));
    let stream: TokenStream = [word("problem"), word("P")].into_iter().collect();
    assert_eq!(SpanMap::layout(stream).text, "problem P ");
}

#[test]
fn nesting_is_no_recursion() {
    let deep = 20_000;
    let nested = (0..deep)
        .fold(TokenStream::new(), |inner, _| TokenTree::Group(Group::new(Delimiter::Parenthesis, inner)).into());
    assert_eq!(SpanMap::layout(nested).text.matches('(').count(), deep);
}

/// What was written, without saying where.
fn tree(text: &str) -> String {
    let spec = syntax::parse(&Source::new("spec", text)).unwrap_or_else(|found| panic!("{found:?}\n{text}"));
    let mut tree = format!("{spec:?}");
    while let Some(start) = tree.find("Span {") {
        let end = start + tree[start..].find('}').expect("a span's Debug closes its brace");
        tree.replace_range(start..=end, "_");
    }
    tree
}

#[test]
fn every_spec_survives_its_tokens() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../specs");
    let files =
        std::fs::read_dir(folder).expect("the specs are there").map(|file| file.expect("it can be listed").path());
    let specs: Vec<_> = files.filter(|path| path.extension().is_some_and(|extension| extension == "ntg")).collect();
    assert!(!specs.is_empty());
    for path in specs {
        let text = std::fs::read_to_string(&path).expect("a spec can be read");
        let (written, leaves) = (tree(&text), leaves(tokens(&text)));
        let (as_written, _) = as_written(&leaves).expect("tokens of a file are in order");
        assert_eq!(tree(&as_written), written, "{}", path.display());
        assert_eq!(tree(&in_a_row(&leaves).0), written, "{}", path.display());
    }
}
