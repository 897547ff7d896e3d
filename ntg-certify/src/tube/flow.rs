//! One box of time of a tube: how far the true state may be from the reference (docs/maths.md, section 15.7).
//!
//! Differences are in the scales of their components, so that they can be compared with each other.

use super::matrix::{Matrix, basis, eliminate, inverse_of_basis};
use super::reference::{Given, Reference, Rule, collocate};
use super::system::{System, Values};
use crate::evaluate::Machine;
use crate::interval::Interval;
use crate::jet::{COUNT, Jet};
use crate::spline::Piece;

/// What is the same in all boxes of a phase.
pub(super) struct Flow<'a> {
    pub(super) machine: &'a Machine<'a>,
    pub(super) system: &'a System,
    pub(super) rule: Rule,
    /// Sizes of the components, and of the highest derivatives.
    pub(super) scales: (Vec<f64>, Vec<f64>),
}

/// A box of time with the splines on it.
#[derive(Clone)]
pub(super) struct Window {
    pub(super) cell: usize,
    pub(super) halvings: u32,
    pub(super) part: u64,
    pub(super) tau: Piece,
    pub(super) length: Interval,
    pub(super) inputs: Vec<Piece>,
    pub(super) components: Vec<Piece>,
    pub(super) highest: Vec<Piece>,
}

/// Differences in a box that may be turned: every one is the sum of the directions times numbers in the extents.
#[derive(Clone, Debug)]
pub(super) struct Turned {
    directions: Vec<Vec<f64>>,
    extents: Vec<Interval>,
}

/// Where a box of time begins: the reference, and the true state's differences from it.
#[derive(Clone, Debug)]
pub(super) struct Front {
    pub(super) start: Vec<f64>,
    pub(super) differences: Turned,
}

/// What is known of a box of time.
pub(super) struct Step {
    /// The true state less the splines, in SI units, at all times of the box and at its end.
    pub(super) over: Vec<Interval>,
    pub(super) at_end: Vec<Interval>,
    pub(super) front: Front,
    pub(super) proof: Proof,
}

/// What proves a box again, in SI units: numbers that stand for themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Where the components of the reference begin.
    pub start: Vec<f64>,
    /// Bernstein coefficients of its highest derivatives, those of the first unknown first.
    pub highest: Vec<f64>,
    /// The most that components of the true state differ from it.
    pub inside: Vec<f64>,
    /// The most that its highest derivatives differ.
    pub slack: Vec<f64>,
    /// Directions along which differences at the end are bounded, row by row.
    pub directions: Vec<f64>,
}

/// Why a box has no enclosure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trouble {
    /// Newton's method found no reference.
    NoReference,
    /// The residual of the reference is not small.
    Coarse,
    /// The equations, or their derivatives, have no bounds over the box.
    Unbounded,
    /// They do not determine the highest derivatives there.
    Singular,
    /// The differences may leave every box that was tried.
    Wide,
}

impl Trouble {
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::NoReference => "no trajectory was found nearby",
            Self::Coarse => "the residual does not become small",
            Self::Unbounded => "the equations or their derivatives have no bounds near the trajectory",
            Self::Singular => "the equations do not determine the highest derivatives",
            Self::Wide => "the enclosure grows without bound",
        }
    }
}

/// What a reference may miss, in parts of a component's size for the whole phase. Far below what splines miss, far above
/// rounding.
const RESIDUAL: f64 = 1e-9;

/// Length of a box times the norm of the rates: the series of the transition converges fast, and Picard's box exists.
const MOST_RATE: f64 = 0.5;

/// How often a box of differences is widened in search of one that they cannot leave, and by what part.
const TRIALS: usize = 12;
const WIDER: f64 = 0.2;

/// What part of a box of differences is left empty, so that another arithmetic finds that it is not left.
const EMPTY: f64 = 1e-3;

/// Differences as large as the state itself are no enclosure.
const MOST_DIFFERENCE: f64 = 10.0;

