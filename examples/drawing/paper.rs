//! The paper's figures 3 to 8, and how well the flown model fits its tables.
//!
//! The tables are all the data there is; where a figure needs a choice that the paper does not
//! state (the routes of figure 4, the knots of figure 6), the picture says what was chosen.

use std::path::Path;

use ntg::runtime::splines::{Axis, Extrapolation, Method, Table};
use plotters::prelude::*;

use super::chart::{Axes, Line, Stroke, axes, draw, legend};
use super::heat::{Scale, bar, diverging, fill, viridis};
use super::radar::{self, PROBABILITIES, RANGES, detection, detection_over_ground, signature, table_1};
use super::{BLUE, Drawn, GREEN, INK, PURPLE, VERMILION, picture, text};

/// Draws all of them into a folder.
pub(crate) fn figures(folder: &Path) -> Drawn {
    detection_over_range(&folder.join("paper_3_detection_over_range.svg"))?;
    path_dependence(&folder.join("paper_4_path_dependence.svg"))?;
    let fit = tensor_product_fit()?;
    let paper = |elevation: f64, azimuth: f64| fit.eval(&[elevation, azimuth], &[0, 0]);
    surface(
        &folder.join("paper_5_signature_table.svg"),
        "Figure 5: the signature of Table 1",
        "Low where the radar sees the nose (azimuth within 30 degrees), with a cliff beside it. Dots: the table (flat beyond 90).",
        Scale::even("signature", 1.0..7.0, 12, viridis),
        table_1,
    )?;
    surface(
        &folder.join("paper_6_signature_fit.svg"),
        "Figure 6: Table 1 as a least-squares tensor-product B-spline",
        "Order 4, 3 knot intervals in elevation, 16 in azimuth: the cliff is smeared, and waves run out from it.",
        Scale::even("signature", 1.0..7.0, 12, viridis),
        paper,
    )?;
    surface(
        &folder.join("paper_7_signature_fit_error.svg"),
        "Figure 7: error of that fit",
        "Fit minus table. An optimiser would fly in the troughs, which are not there: so this fit is not flown.",
        Scale::even("fit - table", -2.2..2.2, 11, diverging),
        |elevation, azimuth| paper(elevation, azimuth) - table_1(elevation, azimuth),
    )?;
    slices(&folder.join("signature_table_fit_and_model.svg"), paper)?;
    detection_surface(&folder.join("paper_8_detection_table.svg"))?;
    detection_fit(&folder.join("detection_fit.svg"))
}

/// Table 1, sampled along straight lines between its nodes and fitted as the paper did.
fn tensor_product_fit() -> Drawn<Table> {
    let elevations: Vec<f64> = (0..=18).map(|i| 5.0 * f64::from(i)).collect();
    let azimuths: Vec<f64> = (0..=180).map(f64::from).collect();
    let values = elevations.iter().flat_map(|el| azimuths.iter().map(|az| table_1(*el, *az))).collect();
    let axes = vec![Axis::even(elevations), Axis::even(azimuths)];
    let method = Method::Fit { order: 4, intervals: vec![3, 16] };
    Ok(Table::new(axes, values, method, Extrapolation::Clamp)?)
}

fn detection_over_range(path: &Path) -> Drawn {
    let area = picture(
        path,
        800,
        "Figure 3: how far away a radar sees the aircraft",
        "Pointed at the radar (\"nose-in\"), it is hidden until about 35 km; turned away, it is seen at 200 km.",
    )?;
    let over = 0.0..300.0;
    let lines = [
        Line::graph("nose-in (azimuth 0)", (BLUE, Stroke::Solid), over.clone(), |r| detection_over_ground(r, 0.0)),
        Line::graph("nose-out (azimuth 180 deg)", (VERMILION, Stroke::Dashed), over.clone(), |r| {
            detection_over_ground(r, 180.0)
        }),
    ];
    let area = legend(&area, &lines)?;
    let labels = Axes::new(("ground range at 12 km altitude [km]", over), ("probability of detection", 0.0..1.05));
    draw(&mut axes(&area, labels)?, &lines)
}

