//! How much faster than the clock the twin runs. Real time is 250 µs a tick; the aim, controller included, is a thousandth of that.
#![allow(missing_docs, clippy::unwrap_used)]

use divan::{Bencher, counter::ItemsCount};
use froude_control::request::{Move, Request};
use froude_control::status::Phase;
use froude_control::tick::{AxisCommand, Command};
use froude_rig::closed_loop::ClosedLoop;
use froude_rig::defaults::control_config;
use froude_rig::load::{BodyState, Load};
use froude_rig::twin::{Twin, TwinConfig};

/// Ticks a sample: ten simulated seconds.
const TICKS: u64 = 40_000;

fn main() {
    divan::main();
}

fn to_and_fro(tick: u64, is_x_moving: bool) -> Command {
    let volts = if (tick / 6_000).is_multiple_of(2) { 2.0 } else { -2.0 };
    let x_volts = if is_x_moving && (tick / 2_000).is_multiple_of(2) { 0.9 } else { -0.9 };
    Command {
        axes: [
            AxisCommand { volts, is_enabled: true },
            AxisCommand { volts: if is_x_moving { x_volts } else { 0.0 }, is_enabled: true },
        ],
    }
}

/// The twin alone, in open loop; y moves, x holds or moves.
#[divan::bench(args = [false, true])]
fn twin_alone(bencher: Bencher<'_, '_>, is_x_moving: bool) {
    let config = TwinConfig::loaded(Load::mounted(BodyState::Wet));
    bencher.counter(ItemsCount::new(TICKS)).with_inputs(|| Twin::new(&config, 1)).bench_local_refs(|twin| {
        for i in 0..TICKS {
            twin.tick(to_and_fro(i, is_x_moving));
        }
        twin.truth(0)
    });
}

/// Twin and controller: homed, then to and fro on y while x holds (the paper's campaign), or on both axes.
#[divan::bench(args = [false, true])]
fn twin_and_controller(bencher: Bencher<'_, '_>, is_x_moving: bool) {
    let load = Load::mounted(BodyState::Wet);
    let mut config = TwinConfig::loaded(load);
    for axis in &mut config.axes {
        axis.start_m = 0.1;
    }
    let mut homed = ClosedLoop::new(&config, control_config(&[load, load]), 1).unwrap();
    assert!(homed.home());
    let profile =
        |target_m, speed_m_s| Move { target_m, speed_m_s, acceleration_m_s2: 0.5, jerk_m_s3: 5.0, is_shaped: true };
    bencher.counter(ItemsCount::new(TICKS)).with_inputs(|| homed.clone()).bench_local_refs(|rig| {
        let (far_m, speed_m_s) = ([2.5, 0.7], [0.3, 0.15]);
        for _ in 0..TICKS {
            for axis in 0..=usize::from(is_x_moving) {
                let status = &rig.output.status.axes[axis];
                if status.phase == Phase::Holding {
                    let target_m = if status.reference_m > 0.5 * far_m[axis] { 0.3 } else { far_m[axis] };
                    rig.request(Request::Move { axis, profile: profile(target_m, speed_m_s[axis]) });
                }
            }
            assert_eq!(rig.step().status.refusal, None);
        }
        assert!(rig.output.status.fault.is_none());
        rig.twin.truth(0)
    });
}
