//! Least squares of more rows than one wants to keep: one pass, bounded memory.
//!
//! Everything here is a triangle. A [`Factor`] is the upper triangle `R` of
//! `[X | Y] = Q·R`: it holds all that a least-squares fit needs of its rows, and
//! two factors merge into the factor of all their rows. Rows are folded in by
//! Householder reflections, a block at a time (tall-skinny QR); the products
//! `XᵀX` are never formed, so a design of condition number κ loses κ, not κ².
//!
//! **Setting.** `X` is `n × p` with `n ≫ p` (p to a few dozen), `Y` is `n × q`:
//! `q` responses of the same regressors. Weighted rows are scaled by the square
//! root of their weight before they come here.
//! **Order.** Sums are taken in blocks of rows fixed by row number, then merged in
//! order: the result is the same, bit for bit, however the rows are cut into
//! chunks and however many threads there are.
//!
//! | rows come | use |
//! | --- | --- |
//! | as columns in memory | [`reduce_columns`] |
//! | made on the fly from raw columns | [`reduce_features`] |
//! | chunk after chunk | [`Accumulator`] |
//! | with a cluster each | [`ClusterAccumulator`] |
//!
//! Then [`Factor::solve`] gives coefficients, σ and classical covariance,
//! [`Factor::solve_non_negative`] the fit under bounds at zero, and
//! [`ClusterFactors::covariance`] CR1 and CR3. One pass is enough for these, also
//! for CR3: a cluster's triangle replaces its rows exactly. HC3 and HAC weigh each
//! row by its final residual, hence need a second pass over the rows; Huber's
//! loss needs several. They are not here.
//!
//! # Accuracy
//!
//! Measured against a QR factorisation of the whole design (tests beside this
//! module): at κ from 1e1 to 1e7 the largest relative coefficient error stays
//! within 10 times that of `faer`'s Householder QR, most often below it.
//!
//! # Source
//!
//! Golub & Van Loan (2013), *Matrix Computations*, 4th ed., algorithm 5.2.1
//! (Householder QR); Demmel, Grigori, Hoemmen & Langou (2012), SIAM J. Sci. Comput.
//! 34, A206 (tall-skinny QR).
//!
//! # Example
//!
//! ```
//! # use froude_fit::stream::{Accumulator, Shape};
//! let mut rows = Accumulator::new(Shape { regressors: 2, responses: 1 });
//! for chunk in 0..10 {
//!     let u: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(100 * chunk + i)).collect();
//!     let quadratic: Vec<f64> = u.iter().map(|u| u * u.abs()).collect();
//!     let force: Vec<f64> = u.iter().map(|u| 3.0 * u + 0.5 * u * u.abs()).collect();
//!     rows.push(&[&u, &quadratic], &[&force])?;
//! }
//! let fit = rows.finish().solve(0)?;
//! assert!((fit.coefficients[1] - 0.5).abs() < 1e-12);
//! # Ok::<(), froude_fit::stream::StreamError>(())
//! ```

mod cluster;
mod gram;
mod kernel;
pub(crate) mod lanes;
mod non_negative;
#[doc(hidden)]
pub mod reference;
#[cfg(test)]
mod tests;

use std::ops::Range;

use faer::Mat;
use rayon::prelude::*;

pub use cluster::{ClusterAccumulator, ClusterCovariance, ClusterFactors, ClusterKind};
use gram::{LARGEST_INFLATION, add_products, largest_inflation, pairs};
use kernel::{Ahead, MakeRows, absorb, clear_from, groups_per_block, put};
use lanes::{LANES, Lane, Level};
pub use non_negative::NonNegative;

/// How many blocks before its turn a block is asked for.
const BLOCKS_AHEAD: usize = 4;

/// Blocks in a segment: the unit that one thread factors on its own.
const BLOCKS_PER_SEGMENT: usize = 256;

