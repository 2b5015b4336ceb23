//! Any message at all, floats from all their bits.

use froude_control::config::{AxisConfig, Config, Drive, Gains, Limits};
use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_control::tick::{AxisCommand, AxisInput, Command, Tick};
use froude_link::session::NOBODY;
use froude_link::status::{
    Ack, BoardHello, BoardId, Event, EventKind, FaultReport, Health, LockStepReply, TimeReply, TurnedAway, Verdict,
};
use froude_link::telemetry::{AxisTelemetry, Telemetry};
use froude_link::{FromBoard, HostFrame, ToBoard};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

/// A source of numbers and flags, so that a structure can be filled field by field.
#[derive(Debug)]
struct Draw {
    bits: Vec<u64>,
    next: usize,
}

impl Draw {
    fn bits(&mut self) -> u64 {
        self.next += 1;
        self.bits[self.next % self.bits.len()].rotate_left(self.next as u32)
    }
    fn f(&mut self) -> f64 {
        f64::from_bits(self.bits())
    }
    fn b(&mut self) -> bool {
        self.bits() & 1 == 1
    }
}

fn any_draw() -> impl Strategy<Value = Draw> {
    vec(prop_oneof![any::<u64>(), Just(0), any::<f64>().prop_map(f64::to_bits)], 1..80)
        .prop_map(|bits| Draw { bits, next: 0 })
}

fn any_fault() -> impl Strategy<Value = Fault> {
    use Fault::*;
    select(vec![
        EmergencyStop,
        EndSwitch,
        AmplifierNotReady,
        EncoderStuck,
        EncoderJump,
        EncoderIllegal,
        Polarity,
        TickLate,
        OverCurrent,
        Overload,
        Saturated,
        FollowingError,
        SoftLimit,
        OverSpeed,
        HostSilent,
        RecorderFailed,
        NotFinite,
        HomingFailed,
    ])
}

fn any_category() -> impl Strategy<Value = StopCategory> {
    select(vec![StopCategory::Zero, StopCategory::One, StopCategory::Two])
}

fn any_phase() -> impl Strategy<Value = Phase> {
    use Phase::*;
    select(vec![Disabled, Holding, Moving, Homing, Exciting, Stopping, Coasting])
}

fn any_refusal() -> impl Strategy<Value = Refusal> {
    use Refusal::*;
    select(vec![
        Faulted,
        Disabled,
        NotHomed,
        Busy,
        OutOfRange,
        BeyondTravel,
        NoSuchAxis,
        NotCleared,
        NotReady,
        EndSwitchOpen,
    ])
}

fn any_excitation() -> impl Strategy<Value = Excitation> {
    (0..4, any_draw()).prop_map(|(kind, mut d)| match kind {
        0 => Excitation::Pulses { volts: d.f(), period_s: d.f(), duty: d.f(), duration_s: d.f() },
        1 => Excitation::Relay { volts: d.f(), hysteresis_m: d.f(), duration_s: d.f() },
        2 => Excitation::Sweep { volts: d.f(), from_hz: d.f(), to_hz: d.f(), duration_s: d.f(), speed_m_s: d.f() },
        _ => Excitation::Jog { volts: d.f(), distance_m: d.f(), duration_s: d.f() },
    })
}

fn any_request() -> impl Strategy<Value = Request> {
    let axis = || 0..=255_usize;
    prop_oneof![
        axis().prop_map(|axis| Request::Enable { axis }),
        axis().prop_map(|axis| Request::Disable { axis }),
        axis().prop_map(|axis| Request::Home { axis }),
        (axis(), any_draw()).prop_map(|(axis, mut d)| Request::Move {
            axis,
            profile: Move {
                target_m: d.f(),
                speed_m_s: d.f(),
                acceleration_m_s2: d.f(),
                jerk_m_s3: d.f(),
                is_shaped: d.b()
            }
        }),
        (axis(), any_excitation()).prop_map(|(axis, excitation)| Request::Excite { axis, excitation }),
        any_category().prop_map(Request::Stop),
        Just(Request::RecorderFailed),
        any_fault().prop_map(Request::Clear),
    ]
}

