//! Which plane is the table.

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::occluded_table::{OccludedTableBuffers, find_occluded_table};
use crate::plane_ransac::{NormalConstraint, PlaneSearchBuffers, largest_plane};
use crate::plane_region::{
    PlaneRegionBuffers, RegionFilter, find_region, region_plane, region_polygon,
};
use crate::samples::Samples;
use crate::table::{FLOOR_GAP_M, Table, TableChoice};
use geometry::Plane;
use nalgebra::{Unit, Vector3};
use random::Random;

/// Planes looked at in one image, at most.
const N_PLANES_MAX: usize = 5;

/// A plane needs this share of the image's samples.
const SHARE_MIN: f64 = 0.02;

/// A table with this share of the samples in range ends the search, unless
/// enough is over it to be a table over a floor.
const DOMINANT_SHARE: f64 = 0.5;

/// The upper of two parallel planes is a table, and no object's top, when it
/// has this share of the lower one's samples.
const TABLE_SHARE_OF_FLOOR: f64 = 0.2;

/// Without known up: least component of a table's normal against the image's
/// downward axis. A camera that looks down sees walls with a component of zero
/// or less, a table with the cosine of its pitch.
const UPWARD_MIN: f64 = 0.2;

/// Without known up: greatest component of a table's normal along the image's
/// rows; what is steeper is a wall at the side of a camera held aslant.
const SIDEWARD_MAX: f64 = 0.6;

/// Without known up: a plane whose normal comes this straight at the camera
/// may be a table seen from above.
const FROM_ABOVE_MIN: f64 = 0.9;

/// Buffers of the search.
#[derive(Debug, Default)]
pub(crate) struct TableSelectionBuffers {
    search: PlaneSearchBuffers,
    region: PlaneRegionBuffers,
    found: Vec<PlaneCandidate>,
    occluded: OccludedTableBuffers,
    /// The table of an earlier frame, whose memory the next one takes.
    spare: Option<Table>,
}

impl TableSelectionBuffers {
    /// Takes back the memory of a table that is not needed any more.
    pub(crate) fn recycle(&mut self, table: Option<Table>) {
        self.spare = table.or(self.spare.take());
    }
}

#[derive(Debug, Clone, Copy)]
struct PlaneCandidate {
    plane: Plane,
    n_samples: usize,
    /// Number of its parts that are large enough for a table.
    n_surfaces: usize,
    likelihood: TableLikelihood,
}

/// How much a plane's direction resembles that of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum TableLikelihood {
    /// A wall, a ceiling, a side of furniture.
    None,
    /// A table from above, or a wall in front of a level camera.
    Possible,
    /// A table seen by a camera that looks down at it.
    Likely,
}

/// The table of an image: among the largest planes the one that most resembles
/// a table, by its direction, its place over a floor and its size.
/// `None` when no plane is large enough and directed like a table.
///
/// `samples` are used up and then freed again.
pub(crate) fn select_table(
    samples: &mut Samples,
    up_in_camera: Option<Unit<Vector3<f64>>>,
    config: &RawConfig,
    random: &mut Random,
    buffers: &mut TableSelectionBuffers,
) -> Option<Table> {
    let limit = up_in_camera.map(|up| NormalConstraint {
        up,
        cos_min: config.table_tilt_max_rad.cos(),
    });
    let n_min = ((samples.len() as f64 * SHARE_MIN) as usize).max(8);
    let n_dominant = ((0..samples.len())
        .filter(|&i| samples.is_unassigned(i))
        .count() as f64
        * DOMINANT_SHARE) as usize;
    buffers.found.clear();
    let mut is_all = true;
    for _ in 0..N_PLANES_MAX {
        let Some(plane) =
            largest_plane(samples, limit.as_ref(), n_min, random, &mut buffers.search)
        else {
            break;
        };
        let found =
            through_largest_region(samples, plane, up_in_camera, n_min, &mut buffers.region);
        samples.assign_inliers(&AffineForm::from(&plane));
        buffers.found.push(found);
        if found.likelihood == TableLikelihood::Likely
            && found.n_samples >= n_dominant
            && !may_be_floor(samples, &found)
        {
            is_all = false;
            break;
        }
    }
    samples.reset_assignment(config);
    let (chosen, mut choice) = choose_table(&buffers.found, n_min)?;
    if choice == TableChoice::Only && !is_all {
        choice = TableChoice::Most;
    }
    let TableSelectionBuffers {
        region, occluded, ..
    } = buffers;
    let occluded = find_occluded_table(samples, &chosen.plane, config, n_min, region, occluded);
    if let Some(plane) = occluded {
        return outlined_table(
            samples,
            plane,
            RegionFilter::All,
            TableChoice::Around,
            buffers,
        );
    }
    outlined_table(
        samples,
        chosen.plane,
        RegionFilter::WideOnly,
        choice,
        buffers,
    )
}

/// Whether so much of what is left lies over a plane that a table may be there.
fn may_be_floor(samples: &Samples, found: &PlaneCandidate) -> bool {
    let height = AffineForm::from(&found.plane);
    let is_over = |&sample: &usize| {
        samples.is_unassigned(sample)
            && f64::from(samples.coordinate(&height, sample)) >= FLOOR_GAP_M
    };
    let n_over = (0..samples.len()).filter(is_over).count();
    n_over as f64 >= TABLE_SHARE_OF_FLOOR * found.n_samples as f64
}

/// The plane through its own largest through_largest_region part.
fn through_largest_region(
    samples: &Samples,
    plane: Plane,
    up_in_camera: Option<Unit<Vector3<f64>>>,
    n_min: usize,
    region: &mut PlaneRegionBuffers,
) -> PlaneCandidate {
    let plane_from_camera = plane.plane_from_source();
    let n_samples = find_region(
        samples,
        &plane,
        &plane_from_camera,
        RegionFilter::WideOnly,
        region,
    );
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

/// The most table-like of the planes; of several, the largest, unless a fairly
/// large one lies over it as a table over a floor.
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

/// The table of a plane that goes through its own region, with its polygon.
fn outlined_table(
    samples: &Samples,
    plane: Plane,
    parts: RegionFilter,
    choice: TableChoice,
    buffers: &mut TableSelectionBuffers,
) -> Option<Table> {
    let region = &mut buffers.region;
    let table_from_camera = plane.plane_from_source();
    let n_samples = find_region(samples, &plane, &table_from_camera, parts, region);
    let (mut polygon, mut outline) = match buffers.spare.take() {
        Some(spare) => (spare.polygon, spare.outline),
        None => Default::default(),
    };
    region_polygon(samples, region, &mut polygon, &mut outline);
    let table = Table {
        plane,
        table_from_camera,
        polygon,
        outline,
        choice,
        n_samples,
    };
    if table.polygon.corners().len() < 3 {
        buffers.spare = Some(table);
        return None;
    }
    Some(table)
}
