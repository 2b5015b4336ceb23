//! How much faster than the clock the twin runs. Real time is 250 µs a tick; the aim, controller included, is a thousandth of that.
#![allow(missing_docs, clippy::unwrap_used)]

use divan::{Bencher, counter::ItemsCount};
use froude_control::tick::{AxisCommand, Command};
use froude_rig::load::{Load, Mounting};
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
    let config = TwinConfig::loaded(Load::mounted(Mounting::Wet));
    bencher.counter(ItemsCount::new(TICKS)).with_inputs(|| Twin::new(&config, 1)).bench_local_refs(|twin| {
        for i in 0..TICKS {
            twin.tick(to_and_fro(i, is_x_moving));
        }
        twin.state_hash()
    });
}
