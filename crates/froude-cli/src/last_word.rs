//! The last message of a run that ends abnormally: an internal error, or no memory left.
//!
//! Whatever the input, the program ends with a sentence and with 0, 1 or 2; never with a trace, never by a signal of its own.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write as _;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use froude::records::memory;

/// Where the latest fault was, for the sentence; a fault that somebody catches and answers is not shown.
static LATEST: Mutex<String> = Mutex::new(String::new());

/// Runs the job; a panic, on whatever thread of it, ends with a sentence that says what to send and to whom.
pub fn guarded(job: impl FnOnce() -> ExitCode) -> ExitCode {
    std::panic::set_hook(Box::new(|panic| {
        *LATEST.lock().unwrap_or_else(PoisonError::into_inner) = in_words(panic);
    }));
    catch_unwind(AssertUnwindSafe(job)).unwrap_or_else(|_| {
        let fault = LATEST.lock().unwrap_or_else(PoisonError::into_inner).clone();
        crate::out::note!("froude: {}", sentence(&fault));
        ExitCode::FAILURE
    })
}

/// The message about a fault: whose it is, and what to do.
fn sentence(fault: &str) -> String {
    if NO_THREAD.iter().any(|words| fault.contains(words)) {
        return "the machine gives the program no more threads: its memory or its number of processes is used up. Results that were not \
                finished are not written. Close other programs, or set RAYON_NUM_THREADS=1"
            .to_owned();
    }
    format!(
        "the program stopped on an internal error: {fault}. Results that were not finished are not written. Please send this message, the \
         command, and the files that it was given to {}/issues (froude {})",
        env!("CARGO_PKG_REPOSITORY"),
        env!("CARGO_PKG_VERSION")
    )
}

/// The words of the standard library and of the thread pool where the system refuses a thread.
const NO_THREAD: [&str; 2] = ["failed to spawn thread", "ThreadPoolBuildError"];

/// What a panic says and where, in one line.
fn in_words(panic: &PanicHookInfo<'_>) -> String {
    let text = panic.payload_as_str().unwrap_or("no words");
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match panic.location() {
        Some(place) => format!("{text} ({}, line {})", source(place.file()), place.line()),
        None => text,
    }
}

/// A source file as anybody names it: the folder of libraries on the machine that built the program says nothing.
fn source(file: &str) -> &str {
    let library = file.split_once("/registry/src/").and_then(|(_, rest)| rest.split_once('/'));
    library.map_or(file, |(_, rest)| rest)
}

/// The system's allocator; where it has nothing left, the program ends with a sentence.
///
/// What allocates for an input asks first ([`memory::reserve`]) and names the file itself.
pub struct Asking;

#[global_allocator]
static MEMORY: Asking = Asking;

// SAFETY: every call goes to the system's allocator unchanged; a null pointer is returned as it came, or never.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Asking {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise.
        granted(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise.
        granted(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, old: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        // SAFETY: the caller's promise.
        granted(unsafe { System.realloc(old, layout, bytes) }, bytes)
    }

    unsafe fn dealloc(&self, old: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(old, layout) }
    }
}

#[inline]
fn granted(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() && !memory::is_asked_for() {
        exhausted(bytes);
    }
    memory
}

/// Says it without allocating, and ends.
#[cold]
fn exhausted(bytes: usize) -> ! {
    let _ = writeln!(
        std::io::stderr(),
        "froude: the machine has no memory left: {bytes} bytes more were asked for. Results that were not finished are not written. Give the \
         program more memory, or a smaller input"
    );
    std::process::exit(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On its own thread and on those of the pool that computes; no trace is printed, the exit code says that it failed.
    #[test]
    fn a_panic_on_any_thread_of_the_job_ends_with_a_sentence_and_1() {
        let jobs: [fn() -> ExitCode; 2] =
            [|| panic!("at  the\njob"), || rayon::join(|| panic!("at the pool"), || ExitCode::SUCCESS).1];
        for (job, words) in jobs.into_iter().zip(["at the job", "at the pool"]) {
            assert_eq!(format!("{:?}", guarded(job)), format!("{:?}", ExitCode::FAILURE));
            let fault = LATEST.lock().unwrap().clone();
            assert!(fault.starts_with(&format!("{words} (crates/froude-cli/src/last_word.rs, line ")), "{fault}");
            let told = sentence(&fault);
            assert!(told.starts_with("the program stopped on an internal error: at the "), "{told}");
            assert!(told.ends_with("/issues (froude 0.1.0)") && !told.contains('\n'), "{told}");
        }
        let _ = std::panic::take_hook();
    }

    #[test]
    fn a_library_is_named_without_the_folders_of_the_machine_that_built_it() {
        assert_eq!(
            source("/home/x/.cargo/registry/src/some-host-1234/statrs-0.19.0/src/beta.rs"),
            "statrs-0.19.0/src/beta.rs"
        );
        assert_eq!(source("crates/froude-fit/src/lib.rs"), "crates/froude-fit/src/lib.rs");
    }
}
