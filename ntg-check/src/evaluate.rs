//! The functions of a certificate on boxes of time.

use crate::interval::Interval;
use crate::jet::{Jet, binomial};
use crate::read::{Axis, Certificate, Function, Input, Node, Table};
use crate::real::Real;

/// A polynomial by its Bernstein coefficients on a box.
pub(crate) type Piece = Vec<Interval>;

/// Jets of the flats at one place, and of scaled time.
pub(crate) struct Here<'a> {
    pub(crate) flats: &'a dyn Fn(usize) -> Jet,
    pub(crate) tau: Jet,
}

fn difference(a: Real, b: Real) -> Interval {
    Interval::point(a) - Interval::point(b)
}

/// Derivative `d` of a spline between two neighbouring cuts: differences of coefficients, then de Boor's scheme with
/// the ends of the cell as arguments.
pub(crate) fn piece(certificate: &Certificate, (spline, d): (usize, usize), cell: usize) -> Result<Piece, String> {
    let spline = &certificate.splines[spline];
    let cuts = &certificate.phases[spline.phase];
    let (low, high, k) = (cuts[cell], cuts[cell + 1], spline.order);
    if d >= k {
        return Ok(vec![Interval::ZERO]);
    }
    let (t, last) = (&spline.knots, spline.knots.len() - k);
    let span = t[..last].partition_point(|knot| *knot <= low).wrapping_sub(1);
    if span + 1 < k || span + 1 >= t.len() || t[span] > low || t[span + 1] < high {
        return Err("a spline is no polynomial between two cuts".to_owned());
    }
    let mut c: Piece = spline.coefficients[span + 1 - k..=span].iter().map(|c| Interval::point(*c)).collect();
    for degree in (k - d..k).rev() {
        let rise = |i: usize| {
            let width = difference(t[span + 1 + i], t[span + 1 + i - degree]);
            ((c[i + 1] - c[i]) * Interval::whole(degree as i64)).over(width)
        };
        c = (0..degree).map(rise).collect();
    }
    let blossom = |ends: usize| {
        let mut row = c.clone();
        for left in (1..k - d).rev() {
            let x = if k - d - left <= ends { high } else { low };
            for i in 0..left {
                let (from, to) = (t[span + 1 + i - left], t[span + 1 + i]);
                row[i] = row[i] + difference(x, from).over(difference(to, from)) * (row[i + 1] - row[i]);
            }
        }
        row[0]
    };
    Ok((0..k - d).map(blossom).collect())
}

/// Both halves of a polynomial.
pub(crate) fn halves(piece: &Piece) -> (Piece, Piece) {
    let (mut row, mut left, mut right) = (piece.clone(), vec![], vec![]);
    while let (Some(first), Some(last)) = (row.first(), row.last()) {
        left.push(*first);
        right.push(*last);
        row = row.windows(2).map(|pair| (pair[0] + pair[1]).scaled(-1)).collect();
    }
    right.reverse();
    (left, right)
}

