//! Reads a certificate (docs/certificate-format.md): lines of words, every reference checked.

use crate::interval::Interval;
use crate::real::Real;

/// An operation of a graph on operations before it.
pub(crate) enum Node {
    /// A number.
    Constant(Interval),
    /// An input of the function.
    Input(usize),
    /// A named operation on one or two nodes.
    Named(String, usize, Option<usize>),
    /// A whole power.
    Power(usize, i32),
    /// The second where the first is not 0, else the third.
    Select(usize, usize, usize),
    /// A derivative of a table.
    Table(usize, Vec<usize>, Vec<usize>),
}

/// What an input of a function is.
pub(crate) enum Input {
    /// A derivative of a spline at the time of evaluation, or at the first (`false`) or last point of a cell.
    Flat(usize, Option<(usize, bool)>),
    /// A number.
    Value(Interval),
    /// Scaled time.
    Tau,
    /// Functions joined: by `+`, `*`, `<` (the smallest) or `>`.
    Join(char, Vec<usize>),
    /// An integral.
    Integral(usize),
}

/// A function: the nodes up to its result, and its inputs.
pub(crate) struct Function {
    pub(crate) graph: usize,
    pub(crate) root: usize,
    pub(crate) inputs: Vec<Input>,
}

/// Operations, and which of them are results.
pub(crate) struct Graph {
    pub(crate) nodes: Vec<Node>,
    pub(crate) rows: Vec<usize>,
}

/// A spline of a phase.
pub(crate) struct Spline {
    pub(crate) phase: usize,
    pub(crate) order: usize,
    pub(crate) knots: Vec<Real>,
    pub(crate) coefficients: Vec<Real>,
}

/// An argument of a table.
pub(crate) struct Axis {
    pub(crate) symmetry: String,
    pub(crate) low: Real,
    pub(crate) high: Real,
    pub(crate) order: usize,
    pub(crate) step: usize,
    pub(crate) coefficients: usize,
    pub(crate) cells: Vec<(Real, Real)>,
    pub(crate) weights: Vec<Real>,
}

/// A table.
pub(crate) struct Table {
    pub(crate) linear: bool,
    pub(crate) axes: Vec<Axis>,
    pub(crate) coefficients: Vec<Real>,
}

/// Where a summand is taken: over a phase, at its start, at its end, nowhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Over {
    Phase(usize),
    End(usize, bool),
    Nowhere,
}

/// A function at all times of some cells of a phase, or a sum.
pub(crate) enum Quantity {
    Path(usize, usize, (usize, usize)),
    Sum(Vec<(usize, Over)>),
}

/// What is claimed of a subject.
pub(crate) struct Claim {
    pub(crate) name: String,
    pub(crate) quantity: Quantity,
    pub(crate) bounds: (Option<usize>, Option<usize>),
    pub(crate) verdict: String,
    /// Of an equality: how far its sides differ at most.
    pub(crate) residual: Option<Real>,
    pub(crate) values: Interval,
    /// Cell, halvings and part of the box in whose middle the values are those of the interval.
    pub(crate) witness: Option<(usize, u32, u64, Interval)>,
    pub(crate) covers: Vec<Vec<String>>,
}

/// Everything that a certificate says.
#[derive(Default)]
pub(crate) struct Certificate {
    pub(crate) numbers: Vec<Interval>,
    pub(crate) phases: Vec<Vec<Real>>,
    pub(crate) splines: Vec<Spline>,
    pub(crate) flats: Vec<(usize, usize)>,
    pub(crate) tables: Vec<Table>,
    pub(crate) graphs: Vec<Graph>,
    pub(crate) functions: Vec<Function>,
    pub(crate) integrals: Vec<Claim>,
    pub(crate) claims: Vec<Claim>,
}

type Read<T> = Result<T, String>;

/// The words of a line.
struct Words<'a>(std::str::SplitAsciiWhitespace<'a>);

impl Words<'_> {
    fn next(&mut self) -> Read<&str> {
        self.0.next().ok_or_else(|| "a word is missing".to_owned())
    }

    fn number<T: std::str::FromStr>(&mut self) -> Read<T> {
        let word = self.next()?;
        word.parse().map_err(|_| format!("`{word}` is no number"))
    }

    /// A reference to one of `count` things.
    fn below(&mut self, count: usize) -> Read<usize> {
        let index = self.number()?;
        if index < count { Ok(index) } else { Err(format!("there is no number {index} of {count}")) }
    }

    /// A list of references to `count` things.
    fn list(&mut self, count: usize) -> Read<Vec<usize>> {
        let length: usize = self.number()?;
        (0..length.min(MOST)).map(|_| self.below(count)).collect()
    }

    fn real(&mut self) -> Read<Real> {
        real(self.next()?)
    }

    fn reals(&mut self, most: usize) -> Read<Vec<Real>> {
        let count = self.number()?;
        if count > most { Err("too many numbers".to_owned()) } else { (0..count).map(|_| self.real()).collect() }
    }

    /// Two ends; `-inf` and `inf` for no bounds.
    fn interval(&mut self) -> Read<Interval> {
        let (low, high) = (self.next()?.to_owned(), self.next()?.to_owned());
        if low == "-inf" && high == "inf" {
            return Ok(Interval::ENTIRE);
        }
        let (low, high) = (real(&low)?, real(&high)?);
        if low <= high { Ok(Interval::new(low, high)) } else { Err("the ends of an interval cross".to_owned()) }
    }

    fn rest(&mut self) -> String {
        self.0.by_ref().collect::<Vec<_>>().join(" ")
    }

    fn end(&mut self) -> Read<()> {
        self.0.next().map_or(Ok(()), |word| Err(format!("`{word}` is one word too many")))
    }
}

