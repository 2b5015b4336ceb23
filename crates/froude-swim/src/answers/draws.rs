//! Coefficients drawn from what their records say of their uncertainty.
//!
//! **Distribution.** About the estimate without bounds, with the record's covariance; by Student's t where the record states degrees of freedom, the fewest of all coefficients for all of them. One set of draws serves all gaits, so that two gaits are compared by pairs.
//!
//! **Laws that there are not.** Still water must take power from the straight robot. A draw that gains some becomes the nearest law that gains none, in the metric of the covariance, and how many these are is said. To refuse them would cut off the values next to a bound, where the truth may
//! lie. Bounds of the fit itself are not kept: the printed value is that of the fit within its bounds, and may lie beside the middle of its interval or, rarely, outside. Intervals of draws that were brought back to a boundary are those of a boundary: too narrow where most were.
//!
//! In three dimensions too the robot is that of the plane here: what drag does up and down goes with that across, and no record knows it.
//!
//! **Nearest law.** Power is linear in the coefficients, so that the laws that take it are a convex cone. Its faces are found one by one: the velocity at which the robot gains the most, then the nearest point behind all faces so far (least distance).
//!
//! **Source.** JCGM 101:2008 (propagation of distributions by draws); Lawson & Hanson (1974), 23.4 (least distance by non-negative least squares).

use faer::Mat;
use froude_fit::End;
use froude_fit::bounded::bounded_least_squares;
use rand::SeedableRng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::blueprint::{Blueprint, Number, drives_the_whole};
use crate::chain::Chain;
use crate::robot::RobotError;

/// Of draws that are asked for, most that are tried.
const MOST_TRIES: usize = 100;
/// Of the cone of laws that take power, most faces that are looked at for one draw.
const MOST_FACES: usize = 100;
/// By how much a draw that is brought back stands behind a face, of its terms' sum: beyond rounding.
const BEHIND: f64 = 1e-10;
/// A pivot of less than this part of its variance is nothing.
const NOTHING: f64 = 1e-12;
/// A negative pivot of more than this part of its variance is none of rounding.
const NEGATIVE: f64 = 1e-6;

/// Draws.
#[derive(Debug, Clone, PartialEq)]
pub struct Draws {
    /// Values of all numbers, a row per draw.
    pub values: Vec<Vec<f64>>,
    /// Those that were no bodies.
    pub beyond: Beyond,
}

/// How many draws were no bodies in water.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Beyond {
    /// How many of the draws still water would have given power, and are the nearest laws that take it.
    pub brought_back: usize,
    /// How many were refused and drawn again: their added mass is not positive, or no law is near.
    pub refused: usize,
}

impl std::ops::AddAssign for Beyond {
    fn add_assign(&mut self, other: Self) {
        self.brought_back += other.brought_back;
        self.refused += other.refused;
    }
}

