//! Friction of the carriage over position and speed, from runs without drag.
//!
//! In volts of the drive command, as everything is before the force per volt comes in:
//! v_c = C(y) sgn v + B v + b, with b what a tilted tank or an amplifier's offset adds (only with both directions).
//! C is one number, or a broken line over position (hat functions on equal knots). Fitted by least squares to means
//! over cells of one knot spacing of the steady windows, each weighted by its part of the window's tapered mean.

use froude_fit::faer::Mat;
use froude_fit::series::taper;
use froude_fit::{Options, Problem, fit};

use super::run::DragRun;
use super::steady::reach;
use super::steady::{SteadySettings, window};

/// Spacing of the knots of a map, m, where that takes no more than 2501 of them: 0.1 m resolves a bump that is half a metre wide to 2 % of its height.
pub const KNOT_SPACING_M: f64 = 0.1;

/// Knots of a map at most: it costs their third power. On ways longer than 250 m they lie further apart.
const MOST_KNOTS: usize = 2501;

/// Friction in volts of the drive command.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction {
    /// Coulomb part at the knots, V; one knot: the same everywhere.
    pub coulomb_v: Vec<f64>,
    /// Position of the first knot, m.
    pub first_knot_m: f64,
    /// Spacing of the knots, m.
    pub spacing_m: f64,
    /// Viscous part, V s/m.
    pub viscous_v_s_m: f64,
    /// Command that motion either way needs alike, V.
    pub bias_v: f64,
    /// Positions that it was identified at, m.
    pub range_m: [f64; 2],
}

/// Means over one stretch of a run's steady window, one knot spacing long.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Mean position, m.
    pub position_m: f64,
    /// Mean speed over the whole window, m/s, signed.
    pub speed_m_s: f64,
    /// +1 or −1.
    pub direction: f64,
    /// Mean command, V.
    pub command_v: f64,
    /// Its part of the window's tapered mean, over that of a cell of an even mean \[-\]: friction is identified with the weights that the
    /// force of a wet run is taken with, so that a bump in mid-window is not taken for drag.
    pub weight: f64,
}

impl Friction {
    /// Command that friction needs at a position and a signed speed, V.
    #[must_use]
    pub fn command_v(&self, position_m: f64, speed_m_s: f64) -> f64 {
        if speed_m_s == 0.0 {
            return self.bias_v;
        }
        speed_m_s.signum() * self.coulomb_at(position_m) + self.viscous_v_s_m * speed_m_s + self.bias_v
    }

    /// Coulomb part at a position, V; held at its end values beyond the knots.
    #[must_use]
    pub fn coulomb_at(&self, position_m: f64) -> f64 {
        let (i, part) = locate(position_m, self.first_knot_m, self.spacing_m, self.coulomb_v.len());
        let here = self.coulomb_v[i];
        if part == 0.0 { here } else { here + part * (self.coulomb_v[i + 1] - here) }
    }

    /// Identifies friction from the [`cells`] of runs without drag; B is left out where all runs have one speed.
    ///
    /// `None` without cells, or where a stretch between two knots was never passed.
    #[must_use]
    pub fn identify<'a>(cells: impl IntoIterator<Item = &'a Cell>, is_mapped: bool) -> Option<Self> {
        Self::with_knots(&cells.into_iter().collect::<Vec<_>>(), is_mapped, MOST_KNOTS)
    }

    fn with_knots(cells: &[&Cell], is_mapped: bool, most: usize) -> Option<Self> {
        let range_m = reach(&cells.iter().map(|c| c.position_m).collect::<Vec<_>>());
        if cells.is_empty() {
            return None;
        }
        let way_m = range_m[1] - range_m[0];
        let knots = if is_mapped { knots_over(way_m, most) } else { 1 };
        let spacing_m = if knots > 1 { way_m / (knots - 1) as f64 } else { KNOT_SPACING_M };
        let has = |sign: f64| cells.iter().any(|c| c.direction == sign);
        let has_bias = has(1.0) && has(-1.0);
        let speeds = reach(&cells.iter().map(|c| c.speed_m_s.abs()).collect::<Vec<_>>());
        let has_viscous = speeds[1] > 1.2 * speeds[0];
        let columns = knots + usize::from(has_viscous) + usize::from(has_bias);
        let mut design = Mat::zeros(cells.len(), columns);
        for (row, c) in cells.iter().enumerate() {
            let (i, part) = locate(c.position_m, range_m[0], spacing_m, knots);
            let w = c.weight.sqrt();
            design[(row, i)] = w * c.direction * (1.0 - part);
            if part > 0.0 {
                design[(row, i + 1)] = w * c.direction * part;
            }
            if has_viscous {
                design[(row, knots)] = w * c.speed_m_s;
            }
            if has_bias {
                design[(row, columns - 1)] = w;
            }
        }
        let names = (0..columns).map(|j| format!("{j}")).collect();
        let response = cells.iter().map(|c| c.weight.sqrt() * c.command_v).collect();
        let fitted = fit(&Problem::single(design, response, names), &Options::default()).ok()?;
        let value: Vec<f64> = fitted.coefficients.iter().map(|c| c.value).collect::<Option<_>>()?;
        Some(Self {
            coulomb_v: value[..knots].to_vec(),
            first_knot_m: range_m[0],
            spacing_m,
            viscous_v_s_m: if has_viscous { value[knots] } else { 0.0 },
            bias_v: if has_bias { value[columns - 1] } else { 0.0 },
            range_m,
        })
    }
}

