//! Every slot as an affine function of the variables (docs/maths.md, section 4.3).
//!
//! Takes a [`Source`] and the point of evaluation; gives the variables it depends on with their
//! coefficients, and the part that depends on none. Derivatives of outputs are with respect to
//! scaled time.

use super::layout::{Layout, Time};
use super::node::Site;
use super::points::Point;
use ntg_math::{Simd, Task, dispatch};
use ntg_splines::basis::derivative;
use ntg_splines::{MAX_ORDER, Side};
use ntg_structure::At;

/// The concrete thing that a slot stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Source {
    /// An output's derivative: indices into the layout's phases and that phase's outputs.
    Flat { phase: usize, at: At, output: usize, derivative: usize },
    /// A phase's duration.
    Duration(usize),
    /// The time at which a phase starts.
    Start(usize),
    /// A variable of the program.
    Global(u32),
}

/// `offset + sum of coefficient * x[variable]`, each variable once.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct AffineMap {
    pub(crate) terms: Vec<(u32, f64)>,
    pub(crate) offset: f64,
}

impl AffineMap {
    /// The value for known variables.
    pub(crate) fn value(&self, x: &[f64]) -> f64 {
        self.terms.iter().fold(self.offset, |sum, &(variable, c)| sum + c * x[variable as usize])
    }

    fn add(&mut self, time: Time) {
        match time {
            Time::Fixed(value) => self.offset += value,
            Time::Free(variable) => self.terms.push((variable, 1.0)),
        }
    }
}

impl Layout {
    /// The affine map of one slot at one point.
    pub(crate) fn affine(&self, source: Source, here: &Point) -> AffineMap {
        let mut map = AffineMap::default();
        match source {
            Source::Flat { phase, at, output, derivative } => {
                let point = match at {
                    At::Here => *here,
                    At::Start => Point::start(phase),
                    At::End => Point::end(phase),
                    At::Inside(instant) => Point::inside(phase, instant, &self.phases[phase].breakpoints),
                    // Sources are about one member; the frame has looked its place up.
                    At::Among { .. } => Point::NONE,
                };
                map.terms = self.basis(phase, output, derivative, point.tau, point.side);
            }
            Source::Duration(phase) => map.add(self.phases[phase].duration),
            // docs/maths.md, equation 3.4.
            Source::Start(phase) => {
                map.add(self.agents[self.phases[phase].agent].start);
                for earlier in self.before(phase) {
                    map.add(self.phases[earlier].duration);
                }
            }
            Source::Global(variable) => map.terms.push((variable, 1.0)),
        }
        map
    }

    /// The basis values of one output at one point, with the variables that they multiply
    /// (docs/maths.md, equation 4.5).
    pub(crate) fn basis(&self, phase: usize, output: usize, order: usize, tau: f64, side: Side) -> Vec<(u32, f64)> {
        let output = &self.phases[phase].outputs[output];
        let knots = &output.knots;
        let interval = knots.interval(tau, side);
        let mut row = [0.0; MAX_ORDER];
        derivative(knots.knots(), knots.order(), knots.span(interval), tau, order, &mut row);
        let first = knots.support_start(interval);
        let active = &output.coefficients[first..first + knots.order()];
        active.iter().copied().zip(row).filter(|&(_, value)| value != 0.0).collect()
    }

    /// The value of one output's derivative with respect to scaled time.
    pub(crate) fn flat(&self, phase: usize, output: usize, order: usize, at: (f64, Side), x: &[f64]) -> f64 {
        self.basis(phase, output, order, at.0, at.1).iter().map(|&(v, b)| b * x[v as usize]).sum()
    }
}

/// The affine maps of all slots of some elements, laid out for evaluation.
#[derive(Clone, Debug, Default)]
pub(crate) struct SlotMaps {
    elements: usize,
    slots: usize,
    /// Slots with common variables.
    bundles: Vec<Bundle>,
    /// The constant part of slot `s` of element `e`: entry `s * elements + e`.
    offset: Vec<f64>,
}

/// Slots that depend on the same variables, an output and its derivatives as a rule: each variable is fetched once
/// for all of them, and for all elements in a row that depend on the same (the points of one interval).
#[derive(Clone, Debug, Default)]
struct Bundle {
    slots: Vec<usize>,
    /// Variables of each element; where an element has fewer, the last stand for nothing.
    width: usize,
    /// One past the last element of each run.
    ends: Vec<usize>,
    /// `width` for each run.
    variables: Vec<u32>,
    /// Slot by slot, `width` for each element: those of a run stand together, the first of all its elements, the
    /// second of all of them, and so on.
    coefficients: Vec<Vec<f64>>,
}

impl SlotMaps {
    /// Maps of the slots with these sources (those of the first element) for every element; `maps[e][s]`.
    pub(crate) fn new(sources: &[Source], maps: &[Vec<AffineMap>]) -> Self {
        Self::build(sources, maps.len(), |element, slot| maps[element][slot].clone())
    }

