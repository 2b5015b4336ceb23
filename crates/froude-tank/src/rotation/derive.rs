//! What the λs of a link mean: coefficients by the strip integrals, and the law behind λ₃.
//!
//! | derived                | formula                      | law                                                                    |
//! |------------------------|------------------------------|------------------------------------------------------------------------|
//! | C_A                    | 3 λ₁ / (2ρπ a² l³)           | added mass of the strips, turning (our derivation)                     |
//! | C_M \[1/m²\]           | 12 λ₁ / (ρπ (a²−b²)² l³)     | USR eq. 8 as printed, which gives kg m⁴                                |
//! | C_f from λ₂            | 6 λ₂ / (ρπ (a+b) l³ v_ref)   | friction along the strips, USR eq. 8                                   |
//! | C_f from λ₃            | 8 λ₃ / (ρπ (a+b) l⁴)         | the same                                                               |
//! | C_D from λ₃            | 2 λ₃ / (ρ a l⁴)              | drag across the strips (our derivation)                                |
//!
//! with v_ref = 1 m/s, which the published linear coefficients carry. C_M is the number that makes the printed formula give the λ₁ that was measured; as the
//! formula lacks a length squared, C_M has the unit 1/m² and is no coefficient of added mass.
//!
//! **The law behind λ₃.** Were it friction, as in USR eq. 8, one C_f would explain λ₂ and λ₃: E_n = d/U(d), d their difference and U(d) its 95 % half-width,
//! covariance of λ₂ and λ₃ included. |E_n| ≤ 1 says that it may be; beyond that with C_f from λ₃ the larger, λ₃ is drag across the body.
//!
//! **Units.** SI. **Range.** One elliptic link turning about its own centre; strips know no ends: added mass by them is too large, by tens of per cent for a
//! body as short as its strips are tall.
//!
//! # Source
//!
//! USR eq. 8; ISO 13528:2022, 9.7 (E_n).

use std::f64::consts::PI;

use froude_fit::budget::Uncertain;
use froude_hydro::Link;

use crate::driven::derived::{Derived, Sum, named};

/// Names of the coefficients of the body.
pub const LAMBDAS: [&str; 3] = ["lambda_1", "lambda_2", "lambda_3"];
/// v_ref, m/s.
pub(super) const V_REF_M_S: f64 = 1.0;

/// Names of what is derived.
pub const C_A: &str = "C_A";
/// C_M of the printed formula, 1/m².
pub const C_M: &str = "C_M_as_printed";
/// C_f from λ₂.
pub const C_F_2: &str = "C_f_from_lambda_2";
/// C_f from λ₃.
pub const C_F_3: &str = "C_f_from_lambda_3";
/// The first less the second.
pub const C_F_DIFFERENCE: &str = "C_f_difference";
/// C_D from λ₃.
pub const C_D_3: &str = "C_D_from_lambda_3";

/// Everything that follows from the λs of a link; a round section has no C_M, as its printed inertia is zero.
#[must_use]
pub fn sums(link: &Link, density: Uncertain) -> Vec<Sum> {
    let (a, b, l, rho) = (link.major_semi_axis_m, link.minor_semi_axis_m, link.half_length_m, density.value);
    let (l3, l4) = (l.powi(3), l.powi(4));
    let added = 3.0 / (2.0 * rho * PI * a * a * l3);
    let printed = 12.0 / (rho * PI * (a * a - b * b).powi(2) * l3);
    let [friction_2, friction_3] = [6.0 / (rho * PI * (a + b) * l3 * V_REF_M_S), 8.0 / (rho * PI * (a + b) * l4)];
    let across = 2.0 / (rho * a * l4);
    let [l1, l2, l3] = LAMBDAS;
    let all = [
        (C_A, "3*lambda_1/(2*density*pi*a^2*l^3)", "1", vec![(l1, added)]),
        (C_M, "12*lambda_1/(density*pi*(a^2-b^2)^2*l^3)", "1/m^2", vec![(l1, printed)]),
        (C_F_2, "6*lambda_2/(density*pi*(a+b)*l^3*v_ref)", "1", vec![(l2, friction_2)]),
        (C_F_3, "8*lambda_3/(density*pi*(a+b)*l^4)", "1", vec![(l3, friction_3)]),
        (C_F_DIFFERENCE, "C_f_from_lambda_2-C_f_from_lambda_3", "1", vec![(l2, friction_2), (l3, -friction_3)]),
        (C_D_3, "2*lambda_3/(density*a*l^4)", "1", vec![(l3, across)]),
    ];
    let is_finite = |factors: &[(&str, f64)]| factors.iter().all(|(_, factor)| factor.is_finite());
    let all = all.into_iter().filter(|(.., factors)| is_finite(factors));
    // ρ stands below the line of all of them.
    let over = Some(("density", density));
    all.map(|(name, formula, unit, factors)| Sum { name, formula, unit, factors, over }).collect()
}

