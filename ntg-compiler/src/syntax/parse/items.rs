//! The problem, and which function reads which item.

use super::parts::Parts;
use super::{Build, Scope};
use crate::diagnostic::Code;
use crate::source::Span;
use crate::syntax::ast::{Item, ItemKind, Problem, Role};
use crate::syntax::grammar::{Pair, Rule};

impl Build {
    pub(super) fn problem(&mut self, pair: Pair<'_>) -> Problem {
        let all = self.span(&pair);
        let mut parts = Parts::of(pair);
        let doc = parts.optional(Rule::doc).map(|pair| self.doc(pair));
        let head = parts.required(Rule::problem_head);
        let span = Span { start: self.span(&head).start, end: all.end };
        let name = self.name(&Parts::of(head).required(Rule::name));
        let items = parts.map(|pair| self.item(pair)).collect();
        Problem { doc, name, items, span }
    }

    /// The items of an agent or phase.
    pub(super) fn items(&mut self, scope: Scope, parts: Parts<'_>) -> Vec<Item> {
        let outer = std::mem::replace(&mut self.scope, scope);
        let items = parts.map(|pair| self.item(pair)).collect();
        self.scope = outer;
        items
    }

    pub(in crate::syntax) fn item(&mut self, pair: Pair<'_>) -> Item {
        let mut parts = Parts::of(pair);
        let doc = parts.optional(Rule::doc).map(|pair| self.doc(pair));
        let declaration = parts.any();
        let span = self.span(&declaration);
        self.check_scope(&declaration);
        Item { doc, kind: self.declaration(declaration), span }
    }

    fn declaration(&mut self, pair: Pair<'_>) -> ItemKind {
        match pair.as_rule() {
            Rule::constant => ItemKind::Const(self.constant(pair)),
            Rule::table => ItemKind::Table(self.table(pair)),
            Rule::param => ItemKind::Param(self.param(pair)),
            Rule::variable => ItemKind::Variable(self.variable(pair)),
            Rule::output => ItemKind::Output(self.output(pair)),
            Rule::state => ItemKind::Output(self.process(pair, Role::State)),
            Rule::input => ItemKind::Output(self.process(pair, Role::Input)),
            Rule::function => ItemKind::Function(self.function(pair)),
            Rule::named => ItemKind::Let(self.named(pair)),
            Rule::continuation => ItemKind::Continuation(self.continuation(pair)),
            Rule::domain => ItemKind::Domain(self.domain(pair)),
            Rule::duration => ItemKind::Duration(self.duration(pair)),
            Rule::start => ItemKind::Start(self.start(pair)),
            Rule::phase => ItemKind::Phase(self.phase(pair)),
            Rule::agent => ItemKind::Agent(self.agent(pair)),
            Rule::scenario => ItemKind::Scenario(self.scenario(pair)),
            Rule::shared => ItemKind::Shared(self.shared(pair)),
            Rule::jump => ItemKind::Jump(self.jump(pair)),
            Rule::continuous => ItemKind::Continuous(self.continuous(pair)),
            Rule::periodic => ItemKind::Periodic(self.periodic(pair)),
            Rule::collocation => ItemKind::Collocation(self.collocation(pair)),
            Rule::objective => ItemKind::Objective(self.objective(pair)),
            Rule::block => ItemKind::Block(self.block(pair)),
            Rule::at_block => ItemKind::At(self.at_block(pair)),
            Rule::guess => ItemKind::Guess(self.guess(pair)),
            rule => unreachable!("the grammar has no declaration {rule:?}"),
        }
    }

