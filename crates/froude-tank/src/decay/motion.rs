//! The equation of motion, integrated between its turning points.
//!
//! q̈ = −ω² s(q − r) − d₁ q̇ − d₂ q̇|q̇| − f sgn q̇, s(x) = x of a spring and sin x of a buoyancy at a radius, with ω² = C/(M+A), d₁ = D_I/(M+A), d₂ = D_II/(M+A) and f = Coulomb friction/(M+A), which the fit
//! keeps at zero. q̇|q̇| has a kink where q̇ = 0; a step that passes it is cut there, so that every piece is smooth and Runge and
//! Kutta's fourth order holds over any number of swings. In phase a step of `ω h` leaves (ω h)⁴/120 a radian: 8e-7 at
//! [`LONGEST_STEP_RAD`], 5e-5 rad after ten cycles.
//!
//! Beside the motion go its derivatives (variational equations of the same scheme), which the kink leaves continuous.
//!
//! **Source.** Hairer, Nørsett & Wanner (1993), II.1 (the scheme), I.14 (derivatives), II.6 (cutting at events).

/// Longest step, rad of the undamped phase.
pub const LONGEST_STEP_RAD: f64 = 0.1;

/// Numbers of the motion, per unit of the moving inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// ω² = C/(M+A), 1/s².
    pub omega2: f64,
    /// d₁ = D_I/(M+A), 1/s.
    pub linear: f64,
    /// d₂ = D_II/(M+A), 1/m or 1/rad.
    pub quadratic: f64,
    /// Coulomb friction over the inertia, m/s² or rad/s².
    pub coulomb: f64,
    /// r, m or rad.
    pub rest: f64,
    /// Whether s(x) is sin x.
    pub is_pendulum: bool,
}

/// Names the derivatives that go along: by ω², d₁, d₂, r, and by the position and speed at the start.
pub const BY: usize = 6;

/// Position and speed, with `K` pairs of their derivatives.
#[derive(Debug, Clone, Copy)]
struct State<const K: usize> {
    q: f64,
    v: f64,
    by: [[f64; 2]; K],
}

impl<const K: usize> State<K> {
    fn along(&self, rate: &Self, h: f64) -> Self {
        let mut out = *self;
        out.q += h * rate.q;
        out.v += h * rate.v;
        for k in 0..K {
            out.by[k][0] += h * rate.by[k][0];
            out.by[k][1] += h * rate.by[k][1];
        }
        out
    }
}

impl Motion {
    /// s(q − r), and its derivative.
    fn restoring(&self, q: f64) -> [f64; 2] {
        let off = q - self.rest;
        if self.is_pendulum { off.sin_cos().into() } else { [off, 1.0] }
    }

    /// Acceleration; `sign` is that of the speed, held over a step.
    fn acceleration(&self, q: f64, v: f64, sign: f64) -> f64 {
        -self.omega2 * self.restoring(q)[0] - v * (self.linear + self.quadratic * sign * v) - sign * self.coulomb
    }

    fn rate<const K: usize>(&self, s: &State<K>, sign: f64) -> State<K> {
        let damping = self.linear + 2.0 * self.quadratic * sign * s.v;
        // ∂q̈ by each parameter itself; the start has none.
        let [off, slope] = self.restoring(s.q);
        let stiffness = self.omega2 * slope;
        let direct = [-off, -s.v, -sign * s.v * s.v, stiffness, 0.0, 0.0];
        let mut by = [[0.0; 2]; K];
        for k in 0..K {
            let [dq, dv] = s.by[k];
            by[k] = [dv, direct[k] - stiffness * dq - damping * dv];
        }
        State { q: s.v, v: self.acceleration(s.q, s.v, sign), by }
    }

    /// Runge and Kutta's step with the sign held.
    fn smooth<const K: usize>(&self, s: &State<K>, sign: f64, h: f64) -> State<K> {
        let k1 = self.rate(s, sign);
        let k2 = self.rate(&s.along(&k1, 0.5 * h), sign);
        let k3 = self.rate(&s.along(&k2, 0.5 * h), sign);
        let k4 = self.rate(&s.along(&k3, h), sign);
        s.along(&k1, h / 6.0).along(&k2, h / 3.0).along(&k3, h / 3.0).along(&k4, h / 6.0)
    }

    /// The sign that the speed has or is about to have; zero where friction holds the body.
    fn sign(&self, q: f64, v: f64) -> f64 {
        if v != 0.0 {
            v.signum()
        } else if self.omega2 * self.restoring(q)[0].abs() <= self.coulomb {
            0.0
        } else {
            -self.restoring(q)[0].signum()
        }
    }

