//! Reads a certificate (docs/certificate-format.md): lines of words, every reference checked.

use crate::interval::Interval;
use crate::real::Real;

/// An operation of a graph on operations before it.
pub(crate) enum Node {
    /// A number.
    Constant(Interval),
    /// An input of the function.
    Input(usize),
    /// A named operation on nodes.
    Named(String, Vec<usize>),
    /// A whole power.
    Power(usize, i32),
    /// A derivative of a table.
    Table(usize, Vec<usize>, Vec<usize>),
}

/// Which derivative of which spline.
pub(crate) type Flat = (usize, usize);

/// Scaled time, where it stands for a flat.
pub(crate) const TAU: Flat = (usize::MAX, 0);

/// What an input of a function is.
pub(crate) enum Input {
    /// A derivative of a spline, or scaled time, at the time of evaluation, or at the first (`false`) or last point of a
    /// cell.
    Flat(Flat, Option<(usize, bool)>),
    /// A number.
    Value(Interval),
    /// Functions joined by an operation.
    Join(String, Vec<usize>),
    /// The value of a claim about a sum.
    Integral(usize),
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

/// A function at all times of some cells of a phase, or a sum of functions: integrals over phases, and numbers.
pub(crate) enum Quantity {
    Path(usize, usize, (usize, usize)),
    Sum(Vec<(usize, Option<usize>)>),
}

/// What is claimed of a subject.
pub(crate) struct Claim {
    pub(crate) quantity: Quantity,
    pub(crate) bounds: (Option<usize>, Option<usize>),
    pub(crate) verdict: String,
    pub(crate) values: Interval,
    /// Cell, halvings and part of the box in whose middle a bound is missed.
    pub(crate) witness: Option<(usize, u32, u64)>,
    pub(crate) covers: Vec<Vec<String>>,
}

/// Equations of motion of a phase, and how far from its splines what satisfies them is at most.
pub(crate) struct Tube {
    pub(crate) phase: usize,
    /// The claims whose quantities are to be what their bounds say.
    pub(crate) equations: Vec<usize>,
    pub(crate) cover: Vec<String>,
    /// The highest derivatives of the splines that the equations determine.
    pub(crate) highest: Vec<Flat>,
    pub(crate) components: Vec<Component>,
    /// One for each box of the cover.
    pub(crate) steps: Vec<Step>,
}

/// A component of the state: what the equations determine, or a derivative of it below the highest.
pub(crate) struct Component {
    pub(crate) flat: Flat,
    /// The component of all tubes with whose difference at the end it begins.
    pub(crate) begin: Option<usize>,
    /// How far it is from its spline: at all times, and at the end.
    pub(crate) bounds: [Interval; 2],
}

/// What is said of a box of time (docs/maths.md, section 15.7).
pub(crate) struct Step {
    /// Where the components of the reference begin.
    pub(crate) start: Vec<Interval>,
    /// Bernstein coefficients of its highest derivatives, those of the first unknown first.
    pub(crate) highest: Vec<Interval>,
    /// What the differences from the reference do not leave: those of its components, and of its highest derivatives.
    pub(crate) inside: Vec<Interval>,
    pub(crate) slack: Vec<Interval>,
    /// Directions along which the differences at the end are bounded, row by row.
    pub(crate) directions: Vec<Interval>,
}

/// Everything that a certificate says.
#[derive(Default)]
pub(crate) struct Certificate {
    pub(crate) numbers: Vec<Interval>,
    pub(crate) phases: Vec<Vec<Real>>,
    pub(crate) durations: Vec<Interval>,
    pub(crate) splines: Vec<Spline>,
    pub(crate) flats: Vec<Flat>,
    pub(crate) tables: Vec<Table>,
    pub(crate) graphs: Vec<Vec<Node>>,
    /// Graphs, whose last nodes are the results, and inputs.
    pub(crate) functions: Vec<(usize, Vec<Input>)>,
    pub(crate) claims: Vec<Claim>,
    pub(crate) tubes: Vec<Tube>,
}

/// What was read or proved, or words about what is wrong.
pub(crate) type Sound<T> = Result<T, String>;

/// The words of a line.
struct Words<'a>(std::str::SplitAsciiWhitespace<'a>);

