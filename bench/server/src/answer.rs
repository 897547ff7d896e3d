//! What is asked of a solver and what it answers.

use cpu_time::ProcessTime;
use serde_json::{Value, json};
use std::time::Instant;

/// A clock on the wall and one of this process, which stands still while others have the core.
pub struct Clocks {
    wall: Instant,
    cpu: ProcessTime,
}

impl Clocks {
    /// Both from now.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: ProcessTime::now() }
    }

    /// Seconds since then.
    pub fn read(&self) -> Seconds {
        Seconds { wall: self.wall.elapsed().as_secs_f64(), cpu: self.cpu.elapsed().as_secs_f64() }
    }
}

/// How long something took.
#[derive(Clone, Copy, Default)]
pub struct Seconds {
    /// On the wall.
    pub wall: f64,
    /// Of the processor.
    pub cpu: f64,
}

impl std::ops::AddAssign for Seconds {
    fn add_assign(&mut self, other: Self) {
        self.wall += other.wall;
        self.cpu += other.cpu;
    }
}

/// How long to go on solving the same problem again.
#[derive(Clone, Copy)]
pub struct Run {
    /// Seconds of solving after which there is enough to tell a median.
    pub seconds: f64,
    /// Solves after which there is enough in any case.
    pub solves: usize,
}

impl Run {
    /// Whether these many solves of these lengths are enough.
    pub fn is_enough(&self, taken: &[Seconds]) -> bool {
        taken.len() >= self.solves || taken.iter().map(|one| one.wall).sum::<f64>() >= self.seconds
    }
}

/// Wall-clock seconds that parts of a solve took, by name.
pub type Parts = Vec<(&'static str, f64)>;

/// One or more solves of the same problem.
pub struct Answer {
    /// How long each solve took.
    pub taken: Vec<Seconds>,
    /// How long a single solve takes that has everything to do for the first time, if that was asked.
    pub once: Option<Seconds>,
    /// In the objective's unit.
    pub objective: f64,
    /// Whether the solver says so.
    pub solved: bool,
    /// The solver's words.
    pub status: String,
    /// Over all steps of a continuation.
    pub iterations: usize,
    /// The largest scaled residual of the optimality conditions at the end.
    pub residual: f64,
    /// The largest relative violation between the points, if it was looked for.
    pub violation: Option<f64>,
    /// Where the time of the last solve went.
    pub parts: Parts,
}

impl Answer {
    /// For the other side of the pipe.
    pub fn json(&self) -> Value {
        json!({
            "wall": self.taken.iter().map(|one| one.wall).collect::<Vec<_>>(),
            "cpu": self.taken.iter().map(|one| one.cpu).collect::<Vec<_>>(),
            "once": self.once.map(|once| once.cpu),
            "objective": self.objective,
            "solved": self.solved,
            "status": self.status,
            "iterations": self.iterations,
            "residual": self.residual,
            "violation": self.violation,
            "parts": self.parts.iter().map(|(name, value)| (name.to_string(), json!(value))).collect::<serde_json::Map<_, _>>(),
        })
    }
}
