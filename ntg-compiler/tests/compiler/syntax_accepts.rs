//! Every form of the language parses, into the tree that it stands for.

use ntg_compiler::source::Source;
use ntg_compiler::syntax::ast::*;
use ntg_compiler::syntax::{comments, parse, parse_expression, parse_quantity};

/// The spec's items; a failure shows the messages.
#[track_caller]
fn items(body: &str) -> Vec<Item> {
    spec(&format!("problem P {{\n{body}\n}}")).problem.items
}

#[track_caller]
fn spec(text: &str) -> Spec {
    let source = Source::new("spec.ntg", text);
    parse(&source).unwrap_or_else(|found| panic!("{}", found.render(&source)))
}

#[track_caller]
fn expression(text: &str) -> Expr {
    let source = Source::new("expression", text);
    parse_expression(&source).unwrap_or_else(|found| panic!("{}", found.render(&source))).without_spans()
}

#[track_caller]
fn quantity(text: &str) -> Values {
    let source = Source::new("quantity", text);
    parse_quantity(&source).unwrap_or_else(|found| panic!("{}", found.render(&source)))
}

/// The fully bracketed form of an expression, numbers with their units' symbols behind.
fn brackets(expr: &Expr) -> String {
    match &expr.kind {
        ExprKind::Number(number) => match &number.unit {
            Some(unit) => format!("{}[{}]", number.value, symbols(&unit.factors)),
            None => number.value.to_string(),
        },
        ExprKind::Pi => "pi".into(),
        ExprKind::Time => "t".into(),
        ExprKind::ScaledTime => "tau".into(),
        ExprKind::Path(path) => shown(path),
        ExprKind::Tuple(elements) => format!("<{}>", all(elements)),
        ExprKind::Neg(inner) => format!("(-{})", brackets(inner)),
        ExprKind::Sum(terms) => {
            let terms =
                terms.iter().map(|(sign, e)| format!("{}{}", if *sign == Sign::Plus { '+' } else { '-' }, brackets(e)));
            format!("({})", terms.collect::<String>())
        }
        ExprKind::Product(factors) => {
            let factors = factors
                .iter()
                .map(|(op, e)| format!("{}{}", if *op == MulOp::Multiply { '*' } else { '/' }, brackets(e)));
            format!("({})", factors.collect::<String>())
        }
        ExprKind::Power(base, exponent) => format!("({}^{})", brackets(base), brackets(exponent)),
        ExprKind::Call(call) => format!("{}({})", call.function.text, all(&call.arguments)),
        ExprKind::Der { of, order } => {
            format!(
                "der({}{})",
                brackets(of),
                order.iter().map(|order| format!(",{}", brackets(order))).collect::<String>()
            )
        }
        ExprKind::Partial { of, argument } => {
            format!("partial({}({}),{})", of.function.text, all(&of.arguments), brackets(argument))
        }
        ExprKind::Integral { path, of } => format!("integral({}{})", of_path(path.as_ref()), brackets(of)),
        ExprKind::Boundary { boundary, path, of } => {
            format!("{boundary:?}({}{})", of_path(path.as_ref()), brackets(of))
        }
        ExprKind::Event { event, path } => format!("{event:?}({})", shown(path)),
        ExprKind::Reduce(reduction) => {
            let Reduction { op, over, body, width } = &**reduction;
            let width = width.iter().map(|width| format!(",{}", brackets(width))).collect::<String>();
            let (first, last) = (brackets(&over.first), brackets(&over.last));
            format!("{op:?}({} in {first}..{last},{}{width})", over.index.text, brackets(body))
        }
        ExprKind::If(conditional) => {
            let branches = conditional.branches.iter().map(|branch| {
                let sides: Vec<String> = branch.condition.sides().into_iter().map(brackets).collect();
                let smooth = branch.smooth.iter().map(|width| format!("~{}", brackets(width))).collect::<String>();
                format!("{}{smooth}?{}:", sides.join("|"), brackets(&branch.value))
            });
            format!("({}{})", branches.collect::<String>(), brackets(&conditional.otherwise))
        }
        ExprKind::Rows(name) => format!("rows({})", name.path),
        ExprKind::File(file) => {
            let columns = file.columns.iter().flat_map(|c| [&c.first].into_iter().chain(&c.last));
            format!("{}:{}", file.name.path, columns.map(brackets).collect::<Vec<_>>().join(".."))
        }
        ExprKind::Steps(steps) => {
            let lets = steps.lets.iter().map(|step| format!("{}={};", step.name.text, brackets(&step.value)));
            format!("{{{}{}}}", lets.collect::<String>(), brackets(&steps.value))
        }
    }
}