impl Turned {
    /// A box along the axes.
    pub(super) fn upright(extents: Vec<Interval>) -> Self {
        let size = extents.len();
        let directions = (0..size).map(|i| (0..size).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        Self { directions, extents }
    }

    /// The smallest box along the axes around it.
    pub(super) fn hull(&self) -> Vec<Interval> {
        Matrix::of_numbers(&self.directions).apply(&self.extents)
    }

    /// All `image x + shift`, for x in the extents (docs/maths.md, equation 15.13).
    fn moved(&self, image: &Matrix, shift: &[Interval]) -> Option<Self> {
        let mut long = image.middle();
        for row in &mut long {
            row.iter_mut().zip(&self.extents).for_each(|(entry, extent)| *entry *= extent.size());
        }
        let directions = basis(&long);
        let back = inverse_of_basis(&directions)?;
        let (turned, shift) = (back.times(image).apply(&self.extents), back.apply(shift));
        Some(Self { directions, extents: turned.iter().zip(shift).map(|(a, b)| *a + b).collect() })
    }
}

impl Window {
    pub(super) fn halves(&self) -> [Self; 2] {
        let split = |pieces: &[Piece]| -> (Vec<Piece>, Vec<Piece>) { pieces.iter().map(Piece::halves).unzip() };
        let (inputs, components) = (split(&self.inputs), split(&self.components));
        let (highest, tau) = (split(&self.highest), self.tau.halves());
        let (cell, halvings, length) = (self.cell, self.halvings + 1, self.length.scaled(0.5));
        let part = 2 * self.part;
        [
            Self {
                cell,
                halvings,
                part,
                length,
                tau: tau.0,
                inputs: inputs.0,
                components: components.0,
                highest: highest.0,
            },
            Self {
                part: part + 1,
                cell,
                halvings,
                length,
                tau: tau.1,
                inputs: inputs.1,
                components: components.1,
                highest: highest.1,
            },
        ]
    }
}

/// Boxes of differences, by the most of each, and where those of the components are found to be.
struct Sets {
    inside: Vec<f64>,
    slack: Vec<f64>,
    reached: Vec<Interval>,
}

/// The differential inequality of differences on a box: their derivative by scaled time is in `rates e + drift`.
struct Rates {
    rates: Matrix,
    drift: Vec<Interval>,
    /// By how much the highest derivatives differ.
    highest: Vec<Interval>,
}

impl Flow<'_> {
    /// Encloses the differences over a box and at its end. The shortest boxes need not have small residuals.
    pub(super) fn step(&self, window: &Window, from: &Front, is_shortest: bool) -> Result<Step, Trouble> {
        let given = Given {
            inputs: &window.inputs,
            highest: &window.highest,
            tau: &window.tau,
            length: window.length,
            start: &from.start,
            scales: (&self.scales.0, &self.scales.1),
        };
        let reference = collocate(self.machine, self.system, &self.rule, &given).ok_or(Trouble::NoReference)?;
        let residuals = self.residuals(window, &reference)?;
        let begin = from.differences.hull();
        let (found, sets) = self.picard(window, &reference, (&residuals, &begin))?;
        let drift = found.drift.iter().fold(0.0, |most: f64, x| most.max(x.size()));
        if drift > RESIDUAL && !is_shortest {
            return Err(Trouble::Coarse);
        }
        let (image, pushed) = transition(&found, (&from.differences.directions, &sets.inside), window.length);
        // The reference ends at a double; the rest is a difference.
        let ends: Vec<Interval> = reference.components.iter().map(Piece::last).collect();
        let start: Vec<f64> = ends.iter().map(|x| x.middle()).collect();
        let jump = self.scaled(ends.iter().zip(&start).map(|(x, at)| *x - Interval::point(*at)));
        let shift: Vec<Interval> = pushed.iter().zip(&jump).map(|(a, b)| *a + *b).collect();
        let differences = from.differences.moved(&image, &shift).ok_or(Trouble::Wide)?;
        let proof = self.proof(&reference, from, (&sets, &differences));
        let at_end = differences.hull();
        if at_end.iter().any(|x| x.size().is_nan() || x.size() > MOST_DIFFERENCE) {
            return Err(Trouble::Wide);
        }
        let from_splines = reference.components.iter().zip(&window.components).enumerate();
        let over =
            from_splines.map(|(c, (own, spline))| apart(own, spline) + sets.reached[c] * self.scales.0[c]).collect();
        let last =
            |(c, spline): (usize, &Piece)| Interval::point(start[c]) - spline.last() + at_end[c] * self.scales.0[c];
        let at_end = window.components.iter().enumerate().map(last).collect();
        Ok(Step { over, at_end, front: Front { start, differences }, proof })
    }

    /// What proves the box again.
    fn proof(&self, reference: &Reference, from: &Front, (sets, end): (&Sets, &Turned)) -> Proof {
        let si = |sizes: &[f64], scales: &[f64]| sizes.iter().zip(scales).map(|(size, scale)| size * scale).collect();
        let rows = end.directions.iter().zip(&self.scales.0);
        Proof {
            start: from.start.clone(),
            highest: reference.highest.iter().flat_map(Piece::middles).collect(),
            inside: si(&sets.inside, &self.scales.0),
            slack: si(&sets.slack, &self.scales.1),
            directions: rows.flat_map(|(row, scale)| row.iter().map(move |x| x * scale)).collect(),
        }
    }

    /// Components in their scales.
    pub(super) fn scaled(&self, components: impl Iterator<Item = Interval>) -> Vec<Interval> {
        components.zip(&self.scales.0).map(|(x, scale)| x.over(Interval::point(*scale))).collect()
    }

