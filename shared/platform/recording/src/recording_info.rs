//! Statistics of a recording: time range, topics with their counts, gaps between frames.

use crate::{Error, FrameRecord, ReadSummary, RecordingMetadata, RecordingReader};
use message::service_name::CAMERA_CLOUD;
use std::collections::BTreeMap;
use std::io::Read;

/// Length of a recording from which on it has rates, seconds. Chosen: three frames of a Kinect.
const RECORDING_MIN_S: f64 = 0.1;

/// Statistics of one topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TopicInfo {
    /// Number of messages.
    pub n_messages: u64,
    /// Size of the messages before compression, bytes.
    pub n_bytes: u64,
    /// Times of the earliest and the latest message, nanoseconds of the wall clock.
    pub span_ns: Option<(u64, u64)>,
}

impl TopicInfo {
    pub(crate) fn add(&mut self, log_ns: u64, n_bytes: usize) {
        self.n_messages += 1;
        self.n_bytes += n_bytes as u64;
        let (first, last) = self.span_ns.unwrap_or((log_ns, log_ns));
        self.span_ns = Some((first.min(log_ns), last.max(log_ns)));
    }

    /// Time from the earliest to the latest message, nanoseconds.
    pub fn duration_ns(&self) -> u64 {
        self.span_ns.map_or(0, |(first, last)| last - first)
    }

    /// Time from the earliest to the latest message, seconds.
    pub fn seconds(&self) -> f64 {
        self.duration_ns() as f64 * 1e-9
    }

    /// Messages a second over a recording of this length, seconds; `None` for a single message, and
    /// for a recording that is too short to tell. The time between the topic's own messages would
    /// make millions a second of two that came together.
    pub fn rate_hz(&self, recording_s: f64) -> Option<f64> {
        let n_intervals = self.n_messages.saturating_sub(1);
        (n_intervals > 0 && recording_s >= RECORDING_MIN_S)
            .then(|| n_intervals as f64 / recording_s)
    }
}

/// Statistics of a recording.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RecordingInfo {
    /// Metadata of the recording, when it has any.
    pub metadata: Option<RecordingMetadata>,
    /// Summary of reading the file.
    pub read: ReadSummary,
    /// Statistics of all messages.
    pub all: TopicInfo,
    /// Statistics by topic.
    pub topics: BTreeMap<String, TopicInfo>,
    /// Number of places at which frames of a session are missing.
    pub n_gaps: u64,
    /// Number of frames that are missing there.
    pub n_missing_frames: u64,
}

impl RecordingInfo {
    /// Reads a file of this length, bytes.
    ///
    /// # Errors
    /// When the file cannot be read, or is no MCAP file.
    pub fn read(input: impl Read, file_bytes: u64) -> Result<Self, Error> {
        let mut reader = RecordingReader::new(input, file_bytes);
        let mut info = Self::default();
        let mut newest = None;
        while let Some(message) = reader.next_message()? {
            info.all.add(message.log_ns, message.data.len());
            let topic = &message.channel.topic;
            let known = info.topics.entry(topic.clone()).or_default();
            known.add(message.log_ns, message.data.len());
            if topic == CAMERA_CLOUD
                && let Ok(frame) = FrameRecord::parse(message.data)
            {
                let number = (frame.header.session, frame.header.sequence);
                info.add_gap(newest.replace(number), number);
            }
        }
        info.metadata = reader.metadata().cloned();
        info.read = reader.summary();
        Ok(info)
    }

    /// Counts the frames that are missing between two, by session and sequence.
    fn add_gap(&mut self, before: Option<(u64, u64)>, (session, sequence): (u64, u64)) {
        let before = before.filter(|before| before.0 == session);
        let n_missing = before.map_or(0, |before| {
            sequence.saturating_sub(before.1).saturating_sub(1)
        });
        self.n_gaps += u64::from(n_missing > 0);
        self.n_missing_frames = self.n_missing_frames.saturating_add(n_missing);
    }
}
