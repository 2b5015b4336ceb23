//! Moves from rest to rest whose state at any time has a closed form.
//!
//! **Setting.** One axis; speed, acceleration and, if asked, jerk stay within bounds. Without a jerk bound the speed is a trapezoid
//! (a triangle when the way is short), with one the acceleration is (seven segments, fewer when the way is short).
//! **Frame.** Axis coordinate along the chain. **Units.** SI.
//!
//! A profile from rest to rest is its own mirror image, so only the first half is stored: the way s(t) from the start. The second
//! half is `target − s(duration − t)`. Hence start and target are met to the last bit, at rest, and the halves meet to rounding.

/// Position, speed and acceleration of a reference.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// m.
    pub position_m: f64,
    /// m/s.
    pub speed_m_s: f64,
    /// m/s².
    pub acceleration_m_s2: f64,
}

impl State {
    /// At rest.
    #[must_use]
    pub const fn at_rest(position_m: f64) -> Self {
        Self { position_m, speed_m_s: 0.0, acceleration_m_s2: 0.0 }
    }
}

/// What a profile must keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Largest speed, m/s (> 0).
    pub speed_m_s: f64,
    /// Largest acceleration, m/s² (> 0).
    pub acceleration_m_s2: f64,
    /// Largest jerk, m/s³; 0 means none is kept.
    pub jerk_m_s3: f64,
}

/// A way shorter than this is no way: the reference steps there, m. A thousandth of an encoder count.
const NO_WAY_M: f64 = 1e-9;

/// The fastest profile from rest to rest within its [`Bounds`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    start_m: f64,
    target_m: f64,
    direction: f64,
    jerk_m_s3: f64,
    acceleration_m_s2: f64,
    peak_speed_m_s: f64,
    /// End of rising jerk, of constant acceleration, of falling jerk; then cruise until `half_s`.
    rise_s: f64,
    hold_s: f64,
    fall_s: f64,
    half_s: f64,
    /// Speed and way at `rise_s`; way at `fall_s`.
    rise_speed_m_s: f64,
    rise_way_m: f64,
    fall_way_m: f64,
}

impl Profile {
    /// Plans the move. The bounds must be positive (jerk: not negative) and finite.
    ///
    /// Start and target are met exactly. Bounds are kept to a few units of rounding.
    ///
    /// # Source
    ///
    /// With Tⱼ the time of a jerk segment and Tₐ that of constant acceleration: peak acceleration J Tⱼ, peak speed
    /// J Tⱼ (Tⱼ + Tₐ), way of both ramps v (2 Tⱼ + Tₐ). Our derivation; the cases are those of Biagiotti & Melchiorri,
    /// "Trajectory planning for automatic machines and robots" (2008), §3.4.
    #[must_use]
    pub fn plan(start_m: f64, target_m: f64, bounds: Bounds) -> Self {
        let way_m = libm::fabs(target_m - start_m);
        let direction = if target_m < start_m { -1.0 } else { 1.0 };
        if way_m < NO_WAY_M {
            return Self::none(target_m);
        }
        let [jerk_s, flat_s] = ramp_times_s(way_m, bounds);
        // Rounding in the times is taken out by a scale within an ulp or two of one: of the speed where the profile
        // cruises, else of the way.
        let jerk = bounds.jerk_m_s3;
        let acceleration = if jerk > 0.0 { jerk * jerk_s } else { bounds.acceleration_m_s2 };
        let speed = acceleration * (jerk_s + flat_s);
        let ramp_way = 0.5 * speed * (2.0 * jerk_s + flat_s);
        let fall_s = 2.0 * jerk_s + flat_s;
        let half_way = 0.5 * way_m;
        let cruise_way = half_way - 0.5 * bounds.speed_m_s * fall_s;
        let (scale, half_s, fall_way_m) = if cruise_way > 0.0 && speed >= bounds.speed_m_s * (1.0 - 1e-9) {
            (bounds.speed_m_s / speed, fall_s + cruise_way / bounds.speed_m_s, 0.5 * bounds.speed_m_s * fall_s)
        } else {
            (half_way / ramp_way, fall_s, half_way)
        };
        let jerk = jerk * scale;
        Self {
            start_m,
            target_m,
            direction,
            jerk_m_s3: jerk,
            acceleration_m_s2: acceleration * scale,
            peak_speed_m_s: speed * scale,
            rise_s: jerk_s,
            hold_s: jerk_s + flat_s,
            fall_s,
            half_s,
            rise_speed_m_s: 0.5 * jerk * jerk_s * jerk_s,
            rise_way_m: jerk * jerk_s * jerk_s * jerk_s / 6.0,
            fall_way_m,
        }
    }

