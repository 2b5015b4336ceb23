//! From a record to the rows of a regression.
//!
//! 1. Position through a zero-phase Butterworth low-pass (the command stays as it is).
//! 2. Speed and acceleration by central differences (if the command is held, acceleration by second differences of position).
//! 3. Regressors of the friction law at the full rate, where `sgn` is sharp.
//! 4. Force **and every regressor** through the same zero-phase FIR decimation: the parallel filter that leaves the
//!    coefficients where they are, and takes out what lies beyond the filtered band.
//! 5. Both ends dropped.
//!
//! # Source
//!
//! Gautier (1997), ICRA, *Dynamic identification of robots with power model*, and Janot, Vandanjon & Gautier (2014), IEEE Trans.
//! Control Syst. Technol. 22, 132: position filter, central differences, parallel decimation.

use froude_records::number::plain;
use froude_signal::{butterworth, decimate, differences, zero_phase};

use crate::servo::coordinate::{Coordinate, DELAY};
use crate::servo::error::ServoError;
use crate::servo::friction::{Friction, Regressor, signum};
use crate::servo::load::{Load, Shape};
use crate::servo::log::{ServoLog, Stretch};
use crate::servo::motion::Motion;
use crate::servo::rows::Rows;

/// Rate of rows from a log, Hz: the effect of position noise grows with the fifth power of this rate, and a rigid axis needs no higher rate.
const ROW_RATE_HZ: f64 = 50.0;
/// Minimum decimation of a log, so that its filter removes what lies beyond the rows' band.
const LEAST_DECIMATION: usize = 4;
/// Rows of a log that are dropped at each end, where the decimation's filter reaches beyond it.
const TRIM_ROWS: f64 = 10.0;
/// Corner of the position filter for a log, Hz, and its largest fraction of the log's rate.
pub(crate) const CORNER_HZ: f64 = 50.0;
const MOST_CORNER: f64 = 0.25;
/// Largest filtered fraction of samples near rest and reversal in a row that is kept.
pub(crate) const MOST_NEAR_REST: f64 = 0.2;

/// From the stamp of a command to the force that it causes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Delay {
    /// On average over the hold of the command, s; half a step for a command that is held until the next one.
    pub at_s: f64,
    /// Whether it is fitted: a column `delay` then says by how much it is longer than `at_s`.
    pub is_estimated: bool,
    /// What one standard uncertainty of a delay that is not fitted, or of the command between its stamps, changes in each coefficient; none where that is known.
    pub changes: Vec<Vec<f64>>,
}

/// Where a model that is not linear in its coefficients is linearised.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct At {
    /// Coefficients of the load, in the order of its terms; empty before the first fit.
    pub load: Vec<f64>,
    /// `F_l`.
    pub of_load: f64,
}

/// How a record is made into rows, and what is fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// Force at the chain per volt of command, N/V.
    pub force_per_volt_n_v: f64,
    /// Order of the position filter (its attenuation counts twice).
    pub filter_order: usize,
    /// Its corner, Hz.
    pub corner_hz: f64,
    /// Decimation factor; 1 for none.
    pub decimation: usize,
    /// Dropped at each end, s.
    pub trim_s: f64,
    /// Whether the acceleration is taken by second differences, which average it as a held command is averaged over the two steps around a sample; else by central differences of the speed.
    pub is_held: bool,
    /// When a command acts.
    pub delay: Delay,
    /// Whether samples near rest and reversal are left out, because the direction of friction is unknown there: they are set to zero on both sides before decimation, and rows with too many of them are dropped.
    pub is_moving: bool,
    /// Whether rows are those of a simulation, whose residuals are correlated as the motion is.
    pub is_simulated: bool,
    /// What moves along what.
    pub coordinate: Coordinate,
    /// Friction law.
    pub friction: Friction,
    /// What loads the axis beside it.
    pub load: Load,
    /// Where it is linearised.
    pub at: At,
    /// Lag of HAC, s; `None` for the automatic one.
    pub hac_lag_s: Option<f64>,
}

impl Chain {
    /// Order 4 at 100 Hz, decimation by 10, 0.2 s dropped: for a record at 1 kHz.
    #[must_use]
    pub fn new(force_per_volt_n_v: f64, friction: Friction) -> Self {
        Self {
            force_per_volt_n_v,
            filter_order: 4,
            corner_hz: 100.0,
            decimation: 10,
            trim_s: 0.2,
            is_held: false,
            delay: Delay::default(),
            is_moving: false,
            is_simulated: false,
            coordinate: Coordinate::default(),
            friction,
            load: Load::default(),
            at: At::default(),
            hac_lag_s: None,
        }
    }

