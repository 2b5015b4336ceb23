//! The 6 × 6 matrix of added mass.

use froude_mesh::vector::Vec3;

/// Added mass over ρ about an origin: surge, sway, heave, roll, pitch, yaw. m³, m⁴, m⁵.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AddedMass {
    /// Symmetric part.
    pub matrix: [[f64; 6]; 6],
    /// Largest |A_ij − A_ji| as part of √(A_ii A_jj): a flag of a mesh that is too coarse, no estimate of the error.
    pub asymmetry: f64,
    /// What its moments are about, m.
    pub origin_m: Vec3,
}

impl AddedMass {
    /// Of a raw matrix.
    #[must_use]
    pub fn of(raw: [[f64; 6]; 6], origin_m: Vec3) -> Self {
        let mut matrix = raw;
        let mut asymmetry = 0.0_f64;
        for i in 0..6 {
            for j in 0..6 {
                matrix[i][j] = 0.5 * (raw[i][j] + raw[j][i]);
                let size = (raw[i][i] * raw[j][j]).abs().sqrt();
                if size > 0.0 {
                    asymmetry = asymmetry.max((raw[i][j] - raw[j][i]).abs() / size);
                }
            }
        }
        Self { matrix, asymmetry, origin_m }
    }

    /// The same body about another point: with v' = v + ω × d, d from the old origin to the new one, A' = Hᵀ A H.
    #[must_use]
    pub fn about(&self, origin_m: Vec3) -> Self {
        let d = [0, 1, 2].map(|i| origin_m[i] - self.origin_m[i]);
        // Velocity at the old origin from that at the new one: v = v' − ω × d = v' + d × ω.
        let mut h = [[0.0; 6]; 6];
        for (i, row) in h.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        let cross = [[0.0, -d[2], d[1]], [d[2], 0.0, -d[0]], [-d[1], d[0], 0.0]];
        for i in 0..3 {
            for j in 0..3 {
                h[i][3 + j] = cross[i][j];
            }
        }
        let mut matrix = [[0.0; 6]; 6];
        for i in 0..6 {
            for j in 0..6 {
                for (k, row) in self.matrix.iter().enumerate() {
                    for (l, a) in row.iter().enumerate() {
                        matrix[i][j] += h[k][i] * a * h[l][j];
                    }
                }
            }
        }
        Self { matrix, origin_m, ..*self }
    }
}
