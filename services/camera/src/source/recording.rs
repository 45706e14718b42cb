//! Frame source for a recording of `tabula record`: frames with their headers, and before each
//! the states of arm and people up to its capture.

use super::playback_clock::PlaybackClock;
use super::recorded_bodies::RecordedBodies;
use super::{DEFAULT_RATE_HZ, FrameInfo, FrameSize, Playback, Source, SourceError};
use channel::Domain;
use message::{CheckedFrame, FrameHeader, frame_flag};
use point_cloud::Point;
use recording::{Error, FramePlayer, FrameRecord, InvalidRecord, PlayedFrame};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Player of a recording.
pub(super) struct RecordingSource {
    path: PathBuf,
    name: String,
    playback: Playback,
    player: Option<FramePlayer<BufReader<File>>>,
    /// Number of the next frame in the file.
    next: usize,
    /// Number of the frame at which a round goes on after a failure of the medium.
    resume_at: usize,
    /// True if a frame of this round was played.
    has_played: bool,
    prepared: Option<PlayedFrame>,
    clock: PlaybackClock,
    bodies: Option<RecordedBodies>,
    max_points: usize,
    /// True if this round was read to the end of the file.
    is_at_end: bool,
    is_end_logged: bool,
}

impl RecordingSource {
    /// Opens a recording and reads its first frame, which determines the memory of the frames.
    /// Without a domain, states of arm and people are left out.
    pub(super) fn open(
        path: &Path,
        playback: &Playback,
        domain: Option<&Domain>,
    ) -> Result<Self, SourceError> {
        let mut source = Self {
            path: path.to_owned(),
            name: path.display().to_string(),
            playback: *playback,
            player: None,
            next: 0,
            resume_at: 0,
            has_played: false,
            prepared: None,
            clock: PlaybackClock::default(),
            bodies: domain.map(RecordedBodies::new).transpose()?,
            max_points: channel::topic::MAX_FRAME_POINTS,
            is_at_end: false,
            is_end_logged: false,
        };
        let unusable = |cause: SourceError| SourceError::Unusable(cause.to_string());
        let first = source.next_frame().map_err(unusable)?;
        let first = first.ok_or_else(|| source.without_frames())?;
        source.max_points = source.max_points.max(first.n_points());
        source.player = None;
        Ok(source)
    }

    fn without_frames(&self) -> SourceError {
        let from = self.playback.from.unwrap_or(0);
        let sentence = match (self.next, self.first_unusable()) {
            (0, Some(reason)) => {
                format!(
                    "the recording {} holds no frame to play: {reason}",
                    self.name
                )
            }
            (0, None) => format!("the recording {} holds no frame", self.name),
            (n, _) => format!(
                "there is no frame from {from} on: the recording {} has {n} frames",
                self.name
            ),
        };
        SourceError::Unusable(sentence)
    }

    /// First of the messages that cannot be used, with the reason.
    fn first_unusable(&self) -> Option<String> {
        let unusable = self.player.as_ref()?.first_unusable()?;
        Some(format!(
            "a message of {} cannot be used: {}",
            unusable.topic, unusable.reason
        ))
    }

    /// Next frame of the playback in this round of the file; `None` at its end.
    fn next_frame(&mut self) -> Result<Option<PlayedFrame>, SourceError> {
        let (from, to) = (self.playback.from.unwrap_or(0), self.playback.to);
        loop {
            if to.is_some_and(|to| self.next >= to && self.player.is_some()) {
                return Ok(None);
            }
            let Some(frame) = self.read_frame()? else {
                self.is_at_end = true;
                return Ok(None);
            };
            self.next += 1;
            if self.next > from.max(self.resume_at) {
                return Ok(Some(frame));
            }
        }
    }

    fn read_frame(&mut self) -> Result<Option<PlayedFrame>, SourceError> {
        if self.player.is_none() {
            self.player = Some(self.opened()?);
            (self.next, self.is_at_end) = (0, false);
        }
        let Some(player) = &mut self.player else {
            return Ok(None);
        };
        player.next_frame().map_err(|error| match error {
            Error::Read(error) => {
                (self.player, self.resume_at) = (None, self.next);
                SourceError::Unavailable(self.read_failure(&error))
            }
            other => SourceError::Unusable(format!("{} cannot be played: {other}", self.name)),
        })
    }

    fn opened(&self) -> Result<FramePlayer<BufReader<File>>, SourceError> {
        let failed = |error| SourceError::Unavailable(self.read_failure(&error));
        let file = File::open(&self.path).map_err(failed)?;
        let file_bytes = file.metadata().map_err(failed)?.len();
        Ok(FramePlayer::new(BufReader::new(file), file_bytes))
    }

