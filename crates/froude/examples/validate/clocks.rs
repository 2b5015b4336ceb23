//! Clocks of real channels: the camera of the NTNU section against its accelerometers, whose authors state that they can be out of phase.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use froude_signal::clock::{Alignment, align};

use crate::claims::{Claims, Verdict};

const SECTION: &str = "Clocks: camera against accelerometers, a section in waves (NTNU)";
/// Periods of a window.
const PERIODS: usize = 4;
/// The motion is taken from so long after the wavemaker's start, s.
const AFTER_S: f64 = 8.0;

/// File, period, and where it can be aligned: skew in ms/s and the range of the gain, by the preparer of the data.
const RUNS: [(&str, f64, Option<(f64, [f64; 2])>); 4] = [
    ("sway_clamped_6041_1", 1.210, Some((-7.3, [0.85, 0.88]))),
    ("sway_clamped_6041_2", 1.210, Some((-6.6, [0.85, 0.88]))),
    ("sway_clamped_6081_1", 1.074, Some((8.5, [0.85, 0.88]))),
    ("sway_clamped_6111_1", 0.802, None),
];

pub fn all(claims: &mut Claims, shared: &Path) -> Result<(), Box<dyn Error>> {
    for (name, period_s, expected) in RUNS {
        let path = shared.join("ntnu-2d-section").join(format!("{name}.csv"));
        let claim = format!("{name}, waves of {period_s} s");
        let Ok(text) = std::fs::read_to_string(&path) else {
            claims.add(SECTION, &claim, "", format!("{} is not there", path.display()), Verdict::Skipped);
            continue;
        };
        let found = aligned(&text, period_s)?;
        let words = format!(
            "skew {:+.1} ms/s (± {:.1}), gain {:.2}, left {:.0} ms ({:.0}°): {}",
            1e3 * found.skew,
            2e3 * found.standard[1],
            found.gain,
            1e3 * found.left_s,
            found.left_rad.to_degrees(),
            if found.is_linear() { "offset and skew" } else { "not alignable by offset and skew" }
        );
        let (bar, holds) = match expected {
            Some((skew, [low, high])) => (
                format!("skew {skew:+.1} ± 1.5 ms/s, gain 0.86 to 0.87"),
                (1e3 * found.skew - skew).abs() <= 1.5 && (low..=high).contains(&found.gain) && found.is_linear(),
            ),
            None => ("not alignable by offset and skew".to_owned(), !found.is_linear()),
        };
        claims.holds(SECTION, &claim, &bar, words, holds);
    }
    Ok(())
}

/// The camera's heave against the mean of the two heave accelerometers, taken for a position by −1/ω².
fn aligned(text: &str, period_s: f64) -> Result<Alignment, Box<dyn Error>> {
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let place = |name: &str| head.iter().position(|h| *h == name).ok_or_else(|| format!("no column {name}"));
    let [t, wave, camera, one, other] = [
        place("t_s")?,
        place("wavemaker_m")?,
        place("heave_m")?,
        place("acc_heave_sb_mps2")?,
        place("acc_heave_ps_mps2")?,
    ];
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|x| x.parse().unwrap_or(f64::NAN)).collect()).collect();
    let largest = rows.iter().map(|r| r[wave].abs()).fold(0.0, f64::max);
    let began = rows.iter().find(|r| r[wave].abs() > 0.3 * largest).map_or(0.0, |r| r[t]);
    let used: Vec<&Vec<f64>> = rows.iter().filter(|r| r[t] >= began + AFTER_S).collect();
    let omega = TAU / period_s;
    let of = |value: &dyn Fn(&Vec<f64>) -> f64| used.iter().map(|r| value(r)).collect::<Vec<f64>>();
    let heave = of(&|r| -0.5 * (r[one] + r[other]) / (omega * omega));
    Ok(align(&of(&|r| r[t]), &heave, &of(&|r| r[camera]), omega, PERIODS)?)
}
