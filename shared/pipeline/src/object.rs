//! One object's half of the step.

use crate::box_frame::box_frame;
use crate::config::descriptor;
use crate::frame::Measured;
use crate::{Config, Error};
use description::{Descriptor, Good, ObjectPoints};
use learning::{CategoryIndex, CategoryName};
use point_cloud::Point;
use tracking::{KeyViewRule, MotionFilter};

/// What is known of one object; small, without heap memory, so that a copy of it
/// is a checkpoint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ObjectState {
    filter: Option<MotionFilter>,
    key_views: KeyViewRule,
    n_views: u32,
}

/// Scratch memory for observing; one for each object or worker.
#[derive(Debug, Clone)]
pub struct ObjectTools {
    good: Good,
}

impl ObjectTools {
    /// Tools without memory yet.
    ///
    /// # Errors
    /// When the descriptor is impossible.
    pub fn new() -> Result<Self, Error> {
        Ok(Self {
            good: descriptor()?,
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
}

impl ObjectState {
    /// Takes one view: updates the motion filter, decides whether the view is
    /// key, describes it into `descriptor`, and compares it with what was taught.
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
        let Observation {
            cloud,
            indices,
            measured,
        } = observation;
        let filter = match &self.filter {
            Some(filter) => filter.updated(&measured.measurement, config.motion()),
            None => Ok(MotionFilter::start(&measured.measurement, config.motion())),
        }
        .map_err(Error::Tracking)?;
        let points = ObjectPoints::selected(cloud, indices).map_err(Error::Description)?;
        let frame = box_frame(&measured.box_in_camera);
        tools
            .good
            .compute(points, &frame, descriptor)
            .map_err(Error::Description)?;
        let answer = taught
            .recognise(descriptor, config.unknown_distance())
            .map_err(Error::Learning)?;
        let pose = filter.box_in_world().frame_from_box;
        let is_key_view = self
            .key_views
            .take(filter.stamp_ns(), &pose, measured.is_cut);
        let view_id = self.n_views;
        self.n_views = self.n_views.saturating_add(1);
        self.filter = Some(filter);
        Ok(Posterior {
            filter,
            view_id,
            is_key_view,
            label: answer.label,
            distance: answer.distance,
        })
    }
}
