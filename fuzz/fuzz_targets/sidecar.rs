//! Sidecars and the scales in them, over a small table: no panic, and what is declared of the data is possible.
#![no_main]

use std::path::Path;

use froude_records::csv_table::parse_csv;
use froude_records::scale::Scale;
use froude_records::sidecar::parse_sidecar;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = Scale::parse(text);
    match parse_sidecar(Path::new("tank.toml"), text) {
        Ok(sidecar) => {
            let declared = &sidecar.run.declared;
            for frame in declared.frames.values() {
                // A rotation keeps lengths, to the digits that are asked for of each of its parents.
                let v = frame.in_body.turned([1.0, 2.0, -2.0]);
                assert!((v.iter().map(|x| x * x).sum::<f64>() - 9.0).abs() < 0.01 * declared.frames.len() as f64);
            }
            assert!(declared.clocks.values().all(|clock| clock.standard_s >= 0.0 && clock.skew.abs() < 1.0));
            assert!(declared.marks.iter().all(|mark| mark.from_s <= mark.to_s));
            assert!(declared.segments.iter().all(|segment| segment.from_s <= segment.to_s));
            if let Some(cell) = &declared.cell {
                assert!(cell.matrix.len() == cell.loads.len() && cell.matrix.iter().all(|row| row.len() == cell.columns.len()));
            }
            for column in sidecar.columns.values() {
                assert!(column.sensor.range.is_none_or(|[low, high]| low < high));
                assert!(column.sensor.resolution.is_none_or(|step| step > 0.0));
            }
            let _ = parse_csv(Path::new("tank.csv"), "a,b,speed\n1,2,0.5\n3,x,0.6\n", Some(&sidecar));
        }
        Err(error) => assert!(error.to_string().starts_with("tank.toml"), "{error}"),
    }
});
