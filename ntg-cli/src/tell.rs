//! Lines on standard error.

/// Prints a line to standard error. A reader that has gone away, as in `2>&1 | head -1`, is no error.
macro_rules! tell {
    ($($words:tt)*) => {{
        let _ = std::io::Write::write_fmt(&mut std::io::stderr(), format_args!("{}\n", format_args!($($words)*)));
    }};
}
