//! Accelerations of a chain in closed form, in absolute angles: the readable reference of the O(n) engine.
//!
//! With the angles θ of all links and the centre of mass p, the centres of the links are X = e p_x + G cos θ, Y = e p_y + G sin θ. G is constant: row by row the way from
//! the head, a link's half-length for each half link on it, less the mean by mass, so that mᵀG = 0 for links whose centre of mass is their centre. Then
//!
//! Ẋ = e ṗ_x − G (sin θ ∘ θ̇),  Ẍ = e p̈_x − G (sin θ ∘ θ̈ + cos θ ∘ θ̇²),
//!
//! and each link's own axes give J_i = ∂(ω, u, v)_i/∂(θ̇, ṗ). The equations are Σ J_iᵀ (I_i ṁ_i + p_i) = Dᵀτ with φ = D θ.
//!
//! # Source
//!
//! USR eq. 1 to 8 (for equal links, in the form of its reference 8); our derivation for links that differ.

use faer::Mat;
use faer::prelude::*;

use froude_swim::chain::{AddedMass, Chain, Link};
use froude_swim::planar::{Load, Motion, dot, turned};

/// A state in absolute angles; all motion is through the water.
#[derive(Debug, Clone, PartialEq)]
pub struct Absolute {
    /// θ, rad.
    pub heading: Vec<f64>,
    /// θ̇, rad/s.
    pub turn_rate: Vec<f64>,
    /// ṗ, m/s, in the axes of the tank.
    pub velocity: [f64; 2],
}

/// Rates of a state.
#[derive(Debug, Clone, PartialEq)]
pub struct Rates {
    /// θ̈, rad/s².
    pub turn: Vec<f64>,
    /// p̈, m/s².
    pub velocity: [f64; 2],
}

/// G: n × n, m.
pub fn places(chain: &Chain) -> Mat<f64> {
    let n = chain.links.len();
    let half = |k: usize| chain.links[k].half_length_m;
    let from_head = |i: usize, k: usize| match k {
        _ if i == 0 || k > i => 0.0,
        0 => -half(0),
        _ if k == i => -half(i),
        _ => -2.0 * half(k),
    };
    let mass = |i: usize| chain.links[i].rigid.x;
    let all: f64 = (0..n).map(mass).sum();
    // A centre of mass that lies ahead of its link's centre belongs to the mean.
    let ahead = |k: usize| chain.links[k].rigid.turn_y;
    let mean = |k: usize| ((0..n).map(|i| mass(i) * from_head(i, k)).sum::<f64>() + ahead(k)) / all;
    Mat::from_fn(n, n, |i, k| from_head(i, k) - mean(k))
}

/// Motions of the links in their own axes.
pub fn motions(places: &Mat<f64>, state: &Absolute) -> Vec<Motion> {
    let n = state.heading.len();
    let sum = |i: usize, of: &dyn Fn(usize) -> f64| (0..n).map(|k| places[(i, k)] * of(k)).sum::<f64>();
    (0..n)
        .map(|i| {
            let x = state.velocity[0] - sum(i, &|k| state.heading[k].sin() * state.turn_rate[k]);
            let y = state.velocity[1] + sum(i, &|k| state.heading[k].cos() * state.turn_rate[k]);
            let (s, c) = state.heading[i].sin_cos();
            [state.turn_rate[i], c * x + s * y, c * y - s * x]
        })
        .collect()
}

/// Accelerations under torques on φ, N m; `None` where the matrix of masses is not positive definite.
pub fn rates(chain: &Chain, state: &Absolute, torque: &[f64]) -> Option<Rates> {
    let n = chain.links.len();
    let g = places(chain);
    let moving = motions(&g, state);
    let (mut mass, mut right) = (Mat::<f64>::zeros(n + 2, n + 2), Mat::<f64>::zeros(n + 2, 1));
    for (i, link) in chain.links.iter().enumerate() {
        let (s, c) = state.heading[i].sin_cos();
        let own = |x: f64, y: f64| [c * x + s * y, c * y - s * x];
        // ∂(ω, u, v)_i by θ̇_k, then by ṗ.
        let column = |k: usize| -> [f64; 3] {
            let [x, y] = match k {
                _ if k == n => [1.0, 0.0],
                _ if k == n + 1 => [0.0, 1.0],
                _ => [-g[(i, k)] * state.heading[k].sin(), g[(i, k)] * state.heading[k].cos()],
            };
            let [u, v] = own(x, y);
            [f64::from(u8::from(k == i)), u, v]
        };
        // What the axes of the links make of a motion that stays as it is.
        let squares = |of: &dyn Fn(f64) -> f64| {
            (0..n).map(|k| -g[(i, k)] * of(state.heading[k]) * state.turn_rate[k].powi(2)).sum::<f64>()
        };
        let [w, u, v] = moving[i];
        let [x, y] = own(squares(&f64::cos), squares(&f64::sin));
        let bias = [0.0, x + w * v, y - w * u];
        let inertia = link.inertia();
        let (from_bias, from_turning) = (inertia.times(bias), turning(chain.added_mass, link, moving[i]));
        let drag = link.drag.load(link.half_length_m, moving[i]);
        for a in 0..n + 2 {
            let ja = column(a);
            for b in 0..n + 2 {
                mass[(a, b)] += dot(inertia.times(column(b)), ja);
            }
            right[(a, 0)] += (0..3).map(|k| ja[k] * (drag[k] - from_bias[k] - from_turning[k])).sum::<f64>();
        }
    }
    for (i, torque) in torque.iter().enumerate() {
        right[(i, 0)] += torque;
        right[(i + 1, 0)] -= torque;
    }
    let found = mass.llt(faer::Side::Lower).ok()?.solve(&right);
    Some(Rates { turn: (0..n).map(|k| found[(k, 0)]).collect(), velocity: [found[(n, 0)], found[(n + 1, 0)]] })
}

/// What the momenta make of axes that turn with the link.
fn turning(added_mass: AddedMass, link: &Link, motion: Motion) -> Load {
    let rigid = turned(motion, link.rigid.times(motion));
    match added_mass {
        AddedMass::Usr => rigid,
        AddedMass::Full => {
            let added = turned(motion, link.added.times(motion));
            [rigid[0] + added[0], rigid[1] + added[1], rigid[2] + added[2]]
        }
    }
}
