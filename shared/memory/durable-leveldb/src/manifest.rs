//! Manifest: the tables of a database, by level.
//!
//! Formats: LevelDB's `doc/impl.md` and `db/version_edit.cc`.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::env_health::EnvHealth;
use crate::error::Error;
use crate::raw_log::{take_slice, visit_log_records};
use crate::raw_table::user_key;
use crate::verified_files::{read_file, read_log, take_varint};

/// Number of levels of LevelDB.
const N_LEVELS: usize = 7;

/// Tags of log number, next file number and last sequence number, without which a manifest is cut.
const REQUIRED_TAGS: u64 = 1 << 2 | 1 << 3 | 1 << 4;

/// State that the manifest describes.
#[derive(Debug, Default)]
pub(crate) struct Manifest {
    /// Number of the oldest of LevelDB's own logs that is not in tables.
    log_number: u64,
    /// Number of one more such log; zero for none.
    previous_log_number: u64,
    /// Sequence number of the last record in the tables.
    pub(crate) last_sequence: u64,
    /// Tags of all fields that were set.
    tags: u64,
    /// Tables of each level, in order of their addition.
    pub(crate) levels: [Vec<TableMetadata>; N_LEVELS],
}

/// Entry of the manifest about a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TableMetadata {
    pub(crate) number: u64,
    pub(crate) n_bytes: u64,
    /// Smallest key in the table.
    pub(crate) smallest: Vec<u8>,
    /// Largest key in the table.
    pub(crate) largest: Vec<u8>,
}

impl Manifest {
    /// Reads the current manifest of a database; `None` if there is no database.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] when the manifest cannot be found or read at all, [`Error::Io`]. Damage
    /// of a part is recorded by the health monitor.
    pub(crate) fn read(folder: &Path, health: &EnvHealth) -> Result<Option<Self>, Error> {
        let current = folder.join("CURRENT");
        if matches!(fs::metadata(&current), Err(error) if error.kind() == io::ErrorKind::NotFound) {
            return Ok(None);
        }
        let failed = |error: io::Error| match health.failure() {
            Some(failure) => failure.into(),
            None => Error::Damaged {
                what: error.to_string(),
            },
        };
        let name = read_file(&current, health).map_err(failed)?;
        let name = str::from_utf8(&name).unwrap_or_default().trim_end();
        let number = name.strip_prefix("MANIFEST-");
        if number.is_none_or(|number| number.parse::<u64>().is_err()) {
            let what = format!("{} does not name a manifest", current.display());
            health.note_damage(what.clone());
            return Err(Error::Damaged { what });
        }
        let path = folder.join(name);
        let log = read_log(&path, health).map_err(failed)?;
        let mut manifest = Self::default();
        let mut is_valid = true;
        visit_log_records(&log, |edit| is_valid &= manifest.apply(edit).is_some());
        if !is_valid {
            health.note_damage(format!("{}: it has an invalid entry", path.display()));
        }
        if manifest.tags & REQUIRED_TAGS != REQUIRED_TAGS {
            let what = format!("{}: its first entry is missing", path.display());
            health.note_damage(what.clone());
            return Err(Error::Damaged { what });
        }
        Ok(Some(manifest))
    }

    /// Applies one version edit; `None` if it is invalid.
    fn apply(&mut self, mut edit: &[u8]) -> Option<()> {
        let edit = &mut edit;
        while !edit.is_empty() {
            let tag = take_varint(edit)?;
            self.tags |= 1_u64.checked_shl(u32::try_from(tag).ok()?)?;
            match tag {
                // The comparator, which is always that of bytes.
                1 => {
                    take_slice(edit)?;
                }
                2 => self.log_number = take_varint(edit)?,
                // The next number of a file.
                3 => {
                    take_varint(edit)?;
                }
                4 => self.last_sequence = take_varint(edit)?,
                // Where the next compaction of a level begins.
                5 => {
                    take_varint(edit)?;
                    take_slice(edit)?;
                }
                6 => {
                    let level = self.level(take_varint(edit)?)?;
                    let number = take_varint(edit)?;
                    level.retain(|table| table.number != number);
                }
                7 => {
                    let level = take_varint(edit)?;
                    let table = TableMetadata {
                        number: take_varint(edit)?,
                        n_bytes: take_varint(edit)?,
                        smallest: user_key(take_slice(edit)?)?.to_vec(),
                        largest: user_key(take_slice(edit)?)?.to_vec(),
                    };
                    self.level(level)?.push(table);
                }
                9 => self.previous_log_number = take_varint(edit)?,
                _ => return None,
            }
        }
        Some(())
    }

    fn level(&mut self, level: u64) -> Option<&mut Vec<TableMetadata>> {
        self.levels.get_mut(usize::try_from(level).ok()?)
    }

    /// `true` if one of LevelDB's own logs has records that are not in tables.
    pub(crate) fn has_log(&self, number: u64) -> bool {
        number >= self.log_number || number == self.previous_log_number && number > 0
    }
}

/// Files of a folder with an extension and a number as name, by number.
pub(crate) fn numbered_files(folder: &Path, extension: &str) -> io::Result<Vec<(u64, PathBuf)>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let number = path.file_stem().and_then(OsStr::to_str);
        let number = number.and_then(|number| number.parse().ok());
        if let Some(number) = number
            && path.extension() == Some(OsStr::new(extension))
        {
            files.push((number, path));
        }
    }
    files.sort_unstable();
    Ok(files)
}