    fn read_failure(&self, error: &std::io::Error) -> String {
        format!(
            "the recording {} cannot be read at present: {error}",
            self.name
        )
    }

    /// Tells once what the recording lacks, when it was read to its end.
    fn log_end(&mut self) {
        let Some(lack) = self.lack() else { return };
        if !std::mem::replace(&mut self.is_end_logged, true) {
            tracing::warn!("{lack}");
        }
    }

    /// Sentence about what was left out of the recording; `None` when nothing was, or when it was
    /// not read to its end.
    fn lack(&self) -> Option<String> {
        let player = self.player.as_ref().filter(|_| self.is_at_end)?;
        let (summary, n_unusable) = (player.summary(), player.n_unusable());
        let mut lacks = Vec::new();
        if !summary.is_complete {
            lacks.push(format!(
                "it was not closed and its last {} bytes are lost; `tabula record --recover` \
                 makes a whole file of it",
                summary.lost_bytes
            ));
        }
        let n_chunks = summary.n_damaged_chunks + summary.n_unsupported_chunks;
        if n_chunks > 0 {
            lacks.push(format!(
                "{n_chunks} chunks cannot be read and were left out"
            ));
        }
        if let Some(reason) = self.first_unusable() {
            lacks.push(format!("{n_unusable} messages were left out; {reason}"));
        }
        let sentence = format!("the recording {}: {}", self.name, lacks.join("; "));
        (!lacks.is_empty()).then_some(sentence)
    }
}

impl Source for RecordingSource {
    fn name(&self) -> &str {
        &self.name
    }

    fn rate_hz(&self) -> Option<f64> {
        Some(self.playback.rate_hz.unwrap_or(DEFAULT_RATE_HZ))
    }

    fn frame_time_ns(&self) -> Option<u64> {
        let is_at_own_pace = self.playback.rate_hz.is_none() && self.prepared.is_some();
        is_at_own_pace.then_some(self.clock.now_ns())
    }

    fn max_points(&self) -> usize {
        self.max_points
    }

    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        self.prepared = None;
        let mut frame = self.next_frame()?;
        if frame.is_none() {
            self.log_end();
            (self.player, self.resume_at) = (None, 0);
            if !self.playback.looped {
                return Ok(None);
            }
            if !std::mem::take(&mut self.has_played) {
                return Err(self.without_frames());
            }
            frame = self.next_frame()?;
        }
        let Some(frame) = frame else {
            return Ok(None);
        };
        self.has_played = true;
        self.clock.advance_to(frame.capture_ns());
        if frame.n_points() > self.max_points {
            return Err(self.refused(&format!(
                "it has {} points, and the memory of the frames is for {}; play it alone with \
                 --from {}",
                frame.n_points(),
                self.max_points,
                self.next.saturating_sub(1)
            )));
        }
        let size = frame.record();
        let size = size.map(|record| FrameSize::of(&record.camera));
        let size = size.map_err(|error| self.refused(&error))?;
        self.prepared = Some(frame);
        Ok(Some(size))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let Some(frame) = &self.prepared else {
            return Err(SourceError::Unusable(
                "a frame was filled before it was prepared".into(),
            ));
        };
        let filled = frame.record().and_then(|record| {
            record.fill(bytemuck::cast_slice_mut(points))?;
            frame_info(&record)
        });
        filled.map_err(|error| self.refused(&error))
    }

    fn complete_header(&self, header: &mut FrameHeader) {
        let record = self.prepared.as_ref().map(PlayedFrame::record);
        if let Some(Ok(record)) = record {
            header.world_from_camera = record.header.world_from_camera;
            header.up_in_camera = record.header.up_in_camera;
        }
    }

    fn before_send(&mut self, header: &FrameHeader) -> Result<(), SourceError> {
        if let (Some(bodies), Some(frame)) = (&mut self.bodies, &self.prepared) {
            bodies.publish(frame, header.capture_stamp_ns)?;
        }
        Ok(())
    }
}

impl RecordingSource {
    fn refused(&self, cause: &impl ToString) -> SourceError {
        SourceError::Frame {
            frame: self.next.saturating_sub(1).to_string(),
            cause: cause.to_string(),
        }
    }
}

/// Metadata of a recorded frame, as its header has them.
fn frame_info(record: &FrameRecord<'_>) -> Result<FrameInfo, InvalidRecord> {
    let header = &record.header;
    let CheckedFrame {
        camera,
        world_from_camera,
        up_in_camera,
    } = header.checked(record.n_points(), u64::MAX)?;
    Ok(FrameInfo {
        camera,
        is_calibrated: header.has(frame_flag::CALIBRATED),
        world_from_camera,
        up_in_camera,
        source_frame: header.source_frame as usize,
        captured_ns: None,
    })
}

#[cfg(test)]
mod tests;
