//! Track-guided regrouping: splits clusters of touching tracked objects and merges
//! fragments of one.

use super::{Clusters, NO_CLUSTER};
use crate::input::ExpectedTrack;
use nalgebra::{Point3, Vector3};
use point_cloud::{OrganizedCloud, Point};

/// Tolerance around a track's predicted box, metres. Chosen.
const MARGIN_M: f64 = 0.008;

/// Sampling stride over the points of a cluster.
const STRIDE: usize = 8;

/// Greatest number of sampled points in the fragment test.
const N_SAMPLED_MAX: usize = 64;

/// Number of first sampled points after which the fragment test stops if none is inside the
/// box.
const N_SAMPLED_FIRST: usize = 4;

/// Least share of a track's last points in a cluster that the track claims. Chosen.
const CLAIM_SHARE: f64 = 0.35;

/// Least number of points in a cluster that a handled track claims: a hand may hide any share of
/// its object. Chosen.
const N_HANDLED_CLAIM: f64 = 48.0;

/// As [`COMMON_SHARE_MAX`], of a handled track: its box is predicted less well, and what it
/// touches is moved, too. Chosen.
const HANDLED_COMMON_SHARE_MAX: f64 = 0.6;

/// Greatest share of a box's points that other boxes claim; above it, two tracks see one
/// object. Chosen.
const COMMON_SHARE_MAX: f64 = 0.3;

/// Greatest distance of an object's point from the claiming boxes, metres; farther points are
/// another object. Chosen.
pub(crate) const OBJECT_REACH_M: f64 = 0.03;

/// As [`OBJECT_REACH_M`], in a cluster of a person or the robot: beyond the tolerance of the boxes
/// the points are the body's.
pub(crate) const BODY_REACH_M: f64 = MARGIN_M;

/// Claim of a track on a cluster.
#[derive(Debug, Clone, Copy)]
struct TrackClaim {
    track: usize,
    /// Number of sampled points inside the box.
    n_inside: usize,
    /// Number of sampled points inside the box and nearest to it.
    n_best: usize,
}

impl TrackClaim {
    /// True if enough of the track's object is in the cluster, and most of it in no other box.
    fn is_valid(&self, track: &ExpectedTrack) -> bool {
        let (n_points_min, common_share_max) = if track.is_handled {
            (N_HANDLED_CLAIM, HANDLED_COMMON_SHARE_MAX)
        } else {
            (CLAIM_SHARE * track.n_points as f64, COMMON_SHARE_MAX)
        };
        (self.n_best * STRIDE) as f64 >= n_points_min
            && self.n_best as f64 >= (1.0 - common_share_max) * self.n_inside as f64
    }
}

/// Claims of several tracks on one cluster.
#[derive(Debug, Default)]
pub(crate) struct TrackClaims {
    near: Vec<TrackClaim>,
}

impl TrackClaims {
    /// Find the tracks that claim a cluster; with fewer than two the cluster stays whole.
    fn find(&mut self, points: &[Point], pixels: &[u32], tracks: &[ExpectedTrack]) {
        let (low, high) = bounds(points, pixels);
        self.near.clear();
        let near = tracks.iter().enumerate().filter(|(_, track)| {
            let centre = track.oriented_box.centre();
            let reach = track.oriented_box.half_sides_m.norm() + MARGIN_M;
            track.n_points > 0
                && (0..3).all(|i| (low[i] - reach..=high[i] + reach).contains(&centre[i]))
        });
        self.near.extend(near.map(|(track, _)| TrackClaim {
            track,
            n_inside: 0,
            n_best: 0,
        }));
        if self.near.len() < 2 {
            return;
        }
        self.count_points(points, pixels, tracks);
        self.near
            .retain(|claim| claim.is_valid(&tracks[claim.track]));
    }

