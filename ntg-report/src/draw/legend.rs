//! The legend above a panel: where its names stand, and how high it is.

use plotters::element::DashedPathElement;
use plotters::prelude::*;

use super::fit::{fitted, width};
use super::{Area, COLOURS, Drawn, GREY, INK, MARGIN, dashes, font};
use crate::figure::{Line, Panel};

/// Height of a row, and what is free above the first.
const ROW: u32 = 400;
const ABOVE: u32 = 80;
/// Rows before the rest is left out: who has more lines knows them by their shape.
const MOST: u32 = 3;
/// What a line takes beside its name.
const SAMPLE: u32 = 1000;
/// Size of its letters.
const SIZE: u32 = 260;

/// Where names stand.
pub(super) struct Legend {
    /// The name of a line as far as there is room for it, and its left upper corner.
    names: Vec<(String, (u32, u32))>,
    /// How many rows there are, with that of what is left out; none of a single line.
    rows: u32,
}

impl Legend {
    /// Lays the names of a panel out that is so wide.
    pub(super) fn of(panel: &Panel, across: u32) -> Self {
        if panel.lines.len() < 2 {
            return Self { names: vec![], rows: 0 };
        }
        let (mut names, mut x, mut row) = (vec![], MARGIN, 0);
        for line in &panel.lines {
            let name = fitted(&line.name, SIZE, across.saturating_sub(MARGIN + SAMPLE));
            let wide = SAMPLE + width(&name, SIZE);
            if x > MARGIN && x + wide > across {
                (x, row) = (MARGIN, row + 1);
            }
            if row == MOST {
                break;
            }
            names.push((name, (x, ABOVE + row * ROW)));
            x += wide;
        }
        Self { names, rows: row + 1 }
    }

    /// How high it is.
    pub(super) fn height(&self) -> u32 {
        if self.rows == 0 { 0 } else { ABOVE + self.rows * ROW }
    }

    /// By how much it is higher than a single row.
    pub(super) fn further(&self) -> u32 {
        self.rows.saturating_sub(1) * ROW
    }

    /// Draws it at the top of an area.
    pub(super) fn draw(&self, area: &Area<'_>, lines: &[Line]) -> Drawn {
        for (index, ((name, (x, y)), line)) in self.names.iter().zip(lines).enumerate() {
            let (x, y) = (i32::try_from(*x)?, i32::try_from(*y)?);
            let ends = [(x, y + 140), (x + 560, y + 140)];
            let like = line.like.unwrap_or(index);
            let colour = COLOURS[like % COLOURS.len()];
            let style = colour.stroke_width(40);
            match dashes(like, line.run)? {
                _ if !line.sigmas.is_empty() => area.draw(&Circle::new((x + 280, y + 140), 50, colour.filled()))?,
                None => area.draw(&PathElement::new(ends, style))?,
                Some((long, gap)) => area.draw(&DashedPathElement::new(ends, long, gap, style))?,
            }
            area.draw(&Text::new(name.clone(), (x + 680, y), font(SIZE).color(&INK)))?;
        }
        if let more @ 1.. = lines.len().saturating_sub(self.names.len())
            && self.rows > 0
        {
            let at = (i32::try_from(MARGIN)?, i32::try_from(ABOVE + MOST * ROW)? - 40);
            area.draw(&Text::new(format!("and {more} more"), at, font(240).color(&GREY)))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{WIDTH, svg};
    use super::*;

    #[test]
    fn forty_members_leave_the_plot_as_high_as_one_and_no_name_leaves_its_panel() {
        let lines = |count: usize, name: &str| {
            let line = |k: usize| Line {
                name: format!("{name}[{k}]"),
                points: vec![(0.0, 0.0), (1.0, 1.0)],
                ..Line::default()
            };
            Panel { lines: (1..=count).map(line).collect(), ..Panel::default() }
        };
        let legend = Legend::of(&lines(40, "x"), WIDTH / 2);
        assert_eq!((legend.rows, legend.further()), (MOST + 1, MOST * ROW));
        assert_eq!((Legend::of(&lines(1, "x"), WIDTH).height(), Legend::of(&lines(2, "x"), WIDTH).further()), (0, 0));
        let name = "a_name_that_is_longer_than_half_a_picture_is_wide_and_goes_on_and_on_and_on_and_on";
        for (name, (x, _)) in Legend::of(&lines(3, name), WIDTH / 2).names {
            assert!(
                x + SAMPLE + width(&name, SIZE) <= WIDTH / 2 && name.ends_with(']') && name.contains("..."),
                "{name}"
            );
        }
        let panel = Panel { title: name.repeat(9), x: name.repeat(9), y: name.repeat(9), ..lines(40, "x") };
        let picture = svg(&name.repeat(9), &name.repeat(9), &[panel]).expect("a picture");
        assert!(!picture.contains(&name.repeat(2)) && picture.contains("and 12 more"));
    }
}
