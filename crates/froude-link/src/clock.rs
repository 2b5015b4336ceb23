//! Offset of the board's clock from the host's, and how well it is known.
//!
//! **Setting.** The host stamps a request (h₁), the board its arrival and its answer (b₂, b₃), the host the answer's arrival (h₄).
//! The offset is θ = ((b₂ − h₁) + (b₃ − h₄))/2, wrong by at most half of the time spent on the line, δ = (h₄ − h₁) − (b₃ − b₂).
//! Queues only ever add to δ, so out of every group of exchanges the one with the smallest δ is kept (the minimum filter of NTP,
//! RFC 5905 §10). A straight line through those gives offset and drift.
//!
//! **Units.** µs; drift is dimensionless (1e-6 is a µs per s).
//!
//! The stated uncertainty has three parts, added in squares: the scatter about the line, the asymmetry of the line (uniform within
//! ± δ/2 of the best exchange: δ/√12) and the µs steps of both clocks. The asymmetry is shared by all exchanges, so more of them
//! do not make it smaller.

/// Exchanges out of which the quickest is kept.
pub const GROUP: usize = 8;
/// Groups that the line is laid through.
pub const KEPT: usize = 64;

/// Board time without wraps.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwrapped {
    last: Option<u32>,
    high: u64,
}

impl Unwrapped {
    /// The µs since the board's power-up, whole; readings must be less than 35 min apart, and may step back a little.
    pub fn unwrap(&mut self, low: u32) -> u64 {
        if let Some(last) = self.last {
            let step = low.wrapping_sub(last) as i32;
            self.high = self.high.wrapping_add_signed(i64::from(step));
        } else {
            self.high = u64::from(low);
        }
        self.last = Some(low);
        self.high
    }
}

/// One two-way exchange.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Exchange {
    /// h₁: the host sent its request, µs.
    pub host_sent_us: u64,
    /// b₂: the board had it, µs.
    pub board_received_us: u64,
    /// b₃: the board answered, µs.
    pub board_sent_us: u64,
    /// h₄: the host had the answer, µs.
    pub host_received_us: u64,
}

impl Exchange {
    /// Time on the line, both ways, µs; `None` if the stamps contradict each other.
    #[must_use]
    pub fn delay_us(&self) -> Option<u64> {
        let on_host = self.host_received_us.checked_sub(self.host_sent_us)?;
        on_host.checked_sub(self.board_sent_us.checked_sub(self.board_received_us)?)
    }

    /// Board minus host, µs, against whole base times (so that nothing is lost in the size of the numbers).
    fn offset_us(&self, host_base: u64, board_base: u64) -> f64 {
        let since = |time: u64, base: u64| time.wrapping_sub(base) as i64 as f64;
        let out = since(self.board_received_us, board_base) - since(self.host_sent_us, host_base);
        let back = since(self.board_sent_us, board_base) - since(self.host_received_us, host_base);
        0.5 * (out + back)
    }
}

/// The board's clock as a line over the host's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// Host time at the middle of the exchanges used, µs.
    pub host_us: u64,
    /// Board time at that moment, µs, whole part.
    pub board_us: u64,
    /// Its fraction and correction, µs.
    pub correction_us: f64,
    /// How much faster the board's clock runs: (board − host)/host.
    pub drift: f64,
    /// Standard uncertainty of the offset at `host_us`, µs.
    pub offset_std_us: f64,
    /// Standard uncertainty of the drift.
    pub drift_std: f64,
    /// Half of the shortest time on the line, µs: the offset cannot be wrong by more.
    pub offset_bound_us: f64,
}

impl Alignment {
    /// Host time of a board time, µs after [`Alignment::host_us`].
    #[must_use]
    pub fn host_after_us(&self, board_us: u64) -> f64 {
        (board_us.wrapping_sub(self.board_us) as i64 as f64 - self.correction_us) / (1.0 + self.drift)
    }

