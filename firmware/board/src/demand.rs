//! From the controller's volts to the code of a DAC.

/// The DAC's full scale, V: codes are two's complement over ± this.
pub const FULL_SCALE_V: f64 = 10.0;
/// Volts of a code.
pub const V_PER_COUNT: f64 = FULL_SCALE_V / 32768.0;

/// Nearest code; saturates, and anything that is not a number is 0 V.
#[must_use]
pub fn dac_code(volts: f64) -> i16 {
    let counts = volts * (1.0 / V_PER_COUNT);
    let rounded = (counts + if counts < 0.0 { -0.5 } else { 0.5 }) as i32;
    rounded.clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16
}
