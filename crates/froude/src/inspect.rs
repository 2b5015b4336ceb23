//! `froude inspect`: what is in a file or a folder, and everything doubtful about it. Nothing is fitted.

use std::path::Path;

use froude_added_mass::options::Asked;
use froude_carriage::axis::source::Servo;
use froude_carriage::runs::inspect::{driven, folder, run, without_log};
pub use froude_identify::inspect::{BudgetFacts, ChannelFacts, ColumnFacts, Inspection, SourceFacts};
use froude_identify::inspect::{campaign, estimates, table};
use froude_records::campaign::Input;
use froude_records::{run::is_servo_log, sidecar_file::sidecar_path};
use froude_rig::carriage::declared;

use crate::{Error, method};

/// Inspects a table, a campaign, an estimate record or a run, by the ending of its name; a run also by its sidecar; a folder of
/// runs as a set.
///
/// # Errors
///
/// Whatever the reader of the format finds.
pub fn inspect(path: &Path, sidecar: Option<&Path>) -> Result<Inspection, Error> {
    if let Some(found) = froude_cfd::forces::inspect::inspect(path)? {
        return Ok(found);
    }
    if path.is_dir() {
        return Ok(folder(path)?);
    }
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    Ok(match ending.as_deref() {
        // A run's sidecar lies beside it and says less than the run itself.
        Some("toml") if path.with_extension("mcap").is_file() => run(&path.with_extension("mcap"))?,
        Some("toml") => match without_log(path) {
            Ok(none) => return Err(none.into()),
            Err(_) => of_campaign(path)?,
        },
        Some("json") => estimates(path)?,
        Some("mcap") if sidecar.is_none() && sidecar_path(path)?.is_none() => run(path)?,
        _ => table(path, sidecar)?,
    })
}

fn of_campaign(path: &Path) -> Result<Inspection, Error> {
    let (campaign, mut found) = campaign(path)?;
    found.facts.extend(declared(&campaign)?.iter().flat_map(driven));
    method::check_sections(&campaign)?;
    for (source, facts) in campaign.sources.iter().zip(&mut found.sources) {
        match &source.input {
            Input::Mesh(path) => drop(Asked::of_source(path, source)?),
            Input::Table(log) if !source.methods.is_empty() || is_servo_log(log, source.sidecar.as_deref())? => {
                let asked = method::of(source, None)?;
                Servo::check_log(source)?;
                facts.models = asked.into_iter().flat_map(|(_, names)| names).map(str::to_owned).collect();
            }
            _ => {}
        }
    }
    Ok(found)
}
