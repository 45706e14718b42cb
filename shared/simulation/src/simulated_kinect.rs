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
        let truth = true_objects(&mut self.rasterizer, &mut self.counts, world, objects);
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

fn true_objects(
    rasterizer: &mut Rasterizer,
    counts: &mut Vec<u32>,
    world: &World,
    instances: &[Instance<'_>],
) -> Vec<TrueObject> {
    let last = world.objects().last().map_or(0, |object| object.id);
    counts.clear();
    counts.resize(usize::from(last) + 1, 0);
    rasterizer.image().count_pixels(counts);
    let objects = world.objects().iter().zip(instances);
    objects
        .map(|(object, instance)| {
            let unoccluded = rasterizer.n_unoccluded_px(instance) as u32;
            TrueObject::new(object, counts[usize::from(object.id)], unoccluded)
        })
        .collect()
}