    /// By how much the reference misses the equations over the box.
    fn residuals(&self, window: &Window, reference: &Reference) -> Result<Vec<Interval>, Trouble> {
        let jets = |pieces: &[Piece]| -> (Vec<Jet>, Vec<Jet>) { pieces.iter().map(Piece::jets).unzip() };
        let (components, highest) = (jets(&reference.components), jets(&reference.highest));
        let (inputs, tau) = (jets(&window.inputs), window.tau.jets());
        let at = Values { components: components.0, highest: highest.0, inputs: inputs.0, tau: tau.0 };
        let over = Values { components: components.1, highest: highest.1, inputs: inputs.1, tau: tau.1 };
        let centres = self.system.residuals(self.machine, &at);
        let all = self.system.residuals(self.machine, &over);
        if all.iter().any(|jet| !jet.total) {
            return Err(Trouble::Unbounded);
        }
        Ok(all.iter().zip(&centres).map(|(all, centre)| all.range(centre)).collect())
    }

    /// A box that the differences do not leave, with the rates in it (docs/maths.md, equation 15.11).
    fn picard(
        &self,
        window: &Window,
        reference: &Reference,
        (residuals, begin): (&[Interval], &[Interval]),
    ) -> Result<(Rates, Sets), Trouble> {
        let during = Interval::new(0.0, window.length.high());
        let mut inside: Vec<f64> = begin.iter().map(|x| wider(x.size())).collect();
        let mut slack = vec![0.0; self.system.unknowns.len()];
        for _ in 0..TRIALS {
            let around = [&inside, &slack].map(|sizes| sizes.iter().map(|x| Interval::new(-x, *x)).collect::<Vec<_>>());
            let found = self.rates(window, reference, (residuals, &around[0], &around[1]))?;
            if found.rates.norm() * window.length.high() > MOST_RATE {
                return Err(Trouble::Wide);
            }
            let slopes = found.rates.apply(&around[0]);
            let reached: Vec<Interval> =
                (0..begin.len()).map(|c| begin[c] + (slopes[c] + found.drift[c]) * during).collect();
            let leaves = |most: f64, x: &Interval| x.size() > most * (1.0 - EMPTY);
            let mut is_left = false;
            for (sizes, found) in [(&mut inside, &reached), (&mut slack, &found.highest)] {
                // A box that is not left stays as it is: a wider one would push the others out again.
                for (most, x) in sizes.iter_mut().zip(found).filter(|(most, x)| leaves(**most, x)) {
                    (*most, is_left) = (wider(x.size()), true);
                }
            }
            if !is_left {
                return Ok((found, Sets { inside, slack, reached }));
            }
            if inside.iter().chain(&slack).any(|x| x.is_nan() || *x > MOST_DIFFERENCE) {
                return Err(Trouble::Wide);
            }
        }
        Err(Trouble::Wide)
    }

    /// The rates of differences for all differences inside (docs/maths.md, equations 15.9 and 15.10).
    fn rates(
        &self,
        window: &Window,
        reference: &Reference,
        (residuals, inside, highest): (&[Interval], &[Interval], &[Interval]),
    ) -> Result<Rates, Trouble> {
        let around = |pieces: &[Piece], by: &[Interval], scales: &[f64]| -> Vec<Interval> {
            pieces.iter().zip(by).zip(scales).map(|((piece, by), scale)| piece.hull() + *by * *scale).collect()
        };
        let values = Values {
            components: around(&reference.components, inside, &self.scales.0),
            highest: around(&reference.highest, highest, &self.scales.1),
            inputs: window.inputs.iter().map(Piece::hull).collect(),
            tau: window.tau.hull(),
        };
        let scales = (&self.scales.0[..], &self.scales.1[..]);
        let (by_x, by_w) = self.system.partials(self.machine, &values, scales).ok_or(Trouble::Unbounded)?;
        let (size, count) = (self.system.size, self.system.unknowns.len());
        let mut rights = Matrix::zero(count, size + 1);
        for (row, residual) in residuals.iter().enumerate() {
            (0..size).for_each(|c| *rights.at_mut(row, c) = -by_x.at(row, c));
            *rights.at_mut(row, size) = -*residual;
        }
        let solved = eliminate(&by_w, &rights).ok_or(Trouble::Singular)?;
        let (mut rates, mut drift) = (Matrix::zero(size, size), vec![Interval::ZERO; size]);
        let ratio = |above: f64, own: f64| Interval::point(above).over(Interval::point(own));
        for (u, unknown) in self.system.unknowns.iter().enumerate() {
            for k in 0..unknown.order {
                let own = unknown.first + k;
                if k + 1 < unknown.order {
                    *rates.at_mut(own, own + 1) = ratio(self.scales.0[own + 1], self.scales.0[own]);
                } else {
                    let factor = ratio(self.scales.1[u], self.scales.0[own]);
                    (0..size).for_each(|c| *rates.at_mut(own, c) = solved.at(u, c) * factor);
                    drift[own] = solved.at(u, size) * factor;
                }
            }
        }
        let differ =
            |u: usize| solved.row(u)[..size].iter().zip(inside).fold(solved.at(u, size), |sum, (a, e)| sum + *a * *e);
        Ok(Rates { rates, drift, highest: (0..count).map(differ).collect() })
    }
}

