//! The data of a problem as constants: what generated code holds, and what a [`Structure`](crate::Structure) is made of
//! at run time.
//!
//! A `static` holds no `Vec` and no `String`, and code that builds hundreds of them, each with what is to be dropped
//! should the next one fail, is long to compile.
//! Each type here is that of the same name in this crate with `&'static [T]` for `Vec<T>` and `&'static str` for
//! `String`; [`Constant::owned`] is compiled once, here, for all programs.
//!
//! Types that own nothing are the same in both forms and are named here again, so that one `use` brings all.

pub use crate::{Angle, At, Block, Degree, Family, Grid, Instant, Part, ReduceOp, TableExtrapolation, TableSymmetry};

/// Text.
pub type Text = &'static str;
/// Any number of things.
pub type List<T> = &'static [T];

/// Data that may stand in a `static`.
pub trait Constant {
    /// The same data, which a program may change.
    type Owned;

    /// Copies them.
    fn owned(&self) -> Self::Owned;
}

impl Constant for Text {
    type Owned = String;
    fn owned(&self) -> String {
        (*self).to_owned()
    }
}

impl<T: Constant> Constant for List<T> {
    type Owned = Vec<T::Owned>;
    fn owned(&self) -> Vec<T::Owned> {
        self.iter().map(T::owned).collect()
    }
}

impl<T: Constant> Constant for Option<T> {
    type Owned = Option<T::Owned>;
    fn owned(&self) -> Option<T::Owned> {
        self.as_ref().map(T::owned)
    }
}

impl<A: Constant, B: Constant> Constant for (A, B) {
    type Owned = (A::Owned, B::Owned);
    fn owned(&self) -> Self::Owned {
        (self.0.owned(), self.1.owned())
    }
}

/// Types that own nothing.
macro_rules! same {
    ($($name:ident)*) => {$(
        impl Constant for $name {
            type Owned = Self;
            fn owned(&self) -> Self {
                *self
            }
        }
    )*};
}

same! { bool u32 usize i64 f64 Angle At Block Degree Family Grid Instant Part ReduceOp TableExtrapolation TableSymmetry }

/// Structs by their fields. Where every field has a value behind `=`, they are the constant `DEFAULT`.
macro_rules! structs {
    ($($name:ident { $($field:ident: $kind:ty $(= $default:expr)?),* })*) => {$(
        #[doc = concat!("[`", stringify!($name), "`](crate::", stringify!($name), ") as a constant.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $name {
            $(
                #[doc = concat!("[`", stringify!($name), "::", stringify!($field), "`](crate::", stringify!($name), "::", stringify!($field), ").")]
                pub $field: $kind
            ),*
        }

        impl Constant for $name {
            type Owned = crate::$name;
            fn owned(&self) -> crate::$name {
                crate::$name { $($field: self.$field.owned()),* }
            }
        }

        structs! { @default $name { $($field $(= $default)?),* } }
    )*};
    (@default $name:ident { $($field:ident = $default:expr),* }) => {
        impl $name {
            /// What [`Default::default`] is of the type with the same name.
            pub const DEFAULT: Self = Self { $($field: $default),* };
        }
    };
    (@default $name:ident { $($field:ident),* }) => {};
}

/// Enums with unit, tuple and struct variants, each kind in a list of its own.
macro_rules! enums {
    ($($name:ident {
        $($unit:ident)*;
        $($tuple:ident($value:ty))*;
        $($braced:ident { $($field:ident: $kind:ty),* })*
    })*) => {$(
        #[doc = concat!("[`", stringify!($name), "`](crate::", stringify!($name), ") as a constant.")]
        #[derive(Clone, Copy, Debug)]
        pub enum $name {
            $(
                #[doc = concat!("[`", stringify!($name), "::", stringify!($unit), "`](crate::", stringify!($name), "::", stringify!($unit), ").")]
                $unit,
            )*
            $(
                #[doc = concat!("[`", stringify!($name), "::", stringify!($tuple), "`](crate::", stringify!($name), "::", stringify!($tuple), ").")]
                $tuple($value),
            )*
            $(
                #[doc = concat!("[`", stringify!($name), "::", stringify!($braced), "`](crate::", stringify!($name), "::", stringify!($braced), ").")]
                $braced {
                    $(
                        #[doc = concat!("The field `", stringify!($field), "` there.")]
                        $field: $kind,
                    )*
                },
            )*
        }

        impl Constant for $name {
            type Owned = crate::$name;
            fn owned(&self) -> crate::$name {
                match self {
                    $(Self::$unit => crate::$name::$unit,)*
                    $(Self::$tuple(value) => crate::$name::$tuple(value.owned()),)*
                    $(Self::$braced { $($field),* } => crate::$name::$braced { $($field: $field.owned()),* },)*
                }
            }
        }
    )*};
}