fn axis_config(d: &mut Draw) -> AxisConfig {
    AxisConfig {
        gains: Gains {
            proportional_v_rad: d.f(),
            derivative_v_s_rad: d.f(),
            integral_v_rad_s: d.f(),
            derivative_filter_hz: d.f(),
        },
        drive: Drive {
            inertia_kg_m2: d.f(),
            coast_inertia_kg_m2: d.f(),
            viscous_n_m_s_rad: d.f(),
            viscous_lower_n_m_s_rad: d.f(),
            coulomb_n_m: d.f(),
            coulomb_lower_n_m: d.f(),
            drag_n_s2_m2: d.f(),
            torque_constant_n_m_a: d.f(),
            amplifier_a_v: d.f(),
            gear_ratio: d.f(),
            sprocket_radius_m: d.f(),
            counts_per_revolution: d.f(),
            held_band: d.f(),
            encoder_sign: d.f(),
        },
        limits: Limits {
            hard_low_m: d.f(),
            hard_high_m: d.f(),
            low_switch_m: d.f(),
            high_switch_m: d.f(),
            speed_m_s: d.f(),
            unhomed_speed_m_s: d.f(),
            acceleration_m_s2: d.f(),
            command_v: d.f(),
            current_a: d.f(),
            continuous_current_a: d.f(),
            thermal_time_s: d.f(),
            following_error_m: d.f(),
            saturation_s: d.f(),
            encoder_errors_per_s: d.bits() as u32,
            polarity_m: d.f(),
            stuck_s: d.f(),
        },
        mode_hz: d.f(),
        mode_damping: d.f(),
        is_robust_shaper: d.b(),
    }
}

fn any_config() -> impl Strategy<Value = Config> {
    any_draw().prop_map(|mut d| Config {
        axes: [axis_config(&mut d), axis_config(&mut d)],
        tick_us: d.bits() as u32,
        late_us: d.bits() as u32,
        host_silence_us: d.bits() as u32,
    })
}

fn any_tick() -> impl Strategy<Value = Tick> {
    (any_draw(), prop::option::of(any_request())).prop_map(|(mut d, request)| {
        let mut input = || AxisInput {
            encoder_count: d.bits() as u32,
            encoder_errors: d.bits() as u32,
            current_a: d.f(),
            is_low_end: d.b(),
            is_high_end: d.b(),
            is_amplifier_ready: d.b(),
        };
        let axes = [input(), input()];
        Tick { latched_us: d.bits() as u32, axes, is_estop_open: d.b(), is_host_heard: d.b(), request }
    })
}

pub fn any_host_frame() -> impl Strategy<Value = HostFrame> {
    // Of another version nothing is read but the version.
    let foreign = (3..u16::MAX).prop_map(|version| ToBoard::ForeignHello { version }.from_session(NOBODY));
    let own = (any_to_board(), prop_oneof![Just(NOBODY), any::<u32>()]);
    prop_oneof![1 => foreign, 9 => own.prop_map(|(says, session)| says.from_session(session))]
}

fn any_to_board() -> impl Strategy<Value = ToBoard> {
    prop_oneof![
        Just(ToBoard::Hello),
        (any::<u16>(), any_request()).prop_map(|(id, request)| ToBoard::Request { id, request }),
        (any::<u16>(), any_config()).prop_map(|(id, config)| ToBoard::Configure { id, config }),
        Just(ToBoard::Heartbeat),
        any::<u64>().prop_map(|host_sent_us| ToBoard::TimeRequest { host_sent_us }),
        (any::<u32>(), any_tick()).prop_map(|(number, tick)| ToBoard::LockStep { number, tick }),
    ]
}

pub fn any_telemetry() -> impl Strategy<Value = Telemetry> {
    let fault = prop::option::of((any_fault(), 0..=2_u8));
    (any_draw(), fault, any_phase(), any_phase()).prop_map(|(mut d, fault, y, x)| {
        let mut axis = |phase| AxisTelemetry {
            encoder_count: d.bits() as u32,
            encoder_errors: d.bits() as u8,
            command_counts: d.bits() as i16,
            current_counts: d.bits() as i16,
            reference_position: d.bits() as i32,
            reference_velocity: d.bits() as i32,
            reference_acceleration: d.bits() as i16,
            phase,
            is_homed: d.b(),
            is_saturated: d.b(),
            is_enabled: d.b(),
            is_low_end: d.b(),
            is_high_end: d.b(),
        };
        let axes = [axis(y), axis(x)];
        Telemetry {
            tick: d.bits() as u32,
            latched_us: d.bits() as u32,
            fault,
            is_estop_open: d.b(),
            is_host_heard: d.b(),
            has_gap_before: d.b(),
            is_after_overrun: d.b(),
            are_amplifiers_ready: [d.b(), d.b()],
            axes,
        }
    })
}

