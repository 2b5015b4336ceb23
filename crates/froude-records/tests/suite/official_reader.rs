//! What the official Python reader and its ROS 2 decoder find in a run is what was recorded.
//!
//! The figures are `golden/official_reader.json`; `golden/official_reader.py` made them.

use crate::common::{RATE_HZ, START_NS, layout, meta, row};
use froude_records::run::{EventKind, Packing, Recorder, RunStatus, read_run};

const GOLDEN: &str = include_str!("../golden/official_reader.json");
const TICKS: u64 = 2000;

#[test]
fn the_official_reader_finds_every_message_and_every_number() {
    let folder = tempfile::tempdir().unwrap();
    // Kept only where the golden figures are made again.
    let kept = std::env::var_os("FROUDE_TEST_KEEP").map(std::path::PathBuf::from);
    let folder = kept.as_deref().unwrap_or(folder.path());
    std::fs::create_dir_all(folder).unwrap();
    let mut recorder = Recorder::create(folder, meta("run"), layout(), Packing::Lz4).unwrap();
    for tick in 0..TICKS {
        recorder.record(tick, &row(tick)).unwrap();
    }
    recorder.event(1999, &EventKind::Warning, "over 60 °C").unwrap();
    let log = read_run(&recorder.finish(RunStatus::Complete).unwrap()).unwrap();

    let golden: serde_json::Value = serde_json::from_str(GOLDEN).unwrap();
    assert_eq!(golden["messages"], 4 * TICKS + 1);
    assert_eq!(golden["statuses"], serde_json::json!(["running", "complete"]));
    assert_eq!(golden["target_speed"], "0.55 m/s");
    let topics = [("/axis/y", "y/"), ("/axis/x", "x/"), ("/force", ""), ("/truth/y", "truth/y/")];
    let mut n_channels = 0;
    for (topic, prefix) in topics {
        let topic = &golden["topics"][topic];
        assert_eq!(topic["messages"], log.len());
        assert_eq!(topic["first_ns"], START_NS);
        assert_eq!(topic["last_ns"], START_NS + (1999.0 / RATE_HZ * 1e9) as u64);
        for (field, sum) in topic["sums"].as_object().unwrap() {
            let own: f64 = log.channels[&format!("{prefix}{field}")].values.iter().sum();
            // Both add the same 2000 numbers in the same order.
            assert_eq!(sum.as_f64().unwrap(), own, "{prefix}{field}");
            n_channels += 1;
        }
    }
    assert_eq!(n_channels, log.channels.len());
    assert_eq!(golden["topics"]["/events"]["texts"], serde_json::json!(["warning", "over 60 °C"]));
}
