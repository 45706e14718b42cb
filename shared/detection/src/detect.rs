//! One frame, from cloud to candidates.

use crate::axis::Axis;
use crate::candidate::{Body, Candidate, Summary, Support, UprightBox};
use crate::clusters::Clusters;
use crate::creases::Creases;
use crate::islands::Islands;
use crate::outline::{Lattice, Outline};
use crate::prism::{OverTable, Prism, SeenRectangle, lowest_m};
use crate::random::Random;
use crate::samples::Samples;
use crate::sensor_noise::depth_sigma_m;
use crate::support::find_supports;
use crate::table_plane::{Table, TableBuffers, find_table};
use crate::table_surface::TableSurface;
use crate::unorganized::{self, detect_unorganized, has_no_grid};
use crate::{Config, Error, RawConfig};
use nalgebra::{Unit, Vector3};
use point_cloud::OrganizedCloud;

/// Most points of a cloud: an image of 8192x8192.
const N_POINTS_MAX: usize = 1 << 26;

/// A candidate this near to the border of what is seen may be cut by it, pixels.
const BORDER_PX: usize = 3;

/// A part of a cluster between creases has at least this many pixels.
const PART_PIXELS_MIN: u32 = 150;

/// Points of the foot of an object lie this high over the table, metres, or so
/// many sigma of the depth noise where that is more.
const FOOT_HEIGHT_MIN_M: f32 = 0.0035;
const FOOT_SIGMAS: f32 = 1.3;
const FOOT_HEIGHT_MAX_M: f32 = 0.02;

/// What is searched.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// The cloud, camera frame. One of a single row or column has no image grid;
    /// it may be in any frame, then, and merged from several views.
    pub cloud: OrganizedCloud<'a>,
    /// Up in the frame of the cloud, where the camera's pose is known.
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
    /// in the order of the cloud within each.
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
    surface: TableSurface,
    hull: Outline,
    lattice: Lattice,
    over_table: Vec<u32>,
    clusters: Clusters,
    whole: Clusters,
    creases: Creases,
    islands: Islands,
    bodies: Vec<Body>,
    pub(crate) unorganized: Option<Box<unorganized::Buffers>>,
}

/// Searches a frame for a table and the objects on it.
///
/// Points may hold any bit pattern; those that are not finite, out of range or
/// absurdly far to the side are ignored. Allocates nothing but the corners of
/// the table's polygon once the buffers have grown.
///
/// # Errors
/// When the cloud is larger than any image; `detection` is then left empty.
pub fn detect(
    frame: &Frame<'_>,
    config: &Config,
    workspace: &mut Workspace,
    detection: &mut Detection,
) -> Result<(), Error> {
    workspace.table.recycle(detection.table.take());
    detection.candidates.clear();
    detection.point_indices.clear();
    check_size(&frame.cloud)?;
    if has_no_grid(&frame.cloud) {
        detect_unorganized(frame, config, workspace, detection);
        return Ok(());
    }
    let config = config.get();
    let Workspace {
        samples,
        table: buffers,
        surface,
        over_table,
        clusters,
        islands,
        ..
    } = workspace;
    samples.refill(&frame.cloud, config);
    let mut random = Random::from_seed(frame.seed);
    let found = find_table(samples, frame.up_in_camera, config, &mut random, buffers);
    let Some(mut table) = found else {
        return Ok(());
    };
    surface.refill(&table, samples);
    if surface.has_holes() {
        std::mem::swap(&mut table.outline, &mut workspace.hull);
        table
            .outline
            .trace(surface, &workspace.hull, &mut workspace.lattice);
    }
    let height = Axis::of_transform(&table.table_from_camera)[2];
    let lowest = |z: f32| lowest_m(z, config.height_min_m as f32);
    islands.find(samples, &height, lowest);
    Prism::over(&table, config, islands, surface).list(&frame.cloud, over_table);
    let seen = SeenRectangle::of(&frame.cloud);
    let n_min = config.points_min_at_1m / (config.range_max_m * config.range_max_m);
    clusters.join(&frame.cloud, over_table, n_min as u32);
    split_piles(&frame.cloud, workspace);
    grow_feet(&frame.cloud, &table, workspace);
    find_bodies(&frame.cloud, &table, config, workspace);
    write(&table, seen, workspace, detection);
    detection.table = Some(table);
    Ok(())
}

