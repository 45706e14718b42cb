//! Which candidate is which track's object.

use crate::Error;
use crate::assignment::{AssignmentBuffers, assign};
use crate::color_histogram::ColorHistogram;
use crate::error::check_settings;
use geometry::OrientedBox;
use nalgebra::{Matrix3, Point3};

/// A part of an object sticks out of its box by this at most, metres.
const PART_MARGIN_M: f64 = 0.012;

/// Steps of a side of a box in which it is looked whether it is a part.
const N_PART_STEPS: usize = 3;

/// They reach so far from its middle: the corners of a box are not filled.
const PART_REACH: f64 = 0.8;

/// Share of a part that lies in the box of the whole.
const PART_SHARE_MIN: f64 = 0.85;

/// Share of a cut candidate's box that lies in that of its object, or of the latter
/// in the former.
const CUT_SHARE_MIN: f64 = 0.5;

/// What lies where a hand is and is larger than the object by more than this is the
/// hand, or both.
const LIMB_VOLUME_RATIO_MAX: f64 = 1.6;

/// What an object looks like, coarsely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appearance {
    /// Volume of its box, cubic metres.
    pub volume_m3: f64,
    /// Its colours.
    pub colors: ColorHistogram,
    /// Whether a part of it may be missing; then its size says nothing.
    pub is_cut: bool,
}

/// A track, predicted to the frame's capture stamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Expected box, world frame.
    pub box_in_world: OrientedBox,
    /// Covariance of its centre, square metres, world axes.
    pub covariance_m2: Matrix3<f64>,
    /// What its object looked like before.
    pub appearance: Appearance,
}

/// A candidate of the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observed {
    /// Measured box, world frame.
    pub box_in_world: OrientedBox,
    /// Variance of the measured centre, each axis, square metres.
    pub position_variance_m2: f64,
    /// What it looks like.
    pub appearance: Appearance,
    /// Whether it lies where a person or the robot is: it may be the object in the
    /// hand, or the hand.
    pub is_limb: bool,
}

/// How much place, size and colour count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssociationConfig {
    /// Greatest squared Mahalanobis distance; 1 to 1000. The default lets 1 %
    /// of true pairs go (chi-squared with three degrees of freedom).
    pub distance2_max: f64,
    /// Cost of a volume e times as large or small; 0 to 100.
    pub volume_weight: f64,
    /// Cost of colours that have nothing in common; 0 to 100.
    pub color_weight: f64,
    /// A volume that differs by this factor is another object's; 1.1 to 1000.
    pub volume_ratio_max: f64,
    /// Colours that are less alike are another object's; 0 to 1, see
    /// [`ColorHistogram::similarity`].
    pub color_similarity_min: f64,
    /// The same for what lies where a person or the robot is.
    pub limb_similarity_min: f64,
    /// Cost of a candidate that lies in the track's box as a part of its object
    /// does, whatever its centre; 0 to 1000.
    pub part_cost: f64,
}

impl Default for AssociationConfig {
    fn default() -> Self {
        Self {
            distance2_max: 11.34,
            volume_weight: 0.5,
            color_weight: 2.0,
            volume_ratio_max: 4.0,
            color_similarity_min: 0.45,
            limb_similarity_min: 0.85,
            part_cost: 9.0,
        }
    }
}

impl AssociationConfig {
    /// Checks the settings.
    ///
    /// # Errors
    /// Names the first setting outside its range.
    pub fn validated(self) -> Result<Self, Error> {
        check_settings(&[
            ("distance2_max", self.distance2_max, 1.0, 1000.0),
            ("volume_weight", self.volume_weight, 0.0, 100.0),
            ("color_weight", self.color_weight, 0.0, 100.0),
            ("volume_ratio_max", self.volume_ratio_max, 1.1, 1000.0),
            ("color_similarity_min", self.color_similarity_min, 0.0, 1.0),
            ("limb_similarity_min", self.limb_similarity_min, 0.0, 1.0),
            ("part_cost", self.part_cost, 0.0, 1000.0),
        ])?;
        Ok(self)
    }

    /// More than any allowed pair costs.
    fn unassigned_cost(&self) -> f64 {
        let volume = self.volume_weight * self.volume_ratio_max.ln();
        1.0 + self.distance2_max.max(self.part_cost) + volume + self.color_weight
    }
}

/// Buffers of [`associate`], reused from frame to frame.
#[derive(Debug, Default)]
pub struct AssociationBuffers {
    costs: Vec<f64>,
    assignment: AssignmentBuffers,
}

