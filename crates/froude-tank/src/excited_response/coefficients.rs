//! A33 and B33 at each period of the wave, with their budget.
//!
//! X = F/z of the mean responses of the held and of the free runs, each per motion of its wavemaker: the strokes need not be equal, within what is linear. With d the delay
//! of the force behind the motion, X = e^{iωd} F/z. A relative variance v of F/z, equal in both components and independent between them, gives u(A33) = |X| √v/ω² and
//! u(B33) = |X| √v/ω, uncorrelated; what is declared makes A33 and B33 err together:
//!
//! | error                    | on A33     | on B33        |
//! |--------------------------|------------|---------------|
//! | mass                     | −1         | 0             |
//! | C33                      | 1/ω²       | 0             |
//! | gain of the force        | −Re X/ω²   | Im X/ω        |
//! | gain of the motion       | Re X/ω²    | −Im X/ω       |
//! | delay                    | Im X/ω     | Re X          |
//!
//! Runs that are repeated show their own scatter: the variance of a mean is the larger of what the lines beside the wave's give and what the runs give.
//!
//! **Source.** Newman (1977), *Marine Hydrodynamics*, 6.17; JCGM 100:2008 (GUM), 5.1.

use faer::{Mat, c64};
use froude_fit::budget::{Combined, Kind, OUTSIDE_95, Part, combine};

use super::response::{DOF, Response, response};
use super::setup::{Setup, Shows, WaveRun};
use super::wave::{ALIKE, Wave, turn};
use super::window::window;
use crate::error::TankError;
use crate::joint::{DeclaredError, part};

/// Names of the two.
pub const NAMES: [&str; 2] = ["A33", "B33"];
/// Their units.
pub const UNITS: [&str; 2] = ["kg", "N*s/m"];
/// Strokes may differ by this part: force and motion are then scaled to one wave.
pub const MOST_OTHER: f64 = 0.25;

/// A run as it was used.
#[derive(Debug, Clone, PartialEq)]
pub struct Used {
    /// Which run.
    pub run: usize,
    /// Its wavemaker.
    pub wave: Wave,
    /// Its signal against that.
    pub response: Response,
}

/// What the runs of one wave give.
#[derive(Debug, Clone, PartialEq)]
pub struct AtPeriod {
    /// Period as it is declared, else as it is found, s.
    pub period_s: f64,
    /// ω, mean of the runs, rad/s.
    pub omega_rad_s: f64,
    /// From and to, s after the wavemaker's start.
    pub window_s: [f64; 2],
    /// Whether somebody declared that window: without it B33 is not determined.
    pub is_declared: bool,
    /// Held runs.
    pub held: Vec<Used>,
    /// Free runs.
    pub free: Vec<Used>,
    /// A33 (kg) and B33 (N s/m).
    pub values: [f64; 2],
    /// The same from the first and from the last half of the cycles.
    pub halves: [[f64; 2]; 2],
    /// Errors that are declared.
    pub errors: Vec<DeclaredError>,
    /// The budget: scatter of held and free runs, and what is declared.
    pub parts: Vec<Part>,
    /// Standard uncertainties and intervals of the two.
    pub combined: [Combined; 2],
}

impl AtPeriod {
    /// All runs that were used.
    pub fn used(&self) -> impl Iterator<Item = &Used> {
        self.held.iter().chain(&self.free)
    }

    /// Correlation of A33 and B33, −1 to 1; 0 where nothing errs.
    #[must_use]
    pub fn correlation(&self) -> f64 {
        let sum = |i: usize, j: usize| self.parts.iter().map(|p| p.covariance[(i, j)]).sum::<f64>();
        let size = (sum(0, 0) * sum(1, 1)).sqrt();
        if size > 0.0 { sum(0, 1) / size } else { 0.0 }
    }

    /// Stroke of each free run over that of each held one, the furthest from one.
    #[must_use]
    pub fn stroke_ratio(&self) -> f64 {
        let ratios = self.free.iter().flat_map(|f| self.held.iter().map(move |h| f.wave.amplitude / h.wave.amplitude));
        ratios.max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs())).unwrap_or(1.0)
    }
}