fn any_verdict() -> impl Strategy<Value = Verdict> {
    prop_oneof![
        Just(Verdict::Accepted),
        any_refusal().prop_map(Verdict::Refused),
        Just(Verdict::NotConfigured),
        Just(Verdict::BadConfiguration),
        Just(Verdict::NotNow),
    ]
}

fn any_event() -> impl Strategy<Value = Event> {
    let kind = prop_oneof![
        (0..=1_u8, any_phase()).prop_map(|(axis, phase)| EventKind::Phase { axis, phase }),
        any_fault().prop_map(EventKind::Cleared),
        any::<u16>().prop_map(EventKind::Overrun),
        any::<u16>().prop_map(EventKind::VersionMismatch),
    ];
    (any::<u32>(), any::<u32>(), kind).prop_map(|(tick, latched_us, kind)| Event { tick, latched_us, kind })
}

pub fn any_from_board() -> impl Strategy<Value = FromBoard> {
    let board = select(vec![BoardId::Realview, BoardId::Am335x, BoardId::Twin]);
    prop_oneof![
        (board, any_draw()).prop_map(|(board, mut d)| FromBoard::Hello(BoardHello {
            board,
            boot: d.bits() as u32,
            baud: d.bits() as u32,
            telemetry_every: d.bits() as u16,
            tick_us: d.bits() as u32,
            command_v_per_count: [d.f(), d.f()],
            current_a_per_count: [d.f(), d.f()],
            is_configured: d.b(),
            was_watchdog_reset: d.b(),
            session: d.bits() as u32,
        })),
        (3..u16::MAX).prop_map(|version| FromBoard::ForeignHello { version }),
        any_telemetry().prop_map(FromBoard::Telemetry),
        any_event().prop_map(FromBoard::Event),
        (any_draw(), any_fault(), any_category()).prop_map(|(mut d, fault, category)| FromBoard::Fault(FaultReport {
            tick: d.bits() as u32,
            latched_us: d.bits() as u32,
            fault,
            axis: d.bits() as u8,
            category,
        })),
        (any::<[u32; 2]>(), any::<u16>(), any_verdict())
            .prop_map(|([session, tick], id, verdict)| FromBoard::Ack(Ack { session, id, tick, verdict })),
        any::<[u32; 4]>().prop_map(|[session, holder, holder_frames, free_in_us]| {
            FromBoard::TurnedAway(TurnedAway { session, holder, holder_frames, free_in_us })
        }),
        any_draw().prop_map(|mut d| {
            let mut next = || d.bits() as u32;
            FromBoard::Health(Health {
                tick: next(),
                telemetry_lost: next(),
                overruns: next(),
                worst_step_us: next(),
                port_overflows: next(),
                corrupt: next(),
                lost: next(),
                late: next(),
                duplicates: next(),
            })
        }),
        (any::<[u32; 3]>(), any::<u64>()).prop_map(|([session, a, b], host_sent_us)| {
            FromBoard::TimeReply(TimeReply { session, host_sent_us, board_received_us: a, board_sent_us: b })
        }),
        (any_draw(), [any_phase(), any_phase()], prop::option::of(any_fault()), prop::option::of(any_refusal()))
            .prop_map(|(mut d, phases, fault, refusal)| FromBoard::LockStep(LockStepReply {
                session: d.bits() as u32,
                number: d.bits() as u32,
                command: Command {
                    axes: [
                        AxisCommand { volts: d.f(), is_enabled: d.b() },
                        AxisCommand { volts: d.f(), is_enabled: d.b() }
                    ]
                },
                reference_m: [d.f(), d.f()],
                position_m: [d.f(), d.f()],
                phases,
                fault,
                refusal,
            })),
    ]
}
