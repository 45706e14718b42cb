//! History archive: entries that left the database, in immutable [segments](segment::Segment).
//!
//! ```text
//! history/000000000001-000000004096    a segment, by its first and last entry
//! history/000000004097-000000008192
//! ```
//!
//! A segment counts only up to the end in the [archive record](ArchiveRecord) of the database; what
//! a crash left beyond it is removed when the store is opened.

mod answered_mutations;
mod archive_record;
mod segment;
mod segment_writer;

use answered_mutations::AnsweredMutations;
pub(crate) use archive_record::ArchiveRecord;
pub(crate) use segment::Segment;
pub(crate) use segment_writer::SegmentWriter;

use std::collections::{BTreeMap, VecDeque};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use durable_leveldb::{Database, MutationId, StoreFolder};

use crate::digest::Digest;
use crate::error::{Error, StorageError};
use crate::history::HistoryEntry;

/// Archive of a store, with the record that says up to which entry it counts.
pub(crate) struct HistoryArchive {
    folder: PathBuf,
    pub(crate) record: ArchiveRecord,
    /// Last entry of each segment, by its first.
    segments: BTreeMap<u64, u64>,
    /// Segment that was read last.
    open: Option<(u64, Segment)>,
    /// Segments whose idempotency keys are kept, oldest first.
    answered: VecDeque<AnsweredSegment>,
    /// Shared with the readers of checkpoints: while there are any, no segment is removed.
    readers: Arc<()>,
}

/// Idempotency keys of a segment.
struct AnsweredSegment {
    first: u64,
    last_wall_ns: u64,
    mutations: AnsweredMutations,
}

/// `true` if a store folder has any archive segment.
pub(crate) fn has_segments(store: &StoreFolder) -> Result<bool, Error> {
    let names = file_names(&path(store))?;
    Ok(names.iter().any(|name| extent(name).is_some()))
}

/// Folder of the archive in a store folder.
pub(crate) fn path(store: &StoreFolder) -> PathBuf {
    store.path().join("history")
}

impl HistoryArchive {
    /// Lists the segments in a folder, which may be missing.
    pub(crate) fn open(folder: PathBuf, record: ArchiveRecord) -> Result<Self, Error> {
        let mut segments = BTreeMap::new();
        for name in file_names(&folder)? {
            if let Some((first, last)) = extent(&name)
                && last <= record.sequence
                && last > record.dropped
            {
                segments.insert(first, last);
            }
        }
        Ok(Self {
            folder,
            record,
            segments,
            open: None,
            answered: VecDeque::new(),
            readers: Arc::default(),
        })
    }

    /// Opens all of an archive whose record is lost.
    pub(crate) fn open_all(folder: PathBuf) -> Result<Self, Error> {
        let mut extents: Vec<(u64, u64)> = file_names(&folder)?
            .iter()
            .filter_map(|name| extent(name))
            .collect();
        extents.sort_unstable();
        let mut record = ArchiveRecord::default();
        if let (Some((first, _)), Some((_, last))) = (extents.first(), extents.last()) {
            record.dropped = first - 1;
            record.sequence = *last;
        }
        let mut archive = Self::open(folder, record)?;
        for (first, last) in extents {
            let path = archive.segment_path(first, last);
            archive.record.n_bytes += fs::metadata(path).map_or(0, |file| file.len());
            if let Ok(segment) = archive.open_segment(first, last) {
                archive.record.head = segment.head();
            }
        }
        Ok(archive)
    }

    /// Removes what a crash left behind: an incomplete file, the segment that follows the archived
    /// entries, which are in the database still, and segments that are recorded as dropped.
    pub(crate) fn clean_up(&self) -> Result<(), Error> {
        for name in file_names(&self.folder)? {
            let is_left = match extent(&name) {
                Some((first, last)) => {
                    first == self.record.sequence + 1 || last <= self.record.dropped
                }
                None => name.ends_with(".partial"),
            };
            if is_left {
                remove(&self.folder.join(name))?;
            }
        }
        Ok(())
    }

    /// Same archive for another reader, which keeps its segments from being removed.
    pub(crate) fn pin(&self) -> Arc<()> {
        Arc::clone(&self.readers)
    }

    /// Ranges of archived entries whose segment is missing.
    pub(crate) fn missing(&self) -> Vec<(u64, u64)> {
        let mut missing = Vec::new();
        let mut next = self.record.dropped + 1;
        for (&first, &last) in &self.segments {
            if first > next {
                missing.push((next, first - 1));
            }
            next = last + 1;
        }
        if next <= self.record.sequence {
            missing.push((next, self.record.sequence));
        }
        missing
    }

    /// Reads an archived entry; `None` for a lost one.
    pub(crate) fn entry(&mut self, sequence: u64) -> Result<Option<HistoryEntry>, Error> {
        let segment = self.segments.range(..=sequence).next_back();
        let Some((&first, &last)) = segment.filter(|(_, last)| sequence <= **last) else {
            return Ok(None);
        };
        if self.open.as_ref().is_none_or(|(open, _)| *open != first) {
            self.open = Some((first, self.open_segment(first, last)?));
        }
        let segment = self.open.as_ref();
        segment.map_or(Ok(None), |(_, segment)| segment.entry(sequence))
    }

    /// Extents of all segments, in order.
    pub(crate) fn extents(&self) -> Vec<(u64, u64)> {
        let segments = self.segments.iter();
        segments.map(|(first, last)| (*first, *last)).collect()
    }

    /// Opens a segment by its first and last entry.
    pub(crate) fn open_segment(&self, first: u64, last: u64) -> Result<Segment, Error> {
        Segment::open(&self.segment_path(first, last), first, last)
    }

