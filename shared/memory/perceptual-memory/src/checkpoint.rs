//! Checkpoints: states of the store on which exports and verifications run in their own thread.
//!
//! Later writes do not change what a checkpoint reads, and wait for it in no way: tables that
//! compaction replaces meanwhile are deleted after it, and no archive segment is dropped.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use durable_leveldb::{Database, Reader, StoreFolder, WRITE_BUFFER_BYTES};
use learning::ViewId;

use crate::archive::{self, HistoryArchive};
use crate::consistency_check::{ConsistencyReport, check_consistency, schema};
use crate::digest::Digest;
use crate::document::{DocumentContent, MemoryDocument};
use crate::document_key::DocumentKey;
use crate::error::{Error, StorageError};
use crate::exchange::{ForeignDocument, ForeignView};
use crate::findings::Findings;
use crate::history_verification::verify_history;
use crate::index_row::IndexedView;
use crate::keys;
use crate::label_status::{DecisionStamp, LabelStatus};
use crate::meta::{SCHEMA, StoreId};
use crate::perceptual_memory::PerceptualMemory;
use crate::queries::Position;
use crate::record_reader::{read_content, read_parts};
use crate::store_index::StoreIndex;
use crate::view_phrase::view_phrase;
use crate::view_record::ViewMetadata;
use crate::watermark::{self, Watermark, WatermarkRecord};

/// State of the store at one time; dropping it releases its files.
pub struct Checkpoint {
    reader: Reader,
    /// Folder of the archived history.
    history: PathBuf,
    /// Keeps the archive segments from being dropped.
    pin: Arc<()>,
    /// History position of the state.
    pub position: Position,
}

impl PerceptualMemory {
    /// Makes a checkpoint of the durable state; takes microseconds.
    ///
    /// # Errors
    ///
    /// [`Error::Failed`] or [`StorageError::Io`].
    pub fn checkpoint(&mut self) -> Result<Checkpoint, Error> {
        self.usable()?;
        Ok(Checkpoint {
            reader: self.engine.snapshot()?,
            history: archive::path(&self.folder),
            pin: self.archive.pin(),
            position: self.position(),
        })
    }
}

/// Checkpoint opened for reading.
pub struct CheckpointReader {
    reader: Reader,
    archive: HistoryArchive,
    index: StoreIndex,
    findings: Findings,
    position: Position,
    #[expect(dead_code, reason = "keeps the archive segments from being dropped")]
    pin: Arc<()>,
}

/// Result of a full verification.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verification {
    /// History position of the verified checkpoint.
    pub position: Position,
    /// Number of views read completely.
    pub n_views: u64,
    /// Number of document versions read completely.
    pub n_documents: u64,
    /// Number of entries in the verified hash chain.
    pub n_history: u64,
    /// Bytes of descriptors, point clouds and documents whose digests match.
    pub n_content_bytes: u64,
    /// Number of integrity errors found by verification.
    pub n_findings: u64,
    /// First integrity errors found, as sentences.
    pub findings: Vec<String>,
}

/// Verifies all content of a store that no process has open; read-only. `progress` gets the number
/// of views read and the total.
///
/// # Errors
///
/// [`StorageError::InUse`], [`StorageError::NewerSchema`], [`StorageError::Io`]; damage is a
/// finding.
pub fn verify_folder(
    folder: &Path,
    mut progress: impl FnMut(u64, u64),
) -> Result<Verification, Error> {
    let folder = StoreFolder::hold_existing(folder)?;
    let (_, mark) = Watermark::open(&watermark::path(&folder))
        .map_err(StorageError::io("opening", watermark::path(&folder)))?;
    let nowhere = Position {
        store_id: StoreId(0),
        sequence: 0,
    };
    let opened = Database::open(&folder.database(), WRITE_BUFFER_BYTES);
    let opened = opened.map_err(Error::from).and_then(|database| {
        let checkpoint = Checkpoint {
            reader: database.reader(),
            history: archive::path(&folder),
            pin: Arc::default(),
            position: nowhere,
        };
        checkpoint.open_marked(mark.ok().flatten().as_ref())
    });
    let mut reader = match opened {
        Ok(reader) => reader,
        Err(Error::Storage(StorageError::Damaged { what })) => {
            return Ok(Verification {
                n_findings: 1,
                findings: vec![what],
                ..Verification::of(nowhere)
            });
        }
        Err(error) => return Err(error),
    };
    if folder.database_is_headless()? {
        reader
            .findings
            .add(|| "its file CURRENT is missing".to_owned());
    }
    let n_views = reader.n_views() as u64;
    reader.verify(|done| progress(done, n_views))
}