    fn count_points(&mut self, points: &[Point], pixels: &[u32], tracks: &[ExpectedTrack]) {
        for &pixel in pixels.iter().step_by(STRIDE) {
            let point = points[pixel as usize].position();
            let mut best: Option<(usize, f64)> = None;
            for (i, claim) in self.near.iter_mut().enumerate() {
                let distance_outside_m = distance_outside_m(&tracks[claim.track], &point);
                if distance_outside_m <= MARGIN_M {
                    claim.n_inside += 1;
                    if best.is_none_or(|(_, least)| distance_outside_m < least) {
                        best = Some((i, distance_outside_m));
                    }
                }
            }
            if let Some((i, _)) = best {
                self.near[i].n_best += 1;
            }
        }
    }
}

impl Clusters {
    /// Split clusters claimed by two or more tracks. Each point goes to its nearest box,
    /// and points farther than `reach_m` from all boxes form a cluster of their own.
    ///
    /// Boxes are in the camera frame.
    pub(crate) fn split_by_tracks(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        tracks: &[ExpectedTrack],
        reach_m: f64,
        claims: &mut TrackClaims,
    ) {
        if tracks.len() < 2 {
            return;
        }
        let n_before = self.len();
        let mut n_clusters = n_before as u32;
        for cluster in 0..n_before {
            claims.find(cloud.points(), self.pixels(cluster), tracks);
            if claims.near.len() < 2 {
                continue;
            }
            let [first, end] = [self.starts[cluster], self.starts[cluster + 1]];
            for place in first as usize..end as usize {
                let pixel = self.pixels[place] as usize;
                let point = cloud.points()[pixel].position();
                let part = claims.nearest_claim(tracks, &point, reach_m);
                if part > 0 {
                    self.cluster_of[pixel] = n_clusters + part as u32 - 1;
                }
            }
            n_clusters += claims.near.len() as u32;
        }
        if n_clusters as usize > n_before {
            self.rebuild_groups(n_clusters as usize);
        }
    }

    /// Sort the pixels again by the labels in `cluster_of`.
    pub(super) fn rebuild_groups(&mut self, n_clusters: usize) {
        self.starts.clear();
        self.starts.resize(n_clusters + 1, 0);
        for &pixel in &self.ungrouped {
            let cluster = self.cluster_of[pixel as usize];
            if cluster != NO_CLUSTER {
                self.starts[cluster as usize + 1] += 1;
            }
        }
        for i in 0..n_clusters {
            self.starts[i + 1] += self.starts[i];
        }
        self.pixels.resize(self.starts[n_clusters] as usize, 0);
        self.number_of.clear();
        self.number_of.extend_from_slice(&self.starts);
        for &pixel in &self.ungrouped {
            let cluster = self.cluster_of[pixel as usize];
            if cluster != NO_CLUSTER {
                let place = &mut self.number_of[cluster as usize];
                self.pixels[*place as usize] = pixel;
                *place += 1;
            }
        }
    }
}

impl TrackClaims {
    /// Index of the claim nearest to a point; the number of claims when none is near.
    fn nearest_claim(&self, tracks: &[ExpectedTrack], point: &Point3<f64>, reach_m: f64) -> usize {
        let outside = |claim: &TrackClaim| distance_outside_m(&tracks[claim.track], point);
        let best = (0..self.near.len())
            .map(|i| (i, outside(&self.near[i])))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match best {
            Some((i, distance_outside_m)) if distance_outside_m <= reach_m => i,
            _ => self.near.len(),
        }
    }
}

/// Signed Chebyshev distance of a point to the track's upright box, metres: the largest excess
/// over the box's axes; negative inside. Between the heights of its top and its base only the
/// horizontal axes count: things that touch stand side by side, and the faces that they share are
/// upright.
fn distance_outside_m(track: &ExpectedTrack, point: &Point3<f64>) -> f64 {
    let place = track
        .oriented_box
        .frame_from_box
        .inverse_transform_point(point);
    let beyond = |i: usize| place[i].abs() - track.oriented_box.half_sides_m[i];
    let (horizontal_m, vertical_m) = (beyond(0).max(beyond(1)), beyond(2));
    if vertical_m <= 0.0 {
        horizontal_m
    } else {
        horizontal_m.max(vertical_m)
    }
}

