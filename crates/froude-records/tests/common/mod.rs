//! A carriage for tests: ticks whose every value can be computed again.
#![allow(dead_code)]

use froude_records::campaign::BodyAxis;
use froude_records::run::{
    Axis, AxisConstants, AxisSample, BodyState, CarriageFacts, CarriageSample, ClockAlignment, Declared, Direction,
    Layout, Mounted, Role, RunMeta, TOW,
};

/// Ticks per second of the board.
pub const RATE_HZ: f64 = 4000.0;

/// 2026-11-21T10:57:34Z.
pub const START_NS: u64 = 1_795_258_654_000_000_000;

pub const TRUTHS: [(&str, &str); 2] = [("truth/y/load_position", "m"), ("truth/y/drag", "N")];

pub fn layout() -> Layout {
    Layout::carriage(true, true, &TRUTHS).unwrap()
}

pub fn meta(id: &str) -> RunMeta {
    let constants = AxisConstants {
        torque_constant_n_m_a: Declared::new(26.7e-3, 0.5e-3),
        amplifier_a_v: Declared::new(0.352, 0.004),
        gear_ratio: Declared::exact(34.97),
        sprocket_radius_m: Declared::new(0.055, 1e-5),
        counts_per_revolution: 4000.0,
        efficiency_forward: Some(Declared::new(0.8, 0.05)),
        efficiency_backward: None,
        is_calibrated: false,
    };
    RunMeta {
        campaign: "Cylinder across its axis \"wet\"\n".to_owned(),
        id: id.to_owned(),
        method: TOW.to_owned(),
        role: Role::Wet,
        mounted: Mounted {
            body: BodyState::Wet,
            is_ballasted: true,
            hung_weight_n: Some(19.62),
            travel: Some(BodyAxis::Y),
        },
        carriage: CarriageFacts {
            set: Some(1),
            pair: Some(3),
            repeat: Some(2),
            axis: Axis::Y,
            target_speed_m_s: Some(0.55),
            direction: Some(Direction::Backward),
            rig: [("y".to_owned(), constants)].into_iter().collect(),
            twin_seed: Some(u64::MAX),
        },
        note: "ripples, waited a minute more".to_owned(),
        versions: [("froude".to_owned(), "0.1.0".to_owned()), ("board fw".to_owned(), "1.0".to_owned())]
            .into_iter()
            .collect(),
        clock: Some(ClockAlignment { host_at_zero_s: -0.0125, drift: 3.1e-6, standard_uncertainty_s: 2e-5 }),
        log_rate_hz: RATE_HZ,
        date: "2026-11-21T10:57:34Z".to_owned(),
        start_unix_ns: START_NS,
        ..RunMeta::default()
    }
}

/// What happens in a tick: positions of a trapezoid's middle, a force that grows, codes.
pub fn sample(tick: u64) -> (CarriageSample, [f64; 2]) {
    let t = tick as f64 / RATE_HZ;
    let axis = |v: f64| AxisSample {
        encoder: (v * t * 1e5) as i64 - 7,
        position_m: v * t,
        reference_position_m: v * t + 1e-3,
        reference_velocity_m_s: v,
        reference_acceleration_m_s2: -0.0,
        command_v: (37.0 * t).sin(),
        current_a: 1.0 / (1.0 + t),
        state: 2,
        fault: (tick % 19) as u8,
    };
    (CarriageSample { y: axis(0.55), x: Some(axis(-0.01)), force_n: 6.05 + 0.01 * t }, [0.55 * t - 1e-4, 6.05])
}

pub fn row(tick: u64) -> Vec<f64> {
    let (sample, truths) = sample(tick);
    let mut row = Vec::new();
    sample.row(true, &truths, &mut row);
    row
}
