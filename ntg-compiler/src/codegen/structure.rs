//! `mod structure`: the problem without its formulas, as the spec states it.
//!
//! One constant for each list of the `Structure`, so that a reader finds a phase or a group by
//! name, and no expression is deeper than one of its entries. Constants, because code that builds
//! the lists takes rustc longer than all formulas do.

use ntg_structure::{Independent, Structure};
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::data::ToRust;

/// The module with its `STRUCTURE`.
pub(super) fn structure(structure: &Structure) -> TokenStream {
    let mut statics = vec![];
    let mut fields = vec![];
    let mut left_out = false;
    let lists = [
        ("parameters", quote! { Parameter }, entries(&structure.parameters)),
        ("tables", quote! { Table }, entries(&structure.tables)),
        ("shared", quote! { Shared }, entries(&structure.shared)),
        ("variables", quote! { Variable }, entries(&structure.variables)),
        ("agents", quote! { Agent }, entries(&structure.agents)),
        ("phases", quote! { Phase }, entries(&structure.phases)),
        ("places", quote! { Places }, entries(&structure.places)),
        ("kernels", quote! { Kernel }, entries(&structure.kernels)),
        ("groups", quote! { Group }, entries(&structure.groups)),
        ("shown", quote! { Group }, entries(&structure.shown)),
        ("arguments", quote! { Arguments }, entries(&structure.arguments)),
        ("corners", quote! { Place }, entries(&structure.corners)),
        ("relaxations", quote! { Relaxation }, entries(&structure.relaxations)),
        ("terms", quote! { Term }, entries(&structure.terms)),
        ("measurements", quote! { Measurement }, entries(&structure.measurements)),
        ("constraints", quote! { Constraint }, entries(&structure.constraints)),
        ("norms", quote! { usize }, entries(&structure.norms)),
        ("angles", quote! { Angle }, entries(&structure.angles)),
        ("integrals", quote! { Integral }, entries(&structure.integrals)),
        ("named", quote! { Named }, entries(&structure.named)),
        ("guesses", quote! { Guess }, entries(&structure.guesses)),
        ("continuations", quote! { Continuation }, entries(&structure.continuations)),
    ];
    for (name, kind, entries) in lists {
        if entries.is_empty() {
            left_out = true;
            continue;
        }
        let (field, list) = (format_ident!("{name}"), format_ident!("{}", name.to_uppercase()));
        fields.push(quote! { #field: #list });
        statics.push(quote! {
            static #list: List<#kind> = &[#(#entries),*];
        });
    }

    let Structure { name, doc, source, maximize, objective_unit, .. } = structure;
    let [name, doc, source] = [name, doc, source].map(ToRust::to_rust);
    let (maximize, objective_unit) = (maximize.to_rust(), objective_unit.to_rust());
    let independent = (structure.independent != Independent::default()).then(|| {
        let independent = structure.independent.to_rust();
        quote! { independent: #independent, }
    });
    let rest = (left_out || independent.is_none()).then(|| quote! { ..Structure::DEFAULT });
    quote! {
        mod structure {
            use ::ntg::runtime::structure::constant::*;

            pub(super) static STRUCTURE: Structure = Structure {
                name: #name,
                doc: #doc,
                source: #source,
                maximize: #maximize,
                objective_unit: #objective_unit,
                #independent
                #(#fields,)*
                #rest
            };

            #(#statics)*
        }
    }
}

fn entries<T: ToRust>(list: &[T]) -> Vec<TokenStream> {
    list.iter().map(ToRust::to_rust).collect()
}
