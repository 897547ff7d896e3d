//! The generated struct: parameters as fields, and the contract with the runtime.
//!
//! In the struct's module all names that are not the user's are written with their path, so that
//! a problem called `Vec` or `Problem` is as good as any other.

use proc_macro2::{Span, TokenStream};
use quote::quote;

use super::kernels::Kernels;
use super::names::ident_at;
use super::parameters::{self, doc_lines};
use super::solution;
use crate::program::Program;

/// The struct, its `Default`, its methods, and `impl Kernels`.
pub(super) fn problem(program: &Program, kernels: &Kernels, place_of: &dyn Fn(&str) -> Span) -> TokenStream {
    let structure = &program.structure;
    let fields = parameters::fields(structure, place_of);
    let declarations = fields.iter().map(|field| &field.declaration);
    let defaults = fields.iter().map(|field| &field.default);
    let items = fields.iter().map(|field| &field.items);

    let name = ident_at(&structure.name, place_of(&structure.name));
    let doc = doc_lines(&structure.doc, &format!("The problem `{}` of `{}`.", structure.name, structure.source));
    let contract = contract(program, kernels, &name);
    let solve = solution::solve(structure, &name);
    quote! {
        #(#[doc = #doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct #name {
            #(#declarations,)*
        }

        #(#items)*

        impl ::core::default::Default for #name {
            fn default() -> Self {
                Self { #(#defaults),* }
            }
        }

        #solve
        #contract
    }
}

/// `impl ::ntg::runtime::Problem for VanDerPol`.
fn contract(program: &Program, kernels: &Kernels, name: &proc_macro2::Ident) -> TokenStream {
    let fields = parameters::fields(&program.structure, &|_| Span::call_site());
    let hand_over: Vec<_> = fields.iter().map(|field| &field.hand_over).collect();
    let update = match hand_over.is_empty() {
        true => quote! { fn update(&self, _: &mut Structure) {} },
        false => quote! { fn update(&self, structure: &mut Structure) { #(#hand_over)* } },
    };
    let Kernels { values, derivatives, undifferentiated, probes, .. } = kernels;
    quote! {
        mod contract {
            use super::{kernels, structure};
            use ::ntg::runtime::lanes::{self, Kernels};
            use ::ntg::runtime::math::Simd;
            use ::ntg::runtime::problem::{Derivatives, Lanes};
            use ::ntg::runtime::splines::Table;
            use ::ntg::runtime::structure::{Structure, constant};

            impl Kernels for super::#name {
                fn structure(&self) -> &'static constant::Structure {
                    &structure::STRUCTURE
                }

                #update

                fn values<S: Simd>(&self, simd: S, kernel: usize, point: Lanes<'_>, tables: &[Table], values: &mut [f64]) {
                    match kernel {
                        #(#values)*
                        _ => self.undifferentiated(kernel, point, tables, values),
                    }
                }

                fn derivatives<S: Simd>(&self, simd: S, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>) {
                    match kernel {
                        #(#derivatives)*
                        _ => self.undifferentiated(kernel, point, tables, out.values),
                    }
                }

                fn undifferentiated(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], values: &mut [f64]) {
                    match kernel {
                        #(#undifferentiated)*
                        _ => values.fill(f64::NAN),
                    }
                }

                fn probes(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], probes: &mut [f64]) {
                    match kernel {
                        #(#probes)*
                        _ => probes.fill(f64::NAN),
                    }
                }
            }
        }
    }
}
