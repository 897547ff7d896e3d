//! Panels as an SVG picture, by plotters.
//!
//! Lengths are in tenths of a pixel of a picture 1600 wide: the library rounds to whole numbers, and a line whose points
//! lie on whole pixels wobbles. Colours are Okabe and Ito's, which colour-blind eyes can tell apart.

mod clip;
mod fit;
mod legend;

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use fit::{fitted, fitted_bold};
use legend::Legend;

use crate::figure::{Kind, Limit, Line, Panel, Shape, least_span};

/// A rectangle of a picture to draw in.
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
/// A place in tenths of a pixel, from the left and from the top.
type Pixel = (i32, i32);
type Drawn<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// How many units of the drawing a pixel is.
const PIXEL: u32 = 10;
const WIDTH: u32 = 1600 * PIXEL;
/// What is left free beside words at the left, and at least at the right.
const MARGIN: u32 = 400;
/// The strip of title and sentence.
const HEAD: u32 = 130 * PIXEL;
/// Heights of a panel, and of one that is a map.
const HEIGHT: u32 = 540 * PIXEL;
const MAP_HEIGHT: u32 = 1100 * PIXEL;
/// Digits that numbers have at most behind the first one.
const MOST_DIGITS: f64 = 15.0;
/// The strip of numbers and words beside an axis that goes up, where numbers are short, and what each sign takes of it.
const BESIDE: u32 = 1100;
const SIGN: u32 = 140;
/// Signs of numbers that are short.
const SHORT: u32 = 6;

const INK: RGBColor = RGBColor(30, 30, 30);
const GREY: RGBColor = RGBColor(110, 110, 110);
/// Limits, and the ground.
const LIMIT: RGBColor = RGBColor(178, 34, 34);
const GROUND: RGBColor = RGBColor(122, 92, 48);
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(170, 68, 153),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(120, 94, 40),
    RGBColor(90, 90, 90),
];

/// Draws panels beneath a title and a sentence.
///
/// # Errors
/// In words; only where a panel holds nothing that can be drawn.
pub fn svg(title: &str, sentence: &str, panels: &[Panel]) -> Result<String, String> {
    if panels.is_empty() {
        return Err("there is nothing to draw".to_owned());
    }
    let rows = rows(panels);
    let height = HEAD + rows.iter().map(|row| row_height(row)).sum::<u32>();
    let mut text = String::new();
    draw(&mut text, height, (title, sentence), &rows).map_err(|error| error.to_string())?;
    // The view box stays: it says how long a unit is.
    let size = |scale: u32| format!("width=\"{}\" height=\"{}\"", WIDTH / scale, height / scale);
    Ok(text.replacen(&size(1), &size(PIXEL), 1))
}

/// Maps and lone panels take a whole row, others share one.
fn rows(panels: &[Panel]) -> Vec<Vec<&Panel>> {
    let mut rows: Vec<Vec<&Panel>> = vec![];
    for panel in panels {
        match rows.last_mut() {
            Some(row) if row.len() == 1 && !row[0].equal && !panel.equal && panels.len() > 2 => row.push(panel),
            _ => rows.push(vec![panel]),
        }
    }
    rows
}

/// How high a row is: a legend of more than one line is no smaller plot.
fn row_height(row: &[&Panel]) -> u32 {
    let height = if row.iter().any(|panel| panel.equal) { MAP_HEIGHT } else { HEIGHT };
    let width = WIDTH / u32::try_from(row.len()).unwrap_or(1);
    height + row.iter().map(|panel| Legend::of(panel, width).further()).max().unwrap_or_default()
}

