//! The law of the order: declarations, statements of one block and terms of the objective may be written in any order.
//!
//! The tree of each shipped spec is put in another order wherever `docs/language.md` says that order has no meaning, and
//! compiled and solved again. Variables, rows and terms then have other numbers, sums are added up and unknowns eliminated in
//! another order, and nothing else changes. What has an order keeps it: `after` of phases, points of routes, values of lists,
//! and several continuations, of which the later is solved within the earlier.

mod shipped;

use ntg_compiler::model::{self, Loader};
use ntg_compiler::source::Source;
use ntg_compiler::syntax::ast::{Expr, ExprKind, GuessKind, Item, ItemKind, Sign, Spec, Statement};
use ntg_compiler::{program, syntax};
use ntg_interp::Interpreted;
use ntg_runtime::settings::Settings;
use shipped::{Change, holds};

/// Four minima of its mesh, three of them between 7.91717 and 7.91790 (`specs/gallery/expected.json`): which one is found, and in
/// how many iterations, depends on rounding.
const MANY_MINIMA: &str = "free_flying_robot";

/// Puts lists in another order.
enum Order {
    Reversed,
    Shuffled(fastrand::Rng),
}

impl Order {
    fn list<T>(&mut self, list: &mut [T]) {
        match self {
            Self::Reversed => list.reverse(),
            Self::Shuffled(random) => random.shuffle(list),
        }
    }

    fn items(&mut self, items: &mut [Item]) {
        items.iter_mut().for_each(|item| self.item(&mut item.kind));
        let is_continuation = |item: &Item| matches!(item.kind, ItemKind::Continuation(_));
        let continuations: Vec<Item> = items.iter().filter(|item| is_continuation(item)).cloned().collect();
        self.list(items);
        let places = items.iter_mut().filter(|item| is_continuation(item));
        places.zip(continuations).for_each(|(place, continuation)| *place = continuation);
    }

    fn item(&mut self, item: &mut ItemKind) {
        match item {
            ItemKind::Phase(phase) => self.items(&mut phase.items),
            ItemKind::Agent(agent) => self.items(&mut agent.items),
            ItemKind::Scenario(scenario) => self.items(&mut scenario.items),
            ItemKind::Block(block) => self.statements(&mut block.statements),
            ItemKind::At(block) => self.statements(&mut block.statements),
            ItemKind::Guess(guess) => self.guesses(&mut guess.statements),
            ItemKind::Output(output) => self.list(&mut output.names),
            ItemKind::Variable(variable) => self.list(&mut variable.names),
            ItemKind::Jump(jump) => self.list(&mut jump.outputs),
            ItemKind::Continuous(continuous) => self.list(&mut continuous.outputs),
            ItemKind::Periodic(periodic) => self.list(&mut periodic.outputs),
            ItemKind::Shared(shared) => self.list(&mut shared.inputs),
            ItemKind::Objective(objective) => self.terms(&mut objective.value),
            _ => {}
        }
    }

    fn statements<T>(&mut self, statements: &mut [Statement<T>]) {
        for statement in &mut *statements {
            if let Statement::For(repeated) = statement {
                self.statements(&mut repeated.body);
            }
        }
        self.list(statements);
    }

    fn guesses(&mut self, statements: &mut [Statement<GuessKind>]) {
        self.statements(statements);
    }

    /// The terms of a sum, and of sums under integrals of it.
    fn terms(&mut self, value: &mut Expr) {
        match &mut value.kind {
            ExprKind::Neg(of) | ExprKind::Integral { of, .. } => self.terms(of),
            ExprKind::Sum(terms) => {
                terms.iter_mut().for_each(|(_, term)| self.terms(term));
                self.list(terms);
                // The tree has no sign before a first term: `-a + b` begins with a negation.
                let (sign, first) = &mut terms[0];
                if *sign == Sign::Minus {
                    let (of, span) = (Box::new(first.clone()), first.span);
                    (*sign, *first) = (Sign::Plus, Expr { kind: ExprKind::Neg(of), span });
                }
            }
            _ => {}
        }
    }
}

fn reverse(spec: &mut Spec) {
    Order::Reversed.items(&mut spec.problem.items);
}

fn shuffle(spec: &mut Spec) {
    Order::Shuffled(fastrand::Rng::with_seed(7)).items(&mut spec.problem.items);
}

#[test]
fn the_order_of_declarations_changes_no_optimum() {
    holds(&[Change::written("reversed", reverse), Change::written("shuffled", shuffle)], &[MANY_MINIMA], 40);
}

/// There are no files.
struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("{path}: there are no files"))
    }
}

/// Few shipped objectives have several terms. Here each of four moves the optimum, two of them with a minus, one of these
/// before all others.
#[test]
fn the_order_of_terms_changes_no_optimum() {
    let text = "problem Terms {
        duration T in 1 .. 4;
        state x;
        input u;
        collocation gauss(points = 3, intervals = 6);
        minimize -final(x) + integral(u^2 - x * u + 0.5 * x^2) - 0.2 * integral(x) + 0.1 * T^2;
        dynamics { der(x) == u - 0.3 * x; }
        initial { x == 0.5; }
    }";
    let source = Source::new("terms.ntg", text);
    let optimum = |change: fn(&mut Spec)| {
        let mut spec = syntax::parse(&source).unwrap_or_else(|_| panic!("{text}"));
        change(&mut spec);
        let (problem, findings) = model::build(&spec, &source, &NoFiles);
        let program = program::lower(problem.unwrap_or_else(|| panic!("{findings:?}")), &source);
        let report = ntg_runtime::solve(&Interpreted::new(&program), &Settings::default()).expect("it can be set up");
        assert!(report.is_solved(), "{report}");
        report.objective
    };
    let plain = optimum(|_| ());
    for changed in [optimum(reverse), optimum(shuffle)] {
        assert!((changed - plain).abs() <= 1e-7 * plain.abs(), "{changed} for {plain}");
    }
}