/// A size, a part larger.
fn wider(size: f64) -> f64 {
    (1.0 + WIDER) * size + f64::EPSILON * f64::EPSILON
}

/// The difference of two polynomials on the same box.
fn apart(a: &Piece, b: &Piece) -> Interval {
    let ((a, over_a), (b, over_b)) = (a.jets::<COUNT>(), b.jets());
    (over_a - over_b).range(&(a - b))
}

/// Where the flow moves directions to over a box, and by how much it moves what does not differ (docs/maths.md, equation
/// 15.12): the series of the transition, whose rest is bounded by all differences inside.
fn transition(found: &Rates, (directions, inside): (&[Vec<f64>], &[f64]), length: Interval) -> (Matrix, Vec<Interval>) {
    /// How many powers of the rates are taken; the next one bounds the rest. As in `ntg-check`.
    const POWERS: usize = 8;
    let mut image = Matrix::of_numbers(directions);
    let mut term = image.clone();
    let mut rest: Vec<Interval> = inside.iter().map(|most| Interval::new(-most, *most)).collect();
    let (mut pushed, mut push) = (vec![Interval::ZERO; inside.len()], vec![Interval::ZERO; inside.len()]);
    for k in 1..=POWERS + 1 {
        let by = length.over(Interval::point(k as f64));
        let drift: &[Interval] = if k == 1 { &found.drift } else { &[] };
        let next = |x: &[Interval]| -> Vec<Interval> { found.rates.apply(x).into_iter().map(|x| x * by).collect() };
        (push, rest) = (next(&push), next(&rest));
        for (c, own) in drift.iter().enumerate() {
            push[c] = push[c] + *own * by;
            rest[c] = rest[c] + *own * by;
        }
        if k <= POWERS {
            term = found.rates.times(&term).map(|x| x * by);
            image = image.plus(&term);
            pushed.iter_mut().zip(&push).for_each(|(sum, x)| *sum = *sum + *x);
        }
    }
    (image, pushed.iter().zip(rest).map(|(a, b)| *a + b).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Vec<Vec<f64>> {
        vec![vec![1.0, 0.0], vec![0.0, 1.0]]
    }

    fn turning(rate: f64, drift: f64) -> Rates {
        let rates = Matrix::of_numbers(&[vec![0.0, rate], vec![-rate, 0.0]]);
        Rates { rates, drift: vec![Interval::point(drift), Interval::ZERO], highest: vec![] }
    }

    #[test]
    fn the_transition_of_a_turn_is_a_turn() {
        let (turn, pushed) = transition(&turning(1.0, 0.5), (&unit(), &[0.5, 0.5]), Interval::point(0.5));
        for (at, expected) in [((0, 0), 0.5_f64.cos()), ((0, 1), 0.5_f64.sin()), ((1, 0), -0.5_f64.sin())] {
            let found = turn.at(at.0, at.1);
            assert!((found.middle() - expected).abs() < 1e-8, "{at:?}: {found:?}");
        }
        // All differences are below a half, and the rest is a part of that.
        for (found, expected) in pushed.iter().zip([0.5 * 0.5_f64.sin(), 0.5 * (0.5_f64.cos() - 1.0)]) {
            assert!(found.contains(expected) && found.width() < 1e-8, "{found:?} {expected}");
        }
    }

    #[test]
    fn turned_boxes_do_not_grow_by_turning() {
        // A hundred turns by a hundredth of a circle: a box along the axes would have grown by exp(8 pi / 2).
        let turn = turning(std::f64::consts::TAU / 100.0, 0.0);
        let mut set = Turned::upright(vec![Interval::new(-1.0, 1.0), Interval::new(-0.01, 0.01)]);
        for _ in 0..100 {
            let (image, pushed) = transition(&turn, (&set.directions, &[1.1, 1.1]), Interval::ONE);
            set = set.moved(&image, &pushed).expect("a turn");
        }
        let hull = set.hull();
        assert!(hull[0].contains(1.0) && hull[0].contains(-1.0) && hull[0].size() < 1.2, "{hull:?}");
        assert!(hull[1].contains(0.01) && hull[1].size() < 0.2, "{hull:?}");
    }
}
