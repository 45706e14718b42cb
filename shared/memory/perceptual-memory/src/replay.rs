//! Replay: reconstruction of a store from its history.

use std::path::Path;

use crate::decision::NewContent;
use crate::error::{Error, StoreRefusal};
use crate::history::HistoryEntry;
use crate::keys;
use crate::model::Effect;
use crate::opening::OpenReport;
use crate::perceptual_memory::PerceptualMemory;
use crate::record_reader::{read_content, read_parts};

impl PerceptualMemory {
    /// Replays the history into an empty `folder`. Only the content of views and documents is
    /// copied; everything else follows from the history. Both stores then hold the same records,
    /// byte for byte.
    ///
    /// # Errors
    ///
    /// Those of [`PerceptualMemory::open`] and of reading and writing; and
    /// [`Error::Refused`] when `folder` holds a store already.
    pub fn replay_into(&mut self, folder: &Path) -> Result<(Self, OpenReport), Error> {
        let (mut copy, report) = Self::open(folder, 0)?;
        if copy.sequence() > 0 {
            return Err(StoreRefusal::NotEmpty.into());
        }
        copy.begin_as(self.meta.before_history())?;
        for sequence in 1..=self.sequence() {
            if self.index.is_lost(sequence) {
                continue;
            }
            let entry = self.entry(sequence)?;
            let contents = self.contents_of(&entry)?;
            copy.stage_entry(entry, &contents);
            copy.commit()?;
        }
        Ok((copy, report))
    }

    /// Content that the entry inserted and that still exists.
    fn contents_of(&mut self, entry: &HistoryEntry) -> Result<NewContent, Error> {
        let mut contents = NewContent::default();
        for effect in &entry.effects {
            match effect {
                Effect::Stored { view, identity } => {
                    let known = self.index.get(*view);
                    if known.is_some_and(|known| known.identity == *identity) {
                        let parts = self.read(|reader| read_parts(reader, *view))?;
                        contents.views.insert(*identity, parts);
                    }
                }
                Effect::Document {
                    after: Some(content),
                    ..
                } if self.index.has_blob(content.digest) => {
                    let key = keys::digest_key(keys::BLOB, content.digest);
                    let bytes = self.read(|reader| read_content(reader, &key))?;
                    contents.documents.insert(content.digest, bytes);
                }
                _ => {}
            }
        }
        Ok(contents)
    }

    /// Visits every record of the database in key order.
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`](crate::StorageError::Damaged) or [`Error::Failed`].
    pub fn visit_records(&mut self, mut visit: impl FnMut(&[u8], &[u8])) -> Result<(), Error> {
        self.read(|reader| Ok(reader.scan_prefix(&[], |key, record| visit(key, record))?))
    }
}