/// Why rows could not be reduced, or a factor not be solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StreamError {
    /// Columns were given in another number than the shape says.
    #[error("{found} {what} were given where the shape says {expected}")]
    Shape {
        /// Regressors, responses or columns.
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many are needed.
        expected: usize,
    },

    /// Columns of one chunk differ in length.
    #[error("column {column} has {found} rows, column 0 has {expected}; give equal lengths")]
    Length {
        /// Index of the column, regressors first, then responses.
        column: usize,
        /// Its length.
        found: usize,
        /// The length of the first column.
        expected: usize,
    },

    /// An entry is NaN or infinite, or so large that its square is.
    #[error(
        "row {row}, column {column} is {value}; every entry must be finite and below 1e150 \
         in size"
    )]
    NotFinite {
        /// Row, from 0 in the order given.
        row: u64,
        /// Index of the column, regressors first, then responses.
        column: usize,
        /// The entry.
        value: f64,
    },

    /// There are not more rows than coefficients.
    #[error("{rows} rows do not determine {regressors} coefficients and their scatter")]
    TooFewRows {
        /// Rows given.
        rows: u64,
        /// Coefficients asked for.
        regressors: usize,
    },

    /// The regressors are parallel to working precision.
    #[error(
        "the data do not determine coefficient {column}: its regressor is a combination of \
         the others (condition number {condition_number:.1e}); leave one out, or add data \
         that excite it"
    )]
    Undetermined {
        /// The regressor with the largest part in the combination.
        column: usize,
        /// Condition number of the design, columns scaled to equal length.
        condition_number: f64,
    },

    /// No such response.
    #[error("response {response} is asked for, but there are {responses}")]
    NoSuchResponse {
        /// The one asked for.
        response: usize,
        /// How many there are.
        responses: usize,
    },

    /// Factors of different shapes cannot be merged.
    #[error("a factor of shape {found:?} cannot be merged into one of {expected:?}")]
    Merge {
        /// Shape of the one to be merged.
        found: Shape,
        /// Shape of the other.
        expected: Shape,
    },

    /// The active-set method did not come to an end.
    #[error("the non-negative fit did not end within {iterations} changes of its active set")]
    NotConverged {
        /// Changes made.
        iterations: usize,
    },

    /// More clusters than memory was granted for.
    #[error(
        "cluster {cluster} is one more than the limit of {limit}: each keeps a triangle of its \
         own; raise the limit, or use longer clusters"
    )]
    TooManyClusters {
        /// The cluster that found no room.
        cluster: u64,
        /// The limit.
        limit: usize,
    },

    /// Too few clusters for an interval that means anything.
    #[error(
        "{found} clusters; cluster-robust covariance is refused below {needed}, where \
         its interval is unreliable"
    )]
    TooFewClusters {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },

    /// One cluster alone determines some coefficient.
    #[error(
        "without cluster {cluster} the coefficients are no longer determined; the cluster \
         jackknife (CR3) needs every one determined by the other clusters"
    )]
    ClusterDecides {
        /// The cluster.
        cluster: u64,
    },
}

/// How many columns there are of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Columns of the design, `p`.
    pub regressors: usize,
    /// Responses of the same regressors, `q`.
    pub responses: usize,
}

impl Shape {
    /// Regressors and responses together.
    #[must_use]
    pub fn width(self) -> usize {
        self.regressors + self.responses
    }

    /// Rows in a block.
    fn block_rows(self) -> usize {
        groups_per_block(self.width()) * LANES
    }

    /// Rows in a segment.
    fn segment_rows(self) -> usize {
        self.block_rows() * BLOCKS_PER_SEGMENT
    }
}

/// The triangle of `[X | Y]`: all that a least-squares fit needs of its rows.
///
/// `triangle` is `width × width`, row-major, zero below the diagonal, with
/// `RᵀR = [X | Y]ᵀ[X | Y]` up to rounding. Diagonal signs are arbitrary.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    shape: Shape,
    rows: u64,
    triangle: Vec<f64>,
}

impl Factor {
    /// The factor of no rows.
    #[must_use]
    pub fn empty(shape: Shape) -> Self {
        Self { shape, rows: 0, triangle: vec![0.0; shape.width() * shape.width()] }
    }

