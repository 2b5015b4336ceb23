//! `[rig]` of the kind `logs`: what is known of a carriage whose runs another program recorded.
//!
//! ```toml
//! [rig]
//! kind = "logs"
//! force_per_volt = { value = "4.77 N/V", standard = "1 %" }   # or force_per_ampere
//! position_standard = "0.1 %"
//! ballasted = true
//! ```

use froude_records::RecordError;
use froude_records::campaign::Campaign;
use froude_records::declare::Values;
use froude_records::run::Declared;
use froude_records::section::Section;

use super::keys::RIG;

/// Its kind.
pub(super) const LOGS: &str = "logs";
/// Keys that only it has.
pub(super) const OF_LOGS: [&str; 5] =
    ["force_per_volt", "force_per_ampere", "position_standard", "ballasted", "strut_drag"];

/// A carriage of which only logs are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogsRig {
    /// Force along the rail for a unit of the drive's channel, N/V or N/A.
    pub force_per_unit: Declared,
    /// Whether that channel is the motor's current.
    pub is_current: bool,
    /// Standard uncertainty of lengths along the rail, as a part.
    pub position_relative: f64,
    /// Whether the wheels carry the same load wet and dry.
    pub is_ballasted: bool,
    /// Drag of the strut, N s²/m².
    pub strut_drag_n_s2_m2: Option<Declared>,
}

impl LogsRig {
    /// What a campaign declares of the carriage of its logs; `None` where its rig is another one, or none.
    ///
    /// # Errors
    ///
    /// A key that is missing or belongs to another kind of rig, with its place.
    pub fn declared(campaign: &Campaign) -> Result<Option<Self>, RecordError> {
        let Some(root) = campaign.root() else { return Ok(None) };
        match root.section("rig")? {
            Some(rig) if rig.text("kind")? == Some(LOGS) => {
                root.refuse(
                    "carriage",
                    true,
                    "states what a rig is to do, and the runs of a rig of the kind \"logs\" were driven; take it out",
                )?;
                read(&rig).map(Some)
            }
            _ => Ok(None),
        }
    }
}

fn read(s: &Section<'_>) -> Result<LogsRig, RecordError> {
    let values = Values::read(s, RIG)?;
    for (key, _, value) in s.entries() {
        if key != "kind" && !OF_LOGS.contains(&key) {
            return Err(s.wrong(key, value, "does not belong to a rig of kind \"logs\"; take it out".to_owned()));
        }
    }
    let (key, force_per_unit) = match (values.constant("force_per_volt"), values.constant("force_per_ampere")) {
        (Some(volt), None) => ("force_per_volt", volt),
        (None, Some(ampere)) => ("force_per_ampere", ampere),
        (None, None) => {
            let advice = "write force_per_volt = { value = \"4.77 N/V\", standard = \"1 %\" }, the force along the rail for a volt of the command, or \
                          force_per_ampere for the motor's current";
            return Err(values.missing("force_per_volt", advice));
        }
        (Some(_), Some(_)) => {
            let problem = "stands beside force_per_volt; the force is taken from one of them: take the other one out";
            return Err(values.wrong("force_per_ampere", problem));
        }
    };
    if force_per_unit.standard_uncertainty <= 0.0 {
        let problem = "has no standard uncertainty, and the drag is known no better than it: write { value = \"…\", standard = \"1 %\" } with your own";
        return Err(values.wrong(key, problem));
    }
    let position_relative = values.number("position_standard").ok_or_else(|| {
        let advice = "write position_standard = \"0.1 %\", for example: the standard uncertainty of a length along the rail, which the drag has twice";
        values.missing("position_standard", advice)
    })?;
    if !values.is_stated("ballasted") {
        let advice = "write ballasted = true where the wheels carry the same load wet and dry, or false where buoyancy takes load off them in \
                      the wet runs (and volume in [body])";
        return Err(values.missing("ballasted", advice));
    }
    Ok(LogsRig {
        force_per_unit,
        is_current: key == "force_per_ampere",
        position_relative,
        is_ballasted: values.flag("ballasted"),
        strut_drag_n_s2_m2: values.constant("strut_drag"),
    })
}