    /// For any log: the position's corner at 50 Hz, some fifty rows a second (both lower where the log has fewer than 200 samples a second), a delay that is estimated (from half a step on), and no rows near rest and reversal.
    #[must_use]
    pub fn of_log(force_per_volt_n_v: f64, rate_hz: f64, friction: Friction) -> Self {
        let decimation = ((rate_hz / ROW_RATE_HZ).round() as usize).max(LEAST_DECIMATION);
        Self {
            corner_hz: CORNER_HZ.min(MOST_CORNER * rate_hz),
            decimation,
            trim_s: TRIM_ROWS * decimation as f64 / rate_hz,
            is_held: true,
            delay: Delay { at_s: 0.5 / rate_hz, is_estimated: true, changes: Vec::new() },
            is_moving: true,
            ..Self::new(force_per_volt_n_v, friction)
        }
    }

    /// What its law says beside friction.
    #[must_use]
    pub fn shape(&self) -> Shape {
        Shape {
            coordinate: self.coordinate,
            loads: self.load.terms.iter().map(|(formula, _)| formula.clone()).collect(),
            stribeck_speed: self.friction.stribeck_speed_m_s,
            is_tabled: self.load.known.is_some(),
            is_simulated: self.is_simulated,
        }
    }

    /// 1 for samples that are so close to rest or reversal that the position's filter sees it: |v| ≤ |a|/corner.
    pub(crate) fn near_rest(&self, motion: &Motion) -> Vec<f64> {
        let reach_s = self.corner_hz.recip();
        let is_near = |(v, a): (&f64, &f64)| f64::from(u8::from(v.abs() <= reach_s * a.abs()));
        motion.velocity_m_s.iter().zip(&motion.acceleration_m_s2).map(is_near).collect()
    }

    /// Forces of commands at even steps, and the columns of the delay; `before` is the command of the sample before the first. For delays of up to a step.
    pub(crate) fn forces(&self, command_v: &[f64], before: Option<f64>, rate_hz: f64) -> [Vec<f64>; 2] {
        let g = self.force_per_volt_n_v;
        let late = self.delay.at_s * rate_hz;
        let first = before.or(command_v.first().copied()).into_iter();
        let pairs = || first.clone().chain(command_v.iter().copied()).zip(command_v);
        [
            pairs().map(|(held, u)| g * (late * held + (1.0 - late) * u)).collect(),
            pairs().map(|(held, u)| g * rate_hz * (u - held)).collect(),
        ]
    }

    /// How rows are made of a record at `rate_hz`, in words.
    #[must_use]
    pub fn words(&self, rate_hz: f64) -> String {
        format!(
            "position through a zero-phase Butterworth low-pass of order {} at {} Hz and differentiated twice; rows decimated by {} from {} Hz \
             after an anti-alias filter, without {} s at each end{}{}",
            self.filter_order,
            plain(self.corner_hz, 3),
            self.decimation,
            plain(rate_hz, 4),
            plain(self.trim_s, 3),
            if self.is_moving { " and without samples near rest and reversal" } else { "" },
            match (self.is_held, self.delay.is_estimated) {
                (false, _) => String::new(),
                (true, true) => "; the delay of the command, its hold included, is estimated".to_owned(),
                (true, false) => {
                    format!(
                        "; a command acts {} ms after its stamp, its hold included",
                        plain(1e3 * self.delay.at_s, 4)
                    )
                }
            }
        )
    }

    /// Filtered motion of a record at its full rate.
    ///
    /// # Errors
    ///
    /// [`ServoError`]: an uneven record, a filter that does not fit it.
    pub fn motion(&self, position_m: &[f64], rate_hz: f64) -> Result<Motion, ServoError> {
        let low_pass = butterworth::low_pass(self.filter_order, self.corner_hz, rate_hz)?;
        let position_m = zero_phase::filter(&low_pass, position_m)?;
        let velocity_m_s = differences::central(&position_m, rate_hz.recip())?;
        let acceleration_m_s2 = if self.is_held {
            differences::second(&position_m, rate_hz.recip())?
        } else {
            differences::central(&velocity_m_s, rate_hz.recip())?
        };
        Ok(Motion { position_m, velocity_m_s, acceleration_m_s2 })
    }

