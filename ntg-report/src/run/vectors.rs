//! Vectors and matrices in files: one entry for each array, whose elements have entries of their own in memory.
//!
//! Pictures and tables show numbers, so a [`Run`](super::Run) has `r[1]`, `r[2]`; who reads a file asks for `r`. Its `value` at a
//! time stands where that of a number would, as a list, of a matrix as a list of rows: `value[k]` belongs to `t[k]`, whatever has
//! a value there, and has the shape that a function of time has in Rust and in Python. Times, unit and documentation stand once.
//! What is no whole array (a file written by hand may have `r[2]` alone) stays as it is.

use std::ops::Range;

use serde_json::{Map, Value};

/// The index of the first element, where it is not 1: a number, of a matrix a list of two.
const FIRST: &str = "first";
/// What elements have each for itself.
const OWN: [&str; 2] = ["value", "bands"];

/// An array among names, or a name that is of none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedArray {
    /// Without the indices of its elements.
    pub name: String,
    /// How many elements it has by each index; empty for a number.
    pub shape: Vec<usize>,
    /// The index of the first element.
    first: Vec<i64>,
    /// Where its elements stand among the names.
    pub elements: Range<usize>,
}

/// Which names are those of all elements of an array, in their order: `r[1]`, `r[2]`, of a matrix row by row.
pub fn arrays(names: &[&str]) -> Vec<NamedArray> {
    let mut found: Vec<NamedArray> = vec![];
    let parts: Vec<Option<(&str, Vec<i64>)>> = names.iter().map(|name| index(name)).collect();
    let mut from = 0;
    while from < names.len() {
        let is_next = |next: &&Option<(&str, Vec<i64>)>| match (&parts[from], next) {
            (Some((base, first)), Some((other, index))) => base == other && first.len() == index.len(),
            _ => false,
        };
        let count = parts[from..].iter().take_while(is_next).count().max(1);
        let indices: Vec<&[i64]> = parts[from..from + count].iter().flatten().map(|(_, index)| &index[..]).collect();
        let whole = parts[from].as_ref().zip(shape(&indices)).filter(|((base, _), _)| !names.contains(base));
        match whole {
            Some(((base, first), shape)) => {
                let (name, first) = ((*base).to_owned(), first.clone());
                found.push(NamedArray { name, shape, first, elements: from..from + count });
            }
            None => found.extend((from..from + count).map(|at| NamedArray {
                name: names[at].to_owned(),
                shape: vec![],
                first: vec![],
                elements: at..at + 1,
            })),
        }
        from += count;
    }
    found
}

/// How many elements there are by each index, if these are all of them, row by row.
fn shape(indices: &[&[i64]]) -> Option<Vec<usize>> {
    let (first, last) = (indices.first()?, indices.last()?);
    let size = |(first, last): (&i64, &i64)| usize::try_from(last.checked_sub(*first)?.checked_add(1)?).ok();
    let shape: Vec<usize> = first.iter().zip(*last).map(size).collect::<Option<_>>()?;
    let columns = shape.get(1).copied().unwrap_or(usize::MAX);
    let is_next = |(k, index): (usize, &&[i64])| match (first, index) {
        ([first], [index]) => index.checked_sub(*first) == i64::try_from(k).ok(),
        ([row, column], [i, j]) => {
            let at = |index: &i64, first: &i64| index.checked_sub(*first).and_then(|at| usize::try_from(at).ok());
            (at(i, row), at(j, column)) == (k.checked_div(columns), k.checked_rem(columns))
        }
        _ => false,
    };
    let fits = shape.iter().try_fold(1_usize, |all, size| all.checked_mul(*size)) == Some(indices.len());
    (fits && indices.iter().enumerate().all(is_next)).then_some(shape)
}

/// Elements put together to arrays, in their order; the rest as it is.
pub fn gathered(elements: Map<String, Value>) -> Map<String, Value> {
    let mut entries: Vec<(String, Value)> = elements.into_iter().collect();
    let names: Vec<&str> = entries.iter().map(|(name, _)| &name[..]).collect();
    let arrays = arrays(&names);
    let mut found = Map::new();
    for array in arrays {
        let elements = &mut entries[array.elements.clone()];
        if array.shape.is_empty() || !are_alike(elements) {
            found.extend(elements.iter_mut().map(std::mem::take));
        } else {
            let (name, entry) = array.entry(elements);
            found.insert(name, entry);
        }
    }
    found
}

