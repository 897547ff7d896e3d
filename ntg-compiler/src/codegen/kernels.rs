//! `mod kernels`: every kernel's functions, and the calls that the contract's methods make.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::function::{self, Functions};
use super::names::Scope;
use crate::program::Program;

/// The module, and the arms of `match kernel` in the three methods of the contract.
pub(super) struct Kernels {
    /// `mod kernels { .. }`.
    pub(super) items: TokenStream,
    /// Arms of `values`.
    pub(super) values: Vec<TokenStream>,
    /// Arms of `derivatives`.
    pub(super) derivatives: Vec<TokenStream>,
    /// Arms of `probes`.
    pub(super) probes: Vec<TokenStream>,
}

/// Writes all kernels of a program.
pub(super) fn kernels(program: &Program) -> Kernels {
    let mut scope = Scope::with(&["math"]);
    let (mut items, mut values, mut derivatives, mut probes) = (vec![], vec![], vec![], vec![]);
    for (i, (shape, body)) in program.structure.kernels.iter().zip(&program.kernels).enumerate() {
        let name = scope.take(&shape.name, |_| false);
        let number = Literal::usize_unsuffixed(i);
        let Functions { items: functions, values: of_values, derivatives: of_derivatives, probes: of_probes } =
            function::functions(&name, shape, body);
        items.push(functions);
        values.push(quote! { #number => lanes::values(simd, point, values, #of_values), });
        derivatives.push(match of_derivatives {
            Some(call) => quote! { #number => lanes::derivatives(simd, point, out, #call), },
            None => quote! { #number => lanes::values(simd, point, out.values, #of_values), },
        });
        probes.extend(of_probes.map(|call| quote! { #number => lanes::values(simd, point, probes, #call), }));
    }
    let items = quote! {
        mod kernels {
            use ::ntg::runtime::math::{self, Pack, Simd};
            use ::ntg::runtime::splines::Table;

            #(#items)*
        }
    };
    Kernels { items, values, derivatives, probes }
}
