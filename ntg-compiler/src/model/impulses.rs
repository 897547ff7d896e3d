//! Derivatives that miss the jumps of what they are taken of.
//!
//! A spline of smoothness `m` may jump, at its knots, in its derivative of order `m`; that of order `m + 1` is then no
//! function: it has impulses there, which no point sees. In an integral or along the way such a derivative says nothing
//! of the jumps, and a finer mesh makes a cost of it as small as one likes (docs/maths.md, section 4).
//! Finds: such derivatives in the objective, in measurements and in constraints along a phase.

use std::collections::HashSet;

use super::derivatives::Jump;
use super::elaborator::Elaborator;
use super::problem::{At, Domain, Leaf};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::NodeId;
use crate::source::Span;
use crate::syntax::ast::{Course, ItemKind, Role};

impl Elaborator<'_> {
    /// Tells of them, and takes them from the jumps.
    pub(super) fn impulses(&mut self) {
        let beyond = |jump: &Jump| jump.order > jump.smoothness;
        // Of a state without equations nothing is known yet.
        if self.has_failed() || !self.jumps.iter().any(beyond) {
            return;
        }
        let used = self.rates_along();
        let (found, left) = std::mem::take(&mut self.jumps)
            .into_iter()
            .partition(|jump| beyond(jump) && used.contains(&(jump.place.0, jump.place.1, jump.order)));
        self.jumps = left;
        let found: Vec<Jump> = found;
        for jump in found {
            let Jump { name, order, smoothness, .. } = &jump;
            let what = match smoothness {
                0 => format!("`{name}`"),
                1 => format!("the derivative of `{name}`"),
                m => format!("the derivative of order {m} of `{name}`"),
            };
            let message = format!("{what} may jump between intervals, and this derivative misses the jumps");
            let finding = Diagnostic::new(Code::MissesJumps, jump.span, message)
                .label(jump.span, format!("is of order {order} of `{name}`"))
                .label(jump.declared, format!("`smoothness = {smoothness}`"));
            let help = self.smoother(&jump);
            self.report(finding.help(help));
        }
    }

    /// What makes the derivative an ordinary function, with the least change.
    fn smoother(&self, jump: &Jump) -> String {
        let Jump { name, order, declared, .. } = jump;
        let declaration = self.items.iter().copied().flatten().find_map(|item| match &item.kind {
            ItemKind::Output(output) if output.names.iter().any(|own| covers(own.name.span, *declared)) => Some(output),
            _ => None,
        });
        match declaration.map(|output| (&output.course, output.role)) {
            Some((Course::Collocated, Role::Input)) if *order == 1 => {
                format!("declare it `input {name}: continuous`, which does not jump")
            }
            Some((Course::Collocated, Role::State)) => format!(
                "name the derivative of order {} by an input that does not jump: `input u: continuous` and `der({name}{}) == u`",
                order - 1,
                if *order > 2 { format!(", {}", order - 1) } else { String::new() }
            ),
            _ => format!(
                "declare `{name}: spline(order = {}, smoothness = {order}, ...)`, whose derivative of order {} does not jump",
                order + 2,
                order - 1
            ),
        }
    }

    /// The derivatives of outputs that occur along phases, in integrals or in constraints: phase, output, order.
    fn rates_along(&self) -> HashSet<(usize, usize, usize)> {
        let (mut along, mut others) = (vec![], vec![]);
        for constraint in &self.problem.constraints {
            let is_along = matches!(constraint.domain, Domain::Path(..));
            if is_along { &mut along } else { &mut others }.push(constraint.body);
        }
        others.extend(self.problem.objective.iter().map(|term| term.body));
        others.extend(self.problem.measurements.iter().map(|measurement| measurement.cost));
        let mut seen: HashSet<NodeId> = HashSet::new();
        let mut rates = HashSet::new();
        let mut open = others;
        while !open.is_empty() {
            for input in self.problem.dag.inputs_of(&std::mem::take(&mut open)) {
                if let Leaf::Integral { integrand, .. } = self.problem.leaves.leaf(input)
                    && seen.insert(*integrand)
                {
                    open.push(*integrand);
                    along.push(*integrand);
                }
            }
        }
        for input in self.problem.dag.inputs_of(&along) {
            if let Leaf::Flat { phase, at: At::Here, output, order, .. } = self.problem.leaves.leaf(input) {
                rates.insert((phase.phase, *output, *order));
            }
        }
        rates
    }
}

/// Whether two places are of one name.
fn covers(name: Span, declared: Span) -> bool {
    declared.start <= name.start && name.end <= declared.end
}
