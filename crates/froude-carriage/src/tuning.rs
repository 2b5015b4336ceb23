//! Tuning of a position loop from experiments on the loop itself.
//!
//! | module       | what                                                              | source                        |
//! |--------------|-------------------------------------------------------------------|-------------------------------|
//! | [`response`] | frequency response of the drive from a sweep in the closed loop     | Ljung 1999, ch. 13 (joint i/o) |
//! | [`margins`]  | gain, phase and delay margin, maximum sensitivity                   | Åström & Hägglund 2006, ch. 4 |
//! | [`relay`]    | ultimate gain and period from a relay's limit cycle                 | Åström & Hägglund 2006, ch. 8 |
//! | [`gains`]    | gains by loop shaping on the measured response; Ziegler–Nichols beside | the same, ch. 6            |
//! | [`tracking`] | following error and speed of a ramp on the identified two masses     | MCD eq. 2, eq. 6; simulated |
//! | [`resonance`] | two-mass modes from the response; the shaper that they ask for     | MCD eq. 2; Singer & Seering 1990 |
//! | [`experiment`] | what a relay and a sweep logged                                  |                               |
//! | [`candidate`], [`choice`] | gains held against response and ramps; which to use     |                               |
//! | [`modes`]    | modes bare, dry and wet                                            |                               |
//! | [`source`]   | both as methods of a source                                        |                               |
//!
//! **Frame.** Drive command v_c \[V\] to motor angle θ \[rad\], as MCD eq. 6 has them.
//! **Units.** SI; frequencies at the faces in Hz.
//!
//! Not here: driving the rig (`froude-rig`).

mod bench;
pub mod candidate;
pub mod choice;
pub mod experiment;
pub mod gains;
pub mod margins;
pub mod modes;
mod objections;
mod record;
pub mod relay;
pub mod resonance;
pub mod response;
pub mod source;
pub mod tracking;
mod turned;

use num_complex::Complex64;

/// One point of a measured frequency response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResponsePoint {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// θ over v_c, rad/V.
    pub plant_rad_v: Complex64,
    /// Coherence between the injected sine and the angle, 0 to 1.
    pub coherence: f64,
    /// Relative standard uncertainty of the modulus (and, in rad, of the phase).
    pub relative_std: f64,
}

/// Gains of MCD eq. 6, in SI over the motor angle, as a sampled loop has them: the integral is a sum, the derivative a difference with a
/// first-order filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopGains {
    /// V/rad.
    pub proportional_v_rad: f64,
    /// V s/rad.
    pub derivative_v_s_rad: f64,
    /// V/(rad s).
    pub integral_v_rad_s: f64,
    /// Corner of the derivative's filter, Hz.
    pub derivative_filter_hz: f64,
    /// The controller's tick, s; 0 is a continuous controller.
    pub tick_s: f64,
}

impl LoopGains {
    /// The controller's frequency response, V/rad.
    ///
    /// K_p + K_i T/(1 − z⁻¹) + K_d (a/T)(1 − z⁻¹)/(1 − (1 − a) z⁻¹) with a = 1 − e^(−2πf_dT), z = e^(iωT): the controller's own difference
    /// equations. What the held command and the way through the computer take is in the measured response of the drive.
    #[must_use]
    pub fn response_v_rad(&self, frequency_hz: f64) -> Complex64 {
        let s = Complex64::new(0.0, std::f64::consts::TAU * frequency_hz);
        let corner_rad_s = std::f64::consts::TAU * self.derivative_filter_hz;
        if self.tick_s <= 0.0 {
            return self.proportional_v_rad
                + self.integral_v_rad_s / s
                + self.derivative_v_s_rad * s / (1.0 + s / corner_rad_s);
        }
        let back = (-s * self.tick_s).exp();
        let share = self.filter_share();
        self.proportional_v_rad
            + self.integral_v_rad_s * self.tick_s / (1.0 - back)
            + self.derivative_v_s_rad * share / self.tick_s * (1.0 - back) / (1.0 - (1.0 - share) * back)
    }

    /// Command that one encoder count gives at the tick in which it comes, V.
    #[must_use]
    pub fn volts_per_count(&self, count_rad: f64) -> f64 {
        let corner_rad_s = std::f64::consts::TAU * self.derivative_filter_hz;
        let slope_1_s = if self.tick_s > 0.0 { self.filter_share() / self.tick_s } else { corner_rad_s };
        count_rad * (self.proportional_v_rad + self.derivative_v_s_rad * slope_1_s)
    }

    /// Below this the integral's lag is more than the derivative's lead, and a swing of the load is fed: √(K_i/K_d), Hz.
    #[must_use]
    pub fn feeding_hz(&self) -> f64 {
        (self.integral_v_rad_s / self.derivative_v_s_rad).sqrt() / std::f64::consts::TAU
    }

    /// Part of a new difference that the derivative's filter takes at once.
    pub(crate) fn filter_share(&self) -> f64 {
        1.0 - (-std::f64::consts::TAU * self.derivative_filter_hz * self.tick_s).exp()
    }
}

/// Why an experiment gives no answer, in words.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct TuningError(String);

impl TuningError {
    /// The record is too short for what is asked; `advice` is what to do.
    fn too_few(what: &str, found: usize, least: usize, advice: &str) -> Self {
        Self(format!("{what}: found {found}, at least {least} are needed; {advice}"))
    }

    /// A number that must be positive and finite is not.
    fn number(name: &str, value: f64) -> Self {
        Self(format!("{name} = {value}: a positive, finite number is expected"))
    }

    /// Checks that both columns have one length.
    fn unless_paired(first: &[f64], second: &[f64]) -> Result<(), Self> {
        let (first, second) = (first.len(), second.len());
        let what = || format!("columns of {first} and {second} samples: one row per tick is expected in each");
        if first == second { Ok(()) } else { Err(Self(what())) }
    }
}