    /// Numbers of columns.
    #[must_use]
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Rows that went in.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Entry `(i, j)` of the triangle; column `regressors + k` belongs to response `k`.
    ///
    /// The `p × p` part and the response's first `p` entries are a small problem with
    /// the same minimiser as the large one, under any constraint and prior.
    #[must_use]
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        self.triangle[i * self.shape.width() + j]
    }

    /// Takes in the rows of another factor.
    ///
    /// # Errors
    ///
    /// [`StreamError::Merge`] when the shapes differ.
    pub fn merge(&mut self, other: &Self) -> Result<(), StreamError> {
        if self.shape != other.shape {
            return Err(StreamError::Merge { found: other.shape, expected: self.shape });
        }
        Folder::new(self.shape).fold_triangle(&mut self.triangle, &other.triangle);
        self.rows += other.rows;
        Ok(())
    }

    /// The same rows with some regressors left out and others in a new order.
    ///
    /// # Errors
    ///
    /// [`StreamError::NoSuchResponse`] or [`StreamError::Shape`] when an index does not exist.
    pub fn select(&self, regressors: &[usize], responses: &[usize]) -> Result<Self, StreamError> {
        let (p, width) = (self.shape.regressors, self.shape.width());
        if let Some(&bad) = regressors.iter().find(|&&j| j >= p) {
            return Err(StreamError::Shape { what: "regressors", found: bad + 1, expected: p });
        }
        for &k in responses {
            self.check_response(k)?;
        }
        let columns: Vec<usize> = (regressors.iter().copied()).chain(responses.iter().map(|k| p + k)).collect();
        let n = columns.len();
        let mut matrix: Vec<f64> = (0..width).flat_map(|i| columns.iter().map(move |&j| self.entry(i, j))).collect();
        reference::triangularise(&mut matrix, width, n);
        matrix.resize(width.max(n) * n, 0.0);
        matrix.truncate(n * n);
        Ok(Self {
            shape: Shape { regressors: regressors.len(), responses: responses.len() },
            rows: self.rows,
            triangle: matrix,
        })
    }

    /// Sum of squared residuals of the unconstrained fit of response `k`.
    #[must_use]
    pub fn residual_squares(&self, k: usize) -> f64 {
        self.residual_product(k, k)
    }

    /// Inner product of the residuals of responses `k` and `l`, unconstrained fits.
    ///
    /// Divided by `n − p` it estimates the covariance of their noise.
    #[must_use]
    pub fn residual_product(&self, k: usize, l: usize) -> f64 {
        let p = self.shape.regressors;
        (p..self.shape.width()).map(|i| self.entry(i, p + k) * self.entry(i, p + l)).sum()
    }

    /// Condition number of the design, its columns scaled to equal length.
    #[must_use]
    pub fn condition_number(&self) -> f64 {
        self.conditioning().0
    }

    /// Condition number, and the regressor with the largest part in the weakest direction.
    fn conditioning(&self) -> (f64, usize) {
        let p = self.shape.regressors;
        if p == 0 {
            return (1.0, 0);
        }
        let lengths = self.column_lengths();
        if let Some(zero) = lengths.iter().position(|&length| length == 0.0) {
            return (f64::INFINITY, zero);
        }
        let scaled = Mat::from_fn(p, p, |i, j| self.entry(i, j) / lengths[j]);
        let Ok(svd) = scaled.svd() else {
            return (f64::INFINITY, 0);
        };
        let singular = svd.S().column_vector();
        let (largest, smallest) = (singular[0], singular[p - 1]);
        let weakest = svd.V().col(p - 1);
        let column = (0..p).max_by(|&a, &b| weakest[a].abs().total_cmp(&weakest[b].abs())).unwrap_or(0);
        (largest / smallest, column)
    }

    /// Euclidean length of each regressor.
    fn column_lengths(&self) -> Vec<f64> {
        (0..self.shape.regressors).map(|j| (0..=j).map(|i| self.entry(i, j).powi(2)).sum::<f64>().sqrt()).collect()
    }

    fn check_response(&self, response: usize) -> Result<(), StreamError> {
        if response < self.shape.responses {
            return Ok(());
        }
        Err(StreamError::NoSuchResponse { response, responses: self.shape.responses })
    }

    /// Refuses a design that does not determine all its coefficients.
    fn check_determined(&self) -> Result<f64, StreamError> {
        let p = self.shape.regressors;
        if self.rows <= p as u64 {
            return Err(StreamError::TooFewRows { rows: self.rows, regressors: p });
        }
        let (condition_number, column) = self.conditioning();
        // Rounding alone gives parallel columns a condition number of about 1/(p·ε).
        if condition_number < 0.1 / (p.max(1) as f64 * f64::EPSILON) {
            return Ok(condition_number);
        }
        Err(StreamError::Undetermined { column, condition_number })
    }

    /// `R⁻¹` of the design, `p × p`, upper triangular.
    fn inverse(&self) -> Mat<f64> {
        let p = self.shape.regressors;
        let mut inverse = Mat::zeros(p, p);
        for j in 0..p {
            for i in (0..=j).rev() {
                let below: f64 = (i + 1..=j).map(|l| self.entry(i, l) * inverse[(l, j)]).sum();
                inverse[(i, j)] = (f64::from(u8::from(i == j)) - below) / self.entry(i, i);
            }
        }
        inverse
    }

    /// Back substitution: the minimiser for response `k`.
    fn minimiser(&self, k: usize) -> Vec<f64> {
        let p = self.shape.regressors;
        let mut beta = vec![0.0; p];
        for i in (0..p).rev() {
            let right: f64 = (i + 1..p).map(|j| self.entry(i, j) * beta[j]).sum();
            beta[i] = (self.entry(i, p + k) - right) / self.entry(i, i);
        }
        beta
    }

    /// Coefficients of every response in turn, where products may stand in for QR.
    fn pilot(&self) -> Option<Vec<f64>> {
        let inflation = largest_inflation(&self.triangle, self.shape.regressors, self.shape.width());
        (inflation <= LARGEST_INFLATION).then(|| (0..self.shape.responses).flat_map(|k| self.minimiser(k)).collect())
    }

    /// Ordinary least squares of response `k`, with classical covariance.
    ///
    /// # Errors
    ///
    /// [`StreamError::NoSuchResponse`], [`StreamError::TooFewRows`] when no degree of
    /// freedom is left, [`StreamError::Undetermined`] when regressors are parallel.
    pub fn solve(&self, k: usize) -> Result<Solution, StreamError> {
        self.check_response(k)?;
        let condition_number = self.check_determined()?;
        let p = self.shape.regressors;
        let squares = self.residual_squares(k);
        let dof = self.rows as f64 - p as f64;
        let variance = squares / dof;
        let inverse = self.inverse();
        let covariance = Mat::from_fn(p, p, |i, j| {
            let shared: f64 = (i.max(j)..p).map(|l| inverse[(i, l)] * inverse[(j, l)]).sum();
            variance * shared
        });
        Ok(Solution {
            coefficients: self.minimiser(k),
            standard: (0..p).map(|j| covariance[(j, j)].sqrt()).collect(),
            covariance,
            sigma: variance.sqrt(),
            dof,
            residual_squares: squares,
            condition_number,
        })
    }
}

