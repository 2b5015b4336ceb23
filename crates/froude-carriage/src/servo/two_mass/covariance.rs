//! Covariance of the parameters of the iteration, and how coefficients follow from them.

use froude_fit::distribution::coverage_factor;
use froude_fit::faer::Mat;
use froude_fit::propagate::effective_dof;

use crate::servo::cluster::Clustered;
use crate::servo::interval::CONFIDENCE;

/// Parameters of the iteration: logarithms of four, sums of two, fractions of two.
pub(crate) const PARAMETERS: usize = 8;

pub(crate) struct Covariance {
    pub(super) classical: Mat<f64>,
    pub(super) hac: Mat<f64>,
    pub(super) clustered: Clustered,
    /// Of the prior and of declared gear, drag and delay.
    pub(super) declared: Mat<f64>,
    /// With the force per volt: known, not estimated.
    pub(super) known: Mat<f64>,
    pub(super) radius_relative: f64,
}

impl Covariance {
    /// Of what goes along `gradient` with the parameters and by `radius` with the sprocket's relative radius.
    pub(crate) fn variance(&self, gradient: &[f64; PARAMETERS], radius: f64) -> f64 {
        quadratic(gradient, &self.clustered.covariance) + self.known(gradient, radius)
    }

    fn known(&self, gradient: &[f64; PARAMETERS], radius: f64) -> f64 {
        quadratic(gradient, &self.known) + (radius * self.radius_relative).powi(2)
    }

    /// Of the interval, with the degrees of freedom by Welch and Satterthwaite.
    pub(crate) fn half_width(&self, gradient: &[f64; PARAMETERS], radius: f64) -> f64 {
        let scatter = quadratic(gradient, &self.clustered.covariance);
        let known = self.known(gradient, radius);
        let dof = effective_dof(&[(scatter, self.clustered.dof(gradient)), (known, f64::INFINITY)]);
        coverage_factor(CONFIDENCE, dof) * (scatter + known).sqrt()
    }
}

/// The power with which the sprocket's radius goes into a coefficient of the chain: it makes forces of torques, and motions of counts. What
/// is brought to the motor's shaft leaves it again, and frequencies do not have it.
#[must_use]
pub fn radius_power(name: &str) -> f64 {
    match name {
        "m" | "M" | "K_e" | "B_e" | "B_sum" => -2.0,
        "C_sum" => -1.0,
        _ => 0.0,
    }
}

pub(crate) fn unit_vector(j: usize, value: f64) -> [f64; PARAMETERS] {
    let mut out = [0.0; PARAMETERS];
    out[j] = value;
    out
}

/// `gᵀ C g`.
pub(crate) fn quadratic(g: &[f64; PARAMETERS], c: &Mat<f64>) -> f64 {
    (0..PARAMETERS).map(|i| (0..PARAMETERS).map(|j| g[i] * c[(i, j)] * g[j]).sum::<f64>()).sum::<f64>().max(0.0)
}

/// `C x`.
pub(crate) fn times(c: &Mat<f64>, x: &[f64]) -> Vec<f64> {
    (0..PARAMETERS).map(|i| (0..PARAMETERS).map(|j| c[(i, j)] * x[j]).sum()).collect()
}

/// Adds `(s x)(s x)ᵀ`.
pub(crate) fn add_outer(out: &mut Mat<f64>, x: &[f64], s: f64) {
    for i in 0..PARAMETERS {
        for j in 0..PARAMETERS {
            out[(i, j)] += s * x[i] * s * x[j];
        }
    }
}