fn draw(text: &mut String, height: u32, (title, sentence): (&str, &str), rows: &[Vec<&Panel>]) -> Drawn {
    let root = SVGBackend::with_string(text, (WIDTH, height)).into_drawing_area();
    root.fill(&WHITE)?;
    let room = WIDTH - 2 * MARGIN;
    let at = |y: i32| (MARGIN as i32, y);
    root.draw(&Text::new(fitted_bold(title, 460, room), at(280), font(460).style(FontStyle::Bold).color(&INK)))?;
    root.draw(&Text::new(fitted(sentence, 280, room), at(840), font(280).color(&GREY)))?;
    let mut rest = root.split_vertically(HEAD).1;
    for row in rows {
        let (area, below) = rest.split_vertically(row_height(row));
        rest = below;
        for (panel, area) in row.iter().zip(area.split_evenly((1, row.len()))) {
            self::panel(&area, panel)?;
        }
    }
    root.present()?;
    Ok(())
}

fn panel(area: &Area<'_>, panel: &Panel) -> Drawn {
    let title = fitted_bold(&panel.title, 320, area.dim_in_pixel().0.saturating_sub(2 * MARGIN));
    area.draw(&Text::new(title, (MARGIN as i32, 60), font(320).style(FontStyle::Bold).color(&INK)))?;
    let below = area.split_vertically(480).1;
    let legend = Legend::of(panel, area.dim_in_pixel().0);
    legend.draw(&below, &panel.lines)?;
    let plot = below.split_vertically(legend.height()).1;
    let (mut xs, mut ys) = ranges(panel);
    let beside = beside(&ys);
    let (width, height) = plot.dim_in_pixel();
    if panel.equal {
        // What the labels and margins below take.
        let aspect = f64::from(width.saturating_sub(600 + beside)) / f64::from(height.saturating_sub(1100));
        equalise(&mut xs, &mut ys, aspect);
    }
    let mut chart = ChartBuilder::on(&plot)
        .margin_left(200)
        .margin_right(400)
        .margin_top(120)
        .margin_bottom(100)
        .x_label_area_size(780)
        .y_label_area_size(beside)
        .build_cartesian_2d(xs.clone(), ys.clone())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12).stroke_width(PIXEL))
        .axis_style(GREY.stroke_width(PIXEL))
        .label_style(font(240).color(&INK))
        .axis_desc_style(font(260).color(&INK))
        .x_labels(along(&xs, width.saturating_sub(600 + beside)))
        .y_labels(8)
        .x_desc(fitted(&panel.x, 260, width.saturating_sub(600 + beside)))
        .y_desc(fitted(&panel.y, 260, height.saturating_sub(1100)))
        .x_label_formatter(&|x| number(*x, xs.end - xs.start))
        .y_label_formatter(&|y| number(*y, ys.end - ys.start))
        .draw()?;
    for shape in &panel.shapes {
        draw_shape(&mut chart, shape, (&xs, &ys))?;
    }
    marks(&mut chart, panel, &xs, &ys)?;
    for (index, line) in panel.lines.iter().enumerate() {
        draw_line(&mut chart, index, line)?;
    }
    Ok(())
}

fn font(size: u32) -> FontDesc<'static> {
    ("sans-serif", size).into_font()
}

/// Limits across and events up.
fn marks(chart: &mut Chart<'_>, panel: &Panel, xs: &Range<f64>, ys: &Range<f64>) -> Drawn {
    // A limit that is far away is not drawn: the library has no room for its distance, and no mark there is seen.
    for Limit { at, name, over, curve } in &panel.limits {
        if !curve.is_empty() {
            limit_curve(chart, (name, curve), (xs, ys))?;
            continue;
        }
        if !ys.contains(at) {
            continue;
        }
        let (from, to) = (over.0.max(xs.start), over.1.min(xs.end));
        chart.draw_series(DashedLineSeries::new([(from, *at), (to, *at)], 50, 70, INK.stroke_width(30)))?;
        limit_name(chart, (from, *at), name)?;
    }
    for (i, (x, name)) in panel.marks.iter().filter(|mark| (xs.start..=xs.end).contains(&mark.0)).enumerate() {
        chart.draw_series(DashedLineSeries::new([(*x, ys.start), (*x, ys.end)], 100, 80, GREY.stroke_width(20)))?;
        // Neighbouring events stand at different heights.
        let height = 40 + 240 * i32::try_from(i % 4)?;
        // Behind its mark, or before it where the panel ends too soon.
        let style = font(220).color(&GREY);
        let inside = chart.plotting_area().get_x_axis_pixel_range();
        let name = fitted(name, 220, u32::try_from(inside.end - inside.start)? / 2);
        let (width, right) = (i32::try_from(style.font.box_size(&name)?.0)?, chart.plotting_area().get_x_range().end);
        let room = chart.backend_coord(&(right, ys.end)).0 - chart.backend_coord(&(*x, ys.end)).0;
        let left = if width + 60 <= room { 60 } else { -60 - width };
        let label = Text::new(name, (left, height), style);
        chart.draw_series([EmptyElement::at((*x, ys.end)) + label])?;
    }
    Ok(())
}

