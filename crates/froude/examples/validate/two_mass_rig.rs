//! The two masses of the carriage's twin, found by its own controller's pulses, bare and in the water.

use std::error::Error;

use froude::control::request::{Excitation, Move, Request};
use froude::control::status::Phase;
use froude::fit::budget::Uncertain;
use froude::fit::coverage::Count;
use froude::methods::carriage::servo::{FlexibleOptions, FlexibleReport, Gear, MotorSide, ServoLog, identify_flexible};
use froude::rig::closed_loop::ClosedLoop;
use froude::rig::defaults::control_config;
use froude::rig::load::{BodyState, Load, Strut};
use froude::rig::{AxisParameters, TwinConfig};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::claims::Claims;

const SECTION: &str =
    "Two masses of the carriage's twin (gear, friction that sticks and varies, amplifier) from its pulses";

/// The paper's pulses.
const PULSES: Excitation = Excitation::Pulses { volts: 2.0, period_s: 1.0, duty: 0.6, duration_s: 20.0 };
/// Ticks per row: 1 kHz.
const DECIMATION: usize = 4;
/// To what part efficiencies and drag are declared; what is declared is drawn. K_T is drawn by the twin.
const EFFICIENCY_TO: f64 = 0.02;
const DRAG_TO: f64 = 0.05;
const TORQUE_TO: f64 = 0.005;
/// The amplifier's current loop and the board's output, as a campaign takes them.
const DELAY_S: Uncertain = Uncertain::new(2e-4, 1e-4);

/// Coverage over `seeds` runs, bare and wet.
pub fn coverage(claims: &mut Claims, seeds: u64) -> Result<(), Box<dyn Error>> {
    let wet = Load { strut: Strut::WithBody, ..Load::mounted(BodyState::Wet) };
    let wet = Load { ballast_kg: wet.balancing_ballast_kg(), ..wet };
    for (name, load) in [("bare", Load::default()), ("wet, ballasted", wet)] {
        of_load(claims, name, load, seeds)?;
    }
    Ok(())
}

fn of_load(claims: &mut Claims, name: &str, load: Load, seeds: u64) -> Result<(), Box<dyn Error>> {
    let axis = AxisParameters::long();
    let reports: Vec<FlexibleReport> = (0..seeds)
        .into_par_iter()
        .map(|seed| -> Result<FlexibleReport, String> {
            let log = pulses(load, seed)?;
            identify_flexible(&log, &declared(&axis, &load, seed)).map_err(|e| e.to_string())
        })
        .collect::<Result<_, _>>()?;
    let n = reports.len() as f64;
    let bar = 0.95 - 3.0 * (0.95 * 0.05 / n).sqrt();
    for (coefficient, truth) in [
        ("J_m", axis.motor_inertia_kg_m2),
        ("M", load.mass_kg(&axis)),
        ("K_e", axis.stiffness_n_m),
        ("B_e", axis.chain_damping_n_s_m),
        ("f_antiresonance", axis.load_mode_hz(load.mass_kg(&axis))),
    ] {
        let mut inside = Count::default();
        let (mut error, mut square, mut stated) = (0.0, 0.0, 0.0);
        for c in reports.iter().filter_map(|r| r.coefficient(coefficient)) {
            inside.add((c.interval[0]..=c.interval[1]).contains(&truth));
            let e = c.value / truth - 1.0;
            error += e / n;
            square += e * e / n;
            stated += (c.block_std / truth).powi(2) / n;
        }
        claims.holds(
            SECTION,
            &format!("{name}, {coefficient}: truth inside the 95 % interval"),
            &format!("at least {bar:.3}: 0.95 less the scatter of {n} runs"),
            format!(
                "{:.3}; mean off by {:+.1} % of {truth:.4e}, rms error {:.1} %, stated {:.1} %",
                inside.rate(),
                100.0 * error,
                100.0 * square.sqrt(),
                100.0 * stated.sqrt()
            ),
            inside.rate() >= bar,
        );
    }
    Ok(())
}

/// What the owner of the rig declares.
fn declared(axis: &AxisParameters, load: &Load, seed: u64) -> FlexibleOptions {
    let mut rng = Pcg64::new(u128::from(seed), 47);
    let mut drawn = |value: f64, part: f64| {
        let normal: f64 = StandardNormal.sample(&mut rng);
        Uncertain::new(value * (1.0 + part * normal), part * value)
    };
    let motor = MotorSide {
        torque_constant_n_m_a: axis.torque_constant_n_m_a,
        amplifier_a_v: froude::rig::parameters::AMPLIFIER_A_V,
        gear_ratio: axis.gear_ratio,
        sprocket_radius_m: axis.sprocket_radius_m,
    };
    FlexibleOptions {
        gear: Gear::Declared {
            forward: drawn(axis.efficiency_forward, EFFICIENCY_TO),
            backward: drawn(axis.efficiency_backward, EFFICIENCY_TO),
        },
        load_drag_n_s2_m2: drawn(load.drag_n_s2_m2() + load.strut_n_s2_m2(axis), DRAG_TO),
        delay_s: DELAY_S,
        force_relative: TORQUE_TO,
        ..FlexibleOptions::new(motor)
    }
}

/// Homes, goes to the middle, pulses; command and encoder while the loop is open.
fn pulses(load: Load, seed: u64) -> Result<ServoLog, String> {
    let axis = AxisParameters::long();
    let bare = Load::default();
    let mut config = TwinConfig::loaded(bare);
    config.axes[0].start_m = 0.05;
    config.axes[1].start_m = 0.02;
    let mut rig = ClosedLoop::new(&config, control_config(&[bare; 2]), seed).map_err(|e| e.to_string())?;
    let middle_m = 0.5 * (axis.hard_low_m + axis.hard_high_m);
    let profile = Move { target_m: middle_m, speed_m_s: 0.3, acceleration_m_s2: 0.3, jerk_m_s3: 1.0, is_shaped: true };
    if !rig.home() || !rig.carry_out(Request::Move { axis: 0, profile }, 0, 400_000) {
        return Err(format!("the twin does not reach the middle: {:?}", rig.output.status));
    }
    // Only now the load is mounted: friction and K_T are drawn anew.
    rig.twin.begin_run([load; 2], seed);
    (0..8_000).for_each(|_| {
        rig.step();
    });
    rig.request(Request::Excite { axis: 0, excitation: PULSES });
    let first = rig.step().status.axes[0].position_m;
    if rig.output.status.axes[0].phase != Phase::Exciting {
        return Err(format!("the pulses are refused: {:?}", rig.output.status.refusal));
    }
    let start = rig.tick.axes[0].encoder_count;
    let mut log = ServoLog::default();
    let mut tick = 0_usize;
    while rig.output.status.axes[0].phase == Phase::Exciting {
        if tick.is_multiple_of(DECIMATION) {
            let counts = rig.tick.axes[0].encoder_count.wrapping_sub(start) as i32;
            log.time_s.push((tick / DECIMATION) as f64 * 1e-3);
            log.position_m.push(first + axis.encoder_sign * f64::from(counts) * axis.metres_per_count());
            log.command_v.push(rig.output.command.axes[0].volts);
        }
        rig.step();
        tick += 1;
    }
    Ok(log)
}
