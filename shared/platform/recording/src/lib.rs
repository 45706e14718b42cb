//! Recordings of a daemon in MCAP: frames to the bit, events as JSON; writing, reading,
//! recovery, and playback.
//!
//! A recording is an MCAP file. A [`RecordingWriter`] appends messages in compressed chunks;
//! each chunk that is on disk can be read, even when the file was never closed. A
//! [`RecordingReader`] reads complete, cut and damaged files front to back and counts what it
//! leaves out; [`recover`] writes what is intact into a new file, and a [`RecordingInfo`] has the
//! statistics of a file. Frames have a lossless binary encoding ([`encode_frame`]), other messages
//! are JSON [`documents`] with a schema in the file.
//! A [`FramePlayer`] yields the frames with the states of arm and people before each.
//! An [`EventStream`] turns scenes into canonical lines and a digest, to compare two replays.
//!
//! Invariants: this crate opens no file, reads no clock and starts no thread. Whatever bytes a
//! file has, reading them gives messages or an error, in memory that is bounded by the file's
//! length.
//!
//! ```
//! use message::{CloudPoint, FrameHeader};
//! use recording::{FramePlayer, MessageTime, RecordingWriter, encode_frame};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut header = FrameHeader::default();
//! header.set_camera(&geometry::PinholeCamera {
//!     fx_px: 4.0, fy_px: 4.0, cx_px: 1.5, cy_px: 1.0, width: 4, height: 3,
//! });
//! let points = vec![CloudPoint { x: 0.1, y: 0.2, z: 0.9, argb: 7 }; 12];
//! let mut file = Vec::new();
//! let mut writer = RecordingWriter::new(&mut file, "demo")?;
//! let mut bytes = Vec::new();
//! encode_frame(&header, &points, &mut bytes)?;
//! writer.write_frame(MessageTime::at(1_000), &bytes)?;
//! writer.finish()?;
//! drop(writer);
//!
//! let mut player = FramePlayer::new(&file[..], file.len() as u64);
//! let frame = player.next_frame()?.ok_or("no frame")?;
//! let mut read = vec![CloudPoint::default(); frame.n_points()];
//! frame.fill(&mut read)?;
//! assert_eq!(read, points);
//! # Ok(()) }
//! ```

mod byte_planes;
mod channel_list;
mod chunk_records;
mod definitions;
pub mod documents;
mod error;
mod event_stream;
mod field_reader;
mod frame_codec;
mod frame_player;
mod number;
mod record_source;
mod recording_info;
mod recording_metadata;
mod recording_reader;
mod recording_writer;
mod recovery;
mod word_table;

pub use channel_list::{ChannelSpec, MessageEncoding, frame_channel};
pub use definitions::{RecordedChannel, RecordedSchema};
pub use error::{Error, InvalidRecord};
pub use event_stream::{EventDigest, EventStream};
pub use frame_codec::{FrameRecord, encode_frame};
pub use frame_player::{ArmSample, FramePlayer, PersonSample, PlayedFrame, UnusableMessage};
pub use number::Number;
pub use recording_info::{RecordingInfo, TopicInfo};
pub use recording_metadata::RecordingMetadata;
pub use recording_reader::{ReadSummary, RecordedMessage, RecordingReader};
pub use recording_writer::{MessageTime, RecordingWriter};
pub use recovery::{RecoveryReport, recover};

/// True for the file name of a recording, also of one that was not closed.
pub fn is_recording_name(name: &str) -> bool {
    let name = name.strip_suffix(".active").unwrap_or(name);
    std::path::Path::new(name)
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"))
}

/// Version of the format of recordings, written into the metadata of each file.
pub const FORMAT_VERSION: u32 = 1;
