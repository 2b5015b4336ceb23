//! A record of hours, a chunk at a time, in bounded memory.
//!
//! The same chain as [`Chain::rows`] and the same least squares, in one pass: filter, differences, regressors, parallel
//! decimation, both ends dropped, orthogonal triangle. Coefficients equal those of the whole record to rounding.
//!
//! HAC needs no second pass either. Bartlett's triangle is a box folded with itself, so that
//!
//! ```text
//! n (Γ₀ + Σ_k w_k (Γ_k + Γ_kᵀ)) = 1/(lag + 1) Σ_t B_t B_tᵀ,   B_t = Σ_{i = t − lag … t} x_i e_i
//! ```
//!
//! and with `e = y − xᵀb` a window's score is `B_t = Σ x y − (Σ x xᵀ) b`: windows' sums of products are gathered while
//! the record goes by, and `b` is put in at the end. A lag costs nothing, but must be known beforehand. So that the
//! products do not lose the digits by which residuals are smaller than the force, `y` is taken less a fit of the
//! record's beginning, and `b` likewise.
//!
//! Not here: blocks and the test of whiteness, which need all rows at once ([`crate::servo::interval`]).

use std::borrow::Cow;
use std::collections::VecDeque;

use froude_fit::faer::Mat;
use froude_fit::stream::{Accumulator, Shape};
use froude_records::number::plain;
use froude_signal::butterworth;
use froude_signal::decimate::Decimator;
use froude_signal::stream::{Differences, Link, SecondDifferences, ZeroPhase};

use crate::servo::chain::{Chain, MOST_NEAR_REST, delay_column, delay_unknown, is_delay_known};
use crate::servo::coordinate::DELAY;
use crate::servo::error::ServoError;
use crate::servo::excitation::{Column, excitation};
use crate::servo::interval::{BLOCK_S, diagonal_roots};
use crate::servo::motion::Motion;
use crate::servo::regression::{inverse_gram, solve};
use crate::servo::report::{NO_RANGE, RigidFit, coefficients, negative, widened};

/// Samples taken in at a time, so that the memory does not grow with a chunk.
const BITE: usize = 8192;

/// Rows of the beginning that scores are taken from, at least.
const BEGINNING: usize = 4096;

/// An identification under way.
///
/// # Example
///
/// ```
/// use froude_carriage::servo::{Chain, Friction, LongServo};
/// let mut servo = LongServo::new(&Chain::new(6.0, Friction::symmetric()), 1000.0)?;
/// for second in 0..20 {
///     let time_s: Vec<f64> = (0..1000).map(|i| f64::from(second) + 1e-3 * f64::from(i)).collect();
///     let position_m: Vec<f64> = time_s.iter().map(|t| 0.2 * (1.3 * t).sin() + 0.1 * (3.1 * t).sin()).collect();
///     let command_v: Vec<f64> = (time_s.iter())
///         .map(|t| {
///             let v = 0.26 * (1.3 * t).cos() + 0.31 * (3.1 * t).cos();
///             let a = -0.338 * (1.3 * t).sin() - 0.961 * (3.1 * t).sin();
///             (6.0 * a + 2.0 * v + 2.5 * v.signum()) / 6.0
///         })
///         .collect();
///     servo.push(&position_m, &command_v)?;
/// }
/// let fit = servo.finish()?;
/// assert_eq!(fit.coefficients[0].name, "M");
/// assert!((fit.coefficients[0].value - 6.0).abs() < 0.01);
/// # Ok::<(), froude_carriage::servo::ServoError>(())
/// ```
#[derive(Debug)]
pub struct LongServo {
    chain: Chain,
    names: Vec<(String, Cow<'static, str>)>,
    rate_hz: f64,
    trim: usize,
    taken: usize,
    filter: ZeroPhase,
    velocity: Differences,
    acceleration: Acceleration,
    /// Filtered and differentiated, not yet made into regressors; the three end at different samples.
    motion: Motion,
    /// Force of the samples whose motion is not yet complete, and their columns of the delay.
    force_n: Vec<f64>,
    by_delay: Vec<f64>,
    /// The command before the next one.
    before_v: Option<f64>,
    force: Decimator,
    /// How close to rest and reversal samples are, where rows near these are left out.
    near_rest: Decimator,
    columns: Vec<Decimator>,
    decimated: Decimated,
    rows: Accumulator,
    windows: Windows,
    /// Sum of the squares of the force, and of each column.
    squares_n2: f64,
    squares: Vec<f64>,
    /// Rows that were fitted.
    fitted: usize,
    ranges: Vec<[f64; 2]>,
}

/// Accelerations as [`Chain::motion`] takes them.
#[derive(Debug, Clone)]
enum Acceleration {
    OfPosition(SecondDifferences),
    OfVelocity(Differences),
}

impl Acceleration {
    fn new(chain: &Chain, rate_hz: f64) -> Result<Self, ServoError> {
        let step_s = rate_hz.recip();
        Ok(if chain.is_held {
            Self::OfPosition(SecondDifferences::new(step_s)?)
        } else {
            Self::OfVelocity(Differences::new(step_s)?)
        })
    }

