//! How long free durations are where nobody says it, and the least that they may be (docs/maths.md, section 8.1).
//!
//! Takes bounds, boundary conditions and slopes; gives a guess of each free duration. Of a bound that is far beyond what
//! balances the equations nothing is known but that somebody wrote it.

use super::rows::shortest_duration;
use super::{Transcription, Workspace, defaults};
use ntg_nlp::{Evaluation, Limits, Nlp};

/// A duration from bounds counts unless another one, so many decades away, balances the equations better. A fit: of 141 shipped,
/// gallery and other specs with free durations none is further off.
const FAR: i32 = 2;

/// Of a bound that is so many times what rates tell, too, nothing is known. A choice: in ten time constants all is over.
const FAR_BY_RATES: f64 = 20.0;

/// Where equations tell a duration without an upper bound, its guess is so many times what they tell, and its range so many times.
/// Choices: what they tell is right to a decade, and motions that are too slow are nearer to a solution than those that are too fast.
const TOLD_GUESS: f64 = 2.0;
const TOLD_RANGE: f64 = 20.0;

/// So many decades from the guess by bounds are looked at. A choice: from an age of the world to a vibration of a molecule.
const RANGE: i32 = 24;

/// All is slow with durations of so many times the guess by bounds. A choice: half of the decades that are looked at.
const SLOW: f64 = 1e12;

/// Parts of a decade in which the best duration is looked for.
const PARTS: i32 = 10;

/// Sums of decades that differ by less are equal: rounding.
const EQUAL: f64 = 1e-6;

/// What is the same over so many decades tends to a number. A choice.
const STEADY: i32 = 6;

/// It is near to that number within this part of it. A choice: a motion over such a duration hardly moves, as its guess does, and
/// its duration is felt.
const TENDS: f64 = 0.01;

/// How equations tell a duration.
#[derive(Clone, Copy)]
struct Rule {
    /// By so many decades in sum they have to be balanced better there, and worse beyond.
    better: f64,
    /// Within so many decades they are balanced as well.
    even: f64,
    /// Whether a rate balances what it is proportional to, `x' = -k x`: without, each output counts once in each equation.
    by_rates: bool,
}

/// Choices: two factors of ten, beside rounding; where that tells nothing one, beside a quarter of a term.
const STRICT: Rule = Rule { better: 2.0, even: EQUAL, by_rates: false };
const LOOSE: Rule = Rule { better: 1.0, even: 0.1, by_rates: true };

/// A duration that is a variable.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeDuration {
    pub(crate) variable: u32,
    /// What is guessed where nobody guesses it, SI.
    pub(crate) guess: f64,
    /// Its greatest length as far as anything is known of it: its upper bound, unless that is far from what balances the equations.
    pub(crate) reach: f64,
    /// Whether its least length is the transcription's: no bound above 0 is declared.
    pub(crate) is_guarded: bool,
}

impl FreeDuration {
    /// Whether it ends at the least length that the transcription gives it.
    pub(crate) fn is_least(&self, limits: &Limits, x: &[f64]) -> bool {
        /// Up to this many times the least length it does: the method stays a hair inside of bounds. A choice.
        const NEAR: f64 = 1.01;
        let variable = self.variable as usize;
        self.is_guarded && x.get(variable).is_some_and(|value| *value <= NEAR * limits.lower[variable])
    }
}

/// What is seen with given durations.
#[derive(Clone, Copy)]
pub(super) struct Trial {
    /// How unbalanced the equations are, see [`Transcription::imbalance`].
    pub(super) decades: f64,
    /// The objective of a motion of the size that balances them.
    pub(super) objective: f64,
}

