//! Who owns what in a solution: the problem, its agents, their phases.
//!
//! Takes a `Structure`, gives a tree of scopes, each with the outputs, named expressions and
//! durations that are reached through it: `solution.x`, `solution.covert.x`, `solution.uav(1).x`.
//! The one unnamed agent is the problem itself, and the one unnamed phase is its agent.
//!
//! A thing is listed in a phase when it is defined there, and in an agent when it is defined in
//! each of its phases, where it runs through all of them.

use ntg_structure::{Domain, Family, Named, Output, Structure};

/// What a scope stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The whole problem, which may be an agent's too.
    Problem,
    /// A named agent.
    Agent,
    /// A named phase.
    Phase,
}

/// A scope with its own type in the generated code.
pub(super) struct Scope<'a> {
    /// What it stands for.
    pub(super) kind: Kind,
    /// The names from the problem down to here, each with its family.
    pub(super) path: Vec<(&'a str, Option<Family>)>,
    /// Outputs, which become fields.
    pub(super) outputs: Vec<&'a Output>,
    /// Named expressions, which become methods.
    pub(super) named: Vec<&'a Named>,
    /// Names of the durations that belong here.
    pub(super) durations: Vec<&'a str>,
    /// The scopes within.
    pub(super) children: Vec<Scope<'a>>,
}

impl<'a> Scope<'a> {
    fn new(kind: Kind, path: Vec<(&'a str, Option<Family>)>) -> Self {
        Self { kind, path, outputs: vec![], named: vec![], durations: vec![], children: vec![] }
    }
}

/// The scope of the whole problem.
pub(super) fn scopes(structure: &Structure) -> Scope<'_> {
    let mut root = Scope::new(Kind::Problem, vec![]);
    for (agent, declared) in structure.agents.iter().enumerate() {
        match &declared.name {
            None => fill(&mut root, structure, agent),
            Some(name) => {
                let mut scope = Scope::new(Kind::Agent, vec![(name.as_str(), declared.family)]);
                fill(&mut scope, structure, agent);
                root.children.push(scope);
            }
        }
    }
    root
}

/// Puts an agent's things into its scope, and its named phases below.
fn fill<'a>(scope: &mut Scope<'a>, structure: &'a Structure, agent: usize) {
    scope.durations.extend(structure.agents[agent].duration_name.as_deref());
    // Numbers belong to the agent as a whole.
    let numbers = structure.named.iter().filter(|named| named.domain == Domain::Mission && named.agent == agent);
    scope.named.extend(by_name(numbers));
    let phases: Vec<usize> = (0..structure.phases.len()).filter(|p| structure.phases[*p].agent == agent).collect();
    let along = |phase: usize| by_name(structure.named.iter().filter(move |named| phase_of(named) == Some(phase)));

    // What the first phase has belongs to the agent if all the others have it too.
    if let Some((first, others)) = phases.split_first() {
        let has_output = |phase: usize, name: &str| structure.phases[phase].outputs.iter().any(|o| o.name == name);
        let outputs = structure.phases[*first].outputs.iter().filter(|output| !output.is_helper());
        scope.outputs.extend(outputs.filter(|output| others.iter().all(|p| has_output(*p, &output.name))));
        let named =
            along(*first).filter(|named| others.iter().all(|p| along(*p).any(|other| other.name == named.name)));
        scope.named.extend(named);
    }

    for phase in phases {
        let declared = &structure.phases[phase];
        let Some(name) = &declared.name else {
            scope.durations.extend(declared.duration_name.as_deref());
            continue;
        };
        let mut path = scope.path.clone();
        path.push((name, declared.family));
        let mut within = Scope::new(Kind::Phase, path);
        within.outputs.extend(declared.outputs.iter().filter(|output| !output.is_helper()));
        within.named.extend(along(phase));
        within.durations.extend(declared.duration_name.as_deref());
        scope.children.push(within);
    }
}

/// One for each name: parts of a family may have formulas of their own.
fn by_name<'a>(list: impl Iterator<Item = &'a Named>) -> impl Iterator<Item = &'a Named> {
    let mut known: Vec<&str> = vec![];
    list.filter(move |named| {
        let is_new = !known.contains(&named.name.as_str());
        known.push(&named.name);
        is_new
    })
}

/// The phase along which an expression is defined.
fn phase_of(named: &Named) -> Option<usize> {
    match &named.domain {
        Domain::Path { phase, .. } | Domain::Start(phase) | Domain::End(phase) => Some(phase.phase),
        Domain::Mission => None,
    }
}
