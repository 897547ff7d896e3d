//! The only file that names pest: the grammar's rules, and where it got stuck.
//!
//! Takes clean text (see `scan`), gives pairs, or the farthest place reached and what would have been
//! understood there.

use pest::Parser;
use pest::error::{ErrorVariant, InputLocation};

pub(super) use generated::Rule;

mod generated {
    //! What pest makes of `grammar.pest`.

    #[derive(pest_derive::Parser)]
    #[grammar = "syntax/grammar.pest"]
    pub(crate) struct Grammar;
}

/// A matched rule with its text and its parts.
pub(super) type Pair<'t> = pest::iterators::Pair<'t, Rule>;

/// The parts of a matched rule.
pub(super) type Pairs<'t> = pest::iterators::Pairs<'t, Rule>;

/// Where the grammar could not go on.
#[derive(Debug)]
pub(super) struct Stuck {
    /// The byte, from the start of the text that was given.
    pub(super) at: usize,
    /// The rules that were tried there.
    pub(super) expected: Vec<Rule>,
}

/// Matches `rule` at the front of `text`.
pub(super) fn front(rule: Rule, text: &str) -> Result<Pair<'_>, Stuck> {
    match generated::Grammar::parse(rule, text) {
        Ok(mut pairs) => Ok(pairs.next().expect("a rule that matched gives its pair")),
        Err(error) => {
            let (InputLocation::Pos(at) | InputLocation::Span((at, _))) = error.location;
            let expected = match error.variant {
                ErrorVariant::ParsingError { positives, .. } => positives,
                ErrorVariant::CustomError { .. } => vec![],
            };
            Err(Stuck { at, expected })
        }
    }
}

/// A whole spec.
pub(super) fn spec(text: &str) -> Result<Pair<'_>, Stuck> {
    front(Rule::spec, text)
}

/// A whole file without a problem.
pub(super) fn library(text: &str) -> Result<Pair<'_>, Stuck> {
    front(Rule::library, text)
}

/// An expression and nothing else.
pub(super) fn expression(text: &str) -> Result<Pair<'_>, Stuck> {
    let whole = front(Rule::whole_expression, text)?;
    Ok(whole.into_inner().next().expect("`whole_expression` holds an expression"))
}

/// A list of values and nothing else.
pub(super) fn values(text: &str) -> Result<Pair<'_>, Stuck> {
    let whole = front(Rule::whole_values, text)?;
    Ok(whole.into_inner().next().expect("`whole_values` holds a list"))
}
