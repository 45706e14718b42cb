//! Which plane is the table.

use crate::RawConfig;
use crate::axis::Axis;
use crate::outline::Outline;
use crate::plane_search::{NormalLimit, SearchBuffers, largest_plane};
use crate::samples::Samples;
use crate::table_region::{Parts, RegionBuffers, find_region, region_moments, region_polygon};
use crate::table_under::{UnderBuffers, table_under};
use geometry::{ConvexPolygon, Plane, RigidTransform};
use nalgebra::{Point2, Point3, Unit, Vector3};
use random::Random;
use std::fmt;

/// Planes looked at in one image, at most.
const N_PLANES_MAX: usize = 5;

/// A plane needs this share of the image's samples.
const SHARE_MIN: f64 = 0.02;

/// A table with this share of the samples in range ends the search, unless
/// enough is over it to be a table over a floor.
const SHARE_CLEAR: f64 = 0.5;

/// A plane this far under another one, seen by the same camera, is the floor
/// under the table, metres; the tops of objects are nearer to their table.
pub(crate) const FLOOR_GAP_M: f64 = 0.35;

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

/// A table found in an image.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The plane, camera frame; its positive side holds the camera, or is up in a
    /// cloud that no single camera has seen.
    pub plane: Plane,
    /// The frame of the table: z along the normal, heights over the table.
    pub table_from_camera: RigidTransform,
    /// Convex hull of the part of the table that is seen, in the table's frame.
    pub polygon: ConvexPolygon,
    /// The same without what is seen to be no table, as in the corner of an L.
    pub outline: Outline,
    /// Why this and no other plane of the image is the table.
    pub choice: TableChoice,
    /// Number of samples of the thinned image on the table.
    pub n_samples: usize,
}

impl Table {
    /// Distance of a place on the table, in the table's frame, from the rim,
    /// metres; see [`Outline::rim_distance_m`].
    pub fn rim_distance_m(&self, place: &Point2<f64>) -> f64 {
        self.outline.rim_distance_m(place)
    }
}

/// Why a surface is the table. Two tables of one height are two surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableChoice {
    /// No other surface could be a table.
    Only,
    /// It shows so much of itself that no other was looked for.
    Most,
    /// It shows more of itself than the others.
    Largest {
        /// How many others there are.
        n_others: usize,
    },
    /// It lies over a larger one, which is the floor or a lower table.
    OverLarger {
        /// How many others there are.
        n_others: usize,
    },
    /// It is seen around a larger surface a little over it, the top of an object.
    Around,
}

impl fmt::Display for TableChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let others = |n: usize| if n == 1 { "surface" } else { "surfaces" };
        match *self {
            Self::Only => write!(f, "the only surface that can be a table"),
            Self::Around => write!(f, "around the top of an object that covers most of it"),
            Self::Most => write!(f, "most of what is in range"),
            Self::Largest { n_others: n } => {
                write!(f, "larger than {n} other {} that can be a table", others(n))
            }
            Self::OverLarger { n_others: n } => write!(
                f,
                "over a larger one, of {n} other {} that can be a table",
                others(n)
            ),
        }
    }
}

/// Buffers of the search.
#[derive(Debug, Default)]
pub(crate) struct TableBuffers {
    pub(crate) search: SearchBuffers,
    pub(crate) region: RegionBuffers,
    found: Vec<FoundPlane>,
    pub(crate) under: UnderBuffers,
    /// The table of an earlier frame, whose memory the next one takes.
    spare: Option<Table>,
}

impl TableBuffers {
    /// Takes back the memory of a table that is not needed any more.
    pub(crate) fn recycle(&mut self, table: Option<Table>) {
        self.spare = table.or(self.spare.take());
    }
}

#[derive(Debug, Clone, Copy)]
struct FoundPlane {
    plane: Plane,
    n_samples: usize,
    /// Number of its parts that are large enough for a table.
    n_surfaces: usize,
    likeness: Likeness,
}

