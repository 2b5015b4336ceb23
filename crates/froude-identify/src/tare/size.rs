//! How large a load is.

/// Largest force that stays in a measured load, N, and its share of the load over all rows, Σ|f stays|/Σf², %: by no more than that a
/// coefficient of that load is off. `None` where it does not matter.
pub(crate) fn size(rows: &[usize], stays_n: &dyn Fn(usize) -> f64, load_n: &[f64]) -> Option<(f64, f64)> {
    let all: f64 = load_n.iter().map(|f| f * f).sum();
    let (mut along, mut most_n) = (0.0, 0.0_f64);
    for &i in rows {
        along += (stays_n(i) * load_n[i]).abs();
        most_n = most_n.max(stays_n(i).abs());
    }
    let share = if all > 0.0 { along / all } else { 0.0 };
    (share > MATTERS_ABOVE).then_some((most_n, 100.0 * share))
}

/// A part of the load that is worth a warning.
pub(crate) const MATTERS_ABOVE: f64 = 0.005;
