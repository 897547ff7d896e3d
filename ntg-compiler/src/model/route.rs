//! Routes: outputs guessed along a polygon of points.
//!
//! Takes `(x, y) through (0, 0), (1, 5) [km];`, `r through start, gate;`, pushes guesses.
//! A vector stands for its elements, and in the list of points a matrix for its rows.
//! Finds: points with too many or too few coordinates, routes of one point.

use super::elaborator::Elaborator;
use super::guess::Guessed;
use super::problem::{Form, GuessKind};
use super::scope::{Context, Entity};
use super::shape::Shape;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::NodeId;
use crate::syntax::ast::{Expr, Path, Point, Route};

/// An output of a route: itself, or the elements of a vector.
struct Routed<'a> {
    elements: Vec<Guessed<'a>>,
    is_vector: bool,
}

impl<'a> Elaborator<'a> {
    pub(super) fn route(&mut self, cx: &Context<'a>, route: &'a Route) -> Option<()> {
        let mut outputs: Vec<Routed<'a>> = Vec::new();
        let mut sound = true;
        for path in &route.outputs {
            match self.route_output(cx, path) {
                Some(routed) => outputs.push(routed),
                None => sound = false,
            }
        }
        let first = outputs.first().filter(|_| sound)?.elements.first()?;
        let scope = self.guess_scope(&first.cx.clone())?;
        for other in outputs.iter().flat_map(|routed| &routed.elements) {
            if self.guess_scope(&other.cx.clone()).as_ref() != Some(&scope) {
                let finding =
                    Diagnostic::new(Code::NotGuessable, other.target.span, "a route is about one phase or agent");
                self.report(finding.help("write a route for each"));
                return None;
            }
        }
        let mut points = Vec::new();
        for point in &route.points {
            points.extend(self.route_points(point, &outputs)?);
        }
        if points.len() < 2 {
            let finding = Diagnostic::new(Code::WrongCount, route.span, "a route has two points at least");
            self.report(finding.help("write where it begins and where it ends"));
            return None;
        }
        let elements = outputs.into_iter().flat_map(|routed| routed.elements);
        let outputs = elements.map(|guessed| (guessed.name, guessed.index)).collect();
        self.push_guess(cx, scope, GuessKind::Route { outputs, points });
        Some(())
    }

    fn route_output(&mut self, cx: &Context<'a>, path: &'a Path) -> Option<Routed<'a>> {
        let (last, outer) = path.segments.split_last()?;
        let (inner, entity) = self.target(cx, outer, last)?;
        if entity != Entity::Output {
            let message = format!("`{}` is {}: a route leads through outputs", self.text(path.span), entity.describe());
            let finding = Diagnostic::new(Code::NotGuessable, path.span, message);
            self.report(finding.help("write it as a guess of its own: `name = value;`"));
            return None;
        }
        let axes = self.axes_of(&inner, entity, &last.name.text)?;
        let shape = self.indexed_shape(&inner, last, &axes, Shape::NUMBER)?;
        match shape.axes() {
            [] => {
                let only = self.guessed_output(&inner, last, &[], path.span)?;
                Some(Routed { elements: vec![only], is_vector: false })
            }
            [n] => {
                let elements = (1..=*n).map(|k| self.guessed_output(&inner, last, &[Form::number(k)], path.span));
                Some(Routed { elements: elements.collect::<Option<_>>()?, is_vector: true })
            }
            _ => {
                self.no_number(path.span, &shape);
                None
            }
        }
    }

    /// The points that an entry of the list stands for, each with a value for every element.
    fn route_points(&mut self, point: &'a Point, outputs: &[Routed<'a>]) -> Option<Vec<Vec<NodeId>>> {
        if let ([routed], [only]) = (outputs, point.coordinates.as_slice())
            && routed.is_vector
        {
            return self.rows_of(only, routed);
        }
        if let ([routed], coordinates) = (outputs, &point.coordinates)
            && routed.is_vector
            && routed.elements.len() == coordinates.len()
        {
            let pairs = coordinates.iter().zip(&routed.elements);
            let values = pairs.map(|(value, element)| self.coordinate(element, value, &[])).collect::<Option<_>>()?;
            return Some(vec![values]);
        }
        let wanted = match outputs {
            [routed] => routed.elements.len(),
            _ => outputs.len(),
        };
        if point.coordinates.len() != wanted || wanted != outputs.len() {
            let message = format!(
                "this point has {} coordinates, but the route is about {wanted} outputs",
                point.coordinates.len()
            );
            let finding = Diagnostic::new(Code::WrongCount, point.span, message);
            self.report(finding.help("write one coordinate for each output"));
            return None;
        }
        let mut values = Vec::new();
        for (value, routed) in point.coordinates.iter().zip(outputs) {
            if routed.is_vector {
                values.extend(self.rows_of(value, routed)?.into_iter().next()?);
            } else {
                values.push(self.coordinate(&routed.elements[0], value, &[])?);
            }
        }
        Some(vec![values])
    }

    /// The elements of a vector, or those of each row of a matrix.
    fn rows_of(&mut self, value: &'a Expr, routed: &Routed<'a>) -> Option<Vec<Vec<NodeId>>> {
        let elements = &routed.elements;
        let shape = self.shape(&elements.first()?.cx.clone(), value)?;
        let n = elements.len() as i64;
        let rows: Vec<Vec<Form>> = match shape.axes() {
            [] if shape == Shape::Any => vec![vec![]],
            [m] if *m == n => vec![vec![]],
            [rows, m] if *m == n => (1..=*rows).map(|row| vec![Form::number(row)]).collect(),
            _ => {
                let wanted = Shape::Of(vec![n]);
                let help = "a point has one coordinate for each element; a matrix stands for its rows";
                self.misfit_shapes((elements[0].target.span, &wanted), (value.span, &shape), help);
                return None;
            }
        };
        let mut points = Vec::new();
        for row in rows {
            let mut point = Vec::new();
            for (k, element) in (1..).zip(elements) {
                let mut at = row.clone();
                if !shape.is_number() {
                    at.push(Form::number(k));
                }
                point.push(self.coordinate(element, value, &at)?);
            }
            points.push(point);
        }
        Some(points)
    }

    fn coordinate(&mut self, element: &Guessed<'a>, value: &'a Expr, at: &[Form]) -> Option<NodeId> {
        self.guess_value(&element.cx, value, at, &element.target)
    }
}
