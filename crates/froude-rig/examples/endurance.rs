//! Long runs of controller and twin: `endurance hours 24`, `endurance faults 100000` and `endurance hosts 100000`.
//!
//! Hours: both axes go to and fro with a wet body, every counter having started just before its wrap; the unwrapped count is
//! held against the truth at every tick, and a second run must end in the same state. Faults: the catalogue on that many seeds. Hosts: the
//! same with the board in between, two hosts on its line and a late operator.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use froude_control::request::{Move, Request};
use froude_control::status::Phase;
use froude_rig::defaults::control_config;
use froude_rig::{AxisParameters, BodyState, ClosedLoop, Load, Truth, TwinConfig};
use std::time::Instant;

#[path = "../tests/faults/mod.rs"]
mod faults;
#[path = "../tests/hosts/mod.rs"]
mod hosts;

use faults::{Catalogue, Sweep};

fn main() -> std::process::ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_good = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["hours", hours] => hours.parse().is_ok_and(endured),
        ["faults", runs] => runs.parse().is_ok_and(faults),
        ["hosts", runs] => runs.parse().is_ok_and(two_hosts),
        _ => {
            eprintln!("usage: endurance hours N | endurance faults N | endurance hosts N");
            return 2.into();
        }
    };
    if is_good { 0.into() } else { 1.into() }
}

/// To and fro on both axes for so many hours; the hash at the end and whether count and truth agreed throughout.
fn to_and_fro(hours: f64) -> ([Truth; 2], bool) {
    let load = Load::mounted(BodyState::Wet);
    let mut config = TwinConfig::loaded(load);
    for axis in &mut config.axes {
        axis.start_m = 0.1;
    }
    let mut rig = ClosedLoop::new(&config, control_config(&[load; 2]), 24).unwrap();
    let per_count_m = [AxisParameters::long(), AxisParameters::short()].map(|p| p.metres_per_count());
    // The controller counts from its first tick, the truth from coordinate zero.
    rig.step();
    let first: [i64; 2] = [0, 1].map(|i| rig.twin.truth(i).count - rig.output.status.axes[i].count);
    let mut is_good = rig.home();
    let (far_m, speed_m_s) = ([3.0, 0.8], [0.5, 0.15]);
    for _ in 0..(hours * 3600.0 * 4000.0) as u64 {
        for axis in 0..2 {
            let status = &rig.output.status.axes[axis];
            if status.phase == Phase::Holding {
                let target_m = if status.reference_m > 0.5 * far_m[axis] { 0.3 } else { far_m[axis] };
                let speed_m_s = speed_m_s[axis];
                let profile = Move { target_m, speed_m_s, acceleration_m_s2: 0.6, jerk_m_s3: 6.0, is_shaped: true };
                rig.request(Request::Move { axis, profile });
            }
        }
        rig.step();
        for axis in 0..2 {
            let exact = rig.twin.truth(axis).motor_position_m / per_count_m[axis];
            let counted = (rig.output.status.axes[axis].count + first[axis]) as f64;
            is_good &= (counted - exact).abs() <= 1.0;
        }
    }
    ([0, 1].map(|i| rig.twin.truth(i)), is_good && rig.output.status.fault.is_none())
}

fn endured(hours: f64) -> bool {
    let begun = Instant::now();
    let (first, second) = std::thread::scope(|scope| {
        let second = scope.spawn(|| to_and_fro(hours));
        (to_and_fro(hours), second.join().unwrap())
    });
    let wall_s = begun.elapsed().as_secs_f64();
    let factor = hours * 3600.0 / wall_s;
    println!("{hours} h twice in {wall_s:.1} s ({factor:.0} times real time each)");
    first == second && first.1
}

fn faults(runs: u64) -> bool {
    let catalogue = Catalogue::new().unwrap();
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let sweep = std::thread::scope(|scope| {
        let parts: Vec<_> = (0..workers)
            .map(|first| {
                let catalogue = &catalogue;
                scope.spawn(move || catalogue.sweep((first as u64..runs).step_by(workers)))
            })
            .collect();
        parts.into_iter().map(|p| p.join().unwrap()).fold(Sweep::default(), |mut sum, part| {
            sum.join(part);
            sum
        })
    });
    for ((injection, called), (n, latest_s)) in &sweep.reported {
        println!("{n:6}  {latest_s:.5} s  {injection}: {called}");
    }
    println!("{} of {runs} not allowed", sweep.refused.len());
    for refused in sweep.refused.iter().take(20) {
        println!("{refused:?}");
    }
    sweep.refused.is_empty()
}

fn two_hosts(runs: u64) -> bool {
    let begun = Instant::now();
    let sweep = hosts::Sweep::of(&hosts::Hosts::new(), runs);
    println!("{sweep}, in {:.0} s", begun.elapsed().as_secs_f64());
    for refused in sweep.refused.iter().take(20) {
        println!("{refused:?}");
    }
    sweep.runs == runs && sweep.refused.is_empty()
}
