//! Constraint evaluator: findings and verdict of one hypothesis.

use super::BodyMask;
use super::box_iou::iou;
use crate::RawConfig;
use crate::candidate::{Candidate, Support};
use crate::cluster_hypothesis::ClusterHypothesis;
use crate::input::ScenePriors;
use crate::reaching_bodies::ReachingBodies;
use crate::samples::Samples;
use crate::table::Table;
use constraint::{Constraint, ConstraintSet, Expression, Finding, Findings, Reason, Ternary};
use geometry::OrientedBox;
use point_cloud::OrganizedCloud;
use std::ops::Range;

/// Growth factor of a track's box in the containment test. Chosen.
const TRACK_GROWTH: f64 = 1.15;

/// Least share of a cluster's points near a body at which the cluster is a part of it.
/// Chosen.
const BODY_SHARE: f32 = 0.5;

/// Least share of a cluster's points near a body at which the cluster may be a part of it.
/// Chosen.
const BODY_SHARE_MAYBE: f32 = 0.1;

/// Increase of the body margins in the contact test, metres: points within the margins were
/// masked. Chosen.
const TOUCH_M: f64 = 0.02;

/// Least share of a cluster's points within the increased margins of a contact. Chosen.
const TOUCH_SHARE: f32 = 0.05;

/// Tolerance of a hypothesis's box around its points, metres.
const BOX_TOLERANCE_M: f64 = 0.02;

/// Greatest number of sampled points of a cluster.
const N_SAMPLES: usize = 256;

/// Greatest distance beyond the rim at which a point may still be on the table, metres: the
/// visible rim is found to about half a cell. Chosen.
const RIM_TOLERANCE_M: f64 = 0.01;

/// Constraint evaluator: the scene against which hypotheses are evaluated.
pub(crate) struct ConstraintEvaluator<'a> {
    pub(crate) cloud: OrganizedCloud<'a>,
    /// Surface of the hypotheses, with its index among those of the frame.
    pub(crate) surface: (usize, &'a Table),
    pub(crate) priors: ScenePriors<'a>,
    pub(crate) body_mask: &'a BodyMask,
    /// Bodies found in depth, with the image they were found in; `None` without any.
    pub(crate) depth_bodies: Option<(&'a ReachingBodies, &'a Samples)>,
    pub(crate) config: &'a RawConfig,
}

fn finding(truth: impl Into<Ternary>, reason: Reason) -> Finding {
    Finding {
        value: truth.into(),
        reason,
    }
}

