//! The serial line: any bytes in both directions. No panic, nothing delivered that was not framed, and every message that is delivered
//! is written and read back as it was.
//!
//! The input is pieces: two bytes (little endian), the lower ten bits the length, then so many bytes. With the upper bit they go on the
//! line as they are; without it they are kind, number and body of a frame, closed here with its CRC, which no fuzzer finds by itself.
#![no_main]

use froude_link::frame::{FrameReader, FrameWriter, MAX_WIRE, Message};
use froude_link::message::{FromBoard, HostFrame};
use libfuzzer_sys::fuzz_target;

/// COBS of these bytes and their CRC-32, and the zero that closes a frame.
fn framed(plain: &[u8]) -> Vec<u8> {
    let whole = [plain, &crc32fast::hash(plain).to_le_bytes()].concat();
    let mut out = vec![0];
    let (mut at, mut code) = (0, 1);
    let mut close = |out: &mut Vec<u8>, code: &mut u8| {
        out[at] = std::mem::replace(code, 1);
        at = out.len();
        out.push(0);
    };
    for byte in whole {
        if byte != 0 {
            out.push(byte);
            code += 1;
        }
        if byte == 0 || code == 255 {
            close(&mut out, &mut code);
        }
    }
    close(&mut out, &mut code);
    out
}

fn line(mut pieces: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    while let Some((head, rest)) = pieces.split_first_chunk::<2>() {
        let head = u16::from_le_bytes(*head);
        let (piece, rest) = rest.split_at(usize::from(head & 0x3ff).min(rest.len()));
        if head & 0x8000 == 0 {
            out.extend(framed(piece))
        } else {
            out.extend_from_slice(piece)
        }
        pieces = rest;
    }
    out
}

fn read<M: Message>(bytes: &[u8]) {
    let mut reader = FrameReader::<M>::new();
    let delivered: Vec<M> = bytes.iter().filter_map(|byte| reader.feed(*byte)).map(|r| r.message).collect();
    let counts = reader.counts();
    let closed = bytes.iter().filter(|b| **b == 0).count() as u64;
    assert_eq!(delivered.len() as u64, u64::from(counts.frames));
    assert!(u64::from(counts.frames) + u64::from(counts.corrupt) + u64::from(counts.unknown) <= closed);
    for message in delivered {
        // On the wire and not as messages: a NaN is not equal to itself.
        let frame = |message: &M| {
            let mut wire = [0; MAX_WIRE];
            FrameWriter::default().write(message, &mut wire).to_vec()
        };
        let sent = frame(&message);
        let mut again = FrameReader::<M>::new();
        let read: Vec<M> = sent.iter().filter_map(|byte| again.feed(*byte)).map(|r| r.message).collect();
        assert!(!sent.is_empty() && read.len() == 1);
        assert_eq!(frame(&read[0]), sent);
    }
}

fuzz_target!(|bytes: &[u8]| {
    let line = line(bytes);
    read::<HostFrame>(&line);
    read::<FromBoard>(&line);
});
