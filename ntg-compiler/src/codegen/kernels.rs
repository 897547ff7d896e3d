//! `mod kernels`: every kernel's functions, and the calls that the contract's methods make.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::function::{self, Functions};
use super::names::{Scope, ident};
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
    let mut scope = Scope::with(&["math", "lanes", "Pack", "Simd", "Table"]);
    let (mut items, mut values, mut derivatives, mut probes) = (vec![], vec![], vec![], vec![]);
    for (i, (shape, body)) in program.structure.kernels.iter().zip(&program.kernels).enumerate() {
        let name = scope.take(&shape.name, |_| false);
        let number = Literal::usize_unsuffixed(i);
        let Functions { items: functions, derivatives: differentiated, probes: probed } =
            function::functions(&name, shape, body);
        let kernel = ident(&name);
        items.push(functions);
        let of_values = |out| quote! { lanes::values(simd, kernels::#kernel {}, point, tables, #out) };
        let (all, only) = (of_values(quote! { values }), of_values(quote! { out.values }));
        values.push(quote! { #number => #all, });
        derivatives.push(match differentiated {
            true => quote! { #number => lanes::derivatives(simd, kernels::#kernel {}, point, tables, out), },
            false => quote! { #number => #only, },
        });
        if probed {
            probes.push(quote! { #number => lanes::probes(kernels::#kernel {}, point, tables, probes), });
        }
    }
    let items = quote! {
        mod kernels {
            use ::ntg::runtime::lanes;
            use ::ntg::runtime::math::{self, Pack, Simd};
            use ::ntg::runtime::splines::Table;

            #(#items)*
        }
    };
    Kernels { items, values, derivatives, probes }
}
