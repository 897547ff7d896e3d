//! The interface of C, called from Rust: what it finds, what it says of mistakes, what it keeps, what it allocates.
//!
//! A binary with the allocator of embedded libraries, so that its memory is that of theirs.

use ntg_c::boundary::{self, Info, Solver as Handle};
use ntg_c::planner::Planner;
use ntg_c::{Code, Reserve};
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::Solver;
use ntg_runtime::problem::{Derivatives, Lanes, Problem};
use ntg_runtime::settings::Settings;
use ntg_runtime::splines::Table;
use ntg_runtime::structure::Structure;
use std::ffi::{CStr, c_int};
use std::ptr;
use std::sync::atomic::{AtomicUsize, Ordering};

#[global_allocator]
static MEMORY: Reserve = Reserve;

/// Specs of tests name no files.
struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("{path}: no files are read here"))
    }
}

/// A cart that is brought to a place; `reach` decides a bound, `T` a duration, `v_max` what is possible.
const CART: &str = "
/// A cart.
problem Cart {
    param horizon = 2 [s];
    param p0[2] = (0, 0) [cm];
    param reach = 100 [cm];
    param v_max = 2 [m/s];
    duration T = horizon;
    output p [m]: spline(order = 6, intervals = 6);
    let speed [cm/s] = der(p);
    minimize integral(der(p, 2)^2);
    initial { p == p0[1];  der(p) == p0[2] / 1 [s]; }
    trajectory { slow: der(p) in -v_max .. v_max; }
    final { p == reach;  der(p) == 0; }
}";
/// The parameters of the spec, in their declared units.
const DEFAULTS: [f64; 5] = [2.0, 0.0, 0.0, 100.0, 2.0];

fn compile(text: &str) -> Interpreted {
    let compiled = ntg_compiler::compile(&Source::new("test.ntg", text), &NoFiles);
    Interpreted::new(&compiled.unwrap_or_else(|found| panic!("{:?}", found.first().message)).program)
}

/// The bits of all coefficients.
fn bits(x: &[f64]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn plans_have_the_bits_of_a_solver_in_rust() {
    let problem = compile(CART);
    let mut solver = Solver::new(compile(CART), &Settings::default());
    let mut planner = Planner::new(&problem, None).expect("a plan");
    solver.solve().expect("a solution");
    for k in 0..20 {
        let (p, v) = (f64::from(k) * 3.0, 60.0 - f64::from(k));
        planner.set(&[2.0, p, v, 100.0, 2.0]).expect("numbers");
        let code = planner.solve(0, 0.0).expect("a plan");
        solver.problem.set("p0", &[p * 0.01, v * 0.01]).expect("a parameter");
        let report = solver.resolve().expect("a report");
        assert_eq!(code, Code::of(&report.status));
        assert_eq!(bits(planner.plan().coefficients()), bits(report.solution.coefficients()));
        let (x, speed) = (planner.read(0, 1, 0.7), planner.read(1, 0, 0.7));
        assert_eq!(planner.readings()[0].name, "p");
        let p = report.solution.output("p").expect("an output");
        assert_eq!(x.map(f64::to_bits), Ok(p.derivative(0.7, 1).to_bits()));
        let in_cm = speed.expect("a reading") / 100.0;
        assert!((in_cm - p.derivative(0.7, 1)).abs() < 1e-12);
    }
}

#[test]
fn a_parameter_may_decide_a_duration() {
    let problem = compile(CART);
    let mut planner = Planner::new(&problem, None).expect("a plan");
    let time = planner.readings().iter().position(|reading| reading.name == "T").expect("a time");
    for horizon in [1.9, 1.5, 2.5] {
        planner.set(&[horizon, 0.0, 0.0, 100.0, 4.0]).expect("numbers");
        planner.solve(0, 0.0).expect("a plan");
        assert_eq!(planner.read(time, 0, 0.0), Ok(horizon));
        assert!((planner.read(0, 0, horizon).expect("a reading") - 1.0).abs() < 1e-9);
    }
}

#[test]
fn what_fails_says_why_and_changes_nothing() {
    let problem = compile(CART);
    let mut planner = Planner::new(&problem, None).expect("a plan");
    let first = bits(planner.plan().coefficients());
    let failed = |result: Result<Code, ntg_c::planner::Failure>, code: Code, word: &str| {
        let failure = result.expect_err("a failure");
        assert_eq!(failure.code, code, "{}", failure.message);
        assert!(failure.message.contains(word), "{}", failure.message);
    };
    for (at, name) in [(0, "`horizon`"), (1, "`p0[1]`"), (2, "`p0[2]`"), (4, "`v_max`")] {
        for wrong in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
            let mut parameters = DEFAULTS;
            parameters[at] = wrong;
            failed(planner.set(&parameters).map(|()| Code::Ok), Code::BadParameter, name);
        }
    }
    failed(planner.set(&[1.0]).map(|()| Code::Ok), Code::BadArgument, "5 parameters");
    assert_eq!(planner.solve(0, 0.0), Ok(Code::Ok), "nothing was set");
    let before = bits(planner.plan().coefficients());
    let kept = |planner: &Planner<'_>| assert_eq!(bits(planner.plan().coefficients()), before);

    planner.set(&[2.0, 0.0, 0.0, 100.0, 0.45]).expect("numbers"); // A metre in two seconds at 0.45 m/s.
    failed(planner.solve(0, 0.0), Code::Infeasible, "misses its bound");
    kept(&planner);
    planner.set(&[2.0, 0.0, 0.0, 100.0, -1.0]).expect("numbers"); // Bounds that cross.
    failed(planner.solve(0, 0.0), Code::BadParameter, "slow");
    planner.set(&[-2.0, 0.0, 0.0, 100.0, 2.0]).expect("numbers"); // A negative duration.
    failed(planner.solve(0, 0.0), Code::BadParameter, "-2");
    kept(&planner);
    planner.set(&[2.0, 30.0, 0.0, 100.0, 0.6]).expect("numbers");
    failed(planner.solve(1, 0.0), Code::IterationLimit, "limit");
    failed(planner.solve(0, 1e-12), Code::TimeLimit, "limit");
    for seconds in [-1.0, f64::NAN, f64::INFINITY, 1e300] {
        failed(planner.solve(0, seconds), Code::BadArgument, "time limit");
    }
    kept(&planner);
    assert_eq!(planner.read(99, 0, 0.0).map_err(|f| f.code), Err(Code::BadArgument));
    assert_eq!(planner.read(0, 0, f64::NAN).map_err(|f| f.code), Err(Code::BadArgument));
    assert_eq!(planner.read(1, 1, 0.0).map_err(|f| f.code), Err(Code::BadArgument));
    assert_eq!(planner.read(0, usize::MAX, 0.0), Ok(0.0), "a spline has no such derivative");

    planner.set(&DEFAULTS).expect("numbers");
    assert_eq!(planner.solve(0, 0.0), Ok(Code::Ok));
    planner.reset();
    assert_eq!(bits(planner.plan().coefficients()), first);
}

