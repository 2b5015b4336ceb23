//! Density and viscosity of fresh and sea water.
//!
//! **Setting.** Water at atmospheric pressure; temperature and salinity known.
//! **Units.** degC (ITS-90) and g/kg (absolute salinity) at the door, SI out.
//!
//! | quantity          | function                   | source                              | range             |
//! |-------------------|----------------------------|-------------------------------------|-------------------|
//! | density           | [`density_eos80_kg_m3`]    | UNESCO 1983 (EOS-80)                | 0..40 degC, S 0..42 |
//! | dynamic viscosity | [`dynamic_viscosity_pa_s`] | Sharqawy, Lienhard & Zubair 2010, eq. 22, 23 | 0..180 degC, 0..150 g/kg |
//! | both              | [`Water::at`]              | the two                             | 0..40 degC, 0..42 g/kg |
//!
//! EOS-80 speaks practical salinity and the temperature scale IPTS-68. [`Water::at`]
//! converts: `S_P = S·35/35.16504` (Millero et al. 2008, reference composition) and
//! `t_68 = 1.00024 t_90`. Standard error of EOS-80 at one atmosphere: 0.0036 kg/m³
//! (UNESCO 1983); the viscosity's stated accuracy is ±1.5 % (Sharqawy 2010), against
//! the ITTC tables at 15 degC it is 0.02 % (measured in the tests).
//!
//! Tap water carries 0.1 to 0.5 g/kg and air bubbles: neither is known here.

/// Absolute salinity of standard sea water, `S_P = 35`, g/kg (Millero et al. 2008).
pub const STANDARD_SEAWATER_G_KG: f64 = 35.165_04;

/// Water that the formulations do not cover.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FluidError {
    /// Outside 0..40 degC, or not a number.
    #[error(
        "water temperature {temperature_degc} degC is outside 0 to 40 degC; \
         kelvin are converted by subtracting 273.15"
    )]
    Temperature {
        /// What was given, degC.
        temperature_degc: f64,
    },
    /// Outside 0..42 g/kg, or not a number.
    #[error(
        "salinity {salinity_g_kg} g/kg is outside 0 to 42 g/kg; sea water has about 35 g/kg, \
         that is 0.035 kg/kg"
    )]
    Salinity {
        /// What was given, g/kg.
        salinity_g_kg: f64,
    },
}

/// Density of fresh water at 20 degC, kg/m³, rounded: what stands in where none can be computed.
const FRESH_KG_M3: f64 = 998.2;

/// Density of the water of a test, kg/m³: the stated one; else that at the stated temperature and salinity, 20 degC and 0 g/kg where these
/// are not stated either.
#[must_use]
pub fn density_kg_m3(stated_kg_m3: Option<f64>, temperature_degc: Option<f64>, salinity_g_kg: Option<f64>) -> f64 {
    stated_kg_m3.unwrap_or_else(|| {
        let water = Water::at(temperature_degc.unwrap_or(20.0), salinity_g_kg.unwrap_or(0.0));
        water.map_or(FRESH_KG_M3, |w| w.density_kg_m3)
    })
}

/// The water of a test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Water {
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Dynamic viscosity, Pa s.
    pub dynamic_viscosity_pa_s: f64,
}