/// The name of a limit above its first point, or as far to the left of it as the frame needs.
fn limit_name(chart: &mut Chart<'_>, at: (f64, f64), name: &str) -> Drawn {
    let inside = chart.plotting_area().get_x_axis_pixel_range();
    let name = fitted(name, 220, u32::try_from(inside.end - inside.start)?.saturating_sub(MARGIN));
    let width = i32::try_from(fit::width(&name, 220))?;
    let left = 100.min(inside.end - width - chart.backend_coord(&at).0);
    chart.draw_series([EmptyElement::at(at) + Text::new(name, (left, -260), font(220).color(&GREY))])?;
    Ok(())
}

/// A limit that is a function of time, as far as it is in the picture.
fn limit_curve(
    chart: &mut Chart<'_>,
    (name, curve): (&str, &[(f64, f64)]),
    (xs, ys): (&Range<f64>, &Range<f64>),
) -> Drawn {
    for (number, part) in clip::line(curve, xs, ys).into_iter().enumerate() {
        let first = part.first().copied().filter(|_| number == 0);
        chart.draw_series(DashedLineSeries::new(part, 50, 70, INK.stroke_width(30)))?;
        if let Some(at) = first {
            limit_name(chart, at, name)?;
        }
    }
    Ok(())
}

/// What lies beneath the lines.
fn draw_shape(chart: &mut Chart<'_>, shape: &Shape, (xs, ys): (&Range<f64>, &Range<f64>)) -> Drawn {
    let colour = match (shape.of, shape.kind) {
        (Some(line), _) => COLOURS[line % COLOURS.len()],
        (None, Kind::Area | Kind::Border) => LIMIT,
        (None, Kind::Ground) => GROUND,
        (None, Kind::Contour | Kind::Place) => GREY,
    };
    let area = clip::area(&shape.points, xs, ys);
    if shape.kind == Kind::Area && area.len() > 2 {
        chart.draw_series([Polygon::new(area.clone(), colour.mix(0.12))])?;
    }
    let parts = clip::line(&shape.points, xs, ys);
    for part in parts.iter().cloned() {
        match shape.kind {
            Kind::Area => chart.draw_series(LineSeries::new(part, colour.stroke_width(20)))?,
            Kind::Contour => chart.draw_series(LineSeries::new(part, colour.mix(0.45).stroke_width(15)))?,
            Kind::Ground => chart.draw_series(LineSeries::new(part, colour.stroke_width(35)))?,
            Kind::Border | Kind::Place => {
                chart.draw_series(DashedLineSeries::new(part, 100, 60, colour.stroke_width(25)))?;
                continue;
            }
        };
    }
    // A name stands in the middle of an area, beside all others; lines of equal height have none.
    let place =
        shape.points.first().copied().filter(|(x, y)| shape.kind == Kind::Place && xs.contains(x) && ys.contains(y));
    if let Some(at) = place {
        chart.draw_series([TriangleMarker::new(at, 90, INK.filled())])?;
    }
    let count = area.len() as f64;
    let mean = |pick: fn(&(f64, f64)) -> f64| area.iter().map(pick).sum::<f64>() / count;
    let at = match shape.kind {
        Kind::Contour => None,
        Kind::Area => (count > 2.0).then(|| (mean(|p| p.0), mean(|p| p.1))),
        Kind::Border | Kind::Ground => parts.first().and_then(|part| part.first()).copied(),
        Kind::Place => place,
    };
    if let Some(at) = at {
        // Above the middle of an area, where a place may have its own name.
        let offset = if shape.kind == Kind::Area { (-200, -400) } else { (100, -80) };
        // Areas of several lines may have one middle.
        let offset = (offset.0, offset.1 - 260 * i32::try_from(shape.of.unwrap_or(0))?);
        let style = font(200).color(&colour);
        let inside = chart.plotting_area().get_x_axis_pixel_range();
        let name = fitted(&shape.name, 200, u32::try_from(inside.end - inside.start)?);
        let size = style.font.box_size(&name)?;
        let size = (i32::try_from(size.0)?, i32::try_from(size.1)?);
        let corner = |x: f64, y: f64| chart.backend_coord(&(x, y));
        let (least, most) = (corner(xs.start, ys.end), corner(xs.end, ys.start));
        let offset = within(corner(at.0, at.1), offset, size, (least, most));
        chart.draw_series([EmptyElement::at(at) + Text::new(name, offset, style)])?;
    }
    Ok(())
}

