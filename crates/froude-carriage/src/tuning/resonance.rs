//! Modes of the two-mass carriage from its motor-side response, and the input shaper for them.
//!
//! Motor side of MCD eq. 2: θ/v_c = k (s² + 2ζ_a ω_a s + ω_a²) / (s (s + b) (s² + 2ζ_p ω_p s + ω_p²)) · e^(−sT).
//! Its **antiresonance** ω_a = √(K_e/M) is the load swinging on a motor that stands still, which is what a stiff position loop
//! makes of the motor: the load's closed-loop mode. Its **resonance** ω_p is the free mode of both masses, the 13 Hz of the
//! paper. A reference is therefore shaped for ω_a; shaping for ω_p leaves the load's swing as it was.

use froude_fit::nonlinear::{Parameter, Scatter, Settings, Solution, minimise};
use num_complex::Complex64;

use super::{ResponsePoint, TuningError};

/// Frequency and damping of a mode, with their standard uncertainties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Undamped natural frequency, Hz.
    pub frequency_hz: f64,
    /// Its standard uncertainty, Hz.
    pub frequency_std_hz: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Its standard uncertainty.
    pub damping_std: f64,
}

/// What the response states about the two masses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoMassModes {
    /// Load on a motor held still: the mode to shape for.
    pub load: Mode,
    /// Both masses free: the peak on the motor side.
    pub free: Mode,
    /// Correlation of the load's frequency and damping, and the free ones.
    pub correlation: [[f64; 4]; 4],
    /// Degrees of freedom of their standard uncertainties.
    pub dof: f64,
    /// M (R/n)²/J_m = (ω_p/ω_a)² − 1.
    pub inertia_ratio: f64,
    /// Acceleration of the motor alone per volt, rad/(s² V).
    pub gain_rad_s2_v: f64,
    /// Viscous decay of the whole, 1/s.
    pub viscous_1_s: f64,
    /// Delay of the loop, s.
    pub delay_s: f64,
    /// Root-mean-square relative residual of the response where its coherence is above 0.8.
    pub relative_residual: f64,
    /// Its median: what is left at most points, dip, peak and harmonics aside.
    pub median_residual: f64,
}

const PARAMETERS: usize = 7;
const NAMES: [&str; PARAMETERS] = ["ln k", "ln b", "ln f_a", "zeta_a", "ln f_p", "zeta_p", "T"];
/// Natural steps: a tenth, and a tenth of a delay that would show.
const SCALES: [f64; PARAMETERS] = [0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.01];
/// From a start that leads nowhere the search goes no further than this; the end within a thousandth of a standard deviation.
const SEARCH: Settings = Settings { difference: 1e-4, offset: 1e-3, step: 1e-10, iterations: 50 };
/// Coherence above which a point counts in the residual.
const SEEN: f64 = 0.8;
/// A fit that leaves more than this of the response is none.
const LARGEST_RESIDUAL: f64 = 0.35;

fn model(p: &[f64], frequency_hz: f64) -> Complex64 {
    let tau = std::f64::consts::TAU;
    let s = Complex64::new(0.0, tau * frequency_hz);
    let (k, b, a, pole) = (p[0].exp(), p[1].exp(), tau * p[2].exp(), tau * p[4].exp());
    k * (s * s + 2.0 * p[3] * a * s + a * a) / (s * (s + b) * (s * s + 2.0 * p[5] * pole * s + pole * pole))
        * (-s * p[6]).exp()
}

