//! Region claims: the live track whose object is expected at a region.

use super::cell_image::Cell;
use super::watershed::Watershed;
use crate::input::ExpectedTrack;
use nalgebra::Point3;
use point_cloud::OrganizedCloud;

/// Tolerance around a track's box, metres. Chosen.
const MARGIN_M: f64 = 0.008;

/// Least share of a region's points in the box of a track that claims it. Chosen.
const SHARE_MIN: f32 = 0.8;

/// Greatest number of points of a region that are tested.
const N_SAMPLES_MAX: u32 = 24;

/// Number of no track.
pub(crate) const NO_TRACK: u32 = u32::MAX;

/// Claims of live tracks on regions. Reused from frame to frame.
#[derive(Debug, Default)]
pub(super) struct RegionClaims {
    /// Per region: the number of its cells, then of those that were visited.
    n_cells: Vec<u32>,
    n_visited: Vec<u32>,
    /// Per region and track: the number of tested points in the track's box.
    n_inside: Vec<u32>,
    n_tested: Vec<u32>,
    claims: Vec<u32>,
}

impl RegionClaims {
    /// Track that claims each region, or [`NO_TRACK`]: of the tracks in whose boxes nearly all
    /// of the region is, the one with the smallest box.
    pub(super) fn find(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        cells: &[Cell],
        regions: &Watershed,
        tracks: &[ExpectedTrack],
    ) -> &[u32] {
        self.claims.clear();
        self.claims.resize(regions.regions.len(), NO_TRACK);
        if !tracks.is_empty() {
            self.test_points(cloud, cells, &regions.region_of, tracks);
            for (region, claim) in self.claims.iter_mut().enumerate() {
                let n_inside = &self.n_inside[region * tracks.len()..][..tracks.len()];
                let n_least = SHARE_MIN * self.n_tested[region] as f32;
                let claiming = (0..).zip(tracks.iter().zip(n_inside));
                let claiming = claiming.filter(|(_, (track, n_inside))| {
                    track.n_points > 0 && **n_inside as f32 >= n_least
                });
                let volume = |track: &ExpectedTrack| track.oriented_box.half_sides_m.product();
                let smallest =
                    claiming.min_by(|(_, (a, _)), (_, (b, _))| volume(a).total_cmp(&volume(b)));
                *claim = smallest.map_or(NO_TRACK, |(number, _)| number);
            }
        }
        &self.claims
    }

    /// Count the points of each region in the box of each track, of evenly spread cells.
    fn test_points(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        cells: &[Cell],
        region_of: &[u32],
        tracks: &[ExpectedTrack],
    ) {
        let n_regions = self.claims.len();
        for counts in [&mut self.n_cells, &mut self.n_visited, &mut self.n_tested] {
            counts.clear();
            counts.resize(n_regions, 0);
        }
        self.n_inside.clear();
        self.n_inside.resize(n_regions * tracks.len(), 0);
        for &region in region_of {
            self.n_cells[region as usize] += 1;
        }
        for (cell, &region) in cells.iter().zip(region_of) {
            let region = region as usize;
            let stride = self.n_cells[region].div_ceil(N_SAMPLES_MAX);
            let is_tested = self.n_visited[region].is_multiple_of(stride);
            self.n_visited[region] += 1;
            if is_tested {
                self.n_tested[region] += 1;
                let point: Point3<f64> = cloud.points()[cell.pixel as usize].position();
                let n_inside = &mut self.n_inside[region * tracks.len()..][..tracks.len()];
                for (track, n_inside) in tracks.iter().zip(n_inside) {
                    *n_inside += u32::from(track.oriented_box.contains(&point, MARGIN_M));
                }
            }
        }
    }
}