/// How far from a point a name of a size stands, so that the frame does not cut it.
fn within(at: Pixel, offset: Pixel, size: Pixel, (least, most): (Pixel, Pixel)) -> Pixel {
    /// Between a name and the frame.
    const GAP: i32 = 40;
    let one = |at: i32, offset: i32, size: i32, (least, most): (i32, i32)| {
        (at + offset).min(most - GAP - size).max(least + GAP) - at
    };
    (one(at.0, offset.0, size.0, (least.0, most.0)), one(at.1, offset.1, size.1, (least.1, most.1)))
}

fn draw_line(chart: &mut Chart<'_>, index: usize, line: &Line) -> Drawn {
    let index = line.like.unwrap_or(index);
    let colour = COLOURS[index % COLOURS.len()];
    let (style, dashes) = (colour.stroke_width(40), dashes(index, line.run)?);
    if !line.sigmas.is_empty() {
        return draw_measured(chart, line, colour);
    }
    // A gap where a quantity does not exist.
    for stretch in line.points.split(|(x, y)| !(x.is_finite() && y.is_finite())) {
        let points = stretch.iter().copied();
        match dashes {
            None => chart.draw_series(LineSeries::new(points, style))?,
            Some((long, gap)) => chart.draw_series(DashedLineSeries::new(points, long, gap, style))?,
        };
    }
    chart.draw_series(line.events.iter().map(|at| Circle::new(*at, 80, colour.filled())))?;
    if let (false, Some(start)) = (line.times.is_empty(), line.points.first()) {
        chart.draw_series([Circle::new(*start, 90, style)])?;
    }
    Ok(())
}

/// Points with their standard deviations to both sides.
fn draw_measured(chart: &mut Chart<'_>, line: &Line, colour: RGBColor) -> Drawn {
    let finite = || line.points.iter().filter(|(x, y)| x.is_finite() && y.is_finite());
    chart.draw_series(finite().map(|at| Circle::new(*at, 50, colour.filled())))?;
    let bars = line.points.iter().zip(&line.sigmas).filter(|((x, y), sigma)| (x + y + *sigma).is_finite());
    let bars = bars.map(|((x, y), sigma)| vec![(*x, y - sigma), (*x, y + sigma)]);
    chart.draw_series(bars.map(|ends| PathElement::new(ends, colour.stroke_width(20))))?;
    Ok(())
}

/// Lengths of dashes and gaps; none for a solid line. Runs differ in their gaps, and lines that have the same colour in
/// their dashes.
fn dashes(index: usize, run: usize) -> Drawn<Option<(u32, u32)>> {
    let again = u32::try_from(index / COLOURS.len())?;
    Ok(match (run, again) {
        (0, 0) => None,
        (0, 1) => Some((30, 60)),
        (0, again) => Some((140 + 120 * (again - 2), 60)),
        (run, again) => Some((140 / (1 + again), 40 + 40 * u32::try_from(run)?)),
    })
}

