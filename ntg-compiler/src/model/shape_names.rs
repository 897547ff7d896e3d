//! The shapes of names: what is declared with a size, and what its indices leave of it.
//!
//! Takes paths, gives shapes; a definition has the shape of its value, found once for each scope.
//! Finds: slices without elements, or whose number depends on an index.

use super::elaborator::Elaborator;
use super::problem::Form;
use super::scope::{Context, Entity, Meaning, Point, look_up};
use super::shape::{Ends, Shape, whole_axes};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{ExprKind, Path, Segment};

impl<'a> Elaborator<'a> {
    pub(super) fn path_shape(&mut self, cx: &Context<'a>, path: &'a Path) -> Option<Shape> {
        let (segment, outer) = path.segments.split_last()?;
        let name = segment.name.text.as_str();
        if !outer.is_empty() {
            let Some(inner) = self.enter_path(cx, outer) else { return Some(Shape::NUMBER) };
            let inner = Context { lexical: inner.scope, point: Point::Nowhere, ..inner };
            return match self.inside(inner.scope, name) {
                Some(entity) => self.entity_shape(&inner, entity, segment),
                None => Some(Shape::NUMBER),
            };
        }
        match cx.local(name) {
            Some(Meaning::Shaped(shape)) => {
                let shape = shape.clone();
                return self.indexed_shape(cx, segment, &whole_axes(&shape), shape);
            }
            Some(Meaning::Lazy(lazy)) => {
                let shape = lazy.shape.clone();
                return self.indexed_shape(cx, segment, &whole_axes(&shape), shape);
            }
            Some(_) => return Some(Shape::NUMBER),
            None => {}
        }
        if self.index_in_sight(cx, name).is_some() {
            return Some(Shape::NUMBER);
        }
        match look_up(&self.scopes, cx.names(), name) {
            Some((_, declared)) => self.entity_shape(cx, declared.entity, segment),
            None => {
                self.unknown(cx, segment, true);
                self.meets_unknown = true;
                Some(Shape::Any)
            }
        }
    }

    fn entity_shape(&mut self, cx: &Context<'a>, entity: Entity, segment: &'a Segment) -> Option<Shape> {
        let axes = self.axes_of(cx, entity, &segment.name.text)?;
        self.indexed_shape(cx, segment, &axes, Shape::NUMBER)
    }

    /// The axes of what a name stands for.
    pub(super) fn axes_of(&mut self, cx: &Context<'a>, entity: Entity, name: &'a str) -> Option<Vec<Ends>> {
        match entity {
            Entity::Definition(definition) => self.definition_axes(cx, definition),
            Entity::Parameter(parameter) => Some(self.parameter_axes.get(parameter).cloned().unwrap_or_default()),
            Entity::Variable(variable) => Some(self.variable_axes.get(variable).cloned().unwrap_or_default()),
            Entity::Output => Some(self.output_axes_of(cx, name)),
            _ => Some(Vec::new()),
        }
    }

    /// The axes of an output seen from a context.
    fn output_axes_of(&mut self, cx: &Context<'a>, name: &'a str) -> Vec<Ends> {
        let scope = &self.scopes[cx.scope];
        let home = scope.phase.or_else(|| self.agents[scope.agent?].phases.first().copied());
        let Some(home) = home else { return Vec::new() };
        let Some((output, _)) = self.output_named(home, name) else { return Vec::new() };
        self.output_axes.get(home).and_then(|axes| axes.get(output)).cloned().unwrap_or_default()
    }

    /// What is left of the axes of a name when its indices are taken; `whole` where no axes are and none is taken.
    pub(super) fn indexed_shape(
        &mut self,
        cx: &Context<'a>,
        segment: &'a Segment,
        axes: &[Ends],
        whole: Shape,
    ) -> Option<Shape> {
        if !axes.is_empty() && segment.indices.len() > axes.len() {
            // Told here, before a vector is missed around it.
            self.wrong_indices(segment, axes.len());
            return None;
        }
        if axes.is_empty() {
            return Some(if segment.indices.is_empty() { whole } else { Shape::NUMBER });
        }
        let mut left = Vec::new();
        for index in &segment.indices {
            let Some(last) = &index.last else { continue };
            let ends = Ends { first: self.form(cx, &index.first)?, last: self.form(cx, last)? };
            left.push(self.extent(&ends, index.span)?);
        }
        for ends in &axes[segment.indices.len()..] {
            left.push(self.extent(ends, segment.span)?);
        }
        Some(Shape::Of(left))
    }