/// Whether entries have the same unit, the same times and whatever else is not an element's own.
fn are_alike(entries: &[(String, Value)]) -> bool {
    let count = |entry: &Map<String, Value>| entry.keys().filter(|key| !OWN.contains(&key.as_str())).count();
    let is_like = |first: &Map<String, Value>, other: &Map<String, Value>| {
        let is_same = |(key, value): (&String, &Value)| OWN.contains(&key.as_str()) || other.get(key) == Some(value);
        count(first) == count(other) && first.iter().all(is_same)
    };
    let first = entries.first().and_then(|(_, entry)| entry.as_object());
    first.is_some_and(|first| {
        entries.iter().all(|(_, entry)| entry.as_object().is_some_and(|other| is_like(first, other)))
    })
}

/// The elements of all arrays, each with an entry of its own; the rest as it is.
pub fn elements(entries: Map<String, Value>) -> Map<String, Value> {
    let mut found = Map::new();
    for (name, entry) in entries {
        match parted(&name, &entry) {
            Some(elements) => found.extend(elements),
            None => _ = found.insert(name, entry),
        }
    }
    found
}

/// A file of an earlier version as it would be written today: a named number was a list of one.
pub(super) fn in_present_form(mut run: Value) -> Value {
    if run["version"] != 1 {
        return run;
    }
    let lets = run.get_mut("lets").and_then(Value::as_object_mut);
    for entry in lets.into_iter().flat_map(Map::values_mut).filter(|entry| entry.get("t").is_none()) {
        if let Some(value) = entry.get_mut("value")
            && let Some(number) = value.as_array().and_then(|list| list.first()).cloned()
        {
            *value = number;
        }
    }
    run
}

impl NamedArray {
    /// One entry of those of its elements.
    fn entry(&self, elements: &mut [(String, Value)]) -> (String, Value) {
        let (mut values, mut bands, mut entry) = (vec![], vec![], Map::new());
        for (_, element) in elements {
            let Value::Object(element) = element else { continue };
            values.push(element.remove("value").unwrap_or_default());
            bands.extend(element.remove("bands"));
            entry = std::mem::take(element);
        }
        if self.first.iter().any(|first| *first != 1) {
            let first = if let [first] = self.first[..] { first.into() } else { self.first.clone().into() };
            entry.insert(FIRST.to_owned(), first);
        }
        let is_timed = entry.contains_key("t");
        let value = if is_timed { transposed(values, &self.shape) } else { members(values, &self.shape) };
        entry.insert("value".to_owned(), value);
        if !bands.is_empty() {
            entry.insert("bands".to_owned(), bands.into());
        }
        (self.name.clone(), Value::Object(entry))
    }
}

/// The name of an element and its indices: `uav[2].r[3]` is element 3 of `uav[2].r`.
fn index(name: &str) -> Option<(&str, Vec<i64>)> {
    let (base, index) = name.strip_suffix(']')?.rsplit_once('[')?;
    let index: Vec<i64> = index.split(',').map(|part| part.trim().parse().ok()).collect::<Option<_>>()?;
    (!base.is_empty() && index.len() <= 2).then_some((base, index))
}

fn named(base: &str, index: &[i64]) -> String {
    let index: Vec<String> = index.iter().map(ToString::to_string).collect();
    format!("{base}[{}]", index.join(", "))
}

/// From a list over time for each element to an array for each time.
fn transposed(lists: Vec<Value>, shape: &[usize]) -> Value {
    let list = |value: Value| if let Value::Array(list) = value { list } else { vec![] };
    let mut lists: Vec<_> = lists.into_iter().map(|value| list(value).into_iter()).collect();
    let times = lists.iter().map(ExactSizeIterator::len).max().unwrap_or(0);
    let at = |_| members(lists.iter_mut().map(|list| list.next().unwrap_or_default()).collect(), shape);
    (0..times).map(at).collect::<Vec<_>>().into()
}

