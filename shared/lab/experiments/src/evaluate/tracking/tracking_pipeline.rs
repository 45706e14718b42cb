//! In-process tracking pipeline: detection, data association and description, as in the daemon.

use detection::{Detection, ExpectedTrack, ScenePriors, Workspace, detect};
use evaluation::tracked_frame::TrackState;
use geometry::{Capsule, PinholeCamera, RigidTransform};
use learning::CategoryIndex;
use nalgebra::{Unit, Vector3};
use pipeline::{
    Config, FramePose, ObjectState, ObjectWorkspace, Observation, TrackTable, TrackUpdate,
    category_index,
};
use point_cloud::OrganizedCloud;
use std::collections::BTreeMap;
use tracking::{AssociationConfig, MotionConfig, TrackPhase, Visibility};

/// Minimum probability of a known object. Without effect here: no category is taught.
const KNOWN_PROBABILITY_MIN: f32 = 0.5;

/// Input of one pipeline step: frame, camera pose and bodies.
#[derive(Debug, Clone, Copy)]
pub(super) struct TrackerInput<'a> {
    /// Number of the frame, from 0.
    pub(super) number: u64,
    pub(super) capture_ns: u64,
    pub(super) cloud: OrganizedCloud<'a>,
    pub(super) camera: PinholeCamera,
    pub(super) world_from_camera: RigidTransform,
    pub(super) up_in_camera: Option<Unit<Vector3<f64>>>,
    /// Capsules in the world frame; `None` if not reported.
    pub(super) people: Option<&'a [Capsule]>,
    /// Capsules in the world frame; `None` if not reported.
    pub(super) robot: Option<&'a [Capsule]>,
}

/// Tracking pipeline with its state.
pub(super) struct TrackingPipeline {
    detection_config: detection::Config,
    config: Config,
    workspace: Workspace,
    detection: Detection,
    table: TrackTable,
    step: TrackUpdate,
    states: BTreeMap<u64, ObjectState>,
    tools: ObjectWorkspace,
    taught: CategoryIndex,
    descriptor: Vec<f32>,
    expected: Vec<ExpectedTrack>,
    last_id: u64,
}

impl TrackingPipeline {
    pub(super) fn new() -> Result<Self, pipeline::Error> {
        let (motion, association) = (MotionConfig::default(), AssociationConfig::default());
        let config = Config::new(motion, association, KNOWN_PROBABILITY_MIN)?;
        Ok(Self {
            detection_config: detection::Config::default(),
            config,
            workspace: Workspace::default(),
            detection: Detection::default(),
            table: TrackTable::new(config),
            step: TrackUpdate::default(),
            states: BTreeMap::new(),
            tools: ObjectWorkspace::new()?,
            taught: category_index(),
            descriptor: Vec::new(),
            expected: Vec::new(),
            last_id: 0,
        })
    }

    /// Processes one frame.
    ///
    /// # Errors
    /// A sentence if detection refuses the frame or an object cannot be described.
    pub(super) fn step(&mut self, seen: &TrackerInput<'_>) -> Result<(), String> {
        let frame = FramePose {
            capture_ns: seen.capture_ns,
            world_from_camera: seen.world_from_camera,
            camera: Some(seen.camera),
        };
        self.table.predict(&frame, &mut self.expected);
        let camera_from_world = seen.world_from_camera.inverse();
        let in_camera = |capsules: Option<&[Capsule]>| -> Option<Vec<Capsule>> {
            let capsules = capsules?.iter();
            Some(
                capsules
                    .map(|c| c.transformed(&camera_from_world))
                    .collect(),
            )
        };
        let (people, robot) = (in_camera(seen.people), in_camera(seen.robot));
        let searched = detection::DetectionInput {
            cloud: seen.cloud,
            up_in_camera: seen.up_in_camera,
            seed: seen.number,
            priors: ScenePriors {
                instructor: people.as_deref(),
                robot: robot.as_deref(),
                tracks: &self.expected,
            },
        };
        let (workspace, detection) = (&mut self.workspace, &mut self.detection);
        detect(&searched, &self.detection_config, workspace, detection)
            .map_err(|error| error.to_string())?;
        let last_id = &mut self.last_id;
        let next_id = || {
            *last_id += 1;
            Some(*last_id)
        };
        self.table.update(
            &self.detection,
            seen.cloud.points(),
            &frame,
            next_id,
            &mut self.step,
        );
        self.observe(seen)
    }

    fn observe(&mut self, seen: &TrackerInput<'_>) -> Result<(), String> {
        for track_id in &self.step.ended_tracks {
            self.states.remove(track_id);
        }
        for sighting in &self.step.sightings {
            let candidate = &self.detection.candidates[sighting.candidate];
            let observation = Observation {
                cloud: seen.cloud.points(),
                indices: self.detection.points_of(candidate),
                measured: &sighting.measured,
            };
            let state = self.states.entry(sighting.track_id).or_default();
            let posterior = state
                .observe(
                    &observation,
                    &self.taught,
                    &self.config,
                    &mut self.tools,
                    &mut self.descriptor,
                )
                .map_err(|error| error.to_string())?;
            self.table.apply_posterior(sighting.track_id, &posterior);
        }
        Ok(())
    }

    /// States of the live tracks after the last frame.
    pub(super) fn track_states(&self) -> Vec<TrackState> {
        let tracks = self.table.tracks().iter().map(|track| TrackState {
            id: track.id,
            is_output: track.visibility() == Visibility::Visible
                && track.phase() == TrackPhase::Confirmed,
            box_in_world: track.box_in_world(),
        });
        tracks.collect()
    }

    /// Ids of the tracks that ended with the last frame.
    pub(super) fn ended(&self) -> &[u64] {
        &self.step.ended_tracks
    }
}