impl Blueprint {
    /// So many draws; the same seed gives the same, and the first of many are the few.
    ///
    /// # Errors
    ///
    /// [`RobotError::Unfit`]: no covariance, or nearly no draw that is a body in water.
    pub fn draws(&self, n: usize, seed: u64) -> Result<Draws, RobotError> {
        let centre: Vec<f64> = self.numbers().iter().map(|c| c.centre.unwrap_or(c.value)).collect();
        let (id, unfit) = (self.id(), |problem: String| RobotError::of(self.record(), problem));
        let Some(covariance) = self.covariance() else {
            return Err(unfit(format!(
                "{id} states neither covariance nor standard uncertainty (published tables do not), so that nothing can be drawn; leave out --draws, or name an estimate that froude identify made"
            )));
        };
        if let Some(Number { name, .. }) = self.numbers().iter().find(|c| c.centre.is_none()) {
            return Err(unfit(format!(
                "{name} of {id} stands at its bound, and the record does not hold the estimate without it, about which its uncertainty is stated; identify again"
            )));
        }
        let root = root(&covariance).map_err(|j| {
            let name = &self.numbers()[j].name;
            unfit(format!(
                "the covariance of {id} is not positive semi-definite (at {name}): no estimate has such a covariance; make the record again with froude identify"
            ))
        })?;
        let dof = self.numbers().iter().filter_map(|c| c.dof).fold(f64::INFINITY, f64::min);
        let chi_squared = ChiSquared::new(dof).ok().filter(|_| dof.is_finite());
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut draws = Draws { values: Vec::with_capacity(n), beyond: Beyond::default() };
        while draws.values.len() < n {
            let kept = draws.values.len();
            if draws.beyond.refused > MOST_TRIES * n {
                let tried = draws.beyond.refused + kept;
                return Err(RobotError::Unfit(format!(
                    "of {tried} draws from the covariance of {id} all but {kept} are no bodies in water, nor is one near them: its coefficients are not determined well enough for intervals; choose a law with fewer of them"
                )));
            }
            let z: Vec<f64> = centre.iter().map(|_| StandardNormal.sample(&mut rng)).collect();
            let wide = chi_squared.map_or(1.0, |chi_squared| (dof / chi_squared.sample(&mut rng)).sqrt());
            let drawn = along(&centre, &root, &z.iter().map(|z| wide * z).collect::<Vec<f64>>());
            match self.nearest(&drawn, &root) {
                Some((values, faces)) => {
                    draws.beyond.brought_back += usize::from(faces > 0);
                    draws.values.push(values);
                }
                None => draws.beyond.refused += 1,
            }
        }
        Ok(draws)
    }

    /// The law nearest to a draw that takes power from the robot, with how many faces of the cone it took to find; `None` where there is none.
    fn nearest(&self, drawn: &[f64], root: &[Vec<f64>]) -> Option<(Vec<f64>, usize)> {
        let (mut values, mut faces) = (drawn.to_vec(), Vec::new());
        loop {
            let robot = self.robot::<Chain>(&values);
            if self.of_no_added_mass(&robot).is_some() || faces.len() == MOST_FACES {
                return None;
            }
            let Some(velocity) = drives_the_whole(&robot) else { return Some((values, faces.len())) };
            faces.push(Face::new(&self.power_row(velocity), drawn, root)?);
            values = along(drawn, root, &least_distance(&faces)?);
        }
    }
}

/// `from + L z`.
fn along(from: &[f64], root: &[Vec<f64>], z: &[f64]) -> Vec<f64> {
    let away = |row: &Vec<f64>| row.iter().zip(z).map(|(l, z)| l * z).sum::<f64>();
    from.iter().zip(root).map(|(from, row)| from + away(row)).collect()
}

/// A half-space `normal · z ≥ distance` in standard deviations from a draw, behind which water gives no power; the normal has the length 1.
struct Face {
    normal: Vec<f64>,
    distance: f64,
}

impl Face {
    /// Of `row · (drawn + L z) ≤ 0`; `None` where the covariance holds no way across.
    fn new(row: &[f64], drawn: &[f64], root: &[Vec<f64>]) -> Option<Self> {
        let terms = || row.iter().zip(drawn).map(|(a, d)| a * d);
        let (gained, of) = (terms().sum::<f64>(), terms().map(f64::abs).sum::<f64>());
        let across = |k: usize| -row.iter().zip(root).map(|(a, l)| a * l[k]).sum::<f64>();
        let normal: Vec<f64> = (0..row.len()).map(across).collect();
        let length = normal.iter().map(|g| g * g).sum::<f64>().sqrt();
        (length > 0.0).then(|| Self {
            normal: normal.iter().map(|g| g / length).collect(),
            distance: (gained + BEHIND * of) / length,
        })
    }
}

