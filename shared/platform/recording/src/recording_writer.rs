//! Writer of a recording: compressed chunks, each readable as soon as it is on disk.

use crate::{ChannelSpec, Document, Error, FORMAT_VERSION, frame_channel};
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Compression, WriteOptions, Writer};
use std::collections::BTreeMap;
use std::io::Write;

/// Size of a chunk before compression, bytes: about one frame of a Kinect. Chosen.
const CHUNK_BYTES: u64 = 2 << 20;
/// Level of compression: the fastest. Chosen.
const COMPRESSION_LEVEL: u32 = 1;

/// Times of a message, nanoseconds of the wall clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MessageTime {
    /// Time at which the recorder received the message.
    pub log_ns: u64,
    /// Time at which the message was published, or of its content.
    pub publish_ns: u64,
}

impl MessageTime {
    /// Both times at the same instant.
    pub fn at(wall_ns: u64) -> Self {
        Self {
            log_ns: wall_ns,
            publish_ns: wall_ns,
        }
    }
}

/// Channel of an open file with the number of its next message.
#[derive(Debug, Clone, Copy)]
struct OpenChannel {
    id: u16,
    next: u32,
}

/// Writer of one recording file. Chunks are made in memory and written at once, so that a file
/// of a killed writer ends with a whole chunk or a recognisable part of one.
pub struct RecordingWriter<W: Write> {
    mcap: Writer<NoSeek<W>>,
    channels: BTreeMap<String, OpenChannel>,
    /// JSON of the document that is written, reused.
    json: Vec<u8>,
}

impl<W: Write> RecordingWriter<W> {
    /// Begins a recording of a daemon; `origin` names it in the file's metadata.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn new(out: W, origin: &str) -> Result<Self, Error> {
        let options = WriteOptions::new()
            .library(concat!("tabula ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Zstd))
            .compression_level(COMPRESSION_LEVEL)
            // The writer has a thread of its own; more would take the cores of perception.
            .compression_threads(0)
            .chunk_size(Some(CHUNK_BYTES))
            // Each chunk has its own checksum.
            .calculate_data_section_crc(false)
            .disable_seeking(true);
        let mut mcap = options.create(NoSeek::new(out))?;
        let metadata = [
            ("format_version", FORMAT_VERSION.to_string()),
            ("origin", origin.to_owned()),
        ];
        mcap.write_metadata(&Metadata {
            name: "tabula.recording".into(),
            metadata: metadata.map(|(key, value)| (key.to_owned(), value)).into(),
        })?;
        Ok(Self {
            mcap,
            channels: BTreeMap::new(),
            json: Vec::new(),
        })
    }

    /// Adds a channel; a known topic keeps its channel.
    ///
    /// # Errors
    /// When the file cannot be written, or has too many channels.
    pub fn add_channel(&mut self, spec: &ChannelSpec) -> Result<(), Error> {
        if self.channels.contains_key(&spec.topic) {
            return Ok(());
        }
        let schema_encoding = spec.encoding.schema_name();
        let schema = self
            .mcap
            .add_schema(&spec.schema_name, schema_encoding, &spec.schema)?;
        let encoding = spec.encoding.message_name();
        let none = BTreeMap::new();
        let id = self
            .mcap
            .add_channel(schema, &spec.topic, encoding, &none)?;
        self.insert(spec.topic.clone(), id);
        Ok(())
    }

    /// Adds a channel as another file defines it.
    pub(crate) fn add_raw_channel(
        &mut self,
        channel: &crate::RecordedChannel,
    ) -> Result<(), Error> {
        if self.channels.contains_key(&channel.topic) {
            return Ok(());
        }
        let schema = if channel.schema_name.is_empty() {
            0
        } else {
            self.mcap.add_schema(
                &channel.schema_name,
                &channel.schema_encoding,
                &channel.schema,
            )?
        };
        let (topic, encoding) = (&channel.topic, &channel.message_encoding);
        let none = BTreeMap::new();
        let id = self.mcap.add_channel(schema, topic, encoding, &none)?;
        self.insert(channel.topic.clone(), id);
        Ok(())
    }

    fn insert(&mut self, topic: String, id: u16) {
        self.channels.insert(topic, OpenChannel { id, next: 0 });
    }

    /// Writes an encoded message of a channel. A message of an unknown topic is an error of the
    /// caller, and is left out.
    ///
    /// # Errors
    /// When the file cannot be written; it then takes no more messages.
    pub fn write(&mut self, topic: &str, time: MessageTime, data: &[u8]) -> Result<(), Error> {
        let Some(channel) = self.channels.get_mut(topic) else {
            return Ok(());
        };
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.next,
            log_time: time.log_ns,
            publish_time: time.publish_ns,
        };
        channel.next = channel.next.wrapping_add(1);
        Ok(self.mcap.write_to_known_channel(&header, data)?)
    }

    /// Writes an encoded frame, see [`encode_frame`](crate::encode_frame).
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn write_frame(&mut self, time: MessageTime, data: &[u8]) -> Result<(), Error> {
        self.add_channel(&frame_channel())?;
        self.write(message::service_name::CAMERA_CLOUD, time, data)
    }

    /// Writes a document.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn write_document<D: Document>(
        &mut self,
        topic: &str,
        time: MessageTime,
        document: &D,
    ) -> Result<(), Error> {
        if !self.channels.contains_key(topic) {
            self.add_channel(&ChannelSpec::json::<D>(topic))?;
        }
        let mut json = std::mem::take(&mut self.json);
        json.clear();
        serde_json::to_writer(&mut json, document)?;
        let written = self.write(topic, time, &json);
        self.json = json;
        written
    }

    /// Ends the current chunk and hands all bytes to the file: what was written before is in the
    /// file then.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn flush(&mut self) -> Result<(), Error> {
        Ok(self.mcap.flush()?)
    }

    /// Writes the index and the end of the file. No message may follow.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn finish(&mut self) -> Result<(), Error> {
        self.mcap.flush()?;
        self.mcap.finish()?;
        Ok(())
    }
}
