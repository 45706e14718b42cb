//! Measurement of a detection candidate from its points.

use crate::{Config, Error, FramePose};
use description::WhiteBalance;
use detection::{Candidate, Support};
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Translation3, Unit, Vector3};
use point_cloud::{ColorHistogram, ColorShares, Moments, Point};
use sensor_noise::DepthNoise;
use tracking::{
    CoarseAppearance, HandContact, Measurement, ObservedCandidate, SightingEvidence,
    ViewingConditions,
};

/// Number of points, approximately, from which colours and variances are sampled.
/// Chosen.
const N_SAMPLES: usize = 400;

/// Measurement of one detection candidate: box, appearance and truncation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CandidateMeasurement {
    /// Oriented bounding box in the world with its stamp.
    pub measurement: Measurement,
    /// Capture time and camera pose of the measured frame.
    pub frame: FramePose,
    /// Coarse appearance of the candidate for data association.
    pub appearance: CoarseAppearance,
    /// Mean red, green and blue, 0 to 255, as the camera sees them.
    pub mean_rgb: [f32; 3],
    /// Shares of the basic colour terms, after the white balance.
    pub color_shares: ColorShares,
    /// White balance of the frame, by which colours are compared with those of other times.
    pub white_balance: WhiteBalance,
    /// Number of points of the candidate.
    pub n_points: usize,
    /// `true` when the candidate lies in the space of a person or the robot.
    pub overlaps_body: bool,
    /// Evidence of the candidate for an object of its own.
    pub evidence: SightingEvidence,
    /// `true` when the image border truncates the object.
    pub is_truncated_by_image: bool,
    /// `true` when a part may be missing: truncated by the image border or touched by a
    /// person or the robot.
    pub is_truncated: bool,
}

impl CandidateMeasurement {
    /// Measurement of a candidate from its points, given as indices into the cloud, with the depth noise law of the camera
    /// and the white balance of the frame.
    ///
    /// # Errors
    /// When the candidate's box is not a valid measurement.
    pub fn from_candidate(
        candidate: &Candidate,
        (indices, cloud): (&[u32], &[Point]),
        frame: &FramePose,
        depth_noise: DepthNoise,
        white_balance: WhiteBalance,
    ) -> Result<Self, Error> {
        let box_in_camera = visible_box(candidate);
        let box_in_world = box_in_camera.transformed(&frame.world_from_camera);
        let is_cut_by_image = candidate.touches_image_border;
        let overlaps_body = candidate.findings.is_person_or_robot();
        let hand_contact = match (overlaps_body, candidate.is_touched()) {
            (true, _) => HandContact::Overlapping,
            (false, true) => HandContact::Touching,
            (false, false) => HandContact::None,
        };
        let is_handled = hand_contact != HandContact::None;
        let is_truncated = is_cut_by_image || is_handled;
        let seen = ViewingConditions {
            depth_m: candidate.centroid.z,
            depth_noise,
            ray_in_world: ray(candidate, &frame.world_from_camera),
            variances_m2: variances_m2(candidate, indices, cloud),
            stands_on_table: stands_on_table(candidate) && !is_handled,
            is_truncated,
            hand_contact,
        };
        let measurement =
            Measurement::new(frame.capture_ns, box_in_world, seen).map_err(Error::Tracking)?;
        let colors = sampled(indices, cloud).map(|point| point.color);
        let balanced = colors.clone().map(|color| white_balance.color(color));
        Ok(Self {
            measurement,
            frame: *frame,
            appearance: CoarseAppearance {
                volume_m3: box_in_world.volume_m3(),
                colors: ColorHistogram::from_colors(colors),
                is_truncated,
            },
            mean_rgb: candidate.mean_rgb,
            color_shares: ColorShares::of(balanced),
            white_balance,
            n_points: candidate.n_points(),
            overlaps_body,
            evidence: SightingEvidence::Separate,
            is_truncated_by_image: is_cut_by_image,
            is_truncated,
        })
    }

    /// Depth noise law of the camera.
    pub(crate) fn depth_noise(&self) -> DepthNoise {
        self.measurement.conditions().depth_noise
    }

    fn observed_candidate(&self, config: &Config) -> ObservedCandidate {
        ObservedCandidate {
            box_in_world: *self.measurement.box_in_world(),
            position_variance_m2: self.measurement.position_variance_m2(config.motion()),
            appearance: self.appearance,
            overlaps_body: self.overlaps_body,
        }
    }
}

/// True if a candidate touches a person or the robot, or lies in their space.
pub(crate) fn is_handled(candidate: &Candidate) -> bool {
    candidate.is_touched() || candidate.findings.is_person_or_robot()
}

/// Candidates for data association: `None` for each that is taken.
pub(crate) fn observed_candidates<'a>(
    measured: &'a [Option<CandidateMeasurement>],
    config: &'a Config,
) -> impl Iterator<Item = Option<ObservedCandidate>> + 'a {
    let observed = |measured: &CandidateMeasurement| measured.observed_candidate(config);
    measured.iter().map(move |one| one.as_ref().map(observed))
}

/// Box around the visible points of a candidate, without its inferred foot. The foot is
/// left out because it vanishes when the object is lifted.
fn visible_box(candidate: &Candidate) -> OrientedBox {
    let whole = &candidate.oriented_box;
    let half_foot_m = (0.5 * candidate.occluded_base_m).min(whole.half_sides_m.z);
    OrientedBox {
        frame_from_box: whole.frame_from_box * Translation3::new(0.0, 0.0, half_foot_m),
        half_sides_m: whole.half_sides_m - Vector3::z() * half_foot_m,
    }
}

/// True if the box was seen to end at the table.
fn stands_on_table(candidate: &Candidate) -> bool {
    candidate.support == Some(Support::Table) && candidate.occluded_base_m == 0.0
}

/// Evenly strided sample of an object's points.
fn sampled<'a>(indices: &'a [u32], cloud: &'a [Point]) -> impl Iterator<Item = &'a Point> + Clone {
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

/// Unit ray from the camera to a candidate, world frame.
fn ray(candidate: &Candidate, world_from_camera: &RigidTransform) -> Unit<Vector3<f64>> {
    let ray_in_camera = candidate.oriented_box.centre().coords;
    let ray = Unit::try_new(world_from_camera.rotation * ray_in_camera, 1e-9);
    ray.unwrap_or_else(|| world_from_camera.rotation * Vector3::z_axis())
}
