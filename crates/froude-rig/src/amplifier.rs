//! The motor amplifier in current mode: DAC steps, gain, saturation, the current loop's lag, the current monitor.
//!
//! i_demand = K_amp v_c, clipped; di/dt = (i_demand − i)/τ_i; the monitor is sampled by an ADC with noise.
//!
//! **Setting.** Four-quadrant drive; the enable input removes the torque, the ready output says that the drive has no fault.
//! **Units.** SI.

use rand::RngExt;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

/// What the amplifier and its converters are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmplifierConfig {
    /// K_amp, A/V.
    pub gain_a_v: f64,
    /// Range of the DAC, ± V.
    pub range_v: f64,
    /// Bits of the DAC; 0 means none (exact).
    pub dac_bits: u32,
    /// Peak current, A.
    pub peak_a: f64,
    /// Time constant of the current loop, s.
    pub lag_s: f64,
    /// Range of the monitor's ADC, ± A.
    pub monitor_range_a: f64,
    /// Its bits; 0 means none.
    pub adc_bits: u32,
    /// Noise of the monitor, A rms.
    pub monitor_noise_a: f64,
}

impl Default for AmplifierConfig {
    fn default() -> Self {
        Self {
            gain_a_v: crate::parameters::AMPLIFIER_A_V,
            range_v: 10.0,
            dac_bits: 16,
            peak_a: 5.0,
            lag_s: 160e-6,
            monitor_range_a: 10.0,
            adc_bits: 12,
            monitor_noise_a: 5e-3,
        }
    }
}

/// What is wrong with the amplifier.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AmplifierFault {
    /// It switched itself off: no current, not ready.
    Off,
    /// It gives its peak current whatever it is commanded, while enabled.
    Runaway,
}

/// Rounds to a multiple of a step; ties to even. Exact for up to 2⁵¹ steps.
fn quantised(value: f64, step: f64, per_step: f64) -> f64 {
    const SHIFT: f64 = 6_755_399_441_055_744.0; // 1.5 · 2⁵²
    if step == 0.0 { value } else { ((value * per_step + SHIFT) - SHIFT) * step }
}

/// Step of a converter over ± range, and its inverse.
fn converter(range: f64, bits: u32) -> (f64, f64) {
    if bits == 0 {
        (0.0, 0.0)
    } else {
        (2.0 * range / libm::exp2(f64::from(bits)), libm::exp2(f64::from(bits)) / (2.0 * range))
    }
}

/// One amplifier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplifier {
    config: AmplifierConfig,
    dac: (f64, f64),
    adc: (f64, f64),
    keep: f64,
    keep_mean: f64,
    demand_a: f64,
    current_a: f64,
    is_enabled: bool,
    fault: Option<AmplifierFault>,
    refused_inputs: u64,
}

impl Amplifier {
    /// Off and without current; `step_s` is the plant's step.
    #[must_use]
    pub fn new(config: AmplifierConfig, step_s: f64) -> Self {
        let ratio = step_s / config.lag_s;
        let keep = if config.lag_s > 0.0 { libm::exp(-ratio) } else { 0.0 };
        Self {
            dac: converter(config.range_v, config.dac_bits),
            adc: converter(config.monitor_range_a, config.adc_bits),
            keep,
            keep_mean: if config.lag_s > 0.0 { (1.0 - keep) / ratio } else { 0.0 },
            demand_a: 0.0,
            current_a: 0.0,
            is_enabled: false,
            fault: None,
            refused_inputs: 0,
            config,
        }
    }

    /// Takes a command. One that is not finite counts as 0 V and is remembered ([`Self::refused_inputs`]).
    pub fn command(&mut self, volts: f64, is_enabled: bool) {
        self.is_enabled = is_enabled && self.fault != Some(AmplifierFault::Off);
        let volts = if volts.is_finite() {
            volts
        } else {
            self.refused_inputs += 1;
            0.0
        };
        let volts = quantised(volts.clamp(-self.config.range_v, self.config.range_v), self.dac.0, self.dac.1);
        let peak_a = self.config.peak_a;
        self.demand_a = match (self.is_enabled, self.fault) {
            (false, _) => 0.0,
            (true, Some(AmplifierFault::Runaway)) => peak_a,
            (true, _) => (self.config.gain_a_v * volts).clamp(-peak_a, peak_a),
        };
    }

