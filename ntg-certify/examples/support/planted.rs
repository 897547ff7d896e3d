//! Trajectories made at random, with constraints that hold, fail by a little, or are spoilt afterwards.

use ntg_certify::certify::{Certificate, certify};
use ntg_certify::prove::Options;
use ntg_certify::statement::{
    Flat, Function, Graph, Input, Kind, Node, Number, Phase, Quantity, Spline, Statement, Subject,
};
use ntg_compiler::expr::{Binary, Unary};
use ntg_splines::{Knots, Side};
use ntg_structure::Unit;

/// A trajectory of two splines on `intervals`, and `f = exp(x / 4) sin(y + p) + hypot(x, 1)` with `f <= limit`, where p
/// is number 1 and the limit number 2.
pub(crate) struct Planted {
    pub(crate) statement: Statement,
    /// The largest value at many times, to a rounding.
    pub(crate) most: f64,
}

impl Planted {
    pub(crate) fn new(random: &mut fastrand::Rng, intervals: usize) -> Self {
        let order = random.usize(3..7);
        let knots = Knots::uniform(order, intervals, order - 2).expect("sound knots");
        let count = knots.knots().len() - order;
        let mut spline = |name: &str| Spline {
            name: name.to_owned(),
            phase: 0,
            order,
            knots: knots.knots().to_vec(),
            coefficients: (0..count).map(|_| 4.0 * random.f64() - 2.0).collect(),
        };
        let splines = vec![spline("x"), spline("y")];
        let shift = 3.0 * random.f64();
        let number = |name: &str, value| Number { name: name.to_owned(), value };
        let numbers = vec![number("start", 0.0), number("shift", shift), number("limit", f64::MAX), number("T", 2.0)];
        let graph = Graph {
            nodes: vec![
                Node::Input(0),
                Node::Input(1),
                Node::Input(2),
                Node::Const(0.25),
                Node::Binary(Binary::Mul, 3, 0),
                Node::Unary(Unary::Exp, 4),
                Node::Binary(Binary::Add, 1, 2),
                Node::Unary(Unary::Sin, 6),
                Node::Binary(Binary::Mul, 5, 7),
                Node::Const(1.0),
                Node::Binary(Binary::Hypot, 0, 9),
                Node::Binary(Binary::Add, 8, 10),
            ],
            rows: vec![11],
        };
        let bound = Graph { nodes: vec![Node::Input(0)], rows: vec![0] };
        let inputs = vec![Input::Flat(0), Input::Flat(1), Input::Number(1)];
        let path = Quantity::Path(0, 0, 0..intervals);
        let subject = |kind, name: &str, bound| Subject {
            kind,
            name: name.to_owned(),
            indices: vec![],
            quantity: path.clone(),
            unit: Unit::default(),
            bounds: (None, bound),
        };
        let mut most = f64::NEG_INFINITY;
        for i in 0..=400 * intervals {
            let tau = i as f64 / (400 * intervals) as f64;
            let [x, y] = [0, 1].map(|s: usize| at(&knots, &splines[s].coefficients, tau));
            most = most.max((0.25 * x).exp() * (y + shift).sin() + x.hypot(1.0));
        }
        let statement = Statement {
            problem: "Planted".to_owned(),
            spec: String::new(),
            numbers,
            phases: vec![Phase { name: String::new(), start: 0, duration: 3, cuts: knots.breakpoints().to_vec() }],
            splines,
            flats: [0, 1].map(|spline| Flat { spline, derivative: 0 }).to_vec(),
            graphs: vec![graph, bound],
            functions: vec![
                Function { graph: 0, row: 0, inputs },
                Function { graph: 1, row: 0, inputs: vec![Input::Number(2)] },
            ],
            subjects: vec![subject(Kind::Constraint(0), "limit", Some(1)), subject(Kind::Named(0), "f", None)],
            ..Statement::default()
        };
        Self { statement, most }
    }

