//! Memory for what an input asks for: had, or refused with a sentence.
//!
//! A buffer whose size an input decides is reserved here before it is filled. What the program needs beside is small; where the machine
//! has not even that, the program's allocator says so and ends.

use std::cell::Cell;

thread_local! {
    /// Whether this thread is asking and takes no for an answer.
    static IS_ASKING: Cell<bool> = const { Cell::new(false) };
}

/// Whether the allocation under way may fail: then whoever asked says what it was for.
#[must_use]
pub fn is_asked_for() -> bool {
    IS_ASKING.try_with(Cell::get).unwrap_or(false)
}

/// Room for `more` elements.
///
/// # Errors
///
/// [`Exhausted`] where the machine has not so much memory.
pub fn reserve<T>(buffer: &mut Vec<T>, more: usize) -> Result<(), Exhausted> {
    let was = IS_ASKING.replace(true);
    let done = buffer.try_reserve(more);
    IS_ASKING.set(was);
    done.map_err(|_| Exhausted {
        bytes: (buffer.len() as u64).saturating_add(more as u64).saturating_mul(size_of::<T>() as u64),
    })
}

/// An element more; the buffer grows as a `Vec` does.
///
/// # Errors
///
/// [`Exhausted`] where the machine has not so much memory.
#[inline]
pub fn push<T>(buffer: &mut Vec<T>, element: T) -> Result<(), Exhausted> {
    if buffer.len() == buffer.capacity() {
        reserve(buffer, 1)?;
    }
    buffer.push(element);
    Ok(())
}

/// The machine has not as much memory as an input needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("it needs {} MiB of memory at once, and the machine has not so much left", .bytes.div_ceil(1 << 20))]
pub struct Exhausted {
    /// Bytes that were asked for.
    pub bytes: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_had_is_an_error_with_its_size() {
        let mut buffer: Vec<u64> = Vec::new();
        let error = reserve(&mut buffer, 1 << 58).unwrap_err();
        assert_eq!(
            error.to_string(),
            "it needs 2199023255552 MiB of memory at once, and the machine has not so much left"
        );
        assert!(!is_asked_for(), "only while it asks");
        push(&mut buffer, 7).unwrap();
        assert_eq!(buffer, [7]);
    }
}