    /// One step, cut where the speed changes its sign.
    fn step<const K: usize>(&self, s: &State<K>, h: f64) -> State<K> {
        let sign = self.sign(s.q, s.v);
        if sign == 0.0 {
            return *s;
        }
        let whole = self.smooth(s, sign, h);
        if whole.v * sign >= 0.0 {
            return whole;
        }
        let plain = State::<0> { q: s.q, v: s.v, by: [] };
        let mut part = if s.v == 0.0 { 0.0 } else { h * s.v / (s.v - whole.v) };
        for _ in 0..8 {
            let at = self.smooth(&plain, sign, part);
            let step = at.v / self.acceleration(at.q, at.v, sign);
            part = (part - step).clamp(0.0, h);
            if step.abs() <= 1e-14 * h {
                break;
            }
        }
        let mut turned = self.smooth(s, sign, part);
        turned.v = 0.0;
        match self.sign(turned.q, 0.0) {
            0.0 => turned,
            next => self.smooth(&turned, next, h - part),
        }
    }

    /// Steps that the time between two samples is cut into.
    fn substeps(&self, step_s: f64) -> usize {
        (self.omega2.sqrt() * step_s / LONGEST_STEP_RAD).ceil().clamp(1.0, 1e4) as usize
    }

    fn sampled<const K: usize, T>(
        &self,
        start: State<K>,
        time_s: &[f64],
        substeps: impl Fn(f64) -> usize,
        of: impl Fn(&State<K>) -> T,
    ) -> Option<Vec<T>> {
        let mut state = start;
        let mut out = Vec::with_capacity(time_s.len());
        for (i, t) in time_s.iter().enumerate() {
            if i > 0 {
                let step_s = t - time_s[i - 1];
                let count = substeps(step_s);
                for _ in 0..count {
                    state = self.step(&state, step_s / count as f64);
                }
            }
            if !(state.q.is_finite() && state.v.is_finite()) {
                return None;
            }
            out.push(of(&state));
        }
        Some(out)
    }

    /// Position and speed at increasing times from a start at the first; `None` where they grow beyond all numbers.
    #[must_use]
    pub fn path(&self, start: [f64; 2], time_s: &[f64]) -> Option<Vec<[f64; 2]>> {
        self.path_by(start, time_s, |step_s| self.substeps(step_s))
    }

    /// The same with so many steps between two times.
    fn path_by(&self, [q, v]: [f64; 2], time_s: &[f64], substeps: impl Fn(f64) -> usize) -> Option<Vec<[f64; 2]>> {
        self.sampled(State::<0> { q, v, by: [] }, time_s, substeps, |s| [s.q, s.v])
    }

