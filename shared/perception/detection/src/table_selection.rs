//! Table selection among the dominant planes of an image.

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::level_surfaces::LevelSearch;
use crate::near_rim::NearRim;
use crate::occluded_table::{OccludedTableBuffers, stands_on};
use crate::plane_ransac::{PlaneSearchBuffers, UpCone, hypothesis_draws, largest_plane_in_image};
use crate::plane_region::{
    PlaneRegionBuffers, RegionFilter, find_region, region_plane, region_plane_and_middle,
    region_polygon,
};
use crate::samples::Samples;
use crate::table::{FLOOR_GAP_M, SurfaceRole, Table, TableChoice, is_same_surface};
use geometry::Plane;
use nalgebra::{Point3, Unit, Vector3};
use sensor_noise::DepthNoise;

/// Greatest number of planes searched in one image.
const N_PLANES_MAX: usize = 5;

/// Least share of the image's samples on a plane. Chosen.
const SHARE_MIN: f64 = 0.02;

/// Share of the samples in range at which a table ends the search, unless enough is above
/// it for a table over a floor or below it for a table under the top of an object. Chosen.
const DOMINANT_SHARE: f64 = 0.5;

/// Least ratio of samples of the upper to the lower of two parallel planes at which the
/// upper is a table and not the top of an object. Chosen.
const TABLE_SHARE_OF_FLOOR: f64 = 0.2;

/// Least component of a table's normal against the image's downward axis, when up is
/// unknown. Under a camera that looks down, walls have zero or less and a table has the
/// cosine of the pitch. Chosen.
const UPWARD_MIN: f64 = 0.2;

/// Greatest component of a table's normal along the image rows, when up is unknown; a
/// larger one is a side wall seen by a rolled camera. Chosen.
const SIDEWARD_MAX: f64 = 0.6;

/// Least component of a normal towards the camera for a table seen from above, when up is
/// unknown. Chosen.
const FROM_ABOVE_MIN: f64 = 0.9;

/// Buffers of the table selection.
#[derive(Debug, Default)]
pub(crate) struct TableSelectionBuffers {
    search: PlaneSearchBuffers,
    pub(crate) region: PlaneRegionBuffers,
    pub(crate) rim: NearRim,
    /// Planes of the image.
    pub(crate) found: Vec<PlaneCandidate>,
    occluded: OccludedTableBuffers,
    /// Surfaces of earlier frames, whose memory the next ones reuse.
    spare: Vec<Table>,
}

impl TableSelectionBuffers {
    /// Recycle the buffers of surfaces for the next frame.
    pub(crate) fn recycle(&mut self, surfaces: &mut Vec<Table>) {
        self.spare.append(surfaces);
    }
}

/// Plane found in an image, with its table likelihood.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlaneCandidate {
    pub(crate) plane: Plane,
    /// Number of samples of its largest region.
    pub(crate) n_samples: usize,
    /// Number of its regions that are large enough for a table.
    n_surfaces: usize,
    likelihood: TableLikelihood,
}

/// Likelihood of a table by the direction of the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum TableLikelihood {
    /// Not a table: wall, ceiling or side of furniture.
    None,
    /// Table seen from above, or a wall in front of a level camera.
    Possible,
    /// Table seen by a camera that looks down.
    Likely,
}

/// Plane of a table, with the parts of it that belong to the table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChosenPlane {
    pub(crate) plane: Plane,
    pub(crate) parts: RegionFilter,
    pub(crate) choice: TableChoice,
}

/// Select the support surfaces of an image, the table first; none when no plane is large enough
/// and directed like a table. `expected` are the surfaces of earlier frames, the table first.
///
/// `samples` are assigned to planes during the search and reset afterwards.
pub(crate) fn select_surfaces(
    samples: &mut Samples,
    up_in_camera: Option<Unit<Vector3<f64>>>,
    expected: &[Plane],
    config: &RawConfig,
    buffers: &mut TableSelectionBuffers,
    surfaces: &mut Vec<Table>,
) {
    let n_min = ((samples.len() as f64 * SHARE_MIN) as usize).max(8);
    let is_all = find_planes(samples, up_in_camera, config, n_min, buffers);
    samples.reset_assignment(config);
    surfaces.extend(select_table(
        samples,
        expected.first(),
        (n_min, is_all),
        config,
        buffers,
    ));
    let levels = LevelSearch {
        samples,
        config,
        expected,
        n_min,
    };
    levels.find(buffers, surfaces);
}

