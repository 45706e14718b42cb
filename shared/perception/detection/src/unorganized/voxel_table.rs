//! Table selection in voxel clouds.

use super::voxel_centroids::VoxelCentroids;
use super::voxel_grid::VoxelGrid;
use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::outline::Outline;
use crate::plane_ransac::{
    SearchEffort, UpCone, hypothesis_draws, largest_plane, least_squares_plane,
};
use crate::plane_region::{
    CELL_M, PlaneRegionBuffers, RegionFilter, RegionRule, find_region_along, region_axes,
    region_polygon,
};
use crate::samples::Samples;
use crate::table::{FLOOR_GAP_M, SurfaceRole, Table, TableChoice};
use crate::table_surface::TableSurface;
use geometry::{ConvexPolygon, Plane, RigidTransform};
use nalgebra::{Unit, Vector3};
use random::Random;

/// Effort of the plane search. Chosen.
const EFFORT: SearchEffort = SearchEffort {
    n_hypotheses_max: 800,
    neighbours_agree: 0.2,
    n_local_fits: 1,
    n_fits: 3,
};

/// Least side of an occupancy cell on a plane, voxels. Chosen.
const CELL_VOXELS: f32 = 2.5;

/// Greatest number of occupancy cells per side; a larger plane gets larger cells.
const CELLS_MAX: usize = 512;

/// Greatest number of planes searched per direction.
const N_PLANES_MAX: usize = 5;

/// Least share of the voxels on a plane. Chosen.
const SHARE_MIN: f64 = 0.005;

/// Least number of voxels on a plane. Chosen.
const N_VOXELS_MIN: usize = 100;

/// Least half width of a plane's band, in voxels. Chosen.
const BAND_VOXELS: f32 = 0.5;

/// Height above the least object height at which voxels count as carried by a plane,
/// metres; above all noise. Chosen.
const CARRIED_M: f32 = 0.02;

/// Least share of carried voxels, relative to those of the plane, of a plane that carries
/// objects. Chosen.
const CARRIED_SHARE_MIN: f64 = 0.005;

/// Least number of carried voxels of a plane that carries objects. Chosen.
const N_CARRIED_MIN: usize = 12;

/// Least ratio of voxels of the upper to the lower of two carrying planes at which the
/// upper is the table; the floor of a whole room is large. Chosen.
const TABLE_SHARE_OF_FLOOR: f64 = 0.05;

/// Assumed up direction in the frame of a camera that looks down obliquely. Chosen.
const OBLIQUE_UP: [f64; 3] = [0.0, -0.8, -0.6];

/// Greatest angle between the true and the assumed up direction, radians. Chosen.
const OBLIQUE_TILT_RAD: f64 = 0.96;

/// Least height of objects over the table, in sigmas of its voxel centroids. Chosen.
const NOISE_SIGMAS: f64 = 3.0;

/// Table of a voxel cloud, with the least height of objects over it, metres.
#[derive(Debug, Clone)]
pub(super) struct VoxelTable {
    pub(super) table: Table,
    pub(super) lowest_m: f32,
}

/// Table search in voxel clouds, with its buffers.
#[derive(Debug, Default)]
pub(super) struct VoxelTableSearch {
    centroids: VoxelCentroids,
    counted: Samples,
    region: PlaneRegionBuffers,
    found: Vec<VoxelPlaneCandidate>,
}

/// Plane found in a voxel cloud, with the number of voxels it carries.
#[derive(Debug)]
struct VoxelPlaneCandidate {
    plane: Plane,
    plane_from_cloud: RigidTransform,
    polygon: ConvexPolygon,
    n_voxels: usize,
    n_carried: usize,
    scatter_m: f64,
}

impl VoxelPlaneCandidate {
    fn carries(&self) -> bool {
        self.n_carried >= N_CARRIED_MIN
            && self.n_carried as f64 >= CARRIED_SHARE_MIN * self.n_voxels as f64
    }
}

impl VoxelTableSearch {
    /// Find the table: among the planes across up the largest that carries objects, or,
    /// where one is over another, the upper one.
    ///
    /// When up is unknown it is assumed to be the cloud's z axis, as in a world frame; if
    /// no such plane carries objects, a camera that looks down obliquely along z is
    /// assumed, whose up is mostly -y.
    pub(super) fn find(
        &mut self,
        voxels: &VoxelGrid,
        up: Option<Unit<Vector3<f64>>>,
        config: &RawConfig,
        surface: &mut TableSurface,
    ) -> Option<VoxelTable> {
        let mut random = hypothesis_draws();
        self.centroids.refill(voxels);
        let level = |up| UpCone {
            up,
            cos_min: config.table_tilt_max_rad.cos(),
        };
        let oblique = UpCone {
            up: Unit::new_normalize(Vector3::from(OBLIQUE_UP)),
            cos_min: OBLIQUE_TILT_RAD.cos(),
        };
        let cones = match up {
            Some(up) => [Some(level(up)), None],
            None => [Some(level(Vector3::z_axis())), Some(oblique)],
        };
        let mut empty = None;
        for cone in cones.iter().flatten() {
            self.find_planes(voxels, cone, config, &mut random, surface);
            let chosen = choose_table(&self.found);
            let chosen = chosen.map(|(plane, choice)| (as_table(plane, choice, config), plane));
            if let Some((table, plane)) = chosen {
                if plane.carries() {
                    return Some(table);
                }
                empty = empty.or(Some(table));
            }
        }
        empty
    }

