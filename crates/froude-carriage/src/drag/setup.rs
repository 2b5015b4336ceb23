//! What a reduction is told of rig, body and water.

use froude_fit::budget::Uncertain;
use froude_records::campaign::BodyAxis;

use crate::drag::mbdp::Flexible;
use crate::drag::steady::SteadySettings;

/// What is known about the gear's efficiency, driving forward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Efficiency {
    /// Nothing was said: eq. 8 is taken as printed, and the truth may lie anywhere in [`UNDECLARED_EFFICIENCY`].
    Undeclared,
    /// A data sheet's or a guess.
    Declared(Uncertain),
}

/// Efficiencies that gearheads of towing carriages have, driving forward: a worn two-stage planetary gear with chain and
/// sprocket at light load has 0.6, a direct drive 1.
pub const UNDECLARED_EFFICIENCY: [f64; 2] = [0.6, 1.0];

/// Rolling coefficients of small carriages where none is declared: 0 to 0.02, ball-bearing rollers on glass or rail.
pub const UNDECLARED_ROLLING: [f64; 2] = [0.0, 0.02];

/// Whether the dry carriage rolled under the wheel load of the wet one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ballast {
    /// The wheels carried one load wet and dry.
    Matched {
        /// What the wet carriage carried more than the dry one for that, kg: the ballast, as heavy as the displaced water; 0 where the body
        /// floats as it is towed and was not on the dry carriage; `None` where it is not known. The ramps feel it.
        carried_kg: Option<Uncertain>,
    },
    /// The wheels carry less in the wet runs.
    Unballasted {
        /// Wheel load that buoyancy removes, N.
        unloaded_n: f64,
        /// Rolling coefficient. Declared, the lost friction is put back and its uncertainty kept; `None`: the value
        /// stays as it is and the interval reaches over [`UNDECLARED_ROLLING`].
        rolling: Option<Uncertain>,
    },
}

/// What is declared about the force sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorBudget {
    /// Standard uncertainty of its gain, as a part.
    pub gain_relative: f64,
    /// Half-width of its drift, N, used for runs without a still window on one side.
    pub drift_half_width_n: f64,
}

/// What the force of a sensorless method is per unit of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DriveUnit {
    /// As it stands in records.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its line in a budget.
    pub error: &'static str,
}

impl DriveUnit {
    /// The command of a drive, by known weights.
    pub const COMMAND: Self = Self { name: "force_per_volt", unit: "N/V", error: "force per volt, calibrated" };
    /// The command of a drive, as declared.
    pub const DECLARED: Self = Self { error: "force per volt, declared", ..Self::COMMAND };
    /// The motor's current, as declared.
    pub const CURRENT: Self = Self { name: "force_per_ampere", unit: "N/A", error: "force per ampere, declared" };
}

/// Names of the errors that other campaigns may have too; `None` where nobody knows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ErrorKeys {
    /// The calibration: of the runs that it was made from.
    pub calibration: Option<String>,
    /// The rig: of its declared constants but for the efficiency, which says nothing of who it is.
    pub rig: Option<String>,
    /// The force sensor, where somebody declared it.
    pub sensor: Option<String>,
}

impl ErrorKeys {
    /// Key of a constant of the rig.
    #[must_use]
    pub fn of_rig(&self, constant: &str) -> Option<String> {
        self.rig.as_ref().map(|rig| format!("{rig}/{constant}"))
    }
}

