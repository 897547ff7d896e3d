//! Poses on the lattice: where a vehicle is and how it moves, for many moves at once.
//!
//! Most functions see only a part of a pose: a speed limit its velocity, a distance its position. Poses
//! that agree in that part are one to them, so they are evaluated once for all of those
//! ([`Poses::classes`]): of a turn, what does not depend on the acceleration is the same for all seven.

use super::grid::{Grid, HEADINGS, TURNS};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// Where a vehicle is and how it moves, in real time, SI.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) position: [f64; 2],
    pub(super) velocity: [f64; 2],
    pub(super) acceleration: [f64; 2],
}

impl Pose {
    /// The parts of a pose, by their order of derivative.
    const PARTS: usize = 3;

    /// One coordinate of a derivative; those of higher order are not known, and taken for 0.
    pub(super) fn at(&self, axis: usize, derivative: usize) -> f64 {
        match derivative {
            0 => self.position[axis],
            1 => self.velocity[axis],
            2 => self.acceleration[axis],
            _ => 0.0,
        }
    }

    /// What a function with these uses knows of it.
    fn seen(&self, uses: Uses) -> [[u64; 2]; Self::PARTS] {
        let part = |derivative| [0, 1].map(|axis| self.at(axis, derivative).to_bits());
        std::array::from_fn(|derivative| if uses.0[derivative] { part(derivative) } else { [0; 2] })
    }
}

/// Which parts of a pose a function depends on: its position, its velocity, its acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Uses([bool; Pose::PARTS]);

impl Uses {
    /// A function that depends on a derivative depends on that part.
    pub(super) fn add(&mut self, derivative: usize) {
        if let Some(part) = self.0.get_mut(derivative) {
            *part = true;
        }
    }

    fn number(self) -> usize {
        self.0.iter().rev().fold(0, |number, used| 2 * number + usize::from(*used))
    }
}

/// Poses that a function can tell apart.
#[derive(Debug)]
pub(super) struct Classes {
    /// The first pose of each class.
    pub(super) first: Vec<u32>,
    /// The class of each pose.
    pub(super) of: Vec<u32>,
}

/// Poses, and their classes as far as they have been asked for.
#[derive(Clone, Debug)]
pub(super) struct Poses {
    all: Vec<Pose>,
    /// One entry for each set of uses. They do not depend on the speed.
    classes: Arc<[OnceLock<Classes>; 1 << Pose::PARTS]>,
}

impl Poses {
    fn new(all: Vec<Pose>) -> Self {
        Self { all, classes: Arc::default() }
    }

    /// Straight on, from every so many cells, with every heading, at speed 1.
    pub(super) fn straight(grid: &Grid, every: usize) -> Self {
        let cells = (0..grid.cells()).step_by(every.max(1));
        let pose = |cell: usize, heading: usize| Pose {
            position: grid.position(cell),
            velocity: grid.vector(heading).map(|v| v / grid.length(heading)),
            acceleration: [0.0; 2],
        };
        Self::new(cells.flat_map(|cell| (0..HEADINGS).map(move |heading| pose(cell, heading))).collect())
    }

    /// The middle of every move after every turn, at speed 1: `(cell * HEADINGS + heading) * TURNS + turn`.
    pub(super) fn moves(grid: &Grid) -> Self {
        let mut all = Vec::with_capacity(grid.cells() * HEADINGS * TURNS);
        for cell in 0..grid.cells() {
            let from = grid.position(cell);
            for heading in 0..HEADINGS {
                let vector = grid.vector(heading);
                let position = [from[0] + 0.5 * vector[0], from[1] + 0.5 * vector[1]];
                let velocity = vector.map(|v| v / grid.length(heading));
                for turn in 0..TURNS {
                    let curvature = grid.curvature(heading, turn);
                    let acceleration = [-velocity[1] * curvature, velocity[0] * curvature];
                    all.push(Pose { position, velocity, acceleration });
                }
            }
        }
        Self::new(all)
    }

    /// The same at another speed: all times pass faster by that factor.
    pub(super) fn at_speed(&self, speed: f64) -> Self {
        let faster = |pose: &Pose| Pose {
            position: pose.position,
            velocity: pose.velocity.map(|v| v * speed),
            acceleration: pose.acceleration.map(|a| a * speed * speed),
        };
        Self { all: self.all.iter().map(faster).collect(), classes: Arc::clone(&self.classes) }
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// Some of the poses, by number.
    pub(super) fn of(&self, numbers: &[u32]) -> Vec<Pose> {
        numbers.iter().map(|number| self.all[*number as usize]).collect()
    }

    /// Which poses a function with these uses can tell apart.
    pub(super) fn classes(&self, uses: Uses) -> &Classes {
        self.classes[uses.number()].get_or_init(|| {
            if uses == Uses([true; Pose::PARTS]) {
                // What sees everything hardly ever sees the same again.
                let each: Vec<u32> = (0..).take(self.all.len()).collect();
                return Classes { first: each.clone(), of: each };
            }
            let (mut known, mut first, mut of) = (HashMap::new(), vec![], Vec::with_capacity(self.all.len()));
            for (number, pose) in (0..).zip(&self.all) {
                let class = *known.entry(pose.seen(uses)).or_insert_with(|| {
                    first.push(number);
                    first.len() as u32 - 1
                });
                of.push(class);
            }
            Classes { first, of }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn poses() -> Poses {
        let pose = |x: f64, v: f64, a: f64| Pose { position: [x, 0.0], velocity: [0.0, v], acceleration: [a, a] };
        let all = [0.0, 1.0].iter().flat_map(|x| [(1.0, 2.0), (1.0, 3.0), (4.0, 2.0)].map(|(v, a)| pose(*x, v, a)));
        Poses::new(all.collect())
    }

    fn uses(parts: &[usize]) -> Uses {
        let mut uses = Uses::default();
        parts.iter().for_each(|part| uses.add(*part));
        uses
    }

    #[test]
    fn poses_are_one_where_they_agree_in_what_is_seen() {
        let poses = poses();
        let of = |parts: &[usize]| poses.classes(uses(parts)).of.clone();
        assert_eq!(of(&[]), [0; 6]);
        assert_eq!(of(&[0]), [0, 0, 0, 1, 1, 1]);
        assert_eq!(of(&[1]), [0, 0, 1, 0, 0, 1]);
        assert_eq!(of(&[1, 2]), [0, 1, 2, 0, 1, 2]);
        assert_eq!(of(&[0, 1, 2]), [0, 1, 2, 3, 4, 5]);
        assert_eq!(of(&[3]), [0; 6], "higher derivatives are the same for all");
        assert_eq!(poses.classes(uses(&[2])).first, [0, 1]);
    }

    #[test]
    fn at_twice_the_speed_the_same_turn_has_four_times_the_acceleration() {
        let fast = poses().at_speed(2.0);
        let pose = fast.of(&[4])[0];
        assert_eq!((pose.at(0, 0), pose.at(1, 1), pose.at(0, 2), pose.at(0, 3)), (1.0, 2.0, 12.0, 0.0));
        assert_eq!(fast.len(), 6);
    }
}
