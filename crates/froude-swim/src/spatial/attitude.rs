//! How a body lies: a unit quaternion (w, x, y, z) that takes vectors of the body to the tank.
//!
//! A step of an integration leaves the unit sphere by its own error, and only then: what is turned is turned by q/|q|, and a step ends on the sphere again, which keeps its order.
//!
//! Roll, pitch and heading turn about x, then y, then z: the heading last, as they are told in ship theory. At a pitch of ±90° heading and roll are one.
//!
//! # Source
//!
//! Fossen (2021), *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2.2; Hairer, Lubich & Wanner (2006), *Geometric Numerical Integration*, IV.4 (projection).

/// A quaternion.
pub type Quaternion = [f64; 4];

/// Level, heading along x.
pub const LEVEL: Quaternion = [1.0, 0.0, 0.0, 0.0];

/// On the unit sphere.
#[must_use]
pub fn unit(q: Quaternion) -> Quaternion {
    let size = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    q.map(|x| x / size)
}

/// Rows: x, y, z of the tank by vectors of the body.
#[must_use]
pub fn world_from_body(q: Quaternion) -> [[f64; 3]; 3] {
    let [w, x, y, z] = unit(q);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// A vector of the body in the tank.
#[must_use]
pub fn to_world(r: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    r.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// q̇ of a turning in the body's axes, rad/s.
#[must_use]
pub fn rate([w, x, y, z]: Quaternion, [p, q, r]: [f64; 3]) -> Quaternion {
    [-x * p - y * q - z * r, w * p + y * r - z * q, w * q + z * p - x * r, w * r + x * q - y * p].map(|d| 0.5 * d)
}

/// Of roll, pitch and heading, rad.
#[must_use]
pub fn of_angles([roll, pitch, heading]: [f64; 3]) -> Quaternion {
    let ((sr, cr), (sp, cp), (sh, ch)) = ((0.5 * roll).sin_cos(), (0.5 * pitch).sin_cos(), (0.5 * heading).sin_cos());
    [cr * cp * ch + sr * sp * sh, sr * cp * ch - cr * sp * sh, cr * sp * ch + sr * cp * sh, cr * cp * sh - sr * sp * ch]
}

/// Roll, pitch and heading, rad.
#[must_use]
pub fn angles(q: Quaternion) -> [f64; 3] {
    let r = world_from_body(q);
    let level = r[0][0].hypot(r[1][0]);
    [r[2][1].atan2(r[2][2]), (-r[2][0]).atan2(level), r[1][0].atan2(r[0][0])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_come_back_and_turn_as_they_are_told() {
        let given = [0.3, -0.8, 2.5];
        for (a, b) in angles(of_angles(given)).into_iter().zip(given) {
            assert!((a - b).abs() < 1e-15, "{a} {b}");
        }
        // Nose up: x of the body points against z, which is down.
        let up = to_world(&world_from_body(of_angles([0.0, 0.5, 0.0])), [1.0, 0.0, 0.0]);
        assert!((up[2] + 0.5_f64.sin()).abs() < 1e-15, "{up:?}");
        // Starboard down.
        let down = to_world(&world_from_body(of_angles([0.5, 0.0, 0.0])), [0.0, 1.0, 0.0]);
        assert!((down[2] - 0.5_f64.sin()).abs() < 1e-15, "{down:?}");
    }

    /// A step of Euler's against the exact turn: an error of the square of the angle, 1e-12.
    #[test]
    fn a_rate_is_that_of_the_body_s_own_axes() {
        let (q, w, h) = (of_angles([0.4, 0.2, -1.0]), [0.7, -0.3, 0.5], 1e-6);
        let d = rate(q, w);
        let after = world_from_body(std::array::from_fn(|k| q[k] + h * d[k]));
        let before = world_from_body(q);
        // Ṙ = R [ω ×].
        for (after, before) in after.iter().zip(&before) {
            let turned = [
                before[1] * w[2] - before[2] * w[1],
                before[2] * w[0] - before[0] * w[2],
                before[0] * w[1] - before[1] * w[0],
            ];
            for k in 0..3 {
                assert!((after[k] - before[k] - h * turned[k]).abs() < 2e-12);
            }
        }
    }
}
