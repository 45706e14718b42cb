//! Simulated Kinect: renders a world and applies the sensor model.

mod person_meshes;
mod room_piece;

use crate::ObjectModel;
use crate::error::Error;
use crate::ground_truth::{ARM_ID, ObjectTruth, PERSON_ID};
use crate::world::World;
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::Point3;
use person_meshes::PersonMeshes;
use point_cloud::Point;
use rendering::kinect::{FrameSeed, KinectSensor};
use rendering::{Image, Instance, Lights, PreparedMesh, Rasterizer, ShadowRegion, StaticScene};
use room_piece::{RoomPiece, room_pieces};
use std::sync::Arc;

/// Radius around the middle of the table in which shadows are cast, metres. Chosen.
const SHADOW_REACH_M: f32 = 1.1;

/// Prepared state of the rasteriser.
///
/// A cached room saves time only while the camera stands still. While it moves, everything is
/// drawn at once over an empty background, with the same result.
#[derive(Debug, Clone, Copy, PartialEq)]
enum PreparedView {
    Nothing,
    /// Camera pose with an empty background, without the room.
    Pose(RigidTransform),
    /// Camera pose with the room as background.
    Room(RigidTransform),
}

/// Simulated Kinect that observes a [`World`].
#[derive(Debug)]
pub struct SimulatedKinect {
    rasterizer: Rasterizer,
    sensor: KinectSensor,
    seed: u64,
    lights: Lights,
    room: Vec<RoomPiece>,
    person: PersonMeshes,
    arm: Vec<PreparedMesh>,
    objects: Vec<(Arc<ObjectModel>, PreparedMesh)>,
    prepared: PreparedView,
    counts: Vec<u32>,
    unoccluded: Vec<UnoccludedCount>,
}

/// Cached number of unoccluded pixels of an object; valid while neither it nor the camera moves.
#[derive(Debug, Clone, Copy)]
struct UnoccludedCount {
    id: u16,
    world_from_camera: RigidTransform,
    world_from_object: RigidTransform,
    n_px: u32,
}