/// Ordinary least squares of one response.
#[derive(Debug, Clone)]
pub struct Solution {
    /// The coefficients, in the order of the regressors.
    pub coefficients: Vec<f64>,
    /// Their classical standard uncertainties.
    pub standard: Vec<f64>,
    /// Classical covariance σ²(XᵀX)⁻¹, `p × p`.
    pub covariance: Mat<f64>,
    /// Standard deviation of the residuals, `n − p` degrees of freedom.
    pub sigma: f64,
    /// Degrees of freedom, `n − p`.
    pub dof: f64,
    /// Sum of squared residuals.
    pub residual_squares: f64,
    /// Condition number of the design, its columns scaled to equal length.
    pub condition_number: f64,
}

/// Memory for folding blocks into triangles of one shape.
struct Folder {
    shape: Shape,
    level: Level,
    block: Vec<Lane>,
    scratch: Vec<f64>,
}

impl Folder {
    fn new(shape: Shape) -> Self {
        Self::at_level(shape, Level::detect())
    }

    fn at_level(shape: Shape, level: Level) -> Self {
        let width = shape.width();
        Self { shape, level, block: vec![Lane::ZERO; width * groups_per_block(width)], scratch: vec![0.0; 2 * width] }
    }

    fn put(&mut self, column: usize, row: usize, values: &[f64]) {
        put(&mut self.block, self.shape.width(), column, row, values);
    }

    /// Folds the first `rows` rows of the block into `triangle`.
    ///
    /// False when an entry was not finite, or its square was not.
    #[must_use]
    fn fold(&mut self, triangle: &mut [f64], rows: usize, ahead: Ahead<'_>) -> bool {
        let width = self.shape.width();
        if rows == 0 || width == 0 {
            return true;
        }
        let used = rows.div_ceil(LANES) * width;
        clear_from(&mut self.block[..used], width, rows);
        absorb(self.level, triangle, &mut self.block[..used], &mut self.scratch, ahead);
        // A bad entry spoils all columns to its right, hence always the last.
        triangle.last().is_none_or(|last| last.is_finite())
    }

