//! The functions of C: pointers, threads and panics.
//!
//! Every function checks its pointers for null, enters the solver's memory, lets one thread in at a time, and catches
//! panics: the caller gets a [`Code`], with a message where the solver can hold one. After a panic the solver is broken
//! and every call but `destroy` returns [`Code::Internal`].
//!
//! What C promises: a solver's pointer is one that `create` gave and `destroy` has not had; other pointers are null or
//! point to as much as the header says.

use crate::Code;
use crate::memory::{Counts, Entered, Pool};
use crate::planner::{Failure, Planner, count};
use crate::text::Text;
use ntg_runtime::problem::Problem;
use std::any::Any;
use std::cell::{RefCell, UnsafeCell};
use std::ffi::{c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::{self, NonNull};
use std::slice;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// A solver as C knows it: by its pointer.
pub struct Solver {
    /// Whether a thread is in a call.
    is_busy: AtomicBool,
    pool: NonNull<Pool>,
    /// How many numbers the parameters have.
    parameters: usize,
    inner: UnsafeCell<Inner>,
}

/// What one thread at a time may touch.
struct Inner {
    message: Text,
    /// None after a panic.
    planner: Option<Planner<'static>>,
    /// The kernels that the planner borrows; dropped after it.
    kernels: *mut dyn Problem,
}

/// Numbers about the last solve, the plan and the memory. The header of C has the same fields.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Info {
    /// The objective of the last solve, in the unit of the spec.
    pub objective: f64,
    /// Its wall-clock time in seconds.
    pub seconds: f64,
    /// Start of the plan in seconds.
    pub start: f64,
    /// End of the plan in seconds.
    pub end: f64,
    /// Bytes of memory that were reserved by create.
    pub reserved: f64,
    /// Bytes of them that were ever used.
    pub used: f64,
    /// Blocks of memory that were taken from the system after create: 0, or the reserve did not suffice.
    pub helped_out: f64,
    /// Iterations of the last solve.
    pub iterations: c_int,
    /// How the last solve ended.
    pub status: c_int,
}

thread_local! {
    /// Why the last create of this thread failed.
    static NOT_CREATED: RefCell<Text> = const { RefCell::new(Text::EMPTY) };
}

/// Nothing is printed of a panic within a call: its words go into the message. Others are none of ours.
fn silence_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !Pool::is_entered() {
                before(panic);
            }
        }));
    });
}

/// What a panic says.
fn words(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("a panic without words")
}

/// Makes a solver with its first plan. Null parameters are those of the spec.
///
/// # Safety
/// `parameters` is null or points to as many numbers as the problem's parameters have; `out` is null or may be written.
pub unsafe fn create<P: Problem + 'static>(
    problem: impl FnOnce() -> P,
    parameters: *const f64,
    out: *mut *mut Solver,
) -> c_int {
    let Some(mut out) = NonNull::new(out) else { return Code::Null as c_int };
    // SAFETY: what the caller promises.
    let out = unsafe { out.as_mut() };
    *out = ptr::null_mut();
    silence_panics();
    let refused = |failure: &Failure| {
        let _ = NOT_CREATED.try_with(|text| text.borrow_mut().set(&failure.message));
        failure.code as c_int
    };
    let Some(pool) = Pool::create() else {
        return refused(&Failure::new(Code::Internal, "there is no memory"));
    };
    // SAFETY: the pool is new.
    let entered = unsafe { Pool::enter(pool) };
    // SAFETY: the caller's promise about parameters.
    let made = catch_unwind(AssertUnwindSafe(|| unsafe { make(problem(), pool, parameters) }));
    let code = match made {
        Ok(Ok(solver)) => {
            *out = solver;
            // SAFETY: the pool is this thread's until create returns.
            unsafe { Pool::seal(pool) };
            Code::Ok as c_int
        }
        Ok(Err(failure)) => refused(&failure),
        Err(panic) => refused(&Failure::new(Code::Internal, words(&*panic))),
    };
    drop(entered);
    if out.is_null() {
        // SAFETY: as above, and nobody has the solver.
        unsafe { Pool::release(pool) };
    }
    code
}