/// Fits all runs, wave by wave; held runs without a free one of their wave are not used.
///
/// # Errors
///
/// No run with the free body or with the held one, runs of different waves or motions, a window that cannot be used, a fit that fails.
pub fn fit(runs: &[WaveRun<'_>], setup: &Setup) -> Result<Vec<AtPeriod>, TankError> {
    if runs.iter().all(WaveRun::is_held) {
        return Err(TankError::new(
            "no run with the free body was given (role \"free\"); its motion and the force of a run with the held body give the coefficients",
        ));
    }
    let waves = runs.iter().map(Wave::of).collect::<Result<Vec<_>, _>>()?;
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (i, wave) in waves.iter().enumerate() {
        let is_alike = |group: &&mut Vec<usize>| (waves[group[0]].omega_rad_s / wave.omega_rad_s - 1.0).abs() <= ALIKE;
        match groups.iter_mut().find(is_alike) {
            Some(group) => group.push(i),
            None => groups.push(vec![i]),
        }
    }
    groups.retain(|group| group.iter().any(|&i| !runs[i].is_held()));
    groups.sort_by(|a, b| waves[a[0]].omega_rad_s.total_cmp(&waves[b[0]].omega_rad_s));
    groups.iter().map(|group| at_period(runs, &waves, group, setup)).collect()
}

fn at_period(runs: &[WaveRun<'_>], waves: &[Wave], group: &[usize], setup: &Setup) -> Result<AtPeriod, TankError> {
    let (held, free): (Vec<usize>, Vec<usize>) = group.iter().partition(|&&i| runs[i].is_held());
    if held.is_empty() {
        return Err(no_held(runs, waves, free[0]));
    }
    let shows = runs[free[0]].shows;
    for &f in &free {
        if runs[f].shows != shows {
            return Err(TankError::new(format!(
                "run {:?} shows the {} of the body, and run {:?}, of the same wave, its {}; the two have gains of their own; give each a [[source]]",
                runs[f].id,
                runs[f].shows.name(),
                runs[free[0]].id,
                shows.name()
            )));
        }
        for &h in &held {
            let (free_m, held_m) = (waves[f].amplitude, waves[h].amplitude);
            if (free_m / held_m - 1.0).abs() > MOST_OTHER {
                return Err(TankError::new(format!(
                    "the wavemaker moves by {:.3} mm in run {:?} and by {:.3} mm in run {:?}, a ratio of {:.2}; force and motion can be scaled to one wave within {:.0} %, beyond that the response is not \
                     known to be linear: repeat one of them",
                    1e3 * free_m,
                    runs[f].id,
                    1e3 * held_m,
                    runs[h].id,
                    free_m / held_m,
                    1e2 * MOST_OTHER
                )));
            }
        }
    }
    let window_s = match setup.window_s {
        Some(declared) => declared,
        None => {
            let all: Vec<(&WaveRun<'_>, &Wave)> = group.iter().map(|&i| (&runs[i], &waves[i])).collect();
            window(&all, setup.harmonics)?
        }
    };
    let used = |indices: &[usize]| -> Result<Vec<Used>, TankError> {
        let one = |&run: &usize| {
            let response = response(&runs[run], &waves[run], window_s, setup.harmonics)?;
            Ok(Used { run, wave: waves[run], response })
        };
        indices.iter().map(one).collect()
    };
    let omega_rad_s = group.iter().map(|&i| waves[i].omega_rad_s).sum::<f64>() / group.len() as f64;
    let period_s = group.iter().find_map(|&i| runs[i].period_s).unwrap_or(std::f64::consts::TAU / omega_rad_s);
    let (held, free) = (used(&held)?, used(&free)?);
    let ratio = |force: c64, motion: c64| {
        let position = if shows == Shows::Acceleration { -motion / omega_rad_s.powi(2) } else { motion };
        force / position * turn(omega_rad_s * setup.delay_s.value)
    };
    let values = |x: c64| coefficients(x, omega_rad_s, setup);
    let [force, motion] = [&held, &free].map(|runs| Mean::of(runs));
    let x = ratio(force.transfer, motion.transfer);
    let half = |k: usize| {
        let mean = |runs: &[Used]| runs.iter().map(|u| u.response.halves[k]).sum::<c64>() / runs.len() as f64;
        values(ratio(mean(&held), mean(&free)))
    };
    let errors = errors(x, omega_rad_s, setup, shows);
    let of = |is_held: bool, mean: &Mean| {
        scatter(is_held, mean.variance / mean.transfer.norm_sqr(), x, omega_rad_s, mean.dof)
    };
    let parts = budget([of(true, &force), of(false, &motion)], &errors);
    Ok(AtPeriod {
        period_s,
        omega_rad_s,
        window_s,
        is_declared: setup.window_s.is_some(),
        values: values(x),
        halves: [half(0), half(1)],
        errors,
        combined: [0, 1].map(|j| combine(&parts, j, OUTSIDE_95)),
        parts,
        held,
        free,
    })
}

fn no_held(runs: &[WaveRun<'_>], waves: &[Wave], free: usize) -> TankError {
    let held = || runs.iter().zip(waves).filter(|(run, _)| run.is_held());
    let each: Vec<String> = held().map(|(run, wave)| format!("{:?} of {:.3} s", run.id, wave.period_s())).collect();
    let there =
        if each.is_empty() { "there is none at all".to_owned() } else { format!("there are {}", each.join(", ")) };
    let what = format!(
        "no run with the held body (role \"held\") has its wave of {:.3} s; {there}: add the run in which the body is held in this wave, or leave this one out",
        waves[free].period_s()
    );
    TankError::of_run(runs[free].id, what)
}

/// A33 and B33 of X.
fn coefficients(x: c64, omega_rad_s: f64, setup: &Setup) -> [f64; 2] {
    let added = (setup.restoring_n_m.value - x.re) / (omega_rad_s * omega_rad_s) - setup.mass_kg.value;
    [added, x.im / omega_rad_s]
}

/// What is declared, as the table above.
#[must_use]
pub fn errors(x: c64, omega_rad_s: f64, setup: &Setup, shows: Shows) -> Vec<DeclaredError> {
    let w = omega_rad_s;
    let gain = [-x.re / (w * w), x.im / w];
    let (motion, of_motion) = match shows {
        Shows::Position => ("gain of the position", setup.position_relative),
        _ => ("gain of the acceleration", setup.acceleration_relative),
    };
    let one = |name: &str, standard, dof, by: [f64; 2]| DeclaredError {
        name: name.to_owned(),
        standard,
        dof,
        value: None,
        sensitivity: by.to_vec(),
    };
    let infinite = f64::INFINITY;
    [
        one("mass", setup.mass_kg.standard, setup.mass_kg.dof, [-1.0, 0.0]),
        one("restoring coefficient C33", setup.restoring_n_m.standard, setup.restoring_n_m.dof, [1.0 / (w * w), 0.0]),
        one("gain of the force", setup.force_relative, infinite, gain),
        one(motion, of_motion, infinite, gain.map(|g| -g)),
        one("delay of the force", setup.delay_s.standard, setup.delay_s.dof, [x.im / w, x.re]),
    ]
    .into_iter()
    .filter(|e| e.standard > 0.0)
    .collect()
}

/// The share of held or free runs, whose relative variance is `relative` in each component.
#[must_use]
pub fn scatter(is_held: bool, relative: f64, x: c64, omega_rad_s: f64, dof: f64) -> Part {
    let name = if is_held { "scatter of the force, body held" } else { "scatter of the motion, body free" };
    let size = relative * x.norm_sqr() / omega_rad_s.powi(2);
    let variances = [size / omega_rad_s.powi(2), size];
    let covariance = Mat::from_fn(2, 2, |i, j| if i == j { variances[i] } else { 0.0 });
    Part { shared: "run", ..part(name, Kind::A, covariance, dof) }
}

/// The budget: scatter of held and of free runs, and what is declared.
#[must_use]
pub fn budget(scatter: [Part; 2], errors: &[DeclaredError]) -> Vec<Part> {
    scatter.into_iter().chain(errors.iter().map(DeclaredError::part)).collect()
}

/// Mean response of some runs, with the variance of each of its components.
struct Mean {
    transfer: c64,
    variance: f64,
    dof: f64,
}

impl Mean {
    fn of(runs: &[Used]) -> Self {
        let n = runs.len() as f64;
        let transfer = runs.iter().map(|u| u.response.transfer).sum::<c64>() / n;
        let within = runs.iter().map(|u| u.response.variance).sum::<f64>() / (n * n);
        let spread = runs.iter().map(|u| (u.response.transfer - transfer).norm_sqr()).sum::<f64>();
        let dof = 2.0 * (n - 1.0);
        let between = if dof > 0.0 { spread / (dof * n) } else { 0.0 };
        if between > within {
            Self { transfer, variance: between, dof }
        } else {
            Self { transfer, variance: within, dof: DOF * n }
        }
    }
}
