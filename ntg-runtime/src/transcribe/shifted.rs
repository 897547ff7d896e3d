//! A program whose variables are measured from their origins (docs/maths.md, equation 5.5a).
//!
//! Takes a transcription with origins; gives the program in the differences from these. Methods measure steps and
//! variables by sizes, and the size of what varies by 5 m at 4000 km from its origin is 5 m.

use super::Transcription;
use super::evaluate::Workspace;
use ntg_nlp::status::Bounded;
use ntg_nlp::{Block, Evaluation, Limits, Nlp, NotFinite, Outcome, Status};

/// A transcription in the differences of its variables from their origins.
pub(crate) struct Shifted<'a> {
    nlp: &'a Transcription<'a>,
    limits: Limits,
}

impl<'a> Shifted<'a> {
    /// None where all origins are 0.
    pub(crate) fn of(nlp: &'a Transcription<'a>) -> Option<Self> {
        if nlp.origin.is_empty() {
            return None;
        }
        let mut limits = nlp.limits.clone();
        for (bounds, origin) in limits.lower.iter_mut().zip(&mut limits.upper).zip(&nlp.origin) {
            *bounds.0 -= origin;
            *bounds.1 -= origin;
        }
        Some(Self { nlp, limits })
    }

    /// The differences of a point from the origins.
    pub(crate) fn shift(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.nlp.origin).map(|(x, origin)| x - origin).collect()
    }

    /// An outcome of the program itself.
    pub(crate) fn unshifted(&self, mut outcome: Outcome) -> Outcome {
        let unshift = |x: &mut [f64]| x.iter_mut().zip(&self.nlp.origin).for_each(|(x, origin)| *x += origin);
        unshift(&mut outcome.x);
        let origin = |of: Bounded| match of {
            Bounded::Variable(variable) => self.nlp.origin[variable],
            Bounded::Row(_) => 0.0,
        };
        match &mut outcome.status {
            Status::NotFinite { x, .. } => unshift(x),
            Status::Infeasible { rows } => rows.iter_mut().for_each(|missed| {
                missed.value += origin(missed.of);
                missed.bound += origin(missed.of);
            }),
            Status::Contradiction { bounds } => bounds.iter_mut().for_each(|crossing| {
                crossing.lower += origin(crossing.of);
                crossing.upper += origin(crossing.of);
            }),
            _ => {}
        }
        outcome
    }

    /// Evaluates the transcription at the point of a difference.
    fn at<T>(&self, x: &[f64], work: &mut Workspace, evaluate: impl FnOnce(&[f64], &mut Workspace) -> T) -> T {
        let mut point = std::mem::take(&mut work.point);
        point.clear();
        point.extend(x.iter().zip(&self.nlp.origin).map(|(x, origin)| x + origin));
        let found = evaluate(&point, work);
        work.point = point;
        found
    }
}

impl Nlp for Shifted<'_> {
    type Workspace = Workspace;

    fn limits(&self) -> &Limits {
        &self.limits
    }

    fn blocks(&self) -> &[Block] {
        self.nlp.blocks()
    }

    fn globals(&self) -> usize {
        self.nlp.globals()
    }

    fn workspace(&self) -> (Workspace, Evaluation) {
        self.nlp.workspace()
    }

    fn values(&self, x: &[f64], work: &mut Workspace, out: &mut Evaluation) -> Result<(), NotFinite> {
        self.at(x, work, |x, work| self.nlp.values(x, work, out))
    }

    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Workspace,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite> {
        self.at(x, work, |x, work| self.nlp.derivatives(x, objective_weight, multipliers, work, out))
    }
}
