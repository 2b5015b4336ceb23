//! The `[rig]` and `[carriage]` sections of a campaign: what is driven, and what it is to do.
//!
//! Pure data, SI; nothing here moves. Constants are *declared*: each with the standard uncertainty that its owner states.
//! A campaign that drives a rig needs no `[[source]]`.
//!
//! ```toml
//! [rig]
//! kind = "twin"
//! seed = 1
//!
//! [rig.y]
//! travel = ["0 m", "5 m"]
//! # limits, drive constants, controller gains …
//!
//! [carriage]
//! speeds = { start = "0.05 m/s", stop = "0.55 m/s", step = "0.1 m/s" }
//! distance = "2.2 m"
//! # order, repeats, waits …
//! ```

pub mod keys;
mod logs;
pub mod plan;
mod section;

use std::path::Path;

use froude_records::campaign::Campaign;
use froude_records::campaign_file::read_campaign;
use froude_records::run::{Axis, AxisConstants, Declared};
use froude_records::units::Quantity;
use froude_records::{Place, RecordError};

pub use logs::LogsRig;
pub use section::declared;

/// A campaign with what it drives.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivenCampaign {
    /// The campaign.
    pub campaign: Campaign,
    /// What it drives; `None` where it drives nothing.
    pub carriage: Option<CarriageCampaign>,
    /// What is known of the carriage where another program recorded its runs.
    pub logs: Option<LogsRig>,
}

impl DrivenCampaign {
    /// Reads both.
    ///
    /// # Errors
    ///
    /// See [`RecordError`].
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        let campaign = read_campaign(path)?;
        let (carriage, logs) = (declared(&campaign)?, LogsRig::declared(&campaign)?);
        Ok(Self { campaign, carriage, logs })
    }
}

/// A campaign that drives a carriage.
#[derive(Debug, Clone, PartialEq)]
pub struct CarriageCampaign {
    /// What is driven.
    pub rig: RigSpec,
    /// What it is to do; `None` where the campaign only names the rig (tuning, jogging).
    pub plan: Option<CarriagePlan>,
}

/// The rig: a twin or a board at a serial port, and its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct RigSpec {
    /// Twin or real.
    pub kind: RigKind,
    /// Ticks per second; 4000 when not given.
    pub log_rate_hz: f64,
    /// The long axis.
    pub y: AxisSpec,
    /// The short axis, where there is one.
    pub x: Option<AxisSpec>,
    /// The force sensor, where there is one.
    pub force_sensor: Option<ForceSensorSpec>,
    /// Where the section stands.
    pub place: Place,
}

/// Twin or real.
#[derive(Debug, Clone, PartialEq)]
pub enum RigKind {
    /// A simulated rig.
    Twin {
        /// Seed: the same seed gives the same runs.
        seed: u64,
        /// True values that override the twin's own, in the order written.
        truths: Vec<TwinTruth>,
    },
    /// A board at a serial port.
    Serial {
        /// The port, `/dev/ttyUSB0`.
        port: String,
        /// Baud rate; 3,000,000 when not given.
        baud: u32,
    },
}

/// A true value of the twin.
#[derive(Debug, Clone, PartialEq)]
pub struct TwinTruth {
    /// Its name, sections joined by dots (`drag`, `y.coulomb`). The twin knows which there are.
    pub name: String,
    /// Its value.
    pub quantity: Quantity,
    /// Where it stands.
    pub place: Place,
}

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSpec {
    /// Hard stops, m, low and high.
    pub travel_m: [f64; 2],
    /// Limits.
    pub limits: LimitsSpec,
    /// Constants that turn counts and volts into metres and newtons.
    pub constants: AxisConstants,
    /// J_eff, kg m², B_eff, N m s/rad, and C_eff, N m, at the motor; `None` until identified.
    pub inertia_kg_m2: Option<Declared>,
    /// B_eff, N m s/rad.
    pub viscous_n_m_s_rad: Option<Declared>,
    /// C_eff, N m.
    pub coulomb_n_m: Option<Declared>,
    /// The position loop.
    pub gains: GainsSpec,
    /// Where the section stands.
    pub place: Place,
}

/// Limits of one axis. What is not given is for the control to choose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitsSpec {
    /// Largest speed.
    pub speed_m_s: f64,
    /// Largest speed before homing.
    pub unhomed_speed_m_s: Option<f64>,
    /// Largest acceleration, also of a controlled stop.
    pub acceleration_m_s2: f64,
    /// Amplifier's input range.
    pub command_v: f64,
    /// Peak current.
    pub current_a: f64,
    /// Continuous current.
    pub continuous_current_a: Option<f64>,
    /// Thermal time constant of the winding.
    pub thermal_time_s: Option<f64>,
    /// Following error.
    pub following_error_m: Option<f64>,
}

/// The position loop over the motor angle (eq. 6), in SI, and the mode that its reference leaves alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GainsSpec {
    /// V/rad.
    pub proportional_v_rad: f64,
    /// V s/rad.
    pub derivative_v_s_rad: f64,
    /// V/(rad s).
    pub integral_v_rad_s: f64,
    /// Corner of the derivative's filter.
    pub derivative_filter_hz: Option<f64>,
    /// Mode for input shaping; no shaping when not given.
    pub shaped_mode_hz: Option<f64>,
    /// Its damping ratio.
    pub shaped_damping: Option<f64>,
    /// ZVD rather than ZV.
    pub is_robust_shaper: bool,
}

