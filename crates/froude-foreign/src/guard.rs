//! Runs a reader of others so that a panic inside of it is an error, without a word on the terminal.
//!
//! Hostile files bring readers to slice out of bounds. What they would allocate without bound is checked before they are called.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

use crate::ForeignError;

thread_local! {
    static IS_GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// What `read` returns, or an error with `what` if it panics: "the workbook", as in "the workbook is damaged".
///
/// # Errors
///
/// Those of `read`, and a panic of it.
pub(crate) fn guarded<T>(what: &str, read: impl FnOnce() -> Result<T, ForeignError>) -> Result<T, ForeignError> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let outer = take_hook();
        set_hook(Box::new(move |panic| {
            if !IS_GUARDED.get() {
                outer(panic);
            }
        }));
    });
    let was_guarded = IS_GUARDED.replace(true);
    let done = catch_unwind(AssertUnwindSafe(read));
    IS_GUARDED.set(was_guarded);
    done.unwrap_or_else(|_| {
        Err(ForeignError(format!(
            "{what} is damaged: its parts contradict each other; open it in the program that wrote it and save it again"
        )))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_of_a_reader_is_an_error() {
        let none: [u8; 0] = [];
        let done = guarded("the workbook", || Ok(none[std::hint::black_box(7)]));
        assert!(done.unwrap_err().0.starts_with("the workbook is damaged: its parts contradict"));
        assert_eq!(guarded("the workbook", || Ok(7)), Ok(7));
    }
}
