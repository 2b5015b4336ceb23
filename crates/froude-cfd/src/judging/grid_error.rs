//! How far a result is from that of infinitely many cells: from the same case on grids of one family.
//!
//! **Order.** With `φ = φ₀ + α hᵖ` on the three finest grids, `(φ₃ − φ₂)/(φ₂ − φ₁) = (h₃ᵖ − h₂ᵖ)/(h₂ᵖ − h₁ᵖ)`; the right side grows with p, and the order is where both are equal. It is claimed only where all grids approach the limit from one side, by steps above their iterative error, and 0.5 < p < 3.
//! **Uncertainty**, of 95 % coverage. With an order, 1.25 times the distance to the limit, that of order 2 where p is larger, and the misfit of the grids that had no part in it. Without, 3 times the spread of all grids. Both with the iterative error of the finest, squares added.
//!
//! Source: the factor 1.25, and the care about orders above 2, are those of Eça and Hoekstra, J. Comput. Phys. 262 (2014) 104–130; the least squares over all grids there are the three finest and a misfit here. Where no order is claimed they fit other laws and multiply by 3; 3 times the spread of the grids is the rule of their earlier procedures, and needs no fit.

use serde::{Deserialize, Serialize};

use crate::family::refinement_ratio;

/// Orders that are claimed lie between these.
const ORDERS: [f64; 2] = [0.5, 3.0];
/// Highest order that a distance to the limit is taken with: the one of the schemes.
const SCHEME_ORDER: f64 = 2.0;
/// On the distance to the limit, where an order is claimed.
const SAFETY: f64 = 1.25;
/// On the spread of the grids, where none is.
const SPREAD_FACTOR: f64 = 3.0;
/// Standard deviations of 95 % coverage.
const COVERAGE: f64 = 2.0;

/// A result on a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnGrid {
    /// Cells of the grid.
    pub cells: usize,
    /// The result, in any unit.
    pub value: f64,
    /// Standard deviation of its iterative error, likewise.
    pub std_iterative: f64,
}

/// What a family says of its finest result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GridError {
    /// On the finest grid.
    pub value: f64,
    /// Half-width of the interval of 95 % about it.
    pub expanded: f64,
    /// p of the three finest; `None` where none is claimed.
    pub order: Option<f64>,
    /// φ₀ of that order.
    pub extrapolated: Option<f64>,
    /// p of every three grids in a row, the finest first, claimed or not; `None` where they do not approach a limit.
    pub orders: Vec<Option<f64>>,
    /// Half-width of the interval of 95 % about the result of each grid, by the grid alone, the finest first.
    pub of_grids: Vec<f64>,
    /// p that distances to the limit are taken with: the order, the scheme's where it is larger; `None` where no order is claimed.
    law_order: Option<f64>,
    /// Largest distance of a grid that had no part in the law from it.
    misfit: f64,
    /// Where the half-width comes from.
    pub reason: String,
}

impl GridError {
    /// Half-width of the interval of 95 % about the result of a grid that is no member of the family, by the grid alone; `size` is its h over that of the finest.
    ///
    /// With an order, 1.25 times its distance to the limit by the family's law; without, 3 times the spread of the family.
    #[must_use]
    pub fn at(&self, size: f64) -> f64 {
        let finest = self.of_grids.first().copied().unwrap_or(0.0);
        self.law_order.map_or(finest, |p| (finest - self.misfit) * size.powf(p) + self.misfit)
    }

    /// Half of the half-width.
    #[must_use]
    pub fn std(&self) -> f64 {
        self.expanded / COVERAGE
    }
}

