//! What Slurm is asked, and what its programs answer.
//!
//! Slurm is asked only whether a job still lives: it forgets jobs some minutes after their end, and its accounts, where there are any, lag behind.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::input;
use crate::store_error::StoreError;

/// Tasks of an array where the cluster does not say how many there may be: Slurm's own default.
const USUAL_ARRAY: usize = 1001;

/// A task of an array: the job's number and its own.
pub(crate) type TaskId = (u64, usize);

/// What Slurm knows of a task.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TaskState {
    /// `PENDING`, `RUNNING`, …
    pub state: String,
    /// Why it waits or ended.
    pub reason: String,
}

impl TaskState {
    /// Whether it may still come to a result. States that are not known here count as alive.
    pub fn is_alive(&self) -> bool {
        const ENDED: [&str; 10] = [
            "BOOT_FAIL",
            "CANCELLED",
            "COMPLETED",
            "DEADLINE",
            "FAILED",
            "NODE_FAIL",
            "OUT_OF_MEMORY",
            "PREEMPTED",
            "REVOKED",
            "TIMEOUT",
        ];
        !ENDED.contains(&self.state.as_str()) && !self.is_stuck()
    }

    /// Put back by Slurm after a node did not start it, and held until somebody releases it.
    pub fn is_stuck(&self) -> bool {
        self.state == "PENDING" && self.reason.replace('_', " ").contains("launch failed requeued held")
    }
}

/// The most tasks of one array.
pub(crate) fn largest_array() -> Result<usize, StoreError> {
    let config = ask("scontrol", &["show", "config"])?;
    Ok(array_size_in(&config).unwrap_or(USUAL_ARRAY).max(1))
}

/// Of `MaxArraySize            = 1001`: indices go up to one less.
fn array_size_in(config: &str) -> Option<usize> {
    config.lines().find_map(|line| {
        let (name, value) = line.split_once('=')?;
        (name.trim() == "MaxArraySize").then(|| value.trim().parse().ok())?
    })
}

/// All that is known of the tasks of jobs with these names.
pub(crate) fn tasks(names: &[String]) -> Result<BTreeMap<TaskId, TaskState>, StoreError> {
    if names.is_empty() {
        return Ok(BTreeMap::new());
    }
    let names = format!("--name={}", names.join(","));
    let said = ask("squeue", &["--noheader", "--array", "--states=all", &names, "--format=%F|%K|%T|%r"])?;
    Ok(said.lines().filter_map(task_in).collect())
}

/// Of `17|3|PENDING|Resources`.
fn task_in(line: &str) -> Option<(TaskId, TaskState)> {
    let mut fields = line.trim().splitn(4, '|');
    let job = fields.next()?.trim().parse().ok()?;
    let task = fields.next()?.trim().parse().ok()?;
    let state = fields.next()?.trim().to_owned();
    let reason = fields.next().unwrap_or_default().trim().to_owned();
    Some(((job, task), TaskState { state, reason }))
}

/// Number of the job of this name that is queued or runs.
pub(crate) fn job_named(name: &str) -> Result<Option<u64>, StoreError> {
    let said = ask("squeue", &["--noheader", "--states=all", &format!("--name={name}"), "--format=%F"])?;
    Ok(said.lines().find_map(|line| line.trim().parse().ok()))
}

/// Submits, the number of the job written to a file by `sbatch` itself: it stands there even where this process is killed meanwhile.
pub(crate) fn submit(arguments: &[String], number: &Path) -> Result<u64, StoreError> {
    let failed = |problem: String| StoreError::Refused(format!("sbatch: {problem}"));
    let file = File::create(number).map_err(|e| StoreError::file(number, e))?;
    let mut command = Command::new("sbatch");
    command.args(arguments).stdin(Stdio::null()).stdout(file).stderr(Stdio::piped());
    let output = command.output().map_err(|e| failed(absent(&e)))?;
    if !output.status.success() {
        return Err(failed(String::from_utf8_lossy(&output.stderr).trim().to_owned()));
    }
    let text = input::text(number).map_err(|e| StoreError::file(number, e))?;
    number_in(&text).ok_or_else(|| failed(format!("it said {text:?}, and a number was expected")))
}

/// Of `17` or `17;cluster`.
pub(crate) fn number_in(text: &str) -> Option<u64> {
    text.trim().split(';').next()?.parse().ok()
}

/// Cancels jobs or tasks: `17`, `17_3`.
pub(crate) fn cancel(jobs: &[String]) -> Result<(), StoreError> {
    if jobs.is_empty() {
        return Ok(());
    }
    let jobs: Vec<&str> = jobs.iter().map(String::as_str).collect();
    ask("scancel", &jobs).map(drop)
}

fn ask(program: &str, arguments: &[&str]) -> Result<String, StoreError> {
    let failed = |problem: String| StoreError::Refused(format!("{program}: {problem}"));
    let output = Command::new(program).args(arguments).stdin(Stdio::null()).output().map_err(|e| failed(absent(&e)))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    Err(failed(String::from_utf8_lossy(&output.stderr).trim().to_owned()))
}

fn absent(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => {
            "there is no such program on PATH; run this on a host of the cluster that jobs are submitted from"
                .to_owned()
        }
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn lines_of_the_queue_are_read() {
        let (id, task) = task_in("17|3|PENDING|launch failed requeued held").unwrap();
        assert_eq!(id, (17, 3));
        assert!(!task.is_alive() && task.is_stuck());
        assert!(task_in("18|0|COMPLETING|None").unwrap().1.is_alive());
        assert!(!task_in("18|0|NODE_FAIL|None").unwrap().1.is_alive());
        assert_eq!(task_in("18|N/A|RUNNING|None"), None);
        assert_eq!(array_size_in("MaxArraySize            = 10001\nMaxJobCount = 2"), Some(10001));
        assert_eq!((number_in("17\n"), number_in("17;far\n"), number_in("")), (Some(17), Some(17), None));
    }

    proptest! {
        #[test]
        fn no_answer_breaks_a_reader(text in "\\PC*") {
            let _ = (task_in(&text), array_size_in(&text), number_in(&text));
        }
    }
}