    /// Adds the products of the first `rows` rows of the block to `sums`.
    fn add_products(&mut self, sums: &mut [Lane], pilot: &[f64], rows: usize, ahead: Ahead<'_>) {
        let (p, width) = (self.shape.regressors, self.shape.width());
        let used = rows.div_ceil(LANES) * width;
        clear_from(&mut self.block[..used], width, rows);
        add_products(self.level, sums, &mut self.block[..used], p, pilot, width, ahead);
    }

    /// Folds another triangle in, a block of its rows after the other.
    fn fold_triangle(&mut self, triangle: &mut [f64], other: &[f64]) {
        let width = self.shape.width();
        if width == 0 {
            return;
        }
        let block_rows = self.shape.block_rows();
        for first in (0..width).step_by(block_rows) {
            let rows = (width - first).min(block_rows);
            for j in 0..width {
                for i in 0..rows {
                    self.put(j, i, &[other[(first + i) * width + j]]);
                }
            }
            // Both triangles are finite: each was checked when it was made.
            let _ = self.fold(triangle, rows, Ahead::nothing());
        }
    }
}

/// Rows taken in chunk after chunk.
///
/// Keeps one block of rows and two triangles, whatever comes. The cut into
/// chunks does not change the result, not even in the last bit.
#[derive(Debug)]
pub struct Accumulator {
    folder: Folder,
    /// Rows waiting in the block.
    waiting: usize,
    /// Blocks in the segment so far.
    blocks: usize,
    segment: Vec<f64>,
    total: Factor,
}

impl std::fmt::Debug for Folder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Folder").field("shape", &self.shape).finish_non_exhaustive()
    }
}

impl Accumulator {
    /// An accumulator without rows.
    #[must_use]
    pub fn new(shape: Shape) -> Self {
        Self {
            folder: Folder::new(shape),
            waiting: 0,
            blocks: 0,
            segment: vec![0.0; shape.width() * shape.width()],
            total: Factor::empty(shape),
        }
    }

    /// Rows taken so far.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.total.rows
    }

    /// Takes a chunk of rows: each regressor, then each response, as a column.
    ///
    /// # Errors
    ///
    /// [`StreamError::Shape`], [`StreamError::Length`], and [`StreamError::NotFinite`]
    /// with the row counted over all chunks. After an error nothing of the chunk has
    /// been taken.
    pub fn push(&mut self, regressors: &[&[f64]], responses: &[&[f64]]) -> Result<(), StreamError> {
        let columns = columns_of(self.total.shape, regressors, responses)?;
        let rows = check_lengths(&columns)?;
        check_finite(&columns, 0..rows, self.total.rows)?;
        self.take(&columns, 0..rows);
        Ok(())
    }

    /// Takes checked rows.
    fn take(&mut self, columns: &[&[f64]], rows: Range<usize>) {
        let shape = self.total.shape;
        let mut next = rows.start;
        while next < rows.end {
            let n = (rows.end - next).min(shape.block_rows() - self.waiting);
            for (j, column) in columns.iter().enumerate() {
                self.folder.put(j, self.waiting, &column[next..next + n]);
            }
            self.waiting += n;
            next += n;
            if self.waiting == shape.block_rows() {
                self.fold();
                if self.blocks == BLOCKS_PER_SEGMENT {
                    self.close_segment();
                }
            }
        }
        self.total.rows += rows.len() as u64;
    }

    fn fold(&mut self) {
        // The entries were checked when they came.
        let _ = self.folder.fold(&mut self.segment, self.waiting, Ahead::nothing());
        self.waiting = 0;
        self.blocks += 1;
    }

    fn close_segment(&mut self) {
        self.folder.fold_triangle(&mut self.total.triangle, &self.segment);
        self.segment.fill(0.0);
        self.blocks = 0;
    }

    /// The factor of all rows taken.
    #[must_use]
    pub fn finish(mut self) -> Factor {
        self.flush()
    }

    /// The factor of all rows taken; starts again without rows.
    fn flush(&mut self) -> Factor {
        self.fold();
        self.close_segment();
        let shape = self.total.shape;
        std::mem::replace(&mut self.total, Factor::empty(shape))
    }
}