/// What λ₃ is of.
#[derive(Debug, Clone, PartialEq)]
pub struct LawBehind {
    /// C_f from λ₂, and its 95 % half-width.
    pub from_lambda_2: [f64; 2],
    /// C_f from λ₃.
    pub from_lambda_3: [f64; 2],
    /// C_D from λ₃.
    pub c_d: [f64; 2],
    /// E_n of the first two.
    pub e_n: f64,
    /// The verdict.
    pub law: Behind,
}

/// A law that λ₃ may come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Behind {
    /// λ₃ is not told from zero.
    Nothing,
    /// One C_f explains λ₂ and λ₃.
    FrictionOrCrossFlow,
    /// λ₃ is larger than friction makes it.
    CrossFlow,
    /// λ₂ is larger than friction makes it.
    MoreThanFriction,
}

/// The law behind λ₃; `None` where λ₂ or λ₃ has no uncertainty, or nothing is declared of the link.
#[must_use]
pub fn law_behind(derived: &[Derived]) -> Option<LawBehind> {
    let of = |name: &str| named(derived, name).map(|d| [d.value, d.combined.arms[1]]);
    let (from_lambda_2, from_lambda_3, c_d) = (of(C_F_2)?, of(C_F_3)?, of(C_D_3)?);
    let [difference, half_width] = of(C_F_DIFFERENCE)?;
    let is_open = [from_lambda_2, from_lambda_3].iter().all(|[_, half]| *half > 0.0) && half_width > 0.0;
    let e_n = difference / half_width;
    let law = if from_lambda_3[0].abs() <= from_lambda_3[1] {
        Behind::Nothing
    } else if e_n.abs() <= 1.0 {
        Behind::FrictionOrCrossFlow
    } else if e_n < 0.0 {
        Behind::CrossFlow
    } else {
        Behind::MoreThanFriction
    };
    is_open.then_some(LawBehind { from_lambda_2, from_lambda_3, c_d, e_n, law })
}