/// For each track its candidate, `None` for a track that was not observed.
/// A candidate named for no track is a new object's.
///
/// A pair is allowed within the gate of distance, or where the candidate can be
/// what is left of an object partly hidden, and where size and colour do not tell
/// different objects; of the allowed pairs the cheapest assignment is chosen that
/// leaves as little as possible unassigned. Place alone does not make a candidate
/// the track's object: scenes are exchanged under a running camera.
pub fn associate<'a>(
    tracks: &[Predicted],
    candidates: &[Observed],
    config: &AssociationConfig,
    buffers: &'a mut AssociationBuffers,
) -> &'a [Option<usize>] {
    buffers.costs.clear();
    for track in tracks {
        let pair = |candidate| pair_cost(track, candidate, config).unwrap_or(f64::INFINITY);
        buffers.costs.extend(candidates.iter().map(pair));
        if candidates.is_empty() {
            // A column that nobody can have keeps one row for each track.
            buffers.costs.push(f64::INFINITY);
        }
    }
    let unassigned = config.unassigned_cost();
    assign(
        &buffers.costs,
        candidates.len().max(1),
        unassigned,
        &mut buffers.assignment,
    )
}

/// Cost of taking a candidate for a track's object; `None` where it is not.
fn pair_cost(track: &Predicted, candidate: &Observed, config: &AssociationConfig) -> Option<f64> {
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
        candidate.appearance.volume_m3 > LIMB_VOLUME_RATIO_MAX * track.appearance.volume_m3;
    if candidate.is_limb && (is_swollen || similarity() < config.limb_similarity_min) {
        return None;
    }
    // Most pairs are far apart: no direction is wider than the trace.
    let is_far = between.norm_squared() > config.distance2_max * covariance.trace();
    let distance2 = if is_far {
        f64::INFINITY
    } else {
        (between.transpose() * covariance.try_inverse()? * between).x
    };
    if distance2 <= config.distance2_max && !is_cut_elsewhere(track, candidate) {
        let look = look_cost(&track.appearance, &candidate.appearance, config)?;
        return Some(distance2 + look);
    }
    if share_inside(&candidate.box_in_world, &track.box_in_world) < PART_SHARE_MIN {
        return None;
    }
    let similarity = similarity();
    (similarity >= config.color_similarity_min)
        .then_some(config.part_cost + config.color_weight * (1.0 - similarity))
}

/// Whether a candidate of which a part may be missing lies elsewhere: the place of
/// its centre says little, but what is seen of it lies where the object is.
fn is_cut_elsewhere(track: &Predicted, candidate: &Observed) -> bool {
    let (of_track, of_candidate) = (&track.box_in_world, &candidate.box_in_world);
    candidate.appearance.is_cut
        && share_inside(of_candidate, of_track) < CUT_SHARE_MIN
        && share_inside(of_track, of_candidate) < CUT_SHARE_MIN
}

/// Cost of the difference of size and colour; `None` where they tell different
/// objects. The more colours are alike, the more sizes may differ.
pub fn look_cost(a: &Appearance, b: &Appearance, config: &AssociationConfig) -> Option<f64> {
    let volume = volume_difference(a, b);
    let volume_share = volume / config.volume_ratio_max.ln();
    let unlike = 1.0 - a.colors.similarity(&b.colors);
    let color_share = unlike / (1.0 - config.color_similarity_min).max(1e-6);
    // Written so that whatever is not a number is refused.
    (volume_share * volume_share + color_share * color_share <= 1.0)
        .then_some(config.volume_weight * volume + config.color_weight * unlike)
}

/// Absolute logarithm of the ratio of volumes. What is cut may be a part of the
/// other one, not more than it; where both are, sizes say nothing. A cubic centimetre
/// is added to both, so that the noise of thin boxes counts little.
fn volume_difference(track: &Appearance, candidate: &Appearance) -> f64 {
    let growth = ((candidate.volume_m3 + 1e-6) / (track.volume_m3 + 1e-6)).ln();
    match (track.is_cut, candidate.is_cut) {
        (false, false) => growth.abs(),
        (false, true) => growth.max(0.0),
        (true, false) => (-growth).max(0.0),
        (true, true) => 0.0,
    }
}