#[test]
fn a_first_plan_that_fails_is_no_planner() {
    let problem = compile(CART);
    let code = |parameters: &[f64]| Planner::new(&problem, Some(parameters)).err().map(|failure| failure.code);
    assert_eq!(code(&[2.0, 0.0, 0.0, 100.0, 0.4]), Some(Code::Infeasible));
    assert_eq!(code(&[0.0, 0.0, 0.0, 100.0, 2.0]), Some(Code::BadParameter));
    assert_eq!(code(&[2.0, 0.0, f64::NAN, 100.0, 2.0]), Some(Code::BadParameter));
    assert_eq!(code(&DEFAULTS), None);
}

/// The message of a solver, or of the last create.
fn message(solver: *mut Handle) -> String {
    // SAFETY: the solver is null or alive, and no other thread has it.
    unsafe { CStr::from_ptr(boundary::message(solver)) }.to_string_lossy().into_owned()
}

#[test]
fn nulls_are_refused_by_every_function() {
    let mut solver = ptr::null_mut();
    let null = Code::Null as c_int;
    // SAFETY: pointers are null, or of what they point to.
    unsafe {
        assert_eq!(boundary::create(|| compile(CART), ptr::null(), ptr::null_mut()), null);
        assert_eq!(boundary::set(ptr::null_mut(), DEFAULTS.as_ptr()), null);
        assert_eq!(boundary::solve(ptr::null_mut(), 0, 0.0), null);
        assert_eq!(boundary::reset(ptr::null_mut()), null);
        assert_eq!(boundary::read(ptr::null_mut(), 0, 0, 0.0, &mut 0.0), null);
        assert_eq!(boundary::info(ptr::null_mut(), &mut Info::default()), null);
        boundary::destroy(ptr::null_mut());

        assert_eq!(boundary::create(|| compile(CART), ptr::null(), &mut solver), Code::Ok as c_int);
        assert_eq!(boundary::set(solver, ptr::null()), null);
        assert_eq!(boundary::read(solver, 0, 0, 0.0, ptr::null_mut()), null);
        assert_eq!(boundary::info(solver, ptr::null_mut()), null);
        for (reading, derivative) in [(-1, 0), (0, -1), (c_int::MAX, 0)] {
            let mut value = 7.0;
            let code = boundary::read(solver, reading, derivative, 0.0, &mut value);
            assert_eq!((code, value), (Code::BadArgument as c_int, 7.0));
            assert!(!message(solver).is_empty());
        }
        assert_eq!(boundary::solve(solver, -1, 0.0), Code::BadArgument as c_int);
        assert_eq!(boundary::solve(solver, 0, 0.0), Code::Ok as c_int);
        boundary::destroy(solver);
    }
    for status in [-1, 0, 12, 13, c_int::MIN, c_int::MAX] {
        // SAFETY: texts are constants.
        assert!(!unsafe { CStr::from_ptr(boundary::text(status)) }.is_empty());
    }
}

