//! Definitions of a recording: its schemas and channels by their ids, and their repetition.
//!
//! A writer puts the definitions into the first chunk, and repeats them behind it in a record of
//! its own, with a checksum: the damage of one chunk then takes no other with it.

use crate::chunk_records::PlainRecords;
use mcap::records::{Record, op};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Code of the record that repeats definitions, one of those that are left to programs: CRC-32 of
/// what follows, then records of schemas and channels.
pub(crate) const REPEATED_DEFINITIONS: u8 = 0xD0;

/// Largest number of schemas, and of channels, of a file; a recording has twelve.
const MAX_DEFINITIONS: usize = 4096;
/// Largest size of all definitions of a file together, bytes; those of a recording have 40 kB.
const MAX_BYTES: usize = 16 << 20;

/// Schema of a recording.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RecordedSchema {
    /// Name of the schema; empty without one.
    pub name: String,
    /// Encoding of the schema.
    pub encoding: String,
    /// Schema in its encoding.
    pub data: Vec<u8>,
}

/// Channel of a recording as the file defines it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordedChannel {
    /// Topic of the channel.
    pub topic: String,
    /// Encoding of its messages.
    pub message_encoding: String,
    /// Schema of its messages, which channels share.
    pub schema: Arc<RecordedSchema>,
}

/// Schemas and channels that a reader has found. The first definition of an id is the valid one.
#[derive(Debug, Default)]
pub(crate) struct Definitions {
    schemas: BTreeMap<u16, Arc<RecordedSchema>>,
    channels: BTreeMap<u16, Arc<RecordedChannel>>,
    n_bytes: usize,
}

impl Definitions {
    /// Channel of an id.
    pub(crate) fn channel(&self, id: u16) -> Option<&Arc<RecordedChannel>> {
        self.channels.get(&id)
    }

    /// Takes the record of a schema or channel; false when it is damaged, contradicts an earlier
    /// one, or is more than a file may have.
    pub(crate) fn add(&mut self, opcode: u8, content: &[u8]) -> bool {
        let is_room = self.n_bytes.saturating_add(content.len()) <= MAX_BYTES;
        match mcap::parse_record(opcode, content) {
            Ok(Record::Schema { header, data }) => match self.schemas.get(&header.id) {
                Some(known) => {
                    let found = (&header.name, &header.encoding, &data[..]);
                    found == (&known.name, &known.encoding, &known.data[..])
                }
                None if header.id == 0 || !is_room || self.schemas.len() >= MAX_DEFINITIONS => {
                    false
                }
                None => {
                    self.n_bytes += content.len();
                    let schema = RecordedSchema {
                        name: header.name,
                        encoding: header.encoding,
                        data: data.into_owned(),
                    };
                    self.schemas.insert(header.id, Arc::new(schema));
                    true
                }
            },
            Ok(Record::Channel(channel)) => match self.channels.get(&channel.id) {
                Some(known) => {
                    let found = (&channel.topic, &channel.message_encoding);
                    found == (&known.topic, &known.message_encoding)
                }
                None if !is_room || self.channels.len() >= MAX_DEFINITIONS => false,
                None => {
                    self.n_bytes += content.len();
                    let schema = self.schemas.get(&channel.schema_id);
                    let recorded = RecordedChannel {
                        topic: channel.topic,
                        message_encoding: channel.message_encoding,
                        schema: schema.cloned().unwrap_or_default(),
                    };
                    self.channels.insert(channel.id, Arc::new(recorded));
                    true
                }
            },
            _ => false,
        }
    }

    /// Takes the content of a record that repeats definitions; false when any is damaged.
    pub(crate) fn add_repeated(&mut self, content: &[u8]) -> bool {
        let Some((crc, records)) = content.split_first_chunk() else {
            return false;
        };
        let Some(mut records) = PlainRecords::new(records, u32::from_le_bytes(*crc)) else {
            return false;
        };
        let mut record = Vec::new();
        let mut is_sound = true;
        loop {
            match records.next(&mut record) {
                Ok(Some(opcode)) => is_sound &= self.add(opcode, &record),
                Ok(None) => return is_sound,
                Err(_) => return false,
            }
        }
    }
}

