//! Motion, load and inertia of a body with six motions, and what a joint turns.
//!
//! **Frame.** Axes of a link at its centre: x forward along it, y to starboard, z down. A motion is (p, q, r, u, v, w), a load (K, M, N, X, Y, Z) about the same point.
//! **Units.** SI.
//!
//! # Source
//!
//! Featherstone (2008), *Rigid Body Dynamics Algorithms*, 2.2 to 2.13.

/// (p, q, r, u, v, w): rad/s and m/s; or its rate.
pub type Motion = [f64; 6];
/// (K, M, N, X, Y, Z): N m and N; or a momentum.
pub type Load = [f64; 6];

/// A symmetric 6 × 6 inertia, in the order of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inertia(pub [[f64; 6]; 6]);

impl Inertia {
    /// A rigid body of mass, inertia about its centre of mass, and that centre's place.
    #[must_use]
    pub fn rigid(mass_kg: f64, inertia_kg_m2: [[f64; 3]; 3], centre_m: [f64; 3]) -> Self {
        let [x, y, z] = centre_m;
        // c × of a vector.
        let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        let square = x * x + y * y + z * z;
        let mut all = [[0.0; 6]; 6];
        for i in 0..3 {
            for j in 0..3 {
                let own = f64::from(u8::from(i == j));
                all[i][j] = inertia_kg_m2[i][j] + mass_kg * (square * own - centre_m[i] * centre_m[j]);
                all[i][3 + j] = mass_kg * cross[i][j];
                all[3 + j][i] = mass_kg * cross[i][j];
                all[3 + i][3 + j] = mass_kg * own;
            }
        }
        Self(all)
    }

    /// Added mass in the order in which it is written: surge, sway, heave, roll, pitch, yaw.
    #[must_use]
    pub fn of_added_mass(a: &[[f64; 6]; 6]) -> Self {
        let at = |k: usize| (k + 3) % 6;
        Self(std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (a[at(i)][at(j)] + a[at(j)][at(i)]))))
    }

    /// Momentum of a motion.
    #[must_use]
    pub fn times(&self, m: Motion) -> Load {
        self.0.map(|row| dot(row, m))
    }

    /// Kinetic energy, J.
    #[must_use]
    pub fn energy(&self, m: Motion) -> f64 {
        0.5 * dot(self.times(m), m)
    }

    /// Sum of two.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| self.0[i][j] + other.0[i][j])))
    }

    /// What is left where a part f fᵀ/d of it is taken out.
    #[must_use]
    pub fn less(&self, f: Load, d: f64) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| self.0[i][j] - f[i] * f[j] / d)))
    }

    /// About the point from which the one that it was about lies at (d, 0, 0), m.
    #[must_use]
    pub fn about(&self, d: f64) -> Self {
        let mut a = self.0;
        // The old point moves by v + d r and w − d q: columns, then rows.
        for row in &mut a {
            row[2] += d * row[4];
            row[1] -= d * row[5];
        }
        let [_, pitch, yaw, _, sway, heave] = &mut a;
        for k in 0..6 {
            yaw[k] += d * sway[k];
            pitch[k] -= d * heave[k];
        }
        Self(a)
    }

    /// The motion that a load gives a free body at rest, I⁻¹ f; `None` where the inertia is not positive definite.
    #[must_use]
    pub fn solve(&self, f: Load) -> Option<Motion> {
        // Cholesky, the translations first: they are the better conditioned.
        let order = [3, 4, 5, 0, 1, 2];
        let mut l = [[0.0; 6]; 6];
        for i in 0..6 {
            for j in 0..=i {
                let left = self.0[order[i]][order[j]] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
                if i == j {
                    if left.is_nan() || left <= 0.0 {
                        return None;
                    }
                    l[i][i] = left.sqrt();
                } else {
                    l[i][j] = left / l[j][j];
                }
            }
        }
        let mut z = [0.0; 6];
        for i in 0..6 {
            z[i] = (f[order[i]] - (0..i).map(|k| l[i][k] * z[k]).sum::<f64>()) / l[i][i];
        }
        for i in (0..6).rev() {
            z[i] = (z[i] - (i + 1..6).map(|k| l[k][i] * z[k]).sum::<f64>()) / l[i][i];
        }
        Some([z[3], z[4], z[5], z[0], z[1], z[2]])
    }
}

/// Power of a load on a motion, W.
#[must_use]
pub fn dot(f: Load, m: Motion) -> f64 {
    (f[0] * m[0] + f[1] * m[1] + f[2] * m[2]) + (f[3] * m[3] + f[4] * m[4] + f[5] * m[5])
}

/// a × b.
#[must_use]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The turning and the moving part.
#[must_use]
pub fn parts(m: [f64; 6]) -> [[f64; 3]; 2] {
    [[m[0], m[1], m[2]], [m[3], m[4], m[5]]]
}

/// Two parts as one.
#[must_use]
pub fn joined([a, b]: [[f64; 3]; 2]) -> [f64; 6] {
    [a[0], a[1], a[2], b[0], b[1], b[2]]
}

/// What the turning of the axes adds to the rate of a momentum h: ω × of its force part, and ω × and v × of its moment.
#[must_use]
pub fn turned(m: Motion, h: Load) -> Load {
    let ([w, v], [turning, moving]) = (parts(m), parts(h));
    let (a, b) = (cross(w, turning), cross(v, moving));
    joined([[a[0] + b[0], a[1] + b[1], a[2] + b[2]], cross(w, moving)])
}

