//! Tracking under evaluation: the frame pipeline of the daemon, run sequentially.

use evaluation::tracked_frame::TrackState;
use geometry::{Capsule, PinholeCamera, RigidTransform};
use nalgebra::{Unit, Vector3};
use pipeline::{Config, FramePipeline, FramePose, SequentialFrame, SequentialState, Track};
use point_cloud::OrganizedCloud;
use tracking::{AssociationConfig, MotionConfig, TrackPhase, Visibility};

/// Frame of a sequence with its camera pose and the known bodies.
#[derive(Debug, Clone, Copy)]
pub(super) struct TrackerInput<'a> {
    /// Frame number, from 0; the seed of detection.
    pub(super) number: u64,
    /// Capture stamp of the frame, nanoseconds.
    pub(super) capture_ns: u64,
    /// Point cloud of the frame, camera frame.
    pub(super) cloud: OrganizedCloud<'a>,
    /// Intrinsics of the camera.
    pub(super) camera: PinholeCamera,
    /// Pose of the camera, `world_from_camera`.
    pub(super) world_from_camera: RigidTransform,
    /// Up direction, camera frame; `None` when unknown.
    pub(super) up_in_camera: Option<Unit<Vector3<f64>>>,
    /// Capsules of people, world frame; `None` when no source reports people.
    pub(super) people: Option<&'a [Capsule]>,
    /// Capsules of the robot, world frame; `None` when no source reports the robot.
    pub(super) robot: Option<&'a [Capsule]>,
}

/// Frame pipeline with its sequential executor.
pub(in super::super) struct TrackingPipeline {
    pipeline: FramePipeline,
    state: SequentialState,
}

impl TrackingPipeline {
    /// Pipeline with the daemon's default settings and nothing taught.
    pub(in super::super) fn new() -> Result<Self, pipeline::Error> {
        let (motion, association) = (MotionConfig::default(), AssociationConfig::default());
        let config = Config::new(motion, association, Config::KNOWN_PROBABILITY_MIN)?;
        Ok(Self {
            pipeline: FramePipeline::new(config),
            state: SequentialState::new(detection::Config::default(), config)?,
        })
    }

    /// Processes one frame: detection, association and track update.
    ///
    /// # Errors
    /// When the frame cannot be searched or an object cannot be described.
    pub(super) fn step(&mut self, input: &TrackerInput<'_>) -> Result<(), pipeline::Error> {
        let camera_from_world = input.world_from_camera.inverse();
        let in_camera = |capsules: Option<&[Capsule]>| -> Option<Vec<Capsule>> {
            let transformed = |capsule: &Capsule| capsule.transformed(&camera_from_world);
            Some(capsules?.iter().map(transformed).collect())
        };
        let (people, robot) = (in_camera(input.people), in_camera(input.robot));
        let frame = SequentialFrame {
            pose: FramePose {
                capture_ns: input.capture_ns,
                world_from_camera: input.world_from_camera,
                up_in_camera: input.up_in_camera,
                camera: Some(input.camera),
            },
            cloud: input.cloud,
            seed: input.number,
            people: people.as_deref(),
            robot: robot.as_deref(),
        };
        self.state.process(&mut self.pipeline, &frame)
    }

    /// Live tracks after the last frame.
    pub(in super::super) fn tracks(&self) -> &[Track] {
        self.pipeline.tracks()
    }

    /// States of the live tracks after the last frame.
    pub(super) fn track_states(&self) -> Vec<TrackState> {
        let tracks = self.pipeline.tracks().iter().map(|track| TrackState {
            id: track.id,
            is_output: track.visibility() == Visibility::Visible
                && track.phase() == TrackPhase::Confirmed,
            box_in_world: track.box_in_world(),
        });
        tracks.collect()
    }

    /// Ids of the tracks that ended with the last frame.
    pub(super) fn ended(&self) -> &[u64] {
        &self.pipeline.update().ended_tracks
    }
}
