//! The 6 × 6 matrix of added mass.

use froude_mesh::vector::Vec3;

use crate::frame::Frame;

/// Added mass over ρ in a frame: surge, sway, heave, roll, pitch, yaw. m³, m⁴, m⁵.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AddedMass {
    /// Symmetric part.
    pub matrix: [[f64; 6]; 6],
    /// Largest |A_ij − A_ji| as part of √(A_ii A_jj): a flag of a mesh that is too coarse, no estimate of the error.
    pub asymmetry: f64,
    /// Axes of its motions, and the point that its moments are about.
    pub frame: Frame,
}

impl AddedMass {
    /// Of a raw matrix.
    #[must_use]
    pub fn of(raw: [[f64; 6]; 6], frame: Frame) -> Self {
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
        Self { matrix, asymmetry, frame }
    }

    /// The same body about another point, its axes kept.
    #[must_use]
    pub fn about(&self, origin_m: Vec3) -> Self {
        self.seen_from(&Frame { origin_m, ..self.frame })
    }

    /// The same body in other axes about another point: A' = Tᵀ A T, T the motions here from those there.
    ///
    /// The kinetic energy ½ νᵀAν of a motion does not depend on the frame that it is expressed in.
    #[must_use]
    pub fn seen_from(&self, frame: &Frame) -> Self {
        let t = self.frame.motions_from(frame);
        Self { matrix: congruent(&self.matrix, &t), frame: *frame, ..*self }
    }
}

/// Tᵀ A T.
#[must_use]
pub fn congruent(a: &[[f64; 6]; 6], t: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
    let mut out = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in 0..6 {
            for (k, row) in a.iter().enumerate() {
                for (l, a) in row.iter().enumerate() {
                    out[i][j] += t[k][i] * a * t[l][j];
                }
            }
        }
    }
    out
}