/// How a segment of rows in memory becomes a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// By inner products where the rows themselves show that it is safe, by
    /// reflections elsewhere.
    ///
    /// The first segment (some ten thousand rows) is factored by reflections and fitted: the
    /// pilot. While variance inflation factors stay below 1000, the triangle of a
    /// further segment is the Cholesky factor of its columns' products, the responses
    /// taken as residuals of the pilot. At most three digits of sixteen are lost, and
    /// only of the small correction to the pilot; the coefficients keep theirs. A
    /// segment that does not pass is done again by reflections.
    #[default]
    Adaptive,
    /// Householder reflections throughout.
    Reflections,
}

/// Reduces columns in memory, on the threads of the current `rayon` pool.
///
/// `regressors` and `responses` are columns of equal length. The result does not
/// depend on the number of threads; with [`Method::Reflections`] it is that of
/// [`Accumulator`], bit for bit.
///
/// # Errors
///
/// [`StreamError::Length`], and [`StreamError::NotFinite`] with the first bad entry.
pub fn reduce_columns(regressors: &[&[f64]], responses: &[&[f64]], method: Method) -> Result<Factor, StreamError> {
    let shape = Shape { regressors: regressors.len(), responses: responses.len() };
    let columns = columns_of(shape, regressors, responses)?;
    let n = check_lengths(&columns)?;
    let fill = |(): &mut (), folder: &mut Folder, rows: Range<usize>| {
        for (j, column) in columns.iter().enumerate() {
            folder.put(j, 0, &column[rows.clone()]);
        }
    };
    let locate = |rows: Range<usize>| check_finite(&columns, rows, 0);
    reduce(Source { shape, n, raw: &columns, fill, locate }, method)
}

/// Reduces rows whose regressors are made on the fly from raw columns in memory, on
/// the threads of the current `rayon` pool.
///
/// `make(raw, columns)` gets a few hundred rows of every raw column, and writes the
/// same rows of each regressor, then of each response; all slices are equally long.
/// It is called for each stretch of rows once or twice, in any order and from several
/// threads.
///
/// # Errors
///
/// [`StreamError::Length`] for raw columns of different lengths, and
/// [`StreamError::NotFinite`] with the first bad entry that was made.
///
/// # Example
///
/// ```
/// # use froude_fit::stream::{reduce_features, Method, Shape};
/// let speed_m_s: Vec<f64> = (0..1000).map(|i| 1e-3 * f64::from(i)).collect();
/// let force_n: Vec<f64> = speed_m_s.iter().map(|u| 2.0 * u + 7.0 * u * u).collect();
/// let shape = Shape { regressors: 2, responses: 1 };
/// let factor = reduce_features(&[&speed_m_s, &force_n], shape, Method::Adaptive, |raw, columns| {
///     let ([u, f], [linear, quadratic, force]) = (raw, columns) else { return };
///     linear.copy_from_slice(u);
///     for (q, u) in quadratic.iter_mut().zip(*u) {
///         *q = u * u.abs();
///     }
///     force.copy_from_slice(f);
/// })?;
/// assert!((factor.solve(0)?.coefficients[1] - 7.0).abs() < 1e-11);
/// # Ok::<(), froude_fit::stream::StreamError>(())
/// ```
pub fn reduce_features<F>(raw: &[&[f64]], shape: Shape, method: Method, make: F) -> Result<Factor, StreamError>
where
    F: Fn(&[&[f64]], &mut [&mut [f64]]) + Sync,
{
    let n = check_lengths(raw)?;
    let stride = shape.block_rows();
    let made = |space: &mut Vec<f64>, rows: Range<usize>| {
        space.resize(shape.width() * stride, 0.0);
        let raw: Vec<&[f64]> = raw.iter().map(|column| &column[rows.clone()]).collect();
        let mut columns: Vec<&mut [f64]> =
            (space.chunks_exact_mut(stride)).map(|column| &mut column[..rows.len()]).collect();
        make(&raw, &mut columns);
    };
    let fill = |space: &mut Vec<f64>, folder: &mut Folder, rows: Range<usize>| {
        made(space, rows.clone());
        for (j, column) in space.chunks_exact(stride).enumerate() {
            folder.put(j, 0, &column[..rows.len()]);
        }
    };
    let locate = |rows: Range<usize>| {
        for start in rows.clone().step_by(stride) {
            let block = start..rows.end.min(start + stride);
            let mut space = Vec::new();
            made(&mut space, block.clone());
            let columns: Vec<&[f64]> = space.chunks_exact(stride).collect();
            check_finite(&columns, 0..block.len(), start as u64)?;
        }
        Ok(())
    };
    reduce(Source { shape, n, raw, fill, locate }, method)
}