/// What the axes span: all lines, and the limits.
fn ranges(panel: &Panel) -> (Range<f64>, Range<f64>) {
    let points = || panel.lines.iter().flat_map(|line| &line.points).filter(|(x, y)| x.is_finite() && y.is_finite());
    let beneath = || panel.shapes.iter().filter(|shape| shape.kind == Kind::Place).flat_map(|shape| &shape.points);
    let xs = span(points().map(|p| p.0), 0.0);
    // What is nearly constant has room around it, for its limits, too.
    let least = least_span(panel);
    let level = |range: Range<f64>| {
        let (middle, half) = (0.5 * (range.start + range.end), 0.5 * least.max(range.end - range.start));
        middle - half..middle + half
    };
    let values = level(span(points().map(|p| p.1), 0.0));
    let reach = 3.0 * (values.end - values.start);
    // A limit that is far away would flatten what there is to see.
    let near = panel.limits.iter().flat_map(|limit| {
        let flat = limit.curve.is_empty().then_some(limit.at);
        flat.into_iter().chain(limit.curve.iter().map(|point| point.1))
    });
    let near = near.filter(|limit| *limit > values.start - reach && *limit < values.end + reach);
    let ys = level(span(points().map(|p| p.1).chain(near), 0.06));
    if !panel.equal {
        return (xs, ys);
    }
    // Places that are no further away than the tracks are long belong to the map.
    let reach = |range: &Range<f64>| {
        let room = range.end - range.start;
        range.start - room..range.end + room
    };
    let (wide, high) = (reach(&xs), reach(&ys));
    let near = beneath().filter(|(x, y)| wide.contains(x) && high.contains(y));
    let near: Vec<(f64, f64)> = points().chain(near).copied().collect();
    (span(near.iter().map(|p| p.0), 0.06), span(near.iter().map(|p| p.1), 0.06))
}

/// The least and the greatest, widened by a share; never empty.
fn span(values: impl Iterator<Item = f64>, widen: f64) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return 0.0..1.0;
    }
    let size = high - low;
    if size <= 1e-9 * low.abs().max(high.abs()) || size == 0.0 {
        let half = (0.1 * low.abs()).max(1e-3);
        return low - half..high + half;
    }
    low - widen * size..high + widen * size
}

/// Widens the shorter axis until a unit is as long on both.
fn equalise(xs: &mut Range<f64>, ys: &mut Range<f64>, aspect: f64) {
    let (width, height) = (xs.end - xs.start, ys.end - ys.start);
    let (axis, wanted) = if width < aspect * height { (xs, aspect * height) } else { (ys, width / aspect) };
    let middle = 0.5 * (axis.start + axis.end);
    *axis = middle - 0.5 * wanted..middle + 0.5 * wanted;
}

/// How wide the strip beside an axis is, for numbers like those near its ends.
fn beside(ys: &Range<f64>) -> u32 {
    BESIDE + SIGN * longest(ys).saturating_sub(SHORT)
}

/// How many numbers have room along an axis of so many units of the drawing.
fn along(xs: &Range<f64>, width: u32) -> usize {
    /// As many as are told where they are short, and signs between two.
    const USUAL: usize = 9;
    const GAP: u32 = 3;
    match longest(xs) {
        ..=SHORT => USUAL,
        signs => ((width / (SIGN * (signs + GAP))) as usize).clamp(2, USUAL),
    }
}

/// How many signs the longest number of an axis has: among as many steps as there are last digits.
fn longest(range: &Range<f64>) -> u32 {
    let length = range.end - range.start;
    let step = 10_f64.powf((length / 10.0).log10().floor());
    let places = (0..10).map(|k| ((range.start / step).round() + f64::from(k)) * step);
    let signs = places.map(|place| number(place, length).chars().count());
    u32::try_from(signs.max().unwrap_or_default()).unwrap_or(u32::MAX)
}

