//! Frame sources behind one trait, and their playback.

mod image_folder;
mod kinect;
mod playback_clock;
mod recorded_bodies;
mod recording;
mod scenes;
mod spec;
mod synthetic_table;
mod unknown_source;

pub(crate) use capture::{FrameInfo, FrameSize, Source, SourceError};
pub(crate) use spec::SourceSpec;

use channel::Domain;
use image_folder::ImageFolderSource;
use std::path::{Path, PathBuf};

/// Playback options of a source.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Playback {
    /// Frame rate, hertz; `None` for the source's own.
    pub(crate) rate_hz: Option<f64>,
    /// True if the recording starts again at its end.
    pub(crate) looped: bool,
    /// First frame; `None` for the first of the recording.
    pub(crate) from: Option<usize>,
    /// End frame, exclusive; `None` for the end of the recording.
    pub(crate) to: Option<usize>,
}

/// Opens a source. A recording publishes its states of arm and people in the domain, when one is
/// given.
///
/// # Errors
/// When the folder is not there or holds nothing usable, or the device cannot
/// be opened.
pub(crate) fn open(
    spec: &SourceSpec,
    playback: &Playback,
    domain: Option<&Domain>,
) -> Result<Box<dyn Source>, SourceError> {
    match spec {
        SourceSpec::Recording(path) => Ok(Box::new(recording::RecordingSource::open(
            path, playback, domain,
        )?)),
        SourceSpec::Synthetic(arrangement) => Ok(Box::new(
            synthetic_table::SyntheticSource::arrangement(*arrangement, playback),
        )),
        SourceSpec::Crowd(n) => Ok(Box::new(synthetic_table::SyntheticSource::crowd(
            *n, playback,
        ))),
        SourceSpec::Parade(n) => Ok(Box::new(synthetic_table::SyntheticSource::parade(
            *n, playback,
        ))),
        SourceSpec::Kinect => Ok(Box::new(kinect::KinectSource::real()?)),
        SourceSpec::Fakenect(folder) => Ok(Box::new(kinect::KinectSource::fake(folder)?)),
        SourceSpec::Folder(folder) if !folder.exists() => {
            Err(SourceError::Unusable(unknown_source::sentence(folder)))
        }
        SourceSpec::Folder(folder) => match dataset::detect_recording_kind(folder) {
            Ok(dataset::RecordingKind::PcdScenes) => {
                Ok(Box::new(scenes::SceneFolderSource::open(folder, playback)?))
            }
            Ok(dataset::RecordingKind::RgbdSequence) => {
                Ok(Box::new(ImageFolderSource::sequence(folder, playback)?))
            }
            Ok(dataset::RecordingKind::RegisteredImages) => {
                Ok(Box::new(ImageFolderSource::registered(folder, playback)?))
            }
            Ok(dataset::RecordingKind::Fakenect) => Err(SourceError::Unusable(format!(
                "{0} is a recording of libfreenect; play it with --source fakenect:{0}",
                folder.display()
            ))),
            Err(error) => Err(SourceError::Unusable(error.to_string())),
        },
    }
}

/// Frame rate of a recording whose playback has none, hertz.
pub(crate) const DEFAULT_RATE_HZ: f64 = 30.0;

/// Cursor over the frames of a recording, with looping and a count of unusable frames.
#[derive(Debug, Clone)]
struct FrameCursor {
    folder: PathBuf,
    /// Name of the recording.
    name: String,
    rate_hz: f64,
    from: usize,
    to: usize,
    next: usize,
    looped: bool,
    n_refused_in_a_row: usize,
}

impl FrameCursor {
    /// Cursor over the frames of `playback` in a recording of `n_frames`.
    fn new(recording: &Path, n_frames: usize, playback: &Playback) -> Result<Self, SourceError> {
        let from = playback.from.unwrap_or(0);
        let to = playback.to.unwrap_or(n_frames).min(n_frames);
        if from >= to {
            return Err(SourceError::Unusable(format!(
                "there is no frame from {from} on: the recording has {n_frames} frames, 0 to {}",
                n_frames.saturating_sub(1)
            )));
        }
        Ok(Self {
            folder: recording.to_owned(),
            name: recording.display().to_string(),
            rate_hz: playback.rate_hz.unwrap_or(DEFAULT_RATE_HZ),
            from,
            to,
            next: from,
            looped: playback.looped,
            n_refused_in_a_row: 0,
        })
    }

    fn advance(&mut self) -> Option<usize> {
        if self.next == self.to && self.looped {
            self.next = self.from;
        }
        let frame = self.next;
        (frame < self.to).then(|| {
            self.next += 1;
            frame
        })
    }

    /// Resets the count of unusable frames after a frame was played.
    fn accept(&mut self) {
        self.n_refused_in_a_row = 0;
    }

    /// Error of an unusable frame; when a whole round was unusable, the error of the
    /// recording. While the folder is away, the frame is the next one again.
    fn refuse(&mut self, frame: &str, cause: String) -> SourceError {
        if let Err(error) = self.folder.read_dir() {
            self.next -= 1;
            return SourceError::Unavailable(format!(
                "the recording cannot be read at present ({error}); mount or restore {}",
                self.name
            ));
        }
        self.n_refused_in_a_row += 1;
        let (n_frames, recording) = (self.to - self.from, &self.name);
        if self.n_refused_in_a_row < n_frames {
            return SourceError::Frame {
                frame: frame.to_owned(),
                cause,
            };
        }
        SourceError::Unusable(format!(
            "none of the {n_frames} frames of {recording} can be played; the last one, {frame}: {cause}"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_is_not_passed_over_while_the_folder_is_away() {
        let folder = tempfile::tempdir().unwrap();
        let (here, away) = (folder.path().join("here"), folder.path().join("away"));
        std::fs::create_dir(&here).unwrap();
        let mut frames = FrameCursor::new(&here, 3, &Playback::default()).unwrap();
        assert_eq!(frames.advance(), Some(0));
        assert_eq!(frames.advance(), Some(1));
        std::fs::rename(&here, &away).unwrap();
        for _ in 0..5 {
            let error = frames.refuse("1.pcd", "could not read it".into());
            assert!(matches!(error, SourceError::Unavailable(_)), "{error}");
            assert_eq!(frames.advance(), Some(1));
        }
        std::fs::rename(&away, &here).unwrap();
        let error = frames.refuse("1.pcd", "it is truncated".into());
        assert!(matches!(error, SourceError::Frame { .. }), "{error}");
        assert_eq!(frames.advance(), Some(2));
    }

    #[test]
    fn frames_are_played_from_inclusive_to_exclusive() {
        let played = |playback: Playback, n| -> Vec<usize> {
            let mut frames = FrameCursor::new(Path::new("recording"), 5, &playback).unwrap();
            std::iter::from_fn(|| frames.advance()).take(n).collect()
        };
        let part = Playback {
            from: Some(1),
            to: Some(3),
            ..Playback::default()
        };
        assert_eq!(played(part, 9), [1, 2]);
        assert_eq!(
            played(
                Playback {
                    looped: true,
                    ..part
                },
                5
            ),
            [1, 2, 1, 2, 1]
        );
        assert_eq!(played(Playback::default(), 9), [0, 1, 2, 3, 4]);
        assert!(
            FrameCursor::new(
                Path::new("recording"),
                5,
                &Playback {
                    from: Some(5),
                    ..part
                }
            )
            .is_err()
        );
        assert!(FrameCursor::new(Path::new("recording"), 0, &Playback::default()).is_err());
    }
}