impl Checkpoint {
    /// Opens the checkpoint; loads and checks its index.
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`] when it cannot be read at all, [`StorageError::Io`].
    pub fn open(self) -> Result<CheckpointReader, Error> {
        self.open_marked(None)
    }

    /// Opens the checkpoint and compares it with the watermark.
    fn open_marked(mut self, mark: Option<&WatermarkRecord>) -> Result<CheckpointReader, Error> {
        if let Some(schema) = schema(&self.reader)?.filter(|schema| *schema < SCHEMA) {
            return Err(Error::Storage(StorageError::Damaged {
                what: format!(
                    "it has schema {schema}, not {SCHEMA}; it is brought over when the daemon \
                     opens it"
                ),
            }));
        }
        let ConsistencyReport {
            index,
            findings,
            meta,
            archived,
            ..
        } = check_consistency(&self.reader, mark)?;
        if let Some(meta) = meta {
            self.position = Position {
                store_id: meta.store_id(),
                sequence: meta.sequence,
            };
        }
        Ok(CheckpointReader {
            reader: self.reader,
            archive: HistoryArchive::open(self.history, archived)?,
            index,
            findings,
            position: self.position,
            pin: self.pin,
        })
    }
}

impl Verification {
    /// Verification result without integrity errors at a position.
    fn of(position: Position) -> Self {
        Self {
            position,
            n_views: 0,
            n_documents: 0,
            n_history: 0,
            n_content_bytes: 0,
            n_findings: 0,
            findings: Vec::new(),
        }
    }
}

impl CheckpointReader {
    /// History position at which the checkpoint was made.
    pub fn position(&self) -> Position {
        self.position
    }

    /// Number of views with content in the checkpoint.
    pub fn n_views(&self) -> usize {
        self.index.n_all()
    }

    /// Reads the whole history and compares the records with it, then all content, and compares it
    /// with its digests. `progress` gets the number of views read.
    ///
    /// # Errors
    ///
    /// [`StorageError::Io`] when the system is short of something; damage is a finding.
    pub fn verify(self, mut progress: impl FnMut(u64)) -> Result<Verification, Error> {
        self.verify_while(|n_views| {
            progress(n_views);
            ControlFlow::Continue(())
        })
    }

    /// Verifies like [`Self::verify`] until `progress` breaks.
    ///
    /// # Errors
    ///
    /// As there, and [`Error::Stopped`] when it does.
    pub fn verify_while(
        mut self,
        mut progress: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Verification, Error> {
        let position = self.position();
        let Self {
            reader,
            archive,
            index,
            findings,
            ..
        } = &mut self;
        let n_history = verify_history(archive, reader, index, findings)?;
        let mut found = Verification {
            n_history,
            ..Verification::of(position)
        };
        let views: Vec<ViewId> = self.index.all().map(|(view, _)| view).collect();
        for view in views {
            if let Some(n_bytes) = self.verify_view(view)? {
                found.n_content_bytes += n_bytes;
            }
            found.n_views += 1;
            if progress(found.n_views).is_break() {
                return Err(Error::Stopped);
            }
        }
        let versions: Vec<_> = self
            .index
            .versions()
            .filter_map(|(key, _, version, _)| Some((key.clone(), version.content.clone()?)))
            .collect();
        for (document, content) in versions {
            self.verify_document(&document, content.digest)?;
            found.n_content_bytes += content.n_bytes as u64;
            found.n_documents += 1;
        }
        found.n_findings = self.findings.count();
        found.findings = self.findings.into_words();
        Ok(found)
    }

    /// Verifies one view; returns its content size in bytes if it is intact.
    fn verify_view(&mut self, view: ViewId) -> Result<Option<u64>, Error> {
        match read_parts(&self.reader, view) {
            Ok(parts) if !self.matches_row(view, &parts.metadata) => {
                let finding = || format!("the index row of {} is another's", view_phrase(view));
                self.findings.add(finding);
                Ok(None)
            }
            Ok(parts) if parts.is_what_it_says() => {
                let n_points = parts.points.as_ref().map_or(0, Vec::len);
                Ok(Some((parts.descriptor.len() + n_points) as u64))
            }
            Ok(_) => {
                let view = view_phrase(view);
                let finding = || format!("the content of {view} does not match its digest");
                self.findings.add(finding);
                Ok(None)
            }
            Err(Error::Storage(StorageError::Damaged { what })) => {
                self.findings.add(|| what);
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    fn matches_row(&self, view: ViewId, metadata: &ViewMetadata) -> bool {
        let row = self.index.get(view);
        row.is_some_and(|row| row.matches(metadata))
    }

    fn verify_document(&mut self, document: &DocumentKey, digest: Digest) -> Result<(), Error> {
        match read_content(&self.reader, &keys::digest_key(keys::BLOB, digest)) {
            Ok(content) if Digest::of(&content) == digest => Ok(()),
            Ok(_) => {
                self.findings
                    .add(|| format!("the content of {document} does not match its digest"));
                Ok(())
            }
            Err(Error::Storage(StorageError::Damaged { what })) => {
                self.findings.add(|| what);
                Ok(())
            }
            Err(error) => Err(error),
        }
    }

    /// Exports everything that another memory can import, in a canonical order: views by content
    /// digest, then documents by key. Views forgotten only because of a local retention limit are
    /// left out.
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`], [`StorageError::Io`], and those of `take`.
    pub fn export<E: From<Error>>(
        &mut self,
        mut take_view: impl FnMut(ForeignView) -> Result<(), E>,
        mut take_document: impl FnMut(ForeignDocument) -> Result<(), E>,
    ) -> Result<(), E> {
        let is_exported = |entry: &IndexedView| {
            let register = &entry.register;
            register.standing != LabelStatus::Forgotten || !register.decided.is_limit_decision()
        };
        let exported = self.index.all().filter(|(_, entry)| is_exported(entry));
        let mut identities: Vec<_> = exported.map(|(_, entry)| entry.identity).collect();
        identities.extend(self.index.tombstones().map(|(identity, _)| identity));
        identities.sort_unstable();
        for identity in identities {
            take_view(self.foreign_view(identity)?)?;
        }
        let mut documents: Vec<_> = self
            .index
            .versions()
            .filter(|(.., replaced_ns)| replaced_ns.is_none())
            .map(|(key, _, version, _)| (key.clone(), version.clone()))
            .collect();
        documents.sort_by(|a, b| a.0.cmp(&b.0));
        for (key, version) in documents {
            let document = match version.content {
                None => None,
                Some(content) => Some(self.document(&key, content)?),
            };
            take_document(ForeignDocument {
                key,
                document,
                decided: version.decided,
            })?;
        }
        Ok(())
    }

    fn foreign_view(&mut self, identity: Digest) -> Result<ForeignView, Error> {
        let known = self.index.by_identity(identity);
        // Who forgot a view is in the history of the robot on which it was forgotten.
        let forgotten = |stamp_ns| ForeignView::Forgotten {
            identity,
            decided: DecisionStamp {
                author: "".into(),
                stamp_ns,
            },
        };
        let Some((view, entry)) = known else {
            return Ok(forgotten(self.index.tombstone(identity).unwrap_or(0)));
        };
        let register = &entry.register;
        if register.standing == LabelStatus::Forgotten {
            return Ok(forgotten(register.decided.stamp_ns));
        }
        let parts = read_parts(&self.reader, view)?;
        let is_decided = register.decided.stamp_ns > 0;
        Ok(ForeignView::Present {
            origin: parts.metadata.origin(),
            view: Box::new(parts.into_view(view)),
            standing: register.standing.clone(),
            decided: is_decided.then(|| register.decided.clone()),
        })
    }

    fn document(
        &mut self,
        key: &DocumentKey,
        content: DocumentContent,
    ) -> Result<MemoryDocument, Error> {
        let blob = keys::digest_key(keys::BLOB, content.digest);
        Ok(MemoryDocument {
            key: key.clone(),
            media_type: content.media_type,
            content: read_content(&self.reader, &blob)?,
        })
    }
}