/// Where the paper's two example paths go, km: straight in, and in segments.
const STRAIGHT: [(f64, f64); 2] = [(-100.0, -100.0), (0.0, 0.0)];
const SEGMENTS: [(f64, f64); 5] = [(-100.0, -100.0), (-40.0, -100.0), (-30.0, -75.0), (-30.0, -30.0), (0.0, 0.0)];

fn path_dependence(path: &Path) -> Drawn {
    let area = picture(
        path,
        800,
        "Figure 4: what is seen depends on the path, not only on the place",
        "Left: two routes to the radar at (0, 0). Right: each turn across 30 degrees of azimuth is a jump. (Way-points are ours.)",
    )?;
    let names = [("straight in", BLUE, Stroke::Solid), ("in segments", VERMILION, Stroke::Dashed)];
    let [straight, segments] = names.map(|(name, colour, stroke)| Line::new(name, colour, stroke, vec![]));
    let along = |look: &Line, points: Vec<(f64, f64)>| Line { points, ..look.clone() };
    let tracks = [along(&straight, STRAIGHT.to_vec()), along(&segments, SEGMENTS.to_vec())];
    let seen = [along(&straight, detection_along(&STRAIGHT)), along(&segments, detection_along(&SEGMENTS))];
    let (left, right) = legend(&area, &tracks)?.split_horizontally(700);
    let ground = Axes::new(("east [km]", -110.0..10.0), ("north [km]", -110.0..10.0));
    draw(&mut axes(&left, ground)?, &tracks)?;
    let flown = Axes::new(("distance flown [km]", 0.0..190.0), ("probability of detection", 0.0..1.05));
    draw(&mut axes(&right, flown)?, &seen)
}

/// Distance flown and probability of detection along a polygon, every 0.5 km.
fn detection_along(route: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut flown = 0.0;
    let mut points = vec![];
    for leg in route.windows(2) {
        let ((x0, y0), (dx, dy)) = (leg[0], (leg[1].0 - leg[0].0, leg[1].1 - leg[0].1));
        let length = dx.hypot(dy);
        let steps = (2.0 * length).ceil();
        for i in 0..steps as i32 {
            let share = f64::from(i) / steps;
            let (x, y) = (x0 + share * dx, y0 + share * dy);
            let azimuth = (x * dy - y * dx).atan2(-(x * dx + y * dy)).to_degrees();
            points.push((flown + share * length, detection_over_ground(x.hypot(y), azimuth)));
        }
        flown += length;
    }
    points
}

/// A function of elevation and azimuth as a heat map with the nodes of Table 1.
fn surface(path: &Path, title: &str, sentence: &str, scale: Scale, f: impl Fn(f64, f64) -> f64) -> Drawn {
    let area = bar(&picture(path, 800, title, sentence)?, &scale)?;
    let labels = Axes::new(("azimuth [deg]", -90.0..90.0), ("elevation [deg]", 0.0..90.0));
    let mut chart = axes(&area, labels)?;
    fill(&mut chart, &scale, |azimuth, elevation| f(elevation, azimuth))?;
    let azimuths = radar::AZIMUTHS[..3].iter().flat_map(|az| [-az, *az]);
    let nodes = azimuths.flat_map(|az| radar::ELEVATIONS.map(|el| (az, el)));
    chart.draw_series(nodes.map(|node| Circle::new(node, 5, INK.filled())))?;
    Ok(())
}

/// Table 1, the paper's fit and the flown model at two elevations.
fn slices(path: &Path, fit: impl Fn(f64, f64) -> f64) -> Drawn {
    let area = picture(
        path,
        1350,
        "Signature over azimuth: table, fit, and the model that is flown",
        "The fit errs by up to 2 and dips below the table's lowest value; the model departs from it only at the jump.",
    )?;
    let over = 0.0..90.0;
    let at = |elevation: f64| {
        let nodes = radar::AZIMUTHS[..3].iter().map(|azimuth| (*azimuth, table_1(elevation, *azimuth)));
        [
            Line::graph("least-squares B-spline", (VERMILION, Stroke::Dashed), over.clone(), |az| fit(elevation, az)),
            Line::graph("model that is flown", (BLUE, Stroke::Solid), over.clone(), |az| signature(elevation, az)),
            Line::new("Table 1", INK, Stroke::Dots, nodes.collect()),
        ]
    };
    let area = legend(&area, &at(0.0))?;
    for (panel, elevation) in area.split_evenly((2, 1)).iter().zip([0.0, 45.0]) {
        let y = format!("signature at elevation {elevation}");
        let labels = Axes::new(("azimuth [deg]", over.clone()), (&y, 0.0..7.0));
        draw(&mut axes(panel, labels)?, &at(elevation))?;
    }
    Ok(())
}

