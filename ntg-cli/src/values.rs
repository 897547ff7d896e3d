//! `--set NAME=VALUE`: parameters and constants in their declared units, or with a unit.

use ntg_compiler::model::{self, Given};
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;

/// What is set on the command line, but for constants, which decide what is compiled.
pub(crate) struct Assignments {
    /// `NAME=VALUE` of parameters.
    pub(crate) parameters: Vec<String>,
    /// The names of the spec's constants.
    constants: Vec<String>,
}

impl Assignments {
    /// The constants that are set, and everything else.
    pub(crate) fn of(source: &Source, set: &[String]) -> (Vec<Given>, Self) {
        let constants = if set.is_empty() { vec![] } else { model::constants(source) };
        let (mut given, mut parameters) = (vec![], vec![]);
        for assignment in set {
            match self::given(assignment).filter(|given| constants.contains(&given.name)) {
                Some(constant) => given.push(constant),
                None => parameters.push(assignment.clone()),
            }
        }
        (given, Self { parameters, constants })
    }

    /// Sets the parameters.
    pub(crate) fn put(&self, problem: &mut Interpreted) -> Result<(), String> {
        self.parameters.iter().try_for_each(|assignment| self.put_one(problem, assignment))
    }

    /// Sets a parameter, all members of an array (`a=1,2,3`), or one member (`a[2]=1`, of a matrix `A[2,1]=1`).
    pub(crate) fn put_one(&self, problem: &mut Interpreted, assignment: &str) -> Result<(), String> {
        let say = |message: String| format!("--set {assignment}: {message}");
        let (target, text) = assignment
            .split_once('=')
            .filter(|(_, text)| !text.trim().is_empty())
            .ok_or_else(|| say("write NAME=VALUE, such as `v_max=0.2` or `v_max=\"200 [m/s]\"`".to_owned()))?;
        problem.assign(target, text).map_err(|message| {
            let is_unknown = message.starts_with("there is no parameter") && !self.constants.is_empty();
            match is_unknown {
                true => say(format!("{message}; the constants are: `{}`", self.constants.join("`, `"))),
                false => say(message),
            }
        })
    }
}

/// `NAME=VALUE`; none of what has another form.
pub(crate) fn given(assignment: &str) -> Option<Given> {
    let (name, text) = assignment.split_once('=')?;
    let given = Given { name: name.trim().to_owned(), text: ntg_interp::bracketed(text.trim()) };
    (!given.text.is_empty()).then_some(given)
}