/// Share of a box that lies in another one, to the width of a part's margin.
pub fn share_inside(part: &OrientedBox, whole: &OrientedBox) -> f64 {
    // Most boxes are nowhere near each other.
    if !part.may_meet(whole, 2.0 * PART_MARGIN_M) {
        return 0.0;
    }
    let place = |step: usize| PART_REACH * (step as f64 / (N_PART_STEPS - 1) as f64 * 2.0 - 1.0);
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

    fn looking(volume_m3: f64, [red, green, blue]: [u8; 3]) -> Appearance {
        Appearance {
            volume_m3,
            colors: ColorHistogram::of([Rgba::opaque(red, green, blue); 20]),
            is_cut: false,
        }
    }

    fn cube(x: f64, half_side_m: f64) -> OrientedBox {
        OrientedBox {
            frame_from_box: RigidTransform::translation(x, 0.0, 0.0),
            half_sides_m: Vector3::repeat(half_side_m),
        }
    }

    fn track(x: f64, appearance: Appearance) -> Predicted {
        Predicted {
            box_in_world: cube(x, 0.01),
            covariance_m2: Matrix3::identity() * 1e-5,
            appearance,
        }
    }

    fn candidate(x: f64, appearance: Appearance) -> Observed {
        Observed {
            box_in_world: cube(x, 0.01),
            position_variance_m2: 1e-5,
            appearance,
            is_limb: false,
        }
    }

    const RED: [u8; 3] = [200, 40, 40];
    const BLUE: [u8; 3] = [40, 40, 200];

    fn check(tracks: &[Predicted], candidates: &[Observed], expected: &[Option<usize>]) {
        let mut buffers = AssociationBuffers::default();
        let config = AssociationConfig::default().validated().unwrap();
        assert_eq!(
            associate(tracks, candidates, &config, &mut buffers),
            expected
        );
    }

    #[test]
    fn the_near_one_is_taken_and_the_far_one_is_new() {
        let mug = looking(1e-3, RED);
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
    fn two_tracks_share_their_candidates_for_the_good_of_both() {
        // Both are nearest to the first candidate; only one of them can go on.
        let mug = looking(1e-3, RED);
        let tracks = [track(0.0, mug), track(0.008, mug)];
        check(
            &tracks,
            &[candidate(0.006, mug), candidate(-0.009, mug)],
            &[Some(1), Some(0)],
        );
    }

    #[test]
    fn an_exchanged_object_does_not_inherit_the_track() {
        let red_mug = looking(1e-3, RED);
        check(
            &[track(0.0, red_mug)],
            &[candidate(0.0, looking(1e-3, BLUE))],
            &[None],
        );
        check(
            &[track(0.0, red_mug)],
            &[candidate(0.0, looking(8e-3, RED))],
            &[None],
        );
        check(
            &[track(0.0, red_mug)],
            &[candidate(0.0, looking(1.3e-3, [190, 50, 45]))],
            &[Some(0)],
        );
    }

    #[test]
    fn a_cut_object_may_look_smaller() {
        let cut = Appearance {
            is_cut: true,
            ..looking(1e-4, RED)
        };
        check(
            &[track(0.0, looking(1e-3, RED))],
            &[candidate(0.004, cut)],
            &[Some(0)],
        );
    }

    #[test]
    fn what_is_left_of_a_hidden_object_goes_on_with_its_track() {
        let box_of = |x: f64, half_side_m: f64| cube(x, half_side_m);
        let whole = Predicted {
            box_in_world: box_of(0.0, 0.08),
            ..track(0.0, looking(4e-3, RED))
        };
        let part = |x: f64, rgb| Observed {
            box_in_world: box_of(x, 0.02),
            ..candidate(0.0, looking(6e-5, rgb))
        };
        check(&[whole], &[part(0.06, RED)], &[Some(0)]);
        check(&[whole], &[part(0.06, BLUE)], &[None]);
        check(&[whole], &[part(0.10, RED)], &[None]);
    }

    #[test]
    fn what_lies_where_a_hand_is_must_look_like_the_object() {
        let whole = Predicted {
            box_in_world: cube(0.0, 0.04),
            ..track(0.0, looking(5e-4, RED))
        };
        let limb = |x: f64, rgb| Observed {
            box_in_world: cube(x, 0.03),
            is_limb: true,
            ..candidate(0.0, looking(2e-4, rgb))
        };
        check(&[whole], &[limb(0.01, RED)], &[Some(0)]);
        check(&[whole], &[limb(0.01, [180, 130, 100])], &[None]);
    }

    #[test]
    fn what_is_not_a_number_belongs_to_nobody() {
        let mug = looking(1e-3, RED);
        for odd in [
            candidate(f64::NAN, mug),
            candidate(0.0, looking(f64::NAN, RED)),
            candidate(0.0, looking(-5.0, RED)),
            Observed {
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
        fn the_order_of_tracks_and_candidates_does_not_matter(
            (tracks, candidates) in scene(), turn_tracks in 0..6_usize, turn_candidates in 0..6_usize,
        ) {
            let mug = looking(1e-3, RED);
            let config = AssociationConfig::default();
            let mut tracks: Vec<_> = tracks.into_iter().map(|x| track(x, mug)).collect();
            let mut candidates: Vec<_> = candidates.into_iter().map(|x| candidate(x, mug)).collect();
            let pairs = |tracks: &[Predicted], candidates: &[Observed]| {
                let mut buffers = AssociationBuffers::default();
                let found = associate(tracks, candidates, &config, &mut buffers);
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
