//! Plain data as the Rust expression of the constant that holds it.
//!
//! Takes the types of `ntg_structure`, gives tokens: `ToRust::to_rust`. Structs and enums are
//! listed once, by name and fields, in the macros below; the tokens are made by `quote!` alone.
//! Fields of a struct with a `Default` are left out where they hold it, so that what is written is
//! what the spec said.
//!
//! What is long because of a number (`intervals = 500`) is written as a rule: the size of the
//! text grows with what the spec says, not with breakpoints or members.
//!
//! Afterwards: the expression, with the types of `ntg_structure::constant` in scope, may stand in a `static`, and the
//! data that are made of it are equal to those given, bit for bit.

use ntg_structure::{
    Affine, Agent, Angle, Arguments, At, Block, Bounds, Call, Constraint, Continuation, Data, Degree, Domain, Duration,
    Family, Grid, Group, Guess, GuessKind, GuessScope, Helper, Independent, Instant, Integral, Kernel, Loop,
    Measurement, Named, Output, Parameter, Part, Phase, PhaseRef, Place, Places, Points, ReduceOp, Reduction,
    Relaxation, Row, Shared, Slot, Spline, Start, Table, TableAxis, TableExtrapolation, TableMethod, TableSymmetry,
    Term, Unit, Variable,
};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// From this many equal or equally spaced numbers on, a list is written as a rule.
const LONG: usize = 4;

/// Data that can be written as a Rust expression.
pub(super) trait ToRust: PartialEq {
    /// The expression.
    fn to_rust(&self) -> TokenStream;

    /// Whether both are the same to the last bit.
    fn same(&self, other: &Self) -> bool {
        self == other
    }
}

