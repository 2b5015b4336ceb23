//! Added mass: coefficients, the signed force balance, forced oscillation.
//!
//! **Setting.** A body accelerating in one direction, or swung as a pendulum.
//! **Frame.** Body axes. All forces act on the body: `f_m` is the rig's,
//! `f_D` drag, `f_B` buoyancy less weight, `f_A` what the water's inertia adds.
//! **Units.** SI.
//!
//! | relation                               | function                        | source        |
//! |----------------------------------------|---------------------------------|---------------|
//! | `μ = V ρ C`                            | [`mass_kg`], [`coefficient`]    | USR eq. 15, 22, 23 |
//! | `μ_y = μ_n ρ k C_A`                    | [`chain_mass_kg`]               | USR eq. 24    |
//! | `f_A = m a − f_m − f_D − f_B`          | [`inertia_force_n`]             | USR eq. 16, 17, signs by Newton |
//! | `f_B = B sin φ`                        | [`buoyancy_across_n`]           | USR eq. 20    |
//! | `φ = (α+δ) sin(ωt+Φ)`                  | [`ForcedOscillation`]           | USR eq. 18, 19, made consistent |
//!
//! `C_A` means nothing without its volume: 1.2674 of USR Table 7 belongs to
//! `μ_n = 1.2723e-3 m³` per link, inferred from the printed slope (not printed).

/// Added mass `μ = V ρ C` \[kg\] (USR eq. 22).
#[must_use]
pub fn mass_kg(coefficient: f64, density_kg_m3: f64, volume_m3: f64) -> f64 {
    coefficient * density_kg_m3 * volume_m3
}

/// Added-mass coefficient `C = μ / (V ρ)` \[-\] (USR eq. 15, 22).
///
/// # Example
///
/// USR Table 6, H3LT, in sea water:
///
/// ```
/// use froude_hydro::added_mass::coefficient;
/// assert!((coefficient(5.1539, 1025.0, 3.830e-3) - 1.3132).abs() < 5e-4);
/// ```
#[must_use]
pub fn coefficient(mass_kg: f64, density_kg_m3: f64, volume_m3: f64) -> f64 {
    mass_kg / (density_kg_m3 * volume_m3)
}

/// Sway added mass of a chain, `μ_y = μ_n ρ k C_A` \[kg\] (USR eq. 24).
///
/// `k` counts plain links: the published `C_A` follows with `k`, not with `k + 2`.
#[must_use]
pub fn chain_mass_kg(c_a: f64, density_kg_m3: f64, link_volume_m3: f64, n_links: f64) -> f64 {
    c_a * density_kg_m3 * link_volume_m3 * n_links
}

/// Force of the water's inertia on the body, `f_A = m a − f_m − f_D − f_B` \[N\].
///
/// # Source
///
/// Newton's law for the body, all forces signed and acting on it. USR eq. 17 is the
/// same with the measured force taken as the body's on the rig.
#[must_use]
pub fn inertia_force_n(
    mass_kg: f64,
    acceleration_m_s2: f64,
    rig_force_n: f64,
    drag_force_n: f64,
    buoyancy_force_n: f64,
) -> f64 {
    mass_kg * acceleration_m_s2 - rig_force_n - drag_force_n - buoyancy_force_n
}

/// Net buoyancy across the link at the swing angle `φ`, `B sin φ` \[N\] (USR eq. 20).
///
/// `B` comes from still runs, `B = f_my / sin φ` (USR eq. 21).
#[must_use]
pub fn buoyancy_across_n(net_buoyancy_n: f64, angle_rad: f64) -> f64 {
    net_buoyancy_n * libm::sin(angle_rad)
}

/// A body swung about a pivot: `φ = (α+δ) sin(ωt + Φ)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForcedOscillation {
    /// Distance of the reference point from the pivot, `r`, m; 0.476 in USR.
    pub radius_m: f64,
    /// `α + δ`, commanded amplitude and its correction, rad.
    pub amplitude_rad: f64,
    /// `ω`, rad/s.
    pub frequency_rad_s: f64,
    /// `Φ`, rad.
    pub phase_rad: f64,
}

impl ForcedOscillation {
    /// `(φ, v_y, a_y)` at a time: rad, m/s, m/s²; `v_y = rφ̇`, `a_y = rφ̈`.
    ///
    /// # Source
    ///
    /// USR eq. 18. Eq. 19 as printed has the sine and cosine exchanged and is not the
    /// derivative of eq. 18; this is.
    ///
    /// # Example
    ///
    /// ```
    /// use froude_hydro::added_mass::ForcedOscillation;
    /// let swing = ForcedOscillation {
    ///     radius_m: 0.476, amplitude_rad: 15f64.to_radians(),
    ///     frequency_rad_s: 70f64.to_radians(), phase_rad: 0.0,
    /// };
    /// let [_, v_y, a_y] = swing.at(0.0);
    /// assert!((v_y - 0.1522).abs() < 1e-4 && a_y == 0.0);
    /// ```
    #[must_use]
    pub fn at(&self, time_s: f64) -> [f64; 3] {
        let omega = self.frequency_rad_s;
        let (sin, cos) = libm::sincos(omega * time_s + self.phase_rad);
        let angle = self.amplitude_rad * sin;
        [angle, self.radius_m * self.amplitude_rad * omega * cos, 0.0 - self.radius_m * omega * omega * angle]
    }
}