fn detection_surface(path: &Path) -> Drawn {
    let edges = vec![0.0, 0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99, 1.0];
    let scale = Scale { name: "probability", edges, palette: viridis };
    let title = "Figure 8: probability of detection over range and signature";
    let sentence = "One unit more of signature makes the aircraft visible 1.78 times as far. Dots: Table 2.";
    let area = bar(&picture(path, 800, title, sentence)?, &scale)?;
    let labels = Axes::new(("slant range [km]", 0.0..700.0), ("signature", 0.5..7.5));
    let mut chart = axes(&area, labels)?;
    fill(&mut chart, &scale, detection)?;
    let nodes = RANGES.iter().flat_map(|(signature, ranges)| ranges.map(|range| (range, *signature)));
    let dots = nodes.map(|node| Circle::new(node, 6, WHITE.filled()));
    chart.draw_series(dots)?;
    let rings = RANGES.iter().flat_map(|(signature, ranges)| ranges.map(|range| (range, *signature)));
    chart.draw_series(rings.map(|node| Circle::new(node, 6, INK.stroke_width(2))))?;
    Ok(())
}

/// The radar equation through Table 2, and what it misses by.
fn detection_fit(path: &Path) -> Drawn {
    let area = picture(
        path,
        1350,
        "Table 2 is the radar equation",
        "Pd = 1 / (1 + exp((ln R - (ln 10 / 4) signature - 2.1477) / 0.0634)) for all seven rows at once.",
    )?;
    let (upper, lower) = area.split_vertically(720);
    let mut labels = Axes::new(("slant range [km]", (10.0..700.0).log_scale()), ("probability", 0.0..1.09));
    labels.numbers =
        |x| if [10.0, 20.0, 50.0, 100.0, 200.0, 500.0].contains(&x) { x.to_string() } else { String::new() };
    let mut chart = axes(&upper, labels)?;
    for (row, (signature, ranges)) in RANGES.iter().enumerate() {
        let colour = [BLUE, VERMILION, GREEN, PURPLE][row % 4];
        let curve = (0..300).map(|i| 10.0 * 70.0_f64.powf(f64::from(i) / 299.0));
        let points = curve.map(|range| (range, detection(range, *signature))).collect();
        let nodes = ranges.iter().copied().zip(PROBABILITIES).collect();
        let lines = [Line::new("", colour, Stroke::Solid, points), Line::new("", colour, Stroke::Dots, nodes)];
        draw(&mut chart, &lines)?;
        let name = Text::new(format!("signature {signature}"), (-80, -42), text(25).color(&colour));
        chart.draw_series([EmptyElement::at((ranges[0], 0.99)) + name])?;
    }
    residuals(&lower)
}

fn residuals(area: &super::Area<'_>) -> Drawn {
    let labels = Axes::new(("signature", 0.5..7.5), ("formula - table", -0.02..0.02));
    let looks = [BLUE, VERMILION, GREEN, PURPLE];
    let lines: Vec<Line> = (0..4)
        .map(|i| {
            let miss = |(s, r): &(f64, [f64; 4])| (*s, detection(r[i], *s) - PROBABILITIES[i]);
            let name = format!("at probability {}", PROBABILITIES[i]);
            Line::new(&name, looks[i], Stroke::Dots, RANGES.iter().map(miss).collect())
        })
        .collect();
    let area = legend(area, &lines)?;
    let mut chart = axes(&area, labels)?;
    let zero = Line::new("", INK, Stroke::Solid, vec![(0.5, 0.0), (7.5, 0.0)]);
    draw(&mut chart, &[zero])?;
    draw(&mut chart, &lines)
}