/// Structs whose fields are all written.
macro_rules! structs {
    ($($name:ident { $($field:ident),* })*) => {$(
        impl ToRust for $name {
            fn to_rust(&self) -> TokenStream {
                let Self { $($field),* } = self;
                $(let $field = $field.to_rust();)*
                quote! { $name { $($field: #$field),* } }
            }
        }
    )*};
}

/// Structs with a `Default`, of which the fields before the `;` and those that differ are written.
macro_rules! structs_with_default {
    ($($name:ident { $($always:ident)? ; $($field:ident),* })*) => {$(
        impl ToRust for $name {
            fn to_rust(&self) -> TokenStream {
                let default = Self::default();
                let Self { $($always,)? $($field),* } = self;
                let mut written: Vec<TokenStream> = vec![];
                let mut left_out = false;
                $(
                    let value = $always.to_rust();
                    written.push(quote! { $always: #value });
                )?
                $(if $field.same(&default.$field) {
                    left_out = true;
                } else {
                    let value = $field.to_rust();
                    written.push(quote! { $field: #value });
                })*
                match (written.is_empty(), left_out) {
                    (true, _) => quote! { $name::DEFAULT },
                    (false, true) => quote! { $name { #(#written,)* ..$name::DEFAULT } },
                    (false, false) => quote! { $name { #(#written),* } },
                }
            }
        }
    )*};
}

/// Enums with unit, tuple and struct variants, each kind in a list of its own.
macro_rules! enums {
    ($($name:ident {
        $($unit:ident)*;
        $($tuple:ident($value:ident))*;
        $($braced:ident { $($field:ident),* })*
    })*) => {$(
        impl ToRust for $name {
            fn to_rust(&self) -> TokenStream {
                match self {
                    $(Self::$unit => quote! { $name::$unit },)*
                    $(Self::$tuple($value) => {
                        let $value = $value.to_rust();
                        quote! { $name::$tuple(#$value) }
                    })*
                    $(Self::$braced { $($field),* } => {
                        $(let $field = $field.to_rust();)*
                        quote! { $name::$braced { $($field: #$field),* } }
                    })*
                }
            }
        }
    )*};
}

structs! {
    Arguments { group, shown, call, axes }
    Agent { name, family, start, duration_name, place }
    Constraint { name, place, block, unit, sides }
    Continuation { parameter, steps }
    Grid { row, column, columns }
    Group { loops, domain, call, rows, bounds }
    Guess { loops, scope, kind }
    Integral { loops, place }
    Loop { first, last }
    Measurement { term, unit, loops, residual, sigma }
    Angle { phase, output, radian, turn, moves }
    Named { name, doc, unit, family, agent, loops, domain, call }
    Output { name, doc, unit, family, vector, spline }
    Parameter { name, doc, unit, array, grid, value }
    Phase { name, agent, family, after, duration, duration_name, outputs, points, place }
    Places { first, instants }
    Reduction { op, over, body }
    Helper { sides, bounds, at_zero }
    Relaxation { equation, other, helpers, corners, exact_first, is_exact }
    Shared { phase, output, until }
    Table { name, doc, axes, unit, values, method, extrapolation, replaceable }
    TableAxis { name, unit, nodes, symmetry }
    Term { name, place, unit }
    Variable { name, doc, unit, family, bounds, place }
}

impl ToRust for Family {
    fn to_rust(&self) -> TokenStream {
        let Self { first, last, grid } = self;
        let (first, last) = (first.to_rust(), last.to_rust());
        match grid {
            Some(_) => {
                let grid = grid.to_rust();
                quote! { Family { first: #first, last: #last, grid: #grid } }
            }
            None => quote! { Family::of(#first, #last) },
        }
    }
}

structs_with_default! {
    Bounds {; call, lower, upper }
    Call { kernel; slots, reductions, data }
    Kernel {; name, slots, data, rows, jacobian, hessian, degree, probes }
    PhaseRef {; phase, agent, index }
    Place {; line, column, text }
    Unit {; symbol, factor }
    Independent {; name, unit }
}

impl ToRust for Instant {
    fn to_rust(&self) -> TokenStream {
        match *self {
            Self::START => quote! { Instant::START },
            Self::END => quote! { Instant::END },
            _ => {
                let tau = self.tau().to_rust();
                quote! { Instant::new(#tau) }
            }
        }
    }
}

impl ToRust for Part {
    fn to_rust(&self) -> TokenStream {
        if self.is_whole() {
            return quote! { Part::WHOLE };
        }
        let Self { from, to, with_first, with_last } = self;
        let (from, to) = (from.to_rust(), to.to_rust());
        quote! { Part { from: #from, to: #to, with_first: #with_first, with_last: #with_last } }
    }
}

enums! {
    At { Here Start End; Inside(instant); Among { places, index } }
    Block { Initial Trajectory Final Temporal Continuity Corner;; }
    Data { Tau TauWithin; Index(index) Duration(phase) Start(phase); Parameter { parameter, index } }
    Degree { Constant Linear Quadratic Nonlinear;; }
    Domain { Mission; Start(phase) End(phase); Path { phase, points, part } }
    Duration {; Fixed(call) Free(bounds); }
    GuessKind {; ;
        Output { output, index, value }
        Route { outputs, points, values }
        Duration { value }
        Variable { variable, index, value }
        Start { value }
    }
    GuessScope {; Phase(phase); Agent { agent, index } }
    Points { Breakpoints LeftLimits; ; Gauss { points } Uniform { points } Times { times } }
    ReduceOp { Sum Product Min Max;; }
    Row {; ;
        Cost { term }
        Constraint { constraint, lower, upper }
        Part { constraint, index }
        Integral { integral, index }
    }
    Slot {;
        Duration(phase) Start(phase);
        Flat { phase, at, output, index, derivative }
        Variable { variable, index }
        Integral { integral, index }
    }
    Start {; Fixed(call) Free(bounds); }
    TableExtrapolation { Clamp Linear;; }
    TableMethod { Monotone Linear; ; Bspline { order } Fit { order, intervals } }
    TableSymmetry { Plain Even Periodic;; }
}

impl ToRust for Affine {
    fn to_rust(&self) -> TokenStream {
        match (self.constant, self.terms.as_slice()) {
            (constant, []) => {
                let constant = constant.to_rust();
                quote! { Affine::constant(#constant) }
            }
            (constant, _) => {
                let (constant, terms) = (constant.to_rust(), self.terms.to_rust());
                quote! { Affine { constant: #constant, terms: #terms } }
            }
        }
    }
}

impl ToRust for Spline {
    fn to_rust(&self) -> TokenStream {
        let (order, smoothness) = (self.order.to_rust(), self.smoothness.to_rust());
        let breakpoints = match self.breakpoints.len().saturating_sub(1) {
            intervals if intervals >= LONG && equally_spaced(&self.breakpoints) => {
                let intervals = intervals.to_rust();
                quote! { Breakpoints::Equal(#intervals) }
            }
            _ => {
                let breakpoints = self.breakpoints.to_rust();
                quote! { Breakpoints::At(#breakpoints) }
            }
        };
        quote! { Spline { order: #order, smoothness: #smoothness, breakpoints: #breakpoints } }
    }
}

/// Whether the breakpoints are the quotients `i / n` themselves, bit for bit.
fn equally_spaced(breakpoints: &[f64]) -> bool {
    let intervals = (breakpoints.len() - 1) as f64;
    breakpoints.iter().enumerate().all(|(i, b)| b.to_bits() == (i as f64 / intervals).to_bits())
}

/// A number as a literal that is read back bit for bit; infinities and NaN, which have no
/// literal, as the constants that name them.
pub(super) fn float(value: f64) -> TokenStream {
    if value.is_nan() {
        quote! { f64::NAN }
    } else if value == f64::INFINITY {
        quote! { f64::INFINITY }
    } else if value == f64::NEG_INFINITY {
        quote! { f64::NEG_INFINITY }
    } else if value.is_sign_negative() {
        let size = positive(-value);
        quote! { -#size }
    } else {
        let size = positive(value);
        quote! { #size }
    }
}

/// A finite number without a sign, in the shorter of the two usual forms (`0.25`, `1e-20`).
/// Rust prints the shortest digits that are read back as the same number.
fn positive(value: f64) -> Literal {
    let (plain, scientific) = (format!("{value:?}"), format!("{value:e}"));
    let text = if plain.len() <= scientific.len() + 4 { plain } else { scientific };
    text.parse().unwrap_or_else(|_| Literal::f64_unsuffixed(value))
}

impl ToRust for f64 {
    fn to_rust(&self) -> TokenStream {
        float(*self)
    }

    fn same(&self, other: &Self) -> bool {
        self.to_bits() == other.to_bits()
    }
}

impl ToRust for bool {
    fn to_rust(&self) -> TokenStream {
        quote! { #self }
    }
}

impl ToRust for u32 {
    fn to_rust(&self) -> TokenStream {
        let number = Literal::u32_unsuffixed(*self);
        quote! { #number }
    }
}

impl ToRust for usize {
    fn to_rust(&self) -> TokenStream {
        let number = Literal::usize_unsuffixed(*self);
        quote! { #number }
    }
}

impl ToRust for i64 {
    fn to_rust(&self) -> TokenStream {
        let sign = (*self < 0).then(|| quote! { - });
        let size = Literal::u64_unsuffixed(self.unsigned_abs());
        quote! { #sign #size }
    }
}

impl ToRust for String {
    fn to_rust(&self) -> TokenStream {
        quote! { #self }
    }
}

impl<T: ToRust> ToRust for Option<T> {
    fn to_rust(&self) -> TokenStream {
        match self {
            None => quote! { None },
            Some(value) => {
                let value = value.to_rust();
                quote! { Some(#value) }
            }
        }
    }
}

impl<T: ToRust> ToRust for Vec<T> {
    fn to_rust(&self) -> TokenStream {
        match self.as_slice() {
            [first, rest @ ..] if self.len() >= LONG && rest.iter().all(|value| value.same(first)) => {
                let (first, length) = (first.to_rust(), self.len().to_rust());
                quote! { &[#first; #length] }
            }
            all => {
                let all = all.iter().map(ToRust::to_rust);
                quote! { &[#(#all),*] }
            }
        }
    }
}

impl<A: ToRust, B: ToRust> ToRust for (A, B) {
    fn to_rust(&self) -> TokenStream {
        let (a, b) = (self.0.to_rust(), self.1.to_rust());
        quote! { (#a, #b) }
    }
}