fn of_path(path: Option<&Path>) -> String {
    path.map(|path| format!("{}:", shown(path))).unwrap_or_default()
}

fn shown(path: &Path) -> String {
    let segment = |segment: &Segment| match segment.indices.is_empty() {
        true => segment.name.text.clone(),
        false => format!("{}[{}]", segment.name.text, indices(&segment.indices)),
    };
    path.segments.iter().map(segment).collect::<Vec<_>>().join(".")
}

fn indices(list: &[Index]) -> String {
    let one = |index: &Index| match &index.last {
        None => brackets(&index.first),
        Some(last) => format!("{} .. {}", brackets(&index.first), brackets(last)),
    };
    list.iter().map(one).collect::<Vec<_>>().join(",")
}

fn all(list: &[Expr]) -> String {
    list.iter().map(brackets).collect::<Vec<_>>().join(",")
}

fn symbols(factors: &[UnitFactor]) -> String {
    let factor = |factor: &UnitFactor| {
        let base = match &factor.base {
            UnitBase::One => "1".into(),
            UnitBase::Symbol(symbol) => symbol.text.clone(),
            UnitBase::Group(inner) => format!("({})", symbols(inner)),
        };
        let sign = if factor.op == MulOp::Multiply { "*" } else { "/" };
        format!("{sign}{base}^{}", factor.power)
    };
    factors.iter().map(factor).collect()
}

#[test]
fn precedence_is_power_then_minus_then_product_then_sum() {
    let cases = [
        ("-a^2", "(-(a^2))"),
        ("a^b^c", "(a^(b^c))"),
        ("2^-3", "(2^(-3))"),
        ("2^-3^x", "(2^(-(3^x)))"),
        ("-a*b + c", "(+(*(-a)*b)+c)"),
        ("a - b - c", "(+a-b-c)"),
        ("a / b * c", "(*a/b*c)"),
        ("a * -b", "(*a*(-b))"),
        ("a - -b", "(+a-(-b))"),
        ("- - a", "(-(-a))"),
        ("(a + b) * c", "(*(+a+b)*c)"),
        ("(a)", "a"),
        ("a + (b + c)", "(+a+(+b+c))"),
        ("31 / 36", "(*31/36)"),
    ];
    for (text, tree) in cases {
        assert_eq!(brackets(&expression(text)), tree, "{text}");
    }
}

#[test]
fn a_unit_binds_tightest_and_to_the_literal_before_it() {
    let cases = [
        ("10 [m]^2", "(10[*m^1]^2)"),
        ("r / 1 [km]", "(*r/1[*km^1])"),
        ("9.81 [m/s^2] * m", "(*9.81[*m^1/s^2]*m)"),
        ("1 [1]", "1[*1^1]"),
        ("2 [kg/(m*s^2)]", "2[*kg^1/(*m^1*s^2)^1]"),
        ("2 [s^-2]", "2[*s^-2]"),
        ("5 [min] + 3 [t] + 2 [in]", "(+5[*min^1]+3[*t^1]+2[*in^1])"),
    ];
    for (text, tree) in cases {
        assert_eq!(brackets(&expression(text)), tree, "{text}");
    }
}

