//! One frame, from cloud to candidates.

use crate::axis::Axis;
use crate::candidate::{Body, Candidate};
use crate::clusters::{Clusters, Parting, TrackClaims};
use crate::constraint_evaluation::{Judge, Limbs};
use crate::crew::{Alone, Crew, Desks};
use crate::islands::Islands;
use crate::outline::{Lattice, Outline};
use crate::piles::may_be_pile;
use crate::prism::{OverTable, Prism, SeenRectangle, lowest_m};
use crate::samples::Samples;
use crate::step::Step;
use crate::support::find_supports;
use crate::table_plane::{Table, TableBuffers, find_table};
use crate::table_surface::TableSurface;
use crate::unorganized::{self, detect_unorganized, has_no_grid};
use crate::{Config, Error, RawConfig};
use constraint::{Assumption, Assumptions, Constraint, ConstraintSet, Expression, Truth};
use geometry::{Capsule, OrientedBox};
use nalgebra::{Unit, Vector3};
use point_cloud::OrganizedCloud;
use random::Random;
use sensor_noise::depth_sigma_m;
use std::ops::Range;

/// Most points of a cloud: an image of 8192x8192.
const N_POINTS_MAX: usize = 1 << 26;

/// A candidate this near to the border of what is seen may be cut by it, pixels.
const BORDER_PX: usize = 3;

/// Points of the foot of an object lie this high over the table, metres, or so
/// many sigma of the depth noise where that is more.
const FOOT_HEIGHT_MIN_M: f32 = 0.0035;
const FOOT_SIGMAS: f32 = 1.3;
const FOOT_HEIGHT_MAX_M: f32 = 0.02;

/// The foot goes on across a step of depth up to this, metres at 1 m, growing
/// with squared depth: what stands behind is another foot.
const FOOT_STEP_M: f32 = 0.02;

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
    /// What else is known to be there.
    pub surroundings: Surroundings<'a>,
}

/// What is known to be there before the frame is searched, camera frame. The
/// default knows nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Surroundings<'a> {
    /// The bodies of people; `None` when nobody tells where people are.
    pub instructor: Option<&'a [Capsule]>,
    /// The links of the robot; `None` when nobody tells where it is.
    pub robot: Option<&'a [Capsule]>,
    /// The live tracks, predicted to this frame.
    pub tracks: &'a [ExpectedTrack],
}

/// A live track as it is expected in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectedTrack {
    /// Its box, camera frame.
    pub shape: OrientedBox,
    /// How many points it had when it was seen last; 0 for a box in which it may
    /// or may not be, by which no cluster is parted.
    pub n_points: usize,
}

impl From<OrientedBox> for ExpectedTrack {
    fn from(shape: OrientedBox) -> Self {
        Self { shape, n_points: 0 }
    }
}

/// What was found. Reused from frame to frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Detection {
    /// The table; without one there are no candidates.
    pub table: Option<Table>,
    /// All clusters with enough points, nearest first: also those that the rule
    /// ignores.
    pub candidates: Vec<Candidate>,
    /// What was taken for granted where a source was absent.
    pub assumptions: Assumptions,
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
    /// What lies over the table, by bands of the image and altogether.
    bands: Vec<Vec<u32>>,
    over_table: Vec<u32>,
    limbs: Limbs,
    of_limbs: Vec<u32>,
    /// Clusters of people and the robot; of this frame only where `of_limbs` is
    /// not empty.
    limb_clusters: Clusters,
    clusters: Clusters,
    partings: Desks<Parting>,
    track_claims: TrackClaims,
    islands: Islands,
    found_bodies: Desks<Vec<Body>>,
    bodies: Vec<Body>,
    judged: Desks<Vec<Candidate>>,
    pub(crate) unorganized: Option<Box<unorganized::Buffers>>,
}

impl Workspace {
    /// The pixels of a body.
    fn pixels(&self, body: &Body) -> &[u32] {
        let clusters = if body.is_limb {
            &self.limb_clusters
        } else {
            &self.clusters
        };
        clusters.pixels(body.cluster as usize)
    }
}

/// Searches a frame for a table and the objects on it, and judges what it finds.
///
/// Points may hold any bit pattern; those that are not finite, out of range or
/// absurdly far to the side are ignored. Allocates nothing once the buffers have
/// grown.
///
/// # Errors
/// When the cloud is larger than any image; `detection` is then left empty.
pub fn detect(
    frame: &Frame<'_>,
    config: &Config,
    workspace: &mut Workspace,
    detection: &mut Detection,
) -> Result<(), Error> {
    detect_in_steps(frame, config, workspace, detection, &Alone, &mut |_| {})
}

