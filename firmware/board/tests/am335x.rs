//! The BeagleBone's drivers against models of its registers.

mod chip;

use chip::{At, Chip};
use froude_board::am335x::eqep::Eqep;
use froude_board::am335x::pins::{PINS, line};
use froude_board::am335x::uart::Rate;
use froude_board::am335x::{Am335x, TICK_STEPS, on_interrupt};
use froude_board::board::Latched;
use froude_board::rig::{CONFIG, Rig};
use froude_board::tick::TickLatch;
use froude_board::{Application, Board};
use froude_control::request::Request;
use froude_control::status::Phase;
use froude_control::tick::{AxisCommand, Command};
use froude_link::frame::{FrameReader, FrameWriter, MAX_WIRE};
use froude_link::status::Verdict;
use froude_link::{FromBoard, ToBoard};

fn started(chip: &Chip) -> (Am335x<chip::Block>, &'static TickLatch) {
    let latch: &'static TickLatch = Box::leak(Box::new(TickLatch::new()));
    (Am335x::start(chip.blocks(), latch).unwrap(), latch)
}

/// A tick's time passes, and the interrupt is taken when it comes.
fn pass_a_tick(chip: &Chip, latch: &TickLatch) {
    chip.advance(TICK_STEPS);
    if chip.is_interrupted() {
        on_interrupt(&chip.blocks(), latch);
    }
}

fn enabled(volts: [f64; 2]) -> Command {
    Command { axes: volts.map(|volts| AxisCommand { volts, is_enabled: true }) }
}

#[test]
fn torque_is_off_before_anything_else_and_stays_off_after_start() {
    let chip = Chip::new();
    chip.with(|s| s.outputs = u32::MAX);
    let _board = started(&chip);
    assert_eq!(chip.with(|s| s.outputs) & (line::ENABLE[0] | line::ENABLE[1]), 0);
    assert_eq!(chip.with(|s| (s.range, s.power, s.volts)), (Some(4), Some(0x15), [0.0; 2]));
}

#[test]
fn a_module_that_does_not_come_up_is_named_and_no_torque_is_given() {
    for (clock, name) in [((At::Per, 0x6c), "UART1"), ((At::Per, 0xd8), "EPWMSS2"), ((At::WakeUp, 0xd4), "WDT1")] {
        let chip = Chip::new();
        chip.with(|s| s.dead.push(clock));
        let latch: &'static TickLatch = Box::leak(Box::new(TickLatch::new()));
        assert_eq!(Am335x::start(chip.blocks(), latch).err(), Some(name));
        assert_eq!(chip.with(|s| s.outputs), 0);
    }
}

#[test]
fn no_pin_is_configured_twice_and_every_input_listens() {
    let chip = Chip::new();
    let _board = started(&chip);
    for (k, pin) in PINS.iter().enumerate() {
        assert!(PINS[..k].iter().all(|other| other.offset != pin.offset), "{} twice", pin.header);
        assert_eq!(chip.written(At::Control, pin.offset), pin.value);
        let is_output = ["to host", "to DAC", "select", "enable"].iter().any(|word| pin.what.contains(word));
        assert_eq!(pin.value & 0x20 == 0, is_output, "{}: {}", pin.header, pin.what);
    }
}

#[test]
fn the_decoder_counts_every_edge_both_ways_through_the_wrap() {
    let chip = Chip::new();
    let (mut board, latch) = started(&chip);
    let mut count = |edges| -> Latched {
        chip.turn(0, edges);
        chip.turn(1, -edges);
        pass_a_tick(&chip, latch);
        board.take_tick().unwrap()
    };
    assert_eq!(count(40).axes.map(|a| a.encoder_count), [40, 40_u32.wrapping_neg()]);
    assert_eq!(count(-50).axes.map(|a| a.encoder_count), [10_u32.wrapping_neg(), 10]);
    assert_eq!(count(11).axes.map(|a| a.encoder_count), [1, 1_u32.wrapping_neg()]);
}

