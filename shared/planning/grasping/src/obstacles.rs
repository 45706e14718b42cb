//! Obstacles: measured voxels in a bounding volume hierarchy, people, and support surfaces.

use crate::grasp_scene::GraspScene;
use geometry::{Capsule as BodyCapsule, OrientedBox, RigidTransform};
use nalgebra::{Point3, Vector3};
use parry3d::bounding_volume::Aabb;
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::query::details::intersection_test_cuboid_cuboid;
use parry3d::query::intersection_test;
use parry3d::shape::{Capsule, Cuboid};
use std::collections::BTreeMap;

/// Side of the voxels, metres.
const VOXEL_M: f64 = 0.010;
/// Distance around the objects within which voxels are kept, metres: the hand and its way.
const MARGIN_M: f64 = 0.30;
/// Distance from the robot's links within which a measured place is the robot, metres.
const ROBOT_MARGIN_M: f64 = 0.03;
/// Pixels of the image are taken in steps of this: closer than voxels at a metre.
const STEP_PX: usize = 2;

/// Distance from an object in the image within which a pixel without an owner shows the object: its depth
/// is mixed with that of what is behind, pixels. Chosen: three times the width of a Kinect's mixed edges.
const MIXED_PX: usize = 4;

/// Thing that a hand would hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Obstacle {
    /// Object with this index in the scene.
    Object(usize),
    /// Support surface with this index in the scene.
    Surface(usize),
    /// Body of a person.
    Person,
    /// Something measured that is neither object nor surface, such as a wall.
    Other,
}

impl Obstacle {
    /// Name of the thing for people, such as `track 4` or `the table`.
    pub fn name(self, scene: &GraspScene<'_>) -> String {
        match self {
            Self::Object(index) => format!("track {}", scene.objects[index].track),
            Self::Surface(index) => scene.surfaces[index].name.clone(),
            Self::Person => "a person".to_owned(),
            Self::Other => "something that is no object".to_owned(),
        }
    }
}

/// Obstacles of a scene.
pub struct Obstacles {
    voxels: Vec<(Point3<f64>, Obstacle)>,
    tree: Bvh,
    people: Vec<BodyCapsule>,
}

impl Obstacles {
    /// Obstacles around all objects of a scene.
    pub fn of(scene: &GraspScene<'_>) -> Self {
        Self::within(scene, &bounds(scene))
    }

    /// Obstacles between two corners.
    pub fn within(scene: &GraspScene<'_>, region: &[Point3<f64>; 2]) -> Self {
        Self::of_voxels(measured_voxels(scene, region), scene)
    }

    /// Obstacles between two corners, but for those within a margin of a body, metres: an object in the
    /// hand, by whatever name it is seen.
    pub fn beside(
        scene: &GraspScene<'_>,
        region: &[Point3<f64>; 2],
        (body, margin_m): (&OrientedBox, f64),
    ) -> Self {
        let mut owners = measured_voxels(scene, region);
        owners.retain(|cell, _| !body.contains(&middle_of(cell), margin_m));
        Self::of_voxels(owners, scene)
    }

