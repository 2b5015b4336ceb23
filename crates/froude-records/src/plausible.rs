//! Values that no tank has: an angle of several turns, water as thin as air.
//!
//! A right unit beside a wrong number passes every check of dimensions. Where a
//! number is impossible, the cause is nearly always its unit, and the message
//! says which.
//!
//! Sea water in g/cm³ under a head of kg/m³ is the number of air: 1.025 and 1.2.
//! The kinematic viscosity beside it tells them apart: ρν of air is some 1.8e-5
//! Pa s, whatever its pressure, and with the ν of water eighteen times less.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use crate::units::{Dimension, Unit};

/// Densities of liquids that bodies are tested in, kg/m³.
///
/// Water lies between 958 (boiling) and 1240 (Dead Sea); light oils at 700 and heavy brines at 1600 stand in for it now and
/// then. Nothing near 1 is among them, which is what water is in g/cm³.
pub const LIQUID_KG_M3: RangeInclusive<f64> = 500.0..=2000.0;

/// Densities of air, kg/m³: 0.9 at 3000 m of height, 1.5 at −40 °C.
pub const AIR_KG_M3: RangeInclusive<f64> = 0.9..=1.5;

/// Dynamic viscosities of air, Pa s: 1.51e-5 at −40 °C to 2.00e-5 at 60 °C by Sutherland's law, and what rounded numbers make of them.
const AIR_PA_S: RangeInclusive<f64> = 1.3e-5..=2.5e-5;

/// Rounding of a whole turn through a unit.
const WHOLE_TURN: f64 = TAU * (1.0 + 1e-9);

/// What is wrong with a value of `name`, as the rest of a sentence that has named it; `None` for a plausible one.
///
/// `si` is the value in SI, `unit` the one that it was written in. A density of air passes: whoever knows the viscosity beside it asks
/// [`density`].
#[must_use]
pub fn problem(name: &str, si: f64, unit: &Unit) -> Option<String> {
    match (name, unit.dimension) {
        ("angle" | "misalignment", Dimension::ANGLE) => angle(si, unit),
        ("density", Dimension::DENSITY) if !AIR_KG_M3.contains(&si) => density(si, None),
        // Glycerine at 20 °C has 1.2e-3 m²/s (CRC Handbook), eight times less; water in cSt has 1.
        ("kinematic_viscosity", Dimension::KINEMATIC_VISCOSITY) if si > 0.01 => Some(
            "is far above that of any liquid in which bodies are towed: water has 1e-6 m^2/s, which is 1 cSt (mm^2/s)"
                .to_owned(),
        ),
        _ => None,
    }
}

/// An angle of more than a turn, and what was probably meant.
#[must_use]
pub fn angle(rad: f64, unit: &Unit) -> Option<String> {
    if rad.abs() <= WHOLE_TURN {
        return None;
    }
    let number = unit.from_si(rad);
    let wrapped = format!("{} {unit}", digits(unit.from_si(rad - TAU * (rad / TAU).round())));
    let is_in_radians = unit.factor == 1.0;
    let cause = if is_in_radians && number.abs() <= 360.0 {
        format!(
            "degrees under a header in radians, probably: write the unit deg; of an angle counted on over several turns take the \
             whole ones off ({wrapped})"
        )
    } else if is_in_radians {
        format!("an angle counted on over several turns, probably: take the whole ones off ({wrapped})")
    } else {
        let once = digits(unit.from_si(rad.to_radians()));
        format!(
            "an angle counted on over several turns, probably: take the whole ones off ({wrapped}); or one that was made degrees \
             twice ({once} {unit})"
        )
    };
    Some(format!("is more than a whole turn: {cause}"))
}

/// A density that neither water nor air has, and what was probably meant; air is believed where the kinematic viscosity beside it is
/// air's.
#[must_use]
pub fn density(kg_m3: f64, kinematic_viscosity_m2_s: Option<f64>) -> Option<String> {
    let problem = no_water(kg_m3)?;
    if !AIR_KG_M3.contains(&kg_m3) {
        return Some(problem);
    }
    match kinematic_viscosity_m2_s {
        Some(nu) if AIR_PA_S.contains(&(kg_m3 * nu)) => None,
        Some(nu) => Some(format!(
            "{problem}, or, if the test was in air, the kinematic viscosity beside it: {nu:e} m^2/s is not that of air, some 1.5e-5 m^2/s"
        )),
        None => Some(format!(
            "{problem}; if the test was in air, state its kinematic viscosity too, some 1.5e-5 m^2/s: kinematic_viscosity beside density, in \
             [fluid] of the campaign or as columns"
        )),
    }
}

/// The same for added mass, which asks for no viscosity and is in proportion to the density: 1 kg/m³ is taken for A/ρ.
#[must_use]
pub fn density_of_displaced_water(kg_m3: f64) -> Option<String> {
    let problem = no_water(kg_m3).filter(|_| kg_m3 != 1.0)?;
    let is_air = AIR_KG_M3.contains(&kg_m3);
    let advice =
        if is_air { "; in air, ask for \"1 kg/m^3\" and multiply the result by the density of the air" } else { "" };
    Some(format!("{problem}{advice}"))
}

