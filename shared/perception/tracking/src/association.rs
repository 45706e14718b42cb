//! Data association of tracks and candidates: Mahalanobis gate, appearance cost,
//! assignment.

use crate::Error;
use crate::assignment::{AssignmentBuffers, assign};
use geometry::OrientedBox;
use nalgebra::{Matrix3, Point3};
use point_cloud::ColorHistogram;
use value_range::check_ranges;

/// Tolerance of the containment test, metres. Chosen.
const PART_MARGIN_M: f64 = 0.012;

/// Sample points per side of a box in the containment test. Chosen.
const N_PART_STEPS: usize = 3;

/// Extent of the sample points relative to the half sides; the corners of a box are
/// rarely filled. Chosen.
const PART_SAMPLE_EXTENT: f64 = 0.8;

/// Contained fraction above which a candidate may be the visible part of a track's
/// object. Chosen.
const PART_FRACTION_MIN: f64 = 0.85;

/// Overlap of a truncated candidate with the expected box, or of the expected box with
/// it, that is required for a match. Chosen.
const TRUNCATED_FRACTION_MIN: f64 = 0.5;

/// Volume ratio to the track above which a candidate in the space of a body is the body
/// itself. Chosen.
const BODY_VOLUME_RATIO_MAX: f64 = 1.6;

/// Coarse appearance for data association: volume and colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoarseAppearance {
    /// Volume of the bounding box, cubic metres.
    pub volume_m3: f64,
    /// Colour histogram of the object.
    pub colors: ColorHistogram,
    /// `true` when a part may be missing, so that the volume is only a lower bound.
    pub is_truncated: bool,
}

/// Track predicted to the capture stamp of the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictedTrack {
    /// Expected oriented bounding box of the track, world frame.
    pub box_in_world: OrientedBox,
    /// Covariance of the centre, world axes, square metres.
    pub covariance_m2: Matrix3<f64>,
    /// Remembered appearance of the track.
    pub appearance: CoarseAppearance,
}

/// Candidate observed in the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObservedCandidate {
    /// Measured oriented bounding box of the candidate, world frame.
    pub box_in_world: OrientedBox,
    /// Variance of the measured centre per axis, square metres.
    pub position_variance_m2: f64,
    /// Measured appearance of the candidate.
    pub appearance: CoarseAppearance,
    /// `true` when the candidate lies in the space of a person or the robot: it may be a
    /// held object or the hand.
    pub overlaps_body: bool,
}

/// Gates and weights of the association cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssociationConfig {
    /// Gate on the squared Mahalanobis distance; 1 to 1000. The default rejects 1 % of
    /// true pairs (chi-squared with three degrees of freedom).
    pub distance2_max: f64,
    /// Weight of the absolute logarithm of the volume ratio; 0 to 100.
    pub volume_weight: f64,
    /// Weight of the colour dissimilarity; 0 to 100.
    pub color_weight: f64,
    /// Gate on the volume ratio; 1.1 to 1000.
    pub volume_ratio_max: f64,
    /// Gate on the colour similarity; 0 to 1, see [`ColorHistogram::similarity`].
    pub color_similarity_min: f64,
    /// Gate on the colour similarity of a candidate in the space of a person or the
    /// robot; 0 to 1.
    pub body_similarity_min: f64,
    /// Cost, in place of the squared distance, of a candidate inside the expected box
    /// that may be the visible part of the object; 0 to 1000.
    pub part_cost: f64,
}

impl Default for AssociationConfig {
    /// The chi-squared quantile for the distance; the other values are chosen.
    fn default() -> Self {
        Self {
            distance2_max: 11.34,
            volume_weight: 0.5,
            color_weight: 2.0,
            volume_ratio_max: 4.0,
            color_similarity_min: 0.45,
            body_similarity_min: 0.85,
            part_cost: 9.0,
        }
    }
}