#[test]
fn both_lines_at_once_are_an_error_counted_once_a_tick() {
    let chip = Chip::new();
    let (mut board, latch) = started(&chip);
    let mut errors = |is_bad: bool| {
        if is_bad {
            let (a, b) = chip.with(|s| s.decoders[0].lines);
            chip.set_lines(0, (!a, !b));
            chip.set_lines(0, (a, b)); // a second one in the same tick is not distinguished
        }
        pass_a_tick(&chip, latch);
        board.take_tick().unwrap().axes.map(|a| a.encoder_errors)
    };
    assert_eq!([errors(false), errors(true), errors(false), errors(true)], [[0, 0], [1, 0], [1, 0], [2, 0]]);
}

#[test]
fn a_decoder_that_was_not_started_does_not_count() {
    let chip = Chip::new();
    chip.with(|s| s.registers.insert((At::Per, 0xd4), 2));
    let decoder = Eqep::new(chip.block(At::PwmY));
    chip.turn(0, 10);
    assert_eq!(decoder.count(), 0);
}

#[test]
fn the_timer_interrupts_every_250_us_and_latches_the_time_of_the_tick() {
    let chip = Chip::new();
    let (mut board, latch) = started(&chip);
    for tick in 1..=5000_u32 {
        chip.advance(TICK_STEPS - 1);
        assert!(!chip.is_interrupted() && board.take_tick().is_none(), "early at tick {tick}");
        chip.advance(1);
        assert!(chip.is_interrupted(), "tick {tick} did not come");
        on_interrupt(&chip.blocks(), latch);
        assert!(!chip.is_interrupted(), "the interrupt was not cleared");
        let latched = board.take_tick().unwrap();
        assert_eq!((latched.latched_us, latched.ticks), (tick * 250, 1));
    }
}

#[test]
fn time_goes_on_through_the_counters_wrap() {
    let chip = Chip::new();
    let (mut board, latch) = started(&chip);
    // Ticks of 10 s: 30 of them are 300 s, the counter wraps after 179 s.
    for k in 1..=30_u32 {
        chip.advance(240_000_000);
        chip.with(|s| s.overflow = true);
        on_interrupt(&chip.blocks(), latch);
        assert_eq!(board.take_tick().unwrap().latched_us, k * 10_000_000);
        assert_eq!(board.now_us(), k * 10_000_000);
    }
}

#[test]
fn a_tick_that_was_not_taken_in_time_is_counted() {
    let chip = Chip::new();
    let (mut board, latch) = started(&chip);
    (0..4).for_each(|_| pass_a_tick(&chip, latch));
    assert_eq!(board.take_tick().unwrap().ticks, 4);
    assert!(board.take_tick().is_none());
}

#[test]
fn a_spurious_interrupt_is_no_tick() {
    let chip = Chip::new();
    let (mut board, latch) = started(&chip);
    on_interrupt(&chip.blocks(), latch);
    assert!(board.take_tick().is_none());
}

#[test]
fn three_megabaud_are_exact_and_921600_are_within_a_fifth_of_a_percent() {
    assert_eq!(Rate::of(3_000_000).baud(), 3_000_000);
    assert_eq!(Rate::of(921_600).baud(), 923_076);
    assert_eq!(Rate::of(115_200).baud(), 115_384);
    let chip = Chip::new();
    let _board = started(&chip);
    assert_eq!((chip.written(At::Uart, 0x20), chip.written(At::Uart, 0x0c)), (0, 3), "16 times, 8N1");
}

#[test]
fn a_full_port_takes_nothing_and_a_flooded_one_says_so() {
    let chip = Chip::new();
    let (mut board, _) = started(&chip);
    assert_eq!((0..100).filter(|&byte| board.write_byte(byte)).count(), 64);
    (0..70).for_each(|byte| chip.receive(byte));
    let mut got = vec![];
    while let Some(byte) = board.read_byte() {
        got.push(byte);
    }
    assert_eq!(got, (0..64).collect::<Vec<_>>());
    assert_eq!(board.port_overflows(), 1);
}