    fn of_voxels(owners: BTreeMap<[i32; 3], Obstacle>, scene: &GraspScene<'_>) -> Self {
        let voxels: Vec<(Point3<f64>, Obstacle)> = owners
            .into_iter()
            .map(|(cell, owner)| (middle_of(&cell), owner))
            .collect();
        let half = Vector::splat(VOXEL_M as f32 / 2.0);
        let leaves: Vec<Aabb> = voxels
            .iter()
            .map(|(middle, _)| Aabb::from_half_extents(vector(&middle.coords), half))
            .collect();
        Self {
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves),
            voxels,
            people: scene.people.clone(),
        }
    }

    /// First thing that a box would hit, people first; `is_ignored` says what does not count.
    pub fn hit_by(
        &self,
        body: &OrientedBox,
        is_ignored: impl Fn(Obstacle) -> bool,
    ) -> Option<Obstacle> {
        let (pose, cuboid) = shape(body);
        if self
            .people
            .iter()
            .any(|person| meets_capsule(&pose, &cuboid, &capsule(person)))
        {
            return Some(Obstacle::Person);
        }
        self.first_voxel(&cuboid.aabb(&pose), is_ignored, |at, voxel| {
            intersection_test_cuboid_cuboid(&pose.inv_mul(at), &cuboid, voxel)
        })
    }

    /// First thing that a capsule, such as a link of the arm, would hit, people first.
    pub fn hit_by_link(
        &self,
        link: &BodyCapsule,
        is_ignored: impl Fn(Obstacle) -> bool,
    ) -> Option<Obstacle> {
        let capsule = capsule(link);
        let meets = |person: &BodyCapsule| capsules_meet(&capsule, &self::capsule(person));
        if self.people.iter().any(meets) {
            return Some(Obstacle::Person);
        }
        self.first_voxel(&capsule.local_aabb(), is_ignored, |at, voxel| {
            meets_capsule(at, voxel, &capsule)
        })
    }

    /// Owner of the first voxel near a body that the body meets; `meets` takes its pose and shape.
    fn first_voxel(
        &self,
        around: &Aabb,
        is_ignored: impl Fn(Obstacle) -> bool,
        meets: impl Fn(&Pose, &Cuboid) -> bool,
    ) -> Option<Obstacle> {
        let voxel = Cuboid::new(Vector::splat(VOXEL_M as f32 / 2.0));
        let mut hits = self.tree.intersect_aabb(around).filter_map(|leaf| {
            let (middle, owner) = &self.voxels[leaf as usize];
            let at = Pose::from_translation(vector(&middle.coords));
            (!is_ignored(*owner) && meets(&at, &voxel)).then_some(*owner)
        });
        hits.next()
    }

    /// Middles of all voxels with their owners, frame of planning.
    pub fn voxels(&self) -> &[(Point3<f64>, Obstacle)] {
        &self.voxels
    }
}

/// Owners of the voxels that are measured between two corners.
fn measured_voxels(
    scene: &GraspScene<'_>,
    region: &[Point3<f64>; 2],
) -> BTreeMap<[i32; 3], Obstacle> {
    let mut owners = BTreeMap::<[i32; 3], Obstacle>::new();
    let [width, height] = scene.space.size_px();
    for row in (0..height).step_by(STEP_PX) {
        for column in (0..width).step_by(STEP_PX) {
            let pixel = row * width + column;
            let Some(place) = scene.space.in_plan(pixel) else {
                continue;
            };
            if is_within(&place, region) && !is_robot(scene, &place) {
                let surface = || scene.surface_at(&place).map(Obstacle::Surface);
                let object = scene.owner(pixel).map(Obstacle::Object);
                let mixed = || mixed_with(scene, [column, row]).map(Obstacle::Object);
                let obstacle = object.or_else(surface).or_else(mixed);
                let obstacle = obstacle.unwrap_or(Obstacle::Other);
                // Of several in one cell an object counts first.
                let owner = owners.entry(cell_of(&place)).or_insert(obstacle);
                *owner = obstacle.min(*owner);
            }
        }
    }
    grow_objects(&mut owners);
    owners
}

/// Object near a pixel of no owner in the image; of several that with the least index.
fn mixed_with(scene: &GraspScene<'_>, [column, row]: [usize; 2]) -> Option<usize> {
    let [width, height] = scene.space.size_px();
    // Eight pixels around it: an object is wider than the distance between them.
    let around = |at: usize, n: usize| {
        (at.saturating_sub(MIXED_PX)..n.min(at + MIXED_PX + 1)).step_by(MIXED_PX)
    };
    let pixels = around(row, height)
        .flat_map(|row| around(column, width).map(move |column| row * width + column));
    pixels.filter_map(|pixel| scene.owner(pixel)).min()
}

