//! Gaits that no other beats in both of two objectives, on a grid and between its points.
//!
//! **Search.** From the grid's front, steps of half the grid's distance to either side along every swept number, then of a quarter, and so on: new points that no other beats join the front, those that are beaten leave it. Nothing is drawn, and the same grid gives the same front.
//!
//! A gait whose motion is unstable (Floquet multiplier above 1) has no place on a front: the swimmer leaves it.
//!
//! **Source.** Pattern search as of Custódio, Madeira, Vaz & Vicente (2011), *SIAM J. Optim.* 21 (direct multisearch), with halved steps.

use std::collections::{BTreeMap, BTreeSet};

use crate::gait::Gait;
use crate::sweep::{Axis, Grid, Row};
use crate::swim::Status;

/// What is sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// High speed.
    Speed,
    /// Low net power.
    Power,
    /// Low cost of transport, by net power.
    Cost,
}

impl Objective {
    /// Name on a command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Power => "power",
            Self::Cost => "cost",
        }
    }

    /// What is larger where it is better.
    #[must_use]
    pub fn good(self, row: &Row) -> f64 {
        match self {
            Self::Speed => row.get("speed"),
            Self::Power => -row.get("power_net"),
            Self::Cost => -row.get("cot"),
        }
    }
}

/// Rows that no other beats in both, the best of the first objective first; of equals the first.
#[must_use]
pub fn front<'a>(rows: impl IntoIterator<Item = &'a Row>, of: [Objective; 2]) -> Vec<&'a Row> {
    let is_one = |row: &&Row| row.status == Status::Periodic && row.get("floquet") <= 1.0;
    let mut all: Vec<([f64; 2], &Row)> =
        rows.into_iter().filter(is_one).map(|row| (of.map(|o| o.good(row)), row)).collect();
    all.sort_by(|(a, _), (b, _)| b[0].total_cmp(&a[0]).then(b[1].total_cmp(&a[1])));
    let mut best = f64::NEG_INFINITY;
    all.retain(|(good, _)| {
        let is_better = good[1] > best;
        best = best.max(good[1]);
        is_better
    });
    all.into_iter().map(|(_, row)| row).collect()
}

/// A place between the points of a grid, in parts of its distances.
type Place = [usize; 4];

/// A front that becomes finer.
#[derive(Debug)]
pub struct Search<'a> {
    grid: &'a Grid,
    of: [Objective; 2],
    /// So many parts lie between two points of the grid.
    parts: usize,
    known: BTreeMap<Place, Row>,
}

impl<'a> Search<'a> {
    /// From the rows of a grid in its order, to be halved so many times.
    #[must_use]
    pub fn new(grid: &'a Grid, rows: &[Row], of: [Objective; 2], halvings: u32) -> Self {
        let parts = 1 << halvings;
        let axes = grid.axes();
        let place = |mut i: usize| {
            let mut at = [0; 4];
            for (place, axis) in at.iter_mut().zip(axes).rev() {
                *place = i % axis.n * parts;
                i /= axis.n;
            }
            at
        };
        let known = rows.iter().enumerate().map(|(i, row)| (place(i), *row)).collect();
        Self { grid, of, parts, known }
    }