/// The elements of an entry that is one of an array; none of another.
fn parted(name: &str, entry: &Value) -> Option<Vec<(String, Value)>> {
    let entry = entry.as_object()?;
    let value = entry.get("value")?;
    let times = entry.contains_key("t").then(|| value.as_array()).flatten();
    let shape = shape_of(times.map_or(Some(value), |times| times.first())?)?;
    let first = |axis: usize| match entry.get(FIRST) {
        Some(Value::Array(first)) => first.get(axis).and_then(Value::as_i64).unwrap_or(1),
        Some(first) => first.as_i64().unwrap_or(1),
        None => 1,
    };
    let columns = shape.get(1).copied();
    let place = |k: usize| columns.map_or(vec![k], |columns| vec![k / columns, k % columns]);
    let element = |k: usize| {
        let place = place(k);
        let of = |value: &Value| place.iter().try_fold(value, |value, at| value.get(*at)).cloned().unwrap_or_default();
        let shared = entry.iter().filter(|(key, _)| !OWN.contains(&key.as_str()) && *key != FIRST);
        let mut own: Map<String, Value> = shared.map(|(key, value)| (key.clone(), value.clone())).collect();
        let value = times.map_or_else(|| of(value), |times| times.iter().map(of).collect::<Vec<_>>().into());
        own.insert("value".to_owned(), value);
        if let Some(bands) = entry.get("bands").and_then(|bands| bands.get(k)) {
            own.insert("bands".to_owned(), bands.clone());
        }
        let index: Vec<i64> =
            place.iter().enumerate().map(|(axis, at)| first(axis).saturating_add(*at as i64)).collect();
        (named(name, &index), Value::Object(own))
    };
    Some((0..shape.iter().product()).map(element).collect())
}

/// The shape of a value at one time: none of a number, and none of what is no vector or matrix.
fn shape_of(value: &Value) -> Option<Vec<usize>> {
    let rows = value.as_array()?;
    let columns = rows.first().and_then(Value::as_array).map(Vec::len);
    let fits = |row: &Value| row.as_array().map(Vec::len) == columns;
    let deep = rows.iter().filter_map(Value::as_array).flatten().any(Value::is_array);
    (!deep && rows.iter().all(fits) && columns != Some(0)).then(|| [rows.len()].into_iter().chain(columns).collect())
}

/// Values as they stand in a file: a number, a list, or a list of the rows of a matrix.
pub fn members(values: Vec<Value>, shape: &[usize]) -> Value {
    match (shape, values.first()) {
        ([], Some(number)) => number.clone(),
        ([_, columns], _) => values.chunks((*columns).max(1)).map(<[Value]>::to_vec).collect::<Vec<_>>().into(),
        _ => values.into(),
    }
}

/// The members of a parameter, row by row, and its shape; that of a number is empty. None of what is no array of numbers.
pub(super) fn from_members(value: &Value) -> Option<(Vec<f64>, Vec<usize>)> {
    let number = |value: &Value| if value.is_null() { Some(f64::NAN) } else { value.as_f64() };
    let Value::Array(list) = value else { return Some((vec![number(value)?], vec![])) };
    let shape = shape_of(value)?;
    let rows = list.iter().map(|row| row.as_array().map_or(std::slice::from_ref(row), Vec::as_slice));
    Some((rows.flatten().map(number).collect::<Option<_>>()?, shape))
}

/// As part of a run: arrays in the file, elements in memory.
pub(super) mod by_array {
    use indexmap::IndexMap;
    use serde::de::{DeserializeOwned, Error as _};
    use serde::ser::Error as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use serde_json::{Map, Value};

    pub(in crate::run) fn serialize<T: Serialize, S: Serializer>(
        elements: &IndexMap<String, T>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let entry = |(name, one): (&String, &T)| Ok((name.clone(), single(serde_json::to_value(one)?)));
        let entries: Result<Map<String, Value>, serde_json::Error> = elements.iter().map(entry).collect();
        super::gathered(entries.map_err(S::Error::custom)?).serialize(to)
    }

    /// A series without times is a number.
    fn single(mut entry: Value) -> Value {
        if entry.get("t").is_none()
            && let Some(value) = entry.get_mut("value")
            && let Some([number]) = value.as_array().map(Vec::as_slice)
        {
            *value = number.clone();
        }
        entry
    }

