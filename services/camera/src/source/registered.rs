//! Frame source for a folder of registered colour and depth images without poses.

use super::{FrameCursor, FrameInfo, FrameSize, Playback, Source, SourceError};
use capture::{DepthPixels, SourceImages};
use dataset::registered_images::{RegisteredImages, Scratch};
use point_cloud::Point;
use std::path::Path;

/// Player of registered images in natural name order.
pub(super) struct RegisteredImagesSource {
    images: RegisteredImages,
    frames: FrameCursor,
    scratch: Scratch,
    prepared: usize,
}

impl RegisteredImagesSource {
    pub(super) fn open(folder: &Path, playback: &Playback) -> Result<Self, SourceError> {
        let images =
            RegisteredImages::open(folder).map_err(|e| SourceError::Unusable(e.to_string()))?;
        if images.n_unpaired() > 0 {
            tracing::warn!(
                "{} images of {} are left out: none of the other kind was taken within 20 ms",
                images.n_unpaired(),
                folder.display()
            );
        }
        Ok(Self {
            frames: FrameCursor::new(folder, images.n_frames(), playback)?,
            images,
            scratch: Scratch::default(),
            prepared: 0,
        })
    }

    fn refuse(&mut self, cause: String) -> SourceError {
        let frame = self.images.name(self.prepared).unwrap_or_default();
        self.frames.refuse(frame, cause)
    }
}

impl Source for RegisteredImagesSource {
    fn name(&self) -> &str {
        &self.frames.name
    }

    fn rate_hz(&self) -> Option<f64> {
        Some(self.frames.rate_hz)
    }

    fn max_points(&self) -> usize {
        self.images.camera().n_pixels()
    }

    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        let Some(frame) = self.frames.advance() else {
            return Ok(None);
        };
        self.prepared = frame;
        let camera = self.images.camera();
        Ok(Some(FrameSize {
            width: camera.width as usize,
            height: camera.height as usize,
        }))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let filled = self.images.fill(self.prepared, &mut self.scratch, points);
        filled.map_err(|error| self.refuse(error.to_string()))?;
        self.frames.accept();
        Ok(FrameInfo {
            camera: *self.images.camera(),
            is_calibrated: true,
            world_from_camera: None,
            up_in_camera: None,
            source_frame: self.prepared,
            captured_ns: None,
        })
    }

    fn images(&self) -> Option<SourceImages<'_>> {
        let camera = *self.images.camera();
        Some(SourceImages {
            depth: DepthPixels::Units {
                pixels: self.scratch.depth(),
                unit_mm: self.images.depth_unit_mm(),
            },
            color_rgb: self.scratch.color_rgb(),
            depth_camera: camera,
            color_camera: camera,
            color_from_depth: None,
        })
    }
}
