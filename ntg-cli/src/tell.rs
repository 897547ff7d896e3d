//! Lines on standard error.

/// Prints a line to standard error, folded where that is a terminal. A reader that has gone away, as in `2>&1 | head -1`,
/// is no error.
macro_rules! tell {
    ($($words:tt)*) => {{
        let said = crate::terminal::folded(&format!($($words)*), crate::terminal::width_of_errors());
        let _ = std::io::Write::write_fmt(&mut std::io::stderr(), format_args!("{said}\n"));
    }};
}
