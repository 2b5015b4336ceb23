//! Change of speed from any state: the stop, and the constant speed of homing and sweeps.
//!
//! **Setting.** From position, speed and acceleration as they are to a constant speed, within an acceleration and, if asked, a jerk.
//! Without a jerk bound the acceleration may jump. **Frame.** Axis coordinate along the chain. **Units.** SI.

use crate::profile::State;

/// The quickest change from a [`State`] to a constant speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedRamp {
    start_m: f64,
    start_speed_m_s: f64,
    start_acceleration_m_s2: f64,
    end_speed_m_s: f64,
    /// Signed: first jerk (its opposite comes last) and the acceleration held between.
    jerk_m_s3: f64,
    held_m_s2: f64,
    first_s: f64,
    held_s: f64,
    end_s: f64,
    /// At `first_s` and at `end_s`, from the start.
    first_speed_m_s: f64,
    first_way_m: f64,
    end_way_m: f64,
}

impl SpeedRamp {
    /// Plans the change. `acceleration_m_s2` > 0; `jerk_m_s3` ≥ 0, 0 means no bound on it.
    ///
    /// The end speed is met to the last bit; with a jerk bound the change may pass beyond it and come back, where the acceleration
    /// at the start is too large to be taken away in time.
    #[must_use]
    pub fn plan(start: State, end_speed_m_s: f64, acceleration_m_s2: f64, jerk_m_s3: f64) -> Self {
        let change = end_speed_m_s - start.speed_m_s;
        let v0 = start.speed_m_s;
        if jerk_m_s3 <= 0.0 {
            let end_s = libm::fabs(change) / acceleration_m_s2;
            return Self {
                start_m: start.position_m,
                start_speed_m_s: v0,
                start_acceleration_m_s2: 0.0,
                end_speed_m_s,
                jerk_m_s3: 0.0,
                held_m_s2: libm::copysign(acceleration_m_s2, change),
                first_s: 0.0,
                held_s: end_s,
                end_s,
                first_speed_m_s: v0,
                first_way_m: 0.0,
                end_way_m: 0.5 * (v0 + end_speed_m_s) * end_s,
            };
        }
        // If the acceleration is only taken away, speed changes by a|a|/2J; the rest decides the sense.
        let a0 = start.acceleration_m_s2;
        let sense = libm::copysign(1.0, change - a0 * libm::fabs(a0) / (2.0 * jerk_m_s3));
        let gain = sense * change;
        let along = sense * a0;
        let peak_free = libm::sqrt(libm::fmax(0.0, jerk_m_s3 * gain + 0.5 * along * along));
        let (peak, hold_s) = if peak_free <= acceleration_m_s2 {
            (libm::fmax(peak_free, along), 0.0)
        } else {
            let peak = libm::fmax(acceleration_m_s2, along);
            (peak, libm::fmax(0.0, (gain - (peak * peak - 0.5 * along * along) / jerk_m_s3) / peak))
        };
        let first_s = (peak - along) / jerk_m_s3;
        let last_s = peak / jerk_m_s3;
        let jerk = sense * jerk_m_s3;
        let held = sense * peak;
        let first_way = first_s * (v0 + first_s * (0.5 * a0 + first_s * jerk * (1.0 / 6.0)));
        let first_speed = v0 + first_s * (a0 + 0.5 * first_s * jerk);
        let held_way = hold_s * (first_speed + 0.5 * hold_s * held);
        let last_way = last_s * (end_speed_m_s - jerk * last_s * last_s * (1.0 / 6.0));
        Self {
            start_m: start.position_m,
            start_speed_m_s: v0,
            start_acceleration_m_s2: a0,
            end_speed_m_s,
            jerk_m_s3: jerk,
            held_m_s2: held,
            first_s,
            held_s: first_s + hold_s,
            end_s: first_s + hold_s + last_s,
            first_speed_m_s: first_speed,
            first_way_m: first_way,
            end_way_m: first_way + held_way + last_way,
        }
    }

    /// How long the speed changes, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.end_s
    }

    /// Where the change is over, m: where a stop ends.
    #[must_use]
    pub fn end_m(&self) -> f64 {
        self.start_m + self.end_way_m
    }

    /// State at `time_s` ≥ 0; after the change the speed stays as it is.
    #[must_use]
    pub fn sample(&self, time_s: f64) -> State {
        let t = time_s;
        let (way, speed, acceleration) = if t < self.first_s {
            let (v, a, j) = (self.start_speed_m_s, self.start_acceleration_m_s2, self.jerk_m_s3);
            (t * (v + t * (0.5 * a + t * j * (1.0 / 6.0))), v + t * (a + 0.5 * t * j), a + t * j)
        } else if t < self.held_s {
            let t = t - self.first_s;
            let (v, a) = (self.first_speed_m_s, self.held_m_s2);
            (self.first_way_m + t * (v + 0.5 * t * a), v + t * a, a)
        } else if t < self.end_s {
            let left = t - self.end_s; // ≤ 0: counted from the end
            let a = -(self.jerk_m_s3 * left);
            let v = self.end_speed_m_s;
            (self.end_way_m + left * (v + a * left * (1.0 / 6.0)), v + 0.5 * a * left, a)
        } else if self.end_speed_m_s == 0.0 {
            (self.end_way_m, 0.0, 0.0)
        } else {
            (self.end_way_m + self.end_speed_m_s * (t - self.end_s), self.end_speed_m_s, 0.0)
        };
        State { position_m: self.start_m + way, speed_m_s: speed, acceleration_m_s2: acceleration }
    }
}
