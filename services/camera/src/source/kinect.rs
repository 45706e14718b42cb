//! Frame source for a Kinect, real or played by fakenect.

use super::{FrameInfo, FrameSize, Source, SourceError};
use capture::{DepthPixels, SourceImages, rounded_mm};
use freenect::{
    Calibration, CloudBuilder, DepthTable, Error, Kinect, Library, LibraryKind, NO_DEPTH, Selector,
};
use point_cloud::Point;
use service::monotonic_ns;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Longest wait for an image. Chosen: shorter than the watchdog allows.
const SILENCE: Duration = Duration::from_secs(1);
/// Number of such waits in a row after which the sensor counts as gone, and is opened again.
const MAX_SILENCES: u32 = 3;

/// Kinect that is opened again whenever it has gone.
pub(super) struct KinectSource {
    name: String,
    library: Arc<Library>,
    kinect: Option<Kinect>,
    builder: CloudBuilder,
    calibration: Calibration,
    /// Depth of each raw value, millimetres; 0 for none.
    mm_of_raw: Vec<u16>,
    n_frames: usize,
    /// Number of waits in a row without an image.
    n_silences: u32,
}

impl KinectSource {
    pub(super) fn real() -> Result<Self, SourceError> {
        Self::new("kinect".into(), LibraryKind::Real)
    }

    /// Source for a recording, which the library finds through the environment of the
    /// process.
    pub(super) fn fake(folder: &Path) -> Result<Self, SourceError> {
        Self::new(format!("fakenect:{}", folder.display()), LibraryKind::Fake)
    }

    fn new(name: String, kind: LibraryKind) -> Result<Self, SourceError> {
        let unusable = |error: &dyn std::error::Error| SourceError::Unusable(error.to_string());
        let calibration = Calibration::nominal();
        Ok(Self {
            name,
            library: Arc::new(Library::load(kind).map_err(|e| unusable(&e))?),
            kinect: None,
            builder: CloudBuilder::new(&calibration).map_err(|e| unusable(&e))?,
            mm_of_raw: mm_of_raw(&calibration),
            calibration,
            n_frames: 0,
            n_silences: 0,
        })
    }

    /// Closes the device and converts its error.
    fn closed(&mut self, error: &Error) -> SourceError {
        self.kinect = None;
        match error {
            Error::NoKinect { .. }
            | Error::CannotOpen { .. }
            | Error::CallFailed { .. }
            | Error::Gone { .. }
            | Error::UsbUnavailable { .. } => SourceError::Unavailable(error.to_string()),
            _ => SourceError::Unusable(error.to_string()),
        }
    }

    /// Counts a wait without an image, and closes the device after several in a row.
    fn silent(&mut self) -> SourceError {
        self.n_silences += 1;
        if self.n_silences >= MAX_SILENCES {
            self.n_silences = 0;
            self.kinect = None;
        }
        SourceError::Unavailable(
            "the Kinect sends no images; check its power supply and its USB port".into(),
        )
    }

    fn open(&mut self) -> Result<(), SourceError> {
        if self.kinect.is_none() {
            let opened = Kinect::open(self.library.clone(), &Selector::Index(0));
            self.kinect = Some(opened.map_err(|error| self.closed(&error))?);
        }
        Ok(())
    }
}

/// Depth of each raw value in whole millimetres, 0 for none.
fn mm_of_raw(calibration: &Calibration) -> Vec<u16> {
    let table = DepthTable::new(calibration.formula);
    let depth_mm = |raw| rounded_mm(f64::from(table.depth_m(raw)) * 1000.0);
    (0..=NO_DEPTH).map(depth_mm).collect()
}

impl Source for KinectSource {
    fn name(&self) -> &str {
        &self.name
    }

    fn rate_hz(&self) -> Option<f64> {
        None
    }

    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        self.open()?;
        Ok(Some(FrameSize {
            width: freenect::WIDTH,
            height: freenect::HEIGHT,
        }))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let Some(kinect) = &mut self.kinect else {
            return Err(SourceError::Unavailable("the Kinect is not open".into()));
        };
        let filled = match kinect.next_frame(SILENCE) {
            Ok(Some(frame)) => self
                .builder
                .fill(frame.depth.pixels, frame.video.pixels, points)
                .map(|_| frame.depth.arrived.elapsed())
                .map_err(|error| SourceError::Unusable(error.to_string())),
            Ok(None) => return Err(self.silent()),
            Err(Error::Ended) => return Err(SourceError::EndOfRecording),
            Err(error) => return Err(self.closed(&error)),
        };
        let since_arrival = filled.inspect_err(|_| self.kinect = None)?;
        self.n_silences = 0;
        let source_frame = self.n_frames;
        self.n_frames += 1;
        Ok(FrameInfo {
            camera: self.calibration.depth_camera,
            is_calibrated: false,
            world_from_camera: None,
            up_in_camera: None,
            source_frame,
            captured_ns: Some(monotonic_ns().saturating_sub(since_arrival.as_nanos() as u64)),
        })
    }

    fn images(&self) -> Option<SourceImages<'_>> {
        let frame = self.kinect.as_ref()?.last_frame()?;
        Some(SourceImages {
            depth: DepthPixels::Table {
                pixels: frame.depth.pixels,
                mm_of_value: &self.mm_of_raw,
            },
            color_rgb: frame.video.pixels,
            depth_camera: self.calibration.depth_camera,
            color_camera: self.calibration.color_camera,
            color_from_depth: Some(self.calibration.color_from_depth),
        })
    }
}
