//! What the application says to a host, on a board that is nothing but queues.

use std::collections::VecDeque;

use froude_board::board::{AxisLatched, Latched, Scales};
use froude_board::rig::CONFIG;
use froude_board::{Application, Board};
use froude_control::config::Config;
use froude_control::fault::{Fault, StopCategory};
use froude_control::request::Request;
use froude_control::status::{Phase, Refusal};
use froude_control::tick::{Command, Tick};
use froude_link::frame::{FrameReader, FrameWriter, MAX_WIRE};
use froude_link::session::{AFTER_SILENCE_US, NOBODY};
use froude_link::status::{Ack, BoardId, EventKind, LockStepReply, TurnedAway, Verdict};
use froude_link::{FromBoard, ToBoard};

/// A board whose ticks come when the test asks for them.
#[derive(Default)]
struct Queues {
    now_us: u32,
    waiting: u32,
    to_board: VecDeque<u8>,
    from_board: Vec<u8>,
    is_enabled: bool,
}

impl Board for Queues {
    const ID: BoardId = BoardId::Twin;
    const BAUD: u32 = 921_600;

    fn scales(&self) -> Scales {
        Scales { command_v_per_count: [1e-3; 2], current_a_per_count: [1e-3; 2] }
    }
    fn boot_number(&self) -> u32 {
        5
    }
    fn was_watchdog_reset(&self) -> bool {
        true
    }
    fn now_us(&mut self) -> u32 {
        self.now_us += 7;
        self.now_us
    }
    fn take_tick(&mut self) -> Option<Latched> {
        let ticks = std::mem::take(&mut self.waiting);
        let axis = AxisLatched { is_amplifier_ready: true, ..AxisLatched::default() };
        (ticks > 0).then_some(Latched { latched_us: self.now_us, ticks, axes: [axis; 2], is_estop_open: false })
    }
    fn actuate(&mut self, command: &Command) -> [i16; 2] {
        self.is_enabled = command.axes.iter().any(|axis| axis.is_enabled);
        [0; 2]
    }
    fn read_byte(&mut self) -> Option<u8> {
        self.to_board.pop_front()
    }
    fn write_byte(&mut self, byte: u8) -> bool {
        self.from_board.push(byte);
        true
    }
    fn port_overflows(&self) -> u32 {
        0
    }
    fn feed_watchdog(&mut self) {}
}

/// The sessions of two hosts.
const FIRST: u32 = 0x0001_0001;
const SECOND: u32 = 0x0002_0002;

/// Application, board and the hosts on its line.
struct Bench {
    application: Application,
    board: Queues,
    /// Whose numbers go on from frame to frame.
    writers: std::collections::BTreeMap<u32, FrameWriter>,
    reader: FrameReader<FromBoard>,
}

impl Bench {
    fn new() -> Self {
        let (writers, reader) = (std::collections::BTreeMap::new(), FrameReader::new());
        Self { application: Application::new(), board: Queues::default(), writers, reader }
    }

    fn configured() -> Self {
        let mut bench = Self::new();
        bench.say(&ToBoard::Hello);
        assert_eq!(bench.verdict(&ToBoard::Configure { id: 1, config: CONFIG }), Verdict::Accepted);
        bench
    }

    /// Lets a tick pass and everything be said; what the board said, telemetry left out.
    fn tick(&mut self) -> Vec<FromBoard> {
        self.board.now_us = self.board.now_us.next_multiple_of(250) + 250;
        self.board.waiting += 1;
        while self.application.turn(&mut self.board) {}
        let bytes = std::mem::take(&mut self.board.from_board);
        let heard = bytes.into_iter().filter_map(|byte| self.reader.feed(byte));
        heard.map(|received| received.message).filter(|m| !matches!(m, FromBoard::Telemetry(_))).collect()
    }

    /// Puts a frame on the line.
    fn send(&mut self, session: u32, says: &ToBoard) {
        let mut wire = [0; MAX_WIRE];
        let writer = self.writers.entry(session).or_default();
        self.board.to_board.extend(writer.write(&(*says).from_session(session), &mut wire));
    }

    /// The first host says something, and two ticks pass.
    fn say(&mut self, message: &ToBoard) -> Vec<FromBoard> {
        self.say_as(FIRST, message)
    }

    fn say_as(&mut self, session: u32, message: &ToBoard) -> Vec<FromBoard> {
        self.send(session, message);
        let mut said = self.tick();
        said.extend(self.tick());
        said
    }