    /// Standard uncertainty of that, µs.
    #[must_use]
    pub fn host_after_std_us(&self, board_us: u64) -> f64 {
        libm::hypot(self.offset_std_us, self.drift_std * self.host_after_us(board_us))
    }
}

/// Collects exchanges and lays the line.
#[derive(Debug, Clone)]
pub struct Aligner {
    /// Quickest of the group under way, and how many it has seen.
    best: Option<(Exchange, u64)>,
    seen: usize,
    kept: [(Exchange, u64); KEPT],
    next: usize,
    len: usize,
}

impl Default for Aligner {
    fn default() -> Self {
        Self { best: None, seen: 0, kept: [(Exchange::default(), 0); KEPT], next: 0, len: 0 }
    }
}

impl Aligner {
    /// Adds an exchange; stamps that contradict each other are dropped.
    pub fn add(&mut self, exchange: Exchange) {
        let Some(delay) = exchange.delay_us() else { return };
        if self.best.is_none_or(|(_, quickest)| delay < quickest) {
            self.best = Some((exchange, delay));
        }
        self.seen += 1;
        if self.seen < GROUP {
            return;
        }
        self.seen = 0;
        if let (Some(best), Some(place)) = (self.best.take(), self.kept.get_mut(self.next)) {
            *place = best;
            self.next = (self.next + 1) % KEPT;
            self.len = (self.len + 1).min(KEPT);
        }
    }

    fn points(&self) -> impl Iterator<Item = &(Exchange, u64)> {
        self.kept.iter().take(self.len)
    }

    /// The line, once three groups are complete.
    #[must_use]
    pub fn alignment(&self) -> Option<Alignment> {
        if self.len < 3 {
            return None;
        }
        let n = self.len as f64;
        let (first, _) = self.points().next()?;
        let (host_base, board_base) = (first.host_sent_us, first.board_received_us);
        // Host time in the middle of each exchange, µs after the base.
        let middle = |e: &Exchange| {
            let after = |t: u64| t.wrapping_sub(host_base) as i64 as f64;
            0.5 * (after(e.host_sent_us) + after(e.host_received_us))
        };
        let offset = |e: &Exchange| e.offset_us(host_base, board_base);
        let mean_t = self.points().map(|(e, _)| middle(e)).sum::<f64>() / n;
        let mean_o = self.points().map(|(e, _)| offset(e)).sum::<f64>() / n;
        let (stt, sto) = self.points().fold((0.0, 0.0), |(stt, sto), (e, _)| {
            let t = middle(e) - mean_t;
            (stt + t * t, sto + t * (offset(e) - mean_o))
        });
        let drift = if stt > 0.0 { sto / stt } else { 0.0 };
        let residual = self.points().fold(0.0, |sum, (e, _)| {
            let r = offset(e) - mean_o - drift * (middle(e) - mean_t);
            sum + r * r
        });
        // A µs step on both clocks: uniform, 1/√12 µs each way, averaged over two stamps each.
        let step_variance = 1.0 / 12.0;
        let variance = (residual / (n - 2.0)).max(step_variance);
        let quickest = self.points().map(|&(_, delay)| delay).min()? as f64;
        let asymmetry_variance = quickest * quickest / 12.0;
        // Whole µs of the middle; what is left over goes into the correction.
        let whole = libm::floor(mean_t);
        let host_us = host_base.wrapping_add_signed(whole as i64);
        let board = whole + mean_o + drift * (whole - mean_t);
        Some(Alignment {
            host_us,
            board_us: board_base.wrapping_add_signed(libm::floor(board) as i64),
            correction_us: board - libm::floor(board),
            drift,
            offset_std_us: libm::sqrt(variance / n + asymmetry_variance + step_variance),
            drift_std: if stt > 0.0 { libm::sqrt(variance / stt) } else { f64::INFINITY },
            offset_bound_us: 0.5 * quickest,
        })
    }
}