impl Water {
    /// Water at a temperature and a salinity, at atmospheric pressure.
    ///
    /// # Errors
    ///
    /// [`FluidError`] outside 0..40 degC or 0..42 g/kg.
    ///
    /// # Source
    ///
    /// UNESCO (1983), Technical Papers in Marine Science 44; Sharqawy, Lienhard and
    /// Zubair (2010), Desalination and Water Treatment 16, eq. 22, 23.
    ///
    /// # Example
    ///
    /// Fresh water at 15 degC, as ITTC 7.5-02-01-03 tabulates it:
    ///
    /// ```
    /// use froude_hydro::fluid::Water;
    /// let fresh = Water::at(15.0, 0.0)?;
    /// assert!((fresh.density_kg_m3 - 999.10).abs() < 0.01);
    /// assert!((fresh.kinematic_viscosity_m2_s() - 1.1386e-6).abs() < 1e-9);
    /// # Ok::<(), froude_hydro::fluid::FluidError>(())
    /// ```
    pub fn at(temperature_degc: f64, salinity_g_kg: f64) -> Result<Self, FluidError> {
        if !(0.0..=40.0).contains(&temperature_degc) {
            return Err(FluidError::Temperature { temperature_degc });
        }
        if !(0.0..=42.0).contains(&salinity_g_kg) {
            return Err(FluidError::Salinity { salinity_g_kg });
        }
        let practical = salinity_g_kg * 35.0 / STANDARD_SEAWATER_G_KG;
        Ok(Self {
            density_kg_m3: density_eos80_kg_m3(1.000_24 * temperature_degc, practical),
            dynamic_viscosity_pa_s: dynamic_viscosity_pa_s(temperature_degc, salinity_g_kg),
        })
    }

    /// Kinematic viscosity `ν = μ/ρ`, m²/s.
    #[must_use]
    pub fn kinematic_viscosity_m2_s(&self) -> f64 {
        self.dynamic_viscosity_pa_s / self.density_kg_m3
    }
}

/// Density of water by EOS-80 at one atmosphere, kg/m³.
///
/// `temperature_68_degc` is on IPTS-68, 0..40 degC; `practical_salinity` on PSS-78,
/// 0..42 \[-\]. Outside, the polynomial is evaluated all the same; [`Water::at`] checks.
///
/// # Source
///
/// UNESCO (1983), eq. 13 to 15 (Millero and Poisson 1981; the pure-water part is
/// Bigg's). Check values: ρ(S, t) = 999.96675 (0, 5), 1027.67547 (35, 5),
/// 1023.34306 (35, 25).
///
/// # Example
///
/// ```
/// use froude_hydro::fluid::density_eos80_kg_m3;
/// assert!((density_eos80_kg_m3(5.0, 35.0) - 1027.67547).abs() < 5e-6);
/// ```
#[must_use]
pub fn density_eos80_kg_m3(temperature_68_degc: f64, practical_salinity: f64) -> f64 {
    let (t, s) = (temperature_68_degc, practical_salinity);
    let pure =
        999.842594 + t * (6.793952e-2 + t * (-9.095290e-3 + t * (1.001685e-4 + t * (-1.120083e-6 + t * 6.536332e-9))));
    let a = 8.24493e-1 + t * (-4.0899e-3 + t * (7.6438e-5 + t * (-8.2467e-7 + t * 5.3875e-9)));
    let b = -5.72466e-3 + t * (1.0227e-4 - t * 1.6546e-6);
    let c = 4.8314e-4;
    pure + s * (a + b * libm::sqrt(s) + c * s)
}

/// Dynamic viscosity of fresh and sea water, Pa s.
///
/// `temperature_degc` 0..180 degC, `salinity_g_kg` 0..150 g/kg; stated accuracy
/// ±1.5 %. Outside, the formula is evaluated all the same; [`Water::at`] checks.
///
/// # Source
///
/// Sharqawy, Lienhard and Zubair (2010), eq. 22 (sea water; after Isdale et al.
/// 1972) and eq. 23 (pure water; fitted to IAPWS 2008).
///
/// # Example
///
/// ```
/// use froude_hydro::fluid::dynamic_viscosity_pa_s;
/// let fresh = dynamic_viscosity_pa_s(20.0, 0.0);
/// assert!((fresh - 1.002e-3).abs() < 1e-6);
/// ```
#[must_use]
pub fn dynamic_viscosity_pa_s(temperature_degc: f64, salinity_g_kg: f64) -> f64 {
    let t = temperature_degc;
    let s = salinity_g_kg / 1000.0; // kg/kg in eq. 22
    let pure = 4.2844e-5 + 1.0 / (0.157 * (t + 64.993) * (t + 64.993) - 91.296);
    let a = 1.541 + t * (1.998e-2 - t * 9.52e-5);
    let b = 7.974 + t * (-7.561e-2 + t * 4.724e-4);
    pure * (1.0 + s * (a + b * s))
}
