//! Sidecars and the scales in them, over a small table: no panic.
#![no_main]

use std::path::Path;

use froude_records::csv_table::parse_csv;
use froude_records::scale::Scale;
use froude_records::sidecar::parse_sidecar;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = Scale::parse(text);
    if let Ok(sidecar) = parse_sidecar(Path::new("tank.toml"), text) {
        let _ = parse_csv(Path::new("tank.csv"), "a,b,speed\n1,2,0.5\n3,x,0.6\n", Some(&sidecar));
    }
});
