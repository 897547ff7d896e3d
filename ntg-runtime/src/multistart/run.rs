//! The starts themselves: made, solved side by side, and put together.

use super::parameters::{self, Open};
use super::vehicles::{Vehicle, positions, vehicles};
use super::{Minimum, MultiReport, Origin, StartKind, StartProgress, StartReport, Starts};
use super::{lattice, minima, random};
use crate::error::Error;
use crate::guess::{Guess, start};
use crate::problem::Problem;
use crate::report::{Report, Resolution};
use crate::settings::{Between, Control, InvalidSetting, Settings};
use crate::solve::refined;
use crate::status::Status;
use crate::strategy::{Session, Task};
use crate::transcribe::Transcription;
use rayon::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Solves a problem from many starts around the spec's own guess.
///
/// `Settings::time_limit` holds for everything; starts that have not begun by then are not tried.
/// `Settings::on_iteration` is called from several threads at once. `Settings::refine` holds for the
/// minima: starts are solved on the problem's own mesh, then every minimum is refined, and those that
/// turn out to be the same are put together.
///
/// # Errors
/// [`Error`] if the problem cannot be set up. A start that fails is no error.
pub fn multistart(problem: &dyn Problem, starts: &Starts, settings: &Settings) -> Result<MultiReport, Error> {
    multistart_from(problem, &Guess::new(), starts, settings)
}

/// Solves a problem from many starts around a program's guess.
///
/// # Errors
/// As [`multistart`], and where the guess does not fit the problem.
pub fn multistart_from(
    problem: &dyn Problem,
    guess: &Guess,
    starts: &Starts,
    settings: &Settings,
) -> Result<MultiReport, Error> {
    settings.validate()?;
    if starts.count == 0 {
        let message = "0 leaves nothing to do; it must be at least 1".into();
        return Err(InvalidSetting { field: "starts.count", message }.into());
    }
    let began = Instant::now();
    let nlp = Transcription::new(problem)?;
    let base = start(&nlp, Some(guess))?;
    let vehicles = vehicles(&nlp, guess);
    let open = match starts.kind {
        StartKind::Mixed => parameters::open(&nlp, &vehicles, guess, &base)?,
        _ => vec![],
    };
    let plan = Plan::new(&nlp, (guess, &base), (&vehicles, &open), starts)?;
    let watch = Watch { starts, began, state: Mutex::default(), cancelled: AtomicBool::new(false) };
    let solved = (0..starts.count).into_par_iter().map_init(Session::default, |session, number| {
        let remaining = settings.time_limit.map(|limit| limit.saturating_sub(began.elapsed()));
        if watch.cancelled.load(Ordering::Relaxed) || remaining == Some(Duration::ZERO) {
            return None;
        }
        let settings = Settings { time_limit: remaining, refine: None, ..settings.remembering() };
        Some(watch.done(plan.solve((problem, session), number, &settings), nlp.model.structure.maximize))
    });
    let solved: Vec<One> = solved.collect::<Vec<_>>().into_iter().flatten().collect();
    let positions = positions(&nlp, &vehicles);
    let mut report = gather(solved, &positions);
    report.finish(problem, &settings.after(began.elapsed()), &positions)?;
    report.problem.clone_from(&nlp.model.structure.name);
    report.notes = plan.notes;
    report.seconds = began.elapsed().as_secs_f64();
    Ok(report)
}

/// Which start comes from where, and what all of them share.
struct Plan<'a> {
    nlp: &'a Transcription<'a>,
    guess: &'a Guess,
    base: &'a [f64],
    vehicles: &'a [Vehicle],
    open: &'a [Open],
    starts: &'a Starts,
    searched: Vec<Vec<f64>>,
    notes: Vec<String>,
}

/// One start and what became of it.
struct One {
    origin: Origin,
    result: Result<Report, String>,
    seconds: f64,
}