impl SimulatedKinect {
    /// Simulated Kinect for a world and its clones.
    ///
    /// # Errors
    /// [`Error::Scene`] for invalid intrinsics or an invalid sensor model of the world.
    pub fn new(world: &World, camera: PinholeCamera) -> Result<Self, Error> {
        let wrong = |error| Error::camera(&error);
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
                ..world.scene().lighting.lights()
            },
            room: room_pieces(world.boxes()),
            person: PersonMeshes::new(),
            arm,
            objects: Vec::new(),
            prepared: PreparedView::Nothing,
            counts: Vec::new(),
            unoccluded: Vec::new(),
        })
    }

    /// Sets the lights of the room.
    pub fn set_lights(&mut self, lights: Lights) {
        self.lights = Lights {
            shadow: self.lights.shadow,
            ..lights
        };
        self.prepared = PreparedView::Nothing;
    }

    /// Captures a frame of the world: writes the organised point cloud, camera frame, row-major.
    /// `frame` selects the noise. Returns the ground truth before the sensor's errors.
    ///
    /// # Errors
    /// [`Error::Scene`] when `points` does not have the size of the image, or the camera pose is
    /// not finite.
    pub fn look(
        &mut self,
        world: &World,
        frame: u64,
        points: &mut [Point],
    ) -> Result<Vec<ObjectTruth>, Error> {
        self.update_meshes(world);
        let wrong = |error| Error::camera(&error);
        self.prepare(world).map_err(wrong)?;
        let mut instances: Vec<Instance<'_>> = match self.prepared {
            PreparedView::Room(_) => Vec::new(),
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
        update_unoccluded(&mut self.rasterizer, &mut self.unoccluded, world, objects);
        let truth = true_objects(&self.counts, &self.unoccluded, world);
        let shot = FrameSeed {
            seed: self.seed,
            frame_index: frame,
        };
        self.sensor
            .sense(self.rasterizer.image(), shot, points)
            .map_err(wrong)?;
        Ok(truth)
    }

    /// Sensor with the last measurement.
    pub fn sensor(&self) -> &KinectSensor {
        &self.sensor
    }

    /// Last rendered image, without the sensor's errors.
    pub fn image(&self) -> &Image {
        self.rasterizer.image()
    }

    /// Instance mask, row-major: object number of each pixel, 0 for none, see [`ARM_ID`] and
    /// [`PERSON_ID`].
    pub fn mask(&self) -> &[u16] {
        self.rasterizer.image().instance()
    }

    /// Camera intrinsics with the image size.
    pub fn camera(&self) -> &PinholeCamera {
        self.rasterizer.camera()
    }

    /// Prepares the rasteriser; caches the room as background when the camera did not move.
    fn prepare(&mut self, world: &World) -> Result<(), rendering::Error> {
        let world_from_camera = world.world_from_camera();
        let keeps_room = match self.prepared {
            PreparedView::Room(pose) if pose == world_from_camera => return Ok(()),
            PreparedView::Pose(pose) => pose == world_from_camera,
            PreparedView::Room(_) | PreparedView::Nothing => false,
        };
        let room: Vec<Instance<'_>> = if keeps_room {
            self.room.iter().map(RoomPiece::instance).collect()
        } else {
            Vec::new()
        };
        self.rasterizer.prepare(&StaticScene {
            world_from_camera,
            lights: self.lights,
            background: &room,
        })?;
        self.prepared = if keeps_room {
            PreparedView::Room(world_from_camera)
        } else {
            PreparedView::Pose(world_from_camera)
        };
        Ok(())
    }

    /// Prepares the meshes of new objects and drops those of removed ones.
    fn update_meshes(&mut self, world: &World) {
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

/// Adds the moving instances: objects first, in their order, then the arm and the person.
fn add_moving<'a>(
    instances: &mut Vec<Instance<'a>>,
    objects: &'a [(Arc<ObjectModel>, PreparedMesh)],
    arm: &'a [PreparedMesh],
    person: &'a PersonMeshes,
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

/// Counts the visible pixels of each object, by its number.
fn count_pixels(rasterizer: &Rasterizer, counts: &mut Vec<u32>, world: &World) {
    let last = world.objects().last().map_or(0, |object| object.id);
    counts.clear();
    counts.resize(usize::from(last) + 1, 0);
    rasterizer.image().count_pixels(counts);
}

/// Updates the unoccluded pixel counts of the objects that moved relative to the camera;
/// `instances` start with the objects.
fn update_unoccluded(
    rasterizer: &mut Rasterizer,
    unoccluded: &mut Vec<UnoccludedCount>,
    world: &World,
    instances: &[Instance<'_>],
) {
    let world_from_camera = world.world_from_camera();
    unoccluded.retain(|seen| world.find(seen.id).is_some());
    for (object, instance) in world.objects().iter().zip(instances) {
        let known = unoccluded.iter().position(|seen| seen.id == object.id);
        let is_same = known.is_some_and(|at| {
            unoccluded[at].world_from_camera == world_from_camera
                && unoccluded[at].world_from_object == object.world_from_object
        });
        if is_same {
            continue;
        }
        let seen = UnoccludedCount {
            id: object.id,
            world_from_camera,
            world_from_object: object.world_from_object,
            n_px: rasterizer.n_unoccluded_px(instance) as u32,
        };
        match known {
            Some(at) => unoccluded[at] = seen,
            None => unoccluded.push(seen),
        }
    }
}

fn true_objects(counts: &[u32], unoccluded: &[UnoccludedCount], world: &World) -> Vec<ObjectTruth> {
    let n_px = |id: u16| {
        let seen = unoccluded.iter().find(|seen| seen.id == id);
        seen.map_or(0, |seen| seen.n_px)
    };
    let objects = world.objects().iter();
    objects
        .map(|object| ObjectTruth::new(object, counts[usize::from(object.id)], n_px(object.id)))
        .collect()
}
