//! Messages put together to ticks; what is missing between two of them is a gap.

use std::io::{Read, Seek};

use super::{Block, RunReader};
use crate::run::file::Message;
use crate::run::layout::{Decoder, text};
use crate::run::log::{Event, EventKind, Gap, GapCause};
use crate::text::counted;

impl<R: Read + Seek> RunReader<R> {
    pub(super) fn take_message(&mut self, body: &[u8], block: &mut Block) {
        let Some(message) = Message::parse(body) else { return };
        if Some(message.channel) == self.events_channel {
            if let Some((kind, text)) = text::decode(message.data) {
                let time_s = self.seconds(message.log_time);
                block.events.push(Event { time_s, kind: EventKind::of_name(&kind), text });
            }
            return;
        }
        let Some(topic) = self.topic_of_channel.get(usize::from(message.channel)).copied().flatten() else { return };
        if self.rows.n_filled > 0 && message.sequence != self.rows.sequence {
            // The last tick never became whole; the jump of the ticks tells it.
            self.topics.iter_mut().for_each(|topic| topic.is_filled = false);
            self.rows.n_filled = 0;
        }
        self.rows.sequence = message.sequence;
        let topic = &mut self.topics[topic];
        for (kind, offset, column) in &topic.fields {
            let Some(value) = Decoder::field(message.data, *kind, *offset) else { return };
            self.rows.row[*column] = value;
        }
        if !std::mem::replace(&mut topic.is_filled, true) {
            self.rows.n_filled += 1;
        }
        if self.rows.n_filled == self.topics.len() {
            self.topics.iter_mut().for_each(|topic| topic.is_filled = false);
            self.rows.n_filled = 0;
            self.take_row(&message, block);
        }
    }

    /// Run time of a time in the file.
    fn seconds(&mut self, log_time: u64) -> f64 {
        let start = match self.meta.start_unix_ns {
            0 if self.meta.log_rate_hz <= 0.0 => *self.rows.first_log_time.get_or_insert(log_time),
            start => start,
        };
        // Two parts: a difference of 64 bits would be rounded to microseconds.
        let ns = i128::from(log_time) - i128::from(start);
        (ns / 1_000_000_000) as f64 + (ns % 1_000_000_000) as f64 / 1e9
    }

    /// A tick that is whole: its number, its time, and what is missing before it.
    fn take_row(&mut self, message: &Message<'_>, block: &mut Block) {
        let seconds = self.seconds(message.log_time);
        let rate = self.meta.log_rate_hz;
        let (tick, time_s) = if rate > 0.0 {
            let tick = unwrap(message.sequence, seconds * rate);
            (tick, tick as f64 / rate)
        } else {
            (u64::from(message.sequence), seconds)
        };
        let rows = &mut self.rows;
        if let Some(column) = rows.row.iter().position(|v| !v.is_finite()) {
            let (name, value) = (&self.channels[column].0, rows.row[column]);
            rows.pending.get_or_insert((GapCause::NotFinite, format!("{name} is {value} in tick {tick}")));
            return;
        }
        if let Some((last, last_s)) = rows.last
            && (time_s <= last_s || (rate > 0.0 && tick <= last))
        {
            let problem = format!("tick {tick} comes after tick {last}");
            rows.pending.get_or_insert((GapCause::Damaged, problem));
            return;
        }
        let missing = match rows.last {
            Some((last, _)) if rate > 0.0 => Some(tick - last - 1),
            _ => None,
        };
        if rows.pending.is_some() || missing.is_some_and(|n| n > 0) {
            let never = || (GapCause::Link, "they never reached the recorder".to_owned());
            let (cause, why) = rows.pending.take().unwrap_or_else(never);
            let count = missing.map_or_else(
                || "an unknown number of ticks is".to_owned(),
                |n| counted(n as usize, "tick is", "ticks are"),
            );
            let from_s = rows.last.map(|(_, s)| s);
            let text = format!("{count} missing before {time_s} s: {why}");
            block.lost.push(Gap { from_s, to_s: Some(time_s), ticks: missing, cause, text });
        }
        rows.last = Some((tick, time_s));
        block.time_s.push(time_s);
        block.columns.iter_mut().zip(&rows.row).for_each(|(column, value)| column.push(*value));
    }
}

/// The tick with these lowest 32 bits that is nearest to `expected`.
fn unwrap(sequence: u32, expected: f64) -> u64 {
    let expected = expected.clamp(0.0, 9e15) as u64;
    let low = expected as u32;
    let ahead = sequence.wrapping_sub(low) as i32;
    expected.saturating_add_signed(i64::from(ahead))
}