    /// A profile that has arrived.
    #[must_use]
    pub fn none(target_m: f64) -> Self {
        Self {
            start_m: target_m,
            target_m,
            direction: 1.0,
            jerk_m_s3: 0.0,
            acceleration_m_s2: 0.0,
            peak_speed_m_s: 0.0,
            rise_s: 0.0,
            hold_s: 0.0,
            fall_s: 0.0,
            half_s: 0.0,
            rise_speed_m_s: 0.0,
            rise_way_m: 0.0,
            fall_way_m: 0.0,
        }
    }

    /// How long it takes, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        2.0 * self.half_s
    }

    /// Largest speed that it reaches, m/s, not negative.
    #[must_use]
    pub fn peak_speed_m_s(&self) -> f64 {
        self.peak_speed_m_s
    }

    /// Largest acceleration that it reaches, m/s², not negative.
    #[must_use]
    pub fn peak_acceleration_m_s2(&self) -> f64 {
        self.acceleration_m_s2
    }

    /// Where it starts, m.
    #[must_use]
    pub fn start_m(&self) -> f64 {
        self.start_m
    }

    /// Where it ends, m.
    #[must_use]
    pub fn target_m(&self) -> f64 {
        self.target_m
    }

    /// +1 or −1.
    #[must_use]
    pub fn direction(&self) -> f64 {
        self.direction
    }

    /// State at `time_s`: at rest at the start before 0, at rest at the target from the end on.
    #[must_use]
    pub fn sample(&self, time_s: f64) -> State {
        let duration_s = self.duration_s();
        if time_s >= duration_s {
            return State::at_rest(self.target_m);
        }
        if time_s < 0.0 {
            return State::at_rest(self.start_m);
        }
        if time_s <= self.half_s {
            let [way, speed, acceleration] = self.first_half(time_s);
            State {
                position_m: self.start_m + self.direction * way,
                speed_m_s: self.direction * speed,
                acceleration_m_s2: self.direction * acceleration,
            }
        } else {
            let [way, speed, acceleration] = self.first_half(duration_s - time_s);
            State {
                position_m: self.target_m - self.direction * way,
                speed_m_s: self.direction * speed,
                acceleration_m_s2: -(self.direction * acceleration),
            }
        }
    }

    /// Way, speed and acceleration at `t` of the first half, along the direction.
    fn first_half(&self, t: f64) -> [f64; 3] {
        let jerk = self.jerk_m_s3;
        if t < self.rise_s {
            let a = jerk * t;
            [a * t * t * (1.0 / 6.0), 0.5 * a * t, a]
        } else if t < self.hold_s {
            let t = t - self.rise_s;
            let a = self.acceleration_m_s2;
            let v0 = self.rise_speed_m_s;
            [self.rise_way_m + t * (v0 + 0.5 * a * t), v0 + a * t, a]
        } else if t < self.fall_s {
            let left = t - self.fall_s; // ≤ 0: counted from the end of the ramp
            let a = -(jerk * left);
            let v = self.peak_speed_m_s;
            [self.fall_way_m + left * (v + a * left * (1.0 / 6.0)), v + 0.5 * a * left, a]
        } else {
            [self.fall_way_m + self.peak_speed_m_s * (t - self.fall_s), self.peak_speed_m_s, 0.0]
        }
    }
}

/// Times of one jerk segment and of constant acceleration, s.
fn ramp_times_s(way_m: f64, bounds: Bounds) -> [f64; 2] {
    let Bounds { speed_m_s: v, acceleration_m_s2: a, jerk_m_s3: j } = bounds;
    if j <= 0.0 {
        let full = v / a;
        return [0.0, if way_m > v * full { full } else { libm::sqrt(way_m / a) }];
    }
    let [jerk_s, flat_s] = if v * j >= a * a { [a / j, v / a - a / j] } else { [libm::sqrt(v / j), 0.0] };
    if v * (2.0 * jerk_s + flat_s) <= way_m {
        return [jerk_s, flat_s];
    }
    // The speed is not reached. Is the acceleration?
    let jerk_s = a / j;
    if v * j >= a * a && way_m >= 2.0 * a * jerk_s * jerk_s {
        let root = libm::sqrt(jerk_s * jerk_s + 4.0 * way_m / a);
        return [jerk_s, libm::fmax(0.0, 0.5 * (root - 3.0 * jerk_s))];
    }
    [libm::cbrt(way_m / (2.0 * j)), 0.0]
}