impl Transcription<'_> {
    /// Guesses free durations, and lets those be short whose upper bound is far from what balances the equations. `longest` has
    /// those that others limit, and how long they may be.
    pub(super) fn find_durations(&mut self, longest: &[(u32, f64)]) {
        for (variable, upper) in longest {
            self.limits.lower[*variable as usize] = shortest_duration(*upper);
        }
        let limits = &self.limits;
        let mut durations: Vec<FreeDuration> = vec![];
        for variable in self.model.layout.free_durations() {
            let told = longest.iter().find(|told| told.0 == variable);
            let upper = told.map_or(limits.upper[variable as usize], |told| told.1);
            let lower = limits.lower[variable as usize];
            // The smallest duration of all is a guard, not a bound that anyone wrote.
            let is_guarded = lower == shortest_duration(upper);
            let guess = defaults::duration(if is_guarded { 0.0 } else { lower }, upper);
            durations.push(FreeDuration { variable, guess, reach: upper, is_guarded });
        }
        self.durations = durations;
        let typical = self.typical_duration();
        for i in 0..self.durations.len() {
            let known = self.durations[i];
            let is_open = known.reach.is_infinite();
            let guess = typical.map_or(known.guess, |(typical, _)| self.duration_near(&known, typical));
            let far = if typical.is_some_and(|(_, by_rates)| by_rates) { FAR_BY_RATES } else { 10f64.powi(FAR) };
            let is_far = |bound: f64| bound > far * guess;
            if guess == known.guess && !is_open || !is_far(known.reach) {
                continue;
            }
            if known.is_guarded {
                self.limits.lower[known.variable as usize] = shortest_duration(2.0 * guess);
            }
            let (guess, reach) = match (is_open, typical.is_some()) {
                (false, _) => (guess, 2.0 * guess),
                (true, false) => (guess, 10f64.powi(FAR) * guess),
                (true, true) => (TOLD_GUESS * guess, TOLD_RANGE * guess),
            };
            self.durations[i] = FreeDuration { guess, reach, ..known };
        }
    }

    /// How short a duration may be by what somebody wrote.
    fn least(&self, duration: &FreeDuration) -> f64 {
        if duration.is_guarded { 0.0 } else { self.limits.lower[duration.variable as usize] }
    }

    /// What is guessed of a duration where `typical` is the time in which something happens.
    fn duration_near(&self, duration: &FreeDuration, typical: f64) -> f64 {
        let wanted = typical.max(self.least(duration));
        if duration.reach.is_infinite() { wanted } else { wanted.min(duration.guess) }
    }

    /// The time in which something happens, if it is far from what bounds tell; and whether rates tell it.
    fn typical_duration(&self) -> Option<(f64, bool)> {
        let first = self.durations.iter().map(|duration| duration.guess).reduce(f64::max)?;
        let has_room = |duration: &FreeDuration| {
            duration.reach.is_infinite() || duration.guess > 10f64.powi(FAR) * self.least(duration)
        };
        if !self.durations.iter().any(has_room) {
            return None;
        }
        let mut x = vec![0.0; self.model.layout.variables];
        defaults::times(self, &mut x);
        defaults::outputs(self, &mut x);
        for (first, members) in self.model.layout.integral_first.iter().zip(&self.model.layout.integral_members) {
            x[*first as usize..][..members.len()].fill(1.0);
        }
        let (mut work, mut at) = self.workspace();
        let groups = self.output_groups();
        let room = self.room((&mut x, first), (&mut work, &mut at));
        let room = room.unwrap_or_else(|| vec![0.0; self.elements.rows.len()]);
        let is_open = self.durations.iter().any(|duration| duration.reach.is_infinite());
        let mut trial = |rule: Rule, tenths: i32| {
            let typical = first * 10f64.powf(f64::from(tenths) / f64::from(PARTS));
            // Beside one without an upper bound all are as long: phases that meet have rates of one size.
            let own =
                |d: &FreeDuration| if is_open { typical.max(self.least(d)) } else { self.duration_near(d, typical) };
            self.durations.iter().for_each(|d| x[d.variable as usize] = own(d));
            self.imbalance((&x, &groups, &room), rule.by_rates, (&mut work, &mut at))
        };
        let mut by = |rule: Rule, find: Find| find(&mut |tenths| trial(rule, tenths), rule);
        let both_ways: Find = |trial, rule| search((trial, rule), &[-PARTS, PARTS]);
        let downwards: Find = |trial, rule| search((trial, rule), &[-PARTS]);
        let ways = match is_open {
            true => vec![(LOOSE, shortest as Find), (STRICT, both_ways), (LOOSE, both_ways)],
            false => vec![(STRICT, downwards), (LOOSE, downwards)],
        };
        let mut told = ways.into_iter().filter_map(|(rule, find)| Some((by(rule, find)?, rule.by_rates)));
        told.next().map(|(tenths, by_rates)| (first * 10f64.powf(tenths / f64::from(PARTS)), by_rates))
    }

    /// What each limit along the way leaves where all is slow; 0 where that is a matter of how slow, none where something is not
    /// finite then, as what grows with time. `first` is a duration by bounds.
    fn room(&self, (x, first): (&mut [f64], f64), (work, at): (&mut Workspace, &mut Evaluation)) -> Option<Vec<f64>> {
        let mut left = |slow: f64| -> Option<Vec<f64>> {
            self.durations.iter().for_each(|d| x[d.variable as usize] = self.duration_near(d, slow * first));
            self.values(x, work, at).ok()?;
            let limits = self.limits.row_lower.iter().zip(&self.limits.row_upper);
            let rows = self.elements.rows.iter().zip(at.rows.iter().zip(limits));
            let room = rows.map(|(info, (value, (lower, upper)))| match info.point.phase {
                Some(_) => (value - lower).min(upper - value).max(0.0),
                None => 0.0,
            });
            Some(room.collect())
        };
        let (slow, slower) = (left(SLOW)?, left(10.0 * SLOW)?);
        let is_same = |(one, other): (&f64, &f64)| (one - other).abs() < 0.5 * one;
        Some(slow.iter().zip(&slower).map(|own| if is_same(own) { *own.0 } else { 0.0 }).collect())
    }
}

