//! Recorded RGB-D sequence with camera poses, and its tracking.

use super::RATE_HZ;
use super::ground_truth::{GroundTruth, LabelledDepthImage};
use super::track_pixels::track_pixels;
use super::tracking_pipeline::TrackingPipeline;
use super::tracking_run::TrackedSequence;
use crate::frame_detector::up_in_camera;
use dataset::rgbd_sequence::{RgbdSequence, Scratch};
use evaluation::tracked_frame::{GroundTruthObject, TrackState, TrackedFrame};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{UnitVector3, Vector3};
use pipeline::{FramePose, SequentialFrame};
use point_cloud::{OrganizedCloud, Point};
use service::Failure;
use simulated_world::truth_from_json;
use std::collections::BTreeMap;
use std::path::Path;

/// RGB-D sequence with its name.
pub(super) struct RecordedSequence {
    pub(super) name: String,
    sequence: RgbdSequence,
}

/// Processed frame with its tracks.
pub(super) struct ProcessedFrame<'a> {
    pub(super) index: usize,
    pub(super) points: &'a [Point],
    pub(super) camera: &'a PinholeCamera,
    pub(super) world_from_camera: RigidTransform,
    pub(super) tracks: &'a [TrackState],
}

impl RecordedSequence {
    pub(super) fn open(folder: &Path) -> Result<Self, Failure> {
        let sequence = RgbdSequence::open(folder).map_err(Failure::usage)?;
        let canonical = folder.canonicalize();
        let canonical = canonical.as_deref().unwrap_or(folder);
        let name = canonical.file_name().unwrap_or_default();
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            sequence,
        })
    }

    pub(super) fn n_frames(&self) -> usize {
        self.sequence.n_frames()
    }

    /// True if the first frame has a ground-truth file.
    pub(super) fn has_truth(&self) -> Result<bool, Failure> {
        let mut text = Vec::new();
        self.sequence
            .read_truth(0, &mut text)
            .map_err(Failure::general)
    }

    /// Tracks the objects of all frames; calls `show` after each frame.
    pub(super) fn play(
        &self,
        mut show: impl FnMut(&ProcessedFrame<'_>) -> Result<(), Failure>,
    ) -> Result<TrackedSequence, Failure> {
        let camera = *self.sequence.camera();
        let mut points = vec![Point::default(); camera.n_pixels()];
        let mut scratch = Scratch::default();
        let mut truth = GroundTruthReader::new(camera);
        let mut tracker = TrackingPipeline::new().map_err(Failure::general)?;
        let mut frames = Vec::with_capacity(self.n_frames());
        for index in 0..self.n_frames() {
            let pose = self.sequence.fill(index, &mut scratch, &mut points);
            let world_from_camera = pose
                .map_err(Failure::general)?
                .ok_or_else(|| Failure::general(self.no_pose(index)))?;
            let seen = self.seen(index, &points, world_from_camera)?;
            tracker.step(&seen).map_err(Failure::general)?;
            let up_in_world = self.up_in_world();
            let objects = truth.read(self, index, &points, world_from_camera, up_in_world)?;
            let pixels = if objects.is_empty() {
                Vec::new()
            } else {
                track_pixels(&tracker, &truth.mask)
            };
            let frame = TrackedFrame {
                pixels,
                tracks_of_people: Vec::new(),
                time_s: index as f64 / RATE_HZ,
                objects,
                tracks: tracker.track_states(),
                ended: tracker.update().ended_tracks.clone(),
            };
            show(&ProcessedFrame {
                index,
                points: &points,
                camera: &camera,
                world_from_camera,
                tracks: &frame.tracks,
            })?;
            frames.push(frame);
        }
        Ok(TrackedSequence {
            frames,
            names: truth.names,
            notes: Vec::new(),
        })
    }

    fn seen<'a>(
        &self,
        index: usize,
        points: &'a [Point],
        world_from_camera: RigidTransform,
    ) -> Result<SequentialFrame<'a>, Failure> {
        let camera = self.sequence.camera();
        let (width, height) = (camera.width as usize, camera.height as usize);
        let gravity = self.sequence.gravity_in_world();
        Ok(SequentialFrame {
            pose: FramePose {
                capture_ns: ((1.0 + index as f64 / RATE_HZ) * 1e9).round() as u64,
                world_from_camera,
                up_in_camera: gravity.map(|down| up_in_camera(&world_from_camera, &-down)),
                camera: Some(*camera),
            },
            cloud: OrganizedCloud::new(points, width, height).map_err(Failure::general)?,
            people: None,
            robot: None,
        })
    }

    /// Unit vector against gravity, world frame; the z axis if gravity was not recorded.
    pub(super) fn up_in_world(&self) -> UnitVector3<f64> {
        let gravity = self.sequence.gravity_in_world();
        gravity.map_or_else(Vector3::z_axis, |down| -down)
    }

    fn no_pose(&self, index: usize) -> String {
        format!(
            "{} of {} has no pose of the camera, without which nothing can be tracked in the \
             world; add frame-NNNNNN.pose.txt",
            self.sequence.name(index).unwrap_or_default(),
            self.name
        )
    }
}

/// Reader of the ground-truth files of a sequence.
struct GroundTruthReader {
    truth: GroundTruth,
    names: BTreeMap<u64, String>,
    text: Vec<u8>,
    mask: Vec<u16>,
    depth_m: Vec<f32>,
    scratch: Scratch,
}

impl GroundTruthReader {
    fn new(camera: PinholeCamera) -> Self {
        Self {
            truth: GroundTruth::new(camera),
            names: BTreeMap::new(),
            text: Vec::new(),
            mask: Vec::new(),
            depth_m: Vec::new(),
            scratch: Scratch::default(),
        }
    }

    /// Ground-truth objects of a frame; none without truth or mask file.
    fn read(
        &mut self,
        recording: &RecordedSequence,
        index: usize,
        points: &[Point],
        world_from_camera: RigidTransform,
        up_in_world: UnitVector3<f64>,
    ) -> Result<Vec<GroundTruthObject>, Failure> {
        let sequence = &recording.sequence;
        let has_truth = sequence
            .read_truth(index, &mut self.text)
            .map_err(Failure::general)?;
        let has_mask = sequence.read_mask(index, &mut self.scratch, &mut self.mask);
        if !has_truth || !has_mask.map_err(Failure::general)? {
            return Ok(Vec::new());
        }
        let objects = truth_from_json(&self.text).map_err(|error| {
            let name = sequence.name(index).unwrap_or_default();
            Failure::general(format!("{name}.truth.json is no truth of a frame: {error}"))
        })?;
        for object in &objects {
            self.truth.know_by_name(object);
            self.names
                .entry(u64::from(object.id))
                .or_insert_with(|| object.name.clone());
        }
        self.depth_m.clear();
        self.depth_m.extend(points.iter().map(|point| point.z));
        let view = LabelledDepthImage {
            depth_m: &self.depth_m,
            is_exact: false,
            mask: &self.mask,
            world_from_camera,
            up_in_world,
        };
        Ok(self.truth.of_frame(&view, &objects))
    }
}
