//! Configuration layers: the main file and the drop-ins `*.toml` in the folder `FILE.d` beside it.

use super::ConfigError;
use rustix::fs::OFlags;
use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::io::{self, Read};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

/// Main file of an installed daemon.
pub(super) const SYSTEM_FILE: &str = "/etc/tabula/tabula.toml";
/// Largest size of a file and its drop-ins together, bytes.
const MAX_BYTES: u64 = 1 << 20;
/// Largest number of drop-ins.
pub(super) const MAX_DROP_INS: usize = 64;

/// Text of one configuration file.
#[derive(Debug)]
pub(super) struct ConfigLayer {
    pub(super) path: PathBuf,
    pub(super) text: String,
}

/// Layers of the configuration, the ones with less precedence first; none without any file.
///
/// # Errors
/// When a file or folder cannot be read, is too large, or there are too many drop-ins.
pub(super) fn find(given: Option<&Path>, home: &Path) -> Result<Vec<ConfigLayer>, ConfigError> {
    if let Some(given) = given {
        let drop_ins = drop_ins(given)?;
        let is_missing = !is_there(given) && !drop_ins.is_empty();
        return read_all((!is_missing).then(|| given.to_owned()), drop_ins);
    }
    for file in [home.join("tabula.toml"), PathBuf::from(SYSTEM_FILE)] {
        let drop_ins = drop_ins(&file)?;
        let file = is_there(&file).then_some(file);
        if file.is_some() || !drop_ins.is_empty() {
            return read_all(file, drop_ins);
        }
    }
    Ok(Vec::new())
}

/// Paths of the drop-ins of a file in the byte order of their names.
fn drop_ins(file: &Path) -> Result<Vec<PathBuf>, ConfigError> {
    let mut folder = file.as_os_str().to_owned();
    folder.push(".d");
    let folder = PathBuf::from(folder);
    let unreadable = |source| ConfigError::Unreadable {
        path: folder.clone(),
        source,
    };
    let entries = match std::fs::read_dir(&folder) {
        Err(error) if is_absent(&error) => return Ok(Vec::new()),
        entries => entries.map_err(unreadable)?,
    };
    let mut names: Vec<OsString> = Vec::new();
    for entry in entries {
        let name = entry.map_err(unreadable)?.file_name();
        if is_drop_in(&name) {
            names.push(name);
        }
        if names.len() > MAX_DROP_INS {
            return Err(ConfigError::TooManyDropIns { folder });
        }
    }
    names.sort_unstable();
    Ok(names.into_iter().map(|name| folder.join(name)).collect())
}

/// `false` only for what does not exist: a link that leads nowhere is there, and cannot be read.
fn is_there(file: &Path) -> bool {
    !file
        .symlink_metadata()
        .is_err_and(|error| is_absent(&error))
}

fn is_absent(error: &io::Error) -> bool {
    use io::ErrorKind::{NotADirectory, NotFound};
    matches!(error.kind(), NotFound | NotADirectory)
}

/// True for `*.toml`, but for a hidden file. Backups of editors and of dpkg have other endings.
fn is_drop_in(name: &OsStr) -> bool {
    let name = name.as_bytes();
    name.ends_with(b".toml") && !name.starts_with(b".")
}

fn read_all(
    file: Option<PathBuf>,
    drop_ins: Vec<PathBuf>,
) -> Result<Vec<ConfigLayer>, ConfigError> {
    let mut n_bytes_left = MAX_BYTES;
    let mut layers = Vec::new();
    for path in file.into_iter().chain(drop_ins) {
        match read(&path, n_bytes_left) {
            Ok(text) => {
                n_bytes_left -= text.len() as u64;
                layers.push(ConfigLayer { path, text });
            }
            Err(source) => return Err(ConfigError::Unreadable { path, source }),
        }
    }
    Ok(layers)
}

