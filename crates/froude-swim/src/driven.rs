//! A swimmer whose joints are driven by torques, over time.
//!
//! **State**, one number after the other: place and heading of the head (3), φ (n − 1), motion of the head through the water in its own axes (3), φ̇ (n − 1), and the
//! integrals of Σ τφ̇ and of the power that drag takes (2).
//!
//! **Units.** SI.

use crate::chain::Chain;
use crate::engine::{Given, Joints, Workspace};

/// Torques on φ, N m, at a time, s, from φ and φ̇.
pub trait Drive {
    /// Puts them into `torque`.
    fn torque(&self, time_s: f64, angle: &[f64], rate: &[f64], torque: &mut [f64]);
}

/// No torque at all.
#[derive(Debug, Clone, Copy)]
pub struct Limp;

impl Drive for Limp {
    fn torque(&self, _: f64, _: &[f64], _: &[f64], torque: &mut [f64]) {
        torque.fill(0.0);
    }
}

/// A chain with its drive.
#[derive(Debug, Clone)]
pub struct Driven<'a, D> {
    /// Its links.
    pub chain: &'a Chain,
    /// What drives its joints.
    pub drive: D,
    /// Speed of the water over the ground, m/s.
    pub current_m_s: [f64; 2],
    work: Workspace,
    torque: Vec<f64>,
}

impl<'a, D: Drive> Driven<'a, D> {
    /// In still water.
    #[must_use]
    pub fn new(chain: &'a Chain, drive: D) -> Self {
        let (work, torque) = (Workspace::new(chain.links.len()), vec![0.0; chain.joints()]);
        Self { chain, drive, current_m_s: [0.0; 2], work, torque }
    }

    /// Length of a state.
    #[must_use]
    pub fn size(&self) -> usize {
        2 * self.chain.joints() + 8
    }

    /// Rates of a state; `None` where an inertia is not positive.
    pub fn rates(&mut self, time_s: f64, state: &[f64], rates: &mut [f64]) -> Option<()> {
        let j = self.chain.joints();
        let (angle, rate) = (&state[3..3 + j], &state[6 + j..6 + 2 * j]);
        let head = [state[3 + j], state[4 + j], state[5 + j]];
        self.drive.torque(time_s, angle, rate, &mut self.torque);
        let turned = self.work.evaluate(self.chain, head, Joints { angle, rate }, Given::Torque(&self.torque))?;
        let (s, c) = state[2].sin_cos();
        let [w, u, v] = head;
        rates[0] = c * u - s * v + self.current_m_s[0];
        rates[1] = s * u + c * v + self.current_m_s[1];
        rates[2] = w;
        rates[3..3 + j].copy_from_slice(rate);
        rates[3 + j..6 + j].copy_from_slice(&turned);
        rates[6 + j..6 + 2 * j].copy_from_slice(&self.work.answer);
        rates[6 + 2 * j] = self.torque.iter().zip(rate).map(|(t, w)| t * w).sum();
        rates[7 + 2 * j] = self.work.loss_w;
        Some(())
    }

    /// Kinetic energy of body and water, J, and their momentum, kg m/s, with its moment about the origin of the tank, kg m²/s, of the state that was evaluated last.
    #[must_use]
    pub fn energy_and_momentum(&self, state: &[f64]) -> (f64, [f64; 3]) {
        let (mut place, mut heading) = ([state[0], state[1]], state[2]);
        let (mut energy, mut sum) = (0.0, [0.0; 3]);
        let mut before = 0.0;
        for (i, (link, motion)) in self.chain.links.iter().zip(self.work.motions()).enumerate() {
            if i > 0 {
                let (s, c) = heading.sin_cos();
                place = [place[0] - before * c, place[1] - before * s];
                heading -= state[2 + i];
                let (s, c) = heading.sin_cos();
                place = [place[0] - link.half_length_m * c, place[1] - link.half_length_m * s];
            }
            before = link.half_length_m;
            let inertia = link.inertia();
            energy += inertia.energy(*motion);
            let [turn, along, across] = inertia.times(*motion);
            let (s, c) = heading.sin_cos();
            let (x, y) = (c * along - s * across, s * along + c * across);
            sum = [sum[0] + x, sum[1] + y, sum[2] + turn + place[0] * y - place[1] * x];
        }
        (energy, sum)
    }
}

/// One step of Runge and Kutta's fourth order; `None` where the rates have none.
pub fn runge_kutta(
    time_s: f64,
    h: f64,
    state: &[f64],
    mut rates: impl FnMut(f64, &[f64], &mut [f64]) -> Option<()>,
) -> Option<Vec<f64>> {
    let n = state.len();
    let mut k = vec![vec![0.0; n]; 4];
    let moved = |k: &[f64], by: f64| state.iter().zip(k).map(|(x, k)| x + by * k).collect::<Vec<f64>>();
    rates(time_s, state, &mut k[0])?;
    let second = moved(&k[0], 0.5 * h);
    rates(time_s + 0.5 * h, &second, &mut k[1])?;
    let third = moved(&k[1], 0.5 * h);
    rates(time_s + 0.5 * h, &third, &mut k[2])?;
    let fourth = moved(&k[2], h);
    rates(time_s + h, &fourth, &mut k[3])?;
    let step = |i: usize| h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
    Some((0..n).map(|i| state[i] + step(i)).collect())
}
