//! The equations of motion of a phase, as a system for its states (docs/maths.md, equation 15.7).
//!
//! An output whose derivative stands in an equality that holds along the whole phase is a *state*; the order of its
//! highest derivative there is its order. Outputs without derivatives are *inputs*: they are what their splines are.
//! Where equalities without derivatives are as many as the inputs in them, these are *algebraic* states, of order 0.

use std::collections::{BTreeMap, BTreeSet};

use super::matrix::Matrix;
use crate::evaluate::{Here, Machine};
use crate::interval::Interval;
use crate::jet::Jet;
use crate::statement::{Input, Kind, Quantity, Statement};

/// An output that the equations determine.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unknown {
    pub(super) spline: usize,
    /// The highest derivative in the equations.
    pub(super) order: usize,
    /// Its value among the components; its derivatives below the highest follow.
    pub(super) first: usize,
}

/// What a flat of the equations is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    Component(usize),
    Highest(usize),
    Input(usize),
}

/// As many equations as unknowns, along one phase.
pub(super) struct System {
    pub(super) unknowns: Vec<Unknown>,
    /// The flats that are given.
    pub(super) inputs: Vec<usize>,
    /// How many components the state has.
    pub(super) size: usize,
    /// The subjects that are the equations.
    pub(super) subjects: Vec<usize>,
    equations: Vec<Equation>,
    roles: BTreeMap<usize, Role>,
}

/// Values of everything that the equations depend on.
pub(super) struct Values<T> {
    pub(super) components: Vec<T>,
    pub(super) highest: Vec<T>,
    pub(super) inputs: Vec<T>,
    pub(super) tau: T,
}

/// A function that is to be equal to a number, and the flats that it needs.
type Equation = (usize, Interval, Vec<usize>);

/// An equality: which subject it is, its function, and the number that this equals.
type Equality = (usize, usize, Interval);

/// The equalities along a phase that could be equations of motion.
fn equalities(machine: &Machine<'_>, phase: usize) -> Result<Vec<Equality>, String> {
    let mut found = vec![];
    for (number, subject) in machine.statement.subjects.iter().enumerate() {
        let (Kind::Constraint(_), Quantity::Path(function, own, cells)) = (subject.kind, &subject.quantity) else {
            continue;
        };
        let ((Some(bound), Some(above)), true) = (subject.bounds, *own == phase) else { continue };
        if bound != above {
            continue;
        }
        if *cells != machine.statement.phases[phase].cells() {
            let has_derivative = |flat: &usize| machine.statement.flats[*flat].derivative > 0;
            if machine.needs(*function).iter().any(has_derivative) {
                return Err(format!("`{}` holds in a part of the phase alone", subject.name));
            }
            continue;
        }
        let value = machine.number(bound, None);
        if !value.total {
            return Err(format!("the sides of `{}` have no bounds", subject.name));
        }
        found.push((number, *function, value.c[0]));
    }
    Ok(found)
}

impl System {
    /// The system of a phase, none where it has no equation of motion; the words say why there is no system.
    pub(super) fn of(machine: &Machine<'_>, phase: usize) -> Result<Option<Self>, String> {
        let statement = machine.statement;
        let all = equalities(machine, phase)?;
        let needs: Vec<Vec<usize>> = all.iter().map(|(_, function, _)| machine.needs(*function)).collect();
        if let Some(integral) = all.iter().find_map(|(_, function, _)| unbounded_integral(machine, *function)) {
            return Err(format!("they depend on integral {integral}, which has no bounds"));
        }
        let mut orders: BTreeMap<usize, usize> = BTreeMap::new();
        for flat in needs.iter().flatten().map(|flat| statement.flats[*flat]) {
            if statement.splines[flat.spline].phase != phase {
                return Err("they depend on another phase".to_owned());
            }
            let order = orders.entry(flat.spline).or_insert(0);
            *order = (*order).max(flat.derivative);
        }
        let has_derivative = |flats: &[usize]| flats.iter().any(|flat| statement.flats[*flat].derivative > 0);
        let dynamic: Vec<usize> = (0..all.len()).filter(|e| has_derivative(&needs[*e])).collect();
        if dynamic.is_empty() {
            return Ok(None);
        }
        let states: Vec<usize> = orders.iter().filter(|(_, order)| **order > 0).map(|(spline, _)| *spline).collect();
        if states.len() != dynamic.len() {
            let (equations, states) = (count(dynamic.len(), "equation"), count(states.len(), "output"));
            return Err(format!("it has {equations} with derivatives of {states}"));
        }
        let others: Vec<usize> = (0..all.len()).filter(|e| !dynamic.contains(e) && !needs[*e].is_empty()).collect();
        let given: BTreeSet<usize> = others
            .iter()
            .flat_map(|e| &needs[*e])
            .map(|flat| statement.flats[*flat].spline)
            .filter(|spline| orders[spline] == 0)
            .collect();
        let algebraic = if given.len() == others.len() { given } else { BTreeSet::new() };
        let chosen: Vec<usize> = if algebraic.is_empty() { dynamic } else { [dynamic, others].concat() };
        let equations = chosen.iter().map(|e| (all[*e].1, all[*e].2, needs[*e].clone())).collect();
        let subjects = chosen.iter().map(|e| all[*e].0).collect();
        let splines = states.into_iter().chain(algebraic).map(|spline| (spline, orders[&spline])).collect();
        Ok(Some(Self::with(statement, (subjects, equations), splines)))
    }

