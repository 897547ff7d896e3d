//! Statements that begin with no word of the language: what is meant by the words of other languages.

use super::imports;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::recover::text;
use crate::syntax::scan::{Scan, Token, TokenKind};
use crate::syntax::words::nearest_item_word;

/// Words for what holds at the start, and at the end.
const STARTS: &[&str] = &["init", "begin", "beginning", "initially", "at_start", "start_point", "initial_conditions"];
const ENDS: &[&str] =
    &["terminal", "endpoint", "goal", "target", "end", "ending", "at_end", "finish", "terminal_conditions"];

/// What is written at the start and at the end of a function of time.
const FIRST_TIMES: &[&str] = &["0", "t0", "t_0"];
const LAST_TIMES: &[&str] = &["T", "tf", "t_f", "t_end", "end"];

/// Where constraints stand.
pub(super) const BLOCKS: &str = "constraints stand in `initial { }`, `trajectory { }`, `final { }` or `temporal { }`";

/// Letters with a dot for a derivative.
const DOTTED: [char; 4] = ['ẋ', 'ẏ', 'ż', 'ṙ'];

/// What declares what is sought.
const KINDS: &str =
    "what is sought is declared by its kind: `state x;`, `input u;`, `output z: spline(...);`, a number `variable p;`";

/// Words that people begin statements with, and what to write.
const OPENERS: &[(&[&str], &str)] = &[
    (
        &["measurement", "measurements", "measured", "observations", "estimate", "fit", "data"],
        "what was measured stands in `measure { }`",
    ),
    (&["use"], "libraries stand before the problem: `use std::constants;`"),
    (&["control", "controls"], "what is chosen freely is an `input`"),
    (
        &["parameter", "parameters", "constant"],
        "a number that may be set is a `param`, one that never changes a `const`",
    ),
    (
        &["Real", "real", "var", "variables", "free"],
        "what moves is a `state`, an `input` or an `output`, a number that is sought a `variable`, a time a `duration`",
    ),
    (
        &["objective", "cost", "J", "mayer", "lagrange", "bolza", "Min", "Max", "min", "max"],
        "write `minimize name: e;` or `maximize name: e;`",
    ),
    (
        &[
            "subject_to",
            "subject",
            "such",
            "constraint",
            "constraints",
            "boundary",
            "bounds",
            "events",
            "st",
            "require",
            "requires",
            "assert",
            "ensure",
            "where",
        ],
        BLOCKS,
    ),
    (ENDS, "what holds at the end stands in `final { }`"),
    (STARTS, "what holds at the start stands in `initial { }`"),
    (&["during", "between", "while", "when"], super::PART),
    (&["along", "throughout", "always", "everywhere", "path"], "what holds all along stands in `trajectory { }`"),
    (
        &["independent", "independent_variable", "abscissa"],
        "what everything is a function of is written `domain s [m];`",
    ),
    (&["cyclic", "cycle", "period"], "what ends as it begins is written `periodic x, y;`"),
    (&["soft", "slack"], "what may be missed stands in a block: `trajectory { soft(w): x <= 1; }`"),
    (&["initial_guess", "initialize", "start_values"], "where the search begins stands in `guess { }`"),
    (&["equation", "equations", "ode", "system"], "equations of motion stand in `dynamics { der(x) == ...; }`"),
    (&["vector", "matrix"], "a vector is declared by its size: `output r[3]: ...`, `param J[3, 3] = ...`"),
    (
        &["solver", "options", "option", "nlp", "tolerance"],
        "how it is solved is said where it is solved: `ntg solve --help`",
    ),
    (
        &["mesh", "grid", "transcription"],
        "points and intervals stand in `collocation gauss(points = 3, intervals = 20);`",
    ),
    (&["time", "horizon"], "how long it takes is the duration: `duration T = 5;`, or `duration T in 1 .. 9;`"),
    (&["link", "linkage", "link_phases"], "phases follow one another by `phase coast after boost { ... }`"),
    (&["function", "def", "func"], "write `fn f(a) = a / 2;`"),
    (&["in"], "how long a phase lasts has its word: `duration in 1 .. 9 [s];`"),
    (&["if"], "an `if` is a value: `let y = if a <= b { ... } else { ... };`"),
    (&["for"], "loops stand in blocks of constraints and in `guess`"),
];