/// Like [`detect`], with the help of a crew, and tells when a step is over: who has a
/// clock may read it. In a cloud without a grid, and without a table, not all steps
/// are taken.
///
/// # Errors
/// As for [`detect`].
pub fn detect_in_steps(
    frame: &Frame<'_>,
    config: &Config,
    workspace: &mut Workspace,
    detection: &mut Detection,
    crew: &dyn Crew,
    on_step: &mut dyn FnMut(Step),
) -> Result<(), Error> {
    workspace.table.recycle(detection.table.take());
    detection.candidates.clear();
    detection.point_indices.clear();
    detection.assumptions = assumptions(frame);
    check_size(&frame.cloud)?;
    if has_no_grid(&frame.cloud) {
        detect_unorganized(frame, config, workspace, detection);
        return Ok(());
    }
    let raw = config.get();
    if let Some(table) = find_surface(frame, raw, workspace, on_step) {
        list_over(&frame.cloud, &table, raw, crew, workspace);
        on_step(Step::Prism);
        join(frame, &table, raw, crew, workspace);
        on_step(Step::Clusters);
        split_piles(&frame.cloud, &table, crew, workspace);
        on_step(Step::Piles);
        regroup_tracked(frame, workspace);
        on_step(Step::Regrouping);
        grow_feet(&frame.cloud, &table, workspace);
        on_step(Step::Feet);
        find_bodies(&frame.cloud, &table, raw, crew, workspace);
        on_step(Step::Boxes);
        write(frame, &table, config, crew, workspace, detection);
        detection.table = Some(table);
        on_step(Step::Judging);
    }
    Ok(())
}

/// The table of a frame, its cells and its outline.
fn find_surface(
    frame: &Frame<'_>,
    config: &RawConfig,
    workspace: &mut Workspace,
    on_step: &mut dyn FnMut(Step),
) -> Option<Table> {
    let Workspace {
        samples,
        table: buffers,
        surface,
        hull,
        lattice,
        ..
    } = workspace;
    samples.refill(&frame.cloud, config);
    on_step(Step::Samples);
    let mut random = Random::from_seed(frame.seed);
    let table = find_table(samples, frame.up_in_camera, config, &mut random, buffers);
    on_step(Step::TablePlane);
    let mut table = table?;
    surface.refill(&table, samples);
    if surface.has_holes() {
        std::mem::swap(&mut table.outline, hull);
        table.outline.trace(surface, hull, lattice);
    }
    on_step(Step::TableSurface);
    Some(table)
}

/// Lists the pixels over the table and on its islands.
fn list_over(
    cloud: &OrganizedCloud<'_>,
    table: &Table,
    config: &RawConfig,
    crew: &dyn Crew,
    workspace: &mut Workspace,
) {
    let Workspace {
        samples,
        surface,
        islands,
        bands,
        over_table,
        ..
    } = workspace;
    let height = Axis::of_transform(&table.table_from_camera)[2];
    islands.find(samples, &height, |z| {
        lowest_m(z, config.height_min_m as f32)
    });
    Prism::over(table, config, islands, surface).list(cloud, crew, bands, over_table);
}

fn assumptions(frame: &Frame<'_>) -> Assumptions {
    let mut assumptions = Assumptions::default();
    for (is_absent, assumption) in [
        (
            frame.surroundings.instructor.is_none(),
            Assumption::NoPersonKnown,
        ),
        (frame.surroundings.robot.is_none(), Assumption::NoRobotKnown),
        (frame.up_in_camera.is_none(), Assumption::UpGuessed),
    ] {
        if is_absent {
            assumptions.add(assumption);
        }
    }
    assumptions
}

/// Joins the points over the table to clusters: those of people and the robot
/// among themselves, so that no object melts with what touches it.
fn join(
    frame: &Frame<'_>,
    table: &Table,
    config: &RawConfig,
    crew: &dyn Crew,
    workspace: &mut Workspace,
) {
    let Workspace {
        over_table,
        limbs,
        of_limbs,
        limb_clusters,
        clusters,
        ..
    } = workspace;
    limbs.refill(&frame.surroundings, table, config);
    let tracks = frame.surroundings.tracks;
    limbs.separate(&frame.cloud, tracks, over_table, of_limbs);
    let n_min = (config.points_min_at_1m / (config.range_max_m * config.range_max_m)) as u32;
    clusters.join(&frame.cloud, crew, over_table, n_min);
    if !of_limbs.is_empty() {
        limb_clusters.join(&frame.cloud, crew, of_limbs, n_min);
    }
}

/// Parts the clusters that are several objects along their creases.
fn split_piles(
    cloud: &OrganizedCloud<'_>,
    table: &Table,
    crew: &dyn Crew,
    workspace: &mut Workspace,
) {
    let Workspace {
        clusters, partings, ..
    } = workspace;
    let table_axes = Axis::of_transform(&table.table_from_camera);
    let may_be_pile = |pixels: &[u32]| may_be_pile(cloud.points(), pixels, &table_axes);
    clusters.part_along_creases(cloud, crew, may_be_pile, partings);
}