    /// So many ticks, in which a host says something every 20 ms.
    fn pass(&mut self, ticks: u32, heartbeat_of: Option<u32>) -> Vec<FromBoard> {
        (0..ticks)
            .flat_map(|tick| {
                if let Some(session) = heartbeat_of.filter(|_| tick % 80 == 0) {
                    self.send(session, &ToBoard::Heartbeat);
                }
                self.tick()
            })
            .collect()
    }

    /// Both axes enabled, the first host's.
    fn enabled() -> Self {
        let mut bench = Self::configured();
        for axis in 0..2 {
            let request = Request::Enable { axis };
            assert_eq!(bench.verdict(&ToBoard::Request { id: 2 + axis as u16, request }), Verdict::Accepted);
        }
        bench
    }

    fn phase(&self) -> Phase {
        self.application.output().status.axes[0].phase
    }

    fn verdict(&mut self, message: &ToBoard) -> Verdict {
        let said = self.say(message);
        let acks = said.iter().filter_map(|m| if let FromBoard::Ack(ack) = m { Some(ack.verdict) } else { None });
        let verdicts: Vec<_> = acks.collect();
        assert_eq!(verdicts.len(), 1, "{said:?}");
        verdicts[0]
    }
}

const ENABLE: Request = Request::Enable { axis: 0 };

fn turned_away(said: &[FromBoard]) -> Vec<TurnedAway> {
    said.iter().filter_map(|m| if let FromBoard::TurnedAway(t) = m { Some(*t) } else { None }).collect()
}

#[test]
fn who_does_not_greet_is_not_heard_and_learns_that_nobody_has_the_board() {
    let mut bench = Bench::new();
    bench.pass(50, None);
    let nobody = TurnedAway { session: FIRST, holder: NOBODY, holder_frames: 0, free_in_us: 0 };
    assert_eq!(bench.say(&ToBoard::Request { id: 1, request: ENABLE }), [FromBoard::TurnedAway(nobody)]);
    bench.pass(50, None);
    assert_eq!(bench.say(&ToBoard::TimeRequest { host_sent_us: 1 }), [FromBoard::TurnedAway(nobody)]);
    assert!(matches!(bench.say(&ToBoard::Hello)[..], [FromBoard::Hello(_), FromBoard::Health(_)]));
}

#[test]
fn the_hello_tells_board_rate_and_the_last_reset() {
    let said = Bench::new().say(&ToBoard::Hello);
    let FromBoard::Hello(hello) = said[0] else { panic!("{said:?}") };
    assert_eq!((hello.board, hello.boot, hello.was_watchdog_reset), (BoardId::Twin, 5, true));
    assert_eq!(hello.session, FIRST, "the answer says whom it is for");
    assert_eq!((hello.baud, hello.telemetry_every), (921_600, 4), "921,600 baud carry every fourth tick");
}

#[test]
fn at_921600_every_fourth_tick_is_reported() {
    let mut bench = Bench::configured();
    let mut ticks = vec![];
    for _ in 0..400 {
        bench.board.waiting += 1;
        while bench.application.turn(&mut bench.board) {}
        for byte in std::mem::take(&mut bench.board.from_board) {
            if let Some(FromBoard::Telemetry(t)) = bench.reader.feed(byte).map(|received| received.message) {
                ticks.push(t.tick);
            }
        }
    }
    assert_eq!(ticks.len(), 100);
    assert!(ticks.windows(2).all(|pair| pair[1] - pair[0] == 4));
}

#[test]
fn another_version_is_told_ours_and_takes_nothing_from_the_host_that_drives() {
    let mut bench = Bench::configured();
    let said = bench.say_as(SECOND, &ToBoard::ForeignHello { version: 9 });
    // The answer is a hello cut short behind the version, which only an end with another version can read.
    assert_eq!(bench.reader.counts().unknown, 1);
    assert!(said.iter().any(|m| matches!(m, FromBoard::Event(e) if e.kind == EventKind::VersionMismatch(9))));
    assert_eq!(bench.verdict(&ToBoard::Request { id: 2, request: ENABLE }), Verdict::Accepted);
}

#[test]
fn without_a_configuration_nothing_moves() {
    let mut bench = Bench::new();
    bench.say(&ToBoard::Hello);
    assert_eq!(bench.verdict(&ToBoard::Request { id: 1, request: ENABLE }), Verdict::NotConfigured);
    let bad = Config { tick_us: 0, ..CONFIG };
    assert_eq!(bench.verdict(&ToBoard::Configure { id: 2, config: bad }), Verdict::BadConfiguration);
    assert!(!bench.board.is_enabled);
}

