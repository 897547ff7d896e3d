//! IPOPT's C interface, from a library that is loaded when the program runs.
//!
//! Only this file is unsafe. The signatures are those of `IpStdCInterface.h` of IPOPT 3.14 (`ipindex` is `int`, `ipnumber`
//! is `double`, `bool` is C's); the library has to be one with these, as in CasADi's wheel.
#![allow(unsafe_code, reason = "a C library is called")]

use crate::solve::{End, Evaluations, Limits};
use libloading::{Library, Symbol};
use std::ffi::{CString, OsStr, c_char, c_double, c_int, c_void};
use std::slice;

type Number = *mut c_double;
type Index = *mut c_int;
type Handle = *mut c_void;
type User = *mut c_void;
type EvalF = extern "C" fn(c_int, Number, bool, Number, User) -> bool;
type EvalGradF = extern "C" fn(c_int, Number, bool, Number, User) -> bool;
type EvalG = extern "C" fn(c_int, Number, bool, c_int, Number, User) -> bool;
type EvalJacG = extern "C" fn(c_int, Number, bool, c_int, c_int, Index, Index, Number, User) -> bool;
type EvalH =
    extern "C" fn(c_int, Number, bool, c_double, c_int, Number, bool, c_int, Index, Index, Number, User) -> bool;
type Intermediate = extern "C" fn(
    c_int,
    c_int,
    c_double,
    c_double,
    c_double,
    c_double,
    c_double,
    c_double,
    c_double,
    c_double,
    c_int,
    User,
) -> bool;
type Create = unsafe extern "C" fn(
    c_int,
    Number,
    Number,
    c_int,
    Number,
    Number,
    c_int,
    c_int,
    c_int,
    EvalF,
    EvalG,
    EvalGradF,
    EvalJacG,
    EvalH,
) -> Handle;
type Free = unsafe extern "C" fn(Handle);
type StrOption = unsafe extern "C" fn(Handle, *mut c_char, *mut c_char) -> bool;
type NumOption = unsafe extern "C" fn(Handle, *mut c_char, c_double) -> bool;
type IntOption = unsafe extern "C" fn(Handle, *mut c_char, c_int) -> bool;
type SetIntermediate = unsafe extern "C" fn(Handle, Intermediate) -> bool;
type Solve = unsafe extern "C" fn(Handle, Number, Number, Number, Number, Number, Number, User) -> c_int;

/// A value of one of IPOPT's options.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// A word.
    Word(String),
    /// A whole number.
    Whole(i32),
    /// Any other number.
    Real(f64),
}

/// A loaded IPOPT.
pub(crate) struct Ipopt {
    library: Library,
}

/// What the callbacks see.
struct Called<'a> {
    evaluations: &'a mut dyn Evaluations,
    jacobian: (Vec<c_int>, Vec<c_int>),
    hessian: (Vec<c_int>, Vec<c_int>),
    iterations: usize,
}

/// A problem in IPOPT's memory, which is given back when this is dropped.
struct Problem {
    handle: Handle,
    free: Free,
}

impl Drop for Problem {
    fn drop(&mut self) {
        // SAFETY: the handle came from CreateIpoptProblem and is freed once.
        unsafe { (self.free)(self.handle) }
    }
}

impl Ipopt {
    /// Loads the library of that name or path.
    ///
    /// # Errors
    /// What the loader says.
    pub(crate) fn load(name: &OsStr) -> Result<Self, String> {
        // SAFETY: the initialisers of IPOPT and of the libraries that it needs have no preconditions.
        let library = unsafe { Library::new(name) };
        let library = library.map_err(|error| format!("IPOPT cannot be loaded from {}: {error}", name.display()))?;
        Ok(Self { library })
    }

    /// A function by its name.
    fn function<T: Copy>(&self, name: &str) -> Result<T, String> {
        // SAFETY: `T` is the function's type in IpStdCInterface.h; the copy lives no longer than `self`.
        let found: Result<Symbol<'_, T>, _> = unsafe { self.library.get(name.as_bytes()) };
        found.map(|symbol| *symbol).map_err(|error| format!("the library is no IPOPT: {error}"))
    }

