//! The framing: what goes in comes out, and nothing else ever does.

use crate::any;
use crate::any::{any_from_board, any_host_frame};
use froude_link::frame::{FrameReader, FrameWriter, MAX_WIRE, Message, Received};
use froude_link::sequence::{Arrival, Order};
use froude_link::session::NOBODY;
use froude_link::status::{BoardHello, BoardId};
use froude_link::{FromBoard, HostFrame, ToBoard};
use proptest::prelude::*;

fn framed<M: Message>(message: &M, sequence: u16) -> Vec<u8> {
    let mut wire = [0; MAX_WIRE];
    FrameWriter::starting_at(sequence).write(message, &mut wire).to_vec()
}

fn read<M: Message>(reader: &mut FrameReader<M>, bytes: &[u8]) -> Vec<Received<M>> {
    bytes.iter().filter_map(|&byte| reader.feed(byte)).collect()
}

proptest! {
    /// Bytes in, the same message out, to the last bit (`==` on floats would let −0 pass for 0 and stumble over NaN).
    #[test]
    fn every_message_to_the_board_comes_out_as_it_went_in(message in any_host_frame(), sequence: u16) {
        let wire = framed(&message, sequence);
        prop_assert!(wire.len() <= MAX_WIRE && wire.ends_with(&[0]));
        let got = read(&mut FrameReader::<HostFrame>::new(), &wire);
        prop_assert_eq!(got.len(), 1);
        prop_assert_eq!(format!("{:?}", got[0].message), format!("{message:?}"));
        prop_assert_eq!(framed(&got[0].message, got[0].sequence), wire);
    }

    #[test]
    fn every_message_from_the_board_comes_out_as_it_went_in(message in any_from_board(), sequence: u16) {
        let wire = framed(&message, sequence);
        let got = read(&mut FrameReader::<FromBoard>::new(), &wire);
        prop_assert_eq!(got.len(), 1);
        prop_assert_eq!(framed(&got[0].message, got[0].sequence), wire);
    }

    /// A telemetry frame fits its budget whatever it carries.
    #[test]
    fn telemetry_takes_at_most_sixty_bytes(message in any::any_telemetry(), sequence: u16) {
        let len = framed(&FromBoard::Telemetry(message), sequence).len();
        prop_assert_eq!(len, froude_link::budget::TELEMETRY_WIRE_BYTES as usize);
        prop_assert!(len <= 60);
    }

    #[test]
    fn noise_never_panics_and_never_speaks(noise in prop::collection::vec(any::<u8>(), 0..2000)) {
        let mut board = FrameReader::<HostFrame>::new();
        let mut host = FrameReader::<FromBoard>::new();
        // 2⁻³² for each of at most 667 pieces: a false frame in 10⁴ cases is a chance of 2·10⁻³ %.
        prop_assert!(read(&mut board, &noise).is_empty());
        prop_assert!(read(&mut host, &noise).is_empty());
    }

    #[test]
    fn after_any_noise_the_second_frame_is_understood(
        noise in prop::collection::vec(any::<u8>(), 0..700), message in any_from_board(),
    ) {
        let mut reader = FrameReader::<FromBoard>::new();
        read(&mut reader, &noise);
        read(&mut reader, &framed(&message, 1)); // the noise may run into this one
        let got = read(&mut reader, &framed(&message, 2));
        prop_assert_eq!(got.len(), 1);
        prop_assert_eq!(got[0].sequence, 2);
    }

    /// All bits of the frame, the closing zero included, one at a time; the frame after it must come through.
    #[test]
    fn one_flipped_bit_is_never_accepted(message in any_from_board(), sequence: u16) {
        let wire = framed(&message, sequence);
        let after = framed(&message, sequence.wrapping_add(1));
        for bit in 0..wire.len() * 8 {
            let mut hit = wire.clone();
            hit[bit / 8] ^= 1 << (bit % 8);
            let mut reader = FrameReader::<FromBoard>::new();
            let wrong = read(&mut reader, &hit);
            prop_assert!(wrong.is_empty(), "bit {bit} of {wire:?}");
            // Without its zero the frame swallows the next one: that is the price, and it is counted.
            let swallows = bit / 8 == wire.len() - 1;
            let got = read(&mut reader, &after);
            prop_assert_eq!(got.len(), usize::from(!swallows));
            prop_assert!(reader.counts().corrupt >= 1);
        }
    }

    /// What the line does to frames is what the counters say, exactly.
    #[test]
    fn loss_repetition_and_lateness_are_counted_exactly(
        start: u16,
        fates in prop::collection::vec(prop::sample::select(vec!["pass", "drop", "twice", "late", "flip"]), 1..400),
    ) {
        let heartbeat = ToBoard::Heartbeat.from_session(7);
        let mut writer = FrameWriter::starting_at(start);
        let mut order = Order::new();
        let mut reader = FrameReader::<HostFrame>::new();
        let mut held: Option<Vec<u8>> = None;
        let (mut lost, mut corrupt, mut duplicates, mut late, mut delivered) = (0, 0, 0, 0, 0);
        let mut trailing = 0; // losses after the last frame that arrived cannot be known yet
        let mut frames = vec![];
        let mut wire = [0; MAX_WIRE];
        frames.push(("pass", writer.write(&heartbeat, &mut wire).to_vec()));
        for fate in fates {
            frames.push((fate, writer.write(&heartbeat, &mut wire).to_vec()));
        }
        for (fate, mut bytes) in frames {
            match fate {
                "drop" => trailing += 1,
                "flip" => {
                    bytes[2] ^= 0x10; // inside the frame, not its end
                    if bytes[2] == 0 { bytes[2] = 0x0f; }
                    read(&mut reader, &bytes);
                    corrupt += 1;
                    trailing += 1;
                }
                "late" if held.is_none() => held = Some(bytes),
                _ => {
                    lost += trailing;
                    trailing = 0;
                    for received in read(&mut reader, &bytes) {
                        order.note(received.sequence);
                        delivered += 1;
                    }
                    if fate == "twice" {
                        let again = read(&mut reader, &bytes);
                        prop_assert_eq!(order.note(again[0].sequence), Arrival::Duplicate);
                        duplicates += 1;
                    }
                    if let Some(old) = held.take() {
                        let again = read(&mut reader, &old);
                        prop_assert_eq!(order.note(again[0].sequence), Arrival::Late);
                        late += 1;
                    }
                }
            }
        }
        let counts = reader.counts();
        prop_assert_eq!(order.counts().lost, lost);
        prop_assert_eq!(order.counts().duplicates, duplicates);
        prop_assert_eq!(order.counts().late, late);
        prop_assert_eq!(counts.corrupt, corrupt);
        prop_assert_eq!(counts.frames, delivered + duplicates + late);
    }
}