/// A number as short as it can be said on an axis of a given length.
fn number(x: f64, length: f64) -> String {
    if x.abs() < 1e-9 * length {
        return "0".to_owned();
    }
    // Two digits beyond the tenth part of the axis tell neighbouring labels apart.
    let last = (length / 10.0).log10().floor() - 1.0;
    if !(1e-4..1e6).contains(&x.abs()) {
        let decimals = (x.abs().log10().floor() - last).clamp(1.0, MOST_DIGITS) as usize;
        let text = format!("{x:.decimals$e}");
        let (number, power) = text.split_once('e').unwrap_or((&text, "0"));
        let short = number.trim_end_matches('0');
        let short = if short.ends_with('.') { format!("{short}0") } else { short.to_owned() };
        return format!("{short}e{power}");
    }
    let decimals = (-last).clamp(0.0, MOST_DIGITS) as usize;
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_one_colour_differ_in_their_dashes() {
        let looks: Vec<_> = (0..40).map(|index| (index % COLOURS.len(), dashes(index, 0).expect("a look"))).collect();
        let unique: std::collections::BTreeSet<_> = looks.iter().collect();
        assert_eq!(unique.len(), looks.len());
        assert!(looks[..8].iter().all(|(_, dashes)| dashes.is_none()));
    }

    #[test]
    fn numbers_of_an_axis_differ() {
        for (middle, length) in
            [(1e6, 400.0), (1e6, 100.0), (6.378e6, 1e3), (3e-5, 3e-9), (-1e9, 2e5), (0.5, 5e-5), (7e5, 1e-3)]
        {
            for parts in [4, 8, 10] {
                let ticks = (0..=parts).map(|k| middle + length * (f64::from(k) / f64::from(parts) - 0.5));
                let labels: Vec<String> = ticks.map(|x| number(x, length)).collect();
                let unique: std::collections::BTreeSet<_> = labels.iter().collect();
                assert_eq!(unique.len(), labels.len(), "{labels:?}");
            }
        }
        // Where numbers are far apart they stay short.
        assert_eq!([1e6, 2.5e6, 0.0, -4e6].map(|x| number(x, 1e7)), ["1.0e6", "2.5e6", "0", "-4.0e6"]);
        assert_eq!([0.25, 0.5].map(|x| number(x, 1.0)), ["0.25", "0.5"]);
        assert_eq!(beside(&(0.0..1.0)), BESIDE);
        assert_eq!(beside(&(1.0e6..1.0004e6)), BESIDE + 3 * SIGN, "`1.00005e6` has three signs more");
        assert_eq!((along(&(0.0..10.0), WIDTH / 2), along(&(1.0e6..1.0004e6), WIDTH / 2)), (9, 4));
    }

    #[test]
    fn the_frame_cuts_no_name_of_a_map() {
        let frame = ((100, 100), (1000, 900));
        assert_eq!(within((500, 500), (20, -30), (200, 50), frame), (20, -30), "there is room");
        assert_eq!(within((980, 110), (20, -30), (200, 50), frame), (-220, 30), "above and to the right there is none");
        let shape = |kind, name: &str, points: &[(f64, f64)]| Shape {
            kind,
            name: name.to_owned(),
            of: None,
            points: points.to_vec(),
        };
        let panel = Panel {
            equal: true,
            lines: vec![Line { points: vec![(0.0, 0.0), (10.0, 10.0)], times: vec![0.0, 1.0], ..Line::default() }],
            shapes: vec![
                shape(Kind::Place, "a landing place with a long name", &[(10.0, 10.0)]),
                shape(Kind::Area, "an area with a long name", &[(9.5, 4.0), (10.5, 4.0), (10.5, 5.0), (9.5, 4.0)]),
            ],
            ..Panel::default()
        };
        let picture = svg("title", "sentence", &[panel]).expect("a picture");
        for name in ["a landing place with a long name", "an area with a long name"] {
            let before = picture.split(name).next().and_then(|before| before.rsplit("<text x=\"").next());
            let x: u32 = before.and_then(|text| text.split('"').next()).and_then(|x| x.parse().ok()).expect("a place");
            let (width, _) = font(200).box_size(name).expect("a width");
            assert!(x + width < WIDTH - 400, "{name} ends at {}", x + width);
        }
    }
}
