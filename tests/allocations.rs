//! After the first iteration a solve allocates nothing, by the count of an allocator.
//!
//! A test binary of its own, with one test: the count is that of the whole process.

use ntg::prelude::*;
use std::sync::{Arc, Mutex};

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

mod flight {
    ntg::ntg_file!("specs/low_observable.ntg");
}
mod phases {
    ntg::ntg_file!("specs/low_observable_phases.ntg");
}
mod fleet {
    ntg::ntg_file!("specs/multi_vehicle_separated.ntg");
}

/// How many blocks were allocated before each iteration of one run of the method.
fn counts(problem: &dyn Problem, method: Method) -> Vec<Vec<u64>> {
    let runs: Arc<Mutex<Vec<Vec<u64>>>> = Arc::default();
    let seen = runs.clone();
    let watch = move |progress: &Progress| {
        let mut runs = seen.lock().unwrap_or_else(|_| panic!("one thread solves"));
        if progress.iteration == 0 {
            runs.push(Vec::with_capacity(5000)); // Before it is counted.
        }
        if let Some(run) = runs.last_mut() {
            run.push(dhat::HeapStats::get().total_blocks);
        }
        Control::Continue
    };
    let settings = Settings { method, on_iteration: Some(Arc::new(watch)), ..Settings::default() };
    let report = solve(problem, &settings).unwrap_or_else(|error| panic!("{error}"));
    assert!(report.is_solved(), "{}", report.status);
    let runs = runs.lock().unwrap_or_else(|_| panic!("one thread solves"));
    runs.clone()
}

#[test]
fn no_iteration_but_the_first_allocates() {
    let _profiler = dhat::Profiler::builder().testing().build();
    let before = dhat::HeapStats::get().total_blocks;
    drop(Box::new(before));
    assert!(dhat::HeapStats::get().total_blocks > before, "the allocator counts");

    let problems: [&dyn Problem; 3] = [
        &flight::LowObservable::default(),
        &phases::LowObservablePhases::default(),
        &fleet::MultiVehicleSeparated::default(),
    ];
    for problem in problems {
        // The harness's own thread is counted too; what the solver allocates, it allocates every time.
        let [runs, again] = [(); 2].map(|()| counts(problem, Method::InteriorPoint));
        assert!(runs.iter().any(|run| run.len() > 10), "there is something to count");
        assert_eq!(runs.len(), again.len());
        for (run, again) in runs.iter().zip(&again) {
            let blocks = |run: &[u64]| run.windows(2).skip(1).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>();
            let both = blocks(run).into_iter().zip(blocks(again));
            let after_the_first: Vec<u64> = both.map(|(one, other)| one.min(other)).collect();
            assert!(after_the_first.iter().all(|blocks| *blocks == 0), "{after_the_first:?}");
        }
    }
}
