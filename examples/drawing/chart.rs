//! Line charts: axes with units, lines and dots, limits, and a legend above.

use std::ops::Range;

use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

use super::{Area, Drawn, GREY, INK, text};

/// How a line is drawn.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Stroke {
    Solid,
    /// Broad and pale: lies under another line that it may coincide with.
    Broad,
    Dashed,
    /// Thin and dotted: where the flight was first sought.
    Fine,
    /// Its points alone.
    Dots,
}

/// Points with a name and a look.
#[derive(Clone)]
pub(crate) struct Line {
    pub(crate) name: String,
    pub(crate) colour: RGBColor,
    pub(crate) stroke: Stroke,
    pub(crate) points: Vec<(f64, f64)>,
}

impl Line {
    pub(crate) fn new(name: &str, colour: RGBColor, stroke: Stroke, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.to_owned(), colour, stroke, points }
    }

    /// The graph of a function at 600 equally spaced places.
    pub(crate) fn graph(name: &str, look: (RGBColor, Stroke), over: Range<f64>, f: impl Fn(f64) -> f64) -> Self {
        let at = |i: i32| over.start + (over.end - over.start) * f64::from(i) / 599.0;
        Self::new(name, look.0, look.1, (0..600).map(|i| (at(i), f(at(i)))).collect())
    }

    fn style(&self) -> ShapeStyle {
        match self.stroke {
            Stroke::Broad => self.colour.mix(0.45).stroke_width(11),
            Stroke::Dots => self.colour.filled(),
            Stroke::Fine => self.colour.stroke_width(3),
            Stroke::Solid | Stroke::Dashed => self.colour.stroke_width(4),
        }
    }
}

/// What the axes say, how far they go, and how numbers on the abscissa are written.
pub(crate) struct Axes<'a, X = Range<f64>> {
    pub(crate) x: (&'a str, X),
    pub(crate) y: (&'a str, Range<f64>),
    pub(crate) numbers: fn(f64) -> String,
}

impl<'a, X> Axes<'a, X> {
    pub(crate) fn new(x: (&'a str, X), y: (&'a str, Range<f64>)) -> Self {
        Self { x, y, numbers: number }
    }
}

/// A chart whose ordinate is linear; its abscissa may be logarithmic.
pub(crate) type Chart<'a, X> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, RangedCoordf64>>;

/// Draws axes with a faint grid, and gives the chart to draw in.
pub(crate) fn axes<'a, X>(area: &Area<'a>, axes: Axes<'_, X>) -> Drawn<Chart<'a, X::CoordDescType>>
where
    X: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
{
    let mut chart = ChartBuilder::on(area)
        .margin_left(24)
        .margin_right(50)
        .margin_top(10)
        .x_label_area_size(if axes.x.0.is_empty() { 45 } else { 90 })
        .y_label_area_size(116)
        .build_cartesian_2d(axes.x.1, axes.y.1)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .axis_style(GREY)
        .label_style(text(28).color(&INK))
        .axis_desc_style(text(30).color(&INK))
        .x_desc(axes.x.0)
        .y_desc(axes.y.0)
        .x_label_formatter(&|x| (axes.numbers)(*x))
        .y_label_formatter(&|y| number(*y))
        .draw()?;
    Ok(chart)
}

/// Draws lines into a chart, the first one undermost.
pub(crate) fn draw<X: Ranged<ValueType = f64>>(chart: &mut Chart<'_, X>, lines: &[Line]) -> Drawn {
    for line in lines {
        let points = line.points.iter().copied();
        match line.stroke {
            Stroke::Solid | Stroke::Broad => chart.draw_series(LineSeries::new(points, line.style()))?,
            Stroke::Dashed => chart.draw_series(DashedLineSeries::new(points, 16, 10, line.style()))?,
            Stroke::Fine => chart.draw_series(DashedLineSeries::new(points, 4, 8, line.style()))?,
            Stroke::Dots => chart.draw_series(points.map(|point| Circle::new(point, 8, line.style())))?,
        };
    }
    Ok(())
}

/// Draws horizontal limits across a chart, each with what it is.
pub(crate) fn limits(chart: &mut Chart<'_, RangedCoordf64>, across: Range<f64>, limits: &[(f64, &str)]) -> Drawn {
    let style = text(26).color(&INK);
    for &(y, name) in limits {
        let ends = [(across.start, y), (across.end, y)];
        chart.draw_series(DashedLineSeries::new(ends, 5, 7, INK.stroke_width(3)))?;
        let label = Text::new(name.to_owned(), (10, -28), style.clone());
        chart.draw_series([EmptyElement::at((across.start, y)) + label])?;
    }
    Ok(())
}

/// Draws the legend in a strip of 44 pixels a row at the top; gives the area beneath it.
pub(crate) fn legend<'a>(area: &Area<'a>, lines: &[Line]) -> Drawn<Area<'a>> {
    let (mut x, mut y) = (40, 12);
    for line in lines {
        // The width of a letter is not known in SVG; 14 pixels is ample at this size.
        let width = 110 + 14 * i32::try_from(line.name.chars().count())?;
        if x > 40 && x + width > 1600 {
            (x, y) = (40, y + 44);
        }
        let ends = [(x, y + 14), (x + 64, y + 14)];
        match line.stroke {
            Stroke::Solid | Stroke::Broad => area.draw(&PathElement::new(ends, line.style()))?,
            Stroke::Dashed => area.draw(&DashedPathElement::new(ends, 16, 10, line.style()))?,
            Stroke::Fine => area.draw(&DashedPathElement::new(ends, 4, 8, line.style()))?,
            Stroke::Dots => area.draw(&Circle::new((x + 32, y + 14), 8, line.style()))?,
        }
        area.draw(&Text::new(line.name.clone(), (x + 78, y), text(28).color(&INK)))?;
        x += width;
    }
    Ok(area.split_vertically(y + 56).1)
}

/// A number as short as it can be said: `0.25`, `-100`, `0`.
fn number(x: f64) -> String {
    let rounded = (x * 1e6).round() / 1e6;
    if rounded == 0.0 { "0".to_owned() } else { rounded.to_string() }
}
