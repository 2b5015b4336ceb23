//! Runs to rows with everything that is declared: the mass below the cell, the delay of the force, and what their errors do.
//!
//! With the force f_m of the rig on the body, the load of the water is f = m a − f_m. An error of a declared number goes into the load of every row:
//!
//! | error of              | moves the load by                                   |
//! |-----------------------|-----------------------------------------------------|
//! | mass, 1 kg            | a                                                   |
//! | delay, 1 s            | −ḟ_m                                                |
//! | gain of the force     | −f_m; of a mass weighed by the same cell m a − f_m  |
//! | gain of the motion    | m a + μ a + D_I v + 2 D_II v|v|; without m a where the mass is weighed |
//! | zero of a run, 1 N    | 1, in that run                                      |
//!
//! **Units.** SI. **Source.** JCGM 100:2008 (GUM), 5.2.

use froude_fit::faer::Mat;
use froude_fit::propagate::effective_dof;
use froude_fit::serial::{RowErrors, serial};
use froude_fit::{FEWEST_CLUSTERS, Options, Problem, fit};
use froude_identify::dataset::{Dataset, GroupedBy};
use froude_identify::uncertainty::SharedError;
use froude_records::run::Declared;

use super::law::{Channels, data, names};
use super::rows::{Rows, TowRun, row_errors, rows};
use super::setup::Setup;
use crate::between_runs::{BetweenRuns, between_runs};
use crate::error::TankError;

/// A run with what is mounted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mounted<'a> {
    /// The log.
    pub run: TowRun<'a>,
    /// Which body of the setup.
    pub body: usize,
    /// Whether it is done in air.
    pub is_dry: bool,
}

/// A mass as it is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mass {
    /// kg.
    pub value_kg: f64,
    /// Standard uncertainty, kg.
    pub standard_kg: f64,
    /// Degrees of freedom of that.
    pub dof: f64,
    /// Whether runs in air show it.
    pub is_weighed: bool,
}

/// The rows of all runs.
#[derive(Debug, Clone)]
pub struct Reduced {
    /// The wet runs, each with its rows.
    pub runs: Vec<(String, usize, Rows)>,
    /// Masses by body.
    pub masses: Vec<Mass>,
    /// μ by body as a plain fit has it, kg.
    pub added_kg: Vec<f64>,
    /// The rows as a data set.
    pub data: Dataset,
    /// What declared errors do to them.
    pub errors: Vec<SharedError>,
    /// Runs that give no rows.
    pub left_out: Vec<TankError>,
    /// Whether whole runs tell the scatter.
    pub is_by_run: bool,
    /// How the errors of the rows come about, where they tell it.
    pub of_rows: RowErrors,
}