    /// The rows of the regression, of each stretch of even steps by itself; stretches too short for any are left out.
    ///
    /// # Errors
    ///
    /// [`ServoError`].
    pub fn rows(&self, log: &ServoLog) -> Result<Rows, ServoError> {
        self.rows_of(&self.prepared(log)?)
    }

    /// The stretches of a log with their filtered motion, which does not depend on where the model is linearised.
    pub(crate) fn prepared(&self, log: &ServoLog) -> Result<Vec<Prepared>, ServoError> {
        let of = |stretch: Stretch| -> Result<Prepared, ServoError> {
            let rate_hz = stretch.log.rate_hz()?;
            let motion = self.motion(&stretch.log.position_m, rate_hz);
            Ok(Prepared { stretch, rate_hz, motion })
        };
        log.evenly()?.stretches.into_iter().map(of).collect()
    }

    /// As [`Self::rows`].
    pub(crate) fn rows_of(&self, stretches: &[Prepared]) -> Result<Rows, ServoError> {
        let (mut joined, mut first_error): (Option<Rows>, Option<ServoError>) = (None, None);
        for stretch in stretches {
            match (self.rows_of_stretch(stretch), &mut joined) {
                (Ok(rows), None) => joined = Some(rows),
                (Ok(rows), Some(all)) => all.append(rows),
                (
                    Err(error @ (ServoError::TooFewRows { .. } | ServoError::AtRest { .. } | ServoError::Signal(_))),
                    _,
                ) => {
                    first_error.get_or_insert(error);
                }
                (Err(error), _) => return Err(error),
            }
        }
        joined.ok_or_else(|| first_error.unwrap_or(ServoError::TooFewRows { rows: 0, needed: 3 }))
    }

    fn rows_of_stretch(&self, prepared: &Prepared) -> Result<Rows, ServoError> {
        let Prepared { stretch, rate_hz, motion } = prepared;
        let (log, rate_hz, motion) = (&stretch.log, *rate_hz, motion.as_ref().map_err(Clone::clone)?);
        let command = stretch.command(self.delay.at_s);
        let forces = |x: &[f64]| x.iter().map(|x| self.force_per_volt_n_v * x).collect::<Vec<f64>>();
        let mut force_n = forces(&command.value_v);
        self.less_known(&mut force_n, motion);
        let mut regressors = self.regressors(motion)?;
        if self.delay.is_estimated {
            regressors.push(delay_column(forces(&command.slope_v_s)));
        }
        if !self.is_moving {
            return self.decimated(&log.time_s, &force_n, regressors, rate_hz);
        }
        let near: Vec<f64> =
            self.near_rest(motion).iter().zip(&command.is_missing).map(|(near, missing)| near.max(*missing)).collect();
        let moving = |x: &[f64]| x.iter().zip(&near).map(|(x, near)| x * (1.0 - near)).collect::<Vec<f64>>();
        let regressors = regressors.into_iter().map(|r| Regressor { values: moving(&r.values), ..r }).collect();
        let rows = self.decimated(&log.time_s, &moving(&force_n), regressors, rate_hz)?;
        let near = decimate::decimate(&near, self.decimation)?;
        let trim = (near.len() - rows.force_n.len()) / 2;
        let moving: Vec<usize> = (0..rows.force_n.len()).filter(|i| near[trim + i] <= MOST_NEAR_REST).collect();
        if moving.len() < rows.columns.len() + 2 {
            return Err(ServoError::AtRest { rows: moving.len(), needed: rows.columns.len() + 2 });
        }
        Ok(rows.chosen(&moving))
    }

    /// Columns at the full rate: inertia, friction, load.
    pub(crate) fn regressors(&self, motion: &Motion) -> Result<Vec<Regressor>, ServoError> {
        let [name, unit] = self.coordinate.names().inertia;
        let inertia = Regressor { name: name.to_owned(), unit: unit.into(), values: motion.acceleration_m_s2.clone() };
        let mut out = vec![inertia];
        out.extend(self.friction.regressors(&motion.velocity_m_s, &motion.position_m, self.coordinate)?);
        let mut terms = self.load.columns(motion, self.coordinate);
        if self.friction.is_of_load && !self.at.load.is_empty() {
            let load = self.load_at(&terms, motion);
            let sign = motion.velocity_m_s.iter().map(|v| signum(*v));
            let values: Vec<f64> = sign.clone().zip(&load).map(|(s, load)| s * load.abs()).collect();
            // F_l sgn v |load| changes with the coefficients of the load too.
            for term in &mut terms {
                let moved = term.values.iter_mut().zip(sign.clone()).zip(&load);
                moved.for_each(|((x, s), load)| *x *= 1.0 + self.at.of_load * s * signum(*load));
            }
            out.push(Regressor { name: OF_LOAD.to_owned(), unit: "1".into(), values });
        }
        out.extend(terms);
        Ok(out)
    }

