//! The order in which an .nl file wants variables, rows and shared expressions.

use crate::expressions::{Expressions, Row};
use crate::graph::{Graph, Id, Node};

/// In rows.
const ROWS: u8 = 1;
/// In the objective.
const OBJECTIVE: u8 = 2;

/// Which of ntg's variables and rows stand where in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order {
    /// ntg's variable at each place.
    pub variables: Vec<usize>,
    /// ntg's row at each place.
    pub rows: Vec<usize>,
    /// How many rows are nonlinear; they come first.
    pub(crate) nonlinear_rows: usize,
    /// How many variables are nonlinear in both, in rows only, in the objective only.
    pub(crate) nonlinear: [usize; 3],
    /// Expressions that are written once and referred to, by where they are used: both, rows, objective.
    pub(crate) shared: [Vec<Id>; 3],
}

impl Order {
    /// The order for a program.
    pub fn of(program: &Expressions) -> Self {
        let graph = &program.graph;
        let used = uses(program);
        let mut variables_in = vec![0_u8; program.bounds.len()];
        let mut shared: [Vec<Id>; 3] = Default::default();
        for id in graph.ids() {
            let (place, count) = used[id.index()];
            match graph.node(id) {
                Node::Variable(variable) => variables_in[*variable as usize] |= place,
                Node::Linear(_, terms) => terms.iter().for_each(|(v, _)| variables_in[*v as usize] |= place),
                _ => {}
            }
            if place != 0 && is_shared(graph, id, count) {
                shared[class(place)].push(id);
            }
        }
        let mut variables: Vec<usize> = (0..program.bounds.len()).collect();
        variables.sort_by_key(|&v| if variables_in[v] == 0 { 3 } else { class(variables_in[v]) });
        let count =
            |wanted: usize| variables_in.iter().filter(|place| **place != 0 && class(**place) == wanted).count();
        let mut rows: Vec<usize> = (0..program.rows.len()).collect();
        let is_linear = |row: &Row| row.rest.is_empty();
        rows.sort_by_key(|&row| is_linear(&program.rows[row]));
        let nonlinear_rows = program.rows.iter().filter(|row| !is_linear(row)).count();
        Self { variables, rows, nonlinear_rows, nonlinear: [0, 1, 2].map(count), shared }
    }

    /// Numbers in the order of the file as numbers in ntg's order.
    pub(crate) fn to_own(places: &[usize], values: &[f64]) -> Vec<f64> {
        let mut own = vec![0.0; places.len()];
        places.iter().zip(values).for_each(|(place, value)| own[*place] = *value);
        own
    }
}

/// 0 for both, 1 for rows, 2 for the objective.
fn class(place: u8) -> usize {
    match place {
        ROWS => 1,
        OBJECTIVE => 2,
        _ => 0,
    }
}

/// Where each node is used, and how often.
fn uses(program: &Expressions) -> Vec<(u8, usize)> {
    let graph = &program.graph;
    let mut used = vec![(0_u8, 0_usize); graph.ids().count()];
    let mut root = |row: &Row, place: u8| {
        for id in &row.rest {
            used[id.index()].0 |= place;
            used[id.index()].1 += 1;
        }
    };
    program.rows.iter().for_each(|row| root(row, ROWS));
    root(&program.objective, OBJECTIVE);
    for id in graph.ids().rev() {
        let (place, count) = used[id.index()];
        if count > 0 {
            graph.node(id).each_operand(|operand| {
                used[operand.index()].0 |= place;
                used[operand.index()].1 += 1;
            });
        }
    }
    used
}

/// Whether an expression is written once and referred to: what is used more than once and is no mere sum or
/// product of a number and something simple; and every linear one, which has a form of its own.
fn is_shared(graph: &Graph, id: Id, count: usize) -> bool {
    match graph.node(id) {
        Node::Constant(_) | Node::Variable(_) => false,
        Node::Linear(..) => true,
        Node::Binary(_, a, b) => {
            let is_simple = |id: &Id| matches!(graph.node(*id), Node::Variable(_) | Node::Linear(..));
            let is_number = |id: &Id| matches!(graph.node(*id), Node::Constant(_));
            count > 1 && !((is_number(a) && is_simple(b)) || (is_simple(a) && is_number(b)))
        }
        _ => count > 1,
    }
}
