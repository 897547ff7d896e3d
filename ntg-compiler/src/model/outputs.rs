//! Flat outputs and their splines in each phase.
//!
//! Takes the `output` items of agents and phases, fills `Phase::outputs`: those of the agent, with
//! another spline where the phase says so, then the phase's own.
//! Finds: splines that do not exist, arrays with impossible sizes.

use ntg_splines::{KnotError, Knots};
use ntg_structure::{Grid, Spline, Unit};

use super::dimension::Dimension;
use super::elaborator::{Elaborator, doc_text};
use super::problem::Output;
use super::scope::{Allow, Context, ScopeId};
use super::shape::Ends;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{self, Course, DeclaredName, ItemKind, Role};

/// A spline in place of one that is wrong: so high that no derivative is refused because of it.
pub(super) fn stand_in() -> Spline {
    Spline { order: 40, smoothness: 39, breakpoints: vec![0.0, 1.0] }
}

/// The indices of the elements of a matrix.
pub(super) fn grid_of(axes: &[Ends]) -> Option<Grid> {
    let [rows, columns] = axes else { return None };
    let ((row, _), (column, last)) = (rows.numbers()?, columns.numbers()?);
    Some(Grid { row, column, columns: (last - column + 1).max(0) })
}

/// One declared output.
struct Declared {
    output: Output,
    axes: Vec<Ends>,
    /// None where its unit was refused.
    dimension: Option<Dimension>,
    has_unit: bool,
}

impl<'a> Elaborator<'a> {
    /// The outputs of every phase.
    pub(super) fn outputs(&mut self) {
        for phase in 0..self.phases.len() {
            let (scope, agent) = (self.phases[phase].scope, self.phases[phase].agent);
            let common = self.agents[agent].scope;
            let mut all = self.outputs_of(common, phase);
            if scope != common {
                for own in self.outputs_of(scope, phase) {
                    match all.iter_mut().find(|known| known.output.name == own.output.name) {
                        Some(known) => self.replace(known, own),
                        None => all.push(own),
                    }
                }
            }
            if all.is_empty() {
                let span = self.phases[phase].span;
                let finding = Diagnostic::new(Code::NoOutput, span, "there is no output here: nothing can move");
                self.report(finding.help("declare one: `output x: spline(order = 5, intervals = 8);`"));
            }
            self.output_dimensions.push(all.iter().map(|declared| declared.dimension).collect());
            self.output_axes.push(all.iter().map(|declared| declared.axes.clone()).collect());
            self.problem.phases[phase].outputs = all.into_iter().map(|declared| declared.output).collect();
        }
    }

    /// A common output gets the spline of a phase; its unit and size stay what they are.
    fn replace(&mut self, known: &mut Declared, own: Declared) {
        let name = &own.output.name;
        if own.has_unit
            && let (Some(this), Some(that)) = (own.dimension, known.dimension)
            && this != that
        {
            let (this, that) = (this.describe(), that.describe());
            let finding =
                Diagnostic::new(Code::DimensionMismatch, own.output.span, format!("`{name}` is {that}, not {this}"))
                    .label(own.output.span, format!("this is {this}"))
                    .label(known.output.span, format!("this is {that}"))
                    .help("leave the unit out: the phase only replaces the spline");
            self.report(finding);
        }
        if own.axes != known.axes {
            let message = format!("`{name}` has another size outside the phase");
            let finding = Diagnostic::new(Code::WrongCount, own.output.span, message)
                .label(known.output.span, "declared here")
                .help("write the same size: the phase only replaces the spline");
            self.report(finding);
        }
        known.output.spline = own.output.spline;
        if own.has_unit {
            known.output.unit = own.output.unit;
        }
    }

