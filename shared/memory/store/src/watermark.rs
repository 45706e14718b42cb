//! What was acknowledged, noted beside the database.
//!
//! A damaged log hides what follows the damage, and the database alone cannot
//! tell that anything followed. So after each synced commit its sequence is also
//! written here, without a sync: it survives the death of the process, and after
//! a power cut is at worst older than the database, which is no loss. Only a
//! mark ahead of the database tells that something acknowledged is gone. It also
//! keeps a database begun anew from leasing track-ids a second time.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::FileExt;
use std::path::Path;

const MAGIC: [u8; 4] = *b"TBW2";
const MARK_BYTES: usize = 4 + 4 + 16 + 16 + 8 + 8 + 8;

/// What is noted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Mark {
    /// The store it is about.
    pub(crate) store_id: u128,
    /// Whose memory it is.
    pub(crate) memory_id: u128,
    /// Its last acknowledged history entry.
    pub(crate) sequence: u64,
    /// The first track-id not yet leased.
    pub(crate) next_track_id: u64,
    /// Views whose content is there.
    pub(crate) n_views: u64,
}

/// The file.
pub(crate) struct Watermark {
    file: File,
}

impl Watermark {
    /// Opens or creates the file; returns the mark in it, `Ok(None)` when it was
    /// never written, and what is wrong when it cannot be read.
    pub(crate) fn open(path: &Path) -> io::Result<(Self, Result<Option<Mark>, &'static str>)> {
        let options = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path);
        let file = options?;
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

    /// Notes `mark`; it is on disk after the next [`Self::sync`] or when the
    /// system finds time.
    pub(crate) fn write(&self, mark: &Mark) -> io::Result<()> {
        self.file.write_all_at(&encode(mark), 0)
    }

    pub(crate) fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    /// Cuts off whatever an unreadable file holds beyond a mark.
    pub(crate) fn trim(&self) -> io::Result<()> {
        self.file.set_len(MARK_BYTES as u64)
    }
}

fn encode(mark: &Mark) -> [u8; MARK_BYTES] {
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

fn decode(bytes: &[u8; MARK_BYTES]) -> Option<Mark> {
    let mark = Mark {
        store_id: u128::from_le_bytes(*bytes[8..].first_chunk()?),
        memory_id: u128::from_le_bytes(*bytes[24..].first_chunk()?),
        sequence: u64::from_le_bytes(*bytes[40..].first_chunk()?),
        next_track_id: u64::from_le_bytes(*bytes[48..].first_chunk()?),
        n_views: u64::from_le_bytes(*bytes[56..].first_chunk()?),
    };
    (encode(&mark) == *bytes).then_some(mark)
}

/// The mark that stores of schema 1 left.
mod schema_1 {
    use super::Mark;

    pub(super) const MARK_BYTES: usize = 4 + 4 + 16 + 8 + 8;

    pub(super) fn decode(bytes: &[u8; MARK_BYTES]) -> Option<Mark> {
        let checksum = u32::from_le_bytes(*bytes[4..].first_chunk()?);
        if !bytes.starts_with(b"TBW1") || crc32fast::hash(&bytes[8..]) != checksum {
            return None;
        }
        let store_id = u128::from_le_bytes(*bytes[8..].first_chunk()?);
        Some(Mark {
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
    fn a_mark_is_read_back_only_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("acknowledged");
        let (file, found) = Watermark::open(&path).unwrap();
        assert_eq!(found, Ok(None));
        let mark = Mark {
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