    fn take(&mut self, [position_m, velocity_m_s]: [&[f64]; 2], out: &mut Vec<f64>) {
        match self {
            Self::OfPosition(differences) => differences.take(position_m, out),
            Self::OfVelocity(differences) => differences.take(velocity_m_s, out),
        }
    }

    fn finish(self, out: &mut Vec<f64>) -> Result<(), ServoError> {
        match self {
            Self::OfPosition(differences) => differences.finish(out)?,
            Self::OfVelocity(differences) => differences.finish(out)?,
        }
        Ok(())
    }
}

/// Decimated columns that wait for each other, and for the record's end to be far enough away.
#[derive(Debug, Clone)]
struct Decimated {
    force_n: Vec<f64>,
    near_rest: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// Rows at the record's front that are still to be dropped.
    in_front: usize,
}

impl LongServo {
    /// Begins a record sampled at `rate_hz`.
    ///
    /// HAC's lag is the chain's `hac_lag_s`, or the length of a block where that is left open: the automatic lag needs
    /// the residuals first.
    ///
    /// # Errors
    ///
    /// [`ServoError`]: a filter or a friction law that cannot be, a lag that is not a time.
    pub fn new(chain: &Chain, rate_hz: f64) -> Result<Self, ServoError> {
        let low_pass = butterworth::low_pass(chain.filter_order, chain.corner_hz, rate_hz)?;
        let row_rate_hz = rate_hz / chain.decimation as f64;
        let lag_s = chain.hac_lag_s.unwrap_or(BLOCK_S);
        if !(0.0..f64::INFINITY).contains(&lag_s) {
            return Err(ServoError::Setting {
                what: "lag of HAC (s)",
                found: lag_s,
                must: "it is a time, 0 or longer",
            });
        }
        let none = Motion { position_m: Vec::new(), velocity_m_s: Vec::new(), acceleration_m_s2: Vec::new() };
        let of_delay = chain.delay.is_estimated.then(|| delay_column(Vec::new()));
        let names: Vec<_> = chain.regressors(&none)?.into_iter().chain(of_delay).map(|r| (r.name, r.unit)).collect();
        let decimator = Decimator::new(chain.decimation)?;
        let trim = (chain.trim_s * row_rate_hz).round() as usize;
        Ok(Self {
            rate_hz,
            trim,
            taken: 0,
            filter: ZeroPhase::new(low_pass),
            velocity: Differences::new(rate_hz.recip())?,
            acceleration: Acceleration::new(chain, rate_hz)?,
            motion: none,
            force_n: Vec::new(),
            by_delay: Vec::new(),
            before_v: None,
            force: decimator.clone(),
            near_rest: decimator.clone(),
            columns: vec![decimator; names.len()],
            decimated: Decimated {
                force_n: Vec::new(),
                near_rest: Vec::new(),
                columns: vec![Vec::new(); names.len()],
                in_front: trim,
            },
            rows: Accumulator::new(Shape { regressors: names.len(), responses: 1 }),
            windows: Windows::new(names.len(), (lag_s * row_rate_hz).round() as usize),
            squares_n2: 0.0,
            squares: vec![0.0; names.len()],
            fitted: 0,
            ranges: vec![NO_RANGE; names.len()],
            chain: chain.clone(),
            names,
        })
    }

