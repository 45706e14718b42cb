//! The database as it was at one instant, for long readings: exports and
//! verifications read it in their own thread, and nobody waits for them.
//!
//! Tables never change, so a checkpoint shares them by hard links; the log and the
//! manifest are copied.

use std::fs;
use std::path::{Path, PathBuf};

use learning::ViewId;

use crate::catalogue::{Catalogue, Entry};
use crate::digest::Digest;
use crate::document::{Document, DocumentContent, DocumentKey};
use crate::economy;
use crate::engine::{Engine, WRITE_BUFFER_BYTES};
use crate::error::{Error, in_words};
use crate::examination::{Examination, examine, schema};
use crate::findings::Findings;
use crate::foreign::{ForeignDocument, ForeignView};
use crate::keys;
use crate::meta::{SCHEMA, StoreId};
use crate::perceptual_memory::PerceptualMemory;
use crate::reading::{Position, read_content, read_parts};
use crate::standing::Standing;
use crate::store_folder::StoreFolder;
use crate::watermark::{Mark, Watermark};

/// A copy of the database's files; removed when it is dropped.
#[derive(Debug)]
pub struct Checkpoint {
    folder: PathBuf,
    /// What it shows.
    pub position: Position,
}

impl Drop for Checkpoint {
    fn drop(&mut self) {
        // What cannot be removed now is removed when the store is opened.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

impl PerceptualMemory {
    /// Makes a checkpoint of what is on disk; takes milliseconds.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the disk has no room for a copy of the log.
    pub fn checkpoint(&self) -> Result<Checkpoint, Error> {
        self.usable()?;
        make(&self.folder, self.position())
    }
}

fn make(folder: &StoreFolder, position: Position) -> Result<Checkpoint, Error> {
    let path = folder.new_checkpoint();
    fs::create_dir(&path).map_err(Error::io("creating", &path))?;
    // From here on it is removed when something fails.
    let checkpoint = Checkpoint {
        folder: path,
        position,
    };
    let database = folder.database();
    let entries = fs::read_dir(&database).map_err(Error::io("listing", &database))?;
    for entry in entries.flatten() {
        let to = checkpoint.folder.join(entry.file_name());
        copy(&entry.path(), &to).map_err(Error::io("copying", entry.path()))?;
    }
    Ok(checkpoint)
}

fn copy(from: &Path, to: &Path) -> std::io::Result<()> {
    let is_table = from
        .extension()
        .is_some_and(|extension| extension == "ldb" || extension == "sst");
    if is_table && fs::hard_link(from, to).is_ok() {
        return Ok(());
    }
    fs::copy(from, to).map(|_| ())
}

/// A checkpoint opened for reading.
pub struct CheckpointReader {
    engine: Engine,
    catalogue: Catalogue,
    findings: Findings,
    /// Last, so that the folder is there until the database is closed.
    checkpoint: Checkpoint,
}

/// What a whole reading of a store found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verification {
    /// What was verified.
    pub position: Position,
    /// Views of which everything was read.
    pub n_views: u64,
    /// Documents of which everything was read.
    pub n_documents: u64,
    /// Entries of the history, each of which follows the one before.
    pub n_history: u64,
    /// Bytes of descriptors, clouds and documents, all as their digests say.
    pub n_content_bytes: u64,
    /// How many things are wrong.
    pub n_findings: u64,
    /// The first ones in words.
    pub findings: Vec<String>,
}

/// Reads everything in a store that no process has open, and changes nothing.
/// `progress` is told how many views have been read, and how many there are.
///
/// # Errors
///
/// [`Error::InUse`], [`Error::NewerSchema`], [`Error::Io`]; damage is a finding.
pub fn verify_folder(
    folder: &Path,
    mut progress: impl FnMut(u64, u64),
) -> Result<Verification, Error> {
    let folder = StoreFolder::hold_existing(folder)?;
    let (_, mark) =
        Watermark::open(&folder.watermark()).map_err(Error::io("opening", folder.watermark()))?;
    let nowhere = Position {
        store_id: StoreId(0),
        sequence: 0,
    };
    let checkpoint = make(&folder, nowhere)?;
    let mut reader = match checkpoint.open_marked(mark.ok().flatten().as_ref()) {
        Ok(reader) => reader,
        Err(Error::Damaged { what }) => {
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
    /// Opens it; the index is read and checked.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] when it cannot be read at all, [`Error::Io`].
    pub fn open(self) -> Result<CheckpointReader, Error> {
        self.open_marked(None)
    }

    /// As [`Self::open`]; what the mark says was acknowledged must be there.
    fn open_marked(mut self, mark: Option<&Mark>) -> Result<CheckpointReader, Error> {
        let mut engine = Engine::open(&self.folder, WRITE_BUFFER_BYTES)?;
        if let Some(schema) = schema(&mut engine)?.filter(|schema| *schema < SCHEMA) {
            return Err(Error::Damaged {
                what: format!(
                    "it has schema {schema}, not {SCHEMA}; it is brought over when the daemon \
                     opens it"
                ),
            });
        }
        let Examination {
            catalogue,
            findings,
            meta,
            ..
        } = examine(&mut engine, mark)?;
        if let Some(meta) = meta {
            self.position = Position {
                store_id: meta.store_id(),
                sequence: meta.sequence,
            };
        }
        Ok(CheckpointReader {
            engine,
            catalogue,
            findings,
            checkpoint: self,
        })
    }
}

impl Verification {
    /// Of a store of which nothing was read yet.
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
    /// What it shows.
    pub fn position(&self) -> Position {
        self.checkpoint.position
    }

    /// Number of views in it whose content is there.
    pub fn n_views(&self) -> usize {
        self.catalogue.n_all()
    }

    /// Reads everything, and compares it with what it must be. `progress` is told
    /// how many views have been read.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the system is short of something; damage is a finding.
    pub fn verify(mut self, mut progress: impl FnMut(u64)) -> Result<Verification, Error> {
        let position = self.position();
        let mut found = Verification {
            n_history: position.sequence.saturating_sub(self.catalogue.n_lost()),
            ..Verification::of(position)
        };
        let views: Vec<ViewId> = self.catalogue.all().map(|(view, _)| view).collect();
        for view in views {
            if let Some(n_bytes) = self.verify_view(view)? {
                found.n_content_bytes += n_bytes;
            }
            found.n_views += 1;
            progress(found.n_views);
        }
        let versions: Vec<_> = self
            .catalogue
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

    /// Reads a view; the bytes of its content when all is well.
    fn verify_view(&mut self, view: ViewId) -> Result<Option<u64>, Error> {
        let mut reader = self.engine.reader()?;
        match read_parts(&mut reader, view) {
            Ok(parts) if parts.is_what_it_says() => {
                let n_points = parts.points.as_ref().map_or(0, Vec::len);
                Ok(Some((parts.descriptor.len() + n_points) as u64))
            }
            Ok(_) => {
                let view = in_words(view);
                let finding = || format!("the content of {view} is not what its digest says");
                self.findings.add(finding);
                Ok(None)
            }
            Err(Error::Damaged { what }) => {
                self.findings.add(|| what);
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    fn verify_document(&mut self, document: &DocumentKey, digest: Digest) -> Result<(), Error> {
        let mut reader = self.engine.reader()?;
        match read_content(&mut reader, &keys::digest_key(keys::BLOB, digest)) {
            Ok(content) if Digest::of(&content) == digest => Ok(()),
            Ok(_) => {
                self.findings
                    .add(|| format!("the content of {document} is not what its digest says"));
                Ok(())
            }
            Err(Error::Damaged { what }) => {
                self.findings.add(|| what);
                Ok(())
            }
            Err(error) => Err(error),
        }
    }

    /// Everything another memory can take over, in an order that depends only on
    /// what is known: views by identity, then documents by name. What was given up
    /// for a limit of this store is left out: another robot may have room for it.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`], [`Error::Io`], and those of `take`.
    pub fn export<E: From<Error>>(
        &mut self,
        mut take_view: impl FnMut(ForeignView) -> Result<(), E>,
        mut take_document: impl FnMut(ForeignDocument) -> Result<(), E>,
    ) -> Result<(), E> {
        let is_told = |entry: &Entry| {
            let register = &entry.register;
            register.standing != Standing::Forgotten || !economy::is_own_limit(&register.decided)
        };
        let told = self.catalogue.all().filter(|(_, entry)| is_told(entry));
        let mut identities: Vec<_> = told.map(|(_, entry)| entry.identity).collect();
        identities.extend(self.catalogue.tombstones.keys());
        identities.sort_unstable();
        for identity in identities {
            take_view(self.foreign_view(identity)?)?;
        }
        let mut documents: Vec<_> = self
            .catalogue
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
        let known = self.catalogue.by_identity(identity);
        let Some((view, entry)) = known else {
            let decided = self.catalogue.tombstones.get(&identity).cloned();
            let decided = decided.unwrap_or_default();
            return Ok(ForeignView::Forgotten { identity, decided });
        };
        let register = &entry.register;
        if register.standing == Standing::Forgotten {
            let decided = register.decided.clone();
            return Ok(ForeignView::Forgotten { identity, decided });
        }
        let parts = read_parts(&mut self.engine.reader()?, view)?;
        let is_decided = register.decided.stamp_ns > 0;
        Ok(ForeignView::Present {
            origin: parts.facts.origin(),
            view: Box::new(parts.into_view(view)),
            standing: register.standing.clone(),
            decided: is_decided.then(|| register.decided.clone()),
        })
    }

    fn document(&mut self, key: &DocumentKey, content: DocumentContent) -> Result<Document, Error> {
        let blob = keys::digest_key(keys::BLOB, content.digest);
        Ok(Document {
            key: key.clone(),
            media_type: content.media_type,
            content: read_content(&mut self.engine.reader()?, &blob)?,
        })
    }
}