    fn segment_path(&self, first: u64, last: u64) -> PathBuf {
        self.folder.join(format!("{first:012}-{last:012}"))
    }

    /// Begins a segment of `n_entries` entries after the archived ones.
    pub(crate) fn begin_segment(
        &self,
        engine: &Database,
        n_entries: u64,
    ) -> Result<SegmentWriter, Error> {
        if !self.folder.exists() {
            let create = || -> std::io::Result<()> {
                fs::create_dir(&self.folder)?;
                let parent = self.folder.parent().unwrap_or(Path::new("."));
                fs::File::open(parent)?.sync_all()
            };
            create().map_err(StorageError::io("creating", &self.folder))?;
        }
        let (first, last) = (self.record.sequence + 1, self.record.sequence + n_entries);
        SegmentWriter::begin(engine, &self.segment_path(first, last), &self.record)
    }

    /// Completes a segment; returns the archive record with it, to be committed.
    pub(crate) fn finish_segment(
        &mut self,
        writer: SegmentWriter,
        lost: &[(u64, u64)],
    ) -> Result<ArchiveRecord, Error> {
        let (first, last) = (self.record.sequence + 1, writer.next() - 1);
        let (index, n_bytes) = writer.finish()?;
        self.segments.insert(first, last);
        self.answered.push_back(AnsweredSegment {
            first,
            last_wall_ns: index.last_wall_ns,
            mutations: index.answered,
        });
        let is_archived = |range: &&(u64, u64)| range.0 <= last;
        let lost = lost.iter().filter(is_archived);
        Ok(ArchiveRecord {
            sequence: last,
            head: index.head,
            dropped: self.record.dropped,
            n_bytes: self.record.n_bytes + n_bytes,
            lost: lost.map(|(from, to)| (*from, last.min(*to))).collect(),
        })
    }

    /// Loads the idempotency keys of the segments that end after a time; returns sentences about
    /// segments that cannot be read.
    pub(crate) fn load_answered(&mut self, after_ns: u64) -> Vec<String> {
        let mut notes = Vec::new();
        for (first, last) in self.extents().into_iter().rev() {
            match self.open_segment(first, last) {
                Ok(segment) if segment.last_wall_ns() < after_ns => break,
                Ok(segment) => self.answered.push_front(AnsweredSegment {
                    first,
                    last_wall_ns: segment.last_wall_ns(),
                    mutations: segment.into_answered(),
                }),
                Err(error) => notes.push(error.to_string()),
            }
        }
        notes
    }

    /// Sequence number of the archived entry with an idempotency key, as long as it is kept.
    pub(crate) fn answered(&self, id: MutationId) -> Option<u64> {
        let newest_first = self.answered.iter().rev();
        let mut found = newest_first
            .filter_map(|segment| Some(segment.first + segment.mutations.offset_of(id)?));
        found.next()
    }

    /// Forgets the idempotency keys of segments that end before a time.
    pub(crate) fn expire_answered(&mut self, before_ns: u64) {
        let is_expired = |segment: &AnsweredSegment| segment.last_wall_ns < before_ns;
        while self.answered.front().is_some_and(is_expired) {
            self.answered.pop_front();
        }
    }

    /// First and last entry of the oldest segment, and the archive record that gives it as dropped;
    /// `None` while a checkpoint is read, or for the last segment.
    pub(crate) fn oldest(&self) -> Option<((u64, u64), ArchiveRecord)> {
        let is_read = Arc::strong_count(&self.readers) > 1;
        let (&first, &last) = self.segments.iter().next().filter(|_| !is_read)?;
        let file = fs::metadata(self.segment_path(first, last));
        let n_bytes = file.map_or(0, |file| file.len());
        let record = ArchiveRecord {
            dropped: last,
            n_bytes: self.record.n_bytes.saturating_sub(n_bytes),
            ..self.record.clone()
        };
        (self.segments.len() > 1).then_some(((first, last), record))
    }

    /// Removes the file of a segment that the archive record gives as dropped.
    pub(crate) fn remove_segment(&mut self, (first, last): (u64, u64)) -> Result<(), Error> {
        self.segments.remove(&first);
        self.answered.retain(|segment| segment.first != first);
        self.open.take_if(|(open, _)| *open == first);
        remove(&self.segment_path(first, last))
    }

    /// Visits all intact entries in order; `fault` gets a sentence about each damage, and the
    /// sequence numbers of the entries that it cost.
    pub(crate) fn visit(
        &self,
        mut visit: impl FnMut(HistoryEntry, Digest),
        mut fault: impl FnMut(String, Vec<u64>),
    ) {
        for (first, last) in self.missing() {
            let folder = self.folder.display();
            let sentence = format!("history entries {first} to {last} are missing in {folder}");
            fault(sentence, (first..=last).collect());
        }
        for (first, last) in self.extents() {
            let visited = match self.open_segment(first, last) {
                Ok(segment) => segment.visit(&mut visit),
                Err(error) => Err((error, (first..=last).collect())),
            };
            if let Err((error, lost)) = visited {
                fault(error.to_string(), lost);
            }
        }
    }
}

fn file_names(folder: &Path) -> Result<Vec<String>, Error> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(StorageError::io("listing", folder))?,
    };
    let mut names = Vec::new();
    for entry in entries {
        let entry = entry.map_err(StorageError::io("listing", folder))?;
        names.extend(entry.file_name().into_string());
    }
    Ok(names)
}

/// First and last entry in the name of a segment.
fn extent(name: &str) -> Option<(u64, u64)> {
    let (first, last) = name.split_once('-')?;
    Some((first.parse().ok()?, last.parse().ok()?))
}

fn remove(path: &Path) -> Result<(), Error> {
    match fs::remove_file(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        removed => Ok(removed.map_err(StorageError::io("removing", path))?),
    }
}