/// How much a plane's direction resembles that of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Likeness {
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
pub(crate) fn find_table(
    samples: &mut Samples,
    up_in_camera: Option<Unit<Vector3<f64>>>,
    config: &RawConfig,
    random: &mut Random,
    buffers: &mut TableBuffers,
) -> Option<Table> {
    let limit = up_in_camera.map(|up| NormalLimit {
        up,
        cos_min: config.table_tilt_max_rad.cos(),
    });
    let n_min = ((samples.len() as f64 * SHARE_MIN) as usize).max(8);
    let n_clear =
        ((0..samples.len()).filter(|&i| samples.is_free(i)).count() as f64 * SHARE_CLEAR) as usize;
    buffers.found.clear();
    let mut is_all = true;
    for _ in 0..N_PLANES_MAX {
        let Some(plane) =
            largest_plane(samples, limit.as_ref(), n_min, random, &mut buffers.search)
        else {
            break;
        };
        let found = connected(samples, plane, up_in_camera, n_min, &mut buffers.region);
        samples.take_inliers(&Axis::from(&plane));
        buffers.found.push(found);
        if found.likeness == Likeness::Likely
            && found.n_samples >= n_clear
            && !may_be_floor(samples, &found)
        {
            is_all = false;
            break;
        }
    }
    samples.free_all(config);
    let (chosen, mut choice) = choose(&buffers.found, n_min)?;
    if choice == TableChoice::Only && !is_all {
        choice = TableChoice::Most;
    }
    if let Some(plane) = table_under(samples, &chosen.plane, config, n_min, buffers) {
        return outlined(samples, plane, Parts::All, TableChoice::Around, buffers);
    }
    outlined(samples, chosen.plane, Parts::Wide, choice, buffers)
}

/// Whether so much of what is left lies over a plane that a table may be there.
fn may_be_floor(samples: &Samples, found: &FoundPlane) -> bool {
    let height = Axis::from(&found.plane);
    let is_over = |&sample: &usize| {
        samples.is_free(sample) && f64::from(samples.along(&height, sample)) >= FLOOR_GAP_M
    };
    let n_over = (0..samples.len()).filter(is_over).count();
    n_over as f64 >= TABLE_SHARE_OF_FLOOR * found.n_samples as f64
}

/// The plane through its own largest connected part.
fn connected(
    samples: &Samples,
    plane: Plane,
    up_in_camera: Option<Unit<Vector3<f64>>>,
    n_min: usize,
    region: &mut RegionBuffers,
) -> FoundPlane {
    let plane_from_camera = plane.plane_from_source();
    let n_samples = find_region(samples, &plane, &plane_from_camera, Parts::Wide, region);
    let plane = region_plane(samples, region).unwrap_or(plane);
    FoundPlane {
        plane,
        n_samples,
        n_surfaces: region.n_of_at_least(n_min),
        likeness: likeness(&plane, up_in_camera),
    }
}

pub(crate) fn region_plane(samples: &Samples, region: &RegionBuffers) -> Option<Plane> {
    let axes = region_moments(samples, region).principal_axes()?;
    let normal = Unit::try_new(axes.axes.column(2).into_owned(), 0.5)?;
    Some(Plane::through(&axes.centroid, normal).facing(&Point3::origin()))
}

fn likeness(plane: &Plane, up_in_camera: Option<Unit<Vector3<f64>>>) -> Likeness {
    let n = &plane.normal;
    let is_likely = up_in_camera.map_or_else(
        || -n.y >= UPWARD_MIN && n.x.abs() <= SIDEWARD_MAX,
        |up| n.dot(&up) > 0.0,
    );
    if is_likely {
        Likeness::Likely
    } else if up_in_camera.is_none() && -n.z >= FROM_ABOVE_MIN {
        Likeness::Possible
    } else {
        Likeness::None
    }
}

/// The most table-like of the planes; of several, the largest, unless a fairly
/// large one lies over it as a table over a floor.
fn choose(found: &[FoundPlane], n_min: usize) -> Option<(FoundPlane, TableChoice)> {
    let large = || found.iter().filter(|plane| plane.n_samples >= n_min);
    let likeness = large().map(|plane| plane.likeness).max()?;
    if likeness == Likeness::None {
        return None;
    }
    let tables = || large().filter(|plane| plane.likeness == likeness);
    let n_others = tables().map(|plane| plane.n_surfaces).sum::<usize>() - 1;
    let mut choice = match n_others {
        0 => TableChoice::Only,
        n_others => TableChoice::Largest { n_others },
    };
    let mut chosen = *tables().max_by_key(|plane| plane.n_samples)?;
    while let Some(upper) = tables()
        .filter(|plane| lies_over(plane, &chosen))
        .max_by_key(|plane| plane.n_samples)
    {
        chosen = *upper;
        choice = TableChoice::OverLarger { n_others };
    }
    Some((chosen, choice))
}

fn lies_over(upper: &FoundPlane, lower: &FoundPlane) -> bool {
    let gap_m = lower.plane.offset_m - upper.plane.offset_m;
    gap_m >= FLOOR_GAP_M
        && upper.plane.normal.dot(&lower.plane.normal) > 0.94
        && upper.n_samples as f64 >= TABLE_SHARE_OF_FLOOR * lower.n_samples as f64
}

/// The table of a plane that goes through its own region, with its polygon.
fn outlined(
    samples: &Samples,
    plane: Plane,
    parts: Parts,
    choice: TableChoice,
    buffers: &mut TableBuffers,
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