impl AssociationConfig {
    /// Validates the association settings against their ranges.
    ///
    /// # Errors
    /// Names the first setting outside its range.
    pub fn validated(self) -> Result<Self, Error> {
        check_ranges(&[
            ("distance2_max", self.distance2_max, 1.0, 1000.0),
            ("volume_weight", self.volume_weight, 0.0, 100.0),
            ("color_weight", self.color_weight, 0.0, 100.0),
            ("volume_ratio_max", self.volume_ratio_max, 1.1, 1000.0),
            ("color_similarity_min", self.color_similarity_min, 0.0, 1.0),
            ("body_similarity_min", self.body_similarity_min, 0.0, 1.0),
            ("part_cost", self.part_cost, 0.0, 1000.0),
        ])?;
        Ok(self)
    }

    /// Upper bound of the cost of an allowed pair.
    fn unassigned_cost(&self) -> f64 {
        let volume = self.volume_weight * self.volume_ratio_max.ln();
        1.0 + self.distance2_max.max(self.part_cost) + volume + self.color_weight
    }
}

/// Scratch buffers of [`associate`], reused from frame to frame.
#[derive(Debug, Default)]
pub struct AssociationBuffers {
    candidates: Vec<Option<ObservedCandidate>>,
    costs: Vec<f64>,
    assignment: AssignmentBuffers,
}

/// Candidate index of each track, `None` for an unobserved track. A candidate assigned
/// to no track belongs to a new object. Tracks and candidates that are `None` are assigned to
/// nothing.
///
/// A pair is allowed within the Mahalanobis gate if size and colour agree, or if the
/// candidate may be the visible part of the object and the colours agree. Among the allowed pairs the
/// assignment with the fewest unassigned tracks and the least cost is chosen. Position
/// alone is not sufficient: a scene may be exchanged in front of a running camera.
pub fn associate<'a>(
    tracks: impl Iterator<Item = Option<PredictedTrack>>,
    candidates: impl Iterator<Item = Option<ObservedCandidate>>,
    config: &AssociationConfig,
    buffers: &'a mut AssociationBuffers,
) -> &'a [Option<usize>] {
    let AssociationBuffers {
        candidates: columns,
        costs,
        assignment,
    } = buffers;
    columns.clear();
    columns.extend(candidates);
    if columns.is_empty() {
        // A column that cannot be assigned keeps one row for each track.
        columns.push(None);
    }
    costs.clear();
    for track in tracks {
        let cost = |candidate: &Option<ObservedCandidate>| {
            pair_cost(track.as_ref()?, candidate.as_ref()?, config)
        };
        costs.extend(columns.iter().map(|one| cost(one).unwrap_or(f64::INFINITY)));
    }
    assign(costs, columns.len(), config.unassigned_cost(), assignment)
}

/// Cost of a track-candidate pair; `None` outside the gates.
fn pair_cost(
    track: &PredictedTrack,
    candidate: &ObservedCandidate,
    config: &AssociationConfig,
) -> Option<f64> {
    let between = candidate.box_in_world.centre() - track.box_in_world.centre();
    let covariance = track.covariance_m2 + Matrix3::identity() * candidate.position_variance_m2;
    if !covariance.trace().is_finite() {
        return None;
    }
    let similarity = || {
        track
            .appearance
            .colors
            .similarity(&candidate.appearance.colors)
    };
    let is_swollen =
        candidate.appearance.volume_m3 > BODY_VOLUME_RATIO_MAX * track.appearance.volume_m3;
    if candidate.overlaps_body && (is_swollen || similarity() < config.body_similarity_min) {
        return None;
    }
    // Fast rejection: no direction has a larger variance than the trace.
    let is_far = between.norm_squared() > config.distance2_max * covariance.trace();
    let distance2 = if is_far {
        f64::INFINITY
    } else {
        (between.transpose() * covariance.try_inverse()? * between).x
    };
    if distance2 <= config.distance2_max && !is_truncated_elsewhere(track, candidate) {
        let (was, is) = (&track.appearance, &candidate.appearance);
        if let Some(appearance) = appearance_cost(was, is, config) {
            return Some(distance2 + appearance);
        }
        if !(0.0..was.volume_m3).contains(&is.volume_m3) {
            return None;
        }
    }
    if fraction_inside(&candidate.box_in_world, &track.box_in_world) < PART_FRACTION_MIN {
        return None;
    }
    let similarity = similarity();
    (similarity >= config.color_similarity_min)
        .then_some(config.part_cost + config.color_weight * (1.0 - similarity))
}

