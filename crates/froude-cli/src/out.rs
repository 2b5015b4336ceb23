//! Lines on standard output, without a panic when nobody reads them.

use std::io::Write as _;

/// Prints a line; ends quietly when nobody reads any more (`froude … | head`), and says so when standard output fails.
pub fn line(text: std::fmt::Arguments<'_>) {
    if let Err(error) = writeln!(std::io::stdout(), "{text}") {
        if error.kind() == std::io::ErrorKind::BrokenPipe {
            std::process::exit(0);
        }
        let _ = writeln!(std::io::stderr(), "froude: cannot write to standard output: {error}");
        std::process::exit(1);
    }
}

/// `println!` that does not panic.
macro_rules! say {
    ($($text:tt)*) => { $crate::out::line(format_args!($($text)*)) };
}
pub(crate) use say;

/// Says a line on standard error; where nobody reads that either, there is nobody to say it to.
pub fn aside(text: std::fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// `eprintln!` that does not panic.
macro_rules! tell {
    ($($text:tt)*) => { $crate::out::aside(format_args!($($text)*)) };
}
pub(crate) use tell;