#[test]
fn a_repeated_request_is_answered_again_and_carried_out_once() {
    let mut bench = Bench::configured();
    assert_eq!(bench.verdict(&ToBoard::Request { id: 2, request: ENABLE }), Verdict::Accepted);
    let home = |id| ToBoard::Request { id, request: Request::Home { axis: 0 } };
    assert_eq!(bench.verdict(&home(3)), Verdict::Accepted);
    assert_eq!(bench.verdict(&home(3)), Verdict::Accepted, "the same answer again");
    assert_eq!(bench.verdict(&home(4)), Verdict::Refused(Refusal::Busy), "another request: the axis is homing");
}

#[test]
fn requests_that_come_within_a_tick_are_all_answered() {
    let mut bench = Bench::configured();
    for id in 2..6 {
        bench.send(FIRST, &ToBoard::Request { id, request: Request::Enable { axis: usize::from(id % 2) } });
    }
    let said: Vec<_> = (0..6).flat_map(|_| bench.tick()).collect();
    let ids: Vec<_> = said.iter().filter_map(|m| if let FromBoard::Ack(a) = m { Some(a.id) } else { None }).collect();
    assert_eq!(ids, [2, 3, 4, 5], "{said:?}");
}

#[test]
fn what_the_controller_refuses_is_reported_by_name() {
    let mut bench = Bench::configured();
    let verdict = bench.verdict(&ToBoard::Request { id: 2, request: Request::Home { axis: 7 } });
    assert_eq!(verdict, Verdict::Refused(Refusal::NoSuchAxis));
    let verdict = bench.verdict(&ToBoard::Request { id: 3, request: Request::Clear(Fault::OverSpeed) });
    assert_eq!(verdict, Verdict::Refused(Refusal::NotCleared));
}

#[test]
fn no_configuration_is_taken_while_an_axis_is_enabled() {
    let mut bench = Bench::configured();
    assert_eq!(bench.verdict(&ToBoard::Request { id: 2, request: ENABLE }), Verdict::Accepted);
    assert_eq!(bench.verdict(&ToBoard::Configure { id: 3, config: CONFIG }), Verdict::NotNow);
}

#[test]
fn a_skipped_tick_is_reported_and_counted() {
    let mut bench = Bench::configured();
    bench.board.waiting += 2; // and a third with `tick`
    let said = bench.tick();
    assert!(said.iter().any(|m| matches!(m, FromBoard::Event(e) if e.kind == EventKind::Overrun(2))), "{said:?}");
    assert_eq!(bench.application.overruns(), 2);
}

#[test]
fn the_time_comes_back_with_both_stamps_of_the_board() {
    let mut bench = Bench::configured();
    let said = bench.say(&ToBoard::TimeRequest { host_sent_us: u64::MAX });
    let [FromBoard::TimeReply(reply)] = said[..] else { panic!("{said:?}") };
    assert_eq!(reply.host_sent_us, u64::MAX);
    assert!(reply.board_sent_us > reply.board_received_us, "each reading of this clock takes 7 µs: {reply:?}");
}

#[test]
fn in_lock_step_a_number_is_stepped_once_and_no_torque_leaves_the_board() {
    let mut bench = Bench::configured();
    let mut ask = |number| -> Vec<LockStepReply> {
        let tick = Tick { latched_us: number * 250, is_host_heard: true, ..Tick::default() };
        let said = bench.say(&ToBoard::LockStep { number, tick });
        said.into_iter().filter_map(|m| if let FromBoard::LockStep(reply) = m { Some(reply) } else { None }).collect()
    };
    let first = ask(0);
    assert_eq!(first.len(), 1);
    assert_eq!(ask(0), first, "again, the same");
    assert_eq!(ask(2), [], "not before the one between");
    assert_eq!(ask(1).len(), 1);
    assert_eq!(ask(0), [], "too late");
    assert!(!bench.board.is_enabled);
}

