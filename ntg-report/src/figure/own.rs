//! What several runs pass: what all of them have, and what is one's own.
//!
//! Takes the scenes of runs; gives one of what is the same in all of them, and one for each run of the rest, whose names
//! tell the run.

use super::{Runs, ground, label};
use crate::run::{Ball, Outline, Place, Scene, Surface};

/// Differences up to this part of a size are none: rounding.
const SAME: f64 = 1e-9;
/// Differences up to this part of what a surface or a line spans are none: each run has a grid of its own for them.
const DRAWN: f64 = 0.02;

/// The scene that is drawn for all runs, and what each run has beside it; none where no run has a scene. Scenes in other
/// coordinates than the first are left out.
pub(super) fn split(runs: &Runs<'_>) -> Option<(Scene, Vec<(usize, Scene)>)> {
    let all = runs.iter().enumerate().map(|(run, (_, found))| (run, &found.scene));
    let all: Vec<(usize, &Scene)> = all.filter(|(_, scene)| !scene.is_empty()).collect();
    let (_, first) = *all.first()?;
    let alike = all.iter().copied().filter(|(_, scene)| scene.axes == first.axes && scene.up == first.up);
    let (numbers, scenes): (Vec<usize>, Vec<&Scene>) = alike.unzip();
    let (places, own_places) = shared(&scenes, |scene| &scene.places, is_same_place);
    let (outlines, own_outlines) = shared(&scenes, |scene| &scene.outlines, is_same_outline);
    let (surfaces, own_surfaces) = shared(&scenes, |scene| &scene.surfaces, is_same_surface);
    let (balls, own_balls) = shared(&scenes, |scene| &scene.balls, is_same_ball);
    let common = Scene { places, outlines, surfaces, balls, ..first.clone() };
    let mut own: Vec<(usize, Scene)> = vec![];
    let rests = own_places.into_iter().zip(own_outlines).zip(own_surfaces.into_iter().zip(own_balls));
    for (run, ((places, outlines), (surfaces, balls))) in numbers.into_iter().zip(rests) {
        let scene = Scene { places, outlines, surfaces, balls, levels: vec![], ..first.clone() };
        own.push((run, named(runs, run, scene)));
    }
    Some((common, own))
}

/// The names of a scene with that of its run.
fn named(runs: &Runs<'_>, run: usize, mut scene: Scene) -> Scene {
    let names = scene.places.iter_mut().map(|place| &mut place.name);
    let names = names.chain(scene.outlines.iter_mut().map(|outline| &mut outline.name));
    let names = names.chain(scene.surfaces.iter_mut().map(|surface| &mut surface.name));
    let names = names.chain(scene.balls.iter_mut().map(|ball| &mut ball.name));
    names.for_each(|name| *name = label(runs, run, name));
    scene
}

/// What all scenes have, and for each what the others have not.
fn shared<T: Clone>(
    scenes: &[&Scene],
    of: impl Fn(&Scene) -> &Vec<T>,
    same: impl Fn(&T, &T) -> bool,
) -> (Vec<T>, Vec<Vec<T>>) {
    let everywhere = |item: &&T| scenes.iter().all(|scene| of(scene).iter().any(|other| same(item, other)));
    let common: Vec<T> = scenes.first().map_or(vec![], |first| of(first).iter().filter(everywhere).cloned().collect());
    let rest =
        |scene: &&Scene| of(scene).iter().filter(|item| !common.iter().any(|c| same(c, item))).cloned().collect();
    let own = scenes.iter().map(rest).collect();
    (common, own)
}

fn is_near(a: f64, b: f64, size: f64) -> bool {
    (a.is_nan() && b.is_nan()) || (a - b).abs() <= SAME * size.max(a.abs()).max(b.abs())
}

fn is_same_place(one: &Place, other: &Place) -> bool {
    let size = one.at.iter().filter(|value| value.is_finite()).fold(0.0_f64, |size, value| size.max(value.abs()));
    one.name == other.name
        && one.at.len() == other.at.len()
        && one.at.iter().zip(&other.at).all(|(a, b)| is_near(*a, *b, size))
}

fn is_same_ball(one: &Ball, other: &Ball) -> bool {
    let numbers =
        |ball: &Ball| -> Vec<f64> { ball.centre.iter().chain(ball.half_axes.iter().flatten()).copied().collect() };
    let (a, b) = (numbers(one), numbers(other));
    let size = a.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    one.name == other.name && one.keep_out == other.keep_out && a.iter().zip(&b).all(|(a, b)| is_near(*a, *b, size))
}

