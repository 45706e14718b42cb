//! Crowded table tops: stacks, bridges, filled containers, leaning and overhanging objects.
//!
//! Objects are planned in groups, supports first. A plan holds position and orientation; the
//! height follows when the world lowers the object onto what is there.

mod clutter_group;
mod clutter_setting;

use crate::error::Error;
use crate::furniture::TableDimensions;
use crate::model_choice::{ModelChoice, ModelSource};
use crate::model_library::ModelLibrary;
use crate::object_model::ObjectModel;
use crate::random_stream::{random_rotation, random_stream};
use crate::scene::{ObjectPlacement, ObjectPlan};
pub(crate) use clutter_setting::{clutter_camera, clutter_table, clutter_table_finish};
use nalgebra::{UnitQuaternion, Vector2, Vector3};
use random::Random;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// Random stream of the choice of groups, models and positions.
const STREAM_CLUTTER: u64 = 11;
/// Random stream of the centre of the crowd.
const STREAM_CENTRE: u64 = 12;
/// Distance between the table's edge and the centre of the crowd, metres. Chosen.
const CENTRE_FROM_RIM_M: [f64; 2] = [0.12, 0.45];
/// Area of the table for each object, square metres: densest and loosest crowd. Chosen, from
/// pictures of mOSD `test` (Richtsfeld et al. 2012).
const AREA_PER_OBJECT_M2: [f64; 2] = [0.008, 0.020];
/// Share of the half diagonal at which two groups count as overlapping. Chosen.
const TOUCHING_SHARE: f64 = 0.75;
/// Number of positions of which the best is taken. Chosen.
const N_POSITIONS: usize = 24;

/// Face on which an object is laid down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Resting {
    /// Upright as the model is.
    Upright,
    /// Upside down.
    Inverted,
    /// Shortest side of the bounding box vertical.
    Flat,
    /// Middle side of the bounding box vertical.
    OnEdge,
    /// Longest side of the bounding box vertical.
    OnEnd,
}

impl Resting {
    /// Axis of the model that becomes vertical.
    fn axis(self, half_sides_m: &Vector3<f64>) -> usize {
        let mut axes = [2, 1, 0];
        axes.sort_by(|&a, &b| half_sides_m[a].total_cmp(&half_sides_m[b]));
        match self {
            Self::Upright | Self::Inverted => 2,
            Self::Flat => axes[0],
            Self::OnEdge => axes[1],
            Self::OnEnd => axes[2],
        }
    }

    /// Rotation of the model before the yaw, and its half sides afterwards.
    fn rotated(self, half_sides_m: &Vector3<f64>) -> (UnitQuaternion<f64>, Vector3<f64>) {
        let half = half_sides_m;
        let (axis, angle_rad, sides) = match (self, self.axis(half)) {
            (Self::Inverted, _) => (Vector3::x_axis(), PI, *half),
            (_, 0) => (
                Vector3::y_axis(),
                -FRAC_PI_2,
                Vector3::new(half.z, half.y, half.x),
            ),
            (_, 1) => (
                Vector3::x_axis(),
                FRAC_PI_2,
                Vector3::new(half.x, half.z, half.y),
            ),
            _ => (Vector3::x_axis(), 0.0, *half),
        };
        (UnitQuaternion::from_axis_angle(&axis, angle_rad), sides)
    }
}

/// Model in a resting orientation, before its yaw and position are known.
#[derive(Debug, Clone)]
struct OrientedModel {
    choice: ModelChoice,
    rotation: UnitQuaternion<f64>,
    half_sides_m: Vector3<f64>,
}

impl OrientedModel {
    fn new(choice: ModelChoice, model: &ObjectModel, resting: Resting) -> Self {
        let (rotation, half_sides_m) = resting.rotated(&model.half_sides_m);
        Self {
            choice,
            rotation,
            half_sides_m,
        }
    }

    fn half_diagonal_m(&self) -> f64 {
        self.half_sides_m.x.hypot(self.half_sides_m.y)
    }

    fn short_half_side_m(&self) -> f64 {
        self.half_sides_m.x.min(self.half_sides_m.y)
    }
}

/// Planned object that may carry others, with its position on the table and its yaw.
#[derive(Debug, Clone)]
struct PlannedSupport {
    object: OrientedModel,
    position_m: Vector2<f64>,
    yaw_rad: f64,
}

