//! Derivatives of all kernels of a node, weights going down from the rows at the top.
//!
//! A member of a reduction is weighted by the derivative of the weighted rows above it by its own
//! value (docs/maths.md, equation 4.8), so that every kernel's weighted Hessian is already that of
//! the element's weighted rows.

use super::node::{Edge, EdgeWork, Node, NodeWork};
use super::reduce;
use crate::problem::{Derivatives, Lanes, Problem};
use ntg_splines::Table;
use ntg_structure::Kernel;

impl Node {
    /// Computes values, first and weighted second derivatives of this kernel and all below it.
    /// Before: `inputs` has run and `work.weights` is set.
    pub(crate) fn derivatives(&self, problem: &dyn Problem, kernels: &[Kernel], tables: &[Table], work: &mut NodeWork) {
        let lanes = self.lanes();
        if lanes == 0 {
            return;
        }
        let point = Lanes { lanes, inputs: &work.inputs, weights: &work.weights };
        let out = Derivatives { values: &mut work.values, jacobian: &mut work.jacobian, hessian: &mut work.hessian };
        problem.derivatives(self.kernel, point, tables, out);
        let NodeWork { jacobian, weights, edges, .. } = work;
        for (q, (edge, below)) in self.edges.iter().zip(edges).enumerate() {
            below.outer.fill(0.0);
            let input = self.slots + q;
            let entries = kernels[self.kernel].jacobian.iter().enumerate().filter(|(_, (_, k))| *k == input);
            for (entry, (row, _)) in entries {
                let (w, j) = (&weights[row * lanes..][..lanes], &jacobian[entry * lanes..][..lanes]);
                below.outer.iter_mut().zip(w).zip(j).for_each(|((outer, w), j)| *outer += w * j);
            }
            edge.derivatives(problem, kernels, tables, self.elements, below);
        }
    }
}

impl Edge {
    fn derivatives(
        &self,
        problem: &dyn Problem,
        kernels: &[Kernel],
        tables: &[Table],
        elements: usize,
        work: &mut EdgeWork,
    ) {
        reduce::factors(self, elements, &work.child.values, &mut work.factor);
        for copy in 0..self.first.len() - 1 {
            let outer = &work.outer[copy * elements..][..elements];
            for member in self.first[copy]..self.first[copy + 1] {
                let factor = &work.factor[member * elements..][..elements];
                let weight = &mut work.child.weights[member * elements..][..elements];
                weight.iter_mut().zip(outer).zip(factor).for_each(|((w, outer), factor)| *w = outer * factor);
            }
        }
        self.child.derivatives(problem, kernels, tables, &mut work.child);
    }
}