/// Select the table of an image: the table of earlier frames if it is seen, otherwise among the
/// largest planes the most table-like one by direction, place over a floor and size. `is_all` tells
/// that all planes were searched.
fn select_table(
    samples: &Samples,
    expected: Option<&Plane>,
    (n_min, is_all): (usize, bool),
    config: &RawConfig,
    buffers: &mut TableSelectionBuffers,
) -> Option<Table> {
    let kept = expected.and_then(|plane| find_again(samples, plane, n_min, &mut buffers.region));
    let by_image = choose_by_image(samples, is_all, n_min, config, buffers);
    let Some((plane, middle)) = kept else {
        let by_image = by_image?;
        return outlined_table(samples, &by_image, by_image.plane, buffers);
    };
    let same = by_image.filter(|one| is_same_surface(&plane, &one.plane, &middle));
    let (parts, choice) = same.map_or((RegionFilter::WideOnly, TableChoice::Kept), |same| {
        (same.parts, same.choice)
    });
    let chosen = ChosenPlane {
        plane,
        parts,
        choice,
    };
    find_region(samples, &plane, parts, &mut buffers.region);
    let plane_by_image = by_image.map_or(plane, |by_image| by_image.plane);
    outlined_table(samples, &chosen, plane_by_image, buffers)
}

/// Table that the image alone gives; its region is the one found last.
fn choose_by_image(
    samples: &Samples,
    is_all: bool,
    n_min: usize,
    config: &RawConfig,
    buffers: &mut TableSelectionBuffers,
) -> Option<ChosenPlane> {
    let (chosen, mut choice) = choose_table(&buffers.found, n_min)?;
    if choice == TableChoice::Only && !is_all {
        choice = TableChoice::Most;
    }
    let region = &mut buffers.region;
    find_region(samples, &chosen.plane, RegionFilter::WideOnly, region);
    let under = find_table_under(samples, &chosen, config, n_min, buffers);
    Some(match under {
        Some(plane) => {
            find_region(samples, &plane, RegionFilter::All, &mut buffers.region);
            ChosenPlane {
                plane,
                parts: RegionFilter::All,
                choice: TableChoice::Around,
            }
        }
        None => ChosenPlane {
            plane: chosen.plane,
            parts: RegionFilter::WideOnly,
            choice,
        },
    })
}

/// Plane of a surface of earlier frames refitted to this image, and the middle of what is seen of
/// it; `None` when it is not seen in its place.
pub(crate) fn find_again(
    samples: &Samples,
    expected: &Plane,
    n_min: usize,
    region: &mut PlaneRegionBuffers,
) -> Option<(Plane, Point3<f64>)> {
    if find_region(samples, expected, RegionFilter::WideOnly, region) < n_min {
        return None;
    }
    let (plane, middle) = region_plane_and_middle(samples, region)?;
    is_same_surface(&plane, expected, &middle).then_some((plane, middle))
}

/// Plane search: the largest planes of an image, of which the samples stay assigned. `true`
/// when all were searched; `false` when a dominant one, with too little above and below it
/// for another table, ended the search.
fn find_planes(
    samples: &mut Samples,
    up_in_camera: Option<Unit<Vector3<f64>>>,
    config: &RawConfig,
    n_min: usize,
    buffers: &mut TableSelectionBuffers,
) -> bool {
    let mut random = hypothesis_draws();
    let cone = up_in_camera.map(|up| UpCone {
        up,
        cos_min: config.table_tilt_max_rad.cos(),
    });
    let n_dominant = (samples.n_unassigned() as f64 * DOMINANT_SHARE) as usize;
    buffers.found.clear();
    for _ in 0..N_PLANES_MAX {
        let (cone, search) = (cone.as_ref(), &mut buffers.search);
        let plane = largest_plane_in_image(samples, cone, n_min, &mut random, search);
        let Some(plane) = plane else { break };
        let found =
            through_largest_region(samples, plane, up_in_camera, n_min, &mut buffers.region);
        samples.assign_inliers(&AffineForm::from(&plane));
        buffers.found.push(found);
        if found.likelihood == TableLikelihood::Likely
            && found.n_samples >= n_dominant
            && !may_be_floor(samples, &found)
            && !may_be_top(samples, &found, n_min)
        {
            return false;
        }
    }
    true
}

/// Table on which the object stands whose top is the chosen plane, or the object under it
/// in a pile; `None` when the chosen plane stands on no other. The wide region of the chosen
/// plane comes as the region found last, and stays it when the result is `None`.
fn find_table_under(
    samples: &Samples,
    chosen: &PlaneCandidate,
    config: &RawConfig,
    n_min: usize,
    buffers: &mut TableSelectionBuffers,
) -> Option<Plane> {
    let TableSelectionBuffers {
        region,
        found,
        occluded,
        ..
    } = buffers;
    let mut lowest = chosen;
    for _ in 0..found.len() {
        let mut carries = |lower: &&PlaneCandidate| {
            let planes = [&lowest.plane, &lower.plane];
            stands_on(samples, planes, config, n_min, region, occluded)
        };
        let under = found
            .iter()
            .filter(|lower| lower.likelihood == chosen.likelihood && lower.plane != lowest.plane)
            .find(&mut carries);
        let Some(under) = under else { break };
        lowest = under;
        find_region(samples, &lowest.plane, RegionFilter::WideOnly, region);
    }
    if lowest.plane == chosen.plane {
        return None;
    }
    find_region(samples, &lowest.plane, RegionFilter::All, region);
    Some(region_plane(samples, region).unwrap_or(lowest.plane))
}