/// # Safety
/// As [`create`].
unsafe fn make<P: Problem + 'static>(
    problem: P,
    pool: NonNull<Pool>,
    parameters: *const f64,
) -> Result<*mut Solver, Failure> {
    let numbers = count(&problem.structure());
    let kernels: *mut dyn Problem = Box::into_raw(Box::new(problem));
    // SAFETY: the caller points to so many numbers.
    let parameters = (!parameters.is_null()).then(|| unsafe { slice::from_raw_parts(parameters, numbers) });
    // SAFETY: the kernels stay until the planner is dropped.
    match Planner::new(unsafe { &*kernels }, parameters) {
        Ok(planner) => {
            let inner = UnsafeCell::new(Inner { message: Text::EMPTY, planner: Some(planner), kernels });
            let solver = Solver { is_busy: AtomicBool::new(false), pool, parameters: numbers, inner };
            Ok(Box::into_raw(Box::new(solver)))
        }
        Err(failure) => {
            // SAFETY: nothing borrows the kernels any more.
            drop(unsafe { Box::from_raw(kernels) });
            Err(failure)
        }
    }
}

/// A thread in a call: it has the solver and its memory for itself.
struct Call<'s> {
    solver: &'s Solver,
    _entered: Entered,
}

impl Drop for Call<'_> {
    fn drop(&mut self) {
        self.solver.is_busy.store(false, Ordering::Release);
    }
}

impl Solver {
    /// Lets a thread in; none where another one is in.
    fn begin(&self) -> Option<Call<'_>> {
        if self.is_busy.swap(true, Ordering::Acquire) {
            return None;
        }
        // SAFETY: `is_busy` keeps other threads out, and the pool lives as long as the solver.
        Some(Call { solver: self, _entered: unsafe { Pool::enter(self.pool) } })
    }
}

/// Does something with a solver's planner: keeps the message of a failure, and breaks the solver where it panics.
///
/// # Safety
/// `solver` is null or a solver that is not destroyed.
unsafe fn with(solver: *mut Solver, work: impl FnOnce(&mut Planner<'static>) -> Result<Code, Failure>) -> c_int {
    let Some(solver) = NonNull::new(solver) else { return Code::Null as c_int };
    // SAFETY: what the caller promises; all that changes is behind `is_busy`.
    let solver = unsafe { solver.as_ref() };
    let Some(_call) = solver.begin() else { return Code::Busy as c_int };
    // SAFETY: this thread alone is in a call.
    let inner = unsafe { &mut *solver.inner.get() };
    let Some(planner) = &mut inner.planner else { return Code::Internal as c_int };
    match catch_unwind(AssertUnwindSafe(|| work(planner))) {
        Ok(Ok(code)) => code as c_int,
        Ok(Err(failure)) => {
            inner.message.set(&failure.message);
            failure.code as c_int
        }
        Err(panic) => {
            inner.message.set(words(&*panic));
            // What a panic has left half done is not dropped either: that might panic again.
            std::mem::forget(inner.planner.take());
            Code::Internal as c_int
        }
    }
}

/// Sets all parameters.
///
/// # Safety
/// `solver` is null or a solver that is not destroyed; otherwise as [`create`].
pub unsafe fn set(solver: *mut Solver, parameters: *const f64) -> c_int {
    // SAFETY: what the caller promises. The number of parameters never changes.
    unsafe {
        let Some(known) = solver.as_ref() else { return Code::Null as c_int };
        if parameters.is_null() {
            return Code::Null as c_int;
        }
        let parameters = slice::from_raw_parts(parameters, known.parameters);
        with(solver, |planner| planner.set(parameters).map(|()| Code::Ok))
    }
}

/// Makes the next plan within limits.
///
/// # Safety
/// `solver` is null or a solver that is not destroyed.
pub unsafe fn solve(solver: *mut Solver, max_iterations: c_int, max_seconds: f64) -> c_int {
    let solve = |planner: &mut Planner<'static>| {
        let Ok(max_iterations) = usize::try_from(max_iterations) else {
            return Err(Failure::new(Code::BadArgument, format!("{max_iterations} iterations are fewer than none")));
        };
        planner.solve(max_iterations, max_seconds)
    };
    // SAFETY: what the caller promises.
    unsafe { with(solver, solve) }
}

