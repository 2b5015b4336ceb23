//! Lines on standard output and standard error. Here alone text reaches a terminal, and here it is made harmless: names, cells, paths
//! and messages of other programs may hold a terminal's commands, and are shown as text.

use std::io::{IsTerminal as _, Write as _};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use clap::CommandFactory as _;
use clap::builder::Styles;
use froude::records::question::Question;
use froude::records::text::visible;
use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};

use crate::args::Cli;

/// What is done does not end with whoever reads about it.
static GOES_ON_UNREAD: AtomicBool = AtomicBool::new(false);

/// From now on a reader that goes away ends nothing: for verbs that do more than print. Who drives a carriage neither stops half way nor leaves it
/// undriven and calls that done, because `| head -1` has seen enough.
pub fn go_on_unread() {
    GOES_ON_UNREAD.store(true, Ordering::Relaxed);
}

/// Prints a line; ends quietly when nobody reads any more (`froude … | head`), and says so when standard output fails.
pub fn line(text: std::fmt::Arguments<'_>) {
    if let Err(error) = writeln!(std::io::stdout(), "{}", visible(&text.to_string())) {
        if error.kind() == std::io::ErrorKind::BrokenPipe {
            if GOES_ON_UNREAD.load(Ordering::Relaxed) {
                return;
            }
            std::process::exit(0);
        }
        error_line(format_args!("froude: cannot write to standard output: {error}"));
        std::process::exit(1);
    }
}

/// Prints a line on standard error; where that is closed nobody can be reached.
pub fn error_line(text: std::fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{}", visible(&text.to_string()));
}

/// `println!` that does not panic.
macro_rules! say {
    ($($text:tt)*) => { $crate::out::line(format_args!($($text)*)) };
}
/// `eprintln!` that does not panic.
macro_rules! note {
    ($($text:tt)*) => { $crate::out::error_line(format_args!($($text)*)) };
}
pub(crate) use {note, say};

/// Help and version, or why the command line was not understood: it quotes what was written.
pub fn usage(error: &clap::Error) -> ExitCode {
    if error.use_stderr() {
        // Said again without clap's colours: every escape that is left was written by somebody else.
        let plain = Cli::command().styles(Styles::plain()).try_get_matches().err();
        error_line(format_args!("{}", plain.as_ref().unwrap_or(error).render().ansi().to_string().trim_end()));
    } else if error.print().is_err() {
        return ExitCode::FAILURE;
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}

/// Asks the person at the terminal which of several readings is meant; `None` where nobody is there, or they do not choose one.
pub fn ask(question: &Question) -> std::io::Result<Option<usize>> {
    if !std::io::stdin().is_terminal() || !std::io::stderr().is_terminal() {
        return Ok(None);
    }
    error_line(format_args!("{}:", question.problem));
    for (k, answer) in question.answers.iter().enumerate() {
        error_line(format_args!("  {}) {}", k + 1, answer.means));
    }
    error_line(format_args!("Which is it? Its number goes into {}; Enter alone ends.", question.sidecar.display()));
    let mut line = String::new();
    std::io::stdin().read_line(&mut line)?;
    Ok(line.trim().parse::<usize>().ok().and_then(|k| k.checked_sub(1)).filter(|k| *k < question.answers.len()))
}

/// How often a file or a pipe hears what a spinner shows.
const UNSEEN: Duration = Duration::from_secs(30);

/// A spinner on standard error, until it is dropped; where that is no terminal, a line every half a minute.
pub struct Spinner {
    bar: ProgressBar,
    /// When a line was last written, or the spinner began.
    written: Mutex<Instant>,
}

impl Spinner {
    pub fn new() -> Self {
        let bar = ProgressBar::new_spinner().with_finish(ProgressFinish::AndClear);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { bar, written: Mutex::new(Instant::now()) }
    }

    pub fn set_message(&self, step: impl Into<String>) {
        let step = step.into();
        if self.bar.is_hidden() {
            let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
            if written.elapsed() >= UNSEEN {
                *written = Instant::now();
                error_line(format_args!("{step}"));
            }
        }
        self.bar.set_message(visible(&step).into_owned());
    }

    /// Does something that writes lines of its own.
    pub fn suspend(&self, write: impl FnOnce()) {
        self.bar.suspend(write);
    }
}

/// How much of a long work is done, on standard error, until it is dropped; silent where that is no terminal.
pub struct Bar(ProgressBar);

impl Bar {
    /// Of things that are counted in the plural.
    pub fn of(what: &str) -> Self {
        let bar = ProgressBar::new(0).with_finish(ProgressFinish::AndClear);
        let template = format!("{{bar:30}} {{pos}} of {{len}} {what}, {{eta}} left");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    pub fn is_at(&self, done: usize, all: usize) {
        self.0.set_length(all as u64);
        self.0.set_position(done as u64);
    }
}
