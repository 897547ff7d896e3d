//! The functions of a certificate on boxes of time.

use crate::interval::{Interval, pi};
use crate::jet::{Jet, binomial};
use crate::read::{Axis, Certificate, Flat, Input, Node, Table};
use crate::real::Real;

/// A polynomial by its Bernstein coefficients on a box.
pub(crate) type Piece = Vec<Interval>;

/// Jets of the flats at one place, scaled time among them.
pub(crate) type Here<'a> = dyn Fn(Flat) -> Jet + 'a;

fn difference(a: Real, b: Real) -> Interval {
    Interval::point(a) - Interval::point(b)
}

/// Derivative `d` of a spline between two neighbouring cuts: differences of coefficients, then de Boor's scheme with
/// the ends of the cell as arguments.
pub(crate) fn piece(certificate: &Certificate, (spline, d): Flat, cell: usize) -> Result<Piece, String> {
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
                let share = difference(x, from).over(difference(to, from));
                row[i] = if x == to { row[i + 1] } else { row[i] + share * (row[i + 1] - row[i]) };
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

/// The flats that functions need at the time of evaluation.
pub(crate) fn needs(certificate: &Certificate, functions: &[usize]) -> Vec<Flat> {
    let (mut found, mut open) = (vec![], functions.to_vec());
    while let Some(function) = open.pop() {
        for input in &certificate.functions[function].1 {
            match input {
                Input::Flat(flat, None) if !found.contains(flat) => found.push(*flat),
                Input::Join(_, members) => open.extend(members),
                _ => {}
            }
        }
    }
    found
}

/// A function at one place; `integrals` are those that are known so far.
pub(crate) fn evaluate(certificate: &Certificate, function: usize, integrals: &[Interval], here: &Here<'_>) -> Jet {
    let (graph, inputs) = &certificate.functions[function];
    let nodes = &certificate.graphs[*graph];
    let mut values: Vec<Jet> = Vec::with_capacity(nodes.len());
    for node in nodes {
        values.push(match node {
            Node::Constant(value) => Jet::constant(*value),
            Node::Input(number) => match inputs.get(*number) {
                Some(given) => input(certificate, given, integrals, here),
                None => Jet::NOTHING,
            },
            Node::Named(name, args) => operation(name, &args.iter().map(|a| values[*a]).collect::<Vec<Jet>>()),
            Node::Power(a, n) => values[*a].power(*n),
            Node::Table(table, orders, args) => {
                let args: Vec<Jet> = args.iter().map(|a| values[*a]).collect();
                look_up(&certificate.tables[*table], orders, &args).unwrap_or(Jet::NOTHING)
            }
        });
    }
    values.last().copied().unwrap_or(Jet::NOTHING)
}

fn input(certificate: &Certificate, input: &Input, integrals: &[Interval], here: &Here<'_>) -> Jet {
    match input {
        Input::Flat(flat, None) => here(*flat),
        Input::Flat(flat, Some((cell, last))) => {
            let piece = piece(certificate, *flat, *cell).unwrap_or(vec![Interval::ENTIRE]);
            Jet::constant(if *last { piece[piece.len() - 1] } else { piece[0] })
        }
        Input::Value(value) => Jet::constant(*value),
        Input::Integral(number) => Jet::constant(integrals.get(*number).copied().unwrap_or(Interval::ENTIRE)),
        Input::Join(how, members) => {
            let member = |f: &usize| evaluate(certificate, *f, integrals, here);
            members.iter().map(member).reduce(|a, b| operation(how, &[a, b])).unwrap_or(Jet::NOTHING)
        }
    }
}

/// A named operation; nothing is known of one with another name or number of arguments.
fn operation(name: &str, args: &[Jet]) -> Jet {
    let one = Jet::constant(Interval::whole(1));
    let half = Jet::constant(Interval::whole(1).scaled(-1));
    match (name, args) {
        ("neg", [x]) => -*x,
        ("square", [x]) => x.power(2),
        ("sqrt", [x]) => x.sqrt(),
        ("exp", [x]) => x.exp(),
        ("log", [x]) => x.log(),
        ("sin", [x]) => x.sine_and_cosine().0,
        ("cos", [x]) => x.sine_and_cosine().1,
        ("tan", [x]) => monotone(x, x.c[0], |x| x.sine_and_cosine().0.over(&x.sine_and_cosine().1)),
        ("asin", [x]) => monotone(x, x.c[0], |x| x.atan2(&((one - *x) * (one + *x)).sqrt())),
        ("acos", _) => Jet::constant(pi()) * half - operation("asin", args),
        ("atan", [x]) => x.atan(),
        ("sinh", [x]) => monotone(x, x.c[0], |x| (x.exp() - (-*x).exp()) * half),
        ("cosh", [x]) => monotone(x, x.c[0].abs(), |x| (x.exp() + (-*x).exp()) * half),
        ("tanh", [x]) => one - (one + one).over(&(one + (*x + *x).exp())),
        ("abs", [x]) => x.max(&-*x).meet(x.c[0].abs()),
        ("sign", [x]) => step(x.c[0], x.total, [-1, 0, 1]),
        ("logistic", [x]) => one.over(&(one + (-*x).exp())),
        ("softplus", [x]) => (one + x.exp()).log(),
        ("add", [a, b]) => *a + *b,
        ("sub", [a, b]) => *a - *b,
        ("mul", [a, b]) => *a * *b,
        ("div", [a, b]) => a.over(b),
        ("pow", [a, b]) => power(a, b),
        ("atan2", [a, b]) => a.atan2(b),
        ("hypot", [a, b]) => (a.power(2) + b.power(2)).sqrt(),
        ("min", [a, b]) => -(-*a).max(&-*b),
        ("max", [a, b]) => a.max(b),
        ("less_eq", [a, b]) => step(b.c[0] - a.c[0], a.total && b.total, [0, 1, 1]),
        ("select", [condition, a, b]) => condition.select(a, b),
        _ => Jet::NOTHING,
    }
}

/// A function that takes all of its values on an interval, and there only rises or only falls wherever it is total: the
/// ends of the interval decide what values there are.
fn monotone(x: &Jet, on: Interval, f: impl Fn(&Jet) -> Jet) -> Jet {
    let all = f(x);
    if all.total { all.meet(on.rising(|end| f(&Jet::constant(end)).known())) } else { all }
}

/// A power; that of 0 is 0 where the exponent is positive.
fn power(a: &Jet, b: &Jet) -> Jet {
    let of = |a: &Jet| (*b * a.log()).exp();
    if a.c[0].is_positive() || !a.c[0].is_not_negative() || !b.c[0].is_positive() {
        return of(a);
    }
    let at = |end: Interval| if end == Interval::ZERO { end } else { of(&Jet::constant(end)).known() };
    Jet::rough((a.c[0].rising(at), a.total && b.total))
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
    contract(table, orders, &places, (0, 0)).map(|jet| Jet { total, ..jet })
}

fn part(x: &Jet, low: Option<Real>, high: Option<Real>) -> Option<Jet> {
    x.c[0].within(low, high).map(|own| x.meet(own))
}

/// Every cell that the argument may touch.
fn places(axis: &Axis, x: &Jet) -> Option<Vec<Place>> {
    let mut found = vec![];
    x.c[0].ends?;
    match axis.symmetry.as_str() {
        "plain" => cells(axis, x, false, &mut found),
        "even" => {
            for (x, mirrored) in [(*x, false), (-*x, true)] {
                part(&x, Some(Real::ZERO), None).iter().for_each(|x| cells(axis, x, mirrored, &mut found));
            }
        }
        _ => {
            let period = difference(axis.high, axis.low);
            let (low, high) = (x.c[0] - Interval::point(axis.low)).over(period).ends?;
            let (first, last) = (low.floor()?, high.floor()?);
            if last > first + 3 {
                return None;
            }
            for turn in first..=last {
                let moved = *x - Jet::constant(period * Interval::whole(turn));
                part(&moved, Some(axis.low), Some(axis.high)).iter().for_each(|x| cells(axis, x, false, &mut found));
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

/// The table from an axis on, at all places that its arguments may be at.
fn contract(table: &Table, orders: &[usize], places: &[Vec<Place>], (axis, first): (usize, usize)) -> Option<Jet> {
    let Some(own) = places.get(axis) else {
        return table.coefficients.get(first).map(|c| Jet::constant(Interval::point(*c)));
    };
    let (parts, d, mut joined) = (&table.axes[axis], orders[axis], None::<Jet>);
    let stride: usize = table.axes[axis + 1..].iter().map(|inner| inner.coefficients).product();
    for (cell, u, beyond, mirrored) in own {
        let start = first + cell * parts.step * stride;
        let inner = (0..parts.order).map(|j| contract(table, orders, places, (axis + 1, start + j * stride)));
        let inner = inner.collect::<Option<Vec<_>>>()?;
        let row = |weights: &[Real]| {
            let terms = weights.iter().zip(&inner).map(|(w, c)| Jet::constant(Interval::point(*w)) * *c);
            terms.fold(Jet::constant(Interval::ZERO), |sum, term| sum + term)
        };
        let weights = parts.weights.chunks_exact(parts.order).skip(cell * parts.order).take(parts.order);
        let bernstein: Vec<Jet> = weights.map(row).collect();
        let at = |d: usize| polynomial(&bernstein, u, d, Interval::point(parts.cells[*cell].1));
        let value = match (beyond, table.linear, d) {
            (None, ..) | (Some(_), false, 0) | (Some(_), true, 1) => at(d),
            (Some(beyond), true, 0) => at(0) + *beyond * at(1),
            _ => Jet::constant(Interval::ZERO),
        };
        let value = if *mirrored && d % 2 == 1 { -value } else { value };
        joined = Some(joined.map_or(value, |known| Jet::rough((known.c[0].hull(value.c[0]), known.total))));
    }
    joined
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
    let inside = Interval::ZERO.hull(Interval::whole(1)).encloses(u.c[0]);
    Jet::constant(factor) * if inside { row[0].meet(hull) } else { row[0] }
}
