//! The slots of many elements as functions of the variables, laid out for evaluation (docs/maths.md, section 4.3).
//!
//! Takes sites and what the slots stand for there; writes the numbers that the slots are at any point of the program.
//! Outputs on the same knots have the same basis functions, so these are computed and stored once for all of them, and
//! once for all members that have the same points.

use super::basis::Basis;
use super::layout::Layout;
use super::node::Site;
use super::shape::Traced;
use super::slots::{AffineMap, Source};
use ntg_math::{Simd, Task, dispatch};
use ntg_structure::At;
use std::collections::HashMap;
use std::ops::Range;

/// The affine maps of all slots of some elements.
#[derive(Clone, Debug, Default)]
pub(crate) struct SlotMaps {
    elements: usize,
    slots: usize,
    /// Outputs at the elements' own points.
    pub(super) bundles: Vec<Bundle>,
    /// All other slots.
    pub(super) constants: Vec<Constant>,
    /// Basis functions, one table for each derivative: those of a run stand together, the first at all its elements, the
    /// second at all of them, and so on.
    pub(super) tables: Vec<Vec<f64>>,
}

/// Slots of one output, which is fetched once for all of its derivatives, and for all elements in a row that depend on
/// the same variables (the points of one interval).
#[derive(Clone, Debug, Default)]
pub(super) struct Bundle {
    /// The slots, each with the number of its table.
    pub(super) slots: Vec<(usize, usize)>,
    /// Variables of each run: the order of the spline.
    pub(super) width: usize,
    pub(super) runs: Vec<Run>,
    /// `width` for each run.
    pub(super) variables: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// One past the last element.
    pub(super) end: usize,
    /// Where its basis functions begin in every table.
    pub(super) first: usize,
}

/// A slot that is the same number at all points of a member.
#[derive(Clone, Debug)]
pub(super) struct Constant {
    pub(super) slot: usize,
    /// One past the last element of each member, and what the slot is there.
    pub(super) members: Vec<(usize, AffineMap)>,
}

/// The elements of one member, which are neighbours, and what their slots stand for.
type Member<'a> = (Range<usize>, &'a [Source]);

impl SlotMaps {
    /// The maps at sites; `of` says which of `traced` each one is.
    pub(crate) fn new(layout: &Layout, sites: &[Site], of: &[usize], traced: &[Traced]) -> Self {
        let mut first = 0;
        let member = |of: &[usize]| {
            let elements = first..first + of.len();
            first = elements.end;
            (elements, &*traced[of[0]].sources)
        };
        let members: Vec<Member> = of.chunk_by(|a, b| a == b).map(member).collect();
        let slots = traced.first().map_or(0, |traced| traced.sources.len());
        let mut maps = Self { elements: sites.len(), slots, ..Self::default() };
        let mut basis = Basis::new(derivatives(&members));
        for slots in bundles(&members) {
            match members[0].1[slots[0]] {
                Source::Flat { at: At::Here, .. } => {
                    maps.bundles.push(bundle(layout, sites, &members, (slots, &mut basis)));
                }
                _ => maps.constants.extend(slots.into_iter().map(|slot| constant(layout, sites, &members, slot))),
            }
        }
        maps.tables = basis.tables;
        maps
    }

    /// Writes slot `s` of element `e` to `u[s * elements + e]`.
    pub(crate) fn refresh(&self, x: &[f64], u: &mut [f64]) {
        dispatch(Refresh { maps: self, x, u });
    }

    /// How many slots an element has.
    pub(super) fn slots(&self) -> usize {
        self.slots
    }

    /// How many numbers `refresh` writes.
    pub(crate) fn len(&self) -> usize {
        self.slots * self.elements
    }
}

/// Slots that are the same output for every member, though not the same derivative, together.
fn bundles(members: &[Member]) -> Vec<Vec<usize>> {
    let mut bundles: Vec<Vec<usize>> = vec![];
    // Bundles by what they are for the first member. Looked up, never iterated.
    let mut known: HashMap<Source, Vec<usize>> = HashMap::new();
    for slot in 0..members.first().map_or(0, |member| member.1.len()) {
        let output = |sources: &[Source], slot: usize| sources[slot].without_derivative();
        let joins = |bundle: &&usize| {
            let first = bundles[**bundle][0];
            members.iter().all(|(_, sources)| output(sources, slot) == output(sources, first))
        };
        let alike = known.entry(output(members[0].1, slot)).or_default();
        match alike.iter().find(joins) {
            Some(bundle) => bundles[*bundle].push(slot),
            None => {
                alike.push(bundles.len());
                bundles.push(vec![slot]);
            }
        }
    }
    bundles
}

