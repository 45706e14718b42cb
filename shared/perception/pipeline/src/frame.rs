//! When and from where a frame was seen, and what it says of a candidate.

use crate::{Config, Error};
use detection::{Candidate, Support};
use geometry::{OrientedBox, PinholeCamera, RigidTransform};
use nalgebra::{Translation3, Unit, Vector3};
use point_cloud::{Moments, Point};
use tracking::{
    Appearance, Circumstances, ColorHistogram, DepthView, Handling, Measurement, Observed,
};

/// An object's colours and the spread of its points are taken from about this
/// many of them.
const N_SAMPLES: usize = 400;

/// The circumstances of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Capture stamp, nanoseconds.
    pub capture_ns: u64,
    /// Pose of the camera; the identity when it is not known.
    pub world_from_camera: RigidTransform,
    /// The camera, where the cloud is its image; without it nothing is known of
    /// what hides an object.
    pub camera: Option<PinholeCamera>,
}

impl Frame {
    /// A view into the frame's cloud, where it is an image.
    pub fn view<'a>(&self, cloud: &'a [Point]) -> Option<DepthView<'a>> {
        DepthView::new(cloud, self.camera?, &self.world_from_camera)
    }
}

/// What a frame says of one candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The box in the world and its stamp.
    pub measurement: Measurement,
    /// The frame it was seen in.
    pub frame: Frame,
    /// Coarse looks.
    pub appearance: Appearance,
    /// Mean red, green, blue; 0 to 255.
    pub mean_rgb: [f32; 3],
    /// Number of points.
    pub n_points: usize,
    /// Whether it lies where a person or the robot is.
    pub is_limb: bool,
    /// Whether the border of the image cuts the object.
    pub is_cut_by_image: bool,
    /// Whether a part of it may be missing: the border of the image cuts it, or a
    /// person or the robot touches it.
    pub is_cut: bool,
}

impl Measured {
    /// The measurement of a candidate from its points.
    ///
    /// # Errors
    /// When the candidate's box is no possible measurement.
    pub fn of(
        candidate: &Candidate,
        indices: &[u32],
        cloud: &[Point],
        frame: &Frame,
    ) -> Result<Self, Error> {
        let box_in_camera = seen_box(candidate);
        let box_in_world = box_in_camera.transformed(&frame.world_from_camera);
        let is_cut_by_image = candidate.touches_image_border;
        let is_limb = candidate.findings.is_limb();
        let handling = match (is_limb, candidate.is_touched()) {
            (true, _) => Handling::WithinHand,
            (false, true) => Handling::Touched,
            (false, false) => Handling::Alone,
        };
        let is_handled = handling != Handling::Alone;
        let is_cut = is_cut_by_image || is_handled;
        let seen = Circumstances {
            depth_m: candidate.centroid.z,
            ray_in_world: ray(candidate, &frame.world_from_camera),
            variances_m2: variances_m2(candidate, indices, cloud),
            stands_on_table: stands_on_table(candidate) && !is_handled,
            is_cut,
            handling,
        };
        let measurement =
            Measurement::new(frame.capture_ns, box_in_world, seen).map_err(Error::Tracking)?;
        let colors = sampled(indices, cloud).map(|point| point.color);
        Ok(Self {
            measurement,
            frame: *frame,
            appearance: Appearance {
                volume_m3: box_in_world.volume_m3(),
                colors: ColorHistogram::of(colors),
                is_cut,
            },
            mean_rgb: candidate.mean_rgb,
            n_points: candidate.n_points(),
            is_limb,
            is_cut_by_image,
            is_cut,
        })
    }

    pub(crate) fn observed(&self, config: &Config) -> Observed {
        Observed {
            box_in_world: *self.measurement.box_in_world(),
            position_variance_m2: self.measurement.position_variance_m2(config.motion()),
            appearance: self.appearance,
            is_limb: self.is_limb,
        }
    }
}

/// The box around what was seen of a candidate, without the foot it is thought to
/// have: whether that is there changes when it is lifted.
fn seen_box(candidate: &Candidate) -> OrientedBox {
    let whole = &candidate.oriented_box;
    let half_foot_m = (0.5 * candidate.unseen_foot_m).min(whole.half_sides_m.z);
    OrientedBox {
        frame_from_box: whole.frame_from_box * Translation3::new(0.0, 0.0, half_foot_m),
        half_sides_m: whole.half_sides_m - Vector3::z() * half_foot_m,
    }
}

/// Whether a candidate's box was seen to end at the table.
fn stands_on_table(candidate: &Candidate) -> bool {
    candidate.support == Some(Support::Table) && candidate.unseen_foot_m == 0.0
}

/// Some of the points of an object, evenly.
fn sampled<'a>(indices: &'a [u32], cloud: &'a [Point]) -> impl Iterator<Item = &'a Point> {
    let stride = indices.len().div_ceil(N_SAMPLES).max(1);
    let index = indices.iter().step_by(stride);
    index.filter_map(|index| cloud.get(*index as usize))
}

/// Variances of the points along the axes of the box, square metres.
fn variances_m2(candidate: &Candidate, indices: &[u32], cloud: &[Point]) -> Vector3<f64> {
    let mut moments = Moments::default();
    for point in sampled(indices, cloud) {
        moments.add(&point.position());
    }
    let axes = candidate
        .oriented_box
        .frame_from_box
        .rotation
        .to_rotation_matrix();
    let spread = moments.covariance_m2().unwrap_or_default();
    (axes.transpose() * spread * axes.matrix())
        .diagonal()
        .map(|variance| variance.max(0.0))
}

/// From the camera to a candidate, world frame.
fn ray(candidate: &Candidate, world_from_camera: &RigidTransform) -> Unit<Vector3<f64>> {
    let ray_in_camera = candidate.oriented_box.centre().coords;
    let ray = Unit::try_new(world_from_camera.rotation * ray_in_camera, 1e-9);
    ray.unwrap_or_else(|| world_from_camera.rotation * Vector3::z_axis())
}