    /// Cuts what the hardware cuts: an open end switch stops current into that end, an open e-stop chain all of it.
    pub fn interlock(&mut self, is_estop: bool, is_low_end: bool, is_high_end: bool) {
        if is_estop || (is_low_end && self.demand_a < 0.0) || (is_high_end && self.demand_a > 0.0) {
            self.demand_a = 0.0;
        }
    }

    /// One plant step; the mean current over it, A.
    #[inline]
    pub fn step(&mut self) -> f64 {
        let error_a = self.current_a - self.demand_a;
        self.current_a = self.demand_a + self.keep * error_a;
        self.demand_a + self.keep_mean * error_a
    }

    /// The monitor's reading, A.
    pub fn monitor(&self, rng: &mut Pcg64Mcg) -> f64 {
        let noise: f64 = rng.sample(StandardNormal);
        let range_a = self.config.monitor_range_a;
        let seen_a = (self.current_a + self.config.monitor_noise_a * noise).clamp(-range_a, range_a);
        quantised(seen_a, self.adc.0, self.adc.1)
    }

    /// True current, A.
    #[must_use]
    pub fn current_a(&self) -> f64 {
        self.current_a
    }

    /// The ready output: the drive has no fault.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        self.fault != Some(AmplifierFault::Off)
    }

    /// Commands that were not finite.
    #[must_use]
    pub fn refused_inputs(&self) -> u64 {
        self.refused_inputs
    }

    /// Breaks or repairs it.
    pub fn set_fault(&mut self, fault: AmplifierFault) {
        self.fault = Some(fault);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn current_follows_as_a_first_order_lag() {
        let config = AmplifierConfig { dac_bits: 0, lag_s: 1e-3, ..AmplifierConfig::default() };
        let mut a = Amplifier::new(config, 1e-4);
        a.command(1.0, true);
        let charge: f64 = (0..10).map(|_| a.step() * 1e-4).sum();
        let e = (-1.0_f64).exp();
        assert!((a.current_a() - 0.352 * (1.0 - e)).abs() < 1e-15);
        // ∫ 0.352 (1 − e^(−t/τ)) dt over one τ.
        assert!((charge - 0.352e-3 * e).abs() < 1e-15);
    }

    #[test]
    fn commands_come_in_steps_and_saturate() {
        let mut a = Amplifier::new(AmplifierConfig { dac_bits: 12, lag_s: 0.0, ..AmplifierConfig::default() }, 1e-4);
        a.command(0.0074, true); // 1.5 steps of 20/4096 V: rounds to two
        a.step();
        assert!((a.current_a() - 0.352 * 40.0 / 4096.0).abs() < 1e-15);
        for volts in [1e3, f64::INFINITY, f64::NAN] {
            a.command(volts, true);
            assert!(a.step() <= 0.352 * 10.0 + 1e-12);
        }
        assert_eq!(a.refused_inputs(), 2);
    }

    #[test]
    fn a_disabled_drive_has_no_torque_and_a_runaway_obeys_only_enable() {
        let mut a = Amplifier::new(AmplifierConfig { lag_s: 0.0, ..AmplifierConfig::default() }, 1e-4);
        a.command(5.0, false);
        assert_eq!(a.step(), 0.0);
        a.set_fault(AmplifierFault::Runaway);
        a.command(0.0, true);
        a.step();
        assert_eq!(a.current_a(), 5.0);
        a.command(0.0, false);
        a.step();
        assert_eq!(a.current_a(), 0.0);
    }

    #[test]
    fn the_monitor_reads_within_half_a_step_without_noise() {
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let config = AmplifierConfig { monitor_noise_a: 0.0, lag_s: 0.0, ..AmplifierConfig::default() };
        let mut a = Amplifier::new(config, 1e-4);
        a.command(1.234, true);
        a.step();
        assert!((a.monitor(&mut rng) - a.current_a()).abs() <= 0.5 * 20.0 / 4096.0);
    }
}