/// A statement among the items that begins with no item's word: a slip of the pen, or a constraint.
pub(super) fn no_item(scan: &Scan, token: &Token, word: &str, at: usize, end: usize) -> Diagnostic {
    let first = (at..end).find(|index| scan.tokens[*index].span == token.span).unwrap_or(at);
    let behind = |steps: usize| scan.tokens.get(first + steps).map_or("", |token| text(scan, token));
    let statement =
        scan.tokens[at..end].iter().map(|token| text(scan, token)).take_while(|text| !matches!(*text, ";" | "{"));
    let statement: Vec<&str> = statement.collect();
    let relates = statement.iter().any(|part| matches!(*part, "==" | "<=" | ">=" | "<" | ">" | "!="));
    let is_at_a_time = behind(1) == "(" && behind(3) == ")" && [FIRST_TIMES, LAST_TIMES].concat().contains(&behind(2));
    if (relates || (is_at_a_time && behind(4) == "=")) && word != "if" {
        let finding = Diagnostic::new(Code::Misplaced, token.span, "a constraint stands in no block");
        let is_derivative = matches!(word, "der" | "d" | "dt" | "ddt") && matches!(behind(1), "(" | "/");
        if is_derivative || word.ends_with("dot") || word.starts_with(DOTTED) {
            return finding.help("equations of motion stand in `dynamics { der(x) == ...; }`");
        }
        return match (is_at_a_time, FIRST_TIMES.contains(&behind(2))) {
            (true, true) => finding.help(format!("what holds at the start stands in `initial {{ {word} == ...; }}`")),
            (true, false) => finding.help(format!("what holds at the end stands in `final {{ {word} == ...; }}`")),
            _ if ENDS.contains(&word) => finding.help("what holds at the end stands in `final { }`"),
            _ if STARTS.contains(&word) => finding.help("what holds at the start stands in `initial { }`"),
            _ => finding.help("write it in `initial { }`, `trajectory { }`, `final { }` or `temporal { }`"),
        };
    }
    let finding = Diagnostic::new(Code::Unexpected, token.span, format!("`{word}` begins no statement"));
    let has = |words: &[&str]| statement.iter().any(|part| words.contains(part));
    if word == "der" && has(&["="]) {
        return finding.help("equations of motion stand in `dynamics { der(x) == ...; }`");
    }
    if behind(1) == "."
        && has(&["minimize", "minimise", "Minimize", "Obj", "Objective", "set_objective", "add_objective"])
    {
        return finding.help("write `minimize e;`");
    }
    if behind(1) == "." && has(&["maximize", "maximise", "Maximize"]) {
        return finding.help("write `maximize e;`");
    }
    if has(&["sym", "Var", "MV", "CV", "SV", "FV", "Variable", "add_state", "add_control", "DerivativeVar"]) {
        return finding.help(KINDS);
    }
    if behind(1) == "=" && has(&["lambda", "function"]) {
        return finding.help(format!("a function is declared by `fn`: `fn {word}(x) = ...;`"));
    }
    if behind(1) == "=" && matches!(word, "cost" | "objective" | "obj" | "J") {
        return finding.help("write `minimize name: e;` or `maximize name: e;`");
    }
    if behind(1) == "in" && word == "t" {
        return finding
            .help("the time runs by itself; how long it takes is `duration T = 5;`, or `duration T in 1 .. 9;`");
    }
    if behind(1) == "in" && token.kind == TokenKind::Word && !matches!(word, "for" | "if") {
        return finding.help(format!(
            "say what it is: `duration {word} in ...;` for a time, `variable {word} in ...;` for another number; limits along the way stand in `trajectory {{ }}`"
        ));
    }
    if behind(1) == "=" {
        return finding.help(format!(
            "say what it is: `const {word} = ...;`, `param {word} = ...;` if it may be set, `let {word} = ...;` if it is made of others, `duration {word} = ...;`"
        ));
    }
    if imports::IMPORTING.contains(&word) && behind(1) != "{" {
        return finding.help(format!("a library is used before the problem: {}", imports::as_use(scan, at)));
    }
    // `s.t.`
    let word = if word == "s" && behind(1) == "." && behind(2) == "t" { "st" } else { word };
    let known = OPENERS.iter().find(|(words, _)| words.contains(&word)).map(|(_, help)| *help);
    let is_called = scan.tokens.get(first + 1).is_some_and(|token| token.kind != TokenKind::Word) && behind(1) == "(";
    match (known, nearest_item_word(word)) {
        (Some(help), _) => finding.help(help),
        (None, _) if is_called && statement.contains(&"=") => {
            finding.help(format!("a function is declared by `fn`: `fn {word}(x) = ...;`"))
        }
        (None, Some(meant)) => finding.help(format!("did you mean `{meant}`?")),
        (None, None) => finding.help("a statement begins with a word such as `let`, `output`, `param` or `trajectory`"),
    }
}