    fn outputs_of(&mut self, scope: ScopeId, phase: usize) -> Vec<Declared> {
        let mut all: Vec<Declared> = Vec::new();
        for item in self.items[scope] {
            let ItemKind::Output(output) = &item.kind else { continue };
            self.units_taken(output);
            let spline = match &output.course {
                Course::Spline(spline) => self.spline((scope, phase), spline, output.role),
                course => self.collocated_start(phase, (course, output.role), item.span),
            };
            for name in &output.names {
                if all.iter().any(|known| known.output.name == name.name.text) {
                    continue; // Told of when it was declared.
                }
                let doc = doc_text(&item.doc);
                let spline = self.collocated(phase, (&output.course, output.role), name, spline.clone());
                all.push(self.output_declaration(scope, name, doc, &spline));
            }
            let measured = |name: &DeclaredName| {
                let declared = all.iter().find(|declared| declared.output.name == name.name.text);
                declared.map_or((None, Unit::default()), |found| (found.dimension, found.output.unit.clone()))
            };
            let measured: Vec<_> = output.names.iter().map(measured).collect();
            for at in self.units_in_doubt(&output.names, &measured) {
                let doubtful = all.iter_mut().filter(|known| known.output.name == output.names[at].name.text);
                doubtful.for_each(|known| known.dimension = None);
            }
        }
        all
    }

    fn output_declaration(&mut self, scope: ScopeId, name: &'a DeclaredName, doc: String, spline: &Spline) -> Declared {
        let cx = Context::of(scope, Allow::Constants);
        let axes = name.shape.as_ref().map_or(Vec::new(), |shape| self.declared_axes(&cx, shape));
        let family = self.family_of(&axes);
        let unit = name.unit.as_ref().and_then(|unit| self.unit(unit));
        let has_unit = name.unit.is_some() || name.bounds.is_some();
        let (dimension, unit) = match unit {
            Some((quantity, shown)) => (Some(quantity.dimension), shown),
            None if name.unit.is_some() => (None, Unit::default()),
            None => self.unit_of_bounds(scope, name),
        };
        let extent = |ends: &Ends| ends.extent().and_then(|extent| usize::try_from(extent).ok());
        let grid = grid_of(&axes);
        let by_size = name.shape.as_ref().is_some_and(|shape| shape.axes.iter().all(|axis| axis.first.is_none()));
        let vector = match axes.as_slice() {
            [only] if by_size => extent(only),
            [_, columns] => extent(columns),
            _ => None,
        };
        let (name, span, spline) = (name.name.text.clone(), name.name.span, spline.clone());
        let output = Output { name, doc, unit, family, grid, vector, spline, span };
        Declared { output, axes, dimension, has_unit }
    }

    /// The axes of something that is declared with a size; empty ones where the size is wrong.
    pub(super) fn declared_axes(&mut self, cx: &Context<'a>, shape: &'a ast::Shape) -> Vec<Ends> {
        let mut axes = Vec::new();
        for axis in &shape.axes {
            let first = match &axis.first {
                Some(first) => self.whole(cx, first, "the first index of an array"),
                None => Some(1),
            };
            let last = self.whole(cx, &axis.last, "the last index of an array");
            // One element in place of a size that is wrong: what follows would only repeat that.
            let first = first.unwrap_or(1);
            axes.push(Ends::between(first, last.unwrap_or(first)));
        }
        axes
    }

    /// The members of an array: those of its one axis, or as many as it has elements, by rows.
    pub(super) fn family_of(&self, axes: &[Ends]) -> Option<(i64, i64)> {
        match axes {
            [] => None,
            [only] => only.numbers(),
            _ => {
                let extents = axes.iter().map(|ends| ends.extent().unwrap_or(0));
                Some((1, extents.fold(1, i64::saturating_mul)))
            }
        }
    }

    /// The spline as written; a stand-in where it is wrong.
    fn spline(&mut self, at: (ScopeId, usize), spline: &'a ast::Spline, role: Role) -> Spline {
        self.spline_as_written(at, spline, role).unwrap_or_else(stand_in)
    }

