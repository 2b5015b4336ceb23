//! What all runs of a campaign have in common.

use std::path::PathBuf;

use crate::carriage::CarriagePlan;
use crate::carriage::plan::PlannedRun;
use froude_control::tick::AXES;
use froude_records::campaign::BodyAxis;
use froude_records::run::{AxisConstants, BodyState, CampaignMark};
use indexmap::IndexMap;

use crate::drive::Stranger;
use crate::load::{HungWeight, Load};

/// An approach that coasts too far even at this speed is none, m/s.
pub(crate) const SLOWEST_APPROACH_M_S: f64 = 0.02;

/// What is the same for all runs.
#[derive(Debug, Clone)]
pub struct Setting {
    /// Campaign's name.
    pub campaign: String,
    /// SHA-256 of the campaign's file, hexadecimal; empty where there is none.
    pub campaign_sha256: String,
    /// Folder of the runs; it exists.
    pub folder: PathBuf,
    /// What is asked for.
    pub asked: CarriagePlan,
    /// Speed of the ways between runs, m/s.
    pub return_speed_m_s: f64,
    /// Longest that homing may take, s, by axis.
    pub homing_s: [f64; AXES],
    /// Shape the reference for the load mode.
    pub is_shaped: bool,
    /// The axis of the body that lies along the travel; `None` where nobody declared it.
    pub travel: Option<BodyAxis>,
    /// Declared constants by axis.
    pub constants: IndexMap<String, AxisConstants>,
    /// What rides on the carriage apart from where it is mounted: only a twin needs it.
    pub load: Load,
    /// Seed, for the record; `None` on a real rig.
    pub twin_seed: Option<u64>,
    /// Every how many ticks one is recorded.
    pub decimation: u64,
    /// Start of the campaign on the host's clock, ns since 1970; 0 where runs shall be bit-equal.
    pub start_unix_ns: u64,
    /// Date in words.
    pub date: String,
}

impl Setting {
    /// The campaign, as its runs name it.
    #[must_use]
    pub fn mark(&self) -> CampaignMark<'_> {
        CampaignMark { name: &self.campaign, sha256: &self.campaign_sha256 }
    }
}

/// The load of a run: a ballasted wet run carries the wheel load that buoyancy removes.
pub(crate) fn load_of(run: &PlannedRun, base: &Load) -> Load {
    let ballast_kg = if run.is_ballasted && run.body == BodyState::Wet { base.balancing_ballast_kg() } else { 0.0 };
    Load {
        mounting: run.body,
        ballast_kg,
        hung: HungWeight {
            weight_n: run.hung_weight_n,
            floor_m: run.floor_m.unwrap_or(f64::NEG_INFINITY),
            ..base.hung
        },
        ..*base
    }
}

/// Whoever watches is shown the samples whose tick is a multiple of this: thirty a second, fewer from a board that sends fewer.
pub(crate) const SHOWN_EVERY: u64 = 133;

/// The message about another program on the line.
pub(crate) fn said_of(stranger: Stranger) -> String {
    match stranger {
        Stranger::TurnedAway(session) => {
            format!("another program (session {session:08x}) asked for the board and was turned away")
        }
        Stranger::Stopped(session) => {
            format!("another program (session {session:08x}) asked for a stop, which was obeyed")
        }
    }
}
