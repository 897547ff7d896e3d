//! Parameters set by name, in the units that a person uses.

use ntg_structure::{Duration, Parameter, Structure};

use crate::Interpreted;

/// Why a parameter could not be set.
#[derive(Clone, Debug, PartialEq)]
pub enum SetError {
    /// There is no parameter of that name; the names that there are.
    Unknown(String, Vec<String>),
    /// A variable, or a duration with bounds.
    Sought(String),
    /// A duration with a fixed value; the names of the parameters.
    Fixed(String, Vec<String>),
    /// An array got the wrong number of values: name, wanted, got.
    Count(String, usize, usize),
    /// An index outside the array, or an index for a parameter that is no array: name, index, members.
    Index(String, i64, Option<usize>),
    /// A value that is not finite.
    NotFinite(String),
}

impl std::fmt::Display for SetError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unknown(name, known) if known.is_empty() => {
                write!(f, "`{name}` cannot be set: the problem has no parameters")
            }
            Self::Unknown(name, known) => {
                write!(f, "there is no parameter `{name}`; the parameters are: `{}`", known.join("`, `"))
            }
            Self::Sought(name) => {
                write!(f, "`{name}` is no parameter but declared with bounds: change them in the spec")
            }
            Self::Fixed(name, known) => {
                write!(
                    f,
                    "`{name}` is no parameter but a fixed duration: write `param {name}_set = ...;` and `duration {name} \
                     = {name}_set;` in the spec, and set `{name}_set`"
                )?;
                if known.is_empty() { Ok(()) } else { write!(f, "; the parameters are: `{}`", known.join("`, `")) }
            }
            Self::Count(name, wanted, got) => {
                let (values, are) =
                    (if *wanted == 1 { "value" } else { "values" }, if *got == 1 { "is" } else { "are" });
                write!(f, "`{name}` holds {wanted} {values}, but {got} {are} given")
            }
            Self::Index(name, index, Some(members)) => {
                write!(f, "there is no `{name}[{index}]`; the members are `{name}[1]` to `{name}[{members}]`")
            }
            Self::Index(name, index, None) => {
                write!(f, "there is no `{name}[{index}]`: `{name}` is one number, not an array")
            }
            Self::NotFinite(name) => write!(f, "`{name}` must be a finite number"),
        }
    }
}

impl std::error::Error for SetError {}

/// Where one number of a parameter stands: for programs that set it again and again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    parameter: usize,
    member: usize,
    /// SI units in one declared unit.
    factor: f64,
}

impl Interpreted {
    /// Where the number stands that a name (`v_max`) or a member (`start_x[2]`) is.
    ///
    /// # Errors
    /// Unknown name, an index outside the array; an array without an index.
    pub fn place(&self, name: &str, index: Option<i64>) -> Result<Place, SetError> {
        let parameter = self.find(name)?;
        let declared = &self.structure.parameters[parameter];
        let factor = declared.unit.factor;
        let member = match index {
            None if declared.value.len() == 1 => 0,
            None => return Err(SetError::Count(name.to_owned(), declared.value.len(), 1)),
            Some(index) => member(declared, index)?,
        };
        Ok(Place { parameter, member, factor })
    }

    /// Sets one number in its declared unit. The place is one of this problem or of a clone.
    ///
    /// # Errors
    /// A value that is not finite.
    pub fn put(&mut self, place: Place, value: f64) -> Result<(), SetError> {
        let parameter = &mut self.structure.parameters[place.parameter];
        if !value.is_finite() {
            return Err(SetError::NotFinite(parameter.name.clone()));
        }
        parameter.value[place.member] = value * place.factor;
        Ok(())
    }

    /// Sets all values of a parameter, in SI units: one for a scalar, as many as an array has.
    ///
    /// # Errors
    /// Unknown name, wrong number of values, values that are not finite.
    pub fn set(&mut self, name: &str, values: &[f64]) -> Result<(), SetError> {
        let parameter = self.find(name)?;
        let place = &mut self.structure.parameters[parameter].value;
        if place.len() != values.len() {
            return Err(SetError::Count(name.to_owned(), place.len(), values.len()));
        }
        if values.iter().any(|v| !v.is_finite()) {
            return Err(SetError::NotFinite(name.to_owned()));
        }
        place.copy_from_slice(values);
        Ok(())
    }

    /// Sets one member of an array parameter (counted from 1), in SI units.
    ///
    /// # Errors
    /// Unknown name, an index outside the array, a value that is not finite.
    pub fn set_member(&mut self, name: &str, index: i64, value: f64) -> Result<(), SetError> {
        let parameter = self.find(name)?;
        let parameter = &mut self.structure.parameters[parameter];
        if !value.is_finite() {
            return Err(SetError::NotFinite(name.to_owned()));
        }
        let member = member(parameter, index)?;
        parameter.value[member] = value;
        Ok(())
    }

    fn find(&self, name: &str) -> Result<usize, SetError> {
        let parameters = &self.structure.parameters;
        parameters.iter().position(|p| p.name == name).ok_or_else(|| {
            let (own, known) = (name.to_owned(), parameters.iter().map(|p| p.name.clone()).collect());
            match other(&self.structure, name) {
                Some(Other::Sought) => SetError::Sought(own),
                Some(Other::Fixed) => SetError::Fixed(own, known),
                None => SetError::Unknown(own, known),
            }
        })
    }
}

/// What a name is that is no parameter's.
enum Other {
    /// The solve finds its value.
    Sought,
    /// The spec fixes its value.
    Fixed,
}

/// Whether a name is that of a duration or a variable.
fn other(structure: &Structure, name: &str) -> Option<Other> {
    let is_own = |own: &Option<String>| own.as_deref() == Some(name);
    let phase = structure.phases.iter().find(|phase| is_own(&phase.duration_name));
    let is_whole = structure.agents.iter().any(|agent| is_own(&agent.duration_name));
    match phase.map(|phase| &phase.duration) {
        Some(Duration::Fixed(_)) => Some(Other::Fixed),
        Some(Duration::Free(_)) => Some(Other::Sought),
        None => (is_whole || structure.variables.iter().any(|v| v.name == name)).then_some(Other::Sought),
    }
}

/// Which number of an array an index from 1 is.
fn member(parameter: &Parameter, index: i64) -> Result<usize, SetError> {
    let members = parameter.array.then_some(parameter.value.len());
    let member = usize::try_from(index).ok().and_then(|index| index.checked_sub(1));
    let member = member.filter(|member| members.is_some_and(|members| *member < members));
    member.ok_or_else(|| SetError::Index(parameter.name.clone(), index, members))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_index_that_is_none_is_told_what_there_is() {
        let of = |array: bool| Parameter {
            name: "a".into(),
            doc: String::new(),
            unit: ntg_structure::Unit::default(),
            array,
            value: vec![1.0, 2.0],
        };
        assert_eq!([1, 2].map(|index| member(&of(true), index)), [Ok(0), Ok(1)]);
        for index in [i64::MIN, -1, 0, 3, i64::MAX] {
            let words = member(&of(true), index).map_err(|error| error.to_string());
            assert_eq!(words, Err(format!("there is no `a[{index}]`; the members are `a[1]` to `a[2]`")));
            let words = member(&of(false), index).map_err(|error| error.to_string());
            assert_eq!(words, Err(format!("there is no `a[{index}]`: `a` is one number, not an array")));
        }
    }
}
