//! Sources behind one trait.

mod kinect;
mod rgbd;
mod scenes;
mod spec;
mod synthetic_table;

pub(crate) use capture::{FrameInfo, FrameSize, Source, SourceError};
pub(crate) use spec::SourceSpec;

/// How a source is played.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Playback {
    /// Frames per second; `None` for the source's own.
    pub(crate) rate_hz: Option<f64>,
    /// Whether it begins again at its end.
    pub(crate) looped: bool,
    /// First frame; `None` for the first there is.
    pub(crate) from: Option<usize>,
    /// Frame before which it ends; `None` for the end there is.
    pub(crate) to: Option<usize>,
}

/// Opens a source.
///
/// # Errors
/// When the folder is not there or holds nothing usable, or the device can not
/// be opened.
pub(crate) fn open(spec: &SourceSpec, playback: &Playback) -> Result<Box<dyn Source>, SourceError> {
    match spec {
        SourceSpec::Synthetic(arrangement) => Ok(Box::new(
            synthetic_table::Synthetic::arrangement(*arrangement, playback),
        )),
        SourceSpec::Crowd(n) => Ok(Box::new(synthetic_table::Synthetic::crowd(*n, playback))),
        SourceSpec::Parade(n) => Ok(Box::new(synthetic_table::Synthetic::parade(*n, playback))),
        SourceSpec::Kinect => Ok(Box::new(kinect::KinectSource::real()?)),
        SourceSpec::Fakenect(folder) => Ok(Box::new(kinect::KinectSource::fake(folder)?)),
        SourceSpec::Folder(folder) => match dataset::detect_kind(folder) {
            Ok(dataset::RecordingKind::PcdScenes) => {
                Ok(Box::new(scenes::Scenes::open(folder, playback)?))
            }
            Ok(dataset::RecordingKind::RgbdSequence) => {
                Ok(Box::new(rgbd::Sequence::open(folder, playback)?))
            }
            Ok(dataset::RecordingKind::Fakenect) => Err(SourceError::Unusable(format!(
                "{0} is a recording of libfreenect; play it with --source fakenect:{0}",
                folder.display()
            ))),
            Err(error) => Err(SourceError::Unusable(error.to_string())),
        },
    }
}

/// The frames of a recording that are played, in turn.
#[derive(Debug, Clone)]
struct Frames {
    from: usize,
    to: usize,
    next: usize,
    looped: bool,
    n_refused_in_a_row: usize,
}

impl Frames {
    /// The frames of `playback` among the `n_frames` there are.
    fn new(n_frames: usize, playback: &Playback) -> Result<Self, SourceError> {
        let from = playback.from.unwrap_or(0);
        let to = playback.to.unwrap_or(n_frames).min(n_frames);
        if from >= to {
            return Err(SourceError::Unusable(format!(
                "there is no frame from {from} on: the recording has {n_frames} frames, 0 to {}",
                n_frames.saturating_sub(1)
            )));
        }
        Ok(Self {
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

    /// Notes that a frame was played.
    fn accept(&mut self) {
        self.n_refused_in_a_row = 0;
    }

    /// The error of a frame that can not be played; when a whole round of them
    /// could not, that of the recording.
    fn refuse(&mut self, recording: &str, frame: &str, cause: String) -> SourceError {
        self.n_refused_in_a_row += 1;
        let n_frames = self.to - self.from;
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
    fn frames_are_played_from_inclusive_to_exclusive() {
        let played = |playback: Playback, n| -> Vec<usize> {
            let mut frames = Frames::new(5, &playback).unwrap();
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
            Frames::new(
                5,
                &Playback {
                    from: Some(5),
                    ..part
                }
            )
            .is_err()
        );
        assert!(Frames::new(0, &Playback::default()).is_err());
    }
}
