//! Loads that the symmetry of body and motion leaves no mean of.
//!
//! A body that moves in a plane of its own symmetry has with each flow the mirrored one: both are solutions. Where a steady flow leans to one side of the plane, as behind short bodies across the flow, the loads that change sign with it are those of one of two states; which of them a computation comes to may depend on where it starts from. The mean of both is zero. It is that of an ensemble; how long a wake stays in one of them a steady flow does not say, so that half the distance between the two counts as an error of the load. Loads that do not change sign are those of the leaning state.
//!
//! With the plane's normal along the axis k, the force along k and the moments about the two other axes change sign: a force is a polar vector, a moment an axial one.

use std::path::Path;

use crate::section::CfdSpec;

use crate::collect::Collected;

/// Velocity over speed below which a body moves in the plane.
const IN_PLANE: f64 = 1e-9;

/// A load of a flow that leans to one side, before it was set to the mean of both.
#[derive(Debug, Clone, PartialEq)]
pub struct OneSided {
    /// The case.
    pub case: String,
    /// Place of the load.
    pub load: usize,
    /// What was computed, N or N m.
    pub value: f64,
    /// The same over ½ρU²A, and ½ρU²A L of a moment \[-\].
    pub part: f64,
}

/// Whether the body is symmetric about all three planes through its middle, as the shapes of body files are: a robot's ends are alike. Of a surface nobody knows it.
#[must_use]
pub fn is_symmetric(spec: &CfdSpec) -> bool {
    spec.body.as_deref().and_then(Path::extension).is_some_and(|extension| extension == "toml")
}

/// Sets the loads of a symmetric body that change sign in the mirror to their mean, and says which they were.
pub fn take_means(rows: &mut [Collected]) -> Vec<OneSided> {
    let mut out = Vec::new();
    for row in rows {
        let velocity_m_s = row.case.flow.velocity_m_s();
        // Half a domain has the third plane as its own.
        let axes = if row.case.is_half { 0..2 } else { 0..3 };
        for axis in axes.filter(|k| velocity_m_s[*k].abs() <= IN_PLANE * row.case.flow.speed_m_s) {
            for load in odd(axis) {
                if row.loads[load] != 0.0 {
                    let part = row.loads[load] / row.case.load_scales()[load];
                    out.push(OneSided { case: row.case.id.clone(), load, value: row.loads[load], part });
                    if let Some(std) = &mut row.outcome.std_iterative {
                        std[load] = std[load].max(row.loads[load].abs());
                    }
                    row.loads[load] = 0.0;
                }
            }
        }
    }
    out
}

/// Loads that change sign in a mirror whose normal is along an axis.
fn odd(axis: usize) -> impl Iterator<Item = usize> {
    (0..6).filter(move |load| if *load < 3 { *load == axis } else { *load - 3 != axis })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// m = r × f: turned about with the plane, the moments of a mirrored force are those that the rule has.
    #[test]
    fn the_loads_that_change_sign_are_those_of_a_mirrored_force_and_its_moment() {
        let (r, f) = ([0.3, -0.2, 0.5], [1.1, 0.7, -0.4]);
        let loads = |r: [f64; 3], f: [f64; 3]| {
            [f[0], f[1], f[2], r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2], r[0] * f[1] - r[1] * f[0]]
        };
        for axis in 0..3 {
            let mirrored = |mut v: [f64; 3]| {
                v[axis] = -v[axis];
                v
            };
            let (here, there) = (loads(r, f), loads(mirrored(r), mirrored(f)));
            for load in 0..6 {
                let sign = if odd(axis).any(|k| k == load) { -1.0 } else { 1.0 };
                assert!((there[load] - sign * here[load]).abs() < 1e-15, "axis {axis}, load {load}");
            }
        }
    }
}