/// What results on grids of one family, in any sequence, say of the finest; `directions` are refined, 3 in space and 2 in a plane.
///
/// # Errors
///
/// Fewer than two grids, a result that is not finite, two grids of the same cells.
pub fn grid_error(results: &[OnGrid], directions: u32) -> Result<GridError, String> {
    let mut grids = results.to_vec();
    grids.sort_by_key(|g| core::cmp::Reverse(g.cells));
    for &OnGrid { cells, value, std_iterative } in &grids {
        if !(value.is_finite() && std_iterative.is_finite() && cells > 0) {
            return Err(format!(
                "the result on the grid of {cells} cells is {value} ± {std_iterative}; both must be finite"
            ));
        }
    }
    if let Some(pair) = grids.windows(2).find(|pair| pair[0].cells == pair[1].cells) {
        return Err(format!("two grids have {} cells; a family has grids of different fineness", pair[0].cells));
    }
    let [finest, second, ..] = grids[..] else {
        let found = grids.len();
        return Err(format!("{found} grids have no error; run the case on two at least, on three for an order"));
    };
    // h over that of the finest.
    let sizes: Vec<f64> = grids.iter().map(|g| refinement_ratio(finest.cells, g.cells, directions)).collect();
    let values: Vec<f64> = grids.iter().map(|g| g.value).collect();
    let orders: Vec<Option<f64>> =
        sizes.windows(3).zip(values.windows(3)).map(|(h, v)| order([h[0], h[1], h[2]], [v[0], v[1], v[2]])).collect();
    let iterative = COVERAGE * finest.std_iterative;
    let found = GridError {
        value: finest.value,
        expanded: 0.0,
        order: None,
        extrapolated: None,
        orders,
        of_grids: Vec::new(),
        law_order: None,
        misfit: 0.0,
        reason: String::new(),
    };
    let order = match claim(&grids, &found.orders) {
        Ok(order) => order,
        Err(why) => {
            let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), &v| (l.min(v), h.max(v)));
            let mesh = SPREAD_FACTOR * (high - low);
            return Ok(GridError {
                expanded: mesh.hypot(iterative),
                of_grids: vec![mesh; grids.len()],
                reason: format!("{SPREAD_FACTOR} times the spread of {} grids: {why}", grids.len()),
                ..found
            });
        }
    };
    let distance = |p: f64| (finest.value - second.value) / (sizes[1].powf(p) - 1.0);
    let limit = finest.value + distance(order);
    // α of h = 1 is −distance.
    let misfit = sizes
        .iter()
        .zip(&values)
        .skip(3)
        .map(|(h, v)| (v - limit + distance(order) * h.powf(order)).abs())
        .fold(0.0, f64::max);
    let law_order = order.min(SCHEME_ORDER);
    let by_law = |size: f64| SAFETY * (distance(law_order) * size.powf(law_order)).abs() + misfit;
    Ok(GridError {
        expanded: by_law(1.0).hypot(iterative),
        of_grids: sizes.iter().map(|size| by_law(*size)).collect(),
        law_order: Some(law_order),
        misfit,
        order: Some(order),
        extrapolated: Some(limit),
        reason: format!(
            "{SAFETY} times the distance to the limit of order {order:.2} on the three finest of {} grids",
            grids.len()
        ),
        ..found
    })
}

/// Half-width of the interval of 95 % about the finer of two results by the grid alone, where no family says more: three times the distance to the limit of the schemes' order.
///
/// `refinement` is how much finer it is in each direction, above 1.
///
/// # Source
///
/// Roache, J. Fluids Eng. 116 (1994) 405–413: the grid convergence index of two grids, `3 |φ₂ − φ₁|/(rᵖ − 1)` with p of the scheme.
#[must_use]
pub fn two_grids(difference: f64, refinement: f64) -> f64 {
    SPREAD_FACTOR * difference.abs() / (refinement.powf(SCHEME_ORDER) - 1.0)
}

/// The order, or why none is claimed.
fn claim(grids: &[OnGrid], orders: &[Option<f64>]) -> Result<f64, String> {
    let Some(&finest) = orders.first() else { return Err("two have no order".to_owned()) };
    let steps = || grids.windows(2).map(|pair| pair[1].value - pair[0].value);
    if !(steps().all(|s| s > 0.0) || steps().all(|s| s < 0.0)) {
        return Err("they do not approach a limit from one side".to_owned());
    }
    for pair in grids.windows(2) {
        let noise = COVERAGE * pair[0].std_iterative.hypot(pair[1].std_iterative);
        if (pair[1].value - pair[0].value).abs() < noise {
            return Err(format!(
                "those of {} and {} cells differ by less than their iterative error",
                pair[1].cells, pair[0].cells
            ));
        }
    }
    let [low, high] = ORDERS;
    match finest {
        Some(p) if low < p && p < high => Ok(p),
        Some(p) => Err(format!("the three finest have order {p:.2}, and one between {low} and {high} is believed")),
        None => Err("the three finest move away from a limit".to_owned()),
    }
}

