//! Added mass of the tri-axial ellipsoid.
//!
//! α_i = abc ∫₀^∞ dλ/((a_i² + λ)Δ) = ⅔ abc R_D(a_j², a_k², a_i²), A_ii = V α_i/(2 − α_i); turning about x,
//! A_44 = V/5 (b² − c²)² (γ − β)/(2(b² − c²) + (b² + c²)(β − γ)). Sources: Lamb 1932, §§ 114, 115; R_D by Carlson 1995.

use core::f64::consts::PI;

/// The six diagonal entries.
pub fn ellipsoid(axes: [f64; 3]) -> [f64; 6] {
    let [a, b, c] = axes;
    let volume = 4.0 / 3.0 * PI * a * b * c;
    let square = axes.map(|x| x * x);
    let alpha: [f64; 3] = core::array::from_fn(|i| {
        2.0 / 3.0 * a * b * c * carlson_rd(square[(i + 1) % 3], square[(i + 2) % 3], square[i])
    });
    core::array::from_fn(|mode| {
        if mode < 3 {
            return volume * alpha[mode] / (2.0 - alpha[mode]);
        }
        let (j, k) = ((mode + 1) % 3, (mode + 2) % 3);
        let (less, more) = (square[j] - square[k], square[j] + square[k]);
        if less == 0.0 {
            return 0.0;
        }
        volume / 5.0 * less * less * (alpha[k] - alpha[j]) / (2.0 * less + more * (alpha[j] - alpha[k]))
    })
}

/// R_D(x, y, z) = 3/2 ∫₀^∞ dt/(√((t + x)(t + y)) (t + z)^{3/2}), by duplication to rounding.
fn carlson_rd(mut x: f64, mut y: f64, mut z: f64) -> f64 {
    let (mut sum, mut power) = (0.0, 1.0);
    loop {
        let mean = (x + y + 3.0 * z) / 5.0;
        let [dx, dy, dz] = [x, y, z].map(|v| 1.0 - v / mean);
        if dx.abs().max(dy.abs()).max(dz.abs()) < 1e-3 {
            let (ea, eb) = (dx * dy, dz * dz);
            let (ec, ed) = (ea - eb, ea - 6.0 * eb);
            let ee = ed + 2.0 * ec;
            let series = 1.0
                + ed * (-3.0 / 14.0 + 9.0 / 88.0 * ed - 9.0 / 52.0 * dz * ee)
                + dz * (ee / 6.0 + dz * (-9.0 / 22.0 * ec + dz * 3.0 / 26.0 * ea));
            return 3.0 * sum + power * series / (mean * mean.sqrt());
        }
        let [rx, ry, rz] = [x, y, z].map(f64::sqrt);
        let step = rx * ry + ry * rz + rz * rx;
        sum += power / (rz * (z + step));
        power *= 0.25;
        [x, y, z] = [x, y, z].map(|v| 0.25 * (v + step));
    }
}