    /// Position at these times and its derivatives by ω², d₁, d₂, r, start position and start speed.
    #[must_use]
    pub fn path_and_derivatives(&self, [q, v]: [f64; 2], time_s: &[f64]) -> Option<Vec<(f64, [f64; BY])>> {
        let mut by = [[0.0; 2]; BY];
        by[4][0] = 1.0;
        by[5][1] = 1.0;
        self.sampled(State { q, v, by }, time_s, |step_s| self.substeps(step_s), |s| (s.q, s.by.map(|b| b[0])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(step_s: f64, n: u32) -> Vec<f64> {
        (0..n).map(|i| step_s * f64::from(i)).collect()
    }

    const MOTION: Motion =
        Motion { omega2: 9.0, linear: 0.12, quadratic: 1.5, coulomb: 0.0, rest: 0.02, is_pendulum: false };

    /// q = r + e^(−γt)(a cos ω_d t + b sin ω_d t): over 20 cycles, within the error that the step promises.
    #[test]
    fn the_linear_oscillator_is_its_closed_form() {
        let motion = Motion { quadratic: 0.0, ..MOTION };
        let (gamma, start) = (0.06, [0.12, 0.3]);
        let damped = (9.0_f64 - gamma * gamma).sqrt();
        let (a, b) = (0.1, (0.3 + gamma * 0.1) / damped);
        let step_s = 0.02;
        for (i, [q, _]) in motion.path(start, &even(step_s, 2100)).unwrap().into_iter().enumerate() {
            let t = step_s * i as f64;
            let exact = 0.02 + (-gamma * t).exp() * (a * (damped * t).cos() + b * (damped * t).sin());
            let phase = (3.0 * step_s).powi(4) / 120.0 * 3.0 * t;
            assert!((q - exact).abs() < 0.15 * phase + 1e-12, "{t} {q} {exact}");
        }
    }

    #[test]
    fn the_order_is_four_across_turning_points() {
        for coulomb in [0.0, 0.02] {
            let motion = Motion { coulomb, ..MOTION };
            let end = |substeps: usize| motion.path_by([0.4, 0.0], &even(0.1, 90), |_| substeps).unwrap()[89][0];
            let (one, two, four) = (end(1), end(2), end(4));
            let order = ((one - two) / (two - four)).abs().log2();
            assert!((order - 4.0).abs() < 0.3, "coulomb {coulomb}: {order}");
        }
    }

    /// Central differences of the path itself, in steps of a part of 1e-6: their own error is 1e-6 where they straddle a turning point.
    #[test]
    fn derivatives_are_those_of_the_path() {
        for is_pendulum in [false, true] {
            derivatives(&Motion { is_pendulum, ..MOTION });
        }
    }

    fn derivatives(motion: &Motion) {
        let (start, step_s, n) = ([0.5, -0.2], 0.03, 400);
        let along = motion.path_and_derivatives(start, &even(step_s, n)).unwrap();
        let moved = |k: usize, d: f64| {
            let (mut m, mut s) = (*motion, start);
            *[&mut m.omega2, &mut m.linear, &mut m.quadratic, &mut m.rest].into_iter().chain(&mut s).nth(k).unwrap() +=
                d;
            m.path(s, &even(step_s, n)).unwrap()
        };
        for k in 0..BY {
            let d = 1e-6;
            let (up, down) = (moved(k, d), moved(k, -d));
            for i in 0..along.len() {
                let difference = (up[i][0] - down[i][0]) / (2.0 * d);
                assert!((along[i].1[k] - difference).abs() < 1e-6, "{k} {i}: {} {difference}", along[i].1[k]);
            }
        }
    }

    /// Coulomb friction alone: each half cycle loses 2f/ω², and the body stops within f/ω² of rest.
    #[test]
    fn coulomb_friction_takes_the_same_from_every_swing_and_stops_the_body() {
        let motion = Motion { omega2: 4.0, linear: 0.0, quadratic: 0.0, coulomb: 0.05, ..MOTION };
        let motion = Motion { rest: 0.0, ..motion };
        let path = motion.path([0.2, 0.0], &even(0.001, 20_000)).unwrap();
        let furthest = |k: usize| {
            let centre = (std::f64::consts::FRAC_PI_2 * k as f64 / 0.001).round() as usize;
            path[centre][0].abs()
        };
        for k in 0..8 {
            assert!((furthest(k) - (0.2 - 0.025 * k as f64)).abs() < 1e-6, "{k}: {}", furthest(k));
        }
        let [q, v] = path[19_999];
        assert!(v == 0.0 && q.abs() <= 0.0125 + 1e-9, "{q} {v}");
    }

    /// Times with samples missing and with jitter: the same motion, as far as the steps promise.
    #[test]
    fn uneven_times_are_of_the_same_motion() {
        let fine = MOTION.path([0.4, 0.0], &even(0.001, 4001)).unwrap();
        let rows: Vec<usize> = (0..4001).filter(|i| i % 20 == i * 7 % 3 && !(1000..1300).contains(i)).collect();
        let time_s: Vec<f64> =
            std::iter::once(0.0).chain(rows.iter().map(|i| 0.001 * *i as f64).filter(|t| *t > 0.0)).collect();
        for (t, [q, _]) in time_s.iter().zip(MOTION.path([0.4, 0.0], &time_s).unwrap()) {
            assert!((q - fine[(t / 0.001).round() as usize][0]).abs() < 1e-5, "{t}: {q}");
        }
    }

    /// Reversing time turns damping round: forward, then back with the damping's sign changed, is where it began.
    #[test]
    fn time_runs_back_to_the_start() {
        let [q, v] = MOTION.path([0.3, 0.1], &even(0.01, 1001)).unwrap()[1000];
        let back = Motion { linear: -MOTION.linear, quadratic: -MOTION.quadratic, ..MOTION };
        let [q0, v0] = back.path([q, -v], &even(0.01, 1001)).unwrap()[1000];
        assert!((q0 - 0.3).abs() < 1e-6 && (v0 + 0.1).abs() < 1e-6, "{q0} {v0}");
    }
}
