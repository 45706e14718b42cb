//! One object's half of the step.

use crate::frame::Measured;
use crate::key_views::KeyViews;
use crate::track::WHOLE_SHARE;
use crate::{Config, Error};
use description::{Appearance, AppearanceWeights, N_READINGS, ObjectPoints};
use geometry::{OrientedBox, RigidTransform};
use learning::{CategoryIndex, CategoryName, N_NEAREST, Neighbour, Vicinity};
use nalgebra::Vector3;
use point_cloud::Point;
use tracking::{Evidence, MotionFilter};

/// An object whose shorter side is at least so long, as a share of the longer one,
/// may be round.
const ROUND_RATIO: f64 = 0.75;

/// What is known of one object; small, so that a copy of it is a checkpoint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObjectState {
    filter: Option<MotionFilter>,
    key_views: KeyViews,
    n_views: u32,
    n_key_views: u32,
}

/// Scratch memory for observing; best one for each object, because what an object was
/// near to saves comparisons the next time.
#[derive(Debug, Clone)]
pub struct ObjectTools {
    appearance: Appearance,
    vicinity: Vicinity,
}

impl ObjectTools {
    /// Tools without memory yet.
    ///
    /// # Errors
    /// When the descriptor is impossible.
    pub fn new() -> Result<Self, Error> {
        Ok(Self {
            appearance: Appearance::new(AppearanceWeights::default())
                .map_err(Error::Description)?,
            vicinity: Vicinity::default(),
        })
    }
}

/// One frame's view of an object.
#[derive(Debug, Clone, Copy)]
pub struct Observation<'a> {
    /// The whole frame, camera frame.
    pub cloud: &'a [Point],
    /// The object's points in it.
    pub indices: &'a [u32],
    /// Its box and looks.
    pub measured: &'a Measured,
}

/// What an object's half of the step has found.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Motion after the measurement.
    pub filter: MotionFilter,
    /// Counts the views of the object from 0.
    pub view_id: u32,
    /// Whether the view is to be stored.
    pub is_key_view: bool,
    /// The learned category; `None` when unknown.
    pub label: Option<CategoryName>,
    /// Distance to the nearest stored view; infinite when nothing was taught.
    pub distance: f32,
    /// Probability that it belongs to the nearest category; `None` when nothing was
    /// taught.
    pub probability: Option<f32>,
    /// The nearest stored view of each of the nearest categories, nearest first.
    pub nearest: [Option<Neighbour>; N_NEAREST],
    /// Key views of the object so far, this one included.
    pub n_key_views: u32,
}

/// A stage that a view has behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// The motion filter has taken the measurement.
    Tracked,
    /// The points are described.
    Described,
    /// The description was compared with what was taught.
    Recognised,
}

/// What becomes of a view while it is observed.
pub struct Stages<'a> {
    /// Becomes the first reading's descriptor, which is the one to be stored.
    pub descriptor: &'a mut Vec<f32>,
    /// Called at the end of a stage: who has a clock may read it.
    pub on_stage: &'a mut dyn FnMut(Stage),
}

impl ObjectState {
    /// Takes one view: updates the motion filter, decides whether the view is
    /// key, describes it, and compares all readings of it with what was taught.
    /// `descriptor` becomes the first reading, which is the one to be stored.
    ///
    /// Frame: points in the camera's, the posterior in the world's.
    ///
    /// # Errors
    /// When the measurement is older than the state, or the points can not be
    /// described. The state is unchanged then.
    pub fn observe(
        &mut self,
        observation: &Observation<'_>,
        taught: &CategoryIndex,
        config: &Config,
        tools: &mut ObjectTools,
        descriptor: &mut Vec<f32>,
    ) -> Result<Posterior, Error> {
        let on_stage = &mut |_| {};
        let stages = Stages {
            descriptor,
            on_stage,
        };
        self.observe_in_stages(observation, taught, config, tools, stages)
    }

    /// Like [`observe`](Self::observe), and tells when a stage is over.
    ///
    /// # Errors
    /// As for [`observe`](Self::observe).
    pub fn observe_in_stages(
        &mut self,
        observation: &Observation<'_>,
        taught: &CategoryIndex,
        config: &Config,
        tools: &mut ObjectTools,
        stages: Stages<'_>,
    ) -> Result<Posterior, Error> {
        let Stages {
            descriptor,
            on_stage,
        } = stages;
        let Observation {
            cloud,
            indices,
            measured,
        } = observation;
        let evidence = Evidence {
            cloud,
            indices,
            world_from_camera: measured.frame.world_from_camera,
            view: measured.frame.view(cloud),
        };
        let filter = match &self.filter {
            Some(filter) => filter.updated(&measured.measurement, Some(&evidence), config.motion()),
            None => Ok(MotionFilter::start(&measured.measurement, config.motion())),
        }
        .map_err(Error::Tracking)?;
        on_stage(Stage::Tracked);
        let points = ObjectPoints::selected(cloud, indices).map_err(Error::Description)?;
        let ObjectTools {
            appearance,
            vicinity,
        } = tools;
        let readings = describe(points, measured, appearance)?;
        on_stage(Stage::Described);
        let answer = taught
            .recognise_again(readings, config.unknown_rule(), vicinity)
            .map_err(Error::Learning)?;
        on_stage(Stage::Recognised);
        descriptor.clone_from(&readings[0]);
        let pose = pose_that_tells(&filter.box_in_world());
        let is_whole = !measured.is_cut && filter.completeness() >= WHOLE_SHARE;
        let is_key_view = self
            .key_views
            .take(filter.stamp_ns(), &pose, is_whole, readings);
        let view_id = self.n_views;
        self.n_views = self.n_views.saturating_add(1);
        self.n_key_views = self.n_key_views.saturating_add(u32::from(is_key_view));
        self.filter = Some(filter);
        Ok(Posterior {
            filter,
            view_id,
            is_key_view,
            label: answer.label,
            distance: answer.distance,
            probability: answer.probability.filter(|_| answer.nearest[0].is_some()),
            nearest: answer.nearest,
            n_key_views: self.n_key_views,
        })
    }
}

/// The pose from which it is told whether an object was moved: how what is round is
/// turned is the noise of its footprint.
fn pose_that_tells(shape: &OrientedBox) -> RigidTransform {
    let [x, y] = [shape.half_sides_m.x, shape.half_sides_m.y];
    if x.min(y) < ROUND_RATIO * x.max(y) {
        shape.frame_from_box
    } else {
        RigidTransform::from(shape.frame_from_box.translation)
    }
}

/// Describes an object upright: its box stands on the table.
fn describe<'a>(
    points: ObjectPoints<'_>,
    measured: &Measured,
    appearance: &'a mut Appearance,
) -> Result<&'a [Vec<f32>; N_READINGS], Error> {
    let camera_from_world = measured.frame.world_from_camera.rotation.inverse();
    let world_from_box = measured.measurement.box_in_world().frame_from_box.rotation;
    let up = camera_from_world * world_from_box * Vector3::z_axis();
    appearance
        .describe(points, Some(&up))
        .map_err(Error::Description)
}