structs! {
    Affine { constant: i64, terms: List<(usize, i64)> }
    Agent { name: Option<Text>, family: Option<Family>, start: Start, duration_name: Option<Text>, place: Place }
    Arguments { group: usize, shown: bool, call: Call, axes: List<(usize, usize)> }
    Bounds { call: Option<Call> = None, lower: Option<usize> = None, upper: Option<usize> = None }
    Call { kernel: usize = 0, slots: List<Slot> = &[], reductions: List<Reduction> = &[], data: List<Data> = &[] }
    Constraint { name: Option<Text>, place: Place, block: Block, unit: Unit, sides: usize }
    Continuation { parameter: usize, steps: List<f64> }
    Group { loops: List<Loop>, domain: Domain, call: Call, rows: List<Row>, bounds: Option<Call> }
    Guess { loops: List<Loop>, scope: GuessScope, kind: GuessKind }
    Helper { sides: List<usize>, bounds: List<usize>, at_zero: usize }
    Independent { name: Text = "t", unit: Unit = Unit { symbol: "s", factor: 1.0 } }
    Integral { loops: List<Loop>, place: Place }
    Kernel {
        name: Text = "",
        slots: usize = 0,
        data: usize = 0,
        rows: usize = 0,
        jacobian: List<(usize, usize)> = &[],
        hessian: List<(usize, usize)> = &[],
        degree: List<Degree> = &[],
        probes: List<Place> = &[]
    }
    Loop { first: Affine, last: Affine }
    Measurement { term: usize, unit: Unit, loops: List<Loop>, residual: Call, sigma: Call }
    Named {
        name: Text,
        doc: Text,
        unit: Unit,
        family: Option<Family>,
        agent: usize,
        loops: List<Loop>,
        domain: Domain,
        call: Call
    }
    Output { name: Text, doc: Text, unit: Unit, family: Option<Family>, vector: Option<usize>, spline: Spline }
    Parameter { name: Text, doc: Text, unit: Unit, array: bool, grid: Option<Grid>, value: List<f64> }
    Phase {
        name: Option<Text>,
        agent: usize,
        family: Option<Family>,
        after: Option<usize>,
        duration: Duration,
        duration_name: Option<Text>,
        outputs: List<Output>,
        points: List<Points>,
        place: Place
    }
    PhaseRef { phase: usize = 0, agent: Option<Affine> = None, index: Option<Affine> = None }
    Place { line: u32 = 0, column: u32 = 0, text: Text = "" }
    Places { first: i64, instants: List<Instant> }
    Reduction { op: ReduceOp, over: Loop, body: Call }
    Relaxation {
        equation: usize,
        other: usize,
        helpers: List<Helper>,
        corners: List<Place>,
        exact_first: bool,
        is_exact: bool
    }
    Shared { phase: usize, output: usize, until: List<f64> }
    Spline { order: usize, smoothness: usize, breakpoints: Breakpoints }
    Structure {
        name: Text = "",
        doc: Text = "",
        source: Text = "",
        maximize: bool = false,
        objective_unit: Unit = Unit::DEFAULT,
        independent: Independent = Independent::DEFAULT,
        parameters: List<Parameter> = &[],
        tables: List<Table> = &[],
        shared: List<Shared> = &[],
        variables: List<Variable> = &[],
        agents: List<Agent> = &[],
        phases: List<Phase> = &[],
        places: List<Places> = &[],
        kernels: List<Kernel> = &[],
        groups: List<Group> = &[],
        shown: List<Group> = &[],
        arguments: List<Arguments> = &[],
        corners: List<Place> = &[],
        relaxations: List<Relaxation> = &[],
        terms: List<Term> = &[],
        measurements: List<Measurement> = &[],
        constraints: List<Constraint> = &[],
        norms: List<usize> = &[],
        angles: List<Angle> = &[],
        integrals: List<Integral> = &[],
        named: List<Named> = &[],
        guesses: List<Guess> = &[],
        continuations: List<Continuation> = &[]
    }
    Table {
        name: Text,
        doc: Text,
        axes: List<TableAxis>,
        unit: Unit,
        values: List<f64>,
        method: TableMethod,
        extrapolation: TableExtrapolation,
        replaceable: bool
    }
    TableAxis { name: Text, unit: Unit, nodes: List<f64>, symmetry: TableSymmetry }
    Term { name: Option<Text>, place: Place, unit: Unit }
    Unit { symbol: Text = "", factor: f64 = 1.0 }
    Variable { name: Text, doc: Text, unit: Unit, family: Option<Family>, bounds: Bounds, place: Place }
}

