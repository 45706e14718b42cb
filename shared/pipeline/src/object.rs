//! One object's half of the step.

use crate::box_frame::{N_READINGS, box_frame};
use crate::config::descriptor;
use crate::frame::Measured;
use crate::key_views::KeyViews;
use crate::{Config, Error};
use description::{Descriptor, Good, ObjectPoints};
use geometry::OrientedBox;
use learning::{CategoryIndex, CategoryName, Recognition};
use point_cloud::Point;
use tracking::{Evidence, MotionFilter};

/// A view shows an object whole with this share of its box.
const WHOLE_SHARE: f64 = 0.9;

/// What is known of one object; small, so that a copy of it is a checkpoint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObjectState {
    filter: Option<MotionFilter>,
    key_views: KeyViews,
    n_views: u32,
}

/// Scratch memory for observing; one for each object or worker.
#[derive(Debug, Clone)]
pub struct ObjectTools {
    good: Good,
    readings: [Vec<f32>; N_READINGS as usize],
}

impl ObjectTools {
    /// Tools without memory yet.
    ///
    /// # Errors
    /// When the descriptor is impossible.
    pub fn new() -> Result<Self, Error> {
        Ok(Self {
            good: descriptor()?,
            readings: Default::default(),
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
        let Observation {
            cloud,
            indices,
            measured,
        } = observation;
        let filter = match &self.filter {
            Some(filter) => {
                let evidence = Evidence {
                    cloud,
                    indices,
                    world_from_camera: measured.frame.world_from_camera,
                    view: measured.frame.view(cloud),
                };
                filter.updated(&measured.measurement, Some(&evidence), config.motion())
            }
            None => Ok(MotionFilter::start(&measured.measurement, config.motion())),
        }
        .map_err(Error::Tracking)?;
        let points = ObjectPoints::selected(cloud, indices).map_err(Error::Description)?;
        let tracked_box = tracked_box_in_camera(&filter, measured);
        let answer = recognise(points, &tracked_box, taught, config, tools)?;
        descriptor.clone_from(&tools.readings[0]);
        let pose = filter.box_in_world().frame_from_box;
        let is_whole = !measured.is_cut && filter.completeness() >= WHOLE_SHARE;
        let is_key_view =
            self.key_views
                .take(filter.stamp_ns(), &pose, is_whole, &tools.readings);
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

/// Describes all readings of an object's box and gives the best answer of all.
fn recognise(
    points: ObjectPoints<'_>,
    tracked_box: &OrientedBox,
    taught: &CategoryIndex,
    config: &Config,
    tools: &mut ObjectTools,
) -> Result<Recognition, Error> {
    let mut best: Option<Recognition> = None;
    for (reading, descriptor) in (0..N_READINGS).zip(&mut tools.readings) {
        let frame = box_frame(tracked_box, reading);
        tools
            .good
            .compute(points, &frame, descriptor)
            .map_err(Error::Description)?;
        let answer = taught
            .recognise(descriptor, config.unknown_distance())
            .map_err(Error::Learning)?;
        if best
            .as_ref()
            .is_none_or(|best| answer.distance < best.distance)
        {
            best = Some(answer);
        }
    }
    best.ok_or(Error::Description(description::Error::NoPoints))
}

/// The tracked box, whose axes and sides are steadier than one frame's, where
/// this frame shows it.
fn tracked_box_in_camera(filter: &MotionFilter, measured: &Measured) -> OrientedBox {
    let mut tracked = filter
        .box_in_world()
        .transformed(&measured.frame.world_from_camera.inverse());
    tracked.frame_from_box.translation = measured.centre_in_camera.into();
    tracked
}
