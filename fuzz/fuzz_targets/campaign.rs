//! Campaigns with the sections of their methods: no panic, and every error has its words.
#![no_main]

use std::path::Path;

use froude::Error;
use froude::pipeline::check_sections;
use froude::records::campaign_file::parse_campaign;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let read = parse_campaign(Path::new("campaign.toml"), text).map_err(Error::from);
    if let Err(error) = read.and_then(|campaign| check_sections(&campaign)) {
        assert!(error.to_string().starts_with("campaign.toml"), "{error}");
    }
});
