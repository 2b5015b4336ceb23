//! `froude new`: a commented campaign of one kind, with only the keys that matter.
//!
//! The files lie in `starters/` of this crate; a test runs each with the program, so that none goes stale.

use std::path::Path;

use crate::block::{Block, TableBuilder};
use crate::error::RecordError;
use crate::outcome::{Exit, Outcome};
use crate::write::write_atomically;

/// A kind of campaign.
#[derive(Debug, Clone, Copy)]
pub struct Starter {
    /// As it is asked for.
    pub kind: &'static str,
    /// What it is for.
    pub words: &'static str,
    /// Its files, by their names in the folder.
    files: &'static [(&'static str, &'static str)],
}

macro_rules! starter {
    ($kind:literal, $words:literal $(, $name:literal = $file:literal)*) => {
        Starter {
            kind: $kind,
            words: $words,
            files: &[
                ("campaign.toml", include_str!(concat!("../starters/", $kind, ".toml")))
                $(, ($name, include_str!(concat!("../starters/", $file))))*
            ],
        }
    };
}

/// All kinds.
pub const STARTERS: [Starter; 10] = [
    starter!("table", "steady forces over speed, a row per run"),
    starter!("drift", "forces and yaw moment over speed and drift angle, a row per run"),
    starter!("decay", "free-decay tests of a released body, one log each"),
    starter!("steady", "raw logs of steady tows, with a sidecar", "runs/run_01.toml" = "steady-run.toml"),
    starter!("carriage", "a towing carriage that Froude drives, on its twin"),
    starter!(
        "carriage-logs",
        "wet and dry tows of a carriage of your own, by its encoder and motor voltage",
        "logs/logs.toml" = "carriage-logs-sidecar.toml"
    ),
    starter!("openfoam", "force files of OpenFOAM cases that are computed already"),
    starter!("mesh", "added mass of a closed surface mesh"),
    starter!("servo", "inertia, friction and loads of a robot's joint or another axis, from its logs"),
    starter!("sway", "pure sway on a planar motion mechanism, with a sidecar", "runs/run_01.toml" = "sway-run.toml"),
];

/// The names of all kinds.
#[must_use]
pub fn kinds() -> Vec<&'static str> {
    STARTERS.iter().map(|starter| starter.kind).collect()
}

/// The kinds with what each is for, for a help text.
#[must_use]
pub fn help() -> String {
    let line = |starter: &Starter| format!("  {:<13} {}", starter.kind, starter.words);
    let lines: Vec<String> = STARTERS.iter().map(line).collect();
    format!("Kinds:\n{}\n\nExample: froude new decay --out buoy", lines.join("\n"))
}

/// Writes the files of a kind into a folder; refused where one of them exists.
///
/// They are the user's from then on: no list of Froude's own files has them.
///
/// # Errors
///
/// A file that cannot be written.
pub fn start(kind: &str, folder: &Path) -> Result<Outcome, RecordError> {
    let refused = |why: String| Ok(Outcome { exit: Exit::Refused(why), ..Outcome::default() });
    let Some(starter) = STARTERS.iter().find(|starter| starter.kind == kind) else {
        return refused(format!("there is no campaign of the kind {kind:?}; there are {}", kinds().join(", ")));
    };
    let place = |name: &str| folder.join(name);
    if let Some((name, _)) = starter.files.iter().find(|(name, _)| place(name).exists()) {
        let there = place(name).display().to_string();
        return refused(format!(
            "{there} exists and is not replaced; name another folder: froude new {kind} --out DIR"
        ));
    }
    for (name, text) in starter.files {
        let path = place(name);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(|e| RecordError::output(parent, &e))?;
        }
        write_atomically(&path, text.as_bytes())?;
    }
    let t = TableBuilder::new("files", "", starter.files);
    let table = t.build(vec![t.text("path", "", |(name, _)| place(name).display().to_string())]);
    let shown: Vec<String> = starter.files.iter().map(|(name, _)| place(name).display().to_string()).collect();
    let said = format!(
        "{}: {}. The first lines state the commands; every value is an example to replace.",
        shown.join(", "),
        starter.words
    );
    Ok(Outcome { blocks: vec![table.into(), Block::text("", vec![said])], ..Outcome::default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign_file::parse_campaign;

    #[test]
    fn every_campaign_is_read() {
        for starter in &STARTERS {
            parse_campaign(Path::new("lab/campaign.toml"), starter.files[0].1).unwrap();
            for (_, text) in starter.files {
                assert!(text.starts_with("# ") && text.lines().count() < 90, "{}", starter.kind);
            }
        }
        assert!(help().contains("\n  openfoam      force files"));
    }

    #[test]
    fn nothing_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("runs")).unwrap();
        std::fs::write(folder.path().join("runs/run_01.toml"), "mine").unwrap();
        let written = start("table", folder.path()).unwrap();
        assert_eq!(written.exit, Exit::Done);
        let schema = serde_json::to_string_pretty(&written.schema()).unwrap() + "\n";
        assert_eq!(Some(schema.trim_end()), crate::schema::of_verb("new"));
        assert_eq!(std::fs::read_to_string(folder.path().join("campaign.toml")).unwrap(), STARTERS[0].files[0].1);
        let Exit::Refused(why) = start("table", folder.path()).unwrap().exit else { panic!("replaced") };
        assert!(why.contains("campaign.toml exists and is not replaced"), "{why}");
        std::fs::remove_file(folder.path().join("campaign.toml")).unwrap();
        let Exit::Refused(why) = start("steady", folder.path()).unwrap().exit else { panic!("replaced") };
        assert!(!folder.path().join("campaign.toml").exists());
        assert!(
            why.ends_with("run_01.toml exists and is not replaced; name another folder: froude new steady --out DIR"),
            "{why}"
        );
        let Exit::Refused(why) = start("stedy", folder.path()).unwrap().exit else { panic!("unknown") };
        assert!(why.contains("there are table, drift, decay"), "{why}");
    }
}
