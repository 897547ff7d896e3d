//! What a constraint without a name is called where its elements or members are made one by one: `r[1] == 0` of
//! `r == (0, 0)`.
//!
//! Takes the text of the spec; a vector in it becomes the text of its element. Afterwards: no two rows that a person
//! reads about have the same words.

use super::elaborator::Elaborator;
use super::scope::Context;
use super::shape::Ends;
use crate::source::{SNIPPET_WIDTH, Span};
use crate::syntax::ast::{self, Expr, ExprKind};

/// `[2]`, `[2, 1]`: the members that are made by themselves.
pub(super) fn member_text(members: &[i64]) -> String {
    if members.is_empty() { String::new() } else { format!("[{}]", listed(members)) }
}

fn listed(members: &[i64]) -> String {
    members.iter().map(i64::to_string).collect::<Vec<_>>().join(", ")
}

impl<'a> Elaborator<'a> {
    /// The text of an element of a relation, and of the member of the loops around it, that are made by themselves; none
    /// where the text of the spec serves all of them.
    pub(super) fn element_words(&mut self, cx: &Context<'a>, constraint: &'a ast::Constraint) -> Option<String> {
        if cx.members.is_empty() {
            return None;
        }
        let (members, elements) = cx.members.split_at(cx.members.len().saturating_sub(self.element_axes));
        let sides: Vec<(Span, String)> = constraint
            .relation
            .sides()
            .into_iter()
            .filter_map(|side| Some((side.span, self.element_side(cx, side, elements)?)))
            .collect();
        Some(self.with_parts(relation_span(constraint), sides, members))
    }

    /// The same of the bounds of a declared array: `r[1] in 0 .. 3`, `r[..] in -1 .. 1` where one formula serves all
    /// elements.
    pub(super) fn bounds_words(
        &mut self,
        cx: &Context<'a>,
        name: &'a ast::DeclaredName,
        axes: &[Ends],
    ) -> Option<String> {
        let bounds = name.bounds.as_ref().filter(|_| name.shape.is_some())?;
        let elements = cx.members.as_slice();
        let ends = bounds.lower.iter().chain(&bounds.upper);
        let ends: Vec<(Span, String)> =
            ends.filter_map(|end| Some((end.span, self.element_side(cx, end, elements)?))).collect();
        let text = self.with_parts(bounds.span, ends, &[]);
        let counts_from_one = axes.iter().all(|ends| ends.first.as_number() == Some(1));
        let own = match (elements.len() == axes.len(), counts_from_one, axes.len()) {
            (true, true, _) => member_text(elements),
            (_, true, 1) if elements.is_empty() => "[..]".to_owned(),
            (_, true, 2) if elements.is_empty() => "[.., ..]".to_owned(),
            _ => String::new(),
        };
        Some(format!("{}{own} in {text}", name.name.text))
    }

    /// The text of a span with other texts in the place of some of its parts.
    fn with_parts(&self, span: Span, mut parts: Vec<(Span, String)>, members: &[i64]) -> String {
        parts.sort_by_key(|(part, _)| part.start);
        let (mut text, mut from) = (String::new(), span.start);
        for (part, words) in parts {
            text += self.source.slice(Span { start: from, end: part.start });
            text += &words;
            from = part.end;
        }
        text += self.source.slice(Span { start: from, end: span.end });
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let text = if text.chars().count() > SNIPPET_WIDTH { self.text(span) } else { text };
        match members {
            [] => text,
            [one] => format!("{text}, member {one}"),
            several => format!("{text}, member ({})", listed(several)),
        }
    }

    /// The text of an element of a side; none where it is a number.
    fn element_side(&mut self, cx: &Context<'a>, side: &'a Expr, at: &[i64]) -> Option<String> {
        if at.is_empty() || self.shape(cx, side).is_none_or(|shape| shape.is_number()) {
            return None;
        }
        Some(self.element_text(side, at))
    }

    fn element_text(&self, side: &Expr, at: &[i64]) -> String {
        let text = self.text(side.span);
        let Some((first, rest)) = at.split_first() else { return text };
        match &side.kind {
            ExprKind::Tuple(elements) => {
                let element = usize::try_from(first - 1).ok().and_then(|k| elements.get(k));
                // A unit behind the list is that of its bare numbers.
                let unit = text.rfind(')').map_or("", |end| &text[end + 1..]);
                element.map_or(text.clone(), |element| self.element_text(element, rest) + unit)
            }
            ExprKind::Path(_) => match text.strip_suffix(']') {
                Some(open) => format!("{open}, {}]", listed(at)),
                None => text + &member_text(at),
            },
            ExprKind::Der { of, order: None } => format!("der({})", self.element_text(of, at)),
            ExprKind::Neg(of) => format!("-{}", self.element_text(of, at)),
            ExprKind::Call(_) => text + &member_text(at),
            _ => format!("({text}){}", member_text(at)),
        }
    }
}

/// A constraint without its name, documentation and softness.
fn relation_span(constraint: &ast::Constraint) -> Span {
    let sides = constraint.relation.sides();
    let ends = sides.iter().map(|side| side.span);
    let bounds = match &constraint.relation {
        ast::Relation::In { bounds, .. } => Some(bounds.span),
        _ => None,
    };
    let whole = ends.chain(bounds).reduce(Span::to);
    whole.unwrap_or(constraint.span)
}