/// Reduces all runs; one that gives no rows is left out. `None` where a body has neither a mass nor a run in air.
#[must_use]
pub fn reduce(mounted: &[Mounted<'_>], setup: &Setup) -> Option<Reduced> {
    let (mut wet, mut dry, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    for m in mounted {
        match rows(&m.run, setup.window_s, setup.delay_s.value) {
            Ok(found) if m.is_dry => dry.push((m.body, found)),
            Ok(found) => wet.push((m.run.id.to_owned(), m.body, found)),
            Err(error) => left_out.push(error),
        }
    }
    let masses = (0..setup.bodies.len()).map(|b| mass(setup.bodies[b].mass_kg, &dry, b)).collect::<Option<Vec<_>>>()?;
    let n_runs = wet.len();
    let mut channels = Channels { density_kg_m3: setup.density_kg_m3, ..Channels::default() };
    let (mut of_run, mut of_body, mut square, mut force, mut slope) = (vec![], vec![], vec![], vec![], vec![]);
    for (r, (id, b, found)) in wet.iter().enumerate() {
        for i in 0..found.middle_s.len() {
            channels.run.push(id.clone());
            channels.configuration.push(setup.bodies[*b].name.clone());
            channels.speed_m_s.push(found.speed_m_s[i]);
            channels.acceleration_m_s2.push(found.acceleration_m_s2[i]);
            channels.load_n.push(masses[*b].value_kg * found.acceleration_m_s2[i] - found.force_n[i]);
            channels.volume_m3.push(setup.bodies[*b].volume_m3);
            of_run.push(r);
            of_body.push(*b);
            square.push(found.square_m2_s2[i]);
            force.push(found.force_n[i]);
            slope.push(found.force_slope_n_s[i]);
        }
    }
    let n = of_run.len();
    let First { added_kg, linear, quadratic } = first_fit(&channels, &square, &of_body, setup.bodies.len());
    // The law is asked at the weighted speed; what its square lacks of the weighted square is put to the load.
    for i in 0..n {
        let v = channels.speed_m_s[i];
        channels.load_n[i] += quadratic * (square[i] - v * v.abs());
    }
    let load = names(&setup.axis)[0].clone();
    let (v, a) = (channels.speed_m_s.clone(), channels.acceleration_m_s2.clone());
    let mut errors = Vec::new();
    let mut put = |name: &str, direction: Vec<f64>, standard: f64, dof: f64| {
        if standard > 0.0 {
            let mut error = SharedError::of_load(name, &load, &direction, standard, dof);
            name.clone_into(&mut error.quantity);
            errors.push(error);
        }
    };
    for (b, mass) in masses.iter().enumerate() {
        let own: Vec<f64> = (0..n).map(|i| if of_body[i] == b { a[i] } else { 0.0 }).collect();
        let of = &setup.bodies[b].name;
        let of = if of.is_empty() { String::new() } else { format!(" of {of}") };
        let by = if mass.is_weighed { " by runs in air" } else { "" };
        put(&format!("mass{of}{by}"), own, mass.standard_kg, mass.dof);
    }
    put("delay", slope.iter().map(|s| -s).collect(), setup.delay_s.standard_uncertainty, f64::INFINITY);
    // A mass that the same cell and encoder weigh errs with them: m̂ a is then what it is, whatever the gains.
    let weighed = |i: usize| if masses[of_body[i]].is_weighed { masses[of_body[i]].value_kg } else { 0.0 };
    let by_force = (0..n).map(|i| weighed(i) * a[i] - force[i]).collect();
    put("gain of the force", by_force, setup.force_relative, f64::INFINITY);
    let rigid = |i: usize| masses[of_body[i]].value_kg - weighed(i);
    let moved = |i: usize| (rigid(i) + added_kg[of_body[i]]) * a[i] + linear * v[i] + 2.0 * quadratic * square[i];
    put("gain of the motion", (0..n).map(moved).collect(), setup.motion_relative, f64::INFINITY);
    let is_by_run = n_runs >= FEWEST_CLUSTERS;
    if !is_by_run && n > 0 {
        errors.push(zeros(&load, &of_run, &wet));
    }
    let between = (!is_by_run).then(|| of_runs(&channels, &square, (&of_run, &of_body), &load));
    errors.extend(between.flatten());
    let mut data = data(channels, &setup.axis);
    data.group = is_by_run.then(|| data.run.clone());
    data.grouped_by = GroupedBy::Run;
    let moved_kg: Vec<f64> = (0..masses.len()).map(|b| masses[b].value_kg + added_kg[b]).collect();
    let of_rows = by_motion(wet.iter().map(|(_, b, rows)| (moved_kg[*b], rows)));
    Some(Reduced { runs: wet, masses, added_kg, data, errors, left_out, is_by_run, of_rows })
}

/// The errors of rows of runs that move so much mass, kg.
fn by_motion<'a>(runs: impl Iterator<Item = (f64, &'a Rows)>) -> RowErrors {
    let (mut squares, mut n, mut is_position) = (0.0, 0.0, true);
    for (moved_kg, rows) in runs {
        squares += rows.middle_s.len() as f64 * (moved_kg * rows.noise_m_s2).powi(2);
        n += rows.middle_s.len() as f64;
        is_position &= rows.is_position;
    }
    row_errors(is_position, if n > 0.0 { (squares / n).sqrt() } else { 0.0 })
}

/// What the zeros of runs in air add to the variance of the mass, Σ a f/Σ a², kg².
fn by_zeros(runs: &[&Rows], squares: f64) -> f64 {
    let of_part = |rows: &Rows, k: usize| {
        let moves = |(at_s, a): (&f64, &f64)| rows.by_zero(*at_s)[k] * a / squares;
        let moved: f64 = rows.middle_s.iter().zip(&rows.acceleration_m_s2).map(moves).sum();
        (moved * rows.zero_parts[k][1]).powi(2)
    };
    runs.iter().flat_map(|rows| (0..rows.zero_parts.len()).map(move |k| of_part(rows, k))).sum()
}

/// What changes from run to run, of three or four runs.
fn of_runs(
    channels: &Channels,
    square: &[f64],
    (of_run, of_body): (&[usize], &[usize]),
    load: &str,
) -> Option<SharedError> {
    let bodies = 1 + of_body.iter().max()?;
    let left_of = |y: &[f64]| {
        let problem = of_first(channels, square, of_body, bodies, y.to_vec());
        Some(fit(&problem, &Options::default()).ok()?.residuals)
    };
    let left = left_of(&channels.load_n)?;
    let n_runs = 1 + of_run.iter().max()?;
    let part = |r: usize| -> Vec<f64> {
        let fitted = |i: usize| channels.load_n[i] - left[i];
        (0..left.len()).map(|i| if of_run[i] == r { fitted(i) } else { 0.0 }).collect()
    };
    let parts: Vec<Vec<f64>> = (0..n_runs).map(part).collect();
    let BetweenRuns { variance, dof } = between_runs(&parts, &left, left_of)?;
    Some(SharedError {
        shared: "run",
        directions: vec![(load.to_owned(), (0..left.len()).map(|i| parts.iter().map(|c| c[i]).collect()).collect())],
        covariance: diagonal(&vec![variance; n_runs]),
        ..SharedError::of_load("what changes from run to run", load, &[], 0.0, dof)
    })
}