#[test]
fn volts_come_out_of_the_dac_to_half_a_code_and_only_while_enabled() {
    let chip = Chip::new();
    let (mut board, _) = started(&chip);
    for volts in [-10.0, -3.3, -1e-4, 0.0, 0.123, 9.9996] {
        let codes = board.actuate(&enabled([volts, -volts]));
        let out = chip.with(|s| s.volts);
        assert!((out[0] - volts).abs() <= 0.5 * 10.0 / 32768.0, "{volts} V: {} V", out[0]);
        assert_eq!(f64::from(codes[0]) * 10.0 / 32768.0, out[0], "what was sent is what is reported");
    }
    assert_eq!(chip.with(|s| s.outputs), line::ENABLE[0] | line::ENABLE[1]);
    let mut command = enabled([2.0, 2.0]);
    command.axes[1].is_enabled = false;
    board.actuate(&command);
    assert_eq!(chip.with(|s| (s.outputs, s.volts[1])), (line::ENABLE[0], 0.0));
    board.actuate(&enabled([f64::NAN, f64::INFINITY]));
    assert_eq!(chip.with(|s| s.volts[0]), 0.0, "what is no number is no voltage");
}

#[test]
fn a_dac_that_does_not_answer_takes_the_torque_away_for_good() {
    let chip = Chip::new();
    let (mut board, latch) = started(&chip);
    board.actuate(&enabled([1.0, 1.0]));
    chip.with(|s| s.is_dac_stuck = true);
    board.actuate(&enabled([1.0, 1.0]));
    assert_eq!(chip.with(|s| s.outputs), 0);
    chip.with(|s| s.is_dac_stuck = false);
    board.actuate(&enabled([1.0, 1.0]));
    assert_eq!(chip.with(|s| s.outputs), 0, "not even when it comes back");
    pass_a_tick(&chip, latch);
    assert!(board.take_tick().unwrap().axes.iter().all(|a| !a.is_amplifier_ready));
}

#[test]
fn switches_and_currents_reach_the_axis_that_they_belong_to() {
    let chip = Chip::new();
    let (mut board, latch) = started(&chip);
    let mut read = |inputs, currents| {
        chip.with(|s| (s.inputs, s.currents) = (inputs, currents));
        board.actuate(&Command::default()); // starts the conversion
        pass_a_tick(&chip, latch);
        board.take_tick().unwrap()
    };
    let quiet = read(0, [2048, 2048]);
    assert!(!quiet.is_estop_open && quiet.axes.iter().all(|a| a.is_amplifier_ready && a.current_counts == 0));
    let l = read(line::ESTOP | line::LOW[0] | line::HIGH[1] | line::FAULT[1], [2148, 1948]);
    assert!(l.is_estop_open);
    assert_eq!(l.axes.map(|a| (a.is_low_end, a.is_high_end)), [(true, false), (false, true)]);
    assert_eq!(l.axes.map(|a| a.is_amplifier_ready), [true, false]);
    assert_eq!(l.axes.map(|a| a.current_counts), [100, -100]);
}

#[test]
fn a_watchdog_that_is_fed_sleeps_and_one_that_is_not_bites_within_50_ms() {
    let chip = Chip::new();
    let (mut board, _) = started(&chip);
    for _ in 0..1000 {
        chip.advance(TICK_STEPS);
        board.feed_watchdog();
    }
    assert!(!chip.with(|s| s.has_bitten));
    chip.advance(24_000 * 49);
    assert!(!chip.with(|s| s.has_bitten), "49 ms");
    chip.advance(24_000 * 2);
    assert!(chip.with(|s| s.has_bitten), "51 ms");
}

