//! Frames: COBS(kind, sequence, body, CRC-32), closed by a zero byte.
//!
//! The zero stands nowhere else, so a reader that was thrown off finds the next frame by itself. A frame counts only if its CRC
//! fits, its kind is known and its body has exactly that kind's length. Who said it, and in which order its frames came, is the
//! business of whoever reads them ([`crate::sequence`], [`crate::session`]): on one line more than one host may speak.

use cobs::{CobsEncoder, DecodeResult, DecoderState};
use crc::{CRC_32_ISO_HDLC, Crc, Table};

use crate::codec::{Reader, Wire, Writer};

/// CRC-32 as Ethernet's: it sees every error of one to five bits in 64 bytes, and every burst up to 32 bits.
static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// Longest unencoded frame: kind, sequence number, body, CRC.
pub const MAX_PLAIN: usize = 640;
/// Longest frame on the wire: COBS adds a byte per 254, the zero closes it.
pub const MAX_WIRE: usize = cobs::max_encoding_length(MAX_PLAIN) + 1;
/// Kind, sequence number, CRC, one COBS byte and the zero.
pub const OVERHEAD: usize = 1 + 2 + 4 + 1 + 1;

/// What one end may say.
pub trait Message: Sized {
    /// The first byte of its frame.
    fn kind(&self) -> u8;
    #[doc(hidden)]
    fn write_body(&self, to: &mut Body<'_, '_>);
    #[doc(hidden)]
    fn read_body(kind: u8, from: &mut BodyReader<'_, '_>) -> Option<Self>;
}

/// The body of a frame being written.
pub struct Body<'w, 'a>(pub(crate) &'w mut Writer<'a>);
/// The body of a frame being read.
pub struct BodyReader<'r, 'a>(pub(crate) &'r mut Reader<'a>);

/// Numbers and frames the messages of one direction.
#[derive(Debug, Clone, Copy, Default)]
pub struct FrameWriter {
    sequence: u16,
}

impl FrameWriter {
    /// Starts with the number that the next frame shall have.
    #[must_use]
    pub const fn starting_at(sequence: u16) -> Self {
        Self { sequence }
    }

    /// The frame of `message`, ready for the line; empty if `wire` is too short for it.
    pub fn write<'w, M: Message>(&mut self, message: &M, wire: &'w mut [u8]) -> &'w [u8] {
        let mut plain = [0_u8; MAX_PLAIN];
        let mut to = Writer::new(&mut plain);
        message.kind().put(&mut to);
        self.sequence.put(&mut to);
        message.write_body(&mut Body(&mut to));
        self.sequence = self.sequence.wrapping_add(1);
        let Some(framed) = to.finish() else { return &[] };
        let check = CRC.checksum(framed).to_le_bytes();
        let mut encoder = CobsEncoder::new(&mut *wire);
        if encoder.push(framed).is_err() || encoder.push(&check).is_err() {
            return &[];
        }
        let len = encoder.finalize();
        match wire.get_mut(len) {
            Some(end) => *end = 0,
            None => return &[],
        }
        wire.get(..=len).unwrap_or(&[])
    }
}

/// What a reader has counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LinkCounts {
    /// Frames delivered, repetitions and late ones included.
    pub frames: u32,
    /// Pieces between two zeros that were no valid frame: noise, flipped bits, halves of frames.
    pub corrupt: u32,
    /// Valid frames of a kind, or with a body, that this version does not know.
    pub unknown: u32,
}

/// A message with its number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Received<M> {
    /// What was said.
    pub message: M,
    /// Its number.
    pub sequence: u16,
}

/// Finds frames in a stream of bytes.
pub struct FrameReader<M> {
    cobs: DecoderState,
    plain: [u8; MAX_PLAIN],
    len: usize,
    /// Since the last zero something was wrong: everything up to the next one is dropped.
    is_spoilt: bool,
    counts: LinkCounts,
    says: core::marker::PhantomData<M>,
}

impl<M> Clone for FrameReader<M> {
    fn clone(&self) -> Self {
        #[allow(clippy::needless_match)] // the decoder's state is no Clone
        let cobs = match self.cobs {
            DecoderState::Idle => DecoderState::Idle,
            DecoderState::Grab(left) => DecoderState::Grab(left),
            DecoderState::GrabChain(left) => DecoderState::GrabChain(left),
        };
        Self { cobs, ..*self }
    }
}

impl<M: Message> Default for FrameReader<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: Message> FrameReader<M> {
    /// A reader in front of the first byte.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            cobs: DecoderState::Idle,
            plain: [0; MAX_PLAIN],
            len: 0,
            is_spoilt: false,
            counts: LinkCounts { frames: 0, corrupt: 0, unknown: 0 },
            says: core::marker::PhantomData,
        }
    }

    /// What was counted so far.
    #[must_use]
    pub const fn counts(&self) -> LinkCounts {
        self.counts
    }

    /// Takes the next byte of the line; a message when that byte completes one.
    pub fn feed(&mut self, byte: u8) -> Option<Received<M>> {
        if byte == 0 {
            return self.close();
        }
        if self.is_spoilt {
            return None;
        }
        match self.cobs.feed(byte) {
            Ok(DecodeResult::DataContinue(plain)) => self.keep(plain),
            Ok(DecodeResult::NoData | DecodeResult::DataStart) => {}
            Ok(DecodeResult::DataComplete) | Err(_) => self.is_spoilt = true,
        }
        None
    }

    fn keep(&mut self, plain: u8) {
        match self.plain.get_mut(self.len) {
            Some(place) => *place = plain,
            None => self.is_spoilt = true,
        }
        self.len = self.len.wrapping_add(1);
    }

    /// A zero came: what stands between it and the last one is a frame or nothing.
    fn close(&mut self) -> Option<Received<M>> {
        let had_bytes = self.is_spoilt || !matches!(self.cobs, DecoderState::Idle);
        let is_whole = !self.is_spoilt && matches!(self.cobs.feed(0), Ok(DecodeResult::DataComplete));
        let len = self.len;
        (self.cobs, self.len, self.is_spoilt) = (DecoderState::Idle, 0, false);
        if !had_bytes {
            return None; // two zeros in a row say nothing
        }
        let framed = if is_whole { self.plain.get(..len).and_then(checked) } else { None };
        let Some(framed) = framed else {
            self.counts.corrupt = self.counts.corrupt.wrapping_add(1);
            return None;
        };
        let mut from = Reader::new(framed);
        let (kind, sequence) = (u8::take(&mut from)?, u16::take(&mut from)?);
        let message = M::read_body(kind, &mut BodyReader(&mut from)).filter(|_| from.is_empty());
        let Some(message) = message else {
            self.counts.unknown = self.counts.unknown.wrapping_add(1);
            return None;
        };
        self.counts.frames = self.counts.frames.wrapping_add(1);
        Some(Received { message, sequence })
    }
}

/// The frame without its CRC, if that fits and there is room for kind and number.
fn checked(plain: &[u8]) -> Option<&[u8]> {
    let (framed, check) = plain.split_last_chunk::<4>()?;
    (framed.len() >= 3 && CRC.checksum(framed) == u32::from_le_bytes(*check)).then_some(framed)
}
