//! Per-object half of the pipeline: motion filter, descriptor, recognition and key
//! views.

use crate::candidate_measurement::CandidateMeasurement;
use crate::key_view_selector::KeyViewSelector;
use crate::track::WHOLE_FRACTION_MIN;
use crate::{Config, Error};
use description::{AppearanceDescriptor, AppearanceWeights, N_AXIS_HYPOTHESES, ObjectPoints};
use geometry::{OrientedBox, RigidTransform};
use learning::{CategoryIndex, TrackEvidence, ViewUse};
use nalgebra::Vector3;
use point_cloud::Point;
use tracking::{MotionFilter, ObservationContext};

/// Ratio of the shorter to the longer footprint side above which an object may be
/// rotationally symmetric. Chosen.
const ROUND_SIDE_RATIO_MIN: f64 = 0.75;

/// Tracking state of one object; small, so that a clone serves as a checkpoint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObjectState {
    filter: Option<MotionFilter>,
    key_view_selector: KeyViewSelector,
    n_views: u32,
    n_key_views: u32,
}

/// Scratch memory for the observation of one object at a time.
#[derive(Debug, Clone)]
pub struct ObjectWorkspace {
    appearance: AppearanceDescriptor,
}

impl ObjectWorkspace {
    /// Scratch memory without allocations.
    ///
    /// # Errors
    /// When the descriptor weights are invalid.
    pub fn new() -> Result<Self, Error> {
        Ok(Self {
            appearance: AppearanceDescriptor::new(AppearanceWeights::default())
                .map_err(Error::Description)?,
        })
    }
}

/// One object's points and measurement in a frame.
#[derive(Debug, Clone, Copy)]
pub struct Observation<'a> {
    /// Point cloud of the whole frame. *Frame*: camera.
    pub cloud: &'a [Point],
    /// Indices of the object's points in the cloud.
    pub indices: &'a [u32],
    /// Measured box and appearance.
    pub measured: &'a CandidateMeasurement,
    /// Evidence of the object's earlier views, that of its track.
    pub evidence: &'a TrackEvidence,
}

/// State update of one object from one observation: motion filter, evidence with the label read
/// from it, and key-view flag.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Motion filter after this measurement update.
    pub filter: MotionFilter,
    /// Number of the view, counted per object from 0.
    pub view_id: u32,
    /// `true` when the view is a key view, which is stored.
    pub is_key_view: bool,
    /// Evidence of all views up to this one, with the recognised category.
    pub evidence: TrackEvidence,
    /// Number of key views of the object, this one included.
    pub n_key_views: u32,
}

/// Completed stage of an observation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObservationStage {
    /// Stage: motion filter updated.
    Tracked,
    /// Stage: descriptor computed.
    Described,
    /// Stage: category recognised.
    Recognised,
}

/// Output buffer and optional stage observer of an observation.
pub struct ObservationOutput<'a> {
    /// Receives the descriptor of the first axis hypothesis, which is the one to be
    /// stored.
    pub descriptor: &'a mut Vec<f32>,
    /// Called at the end of each stage, for instance to read a clock.
    pub on_stage: Option<&'a mut dyn FnMut(ObservationStage)>,
}

impl<'a> From<&'a mut Vec<f32>> for ObservationOutput<'a> {
    fn from(descriptor: &'a mut Vec<f32>) -> Self {
        Self {
            descriptor,
            on_stage: None,
        }
    }
}

impl ObjectState {
    /// Discards a motion filter of a later time than that of the coming measurement, which could
    /// never be updated again. True if there was one.
    pub fn discard_future(&mut self, capture_ns: u64) -> bool {
        self.filter
            .take_if(|filter| filter.stamp_ns() > capture_ns)
            .is_some()
    }

