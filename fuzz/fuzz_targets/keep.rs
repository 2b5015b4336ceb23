//! Conditions on rows: no panic.
#![no_main]

use froude_records::keep::parse_keep;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match parse_keep(text) {
        Ok(keep) => assert!(!keep.clauses.is_empty()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
