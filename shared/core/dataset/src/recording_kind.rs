//! Detection of the kind of a recording by its file names.

use crate::{Error, fakenect_folder, registered_images, rgbd_sequence, scene_folder};
use file_access::file_names;
use std::fmt;
use std::path::Path;

/// Kind of a recording that a camera can play.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecordingKind {
    /// PCD scenes, see [`crate::scene_folder`].
    PcdScenes,
    /// RGB-D sequence, see [`crate::rgbd_sequence`].
    RgbdSequence,
    /// Registered RGB-D images without poses, see [`crate::registered_images`].
    RegisteredImages,
    /// Fakenect recording, see [`crate::fakenect_folder`].
    Fakenect,
}

impl fmt::Display for RecordingKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PcdScenes => "PCD scenes (*.pcd)",
            Self::RgbdSequence => "an RGB-D sequence (frame-*.depth.png)",
            Self::RegisteredImages => "colour and depth images (*-color.png, *-depth.png)",
            Self::Fakenect => "a fakenect recording (INDEX.txt)",
        })
    }
}

/// Detects the kind of a recording by the names of its files, without opening them.
///
/// Registered images beside the files of another kind belong to that kind.
///
/// # Errors
/// When the folder is missing, empty, holds no recording or several kinds.
pub fn detect_recording_kind(folder: &Path) -> Result<RecordingKind, Error> {
    if folder.exists() && !folder.is_dir() {
        return Err(Error::NotAFolder(folder.to_owned()));
    }
    let names = file_names(folder, |_| true)?;
    let has = |is_wanted: fn(&str) -> bool| names.iter().any(|name| is_wanted(name));
    let is_sequence =
        has(rgbd_sequence::is_depth_name) && !registered_images::replaces_sequence(&names);
    let found = [
        has(scene_folder::is_scene_name).then_some(RecordingKind::PcdScenes),
        is_sequence.then_some(RecordingKind::RgbdSequence),
        has(|name| name == fakenect_folder::INDEX_NAME).then_some(RecordingKind::Fakenect),
    ];
    let mut found = found.into_iter().flatten();
    match (found.next(), found.next()) {
        (Some(kind), None) => Ok(kind),
        (Some(first), Some(second)) => Err(Error::Mixed {
            path: folder.to_owned(),
            kinds: [first, second],
        }),
        (None, _) if registered_images::has_images(&names) => Ok(RecordingKind::RegisteredImages),
        (None, _) if names.is_empty() => Err(Error::Empty(folder.to_owned())),
        (None, _) => Err(Error::Unknown(folder.to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mutation_fuzzing::assert_sentence;

    fn detect(names: &[&str]) -> Result<RecordingKind, Error> {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            std::fs::write(folder.path().join(name), []).unwrap();
        }
        detect_recording_kind(folder.path())
    }

    #[test]
    fn each_kind_is_detected_by_its_files() {
        for (names, kind) in [
            (["learn1.pcd", "notes.txt"], RecordingKind::PcdScenes),
            (
                ["frame-000000.depth.png", "camera-intrinsics.txt"],
                RecordingKind::RgbdSequence,
            ),
            (["INDEX.txt", "d-1.0-1.pgm"], RecordingKind::Fakenect),
        ] {
            assert_eq!(detect(&names).unwrap(), kind);
        }
    }

    #[test]
    fn other_folders_are_explained() {
        let folder = tempfile::tempdir().unwrap();
        let missing = detect_recording_kind(&folder.path().join("missing")).unwrap_err();
        let file = folder.path().join("file");
        std::fs::write(&file, []).unwrap();
        for (error, reason) in [
            (missing, "could not list"),
            (detect_recording_kind(&file).unwrap_err(), "not a folder"),
            (detect(&[]).unwrap_err(), "is empty"),
            (
                detect(&["scan.ply", "index.txt"]).unwrap_err(),
                "holds no recording",
            ),
            (
                detect(&["a.pcd", "INDEX.txt"]).unwrap_err(),
                "holds both PCD",
            ),
            (
                detect(&["frame-1.depth.png", "INDEX.txt"]).unwrap_err(),
                "holds both an RGB-D",
            ),
        ] {
            assert_sentence(&error);
            assert!(error.to_string().contains(reason), "{error} / {reason}");
        }
    }
}
