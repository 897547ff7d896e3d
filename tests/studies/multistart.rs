//! Many starts: the known minima are found whatever the seed, and the result depends on nothing else.

use ntg::prelude::*;
use ntg::runtime::multistart::{Origin, multistart};

use crate::support::{Shipped, close};

const B1: f64 = 128.252_905_291;
const B2: f64 = 130.907_227_498;
const B3: f64 = 128.347_970_733;
const B4: f64 = 135.037_709_597;

fn free() -> Shipped {
    Shipped::spec("low_observable").with("signature_max", &[7.0])
}

fn run(problem: &Shipped, starts: &Starts) -> MultiReport {
    multistart(problem.problem(), starts, &Settings::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Solves from the coarse search's first route alone.
#[track_caller]
fn searched(problem: &Shipped, known: f64) {
    let found = run(problem, &Starts { count: 1, kind: StartKind::Search, ..Starts::default() });
    assert_eq!(found.starts[0].origin, Origin::Search, "{found}");
    close(found.best().unwrap_or_else(|| panic!("{found}")).objective, known, 1e-6);
}

#[test]
fn every_seed_finds_the_best_flight() {
    for seed in 1..=10 {
        let found = run(&free(), &Starts { count: 16, seed, kind: StartKind::Routes, ..Starts::default() });
        close(found.best().unwrap_or_else(|| panic!("{found}")).objective, B1, 1e-8);
        assert_eq!(found.tried(), 16);
        assert_eq!(found.minima.iter().map(|m| m.count).sum::<usize>(), found.solved(), "{found}");
    }
}

#[test]
fn the_coarse_search_alone_leads_to_the_best_flights() {
    searched(&free(), B1);
    searched(&Shipped::spec("low_observable"), B2);
    searched(&Shipped::spec("low_observable").with("w_detection", &[400.0]), B4);
}

#[test]
fn the_coarse_search_goes_through_phases() {
    let two = "phase covert { duration in 100 .. 1000 [s]; trajectory { low_observable: signature <= signature_max; } }
               phase exposed after covert { duration in 20 .. 40 [s]; trajectory { seen_less: signature <= 6.5; } }
               duration T in 100 .. 3000 [s];";
    let edits = [
        ("duration T in 100 .. 3000 [s];", two),
        ("        low_observable: signature <= signature_max;\n", ""),
        ("        T = 900 [s];\n", "duration(covert) = 600 [s]; duration(exposed) = 30 [s];"),
    ];
    searched(&Shipped::edited("low_observable", &edits), B3);
}

#[test]
fn both_turns_of_the_missile_are_found_and_compared() {
    let found = run(&Shipped::spec("missile_intercept"), &Starts::default());
    assert!(found.notes.iter().any(|note| note.contains("other outputs")), "{found}");
    let objectives: Vec<f64> = found.minima.iter().map(|minimum| minimum.report.objective).collect();
    close(objectives[0], 95.974_905_59, 1e-6);
    assert!(objectives.iter().any(|j| (j / 105.651_483_76 - 1.0).abs() < 1e-6), "{found}");
}

#[test]
fn the_seed_decides_and_the_number_of_threads_does_not() {
    let starts = Starts { count: 6, seed: 5, ..Starts::default() };
    let on = |threads: usize, starts: &Starts| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
        let found = pool.install(|| run(&free(), starts));
        let each = found.starts.iter().map(|s| (s.origin, s.status.clone(), s.objective.to_bits(), s.iterations));
        each.collect::<Vec<_>>()
    };
    let one = on(1, &starts);
    assert_eq!(one, on(3, &starts));
    assert_ne!(one, on(1, &Starts { seed: 6, ..starts }));
}

#[test]
fn failed_starts_are_counted_and_stop_nothing() {
    let settings = Settings { max_iterations: 2, ..Settings::default() };
    let starts = Starts { count: 3, ..Starts::default() };
    let found = multistart(free().problem(), &starts, &settings).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((found.tried(), found.solved(), found.minima.len()), (3, 0, 0));
    assert_eq!(found.failures().iter().map(|(_, count)| count).sum::<usize>(), 3, "{found}");
    assert!(found.best().is_some_and(|nearest| !nearest.is_solved()));
}

#[test]
fn a_problem_without_positions_is_perturbed_and_says_so() {
    let found = run(&Shipped::spec("van_der_pol"), &Starts { count: 4, ..Starts::default() });
    assert!(found.notes.iter().any(|note| note.contains("perturbed")), "{found}");
    assert_eq!((found.solved(), found.minima.len(), found.minima[0].count), (4, 1, 4), "{found}");
    close(found.minima[0].report.objective, 1.702_214_262_83, 1e-8);
}

#[test]
fn the_watcher_may_cancel() {
    let cancel = std::sync::Arc::new(|_: &ntg::runtime::multistart::StartProgress| Control::Cancel);
    let starts = Starts { count: 64, on_start: Some(cancel), ..Starts::default() };
    let found = run(&Shipped::spec("van_der_pol"), &starts);
    assert!((1..64).contains(&found.tried()), "{found}");
}

#[test]
fn one_start_is_the_plain_solve_bit_for_bit() {
    for problem in [free(), Shipped::spec("van_der_pol"), Shipped::spec("strike_and_look")] {
        let found = run(&problem, &Starts { count: 1, ..Starts::default() });
        let (one, plain) = (found.best().unwrap_or_else(|| panic!("{found}")), problem.solve());
        assert_eq!(one.solution.coefficients(), plain.solution.coefficients());
        assert_eq!((one.iterations, one.objective.to_bits()), (plain.iterations, plain.objective.to_bits()));
    }
}
