//! The emulated board against the host's library, tick by tick over a bad serial line: the same commands, bit for bit.

use std::collections::BTreeSet;

use froude_board::rig::{CONFIG, Rig};
use froude_control::Controller;
use froude_control::fault::StopCategory;
use froude_control::request::{Excitation, Move, Request};
use froude_control::tick::{AXES, Tick};
use froude_emulated::{Board, noise::Line};
use froude_link::status::{Health, LockStepReply, Verdict};
use froude_link::{FromBoard, ToBoard};

/// 20 s when the whole of it is asked for, 2 s in the pipeline.
fn ticks() -> u32 {
    if std::env::var_os("FROUDE_FULL").is_some() { 80_000 } else { 8_000 }
}

/// What the operator wants at which tick: it only has to lead the controller through its states.
fn request(number: u32) -> Option<Request> {
    let go = |axis, target_m, is_shaped, jerk_m_s3| {
        let profile = Move { target_m, speed_m_s: 0.4, acceleration_m_s2: 0.9, jerk_m_s3, is_shaped };
        Some(Request::Move { axis, profile })
    };
    match number {
        10 => Some(Request::Enable { axis: 0 }),
        12 => Some(Request::Enable { axis: 1 }),
        20 => Some(Request::Home { axis: 0 }),
        22 => Some(Request::Home { axis: 1 }),
        4_000 => go(0, 0.4, true, 0.0),
        4_002 => go(1, 0.3, false, 5.0),
        5_000 => Some(Request::Stop(StopCategory::Two)),
        6_400 => {
            let excitation = Excitation::Pulses { volts: 1.0, period_s: 0.2, duty: 0.6, duration_s: 0.5 };
            Some(Request::Excite { axis: 0, excitation })
        }
        7_600 => Some(Request::Stop(StopCategory::One)),
        n if n > 8_000 && n % 16_000 == 0 => Some(Request::Enable { axis: 0 }),
        n if n > 8_000 && n % 16_000 == 40 => go(0, if n / 16_000 % 2 == 0 { 0.2 } else { 1.5 }, true, 0.0),
        _ => None,
    }
}

#[test]
fn commands_are_bit_equal_over_a_line_that_drops_repeats_damages_and_delays() {
    let mut board = Board::start("carriage-realview").unwrap();
    let hello = board.ask(&ToBoard::Hello, |m| if let FromBoard::Hello(h) = m { Some(*h) } else { None }).unwrap();
    println!("{hello:?}");
    assert_eq!(hello.telemetry_every, 1);
    // The board says hello by itself when it starts; our own may have come before its port was set up. Only who greets gets telemetry.
    let is_telemetry = |m: &FromBoard| matches!(m, FromBoard::Telemetry(_)).then_some(());
    board.ask(&ToBoard::Hello, is_telemetry).unwrap();
    let configure = ToBoard::Configure { id: 1, config: CONFIG };
    let ack = board.ask(&configure, |m| if let FromBoard::Ack(a) = m { Some(*a) } else { None }).unwrap();
    assert_eq!(ack.verdict, Verdict::Accepted);
    // What the serial port swallowed before it was set up is no business of the line.
    let is_health = |m: &FromBoard| if let FromBoard::Health(h) = m { Some(*h) } else { None };
    let before = board.ask(&ToBoard::Hello, is_health).unwrap();
    board.outward = Line::bad(20, 1);
    board.inward = Line::bad(20, 2);

    let mut host = Controller::new(CONFIG).unwrap();
    let mut rig = Rig::default();
    let (mut moved, mut seen) = (0, BTreeSet::new());
    let started = std::time::Instant::now();
    for number in 0..ticks() {
        let tick = Tick {
            latched_us: number.wrapping_mul(250).wrapping_sub(1_000_000), // wraps on the way
            axes: rig.axes.map(|axis| axis.input()),
            is_estop_open: false,
            is_host_heard: true,
            request: request(number),
        };
        let expected = host.step(&tick);
        let is_it = |m: &FromBoard| match m {
            FromBoard::LockStep(reply) if reply.number == number => Some(*reply),
            _ => None,
        };
        let reply: LockStepReply = board.ask(&ToBoard::LockStep { number, tick }, is_it).unwrap();
        for axis in 0..AXES {
            let (got, want) = (reply.command.axes[axis], expected.command.axes[axis]);
            assert_eq!(got.volts.to_bits(), want.volts.to_bits(), "tick {number}, axis {axis}: {got:?}, host {want:?}");
            assert_eq!(got.is_enabled, want.is_enabled, "tick {number}, axis {axis}");
            let status = expected.status.axes[axis];
            assert_eq!(reply.reference_m[axis].to_bits(), status.reference_m.to_bits(), "tick {number}, axis {axis}");
            assert_eq!(reply.phases[axis], status.phase, "tick {number}, axis {axis}");
        }
        assert_eq!(reply.fault, expected.status.fault.map(|(fault, _)| fault), "tick {number}");
        assert_eq!(reply.refusal, expected.status.refusal, "tick {number}");
        seen.extend(expected.status.axes.map(|axis| format!("{:?}", axis.phase)));
        if let Some(refusal) = expected.status.refusal {
            println!("tick {number}: {refusal:?}");
        }
        moved += u32::from(expected.command.axes.iter().any(|axis| axis.volts != 0.0));
        rig.step(&expected.command);
    }
    println!(
        "{} ticks, {:.1} s of them, in {:.1} s",
        ticks(),
        f64::from(ticks()) * 250e-6,
        started.elapsed().as_secs_f64()
    );
    println!("states {seen:?}, fault {:?}", host.step(&Tick::default()).status.fault);
    println!("to the board {:?}, to the host {:?}", board.outward.damage, board.inward.damage);
    assert!(moved > ticks() / 4, "only {moved} ticks commanded anything: the comparison would be empty");

    // The board counted what the line did to it, exactly.
    let damage = board.outward.damage;
    let is_holding = board.outward.holds_one();
    (board.outward, board.inward) = (Line::clean(), Line::clean());
    let health: Health = board.ask(&ToBoard::Hello, is_health).unwrap();
    println!("{health:?}");
    assert_eq!(health.corrupt - before.corrupt, damage.damaged);
    assert_eq!(health.duplicates - before.duplicates, damage.repeated);
    assert_eq!(health.late - before.late, damage.delayed - u32::from(is_holding));
    assert_eq!(health.lost - before.lost, damage.dropped + damage.damaged + u32::from(is_holding));
    // And the host what it did to the answers; repeated answers to repeated questions are not repeated frames.
    println!("{:?}", board.counts());
}
