//! What the grammar would have understood, as few kinds of things, each once, in a fixed order.

use std::fmt;

use crate::syntax::grammar::Rule;

/// The rules that were tried.
pub(super) struct Expected {
    rules: Vec<Rule>,
}

impl Expected {
    pub(super) fn new(rules: &[Rule]) -> Self {
        let mut rules = rules.to_vec();
        if rules.contains(&Rule::extent) {
            rules.extend([Rule::equals, Rule::kw_in]);
        }
        if rules.contains(&Rule::course) {
            rules.push(Rule::kw_continuous);
        }
        Self { rules }
    }

    pub(super) fn has(&self, rule: Rule) -> bool {
        self.rules.contains(&rule)
    }

    pub(super) fn has_expression(&self) -> bool {
        self.rules.iter().any(|rule| kind(*rule) == Kind::Expression)
    }

    /// Whether a name would have done, alone or as an expression.
    pub(super) fn wants_a_name(&self) -> bool {
        self.has_expression() || self.rules.iter().any(|rule| kind(*rule) == Kind::Name)
    }

    /// Whether only parts of a unit would have done.
    pub(super) fn is_inside_unit(&self) -> bool {
        let of_unit = |rule: &Rule| matches!(kind(*rule), Kind::Unit | Kind::Power) && *rule != Rule::unit;
        let closes =
            |rule: &Rule| matches!(rule, Rule::right_bracket | Rule::right_parenthesis | Rule::caret | Rule::minus);
        self.rules.iter().any(of_unit) && self.rules.iter().all(|rule| of_unit(rule) || closes(rule))
    }

    /// What to name, in the order in which it is said, without what only clouds it.
    fn words(&self) -> Vec<String> {
        let mut kinds: Vec<Kind> = self.rules.iter().map(|rule| kind(*rule)).collect();
        kinds.sort();
        kinds.dedup();
        let has = |kind: Kind| kinds.contains(&kind);
        let (expression, statement) = (has(Kind::Expression), has(Kind::Statement));
        let (operator, relation) = (has(Kind::Operator), has(Kind::Relation));
        // Behind a bare name a path or an argument may go on.
        let opens = has(Kind::Mark("(")) || self.has(Rule::dot);
        let ends = has(Kind::Mark(";"));
        let major = kinds.iter().any(|kind| !kind.is_minor());
        kinds.retain(|kind| match kind {
            // An expression may begin with both.
            Kind::Name | Kind::Mark("(") if expression => false,
            Kind::Name | Kind::Keyword(_) if statement => false,
            // What is complete may always go on: with an index, a path, a unit, as a call, as a name before a colon.
            kind if kind.is_minor() => !major,
            Kind::Mark("(") if operator => false,
            Kind::Mark(":") if operator && opens => false,
            Kind::Relation => !ends,
            Kind::Operator | Kind::Keyword(_) if relation && !ends => false,
            _ => true,
        });
        kinds.iter().map(Kind::words).collect()
    }
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = self.words();
        match words.split_last() {
            None => f.write_str("something else"),
            Some((only, [])) => f.write_str(only),
            Some((last, rest)) => write!(f, "{} or {last}", rest.join(", ")),
        }
    }
}

