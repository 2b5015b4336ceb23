//! The logs of a student's glass tank: 24 runs of a carriage with a sphere of 100 mm, listed in `runs.csv`. Encoder counts of 0.1 mm, volts, times in ms;
//! no reference, no force sensor. Friction varies along the rail, and changes from run to run.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

pub const C_D: f64 = 0.45;
const DENSITY_KG_M3: f64 = 998.0;
const DIAMETER_M: f64 = 0.1;
const NEWTONS_PER_VOLT: f64 = 4.77;
const COUNT_M: f64 = 1e-4;
const STEP_S: f64 = 0.005;

/// What differs from the student's tank.
#[derive(Debug, Clone, Copy)]
pub struct Tank {
    pub seed: u64,
    /// Wet runs are slower than dry ones by this part: a drive without a loop.
    pub wet_slower: f64,
    /// Wet runs begin so much further along the rail, m.
    pub wet_starts_m: f64,
    /// Times that each setting is driven.
    pub repeats: u32,
    /// Standard deviation of the friction from run to run, V.
    pub run_to_run_v: f64,
    /// Errors of the declared force per volt and of the count, as parts.
    pub wrong: [f64; 2],
    /// Whether each run has one command, that of its listed speed, over 6 m of a rail with the same friction everywhere.
    pub is_open_loop: bool,
}

impl Default for Tank {
    fn default() -> Self {
        Self {
            seed: 14,
            wet_slower: 0.0,
            wet_starts_m: 0.0,
            repeats: 1,
            run_to_run_v: 0.004,
            wrong: [0.0; 2],
            is_open_loop: false,
        }
    }
}

/// Standard normal numbers (SplitMix64, Box and Muller).
pub fn normal(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    move || (-2.0 * (1.0 - uniform()).ln()).sqrt() * (2.0 * PI * uniform()).cos()
}

impl Tank {
    /// Writes `runs.csv` and the folder `logs`.
    pub fn write(&self, folder: &Path) {
        std::fs::create_dir_all(folder.join("logs")).unwrap();
        let mut normal = normal(self.seed);
        let head = if self.repeats > 1 { ",repeat" } else { "" };
        let (mut list, mut number) = (format!("file,state,speed [m/s],direction{head}\n"), 0);
        for repeat in 1..=self.repeats {
            for speed in [0.1, 0.2, 0.3, 0.4, 0.5, 0.6] {
                for (direction, sign) in [("out", 1.0), ("back", -1.0)] {
                    for state in ["dry", "wet"] {
                        number += 1;
                        let name = format!("run_{number:02}.csv");
                        let text = self.log(speed * sign, state == "wet", &mut normal);
                        std::fs::write(folder.join("logs").join(&name), text).unwrap();
                        let tail = if self.repeats > 1 { format!(",{repeat}") } else { String::new() };
                        writeln!(list, "{name},{state},{speed},{direction}{tail}").unwrap();
                    }
                }
            }
        }
        std::fs::write(folder.join("runs.csv"), list).unwrap();
    }

    fn log(&self, listed: f64, is_wet: bool, normal: &mut impl FnMut() -> f64) -> String {
        let velocity = if is_wet { listed * (1.0 - self.wet_slower) } else { listed };
        let area_m2 = PI * DIAMETER_M.powi(2) / 4.0;
        let added_kg = 0.5 * DENSITY_KG_M3 * PI * DIAMETER_M.powi(3) / 6.0 + 0.3;
        let mass_kg = if is_wet { 6.0 + added_kg } else { 6.0 };
        let end_s = 2.6 + if self.is_open_loop { 4.8 } else { 1.2 } / listed.abs();
        let of_run_v = self.run_to_run_v * normal();
        let ramp = |t: f64| ((t - 0.6) / 0.5).clamp(0.0, 1.0) * ((end_s - t - 0.6) / 0.5).clamp(0.0, 1.0);
        let mut x = (if listed > 0.0 { 0.1 } else { 1.6 }) + if is_wet { self.wet_starts_m } else { 0.0 };
        let mut text = "t [ms],enc,u [V]\n".to_owned();
        let drag_kg_m = if is_wet { 0.5 * DENSITY_KG_M3 * C_D * area_m2 } else { 0.0 };
        let (newtons_per_volt, count_m) = (NEWTONS_PER_VOLT * (1.0 + self.wrong[0]), COUNT_M * (1.0 + self.wrong[1]));
        let mut own_m_s = 0.0;
        for i in 0..(end_s / STEP_S) as u32 {
            let t = STEP_S * f64::from(i);
            let resists = |v: f64, bump_n: f64| {
                let sign = if v == 0.0 { 0.0 } else { v.signum() };
                sign * (2.4 + bump_n) + 1.9 * v + drag_kg_m * v * v.abs()
            };
            let (v, force_n) = if self.is_open_loop {
                let force_n = if (0.6..end_s - 0.6).contains(&t) { resists(velocity, 0.0) } else { 0.0 };
                let next_m_s = own_m_s + STEP_S * (force_n - resists(own_m_s, 0.0)) / mass_kg;
                own_m_s = if force_n == 0.0 && next_m_s * own_m_s <= 0.0 { 0.0 } else { next_m_s };
                (own_m_s, force_n)
            } else {
                let v = velocity * ramp(t);
                let acceleration = velocity * (ramp(t + STEP_S) - ramp(t - STEP_S)) / (2.0 * STEP_S);
                (v, mass_kg * acceleration + resists(v, 0.25 * (4.0 * (x + STEP_S * v)).sin()))
            };
            x += STEP_S * v;
            let is_driven = f64::from(u8::from(v != 0.0));
            let volts = force_n / newtons_per_volt + is_driven * of_run_v + 0.02 * normal();
            writeln!(text, "{:.0},{:.0},{volts:.3}", 1e3 * t, x / count_m).unwrap();
        }
        text
    }
}