/// Where both surfaces are, they are as high.
fn is_same_surface(one: &Surface, other: &Surface) -> bool {
    let finite = || one.z.iter().copied().filter(|z| z.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
    let room = DRAWN * (high - low).max(SAME * low.abs().max(high.abs()));
    let at = |i: usize| (other.x[i / other.y.len()], other.y[i % other.y.len()]);
    let heights = other.z.iter().enumerate().map(|(i, z)| (ground::height(one, at(i).0, at(i).1), *z));
    let mut both = heights.filter(|(a, b)| a.is_finite() && b.is_finite()).peekable();
    one.name == other.name
        && one.floor == other.floor
        && both.peek().is_some()
        && both.all(|(a, b)| (a - b).abs() <= room)
}

/// Where both lines are, they are one.
fn is_same_outline(one: &Outline, other: &Outline) -> bool {
    let alike = (&one.name, one.keep_out, one.ground) == (&other.name, other.keep_out, other.ground);
    alike && covers(one, other) && covers(other, one)
}

/// Whether the points of a line that lie in the rectangle of another lie on it.
fn covers(one: &Outline, other: &Outline) -> bool {
    let empty = [(f64::INFINITY, f64::NEG_INFINITY); 2];
    let ends =
        one.lines.iter().flatten().fold(empty, |ends, at| [0, 1].map(|k| (ends[k].0.min(at[k]), ends[k].1.max(at[k]))));
    let room = DRAWN * ends.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    let within = |at: &&[f64; 2]| (0..2).all(|k| ends[k].0 <= at[k] && at[k] <= ends[k].1);
    let mut points = other.lines.iter().flatten().filter(within).peekable();
    let on =
        |at: &[f64; 2]| one.lines.iter().flat_map(|line| line.windows(2)).any(|w| distance(at, &w[0], &w[1]) <= room);
    points.peek().is_some() && points.all(on)
}

/// How far a point is from a segment.
fn distance(at: &[f64; 2], from: &[f64; 2], to: &[f64; 2]) -> f64 {
    let (along, off) = ([to[0] - from[0], to[1] - from[1]], [at[0] - from[0], at[1] - from[1]]);
    let length = along[0] * along[0] + along[1] * along[1];
    let share = if length > 0.0 { ((along[0] * off[0] + along[1] * off[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
    (off[0] - share * along[0]).hypot(off[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{Moving, Run};

    fn ball(radius: f64) -> Ball {
        let half_axes = [[radius, 0.0, 0.0], [0.0, radius, 0.0], [0.0, 0.0, radius]];
        Ball { name: "clear".to_owned(), keep_out: true, centre: [1.0, 2.0, 3.0], half_axes }
    }

    fn run(radius: f64) -> Run {
        let place = Place { name: "hill".to_owned(), at: vec![1.0, 2.0, f64::NAN] };
        let scene = Scene {
            tracks: vec![Moving::default()],
            places: vec![place],
            balls: vec![ball(radius)],
            ..Scene::default()
        };
        Run { scene, ..Run::default() }
    }

    #[test]
    fn what_differs_from_run_to_run_is_each_ones_own_and_has_its_name() {
        let (near, far) = (run(680.0), run(500.0));
        let (common, own) = split(&[("a".to_owned(), &near), ("b".to_owned(), &far)]).expect("scenes");
        assert_eq!((common.places.len(), common.balls.len()), (1, 0));
        let names: Vec<(usize, &str)> = own.iter().map(|(run, scene)| (*run, scene.balls[0].name.as_str())).collect();
        assert_eq!(names, [(0, "clear (a)"), (1, "clear (b)")]);
        assert!(own.iter().all(|(_, scene)| scene.places.is_empty()));
        let (common, own) = split(&[("a".to_owned(), &near), ("b".to_owned(), &near)]).expect("scenes");
        assert_eq!((common.balls.len(), own.iter().all(|(_, scene)| scene.balls.is_empty())), (1, true));
    }

    #[test]
    fn lines_and_surfaces_on_other_grids_are_the_same_and_others_are_not() {
        let circle = |radius: f64, count: usize| {
            let at = |k: usize| 2.0 * std::f64::consts::PI * k as f64 / count as f64;
            let line = (0..=count).map(|k| [radius * at(k).cos(), radius * at(k).sin()]).collect();
            Outline { lines: vec![line], ..Outline::default() }
        };
        assert!(is_same_outline(&circle(1.0, 40), &circle(1.0, 63)));
        assert!(!is_same_outline(&circle(1.0, 40), &circle(1.1, 40)));
        let slope = |lift: f64, x: &[f64]| {
            let z = x.iter().flat_map(|x| [2.0 * x + lift, 2.0 * x + lift]).collect();
            Surface { x: x.to_vec(), y: vec![0.0, 1.0], z, ..Surface::default() }
        };
        assert!(is_same_surface(&slope(0.0, &[0.0, 1.0, 2.0]), &slope(0.0, &[0.5, 1.5, 2.5])));
        assert!(!is_same_surface(&slope(0.0, &[0.0, 1.0, 2.0]), &slope(1.0, &[0.5, 1.5, 2.5])));
    }
}
