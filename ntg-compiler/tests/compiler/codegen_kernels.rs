//! What kernels look like as Rust, and that their size and depth stay bounded.

use crate::codegen_support::{body, expand, one_kernel, rest};

/// The function of a program of one kernel that gives its values.
#[track_caller]
fn values(program: &ntg_compiler::program::Program) -> String {
    let text = expand(program);
    let start = text.find("/// `out[0]`").expect("rows are documented");
    let rest = &text[start..];
    let end = rest.find("\n            }\n").expect("the function ends");
    rest[..end + 14].lines().map(|line| format!("{}\n", line.strip_prefix("            ").unwrap_or(line))).collect()
}

#[test]
fn operations_keep_their_order_with_the_parentheses_that_needs() {
    let program = one_kernel(body(&["a", "b", "c"], |dag, x| {
        let (a, b, c) = (x[0], x[1], x[2]);
        let left = dag.sub(a, b);
        let left = dag.sub(left, c); // a - b - c
        let right = dag.sub(b, c);
        let right = dag.sub(a, right); // a - (b - c)
        let quotient = dag.mul(b, c);
        let quotient = dag.div(a, quotient); // a / (b * c)
        let sum = dag.add(a, b);
        let negated = dag.neg(sum); // -(a + b)
        vec![left, right, quotient, negated]
    }));
    insta::assert_snapshot!(values(&program));
}

#[test]
fn a_shared_node_has_a_let_and_a_single_use_has_none() {
    let program = one_kernel(body(&["x_0", "x_1"], |dag, x| {
        let sine = dag.sin(x[0]);
        let square = dag.powi(x[1], 2);
        let product = dag.mul(sine, square);
        let quotient = dag.div(x[0], sine);
        vec![product, quotient]
    }));
    insta::assert_snapshot!(values(&program));
}

#[test]
fn names_of_the_spec_stay_apart_from_ours_and_from_keywords() {
    let program = one_kernel(body(&["t1", "z", "type", "None", "ψ"], |dag, x| vec![dag.sum(x)]));
    insta::assert_snapshot!(values(&program));
}

#[test]
fn numbers_are_exact_and_signed() {
    let numbers = [-2.0, 0.1 + 0.2, 1e-20, 6.02e23, f64::MAX, f64::MIN_POSITIVE];
    let program = one_kernel(body(&["a"], |dag, x| {
        let numbers = numbers.map(|number| dag.constant(number));
        numbers.map(|number| dag.pow(number, x[0])).to_vec()
    }));
    let text = values(&program);
    insta::assert_snapshot!(text);
    let written: Vec<f64> =
        text.lines().filter_map(|line| line.split_once("splat(simd, ")?.1.split_once(')')?.0.parse().ok()).collect();
    assert_eq!(written, numbers);
}

#[test]
fn a_function_call_takes_every_operation_beyond_arithmetic() {
    let program = one_kernel(body(&["a", "b"], |dag, x| {
        let (a, b) = (x[0], x[1]);
        let condition = dag.less_eq(a, b);
        let smooth = dag.logistic(a);
        vec![dag.hypot(a, b), dag.select(condition, smooth, b), dag.powi(a, -3), dag.table(2, &[1, 0], &[a, b])]
    }));
    insta::assert_snapshot!(values(&program));
}

#[test]
fn derivatives_are_weighted_and_documented() {
    let text = expand(&rest());
    let start = text.find("mod kernels").expect("there are kernels");
    insta::assert_snapshot!(&text[start..]);
}

#[test]
fn a_long_sum_is_many_short_lines() {
    let terms = 200_000;
    let program = one_kernel(body(&["a"], |dag, x| {
        let mut sum = x[0];
        for i in 0..terms {
            let term = dag.constant(f64::from(i) + 0.5);
            let term = dag.mul(term, x[0]);
            sum = dag.add(sum, term);
        }
        vec![sum]
    }));
    // Tokens between semicolons, over all nested groups.
    let (mut lines, mut length, mut longest) = (0, 0, 0);
    let mut open = vec![ntg_compiler::codegen::generate(&program).into_iter()];
    while let Some(tokens) = open.last_mut() {
        match tokens.next() {
            None => drop(open.pop()),
            Some(proc_macro2::TokenTree::Group(group)) => open.push(group.stream().into_iter()),
            Some(proc_macro2::TokenTree::Punct(mark)) if mark.as_char() == ';' => {
                lines += 1;
                longest = longest.max(length);
                length = 0;
            }
            Some(_) => length += 1,
        }
    }
    assert!(lines > terms / 6, "{lines}");
    assert!(longest < 500, "{longest}"); // The longest is an item around the kernels, not a line of theirs.
}

#[test]
fn the_same_program_gives_the_same_bytes() {
    assert_eq!(expand(&rest()), expand(&rest()));
}
