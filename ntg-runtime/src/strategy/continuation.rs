//! Parameters that are solved for in turn (docs/maths.md, section 8.4).
//!
//! Step `i` of a solve gives every such parameter its `i`-th value, or its last one where it has
//! fewer. The value that the program has set replaces the last step.

use ntg_structure::Structure;

/// A parameter and the value that it has in one step, SI.
pub(crate) type Setting = (usize, f64);

/// The settings of every step, in order; one empty step without continuation.
pub(crate) fn steps(structure: &Structure) -> Vec<Vec<Setting>> {
    let sequences: Vec<(usize, Vec<f64>)> = structure
        .continuations
        .iter()
        .map(|continuation| {
            let mut steps = continuation.steps.clone();
            let value = structure.parameters.get(continuation.parameter).and_then(|p| p.value.first());
            if let Some(value) = value {
                steps.pop();
                steps.push(*value);
            }
            (continuation.parameter, steps)
        })
        .collect();
    let count = sequences.iter().map(|(_, steps)| steps.len()).max().unwrap_or(0).max(1);
    let setting = |i: usize| {
        let at = |(parameter, steps): &(usize, Vec<f64>)| {
            let last = steps.len().checked_sub(1)?;
            Some((*parameter, steps[i.min(last)]))
        };
        sequences.iter().filter_map(at).collect()
    };
    (0..count).map(setting).collect()
}

/// Makes a structure that of one step.
pub(crate) fn set(structure: &mut Structure, settings: &[Setting]) {
    for (parameter, value) in settings {
        if let Some(parameter) = structure.parameters.get_mut(*parameter) {
            parameter.value.fill(*value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ntg_structure::{Continuation, Parameter, Unit};

    fn structure(value: f64) -> Structure {
        let parameter = Parameter {
            name: "w".into(),
            doc: String::new(),
            unit: Unit::default(),
            array: false,
            grid: None,
            value: vec![value],
        };
        let continuations = vec![Continuation { parameter: 0, steps: vec![20.0, 5.0, 1.0] }];
        Structure { parameters: vec![parameter], continuations, ..Structure::default() }
    }

    #[test]
    fn the_program_decides_the_last_step() {
        assert_eq!(steps(&structure(1.0)), [[(0, 20.0)], [(0, 5.0)], [(0, 1.0)]]);
        assert_eq!(steps(&structure(2.0))[2], [(0, 2.0)]);
        let mut first = structure(1.0);
        set(&mut first, &[(0, 20.0)]);
        assert_eq!(first.parameters[0].value, [20.0]);
    }

    #[test]
    fn without_continuation_there_is_one_step() {
        assert_eq!(steps(&Structure::default()), [vec![]]);
    }
}