    /// The maps of the sources of every site, which all have equally many.
    pub(crate) fn of_sources<'a>(layout: &Layout, sites: &[Site], sources: impl Fn(usize) -> &'a [Source]) -> Self {
        let first = if sites.is_empty() { &[] } else { sources(0) };
        Self::build(first, sites.len(), |element, slot| layout.affine(sources(element)[slot], &sites[element].point))
    }

    fn build(sources: &[Source], elements: usize, map: impl Fn(usize, usize) -> AffineMap) -> Self {
        let offset = vec![0.0; sources.len() * elements];
        let mut all = Self { elements, slots: sources.len(), bundles: vec![], offset };
        let mut bundles: Vec<(Source, Vec<usize>)> = vec![];
        for (slot, source) in sources.iter().enumerate() {
            let of = source.without_derivative();
            match bundles.iter_mut().find(|(other, _)| *other == of) {
                Some((_, slots)) => slots.push(slot),
                None => bundles.push((of, vec![slot])),
            }
        }
        let mut maps = vec![];
        for (_, slots) in bundles {
            let mut bundle = Bundle { coefficients: vec![vec![]; slots.len()], slots, ..Bundle::default() };
            for element in 0..elements {
                maps.clear();
                maps.extend(bundle.slots.iter().map(|&slot| map(element, slot)));
                for (&slot, map) in bundle.slots.iter().zip(&maps) {
                    all.offset[slot * elements + element] = map.offset;
                }
                bundle.push(&maps);
            }
            bundle.transpose();
            all.bundles.push(bundle);
        }
        all
    }

    /// Writes slot `s` of element `e` to `u[s * elements + e]`.
    pub(crate) fn refresh(&self, x: &[f64], u: &mut [f64]) {
        dispatch(Refresh { maps: self, x, u });
    }

    /// How many numbers `refresh` writes.
    pub(crate) fn len(&self) -> usize {
        self.slots * self.elements
    }
}

impl Source {
    /// The output whose derivative this is.
    fn without_derivative(self) -> Self {
        match self {
            Self::Flat { phase, at, output, .. } => Self::Flat { phase, at, output, derivative: 0 },
            other => other,
        }
    }
}

impl Bundle {
    /// Adds an element with these maps of its slots.
    fn push(&mut self, maps: &[AffineMap]) {
        let known = self.variables.len() - self.width.min(self.variables.len());
        let fits = |map: &AffineMap| map.terms.iter().all(|(variable, _)| self.variables[known..].contains(variable));
        let element = self.ends.last().copied().unwrap_or(0);
        if element > 0 && maps.iter().all(fits) {
            self.ends.last_mut().into_iter().for_each(|end| *end += 1);
        } else {
            let own = union(maps);
            self.widen(own.len());
            let last = own.last().copied().unwrap_or(0);
            self.variables.extend((0..self.width).map(|i| own.get(i).copied().unwrap_or(last)));
            self.ends.push(element + 1);
        }
        let variables = &self.variables[self.variables.len() - self.width..];
        for (coefficients, map) in self.coefficients.iter_mut().zip(maps) {
            let first = coefficients.len();
            coefficients.resize(first + self.width, 0.0);
            for (variable, c) in &map.terms {
                if let Some(at) = variables.iter().position(|v| v == variable) {
                    coefficients[first + at] = *c;
                }
            }
        }
    }

    /// Makes room for elements with more variables.
    fn widen(&mut self, width: usize) {
        if width <= self.width {
            return;
        }
        let before = std::mem::replace(&mut self.width, width);
        if before == 0 {
            let elements = self.ends.last().copied().unwrap_or(0);
            self.variables = vec![0; width * self.ends.len()];
            self.coefficients.iter_mut().for_each(|of| *of = vec![0.0; width * elements]);
            return;
        }
        let wider = |row: &[u32]| (0..width).map(|i| row[i.min(before - 1)]).collect::<Vec<_>>();
        self.variables = self.variables.chunks_exact(before).flat_map(wider).collect();
        for of in &mut self.coefficients {
            let zeros = std::iter::repeat_n(0.0, width - before);
            *of = of.chunks_exact(before).flat_map(|row| row.iter().copied().chain(zeros.clone())).collect();
        }
    }

    /// From element by element, as they were added, to run by run.
    fn transpose(&mut self) {
        let width = self.width;
        for of in &mut self.coefficients {
            let mut first = 0;
            for &end in &self.ends {
                let run = &mut of[first * width..end * width];
                let before = run.to_vec();
                for (i, to) in run.chunks_exact_mut((end - first).max(1)).enumerate() {
                    to.iter_mut().zip(before.chunks_exact(width)).for_each(|(to, element)| *to = element[i]);
                }
                first = end;
            }
        }
    }

    #[inline(always)]
    fn refresh<const W: usize>(&self, x: &[f64], elements: usize, u: &mut [f64]) {
        let mut first = 0;
        for (variables, &end) in self.variables.as_chunks::<W>().0.iter().zip(&self.ends) {
            let mut own = [0.0; W];
            for i in 0..W {
                own[i] = x[variables[i] as usize];
            }
            for (&slot, coefficients) in self.slots.iter().zip(&self.coefficients) {
                let values = &mut u[slot * elements..][first..end];
                add_products(values, &own, &coefficients[first * W..end * W]);
            }
            first = end;
        }
    }

