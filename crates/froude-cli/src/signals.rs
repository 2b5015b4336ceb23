//! Signals: the program removes what it has not finished, says why it ends, and exits with 128 plus the signal's number, as a shell reports it.
//!
//! A verb that stops by itself (a drive, computed flows) takes over; everything else leaves at once. The code of Ctrl-C is 130 for every verb.

use std::io::{IsTerminal as _, Read as _};
use std::os::unix::net::UnixStream;
use std::process::exit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXCPU, SIGXFSZ};
use signal_hook::{flag, low_level::pipe};

/// Exit code of what was stopped by Ctrl-C.
pub const STOPPED: u8 = 130;

/// A verb stops by itself when it is asked to.
static IS_TAKEN_OVER: AtomicBool = AtomicBool::new(false);
/// The program is about to exit.
static IS_LEAVING: AtomicBool = AtomicBool::new(false);

/// Watches signals from now on. Where the system gives no thread or socket for it, they end the program as they always do.
pub fn watch() -> std::io::Result<()> {
    let latest = Arc::new(AtomicUsize::new(0));
    let (mut woken, wake) = UnixStream::pair()?;
    let signal = Arc::clone(&latest);
    std::thread::Builder::new().name("signals".to_owned()).stack_size(1 << 18).spawn(move || {
        let mut byte = [0];
        while woken.read_exact(&mut byte).is_ok() {
            let signal = signal.load(Ordering::SeqCst) as i32;
            if signal == SIGXCPU || !IS_TAKEN_OVER.load(Ordering::SeqCst) {
                leave(signal);
            }
        }
    })?;
    for signal in [SIGINT, SIGTERM, SIGHUP, SIGXCPU] {
        flag::register_usize(signal, Arc::clone(&latest), signal as usize)?;
        pipe::register(signal, wake.try_clone()?)?;
    }
    // A write beyond the limit of `ulimit -f` fails then, and whoever writes says so.
    flag::register(SIGXFSZ, Arc::default())?;
    Ok(())
}

/// The verb stops by itself from now on.
pub fn take_over() {
    IS_TAKEN_OVER.store(true, Ordering::SeqCst);
}

/// What the verb does next may end at once.
pub fn give_back() {
    IS_TAKEN_OVER.store(false, Ordering::SeqCst);
}

/// Waits for the end where the program is leaving: what fails in the meantime fails because its files are gone.
pub fn wait_if_leaving() {
    while IS_LEAVING.load(Ordering::SeqCst) {
        std::thread::park();
    }
}

fn leave(signal: i32) -> ! {
    IS_LEAVING.store(true, Ordering::SeqCst);
    froude::records::unfinished::abandon();
    let (why, code) = match signal {
        SIGINT => ("stopped by Ctrl-C", i32::from(STOPPED)),
        SIGTERM => ("stopped by SIGTERM", 128 + SIGTERM),
        SIGHUP => ("the terminal was closed", 128 + SIGHUP),
        _ => ("the limit of processor time (ulimit -t) is used up", 1),
    };
    // Behind what a spinner has drawn.
    let line = if std::io::stderr().is_terminal() { "\n" } else { "" };
    crate::out::error_line(format_args!("{line}froude: {why}; results that were not finished are not written"));
    exit(code)
}
