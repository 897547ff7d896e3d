//! What moves where, and what it passes: the drawing beneath the tracks.

use serde::{Deserialize, Serialize};

use super::numbers;

/// Positions, and what stands in their space. All numbers are in the units of the coordinates.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Scene {
    /// Two or three coordinates.
    pub axes: Vec<Coordinate>,
    /// Which of them points up; none where that is unknown.
    pub up: Option<usize>,
    /// What moves.
    pub tracks: Vec<Moving>,
    /// Points that have a name.
    pub places: Vec<Place>,
    /// Limits that are lines in the plane of the coordinates that do not point up; in the plane of both where there are
    /// two.
    pub outlines: Vec<Outline>,
    /// Lines in the same plane along which a named expression that depends on the place alone has a value.
    pub levels: Vec<Level>,
    /// Limits that are heights over that plane.
    pub surfaces: Vec<Surface>,
    /// Limits that are balls and ellipsoids.
    pub balls: Vec<Ball>,
}

/// A coordinate of positions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Coordinate {
    /// Its name without agent: `x`, `r[1]`.
    pub name: String,
    /// The unit's symbol.
    pub unit: String,
}

/// Something that moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Moving {
    /// What it is called: `uav[2]`, `[3]`; empty where it is alone.
    pub name: String,
    /// The path of each coordinate among outputs and named expressions.
    pub paths: Vec<String>,
}

/// A point with a name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Place {
    /// The name of the parameters or of the distance that tell it.
    pub name: String,
    /// Its coordinates; NaN for one that is not told.
    #[serde(with = "numbers::many")]
    pub at: Vec<f64>,
}

/// A limit in the plane.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Outline {
    /// The constraint.
    pub name: String,
    /// Whether its inside is forbidden. Otherwise its lines are borders.
    pub keep_out: bool,
    /// Whether it is the ground of a view from the side.
    pub ground: bool,
    /// Points that are joined; the first one again at the end of what is closed.
    pub lines: Vec<Vec<[f64; 2]>>,
}

/// Lines along which a function of the place has one value.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Level {
    /// The named expression.
    pub name: String,
    /// Its value there, in its unit.
    pub value: f64,
    /// Points that are joined.
    pub lines: Vec<Vec<[f64; 2]>>,
}

/// A height at each point of a rectangular grid.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Surface {
    /// The constraint.
    pub name: String,
    /// Whether what is beneath is forbidden; otherwise what is above.
    pub floor: bool,
    /// Whether it stands above a ground that is drawn by itself, so that it is a limit and no ground.
    pub clearance: bool,
    /// Grid lines of the first coordinate of the plane,
    pub x: Vec<f64>,
    /// and of the second one.
    pub y: Vec<f64>,
    /// Heights, the second coordinate running fastest; NaN where there is none.
    #[serde(with = "numbers::many")]
    pub z: Vec<f64>,
}

/// An ellipsoid.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Ball {
    /// The constraint.
    pub name: String,
    /// Whether its inside is forbidden.
    pub keep_out: bool,
    /// Its centre.
    pub centre: [f64; 3],
    /// The three half axes, as vectors.
    pub half_axes: [[f64; 3]; 3],
}

impl Surface {
    /// Whether it is drawn as ground.
    pub fn is_ground(&self) -> bool {
        self.floor && !self.clearance
    }
}

impl Scene {
    /// Whether there is anything to draw.
    pub fn is_empty(&self) -> bool {
        self.tracks.is_empty()
    }

    /// The coordinates that span the plane of a map.
    pub fn plane(&self) -> [usize; 2] {
        match (self.axes.len(), self.up) {
            (3, Some(0)) => [1, 2],
            (3, Some(1)) => [0, 2],
            _ => [0, 1],
        }
    }
}