#[test]
fn a_second_host_is_turned_away_and_nothing_that_it_asks_for_is_done() {
    let mut bench = Bench::enabled();
    bench.send(FIRST, &ToBoard::Heartbeat);
    let said = bench.say_as(SECOND, &ToBoard::Hello);
    let [refused] = turned_away(&said)[..] else { panic!("{said:?}") };
    assert_eq!((refused.session, refused.holder), (SECOND, FIRST));
    assert!((200_000..=200_000 + AFTER_SILENCE_US).contains(&refused.free_in_us), "{refused:?}");
    assert!(!said.iter().any(|m| matches!(m, FromBoard::Hello(_))), "{said:?}");

    let slow = Config { late_us: 900, ..CONFIG };
    for (k, says) in [
        ToBoard::Request { id: 9, request: Request::Disable { axis: 0 } },
        ToBoard::Request { id: 10, request: Request::Home { axis: 0 } },
        ToBoard::Request { id: 11, request: Request::RecorderFailed },
        ToBoard::Configure { id: 12, config: slow },
        ToBoard::LockStep { number: 0, tick: Tick::default() },
        ToBoard::TimeRequest { host_sent_us: 3 },
        ToBoard::Heartbeat,
    ]
    .into_iter()
    .enumerate()
    {
        let before = *bench.application.output();
        bench.send(FIRST, &ToBoard::Heartbeat);
        bench.send(SECOND, &says);
        let said = bench.pass(100, None);
        assert!(matches!(said[..], [FromBoard::TurnedAway(t)] if t.session == SECOND), "{k}: {says:?}: {said:?}");
        assert_eq!(bench.phase(), Phase::Holding, "{says:?}");
        assert_eq!(
            bench.application.output().status.axes[0].reference_m,
            before.status.axes[0].reference_m,
            "{says:?}"
        );
    }
    // It is the first one's board as before, whatever numbers the second one's frames had.
    bench.writers.insert(SECOND, FrameWriter::starting_at(9_000));
    bench.say_as(SECOND, &ToBoard::Heartbeat);
    assert_eq!(bench.verdict(&ToBoard::Request { id: 4, request: Request::Home { axis: 0 } }), Verdict::Accepted);
    let FromBoard::Health(health) = bench.say(&ToBoard::Hello)[1] else { panic!() };
    assert_eq!((health.lost, health.late, health.duplicates), (0, 0, 0), "its frames are no gap in the first one's");
}

#[test]
fn signs_of_life_of_another_host_do_not_keep_the_first_one_alive() {
    let mut bench = Bench::enabled();
    bench.send(FIRST, &ToBoard::Heartbeat);
    let said = bench.pass(4_000, Some(SECOND));
    let faults = said.iter().filter_map(|m| if let FromBoard::Fault(report) = m { Some(report) } else { None });
    assert_eq!(faults.map(|report| report.fault).collect::<Vec<_>>(), [Fault::HostSilent]);
    assert_eq!(bench.phase(), Phase::Disabled);
}

#[test]
fn a_stop_is_obeyed_from_everybody_whatever_its_number() {
    let stop = |id, category| ToBoard::Request { id, request: Request::Stop(category) };
    // The number of the first host's last request, and one of its own; a session that greeted in vain, one that never did, and nobody.
    for (session, id) in [(SECOND, 3), (SECOND, 70), (SECOND + 1, 3), (NOBODY, 1)] {
        for category in [StopCategory::Zero, StopCategory::One] {
            let mut bench = Bench::enabled();
            bench.say_as(SECOND, &ToBoard::Hello);
            let said = bench.say_as(session, &stop(id, category));
            let acks = said.iter().filter_map(|m| if let FromBoard::Ack(ack) = m { Some(*ack) } else { None });
            let acks: Vec<_> = acks.collect();
            assert!(
                matches!(acks[..], [Ack { session: of, id: numbered, verdict: Verdict::Accepted, .. }]
                if (of, numbered) == (session, id)),
                "{said:?}"
            );
            bench.pass(3_000, Some(FIRST));
            assert_eq!(bench.phase(), Phase::Disabled, "{category:?} from {session}");
            // Its answer is not taken for the first one's: the next request of that number is a new one.
            let enable = ToBoard::Request { id: 70, request: ENABLE };
            assert_eq!(bench.verdict(&enable), Verdict::Accepted);
            assert_eq!(bench.phase(), Phase::Holding);
        }
    }
}

#[test]
fn there_is_room_for_a_stop_however_much_is_asked_for() {
    let mut bench = Bench::enabled();
    for id in 10..30 {
        bench.send(FIRST, &ToBoard::Request { id, request: Request::Enable { axis: 1 } });
    }
    bench.send(SECOND, &ToBoard::Request { id: 1, request: Request::Stop(StopCategory::Zero) });
    let said: Vec<_> = (0..2).flat_map(|_| bench.tick()).collect();
    let mut answers = said.iter().filter_map(|m| if let FromBoard::Ack(ack) = m { Some(*ack) } else { None });
    assert!(answers.any(|ack| (ack.session, ack.id, ack.verdict) == (SECOND, 1, Verdict::Accepted)), "{said:?}");
    assert!(!bench.board.is_enabled);
}

