//! Added mass from the ramps: what wet and dry differ by while the carriage accelerates.
//!
//! At one time of the same profile the inertia of carriage and body is in both runs; the difference of the two commands is
//! F = m a + D_d v|v| + F₀ sgn v, with m the water that moves along: added mass and water inside the body. Fitted by
//! least squares over ramps and steady part, the jackknife over pairs gives its uncertainty.
//!
//! Only samples in which the motor drives in both runs count: braking through the gear has another efficiency.
//! Valid while the profile does not shake the chain; flow history (start-up of the wake) is in the result.

use super::coefficient::jackknife;
use super::run::{BodyState, DragRun, DragSetup, RunKind, Uncertain};

/// Water that moves along with the body.
#[derive(Debug, Clone, PartialEq)]
pub struct AddedMass {
    /// Added mass and water inside, kg.
    pub mass_kg: Uncertain,
    /// Its 95 % interval, kg.
    pub interval_95: [f64; 2],
    /// Pairs of runs used.
    pub runs: usize,
}

/// Normal equations of the difference over acceleration, v|v| and sgn v.
#[derive(Debug, Clone, Copy, Default)]
struct Normal {
    matrix: [[f64; 3]; 3],
    right: [f64; 3],
}

impl Normal {
    fn add(&mut self, row: [f64; 3], difference_n: f64) {
        for i in 0..3 {
            for j in 0..3 {
                self.matrix[i][j] += row[i] * row[j];
            }
            self.right[i] += row[i] * difference_n;
        }
    }

    fn with(mut self, other: &Self) -> Self {
        for i in 0..3 {
            for j in 0..3 {
                self.matrix[i][j] += other.matrix[i][j];
            }
            self.right[i] += other.right[i];
        }
        self
    }

    /// The mass, by Cramer's rule on columns scaled to one; `None` where the rows do not determine it.
    fn mass(&self) -> Option<f64> {
        let scale = [0, 1, 2].map(|i| self.matrix[i][i].sqrt());
        if scale.contains(&0.0) {
            return None;
        }
        let m = [0, 1, 2].map(|i| [0, 1, 2].map(|j| self.matrix[i][j] / (scale[i] * scale[j])));
        let r = [0, 1, 2].map(|i| self.right[i] / scale[i]);
        let determinant = |c: [f64; 3]| {
            c[0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - c[1] * (m[0][1] * m[2][2] - m[0][2] * m[2][1])
                + c[2] * (m[0][1] * m[1][2] - m[0][2] * m[1][1])
        };
        let whole = determinant([m[0][0], m[1][0], m[2][0]]);
        (whole > 1e-6).then(|| determinant(r) / whole / scale[0])
    }
}

/// Takes the samples of one wet and dry run at the same time since their start.
fn rows(wet: &DragRun<'_>, dry: &DragRun<'_>, force_per_volt_n: f64) -> Normal {
    let mut out = Normal::default();
    let start = |run: &DragRun<'_>| run.reference_speed_m_s.iter().position(|&v| v != 0.0);
    let (Some(i), Some(j)) = (start(wet), start(dry)) else { return out };
    let step = wet.step_s();
    let n = (wet.time_s.len() - i).min(dry.time_s.len() - j);
    for k in 1..n.saturating_sub(1) {
        let (v, v_dry) = (wet.reference_speed_m_s[i + k], dry.reference_speed_m_s[j + k]);
        let (c, c_dry) = (wet.command_v[i + k], dry.command_v[j + k]);
        let is_same = (v - v_dry).abs() <= 0.01 * wet.target_speed_m_s;
        if is_same && c * v > 0.0 && c_dry * v > 0.0 {
            let a = (wet.reference_speed_m_s[i + k + 1] - wet.reference_speed_m_s[i + k - 1]) / (2.0 * step);
            out.add([a, v * v.abs(), v.signum()], force_per_volt_n * (c - c_dry));
        }
    }
    out
}

/// Added mass by motor current difference; `None` without ramps in at least two pairs.
#[must_use]
pub fn added_mass(runs: &[DragRun<'_>], setup: &DragSetup) -> Option<AddedMass> {
    let tows = |body: BodyState| runs.iter().filter(move |r| r.kind == RunKind::Tow && r.body == body);
    let k = setup.force_per_volt_n();
    let all: Vec<(u32, Normal)> = tows(BodyState::Wet)
        .filter_map(|wet| tows(BodyState::Dry).find(|d| d.is_partner_of(wet)).map(|dry| (wet.pair, rows(wet, dry, k))))
        .collect();
    let mut pairs: Vec<u32> = all.iter().map(|a| a.0).collect();
    pairs.sort_unstable();
    pairs.dedup();
    let of = |skip: Option<u32>| {
        all.iter().filter(|a| Some(a.0) != skip).fold(Normal::default(), |sum, a| sum.with(&a.1)).mass()
    };
    let value = of(None)?;
    let (scatter, dof) = jackknife(pairs.len(), |g| of(Some(pairs[g])))?;
    let scale = match (setup.calibration, setup.efficiency) {
        (Some(c), _) => c.force_per_volt_n.relative(),
        (None, super::run::Efficiency::Declared(e)) => e.relative().hypot(setup.torque_constant_relative),
        (None, super::run::Efficiency::Undeclared) => return None,
    };
    let entries = [(scatter * scatter, dof), ((scale * value).powi(2), f64::INFINITY)];
    let e = froude_fit::propagate::expanded(&entries, 0.95);
    Some(AddedMass {
        mass_kg: Uncertain { value, standard: e.standard, dof: e.dof },
        interval_95: [value - e.expanded, value + e.expanded],
        runs: all.len(),
    })
}
