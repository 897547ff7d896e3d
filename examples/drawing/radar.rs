//! The radar of the paper, apart from any spec: its two tables, and the model that is flown.
//!
//! Written a second time, in plain Rust, so that the pictures' backgrounds do not depend on the
//! specs; docs/maths.md, section 10, says how the model follows from the tables.
//! Lengths in km, angles in degrees.

/// Altitude of the flight above the radar, km.
pub(crate) const ALTITUDE: f64 = 12.0;

/// Elevations of Table 1, degrees.
pub(crate) const ELEVATIONS: [f64; 4] = [0.0, 20.0, 45.0, 90.0];
/// Azimuths of Table 1, degrees.
pub(crate) const AZIMUTHS: [f64; 4] = [0.0, 30.0, 31.0, 180.0];
/// Table 1: signatures, a row for each elevation.
pub(crate) const SIGNATURES: [[f64; 4]; 4] =
    [[1.5, 1.5, 5.5, 5.5], [2.5, 2.5, 5.5, 5.5], [3.5, 3.5, 6.0, 6.0], [6.5, 6.5, 6.5, 6.5]];

/// Probabilities of Table 2.
pub(crate) const PROBABILITIES: [f64; 4] = [0.99, 0.5, 0.1, 0.01];
/// Table 2: a signature, and the slant range in km for each probability.
pub(crate) const RANGES: [(f64, [f64; 4]); 7] = [
    (7.0, [380.1, 481.2, 555.6, 656.6]),
    (6.0, [213.7, 270.6, 312.5, 369.2]),
    (5.0, [120.2, 152.2, 175.7, 207.6]),
    (4.0, [67.6, 85.6, 98.8, 116.8]),
    (3.0, [38.0, 48.1, 55.6, 65.7]),
    (2.0, [21.4, 27.1, 31.2, 36.9]),
    (1.0, [12.0, 15.2, 17.6, 20.8]),
];

/// Table 1 with straight lines between its nodes.
pub(crate) fn table_1(elevation: f64, azimuth: f64) -> f64 {
    let (i, u) = cell(&ELEVATIONS, elevation.abs());
    let (j, v) = cell(&AZIMUTHS, azimuth.abs());
    let along = |row: &[f64; 4]| row[j] * (1.0 - v) + row[j + 1] * v;
    along(&SIGNATURES[i]) * (1.0 - u) + along(&SIGNATURES[i + 1]) * u
}

fn cell(nodes: &[f64; 4], x: f64) -> (usize, f64) {
    let i = nodes[1..3].partition_point(|node| *node <= x);
    (i, ((x - nodes[i]) / (nodes[i + 1] - nodes[i])).clamp(0.0, 1.0))
}

fn logistic(u: f64) -> f64 {
    1.0 / (1.0 + (-u).exp())
}

/// The signature that is flown: the cubic through the nose-in column, blended over one degree
/// of azimuth with a smooth nose-out column.
pub(crate) fn signature(elevation: f64, azimuth: f64) -> f64 {
    let nose_in: f64 = (0..4).map(|i| SIGNATURES[i][0] * lagrange(i, elevation)).sum();
    let nose_out = 5.5 + logistic((elevation - 45.0) / 6.0);
    nose_in + (nose_out - nose_in) * (logistic(azimuth - 30.5) + logistic(-azimuth - 30.5))
}

fn lagrange(i: usize, x: f64) -> f64 {
    let others = (0..4).filter(|j| *j != i);
    others.map(|j| (x - ELEVATIONS[j]) / (ELEVATIONS[i] - ELEVATIONS[j])).product()
}

/// The probability of detection at a slant range: the radar equation.
pub(crate) fn detection(slant: f64, signature: f64) -> f64 {
    logistic(-(slant.ln() - 10.0_f64.ln() / 4.0 * signature - 2.1477) / 0.0634)
}

/// The probability of detection at a ground range and an azimuth, at the flown altitude.
pub(crate) fn detection_over_ground(ground: f64, azimuth: f64) -> f64 {
    detection(ground.hypot(ALTITUDE), signature(ALTITUDE.atan2(ground).to_degrees(), azimuth))
}
