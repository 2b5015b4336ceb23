//! Random faults on random moves. The pipeline runs more of them, the validation 10⁵.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use froude_rig::catalogue::Catalogue;
use std::collections::BTreeMap;

/// Runs in a test.
const RUNS: u64 = 5_000;

#[test]
fn every_injected_fault_is_told_in_time_and_the_carriage_stays_inside() {
    let catalogue = Catalogue::new().unwrap();
    let mut told: BTreeMap<String, (u32, f64)> = BTreeMap::new();
    let mut refused = Vec::new();
    for seed in 0..RUNS {
        let outcome = catalogue.run(seed);
        let name = format!("{:?}", outcome.injection).split('(').next().unwrap_or_default().to_owned();
        let fault = outcome.detected.map_or_else(|| "nothing".to_owned(), |(fault, _)| format!("{fault:?}"));
        let row = told.entry(format!("{name}: {fault}")).or_default();
        *row = (row.0 + 1, row.1.max(outcome.detected.map_or(0.0, |(_, after_s)| after_s)));
        if !outcome.is_allowed() {
            refused.push((seed, outcome));
        }
    }
    for (what, (n, latest_s)) in &told {
        println!("{n:5}  {latest_s:.5} s  {what}");
    }
    let first: Vec<String> = refused.iter().take(12).map(|r| format!("{r:?}")).collect();
    assert!(refused.is_empty(), "{} of {RUNS}:\n{}", refused.len(), first.join("\n"));
}
