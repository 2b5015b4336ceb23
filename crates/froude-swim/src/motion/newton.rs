//! A fixed point of the map over a period.
//!
//! Newton's method; the eigenvalues of the map's derivative there are the Floquet multipliers. Where a step of it does not come nearer (torques that saturate have corners), the swimmer is let go for some periods
//! instead, as it would in a tank.
//!
//! Without a righting moment roll and pitch stay where they are, and their part of the map's derivative is one: then the step of least norm is taken (by singular values), and a multiplier of 1 shows it.
//!
//! **Source.** Nayfeh & Balachandran (1995), *Applied Nonlinear Dynamics*, ch. 3 (stability of periodic solutions) and 6 (shooting).

use faer::Mat;
use faer::prelude::*;

/// Periods that a swimmer is let go before Newton's method.
pub(crate) const TRANSIENT: usize = 3;
/// Steps of Newton's method.
const MOST_STEPS: usize = 30;
/// A motion repeats itself when each part is met to this, of the speed of a link length in a period, or rad.
pub(crate) const REPEATS: f64 = 1e-9;
/// Step of the differences of the map, of the same sizes.
pub(crate) const STEP: f64 = 1e-5;
/// A step of Newton's method is taken where it leaves less than this part of what does not repeat; where roll and pitch bend the map, any that leaves less …
const NEARER: f64 = 0.5;
/// … and it is halved at most so often.
const HALVINGS: i32 = 5;
/// Singular values below this fraction of the largest are treated as zero.
const SINGULAR: f64 = 1e-7;

/// How a map is.
#[derive(Debug, Clone, PartialEq)]
pub struct Form {
    /// Sizes by which its numbers are measured.
    pub size: Vec<f64>,
    /// Where roll and pitch stand, which nothing may right; roll is known up to a whole turn.
    pub tilt: Option<usize>,
    /// Whether it may have corners or many fixed points, so that a step has to come nearer.
    pub has_corners: bool,
}

/// The map of numbers over a period.
pub trait Map {
    /// How it is.
    fn form(&self) -> &Form;

    /// The numbers at the end of a period, in one step of so many; `None` where they are not finite.
    fn over(&mut self, from: &[f64], one_of: usize) -> Option<Vec<f64>>;

    /// Periods that were followed; those side by side count once.
    fn periods(&self) -> usize;

    /// The end of a period, where it is not known, with its derivative: differences to one side.
    fn differentiated(&mut self, from: &[f64], end: Option<Vec<f64>>, one_of: usize) -> Option<(Vec<f64>, Mat<f64>)> {
        let end = match end {
            Some(end) => end,
            None => self.over(from, one_of)?,
        };
        let n = from.len();
        let mut derivative = Mat::zeros(n, n);
        for j in 0..n {
            let by = STEP * self.form().size[j];
            let mut beside = from.to_vec();
            beside[j] += by;
            let moved = self.over(&beside, one_of)?;
            (0..n).for_each(|i| derivative[(i, j)] = self.form().way(i, end[i], moved[i]) / by);
        }
        Some((end, derivative))
    }
}

/// A fixed point.
#[derive(Debug)]
pub struct Fixed {
    /// The numbers that repeat.
    pub at: Vec<f64>,
    derivative: Mat<f64>,
    /// Largest difference over a period, in the sizes of [`Form`].
    pub residual: f64,
}

impl Form {
    /// From one value of a number to another.
    fn way(&self, k: usize, from: f64, to: f64) -> f64 {
        let way = to - from;
        if self.tilt == Some(k) { way.sin().atan2(way.cos()) } else { way }
    }

    /// The largest part by which two differ.
    fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        (0..a.len()).map(|k| (self.way(k, a[k], b[k]) / self.size[k]).abs()).fold(0.0, f64::max)
    }

    /// s with (1 − D) s = away; the smallest one where nothing may right the body.
    fn step(&self, derivative: &Mat<f64>, away: &[f64]) -> Option<Vec<f64>> {
        let n = away.len();
        let left = |i: usize, j: usize| f64::from(u8::from(i == j)) - derivative[(i, j)];
        if self.tilt.is_none() {
            let step = Mat::from_fn(n, n, left).partial_piv_lu().solve(Mat::from_fn(n, 1, |i, _| away[i]));
            return Some((0..n).map(|k| step[(k, 0)]).collect());
        }
        let svd = Mat::from_fn(n, n, |i, j| left(i, j) * self.size[j] / self.size[i]).svd().ok()?;
        let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        let largest = values.iter().fold(0.0_f64, |m, s| m.max(*s));
        let mut out = vec![0.0; n];
        for (k, value) in values.iter().enumerate().filter(|(_, value)| **value > SINGULAR * largest) {
            let along: f64 = (0..n).map(|i| svd.U()[(i, k)] * away[i] / self.size[i]).sum::<f64>() / value;
            for (j, out) in out.iter_mut().enumerate() {
                *out += self.size[j] * along * svd.V()[(j, k)];
            }
        }
        Some(out)
    }
}

impl Fixed {
    /// The one next to `z`, in one step of so many, to a part of the sizes.
    pub fn near(map: &mut (dyn Map + '_), mut z: Vec<f64>, (one_of, within): (usize, f64)) -> Option<Self> {
        let mut known = None;
        for _ in 0..MOST_STEPS {
            let (mut end, derivative) = map.differentiated(&z, known.take(), one_of)?;
            let form = map.form();
            let residual = form.apart(&z, &end);
            if residual < within {
                return Some(Self { at: z, derivative, residual });
            }
            let away: Vec<f64> = (0..z.len()).map(|k| form.way(k, z[k], end[k])).collect();
            let step = form.step(&derivative, &away)?;
            let part = |part: f64| z.iter().zip(&step).map(|(z, step)| z + part * step).collect::<Vec<f64>>();
            if !form.has_corners {
                z = part(1.0);
                continue;
            }
            let (halvings, nearer) = if form.tilt.is_some() { (HALVINGS, 1.0) } else { (0, NEARER) };
            let better = (0..=halvings).find_map(|k| {
                let tried = part(0.5_f64.powi(k));
                let there = map.over(&tried, one_of)?;
                (map.form().apart(&tried, &there) < nearer * residual).then_some((tried, there))
            });
            if let Some((tried, there)) = better {
                (z, known) = (tried, Some(there));
                continue;
            }
            for _ in 0..TRANSIENT {
                z = end;
                end = map.over(&z, one_of)?;
            }
            known = Some(end);
        }
        None
    }

    /// The fixed point that a swimmer approaches after it has left an unstable one, found as by [`Fixed::near`].
    pub fn settled(map: &mut (dyn Map + '_), unstable: &[f64], one_of: usize, most_periods: usize) -> Option<Self> {
        let form = map.form().clone();
        let near = crate::settled::settled(unstable, &form.size, most_periods, |z| {
            let mut end = map.over(z, one_of)?;
            (0..z.len()).for_each(|k| {
                if form.tilt == Some(k) {
                    end[k] = z[k] + form.way(k, z[k], end[k]);
                }
            });
            Some(end)
        })?;
        Self::near(map, near, (1, REPEATS))
    }

    /// Sizes of so many multipliers, the largest first.
    #[must_use]
    pub fn multipliers(&self, n: usize) -> Vec<f64> {
        let mut sizes: Vec<f64> =
            self.derivative.eigenvalues().map_or_else(|_| Vec::new(), |all| all.iter().map(|s| s.norm()).collect());
        sizes.sort_by(|a, b| b.total_cmp(a));
        sizes.resize(n, f64::NAN);
        sizes
    }
}
