//! Parameters as public fields, in the units in which the spec declares them.
//!
//! Takes the structure's parameters and replaceable tables, gives for each a field with its
//! documentation, its default, and the statement that hands its present value to the runtime in
//! SI units.
//!
//! A default is written in its declared unit such that conversion gives back the compiler's SI
//! value to the last bit, wherever such a number exists: an untouched parameter is the same number
//! in every back end.

use ntg_structure::{Parameter, Structure, Table, Unit};
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::{format_ident, quote};

use super::data::float;
use super::names::{camel, capitalised, ident_at};

/// What one parameter contributes to the generated code.
pub(super) struct Field {
    /// `/// ...` `pub v_max: f64`
    pub(super) declaration: TokenStream,
    /// `v_max: 0.25`
    pub(super) default: TokenStream,
    /// `structure.set_parameter(0, &[self.v_max * 1000.0]);`
    pub(super) hand_over: TokenStream,
    /// The type of a table's field.
    pub(super) items: TokenStream,
}

/// All parameters, then all replaceable tables, in the spec's order.
pub(super) fn fields(structure: &Structure, place_of: &dyn Fn(&str) -> Span) -> Vec<Field> {
    let parameters = structure.parameters.iter().enumerate().map(|(i, parameter)| number(i, parameter, place_of));
    let tables = structure.tables.iter().enumerate().filter(|(_, table)| table.replaceable);
    parameters.chain(tables.map(|(i, one)| table(i, one, place_of))).collect()
}

