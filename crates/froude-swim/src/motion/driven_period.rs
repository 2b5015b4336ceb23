//! The motion that repeats itself where servos drive the joints: what repeats are their angles and rates too.
//!
//! Newton's method on the map of 2j + 3 numbers over a period, whose derivative is taken by differences. Where a step of it does not come nearer (torques that saturate have corners), the
//! swimmer is let go for some periods instead, as it would in a tank.
//!
//! **Units.** SI. **Source.** As [`crate::period`].

use faer::Mat;
use faer::prelude::*;

use crate::drive::Servo;
use crate::driven::Driven;
use crate::moving::{Instant, Servoed, go};
use crate::period::{MOST_PERIODS, MOST_STEPS, Periodic, REPEATS, Repeats, STEP, TRANSIENT, scale};
use crate::planar::Motion;
use crate::settled::settled;

/// A step of Newton's method is taken where it leaves less than this part of what does not repeat.
const NEARER: f64 = 0.5;

impl<'a> Driven<'a, Servo<'a>> {
    /// The periodic motion in `steps` steps a period, sought from a motion of the head with the joints where they shall be; seen at the beginning of each step of a period.
    ///
    /// `None` where there is none within reach or an inertia is not positive.
    pub fn periodic_seen(&self, head: Motion, steps: usize, see: &mut dyn FnMut(&Instant<'_>)) -> Option<Periodic> {
        let mut driven = self.clone();
        driven.current_m_s = [0.0; 2];
        let period = driven.drive.course().period_s();
        let size = sizes(&driven);
        let mut map = Map { driven: &mut driven, h: period / steps as f64, steps, periods: 0 };
        let mut z = map.wanted(head);
        for _ in 0..TRANSIENT {
            z = map.over(&z)?;
        }
        told(map, z, &size, see)
    }

    /// The motion that an unstable one settles into; as [`crate::path::Swimmer::settled_seen`].
    pub fn settled_seen(
        &self,
        unstable: &Periodic,
        steps: usize,
        see: &mut dyn FnMut(&Instant<'_>),
    ) -> Option<Periodic> {
        let mut driven = self.clone();
        driven.current_m_s = [0.0; 2];
        let period = driven.drive.course().period_s();
        let size = sizes(&driven);
        let angles = unstable.joints.iter().map(|joint| joint[0]);
        let start: Vec<f64> = angles.chain(unstable.head).chain(unstable.joints.iter().map(|joint| joint[1])).collect();
        let mut map = Map { driven: &mut driven, h: period / steps as f64, steps, periods: 0 };
        let near = settled(&start, &size, MOST_PERIODS, |z| map.over(z))?;
        let found = told(map, near, &size, see)?;
        (found.multipliers[0] <= 1.0).then_some(found)
    }
}

/// Numbers by which the angles, the head's motion and the rates are measured.
fn sizes(driven: &Driven<'_, Servo<'_>>) -> Vec<f64> {
    let (course, j) = (driven.drive.course(), driven.chain.joints());
    let period = course.period_s();
    let mut size = vec![1.0; j];
    size.extend(scale(driven.chain, period));
    size.extend((0..j).map(|i| course.extremes(i, j)[1].max(1.0 / period)));
    size
}

/// The motion that repeats next to `z`, with a period of it.
fn told(mut map: Map<'_, '_>, z: Vec<f64>, size: &[f64], see: &mut dyn FnMut(&Instant<'_>)) -> Option<Periodic> {
    let (z, repeats) = map.fixed(z, size)?;
    let (j, h, steps) = (map.driven.chain.joints(), map.h, map.steps);
    let state = map.state(&z);
    let joints = (0..j).map(|i| [z[i], z[3 + j + i]]).collect();
    let mut moving = Servoed::new(map.driven.clone(), state);
    let passage = go(&mut moving, h, steps, see)?;
    Some(Periodic::of(h * steps as f64, [z[j], z[j + 1], z[j + 2]], joints, &passage, &repeats))
}

/// The map over a period of angles, motion of the head and rates.
struct Map<'m, 'a> {
    driven: &'m mut Driven<'a, Servo<'a>>,
    h: f64,
    steps: usize,
    /// That were followed.
    periods: usize,
}

impl Map<'_, '_> {
    fn wanted(&self, head: Motion) -> Vec<f64> {
        let mut shape = crate::gait::Shape::straight(self.driven.chain.joints());
        self.driven.drive.course().at(0.0, &mut shape);
        [&shape.angle[..], &head, &shape.rate].concat()
    }

    /// A state with these numbers, the head at the origin along x.
    fn state(&self, z: &[f64]) -> Vec<f64> {
        let mut state = vec![0.0; self.driven.size()];
        state[3..3 + z.len()].copy_from_slice(z);
        state
    }

    fn over(&mut self, z: &[f64]) -> Option<Vec<f64>> {
        self.periods += 1;
        let mut state = self.state(z);
        for i in 0..self.steps {
            self.driven.step(i as f64 * self.h, self.h, &mut state)?;
        }
        let end = state[3..3 + z.len()].to_vec();
        end.iter().all(|x| x.is_finite()).then_some(end)
    }

    fn fixed(&mut self, mut z: Vec<f64>, size: &[f64]) -> Option<(Vec<f64>, Repeats)> {
        let n = z.len();
        let away = |z: &[f64], end: &[f64]| (0..n).map(|k| ((end[k] - z[k]) / size[k]).abs()).fold(0.0, f64::max);
        let mut end = self.over(&z)?;
        for _ in 0..MOST_STEPS {
            let mut derivative = Mat::zeros(n, n);
            for j in 0..n {
                let mut beside = z.clone();
                beside[j] += STEP * size[j];
                let moved = self.over(&beside)?;
                (0..n).for_each(|i| derivative[(i, j)] = (moved[i] - end[i]) / (STEP * size[j]));
            }
            let residual = away(&z, &end);
            if residual < REPEATS {
                return Some((z, Repeats { derivative, residual, periods: self.periods }));
            }
            let left = Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - derivative[(i, j)]);
            let step = left.partial_piv_lu().solve(Mat::from_fn(n, 1, |i, _| end[i] - z[i]));
            let tried: Vec<f64> = (0..n).map(|k| z[k] + step[(k, 0)]).collect();
            match self.over(&tried).filter(|there| away(&tried, there) < NEARER * residual) {
                Some(there) => (z, end) = (tried, there),
                None => {
                    for _ in 0..TRANSIENT {
                        z = std::mem::take(&mut end);
                        end = self.over(&z)?;
                    }
                }
            }
        }
        None
    }
}