/// Knots of a map over a way.
fn knots_over(way_m: f64, most: usize) -> usize {
    1 + ((way_m / KNOT_SPACING_M).ceil() as usize).min(most - 1)
}

/// Knot at or below a position and the part of the way to the next one.
fn locate(position_m: f64, first_m: f64, spacing_m: f64, knots: usize) -> (usize, f64) {
    let last = (knots - 1) as f64;
    let x = ((position_m - first_m) / spacing_m).clamp(0.0, last);
    let i = x.floor().min((last - 1.0).max(0.0));
    let part = if knots == 1 { 0.0 } else { x - i };
    (i as usize, part)
}

/// Means of a run's steady window over stretches of one knot spacing; none without a steady window.
#[must_use]
pub fn cells(run: &DragRun<'_>, settings: SteadySettings) -> Vec<Cell> {
    let Ok(window) = window(run, settings) else { return Vec::new() };
    let speed_m_s = super::steady::mean_speed(run, window);
    let travelled = (speed_m_s * window.len() as f64 * run.step_s()).abs();
    let count = ((travelled / KNOT_SPACING_M).round() as usize).min(window.len()).max(1);
    let weights: Vec<f64> = taper(window.len()).collect();
    let even = weights.iter().sum::<f64>() / weights.len() as f64;
    (0..count)
        .map(|k| {
            let first = window.first + k * window.len() / count;
            let end = window.first + (k + 1) * window.len() / count;
            let of = |column: &[f64]| column.iter().sum::<f64>() / (end - first) as f64;
            let mean = |column: &[f64]| of(&column[first..end]);
            Cell {
                position_m: mean(run.position_m),
                speed_m_s,
                direction: run.direction,
                command_v: mean(run.command_v),
                weight: of(&weights[first - window.first..end - window.first]) / even,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drag::run::BodyState;
    use crate::scenario::{Logged, Scenario};

    /// Noise small: what is left is a bump of 0.27 m width seen through cells of 0.1 m, 0.5 N·(0.1/0.27)²/24 = 3 mN, and
    /// the broken line, twice that.
    #[test]
    fn the_map_shows_the_bump_where_it_is() {
        let mut scenario = Scenario::pinned(20.0);
        (scenario.run_to_run, scenario.torque_drift, scenario.noise_n) = (1e-5, 1e-5, 1e-5);
        scenario.pairs = 1;
        let logged = scenario.runs(1);
        let cells: Vec<Cell> = logged
            .iter()
            .map(Logged::view)
            .filter(|r| r.body == BodyState::Dry)
            .flat_map(|r| cells(&r, SteadySettings::default()))
            .collect();
        let map = Friction::identify(&cells, true).unwrap();
        let k = scenario.force_per_volt_n();
        for i in 0..16 {
            let x = 1.7 + 0.1 * f64::from(i);
            let found = k * map.coulomb_at(x);
            assert!((found - scenario.coulomb_at_n(x)).abs() < 0.01, "{x} m: {found} for {}", scenario.coulomb_at_n(x));
        }
        assert!((k * map.viscous_v_s_m - scenario.viscous_n_s_m).abs() < 0.02);
        assert!(map.bias_v.abs() < 1e-4);
    }

    /// 600 m of rails are mapped with 2501 knots, 0.24 m apart: as many as 250 m have, and none of them at 0.1 m. A friction that changes
    /// slowly is found all the same.
    #[test]
    fn a_way_longer_than_its_most_knots_has_them_further_apart() {
        let coulomb_v = |x: f64| 1.0 + 0.2 * (x / 40.0).sin();
        let over = |way_m: f64| -> Vec<Cell> {
            (0..6000)
                .flat_map(|i| {
                    let position_m = way_m * f64::from(i) / 5999.0;
                    [1.0, -1.0].map(|direction| Cell {
                        position_m,
                        speed_m_s: 0.3 * direction,
                        direction,
                        command_v: direction * coulomb_v(position_m),
                        weight: 1.0,
                    })
                })
                .collect()
        };
        for (way_m, knots, spacing_m) in [(249.95, 2501, 249.95 / 2500.0), (250.0, 2501, 0.1), (600.0, 2501, 0.24)] {
            let found = knots_over(way_m, MOST_KNOTS);
            assert_eq!(found, knots, "{way_m} m");
            assert!((way_m / (found - 1) as f64 - spacing_m).abs() < 1e-12, "{way_m} m");
        }
        // A fiftieth of each number, since a map costs the third power of its knots: the same rule.
        let cells = over(12.0);
        let map = Friction::with_knots(&cells.iter().collect::<Vec<_>>(), true, 51).unwrap();
        assert_eq!(map.coulomb_v.len(), 51);
        assert!((map.spacing_m - 0.24).abs() < 1e-12);
        for i in 0..=120 {
            let x = 0.1 * f64::from(i);
            assert!((map.coulomb_at(x) - coulomb_v(x)).abs() < 1e-4, "{x} m");
        }
        assert!((map.coulomb_at(-5.0) - coulomb_v(0.0)).abs() < 1e-4, "held at its ends");
    }

    #[test]
    fn one_speed_alone_leaves_the_viscous_part_out() {
        let cell = |position_m: f64| Cell { position_m, speed_m_s: 0.3, direction: 1.0, command_v: 0.5, weight: 1.0 };
        let friction = Friction::identify(&[cell(1.0), cell(2.0)], false).unwrap();
        assert!((friction.coulomb_v[0] - 0.5).abs() < 1e-12 && friction.viscous_v_s_m == 0.0);
        assert!(Friction::identify(&[], true).is_none());
    }
}
