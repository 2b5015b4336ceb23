//! The parameters of one swimming link: drag, added mass and fluid torque.
//!
//! **Setting.** One link of a multi-link model, elliptic section, strip theory.
//! **Frame.** Link axes at the link's centre; the torque is about it.
//! **Units.** SI. `c_T`, `c_N` multiply `v` (times `v_ref` = 1 m/s) and `v|v|` alike.
//!
//! | parameter | formula                   | source                                |
//! |-----------|---------------------------|---------------------------------------|
//! | `c_T`     | `½ρπC_f·½(a+b)·2l`        | USR eq. 8                             |
//! | `c_N`     | `½ρC_D·2a·2l`             | USR eq. 8                             |
//! | `μ`       | `ρπC_A a²·2l`             | USR eq. 8                             |
//! | `λ₁`      | `⅔ρπC_A a² l³`            | strip theory, our derivation (default) |
//! | `λ₁`      | `ρπC_M(a²−b²)²l³/12`      | USR eq. 8 as printed: kg m⁴, see below |
//! | `λ₂`      | `ρπC_f(a+b)l³/6`          | USR eq. 8 (friction strip)            |
//! | `λ₃`      | `ρπC_f(a+b)l⁴/8`          | USR eq. 8 (friction strip)            |
//! | `λ₂`      | `⅔ρC_D a l³`              | cross-flow strip, our derivation      |
//! | `λ₃`      | `½ρC_D a l⁴`              | cross-flow strip, our derivation      |
//!
//! The printed `λ₁` is a product kg/m³·m⁴·m³ = kg m⁴ and cannot multiply an angular
//! acceleration to a torque: its section term `(a²−b²)²` is the added moment of
//! inertia per length of an ellipse rolling about its axis. It is offered so that
//! published simulations can be repeated.

use core::f64::consts::PI;

use crate::geometry::Link;

/// Coefficients of one link \[-\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkCoefficients {
    /// Friction along the link, on half the wetted area.
    pub c_f: f64,
    /// Cross-flow drag, on the side area.
    pub c_d: f64,
    /// Added mass across, on `πa²·2l`.
    pub c_a: f64,
    /// Added inertia; used by [`YawInertia::AsPrinted`] only.
    pub c_m: f64,
}

/// Which `λ₁` is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum YawInertia {
    /// `⅔ρπC_A a²l³` \[kg m²\]: the sway added mass of the strips, turning.
    #[default]
    StripTheory,
    /// `ρπC_M(a²−b²)²l³/12`, as printed, taken as kg m².
    AsPrinted,
}

/// Which `λ₂` and `λ₃` are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum YawDrag {
    /// Strip integrals of the friction law, USR eq. 8.
    #[default]
    FrictionStrip,
    /// Strip integrals of the cross-flow law: larger by `C_D·4a / (πC_f(a+b))`.
    CrossFlow,
}

/// The six parameters of one link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkParameters {
    /// `c_T`, kg/m.
    pub c_t_kg_m: f64,
    /// `c_N`, kg/m.
    pub c_n_kg_m: f64,
    /// `μ`, kg.
    pub added_mass_kg: f64,
    /// `λ₁`, kg m² (as printed: the same number, kg m⁴).
    pub lambda_1_kg_m2: f64,
    /// `λ₂` per `v_ref`: kg m; torque is `λ₂ v_ref θ̇`.
    pub lambda_2_kg_m: f64,
    /// `λ₃`, kg m²; torque is `λ₃ θ̇|θ̇|`.
    pub lambda_3_kg_m2: f64,
}

impl LinkParameters {
    /// The parameters of a link in water.
    ///
    /// # Source
    ///
    /// USR eq. 8; the variants are described at the top of the module.
    ///
    /// # Example
    ///
    /// ```
    /// use froude_hydro::Link;
    /// use froude_hydro::link_parameters::{LinkCoefficients, LinkParameters, YawDrag, YawInertia};
    /// let link = Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 };
    /// // The estimates used for Mamba before identification (USR Remark 1 a).
    /// let estimated = LinkCoefficients { c_f: 0.3, c_d: 1.75, c_a: 1.5, c_m: 1.0 };
    /// let p = LinkParameters::of(
    ///     &link, 1025.0, &estimated, YawInertia::default(), YawDrag::default(),
    /// );
    /// assert!((p.c_n_kg_m - 18.985).abs() < 1e-3);
    /// // Strip theory: a slender rod's λ₁ is μ (2l)²/12.
    /// assert!((p.lambda_1_kg_m2 - p.added_mass_kg * 0.18 * 0.18 / 12.0).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn of(link: &Link, density_kg_m3: f64, c: &LinkCoefficients, inertia: YawInertia, drag: YawDrag) -> Self {
        let (a, b, l) = (link.major_semi_axis_m, link.minor_semi_axis_m, link.half_length_m);
        let rho = density_kg_m3;
        let l3 = l * l * l;
        let lambda_1_kg_m2 = match inertia {
            YawInertia::StripTheory => 2.0 / 3.0 * rho * PI * c.c_a * a * a * l3,
            YawInertia::AsPrinted => {
                let difference = a * a - b * b;
                rho * PI * c.c_m * difference * difference * l3 / 12.0
            }
        };
        let (lambda_2_kg_m, lambda_3_kg_m2) = match drag {
            YawDrag::FrictionStrip => {
                (rho * PI * c.c_f * (a + b) * l3 / 6.0, rho * PI * c.c_f * (a + b) * l3 * l / 8.0)
            }
            YawDrag::CrossFlow => (2.0 / 3.0 * rho * c.c_d * a * l3, 0.5 * rho * c.c_d * a * l3 * l),
        };
        Self {
            c_t_kg_m: 0.5 * rho * c.c_f * link.friction_area_m2(),
            c_n_kg_m: 0.5 * rho * c.c_d * link.side_area_m2(),
            added_mass_kg: rho * PI * c.c_a * a * a * 2.0 * l,
            lambda_1_kg_m2,
            lambda_2_kg_m,
            lambda_3_kg_m2,
        }
    }
}