#[test]
fn a_long_gap_is_counted_to_the_frame() {
    for gap in [1_u16, 63, 64, 65, 4000, 32_766] {
        let mut order = Order::new();
        assert_eq!(order.note(65_000), Arrival::InOrder);
        assert_eq!(order.note(65_001_u16.wrapping_add(gap)), Arrival::AfterLoss(gap));
        assert_eq!(order.counts().lost, u32::from(gap));
    }
}

#[test]
fn another_version_is_recognised() {
    let foreign = ToBoard::ForeignHello { version: 9 }.from_session(NOBODY);
    assert_eq!(read(&mut FrameReader::<HostFrame>::new(), &framed(&foreign, 0))[0].message, foreign);
    let got = read(&mut FrameReader::<FromBoard>::new(), &framed(&FromBoard::ForeignHello { version: 9 }, 0));
    assert_eq!(got[0].message, FromBoard::ForeignHello { version: 9 });
}

/// A frame of a host as version 1 wrote it: without the session.
struct FirstVersion(HostFrame);

impl FirstVersion {
    fn framed(&self, sequence: u16) -> Vec<u8> {
        let mut plain = vec![];
        cobs_decoded(&framed(&self.0, sequence), &mut plain);
        let mut old = plain[..plain.len() - 4].to_vec();
        match self.0.says {
            // kind, number, magic, version, session
            ToBoard::Hello => {
                old.truncate(3 + 4);
                old.extend(1_u16.to_le_bytes());
            }
            _ => drop(old.drain(3..7)),
        }
        let check = CRC.checksum(&old).to_le_bytes();
        old.extend(check);
        let mut wire = vec![0; MAX_WIRE];
        let len = cobs::encode(&old, &mut wire);
        wire.truncate(len);
        wire.push(0);
        wire
    }
}

const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

fn cobs_decoded(wire: &[u8], plain: &mut Vec<u8>) {
    plain.resize(wire.len(), 0);
    let len = cobs::decode(&wire[..wire.len() - 1], plain).unwrap().frame_size();
    plain.truncate(len);
}

proptest! {
    /// A host of version 1 gets to say its version and nothing else: no other frame of it is one of ours by chance.
    #[test]
    fn of_the_first_version_only_the_hello_is_understood(frame in any_host_frame(), sequence: u16) {
        prop_assume!(!matches!(frame.says, ToBoard::ForeignHello { .. }));
        let got = read(&mut FrameReader::<HostFrame>::new(), &FirstVersion(frame).framed(sequence));
        let said: Vec<_> = got.iter().map(|received| received.message).collect();
        match frame.says {
            ToBoard::Hello => prop_assert_eq!(said, [ToBoard::ForeignHello { version: 1 }.from_session(NOBODY)]),
            _ => prop_assert!(said.is_empty(), "{:?} was read as {said:?}", frame),
        }
    }
}

#[test]
fn two_zeros_in_a_row_are_no_error() {
    let hello = BoardHello {
        board: BoardId::Twin,
        boot: 7,
        baud: 3_000_000,
        telemetry_every: 1,
        tick_us: 250,
        command_v_per_count: [10.0 / 32768.0; 2],
        current_a_per_count: [0.01; 2],
        is_configured: false,
        was_watchdog_reset: false,
        session: NOBODY,
    };
    let mut wire = vec![0, 0];
    wire.extend(framed(&FromBoard::Hello(hello), 0));
    wire.push(0);
    let mut reader = FrameReader::<FromBoard>::new();
    let got = read(&mut reader, &wire);
    assert_eq!(got[0].message, FromBoard::Hello(hello));
    assert_eq!(reader.counts().corrupt, 0);
}
