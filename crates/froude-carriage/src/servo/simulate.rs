//! A rigid axis simulated in its loop.
//!
//! Between two commands force is constant and the law of friction linear on either side of rest, so motion is an
//! exponential: it is stepped exactly, with the instants of reversal and of sticking found in closed form. There is no
//! step size to choose.

use crate::servo::error::ServoError;
use crate::servo::friction::signum;

/// Position beyond which a simulation has run away, m.
const RUN_AWAY_M: f64 = 1e3;

/// A rigid axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid {
    /// Moved mass, kg.
    pub mass_kg: f64,
    /// Viscous coefficients for motion forward and backward, N s/m.
    pub viscous_n_s_m: [f64; 2],
    /// Coulomb friction forward and backward, N.
    pub coulomb_n: [f64; 2],
    /// Constant force, N.
    pub offset_n: f64,
    /// Force per volt, N/V.
    pub force_per_volt_n_v: f64,
}

impl Rigid {
    /// From named values.
    pub(crate) fn from_values(names: &[&str], values: &[f64], force_per_volt_n_v: f64) -> Option<Self> {
        let known = ["M", "F_v", "F_c", "F_v+", "F_v-", "F_c+", "F_c-", "offset"];
        if names.iter().any(|n| !known.contains(n)) {
            return None;
        }
        let of = |name: &str| names.iter().position(|n| *n == name).map(|j| values[j]);
        let both = |name: &str| {
            Some([of(name).or_else(|| of(&format!("{name}+")))?, of(name).or_else(|| of(&format!("{name}-")))?])
        };
        Some(Self {
            mass_kg: of("M")?,
            viscous_n_s_m: both("F_v")?,
            coulomb_n: both("F_c")?,
            offset_n: of("offset").unwrap_or(0.0),
            force_per_volt_n_v,
        })
    }

    /// Position and speed of a state `[m, m/s]` after `step_s` under a constant command.
    #[must_use]
    pub fn after(&self, [position_m, velocity_m_s]: [f64; 2], command_v: f64, step_s: f64) -> [f64; 2] {
        self.advance(position_m, velocity_m_s, command_v, step_s)
    }

    /// Position and speed after `left_s` under a constant command.
    fn advance(&self, mut position_m: f64, mut velocity_m_s: f64, command_v: f64, mut left_s: f64) -> [f64; 2] {
        let force_n = self.force_per_volt_n_v * command_v - self.offset_n;
        // A step holds a reversal at most, and what follows it.
        for _ in 0..3 {
            let mut direction = signum(velocity_m_s);
            if direction == 0.0 {
                let side = usize::from(force_n < 0.0);
                if force_n.abs() <= self.coulomb_n[side] {
                    break;
                }
                direction = signum(force_n);
            }
            let side = usize::from(direction < 0.0);
            let drive_n = force_n - direction * self.coulomb_n[side];
            let free = Free { drive: drive_n / self.mass_kg, rate: self.viscous_n_s_m[side] / self.mass_kg };
            let [dx, v] = free.after(velocity_m_s, left_s);
            if v * direction >= 0.0 {
                return [position_m + dx, v];
            }
            let stop_s = free.stop(velocity_m_s).max(0.0).min(left_s);
            position_m += free.after(velocity_m_s, stop_s)[0];
            velocity_m_s = 0.0;
            left_s -= stop_s;
        }
        [position_m, velocity_m_s]
    }
}

/// `v̇ = drive − rate·v`.
struct Free {
    drive: f64,
    rate: f64,
}

impl Free {
    /// Way and speed after a time.
    fn after(&self, v: f64, t: f64) -> [f64; 2] {
        // (1 − e^{−x})/x and (1 − (1 − e^{−x})/x)/x, without cancelling for small x.
        let x = self.rate * t;
        let first = if x.abs() < 1e-5 { 1.0 - 0.5 * x } else { -(-x).exp_m1() / x };
        let second = if x.abs() < 1e-3 { 0.5 - x / 6.0 + x * x / 24.0 } else { (1.0 - first) / x };
        [t * (v * first + self.drive * t * second), v + t * (self.drive - self.rate * v) * first]
    }

    /// When the speed reaches zero.
    fn stop(&self, v: f64) -> f64 {
        let x = -self.rate * v / self.drive;
        if self.rate.abs() < 1e-12 { -v / self.drive } else { x.ln_1p() / self.rate }
    }
}

/// The loop that was closed when the record was made; gains at the chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loop {
    /// `u = k_p k_v (reference − y) − k_v ẏ`, ẏ the backward difference of the mean of the last two samples.
    Cascade {
        /// `k_p`, 1/s.
        position_1_s: f64,
        /// `k_v`, V s/m.
        velocity_v_s_m: f64,
        /// Limit of the command, V.
        limit_v: f64,
    },
    /// `u = k_p e + k_d ė + k_i ∫e`, ė the backward difference, the integral held at the limit.
    Pid {
        /// `k_p`, V/m.
        proportional_v_m: f64,
        /// `k_i`, V/(m s).
        integral_v_m_s: f64,
        /// `k_d`, V s/m.
        derivative_v_s_m: f64,
        /// Limit of the command, V.
        limit_v: f64,
    },
}