/// A density that no liquid has, and what was probably meant.
fn no_water(kg_m3: f64) -> Option<String> {
    if LIQUID_KG_M3.contains(&kg_m3) {
        return None;
    }
    let meant = [1e3, 1e-3].into_iter().map(|by| by * kg_m3).find(|rho| LIQUID_KG_M3.contains(rho));
    let advice = match meant {
        Some(rho) => format!("write {} g/cm^3 or {} kg/m^3", digits(1e-3 * rho), digits(rho)),
        None => "fresh water has 1000 kg/m^3, sea water 1025".to_owned(),
    };
    let [low, high] = [LIQUID_KG_M3.start(), LIQUID_KG_M3.end()];
    Some(format!("is not a density of water ({low} to {high} kg/m^3 are accepted); {advice}"))
}

/// The unit that a bare number of this kind was probably meant in: 1.025 is a density in g/cm³, and in kg/m³ that of air.
pub(crate) fn unit_for(number: f64, dimension: Dimension, usual: &str) -> &str {
    let is_relative = dimension == Dimension::DENSITY && LIQUID_KG_M3.contains(&(1e3 * number));
    if is_relative { "g/cm^3" } else { usual }
}

/// Enough digits to recognise a number by.
fn digits(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::parse_unit;

    #[test]
    fn an_angle_says_which_slip_made_it() {
        let said = |number: f64, unit: &str| {
            let unit = parse_unit(unit).unwrap();
            problem("angle", unit.to_si(number), &unit)
        };
        for (number, unit) in
            [(0.0, "deg"), (360.0, "deg"), (-360.0, "deg"), (TAU, "rad"), (1.0, "rev"), (400.0, "gon")]
        {
            assert_eq!(said(number, unit), None, "{number} {unit}");
        }
        assert_eq!(
            said(30.0, "rad").unwrap(),
            "is more than a whole turn: degrees under a header in radians, probably: write the unit deg; of an angle counted on \
             over several turns take the whole ones off (-1.41593 rad)"
        );
        assert_eq!(
            said(-1718.873, "deg").unwrap(),
            "is more than a whole turn: an angle counted on over several turns, probably: take the whole ones off (81.127 deg); \
             or one that was made degrees twice (-30 deg)"
        );
        assert!(said(1e4, "rad").unwrap().contains("several turns, probably"));
    }

    #[test]
    fn water_is_neither_air_nor_lead() {
        for rho in [500.0, 700.0, 997.0, 1025.0, 1240.0, 2000.0] {
            assert_eq!(density(rho, None), None, "{rho}");
        }
        let meant = "is not a density of water (500 to 2000 kg/m^3 are accepted); write 1.025 g/cm^3 or 1025 kg/m^3";
        assert!(density(1.025, None).unwrap().starts_with(&format!("{meant}; if the test was in air, state its")));
        assert_eq!(density(1.025e6, None).unwrap(), meant);
        assert!(
            density_of_displaced_water(1.2)
                .unwrap()
                .ends_with("in air, ask for \"1 kg/m^3\" and multiply the result by the density of the air")
        );
        assert_eq!(density_of_displaced_water(1.025e6).unwrap(), meant);
        assert!(density(11_340.0, None).unwrap().ends_with("fresh water has 1000 kg/m^3, sea water 1025"));
        let viscosity = |si: f64| problem("kinematic_viscosity", si, &parse_unit("m^2/s").unwrap());
        assert_eq!((viscosity(1.2e-3), viscosity(1.0e-6)), (None, None), "glycerine and water");
        assert!(viscosity(1.004).unwrap().contains("which is 1 cSt"));
        assert_eq!(unit_for(1.025, Dimension::DENSITY, "kg/m^3"), "g/cm^3");
        assert_eq!(unit_for(1025.0, Dimension::DENSITY, "kg/m^3"), "kg/m^3");
        assert_eq!(unit_for(1.025, Dimension::SPEED, "m/s"), "m/s");
    }

    /// ρ and ν of air by the ideal gas and Sutherland's law, −20 to 50 °C and up to 3000 m; of water 0 to 40 °C in g/cm³.
    #[test]
    fn the_viscosity_tells_air_from_water_in_other_units() {
        for kelvin in [253.15, 273.15, 288.15, 293.15, 323.15] {
            for pascal in [70_000.0, 90_000.0, 101_325.0, 103_000.0] {
                let rho: f64 = pascal / (287.05 * kelvin);
                let mu = 1.716e-5 * f64::powf(kelvin / 273.15, 1.5) * (273.15 + 110.4) / (kelvin + 110.4);
                // Colder and lower than any tunnel, the number alone is none of air.
                if AIR_KG_M3.contains(&rho) {
                    assert_eq!(density(rho, Some(mu / rho)), None, "{kelvin} K, {pascal} Pa");
                }
            }
        }
        for rho in [0.998, 1.025, 1.2] {
            for nu in [0.66e-6, 1.0e-6, 1.19e-6, 1.79e-6] {
                let said = density(rho, Some(nu)).unwrap();
                assert!(said.contains("or, if the test was in air, the kinematic viscosity beside it"), "{said}");
            }
        }
        assert_eq!(density(1.2, Some(1.5e-5)), None);
        assert_eq!(density(1000.0, Some(1.5e-5)), None, "a thick oil");
    }
}