/// The jets of a polynomial in the middle of its box, and everywhere on it.
pub(crate) fn jets(piece: &Piece) -> (Jet, Jet) {
    let degree = piece.len() - 1;
    let (mut at, mut over) = (halves(piece).1, piece.clone());
    let (mut middle, mut all) = (vec![], vec![]);
    for k in 0..=degree.min(6) {
        middle.push(at[0] * binomial(degree, k));
        let hull = over.iter().copied().reduce(Interval::hull).unwrap_or(Interval::ENTIRE);
        all.push((hull * binomial(degree, k)).scaled(-(k as i32)));
        at = at.windows(2).map(|pair| pair[1] - pair[0]).collect();
        over = over.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    (Jet::of(&middle), Jet::of(&all))
}

/// A function at one place; `integrals` are those that are known so far.
pub(crate) fn evaluate(certificate: &Certificate, function: &Function, integrals: &[Interval], here: &Here<'_>) -> Jet {
    let nodes = &certificate.graphs[function.graph].nodes[..=function.root];
    let mut needed = vec![false; nodes.len()];
    needed[function.root] = true;
    for k in (0..nodes.len()).rev().filter(|k| *k <= function.root) {
        if needed[k] {
            operands(&nodes[k]).into_iter().for_each(|operand| needed[operand] = true);
        }
    }
    let nothing = Jet::rough((Interval::ENTIRE, false));
    let mut values = vec![nothing; nodes.len()];
    for (k, node) in nodes.iter().enumerate().filter(|(k, _)| needed[*k]) {
        values[k] = match node {
            Node::Constant(value) => Jet::constant(*value),
            Node::Input(number) => match function.inputs.get(*number) {
                Some(given) => input(certificate, given, integrals, here),
                None => nothing,
            },
            Node::Named(name, a, None) => one(name, &values[*a]),
            Node::Named(name, a, Some(b)) if name == "mul" && a == b => values[*a].square(),
            Node::Named(name, a, Some(b)) => two(name, &values[*a], &values[*b]),
            Node::Power(a, n) => values[*a].power(*n),
            Node::Select(c, a, b) => values[*c].select(&values[*a], &values[*b]),
            Node::Table(table, orders, args) => {
                let args: Vec<Jet> = args.iter().map(|a| values[*a]).collect();
                look_up(&certificate.tables[*table], orders, &args).unwrap_or(nothing)
            }
        };
    }
    values[function.root]
}

fn operands(node: &Node) -> Vec<usize> {
    match node {
        Node::Constant(_) | Node::Input(_) => vec![],
        Node::Named(_, a, b) => [*a].into_iter().chain(*b).collect(),
        Node::Power(a, _) => vec![*a],
        Node::Select(c, a, b) => vec![*c, *a, *b],
        Node::Table(_, _, args) => args.clone(),
    }
}

fn input(certificate: &Certificate, input: &Input, integrals: &[Interval], here: &Here<'_>) -> Jet {
    match input {
        Input::Flat(flat, None) => (here.flats)(*flat),
        Input::Flat(flat, Some(place)) => end_of(certificate, *flat, *place),
        Input::Value(value) => Jet::constant(*value),
        Input::Tau => here.tau,
        Input::Integral(number) => Jet::constant(integrals.get(*number).copied().unwrap_or(Interval::ENTIRE)),
        Input::Join(how, members) => {
            let member = |f: &usize| evaluate(certificate, &certificate.functions[*f], integrals, here);
            let joined = members.iter().map(member).reduce(|a, b| match how {
                '+' => a + b,
                '*' => a * b,
                '<' => -(-a).max(&-b),
                _ => a.max(&b),
            });
            joined.unwrap_or(match how {
                '+' => Jet::constant(Interval::ZERO),
                '*' => Jet::constant(Interval::whole(1)),
                _ => Jet::rough((Interval::ENTIRE, false)),
            })
        }
    }
}

/// A flat where a cell of its phase begins, or where it ends.
pub(crate) fn end_of(certificate: &Certificate, flat: usize, (cell, last): (usize, bool)) -> Jet {
    piece(certificate, certificate.flats[flat], cell).map_or(Jet::rough((Interval::ENTIRE, false)), |piece| {
        Jet::constant(if last { piece[piece.len() - 1] } else { piece[0] })
    })
}

fn one(name: &str, x: &Jet) -> Jet {
    let one = Jet::constant(Interval::whole(1));
    let half = Jet::constant(Interval::whole(1).scaled(-1));
    match name {
        "neg" => -*x,
        "sqrt" => x.sqrt(),
        "exp" => x.exp(),
        "log" => x.log(),
        "sin" => x.sine_and_cosine().0,
        "cos" => x.sine_and_cosine().1,
        "tan" => x.sine_and_cosine().0.over(&x.sine_and_cosine().1),
        "asin" => x.asin_and_acos().0,
        "acos" => x.asin_and_acos().1,
        "atan" => x.atan(),
        "sinh" => (x.exp() - (-*x).exp()) * half,
        "cosh" => (x.exp() + (-*x).exp()) * half,
        "tanh" => one - (one + one).over(&(one + (*x + *x).exp())),
        "abs" => x.max(&-*x),
        "sign" => step(x.c[0], x.total, [-1, 0, 1]),
        "logistic" => one.over(&(one + (-*x).exp())),
        _ => (one + x.exp()).log(), // The only one left is `softplus`.
    }
}

fn two(name: &str, a: &Jet, b: &Jet) -> Jet {
    match name {
        "add" => *a + *b,
        "sub" => *a - *b,
        "mul" => *a * *b,
        "div" => a.over(b),
        "pow" => (*b * a.log()).exp(),
        "atan2" => a.atan2(b),
        "hypot" => (a.square() + b.square()).sqrt(),
        "min" => -(-*a).max(&-*b),
        "max" => a.max(b),
        _ => step(b.c[0] - a.c[0], a.total && b.total, [0, 1, 1]), // The only one left is `less_eq`.
    }
}

/// Which of three numbers, for what is below 0, 0 and above it.
fn step(x: Interval, total: bool, [below, at, above]: [i64; 3]) -> Jet {
    let to = |n: i64| Jet { total, ..Jet::constant(Interval::whole(n)) };
    match x {
        x if x.is_positive() => to(above),
        x if (-x).is_positive() => to(below),
        x if x == Interval::ZERO => to(at),
        _ => Jet::rough((Interval::whole(below).hull(Interval::whole(above)), total)),
    }
}

/// A cell of an argument, the coordinate in it, how far the argument is beyond the table, and its mirror's sign.
type Place = (usize, Jet, Option<Jet>, bool);

fn look_up(table: &Table, orders: &[usize], args: &[Jet]) -> Option<Jet> {
    let total = args.iter().all(|arg| arg.total);
    let places = table.axes.iter().zip(args).map(|(axis, x)| places(axis, x)).collect::<Option<Vec<_>>>()?;
    let count = places.iter().fold(1, |product: usize, found| product.saturating_mul(found.len()));
    if count == 0 || count > 512 {
        return None;
    }
    let mut joined: Option<Jet> = None;
    for mut number in 0..count {
        let mut here: Vec<Place> = vec![];
        for found in &places {
            here.push(found[number % found.len()]);
            number /= found.len();
        }
        let value = contract(table, orders, &here, (0, 0))?;
        joined = Some(joined.map_or(value, |known| Jet::rough((known.c[0].hull(value.c[0]), total))));
    }
    joined.map(|jet| Jet { total, ..jet })
}

fn part(x: &Jet, low: Option<Real>, high: Option<Real>) -> Option<Jet> {
    let mut part = *x;
    part.c[0] = x.c[0].within(low, high)?;
    Some(part)
}

/// Every cell that the argument may touch.
fn places(axis: &Axis, x: &Jet) -> Option<Vec<Place>> {
    let mut found = vec![];
    x.c[0].ends()?;
    match axis.symmetry.as_str() {
        "plain" => cells(axis, x, false, &mut found),
        "even" => {
            for (x, mirrored) in [(*x, false), (-*x, true)] {
                part(&x, Some(Real::ZERO), None).into_iter().for_each(|x| cells(axis, &x, mirrored, &mut found));
            }
        }
        _ => {
            let period = difference(axis.high, axis.low);
            let (low, high) = (x.c[0] - Interval::point(axis.low)).over(period).ends()?;
            let (first, last) = (low.floor()?, high.floor()?);
            for turn in first..=last.min(first + 4) {
                let moved = *x - Jet::constant(period * Interval::whole(turn));
                let inside = part(&moved, Some(axis.low), Some(axis.high));
                inside.into_iter().for_each(|x| cells(axis, &x, false, &mut found));
            }
            if last > first + 3 {
                return None;
            }
        }
    }
    Some(found)
}

fn cells(axis: &Axis, x: &Jet, mirrored: bool, found: &mut Vec<Place>) {
    let local = |x: Jet, cell: usize| {
        let (begin, width) = axis.cells[cell];
        (x - Jet::constant(Interval::point(begin))).over(&Jet::constant(Interval::point(width)))
    };
    let (count, even) = (axis.cells.len(), axis.symmetry == "even");
    for cell in 0..count {
        let low = if cell == 0 && !even { axis.low } else { axis.cells[cell].0 };
        let high = axis.cells.get(cell + 1).map_or(axis.high, |next| next.0);
        part(x, Some(low), Some(high)).into_iter().for_each(|x| found.push((cell, local(x, cell), None, mirrored)));
    }
    let mut outside = |end: Real, cell: usize, beyond: Option<Jet>| {
        let end = Jet::constant(Interval::point(end));
        beyond.into_iter().for_each(|beyond| found.push((cell, local(end, cell), Some(beyond - end), mirrored)));
    };
    if !even && !(x.c[0] - Interval::point(axis.low)).is_not_negative() {
        outside(axis.low, 0, part(x, None, Some(axis.low)));
    }
    if !(Interval::point(axis.high) - x.c[0]).is_not_negative() {
        outside(axis.high, count - 1, part(x, Some(axis.high), None));
    }
}

fn contract(table: &Table, orders: &[usize], places: &[Place], (axis, first): (usize, usize)) -> Option<Jet> {
    let Some((cell, u, beyond, mirrored)) = places.get(axis) else {
        return table.coefficients.get(first).map(|c| Jet::constant(Interval::point(*c)));
    };
    let (parts, d) = (&table.axes[axis], orders[axis]);
    let stride: usize = table.axes[axis + 1..].iter().map(|inner| inner.coefficients).product();
    let start = first + cell * parts.step * stride;
    let inner = (0..parts.order).map(|j| contract(table, orders, places, (axis + 1, start + j * stride)));
    let inner = inner.collect::<Option<Vec<_>>>()?;
    let weights = parts.weights.get(cell * parts.order * parts.order..(cell + 1) * parts.order * parts.order)?;
    let row = |weights: &[Real]| {
        let terms = weights.iter().zip(&inner).map(|(w, c)| Jet::constant(Interval::point(*w)) * *c);
        terms.fold(Jet::constant(Interval::ZERO), |sum, term| sum + term)
    };
    let bernstein: Vec<Jet> = weights.chunks_exact(parts.order).map(row).collect();
    let width = Interval::point(parts.cells[*cell].1);
    let value = match (beyond, table.linear, d) {
        (None, ..) | (Some(_), false, 0) | (Some(_), true, 1) => polynomial(&bernstein, u, d, width),
        (Some(beyond), true, 0) => polynomial(&bernstein, u, 0, width) + *beyond * polynomial(&bernstein, u, 1, width),
        _ => Jet::constant(Interval::ZERO),
    };
    Some(if *mirrored && d % 2 == 1 { -value } else { value })
}

/// Derivative `d` of a polynomial by its Bernstein coefficients, at `u` in a cell of this width.
fn polynomial(bernstein: &[Jet], u: &Jet, d: usize, width: Interval) -> Jet {
    let (mut row, mut factor) = (bernstein.to_vec(), Interval::whole(1));
    for _ in 0..d.min(row.len()) {
        factor = (factor * Interval::whole(row.len() as i64 - 1)).over(width);
        row = row.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    let Some(hull) = row.iter().map(|b| b.c[0]).reduce(Interval::hull) else { return Jet::constant(Interval::ZERO) };
    while row.len() > 1 {
        row = row.windows(2).map(|pair| pair[0] + *u * (pair[1] - pair[0])).collect();
    }
    let mut value = row[0];
    if Interval::ZERO.hull(Interval::whole(1)).encloses(u.c[0]) {
        value.c[0] = value.c[0].meet(hull);
    }
    Jet::constant(factor) * value
}