/// What is declared about rig, body and water.
#[derive(Debug, Clone, PartialEq)]
pub struct DragSetup {
    /// Name of the campaign, for records and messages.
    pub name: String,
    /// (n/R)·K_T·K_amp, N/V, before any loss in the gear.
    pub ideal_force_per_volt_n: f64,
    /// Standard uncertainty of K_T·K_amp, as a part; counts only without a calibration.
    pub torque_constant_relative: f64,
    /// Drift of K_T from run to run, as a part. It is in the scatter; named in the budget and in the detectability.
    pub torque_constant_drift_relative: f64,
    /// What is known about the gear; counts only without a calibration.
    pub efficiency: Efficiency,
    /// Force per volt as calibrated, N/V; of logs of other programs as declared, N/V or N/A.
    pub calibration: Option<Uncertain>,
    /// What that is per unit of.
    pub drive: DriveUnit,
    /// The sensor, if the rig has one.
    pub sensor: SensorBudget,
    /// Standard uncertainty of the length that an encoder count stands for, as a part.
    pub speed_scale_relative: f64,
    /// Wheel load wet and dry.
    pub ballast: Ballast,
    /// D_d of the strut alone, N s²/m², subtracted; `None`: the coefficient is that of body and strut.
    pub strut_n_s2_m2: Option<Uncertain>,
    /// Density of the water, kg/m³.
    pub density_kg_m3: f64,
    /// Area that C_D refers to, m².
    pub reference_area_m2: Option<f64>,
    /// Standard uncertainty of density times area, as a part of it; counts in C_D alone.
    pub reference_relative: f64,
    /// The two-mass model, where it was identified.
    pub flexible: Option<Flexible>,
    /// 1; or, where the campaign stopped at the first interval that was short enough, the number of looks that were planned: the
    /// intervals then hold over all of them (Bonferroni).
    pub looks: usize,
    /// How steady windows are chosen.
    pub steady: SteadySettings,
    /// The body axis that lies along the travel; `None` where nobody declared it.
    pub travel: Option<BodyAxis>,
    /// Errors that other campaigns may have too.
    pub keys: ErrorKeys,
}

impl DragSetup {
    /// The rig of the MCD paper (Table II), nothing calibrated, water at 1000 kg/m³, no area.
    #[must_use]
    pub fn of_the_paper() -> Self {
        let ratio = 34.97 / 0.055;
        Self {
            name: "towing carriage".to_owned(),
            ideal_force_per_volt_n: ratio * 26.7e-3 * 0.352,
            torque_constant_relative: 0.02,
            torque_constant_drift_relative: 0.005,
            efficiency: Efficiency::Undeclared,
            calibration: None,
            drive: DriveUnit::COMMAND,
            sensor: SensorBudget { gain_relative: 0.002, drift_half_width_n: 0.2 },
            speed_scale_relative: 0.0005,
            ballast: Ballast::Matched { carried_kg: Some(Uncertain::new(0.0, 0.0)) },
            strut_n_s2_m2: None,
            density_kg_m3: 1000.0,
            reference_area_m2: None,
            reference_relative: 0.0,
            flexible: None,
            looks: 1,
            steady: SteadySettings::default(),
            travel: None,
            keys: ErrorKeys::default(),
        }
    }

    /// Letter of the axis that the drag is along: the declared one of the body, else x, which is then along the chain.
    pub(super) fn axis(&self) -> &'static str {
        self.travel.map_or("x", BodyAxis::name)
    }

    /// The load along it.
    pub(super) fn load(&self) -> &'static str {
        match self.travel {
            None | Some(BodyAxis::X) => "f_x",
            Some(BodyAxis::Y) => "f_y",
            Some(BodyAxis::Z) => "f_z",
        }
    }

    /// The velocity along it.
    pub(super) fn velocity(&self) -> &'static str {
        match self.travel {
            None | Some(BodyAxis::X) => "v_x",
            Some(BodyAxis::Y) => "v_y",
            Some(BodyAxis::Z) => "v_z",
        }
    }

    /// Force per volt that forces are computed with: calibrated, else ideal times the declared efficiency, else ideal
    /// (eq. 8 as printed).
    #[must_use]
    pub fn force_per_volt_n(&self) -> f64 {
        match (self.calibration, self.efficiency) {
            (Some(force_per_volt), _) => force_per_volt.value,
            (None, Efficiency::Declared(e)) => self.ideal_force_per_volt_n * e.value,
            (None, Efficiency::Undeclared) => self.ideal_force_per_volt_n,
        }
    }
}
