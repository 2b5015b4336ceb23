//! A rigid axis that makes logs.
//!
//! Between two commands force is constant and the law of friction linear on either side of rest, so motion is an
//! exponential: it is stepped exactly, with the instants of reversal and of sticking found in closed form.

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
    /// Position and speed of a state `[m, m/s]` after `step_s` under a constant command.
    pub fn after(&self, [mut position_m, mut velocity_m_s]: [f64; 2], command_v: f64, step_s: f64) -> [f64; 2] {
        let mut left_s = step_s;
        let force_n = self.force_per_volt_n_v * command_v - self.offset_n;
        // A step holds a reversal at most, and what follows it.
        for _ in 0..3 {
            let mut direction = direction_of(velocity_m_s);
            if direction == 0.0 {
                let side = usize::from(force_n < 0.0);
                if force_n.abs() <= self.coulomb_n[side] {
                    break;
                }
                direction = direction_of(force_n);
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

/// −1, 0 or 1.
fn direction_of(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

const AXIS: Rigid =
    Rigid { mass_kg: 2.0, viscous_n_s_m: [3.0; 2], coulomb_n: [1.0; 2], offset_n: 0.0, force_per_volt_n_v: 1.0 };

#[test]
fn an_axis_that_coasts_stops_where_the_formula_says() {
    // v̇ = −(1 + 3v)/2: stops after (m/b) ln(1 + b v/c), over m/b (v − (c/b) ln(1 + b v/c)).
    let [x, v] = AXIS.after([0.0, 0.5], 0.0, 10.0);
    let log = 2.5_f64.ln();
    assert_eq!(v, 0.0);
    assert!((x - 2.0 / 3.0 * (0.5 - log / 3.0)).abs() < 1e-15);
}

#[test]
fn one_long_step_is_many_short_ones_also_through_a_reversal() {
    let mut state = [0.0, 0.4];
    for _ in 0..1000 {
        state = AXIS.after(state, -2.5, 1e-3);
    }
    let once = AXIS.after([0.0, 0.4], -2.5, 1.0);
    // A thousand steps, each rounded once or twice.
    assert!((state[0] - once[0]).abs() < 1e-13 && (state[1] - once[1]).abs() < 1e-13, "{state:?} {once:?}");
    assert!(once[1] < 0.0);
}

#[test]
fn a_force_below_friction_moves_nothing() {
    assert_eq!(AXIS.after([0.3, 0.0], 0.99, 5.0), [0.3, 0.0]);
}
