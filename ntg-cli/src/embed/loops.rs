//! What the example loops measure and print: the parameters that are a measured state, and the readings.

use std::fmt::Write;

use ntg_structure::Structure;

use super::names::{Constant, Member, Readings};

/// A parameter that is measured, and what it measures.
#[derive(Debug)]
pub(super) struct Measured {
    /// The member of the struct of parameters.
    pub(super) member: String,
    /// The constant that reads it from a plan.
    pub(super) reading: String,
    pub(super) derivative: usize,
    /// A unit of the reading in units of the parameter.
    pub(super) factor: f64,
}

/// Reads `PARAMETER=READING` and `PARAMETER=der(READING, ORDER)`.
pub(super) fn measured(
    words: &[String],
    structure: &Structure,
    parameters: &[Member],
    readings: &Readings,
) -> Result<Vec<Measured>, String> {
    let known = |names: &mut dyn Iterator<Item = &str>| names.collect::<Vec<_>>().join("`, `");
    // A comma within brackets is the second argument of `der`, not the next parameter.
    let mut wanted: Vec<String> = vec![];
    for word in words {
        match wanted.last_mut().filter(|last| last.matches('(').count() > last.matches(')').count()) {
            Some(last) => *last = format!("{last},{word}"),
            None => wanted.push(word.clone()),
        }
    }
    let one = |word: &String| {
        let (parameter, reading) = word.split_once('=').ok_or_else(|| {
            format!("--state `{word}`: write the parameter and what it measures, such as `x_start=x` or `v0=der(x)`")
        })?;
        let (parameter, reading) = (parameter.trim(), reading.trim());
        let member = parameters.iter().find(|member| member.of == parameter && member.length.is_none());
        let member = member.ok_or_else(|| {
            let mut names = parameters.iter().filter(|member| member.length.is_none()).map(|m| m.of.as_str());
            format!(
                "--state `{word}`: `{}` has no parameter `{parameter}` that is one number; there are `{}`",
                structure.name,
                known(&mut names)
            )
        })?;
        let (name, derivative) = derivative_of(reading);
        let constant = readings.find(name).ok_or_else(|| {
            let mut names = readings.all.iter().map(|constant| constant.of.as_str());
            format!("--state `{word}`: nothing named `{name}` can be read; there are `{}`", known(&mut names))
        })?;
        if derivative > 0 && !constant.is_output {
            return Err(format!("--state `{word}`: `{name}` is no output, and only outputs have derivatives"));
        }
        let factor = constant.unit.factor / member.unit.factor;
        Ok(Measured { member: member.name.clone(), reading: constant.name.clone(), derivative, factor })
    };
    wanted.iter().map(one).collect()
}

/// `der(x, 2)` as `x` and 2.
fn derivative_of(reading: &str) -> (&str, usize) {
    let inside = reading.strip_prefix("der(").and_then(|rest| rest.strip_suffix(')'));
    match inside.map(|inside| inside.split_once(',').unwrap_or((inside, "1"))) {
        Some((name, order)) => match order.trim().parse() {
            Ok(order) => (name.trim(), order),
            Err(_) => (reading, 0),
        },
        None => (reading, 0),
    }
}

/// What goes into the templates of loops.
pub(super) struct Loops<'a> {
    pub(super) name: &'a str,
    pub(super) readings: &'a Readings,
    pub(super) state: &'a [Measured],
}

impl Loops<'_> {
    /// Fills a template.
    pub(super) fn fill(&self, template: &str) -> String {
        template
            .replace("@MEASURE@", self.measure().trim_end())
            .replace("@MEASURE_CPP@", self.measure_checked().trim_end())
            .replace("@RECEIVE@", self.receive().trim_end())
            .replace("@SHOWN@", &self.shown())
            .replace("@NAMES@", &self.names())
            .replace("@FUNCTIONS@", &self.functions().count().to_string())
            .replace("@STATES@", &self.state.len().to_string())
            .replace("@NAME@", self.name)
            .replace("@UPPER@", &self.name.to_ascii_uppercase())
    }

    /// Statements of C that take the state after a step from the plan.
    fn measure(&self) -> String {
        let mut text = String::new();
        for Measured { member, reading, derivative, factor } in self.state {
            let _ = writeln!(
                text,
                "        status = {}_read(solver, {reading}, {derivative}, step, &parameters.{member});\n        \
                 if (status != {}_OK) return fail(solver, status);{}",
                self.name,
                self.name.to_ascii_uppercase(),
                in_unit(member, *factor)
            );
        }
        if text.is_empty() {
            text.push_str(
                "        (void)step; /* No state was named: `ntg embed --state PARAMETER=READING` fills this in. */\n",
            );
        }
        text
    }

    /// As [`Loops::measure`], in C++.
    fn measure_checked(&self) -> String {
        let mut text = String::new();
        for Measured { member, reading, derivative, factor } in self.state {
            let name = self.name;
            let _ = writeln!(
                text,
                "        check(solver, {name}_read(solver, {reading}, {derivative}, step, &parameters.{member}));{}",
                in_unit(member, *factor)
            );
        }
        if text.is_empty() {
            text.push_str(
                "        (void)step;  // No state was named: `ntg embed --state PARAMETER=READING` fills this in.\n",
            );
        }
        text
    }

    /// Statements of C++ that take the state from a message.
    fn receive(&self) -> String {
        let mut text = String::new();
        for (i, Measured { member, .. }) in self.state.iter().enumerate() {
            let _ = writeln!(text, "        parameters_.{member} = measured.data[{i}];");
        }
        text
    }

    /// The functions of time, by constants.
    fn shown(&self) -> String {
        self.functions().map(|constant| constant.name.as_str()).collect::<Vec<_>>().join(", ")
    }

    /// The functions of time, by names.
    fn names(&self) -> String {
        self.functions().map(|constant| format!("{:?}", constant.of)).collect::<Vec<_>>().join(", ")
    }

    fn functions(&self) -> impl Iterator<Item = &Constant> {
        self.readings.all.iter().filter(|constant| constant.is_function)
    }
}

/// A further line that converts what was read, where the parameter is in another unit.
fn in_unit(member: &str, factor: f64) -> String {
    match factor {
        1.0 => String::new(),
        factor => format!("\n        parameters.{member} *= {factor:?}; /* from the unit of the reading */"),
    }
}

#[cfg(test)]
mod tests {
    use super::derivative_of;

    #[test]
    fn derivatives_are_read_as_the_language_writes_them() {
        assert_eq!(derivative_of("x"), ("x", 0));
        assert_eq!(derivative_of("der(x)"), ("x", 1));
        assert_eq!(derivative_of("der(uav[2].x, 2)"), ("uav[2].x", 2));
        assert_eq!(derivative_of("der(x, y)"), ("der(x, y)", 0));
    }
}
