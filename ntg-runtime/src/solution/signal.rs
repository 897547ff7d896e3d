//! Named expressions of a spec as functions of mission time.

use super::trajectory::is_within;
use super::{Inner, Solution};
use crate::problem::Problem;
use crate::transcribe::SetupError;
use crate::transcribe::instances::members;
use crate::transcribe::names;
use crate::transcribe::node::Site;
use crate::transcribe::points::Point;
use ntg_splines::Side;
use ntg_structure::{Domain, Unit};
use std::collections::HashMap;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A named expression (`let`) of one agent, over all of its phases that define it or in one of them.
///
/// It borrows the problem, whose kernels compute it.
///
/// ```
/// use ntg::prelude::*;
///
/// ntg! {
///     /// From rest to rest with the least effort: a cubic, with cost 12 distance^2 / T^3.
///     problem Move {
///         duration T = 2 [s];
///         param distance = 1 [m];
///         output x [m]: spline(order = 6, intervals = 2);
///         let speed [cm/s] = der(x);
///         minimize integral(der(x, 2)^2);
///         initial { x == 0;  der(x) == 0; }
///         final   { reach: x == distance;  der(x) == 0; }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let solution = Move::default().solve(&Settings::default())?;
/// let speed: Signal<'_> = solution.speed();
/// assert!((speed.at(1.0) - 75.0).abs() < 1e-4 && speed.unit().symbol == "cm/s");
/// // The same by name, for programs that know no spec.
/// let problem = Move::default();
/// let signals = solution.untyped().signals(&problem);
/// assert!(signals.iter().any(|signal| signal.name() == "speed"));
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Signal<'p> {
    problem: &'p dyn Problem,
    inner: Arc<Inner>,
    name: String,
    doc: String,
    unit: Unit,
    /// The phases over which it runs: all of its agent's, or one; none for a number.
    phases: Option<Range<usize>>,
    pieces: Vec<Piece>,
}

/// The expression in one phase, or at no point.
#[derive(Clone, Debug)]
struct Piece {
    phase: Option<usize>,
    named: usize,
    indices: Vec<i64>,
}

impl fmt::Debug for Signal<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Signal").field("name", &self.name).field("unit", &self.unit).finish()
    }
}

impl Signal<'_> {
    /// Its path: `speed`, `uav[2].pd[1]`, `covert.speed` in one phase.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its documentation in the spec.
    pub fn doc(&self) -> &str {
        &self.doc
    }

    /// The declared unit, in which values are given.
    pub fn unit(&self) -> &Unit {
        &self.unit
    }

    /// Whether it is a single number rather than a function of time.
    pub fn is_constant(&self) -> bool {
        self.phases.is_none()
    }

    /// Its own start and end in seconds of mission time; none for a single number.
    pub fn span(&self) -> Option<(f64, f64)> {
        let (layout, x) = (&self.inner.model.layout, &self.inner.x);
        let phases = self.phases.clone()?;
        let start = layout.start(phases.start, x);
        Some((start, phases.fold(start, |t, phase| t + layout.duration(phase, x))))
    }

    /// Whether a mission time, in seconds, is within its own time, as any is within that of a single number.
    pub fn exists_at(&self, t: f64) -> bool {
        self.span().is_none_or(|span| is_within(t, span))
    }

    /// Becomes the same expression in another solution; false, and nothing changes, where that is of another problem.
    pub fn rebind(&mut self, solution: &Solution) -> bool {
        let is_same = self.inner.has_layout_of(&solution.inner);
        if is_same {
            self.inner = Arc::clone(&solution.inner);
        }
        is_same
    }

    /// The value at mission time `t` (seconds, clamped to its own time), in the declared unit.
    /// NaN in a phase that does not define it.
    pub fn at(&self, t: f64) -> f64 {
        self.values(&[t])[0]
    }

    /// The values at many mission times, all at once: far cheaper than one by one.
    pub fn values(&self, times: &[f64]) -> Vec<f64> {
        let mut values = vec![f64::NAN; times.len()];
        let places: Vec<(Option<usize>, Point)> = times.iter().map(|t| self.point(*t)).collect();
        for piece in &self.pieces {
            let own: Vec<usize> = (0..times.len()).filter(|i| places[*i].0 == piece.phase).collect();
            let model = &self.inner.model;
            let call = &model.structure.named[piece.named].call;
            let site = |i: &usize| Site { indices: piece.indices.clone(), point: places[*i].1 };
            let sites = own.iter().filter(|i| !(piece.phase.is_some() && places[**i].1.tau.is_nan()));
            let sites: Vec<usize> = sites.copied().collect();
            let found = model.frame(self.problem).evaluate_all(call, sites.iter().map(site).collect(), &self.inner.x);
            for (i, value) in sites.iter().zip(found.into_iter().flatten()) {
                values[*i] = value / self.unit.factor;
            }
        }
        values
    }

    /// Where a mission time is.
    pub(crate) fn place(&self, t: f64) -> Option<Place> {
        let (phase, point) = self.point(t);
        let piece = self.pieces.iter().find(|piece| piece.phase == phase)?;
        if phase.is_some() && point.tau.is_nan() {
            return None;
        }
        let phase = phase.map(|phase| (phase, point.tau));
        Some(Place { phase, named: piece.named, indices: piece.indices.clone() })
    }

    /// The phase and the point of a mission time; a point whose scaled time is NaN where there is none.
    fn point(&self, t: f64) -> (Option<usize>, Point) {
        let Some(phases) = &self.phases else { return (None, Point::NONE) };
        match self.inner.locate(phases, t) {
            Some((phase, tau)) => {
                let side = if tau == 1.0 { Side::Left } else { Side::Right };
                (Some(phase), Point { phase: Some(phase), tau, side, weight: f64::NAN })
            }
            None => (Some(phases.start), Point::NONE),
        }
    }
}

