//! Wall and processor time, and memory.

use std::time::Instant;

use rustix::time::{ClockId, clock_gettime};

use crate::Outcome;

/// What one case took and gave.
pub struct Row {
    wall_s: Vec<f64>,
    cpu_s: Vec<f64>,
    extra_mib: f64,
    values: Vec<f64>,
}

/// Runs a case once to warm up, then `runs` times.
pub fn measure(runs: usize, case: impl Fn() -> Outcome<Vec<f64>>) -> Outcome<Row> {
    let before = peak_mib();
    let mut row = Row { wall_s: Vec::new(), cpu_s: Vec::new(), extra_mib: 0.0, values: case()? };
    for _ in 0..runs {
        let (wall, cpu) = (Instant::now(), cpu_s());
        row.values = case()?;
        row.cpu_s.push(cpu_s() - cpu);
        row.wall_s.push(wall.elapsed().as_secs_f64());
    }
    row.extra_mib = peak_mib() - before;
    Ok(row)
}

/// Processor time of the whole process, user and system.
fn cpu_s() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Peak resident memory so far.
fn peak_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kib.unwrap_or(f64::NAN) / 1024.0
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

impl Row {
    pub fn json(&self, case: &str, threads: usize) -> String {
        let values: Vec<String> = self.values.iter().map(|value| format!("{value:e}")).collect();
        format!(
            "{{\"tool\": \"froude\", \"case\": \"{case}\", \"threads\": {threads}, \"wall_s\": {:e}, \
             \"wall_median_s\": {:e}, \"cpu_s\": {:e}, \"extra_mib\": {:.1}, \"values\": [{}]}}",
            least(&self.wall_s),
            median(&self.wall_s),
            least(&self.cpu_s),
            self.extra_mib,
            values.join(", ")
        )
    }
}