/// A parameter that is a number or an array of numbers.
fn number(i: usize, parameter: &Parameter, place_of: &dyn Fn(&str) -> Span) -> Field {
    let Parameter { name, doc, unit, array, value, .. } = parameter;
    let ident = ident_at(name, place_of(name));
    let shown: Vec<f64> = value.iter().map(|si| in_unit(*si, unit)).collect();
    let literals: Vec<TokenStream> = shown.iter().map(|number| float(*number)).collect();
    let doc = doc_lines(doc, &format!("{}, default {}.", unit_in_words(unit), in_words(&shown, *array)));
    let i = Literal::usize_unsuffixed(i);
    let factor = (unit.factor != 1.0).then(|| float(unit.factor));

    let (kind, default, si) = if *array {
        let length = Literal::usize_unsuffixed(value.len());
        let all_equal = literals.len() > 3 && shown.iter().all(|number| number.to_bits() == shown[0].to_bits());
        let default = match literals.first() {
            Some(first) if all_equal => quote! { [#first; #length] },
            _ => quote! { [#(#literals),*] },
        };
        let si = match factor {
            Some(factor) => quote! { &self.#ident.map(|value| value * #factor) },
            None => quote! { &self.#ident },
        };
        (quote! { [f64; #length] }, default, si)
    } else {
        let default = literals.first().cloned().unwrap_or_else(|| quote! { 0.0 });
        let times = factor.map(|factor| quote! { * #factor });
        (quote! { f64 }, default, quote! { &[self.#ident #times] })
    };
    Field {
        declaration: quote! { #(#[doc = #doc])* pub #ident: #kind },
        default: quote! { #ident: #default },
        hand_over: quote! { structure.set_parameter(#i, #si); },
        items: TokenStream::new(),
    }
}

/// A table whose nodes and values a program may replace. Nodes are a tuple in the order of the
/// arguments (one array for one argument): fields named after axes could meet names of ours.
fn table(i: usize, table: &Table, place_of: &dyn Fn(&str) -> Span) -> Field {
    let ident = ident_at(&table.name, place_of(&table.name));
    let kind = format_ident!("{}Table", camel(&table.name));
    let sizes: Vec<usize> = table.axes.iter().map(|axis| axis.nodes.len()).collect();
    let lengths = || sizes.iter().map(|size| Literal::usize_unsuffixed(*size));
    let in_tuple = |each: Vec<TokenStream>| match each.as_slice() {
        [one] => one.clone(),
        all => quote! { (#(#all),*) },
    };
    let nodes = table.axes.iter().map(|axis| {
        let nodes = axis.nodes.iter().map(|si| float(in_unit(*si, &axis.unit)));
        quote! { [#(#nodes),*] }
    });
    let nodes = in_tuple(nodes.collect());
    let values: Vec<f64> = table.values.iter().map(|si| in_unit(*si, &table.unit)).collect();
    let values = nested(&values, &sizes);
    let nodes_type = in_tuple(lengths().map(|length| quote! { [f64; #length] }).collect());
    let values_type = lengths().rev().fold(quote! { f64 }, |inner, length| quote! { [#inner; #length] });

    let axes = table
        .axes
        .iter()
        .map(|axis| format!(" - `{}`: {}, {} nodes", axis.name, in_unit_words(&axis.unit), axis.nodes.len()));
    let axes: Vec<String> = axes.collect();
    let sentence = format!("{}; a table whose nodes and values may be replaced.", unit_in_words(&table.unit));
    let doc = doc_lines(&table.doc, &sentence);
    let title = format!(" Nodes and values of the table `{}`.", table.name);
    let values_doc = format!(" Values at the nodes, the last argument fastest; {}.", in_unit_words(&table.unit));
    Field {
        declaration: quote! { #(#[doc = #doc])* pub #ident: #kind },
        default: quote! { #ident: #kind { nodes: #nodes, values: #values } },
        hand_over: hand_over_table(i, table, &ident),
        items: quote! {
            #[doc = #title]
            #[derive(Clone, Debug, PartialEq)]
            pub struct #kind {
                /// Nodes of each argument, increasing, in the argument's unit:
                ///
                #(#[doc = #axes])*
                pub nodes: #nodes_type,
                #[doc = #values_doc]
                pub values: #values_type,
            }
        },
    }
}

/// The statements that hand a table's nodes and values to the runtime, in SI units.
fn hand_over_table(i: usize, table: &Table, ident: &Ident) -> TokenStream {
    let in_si = |unit: &Unit| (unit.factor != 1.0).then(|| float(unit.factor));
    let index = Literal::usize_unsuffixed(i);
    let nodes = table.axes.iter().enumerate().map(|(k, axis)| {
        let k = Literal::usize_unsuffixed(k);
        let place = if table.axes.len() > 1 {
            quote! { .#k }
        } else {
            quote! {}
        };
        let converted = in_si(&axis.unit).map(|factor| quote! { .map(|node| node * #factor) });
        quote! { structure.tables[#index].axes[#k].nodes = self.#ident.nodes #place #converted .to_vec(); }
    });
    let flatten = table.axes.iter().skip(1).map(|_| quote! { .as_flattened() });
    let values = match in_si(&table.unit) {
        Some(factor) => quote! { .iter().map(|value| value * #factor).collect() },
        None => quote! { .to_vec() },
    };
    quote! {
        #(#nodes)*
        structure.tables[#index].values = self.#ident.values #(#flatten)* #values;
    }
}

/// Numbers as nested arrays of the given sizes.
fn nested(values: &[f64], sizes: &[usize]) -> TokenStream {
    match sizes {
        [] => values.first().map_or_else(|| quote! { 0.0 }, |value| float(*value)),
        [_, inner @ ..] => {
            let row = inner.iter().product::<usize>().max(1);
            let rows = values.chunks(row).map(|row| nested(row, inner));
            quote! { [#(#rows),*] }
        }
    }
}

/// A number of SI units in the declared unit: of the numbers that convert back to it exactly, the
/// one that is shortest to write; the quotient where there is none.
pub fn in_unit(si: f64, unit: &Unit) -> f64 {
    /// How many neighbours of the quotient on each side are tried. Division and multiplication
    /// are each rounded by half a last digit, so further ones cannot convert back.
    const NEIGHBOURS: usize = 2;
    let quotient = si / unit.factor;
    let below = std::iter::successors(Some(quotient), |x| Some(x.next_down())).take(NEIGHBOURS + 1);
    let above = std::iter::successors(Some(quotient), |x| Some(x.next_up())).take(NEIGHBOURS + 1);
    let exact = below.chain(above.skip(1)).filter(|x| (x * unit.factor).to_bits() == si.to_bits());
    exact.min_by_key(|x| x.to_string().len()).unwrap_or(quotient)
}

/// The user's documentation as doc lines, then a paragraph of ours.
pub(super) fn doc_lines(doc: &str, ours: &str) -> Vec<String> {
    let mut lines: Vec<String> = doc.lines().map(|line| format!(" {line}")).collect();
    if !lines.is_empty() {
        lines.push(String::new());
    }
    lines.push(format!(" {ours}"));
    lines
}

/// `in km/s`, `a pure number`.
pub(super) fn in_unit_words(unit: &Unit) -> String {
    if unit.symbol.is_empty() || unit.symbol == "1" { "a pure number".into() } else { format!("in {}", unit.symbol) }
}

/// As [`in_unit_words`], as the beginning of a sentence.
pub(super) fn unit_in_words(unit: &Unit) -> String {
    capitalised(&in_unit_words(unit))
}

/// The default as documentation shows it, cut when it is long.
fn in_words(values: &[f64], array: bool) -> String {
    const SHOWN: usize = 8;
    let shortest = |x: &f64| [x.to_string(), format!("{x:e}")].into_iter().min_by_key(String::len).unwrap_or_default();
    let words: Vec<String> = values.iter().take(SHOWN).map(shortest).collect();
    match (array, values.len() > SHOWN) {
        (false, _) => words.join(""),
        (true, false) => format!("({})", words.join(", ")),
        (true, true) => format!("({}, ...)", words.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_default_converts_back_to_its_si_value_bit_for_bit() {
        let factors = [1.0, 1000.0, std::f64::consts::PI / 180.0, 0.3048, 1e-3, 1852.0 / 3600.0, 1e-9];
        for factor in factors {
            let unit = Unit { symbol: "u".into(), factor };
            for i in 1..2000 {
                for declared in [f64::from(i) * 0.01, -f64::from(i) / 7.0, f64::from(i) * 1e-12] {
                    let si = declared * factor;
                    let shown = in_unit(si, &unit);
                    assert_eq!((shown * factor).to_bits(), si.to_bits(), "{declared} * {factor}");
                    assert!(shown.to_string().len() <= declared.to_string().len(), "{shown} for {declared}");
                }
            }
        }
    }
}