/// A hexadecimal floating-point number, such as `-0x1.8p+1`: exact.
pub(crate) fn real(word: &str) -> Read<Real> {
    let wrong = || format!("`{word}` is no hexadecimal number");
    let (sign, size) = word.strip_prefix('-').map_or((1, word), |size| (-1, size));
    let (digits, exponent) = size.strip_prefix("0x").and_then(|s| s.split_once('p')).ok_or_else(wrong)?;
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    if whole.len() != 1 || fraction.len() > 13 || exponent.len() > 5 {
        return Err(wrong());
    }
    let mantissa = i64::from_str_radix(&format!("{whole}{fraction}"), 16).map_err(|_| wrong())?;
    let exponent: i32 = exponent.parse().map_err(|_| wrong())?;
    Ok(Real::dyadic(sign * mantissa, exponent - 4 * fraction.len() as i32))
}

/// Most numbers in one list: a guard against a file that asks for all memory.
const MOST: usize = 1 << 24;

/// Reads all lines but the digest.
pub(crate) fn read(text: &str) -> Read<Certificate> {
    let mut out = Certificate::default();
    let mut lines = text.lines().enumerate();
    if lines.next().is_none_or(|(_, line)| line != "ntg-certificate 1") {
        return Err("this is no certificate of version 1".to_owned());
    }
    for (number, line) in lines.filter(|(_, line)| !line.starts_with("| ")) {
        let mut words = Words(line.split_ascii_whitespace());
        statement(&mut out, &mut words).map_err(|error| format!("line {}: {error}", number + 1))?;
    }
    if let Some(claim) = out.integrals.iter().chain(&out.claims).find(|claim| claim.verdict.is_empty()) {
        return Err(format!("nothing is claimed of `{}`", claim.name));
    }
    Ok(out)
}

fn statement(out: &mut Certificate, words: &mut Words<'_>) -> Read<()> {
    match words.next()? {
        "problem" => drop(words.rest()),
        "number" => {
            out.numbers.push(Interval::point(words.real()?));
            words.rest();
        }
        "phase" => {
            words.below(out.numbers.len())?;
            words.below(out.numbers.len())?;
            out.phases.push(words.reals(MOST)?);
            words.rest();
        }
        "spline" => {
            let (phase, order) = (words.below(out.phases.len())?, words.number()?);
            let (knots, coefficients) = (words.reals(MOST)?, words.reals(MOST)?);
            words.rest();
            out.splines.push(Spline { phase, order, knots, coefficients });
        }
        "flat" => out.flats.push((words.below(out.splines.len())?, words.number()?)),
        "table" => {
            out.tables.push(Table { linear: words.next()? == "linear", axes: vec![], coefficients: vec![] });
            words.rest();
        }
        "axis" => {
            let axis = Axis {
                symmetry: words.next()?.to_owned(),
                low: words.real()?,
                high: words.real()?,
                order: words.number()?,
                step: words.number()?,
                coefficients: words.number()?,
                cells: words.reals(MOST)?.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect(),
                weights: words.reals(MOST)?,
            };
            out.tables.last_mut().ok_or("an axis without a table")?.axes.push(axis);
        }
        "coefficients" => out.tables.last_mut().ok_or("no table")?.coefficients = words.reals(MOST)?,
        "graph" => out.graphs.push(Graph { nodes: vec![], rows: vec![] }),
        "rows" => {
            let graph = out.graphs.last_mut().ok_or("no graph")?;
            graph.rows = words.list(graph.nodes.len())?;
        }
        "function" => {
            let graph = words.below(out.graphs.len())?;
            let root = out.graphs[graph].rows[words.below(out.graphs[graph].rows.len())?];
            let count: usize = words.number()?;
            let inputs = (0..count.min(MOST)).map(|_| input(out, words)).collect::<Read<Vec<_>>>()?;
            out.functions.push(Function { graph, root, inputs });
        }
        "integral" => {
            let quantity = sum(out, words)?;
            out.integrals.push(claim(format!("integral {}", out.integrals.len()), quantity, (None, None)));
        }
        "subject" => {
            words.next()?;
            let functions = out.functions.len();
            let bound = |words: &mut Words<'_>| match words.next()? {
                "-" => Ok(None),
                word => word.parse().ok().filter(|f| *f < functions).map(Some).ok_or("no such bound".to_owned()),
            };
            let bounds = (bound(words)?, bound(words)?);
            let quantity = match words.next()? {
                word @ ("path" | "part") => {
                    let is_part = word == "part";
                    let (function, phase) = (words.below(out.functions.len())?, words.below(out.phases.len())?);
                    let all = out.phases[phase].len().saturating_sub(1);
                    let cells = if is_part { (words.below(all)?, words.below(all + 1)?) } else { (0, all) };
                    Quantity::Path(function, phase, cells)
                }
                _ => sum(out, words)?,
            };
            out.claims.push(claim(words.rest(), quantity, bounds));
        }
        "claim" => {
            let own = last(out)?;
            own.verdict = words.next()?.to_owned();
            own.residual = if own.verdict == "within" { Some(words.real()?) } else { None };
            own.values = words.interval()?;
        }
        "witness" => {
            last(out)?.witness = Some((words.number()?, words.number()?, words.number()?, words.interval()?));
        }
        "cover" => last(out)?.covers.push(words.0.by_ref().map(str::to_owned).collect()),
        word => {
            let graph = out.graphs.last_mut().ok_or_else(|| format!("`{word}` is unknown"))?;
            let node = node(word.to_owned().as_str(), words, (graph.nodes.len(), out.tables.as_slice()))?;
            graph.nodes.push(node);
        }
    }
    words.end()
}