/// Reduces rows made on the fly, each by a formula: the quickest way where the
/// number of columns is known to the compiler.
///
/// `make` turns one row of the `R` raw columns into one row of the `W` columns:
/// regressors, then `responses` responses. It may be called with zeros for rows past
/// the end, whose results are dropped. Otherwise like [`reduce_features`].
///
/// # Errors
///
/// [`StreamError::Shape`] when there are more responses than columns, otherwise those
/// of [`reduce_features`].
///
/// # Example
///
/// ```
/// # use froude_fit::stream::{reduce_rows, Method};
/// let speed_m_s: Vec<f64> = (0..1000).map(|i| 1e-3 * f64::from(i)).collect();
/// let force_n: Vec<f64> = speed_m_s.iter().map(|u| 2.0 * u + 7.0 * u * u).collect();
/// let factor = reduce_rows([&speed_m_s, &force_n], 1, Method::Adaptive, |[u, force]| {
///     [u, u * u.abs(), force]
/// })?;
/// assert!((factor.solve(0)?.coefficients[1] - 7.0).abs() < 1e-11);
/// # Ok::<(), froude_fit::stream::StreamError>(())
/// ```
pub fn reduce_rows<const R: usize, const W: usize, F>(
    raw: [&[f64]; R],
    responses: usize,
    method: Method,
    make: F,
) -> Result<Factor, StreamError>
where
    F: Fn([f64; R]) -> [f64; W] + Sync,
{
    let Some(regressors) = W.checked_sub(responses) else {
        return Err(StreamError::Shape { what: "responses", found: responses, expected: W });
    };
    let shape = Shape { regressors, responses };
    let n = check_lengths(&raw)?;
    let fill = |(): &mut (), folder: &mut Folder, rows: Range<usize>| {
        folder.level.for_compiler().run(MakeRows {
            raw: raw.map(|column| &column[rows.clone()]),
            block: &mut folder.block,
            make: &make,
        });
    };
    let locate = |rows: Range<usize>| {
        for i in rows {
            let row = make(raw.map(|column| column[i]));
            check_finite(&row.each_ref().map(std::slice::from_ref), 0..1, i as u64)?;
        }
        Ok(())
    };
    reduce(Source { shape, n, raw: &raw, fill, locate }, method)
}

/// Rows of a source, cut into segments that are factored by themselves.
struct Source<'a, F, L> {
    shape: Shape,
    n: usize,
    /// Columns in memory that the rows are made of.
    raw: &'a [&'a [f64]],
    /// Writes rows into the folder's block.
    fill: F,
    /// Finds the first bad entry among rows.
    locate: L,
}