/// Least share of a cluster inside a track's box at which the cluster belongs to the track.
/// Chosen.
const PART_SHARE: f64 = 0.85;

/// Least share of a track's last points in its main cluster. Chosen.
const MAIN_SHARE: f64 = 0.4;

/// Greatest share of a track's last points in a fragment, such as the handle of a mug seen
/// end on. A larger cluster is another object, such as an apple in a bowl. Chosen.
const FRAGMENT_SHARE: f64 = 0.15;

impl Clusters {
    /// Merge fragments of tracked objects into their main clusters, unless they are tracked
    /// themselves.
    ///
    /// Boxes are in the camera frame.
    pub(crate) fn merge_by_tracks(&mut self, cloud: &OrganizedCloud<'_>, tracks: &[ExpectedTrack]) {
        let mut is_joined = false;
        for (i, track) in tracks.iter().enumerate() {
            let fits = |pixels: &[u32], share: f64| {
                let n = pixels.len() as f64 / track.n_points.max(1) as f64;
                n >= share && share_inside(cloud.points(), pixels, track) >= PART_SHARE
            };
            let main = (0..self.len()).find(|cluster| fits(self.pixels(*cluster), MAIN_SHARE));
            let Some(main) = main.filter(|_| track.n_points > 0) else {
                continue;
            };
            for cluster in 0..self.len() {
                let [first, end] = [self.starts[cluster], self.starts[cluster + 1]];
                let pixels = &self.pixels[first as usize..end as usize];
                let is_fragment = pixels.len() as f64 <= FRAGMENT_SHARE * track.n_points as f64;
                let others = tracks.iter().enumerate().filter(|(other, _)| *other != i);
                if is_fragment
                    && fits(pixels, 0.0)
                    && !is_tracked(cloud.points(), pixels, others.map(|(_, other)| other))
                {
                    for &pixel in pixels {
                        self.cluster_of[pixel as usize] = main as u32;
                    }
                    is_joined = true;
                }
            }
        }
        if is_joined {
            self.rebuild_groups(self.len());
        }
    }
}

/// `true` when a cluster is the observation of one of the tracks.
fn is_tracked<'a>(
    points: &[Point],
    pixels: &[u32],
    mut tracks: impl Iterator<Item = &'a ExpectedTrack>,
) -> bool {
    tracks.any(|track| {
        track.n_points > 0
            && pixels.len() as f64 >= CLAIM_SHARE * track.n_points as f64
            && share_inside(points, pixels, track) >= PART_SHARE
    })
}

/// Share of a cluster's sampled points inside the box of a track.
fn share_inside(points: &[Point], pixels: &[u32], track: &ExpectedTrack) -> f64 {
    let stride = pixels.len().div_ceil(N_SAMPLED_MAX).max(1);
    let (mut n, mut n_inside) = (0_usize, 0_usize);
    for &pixel in pixels.iter().step_by(stride) {
        n += 1;
        let point = points[pixel as usize].position();
        n_inside += usize::from(distance_outside_m(track, &point) <= MARGIN_M);
        // Early exit: most clusters are elsewhere.
        if n == N_SAMPLED_FIRST && n_inside == 0 {
            return 0.0;
        }
    }
    n_inside as f64 / n.max(1) as f64
}

/// Axis-aligned bounds of the sampled points, camera frame.
fn bounds(points: &[Point], pixels: &[u32]) -> (Vector3<f64>, Vector3<f64>) {
    let (mut low, mut high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
    for &pixel in pixels.iter().step_by(STRIDE) {
        let point = points[pixel as usize].position().coords;
        (low, high) = (low.inf(&point), high.sup(&point));
    }
    (low, high)
}
