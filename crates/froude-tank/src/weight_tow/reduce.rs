//! The observation of a run, at the speed that it has in its window: by the balance where the moving mass is declared, by the cell where it is not.
//!
//! Along the rail, e = (cos θ, −sin θ) in the body's axes, the drag is that of the balance, D = F − m v̇; what the cell shows across the rail, L, is taken as
//! it is: f = −D e + L e_⊥. The cell's own force along the rail has the inertia of body and water in it, 3 kg at a change of speed of 2 % over 0.2 m
//! and 0.1 m/s some 3 mN, and is used only where no mass is declared and the run is shown to be steady.

use froude_records::run::Declared;
use froude_rig::weight_tow::G_M_S2;

use super::balance::{Balance, Pull, balance, no_terminal};
use super::keys::WeightTow;
use super::track::{Track, metres, track};
use crate::conditioning::stretches::{in_words, touching};
use crate::error::TankError;
use crate::observed::spec::{Moves, Run};
use crate::steady::point::{Load, Point, Run as Parts, observed};
use crate::steady::section::SteadySpec;
use crate::steady::window::{Motion, Window};

/// What a run tells beside its observation.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Position along the rail, m.
    pub position_m: Vec<f64>,
    /// Its track.
    pub track: Track,
    /// Its balance; `None` where no moving mass is declared.
    pub balance: Option<Balance>,
    /// Its drag along the rail, N, by the balance; what pulls where it is steady.
    pub drag_n: f64,
    /// Standard uncertainty of its drag along the rail by the acceleration, N.
    pub drag_standard_n: f64,
    /// What the errors of [`ERRORS`] move.
    pub moves: [Moves; 4],
}

impl Found {
    /// Its speed as part of the terminal one; `None` where it is steady.
    #[must_use]
    pub fn reached(&self) -> Option<f64> {
        self.balance.map(|b| self.track.speed_m_s / b.terminal_m_s)
    }
}

fn unmoved(loads: &[Load]) -> Moves {
    Moves { speed_m_s: 0.0, loads_n: vec![0.0; loads.len()] }
}

/// What is declared, moved by a standard uncertainty to see what that does.
#[derive(Debug, Clone, Copy, Default)]
struct Moved {
    scale: f64,
    mass_kg: f64,
    friction_n: f64,
    share: f64,
    near: Option<[f64; 4]>,
}

/// Names of the errors that all runs share.
pub const ERRORS: [&str; 4] =
    ["scale of the picture", "moving mass", "friction of the rig", "law of the drag in the balance"];

/// Positions of the wagon, m: of its mark by scale and lens, or as they stand.
fn position_m(run: &Run<'_>, rig: &WeightTow) -> Vec<f64> {
    match run.channel("mark") {
        [] => [run.channel("y/position"), run.channel("position")].concat(),
        mark => metres(mark, rig.pixel_m(), rig.lens),
    }
}

/// A run as the balance takes it.
struct Pulled<'a> {
    id: &'a str,
    angle_rad: f64,
    weight_n: f64,
    time_s: &'a [f64],
    position_m: &'a [f64],
}

/// Reduces a run.
///
/// # Errors
///
/// [`TankError`]: no motion, neither steady nor to be balanced, loads that give none, marks in what is used.
pub fn reduce(run: &Run<'_>, rig: &WeightTow) -> Result<(Point, Found), TankError> {
    let (point, found) = observed_by(run, rig)?;
    let (used, what) = if found.balance.is_some() {
        (&found.track.moving, "what moves, which the equation of motion is fitted to")
    } else {
        (&found.track.window, "the last part of its way")
    };
    let marks = touching(run.time_s, used, run.told.marks);
    if marks.is_empty() {
        return Ok((point, found));
    }
    let marks = in_words(&marks);
    Err(run.refused(format!("{what}, holds {marks}; film it again, or give the camera a view without what was marked")))
}