impl<F, L> Source<'_, F, L>
where
    L: Fn(Range<usize>) -> Result<(), StreamError>,
{
    fn rows_of(&self, segment: usize) -> Range<usize> {
        let start = segment * self.shape.segment_rows();
        start..self.n.min(start + self.shape.segment_rows())
    }

    /// Calls `each` with the rows of every block of a segment, in order.
    fn blocks(&self, segment: usize) -> impl Iterator<Item = Range<usize>> {
        let (rows, step) = (self.rows_of(segment), self.shape.block_rows());
        let end = rows.end;
        rows.step_by(step).map(move |start| start..end.min(start + step))
    }

    /// What is needed some blocks after `rows`: near enough to be still in the cache then, far enough
    /// to have arrived.
    fn ahead(&self, rows: &Range<usize>) -> Ahead<'_> {
        let on = BLOCKS_AHEAD * self.shape.block_rows();
        Ahead::new(self.raw, self.n.min(rows.start + on)..self.n.min(rows.end + on))
    }

    /// A segment by reflections.
    fn reflect<S>(&self, segment: usize, (space, folder): &mut (S, Folder)) -> Result<Vec<f64>, StreamError>
    where
        F: Fn(&mut S, &mut Folder, Range<usize>),
    {
        let width = self.shape.width();
        let mut triangle = vec![0.0; width * width];
        for rows in self.blocks(segment) {
            (self.fill)(space, folder, rows.clone());
            if !folder.fold(&mut triangle, rows.len(), self.ahead(&rows)) {
                (self.locate)(rows)?;
            }
        }
        Ok(triangle)
    }

    /// A segment by inner products; None when they would not do.
    fn multiply<S>(&self, segment: usize, pilot: &[f64], (space, folder): &mut (S, Folder)) -> Option<Vec<f64>>
    where
        F: Fn(&mut S, &mut Folder, Range<usize>),
    {
        let (p, width) = (self.shape.regressors, self.shape.width());
        let mut sums = vec![Lane::ZERO; pairs(width)];
        for rows in self.blocks(segment) {
            (self.fill)(space, folder, rows.clone());
            folder.add_products(&mut sums, pilot, rows.len(), self.ahead(&rows));
        }
        gram::triangle(&sums, p, pilot, width)
    }
}

/// Segments factored by themselves, then merged in order.
fn reduce<S, F, L>(source: Source<'_, F, L>, method: Method) -> Result<Factor, StreamError>
where
    S: Default,
    F: Fn(&mut S, &mut Folder, Range<usize>) + Sync,
    L: Fn(Range<usize>) -> Result<(), StreamError> + Sync,
{
    let (shape, n) = (source.shape, source.n);
    let mut total = Factor::empty(shape);
    if n == 0 {
        return Ok(total);
    }
    let mut memory = (S::default(), Folder::new(shape));
    let first = source.reflect(0, &mut memory)?;
    memory.1.fold_triangle(&mut total.triangle, &first);
    let pilot = total.pilot().filter(|_| method == Method::Adaptive);
    let triangles: Vec<Result<Vec<f64>, StreamError>> = (1..n.div_ceil(shape.segment_rows()))
        .into_par_iter()
        .map_init(
            || (S::default(), Folder::new(shape)),
            |memory, segment| {
                let quick = (pilot.as_ref()).and_then(|pilot| source.multiply(segment, pilot, memory));
                quick.map_or_else(|| source.reflect(segment, memory), Ok)
            },
        )
        .collect();
    for triangle in triangles {
        memory.1.fold_triangle(&mut total.triangle, &triangle?);
    }
    total.rows = n as u64;
    Ok(total)
}

fn columns_of<'a>(
    shape: Shape,
    regressors: &[&'a [f64]],
    responses: &[&'a [f64]],
) -> Result<Vec<&'a [f64]>, StreamError> {
    for (what, found, expected) in
        [("regressors", regressors.len(), shape.regressors), ("responses", responses.len(), shape.responses)]
    {
        if found != expected {
            return Err(StreamError::Shape { what, found, expected });
        }
    }
    Ok(regressors.iter().chain(responses).copied().collect())
}

fn check_lengths(columns: &[&[f64]]) -> Result<usize, StreamError> {
    let expected = columns.first().map_or(0, |column| column.len());
    match columns.iter().position(|column| column.len() != expected) {
        None => Ok(expected),
        Some(column) => Err(StreamError::Length { column, found: columns[column].len(), expected }),
    }
}

/// The largest entry whose square, summed over any number of rows, stays finite.
const LARGEST: f64 = 1e150;

/// The first row of `rows` with a bad entry; `before` rows came earlier.
fn check_finite(columns: &[&[f64]], rows: Range<usize>, before: u64) -> Result<(), StreamError> {
    let good = |column: &&[f64]| {
        // Without an early exit, so that it runs in lanes.
        (column[rows.clone()].iter()).fold(true, |good, value| good & (value.abs() <= LARGEST))
    };
    if columns.iter().all(good) {
        return Ok(());
    }
    for row in rows {
        for (column, values) in columns.iter().enumerate() {
            let value = values[row];
            if value.is_nan() || value.abs() > LARGEST {
                return Err(StreamError::NotFinite { row: before + row as u64, column, value });
            }
        }
    }
    Ok(())
}