/// What is seen with a duration so many parts of a decade from the guess by bounds.
type Trials<'a> = &'a mut dyn FnMut(i32) -> Option<Trial>;
/// A way to find a duration by a rule.
type Find = fn(Trials<'_>, Rule) -> Option<f64>;

/// Where equations tell how short a duration may be and nothing how long, as limits of speed do: the shortest of those that balance
/// them best, in parts of a decade.
fn shortest(trial: Trials<'_>, rule: Rule) -> Option<f64> {
    let here = trial(0)?.decades;
    let (mut best, mut least) = (0, here);
    // Upwards as long as that is better, else downwards as long as it is as good.
    while best < RANGE * PARTS {
        let there = trial(best + PARTS)?.decades;
        if there >= least - rule.even {
            break;
        }
        (best, least) = (best + PARTS, there);
    }
    let is_good = |there: Trial| (there.decades - least).abs() <= rule.even;
    if !is_good(trial(best + STEADY * PARTS)?) {
        return None;
    }
    let before = loop {
        let there = trial(best - PARTS)?;
        if !is_good(there) {
            break there;
        }
        best -= PARTS;
        if best <= -RANGE * PARTS {
            return None;
        }
    };
    if before.decades < least {
        return None;
    }
    (best - PARTS..=best).find_map(|tenths| trial(tenths).filter(|there| is_good(*there)).map(|_| f64::from(tenths)))
}

/// The best duration in parts of a decade, if it is far from 0: by bounds. `ways` are downwards and, where no bound tells
/// anything, upwards. The sum of decades is convex where all terms are powers of the duration, so that a look a little away
/// tells whether there is anything better.
fn search((trial, rule): (Trials<'_>, Rule), ways: &[i32]) -> Option<f64> {
    let here = trial(0)?;
    let mut found = |way: i32| {
        let near = trial(way * FAR)?;
        match near.decades - here.decades {
            better if better < -EQUAL => balanced((trial, rule), here, way),
            worse if worse > EQUAL => None,
            _ => (near.objective < here.objective).then(|| cheapest(trial, here, way))?,
        }
    };
    ways.iter().find_map(|way| found(*way))
}

/// The middle of all that balance the equations best, if that is by much and not beyond.
fn balanced((trial, rule): (Trials<'_>, Rule), here: Trial, way: i32) -> Option<f64> {
    let (mut best, mut least) = (0, here.decades);
    for decade in FAR..=RANGE {
        let there = trial(way * decade)?.decades;
        if there > least + rule.better {
            break;
        }
        if there < least - EQUAL {
            (best, least) = (decade, there);
        } else if best == 0 || decade == RANGE {
            return None;
        }
    }
    if best == 0 || least > here.decades - rule.better {
        return None;
    }
    let tenths = way * best - PARTS..=way * best + PARTS;
    let found: Vec<(i32, f64)> = tenths.filter_map(|tenths| Some((tenths, trial(tenths)?.decades))).collect();
    let least = found.iter().map(|(_, decades)| *decades).reduce(f64::min)?;
    let good = || found.iter().filter(|(_, decades)| *decades <= least + EQUAL).map(|(tenths, _)| f64::from(*tenths));
    Some(0.5 * (good().reduce(f64::min)? + good().reduce(f64::max)?))
}

/// Of those that balance the equations as `here` does, the one with the lowest objective, if the objective rises again beyond or
/// the equations are no longer balanced there. Where it tends to a number instead, the first one at which it is near to that:
/// beyond, a duration makes no difference that could be told from rounding.
fn cheapest(trial: Trials<'_>, here: Trial, way: i32) -> Option<f64> {
    let is_equal = |there: Trial| (there.decades - here.decades).abs() <= EQUAL;
    let (mut best, mut least, mut ends) = (0, here.objective, false);
    let mut before = least;
    for decade in FAR..=RANGE {
        let there = trial(way * decade)?;
        ends = !is_equal(there) || there.objective - least > EQUAL * (here.objective - least).abs();
        if ends {
            break;
        }
        if decade == RANGE - STEADY {
            before = there.objective;
        }
        if there.objective < least {
            (best, least) = (decade, there.objective);
        }
    }
    if best == 0 {
        return None;
    }
    if !ends {
        let tends = (before - least).abs() <= EQUAL * least.abs();
        let is_near = |there: Trial| (there.objective - least).abs() <= TENDS * least.abs();
        let mut tenths = (1..=RANGE * PARTS).map(|tenths| way.signum() * tenths);
        return tenths.find(|tenths| tends && trial(*tenths).is_some_and(is_near)).map(f64::from);
    }
    let tenths = way * best - PARTS..=way * best + PARTS;
    let near = tenths.filter_map(|tenths| Some((tenths, trial(tenths)?)));
    let good = near.filter(|(_, there)| is_equal(*there));
    good.min_by(|a, b| a.1.objective.total_cmp(&b.1.objective)).map(|(tenths, _)| f64::from(tenths))
}