impl ConstraintEvaluator<'_> {
    /// Candidate of a hypothesis, with its findings and the verdict of the rule.
    ///
    /// `range` locates its points among those of the detection and `indices` in the cloud;
    /// `is_cut` tells that the image border may cut it.
    pub(crate) fn candidate(
        &self,
        hypothesis: &ClusterHypothesis,
        range: Range<usize>,
        indices: &[u32],
        is_cut: bool,
        rule: &Expression,
    ) -> Candidate {
        let oriented_box = hypothesis
            .upright_box
            .in_camera(&self.surface.1.table_from_camera);
        let findings = self.findings(hypothesis, &oriented_box, indices, is_cut);
        let (verdict, decisive) = if hypothesis.is_object_sized {
            (rule.evaluate(&findings), rule.decisive(&findings))
        } else {
            (Ternary::False, ConstraintSet::from(Constraint::Size))
        };
        Candidate {
            range,
            surface: self.surface.0,
            centroid: hypothesis.statistics.centroid,
            oriented_box,
            occluded_base_m: hypothesis.occluded_base_m(),
            mean_rgb: hypothesis.statistics.mean_rgb,
            support: hypothesis.support,
            touches_image_border: is_cut,
            is_object_sized: hypothesis.is_object_sized,
            findings,
            verdict,
            decisive,
        }
    }

    /// Findings of all constraints for a hypothesis with these pixels and its box in the
    /// camera frame.
    fn findings(
        &self,
        hypothesis: &ClusterHypothesis,
        hypothesis_box: &OrientedBox,
        pixels: &[u32],
        is_cut: bool,
    ) -> Findings {
        let mut findings = Findings::default();
        findings.set(Constraint::Table, table_finding(hypothesis));
        findings.set(
            Constraint::Track,
            self.track_finding(hypothesis_box, pixels),
        );
        findings.set(Constraint::Size, self.size_finding(hypothesis, is_cut));
        let [person, robot] = self.person_and_robot(hypothesis, pixels);
        findings.set(Constraint::Instructor, person);
        findings.set(Constraint::Robot, robot);
        findings.set(
            Constraint::Edge,
            self.rim_finding(hypothesis_box, pixels, is_cut),
        );
        findings.set(Constraint::KeyView, Constraint::KeyView.default_finding());
        let border = if is_cut {
            Reason::AtImageBorder
        } else {
            Reason::WithinView
        };
        findings.set(Constraint::ImageBorder, finding(is_cut, border));
        findings
    }

    fn track_finding(&self, hypothesis_box: &OrientedBox, pixels: &[u32]) -> Finding {
        let tracks = self.priors.tracks;
        if tracks.is_empty() {
            return Constraint::Track.default_finding();
        }
        let overlaps = tracks
            .iter()
            .map(|track| iou(hypothesis_box, &track.oriented_box));
        let greatest = overlaps.fold(0.0, f64::max);
        if greatest >= self.config.track_overlap_max {
            let overlap = greatest as f32;
            return finding(false, Reason::OverlapsTrack { overlap });
        }
        let share = self.share_in_tracks(hypothesis_box, pixels);
        if f64::from(share) >= self.config.track_points_share_max {
            return finding(false, Reason::InsideTrack { share });
        }
        let overlap = greatest as f32;
        finding(true, Reason::NoOverlappingTrack { overlap })
    }

    fn size_finding(&self, hypothesis: &ClusterHypothesis, is_cut: bool) -> Finding {
        let config = self.config;
        let mut sides = hypothesis.upright_box.sides_m();
        sides.sort_by(|a, b| b.total_cmp(a));
        let volume_m3 = sides.iter().product::<f64>();
        let [longest, second] = [sides[0], sides[1]].map(|side| side as f32);
        // Beyond object size, the reason names the object limit instead of the grasp limit.
        let longest_max = if sides[0] > config.side_max_m {
            config.side_max_m
        } else {
            config.graspable_side_max_m
        };
        let reason = if sides[0] > longest_max {
            Reason::TooLong {
                side_m: longest,
                max_m: longest_max as f32,
            }
        } else if sides[1] > config.graspable_second_side_max_m {
            Reason::TooBroad {
                side_m: second,
                max_m: config.graspable_second_side_max_m as f32,
            }
        } else if volume_m3 > config.graspable_volume_max_m3 {
            Reason::TooBulky {
                volume_m3: volume_m3 as f32,
                max_m3: config.graspable_volume_max_m3 as f32,
            }
        } else if is_cut {
            return finding(Ternary::Unknown, Reason::SizeTruncated { side_m: longest });
        } else if sides[0] < config.side_min_m {
            Reason::TooSmall {
                side_m: longest,
                min_m: config.side_min_m as f32,
            }
        } else {
            return finding(true, Reason::Graspable { side_m: longest });
        };
        finding(false, reason)
    }

    /// Person and robot findings of a hypothesis.
    fn person_and_robot(&self, hypothesis: &ClusterHypothesis, pixels: &[u32]) -> [Finding; 2] {
        // Object clusters have no point within the margins, because those were masked. The
        // remaining points of a held object are close to the margins.
        let extra_margin_m = if hypothesis.is_masked { 0.0 } else { TOUCH_M };
        let shares = if self.body_mask.is_empty() {
            [0.0; 2]
        } else {
            let points = samples(pixels).map(|&pixel| &self.cloud.points()[pixel as usize]);
            self.body_mask.shares(&points, extra_margin_m)
        };
        let is_known = [
            self.priors.instructor.is_some(),
            self.priors.robot.is_some(),
        ];
        let margins_m = [self.config.person_margin_m, self.config.robot_margin_m];
        std::array::from_fn(|i| {
            let constraint = [Constraint::Instructor, Constraint::Robot][i];
            let is_robot = hypothesis.is_masked && shares[1] >= BODY_SHARE_MAYBE;
            if i == 0
                && !is_robot
                && let Some((bodies, image)) = self.depth_bodies
            {
                return self.depth_body_finding(hypothesis, pixels, bodies, image);
            }
            if !is_known[i] {
                return constraint.default_finding();
            }
            let margin_m = (margins_m[i] + extra_margin_m) as f32;
            if hypothesis.is_masked {
                mask_finding(constraint, shares[i], margin_m)
            } else {
                touch_finding(constraint, shares[i], margin_m)
            }
        })
    }

    /// Person finding of a hypothesis from the bodies found in depth.
    fn depth_body_finding(
        &self,
        hypothesis: &ClusterHypothesis,
        pixels: &[u32],
        bodies: &ReachingBodies,
        image: &Samples,
    ) -> Finding {
        if hypothesis.is_masked {
            return finding(true, Reason::ReachesOverTable);
        }
        let share = bodies.share_near(samples(pixels), &self.cloud, image, TOUCH_M);
        touch_finding(Constraint::Instructor, share, TOUCH_M as f32)
    }

    /// Share of a cluster's sampled points inside grown track boxes.
    fn share_in_tracks(&self, hypothesis_box: &OrientedBox, pixels: &[u32]) -> f32 {
        let mut is_inside = [false; N_SAMPLES];
        let near =
            |track: &&OrientedBox| track.bounding_spheres_meet(hypothesis_box, BOX_TOLERANCE_M);
        let tracks = self.priors.tracks.iter();
        let grown = tracks.map(|track| grown(&track.oriented_box));
        for track in grown.filter(|track| near(&track)) {
            for (is_inside, &pixel) in is_inside.iter_mut().zip(samples(pixels)) {
                let point = self.cloud.points()[pixel as usize].position();
                *is_inside = *is_inside || track.contains(&point, 0.0);
            }
        }
        let n_inside = is_inside.into_iter().filter(|&is_inside| is_inside).count();
        n_inside as f32 / samples(pixels).count().max(1) as f32
    }

    /// Rim finding: beyond, near or away from the visible rim; unknown near a border of the
    /// table that is hidden or outside of the view.
    fn rim_finding(&self, hypothesis_box: &OrientedBox, pixels: &[u32], is_cut: bool) -> Finding {
        let near_m = self.config.rim_distance_m;
        let centre = self.surface.1.table_from_camera * hypothesis_box.centre();
        let outline = &self.surface.1.outline;
        if !is_cut && outline.contains_disc(&centre.xy(), reach_m(hypothesis_box) + near_m) {
            return finding(false, Reason::AwayFromRim);
        }
        let (mut n, mut n_beyond, mut n_near, mut n_unseen) = (0_u32, 0_u32, 0_u32, 0_u32);
        for &pixel in samples(pixels) {
            let point = self.cloud.points()[pixel as usize].position();
            let place = (self.surface.1.table_from_camera * point).xy();
            let [rim_m, unseen_m] = outline.border_distances_m(&place);
            n += 1;
            n_beyond += u32::from(rim_m < -RIM_TOLERANCE_M);
            n_near += u32::from(rim_m < near_m);
            n_unseen += u32::from(unseen_m < near_m);
        }
        let shares = [n_beyond, n_near, n_unseen].map(|part| part as f32 / n.max(1) as f32);
        let distance_m = near_m as f32;
        let [is_beyond, is_near, is_unseen] =
            shares.map(|share| f64::from(share) > self.config.rim_share_max);
        let [beyond, near, unseen] = shares;
        if is_beyond {
            finding(true, Reason::BeyondRim { share: beyond })
        } else if is_near {
            let share = near;
            finding(true, Reason::AtRim { share, distance_m })
        } else if is_unseen || is_cut {
            let share = unseen;
            finding(Ternary::Unknown, Reason::RimUnseen { share, distance_m })
        } else {
            finding(false, Reason::AwayFromRim)
        }
    }
}

