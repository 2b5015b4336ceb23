//! Small campaigns, and a solver that does in milliseconds what a real one does in minutes.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, clippy::panic, clippy::manual_assert, reason = "a test breaks off")]

use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use froude_cfd::case::{Case, Flow, Model, Reference, Stop, Water};
use froude_cfd::outcome::{Outcome, Status};
use froude_cfd::store::Store;
use froude_cfd::work::{Solve, Task};

pub const ITERATIONS: usize = 10;
pub const CELLS: usize = 1000;

pub fn case(id: &str, speed_m_s: f64, start_from: Option<&str>) -> Case {
    Case {
        id: id.to_owned(),
        configuration: "H3LT".to_owned(),
        mesh: "0123abcd".to_owned(),
        is_half: true,
        flow: Flow { speed_m_s, angle_rad: 0.3, pitch_rad: 0.0 },
        water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
        model: Model::Laminar,
        stop: Stop { iterations: ITERATIONS, window: 5, drift: 1e-3, spread: 1e-2 },
        reference: Reference { length_m: 1.0, width_m: 0.1, area_m2: 0.09, point_m: [0.0; 3] },
        start_from: start_from.map(str::to_owned),
    }
}

/// Chains of three cases, `a000`, `a001`, `a002`, each from the one before.
pub fn chains(count: usize) -> Vec<Case> {
    (0..3 * count)
        .map(|k| {
            let from = (k % 3 > 0).then(|| format!("a{:03}", k - 1));
            case(&format!("a{k:03}"), 0.02 + 0.01 * k as f64, from.as_deref())
        })
        .collect()
}

/// A solver whose force is the square of the speed; its faults are asked for by the names of the cases.
#[derive(Default)]
pub struct Stub {
    pub takes: Duration,
    pub diverges: Vec<&'static str>,
    pub fails: Vec<&'static str>,
    pub panics: Vec<&'static str>,
    pub is_infinite: Vec<&'static str>,
    /// Bytes that it writes.
    pub writes: usize,
}

impl Solve for Stub {
    fn solve(&self, task: &Task<'_>) -> Result<Outcome, String> {
        let is = |names: &[&str]| names.contains(&task.case.id.as_str());
        if let Some(from) = task.start_from {
            std::fs::read(from.join("fields")).map_err(|e| format!("no fields to start from: {e}"))?;
        }
        if is(&self.panics) {
            panic!("index out of range");
        }
        if is(&self.fails) {
            return Err("simpleFoam ended with 1".to_owned());
        }
        let start = Instant::now();
        for iteration in 1..=ITERATIONS {
            while start.elapsed() < self.takes * iteration as u32 / ITERATIONS as u32 {
                if task.cancel.load(Ordering::SeqCst) {
                    return Err("killed".to_owned());
                }
                std::thread::sleep(Duration::from_micros(200));
            }
            (task.tell)(iteration);
        }
        std::fs::write(task.attempt.join("fields"), vec![b'0'; self.writes]).map_err(|e| e.to_string())?;
        let status = if is(&self.diverges) { Status::Diverged } else { Status::Converged };
        let force_n = if is(&self.is_infinite) { f64::INFINITY } else { -task.case.flow.speed_m_s.powi(2) };
        Ok(Outcome {
            status,
            reason: "as the test wants it".to_owned(),
            loads: Some([force_n, 0.0, 0.0, 0.0, 0.0, 0.0]),
            pressure: None,
            std_iterative: Some([1e-3; 6]),
            iterations: ITERATIONS,
            cpu_s: 1e-6 * (CELLS * ITERATIONS) as f64,
            y_plus: Some([0.1, 1.0, 2.0]),
            mesh: None,
            start_from: None,
            cells: CELLS,
            solver_version: "stub".to_owned(),
        })
    }
}

/// Runs a campaign on this machine, and nothing cancels it.
pub fn run(store: &Store, solver: &Stub, jobs: usize) -> froude_cfd::engine::Ran {
    let cancel = std::sync::atomic::AtomicBool::new(false);
    froude_cfd::engine::local::run(store, solver, jobs, &cancel, &|_| {}).unwrap()
}

/// Asserts that each case has exactly one accepted result, which is that of its own inputs.
pub fn assert_whole(root: &Path) {
    let store = Store::open(root).unwrap();
    for id in store.ids() {
        let case = store.case(id).unwrap();
        let froude_cfd::store::State::Done(attempted) = store.state(id) else {
            panic!("{id}: {:?}", store.state(id));
        };
        let loads = attempted.outcome.loads.unwrap();
        assert_eq!(loads[0], -case.flow.speed_m_s.powi(2), "{id}");
        let folder = store.case_folder(id);
        let its = froude_cfd::result::attempt_folder(&folder, attempted.attempt).join("result.json");
        assert_eq!(std::fs::read(its).unwrap(), std::fs::read(folder.join("result.json")).unwrap(), "{id}");
    }
}
