//! The table of codes: one line each, with its number and its one-line title.
//!
//! | numbers     | about                                                    |
//! |-------------|----------------------------------------------------------|
//! | E001 - E019 | syntax                                                   |
//! | E020 - E039 | names and declarations                                   |
//! | E040 - E049 | units and dimensions                                     |
//! | E050 - E069 | meaning: time, scopes, orders, bounds                    |
//! | E070 - E079 | tables                                                   |
//! | E080 - E089 | families, phases, agents                                 |
//! | E090 -      | limits                                                   |
//! | N001 -      | notes: jumping gradients, fit reports                    |
//!
//! A number, once given, keeps its meaning. Each code has an entry in docs/errors.md.

use super::Severity;

/// Makes the enum and its table; adding a code is adding one line.
macro_rules! codes {
    ($($variant:ident $number:literal $title:literal;)*) => {
        /// Which kind of finding; its text (`E013`) is stable, its entry is in docs/errors.md.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Code {
            $(#[doc = concat!($number, ": ", $title, ".")] $variant,)*
        }

        impl Code {
            /// Every code, in the table's order.
            pub const ALL: &[Self] = &[$(Self::$variant,)*];

            /// The stable text, `E001`.
            pub const fn text(self) -> &'static str {
                match self {
                    $(Self::$variant => $number,)*
                }
            }

            /// What the code stands for, in one line.
            pub const fn title(self) -> &'static str {
                match self {
                    $(Self::$variant => $title,)*
                }
            }
        }
    };
}

