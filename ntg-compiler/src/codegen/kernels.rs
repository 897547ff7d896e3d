//! `mod kernels`: every kernel's functions, and the calls that the contract's methods make.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::function::{self, Functions};
use super::names::{Scope, ident};
use crate::program::Program;

/// The module, and the arms of `match kernel` in the methods of the contract.
pub(super) struct Kernels {
    /// `mod kernels { .. }`.
    pub(super) items: TokenStream,
    /// Arms of `values`: kernels with derivatives.
    pub(super) values: Vec<TokenStream>,
    /// Arms of `derivatives`.
    pub(super) derivatives: Vec<TokenStream>,
    /// Arms of `undifferentiated`: all others.
    pub(super) undifferentiated: Vec<TokenStream>,
    /// Arms of `probes`.
    pub(super) probes: Vec<TokenStream>,
}

/// Writes all kernels of a program.
pub(super) fn kernels(program: &Program) -> Kernels {
    let mut scope = Scope::with(&["math", "lanes", "Pack", "Simd", "Table"]);
    let (mut items, mut probes) = (vec![], vec![]);
    let (mut values, mut derivatives, mut undifferentiated) = (vec![], vec![], vec![]);
    for (i, (shape, body)) in program.structure.kernels.iter().zip(&program.kernels).enumerate() {
        let name = scope.take(&shape.name, |_| false);
        let number = Literal::usize_unsuffixed(i);
        let Functions { items: functions, derivatives: differentiated, probes: probed } =
            function::functions(&name, shape, body);
        let kernel = ident(&name);
        items.push(functions);
        if differentiated {
            values.push(quote! { #number => lanes::values(simd, kernels::#kernel {}, point, tables, values), });
            derivatives.push(quote! { #number => lanes::derivatives(simd, kernels::#kernel {}, point, tables, out), });
        } else {
            undifferentiated
                .push(quote! { #number => lanes::undifferentiated(kernels::#kernel {}, point, tables, values), });
        }
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
    Kernels { items, values, derivatives, undifferentiated, probes }
}
