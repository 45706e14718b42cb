//! The simulated table as a Kinect sees it.

mod appearance;
mod person_look;

use crate::ObjectModel;
use crate::error::Error;
use crate::truth::{ARM_ID, PERSON_ID, TrueObject};
use crate::world::World;
use appearance::{RoomPiece, room_pieces};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::Point3;
use person_look::PersonLook;
use point_cloud::Point;
use rendering::kinect::{KinectSensor, Shot};
use rendering::{Image, Instance, Lights, PreparedMesh, Rasterizer, ShadowRegion, Stage};
use std::sync::Arc;

/// How far from the middle of the table shadows are cast, metres.
const SHADOW_REACH_M: f32 = 1.1;

/// What the rasteriser keeps from look to look.
///
/// A room that is kept saves time only where the camera stands still; while it
/// moves, everything is drawn at once over nothing, with the same result.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Prepared {
    Nothing,
    /// Nothing but the camera's pose.
    Pose(RigidTransform),
    /// The room seen from a pose.
    Room(RigidTransform),
}

/// A camera that looks at a [`World`].
#[derive(Debug)]
pub struct SimulatedKinect {
    rasterizer: Rasterizer,
    sensor: KinectSensor,
    seed: u64,
    lights: Lights,
    room: Vec<RoomPiece>,
    person: PersonLook,
    arm: Vec<PreparedMesh>,
    objects: Vec<(Arc<ObjectModel>, PreparedMesh)>,
    prepared: Prepared,
    counts: Vec<u32>,
    alone: Vec<SeenAlone>,
}

/// How many pixels an object covers where nothing is before it; the same as long as
/// neither it nor the camera moves.
#[derive(Debug, Clone, Copy)]
struct SeenAlone {
    id: u16,
    world_from_camera: RigidTransform,
    world_from_object: RigidTransform,
    n_px: u32,
}

impl SimulatedKinect {
    /// A camera for a world and its likes.
    ///
    /// # Errors
    /// When the intrinsics or the world's sensor model are impossible.
    pub fn new(world: &World, camera: PinholeCamera) -> Result<Self, Error> {
        let wrong = |error: rendering::Error| Error::Scene {
            place: "camera".into(),
            rule: error.to_string(),
        };
        let middle = world.scene().table.middle().cast::<f32>();
        let arm = world.arm().map_or_else(Vec::new, |arm| {
            let meshes = &arm.parts.meshes;
            let solids = meshes.links.iter().chain([&meshes.rail, &meshes.finger]);
            solids.map(|solid| PreparedMesh::new(&solid.mesh)).collect()
        });
        Ok(Self {
            rasterizer: Rasterizer::new(camera).map_err(wrong)?,
            sensor: KinectSensor::new(camera, world.scene().sensor).map_err(wrong)?,
            seed: world.scene().seed,
            lights: Lights {
                shadow: Some(ShadowRegion {
                    center_in_world: Point3::from(middle),
                    radius_m: SHADOW_REACH_M,
                }),
                ..Lights::ROOM
            },
            room: room_pieces(world.blocks()),
            person: PersonLook::new(),
            arm,
            objects: Vec::new(),
            prepared: Prepared::Nothing,
            counts: Vec::new(),
            alone: Vec::new(),
        })
    }

    /// Light of the room from now on.
    pub fn set_lights(&mut self, lights: Lights) {
        self.lights = Lights {
            shadow: self.lights.shadow,
            ..lights
        };
        self.prepared = Prepared::Nothing;
    }