/// Where a named expression is at a mission time.
pub(crate) struct Place {
    /// The phase and the scaled time in it; none for a number.
    pub(crate) phase: Option<(usize, f64)>,
    /// Which of `Structure::named` it is there.
    pub(crate) named: usize,
    /// For which indices.
    pub(crate) indices: Vec<i64>,
}

/// Signals in order, and where each is among them by its name and phases.
#[derive(Default)]
struct Signals<'p> {
    all: Vec<Signal<'p>>,
    known: HashMap<(String, Option<Range<usize>>), usize>, // Looked up, never iterated.
}

impl Solution {
    /// Every named expression; `problem` must be the one that was solved.
    pub fn signals<'p>(&self, problem: &'p dyn Problem) -> Vec<Signal<'p>> {
        let mut found = Signals::default();
        for named in 0..self.structure().named.len() {
            // A structure that could be transcribed has no index outside a family here.
            let _ = self.add_signals(problem, named, &mut found);
        }
        found.all
    }

    /// A named expression by its path: `speed`, `uav[2].speed`, `pd[1]` over all phases of the agent;
    /// `covert.speed`, `uav[2].leg[1].speed` in one phase alone, up to both of its ends.
    pub fn signal<'p>(&self, problem: &'p dyn Problem, path: &str) -> Option<Signal<'p>> {
        let signals = self.signals(problem);
        if let Some(found) = signals.iter().find(|signal| signal.name == path) {
            return Some(found.clone());
        }
        let (structure, layout) = (&self.inner.model.structure, &self.inner.model.layout);
        (0..layout.phases.len()).find_map(|phase| {
            let agent = layout.phases[phase].agent;
            let own = path.strip_prefix(&names::phase(structure, layout, phase))?.strip_prefix('.')?;
            let whole = names::join(&names::agent(structure, layout, agent), own);
            let along = signals.iter().find(|signal| signal.name == whole)?;
            let has = along.pieces.iter().any(|piece| piece.phase == Some(phase));
            has.then(|| Signal { name: path.to_owned(), phases: Some(phase..phase + 1), ..along.clone() })
        })
    }

    fn add_signals<'p>(
        &self,
        problem: &'p dyn Problem,
        named: usize,
        found: &mut Signals<'p>,
    ) -> Result<(), SetupError> {
        let model = &self.inner.model;
        let (structure, layout) = (&model.structure, &model.layout);
        let declared = &structure.named[named];
        for indices in members(&declared.loops) {
            let phase = match &declared.domain {
                Domain::Mission => None,
                Domain::Start(reference) | Domain::End(reference) | Domain::Path { phase: reference, .. } => {
                    Some(layout.phase(structure, reference, &indices)?)
                }
            };
            let agent = phase.map(|phase| layout.phases[phase].agent);
            let index = declared.family.and_then(|_| indices.last().copied());
            // A number's loops are that over its agent's members, if it is a family, and its own.
            let member = structure.agents[declared.agent].family.and_then(|_| indices.first().copied());
            let owner = structure.agents[declared.agent].name.as_deref();
            let path = owner.map_or_else(String::new, |owner| names::indexed(owner, member));
            let name = names::join(&path, &names::member(&declared.name, declared.family, index));
            let phases = agent.map(|agent| layout.agents[agent].phases.clone());
            let piece = Piece { phase, named, indices };
            let at = *found.known.entry((name.clone(), phases.clone())).or_insert_with(|| {
                found.all.push(Signal {
                    problem,
                    inner: self.inner.clone(),
                    name,
                    doc: declared.doc.clone(),
                    unit: declared.unit.clone(),
                    phases,
                    pieces: vec![],
                });
                found.all.len() - 1
            });
            found.all[at].pieces.push(piece);
        }
        Ok(())
    }
}