impl<'a> Words<'a> {
    fn next(&mut self) -> Sound<&'a str> {
        self.0.next().ok_or_else(|| "a word is missing".to_owned())
    }

    fn number<T: std::str::FromStr>(&mut self) -> Sound<T> {
        let word = self.next()?;
        word.parse().map_err(|_| format!("`{word}` is no number"))
    }

    /// A reference to one of `count` things.
    fn below(&mut self, count: usize) -> Sound<usize> {
        let index = self.number()?;
        if index < count { Ok(index) } else { Err(format!("there is no number {index} of {count}")) }
    }

    /// The same, or `-` for none.
    fn optional(&mut self, count: usize) -> Sound<Option<usize>> {
        if self.0.clone().next() == Some("-") { self.next().map(|_| None) } else { self.below(count).map(Some) }
    }

    fn many<T>(&mut self, mut each: impl FnMut(&mut Self) -> Sound<T>) -> Sound<Vec<T>> {
        let length: usize = self.number()?;
        (0..length.min(MOST)).map(|_| each(self)).collect()
    }

    fn real(&mut self) -> Sound<Real> {
        real(self.next()?)
    }

    fn reals(&mut self) -> Sound<Vec<Real>> {
        self.many(Self::real)
    }

    fn points(&mut self) -> Sound<Vec<Interval>> {
        self.many(|words| words.real().map(Interval::point))
    }

    /// Two ends; `-inf` and `inf` for no bounds.
    fn interval(&mut self) -> Sound<Interval> {
        let (low, high) = (self.next()?, self.next()?);
        if low == "-inf" && high == "inf" {
            return Ok(Interval::ENTIRE);
        }
        let (low, high) = (real(low)?, real(high)?);
        if low <= high { Ok(Interval::new(low, high)) } else { Err("the ends of an interval cross".to_owned()) }
    }
}

/// `MpE` for the number M 2^E.
fn real(word: &str) -> Sound<Real> {
    let parts = word.split_once('p').and_then(|(m, e)| Some((m.parse().ok()?, e.parse::<i16>().ok()?)));
    let sound = parts.filter(|(m, _): &(i64, i16)| m.unsigned_abs() >> 62 == 0);
    sound.map(|(m, e)| Real::dyadic(m, e.into())).ok_or_else(|| format!("`{word}` is no number"))
}

/// Most numbers in one list: a guard against a file that asks for all memory.
const MOST: usize = 1 << 24;

/// Reads all lines but the digest.
pub(crate) fn read(text: &str) -> Sound<Certificate> {
    let mut out = Certificate::default();
    let mut lines = text.lines().enumerate();
    if lines.next().is_none_or(|(_, line)| line != "ntg-certificate 2") {
        return Err("this is no certificate of version 2".to_owned());
    }
    for (number, line) in lines.filter(|(_, line)| !line.starts_with("| ")) {
        // What follows is a name, for people.
        let line = line.split(" # ").next().unwrap_or(line);
        let mut words = Words(line.split_ascii_whitespace());
        statement(&mut out, &mut words).map_err(|error| format!("line {}: {error}", number + 1))?;
    }
    Ok(out)
}

