//! Estimate records: no panic, and what is accepted can be written and read back.
#![no_main]

use std::path::Path;

use froude_records::json::parse_estimates;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let path = Path::new("estimate.json");
    if let Ok(file) = parse_estimates(path, text) {
        let written = serde_json::to_string(&file).expect("a record is JSON");
        assert_eq!(parse_estimates(path, &written).as_ref(), Ok(&file));
    }
});