    /// How many indices lie between two ends; told where no number says so.
    fn extent(&mut self, ends: &Ends, span: Span) -> Option<i64> {
        let extent = ends.extent();
        match extent {
            Some(extent) if extent > 0 => return Some(extent),
            Some(_) => {
                let message = format!("`{}` has no elements", self.text(span));
                self.report(
                    Diagnostic::new(Code::IndexOutside, span, message).help("write `first .. last`, both included"),
                );
            }
            None => {
                let message = format!("how many elements `{}` has depends on an index", self.text(span));
                let help = "write both ends with the same index, `i .. i + 2`, or take one element";
                self.report(Diagnostic::new(Code::NotWhole, span, message).help(help));
            }
        }
        None
    }

    /// The axes of a definition: those of its family, then those of its members.
    pub(super) fn definition_axes(&mut self, cx: &Context<'a>, definition: usize) -> Option<Vec<Ends>> {
        let declared = self.definitions[definition].shape;
        // Sizes that are written mean the same wherever no member of a family is around.
        let is_free = declared.is_some() && cx.agent.is_none() && cx.phase.is_none();
        let key = (definition, cx.scope);
        if let Some(known) = self.written_axes.get(&key).filter(|_| is_free) {
            return Some(known.clone());
        }
        let axes = self.axes_as_written(cx, definition)?;
        if is_free && axes.iter().all(|ends| ends.numbers().is_some()) {
            self.written_axes.insert(key, axes.clone());
        }
        Some(axes)
    }

    fn axes_as_written(&mut self, cx: &Context<'a>, definition: usize) -> Option<Vec<Ends>> {
        let mut axes = Vec::new();
        let declared = self.definitions[definition].shape;
        if let Some(shape) = declared.filter(|_| self.definitions[definition].is_const) {
            let (name, value) = (self.definitions[definition].name, self.definitions[definition].value.span);
            if self.is_unit_for_size(shape, ("const", &name.text), value) {
                return None;
            }
        }
        let outside = self.home(cx, self.definitions[definition].scope);
        let mut sized = false;
        for axis in declared.iter().flat_map(|shape| &shape.axes) {
            let first = match &axis.first {
                Some(first) => self.form(&outside, first)?,
                None => Form::number(1),
            };
            let last = self.form(&outside, &axis.last)?;
            sized |= axis.index.is_none();
            axes.push(Ends { first, last });
        }
        if !sized {
            let shape = self.member_shape(cx, definition)?;
            axes.extend(shape.axes().iter().map(|n| Ends::to(*n)));
        }
        Some(axes)
    }

    /// The shape of a member of a definition, from its value.
    pub(super) fn member_shape(&mut self, cx: &Context<'a>, definition: usize) -> Option<Shape> {
        let key = (definition, cx.scope);
        if let Some(known) = self.member_shapes.get(&key) {
            let known = known.clone();
            self.recurs |= self.shaping.contains(&definition);
            if self.shapes_open.contains(&definition) && self.definitions[definition].indices().next().is_none() {
                let value = self.definitions[definition].value;
                let circle = self.needs_itself(cx, definition, value.span);
                // Elements of a list may need those before them.
                if !matches!(value.kind, ExprKind::Tuple(_)) {
                    let _ = self.refuse(circle, value.span);
                    return None;
                }
            }
            return known;
        }
        // What needs itself is a number here; whoever elaborates it tells of the circle.
        self.member_shapes.insert(key, Some(Shape::NUMBER));
        self.shapes_open.push(definition);
        self.warm_shapes(cx, definition);
        let lexical = self.definitions[definition].scope;
        let mut inner = self.home(cx, lexical);
        for index in self.definitions[definition].indices() {
            let unknown = self.unknown_index();
            inner = inner.with(&index.text, Meaning::Index(unknown));
        }
        let value = self.definitions[definition].value;
        self.shaping.push(definition);
        let met_before = std::mem::take(&mut self.meets_unknown);
        let shape = self.shape(&inner, value).filter(|_| !self.meets_unknown);
        self.meets_unknown = met_before;
        self.shaping.pop();
        self.shapes_open.pop();
        self.member_shapes.insert(key, shape.clone());
        shape
    }
}