    /// Phases and agents do not nest; some statements make sense in a phase only, or nowhere in one.
    fn check_scope(&mut self, declaration: &Pair<'_>) {
        let (word, where_to) = match (declaration.as_rule(), self.scope) {
            (rule, Scope::Library) => return self.check_library_item(declaration, rule),
            (Rule::domain, Scope::Phase | Scope::Agent | Scope::Scenario) => {
                ("domain", "write it directly in the problem: all agents have the same independent variable")
            }
            (rule, Scope::Scenario) => match outside_scenarios(rule, declaration.as_str()) {
                Some(found) => found,
                None => return,
            },
            (Rule::scenario, Scope::Phase) => {
                ("scenario", "write it outside the phases: a scenario goes through all of them")
            }
            (Rule::shared, _) => ("shared", "write it in the scenario whose members share it"),
            (Rule::phase, Scope::Phase) => ("phase", "write it after the phase, with `after`"),
            (Rule::agent, Scope::Phase | Scope::Agent) => ("agent", "write it directly in the problem"),
            (Rule::start, Scope::Phase) => {
                ("start", "write it in the agent: a phase starts when the one before it ends")
            }
            (Rule::jump, Scope::Problem | Scope::Agent) => ("jump", "write it in the phase that begins with the jump"),
            (Rule::continuous, Scope::Problem | Scope::Agent) => {
                ("continuous", "write it in the later one of the two phases that meet")
            }
            _ => return,
        };
        self.misplaced_item(declaration, word, where_to);
    }

    /// A library has no values of its own to be found or changed.
    fn check_library_item(&mut self, declaration: &Pair<'_>, rule: Rule) {
        let text = declaration.as_str();
        let is_param = rule == Rule::param || (rule == Rule::table && text.starts_with("param"));
        if matches!(rule, Rule::constant | Rule::function | Rule::table) && !is_param {
            return;
        }
        let word: String = text.chars().take_while(|c| c.is_alphanumeric()).collect();
        let help = match rule {
            _ if is_param => "what a program may change is an argument of a function",
            Rule::named => "write `const`, or `fn` with what it depends on as arguments",
            _ => "write it in the problem that uses the library",
        };
        let start = self.span(declaration).start;
        let span = Span { start, end: start + word.len() as u32 };
        let message = format!("`{word}` may not stand in a library, which has only `use`, `const`, `fn` and `table`");
        self.report(Code::WrongLibrary, span, message, help);
    }

    fn misplaced_item(&mut self, declaration: &Pair<'_>, word: &str, where_to: &str) {
        let place = match self.scope {
            Scope::Problem => "directly in the problem",
            Scope::Agent => "in an agent",
            Scope::Phase => "in a phase",
            Scope::Scenario => "in a scenario",
            Scope::Library => "in a library",
        };
        let start = self.span(declaration).start;
        let span = Span { start, end: start + word.len() as u32 };
        self.report(Code::Misplaced, span, format!("`{word}` may not stand {place}"), where_to);
    }
}

/// What may not stand in a scenario, and where to write it.
fn outside_scenarios(rule: Rule, text: &str) -> Option<(&'static str, &'static str)> {
    const ALL: &str = "write it outside the scenario, whose members have it in common";
    const TIME: &str = "write it outside the scenario: its members share one time";
    Some(match rule {
        Rule::table if text.starts_with("param") => ("param", ALL),
        Rule::table => ("table", ALL),
        Rule::param => (
            "param",
            "write it outside the scenario, for numbers of each member as an array: `param p[3] = (1, 2, 3);`",
        ),
        Rule::constant => {
            ("const", "write `let` for a number that depends on the member, or move it outside the scenario")
        }
        Rule::function => ("fn", "write it outside the scenario, with what it depends on as arguments"),
        Rule::continuation => ("continuation", ALL),
        Rule::collocation => ("collocation", TIME),
        Rule::duration => ("duration", TIME),
        Rule::start => ("start", TIME),
        Rule::phase => ("phase", TIME),
        Rule::agent => ("agent", "write the scenario in the agent"),
        Rule::scenario => ("scenario", "scenarios do not nest: write it beside this one"),
        Rule::jump => (
            "jump",
            "a scenario goes through all phases: write `jump name.x;` in the phase that begins with the jump, with the name of the scenario",
        ),
        Rule::continuous => ("continuous", TIME),
        _ => return None,
    })
}
