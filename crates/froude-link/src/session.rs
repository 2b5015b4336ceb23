//! One operator: which host has the board.
//!
//! Every host draws a number when it starts, its session, and says it in every frame. The first one that greets has the board; as
//! long as it gives signs of life another one is turned away, whatever it asks for. After the holder's silence the next one that
//! greets has it. A stop is no question of sessions: it is obeyed from everybody.
//!
//! **What it is for.** Two programs of well-meaning people on one line: a second terminal, a program that was suspended and wakes up.
//! A session is a name and proves nothing; whoever reaches the line can say any number.
//!
//! **Time.** The holder loses the board [`AFTER_SILENCE_US`] later than the controller's own limit of the host's silence, so that the
//! controller has stopped for its host's silence before another host can end that silence.

/// The session of nobody: it has no board and can have none.
pub const NOBODY: u32 = 0;
/// The controller notices the silence of its host so much before the board is free, µs.
pub const AFTER_SILENCE_US: u32 = 10_000;

/// What a hello came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Greeting {
    /// It has the board from now on: nobody had it, or the holder was silent for too long.
    Taken,
    /// It has the board already.
    Again,
    /// Another one has it.
    Refused,
}

/// Who has the board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Holder {
    session: u32,
    frames: u32,
    silent_us: u32,
}

impl Default for Holder {
    fn default() -> Self {
        Self::nobody()
    }
}

impl Holder {
    /// Nobody.
    #[must_use]
    pub const fn nobody() -> Self {
        Self { session: NOBODY, frames: 0, silent_us: 0 }
    }

    /// The session that has the board, or [`NOBODY`].
    #[must_use]
    pub const fn session(&self) -> u32 {
        self.session
    }

    /// Frames heard from it; wraps.
    #[must_use]
    pub const fn frames(&self) -> u32 {
        self.frames
    }

    /// Time passes, µs.
    pub const fn pass(&mut self, us: u32) {
        self.silent_us = self.silent_us.saturating_add(us);
    }

    /// Silent for so long more, the holder loses the board, µs. `silence_us` is the controller's limit of the host's silence.
    #[must_use]
    pub const fn free_in_us(&self, silence_us: u32) -> u32 {
        if self.session == NOBODY {
            return 0;
        }
        silence_us.saturating_add(AFTER_SILENCE_US).saturating_sub(self.silent_us)
    }

    /// A session says hello.
    pub const fn greet(&mut self, session: u32, silence_us: u32) -> Greeting {
        if self.hear(session) {
            return Greeting::Again;
        }
        if session == NOBODY || self.free_in_us(silence_us) > 0 {
            return Greeting::Refused;
        }
        *self = Self { session, frames: 1, silent_us: 0 };
        Greeting::Taken
    }

    /// A session says anything else; whether it has the board. If it has, that was a sign of life.
    pub const fn hear(&mut self, session: u32) -> bool {
        if session == NOBODY || session != self.session {
            return false;
        }
        self.frames = self.frames.wrapping_add(1);
        self.silent_us = 0;
        true
    }
}