    pub(in crate::run) fn deserialize<'de, T: DeserializeOwned, D: Deserializer<'de>>(
        from: D,
    ) -> Result<IndexMap<String, T>, D::Error> {
        let entries = super::elements(Map::deserialize(from)?).into_iter();
        entries.map(|(name, entry)| Ok((name, serde_json::from_value(entry).map_err(D::Error::custom)?))).collect()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn of(value: Value) -> Map<String, Value> {
        value.as_object().expect("an object").clone()
    }

    #[test]
    fn a_vector_has_one_list_for_each_time_and_a_matrix_its_rows() {
        let elements = json!({
            "r[1]": { "unit": "m", "t": [0.0, 1.0], "value": [1.0, 2.0] },
            "r[2]": { "unit": "m", "t": [0.0, 1.0], "value": [3.0, null] },
            "uav[2].x": { "unit": "", "t": [0.0], "value": [5.0] },
            "a[0, 1]": { "unit": "", "value": 1.0 },
            "a[0, 2]": { "unit": "", "value": 2.0 },
            "a[1, 1]": { "unit": "", "value": 3.0 },
            "a[1, 2]": { "unit": "", "value": 4.0 },
            "one[1]": { "unit": "", "value": 7.0 },
        });
        let gathered = json!({
            "r": { "unit": "m", "t": [0.0, 1.0], "value": [[1.0, 3.0], [2.0, null]] },
            "uav[2].x": { "unit": "", "t": [0.0], "value": [5.0] },
            "a": { "unit": "", "first": [0, 1], "value": [[1.0, 2.0], [3.0, 4.0]] },
            "one": { "unit": "", "value": [7.0] },
        });
        assert_eq!(Value::from(super::gathered(of(elements.clone()))), gathered);
        assert_eq!(Value::from(super::elements(of(gathered))), elements);
    }

    #[test]
    fn what_is_no_whole_array_stays_as_it_is() {
        let entry = |unit: &str, t: f64| json!({ "unit": unit, "t": [t], "value": [1.0] });
        for parts in [
            json!({ "r[2]": entry("m", 0.0), "r[4]": entry("m", 0.0) }),
            json!({ "r[1]": entry("m", 0.0), "r[2]": entry("km", 0.0) }),
            json!({ "r[1]": entry("m", 0.0), "r[2]": entry("m", 1.0) }),
            json!({ "r[1]": entry("m", 0.0), "r": entry("m", 0.0) }),
            json!({ "r[1, 1]": entry("m", 0.0), "r[1, 2]": entry("m", 0.0), "r[2, 1]": entry("m", 0.0) }),
            json!({ "r[1]": 3.0, "r[2]": null, "x]": {}, "[1]": {}, "y[a]": {}, "z[1, 2, 3]": {} }),
            json!({ "r[-9223372036854775808]": entry("m", 0.0), "r[9223372036854775807]": entry("m", 0.0) }),
        ] {
            assert_eq!(Value::from(gathered(of(parts.clone()))), parts);
            assert_eq!(Value::from(elements(of(parts.clone()))), parts);
        }
        // Damaged values are read as no vectors.
        for damaged in [json!([[1.0], [2.0, 3.0], [[4.0]]]), json!([[], []]), json!({}), json!([[[]]]), json!(null)] {
            let _ = elements(of(json!({ "r": { "t": [0.0, 1.0], "value": damaged } })));
            let _ = elements(of(json!({ "r": { "value": damaged, "first": "x" } })));
            let _ = from_members(&damaged);
        }
    }

    #[test]
    fn bands_are_those_of_the_elements() {
        let elements = json!({
            "a[1]": { "t": [0.0], "value": [1.0], "bands": [[0.0, 1.0, 0.5, 1.5]] },
            "a[2]": { "t": [0.0], "value": [2.0], "bands": [[0.0, 1.0, 1.5, 2.5]] },
        });
        let gathered = gathered(of(elements.clone()));
        assert_eq!(gathered["a"]["bands"][1], json!([[0.0, 1.0, 1.5, 2.5]]));
        assert_eq!(Value::from(super::elements(gathered)), elements);
    }
}