/// True if a truncated candidate does not overlap the expected box. The centre of a
/// truncated box is unreliable, but its visible part must lie where the object is.
fn is_truncated_elsewhere(track: &PredictedTrack, candidate: &ObservedCandidate) -> bool {
    let (of_track, of_candidate) = (&track.box_in_world, &candidate.box_in_world);
    candidate.appearance.is_truncated
        && fraction_inside(of_candidate, of_track) < TRUNCATED_FRACTION_MIN
        && fraction_inside(of_track, of_candidate) < TRUNCATED_FRACTION_MIN
}

/// Cost of a difference in size and colour; `None` outside the joint gate. The more
/// similar the colours, the more the sizes may differ.
pub fn appearance_cost(
    a: &CoarseAppearance,
    b: &CoarseAppearance,
    config: &AssociationConfig,
) -> Option<f64> {
    let volume = volume_difference(a, b);
    let volume_share = volume / config.volume_ratio_max.ln();
    let unlike = 1.0 - a.colors.similarity(&b.colors);
    let color_share = unlike / (1.0 - config.color_similarity_min).max(1e-6);
    // Written so that NaN is rejected.
    (volume_share * volume_share + color_share * color_share <= 1.0)
        .then_some(config.volume_weight * volume + config.color_weight * unlike)
}

/// Absolute logarithm of the volume ratio. A truncated box may be smaller than the other
/// one, but not larger; if both are truncated, the difference is 0. A cubic centimetre
/// is added to both volumes to damp the noise of thin boxes.
fn volume_difference(track: &CoarseAppearance, candidate: &CoarseAppearance) -> f64 {
    let growth = ((candidate.volume_m3 + 1e-6) / (track.volume_m3 + 1e-6)).ln();
    match (track.is_truncated, candidate.is_truncated) {
        (false, false) => growth.abs(),
        (false, true) => growth.max(0.0),
        (true, false) => (-growth).max(0.0),
        (true, true) => 0.0,
    }
}

