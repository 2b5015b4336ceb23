//! Reading whole files of other rooms' formats, with the errors of this one.

use std::path::Path;

use crate::error::{RecordError, read_bytes};

/// The bytes of a file of at most `limit`; `what` says in the message what kind of file it was read as.
///
/// # Errors
///
/// [`RecordError::Read`] and [`RecordError::TooLarge`].
pub fn whole(path: &Path, limit: u64, what: &'static str) -> Result<Vec<u8>, RecordError> {
    read_bytes(path, limit, what)
}
