//! Which elements of states no equation of motion holds a derivative of.
//!
//! Takes the rows of `dynamics` blocks as they are pushed; gives the first element that rests.

use super::elaborator::Elaborator;
use super::problem::{Form, Leaf, Loop};
use super::shape::Ends;
use crate::source::Span;
use crate::syntax::ast::DeclaredName;

/// The largest number of elements that are looked at one by one.
const MOST: i64 = 10_000;

impl Elaborator<'_> {
    /// Notes the elements whose derivatives the rows from `first` on hold.
    pub(super) fn note_moved(&mut self, phase: usize, first: usize) {
        for row in &self.problem.constraints[first..] {
            for input in self.problem.dag.inputs_of(&[row.body]) {
                let Leaf::Flat { output, index, order: 1.., .. } = self.problem.leaves.leaf(input) else { continue };
                let places = index.as_ref().map_or(Some(vec![]), |form| values(form, &row.loops));
                match places {
                    Some(places) => {
                        self.noted.moved.extend(places.into_iter().map(|place| (phase, *output, Some(place))));
                    }
                    // Any of them.
                    None => _ = self.noted.moved.insert((phase, *output, None)),
                }
            }
        }
    }

    /// The first element of an array of states of which no equation holds a derivative, and where it is declared.
    pub(super) fn resting_element(&self, phase: usize, states: &[&DeclaredName]) -> Option<(String, Span)> {
        for name in states {
            let outputs = &self.problem.phases[phase].outputs;
            let output = outputs.iter().position(|output| output.name == name.name.text)?;
            let axes: &[Ends] = &self.output_axes[phase][output];
            let extents: Vec<i64> = axes.iter().map(Ends::extent).collect::<Option<_>>()?;
            let count = extents.iter().try_fold(1_i64, |product, extent| product.checked_mul(*extent))?;
            if axes.is_empty() || count > MOST || self.noted.moved.contains(&(phase, output, None)) {
                continue;
            }
            // The only axis counts as it is declared, several count from 1.
            let first = if let [only] = axes { only.numbers()?.0 } else { 1 };
            let rests = |k: &i64| !self.noted.moved.contains(&(phase, output, Some(first + k)));
            if let Some(k) = (0..count).find(rests) {
                let mut left = k;
                let mut indices: Vec<String> = vec![];
                for (ends, extent) in axes.iter().zip(&extents).rev() {
                    indices.insert(0, (ends.numbers()?.0 + left % extent).to_string());
                    left /= extent;
                }
                return Some((format!("{}[{}]", name.name.text, indices.join(", ")), name.name.span));
            }
        }
        None
    }
}

/// The values that a form takes where its loops run; none where these are not known, or too many.
fn values(form: &Form, loops: &[Loop]) -> Option<Vec<i64>> {
    let mut all = vec![form.constant];
    for (index, factor) in &form.terms {
        let over = loops.iter().find(|over| over.index == *index)?;
        let (first, last) = (over.first.as_number()?, over.last.as_number()?);
        if (last - first + 1).max(0) * all.len() as i64 > MOST {
            return None;
        }
        all = all.iter().flat_map(|start| (first..=last).map(move |k| start + factor * k)).collect();
    }
    Some(all)
}
