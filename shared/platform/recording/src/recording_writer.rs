//! Writer of a recording: compressed chunks, each readable as soon as it is on disk.

use crate::definitions::{REPEATED_DEFINITIONS, Repetition};
use crate::{
    ChannelSpec, Error, FORMAT_VERSION, RecordedChannel, RecordedSchema, RecordingMetadata,
    frame_channel,
};
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{Compression, WriteOptions, Writer};
use message::service_name::CAMERA_CLOUD;
use scene_document::Document;
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;

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
pub(crate) struct OpenChannel {
    id: u16,
    next: u32,
}

/// Writer of one recording file. Chunks are made in memory and written at once, so that a file
/// of a killed writer ends with a whole chunk or a recognisable part of one.
pub struct RecordingWriter<W: Write> {
    mcap: Writer<NoSeek<W>>,
    channels: BTreeMap<String, OpenChannel>,
    /// New definitions, which are repeated before the next message.
    repetition: Repetition,
    /// JSON of the document that is written, reused.
    json: Vec<u8>,
    is_finished: bool,
}

impl<W: Write> RecordingWriter<W> {
    /// Begins a recording of a daemon; `origin` names it in the file's metadata.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn new(out: W, origin: &str) -> Result<Self, Error> {
        let mut writer = Self::without_metadata(out)?;
        writer.write_metadata(&RecordingMetadata {
            format_version: FORMAT_VERSION,
            origin: origin.to_owned(),
        })?;
        Ok(writer)
    }

    /// Begins a recording whose metadata are written later.
    pub(crate) fn without_metadata(out: W) -> Result<Self, Error> {
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
        Ok(Self {
            mcap: options.create(NoSeek::new(out))?,
            channels: BTreeMap::new(),
            repetition: Repetition::default(),
            json: Vec::new(),
            is_finished: false,
        })
    }

    /// File that takes records; the library panics at one behind the end.
    fn open(&mut self) -> Result<&mut Writer<NoSeek<W>>, Error> {
        if self.is_finished {
            return Err(Error::Finished);
        }
        Ok(&mut self.mcap)
    }

    pub(crate) fn write_metadata(&mut self, metadata: &RecordingMetadata) -> Result<(), Error> {
        Ok(self.open()?.write_metadata(&metadata.to_record())?)
    }

    /// Adds a channel; a known topic keeps its channel.
    ///
    /// # Errors
    /// When the file cannot be written, or has too many channels.
    pub fn add_channel(&mut self, spec: &ChannelSpec) -> Result<(), Error> {
        if self.channels.contains_key(&spec.topic) {
            return Ok(());
        }
        let schema = RecordedSchema {
            name: spec.schema_name.clone(),
            encoding: spec.encoding.schema_name().to_owned(),
            data: spec.schema.clone(),
        };
        let channel = self.define(&RecordedChannel {
            topic: spec.topic.clone(),
            message_encoding: spec.encoding.message_name().to_owned(),
            schema: Arc::new(schema),
        })?;
        self.channels.insert(spec.topic.clone(), channel);
        Ok(())
    }

    /// Writes the definition of a channel.
    pub(crate) fn define(&mut self, channel: &RecordedChannel) -> Result<OpenChannel, Error> {
        let mut schema_id = 0;
        if *channel.schema != RecordedSchema::default() {
            let RecordedSchema {
                name,
                encoding,
                data,
            } = &*channel.schema;
            schema_id = self.open()?.add_schema(name, encoding, data)?;
            self.repetition.add_schema(schema_id, &channel.schema);
        }
        let (topic, encoding) = (&channel.topic, &channel.message_encoding);
        let none = BTreeMap::new();
        let id = self
            .open()?
            .add_channel(schema_id, topic, encoding, &none)?;
        self.repetition.add_channel(id, schema_id, channel);
        Ok(OpenChannel { id, next: 0 })
    }

    /// Ends the chunk with new definitions and repeats them behind it.
    #[expect(
        clippy::default_trait_access,
        reason = "mcap does not export the type of its set of options"
    )]
    fn repeat_definitions(&mut self) -> Result<(), Error> {
        if let Some(definitions) = self.repetition.take() {
            // No option: outside of the chunks.
            let options = Default::default();
            self.open()?
                .write_private_record(REPEATED_DEFINITIONS, &definitions, options)?;
        }
        Ok(())
    }

    /// Writes an encoded message of a channel. A message of an unknown topic is an error of the
    /// caller, and is left out.
    ///
    /// # Errors
    /// When the file cannot be written; it then takes no more messages.
    pub fn write(&mut self, topic: &str, time: MessageTime, data: &[u8]) -> Result<(), Error> {
        let Some(&(mut channel)) = self.channels.get(topic) else {
            return Ok(());
        };
        let written = self.write_to(&mut channel, time, data);
        if let Some(known) = self.channels.get_mut(topic) {
            *known = channel;
        }
        written
    }

    /// Writes a message of a channel.
    pub(crate) fn write_to(
        &mut self,
        channel: &mut OpenChannel,
        time: MessageTime,
        data: &[u8],
    ) -> Result<(), Error> {
        self.repeat_definitions()?;
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.next,
            log_time: time.log_ns,
            publish_time: time.publish_ns,
        };
        channel.next = channel.next.wrapping_add(1);
        Ok(self.open()?.write_to_known_channel(&header, data)?)
    }

    /// Writes an encoded frame, see [`encode_frame`](crate::encode_frame).
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn write_frame(&mut self, time: MessageTime, data: &[u8]) -> Result<(), Error> {
        if !self.channels.contains_key(CAMERA_CLOUD) {
            self.add_channel(&frame_channel())?;
        }
        self.write(CAMERA_CLOUD, time, data)
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
        self.repeat_definitions()?;
        Ok(self.open()?.flush()?)
    }

    /// Writes the index and the end of the file. No message may follow.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn finish(&mut self) -> Result<(), Error> {
        self.flush()?;
        self.is_finished = true;
        self.mcap.finish()?;
        Ok(())
    }
}
