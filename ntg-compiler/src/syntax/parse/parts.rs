//! Walking over the parts of a rule: keywords and punctuation are dropped, the rest is taken in order.

use crate::syntax::grammar::{Pair, Pairs, Rule};

/// The parts of a rule that mean something, in order.
pub(super) struct Parts<'t> {
    pairs: Pairs<'t>,
    /// The next part, once it was looked at: every look at a pair makes it anew.
    ahead: Option<Pair<'t>>,
}

impl<'t> Parts<'t> {
    pub(super) fn of(pair: Pair<'t>) -> Self {
        Self { pairs: pair.into_inner(), ahead: None }
    }

    /// The next part if it is a `rule`.
    pub(super) fn optional(&mut self, rule: Rule) -> Option<Pair<'t>> {
        let next = self.next()?;
        if next.as_rule() == rule {
            return Some(next);
        }
        self.ahead = Some(next);
        None
    }

    /// The next part, which the grammar says is a `rule`.
    pub(super) fn required(&mut self, rule: Rule) -> Pair<'t> {
        self.optional(rule).expect("the grammar puts this part here")
    }

    /// The next part, which the grammar says is there.
    pub(super) fn any(&mut self) -> Pair<'t> {
        self.next().expect("the grammar puts a part here")
    }
}

impl<'t> Iterator for Parts<'t> {
    type Item = Pair<'t>;

    fn next(&mut self) -> Option<Pair<'t>> {
        self.ahead.take().or_else(|| self.pairs.find(|pair| !is_mute(pair.as_rule())))
    }
}

/// Whether a rule is a keyword or a punctuation mark, which says nothing once it has matched.
pub(in crate::syntax) fn is_mute(rule: Rule) -> bool {
    is_punctuation(rule) || is_keyword(rule)
}

fn is_punctuation(rule: Rule) -> bool {
    use Rule as R;
    matches!(
        rule,
        R::left_brace
            | R::right_brace
            | R::left_parenthesis
            | R::right_parenthesis
            | R::left_bracket
            | R::right_bracket
            | R::semicolon
            | R::colon
            | R::double_colon
            | R::comma
            | R::caret
            | R::dot
            | R::dots
            | R::equals
            | R::EOI
    )
}

/// `kw_param` and `kw_fit` and the dots are looked for by hand where they decide something.
fn is_keyword(rule: Rule) -> bool {
    use Rule as R;
    matches!(
        rule,
        R::kw_after
            | R::kw_agent
            | R::kw_as
            | R::kw_at
            | R::kw_collocation
            | R::kw_column
            | R::kw_columns
            | R::kw_const
            | R::kw_continuation
            | R::kw_continuous
            | R::kw_duration
            | R::kw_else
            | R::kw_domain
            | R::kw_except
            | R::kw_fn
            | R::kw_for
            | R::kw_from
            | R::kw_guess
            | R::kw_if
            | R::kw_in
            | R::kw_input
            | R::kw_jump
            | R::kw_let
            | R::kw_output
            | R::kw_param
            | R::kw_periodic
            | R::kw_phase
            | R::kw_problem
            | R::kw_rows
            | R::kw_sigma
            | R::kw_scenario
            | R::kw_shared
            | R::kw_smooth
            | R::kw_soft
            | R::kw_spline
            | R::kw_start
            | R::kw_state
            | R::kw_table
            | R::kw_through
            | R::kw_to
            | R::kw_until
            | R::kw_up
            | R::kw_use
            | R::kw_variable
            | R::kw_weight
    )
}
