//! The drag of a wagon that still accelerates, by the equation of motion.
//!
//! m v̇ = F (1 − s u − (1 − s) u²), u = v/v_∞, with F the weight less the friction, m all that moves and the weight itself, v_∞ the terminal speed, and s
//! the share of the drag that is linear there. The track gives v_∞, its start, its speed there and, as far as it shows it, s, which beforehand lies evenly
//! between 0 and 1. What is wanted is neither v_∞ nor s but the drag where the wagon is, D = F − m v̇ at its own speed: it hardly depends on s, whereas
//! v_∞ does by a quarter of itself where six tenths of it are reached.
//!
//! **Source.** Newton; USR, the rig of Table 3. For s = 0, v² = v_∞²(1 − e^{−2F x/(m v_∞²)}).

use froude_fit::faer::Mat;
use froude_fit::nonlinear::{Model, Parameter, Settings, minimise};

use crate::error::TankError;
use crate::inverted::inverted;

/// s beforehand: the mean and standard deviation of what lies evenly between 0 and 1.
const SHARE: [f64; 2] = [0.5, 0.288_675_134_594_812_9];
/// v_∞ is looked for from this part of the speed at the end.
const LEAST_SPEED: f64 = 1e-3;
/// Step of differences, as part of the value.
const STEP: f64 = 1e-6;
/// Errors of a track are at least this part of its way: what the integration and the rounding of a file leave.
const LEAST_NOISE: f64 = 1e-8;

/// What pulls, and what it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pull {
    /// F: weight less friction, N.
    pub force_n: f64,
    /// m: wagon, body, water and weight, kg.
    pub mass_kg: f64,
}

/// The balance of a wagon at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// Acceleration at that speed, m/s².
    pub acceleration_m_s2: f64,
    /// Standard uncertainty of that by the errors of the track, m/s²; that of s is one that all runs share.
    pub standard_m_s2: f64,
    /// v_∞, m/s.
    pub terminal_m_s: f64,
    /// Root mean square of what the motion leaves of the track, m.
    pub residual_m: f64,
    /// v_∞, start, speed there and s: from where a fit that differs a little sets out.
    pub solution: [f64; 4],
}

/// The balance at `speed_m_s` of a track of the moving part, positions increasing, whose errors are `noise_m`; `near` is the solution of a fit that
/// differs a little, and `share_off` moves what s is taken for beforehand, in its standard deviations.
///
/// # Errors
///
/// A track that no drag explains.
pub fn balance(
    run: &str,
    time_s: &[f64],
    position_m: &[f64],
    (speed_m_s, noise_m): (f64, f64),
    pull: Pull,
    (near, share_off): (Option<[f64; 4]>, f64),
) -> Result<Balance, TankError> {
    let refuse = |what| no_terminal(run, what);
    let n = position_m.len();
    let noise_m = noise_m.max(LEAST_NOISE * (position_m[n - 1] - position_m[0]).abs());
    let first = (n / 10).max(1);
    let begins = ((position_m[first] - position_m[0]) / (time_s[first] - time_s[0])).max(0.0);
    let scale = [speed_m_s, speed_m_s, speed_m_s, 1.0];
    let track = Track { time_s, position_m, noise_m, share_off, pull, scale };
    let start = near.unwrap_or([1.3 * speed_m_s, position_m[0], begins, SHARE[0]]);
    let named = ["terminal speed", "start", "speed there", "linear share"].into_iter().zip(start).zip(scale);
    let mut parameters: Vec<Parameter> = named.map(|((name, at), scale)| Parameter::new(name, at, scale)).collect();
    parameters[0].lower = LEAST_SPEED * speed_m_s;
    let found = minimise(&track, &parameters, &Settings::default()).map_err(|_| refuse("without any drag"))?;
    let at: [f64; 4] = std::array::from_fn(|j| found.values[j]);
    let (left, slopes) = (&found.residuals[0], &found.columns[0]);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let inverse = inverted(&Mat::from_fn(4, 4, |i, j| dot(&slopes[i], &slopes[j])));
    let inverse = inverse.ok_or_else(|| refuse("without any drag"))?;
    if at[0] > 20.0 * speed_m_s {
        return Err(refuse("as if there were no drag at all"));
    }
    let acceleration = |p: [f64; 4]| Law::of(p, pull).acceleration_m_s2(speed_m_s);
    let here = acceleration(at);
    let slope: [f64; 4] = std::array::from_fn(|j| {
        let mut p = at;
        p[j] += STEP * scale[j];
        (acceleration(p) - here) / (STEP * scale[j])
    });
    // cᵀ (J + P)⁻¹ J (J + P)⁻¹ c with c the slope, J of the track, and P = 1/σ_s² beforehand.
    let moved = |i: usize| (0..4).map(|j| inverse[(i, j)] * slope[j]).sum::<f64>();
    let all: f64 = (0..4).map(|i| slope[i] * moved(i)).sum();
    let variance = (all - (moved(3) / SHARE[1]).powi(2)).max(0.0);
    let of_track = dot(&left[..n], &left[..n]) / (n as f64 - 4.0).max(1.0);
    Ok(Balance {
        acceleration_m_s2: here,
        standard_m_s2: variance.sqrt(),
        terminal_m_s: at[0],
        residual_m: noise_m * of_track.sqrt(),
        solution: at,
    })
}

