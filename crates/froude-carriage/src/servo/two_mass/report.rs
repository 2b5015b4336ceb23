//! How a flexible axis is identified, and what its record says.

use froude_fit::Report;
use froude_fit::budget::Uncertain;
use froude_fit::faer::Mat;

use crate::drag::mbdp;
use crate::servo::flexible::TwoMass;
use crate::servo::interval::Whiteness;
use crate::servo::motor::MotorSide;
use crate::servo::report::ServoCoefficient;

/// What is known of the gear between motor and chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gear {
    /// There is none, or it takes nothing.
    Lossless,
    /// It takes some of the torque, and how much is not declared: what lies behind it is found as it appears through the gear.
    Undeclared,
    /// Declared or calibrated.
    Declared {
        /// η, the motor drives.
        forward: Uncertain,
        /// η_b, the load drives.
        backward: Uncertain,
    },
}

/// How a flexible axis is identified.
#[derive(Debug, Clone, PartialEq)]
pub struct FlexibleOptions {
    /// The drive.
    pub motor: MotorSide,
    /// Its gear.
    pub gear: Gear,
    /// Drag of the load over ẏ|ẏ|, N s²/m²: a body in the water. It is not identified.
    pub load_drag_n_s2_m2: Uncertain,
    /// From the command to the force, s.
    pub delay_s: Uncertain,
    /// Standard uncertainty of force per volt, as a part.
    pub force_relative: f64,
    /// That of the sprocket's radius, which makes torques into forces and counts into metres.
    pub radius_relative: f64,
    /// Longest step of the simulation, s.
    pub step_s: f64,
    /// Antiresonances tried as a start, Hz.
    pub start_hz: Vec<f64>,
}

impl FlexibleOptions {
    /// For a mode between some 2 and 40 Hz; no gear, no drag, no delay.
    #[must_use]
    pub fn new(motor: MotorSide) -> Self {
        Self {
            motor,
            gear: Gear::Lossless,
            load_drag_n_s2_m2: Uncertain::new(0.0, 0.0),
            delay_s: Uncertain::new(0.0, 0.0),
            force_relative: 0.0,
            radius_relative: 0.0,
            step_s: 2e-4,
            start_hz: vec![2.5, 3.2, 4.0, 5.0, 6.5, 8.0, 10.0, 13.0, 17.0, 22.0, 30.0],
        }
    }

    /// Declared inputs: η, η_b, drag, delay.
    pub(crate) fn declared(&self) -> [Uncertain; 4] {
        let one = Uncertain::new(1.0, 0.0);
        let [forward, backward] = match self.gear {
            Gear::Declared { forward, backward } => [forward, backward],
            Gear::Lossless | Gear::Undeclared => [one; 2],
        };
        [forward, backward, self.load_drag_n_s2_m2, self.delay_s]
    }
}

/// How much of a friction sits at the motor.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// `B_m/B` or `C_m/C`.
    pub name: &'static str,
    /// Share of the motor; it means nothing unless identified.
    pub share_of_motor: f64,
    /// Its interval.
    pub interval: [f64; 2],
    /// Whether the interval lies inside 0…1 and is shorter than half of it.
    pub is_identified: bool,
}

/// What a record says about a flexible axis.
#[derive(Debug, Clone, PartialEq)]
pub struct FlexibleReport {
    /// At the chain: `m`, `M`, `K_e`, `B_e`, `B_sum`, `C_sum`; at the motor: `J_m`, `J_eff`, `B_eff`, `C_eff`; `f_antiresonance`, `f_resonance`.
    ///
    /// `block_std` and the interval include the uncertainties of the declared inputs, of the force per volt and of the radius, the other two
    /// only scatter.
    pub coefficients: Vec<ServoCoefficient>,
    /// Covariance of the first [`CHAIN_PARAMETERS`](super::CHAIN_PARAMETERS) of them, at the chain, from scatter.
    pub scatter: Mat<f64>,
    /// Degrees of freedom of each of these.
    pub dof: Vec<f64>,
    /// What the declared gear, drag and delay and the prior of the splits add to it; the force per volt and the radius are apart, since other
    /// records of the rig share them.
    pub declared: Mat<f64>,
    /// Splits of friction between motor and load.
    pub splits: Vec<Split>,
    /// The axis with these parameters.
    pub axis: TwoMass,
    /// Whether what lies behind the gear is as it appears through it, because its efficiency is not declared.
    pub is_apparent: bool,
    /// Whether what is not predicted from sample to sample is white.
    pub whiteness: Option<Whiteness>,
    /// Samples compared.
    pub n_rows: usize,
    /// How the iteration ended.
    pub end: Report,
    /// What a reader must know before using the numbers.
    pub findings: Vec<String>,
}

impl FlexibleReport {
    /// The coefficient of that name.
    #[must_use]
    pub fn coefficient(&self, name: &str) -> Option<&ServoCoefficient> {
        self.coefficients.iter().find(|c| c.name == name)
    }

    /// The chain for drag by the model of two masses (MCD eq. 9 with the chain's force).
    ///
    /// Positions are differentiated over a third of the period of the fastest mode.
    #[must_use]
    pub fn flexible(&self) -> mbdp::Flexible {
        let masses = self.axis.masses;
        mbdp::Flexible {
            motor_mass_kg: masses.motor_mass_kg,
            load_mass_kg: masses.load_mass_kg,
            stiffness_n_m: masses.stiffness_n_m,
            damping_n_s_m: masses.damping_n_s_m,
            span_s: (3.0 * masses.resonance_hz()).recip(),
        }
    }
}