fn statement(out: &mut Certificate, words: &mut Words<'_>) -> Sound<()> {
    match words.next()? {
        "number" => out.numbers.push(Interval::point(words.real()?)),
        "phase" => {
            words.below(out.numbers.len())?;
            out.durations.push(out.numbers[words.below(out.numbers.len())?]);
            out.phases.push(words.reals()?);
        }
        "spline" => out.splines.push(Spline {
            phase: words.below(out.phases.len())?,
            order: words.number()?,
            knots: words.reals()?,
            coefficients: words.reals()?,
        }),
        "flat" => out.flats.push((words.below(out.splines.len())?, words.number()?)),
        "table" => out.tables.push(Table { linear: words.next()? == "linear", axes: vec![], coefficients: vec![] }),
        "axis" => {
            let axis = Axis {
                symmetry: words.next()?.to_owned(),
                low: words.real()?,
                high: words.real()?,
                order: words.number()?,
                step: words.number()?,
                coefficients: words.number()?,
                cells: words.reals()?.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect(),
                weights: words.reals()?,
            };
            out.tables.last_mut().ok_or("an axis without a table")?.axes.push(axis);
        }
        "coefficients" => out.tables.last_mut().ok_or("no table")?.coefficients = words.reals()?,
        "graph" => out.graphs.push(vec![]),
        "function" => {
            let graph = words.below(out.graphs.len())?;
            out.functions.push((graph, words.many(|words| input(out, words))?));
        }
        "claim" => out.claims.push(Claim {
            verdict: words.next()?.to_owned(),
            values: words.interval()?,
            bounds: (words.optional(out.functions.len())?, words.optional(out.functions.len())?),
            quantity: quantity(out, words)?,
            witness: None,
            covers: vec![],
        }),
        "witness" => {
            let own = out.claims.last_mut().ok_or("a witness of nothing")?;
            own.witness = Some((words.number()?, words.number()?, words.number()?));
        }
        "cover" => {
            let own = out.claims.last_mut().ok_or("a cover of nothing")?;
            own.covers.push(words.0.by_ref().map(str::to_owned).collect());
        }
        "tube" => out.tubes.push(Tube {
            phase: words.below(out.phases.len())?,
            equations: words.many(|words| words.below(out.claims.len()))?,
            cover: words.0.by_ref().map(str::to_owned).collect(),
            highest: vec![],
            components: vec![],
            steps: vec![],
        }),
        "unknown" => {
            let spline = words.below(out.splines.len())?;
            tube(out)?.highest.push((spline, 0));
        }
        "component" => {
            let begin = words.optional(usize::MAX)?;
            let (own, bounds) = (tube(out)?, [words.interval()?, words.interval()?]);
            let highest = own.highest.last_mut().ok_or("a component of nothing")?;
            own.components.push(Component { flat: *highest, begin, bounds });
            highest.1 += 1;
        }
        "box" => {
            let (start, highest) = (words.points()?, words.points()?);
            let mut radii = || words.points().map(|all| all.into_iter().map(|x| x.hull(-x)).collect());
            let (inside, slack) = (radii()?, radii()?);
            let directions = words.points()?;
            tube(out)?.steps.push(Step { start, highest, inside, slack, directions });
        }
        word => {
            let graph = out.graphs.last_mut().ok_or_else(|| format!("`{word}` is unknown"))?;
            graph.push(node(word, words, (graph.len(), out.tables.as_slice()))?);
        }
    }
    words.0.next().map_or(Ok(()), |word| Err(format!("`{word}` is one word too many")))
}

/// The tube that a line belongs to.
fn tube(out: &mut Certificate) -> Sound<&mut Tube> {
    out.tubes.last_mut().ok_or("no tube".to_owned())
}

fn quantity(out: &Certificate, words: &mut Words<'_>) -> Sound<Quantity> {
    let (functions, phases) = (out.functions.len(), out.phases.len());
    if words.next()? == "path" {
        let (function, phase) = (words.below(functions)?, words.below(phases)?);
        let ends = out.phases[phase].len();
        return Ok(Quantity::Path(function, phase, (words.below(ends)?, words.below(ends)?)));
    }
    words.many(|words| Ok((words.below(functions)?, words.optional(phases)?))).map(Quantity::Sum)
}

fn input(out: &Certificate, words: &mut Words<'_>) -> Sound<Input> {
    Ok(match words.next()? {
        "flat" => Input::Flat(out.flats[words.below(out.flats.len())?], None),
        end @ ("first" | "last") => {
            let flat = out.flats[words.below(out.flats.len())?];
            let cells = out.phases[out.splines[flat.0].phase].len().saturating_sub(1);
            Input::Flat(flat, Some((words.below(cells)?, end == "last")))
        }
        "number" => Input::Value(out.numbers[words.below(out.numbers.len())?]),
        "value" => Input::Value(Interval::point(words.real()?)),
        "tau" => Input::Flat(TAU, None),
        "integral" => Input::Integral(words.number()?),
        join @ ("add" | "mul" | "min" | "max") => {
            Input::Join(join.to_owned(), words.many(|words| words.below(out.functions.len()))?)
        }
        word => return Err(format!("`{word}` is no input")),
    })
}

fn node(word: &str, words: &mut Words<'_>, (before, tables): (usize, &[Table])) -> Sound<Node> {
    Ok(match word {
        "const" => Node::Constant(Interval::point(words.real()?)),
        "input" => Node::Input(words.number()?),
        "powi" => Node::Power(words.below(before)?, words.number()?),
        "lookup" => {
            let table = words.below(tables.len())?;
            let count = tables[table].axes.len();
            let orders = (0..count).map(|_| words.number()).collect::<Sound<_>>()?;
            Node::Table(table, orders, (0..count).map(|_| words.below(before)).collect::<Sound<_>>()?)
        }
        _ => {
            let operands = words.0.by_ref().map(|operand| operand.parse().ok().filter(|k| *k < before));
            Node::Named(word.to_owned(), operands.collect::<Option<_>>().ok_or(format!("`{word}` is no operation"))?)
        }
    })
}
