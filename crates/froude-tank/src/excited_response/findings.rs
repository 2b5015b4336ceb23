//! What is doubtful about runs in waves, with the numbers that support it.

use froude_records::finding::Finding;
use froude_signal::clock::MOST_LEFT_RAD;

use super::camera::camera;
use super::coefficients::{AtPeriod, NAMES, UNITS, Used};
use super::setup::{Setup, WaveRun};
use crate::findings::{note, warning};

/// Strokes that differ by more than this are no repeat of one wave.
const SAME_STROKE: f64 = 0.02;
/// A33 of the two halves of a window may differ by this part of the moving mass with its water, and B33 by this part of itself.
const HALVES: [f64; 2] = [0.02, 0.05];
/// Halves differ by more than chance beyond this many standard uncertainties of their difference.
const BY_CHANCE: f64 = 2.0;
/// A wavemaker that its fundamental leaves more than this part of is not harmonic.
const HARMONIC: f64 = 0.1;
/// A camera's clock that gains or loses less than this is even, s/s.
const EVEN: f64 = 1e-3;
/// A gain this near to one is one.
const SAME_GAIN: f64 = 0.02;

/// All of it.
#[must_use]
pub fn findings(found: &[AtPeriod], runs: &[WaveRun<'_>], setup: &Setup) -> Vec<Finding> {
    let mut out = Vec::new();
    out.extend(as_exact(setup));
    out.extend(not_used(found, runs));
    for at in found {
        out.extend(of_waves(at, runs));
        out.extend(of_values(at, setup));
        out.extend(at.free.iter().filter_map(|used| of_camera(&runs[used.run], used, setup.harmonics)));
    }
    out.push(note("guides-in-damping",
        "B33 is all that takes energy out of the motion: waves, and with them viscosity and the friction of guides, which are not subtracted".to_owned(),
    ));
    out
}

/// What nobody declared an uncertainty of counts as exact.
fn as_exact(setup: &Setup) -> Vec<Finding> {
    let declared = [("mass", setup.mass_kg), ("restoring", setup.restoring_n_m), ("delay", setup.delay_s)];
    let said = |(name, _): (&str, _)| {
        let like = if name == "delay" { "1 ms" } else { "0.5 %" };
        let text = format!(
            "{name} is declared without a standard uncertainty and counts as exact: write {name} = {{ value = …, standard = \"{like}\" }}"
        );
        warning("declared-as-exact", text)
    };
    declared.into_iter().filter(|(_, number)| number.standard == 0.0).map(said).collect()
}

fn not_used(found: &[AtPeriod], runs: &[WaveRun<'_>]) -> Vec<Finding> {
    let is_used = |i: usize| found.iter().flat_map(AtPeriod::used).any(|used| used.run == i);
    let left_out = (0..runs.len()).filter(|&i| !is_used(i));
    let said = |i: usize| {
        warning(
            "run-left-out",
            format!("run {:?}: the body is held, and no run has it free in this wave; it is not used", runs[i].id),
        )
    };
    left_out.map(said).collect()
}

/// Whether the two runs are of one wave.
fn of_waves(at: &AtPeriod, runs: &[WaveRun<'_>]) -> Vec<Finding> {
    let mut out = Vec::new();
    let ratio = at.stroke_ratio();
    if (ratio - 1.0).abs() > SAME_STROKE {
        out.push(warning(
            "wave-differs",
            format!(
                "waves of {:.3} s: the wavemaker's stroke with the body free is {:.3} of that with it held; the force is scaled to one wave, which is right as far as it is linear in the wave",
                at.period_s, ratio
            ),
        ));
    }
    for used in at.used().filter(|used| used.wave.residual > HARMONIC) {
        out.push(warning(
            "reference-not-harmonic",
            format!(
                "run {:?}: one harmonic leaves {:.1} % of the wavemaker's amplitude; force and motion are referred to that harmonic alone",
                runs[used.run].id,
                1e2 * used.wave.residual
            ),
        ));
    }
    out
}

/// Whether the window is good for its numbers.
fn of_values(at: &AtPeriod, setup: &Setup) -> Vec<Finding> {
    let mut out = Vec::new();
    let [added, damping] = at.values;
    let scales = [(setup.mass_kg.value + added).abs(), damping.abs()];
    // Each half has twice the variance of the whole: their difference has twice its standard uncertainty.
    let of_difference = |j: usize| 2.0 * at.combined[j].type_a;
    let is_chance = |j: usize, d: f64| d.abs() <= (BY_CHANCE * of_difference(j)).max(HALVES[j] * scales[j]);
    let differ = |j: usize| !is_chance(j, at.halves[1][j] - at.halves[0][j]);
    let stated = if at.is_declared { 2 } else { 1 };
    for j in (0..stated).filter(|&j| differ(j)) {
        out.push(warning(
            "window-not-steady",
            format!(
                "waves of {:.3} s: {} is {:.1} {unit} from the first half of the window and {:.1} {unit} from the last (the difference has a standard uncertainty of {:.1} {unit}): the start has not decayed, or reflections are \
                 back; move the window, which is from {:.1} s to {:.1} s after the wavemaker's start",
                at.period_s,
                NAMES[j],
                at.halves[0][j],
                at.halves[1][j],
                of_difference(j),
                at.window_s[0],
                at.window_s[1],
                unit = UNITS[j]
            ),
        ));
    }
    if !at.is_declared {
        out.push(warning(
            "window-not-declared",
            format!(
                "waves of {:.3} s: B33 only with the declared window before reflections: it follows the window, and nothing in the runs says when the reflected wave is back; A33 is taken from {:.1} s to \
                 {:.1} s after the wavemaker's start. Declare window = {{ from = \"…\", to = \"…\" }} in [source.excited_response]",
                at.period_s, at.window_s[0], at.window_s[1]
            ),
        ));
    }
    if damping < -2.0 * at.combined[1].standard {
        out.push(warning(
            "negative-damping",
            format!(
                "waves of {:.3} s: B33 is {damping:.1} N s/m: a body does not gain energy from waves that it makes; look at the signs of force and motion, at delay, and at the clocks of the channels",
                at.period_s
            ),
        ));
    }
    if added < -2.0 * at.combined[0].standard {
        out.push(warning(
            "negative-added-mass",
            format!(
                "waves of {:.3} s: A33 is {added:.1} kg: look at the signs of force and motion, at mass and restoring",
                at.period_s
            ),
        ));
    }
    out
}

/// The camera of a free run.
fn of_camera(run: &WaveRun<'_>, used: &Used, harmonics: usize) -> Option<Finding> {
    let found = match camera(run, used, harmonics)? {
        Ok(found) => found,
        Err(error) => {
            let text = format!("the camera cannot be set beside the accelerometers: {error}");
            return Some(warning("camera-not-compared", text));
        }
    };
    let numbers = format!(
        "skew {:+.1} ms/s (± {:.1}), lead {:+.0} ms in the middle, gain {:.2}, {:.0}° of phase left",
        1e3 * found.skew,
        2e3 * found.standard[1],
        1e3 * found.offset_s,
        found.gain,
        found.left_rad.to_degrees()
    );
    if !found.is_linear() {
        let text = format!(
            "run {:?}: the camera's heave is not alignable by offset and skew with the accelerometers ({numbers}; at most {:.0}°): do not use it as the motion",
            run.id,
            MOST_LEFT_RAD.to_degrees()
        );
        return Some(warning("camera-not-alignable", text));
    }
    let is_even = found.skew.abs() < EVEN && (found.gain - 1.0).abs() < SAME_GAIN;
    (!is_even).then(|| {
        let text = format!(
            "run {:?}: the camera's heave runs on another clock than the accelerometers: {numbers}; reported and not repaired, the coefficients come from the accelerometers",
            run.id
        );
        warning("camera-clock", text)
    })
}
