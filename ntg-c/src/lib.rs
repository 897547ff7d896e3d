//! The C interface of one problem: what a crate that `ntg embed` has written consists of.
//!
//! ```text
//! C  ──►  boundary  ──►  Planner  ──►  ntg_runtime::Solver
//!         pointers, panics             parameters, plan, readings
//!              └────►  memory          reserved by create, so that a solve calls no allocator of the system
//! ```
//!
//! [`embed!`] instantiates the interface for one problem: eight functions of C, by the names that it is given.
//! [`boundary`] is all that touches pointers: it checks them, keeps a second thread out, and turns panics into a
//! [`Code`]. [`planner`] is the same interface in safe Rust. [`readings`] says what can be read from a plan, in the order
//! in which the header of C numbers it. The only unsafe code of the project is in [`boundary`] and [`memory`].

pub mod boundary;
pub mod memory;
pub mod planner;
pub mod readings;
mod text;

mod code;

pub use code::Code;
pub use memory::Reserve;

/// The functions of C for one problem, by the names that they have in C.
///
/// ```
/// mod problem {
///     # pub use ntg_runtime::structure::Structure;
///     # pub struct Move;
///     # // A problem of no size, in place of `ntg::ntg_file!("move.ntg");`.
///     # impl Default for Move { fn default() -> Self { Move } }
///     # use ntg_runtime::problem::{Derivatives, Lanes, Problem};
///     # use ntg_runtime::splines::Table;
///     # impl Problem for Move {
///     #     fn structure(&self) -> Structure { Structure::default() }
///     #     fn values(&self, _: usize, _: usize, _: &[f64], _: &[Table], _: &mut [f64]) {}
///     #     fn derivatives(&self, _: usize, _: Lanes<'_>, _: &[Table], _: Derivatives<'_>) {}
///     #     fn probes(&self, _: usize, _: usize, _: &[f64], _: &[Table], _: &mut [f64]) {}
///     # }
/// }
///
/// ntg_c::embed! {
///     problem::Move;
///     create = "move_create", set = "move_set", solve = "move_solve", reset = "move_reset", read = "move_read",
///     info = "move_info", message = "move_message", text = "move_text", destroy = "move_destroy",
/// }
/// # fn main() {}
/// ```
#[macro_export]
macro_rules! embed {
    (
        $problem:path;
        create = $create:literal, set = $set:literal, solve = $solve:literal, reset = $reset:literal,
        read = $read:literal, info = $info:literal, message = $message:literal, text = $text:literal,
        destroy = $destroy:literal $(,)?
    ) => {
        const _: () = {
            use ::core::ffi::{c_char, c_int};
            use $crate::boundary::{self, Info, Solver};

            #[unsafe(export_name = $create)]
            unsafe extern "C" fn create(parameters: *const f64, out: *mut *mut Solver) -> c_int {
                // SAFETY: what the header demands of the caller.
                unsafe { boundary::create(|| <$problem as ::core::default::Default>::default(), parameters, out) }
            }

            #[unsafe(export_name = $set)]
            unsafe extern "C" fn set(solver: *mut Solver, parameters: *const f64) -> c_int {
                // SAFETY: what the header demands of the caller.
                unsafe { boundary::set(solver, parameters) }
            }

            #[unsafe(export_name = $solve)]
            unsafe extern "C" fn solve(solver: *mut Solver, max_iterations: c_int, max_seconds: f64) -> c_int {
                // SAFETY: what the header demands of the caller.
                unsafe { boundary::solve(solver, max_iterations, max_seconds) }
            }

            #[unsafe(export_name = $reset)]
            unsafe extern "C" fn reset(solver: *mut Solver) -> c_int {
                // SAFETY: what the header demands of the caller.
                unsafe { boundary::reset(solver) }
            }

            #[unsafe(export_name = $read)]
            unsafe extern "C" fn read(
                solver: *mut Solver,
                reading: c_int,
                derivative: c_int,
                time: f64,
                out: *mut f64,
            ) -> c_int {
                // SAFETY: what the header demands of the caller.
                unsafe { boundary::read(solver, reading, derivative, time, out) }
            }

            #[unsafe(export_name = $info)]
            unsafe extern "C" fn info(solver: *mut Solver, out: *mut Info) -> c_int {
                // SAFETY: what the header demands of the caller.
                unsafe { boundary::info(solver, out) }
            }

            #[unsafe(export_name = $message)]
            unsafe extern "C" fn message(solver: *mut Solver) -> *const c_char {
                // SAFETY: what the header demands of the caller.
                unsafe { boundary::message(solver) }
            }

            #[unsafe(export_name = $text)]
            extern "C" fn text(status: c_int) -> *const c_char {
                boundary::text(status)
            }

            #[unsafe(export_name = $destroy)]
            unsafe extern "C" fn destroy(solver: *mut Solver) {
                // SAFETY: what the header demands of the caller.
                unsafe { boundary::destroy(solver) }
            }
        };
    };
}
