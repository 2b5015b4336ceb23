//! What the application says to a host, on a board that is nothing but queues.

use std::collections::VecDeque;

use froude_board::board::{AxisLatched, Latched, Scales};
use froude_board::rig::CONFIG;
use froude_board::{Application, Board};
use froude_control::config::Config;
use froude_control::fault::Fault;
use froude_control::request::Request;
use froude_control::status::Refusal;
use froude_control::tick::{Command, Tick};
use froude_link::frame::{FrameReader, FrameWriter, MAX_WIRE};
use froude_link::status::{BoardId, EventKind, LockStepReply, Verdict};
use froude_link::{FromBoard, ToBoard};

/// A board whose ticks come when they are told to.
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

/// Application, board and host.
struct Bench {
    application: Application,
    board: Queues,
    writer: FrameWriter,
    reader: FrameReader<FromBoard>,
}

impl Bench {
    fn new() -> Self {
        let reader = FrameReader::new();
        Self { application: Application::new(), board: Queues::default(), writer: FrameWriter::default(), reader }
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

    fn say(&mut self, message: &ToBoard) -> Vec<FromBoard> {
        let mut wire = [0; MAX_WIRE];
        self.board.to_board.extend(self.writer.write(message, &mut wire));
        let mut said = self.tick();
        said.extend(self.tick());
        said
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

#[test]
fn who_does_not_greet_is_not_heard() {
    let mut bench = Bench::new();
    assert_eq!(bench.say(&ToBoard::Request { id: 1, request: ENABLE }), []);
    assert_eq!(bench.say(&ToBoard::TimeRequest { host_sent_us: 1 }), []);
    assert!(matches!(bench.say(&ToBoard::Hello)[..], [FromBoard::Hello(_), FromBoard::Health(_)]));
}

#[test]
fn the_hello_tells_board_rate_and_the_last_reset() {
    let said = Bench::new().say(&ToBoard::Hello);
    let FromBoard::Hello(hello) = said[0] else { panic!("{said:?}") };
    assert_eq!((hello.board, hello.boot, hello.was_watchdog_reset), (BoardId::Twin, 5, true));
    assert_eq!((hello.baud, hello.telemetry_every), (921_600, 4), "921,600 baud carry every fourth tick");
}

#[test]
fn at_921600_every_fourth_tick_is_told() {
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
fn another_version_is_told_ours_and_nothing_more() {
    let mut bench = Bench::configured();
    let said = bench.say(&ToBoard::ForeignHello { version: 9 });
    // The answer is a hello cut short behind the version, which only an end with another version can read.
    assert_eq!(bench.reader.counts().unknown, 1);
    assert!(said.iter().any(|m| matches!(m, FromBoard::Event(e) if e.kind == EventKind::VersionMismatch(9))));
    assert_eq!(bench.say(&ToBoard::Request { id: 2, request: ENABLE }), [], "it must greet properly first");
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
    let mut wire = [0; MAX_WIRE];
    for id in 2..6 {
        let request = Request::Enable { axis: usize::from(id % 2) };
        bench.board.to_board.extend(bench.writer.write(&ToBoard::Request { id, request }, &mut wire));
    }
    let said: Vec<_> = (0..6).flat_map(|_| bench.tick()).collect();
    let ids: Vec<_> = said.iter().filter_map(|m| if let FromBoard::Ack(a) = m { Some(a.id) } else { None }).collect();
    assert_eq!(ids, [2, 3, 4, 5], "{said:?}");
}

#[test]
fn what_the_controller_refuses_is_told_by_name() {
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
fn a_skipped_tick_is_told_and_counted() {
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