/// A motion at the point that lies at (d, 0, 0), m.
#[must_use]
pub fn carried(m: Motion, d: f64) -> Motion {
    [m[0], m[1], m[2], m[3], m[4] + d * m[2], m[5] - d * m[1]]
}

/// A load about the point from which the one that it was about lies at (d, 0, 0), m.
#[must_use]
pub fn about(f: Load, d: f64) -> Load {
    [f[0], f[1] - d * f[5], f[2] + d * f[4], f[3], f[4], f[5]]
}

/// About which axis of its link a joint turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Axis {
    /// z: the links behind turn to port or starboard.
    #[default]
    Yaw,
    /// y: they turn up or down.
    Pitch,
}

impl Axis {
    /// Its number among x, y, z.
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Self::Yaw => 2,
            Self::Pitch => 1,
        }
    }

    /// The two that it turns, the first towards the second.
    fn turns(self) -> [usize; 2] {
        match self {
            Self::Yaw => [0, 1],
            Self::Pitch => [2, 0],
        }
    }
}

/// A joint at an angle φ: the link behind it is turned by −φ about the axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turn {
    axis: Axis,
    cos: f64,
    sin: f64,
}

impl Turn {
    /// φ in rad.
    #[must_use]
    pub fn new(axis: Axis, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { axis, cos, sin }
    }

    /// A vector of the link before in the axes of the link behind.
    #[must_use]
    pub fn behind(&self, mut x: [f64; 3]) -> [f64; 3] {
        let [a, b] = self.axis.turns();
        (x[a], x[b]) = (self.cos * x[a] - self.sin * x[b], self.sin * x[a] + self.cos * x[b]);
        x
    }

    /// A vector of the link behind in the axes of the link before.
    #[must_use]
    pub fn before(&self, x: [f64; 3]) -> [f64; 3] {
        Self { sin: -self.sin, ..*self }.behind(x)
    }

    /// A motion of the link before at the joint, in the axes of the link behind.
    #[must_use]
    pub fn motion_behind(&self, m: Motion) -> Motion {
        joined(parts(m).map(|x| self.behind(x)))
    }

    /// A load of the link behind about the joint, in the axes of the link before.
    #[must_use]
    pub fn load_before(&self, f: Load) -> Load {
        joined(parts(f).map(|x| self.before(x)))
    }

    /// An inertia of the link behind about the joint, in the axes of the link before.
    #[must_use]
    pub fn inertia_before(&self, i: &Inertia) -> Inertia {
        let mut all = i.0.map(|row| self.load_before(row));
        for k in 0..6 {
            let column = self.load_before(std::array::from_fn(|row| all[row][k]));
            for (row, x) in column.into_iter().enumerate() {
                all[row][k] = x;
            }
        }
        Inertia(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body() -> Inertia {
        let rigid =
            Inertia::rigid(1.3, [[2e-3, 1e-4, 0.0], [1e-4, 4e-3, 2e-4], [0.0, 2e-4, 5e-3]], [0.01, -0.02, 0.03]);
        let mut added = [[0.0; 6]; 6];
        for (k, a) in [0.1, 1.6, 0.9, 1e-4, 3e-3, 5e-3].into_iter().enumerate() {
            added[k][k] = a;
        }
        (added[1][5], added[5][1], added[2][4], added[4][2]) = (0.02, 0.02, -0.01, -0.01);
        rigid.plus(&Inertia::of_added_mass(&added))
    }

    /// Kinetic energy and power do not depend on the point and the axes by which they are told; a few operations round.
    #[test]
    fn a_joint_changes_neither_energy_nor_power() {
        let (m, f) = ([0.3, -0.7, 1.1, 0.4, -0.2, 0.9], [0.2, 0.5, -0.4, 1.0, 2.0, -3.0]);
        let inertia = body();
        for axis in [Axis::Yaw, Axis::Pitch] {
            let turn = Turn::new(axis, 0.8);
            let before = inertia.about(-0.09);
            let before = turn.inertia_before(&before).about(-0.07);
            let behind = carried(turn.motion_behind(carried(m, -0.07)), -0.09);
            assert!((before.energy(m) - inertia.energy(behind)).abs() < 1e-15);
            let carried_load = about(turn.load_before(about(f, -0.09)), -0.07);
            assert!((dot(carried_load, m) - dot(f, behind)).abs() < 1e-14);
        }
    }

    /// A point that is fixed to the mass: its momentum is m (v + ω × c).
    #[test]
    fn a_rigid_body_has_the_momentum_of_its_mass() {
        let inertia = Inertia::rigid(2.0, [[0.0; 3]; 3], [0.1, 0.2, -0.3]);
        let (w, v) = ([0.3, -0.5, 0.7], [1.0, 2.0, 3.0]);
        let at = cross(w, [0.1, 0.2, -0.3]);
        let p: [f64; 3] = std::array::from_fn(|k| 2.0 * (v[k] + at[k]));
        let expected = joined([cross([0.1, 0.2, -0.3], p), p]);
        for (a, b) in inertia.times(joined([w, v])).into_iter().zip(expected) {
            assert!((a - b).abs() < 1e-15, "{a} {b}");
        }
    }

    #[test]
    fn a_load_on_an_inertia_gives_back_its_motion() {
        let m = [0.3, -0.7, 1.1, 0.4, -0.2, 0.9];
        for (a, b) in body().solve(body().times(m)).unwrap().into_iter().zip(m) {
            // Times the condition of the inertia, some 1e4.
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        assert_eq!(Inertia::default().solve([1.0; 6]), None);
    }
}
