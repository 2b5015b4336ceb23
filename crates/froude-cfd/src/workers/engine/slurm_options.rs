//! What is asked of a Slurm cluster, in the words of `sbatch`.

use std::path::Path;
use std::time::Duration;

use crate::engine::slurm_ledger::Submission;

/// A time limit is so many times what is expected, never below [`LEAST_LIMIT_MIN`], and twice as long after each job that was lost.
const LIMIT_FACTOR: f64 = 4.0;
const LEAST_LIMIT_MIN: f64 = 5.0;

/// What is asked of the cluster.
#[derive(Debug, Clone, PartialEq)]
pub struct SlurmOptions {
    /// The program and its words before the folders of cases: `["/usr/bin/froude", "cfd", "case"]`.
    pub program: Vec<String>,
    /// Partition; `None`: the cluster's own choice.
    pub partition: Option<String>,
    /// Memory of a task, MiB; `None`: the cluster's own choice.
    pub memory_mib: Option<u64>,
    /// Time limit of a task, min; `None`: by what its cases are expected to cost.
    pub time_limit_min: Option<u32>,
    /// Ranks of MPI of each case, on one node.
    pub ranks: usize,
    /// Time that the cases of a task are expected to take together, s.
    pub task_s: f64,
    /// Jobs that may end without a result of a case before it is left.
    pub tries: usize,
    /// Time between two looks at the queue.
    pub poll: Duration,
    /// Further words for `sbatch`: `--account=…`.
    pub more: Vec<String>,
}

impl SlurmOptions {
    /// The usual ones: tasks of ten minutes on one core, three tries, a look every ten seconds.
    #[must_use]
    pub fn new(program: Vec<String>) -> Self {
        Self {
            program,
            partition: None,
            memory_mib: None,
            time_limit_min: None,
            ranks: 1,
            task_s: 600.0,
            tries: 3,
            poll: Duration::from_secs(10),
            more: Vec::new(),
        }
    }

    /// Time of processors that the cases of a task are expected to take together, s: a part of the time limit where there is one.
    pub(crate) fn task_cpu_s(&self) -> f64 {
        let limit_s = self.time_limit_min.map_or(f64::INFINITY, |min| 60.0 * f64::from(min) / LIMIT_FACTOR);
        self.task_s.min(limit_s) * self.ranks.max(1) as f64
    }

    /// Words for `sbatch`, where the longest task is expected to take so much time of processors, and so many jobs were lost with its cases before.
    pub(crate) fn arguments(
        &self,
        root: &Path,
        submission: &Submission,
        longest_cpu_s: f64,
        lost: usize,
    ) -> Vec<String> {
        let ranks = self.ranks.max(1);
        let limit_min = LIMIT_FACTOR * longest_cpu_s / ranks as f64 / 60.0;
        let limit_min = limit_min.ceil().max(LEAST_LIMIT_MIN) * 2_f64.powi(lost as i32);
        let limit_min = self.time_limit_min.unwrap_or(limit_min as u32);
        let mut arguments = vec![
            "--parsable".to_owned(),
            "--requeue".to_owned(),
            "--open-mode=append".to_owned(),
            format!("--job-name={}", submission.name),
            format!("--array=0-{}", submission.tasks.len().saturating_sub(1)),
            format!("--ntasks={ranks}"),
            "--nodes=1".to_owned(),
            format!("--time={limit_min}"),
            format!("--chdir={}", root.display()),
            format!("--output={}", submission.log("%a")),
        ];
        arguments.extend(self.partition.iter().map(|p| format!("--partition={p}")));
        arguments.extend(self.memory_mib.iter().map(|m| format!("--mem={m}M")));
        arguments.extend(self.more.iter().cloned());
        arguments.push(root.join(submission.script()).display().to_string());
        arguments
    }
}