/// Fits the two-mass model to the logarithm of the response (modulus and phase), weighted by the coherence.
///
/// The search begins from a grid of starts; the best end is kept.
///
/// # Errors
///
/// [`TuningError`] when the model does not follow the response, and below 20 points.
pub fn two_mass_modes(plant: &[ResponsePoint]) -> Result<TwoMassModes, TuningError> {
    if plant.len() < 20 {
        return Err(TuningError::too_few("points of the frequency response", plant.len(), 20, "sweep longer"));
    }
    let from = |start: [f64; PARAMETERS]| -> Option<Solution> {
        let parameters: [Parameter; PARAMETERS] = std::array::from_fn(|j| {
            let free = Parameter::new(NAMES[j], start[j], SCALES[j]);
            if NAMES[j].starts_with("zeta") { free.within(0.0, f64::INFINITY) } else { free }
        });
        // A start that the search refuses is one start less.
        minimise(&|p: &[f64]| Some(residuals(plant, p)), &parameters, &SEARCH).ok()
    };
    let found = starts(plant).into_iter().filter_map(from);
    let best = found.min_by(|a, b| a.sum_of_squares.total_cmp(&b.sum_of_squares));
    let (low_hz, high_hz) = (plant[0].frequency_hz, plant[plant.len() - 1].frequency_hz);
    let no_modes = |residual: f64| {
        TuningError(format!(
            "the two-mass model leaves {:.0} % of the response unexplained: it has no single antiresonance \
             and resonance between {low_hz:.1} and {high_hz:.1} Hz",
            100.0 * residual
        ))
    };
    let Some((best, covariance)) = best.and_then(|b| b.covariance(Scatter::Independent).ok().map(|c| (b, c))) else {
        return Err(no_modes(1.0));
    };
    let p = &best.values;
    // Only where the response was seen at all: at an antiresonance the encoder may see nothing.
    let seen: Vec<&ResponsePoint> = plant.iter().filter(|q| q.coherence > SEEN).collect();
    let (load_hz, free_hz) = (p[2].exp(), p[4].exp());
    let mut squares: Vec<f64> =
        seen.iter().map(|q| (model(p, q.frequency_hz) / q.plant_rad_v - 1.0).norm_sqr()).collect();
    let relative_residual = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    squares.sort_by(f64::total_cmp);
    let median_residual = squares.get(squares.len() / 2).map_or(f64::NAN, |x| x.sqrt());
    let is_inside = |f: f64| (low_hz..=high_hz).contains(&f);
    // A comparison with NaN is false, so this also refuses a fit that ran away.
    if !(relative_residual < LARGEST_RESIDUAL && is_inside(load_hz) && is_inside(free_hz) && load_hz < free_hz) {
        return Err(no_modes(relative_residual));
    }
    let std = |j: usize| covariance.standard(j).unwrap_or(f64::NAN);
    let mode = |f: usize, z: usize| Mode {
        frequency_hz: p[f].exp(),
        frequency_std_hz: p[f].exp() * std(f),
        damping: p[z],
        damping_std: std(z),
    };
    let correlation = std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let both = std(2 + a) * std(2 + b);
            covariance.covariance(2 + a, 2 + b).filter(|_| both > 0.0).map_or(f64::from(u8::from(a == b)), |c| c / both)
        })
    });
    Ok(TwoMassModes {
        load: mode(2, 3),
        free: mode(4, 5),
        correlation,
        dof: covariance.dof,
        inertia_ratio: (free_hz / load_hz).powi(2) - 1.0,
        gain_rad_s2_v: p[0].exp(),
        viscous_1_s: p[1].exp(),
        delay_s: p[6],
        relative_residual,
        median_residual,
    })
}

impl TwoMassModes {
    /// Standard uncertainties in the order of [`Self::correlation`].
    #[must_use]
    pub fn standards(&self) -> [f64; 4] {
        let (load, free) = (self.load, self.free);
        [load.frequency_std_hz, load.damping_std, free.frequency_std_hz, free.damping_std]
    }

    /// θ/v_c of the fitted model, rad/V.
    #[must_use]
    pub fn response_rad_v(&self, frequency_hz: f64) -> Complex64 {
        let ln = f64::ln;
        let p = [
            ln(self.gain_rad_s2_v),
            ln(self.viscous_1_s),
            ln(self.load.frequency_hz),
            self.load.damping,
            ln(self.free.frequency_hz),
            self.free.damping,
            self.delay_s,
        ];
        model(&p, frequency_hz)
    }

    /// The same drive with another load: `factor` times the one that was identified.
    #[must_use]
    pub fn with_load(&self, factor: f64) -> Self {
        let inertia_ratio = factor * self.inertia_ratio;
        let load = self.load.frequency_hz / factor.sqrt();
        let free = load * (1.0 + inertia_ratio).sqrt();
        let mode = |m: Mode, frequency_hz: f64| {
            // The chain's damper stays: the ratio goes with the frequency.
            let part = frequency_hz / m.frequency_hz;
            Mode { frequency_hz, frequency_std_hz: part * m.frequency_std_hz, damping: part * m.damping, ..m }
        };
        Self {
            load: mode(self.load, load),
            free: mode(self.free, free),
            inertia_ratio,
            viscous_1_s: self.viscous_1_s * (1.0 + self.inertia_ratio) / (1.0 + inertia_ratio),
            ..*self
        }
    }

    /// The measured points, and the model's where nothing was measured, from a lower to a higher frequency.
    #[must_use]
    pub fn extended(&self, plant: &[ResponsePoint], [low_hz, high_hz]: [f64; 2]) -> Vec<ResponsePoint> {
        /// Far less than the width of a lightly damped dip, whose phase turns by half a turn.
        const STEP: f64 = 1.002;
        let at = |frequency_hz: f64| ResponsePoint {
            frequency_hz,
            plant_rad_v: self.response_rad_v(frequency_hz),
            coherence: f64::NAN,
            relative_std: f64::NAN,
        };
        let first_hz = plant.first().map_or(low_hz, |p| p.frequency_hz);
        let last_hz = plant.last().map_or(low_hz, |p| p.frequency_hz);
        let steps =
            |from_hz: f64, to_hz: f64| (1..).map(move |i| from_hz * STEP.powi(i)).take_while(move |f| *f < to_hz);
        let below: Vec<ResponsePoint> = steps(low_hz / STEP, first_hz).map(at).collect();
        below.into_iter().chain(plant.iter().copied()).chain(steps(last_hz, high_hz).map(at)).collect()
    }