    /// Processes one view: updates the motion filter, describes the points, recognises
    /// the category over all sides of the object and selects key views. The descriptor of
    /// the first hypothesis, which is the one to be stored, is written to `output`.
    ///
    /// *Frame*: points in the camera frame, posterior in the world frame.
    ///
    /// # Errors
    /// When the measurement is older than the state, or the points cannot be described.
    /// The state is unchanged then.
    pub fn observe<'a>(
        &mut self,
        observation: &Observation<'_>,
        taught: &CategoryIndex,
        config: &Config,
        workspace: &mut ObjectWorkspace,
        output: impl Into<ObservationOutput<'a>>,
    ) -> Result<Posterior, Error> {
        let ObservationOutput {
            descriptor,
            mut on_stage,
        } = output.into();
        let mut end_stage = |stage| {
            if let Some(on_stage) = &mut on_stage {
                on_stage(stage);
            }
        };
        let Observation {
            cloud,
            indices,
            measured,
            evidence,
        } = observation;
        let context = ObservationContext {
            cloud,
            indices,
            world_from_camera: measured.frame.world_from_camera,
            view: measured.frame.view(cloud, measured.depth_noise()),
        };
        let filter = match &self.filter {
            Some(filter) => filter.updated(&measured.measurement, Some(&context), config.motion()),
            None => Ok(MotionFilter::start(&measured.measurement, config.motion())),
        }
        .map_err(Error::Tracking)?;
        end_stage(ObservationStage::Tracked);
        let points = ObjectPoints::selected(cloud, indices).map_err(Error::Description)?;
        let hypotheses = describe(points, measured, &mut workspace.appearance)?;
        end_stage(ObservationStage::Described);
        let pose = observable_pose(&filter.box_in_world());
        let is_whole = !measured.is_truncated && filter.completeness() >= WHOLE_FRACTION_MIN;
        let is_key_view =
            self.key_view_selector
                .accept(filter.stamp_ns(), &pose, is_whole, hypotheses);
        let view_use = view_use(is_key_view, is_whole);
        let mut evidence = TrackEvidence::clone(evidence);
        taught
            .recognise_track(hypotheses, view_use, config.unknown_rule(), &mut evidence)
            .map_err(Error::Learning)?;
        end_stage(ObservationStage::Recognised);
        descriptor.clone_from(&hypotheses[0]);
        let view_id = self.n_views;
        self.n_views = self.n_views.saturating_add(1);
        self.n_key_views = self.n_key_views.saturating_add(u32::from(is_key_view));
        self.filter = Some(filter);
        Ok(Posterior {
            filter,
            view_id,
            is_key_view,
            evidence,
            n_key_views: self.n_key_views,
        })
    }
}

fn view_use(is_key_view: bool, is_whole: bool) -> ViewUse {
    match (is_key_view, is_whole) {
        (true, _) => ViewUse::KeyView,
        (false, true) => ViewUse::Whole,
        (false, false) => ViewUse::Partial,
    }
}

/// Pose for motion detection. The yaw of a rotationally symmetric object is
/// unobservable, so its rotation is left out.
fn observable_pose(shape: &OrientedBox) -> RigidTransform {
    let [x, y] = [shape.half_sides_m.x, shape.half_sides_m.y];
    if x.min(y) < ROUND_SIDE_RATIO_MIN * x.max(y) {
        shape.frame_from_box
    } else {
        RigidTransform::from(shape.frame_from_box.translation)
    }
}

/// Upright descriptor of an object in all axis hypotheses; the box axis z is the up
/// direction.
fn describe<'a>(
    points: ObjectPoints<'_>,
    measured: &CandidateMeasurement,
    appearance: &'a mut AppearanceDescriptor,
) -> Result<&'a [Vec<f32>; N_AXIS_HYPOTHESES], Error> {
    let camera_from_world = measured.frame.world_from_camera.rotation.inverse();
    let world_from_box = measured.measurement.box_in_world().frame_from_box.rotation;
    let up = camera_from_world * world_from_box * Vector3::z_axis();
    appearance
        .describe(points.balanced(measured.white_balance), Some(&up))
        .map_err(Error::Description)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sensor_noise::DepthNoise;
    use tracking::{HandContact, Measurement, MotionConfig, ViewingConditions};

    #[test]
    fn only_a_filter_of_a_later_time_is_discarded() {
        let conditions = ViewingConditions {
            depth_m: 1.0,
            depth_noise: DepthNoise::KINECT_V1,
            ray_in_world: Vector3::y_axis(),
            variances_m2: Vector3::repeat(1e-3),
            stands_on_table: true,
            is_truncated: false,
            hand_contact: HandContact::None,
        };
        let shape = OrientedBox {
            frame_from_box: RigidTransform::identity(),
            half_sides_m: Vector3::repeat(0.05),
        };
        let measurement = Measurement::new(1_000, shape, conditions).unwrap();
        let mut state = ObjectState::default();
        assert!(!state.discard_future(0), "there is none");
        state.filter = Some(MotionFilter::start(&measurement, &MotionConfig::default()));
        assert!(!state.discard_future(1_000));
        assert!(state.filter.is_some());
        assert!(state.discard_future(999));
        assert_eq!(state.filter, None);
    }
}