/// True for a place that belongs to the robot.
fn is_robot(scene: &GraspScene<'_>, place: &Point3<f64>) -> bool {
    let mut links = scene.robot.iter();
    links.any(|link| link.distance_m(place) < ROBOT_MARGIN_M)
}

/// Middle of a voxel, metres.
fn middle_of(cell: &[i32; 3]) -> Point3<f64> {
    Point3::from(cell.map(|index| (f64::from(index) + 0.5) * VOXEL_M))
}

/// Cell of a place.
fn cell_of(place: &Point3<f64>) -> [i32; 3] {
    place.coords.map(|c| (c / VOXEL_M).floor() as i32).into()
}

/// Gives voxels without an owner beside an object to it: detection leaves out pixels at the edge of an
/// object, which mix its depth with what is behind.
fn grow_objects(owners: &mut BTreeMap<[i32; 3], Obstacle>) {
    let is_object = |owner: &Obstacle| matches!(owner, Obstacle::Object(_));
    let around = |[x, y, z]: [i32; 3]| {
        let steps = [-1, 0, 1];
        steps.into_iter().flat_map(move |a| {
            let plane = steps.into_iter();
            plane.flat_map(move |b| steps.map(|c| [x + a, y + b, z + c]))
        })
    };
    let unowned = owners
        .iter()
        .filter(|(_, owner)| **owner == Obstacle::Other);
    let grown: Vec<([i32; 3], Obstacle)> = unowned
        .filter_map(|(cell, _)| {
            let near = around(*cell).filter_map(|near| owners.get(&near).copied());
            near.filter(is_object).min().map(|owner| (*cell, owner))
        })
        .collect();
    owners.extend(grown);
}

/// Least and greatest corner of the region around the objects.
fn bounds(scene: &GraspScene<'_>) -> [Point3<f64>; 2] {
    let (mut low, mut high) = (
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(f64::NEG_INFINITY),
    );
    for object in 0..scene.objects.len() {
        for &pixel in scene.pixels(object).iter().step_by(7) {
            if let Some(place) = scene.space.in_plan(pixel) {
                low = low.inf(&place.coords);
                high = high.sup(&place.coords);
            }
        }
    }
    let margin = Vector3::repeat(MARGIN_M);
    [(low - margin).into(), (high + margin).into()]
}

fn is_within(place: &Point3<f64>, [low, high]: &[Point3<f64>; 2]) -> bool {
    (0..3).all(|axis| (low[axis]..=high[axis]).contains(&place[axis]))
}

/// True if a box at a pose meets a capsule; the query knows both shapes.
fn meets_capsule(pose: &Pose, cuboid: &Cuboid, capsule: &Capsule) -> bool {
    intersection_test(pose, cuboid, &Pose::IDENTITY, capsule).is_ok_and(|found| found.intersecting)
}

/// True if a box meets a capsule.
pub fn box_meets_capsule(body: &OrientedBox, link: &BodyCapsule) -> bool {
    let (pose, cuboid) = shape(body);
    meets_capsule(&pose, &cuboid, &capsule(link))
}

/// True if two capsules meet; the query knows both shapes.
fn capsules_meet(a: &Capsule, b: &Capsule) -> bool {
    intersection_test(&Pose::IDENTITY, a, &Pose::IDENTITY, b).is_ok_and(|found| found.intersecting)
}

fn capsule(body: &BodyCapsule) -> Capsule {
    Capsule::new(
        vector(&body.from.coords),
        vector(&body.to.coords),
        body.radius_m as f32,
    )
}

/// Pose and shape of a box for the collision library, which counts in single precision.
fn shape(body: &OrientedBox) -> (Pose, Cuboid) {
    let RigidTransform {
        rotation,
        translation,
    } = body.frame_from_box;
    let r = rotation.coords;
    let rotation = Rotation::from_xyzw(r.x as f32, r.y as f32, r.z as f32, r.w as f32).normalize();
    let pose = Pose::from_parts(vector(&translation.vector), rotation);
    (pose, Cuboid::new(vector(&body.half_sides_m)))
}

fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}