/// The first or the last cell between the cuts of a phase.
pub(crate) fn end_cell(cuts: &[Real], last: bool) -> usize {
    if last { cuts.len().saturating_sub(2) } else { 0 }
}

fn claim(name: String, quantity: Quantity, bounds: (Option<usize>, Option<usize>)) -> Claim {
    let (verdict, values, covers) = (String::new(), Interval::ENTIRE, vec![]);
    Claim { name, quantity, bounds, verdict, residual: None, values, witness: None, covers }
}

/// The subject or the integral that a line belongs to.
fn last(out: &mut Certificate) -> Read<&mut Claim> {
    let Certificate { integrals, claims, .. } = out;
    claims.last_mut().or(integrals.last_mut()).ok_or("a claim about nothing".to_owned())
}

fn sum(out: &Certificate, words: &mut Words<'_>) -> Read<Quantity> {
    let count: usize = words.number()?;
    let summand = |_| {
        let function = words.below(out.functions.len())?;
        let over = match words.next()? {
            "nowhere" => Over::Nowhere,
            "over" => Over::Phase(words.below(out.phases.len())?),
            "start" => Over::End(words.below(out.phases.len())?, false),
            "end" => Over::End(words.below(out.phases.len())?, true),
            word => return Err(format!("`{word}` is no place")),
        };
        Ok((function, over))
    };
    Ok(Quantity::Sum((0..count.min(MOST)).map(summand).collect::<Read<_>>()?))
}

fn input(out: &Certificate, words: &mut Words<'_>) -> Read<Input> {
    Ok(match words.next()? {
        "flat" => Input::Flat(words.below(out.flats.len())?, None),
        word @ ("start" | "end" | "inside") => {
            let (is_inside, last) = (word == "inside", word == "end");
            let flat = words.below(out.flats.len())?;
            let cuts = &out.phases[out.splines[out.flats[flat].0].phase];
            let cell = if is_inside { words.below(cuts.len().saturating_sub(1))? } else { end_cell(cuts, last) };
            Input::Flat(flat, Some((cell, last)))
        }
        "number" => Input::Value(out.numbers[words.below(out.numbers.len())?]),
        "value" => Input::Value(Interval::point(words.real()?)),
        "tau" => Input::Tau,
        "integral" => Input::Integral(words.number()?),
        join @ ("sum" | "product" | "min" | "max") => {
            let how = match join {
                "sum" => '+',
                "product" => '*',
                "min" => '<',
                _ => '>',
            };
            Input::Join(how, words.list(out.functions.len())?)
        }
        word => return Err(format!("`{word}` is no input")),
    })
}

fn node(word: &str, words: &mut Words<'_>, (before, tables): (usize, &[Table])) -> Read<Node> {
    const ONE: [&str; 17] = [
        "neg", "sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "abs",
        "sign", "logistic", "softplus",
    ];
    const TWO: [&str; 10] = ["add", "sub", "mul", "div", "pow", "atan2", "hypot", "min", "max", "less_eq"];
    Ok(match word {
        "const" => Node::Constant(Interval::point(words.real()?)),
        "input" => Node::Input(words.number()?),
        "powi" => Node::Power(words.below(before)?, words.number()?),
        "select" => Node::Select(words.below(before)?, words.below(before)?, words.below(before)?),
        "lookup" => {
            let table = words.below(tables.len())?;
            let count = tables[table].axes.len();
            let orders = (0..count).map(|_| words.number()).collect::<Read<_>>()?;
            Node::Table(table, orders, (0..count).map(|_| words.below(before)).collect::<Read<_>>()?)
        }
        _ if ONE.contains(&word) => Node::Named(word.to_owned(), words.below(before)?, None),
        _ if TWO.contains(&word) => Node::Named(word.to_owned(), words.below(before)?, Some(words.below(before)?)),
        _ => return Err(format!("`{word}` is unknown")),
    })
}