    fn spline_as_written(
        &mut self,
        (scope, phase): (ScopeId, usize),
        spline: &'a ast::Spline,
        role: Role,
    ) -> Option<Spline> {
        let cx = Context::of(scope, Allow::Constants);
        let Some(order) = &spline.order else {
            let finding = Diagnostic::new(Code::WrongSpline, spline.span, "a spline needs an order");
            self.report(finding.help("write `spline(order = 5, intervals = 8)`; order 5 is degree 4"));
            return None;
        };
        let k = self.natural(&cx, order, "the order of a spline")?;
        let m = match &spline.smoothness {
            Some(smoothness) => self.natural(&cx, smoothness, "the smoothness of a spline")?,
            None => k.saturating_sub(1),
        };
        let knots = match (&spline.knots, &spline.intervals) {
            (Some(knots), None) => {
                let points: Vec<Option<f64>> =
                    knots.elements.iter().map(|e| self.pure_constant(&cx, e, "a breakpoint of a spline")).collect();
                Knots::new(k, points.into_iter().collect::<Option<_>>()?, m)
            }
            (None, Some(intervals)) => {
                let intervals = self.natural(&cx, intervals, "the number of intervals of a spline")?;
                Knots::uniform(k, intervals, m)
            }
            (Some(knots), Some(_)) => {
                let finding = Diagnostic::new(Code::WrongSpline, knots.span, "both `knots` and `intervals` are given");
                self.report(finding.help("keep one of them: `intervals` are equal, `knots` are as you write them"));
                return None;
            }
            (None, None) => {
                let Some(breakpoints) = self.common_breakpoints(phase) else {
                    let finding =
                        Diagnostic::new(Code::WrongSpline, spline.span, "a spline needs a number of intervals");
                    self.report(finding.help(match role {
                        Role::Output => "write `spline(order = 5, intervals = 8)`",
                        _ => "write `spline(order = 4, intervals = 20)`, or `intervals = 20` in `collocation`",
                    }));
                    return None;
                };
                Knots::new(k, breakpoints, m)
            }
        };
        match knots {
            Ok(knots) => {
                let breakpoints = knots.breakpoints().to_vec();
                Some(Spline { order: knots.order(), smoothness: knots.smoothness(), breakpoints })
            }
            Err(error) => {
                self.wrong_spline(spline, error);
                None
            }
        }
    }

    pub(super) fn wrong_spline(&mut self, spline: &ast::Spline, error: KnotError) {
        let part = |expr: &Option<ast::Expr>| expr.as_ref().map(|expr| expr.span);
        let knot = |index: usize| spline.knots.as_ref().and_then(|knots| knots.elements.get(index)).map(|e| e.span);
        let (span, help) = match error {
            KnotError::Order { .. } => (part(&spline.order), "write an order such as 5, which is degree 4"),
            KnotError::Smoothness { .. } => (part(&spline.smoothness), "lower `smoothness`, or raise `order`"),
            KnotError::Intervals { .. } => (part(&spline.intervals), "write a number of intervals such as 8"),
            KnotError::NotFinite { index } | KnotError::NotIncreasing { index } => {
                (knot(index), "breakpoints increase from 0 to 1: `knots = (0, 0.2, 0.6, 1)`")
            }
            _ => (
                spline.knots.as_ref().map(|knots| knots.span),
                "breakpoints are in scaled time, from 0 to 1: `knots = (0, 0.2, 0.6, 1)`",
            ),
        };
        let finding = Diagnostic::new(Code::WrongSpline, span.unwrap_or(spline.span), error.to_string());
        self.report(finding.help(help));
    }

    /// A whole number that is not negative.
    pub(super) fn natural(&mut self, cx: &Context<'a>, expr: &'a ast::Expr, what: &str) -> Option<usize> {
        let value = self.whole(cx, expr, what)?;
        if let Ok(value) = usize::try_from(value) {
            return Some(value);
        }
        let message = format!("{what} is not negative, this is {value}");
        self.report(Diagnostic::new(Code::NotWhole, expr.span, message).help("write a whole number, 0 or more"));
        None
    }

    /// A constant that is a pure number.
    pub(super) fn pure_constant(&mut self, cx: &Context<'a>, expr: &'a ast::Expr, what: &str) -> Option<f64> {
        let constant = self.constant(cx, expr, what)?;
        let Some(dimension) = constant.dimension.filter(|d| !d.is_none()) else { return Some(constant.value) };
        let message = format!("{what} is a pure number, this is {}", dimension.describe());
        self.report(Diagnostic::new(Code::NotPure, expr.span, message).help("write it without a unit"));
        None
    }
}
