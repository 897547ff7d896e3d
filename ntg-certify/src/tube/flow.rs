//! One box of time of a tube: how far the true state may be from the reference (docs/maths.md, section 15.7).
//!
//! Differences are in the scales of their components, so that they can be compared with each other.

use super::matrix::{Matrix, basis, inverse_of_basis, solve_enclosed};
use super::reference::{Given, Reference, Rule, collocate};
use super::system::{System, Values};
use crate::evaluate::Machine;
use crate::interval::Interval;
use crate::jet::Jet;
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

    /// All `transition x + shift`, for x inside (docs/maths.md, equation 15.13).
    fn moved(&self, transition: &Matrix, shift: &[Interval]) -> Option<Self> {
        let image = transition.times(&Matrix::of_numbers(&self.directions));
        let mut long = image.middle();
        for row in &mut long {
            row.iter_mut().zip(&self.extents).for_each(|(entry, extent)| *entry *= extent.size());
        }
        let directions = basis(&long);
        let back = inverse_of_basis(&directions)?;
        let (turned, shift) = (back.times(&image).apply(&self.extents), back.apply(shift));
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
        let (found, inside) = self.picard(window, &reference, (&residuals, &begin))?;
        let drift = found.drift.iter().fold(0.0, |most: f64, x| most.max(x.size()));
        if drift > RESIDUAL && !is_shortest {
            return Err(Trouble::Coarse);
        }
        let (whole, end) = transitions(&found.rates, window.length).ok_or(Trouble::Wide)?;
        let pushed: Vec<Interval> = whole.apply(&found.drift).iter().map(|x| *x * window.length).collect();
        // The reference ends at a double; the rest is a difference.
        let ends: Vec<Interval> = reference.components.iter().map(Piece::last).collect();
        let start: Vec<f64> = ends.iter().map(|x| x.middle()).collect();
        let jump = self.scaled(ends.iter().zip(&start).map(|(x, at)| *x - Interval::point(*at)));
        let shift: Vec<Interval> = pushed.iter().zip(&jump).map(|(a, b)| *a + *b).collect();
        let differences = from.differences.moved(&end, &shift).ok_or(Trouble::Wide)?;
        let during = Interval::new(0.0, window.length.high());
        let drifts = whole.apply(&found.drift);
        let over = whole.apply(&begin).into_iter().zip(drifts).map(|(a, b)| a + b * during);
        let over: Vec<Interval> = over.zip(inside).map(|(a, b)| a.meet(b)).collect();
        let at_end = differences.hull();
        if at_end.iter().any(|x| x.size().is_nan() || x.size() > MOST_DIFFERENCE) {
            return Err(Trouble::Wide);
        }
        let from_splines = reference.components.iter().zip(&window.components).enumerate();
        let over = from_splines.map(|(c, (own, spline))| apart(own, spline) + over[c] * self.scales.0[c]).collect();
        let last =
            |(c, spline): (usize, &Piece)| Interval::point(start[c]) - spline.last() + at_end[c] * self.scales.0[c];
        let at_end = window.components.iter().enumerate().map(last).collect();
        Ok(Step { over, at_end, front: Front { start, differences } })
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
    ) -> Result<(Rates, Vec<Interval>), Trouble> {
        let during = Interval::new(0.0, window.length.high());
        let mut inside: Vec<Interval> = begin.iter().map(|x| wider(*x)).collect();
        let mut highest = vec![Interval::ZERO; self.system.unknowns.len()];
        for _ in 0..TRIALS {
            let found = self.rates(window, reference, (residuals, &inside, &highest))?;
            if found.rates.norm() * window.length.high() > MOST_RATE {
                return Err(Trouble::Wide);
            }
            let slopes = found.rates.apply(&inside);
            let reached: Vec<Interval> =
                (0..begin.len()).map(|c| begin[c] + (slopes[c] + found.drift[c]) * during).collect();
            let stays = inside.iter().zip(&reached).all(|(all, x)| all.encloses(*x));
            let known = highest.iter().zip(&found.highest).all(|(all, x)| all.low() < x.low() && x.high() < all.high());
            if stays && known {
                return Ok((found, reached));
            }
            inside = inside.iter().zip(&reached).map(|(a, b)| wider(a.hull(*b))).collect();
            highest = highest.iter().zip(&found.highest).map(|(a, b)| wider(a.hull(*b))).collect();
            if inside.iter().chain(&highest).any(|x| x.size().is_nan() || x.size() > MOST_DIFFERENCE) {
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
        let solved = solve_enclosed(&by_w, &rights).ok_or(Trouble::Singular)?;
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

/// What is around an interval, a part of its size farther out on both sides.
fn wider(x: Interval) -> Interval {
    let by = WIDER * x.width() + 1e-15 * x.size() + f64::MIN_POSITIVE;
    Interval::new(x.low() - by, x.high() + by)
}

/// The difference of two polynomials on the same box.
fn apart(a: &Piece, b: &Piece) -> Interval {
    let ((a, over_a), (b, over_b)) = (a.jets(), b.jets());
    (over_a - over_b).range(&(a - b))
}

/// The transition matrices to all times of a box, and to its end (docs/maths.md, equation 15.12).
fn transitions(rates: &Matrix, length: Interval) -> Option<(Matrix, Matrix)> {
    const TERMS: usize = 12;
    let scaled = rates.clone().map(|x| x * length);
    let norm = scaled.norm();
    if norm.is_nan() || norm > 1.0 {
        return None;
    }
    let size = rates.rows();
    let (mut end, mut whole) = (Matrix::identity(size), Matrix::identity(size));
    let (mut power, mut rest) = (Matrix::identity(size), Interval::ONE);
    for k in 1..=TERMS {
        power = scaled.times(&power).map(|x| x.over(Interval::point(k as f64)));
        rest = (rest * Interval::point(norm)).over(Interval::point(k as f64));
        end = end.plus(&power);
        whole = whole.plus(&power.clone().map(|x| x.hull(Interval::ZERO)));
    }
    // What follows is less than a geometric series with the ratio norm / (TERMS + 1), at most a half.
    let slack = (rest * Interval::point(norm)).over(Interval::point(TERMS as f64 / 2.0)).high();
    let slack = |x: Interval| x + Interval::new(-slack, slack);
    Some((whole.map(slack), end.map(slack)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transition_of_a_turn_is_a_turn() {
        let rates = Matrix::of_numbers(&[vec![0.0, 1.0], vec![-1.0, 0.0]]);
        let (whole, end) = transitions(&rates, Interval::point(0.5)).expect("a short box");
        for (at, expected) in [((0, 0), 0.5_f64.cos()), ((0, 1), 0.5_f64.sin()), ((1, 0), -0.5_f64.sin())] {
            let found = end.at(at.0, at.1);
            assert!(found.contains(expected) && found.width() < 1e-12, "{at:?}: {found:?}");
        }
        for i in 0..=10 {
            let t = 0.05 * f64::from(i);
            assert!(whole.at(0, 0).contains(t.cos()) && whole.at(0, 1).contains(t.sin()));
        }
        assert!(transitions(&rates, Interval::point(1.5)).is_none());
    }

    #[test]
    fn turned_boxes_do_not_grow_by_turning() {
        // A hundred turns by a hundredth of a circle: a box along the axes would have grown by exp(8 pi / 2).
        let angle = std::f64::consts::TAU / 100.0;
        let rates = Matrix::of_numbers(&[vec![0.0, angle], vec![-angle, 0.0]]);
        let (_, turn) = transitions(&rates, Interval::ONE).expect("a short box");
        let mut set = Turned::upright(vec![Interval::new(-1.0, 1.0), Interval::new(-0.01, 0.01)]);
        for _ in 0..100 {
            set = set.moved(&turn, &[Interval::ZERO; 2]).expect("a turn");
        }
        let hull = set.hull();
        assert!(hull[0].contains(1.0) && hull[0].contains(-1.0) && hull[0].size() < 1.2, "{hull:?}");
        assert!(hull[1].contains(0.01) && hull[1].size() < 0.2, "{hull:?}");
    }
}