/// Parts the clusters that are several objects along their creases.
fn split_piles(cloud: &OrganizedCloud<'_>, workspace: &mut Workspace) {
    let Workspace {
        whole,
        clusters,
        creases,
        ..
    } = workspace;
    if creases.find(cloud, clusters) {
        std::mem::swap(whole, clusters);
        clusters.split(cloud, whole, creases, PART_PIXELS_MIN);
    }
}

/// Lets the clusters grow down to the table.
fn grow_feet(cloud: &OrganizedCloud<'_>, table: &Table, workspace: &mut Workspace) {
    let height = Axis::of_transform(&table.table_from_camera)[2];
    let is_foot = |pixel: usize| {
        let point = &cloud.points()[pixel];
        let lowest_m = FOOT_HEIGHT_MIN_M.max(FOOT_SIGMAS * depth_sigma_m(point.z));
        (lowest_m..=FOOT_HEIGHT_MAX_M).contains(&height.at(point.x, point.y, point.z))
    };
    let Workspace {
        clusters,
        over_table,
        ..
    } = workspace;
    clusters.grow_feet(over_table, cloud.width() as isize, is_foot);
}

fn check_size(cloud: &OrganizedCloud<'_>) -> Result<(), Error> {
    let n_points = cloud.points().len();
    if n_points > N_POINTS_MAX {
        return Err(Error::TooLarge { n_points });
    }
    Ok(())
}

/// The clusters that can be objects by their size and by what carries them,
/// nearest first.
fn find_bodies(
    cloud: &OrganizedCloud<'_>,
    table: &Table,
    config: &RawConfig,
    workspace: &mut Workspace,
) {
    let Workspace {
        clusters,
        bodies,
        surface,
        ..
    } = workspace;
    let table_axes = Axis::of_transform(&table.table_from_camera);
    let over_table = OverTable::new(table, surface);
    bodies.clear();
    bodies.extend(
        (0..clusters.len() as u32)
            .filter(|&cluster| over_table.holds(clusters.pixels(cluster as usize), cloud))
            .filter_map(|cluster| body_of(cluster, clusters, cloud, &table_axes, config)),
    );
    find_supports(cloud, clusters, &table.plane.normal, bodies);
    bodies.retain(|body| body.support.is_some());
    let distance = |body: &Body| body.summary.centroid.coords.norm_squared();
    bodies.sort_unstable_by(|a, b| {
        distance(a)
            .total_cmp(&distance(b))
            .then(a.cluster.cmp(&b.cluster))
    });
}

/// A cluster as a body; `None` when it is too small or too large.
fn body_of(
    cluster: u32,
    clusters: &Clusters,
    cloud: &OrganizedCloud<'_>,
    table_axes: &[Axis; 3],
    config: &RawConfig,
) -> Option<Body> {
    let pixels = clusters.pixels(cluster as usize);
    let summary = Summary::of(pixels, cloud, &table_axes[2], config);
    if (pixels.len() as f64) < config.points_min_at_1m / summary.centroid.z.powi(2) {
        return None;
    }
    let [lowest_m, highest_m] = summary.height_m.map(f64::from);
    let heights_m = [if summary.stands { 0.0 } else { lowest_m }, highest_m];
    let upright_box = UprightBox::around(pixels, cloud.points(), table_axes, heights_m)?;
    let sides = config.side_min_m..=config.side_max_m;
    let support = summary.stands.then_some(Support::Table);
    sides
        .contains(&upright_box.longest_side_m())
        .then_some(Body {
            cluster,
            summary,
            upright_box,
            support,
        })
}

/// Writes the bodies as candidates.
fn write(table: &Table, seen: SeenRectangle, workspace: &Workspace, detection: &mut Detection) {
    for body in &workspace.bodies {
        let Some(support) = body.support else {
            continue;
        };
        let first = detection.point_indices.len();
        let pixels = workspace.clusters.pixels(body.cluster as usize);
        detection.point_indices.extend_from_slice(pixels);
        detection.candidates.push(Candidate {
            range: first..detection.point_indices.len(),
            centroid: body.summary.centroid,
            oriented_box: body.upright_box.in_camera(&table.table_from_camera),
            mean_rgb: body.summary.mean_rgb,
            support,
            touches_image_border: seen.is_reached_by(&body.summary.seen, BORDER_PX),
        });
    }
}
