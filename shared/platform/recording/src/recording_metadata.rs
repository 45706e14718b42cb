//! Metadata of a recording: version of its format, and origin.

use mcap::records::{Metadata, Record, op};

/// Name of the metadata record.
const NAME: &str = "tabula.recording";
const FORMAT_VERSION: &str = "format_version";
const ORIGIN: &str = "origin";
/// Largest metadata record that is read, bytes.
const MAX_BYTES: usize = 1 << 16;

/// Metadata of a recording.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RecordingMetadata {
    /// Version of the format.
    pub format_version: u32,
    /// Name of the recorded daemon.
    pub origin: String,
}

impl RecordingMetadata {
    /// Reads the content of a metadata record; `None` when it is another one, or damaged.
    pub(crate) fn parse(content: &[u8]) -> Option<Self> {
        if content.len() > MAX_BYTES {
            return None;
        }
        match mcap::parse_record(op::METADATA, content) {
            Ok(Record::Metadata(record)) if record.name == NAME => Some(Self {
                format_version: record.metadata.get(FORMAT_VERSION)?.parse().ok()?,
                origin: record.metadata.get(ORIGIN)?.clone(),
            }),
            _ => None,
        }
    }

    /// Metadata record of the file.
    pub(crate) fn to_record(&self) -> Metadata {
        let metadata = [
            (FORMAT_VERSION, self.format_version.to_string()),
            (ORIGIN, self.origin.clone()),
        ];
        Metadata {
            name: NAME.into(),
            metadata: metadata.map(|(key, value)| (key.to_owned(), value)).into(),
        }
    }
}