fn table_finding(hypothesis: &ClusterHypothesis) -> Finding {
    match hypothesis.support {
        Some(Support::Table) => finding(true, Reason::StandsOnTable),
        Some(Support::Object) => finding(true, Reason::RestsOnObject),
        Some(Support::Occluded) if hypothesis.is_base_without_depth => {
            finding(true, Reason::BaseWithoutDepth)
        }
        Some(Support::Occluded) => finding(true, Reason::BaseOccluded),
        None if hypothesis.off_table_share > 0.0 => {
            let share = hypothesis.off_table_share;
            finding(false, Reason::BeginsOffTable { share })
        }
        None if hypothesis.is_base_without_depth => {
            finding(Ternary::Unknown, Reason::BaseWithoutDepth)
        }
        None => {
            let gap_m = hypothesis.statistics.height_m[0];
            finding(false, Reason::Unsupported { gap_m })
        }
    }
}

/// Finding of a masked cluster from its share of points near the body.
fn mask_finding(constraint: Constraint, share: f32, margin_m: f32) -> Finding {
    let is_robot = constraint == Constraint::Robot;
    let truth = if share >= BODY_SHARE {
        Ternary::True
    } else if share >= BODY_SHARE_MAYBE {
        Ternary::Unknown
    } else {
        Ternary::False
    };
    let reason = match (truth, is_robot) {
        (Ternary::True, false) => Reason::Person { share, margin_m },
        (Ternary::True, true) => Reason::Robot { share, margin_m },
        (Ternary::Unknown, false) => Reason::MaybePerson { share, margin_m },
        (Ternary::Unknown, true) => Reason::MaybeRobot { share, margin_m },
        (Ternary::False, false) => Reason::NotPerson,
        (Ternary::False, true) => Reason::NotRobot,
    };
    finding(truth, reason)
}

/// Contact finding of an object cluster from its share of points near the body.
fn touch_finding(constraint: Constraint, share: f32, margin_m: f32) -> Finding {
    match (share >= TOUCH_SHARE, constraint == Constraint::Robot) {
        (true, false) => finding(
            Ternary::Unknown,
            Reason::TouchedByPerson { share, margin_m },
        ),
        (true, true) => finding(Ternary::Unknown, Reason::TouchedByRobot { share, margin_m }),
        (false, false) => finding(false, Reason::NotPerson),
        (false, true) => finding(false, Reason::NotRobot),
    }
}

/// Radius of a hypothesis's box around its centre, metres.
fn reach_m(hypothesis_box: &OrientedBox) -> f64 {
    hypothesis_box.half_sides_m.norm() + BOX_TOLERANCE_M
}

/// At most [`N_SAMPLES`] pixels of a cluster, evenly strided.
fn samples(pixels: &[u32]) -> impl Iterator<Item = &u32> + Clone {
    pixels
        .iter()
        .step_by(pixels.len().div_ceil(N_SAMPLES).max(1))
}

fn grown(track: &OrientedBox) -> OrientedBox {
    OrientedBox {
        half_sides_m: TRACK_GROWTH * track.half_sides_m,
        ..*track
    }
}
