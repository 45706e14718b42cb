//! Sequential executor: detection and observation on the calling thread, for
//! evaluation and replay.

use crate::frame_pipeline::{FrameExecutor, FramePipeline, ObservedTracks};
use crate::{
    Config, Error, FramePose, ObjectState, ObjectWorkspace, Observation, Sighting, category_index,
};
use detection::{
    BodyMap, Detection, DetectionInput, Execution, ExpectedTrack, ScenePriors, Workspace, detect,
};
use geometry::{Capsule, Plane};
use learning::CategoryIndex;
use point_cloud::OrganizedCloud;
use std::collections::BTreeMap;
use std::future::ready;

/// Frame with its priors, as a recording or a simulation supplies it.
#[derive(Debug, Clone, Copy)]
pub struct SequentialFrame<'a> {
    /// Camera pose, gravity and intrinsics with the time of capture.
    pub pose: FramePose,
    /// Point cloud of the frame, camera frame.
    pub cloud: OrganizedCloud<'a>,
    /// Capsules of people, camera frame; `None` when no source reports people.
    pub people: Option<&'a [Capsule]>,
    /// Capsules of the robot, camera frame; `None` when no source reports the robot.
    pub robot: Option<&'a [Capsule]>,
}

/// State of one object, and the descriptor of its last view.
#[derive(Debug, Default)]
struct SequentialObject {
    state: ObjectState,
    descriptor: Vec<f32>,
}

/// State of the objects and buffers, which last from frame to frame.
#[derive(Debug)]
pub struct SequentialState {
    detection_config: detection::Config,
    config: Config,
    workspace: Workspace,
    detection: Detection,
    bodies: BodyMap,
    expected: Vec<ExpectedTrack>,
    expected_surfaces: Vec<Plane>,
    objects: BTreeMap<u64, SequentialObject>,
    object_workspace: ObjectWorkspace,
    categories: CategoryIndex,
    last_track_id: u64,
}

impl SequentialState {
    /// State without objects and without taught categories.
    ///
    /// # Errors
    /// When the descriptor cannot be set up.
    pub fn new(detection_config: detection::Config, config: Config) -> Result<Self, Error> {
        Ok(Self {
            detection_config,
            config,
            workspace: Workspace::default(),
            detection: Detection::default(),
            bodies: BodyMap::default(),
            expected: Vec::new(),
            expected_surfaces: Vec::new(),
            objects: BTreeMap::new(),
            object_workspace: ObjectWorkspace::new()?,
            categories: category_index(),
            last_track_id: 0,
        })
    }

    /// Replaces the taught categories, between two frames.
    pub fn set_categories(&mut self, categories: CategoryIndex) {
        self.categories = categories;
    }

    /// Detection of the last frame.
    pub fn detection(&self) -> &Detection {
        &self.detection
    }

    /// Descriptor of the last view of a live object, as it is stored when it is taught.
    pub fn descriptor(&self, track_id: u64) -> Option<&[f32]> {
        let object = self.objects.get(&track_id)?;
        Some(&object.descriptor)
    }

    /// Runs one frame through a pipeline sequentially.
    ///
    /// # Errors
    /// When the cloud cannot be searched or an object cannot be described.
    pub fn process(
        &mut self,
        pipeline: &mut FramePipeline,
        frame: &SequentialFrame<'_>,
    ) -> Result<(), Error> {
        let mut executor = SequentialExecutor { state: self, frame };
        let done = pipeline.process_now(&frame.pose, frame.cloud.points(), &mut executor);
        if let Some(detection) = done.transpose()? {
            self.detection = detection;
        }
        Ok(())
    }
}

/// Single-threaded [`FrameExecutor`] of one frame over a [`SequentialState`]: detection and
/// observation run on the calling thread.
#[derive(Debug)]
pub struct SequentialExecutor<'a> {
    state: &'a mut SequentialState,
    frame: &'a SequentialFrame<'a>,
}

impl SequentialExecutor<'_> {
    fn search(&mut self) -> Result<Detection, Error> {
        let state = &mut *self.state;
        let input = DetectionInput {
            cloud: self.frame.cloud,
            up_in_camera: self.frame.pose.up_in_camera,
            priors: ScenePriors {
                instructor: self.frame.people,
                robot: self.frame.robot,
                bodies: Some(&state.bodies),
                world_from_camera: self.frame.pose.world_from_camera,
                surfaces: &state.expected_surfaces,
                tracks: &state.expected,
            },
        };
        let mut detection = std::mem::take(&mut state.detection);
        let (config, workspace) = (&state.detection_config, &mut state.workspace);
        detect(
            &input,
            config,
            workspace,
            &mut detection,
            Execution::default(),
        )
        .map_err(Error::Detection)?;
        state.bodies.assign(&detection.bodies);
        Ok(detection)
    }

    fn observe_all(
        &mut self,
        detection: &Detection,
        sightings: &[Sighting],
        mut tracks: ObservedTracks<'_>,
    ) -> Result<(), Error> {
        let state = &mut *self.state;
        for sighting in sightings {
            let candidate = &detection.candidates[sighting.candidate];
            let observation = Observation {
                cloud: self.frame.cloud.points(),
                indices: detection.points_of(candidate),
                measured: &sighting.measured,
                evidence: &tracks.evidence(sighting.track_id),
            };
            let object = state.objects.entry(sighting.track_id).or_default();
            let posterior = object.state.observe(
                &observation,
                &state.categories,
                &state.config,
                &mut state.object_workspace,
                &mut object.descriptor,
            )?;
            tracks.apply(sighting.track_id, &posterior);
        }
        Ok(())
    }
}

impl FrameExecutor for SequentialExecutor<'_> {
    type Detected = Detection;
    type Error = Error;

    fn expected_tracks(&mut self) -> &mut Vec<ExpectedTrack> {
        &mut self.state.expected
    }

    fn expected_surfaces(&mut self) -> &mut Vec<Plane> {
        &mut self.state.expected_surfaces
    }

    fn detect(&mut self) -> impl Future<Output = Result<Detection, Error>> + Send {
        ready(self.search())
    }

    fn detection(detected: &Detection) -> &Detection {
        detected
    }

    fn next_track_id(&mut self) -> Option<u64> {
        self.state.last_track_id += 1;
        Some(self.state.last_track_id)
    }

    fn track_started(&mut self, _track_id: u64) {}

    fn track_ended(&mut self, track_id: u64) {
        self.state.objects.remove(&track_id);
    }

    fn observe(
        &mut self,
        detected: &Detection,
        sightings: &[Sighting],
        tracks: ObservedTracks<'_>,
    ) -> impl Future<Output = Result<(), Error>> + Send {
        ready(self.observe_all(detected, sightings, tracks))
    }
}