    /// Looks at the world: writes the organised cloud, camera frame, row-major.
    /// `frame` tells the noise of frames apart. The truth is what is seen before
    /// the sensor's errors.
    ///
    /// # Errors
    /// When `points` has not the size of the image, or the camera is nowhere.
    pub fn look(
        &mut self,
        world: &World,
        frame: u64,
        points: &mut [Point],
    ) -> Result<Vec<TrueObject>, Error> {
        self.follow_objects(world);
        let wrong = |error: rendering::Error| Error::Scene {
            place: "camera".into(),
            rule: error.to_string(),
        };
        self.prepare(world).map_err(wrong)?;
        let mut instances: Vec<Instance<'_>> = match self.prepared {
            Prepared::Room(_) => Vec::new(),
            _ => self.room.iter().map(RoomPiece::instance).collect(),
        };
        let n_room = instances.len();
        add_moving(
            &mut instances,
            &self.objects,
            &self.arm,
            &self.person,
            world,
        );
        self.rasterizer.render(&instances);
        let objects = &instances[n_room..];
        count_pixels(&self.rasterizer, &mut self.counts, world);
        see_alone(&mut self.rasterizer, &mut self.alone, world, objects);
        let truth = true_objects(&self.counts, &self.alone, world);
        let shot = Shot {
            seed: self.seed,
            frame_index: frame,
        };
        self.sensor
            .sense(self.rasterizer.image(), shot, points)
            .map_err(wrong)?;
        Ok(truth)
    }

    /// What was measured last.
    pub fn sensor(&self) -> &KinectSensor {
        &self.sensor
    }

    /// What was seen last, without the sensor's errors.
    pub fn image(&self) -> &Image {
        self.rasterizer.image()
    }

    /// The object of each pixel, row-major: 0 for none, see [`ARM_ID`] and [`PERSON_ID`].
    pub fn mask(&self) -> &[u16] {
        self.rasterizer.image().instance()
    }

    /// Intrinsics and size.
    pub fn camera(&self) -> &PinholeCamera {
        self.rasterizer.camera()
    }

    /// Keeps the room when the camera stands where it stood.
    fn prepare(&mut self, world: &World) -> Result<(), rendering::Error> {
        let world_from_camera = world.world_from_camera();
        let keeps_room = match self.prepared {
            Prepared::Room(pose) if pose == world_from_camera => return Ok(()),
            Prepared::Pose(pose) => pose == world_from_camera,
            Prepared::Room(_) | Prepared::Nothing => false,
        };
        let room: Vec<Instance<'_>> = if keeps_room {
            self.room.iter().map(RoomPiece::instance).collect()
        } else {
            Vec::new()
        };
        self.rasterizer.prepare(&Stage {
            world_from_camera,
            lights: self.lights,
            background: &room,
        })?;
        self.prepared = if keeps_room {
            Prepared::Room(world_from_camera)
        } else {
            Prepared::Pose(world_from_camera)
        };
        Ok(())
    }

    /// Prepares the meshes of new objects and forgets those that are gone.
    fn follow_objects(&mut self, world: &World) {
        self.objects.retain(|(model, _)| {
            let mut there = world.objects().iter();
            there.any(|object| Arc::ptr_eq(&object.model, model))
        });
        for object in world.objects() {
            if mesh_of(&self.objects, &object.model).is_none() {
                let mesh = PreparedMesh::new(&object.model.mesh);
                self.objects.push((Arc::clone(&object.model), mesh));
            }
        }
    }
}

fn mesh_of<'a>(
    objects: &'a [(Arc<ObjectModel>, PreparedMesh)],
    model: &Arc<ObjectModel>,
) -> Option<&'a PreparedMesh> {
    let same = objects.iter().find(|(known, _)| Arc::ptr_eq(known, model));
    same.map(|(_, mesh)| mesh)
}

/// Adds what moves: objects first, in their order, then the arm and the person.
fn add_moving<'a>(
    instances: &mut Vec<Instance<'a>>,
    objects: &'a [(Arc<ObjectModel>, PreparedMesh)],
    arm: &'a [PreparedMesh],
    person: &'a PersonLook,
    world: &World,
) {
    for object in world.objects() {
        if let Some(mesh) = mesh_of(objects, &object.model) {
            instances.push(Instance::new(mesh, object.world_from_object, object.id));
        }
    }
    if let (Some(simulated), Some(finger)) = (world.arm(), arm.last()) {
        for (index, pose) in simulated.poses().into_iter().enumerate() {
            let mesh = arm.get(index).unwrap_or(finger);
            instances.push(Instance::new(mesh, pose, ARM_ID));
        }
    }
    for (mesh, pose) in person.limbs(&world.person_capsules()) {
        instances.push(Instance::new(mesh, pose, PERSON_ID));
    }
}

/// Counts the pixels in which each object is seen, by its id.
fn count_pixels(rasterizer: &Rasterizer, counts: &mut Vec<u32>, world: &World) {
    let last = world.objects().last().map_or(0, |object| object.id);
    counts.clear();
    counts.resize(usize::from(last) + 1, 0);
    rasterizer.image().count_pixels(counts);
}

/// Draws those objects alone that have moved against the camera; `instances` begin with
/// the objects.
fn see_alone(
    rasterizer: &mut Rasterizer,
    alone: &mut Vec<SeenAlone>,
    world: &World,
    instances: &[Instance<'_>],
) {
    let world_from_camera = world.world_from_camera();
    alone.retain(|seen| world.find(seen.id).is_some());
    for (object, instance) in world.objects().iter().zip(instances) {
        let known = alone.iter().position(|seen| seen.id == object.id);
        let is_same = known.is_some_and(|at| {
            alone[at].world_from_camera == world_from_camera
                && alone[at].world_from_object == object.world_from_object
        });
        if is_same {
            continue;
        }
        let seen = SeenAlone {
            id: object.id,
            world_from_camera,
            world_from_object: object.world_from_object,
            n_px: rasterizer.n_unoccluded_px(instance) as u32,
        };
        match known {
            Some(at) => alone[at] = seen,
            None => alone.push(seen),
        }
    }
}

fn true_objects(counts: &[u32], alone: &[SeenAlone], world: &World) -> Vec<TrueObject> {
    let n_px = |id: u16| {
        let seen = alone.iter().find(|seen| seen.id == id);
        seen.map_or(0, |seen| seen.n_px)
    };
    let objects = world.objects().iter();
    objects
        .map(|object| TrueObject::new(object, counts[usize::from(object.id)], n_px(object.id)))
        .collect()
}
