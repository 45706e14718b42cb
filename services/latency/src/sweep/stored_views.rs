//! Synthetic memory: stores taught views for a daemon that is not running yet.
//!
//! The views are of solids with random sides, colours and orientations, described as the daemon
//! describes real views, so that their descriptors are spread realistically.

use description::{AppearanceDescriptor, AppearanceWeights, ObjectPoints};
use geometry::OrientedBox;
use learning::DESCRIPTOR_KIND;
use learning::{CategoryName, ViewId};
use nalgebra::{Isometry3, UnitVector3, Vector3};
use perceptual_memory::{
    CapturedView, Mutation, MutationId, Requester, RetentionLimits, StoreChange, StoreConfig,
    StoreHandle, StoreThread, StoredDescriptor, WRITE_BUFFER_BYTES,
};
use point_cloud::{Point, Rgba};
use random::Random;
use service::{Failure, Home};
use std::f64::consts::TAU;
use std::fmt::Display;
use std::path::Path;

/// Points on the visible side of a solid.
const N_POINTS: usize = 400;
/// Minimum number of tracks, if there are enough views, and maximum number of views of a track.
/// Views of a track are taught together; each mutation waits for the disk.
const N_TRACKS_MIN: usize = 20;
const VIEWS_PER_TRACK_MAX: usize = 100;
/// Number of categories, large enough that none reaches the memory's limit.
const N_CATEGORIES: usize = 200;
/// Capacity of the store's request queue.
const QUEUE: usize = 16;

fn failed(error: impl Display) -> Failure {
    let sentence = format!("the views to be compared with could not be stored: {error}");
    Failure::general(sentence)
}

/// Stores and teaches `n_views` views in a daemon's home; returns the last sequence number of the
/// memory's history.
///
/// # Errors
/// If the memory cannot be written.
pub(super) fn store(home: &Path, n_views: usize) -> Result<u64, Failure> {
    let config = StoreConfig {
        folder: Home::at(home.to_owned()).perceptual_memory(),
        queue_capacity: QUEUE,
        limits: RetentionLimits::default(),
        write_buffer_bytes: WRITE_BUFFER_BYTES,
        wall_clock: || 1,
        on_reopened: Box::new(|_| ()),
        on_notice: Box::new(|_| ()),
    };
    let (thread, store, _) = StoreThread::start(config).map_err(failed)?;
    let per_track = (n_views / N_TRACKS_MIN).clamp(1, VIEWS_PER_TRACK_MAX);
    let n_tracks = n_views.div_ceil(per_track);
    let first_track = store
        .lease_track_ids_and_wait(n_tracks as u64)
        .map_err(failed)?;
    let mut appearance = AppearanceDescriptor::new(AppearanceWeights::default()).map_err(failed)?;
    for track in 0..n_tracks {
        let n_of_track = per_track.min(n_views - track * per_track);
        let track_id = first_track + track as u64;
        let views = views(track, track_id, n_of_track, &mut appearance)?;
        change(&store, StoreChange::StoreViews(views))?;
        let name = format!("solid {}", track % N_CATEGORIES);
        let category = CategoryName::new(&name).map_err(failed)?;
        change(&store, StoreChange::Teach { track_id, category })?;
    }
    let sequence = store
        .read_and_wait(|memory| Ok(memory.sequence()))
        .map_err(failed)?;
    thread.stop().map_err(failed)?;
    Ok(sequence)
}

fn change(store: &StoreHandle, change: StoreChange) -> Result<(), Failure> {
    let mutation = Mutation {
        id: MutationId::random().map_err(failed)?,
        author: "tabula-latency".to_owned(),
        requester: Requester::default(),
        wall_ns: 1,
        change,
    };
    store.mutate_and_wait(mutation).map_err(failed)?;
    Ok(())
}

