//! Frame source for an RGB-D sequence with camera poses.

use super::{FrameCursor, FrameInfo, FrameSize, Playback, Source, SourceError};
use capture::{DepthPixels, SourceImages};
use dataset::rgbd_sequence::{RgbdSequence, Scratch};
use point_cloud::Point;
use std::path::Path;

/// Player of an RGB-D sequence.
pub(super) struct RgbdSource {
    sequence: RgbdSequence,
    frames: FrameCursor,
    scratch: Scratch,
    prepared: usize,
}

impl RgbdSource {
    pub(super) fn open(folder: &Path, playback: &Playback) -> Result<Self, SourceError> {
        let sequence =
            RgbdSequence::open(folder).map_err(|e| SourceError::Unusable(e.to_string()))?;
        Ok(Self {
            frames: FrameCursor::new(folder, sequence.n_frames(), playback)?,
            sequence,
            scratch: Scratch::default(),
            prepared: 0,
        })
    }

    fn refuse(&mut self, cause: String) -> SourceError {
        let frame = self.sequence.name(self.prepared).unwrap_or_default();
        self.frames.refuse(frame, cause)
    }
}

impl Source for RgbdSource {
    fn name(&self) -> &str {
        &self.frames.name
    }

    fn rate_hz(&self) -> Option<f64> {
        Some(self.frames.rate_hz)
    }

    fn max_points(&self) -> usize {
        self.sequence.camera().n_pixels()
    }

    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        let Some(frame) = self.frames.advance() else {
            return Ok(None);
        };
        self.prepared = frame;
        let camera = self.sequence.camera();
        Ok(Some(FrameSize {
            width: camera.width as usize,
            height: camera.height as usize,
        }))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let filled = self.sequence.fill(self.prepared, &mut self.scratch, points);
        let world_from_camera = filled.map_err(|error| self.refuse(error.to_string()))?;
        self.frames.accept();
        let down_in_world = self.sequence.gravity_in_world();
        let up_in_camera = world_from_camera
            .zip(down_in_world)
            .map(|(world_from_camera, down)| world_from_camera.rotation.inverse() * -down);
        Ok(FrameInfo {
            camera: *self.sequence.camera(),
            is_calibrated: true,
            world_from_camera,
            up_in_camera,
            source_frame: self.prepared,
            captured_ns: None,
        })
    }

    fn images(&self) -> Option<SourceImages<'_>> {
        let camera = *self.sequence.camera();
        Some(SourceImages {
            depth: DepthPixels::Units {
                pixels: self.scratch.depth_mm(),
                unit_mm: 1.0,
            },
            color_rgb: self.scratch.color_rgb(),
            depth_camera: camera,
            color_camera: camera,
            color_from_depth: None,
        })
    }
}