/// Fraction of sample points of a box inside another one, with a tolerance of 12 mm.
pub fn fraction_inside(part: &OrientedBox, whole: &OrientedBox) -> f64 {
    // Most boxes are far apart.
    if !part.bounding_spheres_meet(whole, 2.0 * PART_MARGIN_M) {
        return 0.0;
    }
    let place =
        |step: usize| PART_SAMPLE_EXTENT * (step as f64 / (N_PART_STEPS - 1) as f64 * 2.0 - 1.0);
    let mut n_inside = 0_usize;
    for i in 0..N_PART_STEPS.pow(3) {
        let [x, y, z] =
            [i, i / N_PART_STEPS, i / N_PART_STEPS.pow(2)].map(|i| place(i % N_PART_STEPS));
        let half = part.half_sides_m;
        let corner = Point3::new(x * half.x, y * half.y, z * half.z);
        let point = part.frame_from_box * corner;
        n_inside += usize::from(whole.contains(&point, PART_MARGIN_M));
    }
    n_inside as f64 / N_PART_STEPS.pow(3) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::RigidTransform;
    use nalgebra::Vector3;
    use point_cloud::Rgba;
    use proptest::prelude::*;

    fn appearance(volume_m3: f64, [red, green, blue]: [u8; 3]) -> CoarseAppearance {
        CoarseAppearance {
            volume_m3,
            colors: ColorHistogram::from_colors([Rgba::opaque(red, green, blue); 20]),
            is_truncated: false,
        }
    }

    fn cube(x: f64, half_side_m: f64) -> OrientedBox {
        OrientedBox {
            frame_from_box: RigidTransform::translation(x, 0.0, 0.0),
            half_sides_m: Vector3::repeat(half_side_m),
        }
    }

    fn track(x: f64, appearance: CoarseAppearance) -> PredictedTrack {
        PredictedTrack {
            box_in_world: cube(x, 0.01),
            covariance_m2: Matrix3::identity() * 1e-5,
            appearance,
        }
    }

    fn candidate(x: f64, appearance: CoarseAppearance) -> ObservedCandidate {
        ObservedCandidate {
            box_in_world: cube(x, 0.01),
            position_variance_m2: 1e-5,
            appearance,
            overlaps_body: false,
        }
    }

    const RED: [u8; 3] = [200, 40, 40];
    const BLUE: [u8; 3] = [40, 40, 200];

    fn check(
        tracks: &[PredictedTrack],
        candidates: &[ObservedCandidate],
        expected: &[Option<usize>],
    ) {
        let mut buffers = AssociationBuffers::default();
        let config = AssociationConfig::default().validated().unwrap();
        let (some_tracks, some_candidates) = (
            tracks.iter().copied().map(Some),
            candidates.iter().copied().map(Some),
        );
        let found = associate(some_tracks, some_candidates, &config, &mut buffers);
        assert_eq!(found, expected);
    }

    #[test]
    fn association_prefers_the_nearest_candidate_within_the_gate() {
        let mug = appearance(1e-3, RED);
        check(
            &[track(0.0, mug)],
            &[candidate(0.5, mug), candidate(0.005, mug)],
            &[Some(1)],
        );
        check(&[track(0.0, mug)], &[candidate(0.5, mug)], &[None]);
        check(&[track(0.0, mug)], &[], &[None]);
        check(&[], &[candidate(0.5, mug)], &[]);
    }

    #[test]
    fn association_minimises_the_total_cost() {
        // Both are nearest to the first candidate; only one of them can be assigned to
        // it.
        let mug = appearance(1e-3, RED);
        let tracks = [track(0.0, mug), track(0.008, mug)];
        check(
            &tracks,
            &[candidate(0.006, mug), candidate(-0.009, mug)],
            &[Some(1), Some(0)],
        );
    }

    #[test]
    fn association_rejects_an_exchanged_object() {
        let red_mug = appearance(1e-3, RED);
        check(
            &[track(0.0, red_mug)],
            &[candidate(0.0, appearance(1e-3, BLUE))],
            &[None],
        );
        check(
            &[track(0.0, red_mug)],
            &[candidate(0.0, appearance(8e-3, RED))],
            &[None],
        );
        check(
            &[track(0.0, red_mug)],
            &[candidate(0.0, appearance(1.3e-3, [190, 50, 45]))],
            &[Some(0)],
        );
    }

    #[test]
    fn association_accepts_a_smaller_truncated_candidate() {
        let cut = CoarseAppearance {
            is_truncated: true,
            ..appearance(1e-4, RED)
        };
        check(
            &[track(0.0, appearance(1e-3, RED))],
            &[candidate(0.004, cut)],
            &[Some(0)],
        );
    }

    #[test]
    fn association_accepts_the_visible_part_of_an_occluded_object() {
        let box_of = |x: f64, half_side_m: f64| cube(x, half_side_m);
        let whole = PredictedTrack {
            box_in_world: box_of(0.0, 0.08),
            ..track(0.0, appearance(4e-3, RED))
        };
        let part = |x: f64, rgb| ObservedCandidate {
            box_in_world: box_of(x, 0.02),
            ..candidate(0.0, appearance(6e-5, rgb))
        };
        check(&[whole], &[part(0.06, RED)], &[Some(0)]);
        check(&[whole], &[part(0.06, BLUE)], &[None]);
        check(&[whole], &[part(0.10, RED)], &[None]);
        // The gate of an object that was out of view is wide enough for any part of it.
        let unseen = PredictedTrack {
            covariance_m2: Matrix3::identity() * 1.6e-3,
            ..whole
        };
        check(&[unseen], &[part(0.04, RED)], &[Some(0)]);
        check(&[unseen], &[part(0.04, BLUE)], &[None]);
    }

    #[test]
    fn association_in_the_space_of_a_body_requires_similar_colours() {
        let whole = PredictedTrack {
            box_in_world: cube(0.0, 0.04),
            ..track(0.0, appearance(5e-4, RED))
        };
        let limb = |x: f64, rgb| ObservedCandidate {
            box_in_world: cube(x, 0.03),
            overlaps_body: true,
            ..candidate(0.0, appearance(2e-4, rgb))
        };
        check(&[whole], &[limb(0.01, RED)], &[Some(0)]);
        check(&[whole], &[limb(0.01, [180, 130, 100])], &[None]);
    }

    #[test]
    fn association_rejects_nan() {
        let mug = appearance(1e-3, RED);
        for odd in [
            candidate(f64::NAN, mug),
            candidate(0.0, appearance(f64::NAN, RED)),
            candidate(0.0, appearance(-5.0, RED)),
            ObservedCandidate {
                position_variance_m2: f64::NAN,
                ..candidate(0.0, mug)
            },
        ] {
            check(&[track(0.0, mug)], &[odd], &[None]);
        }
    }

    #[test]
    fn settings_out_of_range_are_refused() {
        let bad = AssociationConfig {
            color_weight: f64::NAN,
            ..AssociationConfig::default()
        };
        assert!(
            bad.validated()
                .unwrap_err()
                .to_string()
                .contains("color_weight")
        );
    }

    fn scene() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
        let places = || prop::collection::vec(0.0..0.03_f64, 1..6);
        (places(), places())
    }

    proptest! {
        #[test]
        fn association_ignores_tracks_and_candidates_that_are_none(
            (tracks, candidates) in scene(), gaps in prop::array::uniform12(prop::bool::ANY),
        ) {
            let mug = appearance(1e-3, RED);
            let config = AssociationConfig::default();
            let with_gaps = |n: usize, gaps: &[bool]| {
                let slots = (0..n).zip(gaps).flat_map(|(i, is_gap)| {
                    is_gap.then_some(None).into_iter().chain([Some(i)])
                });
                slots.collect::<Vec<Option<usize>>>()
            };
            let rows = with_gaps(tracks.len(), &gaps[..6]);
            let columns = with_gaps(candidates.len(), &gaps[6..]);
            let track = |i: usize| track(tracks[i], mug);
            let candidate = |i: usize| candidate(candidates[i], mug);
            let mut buffers = AssociationBuffers::default();
            let all = (0..tracks.len()).map(|i| Some(track(i)));
            let dense = (0..candidates.len()).map(|i| Some(candidate(i)));
            let expected = associate(all, dense, &config, &mut buffers).to_vec();
            let some_tracks = rows.iter().map(|one| one.map(track));
            let some_candidates = columns.iter().map(|one| one.map(candidate));
            let found = associate(some_tracks, some_candidates, &config, &mut buffers);
            for (row, column) in rows.iter().zip(found) {
                let column = column.map(|column| columns[column].unwrap());
                prop_assert_eq!(column, row.and_then(|row| expected[row]));
            }
        }

        #[test]
        fn the_order_of_tracks_and_candidates_does_not_matter(
            (tracks, candidates) in scene(), turn_tracks in 0..6_usize, turn_candidates in 0..6_usize,
        ) {
            let mug = appearance(1e-3, RED);
            let config = AssociationConfig::default();
            let mut tracks: Vec<_> = tracks.into_iter().map(|x| track(x, mug)).collect();
            let mut candidates: Vec<_> = candidates.into_iter().map(|x| candidate(x, mug)).collect();
            let pairs = |tracks: &[PredictedTrack], candidates: &[ObservedCandidate]| {
                let mut buffers = AssociationBuffers::default();
                let found = associate(
                    tracks.iter().copied().map(Some),
                    candidates.iter().copied().map(Some),
                    &config,
                    &mut buffers,
                );
                let x = |shape: &OrientedBox| shape.centre().x.to_bits();
                let place = |i: usize, column: &Option<usize>| {
                    (x(&tracks[i].box_in_world), column.map(|c| x(&candidates[c].box_in_world)))
                };
                let mut pairs: Vec<_> = found.iter().enumerate().map(|(i, c)| place(i, c)).collect();
                pairs.sort_unstable();
                pairs
            };
            let before = pairs(&tracks, &candidates);
            let (n_tracks, n_candidates) = (tracks.len(), candidates.len());
            tracks.rotate_left(turn_tracks % n_tracks);
            candidates.rotate_left(turn_candidates % n_candidates);
            candidates.reverse();
            prop_assert_eq!(before, pairs(&tracks, &candidates));
        }
    }
}