/// Definitions of a writer that are to be repeated, as records.
#[derive(Debug, Default)]
pub(crate) struct Repetition {
    records: Vec<u8>,
}

impl Repetition {
    /// Appends a schema.
    pub(crate) fn add_schema(&mut self, id: u16, schema: &RecordedSchema) {
        let mut content = id.to_le_bytes().to_vec();
        append_bytes(schema.name.as_bytes(), &mut content);
        append_bytes(schema.encoding.as_bytes(), &mut content);
        append_bytes(&schema.data, &mut content);
        self.append(op::SCHEMA, &content);
    }

    /// Appends a channel without metadata.
    pub(crate) fn add_channel(&mut self, id: u16, schema_id: u16, channel: &RecordedChannel) {
        let mut content = id.to_le_bytes().to_vec();
        content.extend(schema_id.to_le_bytes());
        append_bytes(channel.topic.as_bytes(), &mut content);
        append_bytes(channel.message_encoding.as_bytes(), &mut content);
        append_bytes(&[], &mut content);
        self.append(op::CHANNEL, &content);
    }

    fn append(&mut self, opcode: u8, content: &[u8]) {
        self.records.push(opcode);
        self.records.extend((content.len() as u64).to_le_bytes());
        self.records.extend_from_slice(content);
    }

    /// Takes the content of the record; `None` when there is nothing to repeat.
    pub(crate) fn take(&mut self) -> Option<Vec<u8>> {
        if self.records.is_empty() {
            return None;
        }
        let mut content = crc32fast::hash(&self.records).to_le_bytes().to_vec();
        content.append(&mut self.records);
        Some(content)
    }
}

/// Appends the length and the bytes of a text or of data.
fn append_bytes(bytes: &[u8], out: &mut Vec<u8>) {
    out.extend((bytes.len() as u32).to_le_bytes());
    out.extend_from_slice(bytes);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(topic: &str) -> RecordedChannel {
        let schema = RecordedSchema {
            name: "tabula.Thing".into(),
            encoding: "jsonschema".into(),
            data: b"{}".to_vec(),
        };
        RecordedChannel {
            topic: topic.into(),
            message_encoding: "json".into(),
            schema: Arc::new(schema),
        }
    }

    fn repeated(topic: &str) -> Vec<u8> {
        let mut repetition = Repetition::default();
        repetition.add_schema(3, &channel(topic).schema);
        repetition.add_channel(7, 3, &channel(topic));
        let content = repetition.take().unwrap();
        assert_eq!(repetition.take(), None);
        content
    }

    #[test]
    fn definitions_are_read_from_their_repetition() {
        let mut definitions = Definitions::default();
        assert!(definitions.add_repeated(&repeated("scene")));
        assert_eq!(**definitions.channel(7).unwrap(), channel("scene"));
        // The first definition is the valid one; the same again is no damage.
        assert!(definitions.add_repeated(&repeated("scene")));
        assert!(!definitions.add_repeated(&repeated("health")));
        assert_eq!(definitions.channel(7).unwrap().topic, "scene");
    }

    #[test]
    fn repetition_with_a_wrong_byte_defines_nothing() {
        let whole = repeated("scene");
        for at in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 0x20;
            let mut definitions = Definitions::default();
            assert!(!definitions.add_repeated(&damaged), "{at}");
            assert!(definitions.channel(7).is_none(), "{at}");
        }
    }

    #[test]
    fn channels_share_their_schema_within_a_bound() {
        let mut schema = channel("").schema.as_ref().clone();
        schema.data = vec![b' '; MAX_BYTES / 2];
        let mut repetition = Repetition::default();
        repetition.add_schema(3, &schema);
        for id in 0..u16::MAX {
            repetition.add_channel(id, 3, &channel(&id.to_string()));
        }
        repetition.add_schema(4, &schema);
        let mut definitions = Definitions::default();
        assert!(!definitions.add_repeated(&repetition.take().unwrap()));
        assert_eq!(definitions.channels.len(), MAX_DEFINITIONS);
        assert_eq!(definitions.schemas.len(), 1);
        let [first, last] = [0, MAX_DEFINITIONS as u16 - 1];
        let schema_of = |id| &definitions.channel(id).unwrap().schema;
        assert!(Arc::ptr_eq(schema_of(first), schema_of(last)));
    }
}
