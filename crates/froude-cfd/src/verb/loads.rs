//! Names and units of the loads of a case, and those that its domain determines.

/// Loads in the order of [`Loads`].
pub(crate) const LOADS: [&str; 6] = ["f_x", "f_y", "f_z", "m_x", "m_y", "m_z"];
/// Those that half a domain determines; the others are zero by its symmetry.
const OF_HALF: [usize; 3] = [0, 1, 5];

/// Loads that a domain determines, by their places.
pub(super) fn loads_of(is_half: bool) -> Vec<usize> {
    if is_half { OF_HALF.to_vec() } else { (0..LOADS.len()).collect() }
}

/// Of a load.
pub(crate) fn unit(load: usize) -> &'static str {
    if load < 3 { "N" } else { "N m" }
}