codes! {
    Unexpected "E001" "something else was expected here";
    MissingSemicolon "E002" "a statement without its `;`";
    Unclosed "E003" "a bracket, comment or string that is never closed";
    Unopened "E004" "a closing bracket that closes nothing";
    TooDeep "E005" "brackets nested too deeply";
    MalformedNumber "E006" "a number that is not written as numbers are";
    NumberTooLarge "E007" "a number beyond the largest that can be held";
    UnknownCharacter "E008" "a character that the language does not use";
    MalformedString "E009" "a string that would not survive inline";
    Comment "E010" "a comment of a kind that is refused, or one that documents nothing";
    MalformedName "E011" "a word that cannot be a name";
    ReservedWord "E012" "a reserved word used as a name";
    WrongRelation "E013" "a relation other than `==`, `<=`, `>=`";
    MixedChain "E014" "a chain of relations that is no double bound";
    RangeOperator "E015" "a range written otherwise than `first .. last`";
    Setting "E016" "a setting that is unknown, given twice or not taken here";
    Misplaced "E017" "something that may not stand here";
    MalformedUnit "E018" "a unit that is not written as units are";
    OneProblem "E019" "a spec is exactly one problem";

    UnknownName "E020" "a name that nothing has";
    DeclaredTwice "E021" "a name or setting declared twice in one place";
    ShadowsFunction "E022" "a name that a function of the language has";
    Circle "E023" "a definition or function that needs itself";
    NoFunction "E024" "something applied that is no function";
    ArgumentCount "E025" "too many or too few arguments";
    WrongIndices "E026" "an index that is missing or superfluous";
    NotWhole "E027" "something other than a whole number of constants and indices";
    IndexOutside "E028" "an index outside its range";
    NotConstant "E029" "something that is not known where constants stand";
    NoValue "E030" "a name that stands for no value";
    WrongCount "E031" "a list with too many or too few elements";
    NotFinite "E032" "a number that is not finite";
    WrongContinuation "E033" "a continuation of something else than a number";
    UnknownUnit "E040" "a unit symbol that is not known";
    DimensionMismatch "E041" "different dimensions joined or compared";
    NotPure "E042" "a quantity where a pure number is needed";
    WildExponent "E043" "an exponent that leaves no dimension";
    WrongUnit "E044" "a declared unit of another dimension";
    UnusableUnit "E045" "a unit too large or too small";
    ShapeMismatch "E046" "shapes that do not fit";
    NoNumber "E047" "a vector or matrix where one number is needed";
    MixedVector "E048" "a vector of different kinds of quantities";
    WrongCondition "E049" "a condition that decides nothing";
    VariesAlong "E050" "a trajectory quantity where a single number stands";
    TimeOutOfPlace "E051" "`t` or `tau` where it has no value";
    EventAlong "E052" "an event time or integral where an expression belongs to a point";
    ForeignTrajectory "E053" "a trajectory quantity of another phase or agent";
    NoDerivative "E054" "a derivative that a spline does not have";
    WrongSpline "E055" "a spline that does not exist";
    BoundsCross "E056" "bounds that cross";
    Contradiction "E057" "conditions that contradict each other";
    TooManyRows "E058" "more boundary conditions than an output can meet";
    NoObjective "E059" "no objective, and an open trajectory";
    WrongDuration "E060" "a duration that is missing, superfluous or not positive";
    MixedSenses "E061" "minimised and maximised at once";
    WrongPoints "E062" "a number of points that makes no rule";
    WrongPartial "E063" "a derivative that cannot be taken";
    WrongOrder "E064" "an order of differentiation that means nothing";
    NotGuessable "E065" "a guess of or from something that cannot be guessed";
    NeverHolds "E066" "a constraint that can never hold";
    NoOutput "E067" "a phase in which nothing can move";
    WrongEquations "E068" "as many equations of `dynamics` as elements of states are needed";
    StateWithoutRate "E069" "a state without a derivative in `dynamics`";
    NodesNotIncreasing "E070" "table nodes that do not increase";
    RaggedTable "E071" "rows of a table with different lengths";
    UnreadableTable "E072" "a file of numbers that cannot be read";
    WrongTable "E073" "a table that has no interpolant";
    FileSize "E074" "a file that has another size than the array that it fills";
    UnknownPhase "E080" "a phase or agent that does not exist";
    PhaseCircle "E081" "phases that follow one another in a circle";
    PhaseFork "E082" "two phases after one";
    WrongLevel "E083" "an item that means nothing at its level";
    EmptyFamily "E084" "a family without members";
    WrongAfter "E085" "an index after which a phase cannot follow";
    WhichAgent "E086" "an agent that is not named";
    WrongLibrary "E087" "a library that cannot be used";

    SourceTooLarge "E090" "a spec too large to be read";
    TooManySteps "E091" "a problem too large to be given a meaning";
    TooDeepMeaning "E092" "definitions nested too deeply in one another";
    UnknownPlace "E093" "a place in time that is not known before the solve, or outside";
    Delay "E094" "an expression at another time than that at which it stands";
    WrongMeasurement "E095" "something in `measure` that is no measurement";
    UnitInDoubt "E096" "a unit in a list that can be read two ways";
    MissesJumps "E097" "a derivative that misses the jumps of what it is taken of";
    TooLarge "E098" "a problem too large to be solved";
    FewPoints "E099" "an equation between states on too few points";
    LayoutChanges "E100" "a layout that would change what a spec says";

    GradientJumps "N001" "a gradient that may jump";
    DerivativeJumps "N002" "a derivative that jumps at the knots";
    FitReport "N003" "how well a table follows its values";
    AlwaysHolds "N004" "a constraint that always holds";
    FreeStart "N005" "an end without a start";
    UnitTaken "N006" "a name in a list takes the next unit";
    UnboundedInList "N007" "a name in a list without the bounds of the next one";
    UnitLikeSize "N008" "a unit that is also the name of a size";
    BareAngle "N009" "a bare number beside an angle, of more than a turn";
    GuessOutside "N010" "a guess outside of its bounds";
    SoftName "N011" "a constraint named `soft` that has no price";
    Invariant "N012" "an equation that follows from the equations of motion";
    Reduced "N013" "an equation between states that inputs keep";
    KnotsApart "N014" "an equation between splines on different knots";
}

impl Code {
    /// Errors have an `E`, warnings a `W`, notes an `N`.
    pub const fn severity(self) -> Severity {
        match self.text().as_bytes()[0] {
            b'N' => Severity::Note,
            b'W' => Severity::Warning,
            _ => Severity::Error,
        }
    }
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_unique_well_formed_and_rising() {
        let texts: Vec<&str> = Code::ALL.iter().map(|code| code.text()).collect();
        for text in &texts {
            assert!(
                matches!(text.as_bytes(), [b'E' | b'W' | b'N', d @ ..] if d.len() == 3 && d.iter().all(u8::is_ascii_digit))
            );
        }
        // Errors before notes, each kind in rising order: a number given twice would show here.
        let key = |text: &str| (text.starts_with('N'), text.starts_with('W'), text.to_owned());
        assert!(texts.windows(2).all(|pair| key(pair[0]) < key(pair[1])), "{texts:?}");
    }
}