/// The zeros of few runs: an error of each part at rest, on the line between both. Of five and more runs they are in the scatter of the runs.
fn zeros(load: &str, of_run: &[usize], wet: &[(String, usize, Rows)]) -> SharedError {
    let parts: Vec<(usize, usize, f64)> = (wet.iter().enumerate())
        .flat_map(|(r, (_, _, rows))| {
            rows.zero_parts.iter().enumerate().map(move |(k, [_, standard])| (r, k, *standard))
        })
        .collect();
    let middles: Vec<f64> = wet.iter().flat_map(|(_, _, rows)| rows.middle_s.iter().copied()).collect();
    let row = |(r, at_s): (&usize, &f64)| {
        let by = wet[*r].2.by_zero(*at_s);
        parts.iter().map(|(of, k, _)| if of == r { by[*k] } else { 0.0 }).collect()
    };
    let dof = wet.iter().map(|(_, _, rows)| rows.zero_dof).fold(f64::INFINITY, f64::min);
    SharedError {
        shared: "run",
        directions: vec![(load.to_owned(), of_run.iter().zip(&middles).map(row).collect())],
        covariance: diagonal(&parts.iter().map(|(.., standard)| standard.powi(2)).collect::<Vec<f64>>()),
        ..SharedError::of_load("zeros of the runs", "zero", &[], 0.0, dof)
    }
}

fn diagonal(of: &[f64]) -> Vec<Vec<f64>> {
    (0..of.len()).map(|i| (0..of.len()).map(|j| if i == j { of[i] } else { 0.0 }).collect()).collect()
}

/// What errors move depends on the coefficients, to first order: these of all rows together.
struct First {
    /// μ by body, kg.
    added_kg: Vec<f64>,
    /// D_I, kg/s.
    linear: f64,
    /// D_II, kg/m.
    quadratic: f64,
}

/// The rows of that fit for any response.
fn of_first(channels: &Channels, square: &[f64], of_body: &[usize], bodies: usize, response: Vec<f64>) -> Problem {
    let design = Mat::from_fn(square.len(), bodies + 2, |i, j| match j {
        0 => -channels.speed_m_s[i],
        1 => -square[i],
        _ if of_body[i] == j - 2 => -channels.acceleration_m_s2[i],
        _ => 0.0,
    });
    Problem::single(design, response, (0..bodies + 2).map(|j| format!("c{j}")).collect())
}

/// Plain least squares with a μ of each body and one drag.
fn first_fit(channels: &Channels, square: &[f64], of_body: &[usize], bodies: usize) -> First {
    let found = fit(&of_first(channels, square, of_body, bodies, channels.load_n.clone()), &Options::default());
    let value = |j: usize| found.as_ref().ok().and_then(|f| f.coefficients[j].value).unwrap_or(0.0);
    First { added_kg: (0..bodies).map(|b| value(2 + b)).collect(), linear: value(0), quadratic: value(1) }
}

/// The mass of a body: by its runs in air, f_m = m a, else as it is declared.
fn mass(declared: Option<Declared>, dry: &[(usize, Rows)], body: usize) -> Option<Mass> {
    let own: Vec<&Rows> = dry.iter().filter(|(b, _)| *b == body).map(|(_, rows)| rows).collect();
    let weighed = || {
        let run: Vec<usize> = own.iter().enumerate().flat_map(|(r, rows)| vec![r; rows.middle_s.len()]).collect();
        let a: Vec<f64> = own.iter().flat_map(|rows| rows.acceleration_m_s2.iter().copied()).collect();
        let f: Vec<f64> = own.iter().flat_map(|rows| rows.force_n.iter().copied()).collect();
        let squares: f64 = a.iter().map(|a| a * a).sum();
        let value_kg = a.iter().zip(&f).map(|(a, f)| a * f).sum::<f64>() / squares;
        let residual: Vec<f64> = a.iter().zip(&f).map(|(a, f)| f - value_kg * a).collect();
        let design = Mat::from_fn(a.len(), 1, |i, _| a[i]);
        let sensitivity = Mat::from_fn(1, a.len(), |_, i| a[i] / squares);
        let errors = by_motion(own.iter().map(|rows| (value_kg, *rows)));
        let found = serial(&design, sensitivity.as_ref(), &residual, &run, &errors)?;
        let (scatter, zeros) = (found.covariance[(0, 0)], by_zeros(&own, squares));
        let zero_dof = own.iter().map(|rows| rows.zero_dof).fold(f64::INFINITY, f64::min);
        let dof = effective_dof(&[(scatter, found.dof[0]), (zeros, zero_dof)]);
        Some(Mass { value_kg, standard_kg: (scatter + zeros).sqrt(), dof, is_weighed: true })
    };
    let as_declared = |m: Declared| Mass {
        value_kg: m.value,
        standard_kg: m.standard_uncertainty,
        dof: f64::INFINITY,
        is_weighed: false,
    };
    if own.is_empty() { declared.map(as_declared) } else { weighed().or_else(|| declared.map(as_declared)) }
}