    /// Solves from a start, with options by name.
    ///
    /// # Errors
    /// A library that is no IPOPT, a program it does not take, an option that it does not know.
    pub(crate) fn solve(
        &self,
        limits: &mut Limits,
        start: &[f64],
        evaluations: &mut dyn Evaluations,
        options: &[(String, Value)],
    ) -> Result<End, String> {
        let (n, m) = (limits.lower.len(), limits.row_lower.len());
        let places = |(rows, columns): (Vec<usize>, Vec<usize>)| (whole(&rows), whole(&columns));
        let (jacobian, hessian) = (places(evaluations.jacobian_pattern()), places(evaluations.hessian_pattern()));
        let problem = self.problem(limits, (jacobian.0.len(), hessian.0.len()))?;
        for (name, value) in options {
            self.set(&problem, name, value)?;
        }
        let mut called = Called { evaluations, jacobian, hessian, iterations: 0 };
        let mut end = End {
            status: 0,
            iterations: 0,
            objective: f64::NAN,
            x: start.to_vec(),
            rows: vec![0.0; m],
            row_multipliers: vec![0.0; m],
            lower_multipliers: vec![0.0; n],
            upper_multipliers: vec![0.0; n],
        };
        let solve: Solve = self.function("IpoptSolve")?;
        // SAFETY: all arrays have the lengths that the problem was made with; `called` outlives the call, and
        // nothing else uses it meanwhile.
        end.status = unsafe {
            solve(
                problem.handle,
                end.x.as_mut_ptr(),
                end.rows.as_mut_ptr(),
                &raw mut end.objective,
                end.row_multipliers.as_mut_ptr(),
                end.lower_multipliers.as_mut_ptr(),
                end.upper_multipliers.as_mut_ptr(),
                (&raw mut called).cast(),
            )
        };
        end.iterations = called.iterations;
        Ok(end)
    }

    fn problem(&self, limits: &mut Limits, (jacobian, hessian): (usize, usize)) -> Result<Problem, String> {
        /// Rows and columns are counted from 0.
        const C_STYLE: c_int = 0;
        let create: Create = self.function("CreateIpoptProblem")?;
        let free: Free = self.function("FreeIpoptProblem")?;
        let set: SetIntermediate = self.function("SetIntermediateCallback")?;
        let (n, m) = (limits.lower.len(), limits.row_lower.len());
        // SAFETY: the arrays have `n` and `m` numbers and are copied in the call.
        let handle = unsafe {
            create(
                one(n),
                limits.lower.as_mut_ptr(),
                limits.upper.as_mut_ptr(),
                one(m),
                limits.row_lower.as_mut_ptr(),
                limits.row_upper.as_mut_ptr(),
                one(jacobian),
                one(hessian),
                C_STYLE,
                eval_f,
                eval_g,
                eval_grad_f,
                eval_jac_g,
                eval_h,
            )
        };
        if handle.is_null() {
            return Err("IPOPT does not take a program of this size".into());
        }
        // SAFETY: the handle is valid.
        unsafe { set(handle, intermediate) };
        Ok(Problem { handle, free })
    }

    fn set(&self, problem: &Problem, name: &str, value: &Value) -> Result<(), String> {
        let refused = || format!("IPOPT does not take the option {name} = {value:?}");
        let key = CString::new(name).map_err(|_| refused())?;
        let key = key.as_ptr().cast_mut();
        // SAFETY: the strings end with a 0 and are copied; the C interface lacks `const` but changes nothing.
        let is_taken = match value {
            Value::Word(word) => {
                let word = CString::new(word.as_str()).map_err(|_| refused())?;
                let add: StrOption = self.function("AddIpoptStrOption")?;
                unsafe { add(problem.handle, key, word.as_ptr().cast_mut()) }
            }
            Value::Whole(number) => {
                let add: IntOption = self.function("AddIpoptIntOption")?;
                unsafe { add(problem.handle, key, *number) }
            }
            Value::Real(number) => {
                let add: NumOption = self.function("AddIpoptNumOption")?;
                unsafe { add(problem.handle, key, *number) }
            }
        };
        if is_taken { Ok(()) } else { Err(refused()) }
    }
}