    /// Free mode without the gear's loss, Hz, and its standard uncertainty: f_l √(1 + ηr_a), r_a = (f_r/f_l)² − 1.
    ///
    /// A motor that drives feels the chain's force over the gear's efficiency η, so that its response has its peak at
    /// f_r = f_l √(1 + r/η), r = M(R/n)²/J_m; the dip at f_l is the load's alone and does not move.
    #[must_use]
    pub fn free_through_gear(&self, efficiency: f64, efficiency_std: f64) -> (f64, f64) {
        let (load, apparent) = (self.load, self.free);
        let free_hz = load.frequency_hz * (1.0 + efficiency * self.inertia_ratio).sqrt();
        // f² = (1 − η) f_l² + η f_r².
        let by_load = (1.0 - efficiency) * load.frequency_hz / free_hz * load.frequency_std_hz;
        let by_free = efficiency * apparent.frequency_hz / free_hz * apparent.frequency_std_hz;
        let by_gear = 0.5 * (apparent.frequency_hz.powi(2) - load.frequency_hz.powi(2)) / free_hz * efficiency_std;
        let both = 2.0 * self.correlation[0][2] * by_load * by_free;
        (free_hz, (by_load * by_load + by_free * by_free + both + by_gear * by_gear).max(0.0).sqrt())
    }
}

/// First guesses: the load mode anywhere in the range, the free one above it by what light to heavy loads give.
fn starts(plant: &[ResponsePoint]) -> Vec<[f64; PARAMETERS]> {
    let (first, last) = (&plant[0], &plant[plant.len() - 1]);
    let k = last.plant_rad_v.norm() * (std::f64::consts::TAU * last.frequency_hz).powi(2);
    let range = (last.frequency_hz / first.frequency_hz).ln();
    let mut out = Vec::new();
    for i in 0..8 {
        let load = first.frequency_hz.ln() + range * (0.1 + 0.1 * f64::from(i));
        for ratio in [1.4_f64, 2.2, 3.5] {
            out.push([k.ln(), 0.0, load, 0.03, load + ratio.ln(), 0.05, 2.5e-4]);
        }
    }
    out
}

/// Weighted residuals ln(measured/model): moduli first, then phases.
fn residuals(plant: &[ResponsePoint], p: &[f64]) -> Vec<f64> {
    let ratio = |q: &ResponsePoint| (q.plant_rad_v / model(p, q.frequency_hz)).ln() / weight(q);
    plant.iter().map(|q| ratio(q).re).chain(plant.iter().map(|q| ratio(q).im)).collect()
}

/// Standard deviation of a point, at least 1 %: what friction bends does not show in the coherence.
fn weight(point: &ResponsePoint) -> f64 {
    point.relative_std.max(0.01)
}

/// A shaper for a mode: impulses that leave it at rest (Singer & Seering 1990).
#[derive(Debug, Clone, PartialEq)]
pub struct Shaper {
    /// Its impulses: time, s, and part of the whole.
    pub impulses: Vec<(f64, f64)>,
    /// Time that it adds to a move, s.
    pub added_s: f64,
    /// Residual swing with the mode `wrong` (relative) off, as a part of the unshaped one.
    pub residual_10_percent_low: f64,
    /// The same with the mode higher by 10 %.
    pub residual_10_percent_high: f64,
}

/// Zero-vibration shaper, or with `is_robust` the one with zero derivative as well, for a mode, and what it leaves 10 % off it.
#[must_use]
pub fn shaper(mode: &Mode, is_robust: bool) -> Shaper {
    let damped = (1.0 - mode.damping * mode.damping).max(1e-6).sqrt();
    let half_s = 0.5 / (mode.frequency_hz * damped);
    let k = (-mode.damping * std::f64::consts::PI / damped).exp();
    let impulses: Vec<(f64, f64)> = if is_robust {
        let total = (1.0 + k) * (1.0 + k);
        vec![(0.0, 1.0 / total), (half_s, 2.0 * k / total), (2.0 * half_s, k * k / total)]
    } else {
        vec![(0.0, 1.0 / (1.0 + k)), (half_s, k / (1.0 + k))]
    };
    let mut out = Shaper {
        impulses,
        added_s: if is_robust { 2.0 * half_s } else { half_s },
        residual_10_percent_low: 0.0,
        residual_10_percent_high: 0.0,
    };
    out.residual_10_percent_low = out.residual(0.9 * mode.frequency_hz, mode.damping);
    out.residual_10_percent_high = out.residual(1.1 * mode.frequency_hz, mode.damping);
    out
}

impl Shaper {
    /// Swing of a mode that is left, as a part of the unshaped one: |Σ a e^((ζ − i√(1−ζ²)) ω t)|.
    #[must_use]
    pub fn residual(&self, frequency_hz: f64, damping: f64) -> f64 {
        let omega = std::f64::consts::TAU * frequency_hz;
        let damped = (1.0 - damping * damping).max(1e-6).sqrt();
        let term = |&(t, a): &(f64, f64)| a * (Complex64::new(damping * omega, -omega * damped) * t).exp();
        self.impulses.iter().map(term).sum::<Complex64>().norm()
    }
}