#[test]
fn applications_of_every_kind() {
    let cases = [
        ("sin(x)", "sin(x)"),
        ("hypot(der(x), der(y))", "hypot(der(x),der(y))"),
        ("der(x, 2)", "der(x,2)"),
        ("partial(f(s, w), s)", "partial(f(s,w),s)"),
        ("integral(z^2)", "integral((z^2))"),
        ("integral(uav[2].strike, sig)", "integral(uav[2].strike:sig)"),
        ("initial(m) - final(covert, m)", "(+Initial(m)-Final(covert:m))"),
        ("end(looker) - start(leg[i - 1]) + duration(p)", "(+End(looker)-Start(leg[(+i-1)])+Duration(p))"),
        ("sum(i in 1 .. N, x[i]^2)", "Sum(i in 1..N,(x[i]^2))"),
        ("prod(i in 1..2, i)", "Product(i in 1..2,i)"),
        ("min(a, b, c) + min(i in 1 .. 3, x[i])", "(+min(a,b,c)+Min(i in 1..3,x[i]))"),
        ("smooth_max(u, v, w) + smooth_max(i in 1 .. 3, x[i], w)", "(+smooth_max(u,v,w)+SmoothMax(i in 1..3,x[i],w))"),
        ("pi + t + tau + tango", "(+pi+t+tau+tango)"),
        ("x[i, j]", "x[i,j]"),
    ];
    for (text, tree) in cases {
        assert_eq!(brackets(&expression(text)), tree, "{text}");
    }
}

#[test]
fn words_that_merely_begin_like_keywords_are_names() {
    let words = "inner initially format summit products derive partially integrals finals starts ending durations tt tau2 \
                 pipe agents constant parameter unitary used iff atlas softly scaled outputs letter fnord problems";
    for word in words.split_whitespace() {
        assert_eq!(brackets(&expression(word)), word);
    }
}

#[test]
fn words_with_a_meaning_somewhere_stay_free_as_names() {
    let words =
        "after up to even periodic from through spline jump fit range min max T linear monotone gauss points type fn_";
    for word in words.split_whitespace() {
        let items =
            items(&format!("let {word} = 1; output {word}[1 .. 2] [km]: spline(order = 3); param {word} = {word};"));
        assert_eq!(items.len(), 3, "{word}");
    }
    assert_eq!(
        items("table even(even even [deg]) = linear { 0: 1; 1: 2; } phase p { jump jump; continuous up up to 1; }")
            .len(),
        2
    );
}

#[test]
fn a_unit_after_a_tuple_reaches_its_bare_literals_and_nothing_else() {
    assert_eq!(all(&quantity("(-100, a, 2*3, 4 [m]) [km]").elements), "(-100[*km^1]),a,(*2*3),4[*m^1]");
    assert_eq!(all(&quantity("-100, -97 [km]").elements), "(-100[*km^1]),(-97[*km^1])");
    assert_eq!(all(&quantity("(1, 2 [km])").elements), "1[*km^1],2[*km^1]");
    assert_eq!(all(&quantity("(-100) [km]").elements), "(-100[*km^1])");
    assert_eq!(all(&quantity("250 [m/s]").elements), "250[*m^1/s^1]");
    assert!(!quantity("(1)").is_tuple && quantity("(1,)").is_tuple && quantity("(1) [m]").is_tuple);
}