/// What the loop remembers.
#[derive(Debug, Clone, Copy)]
struct Memory {
    before_m: [f64; 2],
    error_m: f64,
    integral_m_s: f64,
}

impl Loop {
    fn command_v(&self, memory: &mut Memory, reference_m: f64, position_m: f64, step_s: f64) -> f64 {
        let error_m = reference_m - position_m;
        let command = match *self {
            Self::Cascade { position_1_s, velocity_v_s_m, limit_v } => {
                let speed_m_s = (position_m - memory.before_m[1]) / (2.0 * step_s);
                (velocity_v_s_m * (position_1_s * error_m - speed_m_s)).max(-limit_v).min(limit_v)
            }
            Self::Pid { proportional_v_m, integral_v_m_s, derivative_v_s_m, limit_v } => {
                let integral_m_s = memory.integral_m_s + error_m * step_s;
                let rest = proportional_v_m * error_m + derivative_v_s_m * (error_m - memory.error_m) / step_s;
                let wanted = rest + integral_v_m_s * integral_m_s;
                if wanted.abs() <= limit_v {
                    memory.integral_m_s = integral_m_s;
                }
                wanted.max(-limit_v).min(limit_v)
            }
        };
        memory.before_m = [position_m, memory.before_m[0]];
        memory.error_m = error_m;
        command
    }
}

/// A simulated record, a value per sample of the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// Position, m.
    pub position_m: Vec<f64>,
    /// Speed, m/s.
    pub velocity_m_s: Vec<f64>,
    /// Command, V.
    pub command_v: Vec<f64>,
}

/// Simulates an axis in its loop, from rest at `start_m`; the command is held between samples.
///
/// # Errors
///
/// [`ServoError::RanAway`]; [`ServoError::Setting`] for a mass that is not positive or friction that drives.
pub fn closed_loop(
    axis: &Rigid,
    servo: &Loop,
    reference_m: &[f64],
    start_m: f64,
    step_s: f64,
) -> Result<Simulated, ServoError> {
    let is_possible = axis.mass_kg > 0.0 && axis.coulomb_n.iter().all(|c| *c >= 0.0);
    if !is_possible {
        let must = "mass must be positive and Coulomb friction not negative to simulate the axis";
        return Err(ServoError::Setting { what: "mass of the axis (kg)", found: axis.mass_kg, must });
    }
    let n = reference_m.len();
    let mut out = Simulated {
        position_m: Vec::with_capacity(n),
        velocity_m_s: Vec::with_capacity(n),
        command_v: Vec::with_capacity(n),
    };
    let mut memory =
        Memory { before_m: [start_m; 2], error_m: reference_m.first().map_or(0.0, |r| r - start_m), integral_m_s: 0.0 };
    let mut state = [start_m, 0.0];
    for (k, reference) in reference_m.iter().enumerate() {
        let [position_m, velocity_m_s] = state;
        if position_m.is_nan() || position_m.abs() > RUN_AWAY_M {
            return Err(ServoError::RanAway { time_s: k as f64 * step_s });
        }
        let command_v = servo.command_v(&mut memory, *reference, position_m, step_s);
        out.position_m.push(position_m);
        out.velocity_m_s.push(velocity_m_s);
        out.command_v.push(command_v);
        state = axis.advance(position_m, velocity_m_s, command_v, step_s);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXIS: Rigid =
        Rigid { mass_kg: 2.0, viscous_n_s_m: [3.0; 2], coulomb_n: [1.0; 2], offset_n: 0.0, force_per_volt_n_v: 1.0 };

    #[test]
    fn an_axis_that_coasts_stops_where_the_formula_says() {
        // v̇ = −(1 + 3v)/2: stops after (m/b) ln(1 + b v/c), over m/b (v − (c/b) ln(1 + b v/c)).
        let [x, v] = AXIS.advance(0.0, 0.5, 0.0, 10.0);
        let log = 2.5_f64.ln();
        assert_eq!(v, 0.0);
        assert!((x - 2.0 / 3.0 * (0.5 - log / 3.0)).abs() < 1e-15);
    }

    #[test]
    fn one_long_step_is_many_short_ones_also_through_a_reversal() {
        let mut state = [0.0, 0.4];
        for _ in 0..1000 {
            state = AXIS.advance(state[0], state[1], -2.5, 1e-3);
        }
        let once = AXIS.advance(0.0, 0.4, -2.5, 1.0);
        // A thousand steps, each rounded once or twice.
        assert!((state[0] - once[0]).abs() < 1e-13 && (state[1] - once[1]).abs() < 1e-13, "{state:?} {once:?}");
        assert!(once[1] < 0.0);
    }

    #[test]
    fn a_force_below_friction_moves_nothing() {
        assert_eq!(AXIS.advance(0.3, 0.0, 0.99, 5.0), [0.3, 0.0]);
    }
}