impl<'a> Plan<'a> {
    fn new(
        nlp: &'a Transcription<'a>,
        (guess, base): (&'a Guess, &'a [f64]),
        (vehicles, open): (&'a [Vehicle], &'a [Open]),
        starts: &'a Starts,
    ) -> Result<Self, Error> {
        let mut notes = vec![];
        if vehicles.is_empty() && starts.kind != StartKind::Perturbed {
            notes.push(
                "no two or three outputs form a position (of one unit, with a route guess, fixed ends or constant \
                 bounds), so the guess was perturbed instead of its route"
                    .to_owned(),
            );
        }
        let searches = match starts.kind {
            StartKind::Search => starts.count,
            StartKind::Mixed => Starts::SEARCHED.min(starts.count - 1),
            StartKind::Routes | StartKind::Perturbed => 0,
        };
        let searched = if vehicles.is_empty() { vec![] } else { lattice::routes(nlp, vehicles, base, searches)? };
        if searches > 0 && !vehicles.is_empty() && searched.is_empty() {
            notes.push(
                "no coarse search: along straight moves the constraints are far from met, because they tie the \
                 position to other outputs"
                    .to_owned(),
            );
        } else if starts.kind == StartKind::Search && !vehicles.is_empty() && searched.len() < starts.count {
            let found = searched.len();
            notes.push(format!("the coarse search found {found} different routes; the other starts are random routes"));
        }
        Ok(Self { nlp, guess, base, vehicles, open, starts, searched, notes })
    }

    /// Where a start comes from.
    fn origin(&self, number: usize) -> Origin {
        let given = usize::from(self.starts.kind == StartKind::Mixed);
        let random = if self.vehicles.is_empty() { Origin::Perturbed } else { Origin::Route };
        match self.starts.kind {
            StartKind::Perturbed => Origin::Perturbed,
            StartKind::Routes => random,
            _ if number < given => Origin::Guess,
            _ if number < given + self.searched.len() => Origin::Search,
            // Where the author of the spec has left a guess open, that says most about what may differ.
            StartKind::Mixed if !self.open.is_empty() && !number.is_multiple_of(3) => Origin::Parameters,
            StartKind::Mixed if number % 4 == 3 => Origin::Perturbed,
            _ => random,
        }
    }

    /// How many starts before this one come from the same place.
    fn visit(&self, number: usize) -> usize {
        (0..number).filter(|earlier| self.origin(*earlier) == self.origin(number)).count()
    }

    fn solve(&self, (problem, session): (&dyn Problem, &mut Session), number: usize, settings: &Settings) -> One {
        let began = Instant::now();
        let origin = self.origin(number);
        let mut rng = random::generator(self.starts.seed, number);
        let given = usize::from(self.starts.kind == StartKind::Mixed);
        let x = match origin {
            // The plain solve, bit for bit.
            Origin::Guess => Ok(None),
            Origin::Search => Ok(Some(self.searched[number - given].clone())),
            Origin::Route => random::route(self.nlp, self.vehicles, self.base, &mut rng).map(Some),
            Origin::Perturbed => random::perturbed(self.nlp, self.base, &mut rng).map(Some),
            Origin::Parameters => {
                parameters::draw(self.nlp, self.guess, self.open, (self.starts.seed, self.visit(number))).map(Some)
            }
        };
        let result = x.map_err(Error::from).and_then(|x| {
            let drawn = x.map(Guess::raw);
            session.solve(Task { problem, guess: Some(drawn.as_ref().unwrap_or(self.guess)) }, settings)
        });
        One { origin, result: result.map_err(|error| error.to_string()), seconds: began.elapsed().as_secs_f64() }
    }
}

/// Counts starts that are done, and tells the caller.
struct Watch<'a> {
    starts: &'a Starts,
    began: Instant,
    state: Mutex<(usize, usize, Option<f64>)>,
    cancelled: AtomicBool,
}

impl Watch<'_> {
    fn done(&self, one: One, maximize: bool) -> One {
        let Some(on_start) = &self.starts.on_start else { return one };
        let mut state = self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        state.0 += 1;
        if let Some(report) = one.result.as_ref().ok().filter(|r| r.has_solution()) {
            state.1 += 1;
            let better = |held: f64| if maximize { report.objective > held } else { report.objective < held };
            if state.2.is_none_or(better) {
                state.2 = Some(report.objective);
            }
        }
        let (done, solved, best) = *state;
        let seconds = self.began.elapsed().as_secs_f64();
        let progress =
            StartProgress { done, count: self.starts.count, solved, best: best.unwrap_or(f64::NAN), seconds };
        if on_start(&progress) == Control::Cancel {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        drop(state);
        one
    }
}