fn one(number: usize) -> c_int {
    c_int::try_from(number).unwrap_or(c_int::MAX)
}

fn whole(numbers: &[usize]) -> Vec<c_int> {
    numbers.iter().map(|&number| one(number)).collect()
}

/// An array that IPOPT lends for the length of a callback; empty where it has none.
fn lent<'a>(first: Number, length: c_int) -> &'a mut [f64] {
    match usize::try_from(length) {
        // SAFETY: IPOPT passes arrays of the lengths that it says, and nothing else uses them meanwhile.
        Ok(length) if length > 0 && !first.is_null() => unsafe { slice::from_raw_parts_mut(first, length) },
        _ => &mut [],
    }
}

/// What `solve` passed as user data.
fn called<'a>(user: User) -> &'a mut Called<'a> {
    // SAFETY: `solve` passed a pointer to its `Called`, which it does not touch before IPOPT returns; callbacks
    // come one after the other.
    unsafe { &mut *user.cast::<Called<'a>>() }
}

extern "C" fn eval_f(n: c_int, x: Number, _new: bool, value: Number, user: User) -> bool {
    let Some(found) = called(user).evaluations.objective(lent(x, n)) else { return false };
    lent(value, 1)[0] = found;
    true
}

extern "C" fn eval_grad_f(n: c_int, x: Number, _new: bool, gradient: Number, user: User) -> bool {
    called(user).evaluations.gradient(lent(x, n), lent(gradient, n)).is_some()
}

extern "C" fn eval_g(n: c_int, x: Number, _new: bool, m: c_int, rows: Number, user: User) -> bool {
    called(user).evaluations.constraints(lent(x, n), lent(rows, m)).is_some()
}

/// Writes a pattern where IPOPT asks for one, which it does by passing no room for values.
fn pattern((rows, columns): &(Vec<c_int>, Vec<c_int>), to_rows: Index, to_columns: Index) {
    for (from, to) in [(rows, to_rows), (columns, to_columns)] {
        if !to.is_null() {
            // SAFETY: IPOPT's arrays have as many entries as the problem was made with, which is `from.len()`.
            unsafe { slice::from_raw_parts_mut(to, from.len()) }.copy_from_slice(from);
        }
    }
}

extern "C" fn eval_jac_g(
    n: c_int,
    x: Number,
    _new: bool,
    _m: c_int,
    entries: c_int,
    rows: Index,
    columns: Index,
    values: Number,
    user: User,
) -> bool {
    let called = called(user);
    if values.is_null() {
        pattern(&called.jacobian, rows, columns);
        return true;
    }
    called.evaluations.jacobian(lent(x, n), lent(values, entries)).is_some()
}

extern "C" fn eval_h(
    n: c_int,
    x: Number,
    _new: bool,
    objective: c_double,
    m: c_int,
    multipliers: Number,
    _new_multipliers: bool,
    entries: c_int,
    rows: Index,
    columns: Index,
    values: Number,
    user: User,
) -> bool {
    let called = called(user);
    if values.is_null() {
        pattern(&called.hessian, rows, columns);
        return true;
    }
    called.evaluations.hessian(lent(x, n), objective, lent(multipliers, m), lent(values, entries)).is_some()
}

extern "C" fn intermediate(
    _mode: c_int,
    iteration: c_int,
    _objective: c_double,
    _primal: c_double,
    _dual: c_double,
    _mu: c_double,
    _step: c_double,
    _regularisation: c_double,
    _alpha_dual: c_double,
    _alpha_primal: c_double,
    _trials: c_int,
    user: User,
) -> bool {
    called(user).iterations = usize::try_from(iteration).unwrap_or(0);
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_that_is_not_there_is_empty() {
        assert!(lent(std::ptr::null_mut(), 3).is_empty());
    }

    #[test]
    fn a_library_that_is_not_there_is_named() {
        let error = Ipopt::load(OsStr::new("libno_such_thing.so")).err().unwrap_or_default();
        assert!(error.contains("libno_such_thing.so"), "{error}");
    }
}