/// Planner of one crowd: places groups of objects until the requested number is reached.
struct ClutterPlanner<'a> {
    random: Random,
    library: &'a mut ModelLibrary,
    table: TableDimensions,
    centre_m: Vector2<f64>,
    reach_m: f64,
    n_objects: usize,
    plans: Vec<ObjectPlan>,
    /// Position and radius of the groups on the table.
    taken: Vec<(Vector2<f64>, f64)>,
}

/// Plans a crowded table of `n_objects`, in the order in which they are put down.
///
/// # Errors
/// An error of an unusable model.
pub(crate) fn clutter(
    table: &TableDimensions,
    n_objects: usize,
    seed: u64,
    library: &mut ModelLibrary,
) -> Result<Vec<ObjectPlan>, Error> {
    let mut random = random_stream(seed, STREAM_CLUTTER);
    let [dense, loose] = AREA_PER_OBJECT_M2;
    let area_m2 = n_objects as f64 * random.between(dense, loose);
    let centre_m = crowd_centre(seed, table);
    let files = match library.source() {
        ModelSource::Generated => Vec::new(),
        ModelSource::Folder(_) => library.choose(n_objects, seed),
    };
    let mut planner = ClutterPlanner {
        random,
        library,
        table: *table,
        centre_m,
        reach_m: (area_m2 / PI).sqrt(),
        n_objects,
        plans: Vec::new(),
        taken: Vec::new(),
    };
    if files.is_empty() {
        planner.place_groups()?;
    } else {
        planner.place_files(files)?;
    }
    Ok(planner.plans)
}

/// Centre of the crowd on the table, world x and y.
fn crowd_centre(seed: u64, table: &TableDimensions) -> Vector2<f64> {
    let mut random = random_stream(seed, STREAM_CENTRE);
    let [near, far] = CENTRE_FROM_RIM_M;
    let from_rim_m = random.between(near, far);
    let coordinate = |size_m: f64, random: &mut Random| {
        let half_m = (size_m / 2.0 - from_rim_m).clamp(0.0, 0.55);
        random.between(-half_m, half_m)
    };
    let x = coordinate(table.size_m[0], &mut random);
    Vector2::new(x, coordinate(table.size_m[1], &mut random))
}