    #[inline(always)]
    fn refresh_any(&self, x: &[f64], elements: usize, u: &mut [f64]) {
        let width = self.width;
        let mut first = 0;
        for (variables, &end) in self.variables.chunks_exact(width).zip(&self.ends) {
            for (&slot, coefficients) in self.slots.iter().zip(&self.coefficients) {
                let values = &mut u[slot * elements..][first..end];
                for (i, variable) in variables.iter().enumerate() {
                    let own = &coefficients[first * width..][i * (end - first)..][..end - first];
                    add_products(values, &[x[*variable as usize]], own);
                }
            }
            first = end;
        }
    }
}

/// Adds to every value the products of `x` with its column of `coefficients`, in order.
#[inline(always)]
fn add_products<const W: usize>(values: &mut [f64], x: &[f64; W], coefficients: &[f64]) {
    const TOGETHER: usize = 4;
    let count = values.len();
    let mut rows: [&[f64]; W] = [&[]; W];
    for i in 0..W {
        rows[i] = &coefficients[i * count..][..count];
    }
    let (chunks, rest) = values.as_chunks_mut::<TOGETHER>();
    let done = chunks.len() * TOGETHER;
    for (k, values) in chunks.iter_mut().enumerate() {
        // All is read before anything is written: so the compiler makes vector instructions of it.
        let mut sum = *values;
        for i in 0..W {
            let c = &rows[i][k * TOGETHER..][..TOGETHER];
            for lane in 0..TOGETHER {
                sum[lane] += c[lane] * x[i];
            }
        }
        *values = sum;
    }
    for (k, value) in rest.iter_mut().enumerate() {
        let mut sum = *value;
        for i in 0..W {
            sum += rows[i][done + k] * x[i];
        }
        *value = sum;
    }
}

struct Refresh<'a> {
    maps: &'a SlotMaps,
    x: &'a [f64],
    u: &'a mut [f64],
}

impl Task for Refresh<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        let Self { maps: SlotMaps { offset, bundles, elements, .. }, x, u } = self;
        u.copy_from_slice(offset);
        for bundle in bundles {
            match bundle.width {
                0 => {}
                1 => bundle.refresh::<1>(x, *elements, u),
                2 => bundle.refresh::<2>(x, *elements, u),
                3 => bundle.refresh::<3>(x, *elements, u),
                4 => bundle.refresh::<4>(x, *elements, u),
                5 => bundle.refresh::<5>(x, *elements, u),
                6 => bundle.refresh::<6>(x, *elements, u),
                _ => bundle.refresh_any(x, *elements, u),
            }
        }
    }
}

/// The variables of all of these maps, in the order in which they appear.
fn union(maps: &[AffineMap]) -> Vec<u32> {
    let longest = maps.iter().max_by_key(|map| map.terms.len());
    let mut all: Vec<u32> = longest.iter().flat_map(|map| map.terms.iter().map(|t| t.0)).collect();
    for (variable, _) in maps.iter().flat_map(|map| &map.terms) {
        if !all.contains(variable) {
            all.push(*variable);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The terms and the offset of a map.
    type Affine<'a> = (&'a [(u32, f64)], f64);

    /// Elements of two slots with these maps.
    fn maps(of: &[[Affine; 2]]) -> Vec<Vec<AffineMap>> {
        let map = |(terms, offset): &Affine| AffineMap { terms: terms.to_vec(), offset: *offset };
        of.iter().map(|slots| slots.iter().map(map).collect()).collect()
    }

    #[test]
    fn slots_are_what_their_maps_say_whatever_they_share() {
        let flat = |derivative| Source::Flat { phase: 0, at: At::Here, output: 0, derivative };
        let elements = maps(&[
            [(&[], 4.0), (&[], 1.0)],
            [(&[(0, 2.0)], 0.0), (&[(0, 1.0), (1, -3.0)], 1.0)],
            [(&[(1, 2.0)], 0.0), (&[(0, 5.0)], 1.0)],
            [(&[(2, 2.0), (3, 0.5), (4, 1.0)], -1.0), (&[(3, 1.0), (5, -3.0)], 1.0)],
            [(&[(5, 1.0)], 0.0), (&[], 3.0)],
        ]);
        let x = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5];
        for sources in [[flat(0), flat(2)], [flat(0), Source::Duration(0)]] {
            let slots = SlotMaps::new(&sources, &elements);
            let mut u = vec![f64::NAN; slots.len()];
            slots.refresh(&x, &mut u);
            for (e, maps) in elements.iter().enumerate() {
                for (s, map) in maps.iter().enumerate() {
                    assert_eq!(u[s * elements.len() + e], map.value(&x), "slot {s} of element {e}");
                }
            }
        }
    }
}