/// The point nearest to the origin behind all faces; `None` where there is none.
fn least_distance(faces: &[Face]) -> Option<Vec<f64>> {
    let n = faces.first()?.normal.len();
    let e = Mat::from_fn(n + 1, faces.len(), |i, k| faces[k].normal.get(i).copied().unwrap_or(faces[k].distance));
    let mut target = vec![0.0; n + 1];
    target[n] = 1.0;
    let (none, any) = (vec![0.0; faces.len()], vec![f64::INFINITY; faces.len()]);
    let dual = bounded_least_squares(e.as_ref(), &target, &none, &any);
    if dual.report.end != End::Converged {
        return None;
    }
    let rest = |i: usize| (0..faces.len()).map(|k| e[(i, k)] * dual.x[k]).sum::<f64>() - target[i];
    let last = rest(n);
    let z: Vec<f64> = (0..n).map(|i| -rest(i) / last).collect();
    z.iter().all(|z| z.is_finite()).then_some(z)
}

/// L with L Lᵀ = C, of a matrix that may be semi-definite (Cholesky); else the row at which it is not.
fn root(c: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, usize> {
    let n = c.len();
    let mut l = vec![vec![0.0; n]; n];
    for j in 0..n {
        let pivot = c[j][j] - l[j][..j].iter().map(|x| x * x).sum::<f64>();
        if pivot < -NEGATIVE * c[j][j].abs() {
            return Err(j);
        }
        if pivot <= NOTHING * c[j][j] {
            continue;
        }
        l[j][j] = pivot.sqrt();
        for i in j + 1..n {
            let known: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            l[i][j] = (c[i][j] - known) / l[j][j];
        }
    }
    Ok(l)
}

/// The envelope of the intervals of several laws, each from so many numbers in turn; `None` where one of them has fewer than two.
#[must_use]
pub fn envelope_95<'a>(laws: impl IntoIterator<Item = &'a [f64]>) -> Option<[f64; 2]> {
    let each: Option<Vec<[f64; 2]>> = laws.into_iter().map(interval_95).collect();
    each?.into_iter().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// The interval that leaves 2.5 % of the distribution of the numbers on either side, as far as there are numbers; `None` of fewer than two.
///
/// At the place p(n + 1) of the sorted numbers, so that what lies below it is p on average (Weibull's plotting position).
#[must_use]
pub fn interval_95(numbers: &[f64]) -> Option<[f64; 2]> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1).filter(|last| *last > 0)?;
    Some([0.025, 0.975].map(|p| {
        let place = (p * (last + 2) as f64 - 1.0).clamp(0.0, last as f64);
        let below = (place as usize).min(last - 1);
        let part = place - below as f64;
        sorted[below] * (1.0 - part) + sorted[below + 1] * part
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_squares_to_its_matrix_also_where_it_is_singular() {
        let c = vec![vec![4.0, 2.0, 0.0], vec![2.0, 1.0, 0.0], vec![0.0, 0.0, 9.0]];
        let l = root(&c).unwrap();
        for i in 0..3 {
            for j in 0..3 {
                let square: f64 = (0..3).map(|k| l[i][k] * l[j][k]).sum();
                assert!((square - c[i][j]).abs() < 1e-12);
            }
        }
        assert_eq!(root(&[vec![1.0, 2.0], vec![2.0, 1.0]]), Err(1));
    }

    /// Two faces by hand: x + y ≥ 2 alone is nearest at (1, 1); with x ≥ 1.5 at (1.5, 0.5).
    #[test]
    fn the_nearest_point_lies_behind_all_faces() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let faces =
            [Face { normal: vec![half, half], distance: 2.0 * half }, Face { normal: vec![1.0, 0.0], distance: 1.5 }];
        for (faces, expected) in [(&faces[..1], [1.0, 1.0]), (&faces[..], [1.5, 0.5])] {
            let found = least_distance(faces).unwrap();
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        }
    }

    #[test]
    fn an_interval_leaves_a_fortieth_on_either_side() {
        let numbers: Vec<f64> = (0..=40).rev().map(f64::from).collect();
        // 41 numbers: the places 0.05 and 39.95.
        let [low, high] = interval_95(&numbers).unwrap();
        assert!((low - 0.05).abs() < 1e-12 && (high - 39.95).abs() < 1e-12, "{low} {high}");
        assert_eq!(interval_95(&[1.0]), None);
    }
}
