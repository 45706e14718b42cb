//! Frame source for a folder of colour and depth images: an RGB-D sequence with camera poses, or
//! registered images without poses.

use super::{FrameCursor, FrameInfo, FrameSize, Playback, Source, SourceError};
use capture::{DepthPixels, SourceImages};
use dataset::registered_images::RegisteredImages;
use dataset::rgbd_sequence::{RgbdSequence, Scratch};
use geometry::PinholeCamera;
use point_cloud::Point;
use std::path::Path;

/// Images of a folder, in natural name order.
enum ImageFolder {
    Sequence(RgbdSequence),
    Registered(RegisteredImages),
}

impl ImageFolder {
    fn camera(&self) -> &PinholeCamera {
        match self {
            Self::Sequence(images) => images.camera(),
            Self::Registered(images) => images.camera(),
        }
    }

    fn name(&self, frame: usize) -> &str {
        let name = match self {
            Self::Sequence(images) => images.name(frame),
            Self::Registered(images) => images.name(frame),
        };
        name.unwrap_or_default()
    }

    /// Decodes a frame to points, camera frame.
    fn fill(
        &self,
        frame: usize,
        scratch: &mut Scratch,
        points: &mut [Point],
    ) -> Result<FrameInfo, String> {
        let (world_from_camera, down_in_world) = match self {
            Self::Sequence(images) => {
                let pose = images.fill(frame, scratch, points);
                (pose.map_err(|e| e.to_string())?, images.gravity_in_world())
            }
            Self::Registered(images) => {
                let filled = images.fill(frame, scratch, points);
                filled.map_err(|e| e.to_string())?;
                (None, None)
            }
        };
        let up_in_camera = world_from_camera
            .zip(down_in_world)
            .map(|(world_from_camera, down)| world_from_camera.rotation.inverse() * -down);
        Ok(FrameInfo {
            camera: *self.camera(),
            is_calibrated: true,
            world_from_camera,
            up_in_camera,
            source_frame: frame,
            captured_ns: None,
        })
    }
}

/// Player of a folder of images.
pub(super) struct ImageFolderSource {
    images: ImageFolder,
    frames: FrameCursor,
    scratch: Scratch,
    prepared: usize,
}

impl ImageFolderSource {
    /// Opens an RGB-D sequence.
    pub(super) fn sequence(folder: &Path, playback: &Playback) -> Result<Self, SourceError> {
        let images =
            RgbdSequence::open(folder).map_err(|e| SourceError::Unusable(e.to_string()))?;
        let frames = FrameCursor::new(folder, images.n_frames(), playback)?;
        Ok(Self::new(ImageFolder::Sequence(images), frames))
    }

    /// Opens a folder of registered images.
    pub(super) fn registered(folder: &Path, playback: &Playback) -> Result<Self, SourceError> {
        let images =
            RegisteredImages::open(folder).map_err(|e| SourceError::Unusable(e.to_string()))?;
        if images.n_unpaired() > 0 {
            tracing::warn!(
                "{} images of {} are left out: none of the other kind was taken within 20 ms",
                images.n_unpaired(),
                folder.display()
            );
        }
        let frames = FrameCursor::new(folder, images.n_frames(), playback)?;
        Ok(Self::new(ImageFolder::Registered(images), frames))
    }

    fn new(images: ImageFolder, frames: FrameCursor) -> Self {
        Self {
            images,
            frames,
            scratch: Scratch::default(),
            prepared: 0,
        }
    }
}

impl Source for ImageFolderSource {
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
        Ok(Some(FrameSize::of(self.images.camera())))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let frame = self.prepared;
        let filled = self.images.fill(frame, &mut self.scratch, points);
        let info = filled.map_err(|cause| self.frames.refuse(self.images.name(frame), cause))?;
        self.frames.accept();
        Ok(info)
    }

    fn images(&self) -> Option<SourceImages<'_>> {
        let camera = *self.images.camera();
        Some(SourceImages {
            depth: DepthPixels::Units {
                pixels: self.scratch.depth(),
                unit_mm: match &self.images {
                    ImageFolder::Sequence(_) => 1.0,
                    ImageFolder::Registered(images) => images.depth_unit_mm(),
                },
            },
            color_rgb: self.scratch.color_rgb(),
            depth_camera: camera,
            color_camera: camera,
            color_from_depth: None,
        })
    }
}