#[test]
fn after_create_the_system_is_asked_for_no_memory() {
    let mut solver = ptr::null_mut();
    let mut info = Info::default();
    // SAFETY: the solver is this test's alone, and other pointers are of what they point to.
    unsafe {
        assert_eq!(boundary::create(|| compile(CART), ptr::null(), &mut solver), Code::Ok as c_int);
        for k in 0..500 {
            let t = f64::from(k % 50);
            // Plans, plans of other durations, infeasible steps, contradictions, bad parameters, limits.
            let parameters = match k % 10 {
                5 => [2.0, 0.0, 0.0, 100.0, 0.4],
                6 => [2.0, 0.0, 0.0, 100.0, -1.0],
                7 => [f64::NAN, 0.0, 0.0, 100.0, -1.0],
                8 => [1.5 + 0.01 * t, 0.0, 0.0, 100.0, 2.0],
                _ => [2.0, t, 10.0, 100.0, 2.0],
            };
            boundary::set(solver, parameters.as_ptr());
            boundary::solve(solver, if k % 10 == 9 { 1 } else { 0 }, 0.0);
            boundary::read(solver, 1, 0, 0.02 * t, &mut 0.0);
        }
        boundary::reset(solver);
        assert_eq!(boundary::info(solver, &mut info), Code::Ok as c_int);
        boundary::destroy(solver);
    }
    assert!(info.reserved > 0.0 && info.used > 0.0, "the pool is in use: {info:?}");
    assert_eq!(info.helped_out, 0.0, "{info:?}");
}

/// A problem that panics in the kernel call of some number, and waits in it for another thread.
struct Faulty {
    problem: Interpreted,
    calls: &'static AtomicUsize,
    work: fn(usize),
}

impl Problem for Faulty {
    fn structure(&self) -> Structure {
        self.problem.structure()
    }
    fn values(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], values: &mut [f64]) {
        (self.work)(self.calls.fetch_add(1, Ordering::SeqCst));
        self.problem.values(kernel, lanes, inputs, tables, values);
    }
    fn derivatives(&self, kernel: usize, point: Lanes<'_>, tables: &[Table], out: Derivatives<'_>) {
        (self.work)(self.calls.fetch_add(1, Ordering::SeqCst));
        self.problem.derivatives(kernel, point, tables, out);
    }
    fn probes(&self, kernel: usize, lanes: usize, inputs: &[f64], tables: &[Table], probes: &mut [f64]) {
        self.problem.probes(kernel, lanes, inputs, tables, probes);
    }
}

#[test]
fn a_panic_is_a_status_and_the_solver_can_be_destroyed() {
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    const LATE: usize = 1 << 20;
    let work = |call: usize| assert!(call < LATE, "a defect of a kernel");
    let problem = || Faulty { problem: compile(CART), calls: &CALLS, work };
    let internal = Code::Internal as c_int;
    let mut solver = ptr::null_mut();
    // SAFETY: the solvers are this test's alone, and other pointers are of what they point to.
    unsafe {
        assert_eq!(boundary::create(problem, ptr::null(), &mut solver), Code::Ok as c_int);
        CALLS.store(LATE, Ordering::SeqCst);
        boundary::set(solver, [2.0, 5.0, 0.0, 100.0, 2.0].as_ptr());
        assert_eq!(boundary::solve(solver, 0, 0.0), internal);
        assert!(message(solver).contains("a defect of a kernel"));
        assert_eq!(boundary::solve(solver, 0, 0.0), internal);
        assert_eq!(boundary::read(solver, 0, 0, 0.0, &mut 0.0), internal);
        boundary::destroy(solver);

        assert_eq!(boundary::create(problem, ptr::null(), &mut solver), internal);
        assert!(solver.is_null() && message(ptr::null_mut()).contains("a defect of a kernel"));
    }
}

#[test]
fn a_second_thread_is_kept_out() {
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    static OTHER: AtomicUsize = AtomicUsize::new(0);
    static ANSWER: AtomicUsize = AtomicUsize::new(usize::MAX);
    // Within the first kernel call after `OTHER` is set, another thread solves with the same solver.
    let work = |_: usize| {
        let solver = OTHER.swap(0, Ordering::SeqCst);
        if solver != 0 {
            let other = std::thread::spawn(move || {
                // SAFETY: the solver is alive; that another thread is in a call is what is tested.
                unsafe { boundary::solve(solver as *mut Handle, 0, 0.0) }
            });
            let answer = other.join().expect("a status");
            ANSWER.store(answer as usize, Ordering::SeqCst);
        }
    };
    let mut solver = ptr::null_mut();
    // SAFETY: as above.
    unsafe {
        let problem = || Faulty { problem: compile(CART), calls: &CALLS, work };
        assert_eq!(boundary::create(problem, ptr::null(), &mut solver), Code::Ok as c_int);
        OTHER.store(solver as usize, Ordering::SeqCst);
        boundary::set(solver, [2.0, 5.0, 0.0, 100.0, 2.0].as_ptr());
        assert_eq!(boundary::solve(solver, 0, 0.0), Code::Ok as c_int);
        boundary::destroy(solver);
    }
    assert_eq!(ANSWER.load(Ordering::SeqCst), Code::Busy as usize);
}
