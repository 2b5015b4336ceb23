//! A body swung about a pivot in a stream: velocity and acceleration through the water, from the angle and its derivatives.
//!
//! **Frame.** Body axes, `x` along the stream at rest, `y` across; `φ > 0` moves the body towards `+y`. **Units.** SI, radians.
//!
//! | pivot  | v_x     | v_y            | v̇_y                | a_y of the body | buoyancy across it |
//! |--------|---------|----------------|---------------------|-----------------|--------------------|
//! | stream | U       | r φ̇           | r φ̈                | r φ̈            | B sin φ            |
//! | upright| U cos φ | r φ̇ − U sin φ | r φ̈ − U φ̇ cos φ   | r φ̈            | –                  |
//!
//! # Source
//!
//! USR eq. 5, v = Rᵀ(ẋ − V), and eq. 19 in its consistent form (the printed velocity and acceleration are not derivatives of one angle).

/// Standard acceleration of free fall, m/s².
const G_M_S2: f64 = 9.80665;

/// How the pivot axis lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Pivot {
    /// Along the stream: the body swings across it like a pendulum, and its buoyancy has a part `B sin φ` across it.
    Stream,
    /// Upright: the body turns its heading with `φ`, so that a part of the stream, `−U sin φ`, runs across it.
    Upright,
}

impl Pivot {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Stream, Self::Upright];
    /// As they stand in files.
    pub const NAMES: [&'static str; 2] = ["stream", "upright"];

    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Stream => "the pivot axis lies along the stream",
            Self::Upright => "the pivot axis is upright",
        }
    }
}

/// What the body swings in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Medium {
    /// Water: the weight is part of the net buoyancy.
    Water,
    /// Air: the rig carries the weight.
    Air,
}

/// The motion at one time, in body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinematics {
    /// Velocity through the water, m/s.
    pub velocity_m_s: [f64; 2],
    /// v̇_y: rate of the velocity across the body, in body axes, m/s².
    pub sway_rate_m_s2: f64,
    /// Acceleration of the body across itself in space, m/s².
    pub acceleration_m_s2: f64,
    /// Part of an upward force that lies across the body, towards +y.
    pub upward: f64,
}

impl Kinematics {
    /// Of an angle `[φ, φ̇, φ̈]`, rad over s.
    #[must_use]
    pub fn of([angle, rate, second]: [f64; 3], pivot: Pivot, radius_m: f64, flow_m_s: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        match pivot {
            Pivot::Stream => Self {
                velocity_m_s: [flow_m_s, radius_m * rate],
                sway_rate_m_s2: radius_m * second,
                acceleration_m_s2: radius_m * second,
                upward: sin,
            },
            Pivot::Upright => Self {
                velocity_m_s: [flow_m_s * cos, radius_m * rate - flow_m_s * sin],
                sway_rate_m_s2: radius_m * second - flow_m_s * rate * cos,
                acceleration_m_s2: radius_m * second,
                upward: 0.0,
            },
        }
    }

    /// Force that the rig exerts per mass of the body, N/kg: what moves it, and in air what carries it.
    #[must_use]
    pub fn per_mass(&self, medium: Medium) -> f64 {
        match medium {
            Medium::Water => self.acceleration_m_s2,
            Medium::Air => self.acceleration_m_s2 + G_M_S2 * self.upward,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// Differences of positions in space, turned into body axes: no formula of the table is used.
    #[test]
    fn the_table_is_the_derivative_of_the_motion() {
        let (radius, flow, amplitude, omega) = (0.476, 0.2, 0.3, 1.2);
        let angle = |t: f64| amplitude * (omega * t).sin();
        let h = 1e-4;
        for pivot in Pivot::ALL {
            // Position of the reference point relative to water that rests: along the stream, across, and up.
            let position = |t: f64| match pivot {
                Pivot::Stream => [flow * t, radius * angle(t).sin(), -radius * angle(t).cos()],
                Pivot::Upright => [flow * t + radius * angle(t).cos(), radius * angle(t).sin(), 0.0],
            };
            let across = |t: f64| match pivot {
                Pivot::Stream => [0.0, angle(t).cos(), angle(t).sin()],
                Pivot::Upright => [-angle(t).sin(), angle(t).cos(), 0.0],
            };
            let along = |t: f64| match pivot {
                Pivot::Stream => [1.0, 0.0, 0.0],
                Pivot::Upright => [angle(t).cos(), angle(t).sin(), 0.0],
            };
            let rate = |t: f64| {
                let (a, b) = (position(t + h), position(t - h));
                [0, 1, 2].map(|i| (a[i] - b[i]) / (2.0 * h))
            };
            let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let sway = |t: f64| dot(rate(t), across(t));
            let t = 0.7;
            let space = {
                let (a, b) = (rate(t + h), rate(t - h));
                [0, 1, 2].map(|i| (a[i] - b[i]) / (2.0 * h))
            };
            let phi = [angle(t), amplitude * omega * (omega * t).cos(), -omega * omega * angle(t)];
            let k = Kinematics::of(phi, pivot, radius, flow);
            // Differences of steps of 1e-4 s: error 1e-8 of the third derivative, rounding 1e-16/1e-8.
            assert!((k.velocity_m_s[0] - dot(rate(t), along(t))).abs() < 1e-7, "{pivot:?}");
            assert!((k.velocity_m_s[1] - sway(t)).abs() < 1e-7, "{pivot:?}");
            assert!((k.sway_rate_m_s2 - (sway(t + h) - sway(t - h)) / (2.0 * h)).abs() < 1e-6, "{pivot:?}");
            assert!((k.acceleration_m_s2 - dot(space, across(t))).abs() < 1e-6, "{pivot:?}");
            assert!((k.upward - dot([0.0, 0.0, 1.0], across(t))).abs() < 1e-12);
        }
    }
}