/// Parts the clusters that are several tracked objects that have come together, and
/// joins those that are fragments of one.
fn regroup_tracked(frame: &Frame<'_>, workspace: &mut Workspace) {
    let Workspace {
        clusters,
        track_claims,
        ..
    } = workspace;
    let tracks = frame.surroundings.tracks;
    clusters.part_by_tracks(&frame.cloud, tracks, track_claims);
    clusters.join_by_tracks(&frame.cloud, tracks);
}

/// Lets the clusters grow down to the table.
fn grow_feet(cloud: &OrganizedCloud<'_>, table: &Table, workspace: &mut Workspace) {
    let height = Axis::of_transform(&table.table_from_camera)[2];
    let is_foot = |pixel: usize, above: usize| {
        let (point, above) = (&cloud.points()[pixel], &cloud.points()[above]);
        let lowest_m = FOOT_HEIGHT_MIN_M.max(FOOT_SIGMAS * depth_sigma_m(point.z));
        (point.z - above.z).abs() <= FOOT_STEP_M * point.z * point.z
            && (lowest_m..=FOOT_HEIGHT_MAX_M).contains(&height.at(point.x, point.y, point.z))
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

/// The clusters with enough points, nearest first, with what carries them.
fn find_bodies(
    cloud: &OrganizedCloud<'_>,
    table: &Table,
    config: &RawConfig,
    crew: &dyn Crew,
    workspace: &mut Workspace,
) {
    let Workspace {
        of_limbs,
        limb_clusters,
        clusters,
        found_bodies,
        bodies,
        surface,
        ..
    } = workspace;
    let table_axes = Axis::of_transform(&table.table_from_camera);
    let over_table = OverTable::new(table, surface);
    let n_limbs = if of_limbs.is_empty() {
        0
    } else {
        limb_clusters.len()
    };
    let limb = (0..n_limbs as u32).map(|cluster| (cluster, true));
    let all = (0..clusters.len() as u32).map(|cluster| (cluster, false));
    found_bodies.each(crew, all.chain(limb), |found, (cluster, is_limb)| {
        let own = if is_limb { &*limb_clusters } else { &*clusters };
        let pixels = own.pixels(cluster as usize);
        if over_table.holds(pixels, cloud)
            && let Some(body) = Body::of(cluster, pixels, cloud, &table_axes, config)
            && pixels.len() as f64 >= config.points_min_at_1m / body.summary.centroid.z.powi(2)
        {
            found.push(Body { is_limb, ..body });
        }
    });
    bodies.clear();
    found_bodies.gather(bodies);
    find_supports(cloud, clusters, &table.plane.normal, bodies);
    let distance = |body: &Body| body.summary.centroid.coords.norm_squared();
    bodies.sort_unstable_by(|a, b| {
        distance(a)
            .total_cmp(&distance(b))
            .then((a.is_limb, a.cluster).cmp(&(b.is_limb, b.cluster)))
    });
}

/// Judges the bodies and writes them as candidates.
fn write(
    frame: &Frame<'_>,
    table: &Table,
    config: &Config,
    crew: &dyn Crew,
    workspace: &mut Workspace,
    detection: &mut Detection,
) {
    let seen = SeenRectangle::of(&frame.cloud);
    let judge = Judge {
        cloud: frame.cloud,
        table,
        surroundings: frame.surroundings,
        limbs: &workspace.limbs,
        config: config.get(),
    };
    let indices = &mut detection.point_indices;
    for body in &workspace.bodies {
        indices.extend_from_slice(workspace.pixels(body));
    }
    let mut first = 0;
    let bodies = workspace.bodies.iter().map(|body| {
        let range = first..first + workspace.pixels(body).len();
        first = range.end;
        (body, range)
    });
    workspace
        .judged
        .each(crew, bodies, |candidates, (body, range)| {
            let pixels = &indices[range.clone()];
            let is_cut = seen.is_reached_by(&body.summary.seen, BORDER_PX);
            candidates.push(judged(body, range, pixels, is_cut, &judge, config.rule()));
        });
    workspace.judged.gather(&mut detection.candidates);
    let first = |candidate: &Candidate| candidate.range.start;
    detection.candidates.sort_unstable_by_key(first);
}

/// The candidate that a body is, with what the rule says of it.
pub(crate) fn judged(
    body: &Body,
    range: Range<usize>,
    indices: &[u32],
    is_cut: bool,
    judge: &Judge<'_>,
    rule: &Expression,
) -> Candidate {
    let oriented_box = body.upright_box.in_camera(&judge.table.table_from_camera);
    let findings = judge.findings(body, &oriented_box, indices, is_cut);
    let (verdict, decisive) = if body.is_object_sized {
        (rule.evaluate(&findings), rule.decisive(&findings))
    } else {
        (Truth::False, ConstraintSet::from(Constraint::Size))
    };
    Candidate {
        range,
        centroid: body.summary.centroid,
        oriented_box,
        unseen_foot_m: body.unseen_foot_m(),
        mean_rgb: body.summary.mean_rgb,
        support: body.support,
        touches_image_border: is_cut,
        is_object_sized: body.is_object_sized,
        findings,
        verdict,
        decisive,
    }
}
