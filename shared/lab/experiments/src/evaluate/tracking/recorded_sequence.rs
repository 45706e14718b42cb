//! Recorded RGB-D sequence with camera poses, and its tracking.

use super::RATE_HZ;
use super::ground_truth::{GroundTruth, LabelledDepthImage};
use super::tracking_pipeline::{TrackerInput, TrackingPipeline};
use super::tracking_run::TrackedSequence;
use dataset::rgbd_sequence::{RgbdSequence, Scratch};
use evaluation::tracked_frame::{GroundTruthObject, TrackState, TrackedFrame};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{Quaternion, Translation3, Unit, UnitQuaternion, UnitVector3, Vector3};
use point_cloud::{OrganizedCloud, Point};
use serde::Deserialize;
use service::Failure;
use simulated_world::{ObjectState, ObjectTruth};
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

/// Ground truth of a frame as written in its file.
#[derive(Deserialize)]
struct RawGroundTruth {
    objects: Vec<RawObject>,
}

#[derive(Deserialize)]
struct RawObject {
    id: u16,
    name: String,
    category: String,
    state: String,
    position_m: [f64; 3],
    orientation_xyzw: [f64; 4],
    size_m: [f64; 3],
    velocity_m_s: [f64; 3],
    visible_px: u32,
    unoccluded_px: u32,
}

impl TryFrom<RawObject> for ObjectTruth {
    type Error = String;

    fn try_from(raw: RawObject) -> Result<Self, String> {
        let rotation = Quaternion::from(raw.orientation_xyzw);
        if !(0.99..1.01).contains(&rotation.norm()) {
            return Err(format!(
                "the orientation of object {} is no unit quaternion",
                raw.id
            ));
        }
        let rotation = UnitQuaternion::new_normalize(rotation);
        let state = match raw.state.as_str() {
            "settled" => ObjectState::Settled,
            "held-by-person" => ObjectState::HeldByPerson,
            "held-by-arm" => ObjectState::HeldByArm,
            "on-floor" => ObjectState::OnFloor,
            _ => ObjectState::Moving,
        };
        Ok(Self {
            id: raw.id,
            name: raw.name,
            category: raw.category,
            world_from_object: RigidTransform::from_parts(
                Translation3::from(Vector3::from(raw.position_m)),
                rotation,
            ),
            size_m: raw.size_m.into(),
            velocity_m_s: raw.velocity_m_s.into(),
            state,
            visible_px: raw.visible_px,
            unoccluded_px: raw.unoccluded_px,
        })
    }
}

fn parse_truth(json: &[u8]) -> Result<Vec<ObjectTruth>, String> {
    let raw: RawGroundTruth = serde_json::from_slice(json).map_err(|error| error.to_string())?;
    raw.objects.into_iter().map(TryInto::try_into).collect()
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
            let frame = TrackedFrame {
                tracks_of_people: Vec::new(),
                time_s: index as f64 / RATE_HZ,
                objects,
                tracks: tracker.track_states(),
                ended: tracker.ended().to_vec(),
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
    ) -> Result<TrackerInput<'a>, Failure> {
        let camera = self.sequence.camera();
        let (width, height) = (camera.width as usize, camera.height as usize);
        let gravity = self.sequence.gravity_in_world();
        let up_in_camera = gravity.map(|down| {
            Unit::new_normalize(world_from_camera.rotation.inverse() * -down.into_inner())
        });
        Ok(TrackerInput {
            number: index as u64,
            capture_ns: ((1.0 + index as f64 / RATE_HZ) * 1e9).round() as u64,
            cloud: OrganizedCloud::new(points, width, height).map_err(Failure::general)?,
            camera: *camera,
            world_from_camera,
            up_in_camera,
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
        let objects = parse_truth(&self.text).map_err(|error| {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ground_truth_files_are_read_back_and_validated() {
        let object = ObjectTruth {
            id: 3,
            name: "mug-7".into(),
            category: "mug".into(),
            world_from_object: RigidTransform::new(Vector3::new(0.1, 0.2, 0.7), Vector3::z()),
            size_m: Vector3::new(0.1, 0.08, 0.09),
            velocity_m_s: Vector3::zeros(),
            state: ObjectState::HeldByPerson,
            visible_px: 900,
            unoccluded_px: 1000,
        };
        let text = simulated_world::truth_json(4, 0.5, std::slice::from_ref(&object));
        let read = parse_truth(text.as_bytes()).unwrap();
        assert_eq!(
            (read[0].id, &read[0].name, read[0].state),
            (3, &object.name, object.state)
        );
        let apart = read[0].world_from_object.inverse() * object.world_from_object;
        assert!(apart.translation.vector.norm() < 1e-12 && apart.rotation.angle() < 1e-7);
        let w = object.world_from_object.rotation.w;
        let broken = text.replace(&format!("{w}"), "9.0");
        assert!(
            parse_truth(broken.as_bytes())
                .unwrap_err()
                .contains("object 3")
        );
        assert!(parse_truth(b"{}").is_err());
    }
}
