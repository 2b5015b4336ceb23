//! A run with its sidecar: whatever the two say, one gives a run or an error, and what is read is a run.
//!
//! The first two bytes (little endian) are the length of the sidecar, which follows; the rest is the log. The seeds are a sidecar
//! and a log of one run, whole and cut off.
#![no_main]

use std::io::Cursor;
use std::path::Path;

use froude_records::run::{RunReader, parse_run_meta};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((length, rest)) = bytes.split_first_chunk::<2>() else { return };
    let at = usize::from(u16::from_le_bytes(*length)).min(rest.len());
    let (sidecar, log) = rest.split_at(at);
    let Ok(sidecar) = std::str::from_utf8(sidecar) else { return };
    let meta = match parse_run_meta(Path::new("run.toml"), sidecar) {
        Ok(meta) => meta,
        Err(error) => {
            assert!(error.to_string().starts_with("run.toml"), "{error}");
            return;
        }
    };
    let reader = RunReader::new(Path::new("run.mcap"), Cursor::new(log), Some(meta.clone()));
    match reader.and_then(RunReader::read_all) {
        Ok(run) => {
            assert_eq!(run.meta.id, meta.id, "what the sidecar says goes before what the file says");
            for channel in run.channels.values() {
                assert_eq!(channel.values.len(), run.len());
                assert!(channel.values.iter().all(|x| x.is_finite()));
            }
            assert!(run.time_s.windows(2).all(|w| w[0] < w[1]));
        }
        Err(error) => assert!(error.to_string().starts_with("run.mcap"), "{error}"),
    }
});
