//! Heat maps in bands: a function of two variables as coloured areas, each band one step of a scale
//! that stands at the side with its numbers.

use std::ops::Range;

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::chart::Chart;
use super::{Area, Drawn, GREY, INK, text};

/// Cells across and up: fine enough that the edges of bands look like lines.
const CELLS: (usize, usize) = (280, 180);

/// From values to colours, in bands.
pub(crate) struct Scale {
    /// What is coloured, with its unit.
    pub(crate) name: &'static str,
    /// Edges of the bands, increasing; values beyond them take the outermost band's colour.
    pub(crate) edges: Vec<f64>,
    /// Gives the colour for a share of the way from the first band to the last.
    pub(crate) palette: fn(f64) -> RGBColor,
}

impl Scale {
    /// Bands of equal width.
    pub(crate) fn even(name: &'static str, over: Range<f64>, bands: u32, palette: fn(f64) -> RGBColor) -> Self {
        let at = |i: u32| over.start + (over.end - over.start) * f64::from(i) / f64::from(bands);
        Self { name, edges: (0..=bands).map(at).collect(), palette }
    }

    fn bands(&self) -> usize {
        self.edges.len() - 1
    }

    fn band(&self, value: f64) -> usize {
        // A value on an edge belongs to the band above, whatever its last bit.
        self.edges[1..self.bands()].partition_point(|edge| *edge <= value + 1e-9)
    }

    fn colour(&self, band: usize) -> RGBColor {
        (self.palette)(band as f64 / (self.bands() - 1).max(1) as f64)
    }
}

/// From dark blue to yellow, evenly in lightness.
pub(crate) fn viridis(share: f64) -> RGBColor {
    ViridisRGB.get_color(share)
}

/// White to warm orange: a background on which lines still show.
pub(crate) fn warm(share: f64) -> RGBColor {
    mix(RGBColor(255, 255, 255), RGBColor(240, 170, 110), share)
}

/// Blue for what is below, white for nothing, red-orange for what is above.
pub(crate) fn diverging(share: f64) -> RGBColor {
    let white = RGBColor(250, 250, 250);
    if share < 0.5 {
        mix(RGBColor(5, 80, 150), white, 2.0 * share)
    } else {
        mix(white, RGBColor(190, 70, 0), 2.0 * share - 1.0)
    }
}

fn mix(from: RGBColor, to: RGBColor, share: f64) -> RGBColor {
    let channel = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
    RGBColor(channel(from.0, to.0), channel(from.1, to.1), channel(from.2, to.2))
}

/// Fills a chart with the bands of `f`. Neighbouring cells of one band are drawn as one rectangle.
pub(crate) fn fill(chart: &mut Chart<'_, RangedCoordf64>, scale: &Scale, f: impl Fn(f64, f64) -> f64) -> Drawn {
    let (xs, ys) = (chart.x_range(), chart.y_range());
    let (columns, rows) = CELLS;
    let x = |i: f64| xs.start + (xs.end - xs.start) * (i / columns as f64).min(1.0);
    let y = |j: f64| ys.start + (ys.end - ys.start) * (j / rows as f64).min(1.0);
    for j in 0..rows {
        let bands: Vec<usize> = (0..columns).map(|i| scale.band(f(x(i as f64 + 0.5), y(j as f64 + 0.5)))).collect();
        let mut first = 0;
        for run in bands.chunk_by(|a, b| a == b) {
            // Half a cell of overlap, which the next rectangles cover, leaves no seams.
            let end = (first + run.len()) as f64 + 0.5;
            let corners = [(x(first as f64), y(j as f64)), (x(end), y(j as f64 + 1.5))];
            chart.draw_series([Rectangle::new(corners, scale.colour(run[0]).filled())])?;
            first += run.len();
        }
    }
    Ok(())
}

/// Draws the scale at the right of an area; gives what is left of it.
pub(crate) fn bar<'a>(area: &Area<'a>, scale: &Scale) -> Drawn<Area<'a>> {
    let (width, height) = area.dim_in_pixel();
    let (map, side) = area.split_horizontally(width - 190);
    let (top, bottom) = (60, i32::try_from(height)? - 100);
    let step = f64::from(bottom - top) / scale.bands() as f64;
    let level = |i: usize| bottom - (step * i as f64).round() as i32;
    for band in 0..scale.bands() {
        let corners = [(20, level(band + 1)), (60, level(band))];
        side.draw(&Rectangle::new(corners, scale.colour(band).filled()))?;
    }
    side.draw(&Rectangle::new([(20, top), (60, bottom)], GREY.stroke_width(1)))?;
    let style = text(26).color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
    let every = scale.bands().div_ceil(12);
    for (i, edge) in scale.edges.iter().enumerate().step_by(every) {
        let label = format!("{}", (edge * 1e4).round() / 1e4);
        side.draw(&Text::new(label, (70, level(i)), style.clone()))?;
    }
    side.draw(&Text::new(scale.name, (0, 10), text(28).color(&INK)))?;
    Ok(map)
}