/// Views of one solid, each with a random orientation.
fn views(
    track: usize,
    track_id: u64,
    n_views: usize,
    appearance: &mut AppearanceDescriptor,
) -> Result<Vec<CapturedView>, Failure> {
    let mut random = Random::from_seed(track as u64);
    let solid = RandomSolid::of_category(track % N_CATEGORIES, &mut random);
    (0..n_views as u32)
        .map(|view_id| {
            let cloud = solid.visible_points(&mut random);
            let up = UnitVector3::new_unchecked(Vector3::z());
            let readings = appearance.describe(ObjectPoints::all(&cloud), Some(&up));
            Ok(CapturedView {
                id: ViewId { track_id, view_id },
                descriptor: StoredDescriptor {
                    kind: DESCRIPTOR_KIND.to_owned(),
                    values: readings.map_err(failed)?[0].clone(),
                },
                box_in_world: OrientedBox {
                    frame_from_box: Isometry3::identity(),
                    half_sides_m: solid.half_sides_m,
                },
                captured_ns: track_id,
                frame_sequence: u64::from(view_id),
                source: "solids".to_owned(),
                mean_rgb: None,
                points: None,
            })
        })
        .collect()
}

/// Box or ellipsoid of one colour.
struct RandomSolid {
    half_sides_m: Vector3<f64>,
    is_round: bool,
    rgb: [f64; 3],
}

impl RandomSolid {
    /// Random solid of a category: sides vary by 10 %, colour slightly.
    fn of_category(category: usize, random: &mut Random) -> Self {
        let mut of_category = Random::from_seed(0x5eed_0000 + category as u64);
        let mut side = || {
            let usual = 0.02 + 0.08 * of_category.unit();
            usual * (0.95 + 0.1 * random.unit())
        };
        let half_sides_m = Vector3::new(side(), side(), side());
        let is_round = of_category.unit() < 0.5;
        let mut channel = || 20.0 + 200.0 * of_category.unit() + 15.0 * random.unit();
        Self {
            half_sides_m,
            is_round,
            rgb: [channel(), channel(), channel()],
        }
    }

    /// Points on the side visible to a camera in front of and above the solid.
    fn visible_points(&self, random: &mut Random) -> Vec<Point> {
        let turn = TAU * random.unit();
        let towards_camera = Vector3::new(turn.cos(), turn.sin(), 0.7);
        let mut points = Vec::with_capacity(N_POINTS);
        while points.len() < N_POINTS {
            let (place, normal) = self.on_surface(random);
            if normal.dot(&towards_camera) > 0.0 {
                let [red, green, blue] = self
                    .rgb
                    .map(|channel| (channel + 10.0 * random.unit()) as u8);
                points.push(Point {
                    x: place.x as f32,
                    y: place.y as f32,
                    z: place.z as f32,
                    color: Rgba::opaque(red, green, blue),
                });
            }
        }
        points
    }

    /// Random point on the solid's surface with its outward normal.
    fn on_surface(&self, random: &mut Random) -> (Vector3<f64>, Vector3<f64>) {
        let mut direction = Vector3::from_fn(|_, _| 2.0 * random.unit() - 1.0);
        if self.is_round {
            let unit = direction.normalize();
            let normal = unit.component_div(&self.half_sides_m);
            return (unit.component_mul(&self.half_sides_m), normal);
        }
        let axis = (3.0 * random.unit()) as usize % 3;
        let sign = direction[axis].signum();
        direction[axis] = sign;
        let mut normal = Vector3::zeros();
        normal[axis] = sign;
        (direction.component_mul(&self.half_sides_m), normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requested_number_of_views_is_taught() {
        let home = tempfile::tempdir().unwrap();
        let sequence = store(home.path(), 45).unwrap();
        assert_eq!(sequence, 46, "23 tracks, each stored and taught");
    }

    #[test]
    fn views_of_a_category_are_nearest_to_each_other() {
        let mut appearance = AppearanceDescriptor::new(AppearanceWeights::default()).unwrap();
        let mut descriptor = |track: usize| {
            let views = views(track, 1, 1, &mut appearance).unwrap();
            views[0].descriptor.values.clone()
        };
        let distance =
            |a: &[f32], b: &[f32]| -> f32 { a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum() };
        let nearer = (0..20).filter(|&category| {
            let own = descriptor(category);
            let same = descriptor(category + N_CATEGORIES);
            distance(&own, &same) < distance(&own, &descriptor(category + 1))
        });
        assert!(nearer.count() >= 16);
    }
}
