//! Which candidate is which track's object.

use crate::Error;
use crate::assignment::{AssignmentBuffers, assign};
use crate::error::check_settings;
use nalgebra::Point3;

/// What an object looks like, coarsely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appearance {
    /// Volume of its box, cubic metres.
    pub volume_m3: f64,
    /// Mean red, green, blue; 0 to 255.
    pub mean_rgb: [f32; 3],
    /// Whether a part of it may be missing; then its size says nothing.
    pub is_cut: bool,
}

/// A track, predicted to the frame's capture stamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Expected centre, world frame.
    pub position: Point3<f64>,
    /// Variance of the expected centre, each axis, square metres.
    pub position_variance_m2: f64,
    /// What its object looked like before.
    pub appearance: Appearance,
}

/// A candidate of the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observed {
    /// Measured centre, world frame.
    pub position: Point3<f64>,
    /// Variance of the measured centre, each axis, square metres.
    pub position_variance_m2: f64,
    /// What it looks like.
    pub appearance: Appearance,
}

/// How much place, size and colour count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssociationConfig {
    /// Greatest squared Mahalanobis distance; 1 to 1000. The default lets 1 %
    /// of true pairs go (chi-squared with three degrees of freedom).
    pub distance2_max: f64,
    /// Cost of a volume e times as large or small; 0 to 100.
    pub volume_weight: f64,
    /// Cost of a colour as different as `color_distance_max`; 0 to 100.
    pub color_weight: f64,
    /// A volume that differs by this factor is another object's; 1.1 to 1000.
    pub volume_ratio_max: f64,
    /// A mean colour this far away is another object's; 1 to 442, the distance
    /// of black and white.
    pub color_distance_max: f64,
}

impl Default for AssociationConfig {
    fn default() -> Self {
        Self {
            distance2_max: 11.34,
            volume_weight: 0.5,
            color_weight: 2.0,
            volume_ratio_max: 4.0,
            color_distance_max: 60.0,
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
            ("color_distance_max", self.color_distance_max, 1.0, 442.0),
        ])?;
        Ok(self)
    }

    /// More than any allowed pair costs.
    fn unassigned_cost(&self) -> f64 {
        let volume = self.volume_weight * self.volume_ratio_max.ln();
        1.0 + self.distance2_max + volume + self.color_weight
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
/// A pair is allowed within the gate of distance and where size and colour do
/// not tell different objects; of the allowed pairs the cheapest assignment is
/// chosen that leaves as little as possible unassigned. Place alone does not
/// make a candidate the track's object: scenes are exchanged under a running
/// camera.
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
    let variance_m2 = track.position_variance_m2 + candidate.position_variance_m2;
    let distance2 = (candidate.position - track.position).norm_squared() / variance_m2;
    let volume = volume_difference(&track.appearance, &candidate.appearance);
    let color =
        color_distance(&track.appearance, &candidate.appearance) / config.color_distance_max;
    let volume_share = volume / config.volume_ratio_max.ln();
    // Written so that whatever is not a number is refused.
    let same = volume_share * volume_share + color * color <= 1.0;
    (distance2 <= config.distance2_max && same)
        .then_some(distance2 + config.volume_weight * volume + config.color_weight * color)
}

/// Absolute logarithm of the ratio of volumes; 0 where one is cut. A cubic
/// centimetre is added to both, so that the noise of thin boxes counts little.
fn volume_difference(a: &Appearance, b: &Appearance) -> f64 {
    if a.is_cut || b.is_cut {
        return 0.0;
    }
    ((a.volume_m3 + 1e-6) / (b.volume_m3 + 1e-6)).ln().abs()
}

fn color_distance(a: &Appearance, b: &Appearance) -> f64 {
    let squares = a
        .mean_rgb
        .iter()
        .zip(b.mean_rgb)
        .map(|(a, b)| f64::from(a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn looking(volume_m3: f64, mean_rgb: [f32; 3]) -> Appearance {
        Appearance {
            volume_m3,
            mean_rgb,
            is_cut: false,
        }
    }

    fn track(x: f64, appearance: Appearance) -> Predicted {
        Predicted {
            position: Point3::new(x, 0.0, 0.0),
            position_variance_m2: 1e-5,
            appearance,
        }
    }

    fn candidate(x: f64, appearance: Appearance) -> Observed {
        Observed {
            position: Point3::new(x, 0.0, 0.0),
            position_variance_m2: 1e-5,
            appearance,
        }
    }

    const RED: [f32; 3] = [200.0, 40.0, 40.0];
    const BLUE: [f32; 3] = [40.0, 40.0, 200.0];

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
            &[candidate(0.0, looking(1.3e-3, [190.0, 50.0, 45.0]))],
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
    fn what_is_not_a_number_belongs_to_nobody() {
        let mug = looking(1e-3, RED);
        for odd in [
            candidate(f64::NAN, mug),
            candidate(0.0, looking(f64::NAN, RED)),
            candidate(0.0, looking(-5.0, RED)),
            candidate(0.0, looking(1e-3, [f32::NAN, 0.0, 0.0])),
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
                let place = |i: usize, column: &Option<usize>| {
                    (tracks[i].position.x.to_bits(), column.map(|c| candidates[c].position.x.to_bits()))
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
