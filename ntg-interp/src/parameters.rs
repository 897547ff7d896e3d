//! Parameters set by name, in the units that a person uses.

use ntg_structure::{Duration, Parameter, Structure};

use crate::Interpreted;
use crate::text::written;

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
    /// Indices outside the array, as many as it has or not, or of a parameter that is no array: the parameter's name, the
    /// indices, the first and the last member as they are written, if there are any.
    Index(String, Vec<i64>, Option<(String, String)>),
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
            Self::Index(name, indices, Some((first, last))) => {
                let (own, takes) = (written(indices), first.matches(',').count() + 1);
                match takes == indices.len() {
                    true => write!(f, "there is no `{name}{own}`; the members are `{first}` to `{last}`"),
                    false if takes == 2 => {
                        write!(
                            f,
                            "`{name}` is a matrix and takes two indices, a row and a column: `{first}` to `{last}`"
                        )
                    }
                    false => write!(f, "`{name}` takes one index: `{first}` to `{last}`"),
                }
            }
            Self::Index(name, indices, None) => {
                write!(f, "there is no `{name}{}`: `{name}` is one number, not an array", written(indices))
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
    /// Where the number stands that a name (`v_max`) or a member (`start_x[2]`, of a matrix `A[2, 1]`) is.
    ///
    /// # Errors
    /// Unknown name, an index outside the array; an array without an index.
    pub fn place(&self, name: &str, indices: &[i64]) -> Result<Place, SetError> {
        let parameter = self.find(name)?;
        let declared = &self.structure.parameters[parameter];
        let factor = declared.unit.factor;
        let member = match indices {
            [] if declared.value.len() == 1 => 0,
            [] => return Err(SetError::Count(name.to_owned(), declared.value.len(), 1)),
            indices => member(declared, indices)?,
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

    /// Sets one member of an array parameter by its indices (counted from 1), in SI units.
    ///
    /// # Errors
    /// Unknown name, an index outside the array, a value that is not finite.
    pub fn set_member(&mut self, name: &str, indices: &[i64], value: f64) -> Result<(), SetError> {
        let parameter = self.find(name)?;
        let parameter = &mut self.structure.parameters[parameter];
        if !value.is_finite() {
            return Err(SetError::NotFinite(name.to_owned()));
        }
        let member = member(parameter, indices)?;
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

/// Which number of an array is meant by its indices, counted from 1.
fn member(parameter: &Parameter, indices: &[i64]) -> Result<usize, SetError> {
    let count = parameter.value.len();
    let at = |index: i64| usize::try_from(index).ok().and_then(|index| index.checked_sub(1));
    let member = match (indices, parameter.grid) {
        (&[index], None) => at(index),
        (&[row, column], Some(grid)) => {
            let columns = usize::try_from(grid.columns).unwrap_or(0);
            let place = at(row).zip(at(column).filter(|column| *column < columns));
            place.and_then(|(row, column)| row.checked_mul(columns)?.checked_add(column))
        }
        _ => None,
    };
    member.filter(|member| parameter.array && *member < count).ok_or_else(|| {
        let ends = parameter.array.then(|| (parameter.element(0), parameter.element(count.saturating_sub(1))));
        SetError::Index(parameter.name.clone(), indices.to_vec(), ends)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_of_a_matrix_have_two_indices() {
        let matrix = Parameter {
            name: "B".into(),
            doc: String::new(),
            unit: ntg_structure::Unit::default(),
            array: true,
            grid: Some(ntg_structure::Grid { row: 1, column: 1, columns: 3 }),
            value: vec![0.0; 6],
        };
        assert_eq!([[1, 1], [1, 3], [2, 1], [2, 3]].map(|place| member(&matrix, &place)), [Ok(0), Ok(2), Ok(3), Ok(5)]);
        assert_eq!([0, 2, 5].map(|k| matrix.element(k)), ["B[1, 1]", "B[1, 3]", "B[2, 3]"]);
        for outside in [[0, 1], [1, 0], [1, 4], [3, 1], [i64::MAX, 3], [-1, -1]] {
            let words = member(&matrix, &outside).map_err(|error| error.to_string());
            let [row, column] = outside;
            assert_eq!(words, Err(format!("there is no `B[{row}, {column}]`; the members are `B[1, 1]` to `B[2, 3]`")));
        }
        for count in [&[1][..], &[1, 1, 1]] {
            let words = member(&matrix, count).map_err(|error| error.to_string());
            let wanted = "`B` is a matrix and takes two indices, a row and a column: `B[1, 1]` to `B[2, 3]`";
            assert_eq!(words, Err(wanted.to_owned()));
        }
    }

    #[test]
    fn an_index_that_is_none_is_told_what_there_is() {
        let of = |array: bool| Parameter {
            name: "a".into(),
            doc: String::new(),
            unit: ntg_structure::Unit::default(),
            array,
            grid: None,
            value: vec![1.0, 2.0],
        };
        assert_eq!([1, 2].map(|index| member(&of(true), &[index])), [Ok(0), Ok(1)]);
        for index in [i64::MIN, -1, 0, 3, i64::MAX] {
            let words = member(&of(true), &[index]).map_err(|error| error.to_string());
            assert_eq!(words, Err(format!("there is no `a[{index}]`; the members are `a[1]` to `a[2]`")));
            let words = member(&of(false), &[index]).map_err(|error| error.to_string());
            assert_eq!(words, Err(format!("there is no `a[{index}]`: `a` is one number, not an array")));
        }
    }
}