pub(super) fn no_terminal(run: &str, what: &str) -> TankError {
    let what = format!(
        "no terminal speed explains the track with this weight and mass: it goes {what}; check weight, friction and moving_mass"
    );
    TankError::of_run(run, what)
}

/// v̇ = a − b v − c v|v|.
#[derive(Clone, Copy)]
struct Law {
    a: f64,
    b: f64,
    c: f64,
}

impl Law {
    fn of([terminal, _, _, share]: [f64; 4], pull: Pull) -> Self {
        let a = pull.force_n / pull.mass_kg;
        Self { a, b: a * share / terminal, c: a * (1.0 - share) / (terminal * terminal) }
    }

    #[inline]
    fn acceleration_m_s2(self, speed: f64) -> f64 {
        self.a - (self.b + self.c * speed.abs()) * speed
    }
}

/// What was read of a wagon.
struct Track<'a> {
    time_s: &'a [f64],
    position_m: &'a [f64],
    noise_m: f64,
    share_off: f64,
    pull: Pull,
    /// A natural step of each parameter.
    scale: [f64; 4],
}

impl Model for Track<'_> {
    fn runs(&self) -> usize {
        1
    }

    fn residuals(&self, _: usize, theta: &[f64]) -> Option<Vec<f64>> {
        let [own] = self.left([std::array::from_fn(|j| theta[j])]);
        Some(own)
    }

    fn derivatives(&self, _: usize, theta: &[f64]) -> Option<Vec<Vec<f64>>> {
        let moved = |k: usize| std::array::from_fn(|j| theta[j] + if k == j { STEP * self.scale[j] } else { 0.0 });
        let [here, there @ ..] = self.left([moved(4), moved(0), moved(1), moved(2), moved(3)]);
        let column = |(there, scale): (Vec<f64>, f64)| {
            there.iter().zip(&here).map(|(there, here)| (there - here) / (STEP * scale)).collect()
        };
        Some(there.into_iter().zip(self.scale).map(column).collect())
    }
}