/// Returns to the plan of create.
///
/// # Safety
/// `solver` is null or a solver that is not destroyed.
pub unsafe fn reset(solver: *mut Solver) -> c_int {
    let reset = |planner: &mut Planner<'static>| {
        planner.reset();
        Ok(Code::Ok)
    };
    // SAFETY: what the caller promises.
    unsafe { with(solver, reset) }
}

/// Reads the plan. Where that fails, nothing is written.
///
/// # Safety
/// `solver` is null or a solver that is not destroyed; `out` is null or may be written.
pub unsafe fn read(solver: *mut Solver, reading: c_int, derivative: c_int, time: f64, out: *mut f64) -> c_int {
    let Some(mut out) = NonNull::new(out) else { return Code::Null as c_int };
    let read = |planner: &mut Planner<'static>| {
        let number = |value: c_int, of: &str| {
            usize::try_from(value).map_err(|_| Failure::new(Code::BadArgument, format!("{value} is no {of}")))
        };
        let value = planner.read(number(reading, "reading")?, number(derivative, "derivative")?, time)?;
        // SAFETY: what the caller promises.
        unsafe { *out.as_mut() = value };
        Ok(Code::Ok)
    };
    // SAFETY: what the caller promises.
    unsafe { with(solver, read) }
}

/// Numbers about the last solve, the plan and the memory.
///
/// # Safety
/// As [`read`].
pub unsafe fn info(solver: *mut Solver, out: *mut Info) -> c_int {
    let (Some(mut out), Some(known)) = (NonNull::new(out), NonNull::new(solver)) else { return Code::Null as c_int };
    let info = |planner: &mut Planner<'static>| {
        let (status, last, [start, end]) = planner.state();
        // SAFETY: this thread is in a call, and has the pool.
        let Counts { reserved, used, helped_out } = unsafe { Pool::counts(known.as_ref().pool) };
        let info = Info {
            objective: last.objective,
            seconds: last.seconds,
            start,
            end,
            reserved: reserved as f64,
            used: used as f64,
            helped_out: helped_out as f64,
            iterations: c_int::try_from(last.iterations).unwrap_or(c_int::MAX),
            status: status as c_int,
        };
        // SAFETY: what the caller promises.
        unsafe { *out.as_mut() = info };
        Ok(Code::Ok)
    };
    // SAFETY: what the caller promises.
    unsafe { with(solver, info) }
}

/// The message of the last call that failed; with null, why the last create of this thread failed. It stays until the next
/// call that fails.
///
/// # Safety
/// `solver` is null or a solver that is not destroyed, and no other thread is in a call with the solver.
pub unsafe fn message(solver: *mut Solver) -> *const c_char {
    let Some(solver) = NonNull::new(solver) else {
        let text = NOT_CREATED.try_with(|text| text.try_borrow().map(|text| text.as_ptr()));
        return text.ok().and_then(Result::ok).unwrap_or(c"".as_ptr());
    };
    // SAFETY: what the caller promises.
    unsafe { (*solver.as_ref().inner.get()).message.as_ptr() }
}

/// What a status means, in words.
pub fn text(status: c_int) -> *const c_char {
    let code = usize::try_from(status).ok().and_then(|status| Code::ALL.get(status));
    code.map_or(c"this is no status", |code| code.text()).as_ptr()
}

/// Ends a solver; nothing for null.
///
/// # Safety
/// `solver` is null or a solver that is not destroyed, and no other thread is in a call with the solver or uses it afterwards.
pub unsafe fn destroy(solver: *mut Solver) {
    let Some(solver) = NonNull::new(solver) else { return };
    // SAFETY: what the caller promises: the solver is this thread's, and was boxed by create.
    unsafe {
        let pool = solver.as_ref().pool;
        let entered = Pool::enter(pool);
        let ended = catch_unwind(AssertUnwindSafe(|| {
            let Solver { inner, .. } = *Box::from_raw(solver.as_ptr());
            let Inner { planner, kernels, .. } = inner.into_inner();
            drop(planner);
            drop(Box::from_raw(kernels));
        }));
        if let Err(panic) = ended {
            std::mem::forget(panic); // What it holds may panic again.
        }
        drop(entered);
        Pool::release(pool);
    }
}