    /// Takes the next samples.
    ///
    /// # Errors
    ///
    /// [`ServoError::Length`], [`ServoError::Fit`] for a value that is not finite.
    pub fn push(&mut self, position_m: &[f64], command_v: &[f64]) -> Result<(), ServoError> {
        let (found, expected) = (command_v.len(), position_m.len());
        if found != expected {
            return Err(ServoError::Length { column: "command", found, expected });
        }
        for start in (0..position_m.len()).step_by(BITE) {
            let bite = start..position_m.len().min(start + BITE);
            self.taken += bite.len();
            let command_v = &command_v[bite.clone()];
            let [force_n, by_delay] = self.chain.forces(command_v, self.before_v, self.rate_hz);
            self.force_n.extend(force_n);
            self.by_delay.extend(by_delay);
            self.before_v = command_v.last().copied();
            let position = self.motion.position_m.len();
            self.filter.take(&position_m[bite], &mut self.motion.position_m);
            self.differentiate(position);
            self.regress(self.trim)?;
        }
        Ok(())
    }

    /// Differences of the filtered positions from `position` on.
    fn differentiate(&mut self, position: usize) {
        let velocity = self.motion.velocity_m_s.len();
        let Motion { position_m, velocity_m_s, acceleration_m_s2 } = &mut self.motion;
        self.velocity.take(&position_m[position..], velocity_m_s);
        self.acceleration.take([&position_m[position..], &velocity_m_s[velocity..]], acceleration_m_s2);
    }

    /// Rows of what is complete; `kept` of them stay, in case the record ends here.
    fn regress(&mut self, kept: usize) -> Result<(), ServoError> {
        let Motion { position_m, velocity_m_s, acceleration_m_s2 } = &mut self.motion;
        let n = acceleration_m_s2.len().min(velocity_m_s.len());
        let part = |column: &mut Vec<f64>| column.drain(..n).collect::<Vec<f64>>();
        let motion = Motion {
            position_m: part(position_m),
            velocity_m_s: part(velocity_m_s),
            acceleration_m_s2: part(acceleration_m_s2),
        };
        let mut regressors = self.chain.regressors(&motion)?;
        let mut force_n: Vec<f64> = self.force_n.drain(..n).collect();
        let by_delay: Vec<f64> = self.by_delay.drain(..n).collect();
        if self.chain.delay.is_estimated {
            regressors.push(delay_column(by_delay));
        }
        let near = self.chain.near_rest(&motion);
        self.near_rest.take(&near, &mut self.decimated.near_rest);
        if self.chain.is_moving {
            let moving = |x: &mut Vec<f64>| x.iter_mut().zip(&near).for_each(|(x, near)| *x *= 1.0 - near);
            moving(&mut force_n);
            for regressor in &mut regressors {
                moving(&mut regressor.values);
            }
        }
        self.force.take(&force_n, &mut self.decimated.force_n);
        let to = self.columns.iter_mut().zip(&mut self.decimated.columns);
        for (regressor, (decimator, column)) in regressors.iter().zip(to) {
            decimator.take(&regressor.values, column);
        }
        self.fit(kept)
    }

    /// Decimated rows into the fit.
    fn fit(&mut self, kept: usize) -> Result<(), ServoError> {
        let Decimated { force_n, near_rest, columns, in_front } = &mut self.decimated;
        let complete = columns.iter().map(Vec::len).fold(force_n.len().min(near_rest.len()), usize::min);
        let ready = complete.saturating_sub(kept);
        let dropped = ready.min(*in_front);
        *in_front -= dropped;
        let is_taken = |i: &usize| !self.chain.is_moving || near_rest[*i] <= MOST_NEAR_REST;
        let taken: Vec<usize> = (dropped..ready).filter(is_taken).collect();
        let of = |column: &[f64]| taken.iter().map(|&i| column[i]).collect::<Vec<f64>>();
        let (kept, response) = (columns.iter().map(|c| of(c)).collect::<Vec<_>>(), of(force_n));
        let (regressors, response): (Vec<&[f64]>, &[f64]) = (kept.iter().map(Vec::as_slice).collect(), &response);
        self.fitted += taken.len();
        self.rows.push(&regressors, &[response])?;
        self.windows.push(&regressors, response);
        self.squares_n2 += response.iter().map(|f| f * f).sum::<f64>();
        for (range, column) in self.ranges.iter_mut().zip(&regressors) {
            *range = widened(*range, column);
        }
        for (squares, column) in self.squares.iter_mut().zip(&regressors) {
            *squares += column.iter().map(|x| x * x).sum::<f64>();
        }
        force_n.drain(..ready);
        near_rest.drain(..ready);
        for column in columns {
            column.drain(..ready);
        }
        Ok(())
    }

