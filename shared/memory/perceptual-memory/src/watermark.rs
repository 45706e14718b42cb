//! Watermark file: the last acknowledged sequence number, kept outside the database.
//!
//! A corrupted log hides the records after the corruption, and the database alone cannot show that
//! there were any. After each synced commit its sequence number is therefore written to this file,
//! without a sync. It survives the death of the process; after a power cut it is at worst older
//! than the database, which is harmless. A watermark ahead of the database proves that acknowledged
//! entries are missing. It also keeps a replaced database from leasing track-ids a second time.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};

use durable_leveldb::StoreFolder;

const MAGIC: [u8; 4] = *b"TBW2";
const MARK_BYTES: usize = 4 + 4 + 16 + 16 + 8 + 8 + 8;

/// Content of the watermark file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct WatermarkRecord {
    /// Id of the store.
    pub(crate) store_id: u128,
    /// Id of the memory.
    pub(crate) memory_id: u128,
    /// Sequence number of the last acknowledged history entry.
    pub(crate) sequence: u64,
    /// First track-id that is not leased.
    pub(crate) next_track_id: u64,
    /// Number of stored views with content.
    pub(crate) n_views: u64,
}

/// Path of the watermark file in a store folder.
pub(crate) fn path(folder: &StoreFolder) -> PathBuf {
    folder.path().join("acknowledged")
}

/// Watermark file that is open.
pub(crate) struct Watermark {
    file: File,
}

impl Watermark {
    /// Opens an existing file for reading; see [`Self::open`]. It is never written.
    pub(crate) fn open_for_reading(
        path: &Path,
    ) -> io::Result<(Self, Result<Option<WatermarkRecord>, &'static str>)> {
        Self::read(File::open(path)?)
    }

    /// Opens or creates the file. Returns the record in it, `Ok(None)` for a new file, or the
    /// reason why it is unreadable.
    pub(crate) fn open(
        path: &Path,
    ) -> io::Result<(Self, Result<Option<WatermarkRecord>, &'static str>)> {
        let options = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path);
        Self::read(options?)
    }

    fn read(file: File) -> io::Result<(Self, Result<Option<WatermarkRecord>, &'static str>)> {
        let n_bytes = file.metadata()?.len();
        let mut bytes = [0; MARK_BYTES];
        let found = if n_bytes == 0 {
            Ok(None)
        } else if n_bytes == MARK_BYTES as u64 {
            file.read_exact_at(&mut bytes, 0)?;
            decode(&bytes).map(Some).ok_or("its checksum is wrong")
        } else if n_bytes == schema_1::MARK_BYTES as u64 {
            let mut bytes = [0; schema_1::MARK_BYTES];
            file.read_exact_at(&mut bytes, 0)?;
            schema_1::decode(&bytes)
                .map(Some)
                .ok_or("its checksum is wrong")
        } else {
            Err("its length is wrong")
        };
        Ok((Self { file }, found))
    }

    /// Writes the record; it is durable after the next [`Self::sync`], or after the next write-back
    /// of the kernel.
    pub(crate) fn write(&self, mark: &WatermarkRecord) -> io::Result<()> {
        self.file.write_all_at(&encode(mark), 0)
    }

    pub(crate) fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    /// Truncates the file to the length of one record.
    pub(crate) fn trim(&self) -> io::Result<()> {
        self.file.set_len(MARK_BYTES as u64)
    }
}

fn encode(mark: &WatermarkRecord) -> [u8; MARK_BYTES] {
    let mut bytes = [0; MARK_BYTES];
    bytes[..4].copy_from_slice(&MAGIC);
    bytes[8..24].copy_from_slice(&mark.store_id.to_le_bytes());
    bytes[24..40].copy_from_slice(&mark.memory_id.to_le_bytes());
    bytes[40..48].copy_from_slice(&mark.sequence.to_le_bytes());
    bytes[48..56].copy_from_slice(&mark.next_track_id.to_le_bytes());
    bytes[56..].copy_from_slice(&mark.n_views.to_le_bytes());
    let checksum = crc32fast::hash(&bytes[8..]);
    bytes[4..8].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

fn decode(bytes: &[u8; MARK_BYTES]) -> Option<WatermarkRecord> {
    let mark = WatermarkRecord {
        store_id: u128::from_le_bytes(*bytes[8..].first_chunk()?),
        memory_id: u128::from_le_bytes(*bytes[24..].first_chunk()?),
        sequence: u64::from_le_bytes(*bytes[40..].first_chunk()?),
        next_track_id: u64::from_le_bytes(*bytes[48..].first_chunk()?),
        n_views: u64::from_le_bytes(*bytes[56..].first_chunk()?),
    };
    (encode(&mark) == *bytes).then_some(mark)
}

/// Reader of the watermark of schema 1.
mod schema_1 {
    use super::WatermarkRecord;

    pub(super) const MARK_BYTES: usize = 4 + 4 + 16 + 8 + 8;

    pub(super) fn decode(bytes: &[u8; MARK_BYTES]) -> Option<WatermarkRecord> {
        let checksum = u32::from_le_bytes(*bytes[4..].first_chunk()?);
        if !bytes.starts_with(b"TBW1") || crc32fast::hash(&bytes[8..]) != checksum {
            return None;
        }
        let store_id = u128::from_le_bytes(*bytes[8..].first_chunk()?);
        Some(WatermarkRecord {
            store_id,
            memory_id: store_id,
            sequence: u64::from_le_bytes(*bytes[24..].first_chunk()?),
            next_track_id: u64::from_le_bytes(*bytes[32..].first_chunk()?),
            n_views: 0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn watermark_record_is_valid_only_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("acknowledged");
        let (file, found) = Watermark::open(&path).unwrap();
        assert_eq!(found, Ok(None));
        let mark = WatermarkRecord {
            store_id: 3,
            memory_id: 4,
            sequence: u64::MAX,
            next_track_id: 5,
            n_views: 6,
        };
        file.write(&mark).unwrap();
        assert_eq!(Watermark::open(&path).unwrap().1, Ok(Some(mark)));
        let whole = std::fs::read(&path).unwrap();
        for i in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[i] ^= 0x10;
            std::fs::write(&path, &damaged).unwrap();
            assert!(Watermark::open(&path).unwrap().1.is_err(), "byte {i}");
        }
    }
}