impl LawBehind {
    /// In a sentence.
    #[must_use]
    pub fn words(&self) -> String {
        use froude_records::number::significant;
        let with = |[value, half]: [f64; 2]| format!("{} ± {}", significant(value, 3), significant(half, 2));
        let both = format!(
            "C_f is {} by lambda_2 and {} by lambda_3 (E_n = {:.2}, their covariance counted)",
            with(self.from_lambda_2),
            with(self.from_lambda_3),
            self.e_n
        );
        let across = with(self.c_d);
        match self.law {
            Behind::Nothing => format!(
                "lambda_3 is not told from zero, so that no law can be named behind it: {both}; larger amplitudes or faster motion show it"
            ),
            Behind::FrictionOrCrossFlow => format!(
                "one friction coefficient may explain lambda_2 and lambda_3: {both}; drag across the body would need C_D = {across}. The interval is what decides: narrow it before friction is believed"
            ),
            Behind::CrossFlow => format!(
                "one friction coefficient cannot explain lambda_2 and lambda_3: {both}. As drag across the body lambda_3 has C_D = {across}; where that is of the size of a blunt body's, and C_f larger than a skin friction, use \
                 lambda_3 = density*C_D*a*l^4/2, not the friction integral"
            ),
            Behind::MoreThanFriction => format!(
                "one friction coefficient cannot explain lambda_2 and lambda_3: {both}. Something else is linear in the rate: a bearing or seal above the body (subtract a tare), or the drag of slow motion"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use froude_hydro::Link;
    use froude_hydro::link_parameters::{LinkCoefficients, LinkParameters, YawDrag, YawInertia};

    use super::*;
    use crate::driven::derived::derived;
    use crate::joint::part;
    use crate::joint::{JointFit, Unknown};
    use froude_fit::budget::{Kind, OUTSIDE_95, combine};

    const MAMBA: Link = Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 };
    /// Of the f2 model in the circulation tank: C_f^II and C_d^II (USR, Table 9).
    const TANK: LinkCoefficients = LinkCoefficients { c_f: 0.0544, c_d: 1.8601, c_a: 1.277, c_m: 1.0 };

    fn parameters(inertia: YawInertia, drag: YawDrag) -> [f64; 3] {
        let p = LinkParameters::of(&MAMBA, 1025.0, &TANK, inertia, drag);
        [p.lambda_1_kg_m2, p.lambda_2_kg_m, p.lambda_3_kg_m2]
    }

    /// A fit with these λs, 1 % standard uncertainty each, λ₂ and λ₃ correlated by `correlation`.
    fn made(lambdas: [f64; 3], correlation: f64) -> JointFit {
        let covariance = froude_fit::faer::Mat::from_fn(3, 3, |i, j| {
            let of = |k: usize| 0.01 * lambdas[k];
            let r = if i == j {
                1.0
            } else if i + j == 3 {
                correlation
            } else {
                0.0
            };
            r * of(i) * of(j)
        });
        let parts = vec![part("scatter", Kind::A, covariance, f64::INFINITY)];
        let unknown = |j: usize| Unknown {
            name: LAMBDAS[j].to_owned(),
            unit: String::new(),
            value: Some(lambdas[j]),
            status: froude_fit::Status::Free,
            combined: Some(combine(&parts, j, OUTSIDE_95)),
        };
        JointFit {
            law: String::new(),
            unknowns: (0..3).map(unknown).collect(),
            errors: Vec::new(),
            fitted: Vec::new(),
            by: "run",
            has_runs: true,
            clusters: 9,
            is_scaled: true,
            samples: 0,
            effective: 0.0,
            sigma: vec![0.0],
            delay_s: 0.0,
            parts,
        }
    }

    fn of(fit: &JointFit) -> Vec<Derived> {
        derived(fit, &sums(&MAMBA, Uncertain::new(1025.0, 0.0)))
    }

    fn value(all: &[Derived], name: &str) -> f64 {
        all.iter().find(|d| d.name == name).unwrap().value
    }

    /// The coefficients that made the λs come back, whichever law made them.
    #[test]
    fn the_derived_are_the_inverse_of_the_strip_integrals() {
        let strip = parameters(YawInertia::StripTheory, YawDrag::FrictionStrip);
        let all = of(&made(strip, 0.0));
        for (name, expected) in [(C_A, 1.277), (C_F_2, 0.0544), (C_F_3, 0.0544), (C_F_DIFFERENCE, 0.0)] {
            assert!((value(&all, name) - expected).abs() < 1e-12, "{name}: {}", value(&all, name));
        }
        let printed = parameters(YawInertia::AsPrinted, YawDrag::CrossFlow);
        let all = of(&made(printed, 0.0));
        for (name, expected) in [(C_M, 1.0), (C_D_3, 1.8601)] {
            assert!((value(&all, name) - expected).abs() < 1e-12, "{name}: {}", value(&all, name));
        }
        assert_eq!(all.iter().find(|d| d.name == C_M).unwrap().unit, "1/m^2");
    }

    /// Computed beforehand: 1.41e-4 by friction, 3.68e-3 by cross-flow, 26 times apart (half a unit of the last digit).
    #[test]
    fn the_laws_of_the_mamba_link_are_26_times_apart() {
        let friction = parameters(YawInertia::StripTheory, YawDrag::FrictionStrip)[2];
        let across = parameters(YawInertia::StripTheory, YawDrag::CrossFlow)[2];
        assert!((friction - 1.41e-4).abs() < 0.5e-6, "{friction}");
        assert!((across - 3.68e-3).abs() < 0.5e-5, "{across}");
        assert!((across / friction - 26.0).abs() < 0.5, "{}", across / friction);
        // λ₂ by friction with λ₃ across the body is what friction cannot explain.
        let lambdas = parameters(YawInertia::StripTheory, YawDrag::FrictionStrip);
        let mixed = law_behind(&of(&made([lambdas[0], lambdas[1], across], -0.9))).unwrap();
        assert_eq!(mixed.law, Behind::CrossFlow);
        assert!(
            mixed.words().contains("one friction coefficient cannot explain lambda_2 and lambda_3"),
            "{}",
            mixed.words()
        );
        let same = law_behind(&of(&made(lambdas, -0.9))).unwrap();
        assert_eq!(same.law, Behind::FrictionOrCrossFlow);
        let seal = law_behind(&of(&made([lambdas[0], 3.0 * lambdas[1], lambdas[2]], -0.9))).unwrap();
        assert_eq!(seal.law, Behind::MoreThanFriction);
    }

    /// U² = 1.96² (u₂² + u₃² − 2 r u₂ u₃): a negative correlation widens the difference.
    #[test]
    fn the_test_counts_the_covariance_of_both() {
        let lambdas = parameters(YawInertia::StripTheory, YawDrag::FrictionStrip);
        for r in [-0.9, 0.0, 0.9] {
            let all = of(&made(lambdas, r));
            let half = all.iter().find(|d| d.name == C_F_DIFFERENCE).unwrap().combined.arms[1];
            let expected = 1.959_964 * 0.01 * 0.0544 * (2.0 - 2.0 * r).sqrt();
            assert!((half / expected - 1.0).abs() < 1e-5, "{r}: {half} {expected}");
        }
    }
}