impl Track<'_> {
    /// What motions of these terminal speeds, starts, speeds there and linear shares leave of the track, in its errors, and of s beforehand.
    ///
    /// They are stepped side by side, by Runge and Kutta's rule of fourth order: each waits for itself only.
    fn left<const N: usize>(&self, p: [[f64; 4]; N]) -> [Vec<f64>; N] {
        let laws = p.map(|p| Law::of(p, self.pull));
        let (mut x, mut v) = (p.map(|p| p[1]), p.map(|p| p[2]));
        let n = self.position_m.len();
        let mut out: [Vec<f64>; N] = std::array::from_fn(|_| Vec::with_capacity(n + 1));
        for (k, position) in self.position_m.iter().enumerate() {
            for (own, x) in out.iter_mut().zip(x) {
                own.push((position - x) / self.noise_m);
            }
            let Some(next) = self.time_s.get(k + 1) else { break };
            let h = next - self.time_s[k];
            for j in 0..N {
                let at = |speed: f64| laws[j].acceleration_m_s2(speed);
                let k1 = at(v[j]);
                let k2 = at(v[j] + 0.5 * h * k1);
                let k3 = at(v[j] + 0.5 * h * k2);
                let k4 = at(v[j] + h * k3);
                x[j] += h * (v[j] + h / 6.0 * (k1 + k2 + k3));
                v[j] += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            }
        }
        for (own, p) in out.iter_mut().zip(p) {
            own.push((SHARE[0] - p[3]) / SHARE[1] + self.share_off);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PULL: Pull = Pull { force_n: 0.113, mass_kg: 4.0 };

    /// x = (v_∞²/g) ln cosh(g t/v_∞) with g = F/m: the quadratic law from rest, which has reached 0.64 of its terminal speed.
    #[test]
    fn the_closed_form_of_quadratic_drag_is_found_again() {
        let terminal_m_s = 0.3_f64;
        let g = PULL.force_n / PULL.mass_kg;
        let time_s: Vec<f64> = (0..400).map(|i| 0.02 * f64::from(i)).collect();
        let x: Vec<f64> =
            time_s.iter().map(|t| terminal_m_s.powi(2) / g * (g * t / terminal_m_s).cosh().ln()).collect();
        let speed = 0.19;
        let found = balance("a", &time_s, &x, (speed, 1e-7), PULL, (None, 0.0)).unwrap();
        let exact = g * (1.0 - (speed / terminal_m_s).powi(2));
        // A tenth of a micrometre of errors: s is shown by the track, to what the prior draws it by.
        assert!((found.terminal_m_s / terminal_m_s - 1.0).abs() < 1e-4, "{found:?}");
        assert!((found.acceleration_m_s2 / exact - 1.0).abs() < 1e-5, "{found:?} {exact}");
    }

    /// v = v_∞ (1 − e^{−g t/v_∞}): the linear one, read to a millimetre. The acceleration is known ten times better than the terminal speed.
    #[test]
    fn the_acceleration_does_not_wait_for_the_law() {
        let terminal_m_s = 0.3_f64;
        let g = PULL.force_n / PULL.mass_kg;
        let tau = terminal_m_s / g;
        let time_s: Vec<f64> = (0..400).map(|i| 0.02 * f64::from(i)).collect();
        // Errors of 0.6 mm that repeat nowhere, of variance a half.
        let error = |i: usize| 8e-4 * (977.0 * (i * i) as f64).sin();
        let x: Vec<f64> = (time_s.iter().enumerate())
            .map(|(i, t)| terminal_m_s * (t - tau * (1.0 - (-t / tau).exp())) + error(i))
            .collect();
        let speed = terminal_m_s * (1.0 - (-7.0 / tau).exp());
        let found = balance("a", &time_s, &x, (speed, 8e-4 / 2.0_f64.sqrt()), PULL, (None, 0.0)).unwrap();
        let drag = |a: f64| PULL.force_n - PULL.mass_kg * a;
        let exact = g * (1.0 - speed / terminal_m_s);
        let off = drag(found.acceleration_m_s2) - drag(exact);
        // Three standard deviations of the track, and what s may be beside one half: 1.7 of its own.
        let shifted = balance("a", &time_s, &x, (speed, 8e-4 / 2.0_f64.sqrt()), PULL, (None, 1.0)).unwrap();
        let by_share = (drag(shifted.acceleration_m_s2) - drag(found.acceleration_m_s2)).abs();
        assert!(off.abs() < 3.0 * PULL.mass_kg * found.standard_m_s2 + 1.7 * by_share, "{off} {found:?}");
        let by_law = [
            drag(shifted.acceleration_m_s2) / drag(found.acceleration_m_s2) - 1.0,
            shifted.terminal_m_s / found.terminal_m_s - 1.0,
        ]
        .map(f64::abs);
        assert!(by_law[0] < 0.05 && by_law[1] > 3.0 * by_law[0], "{by_law:?}");
    }
}