/// The kinds of things that a message names, in the order in which it does.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Statement,
    Constraint,
    Guess,
    Expression,
    Name,
    Unit,
    Power,
    Relation,
    Symmetry,
    Setting,
    String,
    Operator,
    Keyword(String),
    Mark(&'static str),
    /// Marks after which an expression or name goes on.
    Minor(&'static str),
    End,
}

impl Kind {
    fn is_minor(&self) -> bool {
        matches!(self, Self::Minor(_) | Self::Unit | Self::Symmetry)
    }

    fn words(&self) -> String {
        let words = match self {
            Self::Statement => "a statement",
            Self::Constraint => "a constraint",
            Self::Guess => "a guess",
            Self::Expression => "an expression",
            Self::Name => "a name",
            Self::Unit => "a unit",
            Self::Power => "a whole number",
            Self::Relation => "`==`, `<=` or `>=`",
            Self::Symmetry => "`even`, `periodic`",
            Self::Setting => "a setting",
            Self::String => "a file name in quotes",
            Self::Operator => "an operator",
            Self::Keyword(word) => return format!("`{word}`"),
            Self::Mark(mark) | Self::Minor(mark) => return format!("`{mark}`"),
            Self::End => "the end of the text",
        };
        words.into()
    }
}

fn kind(rule: Rule) -> Kind {
    use Rule as R;
    match rule {
        R::item
        | R::constant
        | R::table
        | R::table_head
        | R::param
        | R::variable
        | R::output
        | R::state
        | R::input
        | R::function
        | R::named
        | R::continuation
        | R::domain
        | R::duration
        | R::start
        | R::phase
        | R::phase_head
        | R::agent
        | R::agent_head
        | R::scenario
        | R::scenario_head
        | R::shared
        | R::jump
        | R::continuous
        | R::periodic
        | R::collocation
        | R::objective
        | R::sense
        | R::block
        | R::block_head
        | R::at_block
        | R::at_head
        | R::guess
        | R::guess_head => Kind::Statement,
        R::statement | R::constraint | R::repeated | R::softness | R::kw_soft => Kind::Constraint,
        R::guess_statement | R::guess_repeated | R::route | R::assign => Kind::Guess,
        R::bounds
        | R::expression
        | R::whole_expression
        | R::whole_values
        | R::minus
        | R::number
        | R::numeral
        | R::parenthesis
        | R::conditional
        | R::branch
        | R::kw_if
        | R::condition
        | R::rows_of
        | R::kw_rows
        | R::call
        | R::callee
        | R::bare_name
        | R::word
        | R::path
        | R::values
        | R::value_list
        | R::cells
        | R::row
        | R::function_word
        | R::event
        | R::event_word => Kind::Expression,
        R::name
        | R::qualifier
        | R::qualifier_front
        | R::module
        | R::argument
        | R::segment
        | R::axis
        | R::axis_name
        | R::declared
        | R::objective_name
        | R::constraint_name
        | R::index_range => Kind::Name,
        R::axis_size | R::ranged_axis | R::size | R::whole_size | R::whole_number | R::index => Kind::Expression,
        R::unit
        | R::unit_product
        | R::unit_operator
        | R::unit_factor
        | R::unit_one
        | R::unit_symbol
        | R::unit_group => Kind::Unit,
        R::unit_power | R::unit_digits => Kind::Power,
        R::relation => Kind::Relation,
        R::symmetry => Kind::Symmetry,
        R::setting => Kind::Setting,
        R::string => Kind::String,
        R::operator => Kind::Operator,
        R::EOI => Kind::End,
        _ => mark(rule),
    }
}

fn mark(rule: Rule) -> Kind {
    use Rule as R;
    match rule {
        R::left_brace | R::value_block | R::rows | R::head_end => Kind::Mark("{"),
        R::right_brace => Kind::Mark("}"),
        R::left_parenthesis | R::settings => Kind::Mark("("),
        R::right_parenthesis => Kind::Mark(")"),
        R::left_bracket | R::array_size | R::shape | R::only_a_unit | R::family | R::indices => Kind::Minor("["),
        R::right_bracket => Kind::Mark("]"),
        R::semicolon => Kind::Mark(";"),
        R::colon => Kind::Mark(":"),
        R::comma => Kind::Mark(","),
        R::double_colon | R::use_names => Kind::Minor("::"),
        R::use_item => Kind::Keyword("use".into()),
        R::library => Kind::Statement,
        R::alias => Kind::Keyword("as".into()),
        R::trailing_comma => Kind::Mark(","),
        R::caret => Kind::Minor("^"),
        R::dot => Kind::Minor("."),
        R::dots => Kind::Mark(".."),
        R::equals => Kind::Mark("="),
        R::extent => Kind::Mark("="),
        R::after => Kind::Keyword("after".into()),
        R::part => Kind::Keyword("from".into()),
        R::end_word => Kind::Keyword("initial` or `final".into()),
        R::spline => Kind::Keyword("spline".into()),
        // A list may come from a file; who has begun to write one is told of the list.
        R::file => Kind::Minor("from"),
        R::columns | R::kw_columns => Kind::Minor("columns"),
        R::kw_column => Kind::Minor("column"),
        R::deviation => Kind::Minor("sigma"),
        R::smoothness => Kind::Keyword("smooth".into()),
        R::course => Kind::Keyword("held".into()),
        R::method | R::domain_name => Kind::Name,
        R::place
        | R::whole_block_head
        | R::whole_at_head
        | R::whole_guess_head
        | R::whole_phase_head
        | R::whole_agent_head
        | R::whole_scenario_head
        | R::whole_table_head => Kind::Statement,
        R::problem | R::problem_head | R::whole_problem_head => Kind::Keyword("problem".into()),
        R::for_head | R::whole_for_head => Kind::Keyword("for".into()),
        R::doc | R::doc_line => Kind::Minor("///"),
        _ => {
            // A keyword's rule is called after it.
            let name = format!("{rule:?}");
            Kind::Keyword(name.trim_start_matches("kw_").to_owned())
        }
    }
}