/// Puts the starts together, in their own order.
fn gather(all: Vec<One>, positions: &[String]) -> MultiReport {
    let (mut starts, mut solved, mut nearest) = (vec![], vec![], None::<Box<Report>>);
    for (number, One { origin, result, seconds }) in all.into_iter().enumerate() {
        let (status, objective, iterations) = match &result {
            Ok(report) => (report.status.label(), report.objective, report.iterations),
            Err(message) => (message.clone(), f64::NAN, 0),
        };
        starts.push(StartReport { origin, status, minimum: None, objective, iterations, seconds });
        match result {
            Ok(report) if report.has_solution() => solved.push((number, report)),
            Ok(report) => {
                let primal = |r: &Report| r.residuals.scaled.primal;
                if nearest.as_ref().is_none_or(|held| primal(&report) < primal(held)) {
                    nearest = Some(Box::new(report));
                }
            }
            Err(_) => {}
        }
    }
    let minima = minima::minima(solved, positions);
    for (index, minimum) in minima.iter().enumerate() {
        minimum.starts.iter().for_each(|start| starts[*start].minimum = Some(index));
    }
    let minima = minima.into_iter().map(minima::Group::minimum).collect::<Vec<_>>();
    let nearest = nearest.filter(|_| minima.is_empty());
    MultiReport { problem: String::new(), starts, minima, nearest, notes: vec![], seconds: 0.0 }
}

impl MultiReport {
    /// Puts minima that are solutions of the points alone behind the others: nothing is gained by what they have less.
    fn put_resolved_first(&mut self) {
        let is_unresolved = |minimum: &Minimum| minimum.report.resolution() == Some(Resolution::Unresolved);
        let (last, first): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.minima).into_iter().enumerate().partition(|(_, minimum)| is_unresolved(minimum));
        let (before, minima): (Vec<usize>, Vec<Minimum>) = first.into_iter().chain(last).unzip();
        let now = |own: usize| before.iter().position(|before| *before == own);
        self.starts.iter_mut().for_each(|start| start.minimum = start.minimum.and_then(now));
        self.minima = minima;
    }

    /// Refines every minimum where the settings say so, puts those together that are one on finer meshes, and leaves out
    /// those that the settings refuse.
    fn finish(&mut self, problem: &dyn Problem, settings: &Settings, positions: &[String]) -> Result<(), Error> {
        if settings.refine.is_none() && settings.between == Between::Report {
            let began = Instant::now();
            let confirm = |minimum: &mut Minimum| {
                minimum.report =
                    minimum.report.clone().confirmed_from_now(problem, &settings.after(began.elapsed()))?;
                Ok::<(), Error>(())
            };
            self.minima.par_iter_mut().try_for_each(confirm)?;
            self.put_resolved_first();
            return Ok(());
        }
        let coarse = std::mem::take(&mut self.minima);
        let refined = coarse.into_par_iter().map(|minimum| refined(problem, minimum.report, settings));
        let refined = refined.collect::<Result<Vec<Report>, Error>>()?;
        let is_refused = |report: &Report| matches!(report.status, Status::ViolatedBetween { .. });
        if refined.iter().all(is_refused) && self.nearest.is_none() {
            self.nearest = refined.first().cloned().map(Box::new);
        }
        let kept = refined.into_iter().enumerate().filter(|(_, report)| !is_refused(report));
        let groups = minima::minima(kept.collect(), positions);
        let now = |before: usize| groups.iter().position(|group| group.starts.contains(&before));
        self.starts.iter_mut().for_each(|start| start.minimum = start.minimum.and_then(now));
        for (index, group) in groups.into_iter().enumerate() {
            let own = self.starts.iter().enumerate().filter(|(_, start)| start.minimum == Some(index));
            let starts = own.map(|(number, _)| number).collect();
            self.minima.push(minima::Group { starts, ..group }.minimum());
        }
        self.put_resolved_first();
        Ok(())
    }
}