enums! {
    Data { Tau TauWithin; Index(Affine) Duration(PhaseRef) Start(PhaseRef); Parameter { parameter: usize, index: Option<Affine> } }
    Domain { Mission; Start(PhaseRef) End(PhaseRef); Path { phase: PhaseRef, points: usize, part: Part } }
    Duration {; Fixed(Call) Free(Bounds); }
    GuessKind {; ;
        Output { output: Text, index: Option<Affine>, value: Call }
        Route { outputs: List<(Text, Option<Affine>)>, points: usize, values: Call }
        Duration { value: Call }
        Variable { variable: usize, index: Option<Affine>, value: Call }
        Start { value: Call }
    }
    GuessScope {; Phase(PhaseRef); Agent { agent: usize, index: Option<Affine> } }
    Points { Breakpoints LeftLimits; ;
        Gauss { points: usize }
        Uniform { points: usize }
        Times { times: List<Instant> }
    }
    Row {; ;
        Cost { term: usize }
        Constraint { constraint: usize, lower: Option<usize>, upper: Option<usize> }
        Part { constraint: usize, index: List<Affine> }
        Integral { integral: usize, index: List<Affine> }
    }
    Slot {;
        Duration(PhaseRef) Start(PhaseRef);
        Flat { phase: PhaseRef, at: At, output: usize, index: Option<Affine>, derivative: usize }
        Variable { variable: usize, index: Option<Affine> }
        Integral { integral: usize, index: List<Affine> }
    }
    Start {; Fixed(Option<Call>) Free(Bounds); }
    TableMethod { Monotone Linear; ;
        Bspline { order: usize }
        Fit { order: usize, intervals: List<usize> }
    }
}

impl Affine {
    /// [`crate::Affine::constant`].
    pub const fn constant(value: i64) -> Self {
        Self { constant: value, terms: &[] }
    }
}

/// Breakpoints of a spline, of which many that are equally spaced are a rule and not a list.
#[derive(Clone, Copy, Debug)]
pub enum Breakpoints {
    /// So many intervals of the same length.
    Equal(usize),
    /// These numbers.
    At(List<f64>),
}

impl Constant for Breakpoints {
    type Owned = Vec<f64>;
    fn owned(&self) -> Vec<f64> {
        match *self {
            Self::Equal(intervals) => (0..=intervals).map(|i| i as f64 / intervals as f64).collect(),
            Self::At(breakpoints) => breakpoints.to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_those_of_the_data() {
        assert_eq!(Bounds::DEFAULT.owned(), crate::Bounds::default());
        assert_eq!(Call::DEFAULT.owned(), crate::Call::default());
        assert_eq!(Independent::DEFAULT.owned(), crate::Independent::default());
        assert_eq!(Kernel::DEFAULT.owned(), crate::Kernel::default());
        assert_eq!(PhaseRef::DEFAULT.owned(), crate::PhaseRef::default());
        assert_eq!(Place::DEFAULT.owned(), crate::Place::default());
        assert_eq!(Structure::DEFAULT.owned(), crate::Structure::default());
        assert_eq!(Unit::DEFAULT.owned(), crate::Unit::default());
    }

    #[test]
    fn equal_breakpoints_are_the_quotients_themselves() {
        let spline = Spline { order: 5, smoothness: 3, breakpoints: Breakpoints::Equal(4) };
        assert_eq!(spline.owned().breakpoints, [0.0, 0.25, 0.5, 0.75, 1.0]);
        let spline = Spline { breakpoints: Breakpoints::At(&[0.0, 0.3, 1.0]), ..spline };
        assert_eq!(spline.owned().breakpoints, [0.0, 0.3, 1.0]);
    }
}