/// The whole application on the modelled chip, a rig at its pins and the host at its serial port.
#[test]
fn the_application_homes_a_rig_through_every_register() {
    let chip = Chip::new();
    let (mut board, latch) = started(&chip);
    let mut application = Application::new();
    let mut rig = Rig::default();
    let (mut writer, mut reader) = (FrameWriter::default(), FrameReader::<FromBoard>::new());
    let (mut heard, mut telemetry, mut accepted) = (0, vec![], 0);
    let counts = |rig: &Rig| rig.axes.map(|axis| axis.input().encoder_count);
    let mut before = counts(&rig);
    let mut line_in = std::collections::VecDeque::new();
    application.announce(&mut board);
    for tick in 0..16_000_u32 {
        let message = match tick {
            10 => ToBoard::Hello,
            20 => ToBoard::Configure { id: 1, config: CONFIG },
            40 => ToBoard::Request { id: 2, request: Request::Enable { axis: 0 } },
            50 => ToBoard::Request { id: 3, request: Request::Home { axis: 0 } },
            _ => ToBoard::Heartbeat,
        };
        let mut wire = [0; MAX_WIRE];
        if tick % 10 == 0 {
            line_in.extend(writer.write(&message.from_session(1), &mut wire));
        }

        // The rig moves by what stands at the pins, its encoders turn, its switches open, its current flows.
        let (outputs, volts) = chip.with(|s| (s.outputs, s.volts));
        let axes = [0, 1].map(|k| AxisCommand { volts: volts[k], is_enabled: outputs & line::ENABLE[k] != 0 });
        rig.step(&Command { axes });
        let now = counts(&rig);
        (0..2).for_each(|k| chip.turn(k, now[k].wrapping_sub(before[k]).cast_signed()));
        before = now;
        chip.with(|s| {
            let open = |is_open, bit| if is_open { bit } else { 0 };
            s.inputs = (0..2)
                .map(|k| {
                    let input = rig.axes[k].input();
                    open(input.is_low_end, line::LOW[k]) | open(input.is_high_end, line::HIGH[k])
                })
                .fold(0, |all, one| all | one);
            s.currents = rig.axes.map(|axis| (2048.0 + axis.current_a * 204.8) as u32);
        });
        // A tick's time in slices of 10 µs, in which the main loop turns and three bytes pass the line each way.
        for _ in 0..25 {
            line_in.drain(..line_in.len().min(3)).for_each(|byte| chip.receive(byte));
            chip.advance(TICK_STEPS / 25);
            if chip.is_interrupted() {
                on_interrupt(&chip.blocks(), latch);
            }
            while application.turn(&mut board) {}
        }
        let sent = chip.with(|s| std::mem::take(&mut s.sent));
        for received in sent.into_iter().filter_map(|byte| reader.feed(byte)) {
            heard += 1;
            match received.message {
                FromBoard::Telemetry(t) => telemetry.push(t),
                FromBoard::Ack(ack) if ack.verdict == Verdict::Accepted => accepted += 1,
                FromBoard::Ack(ack) => panic!("{ack:?}"),
                FromBoard::Fault(report) => panic!("{report:?}"),
                _ => {}
            }
        }
    }
    assert_eq!(accepted, 3);
    let axis = application.output().status.axes[0];
    assert!(axis.is_homed && axis.phase == Phase::Holding, "{axis:?}");
    let error_m = axis.position_m - rig.axes[0].position_m();
    assert!(error_m.abs() < 0.05 * 250e-6 * 2.0 + 2.5e-6, "{error_m} m off after homing");
    // Every tick since the hello has been reported, in order, and the last raw count is the rig's.
    assert!(telemetry.windows(2).all(|pair| pair[1].tick == pair[0].tick + 1), "a tick is missing");
    assert!(telemetry.len() > 15_950 && heard > 15_960, "{} frames of telemetry", telemetry.len());
    assert_eq!(application.overruns(), 0);
    assert!(!chip.with(|s| s.has_bitten));
}