    /// Ends the record. Its intervals are those of HAC, with 1.5 n/(lag + 1) degrees of freedom: Bartlett's window at frequency zero (Priestley
    /// 1981, 6.2).
    ///
    /// # Errors
    ///
    /// [`ServoError::TooFewRows`], [`ServoError::Signal`] for a record shorter than the filter, [`ServoError::Fit`] where
    /// it does not determine the coefficients.
    pub fn finish(mut self) -> Result<RigidFit, ServoError> {
        let total = self.taken.div_ceil(self.chain.decimation);
        let (rows, needed) = (total.saturating_sub(2 * self.trim), self.names.len() + 2);
        if rows < needed {
            return Err(ServoError::TooFewRows { rows, needed });
        }
        let position = self.motion.position_m.len();
        self.filter.clone().finish(&mut self.motion.position_m)?;
        self.differentiate(position);
        let velocity = self.motion.velocity_m_s.len();
        self.velocity.clone().finish(&mut self.motion.velocity_m_s)?;
        self.acceleration.take([&[], &self.motion.velocity_m_s[velocity..]], &mut self.motion.acceleration_m_s2);
        self.acceleration.clone().finish(&mut self.motion.acceleration_m_s2)?;
        self.regress(self.trim)?;
        self.force.clone().finish(&mut self.decimated.force_n)?;
        self.near_rest.clone().finish(&mut self.decimated.near_rest)?;
        for (decimator, column) in self.columns.iter().zip(&mut self.decimated.columns) {
            decimator.clone().finish(column)?;
        }
        self.fit(self.trim)?;
        let rows = self.fitted;
        if rows < needed {
            return Err(ServoError::AtRest { rows, needed });
        }

        let mut solution = self.rows.finish().solve(0)?;
        let p = self.names.len();
        let middle = self.windows.finish(&solution.coefficients);
        let dof = rows as f64 / (rows - p) as f64;
        let middle = Mat::from_fn(p, p, |i, j| dof * middle[i * p + j]);
        let inverse_gram = inverse_gram(&solution);
        let rate_hz = self.rate_hz / self.chain.decimation as f64;
        let mut covariance = &inverse_gram * middle * &inverse_gram;
        let hac = diagonal_roots(&covariance);
        let windows = rows as f64 / (self.windows.lag + 1) as f64;
        let columns: Vec<Column<'_>> = (0..p)
            .map(|j| Column { name: &self.names[j].0, hac: hac[j], rms: (self.squares[j] / rows as f64).sqrt() })
            .collect();
        let mut weak = Vec::new();
        let mut is_told = vec![true; p];
        if self.chain.is_moving {
            let found = excitation(&columns, &solution, rows, rate_hz, self.chain.corner_hz);
            covariance += &found.moved;
            (weak, is_told) = (found.findings, found.is_told);
        }
        let mut findings = Vec::new();
        let delay = self.names.iter().position(|(name, _)| name == DELAY);
        if let Some(d) = delay {
            let (step_s, late_s) = (self.rate_hz.recip(), solution.coefficients[d]);
            let part = solution.sigma / (solution.standard[d] * self.squares[d].sqrt());
            if !is_delay_known(late_s + self.chain.delay.at_s, covariance[(d, d)].sqrt(), part, step_s) {
                // The other coefficients for a delay that lies within a step: they are linear in it.
                let by: Vec<f64> = (0..p).map(|i| solution.covariance[(i, d)] / solution.covariance[(d, d)]).collect();
                for (c, by) in solution.coefficients.iter_mut().zip(&by) {
                    *c -= by * late_s;
                }
                let whole = covariance[(d, d)] + step_s * step_s / 12.0;
                covariance = Mat::from_fn(p, p, |i, j| {
                    covariance[(i, j)] - by[i] * covariance[(d, j)] - by[j] * covariance[(i, d)] + by[i] * by[j] * whole
                });
                findings.push(delay_unknown(step_s));
            } else if late_s.abs() > step_s {
                findings.push(format!(
                    "the command acts {} ms after its stamp, more than a step: a log that is read in chunks is fitted for delays of up to one. Cut it to fewer rows, or shift the command",
                    plain(1e3 * (late_s + self.chain.delay.at_s), 4)
                ));
            }
        }
        let hac = diagonal_roots(&covariance);
        let dof = vec![(1.5 * windows).min(solution.dof); p];
        let mut coefficients = coefficients(&self.names, &solution, [&hac, &hac, &dof], &is_told);
        if let Some(c) = delay.and_then(|d| coefficients.get_mut(d)) {
            c.value += self.chain.delay.at_s;
            c.interval = c.interval.map(|end| end + self.chain.delay.at_s);
        }
        Ok(RigidFit {
            findings: negative(&coefficients).chain(findings).collect(),
            excitation: weak,
            coefficients,
            shape: self.chain.shape(),
            covariance,
            dof,
            pieces: format!("HAC with a lag of {:.1} s", self.windows.lag as f64 / rate_hz),
            runs: None,
            ranges: self.ranges,
            preparation: self.chain.words(self.rate_hz),
            n_rows: rows,
            rate_hz,
            relative_force_error: (solution.residual_squares / self.squares_n2).sqrt(),
            sigma_n: solution.sigma,
            condition_number: None,
        })
    }
}

/// Products of the sums over moving windows of `lag + 1` rows: what the scores' long-run covariance needs, for any
/// coefficients.
#[derive(Debug, Clone)]
struct Windows {
    p: usize,
    lag: usize,
    /// Products of a row, `x e` and then the upper triangle of `x xᵀ`.
    width: usize,
    /// Coefficients of the beginning, and its rows until there are enough of them.
    reference: Option<Vec<f64>>,
    beginning: Vec<Vec<f64>>,
    /// `Σ_t W_t W_tᵀ` of the windows' sums `W`, upper triangle by rows.
    squares: Vec<f64>,
    /// Sums over the rows of the block of `lag + 1` before this one, from each row to the block's end.
    behind: VecDeque<f64>,
    /// Rows of this block.
    block: Vec<f64>,
    /// Sum over this block so far.
    sum: Vec<f64>,
}

impl Windows {
    fn new(p: usize, lag: usize) -> Self {
        let width = p + p * (p + 1) / 2;
        Self {
            p,
            lag,
            width,
            reference: None,
            beginning: vec![Vec::new(); p + 1],
            squares: vec![0.0; width * (width + 1) / 2],
            behind: VecDeque::new(),
            block: Vec::new(),
            sum: vec![0.0; width],
        }
    }

