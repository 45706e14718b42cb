//! Folder of PCD scenes.

use crate::{Error, pcd};
use file_access::{file_names, read_file};
use std::path::{Path, PathBuf};

/// Scenes of a folder, in natural order of their names.
#[derive(Debug, Clone)]
pub struct SceneFolder {
    folder: PathBuf,
    names: Vec<String>,
}

#[expect(
    clippy::len_without_is_empty,
    reason = "a folder without scenes cannot be opened"
)]
impl SceneFolder {
    /// Lists the PCD files of a folder without opening them.
    ///
    /// # Errors
    /// When the folder cannot be read or has no PCD files.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let names = file_names(folder, is_scene_name)?;
        if names.is_empty() {
            return Err(Error::NoScenes(folder.to_owned()));
        }
        Ok(Self {
            folder: folder.to_owned(),
            names,
        })
    }

    /// Number of scenes, at least 1.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// File name of a scene; `None` after the last.
    pub fn name(&self, index: usize) -> Option<&str> {
        self.names.get(index).map(String::as_str)
    }

    /// Reads the bytes of a scene into a buffer, for [`pcd::Header::parse`]. The buffer's memory is
    /// reused.
    ///
    /// # Errors
    /// When there is no such scene, or its file cannot be read or is larger
    /// than [`pcd::MAX_BYTES`].
    pub fn read_bytes(&self, index: usize, buffer: &mut Vec<u8>) -> Result<(), Error> {
        let (what, n) = ("scene", self.names.len());
        let name = self
            .names
            .get(index)
            .ok_or(Error::NoSuch { what, index, n })?;
        Ok(read_file(&self.folder.join(name), pcd::MAX_BYTES, buffer)?)
    }
}

/// True if a file name is that of a scene.
pub(crate) fn is_scene_name(name: &str) -> bool {
    name.strip_suffix(".pcd")
        .is_some_and(|stem| !stem.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_come_in_natural_order() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["learn10.pcd", "learn2.pcd", "learn2.txt", ".pcd"] {
            std::fs::write(folder.path().join(name), name).unwrap();
        }
        let scenes = SceneFolder::open(folder.path()).unwrap();
        assert_eq!(scenes.len(), 2);
        let mut bytes = Vec::new();
        for (index, name) in ["learn2.pcd", "learn10.pcd"].into_iter().enumerate() {
            assert_eq!(scenes.name(index), Some(name));
            scenes.read_bytes(index, &mut bytes).unwrap();
            assert_eq!(bytes, name.as_bytes());
        }
        let error = scenes.read_bytes(2, &mut bytes).unwrap_err();
        assert!(
            matches!(error, Error::NoSuch { index: 2, n: 2, .. }),
            "{error}"
        );
    }

    #[test]
    fn a_folder_without_scenes_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = SceneFolder::open(folder.path()).unwrap_err().to_string();
        assert!(
            error.contains(&folder.path().display().to_string()),
            "{error}"
        );
        let error = SceneFolder::open(&folder.path().join("missing")).unwrap_err();
        assert!(matches!(error, Error::File(_)), "{error}");
    }
}