/// Reads at most `max_bytes` of a file. A pipe, which could make the reader wait, is refused.
fn read(path: &Path, max_bytes: u64) -> io::Result<String> {
    let invalid = |sentence| io::Error::new(io::ErrorKind::InvalidData, sentence);
    let file = File::options()
        .read(true)
        .custom_flags(OFlags::NONBLOCK.bits().cast_signed())
        .open(path)?;
    let kind = file.metadata()?.file_type();
    if !kind.is_file() && !kind.is_char_device() {
        return Err(invalid("it is not a file"));
    }
    let mut bytes = Vec::new();
    file.take(max_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max_bytes {
        return Err(invalid(
            "the configuration, its drop-ins included, is larger than 1 MiB",
        ));
    }
    String::from_utf8(bytes).map_err(|_| invalid("it is not UTF-8 text"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(layers: &[ConfigLayer]) -> Vec<String> {
        let name = |layer: &ConfigLayer| layer.path.file_name().unwrap().to_str().unwrap().into();
        layers.iter().map(name).collect()
    }

    #[test]
    fn layers_are_the_file_and_its_drop_ins_in_byte_order() {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("tabula.toml.d");
        std::fs::create_dir(&folder).unwrap();
        assert!(find(None, home.path()).unwrap().is_empty(), "no drop-in");
        for name in [
            "20-b.toml",
            "10-a.toml",
            "9.toml",
            "B.toml",
            "a.toml",
            ".hidden.toml",
            "c.toml~",
            "d.toml.dpkg-old",
            "e.toml.dpkg-dist",
            "readme",
        ] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        let sorted = ["10-a.toml", "20-b.toml", "9.toml", "B.toml", "a.toml"];
        assert_eq!(names(&find(None, home.path()).unwrap()), sorted, "alone");
        let file = home.path().join("tabula.toml");
        assert_eq!(names(&find(Some(&file), home.path()).unwrap()), sorted);
        std::fs::write(&file, "").unwrap();
        let found = find(None, home.path()).unwrap();
        assert_eq!(names(&found)[0], "tabula.toml");
        assert_eq!(names(&found)[1..], sorted);
    }

    #[test]
    fn layers_of_a_given_file_are_its_own() {
        let home = tempfile::tempdir().unwrap();
        std::fs::write(home.path().join("tabula.toml"), "").unwrap();
        let given = home.path().join("other.toml");
        let sentence = find(Some(&given), home.path()).unwrap_err().to_string();
        assert!(sentence.contains("other.toml"), "{sentence}");
        std::fs::write(&given, "").unwrap();
        let layers = find(Some(&given), home.path()).unwrap();
        assert_eq!(names(&layers), ["other.toml"]);
    }

    #[test]
    fn layers_have_bounds() {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("tabula.toml.d");
        std::fs::create_dir(&folder).unwrap();
        for number in 0..MAX_DROP_INS {
            std::fs::write(folder.join(format!("{number:03}.toml")), "").unwrap();
        }
        assert_eq!(find(None, home.path()).unwrap().len(), MAX_DROP_INS);
        let half = "#".repeat((MAX_BYTES / 2) as usize);
        std::fs::write(folder.join("000.toml"), &half).unwrap();
        std::fs::write(folder.join("001.toml"), &half).unwrap();
        assert_eq!(find(None, home.path()).unwrap().len(), MAX_DROP_INS);
        std::fs::write(folder.join("002.toml"), "#").unwrap();
        let sentence = find(None, home.path()).unwrap_err().to_string();
        assert!(sentence.contains("larger than 1 MiB"), "{sentence}");
        std::fs::write(folder.join("one-more.toml"), "").unwrap();
        let sentence = find(None, home.path()).unwrap_err().to_string();
        assert!(sentence.contains("drop-ins"), "{sentence}");
    }

    #[test]
    fn layers_are_files_and_never_wait() {
        let home = tempfile::tempdir().unwrap();
        let given = home.path().join("pipe.toml");
        rustix::fs::mkfifoat(rustix::fs::CWD, &given, rustix::fs::Mode::RUSR).unwrap();
        for path in [given.as_path(), home.path(), Path::new("/dev/zero")] {
            assert!(find(Some(path), home.path()).is_err(), "{path:?}");
        }
        let nothing = find(Some(Path::new("/dev/null")), home.path()).unwrap();
        assert_eq!(nothing[0].text, "");
    }
}