#[test]
fn a_unit_after_a_range_reaches_its_lower_end() {
    let bounds = |text: &str| match items(text).remove(0).kind {
        ItemKind::Variable(mut variable) => {
            let Bounds { lower, upper, .. } = variable.names.remove(0).bounds.unwrap();
            [lower, upper].map(|end| end.map(|end| brackets(&end)).unwrap_or_default())
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(bounds("variable m in 1 .. 5 [kg];"), ["1[*kg^1]", "5[*kg^1]"]);
    assert_eq!(bounds("variable m in -1..-5 [kg];"), ["(-1[*kg^1])", "(-5[*kg^1])"]);
    assert_eq!(bounds("variable m in 1 [kg] ..;"), ["1[*kg^1]", ""]);
    assert_eq!(bounds("variable m in .. 5 [kg];"), ["", "5[*kg^1]"]);
    assert_eq!(bounds("variable m in a .. 2 * 5 [kg];"), ["a", "(*2*5[*kg^1])"]);
    assert_eq!(bounds("variable m in 1 .. 2 * 5 [kg];"), ["1", "(*2*5[*kg^1])"]);
}

#[test]
fn a_unit_after_a_route_reaches_all_of_its_points() {
    let items = items("guess { (x, y) through (-1, a), (3, 4) [m], (5, 6) [km];  z through 0, 5 [s]; }");
    let ItemKind::Guess(guess) = &items[0].kind else { panic!() };
    let points: Vec<Vec<String>> = guess
        .statements
        .iter()
        .map(|statement| match statement {
            Statement::One(GuessKind::Route(route)) => {
                route.points.iter().map(|point| all(&point.coordinates)).collect()
            }
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(points[0], ["(-1[*km^1]),a", "3[*m^1],4[*m^1]", "5[*km^1],6[*km^1]"]);
    assert_eq!(points[1], ["0[*s^1]", "5[*s^1]"]);
}

#[test]
fn outputs_without_a_unit_take_the_last_one_of_their_list() {
    let items = items("output r [m], s, theta[1 .. N] [rad], psi: spline(order = 5);");
    let ItemKind::Output(output) = &items[0].kind else { panic!() };
    let units: Vec<String> = output
        .names
        .iter()
        .map(|name| name.unit.as_ref().map(|unit| symbols(&unit.factors)).unwrap_or_default())
        .collect();
    assert_eq!(units, ["*m^1", "*rad^1", "*rad^1", "*rad^1"]);
    assert!(output.names[2].shape.is_some() && output.names[3].shape.is_none());
}

#[test]
fn the_first_example() {
    let spec = spec(include_str!("../syntax_specs/van_der_pol.ntg"));
    let doc = spec.problem.doc.map(|doc| doc.text).unwrap_or_default();
    assert_eq!(
        doc,
        "The driven van der Pol oscillator, the first example of NTG (examples/vanderpol.c).\n\nSecond paragraph."
    );
    assert_eq!(spec.problem.name.text, "VanDerPol");
    let kinds: Vec<bool> = spec.problem.items.iter().map(|item| matches!(item.kind, ItemKind::Block(_))).collect();
    assert_eq!(kinds, [false, false, false, false, true, true]);
}

#[test]
fn a_conditional_is_one_operand_to_its_last_brace() {
    for (text, wanted) in [
        ("if a <= b { 1 } else { 2 } + 3", "(+(a|b?1:2)+3)"),
        ("-if a in 1 .. 2 { 1 } else { 2 } ^ 2", "(-((a|1|2?1:2)^2))"),
        ("if a <= smooth smooth unit_ { x } else { y }", "(a|smooth~unit_?x:y)"),
        ("if a <= b smooth c * d { 1 } else if e >= f { 2 } else { 3 }", "(a|b~(*c*d)?1:e|f?2:3)"),
        ("if a == if b <= c { 1 } else { 2 } { 3 } else { 4 }", "(a|(b|c?1:2)?3:4)"),
        ("f(if a <= b { let c = 2; let d [m] = c; c * d } else { (1, 2) })", "f((a|b?{c=2;d=c;(*c*d)}:<1,2>))"),
    ] {
        assert_eq!(brackets(&expression(text)), wanted, "{text}");
    }
}

#[test]
fn every_declaration_of_the_language() {
    let spec = spec(include_str!("../syntax_specs/everything.ntg"));
    let names: Vec<String> = spec
        .problem
        .items
        .iter()
        .map(|item| format!("{:?}", item.kind).split(['(', '{', ' ']).next().unwrap_or_default().to_owned())
        .collect();
    for kind in [
        "Const",
        "Param",
        "Variable",
        "Output",
        "Function",
        "Let",
        "Table",
        "Continuation",
        "Duration",
        "Start",
        "Phase",
        "Agent",
        "Collocation",
        "Objective",
        "Block",
        "Guess",
    ] {
        assert!(names.iter().any(|name| name == kind), "{kind} is not in {names:?}");
    }
}

#[test]
fn white_space_matters_nowhere_between_tokens() {
    let text = include_str!("../syntax_specs/everything.ntg");
    let source = Source::new("everything", text);
    let wanted = spec(text).without_spans();
    // One token a line, and everything on as few lines as doc comments allow.
    let mut spread = String::new();
    let mut tight = String::new();
    for (token, is_doc) in rough_tokens(&blanked(&source)) {
        spread.push_str(&token);
        spread.push('\n');
        let glue = tight.chars().next_back().is_some_and(|c| c.is_alphanumeric() || c == '_');
        if glue && token.starts_with(|c: char| c.is_alphanumeric() || c == '"') {
            tight.push(' ');
        }
        tight.push_str(&token);
        if is_doc {
            tight.push('\n');
        }
    }
    assert_eq!(spec(&spread).without_spans(), wanted);
    assert_eq!(spec(&tight).without_spans(), wanted);
    assert_eq!(spec(&text.replace('\n', "\r\n")).without_spans(), wanted);
    assert_eq!(spec(&format!("\u{feff}{text}")).without_spans(), wanted);
}

/// The text with its plain comments blanked.
fn blanked(source: &Source) -> String {
    let mut text = source.text.clone();
    for comment in comments(source) {
        let range = comment.span.start as usize..comment.span.end as usize;
        text.replace_range(range.clone(), &" ".repeat(range.len()));
    }
    text
}

/// Tokens as Rust's lexer would cut them, joint punctuation in one piece; doc lines are marked.
fn rough_tokens(text: &str) -> Vec<(String, bool)> {
    let mut tokens = vec![];
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let is_doc = rest.starts_with("///");
        let end_of = |while_it: fn(char) -> bool| rest.find(|c| !while_it(c)).unwrap_or(rest.len());
        let length = if is_doc {
            rest.find('\n').unwrap_or(rest.len())
        } else if let Some(string) = rest.strip_prefix('"') {
            string.find('"').map_or(rest.len(), |end| end + 2)
        } else if rest.starts_with(|c: char| c.is_ascii_digit()) {
            let digits = end_of(|c| c.is_alphanumeric());
            let fraction =
                rest[digits..].starts_with('.') && rest[digits + 1..].starts_with(|c: char| c.is_ascii_digit());
            if fraction {
                digits + 1 + rest[digits + 1..].find(|c: char| !c.is_alphanumeric()).unwrap_or(0)
            } else {
                digits
            }
        } else if rest.starts_with(|c: char| c.is_alphabetic()) {
            end_of(|c| c.is_alphanumeric() || c == '_' || c == '\u{307}')
        } else if ["..", "==", "<=", ">=", "::"].iter().any(|joint| rest.starts_with(joint)) {
            2
        } else {
            rest.chars().next().map_or(1, char::len_utf8)
        };
        tokens.push((rest[..length].to_owned(), is_doc));
        rest = rest[length..].trim_start();
    }
    tokens
}

#[test]
fn names_are_normalised() {
    let (composed, decomposed) = (expression("\u{1e8b}"), expression("x\u{307}"));
    assert_eq!(composed, decomposed);
    assert_eq!(brackets(&expression("ψ")), "ψ");
}

#[test]
fn comments_are_kept_aside_and_nest() {
    let text = "// one\nproblem P { /* two /* nested */ */ let a = 1; //// three\n /// doc\n let b = /***/ 2; /**/ }";
    let source = Source::new("s", text);
    let texts: Vec<String> = comments(&source).into_iter().map(|comment| comment.text).collect();
    assert_eq!(texts, ["// one", "/* two /* nested */ */", "//// three", "/***/", "/**/"]);
    let items = spec(text).problem.items;
    assert_eq!(items[0].doc, None);
    assert_eq!(items[1].doc.as_ref().map(|doc| doc.text.as_str()), Some("doc"));
}

#[test]
fn spans_cover_what_was_written() {
    let text = "problem P {\n  /// doc\n  let a = -b * ( c + 1 [km] ) // comment\n ;\n initial { near: a == 2 ; } }";
    let source = Source::new("s", text);
    let problem = spec(text).problem;
    assert_eq!(source.slice(problem.span), text);
    assert!(
        source.slice(problem.items[0].span).starts_with("let a") && source.slice(problem.items[0].span).ends_with(';')
    );
    let ItemKind::Let(Let { value, .. }) = &problem.items[0].kind else { panic!() };
    assert_eq!(source.slice(value.span), "-b * ( c + 1 [km] )");
    let ExprKind::Product(factors) = &value.kind else { panic!() };
    assert_eq!(source.slice(factors[0].1.span), "-b");
    assert_eq!(source.slice(factors[1].1.span), "( c + 1 [km] )");
    let ItemKind::Block(block) = &problem.items[1].kind else { panic!() };
    let Statement::One(constraint) = &block.statements[0] else { panic!() };
    assert_eq!(source.slice(constraint.span), "near: a == 2");
}