    fn push(&mut self, columns: &[&[f64]], response: &[f64]) {
        if self.reference.is_some() {
            self.products(columns, response);
            return;
        }
        for (held, new) in self.beginning.iter_mut().zip(columns.iter().chain([&response])) {
            held.extend_from_slice(new);
        }
        if self.beginning[self.p].len() >= BEGINNING.max(4 * self.lag) {
            self.begin();
        }
    }

    /// Fits the beginning and takes its rows in. One that determines nothing yet is no reference: zeros are.
    fn begin(&mut self) {
        let beginning = std::mem::take(&mut self.beginning);
        let (columns, response) = beginning.split_at(self.p);
        let fit = solve(columns, &response[0]).map_or_else(|_| vec![0.0; self.p], |s| s.coefficients);
        self.reference = Some(fit);
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        self.products(&columns, &response[0]);
    }

    fn products(&mut self, columns: &[&[f64]], response: &[f64]) {
        let reference = self.reference.take().unwrap_or_default();
        let mut row = Vec::with_capacity(self.width);
        for (i, y) in response.iter().enumerate() {
            let e = columns.iter().zip(&reference).fold(*y, |e, (x, b)| e - x[i] * b);
            row.clear();
            row.extend(columns.iter().map(|x| x[i] * e));
            for a in 0..self.p {
                row.extend((a..self.p).map(|b| columns[a][i] * columns[b][i]));
            }
            self.row(&row);
        }
        self.reference = Some(reference);
    }

    /// A window ends with this row: the rest of the block before, and this block so far. Nothing is ever taken off a
    /// sum, so that rounding does not gather.
    fn row(&mut self, row: &[f64]) {
        for (sum, x) in self.sum.iter_mut().zip(row) {
            *sum += x;
        }
        self.block.extend_from_slice(row);
        self.behind.drain(..self.width.min(self.behind.len()));
        let mut window = self.sum.clone();
        for (w, x) in window.iter_mut().zip(&self.behind) {
            *w += x;
        }
        let mut squares = self.squares.iter_mut();
        for (i, a) in window.iter().enumerate() {
            for (b, square) in window[i..].iter().zip(squares.by_ref()) {
                *square += a * b;
            }
        }
        if self.block.len() == (self.lag + 1) * self.width {
            for at in (0..self.block.len() - self.width).rev() {
                self.block[at] += self.block[at + self.width];
            }
            self.behind = std::mem::take(&mut self.block).into();
            self.sum.fill(0.0);
        }
    }