    /// Rows that are known.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.known.len()
    }

    /// The front of what is known.
    #[must_use]
    pub fn front(&self) -> Vec<Row> {
        front(self.known.values(), self.of).into_iter().copied().collect()
    }

    /// Halves the distance until it is a part of the grid's; `swim` makes rows of gaits, in their order.
    ///
    /// # Errors
    ///
    /// Those of `swim`.
    pub fn refine<E>(&mut self, mut swim: impl FnMut(&[Gait]) -> Result<Vec<Row>, E>) -> Result<(), E> {
        let mut step = self.parts / 2;
        while step > 0 {
            let places = self.around(step);
            let gaits: Vec<Gait> = places.iter().map(|place| self.gait(*place)).collect();
            let rows = swim(&gaits)?;
            self.known.extend(places.into_iter().zip(rows));
            step /= 2;
        }
        Ok(())
    }

    /// New places beside those of the front.
    fn around(&self, step: usize) -> Vec<Place> {
        let axes = self.grid.axes();
        let rows = front(self.known.values(), self.of);
        let is_on = |row: &Row| rows.iter().any(|on| std::ptr::eq(*on, row));
        let mut new = BTreeSet::new();
        for place in self.known.iter().filter(|(_, row)| is_on(row)).map(|(place, _)| *place) {
            for (k, axis) in axes.iter().enumerate().filter(|(_, axis)| axis.n > 1) {
                let last = (axis.n - 1) * self.parts;
                let beside = [place[k].checked_sub(step), Some(place[k] + step).filter(|p| *p <= last)];
                for at in beside.into_iter().flatten() {
                    let mut there = place;
                    there[k] = at;
                    new.insert(there);
                }
            }
        }
        new.into_iter().filter(|place| !self.known.contains_key(place)).collect()
    }

    fn gait(&self, place: Place) -> Gait {
        let axes = self.grid.axes();
        let at = |k: usize| {
            let fine = Axis { n: (axes[k].n - 1) * self.parts + 1, ..axes[k] };
            fine.at(place[k])
        };
        self.grid.with([0, 1, 2, 3].map(at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::Envelope;
    use crate::sweep::COLUMNS;

    /// Speed a + b, power a² + b²: the best have a = b.
    fn row(gait: &Gait) -> Row {
        let mut numbers = [0.0; COLUMNS.len()];
        let mut put = |name: &str, x: f64| numbers[COLUMNS.iter().position(|(n, _)| *n == name).unwrap()] = x;
        let (a, b) = (gait.amplitude, gait.phase);
        put("amplitude", a);
        put("phase", b);
        put("speed", a + b);
        put("power_net", a * a + b * b);
        Row { numbers, status: Status::Periodic }
    }

    #[test]
    fn a_refined_front_closes_in_on_the_true_one() {
        let mut grid = Grid::of(&Gait::wave(0.0, 1.0, 0.0, Envelope::Lateral));
        grid.amplitude = Axis { low: 0.0, high: 1.0, n: 3 };
        grid.phase = Axis { low: 0.0, high: 1.0, n: 4 };
        let rows: Vec<Row> = (0..12).map(|i| row(&grid.gait(i))).collect();
        let mut search = Search::new(&grid, &rows, [Objective::Speed, Objective::Power], 4);
        // On the grid a power may be (1/2 − 1/3)²/2 above the least of its speed.
        let above =
            |front: &[Row]| front.iter().map(|r| r.get("power_net") - r.get("speed").powi(2) / 2.0).fold(0.0, f64::max);
        let coarse = above(&search.front());
        search.refine(|gaits| Ok::<_, ()>(gaits.iter().map(row).collect())).unwrap();
        let fine = search.front();
        assert!(fine.len() > 20 && above(&fine) < coarse / 10.0, "{} {} {coarse}", fine.len(), above(&fine));
        assert!(
            fine.windows(2)
                .all(|w| w[0].get("speed") > w[1].get("speed") && w[0].get("power_net") > w[1].get("power_net"))
        );
        assert_eq!((fine[0].get("amplitude"), fine[0].get("phase")), (1.0, 1.0));
    }

    #[test]
    fn what_is_unstable_or_has_no_answer_is_on_no_front() {
        let good = row(&Gait::wave(0.2, 1.0, 0.2, Envelope::Lateral));
        let mut unstable = row(&Gait::wave(0.9, 1.0, 0.2, Envelope::Lateral));
        unstable.numbers[COLUMNS.iter().position(|(n, _)| *n == "floquet").unwrap()] = 1.2;
        let none = Row { status: Status::Still, ..row(&Gait::wave(0.9, 1.0, 0.9, Envelope::Lateral)) };
        assert_eq!(front(&[good, unstable, none, good], [Objective::Speed, Objective::Cost]), [&good]);
    }
}
