//! Runs: any bytes give a run or an error, and what is read is a run: full columns of finite numbers, times that increase.
//!
//! The seeds are runs of three ticks: packed in each way, without checksums (so that what is inside a chunk can be
//! changed), and cut off.
#![no_main]

use std::io::Cursor;
use std::path::Path;

use froude_records::run::{RunReader, RunStatus};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let reader = RunReader::new(Path::new("run.mcap"), Cursor::new(bytes), None);
    if let Ok(log) = reader.and_then(RunReader::read_all) {
        for channel in log.channels.values() {
            assert_eq!(channel.values.len(), log.len());
            assert!(channel.values.iter().all(|x| x.is_finite()));
        }
        assert!(log.time_s.windows(2).all(|w| w[0] < w[1]));
        assert_ne!(log.meta.status, RunStatus::Running);
        assert!(log.lost.iter().all(|gap| !gap.text.is_empty()));
    }
});