    fn with(
        statement: &Statement,
        (subjects, equations): (Vec<usize>, Vec<Equation>),
        splines: Vec<(usize, usize)>,
    ) -> Self {
        let (mut unknowns, mut size): (Vec<Unknown>, usize) = (vec![], 0);
        for (spline, order) in splines {
            unknowns.push(Unknown { spline, order, first: size });
            size += order;
        }
        let (mut inputs, mut roles) = (vec![], BTreeMap::new());
        for flat in equations.iter().flat_map(|(_, _, needs)| needs) {
            let own = statement.flats[*flat];
            let role = match unknowns.iter().position(|unknown| unknown.spline == own.spline) {
                Some(unknown) if unknowns[unknown].order == own.derivative => Role::Highest(unknown),
                Some(unknown) => Role::Component(unknowns[unknown].first + own.derivative),
                None => Role::Input(inputs.len()),
            };
            if let (Role::Input(_), false) = (role, roles.contains_key(flat)) {
                inputs.push(*flat);
            }
            roles.entry(*flat).or_insert(role);
        }
        Self { unknowns, inputs, size, subjects, equations, roles }
    }

    /// For each component the unknown and the derivative that it is.
    pub(super) fn components(&self) -> impl Iterator<Item = (&Unknown, usize)> {
        self.unknowns.iter().flat_map(|unknown| (0..unknown.order).map(move |k| (unknown, k)))
    }

    fn here(&self, machine: &Machine<'_>, values: &Values<Jet>) -> Here {
        let mut flats = vec![None; machine.statement.flats.len()];
        for (flat, role) in &self.roles {
            flats[*flat] = Some(match role {
                Role::Component(c) => values.components[*c],
                Role::Highest(u) => values.highest[*u],
                Role::Input(i) => values.inputs[*i],
            });
        }
        Here { flats, tau: values.tau }
    }

    /// By how much each equation is missed.
    pub(super) fn residuals(&self, machine: &Machine<'_>, values: &Values<Jet>) -> Vec<Jet> {
        let here = self.here(machine, values);
        let one = |(function, bound, _): &Equation| machine.evaluate(*function, &here) - Jet::constant(*bound);
        self.equations.iter().map(one).collect()
    }

    /// The derivatives of the equations by the components and by the highest derivatives, each times its scale;
    /// none where one has no bounds.
    pub(super) fn partials(
        &self,
        machine: &Machine<'_>,
        values: &Values<Interval>,
        (of_components, of_highest): (&[f64], &[f64]),
    ) -> Option<(Matrix, Matrix)> {
        let constants = |all: &[Interval]| all.iter().map(|x| Jet::constant(*x)).collect::<Vec<_>>();
        let values = Values {
            components: constants(&values.components),
            highest: constants(&values.highest),
            inputs: constants(&values.inputs),
            tau: Jet::constant(values.tau),
        };
        let mut here = self.here(machine, &values);
        let rows = self.equations.len();
        let (mut x, mut w) = (Matrix::zero(rows, self.size), Matrix::zero(rows, self.unknowns.len()));
        for (row, (function, _, needs)) in self.equations.iter().enumerate() {
            for flat in needs {
                let (out, scale) = match self.roles[flat] {
                    Role::Component(c) => (x.at_mut(row, c), of_components[c]),
                    Role::Highest(u) => (w.at_mut(row, u), of_highest[u]),
                    Role::Input(_) => continue,
                };
                let constant = here.flats[*flat];
                // The first coefficient is then the derivative by this flat.
                here.flats[*flat] = constant.map(|mut jet| {
                    jet.c[1] = Interval::point(scale);
                    jet
                });
                let found = machine.evaluate(*function, &here);
                here.flats[*flat] = constant;
                if !found.total || !found.c[1].is_bounded() {
                    return None;
                }
                *out = found.c[1];
            }
        }
        Some((x, w))
    }
}

fn count(number: usize, word: &str) -> String {
    if number == 1 { format!("one {word}") } else { format!("{number} {word}s") }
}

/// An integral without bounds that a function uses.
fn unbounded_integral(machine: &Machine<'_>, function: usize) -> Option<usize> {
    machine.statement.functions[function].inputs.iter().find_map(|input| match input {
        Input::Integral(integral) if !machine.integrals[*integral].is_bounded() => Some(*integral),
        Input::Join(_, members) => members.iter().find_map(|member| unbounded_integral(machine, *member)),
        _ => None,
    })
}
