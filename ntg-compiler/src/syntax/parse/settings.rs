//! Settings in parentheses, `(order = 5, intervals = 8)`: each known, each once.

use super::Build;
use super::parts::Parts;
use crate::diagnostic::Code;
use crate::syntax::ast::{Expr, Ident, Values};
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::words::nearest;

/// The settings that were given to `owner` and not yet asked for, and the names of those that were.
pub(super) struct Settings {
    owner: &'static str,
    given: Vec<(Ident, Values)>,
    known: Vec<&'static str>,
}

impl Build {
    pub(super) fn settings(&mut self, owner: &'static str, pair: Option<Pair<'_>>) -> Settings {
        let given = pair.into_iter().flat_map(Parts::of).map(|pair| self.setting(pair)).collect();
        Settings { owner, given, known: vec![] }
    }

    fn setting(&mut self, pair: Pair<'_>) -> (Ident, Values) {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        (name, self.values(parts.required(Rule::values)))
    }
}

impl Settings {
    /// Takes a setting that is one expression.
    pub(super) fn value(&mut self, build: &mut Build, name: &'static str) -> Option<Expr> {
        let values = self.values(build, name)?;
        if values.elements.len() > 1 {
            build.report(Code::Setting, values.span, format!("`{name}` takes one value"), "write one value here");
        }
        values.elements.into_iter().next()
    }

    /// Takes a setting that may be a tuple.
    pub(super) fn values(&mut self, build: &mut Build, name: &'static str) -> Option<Values> {
        self.known.push(name);
        let mut taken = None;
        for (given, values) in std::mem::take(&mut self.given) {
            if given.text != name {
                self.given.push((given, values));
            } else if taken.is_none() {
                taken = Some(values);
            } else {
                build.report(Code::Setting, given.span, format!("`{name}` is given twice"), "remove one of the two");
            }
        }
        taken
    }

    /// Reports the settings that no one asked for.
    pub(super) fn finish(self, build: &mut Build) {
        for (name, _) in &self.given {
            let message = format!("`{}` has no setting `{}`", self.owner, name.text);
            let help = match nearest(&name.text, self.known.iter().copied()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None if name.text == "periodic" => {
                    "what ends as it begins has a statement of its own: `periodic x;`".into()
                }
                None if self.known.is_empty() => "it takes no settings at all".into(),
                None => format!("it takes {}", list(&self.known)),
            };
            build.report(Code::Setting, name.span, message, help);
        }
    }
}

/// `` `a`, `b` and `c` ``
fn list(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
        None => String::new(),
    }
}