fn observed_by(logged: &Run<'_>, spec: &WeightTow) -> Result<(Point, Found), TankError> {
    let position_m = position_m(logged, spec);
    let run = &Pulled {
        id: &logged.point.id,
        angle_rad: logged.point.condition("angle"),
        weight_n: logged.point.condition("weight"),
        time_s: logged.time_s,
        position_m: &position_m,
    };
    let mut track = track(run.id, run.time_s, run.position_m, spec.window_m)?;
    if let Some(noise_m) = spec.noise_m {
        track.change[1] = track.change_per_noise * noise_m;
        (track.noise_m, track.standard_m_s) = (noise_m, track.per_noise * noise_m);
    }
    let loads = logged.channels.iter().filter(|(name, _)| name.starts_with("f_")).copied().collect();
    let own = Parts { id: run.id, time_s: run.time_s, motion: Motion::Position(run.position_m), loads, zero: None };
    let window = Window { steady: track.window.clone(), before: track.before.clone(), after: track.after.clone() };
    let mut point = observed(&own, window, &SteadySpec::default())?;
    point.speed_m_s = track.speed_m_s;
    let force_n = run.weight_n - spec.friction_n.value;
    let scale = spec.scale_m.map_or(0.0, |s| s.standard_uncertainty / s.value);
    let [change, standard] = track.change;
    let is_steady = spec.moving_mass_kg.is_none() && change.abs() + 2.0 * standard <= spec.tolerance;
    if is_steady && !point.loads.is_empty() {
        let mut moves: [Moves; 4] = std::array::from_fn(|_| unmoved(&point.loads));
        moves[0].speed_m_s = scale * track.speed_m_s;
        let (drag_n, drag_standard_n) = (force_n, 0.0);
        return Ok((point, Found { track, balance: None, drag_n, drag_standard_n, moves, position_m }));
    }
    // Without a cell the balance of a steady run is that of its weight.
    let mass = match spec.moving_mass_kg {
        Some(mass) if !is_steady => mass,
        _ if is_steady => Declared::exact(0.0),
        _ => {
            let what = format!(
                "not steady: the speed changes by {:.1} ± {:.1} % over the last {:.3} m, and {:.1} % is allowed; declare moving_mass in [source.weight_tow], so that it \
                 can be balanced, or use a longer way",
                1e2 * change,
                1e2 * standard,
                spec.window_m,
                1e2 * spec.tolerance
            );
            return Err(TankError::of_run(run.id, what));
        }
    };
    if force_n <= 0.0 {
        let what = format!(
            "the weight of {:.4} N is not above the friction of {:.4} N that is declared, and yet the wagon moves; check both",
            run.weight_n, spec.friction_n.value
        );
        return Err(TankError::of_run(run.id, what));
    }
    let at = |moved: Moved| -> Result<(f64, Option<Balance>), TankError> {
        let force_n = (force_n - moved.friction_n).max(0.1 * force_n);
        if is_steady {
            return Ok((force_n, None));
        }
        let pull = Pull { force_n, mass_kg: mass.value + moved.mass_kg + run.weight_n / G_M_S2 };
        let found = balanced(run, spec, &track, pull, &moved)?;
        Ok((pull.force_n - pull.mass_kg * found.acceleration_m_s2, Some(found)))
    };
    let (drag_n, found) = at(Moved::default())?;
    if drag_n <= 0.0 {
        return Err(no_terminal(run.id, "faster than its weight could drive it"));
    }
    along_the_rail(run, &mut point, drag_n)?;
    let (sin, cos) = run.angle_rad.sin_cos();
    let near = found.map(|b| b.solution);
    let by = |speed_m_s: f64, moved: Moved, is_there: bool| -> Result<Moves, TankError> {
        let drag = if is_there { at(Moved { near, ..moved })?.0 - drag_n } else { 0.0 };
        let loads = point.loads.iter().map(|l| if l.name == "f_x" { -drag * cos } else { drag * sin });
        Ok(Moves { speed_m_s, loads_n: loads.collect() })
    };
    let [heavier, rubs] = [mass.standard_uncertainty, spec.friction_n.standard_uncertainty];
    let moves = [
        by(scale * track.speed_m_s, Moved { scale, ..Moved::default() }, scale > 0.0 && !is_steady)?,
        by(0.0, Moved { mass_kg: heavier, ..Moved::default() }, heavier > 0.0)?,
        by(0.0, Moved { friction_n: rubs, ..Moved::default() }, rubs > 0.0)?,
        by(0.0, Moved { share: 1.0, ..Moved::default() }, !is_steady)?,
    ];
    let moving_kg = mass.value + run.weight_n / G_M_S2;
    let drag_standard_n = moving_kg * found.map_or(0.0, |b| b.standard_m_s2);
    Ok((point, Found { track, balance: found, drag_n, drag_standard_n, moves, position_m }))
}

/// The balance of a run that still accelerates, where it has come far enough.
fn balanced(
    run: &Pulled<'_>,
    spec: &WeightTow,
    track: &Track,
    pull: Pull,
    moved: &Moved,
) -> Result<Balance, TankError> {
    let larger = 1.0 + moved.scale;
    let sense = (run.position_m[run.position_m.len() - 1] - run.position_m[0]).signum();
    let positions: Vec<f64> = run.position_m[track.moving.clone()].iter().map(|x| larger * sense * x).collect();
    let time_s = &run.time_s[track.moving.clone()];
    let found = balance(
        run.id,
        time_s,
        &positions,
        (larger * track.speed_m_s, track.noise_m),
        pull,
        (moved.near, moved.share),
    )?;
    if moved.near.is_none() && track.speed_m_s < spec.reached * found.terminal_m_s {
        let (speed_m_s, terminal_m_s) = (track.speed_m_s, found.terminal_m_s);
        let what = format!(
            "only {:.0} % of its terminal speed is reached ({speed_m_s:.3} of {terminal_m_s:.3} m/s), and {:.0} % is needed; use a longer way, a lighter wagon, or a body with \
             more drag",
            1e2 * speed_m_s / terminal_m_s,
            1e2 * spec.reached
        );
        return Err(TankError::of_run(run.id, what));
    }
    Ok(found)
}

/// Sets the force along the rail, leaving that across it; without a cell the body must lie along the rail.
fn along_the_rail(run: &Pulled<'_>, point: &mut Point, drag_n: f64) -> Result<(), TankError> {
    if point.loads.is_empty() {
        point.loads.push(by_weight(run, drag_n)?);
        return Ok(());
    }
    let (sin, cos) = run.angle_rad.sin_cos();
    let value = |name: &str| point.loads.iter().find(|l| l.name == name).map_or(0.0, |l| l.value);
    let across = value("f_x") * sin + value("f_y") * cos;
    for load in &mut point.loads {
        load.value = match load.name.as_str() {
            "f_x" => -drag_n * cos + across * sin,
            _ => drag_n * sin + across * cos,
        };
    }
    Ok(())
}

/// Without a load cell the drag along the rail is what pulls; across it nothing is known, so that the body must lie along the rail.
fn by_weight(run: &Pulled<'_>, force_n: f64) -> Result<Load, TankError> {
    if run.angle_rad != 0.0 {
        let what = "at an angle and without a load cell, so that what acts across the rail is unknown";
        return Err(no_terminal(run.id, what));
    }
    Ok(Load::stated("f_x", -force_n))
}
