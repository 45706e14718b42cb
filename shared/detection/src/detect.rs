//! One frame, from cloud to candidates.

use crate::candidate::{Candidate, Summary, Support, upright_box};
use crate::clusters::Clusters;
use crate::prism::{Prism, SeenRectangle};
use crate::random::Random;
use crate::samples::Samples;
use crate::support::{SupportBuffers, find_supports};
use crate::table_plane::{Table, TableBuffers, find_table};
use crate::table_slabs::TableSlabs;
use crate::{Config, Error, RawConfig};
use crate::axis::Axis;
use nalgebra::{Unit, Vector3};
use point_cloud::OrganizedCloud;

/// Most points of a cloud: an image of 8192x8192.
const N_POINTS_MAX: usize = 1 << 26;

/// A candidate this near to the border of what is seen may be cut by it, pixels.
const BORDER_PX: usize = 3;

/// What is searched.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// The cloud, camera frame.
    pub cloud: OrganizedCloud<'a>,
    /// Up in the camera frame, where the camera's pose is known.
    pub up_in_camera: Option<Unit<Vector3<f64>>>,
    /// Seed of the plane search; the same seed gives the same result.
    pub seed: u64,
}

/// What was found. Reused from frame to frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Detection {
    /// The table; without one there are no candidates.
    pub table: Option<Table>,
    /// Candidates, nearest first.
    pub candidates: Vec<Candidate>,
    /// Indices of the candidates' points in the cloud, candidate by candidate,
    /// in image order within each.
    pub point_indices: Vec<u32>,
}

impl Detection {
    /// Indices of a candidate's points in the cloud.
    pub fn points_of(&self, candidate: &Candidate) -> &[u32] {
        &self.point_indices[candidate.range.clone()]
    }
}

/// Buffers, reused from frame to frame.
#[derive(Debug, Default)]
pub struct Workspace {
    samples: Samples,
    table: TableBuffers,
    slabs: TableSlabs,
    clusters: Clusters,
    summaries: Vec<Summary>,
    support: SupportBuffers,
    order: Vec<u32>,
}

/// Searches a frame for a table and the objects on it.
///
/// Points may hold any bit pattern; those that are not finite, out of range or
/// absurdly far to the side are ignored. Allocates nothing but the corners of
/// the table's polygon once the buffers have grown.
///
/// # Errors
/// When the cloud has no image grid, or is larger than any image; `detection`
/// is then left empty.
pub fn detect(
    frame: &Frame<'_>,
    config: &Config,
    workspace: &mut Workspace,
    detection: &mut Detection,
) -> Result<(), Error> {
    detection.table = None;
    detection.candidates.clear();
    detection.point_indices.clear();
    check_grid(&frame.cloud)?;
    let config = config.get();
    let Workspace { samples, table: buffers, slabs, clusters, .. } = workspace;
    samples.refill(&frame.cloud, config);
    let mut random = Random::from_seed(frame.seed);
    let found = find_table(samples, frame.up_in_camera, config, &mut random, buffers);
    let Some(table) = found else { return Ok(()) };
    let seen = Prism::over(&table, config, slabs).mark(&frame.cloud, &mut clusters.cluster_of);
    let n_min = config.points_min_at_1m / (config.range_max_m * config.range_max_m);
    clusters.join(&frame.cloud, n_min as u32);
    summarise(&frame.cloud, &table, config, workspace);
    collect(&frame.cloud, &table, seen, (config, workspace), detection);
    detection.table = Some(table);
    Ok(())
}

fn check_grid(cloud: &OrganizedCloud<'_>) -> Result<(), Error> {
    let n_points = cloud.points().len();
    if cloud.height() == 1 || cloud.width() == 1 {
        return Err(Error::Unorganized { n_points });
    }
    if n_points > N_POINTS_MAX {
        return Err(Error::TooLarge { n_points });
    }
    Ok(())
}

/// Sums over each cluster, and what carries it.
fn summarise(
    cloud: &OrganizedCloud<'_>,
    table: &Table,
    config: &RawConfig,
    workspace: &mut Workspace,
) {
    let Workspace { clusters, summaries, support, .. } = workspace;
    let height = Axis::from(&table.plane);
    summaries.clear();
    summaries.extend(
        (0..clusters.len()).map(|i| Summary::of(clusters.pixels(i), cloud, &height, config)),
    );
    support.support_of.clear();
    support.support_of.extend(summaries.iter().map(|s| s.stands.then_some(Support::Table)));
    let centroid = |cluster: usize| summaries[cluster].centroid;
    find_supports(cloud, clusters, centroid, &table.plane.normal, support);
}

/// Writes the clusters that can be objects, nearest first.
fn collect(
    cloud: &OrganizedCloud<'_>,
    table: &Table,
    seen: SeenRectangle,
    (config, workspace): (&RawConfig, &mut Workspace),
    detection: &mut Detection,
) {
    let Workspace { clusters, summaries, support, order, .. } = workspace;
    order.clear();
    order.extend(0..clusters.len() as u32);
    let distance = |&cluster: &u32| summaries[cluster as usize].centroid.coords.norm_squared();
    order.sort_unstable_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
    for &cluster in order.iter() {
        let (summary, pixels) = (&summaries[cluster as usize], clusters.pixels(cluster as usize));
        let Some(support) = support.support_of[cluster as usize] else { continue };
        if (pixels.len() as f64) < config.points_min_at_1m / summary.centroid.z.powi(2) {
            continue;
        }
        let lowest_m = if support == Support::Table { 0.0 } else { f64::from(summary.height_m[0]) };
        let heights = [lowest_m, f64::from(summary.height_m[1])];
        let Some(oriented_box) = upright_box(pixels, cloud.points(), table, heights) else {
            continue;
        };
        if !(config.side_min_m..=config.side_max_m).contains(&oriented_box.sides_m().max()) {
            continue;
        }
        let first = detection.point_indices.len();
        detection.point_indices.extend_from_slice(pixels);
        detection.candidates.push(Candidate {
            range: first..detection.point_indices.len(),
            centroid: summary.centroid,
            oriented_box,
            mean_rgb: summary.mean_rgb,
            support,
            touches_image_border: seen.is_reached_by(&summary.seen, BORDER_PX),
        });
    }
}
