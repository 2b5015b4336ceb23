//! A line that loses, repeats, damages and delays frames, and keeps count.

/// What was done to frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Damage {
    /// Never delivered.
    pub dropped: u32,
    /// Delivered twice.
    pub repeated: u32,
    /// Delivered with a bit flipped.
    pub damaged: u32,
    /// Delivered after their successor.
    pub delayed: u32,
}

/// One direction of a line.
#[derive(Debug, Clone)]
pub struct Line {
    state: u64,
    per_mille: u64,
    held: Option<Vec<u8>>,
    partial: Vec<u8>,
    /// What was done so far.
    pub damage: Damage,
}

impl Line {
    /// One that delivers what it is given.
    #[must_use]
    pub const fn clean() -> Self {
        Self::bad(0, 0)
    }

    /// One that does each of the four things to `per_mille` of the frames.
    #[must_use]
    pub const fn bad(per_mille: u64, seed: u64) -> Self {
        let damage = Damage { dropped: 0, repeated: 0, damaged: 0, delayed: 0 };
        Self { state: seed, per_mille, held: None, partial: Vec::new(), damage }
    }

    /// SplitMix64 (Steele, Lea and Flood 2014).
    fn draw(&mut self, below: u64) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % below
    }

    /// What arrives when this frame is sent.
    pub fn pass(&mut self, frame: &[u8]) -> Vec<u8> {
        if self.per_mille == 0 {
            return frame.to_vec();
        }
        let mut arrives = Vec::new();
        let fate = self.draw(1000) / self.per_mille;
        match fate {
            0 => self.damage.dropped += 1,
            1 => {
                self.damage.repeated += 1;
                arrives.extend_from_slice(frame);
                arrives.extend_from_slice(frame);
            }
            2 => {
                self.damage.damaged += 1;
                let mut hit = frame.to_vec();
                let (place, bit) = (self.draw(frame.len() as u64 - 1) as usize, self.draw(8));
                hit[place] ^= 1 << bit;
                if hit[place] == 0 {
                    hit[place] = 0xff; // a zero would be two frames: that is for the property tests
                }
                if hit[place] == frame[place] {
                    hit[place] = 0x55;
                }
                arrives.extend(hit);
            }
            3 if self.held.is_none() => {
                self.damage.delayed += 1;
                self.held = Some(frame.to_vec());
                return arrives;
            }
            _ => arrives.extend_from_slice(frame),
        }
        if fate != 0 && fate != 2 {
            arrives.extend(self.held.take().unwrap_or_default());
        }
        arrives
    }

    /// The same for a stream of bytes, frame by frame.
    pub fn pass_stream(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut arrives = Vec::new();
        for &byte in bytes {
            self.partial.push(byte);
            if byte == 0 {
                let frame = std::mem::take(&mut self.partial);
                arrives.extend(self.pass(&frame));
            }
        }
        arrives
    }

    /// Whether a frame is still under way.
    #[must_use]
    pub const fn holds_one(&self) -> bool {
        self.held.is_some()
    }
}
