//! A log with its sidecar, imported and conditioned as the tank methods do: no panic, and what is left is a run: full columns of finite numbers, times that
//! increase.
//!
//! The first two bytes (little endian) are the length of the sidecar, which follows; the rest is the CSV.
#![no_main]

use std::path::Path;

use froude_records::csv_table::parse_csv;
use froude_records::run::run_of_table;
use froude_records::sidecar::parse_sidecar;
use froude_tank::conditioning::condition;
use froude_tank::log::TankLog;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((length, rest)) = bytes.split_first_chunk::<2>() else { return };
    let at = usize::from(u16::from_le_bytes(*length)).min(rest.len());
    let (sidecar, log) = rest.split_at(at);
    let (Ok(sidecar), Ok(log)) = (std::str::from_utf8(sidecar), std::str::from_utf8(log)) else { return };
    let sidecar = match parse_sidecar(Path::new("run.toml"), sidecar) {
        Ok(sidecar) => sidecar,
        Err(error) => {
            assert!(error.to_string().starts_with("run.toml"), "{error}");
            return;
        }
    };
    let Ok(table) = parse_csv(Path::new("run.csv"), log, Some(&sidecar)) else { return };
    for method in ["steady", "forced_oscillation", "another"] {
        let Ok(run) = run_of_table(&table, Some(&sidecar)) else { return };
        let mut run = TankLog::from(run);
        if condition(&mut run, method).is_err() {
            continue;
        }
        assert!(run.log.time_s.windows(2).all(|w| w[0] < w[1]));
        for (name, channel) in &run.log.channels {
            assert_eq!(channel.values.len(), run.log.time_s.len(), "{name}");
        }
        assert!(run.declared.marks.iter().all(|mark| mark.from_s <= mark.to_s));
        assert!(run.done.iter().flat_map(|step| step.parameters.values()).all(|p| p.value.is_finite()));
    }
});