/// The force sensor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ForceSensorSpec {
    /// Largest force.
    pub range_n: Option<f64>,
    /// Step of its reading.
    pub resolution_n: Option<f64>,
    /// Standard deviation of its noise.
    pub noise_n: Option<f64>,
    /// Half-width of its slow drift, taken as uniform.
    pub drift_n: Option<f64>,
    /// Standard uncertainty of its gain, as a part.
    pub gain_standard: Option<f64>,
}

/// What the carriage is to do.
#[derive(Debug, Clone, PartialEq)]
pub struct CarriagePlan {
    /// The axis that tows.
    pub axis: Axis,
    /// Speeds of the steady part, increasing.
    pub speed_m_s: Vec<f64>,
    /// Wet/dry pairs at each speed; 1 when not given.
    pub repeats: usize,
    /// Order of dry (A) and wet (B).
    pub order: Order,
    /// Which way the runs go.
    pub directions: Directions,
    /// Travel of a run, ramps included.
    pub distance_m: f64,
    /// Where a forward run begins; chosen by the pre-flight when not given.
    pub start_m: Option<f64>,
    /// Acceleration of the ramps.
    pub acceleration_m_s2: f64,
    /// Jerk of the ramps; a trapezoid of speed when not given.
    pub jerk_m_s3: Option<f64>,
    /// Wait between dry runs.
    pub settling_dry_s: f64,
    /// Wait between wet runs, until the water is still.
    pub settling_wet_s: f64,
    /// Still window before and after each run, for the sensor's zero.
    pub still_s: f64,
    /// Motion before the first run that counts.
    pub warm_up: Option<WarmUp>,
    /// Dry sweep over position and speed.
    pub friction: Option<FrictionSweep>,
    /// Known weights over the pulley.
    pub calibration: Option<Calibration>,
    /// Excitation for the servo's parameters.
    pub excitation: Option<PulseTrain>,
    /// Wet runs carry ballast that restores the dry wheel load: the mass of the water that the body displaces.
    pub is_ballasted: bool,
    /// Stop early when the 95 % interval of D_d is narrower than this, half-width over value.
    pub stop_at_relative_half_width: Option<f64>,
    /// D_d to be expected, N s²/m², for the detectability of each speed.
    pub expected_drag_n_s2_m2: Option<f64>,
    /// Standard deviation of one wet-minus-dry difference, N, with its degrees of freedom, as an earlier campaign showed it.
    pub expected_scatter_n: Option<(f64, f64)>,
    /// Drag of the strut, N s²/m², that is in the water with the body and measured along.
    pub strut_drag_n_s2_m2: Option<Declared>,
    /// Where the section stands.
    pub place: Place,
}

/// Order of dry (A) and wet (B) runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Order {
    /// Dry, wet, wet, dry: a linear drift cancels.
    #[default]
    Abba,
    /// Dry and wet in turn.
    Ab,
    /// All dry runs, then all wet ones: one change of the body, no protection from drift.
    Blocks,
}

impl Order {
    pub(crate) const ALL: [Self; 3] = [Self::Abba, Self::Ab, Self::Blocks];
    pub(crate) const NAMES: [&'static str; 3] = ["ABBA", "AB", "blocks"];
}

/// Which way runs go.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Directions {
    /// Forward; the way back is not used.
    #[default]
    Forward,
    /// Forward and backward in turn.
    Both,
}

impl Directions {
    pub(crate) const ALL: [Self; 2] = [Self::Forward, Self::Both];
    pub(crate) const NAMES: [&'static str; 2] = ["forward", "both"];
}

/// Motion before the first run that counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WarmUp {
    /// How long.
    pub duration_s: f64,
    /// How fast.
    pub speed_m_s: f64,
}

/// Dry sweep over position and speed.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionSweep {
    /// Speeds.
    pub speed_m_s: Vec<f64>,
    /// How often each is run, both ways; 1 when not given.
    pub repeats: usize,
}

/// Known weights over the pulley.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The weights.
    pub weights_n: Vec<f64>,
    /// Standard uncertainty of each.
    pub weight_standard_n: f64,
    /// What the pulley takes, as part of the weight; 1 % ± 0.6 % when not given and not measured.
    pub pulley_loss: Option<Declared>,
    /// How fast they are lifted and lowered.
    pub speed_m_s: f64,
    /// How often each; 1 when not given.
    pub repeats: usize,
    /// Where lifting begins; that of the tows when not given.
    pub start_m: Option<f64>,
    /// Way of each lift; that of the tows when not given.
    pub distance_m: Option<f64>,
    /// Where a weight that goes down comes to rest on the floor: below this coordinate the cord is slack.
    pub floor_m: Option<f64>,
}

/// Square pulses that excite the servo (the paper: 60 % of 1 s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulseTrain {
    /// Amplitude.
    pub amplitude_v: f64,
    /// Period.
    pub period_s: f64,
    /// Part of the period that is on.
    pub duty: f64,
    /// How long.
    pub duration_s: f64,
}