/// The derivatives of outputs at the elements' own points that any slot is.
fn derivatives(members: &[Member]) -> Vec<usize> {
    let mut derivatives = vec![];
    for source in members.first().map_or(&[][..], |member| member.1) {
        if let Source::Flat { at: At::Here, derivative, .. } = source
            && !derivatives.contains(derivative)
        {
            derivatives.push(*derivative);
        }
    }
    derivatives
}

fn bundle(layout: &Layout, sites: &[Site], members: &[Member], (slots, basis): (Vec<usize>, &mut Basis)) -> Bundle {
    let mut bundle = Bundle::default();
    for (elements, sources) in members {
        let Source::Flat { phase, output, .. } = sources[slots[0]] else { continue };
        let output = &layout.phases[phase].outputs[output];
        bundle.width = output.knots.order();
        let known = basis.along(&output.knots, sites, elements);
        for stretch in &known.stretches {
            bundle.runs.push(Run { end: elements.start + stretch.end, first: stretch.first });
            let first = output.knots.support_start(stretch.interval);
            bundle.variables.extend_from_slice(&output.coefficients[first..][..bundle.width]);
        }
    }
    let table = |slot: usize| match members[0].1[slot] {
        Source::Flat { derivative, .. } => basis.derivatives.iter().position(|known| *known == derivative),
        _ => None,
    };
    bundle.slots = slots.iter().filter_map(|&slot| Some((slot, table(slot)?))).collect();
    bundle
}

fn constant(layout: &Layout, sites: &[Site], members: &[Member], slot: usize) -> Constant {
    let map = |(elements, sources): &Member| (elements.end, layout.affine(sources[slot], &sites[elements.start].point));
    Constant { slot, members: members.iter().map(map).collect() }
}

impl Bundle {
    #[inline(always)]
    fn refresh<const W: usize>(&self, tables: &[Vec<f64>], x: &[f64], (u, elements): (&mut [f64], usize)) {
        let mut begin = 0;
        for (variables, run) in self.variables.as_chunks::<W>().0.iter().zip(&self.runs) {
            let mut own = [0.0; W];
            for i in 0..W {
                own[i] = x[variables[i] as usize];
            }
            for &(slot, table) in &self.slots {
                let values = &mut u[slot * elements..][begin..run.end];
                write_products(values, &own, &tables[table][run.first..]);
            }
            begin = run.end;
        }
    }

    #[inline(always)]
    fn refresh_any(&self, tables: &[Vec<f64>], x: &[f64], (u, elements): (&mut [f64], usize)) {
        let mut begin = 0;
        for (variables, run) in self.variables.chunks_exact(self.width.max(1)).zip(&self.runs) {
            for &(slot, table) in &self.slots {
                let values = &mut u[slot * elements..][begin..run.end];
                values.fill(0.0);
                for (&variable, functions) in
                    variables.iter().zip(tables[table][run.first..].chunks_exact(run.end - begin))
                {
                    let x = x[variable as usize];
                    values.iter_mut().zip(functions).for_each(|(value, function)| *value += function * x);
                }
            }
            begin = run.end;
        }
    }
}

