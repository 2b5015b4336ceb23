//! Where the results of a fit lie.

use indexmap::IndexMap;

pub use froude_records::results::{can_be_written, spares};

/// The program that makes a record.
pub(crate) fn versions() -> IndexMap<String, String> {
    IndexMap::from([("froude".to_owned(), env!("CARGO_PKG_VERSION").to_owned())])
}
