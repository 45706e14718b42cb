//! Read-only opening of a store whose disk is full, or cannot be written for another reason: what
//! is known can be read and exported, and nothing can be changed.

use std::path::Path;
use std::sync::Arc;

use durable_leveldb::StoreFolder;

use crate::archive::{self, HistoryArchive};
use crate::consistency_check::{check_consistency, schema};
use crate::error::{Error, StorageError};
use crate::meta::SCHEMA;
use crate::model::RetentionLimits;
use crate::opening::{Condition, OpenReport};
use crate::perceptual_memory::{PerceptualMemory, ReadOnly};
use crate::watermark::{self, Watermark};

/// Opens an existing store for reading, and changes nothing. `reason` is why it cannot be written.
///
/// # Errors
///
/// [`StorageError::InUse`]; [`StorageError::Damaged`] when the database is damaged or of an older
/// schema, which only an opening for writing mends; [`StorageError::Io`].
pub(crate) fn open(
    folder: &Path,
    limits: RetentionLimits,
    (wall_ns, reason): (u64, Error),
) -> Result<(PerceptualMemory, OpenReport), Error> {
    let folder = StoreFolder::hold_for_reading(folder)?;
    let path = watermark::path(&folder);
    let (watermark, mark) =
        Watermark::open_for_reading(&path).map_err(StorageError::io("opening", path))?;
    let damaged = |what: String| Error::Storage(StorageError::Damaged { what });
    let mark = mark.map_err(|wrong| damaged(format!("the watermark is unreadable: {wrong}")))?;
    let engine = folder.open_database()?;
    if schema(&engine.reader())?.is_none_or(|schema| schema < SCHEMA) {
        return Err(damaged("it is of an older schema".to_owned()));
    }
    let examination = check_consistency(&engine.reader(), mark.as_ref())?;
    let findings = examination.findings.into_words();
    let meta = examination.meta.filter(|_| findings.is_empty());
    let meta = meta.ok_or_else(|| damaged(findings.join("; ")))?;
    let mut archive = HistoryArchive::open(archive::path(&folder), examination.archived)?;
    let notes = archive.load_answered(wall_ns.saturating_sub(limits.history.answered_kept_ns));
    let condition = Condition::ReadOnly {
        reason: reason.to_string(),
    };
    let index = examination.index;
    let report = OpenReport::of(condition, &index, meta.sequence, notes);
    let mut memory = PerceptualMemory::new((engine, archive), index, meta, watermark, folder);
    memory.set_limits(limits);
    memory.sizes = examination.sizes;
    memory.last_wall_ns = wall_ns;
    memory.read_only = Some(ReadOnly {
        reason: Arc::new(reason),
        acknowledged: mark.map_or(0, |mark| mark.sequence),
    });
    Ok((memory, report))
}