    /// The load with the coefficients that the model is linearised at.
    fn load_at(&self, terms: &[Regressor], motion: &Motion) -> Vec<f64> {
        let mut out = self.load.known(&motion.position_m);
        for (term, k) in terms.iter().zip(&self.at.load) {
            out.iter_mut().zip(&term.values).for_each(|(load, x)| *load += k * x);
        }
        out
    }

    /// Takes the known load off the force, and adds what linearising counts twice.
    fn less_known(&self, force_n: &mut [f64], motion: &Motion) {
        if self.load.is_none() {
            return;
        }
        let known = self.load.known(&motion.position_m);
        force_n.iter_mut().zip(&known).for_each(|(force, load)| *force -= load);
        if self.friction.is_of_load && !self.at.load.is_empty() {
            let load = self.load_at(&self.load.columns(motion, self.coordinate), motion);
            for (((force, load), known), v) in force_n.iter_mut().zip(&load).zip(&known).zip(&motion.velocity_m_s) {
                *force += self.at.of_load * signum(*v) * signum(*load) * (load - known);
            }
        }
    }

    pub(crate) fn decimated(
        &self,
        time_s: &[f64],
        force_n: &[f64],
        regressors: Vec<Regressor>,
        rate_hz: f64,
    ) -> Result<Rows, ServoError> {
        let rate_hz = rate_hz / self.decimation as f64;
        let trim = (self.trim_s * rate_hz).round() as usize;
        let total = time_s.len().div_ceil(self.decimation);
        let needed = regressors.len() + 2;
        let rows = total.saturating_sub(2 * trim);
        if rows < needed {
            return Err(ServoError::TooFewRows { rows, needed });
        }
        let keep = |column: &[f64]| -> Result<Vec<f64>, ServoError> {
            Ok(decimate::decimate(column, self.decimation)?[trim..total - trim].to_vec())
        };
        let mut names = Vec::new();
        let mut columns = Vec::new();
        for regressor in regressors {
            columns.push(keep(&regressor.values)?);
            names.push((regressor.name, regressor.unit));
        }
        let time_s = time_s.iter().step_by(self.decimation).copied().collect::<Vec<f64>>();
        Ok(Rows { rate_hz, time_s: time_s[trim..total - trim].to_vec(), force_n: keep(force_n)?, names, columns })
    }
}

/// Least part of the column of the delay that no other column has.
const LEAST_PART: f64 = 0.02;

/// Standard uncertainties by which a delay must lie beyond the step to be determined, however wide they are.
const BEYOND: f64 = 2.0;

/// Whether a fit knows more of the delay than that it lies within a step: its value, its standard uncertainty, and the part of its column that no other column has.
pub(crate) fn is_delay_known(delay_s: f64, standard_s: f64, part: f64, step_s: f64) -> bool {
    let is_beyond = (delay_s - 0.5 * step_s).abs() > 0.5 * step_s + BEYOND * standard_s;
    part >= LEAST_PART && (is_beyond || standard_s <= step_s / 12.0_f64.sqrt())
}

/// Finding for an undetermined delay.
pub(crate) fn delay_unknown(step_s: f64) -> String {
    format!(
        "the motion does not determine the delay of the command: it is taken to lie between 0 and one step ({} ms), which the intervals include; move at several \
         frequencies, or declare `delay`",
        plain(1e3 * step_s, 4)
    )
}

/// The coefficient of friction in proportion to the load.
pub(crate) const OF_LOAD: &str = "F_l";

/// The column of the delay: what a second of it takes off the force.
pub(crate) fn delay_column(values: Vec<f64>) -> Regressor {
    Regressor { name: DELAY.to_owned(), unit: "s".into(), values }
}

/// A stretch of a log with its filtered motion.
#[derive(Debug)]
pub(crate) struct Prepared {
    stretch: Stretch,
    /// Its rate, Hz.
    pub rate_hz: f64,
    /// Its motion; an error where it is too short for the filter.
    pub motion: Result<Motion, ServoError>,
}