#[test]
fn what_was_asked_for_before_a_stop_is_not_begun_after_it() {
    let mut bench = Bench::enabled();
    for (session, id) in [(FIRST, 11), (SECOND, 1)] {
        bench.send(FIRST, &ToBoard::Request { id: id + 20, request: Request::Home { axis: 0 } });
        bench.send(session, &ToBoard::Request { id, request: Request::Stop(StopCategory::Two) });
        let said: Vec<_> = (0..20).flat_map(|_| bench.tick()).collect();
        let verdict = |asked: (u32, u16)| {
            said.iter().find_map(|m| match m {
                FromBoard::Ack(ack) if (ack.session, ack.id) == asked => Some(ack.verdict),
                _ => None,
            })
        };
        assert_eq!(verdict((FIRST, id + 20)), Some(Verdict::Refused(Refusal::Busy)), "{said:?}");
        assert_eq!(verdict((session, id)), Some(Verdict::Accepted), "{said:?}");
        assert_eq!(bench.application.output().status.axes[0].phase, Phase::Holding);
    }
}

#[test]
fn after_its_silence_the_next_one_that_greets_has_the_board_and_the_first_one_is_reported() {
    let mut bench = Bench::enabled();
    bench.send(FIRST, &ToBoard::Heartbeat);
    bench.pass(800, None);
    let said = bench.say_as(SECOND, &ToBoard::Hello);
    let [refused] = turned_away(&said)[..] else { panic!("{said:?}") };
    // Said at the tick after the one that it came in.
    assert_eq!(refused.free_in_us, AFTER_SILENCE_US - 250, "the controller judges the silence first");
    bench.pass(40, None);
    let silent = Some((Fault::HostSilent, 2));
    assert_eq!(bench.application.output().status.fault, silent, "it stopped before anybody could take it over");
    let said = bench.say_as(SECOND, &ToBoard::Hello);
    assert!(said.iter().any(|m| matches!(m, FromBoard::Hello(hello) if hello.session == SECOND)), "{said:?}");

    // The first one wakes up: its operator's answer comes too late for it.
    bench.pass(100, Some(SECOND));
    let said = bench.say(&ToBoard::Request { id: 4, request: Request::Clear(Fault::HostSilent) });
    assert!(matches!(turned_away(&said)[..], [TurnedAway { session: FIRST, holder: SECOND, .. }]), "{said:?}");
    bench.pass(100, Some(SECOND));
    assert_eq!(bench.application.output().status.fault, silent);
    let said = bench.say_as(SECOND, &ToBoard::Request { id: 1, request: Request::Clear(Fault::HostSilent) });
    let cleared = |m: &FromBoard| matches!(m, FromBoard::Ack(Ack { session: SECOND, verdict: Verdict::Accepted, .. }));
    assert!(said.iter().any(cleared), "{said:?}");
}

#[test]
fn how_long_the_board_waits_is_what_the_configuration_says() {
    let mut bench = Bench::new();
    bench.say(&ToBoard::Hello);
    let patient = Config { host_silence_us: 2_000_000, ..CONFIG };
    assert_eq!(bench.verdict(&ToBoard::Configure { id: 1, config: patient }), Verdict::Accepted);
    bench.pass(7_990, None);
    assert_eq!(turned_away(&bench.say_as(SECOND, &ToBoard::Hello)).len(), 1);
    bench.pass(60, None);
    assert_eq!(turned_away(&bench.say_as(SECOND, &ToBoard::Hello)).len(), 0);
}

#[test]
fn a_repeated_hello_changes_nothing() {
    let mut bench = Bench::enabled();
    let home = ToBoard::Request { id: 4, request: Request::Home { axis: 0 } };
    assert_eq!(bench.verdict(&home), Verdict::Accepted);
    let said = bench.say(&ToBoard::Hello);
    assert!(matches!(said[..], [FromBoard::Hello(_), FromBoard::Health(_)]), "{said:?}");
    assert_eq!(bench.verdict(&home), Verdict::Accepted, "the same answer again: carried out twice it would be Busy");
}

#[test]
fn hosts_that_are_turned_away_cannot_fill_the_line() {
    let mut bench = Bench::configured();
    let mut told = 0;
    for _ in 0..4_000 {
        bench.send(FIRST, &ToBoard::Heartbeat);
        bench.send(SECOND, &ToBoard::Hello);
        bench.send(SECOND, &ToBoard::Heartbeat);
        told += turned_away(&bench.tick()).len();
    }
    assert!((95..=100).contains(&told), "{told} in a second");
}

#[test]
fn the_session_of_nobody_has_no_board() {
    let mut bench = Bench::new();
    bench.pass(50, None);
    assert_eq!(turned_away(&bench.say_as(NOBODY, &ToBoard::Hello)).len(), 1);
    bench.pass(50, None);
    assert_eq!(turned_away(&bench.say_as(NOBODY, &ToBoard::Configure { id: 1, config: CONFIG })).len(), 1);
}
