//! What a tube is, in words.

use std::fmt;

use super::{Ending, State, Tube};

impl State {
    /// `x`, `der(x)`, `der(x, 2)`.
    pub fn label(&self) -> String {
        label(&self.name, self.derivative)
    }

    /// `km`, `km/s`, `1/s^2`.
    pub fn unit_label(&self) -> String {
        let own = &self.unit.symbol;
        match (self.derivative, own.is_empty()) {
            (0, _) => own.clone(),
            (1, true) => "1/s".to_owned(),
            (1, false) => format!("{own}/s"),
            (k, true) => format!("1/s^{k}"),
            (k, false) => format!("{own}/s^{k}"),
        }
    }
}

impl fmt::Display for Tube {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.phases.iter().all(super::Stretch::is_flat) {
            return writeln!(f, "Tube: none is needed, no equation of motion holds at points only");
        }
        writeln!(
            f,
            "Tube: how far the true state is from the splines, with their inputs, from their start ({} boxes of time, {:.3} s)",
            self.boxes, self.seconds
        )?;
        let labels = self.phases.iter().flat_map(|stretch| &stretch.states).map(|state| state.label().chars().count());
        let width = labels.max().unwrap_or(0);
        for stretch in &self.phases {
            let of = if stretch.phase.is_empty() { String::new() } else { format!("{}: ", stretch.phase) };
            match &stretch.ending {
                Ending::Whole => {}
                Ending::None(words) => writeln!(f, "  {of}no tube: {words}")?,
                Ending::At(time, words) => {
                    let (name, unit) = (&self.independent.name, &self.independent.unit.symbol);
                    let at = format!("{name} = {time:.4} {unit}");
                    writeln!(f, "  {of}no tube from {} on: {words}", at.trim_end())?;
                }
            }
            // A tube that ends where it begins bounds nothing.
            let is_partial = matches!(stretch.ending, Ending::At(..));
            let is_nothing = is_partial && stretch.states.iter().all(|state| state.most == 0.0);
            for state in stretch.states.iter().filter(|_| !is_nothing) {
                let most = format!("{} {}", above(state.most), state.unit_label());
                let until = if is_partial { "until then within" } else { "within" };
                let at_end = state.at_end.map_or(String::new(), |by| format!(", {} at the end", above(by)));
                writeln!(f, "  {:<width$}  {until} {}{at_end}", state.label(), most.trim_end())?;
            }
        }
        if !self.is_whole() {
            writeln!(f, "  where there is no tube, no more is certified than the residuals of the equations")?;
        }
        Ok(())
    }
}

/// A derivative of an output.
pub(super) fn label(name: &str, derivative: usize) -> String {
    match derivative {
        0 => name.to_owned(),
        1 => format!("der({name})"),
        k => format!("der({name}, {k})"),
    }
}

/// Two digits, rounded up.
pub(super) fn above(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let unit = 10_f64.powi(value.abs().log10().floor() as i32 - 1);
    format!("{:.1e}", ((value / unit).ceil() + 0.0) * unit)
}

#[cfg(test)]
mod tests {
    use super::above;

    #[test]
    fn bounds_are_rounded_up() {
        assert_eq!(above(1.01e-7), "1.1e-7");
        assert_eq!(above(9.91), "1.0e1");
        assert_eq!(above(2.0e-3), "2.0e-3");
        assert_eq!(above(0.0), "0");
    }
}