    fn find_planes(
        &mut self,
        voxels: &VoxelGrid,
        cone: &UpCone,
        config: &RawConfig,
        random: &mut Random,
        surface: &mut TableSurface,
    ) {
        let voxel_m = voxels.size_m();
        let band_m = (config.plane_band_min_m as f32).max(BAND_VOXELS * voxel_m);
        let rule = RegionRule {
            cell_m: CELL_M.max(CELL_VOXELS * voxel_m),
            n_cells_max: CELLS_MAX,
            parts: RegionFilter::WideParts,
        };
        let n_voxels = self.centroids.samples.len();
        let n_min = ((SHARE_MIN * n_voxels as f64) as usize).max(N_VOXELS_MIN);
        self.found.clear();
        self.centroids.samples.release(band_m);
        for _ in 0..N_PLANES_MAX {
            let Self {
                centroids, counted, ..
            } = self;
            let (samples, draw) = (&centroids.samples, || centroids.draw(random));
            let plane = largest_plane(samples, Some(cone), n_min, &EFFORT, draw, counted);
            let Some(plane) = plane else { break };
            let found = self.outlined(plane, cone, &rule);
            let samples = &mut self.centroids.samples;
            samples.assign_inliers(&AffineForm::from(&plane));
            if let Some(mut found) = found.filter(|found| found.n_voxels >= n_min) {
                found.n_carried = self.count_carried(&found, config, surface);
                self.found.push(found);
            }
        }
    }

    /// Plane refitted to its own largest region, with its polygon.
    fn outlined(
        &mut self,
        plane: Plane,
        cone: &UpCone,
        rule: &RegionRule,
    ) -> Option<VoxelPlaneCandidate> {
        let (samples, region) = (&self.centroids.samples, &mut self.region);
        let axes = AffineForm::coordinates_of(&plane.plane_from_source());
        find_region_along(samples, &axes, rule, region);
        let principal = region_axes(samples, region)?;
        let plane = cone.admit(least_squares_plane(&principal)?)?;
        let plane_from_cloud = plane.plane_from_source();
        let axes = AffineForm::coordinates_of(&plane_from_cloud);
        let n_voxels = find_region_along(samples, &axes, rule, region);
        let mut polygon = ConvexPolygon::default();
        region_polygon(samples, region, &mut polygon);
        (polygon.corners().len() >= 3).then_some(VoxelPlaneCandidate {
            plane,
            plane_from_cloud,
            polygon,
            n_voxels,
            n_carried: 0,
            scatter_m: principal.variances_m2.min().max(0.0).sqrt(),
        })
    }

    /// Number of voxels carried by a plane.
    fn count_carried(
        &self,
        found: &VoxelPlaneCandidate,
        config: &RawConfig,
        surface: &mut TableSurface,
    ) -> usize {
        surface.refill_from_polygon(&found.polygon);
        let [u, v, height] = AffineForm::coordinates_of(&found.plane_from_cloud);
        let heights = config.height_min_m as f32 + CARRIED_M..=config.height_max_m as f32;
        let samples = &self.centroids.samples;
        (0..samples.len())
            .filter(|&i| {
                heights.contains(&samples.coordinate(&height, i))
                    && surface.is_table(samples.coordinate(&u, i), samples.coordinate(&v, i))
            })
            .count()
    }
}

fn as_table(found: &VoxelPlaneCandidate, choice: TableChoice, config: &RawConfig) -> VoxelTable {
    VoxelTable {
        table: Table {
            plane: found.plane,
            plane_by_image: found.plane,
            table_from_camera: found.plane_from_cloud,
            polygon: found.polygon.clone(),
            outline: Outline::around(&found.polygon),
            choice,
            role: SurfaceRole::Table,
            n_samples: found.n_voxels,
            depth_noise: config.depth_noise,
            noise_ratio: 1.0,
        },
        lowest_m: config.height_min_m.max(NOISE_SIGMAS * found.scatter_m) as f32,
    }
}

fn choose_table(found: &[VoxelPlaneCandidate]) -> Option<(&VoxelPlaneCandidate, TableChoice)> {
    let mut choice = match found.len().saturating_sub(1) {
        0 => TableChoice::Only,
        n_others => TableChoice::Largest { n_others },
    };
    let carrying = || found.iter().filter(|plane| plane.carries());
    let Some(mut chosen) = carrying().max_by_key(|plane| plane.n_voxels) else {
        let largest = found.iter().max_by_key(|plane| plane.n_voxels)?;
        return Some((largest, choice));
    };
    // Each iteration climbs at least the floor gap, so the loop ends.
    while let Some(upper) = carrying()
        .filter(|plane| is_above(plane, chosen))
        .max_by_key(|plane| plane.n_voxels)
    {
        chosen = upper;
        choice = TableChoice::OverLarger {
            n_others: found.len() - 1,
        };
    }
    Some((chosen, choice))
}

fn is_above(upper: &VoxelPlaneCandidate, lower: &VoxelPlaneCandidate) -> bool {
    lower.plane.offset_m - upper.plane.offset_m >= FLOOR_GAP_M
        && upper.plane.normal.dot(&lower.plane.normal) > 0.94
        && upper.n_voxels as f64 >= TABLE_SHARE_OF_FLOOR * lower.n_voxels as f64
}
