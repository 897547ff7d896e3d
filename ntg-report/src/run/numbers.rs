//! Numbers that may not be finite: `null` in JSON, NaN in memory.

/// A single number.
pub(super) mod one {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in crate::run) fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        value.is_finite().then_some(*value).serialize(to)
    }

    pub(in crate::run) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::NAN))
    }
}

/// A list of numbers.
pub(super) mod many {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(in crate::run) fn serialize<S: Serializer>(values: &[f64], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(values.iter().map(|value| value.is_finite().then_some(*value)))
    }

    pub(in crate::run) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let values = Vec::<Option<f64>>::deserialize(from)?;
        Ok(values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
    }
}

/// A list of numbers, or one number.
pub(super) fn one_or_many<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
    use serde::Deserialize;

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Written {
        One(Option<f64>),
        Many(Vec<Option<f64>>),
    }
    let values = match Written::deserialize(from)? {
        Written::One(value) => vec![value],
        Written::Many(values) => values,
    };
    Ok(values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
}

/// The values of a parameter in a file.
#[derive(Default, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub(super) struct Written {
    unit: String,
    value: serde_json::Value,
}

impl From<super::Values> for Written {
    fn from(values: super::Values) -> Self {
        let value = super::vectors::members(values.value.into_iter().map(Into::into).collect(), &values.shape);
        Self { unit: values.unit, value }
    }
}

impl TryFrom<Written> for super::Values {
    type Error = String;

    fn try_from(written: Written) -> Result<Self, String> {
        let members = super::vectors::from_members(&written.value);
        let (value, shape) = members.ok_or_else(|| format!("{} are no values of a parameter", written.value))?;
        Ok(Self { unit: written.unit, value, shape })
    }
}

/// A table of numbers.
pub(super) mod rows {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(in crate::run) fn serialize<S: Serializer>(rows: &[Vec<f64>], to: S) -> Result<S::Ok, S::Error> {
        let finite = |row: &Vec<f64>| -> Vec<Option<f64>> {
            row.iter().map(|value| value.is_finite().then_some(*value)).collect()
        };
        to.collect_seq(rows.iter().map(finite))
    }

    pub(in crate::run) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Vec<f64>>, D::Error> {
        let rows = Vec::<Vec<Option<f64>>>::deserialize(from)?;
        Ok(rows.into_iter().map(|row| row.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect()).collect())
    }
}
