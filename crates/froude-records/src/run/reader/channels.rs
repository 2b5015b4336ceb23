//! Which channels a run has: schemas and channels of its file.

use std::io::{Read, Seek};

use mcap::records::op;

use super::{MOST_CHANNELS, ReadTopic, RunReader};
use crate::error::RecordError;
use crate::run::allowance::Allowance;
use crate::run::file::{FileChannel, Step, Summary, records, schema, unpack};
use crate::run::layout::{Decoder, PREFIX_KEY, text};

/// Most topics that a refusal names.
const MAX_NAMED: usize = 8;

impl<R: Read + Seek> RunReader<R> {
    /// Schemas and channels: from the summary of a whole file, else from the beginning up to the first chunk with any.
    pub(super) fn find_channels(&mut self) -> Result<(), RecordError> {
        let summary = self.walk.go_to_summary().map_err(|e| self.failed(&e))?;
        if let Summary::Damaged(problem) = summary {
            self.damage.get_or_insert(problem);
        } else if summary == Summary::None && self.meta.log.is_some() {
            // A log that was finished has one.
            self.damage.get_or_insert_with(|| "its end cannot be found".to_owned());
        } else if summary == Summary::Here {
            while let Some(opcode) = self.walk.next_of_summary().map_err(|e| self.failed(&e))? {
                let body = std::mem::take(&mut self.walk.body);
                self.declare(opcode, &body);
                self.walk.body = body;
            }
        }
        self.walk.rewind().map_err(|e| self.failed(&e))?;
        while self.topics.is_empty() && self.others.is_empty() {
            let Step::Record { opcode, offset } = self.walk.next().map_err(|e| self.failed(&e))? else { break };
            let body = std::mem::take(&mut self.walk.body);
            match opcode {
                op::CHUNK => {
                    let mut unpacked = std::mem::take(&mut self.unpacked);
                    for (opcode, body) in unpack(&body, &mut unpacked).iter().flat_map(|c| records(c)).flatten() {
                        self.declare(opcode, body);
                    }
                    self.unpacked = unpacked;
                    self.allowance.take(&self.path, self.unpacked.len())?;
                }
                op::METADATA => self.take_metadata(offset, &body)?,
                _ => self.declare(opcode, &body),
            }
            self.walk.body = body;
        }
        self.walk.rewind().map_err(|e| self.failed(&e))?;
        self.allowance = Allowance::of(self.walk.length());
        self.index_topics();
        Ok(())
    }

    /// Refuses a log of another program: its topics have rates of their own, and nobody declared what it is of.
    pub(super) fn check_own(&self) -> Result<(), RecordError> {
        if self.is_own || self.others.is_empty() {
            return Ok(());
        }
        let ellipsis = if self.others.len() == MAX_NAMED { ", …" } else { "" };
        let topics = format!("{}{ellipsis}", self.others.join(", "));
        Err(RecordError::ForeignLog { path: self.path.clone(), topics })
    }

    pub(super) fn index_topics(&mut self) {
        self.topic_of_channel.clear();
        for (i, topic) in self.topics.iter().enumerate() {
            let channel = usize::from(topic.channel);
            if self.topic_of_channel.len() <= channel {
                self.topic_of_channel.resize(channel + 1, None);
            }
            self.topic_of_channel[channel] = Some(i);
        }
        self.rows.row = vec![0.0; self.channels.len()];
    }

    /// Takes a schema or a channel; what is not a flat message of numbers, or no log of events, is left alone.
    fn declare(&mut self, opcode: u8, body: &[u8]) {
        match opcode {
            op::SCHEMA => {
                if let Some((id, "ros2msg", text)) = schema(body) {
                    self.schemas.insert(id, String::from_utf8_lossy(text).into_owned());
                }
            }
            op::CHANNEL => {
                let Some(channel) = FileChannel::parse(body) else { return };
                self.is_own |= channel.metadata.contains_key(PREFIX_KEY);
                if channel.encoding == "cdr" {
                    self.declare_channel(&channel);
                }
                if self.others.len() < MAX_NAMED && !self.others.iter().any(|topic| topic == channel.topic) {
                    self.others.push(channel.topic.to_owned());
                }
            }
            _ => {}
        }
    }

    fn declare_channel(&mut self, channel: &FileChannel<'_>) {
        let Some(schema) = self.schemas.get(&channel.schema) else { return };
        if channel.topic == text::TOPIC && schema == text::SCHEMA {
            self.events_channel = Some(channel.id);
            return;
        }
        let is_known = self.topics.iter().any(|topic| topic.channel == channel.id);
        let Some(decoder) = Decoder::parse(schema).filter(|_| !is_known) else { return };
        let prefix = channel.metadata.get(PREFIX_KEY).cloned();
        let prefix = prefix.unwrap_or_else(|| format!("{}/", channel.topic.trim_matches('/')));
        let mut fields = Vec::new();
        for (field, kind, offset) in decoder.fields {
            let name = format!("{prefix}{field}");
            let is_taken = self.channels.iter().any(|(own, _)| *own == name);
            if is_taken || self.channels.len() == MOST_CHANNELS {
                continue;
            }
            let unit = channel.metadata.get(&field).cloned().unwrap_or_else(|| "1".to_owned());
            fields.push((kind, offset, self.channels.len()));
            self.channels.push((name, unit));
        }
        if !fields.is_empty() {
            self.topics.push(ReadTopic { channel: channel.id, fields, is_filled: false });
        }
    }
}
