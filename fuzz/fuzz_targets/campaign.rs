//! Campaigns: no panic, and every error has its words.
#![no_main]

use std::path::Path;

use froude_records::campaign::parse_campaign;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Err(error) = parse_campaign(Path::new("campaign.toml"), text) {
        assert!(error.to_string().starts_with("campaign.toml"), "{error}");
    }
});