    /// `n (Γ₀ + Σ w_k (Γ_k + Γ_kᵀ))` of the scores for these coefficients, `p × p`, row-major.
    fn finish(&mut self, coefficients: &[f64]) -> Vec<f64> {
        if self.reference.is_none() {
            self.begin();
        }
        let reference = self.reference.iter().flatten();
        let coefficients: Vec<f64> = coefficients.iter().zip(reference).map(|(b, r)| b - r).collect();
        // Windows that the record's end cuts short.
        let nothing = vec![0.0; self.width];
        for _ in 0..self.lag {
            self.row(&nothing);
        }
        // Score of a window = map · W.
        let (p, width) = (self.p, self.width);
        let mut map = vec![0.0; p * width];
        let mut at = p;
        for a in 0..p {
            map[a * width + a] = 1.0;
            for b in a..p {
                map[a * width + at] -= coefficients[b];
                if a != b {
                    map[b * width + at] -= coefficients[a];
                }
                at += 1;
            }
        }
        let square = |i: usize, j: usize| {
            let (i, j) = (i.min(j), i.max(j));
            self.squares[i * (2 * width - i + 1) / 2 + j - i]
        };
        let mut out = vec![0.0; p * p];
        for (k, out) in out.iter_mut().enumerate() {
            let (a, b) = (&map[k / p * width..][..width], &map[k % p * width..][..width]);
            for i in 0..width {
                let row: f64 = (0..width).map(|j| square(i, j) * b[j]).sum();
                *out += a[i] * row / (self.lag + 1) as f64;
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::friction::Friction;
    use crate::servo::interval::hac;
    use crate::servo::log::ServoLog;
    use crate::servo::regression::least_squares;
    use crate::servo::report::ServoCoefficient;
    use proptest::prelude::*;

    /// Two tones that reverse every few seconds, a command with friction, a ripple nobody records; 60 s at 1 kHz.
    fn record() -> ServoLog {
        let time_s: Vec<f64> = (0..60_000).map(|i| 1e-3 * f64::from(i)).collect();
        let position_m = time_s.iter().map(|t| 0.2 * (1.3 * t).sin() + 0.1 * (3.1 * t).sin()).collect();
        let command_v = (time_s.iter())
            .map(|t| {
                let v = 0.26 * (1.3 * t).cos() + 0.31 * (3.1 * t).cos();
                let a = -0.338 * (1.3 * t).sin() - 0.961 * (3.1 * t).sin();
                (6.0 * a + 2.0 * v + 2.5 * v.signum() + 0.3 + 0.1 * (17.0 * t).sin()) / 6.0
            })
            .collect();
        ServoLog { time_s, position_m, command_v }
    }

    /// Both sides round alike but in another order: some 6000 roundings times a condition of some 100 are 1.3e-10.
    const TOLERANCE: f64 = 1e-9;

    #[track_caller]
    fn same(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() <= TOLERANCE * b.abs(), "{a} {b}");
        }
    }

    fn compare(log: &ServoLog, chain: &Chain, cut: usize) {
        let rows = chain.rows(log).unwrap();
        let whole = least_squares(&rows).unwrap();
        let residuals = rows.residuals_n(&whole.coefficients);
        let lag_s = chain.hac_lag_s;
        let (mut expected, lag_s) = hac(&rows.columns, &residuals, &inverse_gram(&whole), rows.rate_hz, lag_s);
        if chain.is_moving {
            let rms = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
            let columns: Vec<Column<'_>> = (rows.names.iter().zip(&rows.columns).zip(&expected))
                .map(|(((name, _), column), hac)| Column { name, hac: *hac, rms: rms(column) })
                .collect();
            let moved = excitation(&columns, &whole, rows.force_n.len(), rows.rate_hz, chain.corner_hz).moved;
            assert!((0..expected.len()).all(|j| moved[(j, j)] > 0.0));
            expected.iter_mut().enumerate().for_each(|(j, hac)| *hac = hac.hypot(moved[(j, j)].sqrt()));
        }

        let mut servo = LongServo::new(chain, 1000.0).unwrap();
        for start in (0..log.time_s.len()).step_by(cut) {
            let part = log.part(start..log.time_s.len().min(start + cut));
            servo.push(&part.position_m, &part.command_v).unwrap();
        }
        assert_eq!(servo.windows.lag, (lag_s * rows.rate_hz).round() as usize);
        let fit = servo.finish().unwrap();
        assert_eq!(fit.n_rows, rows.force_n.len());
        let own = |of: fn(&ServoCoefficient) -> f64| fit.coefficients.iter().map(of).collect::<Vec<f64>>();
        for (c, (name, unit)) in fit.coefficients.iter().zip(&rows.names) {
            assert_eq!((&c.name, &c.unit), (name, unit));
        }
        same(&own(|c| c.value), &whole.coefficients);
        same(&own(|c| c.classical_std), &whole.standard);
        same(&own(|c| c.hac_std), &expected);
        same(&[fit.relative_force_error], &[rows.relative_error(&whole.coefficients)]);
    }

    #[test]
    fn however_it_is_cut_a_record_gives_what_it_gives_in_memory() {
        let mut chain = Chain::new(6.0, Friction::symmetric());
        chain.hac_lag_s = Some(0.77);
        let log = record();
        for cut in [997, 10_000, 60_000] {
            compare(&log, &chain, cut);
        }
    }

    #[test]
    fn any_log_gives_the_same_result_in_chunks_as_in_memory() {
        let mut chain = Chain::of_log(6.0, 1000.0, Friction::asymmetric());
        chain.hac_lag_s = Some(0.77);
        // A delay that the motion does not determine is settled after the fit.
        chain.delay.is_estimated = false;
        for cut in [997, 60_000] {
            compare(&record(), &chain, cut);
        }
    }

    #[test]
    fn every_law_of_friction_and_a_lag_of_none() {
        let log = record();
        for friction in [
            Friction::asymmetric(),
            Friction { knots_m: vec![-0.2, 0.0, 0.2], ..Friction::default() },
            Friction { stribeck_speed_m_s: Some(0.05), ..Friction::default() },
        ] {
            let mut chain = Chain::new(6.0, friction);
            chain.hac_lag_s = Some(0.0);
            compare(&log, &chain, 7001);
        }
    }

    #[test]
    fn a_record_of_a_moment_is_refused_with_both_numbers() {
        let mut servo = LongServo::new(&Chain::new(6.0, Friction::symmetric()), 1000.0).unwrap();
        servo.push(&[0.0; 300], &[0.0; 300]).unwrap();
        let error = servo.finish().unwrap_err();
        assert_eq!(error, ServoError::TooFewRows { rows: 0, needed: 6 });
    }

    proptest! {
        /// Windows of products are the sum over lags, also where the lag is longer than the record.
        #[test]
        fn windows_are_the_sum_over_lags(
            rows in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 1..60), lag in 0_usize..80,
        ) {
            let column = |k: usize| rows.iter().map(|r| r[k]).collect::<Vec<f64>>();
            let (x, y) = ([column(0), column(1)], column(2));
            let coefficients = [0.3, -0.7];
            let mut windows = Windows::new(2, lag);
            windows.push(&[&x[0], &x[1]], &y);
            let found = windows.finish(&coefficients);
            let e: Vec<f64> = (0..y.len()).map(|i| y[i] - coefficients[0] * x[0][i] - coefficients[1] * x[1][i]).collect();
            let scores: Vec<Vec<f64>> = x.iter().map(|x| x.iter().zip(&e).map(|(x, e)| x * e).collect()).collect();
            let expected = froude_fit::long_run::covariance_of_sum(&[&scores[0], &scores[1]], lag);
            // A reference from few rows that are nearly parallel is large, and what is left of it after its part is
            // taken off again has its roundings: 60² products of scores of this size.
            let size = 1.0 + windows.reference.iter().flatten().map(|r| r.abs()).sum::<f64>();
            let rounding = 3600.0 * f64::EPSILON * size * size;
            for (a, b) in found.iter().zip(&expected) {
                prop_assert!((a - b).abs() < rounding, "{} {} within {}", a, b, rounding);
            }
        }
    }
}