impl ClutterPlanner<'_> {
    fn is_full(&self) -> bool {
        self.plans.len() >= self.n_objects
    }

    /// Random model of one of the categories, in a resting orientation.
    fn generated(&mut self, categories: &[&str], resting: Resting) -> Result<OrientedModel, Error> {
        let category = self.random.choice(categories).copied().unwrap_or("carton");
        let choice = ModelChoice::Generated {
            category: category.to_owned(),
            instance: self.random.next_u64() % 100_000,
        };
        let model = self.library.load(&choice)?;
        Ok(OrientedModel::new(choice, &model, resting))
    }

    /// Random model whose footprint fits a support; the last of several tries otherwise.
    fn generated_within(
        &mut self,
        categories: &[&str],
        resting: Resting,
        half_m: f64,
    ) -> Result<OrientedModel, Error> {
        let mut found = self.generated(categories, resting)?;
        for _ in 0..5 {
            if found.short_half_side_m() <= half_m {
                break;
            }
            found = self.generated(categories, resting)?;
        }
        Ok(found)
    }

    /// Adds an object unless the scene is full.
    fn put(
        &mut self,
        object: &OrientedModel,
        position_m: Vector2<f64>,
        yaw_rad: f64,
    ) -> PlannedSupport {
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_rad);
        self.put_rotated(&object.choice, position_m, yaw * object.rotation);
        PlannedSupport {
            object: object.clone(),
            position_m,
            yaw_rad,
        }
    }

    fn put_rotated(
        &mut self,
        choice: &ModelChoice,
        position_m: Vector2<f64>,
        rotation: UnitQuaternion<f64>,
    ) {
        if self.is_full() {
            return;
        }
        self.plans.push(ObjectPlan {
            model: choice.clone(),
            placement: ObjectPlacement::Lowered {
                position_m: position_m.into(),
                rotation,
            },
        });
    }

    /// Puts the lowest object of a group onto the table, at a free position near the centre.
    fn put_on_table(&mut self, object: &OrientedModel, group_radius_m: f64) -> PlannedSupport {
        let position_m = self.table_position(group_radius_m * TOUCHING_SHARE);
        let yaw_rad = self.random.between(-PI, PI);
        self.taken
            .push((position_m, group_radius_m * TOUCHING_SHARE));
        self.put(object, position_m, yaw_rad)
    }

    /// Puts an object onto a support, off its middle by up to `off` of the support's half sides.
    fn put_on(
        &mut self,
        object: &OrientedModel,
        support: &PlannedSupport,
        yaw_rad: f64,
        off: f64,
    ) -> PlannedSupport {
        let half = support.object.half_sides_m.xy();
        let offset = half.map(|half| self.random.between(-off, off) * half);
        let position_m = support.position_m + nalgebra::Rotation2::new(support.yaw_rad) * offset;
        self.put(object, position_m, yaw_rad)
    }

    /// Yaw on a support: flush with it, or turned.
    fn yaw_on(&mut self, support: &PlannedSupport, flush_share: f64) -> f64 {
        if self.random.unit() < flush_share {
            support.yaw_rad + self.random.between(-0.05, 0.05)
        } else {
            self.random.between(-PI, PI)
        }
    }

    /// Position in the crowd that overlaps the groups there least; of the free ones the one
    /// nearest to the centre.
    fn table_position(&mut self, radius_m: f64) -> Vector2<f64> {
        let mut best = (f64::MAX, self.centre_m);
        for _ in 0..N_POSITIONS {
            let (angle, reach_m) = (
                self.random.between(0.0, TAU),
                self.reach_m * self.random.unit().sqrt(),
            );
            let position_m =
                self.on_table(self.centre_m + Vector2::new(angle.cos(), angle.sin()) * reach_m);
            let overlap_m = |(other, other_radius_m): &(Vector2<f64>, f64)| {
                (radius_m + other_radius_m - (position_m - other).norm()).max(0.0)
            };
            let overlap_m: f64 = self.taken.iter().map(overlap_m).sum();
            let cost = 10.0 * overlap_m + (position_m - self.centre_m).norm();
            if cost < best.0 {
                best = (cost, position_m);
            }
        }
        best.1
    }

    /// Nearest position whose object does not fall off the table.
    fn on_table(&self, position_m: Vector2<f64>) -> Vector2<f64> {
        let half = self.table.size_m.map(|side| (side / 2.0 - 0.06).max(0.0));
        Vector2::new(
            position_m.x.clamp(-half[0], half[0]),
            position_m.y.clamp(-half[1], half[1]),
        )
    }

    /// Crowd of model files: on the table, on each other, or dropped between the others.
    fn place_files(&mut self, choices: Vec<ModelChoice>) -> Result<(), Error> {
        let mut models: Vec<(ModelChoice, Arc<ObjectModel>)> = Vec::new();
        for choice in choices {
            let model = self.library.load(&choice)?;
            models.push((choice, model));
        }
        let mut supports: Vec<PlannedSupport> = Vec::new();
        for (choice, model) in models {
            let resting = match self.random.below(10) {
                0..6 => Resting::Upright,
                6..8 => Resting::Flat,
                8 => Resting::OnEdge,
                _ => Resting::Inverted,
            };
            let object = OrientedModel::new(choice, &model, resting);
            let draw = self.random.unit();
            let at = self.random.below(supports.len().max(1));
            let support = supports.get(at).cloned();
            match support {
                Some(support) if draw < 0.4 => {
                    let yaw_rad = self.yaw_on(&support, 0.3);
                    supports.push(self.put_on(&object, &support, yaw_rad, 0.4));
                }
                Some(support) if draw < 0.55 => self.put_dropped_beside(&object, &support),
                _ => {
                    let radius_m = object.half_diagonal_m();
                    supports.push(self.put_on_table(&object, radius_m));
                }
            }
        }
        Ok(())
    }

    /// Drops an object in a random orientation against a support.
    fn put_dropped_beside(&mut self, object: &OrientedModel, support: &PlannedSupport) {
        let angle = self.random.between(0.0, TAU);
        let reach_m = support.object.half_diagonal_m() * 0.8;
        let position_m = support.position_m + Vector2::new(angle.cos(), angle.sin()) * reach_m;
        let rotation = random_rotation(&mut self.random);
        self.put_rotated(&object.choice, self.on_table(position_m), rotation);
    }
}