/// Writes to every value the sum of the products of `x` with its column of `coefficients`, in order.
#[inline(always)]
fn write_products<const W: usize>(values: &mut [f64], x: &[f64; W], coefficients: &[f64]) {
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
        let mut sum = [0.0; TOGETHER];
        for i in 0..W {
            let c = &rows[i][k * TOGETHER..][..TOGETHER];
            for lane in 0..TOGETHER {
                sum[lane] += c[lane] * x[i];
            }
        }
        *values = sum;
    }
    for (k, value) in rest.iter_mut().enumerate() {
        let mut sum = 0.0;
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
        let Self { maps: SlotMaps { constants, bundles, tables, elements, .. }, x, u } = self;
        for constant in constants {
            let mut begin = constant.slot * elements;
            for (end, map) in &constant.members {
                let end = constant.slot * elements + end;
                u[begin..end].fill(map.value(x));
                begin = end;
            }
        }
        for bundle in bundles {
            match bundle.width {
                1 => bundle.refresh::<1>(tables, x, (u, *elements)),
                2 => bundle.refresh::<2>(tables, x, (u, *elements)),
                3 => bundle.refresh::<3>(tables, x, (u, *elements)),
                4 => bundle.refresh::<4>(tables, x, (u, *elements)),
                5 => bundle.refresh::<5>(tables, x, (u, *elements)),
                6 => bundle.refresh::<6>(tables, x, (u, *elements)),
                _ => bundle.refresh_any(tables, x, (u, *elements)),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::layout::{AgentMember, OutputMember, PhaseMember, Time};
    use super::super::points::Point;
    use super::super::range_maps::range_maps;
    use super::*;
    use ntg_nlp::Block;
    use ntg_splines::{Knots, Side};
    use std::sync::Arc;

    /// One phase with a free duration and three outputs, the first two of them on the same knots.
    fn layout() -> Layout {
        let short = Arc::new(Knots::uniform(4, 3, 2).expect("good knots"));
        let long = Arc::new(Knots::uniform(8, 2, 3).expect("good knots"));
        let mut layout = Layout::default();
        let mut outputs = vec![];
        for knots in [&short, &short, &long] {
            let first = layout.variables as u32;
            let coefficients: Vec<u32> = (first..first + knots.coefficients() as u32).rev().collect();
            layout.variables += coefficients.len();
            outputs.push(OutputMember { output: outputs.len(), index: None, knots: Arc::clone(knots), coefficients });
        }
        layout.coefficients = layout.variables;
        layout.phases.push(PhaseMember {
            phase: 0,
            agent: 0,
            index: None,
            duration: Time::Free(layout.variables as u32),
            outputs,
            output_first: vec![0, 1, 2],
            breakpoints: vec![0.0, 1.0],
        });
        layout.agents.push(AgentMember { agent: 0, index: None, phases: 0..1, start: Time::Fixed(-2.5) });
        layout.variables += 1;
        layout
    }

    #[test]
    fn slots_are_what_their_maps_say_whatever_they_share() {
        let layout = layout();
        let flat = |output, derivative, at| Source::Flat { phase: 0, at, output, derivative };
        // Two slots that are one output for the first member and two for the second.
        let member = |a, b| Traced {
            sources: vec![
                flat(a, 0, At::Here),
                flat(a, 2, At::Here),
                flat(b, 1, At::Here),
                flat(2, 1, At::Here),
                flat(2, 0, At::End),
                Source::Duration(0),
                Source::Start(0),
            ],
            ..Traced::default()
        };
        let traced = [member(0, 0), member(0, 1), member(1, 0)];
        let early = [0.0, 0.1, 0.2, 0.3, 0.33, 1.0 / 3.0, 0.5, 0.7, 1.0];
        let late = [0.4, 0.5, 0.6, 0.61, 0.62];
        let (mut sites, mut of) = (vec![], vec![]);
        for (member, taus) in [&early[..], &early, &late].into_iter().enumerate() {
            for &tau in taus {
                let side = if tau == 1.0 { Side::Left } else { Side::Right };
                sites.push(Site { indices: vec![], point: Point { tau, side, ..Point::start(0) } });
                of.push(member);
            }
        }
        let x: Vec<f64> = (0..layout.variables).map(|i| (1.0 + i as f64).sin()).collect();
        let maps = SlotMaps::new(&layout, &sites, &of, &traced);
        let mut u = vec![f64::NAN; maps.len()];
        maps.refresh(&x, &mut u);
        let mut block = Block { elements: sites.len(), slots: maps.slots(), ..Block::default() };
        range_maps(&mut block, &maps);
        for (e, site) in sites.iter().enumerate() {
            let variables = block.variables(e);
            assert!(variables.is_sorted_by(|a, b| a < b), "variables of element {e}");
            for (s, source) in traced[of[e]].sources.iter().enumerate() {
                let map = layout.affine(*source, &site.point);
                let row = &block.map(e)[s * variables.len()..][..variables.len()];
                let mut terms: Vec<(u32, f64)> = variables.iter().copied().zip(row.iter().copied()).collect();
                terms.retain(|(_, coefficient)| *coefficient != 0.0);
                let mut wanted = map.terms.clone();
                wanted.sort_by_key(|(variable, _)| *variable);
                assert_eq!((terms, block.offset[s * sites.len() + e]), (wanted, map.offset), "slot {s} of element {e}");
                let (found, wanted) = (u[s * sites.len() + e], map.value(&x));
                assert!(
                    (found - wanted).abs() <= 1e-13 * wanted.abs().max(1.0),
                    "slot {s} of element {e}: {found} {wanted}"
                );
            }
        }
    }

    #[test]
    fn what_outputs_and_members_have_in_common_is_stored_once() {
        let layout = layout();
        let traced = [0, 1].map(|output| Traced {
            sources: [output, 1 - output]
                .map(|output| Source::Flat { phase: 0, at: At::Here, output, derivative: 0 })
                .to_vec(),
            ..Traced::default()
        });
        let point = |i: usize| Point { tau: 0.1 * i as f64, ..Point::start(0) };
        let sites: Vec<Site> = (0..20).map(|e| Site { indices: vec![], point: point(e % 10) }).collect();
        let of: Vec<usize> = (0..20).map(|e| e / 10).collect();
        let maps = SlotMaps::new(&layout, &sites, &of, &traced);
        assert_eq!(maps.tables.iter().map(Vec::len).collect::<Vec<_>>(), [4 * 10]);
    }
}