/// `true` when enough of the unassigned samples are above a plane for a table over it.
fn may_be_floor(samples: &Samples, found: &PlaneCandidate) -> bool {
    let height = AffineForm::from(&found.plane);
    let is_over = |&sample: &usize| {
        samples.is_unassigned(sample)
            && f64::from(samples.coordinate(&height, sample)) >= FLOOR_GAP_M
    };
    let n_over = (0..samples.len()).filter(is_over).count();
    n_over as f64 >= TABLE_SHARE_OF_FLOOR * found.n_samples as f64
}

/// `true` when enough of the unassigned samples are a little below a plane for a table under
/// it.
fn may_be_top(samples: &Samples, found: &PlaneCandidate, n_min: usize) -> bool {
    let height = AffineForm::from(&found.plane);
    let is_under = |&sample: &usize| {
        let below_m = -f64::from(samples.coordinate(&height, sample));
        samples.is_unassigned(sample) && (0.0..FLOOR_GAP_M).contains(&below_m)
    };
    (0..samples.len()).filter(is_under).count() >= n_min
}

/// Plane refitted to its own largest connected region.
fn through_largest_region(
    samples: &Samples,
    plane: Plane,
    up_in_camera: Option<Unit<Vector3<f64>>>,
    n_min: usize,
    region: &mut PlaneRegionBuffers,
) -> PlaneCandidate {
    let n_samples = find_region(samples, &plane, RegionFilter::WideOnly, region);
    let plane = region_plane(samples, region).unwrap_or(plane);
    PlaneCandidate {
        plane,
        n_samples,
        n_surfaces: region.n_regions_of_at_least(n_min),
        likelihood: likelihood(&plane, up_in_camera),
    }
}

fn likelihood(plane: &Plane, up_in_camera: Option<Unit<Vector3<f64>>>) -> TableLikelihood {
    let n = &plane.normal;
    let is_likely = up_in_camera.map_or_else(
        || -n.y >= UPWARD_MIN && n.x.abs() <= SIDEWARD_MAX,
        |up| n.dot(&up) > 0.0,
    );
    if is_likely {
        TableLikelihood::Likely
    } else if up_in_camera.is_none() && -n.z >= FROM_ABOVE_MIN {
        TableLikelihood::Possible
    } else {
        TableLikelihood::None
    }
}

/// Selects the table among the planes: the most table-like, then the largest; a parallel
/// plane above it with enough samples takes its place, as a table over a floor does.
fn choose_table(found: &[PlaneCandidate], n_min: usize) -> Option<(PlaneCandidate, TableChoice)> {
    let large = || found.iter().filter(|plane| plane.n_samples >= n_min);
    let likelihood = large().map(|plane| plane.likelihood).max()?;
    if likelihood == TableLikelihood::None {
        return None;
    }
    let tables = || large().filter(|plane| plane.likelihood == likelihood);
    let n_others = tables().map(|plane| plane.n_surfaces).sum::<usize>() - 1;
    let mut choice = match n_others {
        0 => TableChoice::Only,
        n_others => TableChoice::Largest { n_others },
    };
    let mut chosen = *tables().max_by_key(|plane| plane.n_samples)?;
    while let Some(upper) = tables()
        .filter(|plane| is_above(plane, &chosen))
        .max_by_key(|plane| plane.n_samples)
    {
        chosen = *upper;
        choice = TableChoice::OverLarger { n_others };
    }
    Some((chosen, choice))
}

fn is_above(upper: &PlaneCandidate, lower: &PlaneCandidate) -> bool {
    let gap_m = lower.plane.offset_m - upper.plane.offset_m;
    gap_m >= FLOOR_GAP_M
        && upper.plane.normal.dot(&lower.plane.normal) > 0.94
        && upper.n_samples as f64 >= TABLE_SHARE_OF_FLOOR * lower.n_samples as f64
}

/// Table of a plane with the polygon of its region, which was found last.
pub(crate) fn outlined_table(
    samples: &Samples,
    &ChosenPlane { plane, choice, .. }: &ChosenPlane,
    plane_by_image: Plane,
    buffers: &mut TableSelectionBuffers,
) -> Option<Table> {
    let region = &mut buffers.region;
    let table_from_camera = plane.plane_from_source();
    let (mut polygon, mut outline) = match buffers.spare.pop() {
        Some(spare) => (spare.polygon, spare.outline),
        None => Default::default(),
    };
    region_polygon(samples, region, &mut polygon);
    outline.assign_hull(&polygon);
    let table = Table {
        plane,
        plane_by_image,
        table_from_camera,
        polygon,
        outline,
        choice,
        role: SurfaceRole::Table,
        n_samples: region.n_samples(),
        depth_noise: DepthNoise::default(),
        noise_ratio: 1.0,
    };
    if table.polygon.corners().len() < 3 {
        buffers.spare.push(table);
        return None;
    }
    Some(table)
}
