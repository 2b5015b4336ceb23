//! Excitations, tick by tick.
//!
//! Pulses, relay and jog open the loop; a sweep adds a sine to it. Torque in the direction of motion is taken off at the speed limit,
//! and the axis module ends an excitation while the stopping way still lies inside the soft limits.

use crate::law::Law;
use crate::request::Excitation;

/// What an excitation asks for at this tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Asked {
    /// This command, the loop open, V.
    Open(f64),
    /// This on top of the loop's command, V.
    Added(f64),
    /// It is over.
    Done,
}

/// A unit vector that turns a little each tick: sine without a library call.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Phasor {
    cos: f64,
    sin: f64,
}

impl Phasor {
    /// Turns by `angle` (|angle| ≤ π/2). The series are good to 1e-8 at π/2 and to rounding below 0.2; the length is held at one.
    fn turn(&mut self, angle: f64) {
        let x = angle * angle;
        let s = angle
            * (1.0
                - x * (1.0 / 6.0)
                    * (1.0
                        - x * (1.0 / 20.0)
                            * (1.0 - x * (1.0 / 42.0) * (1.0 - x * (1.0 / 72.0) * (1.0 - x * (1.0 / 110.0))))));
        let c = 1.0
            - x * 0.5
                * (1.0
                    - x * (1.0 / 12.0)
                        * (1.0 - x * (1.0 / 30.0) * (1.0 - x * (1.0 / 56.0) * (1.0 - x * (1.0 / 90.0)))));
        let (cos, sin) = (self.cos * c - self.sin * s, self.sin * c + self.cos * s);
        let correction = 1.5 - 0.5 * (cos * cos + sin * sin);
        *self = Self { cos: cos * correction, sin: sin * correction };
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Signal {
    Pulses { volts: f64, period: u32, on: u32, at: u32, sign: f64 },
    Relay { volts: f64, hysteresis_m: f64, centre_m: f64, sign: f64 },
    Sweep { volts: f64, phasor: Phasor, step_rad: f64, ratio: f64 },
    Jog { volts: f64, distance_m: f64, start_m: f64 },
}

/// A running excitation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Exciter {
    signal: Signal,
    left_ticks: u32,
}

impl Exciter {
    /// Starts at `position_m`. The request must have been checked.
    pub(crate) fn new(excitation: &Excitation, law: &Law, position_m: f64) -> Self {
        let (signal, duration_s) = match *excitation {
            Excitation::Pulses { volts, period_s, duty, duration_s } => {
                let on = (duty * period_s * law.per_tick_s + 0.5) as u32;
                (Signal::Pulses { volts, period: law.ticks(period_s), on, at: 0, sign: 1.0 }, duration_s)
            }
            Excitation::Relay { volts, hysteresis_m, duration_s } => {
                (Signal::Relay { volts, hysteresis_m, centre_m: position_m, sign: 1.0 }, duration_s)
            }
            Excitation::Sweep { volts, from_hz, to_hz, duration_s, .. } => {
                let phasor = Phasor { cos: 1.0, sin: 0.0 };
                let step_rad = 2.0 * core::f64::consts::PI * from_hz * law.tick_s;
                let ratio = libm::exp(libm::log(to_hz / from_hz) * law.tick_s / duration_s);
                (Signal::Sweep { volts, phasor, step_rad, ratio }, duration_s)
            }
            Excitation::Jog { volts, distance_m, duration_s } => {
                (Signal::Jog { volts, distance_m, start_m: position_m }, duration_s)
            }
        };
        Self { signal, left_ticks: law.ticks(duration_s) }
    }

    /// Whether the loop is open.
    pub(crate) fn is_open_loop(&self) -> bool {
        !matches!(self.signal, Signal::Sweep { .. })
    }

    /// Whether it is a jog.
    pub(crate) fn is_jog(&self) -> bool {
        matches!(self.signal, Signal::Jog { .. })
    }

    /// The next tick. `is_at_speed`: the ramp below a sweep is over.
    pub(crate) fn step(&mut self, position_m: f64, is_at_speed: bool) -> Asked {
        if !is_at_speed {
            return Asked::Added(0.0);
        }
        if self.left_ticks == 0 {
            return Asked::Done;
        }
        self.left_ticks = self.left_ticks.saturating_sub(1);
        match &mut self.signal {
            Signal::Pulses { volts, period, on, at, sign } => {
                let asked = if *at < *on { *sign * *volts } else { 0.0 };
                *at = at.saturating_add(1);
                if *at >= *period {
                    (*at, *sign) = (0, -*sign);
                }
                Asked::Open(asked)
            }
            Signal::Relay { volts, hysteresis_m, centre_m, sign } => {
                let error_m = *centre_m - position_m;
                if error_m > *hysteresis_m {
                    *sign = 1.0;
                } else if error_m < -*hysteresis_m {
                    *sign = -1.0;
                }
                Asked::Open(*sign * *volts)
            }
            Signal::Sweep { volts, phasor, step_rad, ratio } => {
                let added = *volts * phasor.sin;
                phasor.turn(*step_rad);
                *step_rad *= *ratio;
                Asked::Added(added)
            }
            Signal::Jog { volts, distance_m, start_m } => {
                if libm::fabs(position_m - *start_m) >= *distance_m {
                    return Asked::Done;
                }
                Asked::Open(*volts)
            }
        }
    }
}
