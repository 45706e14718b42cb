//! Clusters that are several tracked objects that touch, or parts of one.

use super::Clusters;
use crate::input::ExpectedTrack;
use nalgebra::{Point3, Vector3};
use point_cloud::{OrganizedCloud, Point};

/// A point sticks out of its object's expected box by this at most, metres.
const MARGIN_M: f64 = 0.008;

/// Every so many points of a cluster one is asked whose it is.
const STRIDE: usize = 8;

/// As many points of a cluster are asked whether it is a fragment, and when none of
/// the first ones lies in the box, no more.
const N_SAMPLED_MAX: usize = 64;
const N_SAMPLED_FIRST: usize = 4;

/// A track claims a cluster with this share of the points it had.
const CLAIM_SHARE: f64 = 0.35;

/// Boxes that share more of their points than this are two tracks of one object.
const COMMON_SHARE_MAX: f64 = 0.3;

/// What is farther from every claimed box is something else, metres.
const ELSEWHERE_M: f64 = 0.03;

/// What a track finds of a cluster in its box.
#[derive(Debug, Clone, Copy)]
struct TrackClaim {
    track: usize,
    /// Points asked that lie in the box, and those that lie best in it.
    n_inside: usize,
    n_best: usize,
}

/// Buffers.
#[derive(Debug, Default)]
pub(crate) struct TrackClaims {
    near: Vec<TrackClaim>,
}

impl TrackClaims {
    /// The tracks that claim a cluster; fewer than two when it is to stay whole.
    fn find(&mut self, points: &[Point], pixels: &[u32], tracks: &[ExpectedTrack]) {
        let (low, high) = bounds(points, pixels);
        self.near.clear();
        let near = tracks.iter().enumerate().filter(|(_, track)| {
            let centre = track.shape.centre();
            let reach = track.shape.half_sides_m.norm() + MARGIN_M;
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
        self.near.retain(|claim| {
            let n_least = CLAIM_SHARE * tracks[claim.track].n_points as f64;
            let is_own = claim.n_best as f64 >= (1.0 - COMMON_SHARE_MAX) * claim.n_inside as f64;
            is_own && (claim.n_best * STRIDE) as f64 >= n_least
        });
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
    /// RegionFilter clusters in which two or more tracks find most of their objects:
    /// each point goes to the box it lies in or nearest_claim to, and what is far from
    /// all of them is a cluster of its own.
    ///
    /// Boxes of the tracks in the camera's frame.
    pub(crate) fn split_by_tracks(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        tracks: &[ExpectedTrack],
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
                let part = claims.nearest_claim(tracks, &point);
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

    /// LabelGroups the pixels anew by what `cluster_of` says now.
    fn rebuild_groups(&mut self, n_clusters: usize) {
        self.ungrouped.clear();
        self.ungrouped.extend_from_slice(&self.pixels);
        self.starts.clear();
        self.starts.resize(n_clusters + 1, 0);
        for &pixel in &self.ungrouped {
            self.starts[self.cluster_of[pixel as usize] as usize + 1] += 1;
        }
        for i in 0..n_clusters {
            self.starts[i + 1] += self.starts[i];
        }
        self.number_of.clear();
        self.number_of.extend_from_slice(&self.starts);
        for &pixel in &self.ungrouped {
            let place = &mut self.number_of[self.cluster_of[pixel as usize] as usize];
            self.pixels[*place as usize] = pixel;
            *place += 1;
        }
    }
}

impl TrackClaims {
    /// The number of the claim a point belongs to; that behind the last one for
    /// what belongs to none.
    fn nearest_claim(&self, tracks: &[ExpectedTrack], point: &Point3<f64>) -> usize {
        let outside = |claim: &TrackClaim| distance_outside_m(&tracks[claim.track], point);
        let best = (0..self.near.len())
            .map(|i| (i, outside(&self.near[i])))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match best {
            Some((i, distance_outside_m)) if distance_outside_m <= ELSEWHERE_M => i,
            _ => self.near.len(),
        }
    }
}

/// How far a point lies outside the box of a track, metres; negative within it.
fn distance_outside_m(track: &ExpectedTrack, point: &Point3<f64>) -> f64 {
    let place = track.shape.frame_from_box.inverse_transform_point(point);
    let beyond = |i: usize| place[i].abs() - track.shape.half_sides_m[i];
    (0..3).map(beyond).fold(f64::NEG_INFINITY, f64::max)
}

/// Clusters of which this share lies in the box of a track are its object's, ...
const PART_SHARE: f64 = 0.85;

/// ... the main one with at least this share of the points it had, ...
const MAIN_SHARE: f64 = 0.4;

/// ... and the others, like the handle of a mug seen end on, with at most this: what
/// is larger is another object, like an apple in a bowl.
const FRAGMENT_SHARE: f64 = 0.15;

impl Clusters {
    /// Joins the fragments of tracked objects with their main clusters, unless they
    /// are tracked themselves.
    ///
    /// Boxes of the tracks in the camera's frame.
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

/// Whether a cluster is what one of some tracks saw.
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

/// Share of a cluster's points in the box of a track.
fn share_inside(points: &[Point], pixels: &[u32], track: &ExpectedTrack) -> f64 {
    let stride = pixels.len().div_ceil(N_SAMPLED_MAX).max(1);
    let (mut n, mut n_inside) = (0_usize, 0_usize);
    for &pixel in pixels.iter().step_by(stride) {
        n += 1;
        let point = points[pixel as usize].position();
        n_inside += usize::from(distance_outside_m(track, &point) <= MARGIN_M);
        // Mostly it lies elsewhere altogether.
        if n == N_SAMPLED_FIRST && n_inside == 0 {
            return 0.0;
        }
    }
    n_inside as f64 / n.max(1) as f64
}

/// The corners of the box along the camera's axes around some of the points.
fn bounds(points: &[Point], pixels: &[u32]) -> (Vector3<f64>, Vector3<f64>) {
    let (mut low, mut high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
    for &pixel in pixels.iter().step_by(STRIDE) {
        let point = points[pixel as usize].position().coords;
        (low, high) = (low.inf(&point), high.sup(&point));
    }
    (low, high)
}
