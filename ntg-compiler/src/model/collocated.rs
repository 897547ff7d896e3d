//! Splines of states and inputs: what collocation and equations ask for.
//!
//! Takes declarations without a spline of their own. With `p` Gauss points in an interval and `d` the highest derivative
//! of a state in `dynamics`, the state is a spline of order `p + d` with smoothness `d`: its `d`-th derivative is a
//! polynomial of degree `p - 1` in each interval, as free as `p` equations determine it (docs/maths.md, section 4).
//! Finds: states without intervals, or with other points for equalities than for the rest.

use ntg_splines::Knots;
use ntg_structure::{Spline, Unit};

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::outputs::stand_in;
use super::problem::{Collocation, Form};
use super::scope::{Allow, Context, ScopeId};
use super::units;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{self, Course, DeclaredName, ItemKind, Role};

/// What is said of states under a rule that serves none.
const NO_GAUSS: &str = "states need gauss points, and as many for equalities";

impl<'a> Elaborator<'a> {
    /// What is told once for all names of a declaration; the spline itself follows for each name.
    pub(super) fn collocated_start(&mut self, phase: usize, (_, role): (&Course, Role), span: Span) -> Spline {
        let collocation = self.problem.phases[phase].collocation;
        let fits = matches!(collocation, Collocation::Gauss { points, equalities, .. } if points == equalities);
        if !fits && role == Role::State {
            let finding = Diagnostic::new(Code::WrongPoints, span, NO_GAUSS);
            self.report(
                finding.help("write `collocation gauss(points = 3, intervals = 20);`, or give the state a spline"),
            );
        }
        stand_in()
    }

    /// The spline of a state or input that has none of its own; `written` where it has.
    pub(super) fn collocated(
        &mut self,
        phase: usize,
        (course, role): (&Course, Role),
        name: &'a DeclaredName,
        written: Spline,
    ) -> Spline {
        let points = match self.problem.phases[phase].collocation {
            Collocation::Gauss { points, .. } => points,
            Collocation::Uniform { .. } => 1,
        };
        let (order, smoothness) = match (course, role) {
            (Course::Spline(_), _) => return written,
            (Course::Held, _) => (1, 0),
            (Course::Continuous, _) => (points.max(2), 1),
            (Course::Collocated, Role::State) => {
                let d = self.highest_rate(phase, &name.name.text);
                (points + d, d)
            }
            (Course::Collocated, _) => (points, 0),
        };
        let Some(breakpoints) = self.common_breakpoints(phase) else {
            let message = "states and inputs without a spline of their own need intervals";
            // However many they are, that is one mistake; so is `uniform`, which takes no intervals.
            if self.found.iter().all(|finding| finding.message != message && finding.message != NO_GAUSS) {
                let finding = Diagnostic::new(Code::WrongSpline, name.name.span, message);
                self.report(
                    finding.help("write `collocation gauss(points = 3, intervals = 20);`, which serves all of them"),
                );
            }
            return stand_in();
        };
        match Knots::new(order, breakpoints, smoothness) {
            Ok(knots) => {
                let breakpoints = knots.breakpoints().to_vec();
                Spline { order: knots.order(), smoothness: knots.smoothness(), breakpoints }
            }
            Err(error) => {
                let finding = Diagnostic::new(Code::WrongSpline, name.name.span, error.to_string());
                self.report(finding.help("give it a spline of its own: `: spline(order = 4, intervals = 20)`"));
                stand_in()
            }
        }
    }

    /// The breakpoints that `collocation` gives to every spline without its own, the innermost scope's first.
    pub(super) fn common_breakpoints(&mut self, phase: usize) -> Option<Vec<f64>> {
        let mut next: Option<ScopeId> = Some(self.phases[phase].scope);
        while let Some(scope) = next {
            for item in self.items[scope] {
                let ItemKind::Collocation(collocation) = &item.kind else { continue };
                if collocation.intervals.is_some() || collocation.knots.is_some() {
                    return self.breakpoints_of(scope, collocation);
                }
            }
            next = self.scopes[scope].parent;
        }
        None
    }

    fn breakpoints_of(&mut self, scope: ScopeId, collocation: &'a ast::Collocation) -> Option<Vec<f64>> {
        let cx = Context::of(scope, Allow::Constants);
        let (knots, span) = match (&collocation.knots, &collocation.intervals) {
            (Some(knots), None) => {
                let points: Vec<Option<f64>> =
                    knots.elements.iter().map(|e| self.pure_constant(&cx, e, "a breakpoint of a spline")).collect();
                // Any order will do: only the breakpoints are looked at.
                let Some(points) = points.into_iter().collect() else { return Some(vec![0.0, 1.0]) };
                (Knots::new(2, points, 1), knots.span)
            }
            (None, Some(intervals)) => {
                let Some(n) = self.natural(&cx, intervals, "the number of intervals of a spline") else {
                    return Some(vec![0.0, 1.0]);
                };
                (Knots::uniform(2, n, 1), intervals.span)
            }
            (knots, _) => {
                let span = knots.as_ref().map_or(Span::default(), |knots| knots.span);
                let finding = Diagnostic::new(Code::WrongSpline, span, "both `knots` and `intervals` are given");
                self.report(finding.help("keep one of them: `intervals` are equal, `knots` are as you write them"));
                return Some(vec![0.0, 1.0]);
            }
        };
        match knots {
            Ok(knots) => Some(knots.breakpoints().to_vec()),
            Err(error) => {
                let finding = Diagnostic::new(Code::WrongSpline, span, error.to_string());
                self.report(finding.help("write `intervals = 20`, or `knots = (0, 0.2, 0.6, 1)`, in scaled time"));
                Some(vec![0.0, 1.0])
            }
        }
    }

    /// Dimension and unit of an output without a unit: those of its bounds; no dimension where these were refused.
    pub(super) fn unit_of_bounds(&mut self, scope: ScopeId, name: &'a DeclaredName) -> (Option<Dimension>, Unit) {
        let Some(bounds) = &name.bounds else { return (Some(Dimension::NONE), Unit::default()) };
        let mut is_refused = false;
        let cx = self.first_members(scope, Allow::Parameters);
        for end in bounds.upper.iter().chain(&bounds.lower) {
            let Some(shape) = self.shape(&cx, end) else { continue };
            let first = vec![Form::number(1); shape.axes().len()];
            let value = self.element(&cx, end, &first);
            is_refused |= !value.is_sound();
            if let Some(dimension) = value.dimension.filter(|_| value.is_sound()) {
                let unit = value.unit.map_or_else(|| units::si(&dimension), |unit| (*unit).clone());
                return (Some(dimension), unit);
            }
        }
        ((!is_refused).then_some(Dimension::NONE), Unit::default())
    }
}