    /// The same with another limit.
    pub(crate) fn limited(&self, limit: f64) -> Statement {
        let mut statement = self.statement.clone();
        statement.numbers[2].value = limit;
        statement
    }
}

fn at(knots: &Knots, coefficients: &[f64], tau: f64) -> f64 {
    let mut row = [0.0; 8];
    let side = if tau == 1.0 { Side::Left } else { Side::Right };
    let first = knots.basis(tau, side, 0, &mut row);
    (0..knots.order()).map(|b| row[b] * coefficients[first + b]).sum()
}

/// A certificate whose claims are those of another trajectory, formula or number, or that is spoilt in itself; with a
/// word about how. None where the claims happen to be true of what was changed.
pub(crate) fn spoilt(random: &mut fastrand::Rng, sound: &Certificate) -> Option<(String, &'static str)> {
    let mut false_one = sound.clone();
    let statement = &mut false_one.statement;
    let how = match random.u8(0..7) {
        0 => {
            let spline = random.usize(0..statement.splines.len());
            let place = random.usize(0..statement.splines[spline].coefficients.len());
            statement.splines[spline].coefficients[place] += (random.f64() - 0.5) * 4.0;
            "coefficients"
        }
        1 => {
            statement.numbers[1].value += (random.f64() - 0.5) * 2.0;
            "parameters"
        }
        2 => {
            let operations = [Binary::Sub, Binary::Max, Binary::Mul, Binary::Atan2];
            let operation = operations[random.usize(0..operations.len())];
            let place = [4, 6, 8, 10, 11][random.usize(0..5)];
            let Node::Binary(_, a, b) = statement.graphs[0].nodes[place] else { return None };
            statement.graphs[0].nodes[place] = Node::Binary(operation, a, b);
            "formulas"
        }
        3 => {
            // The limit itself: what was proved is now false.
            let inner = sound.findings[1].values;
            statement.numbers[2].value = inner.high() - (0.05 + 0.9 * random.f64()) * inner.width();
            return Some((ntg_certify::write::body(&false_one), "bounds"));
        }
        4 => {
            let values = false_one.findings[1].values;
            let cut = (0.05 + 0.4 * random.f64()) * values.width();
            false_one.findings[1].values = match random.bool() {
                true => ntg_certify::Interval::new(values.low() + cut, values.high()),
                false => ntg_certify::Interval::new(values.low(), values.high() - cut),
            };
            return Some((ntg_certify::write::body(&false_one), "bounds"));
        }
        5 => {
            let text = ntg_certify::write::body(sound);
            let places: Vec<usize> = text.match_indices("cover ").map(|(at, words)| at + words.len()).collect();
            let place = places[random.usize(0..places.len())];
            let end = place + text[place..].find('\n').unwrap_or(0);
            let at = random.usize(place..end);
            let change = match (random.u8(0..3), &text[at..=at]) {
                (0, _) => String::new(),
                (1, own) => format!("{own}."),
                (_, ".") => "/".to_owned(),
                (_, "/") => ".".to_owned(),
                _ => "./".to_owned(),
            };
            return Some((format!("{}{change}{}", &text[..at], &text[at + 1..]), "subdivision"));
        }
        _ => {
            // Times: the knots of one spline, at an inner breakpoint.
            let place = statement.splines[0].knots.len() / 2;
            let inside = 0.0 < statement.splines[0].knots[place] && statement.splines[0].knots[place] < 1.0;
            if !inside {
                return None;
            }
            statement.splines[0].knots[place] += 1e-3;
            return Some((ntg_certify::write::body(&false_one), "times"));
        }
    };
    // Whether what was claimed is false of this one: its own range sticks out.
    let own = certify(false_one.statement.clone(), &Options::default());
    let (claimed, found) = (sound.findings[1].values, own.findings[1].values);
    let out = (found.high() - claimed.high()).max(claimed.low() - found.low());
    (out > 0.05 * found.width()).then(|| (ntg_certify::write::body(&false_one), how))
}
