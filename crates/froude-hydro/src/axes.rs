//! Heading, towing direction and the velocity of a body through the water.
//!
//! **Setting.** Planar motion (surge, sway, yaw), uniform current.
//! **Frame.** World axes `x`, `y`; body axes turned by the heading `θ`, positive
//! from world `x` to world `y`. `v` is the body's velocity *through the water*.
//! **Units.** m/s, rad.
//!
//! | relation                       | function                            | source    |
//! |--------------------------------|-------------------------------------|-----------|
//! | `v = (U cos θ, −U sin θ)`      | [`velocity_when_towed_m_s`]         | USR eq. 5 |
//! | `θ = atan2(−v_y, v_x)`         | [`angle_rad`]                       | its inverse |
//! | `v = Rᵀ(θ)(ẋ − V)`             | [`velocity_through_water_body_m_s`] | USR eq. 5 |
//! | `v̇ = Rᵀẍ + (dRᵀ/dt)(ẋ − V)`    | [`acceleration_through_water_body_m_s2`] | USR eq. 6 |

/// Body-axes velocity of a body at heading `θ` towed at `U` along world `x`.
///
/// `v = (U cos θ, −U sin θ)` \[m/s\]. A body held at the angle of attack `θ` in a
/// stream `U` along world `−x` moves through the water in the same way.
///
/// # Source
///
/// USR eq. 5 with `ẋ = (U, 0)` and no current.
///
/// # Example
///
/// ```
/// use froude_hydro::axes::velocity_when_towed_m_s;
/// let [v_x, v_y] = velocity_when_towed_m_s(0.4, core::f64::consts::FRAC_PI_6);
/// assert!((v_x - 0.346_410).abs() < 1e-6 && (v_y + 0.2).abs() < 1e-12);
/// ```
#[must_use]
pub fn velocity_when_towed_m_s(speed_m_s: f64, angle_rad: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle_rad);
    [speed_m_s * cos, -speed_m_s * sin]
}

/// Sensitivity of [`velocity_when_towed_m_s`] to speed and to angle.
///
/// Rows are `∂v/∂U` \[-\] and `∂v/∂θ` \[m/s per rad\], each `(x, y)`.
///
/// # Example
///
/// One degree of misalignment at 0.4 m/s is 7 mm/s of sway:
///
/// ```
/// use froude_hydro::axes::velocity_sensitivity;
/// let [_, by_angle] = velocity_sensitivity(0.4, 0.0);
/// assert!((by_angle[1].abs() * 1f64.to_radians() - 0.007).abs() < 1e-4);
/// ```
#[must_use]
pub fn velocity_sensitivity(speed_m_s: f64, angle_rad: f64) -> [[f64; 2]; 2] {
    let (sin, cos) = libm::sincos(angle_rad);
    [[cos, -sin], [-speed_m_s * sin, -speed_m_s * cos]]
}

/// Angle of the motion, `θ = atan2(−v_y, v_x)` \[rad\], in `(−π, π]`.
///
/// Zero is straight ahead; at rest the result is zero.
///
/// # Example
///
/// ```
/// use froude_hydro::axes::{angle_rad, velocity_when_towed_m_s};
/// assert!((angle_rad(velocity_when_towed_m_s(0.3, 0.7)) - 0.7).abs() < 1e-15);
/// ```
#[must_use]
pub fn angle_rad(v_body_m_s: [f64; 2]) -> f64 {
    if v_body_m_s == [0.0, 0.0] {
        return 0.0;
    }
    // 0 − v_y and not −v_y: straight astern is +π, whatever the sign of zero.
    libm::atan2(0.0 - v_body_m_s[1], v_body_m_s[0])
}

/// Speed through the water, `U = √(v_x² + v_y²)` \[m/s\].
#[must_use]
pub fn speed_m_s(v_body_m_s: [f64; 2]) -> f64 {
    libm::hypot(v_body_m_s[0], v_body_m_s[1])
}

/// Turns a world vector into body axes: `Rᵀ(θ) a`, in the unit of `a`.
#[must_use]
pub fn body_from_world(heading_rad: f64, world: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = libm::sincos(heading_rad);
    [cos * world[0] + sin * world[1], cos * world[1] - sin * world[0]]
}

/// Turns a body vector into world axes: `R(θ) a`, in the unit of `a`.
#[must_use]
pub fn world_from_body(heading_rad: f64, body: [f64; 2]) -> [f64; 2] {
    body_from_world(-heading_rad, body)
}

/// Velocity through the water in body axes, `v = Rᵀ(θ)(ẋ − V)` \[m/s\].
///
/// # Source
///
/// USR eq. 5.
#[must_use]
pub fn velocity_through_water_body_m_s(
    heading_rad: f64,
    velocity_world_m_s: [f64; 2],
    current_world_m_s: [f64; 2],
) -> [f64; 2] {
    body_from_world(
        heading_rad,
        [velocity_world_m_s[0] - current_world_m_s[0], velocity_world_m_s[1] - current_world_m_s[1]],
    )
}

/// Rate of the body-axes velocity, `v̇ = Rᵀẍ + (dRᵀ/dt)(ẋ − V)` \[m/s²\].
///
/// The second term is `r (v_y, −v_x)`: a turning body sees its velocity turn the
/// other way. The current is steady.
///
/// # Source
///
/// USR eq. 6 (the unnumbered line below eq. 5).
///
/// # Example
///
/// ```
/// use froude_hydro::axes::acceleration_through_water_body_m_s2;
/// // No acceleration in the world, 1 m/s ahead, turning at 2 rad/s.
/// let a = acceleration_through_water_body_m_s2(0.0, 2.0, [1.0, 0.0], [0.0, 0.0], [0.0, 0.0]);
/// assert_eq!(a, [0.0, -2.0]);
/// ```
#[must_use]
pub fn acceleration_through_water_body_m_s2(
    heading_rad: f64,
    yaw_rate_rad_s: f64,
    velocity_world_m_s: [f64; 2],
    current_world_m_s: [f64; 2],
    acceleration_world_m_s2: [f64; 2],
) -> [f64; 2] {
    let v = velocity_through_water_body_m_s(heading_rad, velocity_world_m_s, current_world_m_s);
    let a = body_from_world(heading_rad, acceleration_world_m_s2);
    [a[0] + yaw_rate_rad_s * v[1], a[1] - yaw_rate_rad_s * v[0]]
}
