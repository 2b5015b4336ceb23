//! What was submitted, on the disk before it is.
//!
//! ```text
//! CAMPAIGN/slurm/0001/name     of the job, which no other has
//! CAMPAIGN/slurm/0001/tasks    a line for each task: its cases
//! CAMPAIGN/slurm/0001/job.sh   what each task runs
//! CAMPAIGN/slurm/0001/number   the job's, written by sbatch
//! CAMPAIGN/slurm/0001/3.log    what task 3 printed
//! CAMPAIGN/slurm/0001/ended    none of its tasks is waited for any more
//! ```

use std::path::{Path, PathBuf};

use froude_records::folder::UnfinishedFolder;
use froude_records::hash::short_key;
use froude_records::write::write_atomically;

use crate::engine::slurm_queue::{self, number_in};
use crate::input;
use crate::store::is_name;
use crate::store_error::StoreError;

const LEDGER: &str = "slurm";

/// An array that was submitted, or was about to be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Submission {
    folder: PathBuf,
    /// Name of the job, which no other has.
    pub name: String,
    /// Cases of each task.
    pub tasks: Vec<Vec<String>>,
}

impl Submission {
    /// Writes down what is to be submitted.
    pub fn new(root: &Path, tasks: Vec<Vec<String>>, program: &[String]) -> Result<Self, StoreError> {
        let number = numbers(root)?.into_iter().max().unwrap_or(0) + 1;
        let folder = root.join(LEDGER).join(format!("{number:04}"));
        let made = UnfinishedFolder::beside(&folder)?;
        let lines: String = tasks.iter().map(|ids| ids.join(" ") + "\n").collect();
        write_atomically(&made.path().join("tasks"), lines.as_bytes())?;
        write_atomically(&made.path().join("job.sh"), script(number, program).as_bytes())?;
        let name = format!("froude-{}-{number:04}", short_key(root.as_os_str().as_encoded_bytes()));
        write_atomically(&made.path().join("name"), name.as_bytes())?;
        made.take_place()?;
        Ok(Self { folder, name, tasks })
    }

    /// Those of a campaign that tasks may still live of.
    pub fn open(root: &Path) -> Result<Vec<Self>, StoreError> {
        let mut numbers = numbers(root)?;
        numbers.sort_unstable();
        let mut open = Vec::new();
        for number in numbers {
            let folder = root.join(LEDGER).join(format!("{number:04}"));
            if folder.join("ended").exists() {
                continue;
            }
            let read = |file: &str| {
                let path = folder.join(file);
                input::text(&path).map_err(|e| StoreError::file(&path, e))
            };
            let (name, text) = (read("name")?, read("tasks")?);
            if !is_name(&name) {
                return Err(StoreError::file(&folder.join("name"), format!("{name:?} is no name of a job")));
            }
            let ids = |line: &str| line.split(' ').filter(|id| is_name(id)).map(str::to_owned).collect();
            open.push(Self { tasks: text.lines().map(ids).collect(), folder, name });
        }
        Ok(open)
    }

    /// Path of its script, as seen from the campaign.
    pub fn script(&self) -> String {
        self.place("job.sh")
    }

    /// Path of what a task prints, as seen from the campaign; of all tasks with `%a`.
    pub fn log(&self, task: &str) -> String {
        self.place(&format!("{task}.log"))
    }

    fn place(&self, file: &str) -> String {
        let number = self.folder.file_name().unwrap_or_default().to_string_lossy();
        format!("{LEDGER}/{number}/{file}")
    }

    /// The file that the job's number stands in.
    pub fn number_file(&self) -> PathBuf {
        self.folder.join("number")
    }

    /// Number of its job; where its writer was killed the queue is asked for its name.
    ///
    /// `None`: it was never submitted.
    pub fn number(&self) -> Result<Option<u64>, StoreError> {
        let text = input::text(&self.number_file()).unwrap_or_default();
        if let Some(number) = number_in(&text) {
            return Ok(Some(number));
        }
        let found = slurm_queue::job_named(&self.name)?;
        if let Some(number) = found {
            write_atomically(&self.number_file(), format!("{number}\n").as_bytes())?;
        }
        Ok(found)
    }

    /// Takes it back: it was not submitted.
    pub fn withdraw(&self) -> Result<(), StoreError> {
        std::fs::remove_dir_all(&self.folder).map_err(|e| StoreError::file(&self.folder, e))
    }

    /// Says that none of its tasks is waited for any more.
    pub fn end(&self) -> Result<(), StoreError> {
        Ok(write_atomically(&self.folder.join("ended"), b"")?)
    }
}

fn numbers(root: &Path) -> Result<Vec<u32>, StoreError> {
    let folder = root.join(LEDGER);
    std::fs::create_dir_all(&folder).map_err(|e| StoreError::file(&folder, e))?;
    input::numbers(&folder, ["", ""], u32::MAX)
}

/// Each task does the cases of its line, one behind another.
fn script(number: u32, program: &[String]) -> String {
    let words: String = program.iter().map(|word| format!("'{}' ", word.replace('\'', "'\\''"))).collect();
    format!(
        "#!/bin/sh\n\
         cases=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" {LEDGER}/{number:04}/tasks)\n\
         set --\n\
         for case in $cases; do set -- \"$@\" \"cases/$case\"; done\n\
         exec {words}\"$@\"\n"
    )
}
