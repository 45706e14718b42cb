//! Frame source for a folder of PCD scenes.

use super::{FrameCursor, FrameInfo, FrameSize, Playback, Source, SourceError};
use crate::intrinsics_fit;
use dataset::pcd;
use dataset::scene_folder::SceneFolder;
use geometry::PinholeCamera;
use point_cloud::Point;
use std::path::Path;

/// Player of organised scenes in natural name order.
pub(super) struct SceneFolderSource {
    folder: SceneFolder,
    frames: FrameCursor,
    bytes: Vec<u8>,
    decoder: pcd::Decoder,
    prepared: Option<(usize, pcd::Header)>,
}

impl SceneFolderSource {
    pub(super) fn open(folder: &Path, playback: &Playback) -> Result<Self, SourceError> {
        let scenes = SceneFolder::open(folder).map_err(|e| SourceError::Unusable(e.to_string()))?;
        Ok(Self {
            frames: FrameCursor::new(folder, scenes.len(), playback)?,
            folder: scenes,
            bytes: Vec::new(),
            decoder: pcd::Decoder::new(),
            prepared: None,
        })
    }

    fn read_header(&mut self, frame: usize) -> Result<pcd::Header, String> {
        self.folder
            .read_bytes(frame, &mut self.bytes)
            .map_err(|e| e.to_string())?;
        let header = pcd::Header::parse(&self.bytes).map_err(|e| e.to_string())?;
        let (width, height) = (header.width(), header.height());
        if width < 2 || height < 2 {
            return Err(format!(
                "it is unorganised ({width}x{height}); a camera's scene has rows and columns"
            ));
        }
        let max = channel::topic::MAX_FRAME_POINTS;
        if header.n_points() > max {
            return Err(format!(
                "it has {width}x{height} points, and at most {max} can be sent"
            ));
        }
        Ok(header)
    }

    fn refuse(&mut self, frame: usize, cause: String) -> SourceError {
        let name = self.folder.name(frame).unwrap_or_default();
        self.frames.refuse(name, cause)
    }
}

impl Source for SceneFolderSource {
    fn name(&self) -> &str {
        &self.frames.name
    }

    fn rate_hz(&self) -> Option<f64> {
        Some(self.frames.rate_hz)
    }

    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        let Some(frame) = self.frames.advance() else {
            return Ok(None);
        };
        let header = self
            .read_header(frame)
            .map_err(|cause| self.refuse(frame, cause))?;
        let size = FrameSize {
            width: header.width(),
            height: header.height(),
        };
        self.prepared = Some((frame, header));
        Ok(Some(size))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let Some((frame, header)) = self.prepared.take() else {
            return Err(SourceError::Unusable(
                "a scene was filled before it was prepared".into(),
            ));
        };
        let decoded = self.decoder.decode_into(&self.bytes, &header, points, None);
        decoded.map_err(|error| self.refuse(frame, error.to_string()))?;
        self.frames.accept();
        let fitted = intrinsics_fit::fit(points, header.width(), header.height());
        Ok(FrameInfo {
            is_calibrated: fitted.is_some(),
            camera: fitted.unwrap_or_else(|| nominal(header.width(), header.height())),
            world_from_camera: None,
            up_in_camera: None,
            source_frame: frame,
            captured_ns: None,
        })
    }
}

/// Nominal intrinsics with a Kinect's field of view.
fn nominal(width: usize, height: usize) -> PinholeCamera {
    let kinect = PinholeCamera::KINECT_V1;
    let scale = width as f64 / f64::from(kinect.width);
    PinholeCamera {
        fx_px: kinect.fx_px * scale,
        fy_px: kinect.fy_px * scale,
        cx_px: (width - 1) as f64 / 2.0,
        cy_px: (height - 1) as f64 / 2.0,
        width: width as u32,
        height: height as u32,
    }
}