/// p from the finest three, finest first; `None` where they do not approach a limit from one side.
fn order(h: [f64; 3], v: [f64; 3]) -> Option<f64> {
    const RANGE: [f64; 2] = [0.01, 20.0];
    let found = (v[2] - v[1]) / (v[1] - v[0]);
    let [a, b] = [h[1] / h[0], h[2] / h[0]];
    let of = |p: f64| (b.powf(p) - a.powf(p)) / (a.powf(p) - 1.0);
    let [mut low, mut high] = RANGE;
    if !(of(low)..=of(high)).contains(&found) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if of(middle) < found {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELLS: [usize; 4] = [115_000, 41_000, 14_600, 5_100];

    fn of(law: impl Fn(f64) -> f64) -> Vec<OnGrid> {
        CELLS
            .map(|cells| OnGrid { cells, value: law(refinement_ratio(CELLS[0], cells, 3)), std_iterative: 0.0 })
            .to_vec()
    }

    #[test]
    fn an_exact_power_gives_its_order_and_limit_in_any_sequence() {
        for p in [0.7, 1.0, 1.5, 2.0, 2.6] {
            let mut grids = of(|h| 5.0 - 0.3 * h.powf(p));
            grids.swap(0, 2);
            let found = grid_error(&grids, 3).unwrap();
            assert!((found.order.unwrap() - p).abs() < 1e-9, "{found:?}");
            assert!((found.extrapolated.unwrap() - 5.0).abs() < 1e-9, "{found:?}");
            assert!(found.orders.iter().all(|o| (o.unwrap() - p).abs() < 1e-9));
            let distance = if p <= 2.0 {
                0.3
            } else {
                0.3 * (refinement_ratio(CELLS[0], CELLS[1], 3).powf(p) - 1.0)
                    / (refinement_ratio(CELLS[0], CELLS[1], 3).powi(2) - 1.0)
            };
            assert!((found.expanded - 1.25 * distance).abs() < 1e-9, "{p}: {found:?}");
            assert!(found.expanded > 0.3, "the limit lies within");
        }
    }

    /// Drag of a sphere at Re = 100 on 14.6k, 41k and 115k cells, as an independent program gave it: order 2.2, limit 1.0885.
    #[test]
    fn the_sphere_of_three_grids_has_its_order() {
        let grids: Vec<OnGrid> = CELLS
            .iter()
            .zip([1.0935, 1.0991, 1.1110])
            .map(|(&cells, value)| OnGrid { cells, value, std_iterative: 0.0 })
            .collect();
        let found = grid_error(&grids, 3).unwrap();
        assert!((found.order.unwrap() - 2.2).abs() < 0.05, "{found:?}");
        assert!((found.extrapolated.unwrap() - 1.0885).abs() < 2e-4, "{found:?}");
        assert!(found.reason.starts_with("1.25 times the distance to the limit of order 2.1"), "{}", found.reason);
    }

    #[test]
    fn no_order_is_claimed_where_there_is_none_and_the_reason_says_so() {
        let wavy = grid_error(&of(|h| 5.0 + (3.0 * h).sin()), 3).unwrap();
        assert_eq!(wavy.order, None);
        let values: Vec<f64> = of(|h| 5.0 + (3.0 * h).sin()).iter().map(|g| g.value).collect();
        let spread = values.iter().copied().fold(f64::MIN, f64::max) - values.iter().copied().fold(f64::MAX, f64::min);
        assert!((wavy.expanded - 3.0 * spread).abs() < 1e-12);
        assert_eq!(wavy.reason, "3 times the spread of 4 grids: they do not approach a limit from one side");
        let steep = grid_error(&of(|h| 5.0 + h.powf(4.0)), 3).unwrap();
        assert_eq!(
            steep.reason,
            "3 times the spread of 4 grids: the three finest have order 4.00, and one between 0.5 and 3 is believed"
        );
        let away = grid_error(&of(|h| 5.0 - h.ln()), 3).unwrap();
        assert!(away.order.is_none() && away.reason.starts_with("3 times the spread"), "{away:?}");
        let two = grid_error(&of(|h| h)[..2], 3).unwrap();
        assert_eq!(two.reason, "3 times the spread of 2 grids: two have no order");
        let mut noisy = of(|h| 5.0 + 0.1 * h);
        noisy[1].std_iterative = 0.1;
        let noisy = grid_error(&noisy, 3).unwrap();
        assert_eq!(
            noisy.reason,
            "3 times the spread of 4 grids: those of 41000 and 115000 cells differ by less than their iterative error"
        );
    }

    #[test]
    fn an_iterative_error_widens_and_a_misfit_too() {
        let mut grids = of(|h| 5.0 - 0.3 * h);
        grids[0].std_iterative = 0.01;
        let found = grid_error(&grids, 3).unwrap();
        assert!((found.expanded - (1.25_f64 * 0.3).hypot(0.02)).abs() < 1e-9);
        assert_eq!(found.std(), 0.5 * found.expanded);
        grids[0].std_iterative = 0.0;
        grids[3].value -= 0.05;
        let found = grid_error(&grids, 3).unwrap();
        assert!((found.expanded - (1.25 * 0.3 + 0.05)).abs() < 1e-9, "{found:?}");
    }

    /// φ = 5 + 0.3 hᵖ has the error 0.3 hᵖ on a grid of size h.
    #[test]
    fn each_grid_has_its_own_distance_to_the_limit_and_so_has_one_that_is_no_member() {
        let sizes = CELLS.map(|cells| refinement_ratio(CELLS[0], cells, 3));
        for p in [0.7, 1.0, 2.0] {
            let found = grid_error(&of(|h| 5.0 + 0.3 * h.powf(p)), 3).unwrap();
            for (h, expanded) in sizes.iter().zip(&found.of_grids) {
                assert!((expanded - 1.25 * 0.3 * h.powf(p)).abs() < 1e-8, "{p}: {found:?}");
            }
            assert!((found.at(1.2) - 1.25 * 0.3 * 1.2_f64.powf(p)).abs() < 1e-8);
        }
        let wavy = grid_error(&of(|h| 5.0 + (3.0 * h).sin()), 3).unwrap();
        assert_eq!(wavy.of_grids, [wavy.expanded; 4]);
        assert_eq!(wavy.at(1.7), wavy.expanded);
    }

    /// Two grids of a law of order 2, by a factor of 2: a third of the difference is left, and is covered three times.
    #[test]
    fn two_grids_cover_three_times_what_the_order_of_the_schemes_leaves() {
        let value = |h: f64| 5.0 + 0.3 * h * h;
        assert!((two_grids(value(2.0) - value(1.0), 2.0) - 3.0 * 0.3).abs() < 1e-12);
    }

    #[test]
    fn grids_that_say_nothing_are_refused() {
        let refused = |grids: &[OnGrid]| grid_error(grids, 3).unwrap_err();
        let grids = of(|h| h);
        assert_eq!(refused(&grids[..1]), "1 grids have no error; run the case on two at least, on three for an order");
        assert_eq!(refused(&[]), "0 grids have no error; run the case on two at least, on three for an order");
        assert_eq!(
            refused(&[grids[0], grids[0]]),
            "two grids have 115000 cells; a family has grids of different fineness"
        );
        let mut broken = grids.clone();
        broken[2].value = f64::NAN;
        assert_eq!(refused(&broken), "the result on the grid of 14600 cells is NaN ± 0; both must be finite");
    }
}
