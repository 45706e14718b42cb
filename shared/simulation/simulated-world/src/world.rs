//! Simulated world: physics, objects, arm and person over time.

mod held_object;
mod lowering;
mod settling;
mod world_query;

use crate::arm::{ArmCommand, ArmStatus, SimulatedArm};
use crate::arrangement;
use crate::camera_mount::CameraMount;
use crate::error::Error;
use crate::model_choice::ModelChoice;
use crate::model_library::ModelLibrary;
use crate::person::{HandEvent, Person};
use crate::physics::{Physics, STEPS_PER_SECOND};
use crate::room::{self, RoomBox};
use crate::scene::{ObjectPlacement, ObjectPlan, Scene};
use crate::scene_file::MAX_OBJECTS;
use crate::scene_object::{ObjectState, SimulatedObject};
use geometry::{Capsule, RigidTransform};
use held_object::HeldObject;
use std::sync::Arc;

/// Interval between two objects dropped into a pile, steps. Chosen.
const DROP_STEPS: u32 = STEPS_PER_SECOND * 35 / 100;
/// Greatest distance between the hand and an object's top at which a grasp succeeds, metres.
/// Chosen.
const MISSED_GRIP_M: f64 = 0.05;
/// Greatest object number; larger values are reserved in the mask.
const LAST_ID: u16 = 60_000;
/// Initial height of an upright object above the table, metres. Chosen.
const PUT_DOWN_LIFT_M: f64 = 0.001;

/// Simulated world at one instant: table, objects, arm and person.
///
/// A clone continues exactly as the original does.
#[derive(Debug, Clone)]
pub struct World {
    scene: Arc<Scene>,
    boxes: Arc<[RoomBox]>,
    library: ModelLibrary,
    physics: Physics,
    objects: Vec<SimulatedObject>,
    last_id: u16,
    arm: Option<SimulatedArm>,
    person: Option<Person>,
    in_hand: Option<HeldObject>,
    n_steps: u64,
    notes: Vec<String>,
}

impl World {
    /// Sets up a scene and lets its objects come to rest.
    ///
    /// # Errors
    /// An error of an unusable model.
    pub fn new(scene: Scene, mut library: ModelLibrary) -> Result<Self, Error> {
        let boxes: Arc<[RoomBox]> = room::room_boxes(&scene).into();
        let mut physics = Physics::new();
        room::build(&boxes, &mut physics);
        let is_lowered = |p: &ObjectPlan| matches!(p.placement, ObjectPlacement::Lowered { .. });
        if scene.objects.iter().any(is_lowered) {
            physics.stiffen_stacks();
        }
        let arm = scene
            .arm
            .as_ref()
            .and_then(|mount| SimulatedArm::new(mount, scene.seed, &mut physics));
        let models = scene.objects.iter().map(|plan| library.load(&plan.model));
        let models = models.collect::<Result<Vec<_>, _>>()?;
        let mut world = Self {
            person: scene
                .person
                .clone()
                .map(|plan| Person::new(plan, scene.seed)),
            scene: Arc::new(scene),
            arm,
            boxes,
            physics,
            objects: Vec::new(),
            last_id: 0,
            in_hand: None,
            n_steps: 0,
            notes: library.take_notes(),
            library,
        };
        let plans = Arc::clone(&world.scene);
        for (plan, model) in plans.objects.iter().zip(models) {
            world.add_planned(model, &plan.placement);
        }
        world.settle();
        Ok(world)
    }

    fn add_planned(&mut self, model: Arc<crate::ObjectModel>, placing: &ObjectPlacement) {
        match placing {
            ObjectPlacement::Upright {
                position_m,
                yaw_rad,
                raised_m,
            } => {
                let pose = arrangement::upright_pose(
                    &model,
                    &self.scene.table,
                    *position_m,
                    *yaw_rad,
                    raised_m + PUT_DOWN_LIFT_M,
                );
                self.add_object(model, &pose);
            }
            ObjectPlacement::Dropped { world_from_object } => {
                self.add_object(model, world_from_object);
                self.run_physics(DROP_STEPS);
            }
            ObjectPlacement::Lowered {
                position_m,
                rotation,
            } => self.lower_object(model, *position_m, rotation),
        }
    }

    fn add_object(&mut self, model: Arc<crate::ObjectModel>, pose: &RigidTransform) -> u16 {
        self.last_id += 1;
        let body = self
            .physics
            .add_object(&model.shape, model.mass_kg, model.friction, pose);
        self.objects
            .push(SimulatedObject::new(self.last_id, model, body));
        self.refresh_objects();
        self.last_id
    }

    /// Advances the world by one step of 1/120 s.
    pub fn step(&mut self) {
        self.step_person();
        if let Some(held) = &self.in_hand
            && let (Some(person), Some(object)) = (&self.person, self.find(held.object))
        {
            let pose = held.world_from_object(&person.hand());
            self.physics.move_to(object.body, &pose);
        }
        if let Some(arm) = &mut self.arm {
            arm.step(&mut self.physics, &mut self.objects);
        }
        self.physics.step();
        self.n_steps += 1;
        self.refresh_objects();
        self.report_falls();
    }

    fn step_person(&mut self) {
        let Some(mut person) = self.person.take() else {
            return;
        };
        let dt_s = 1.0 / f64::from(STEPS_PER_SECOND);
        let event = person.step(self.time_s(), dt_s, self);
        let hand = person.hand();
        self.person = Some(person);
        match event {
            None => {}
            Some(HandEvent::Brought(model)) => self.bring_object(&model, hand),
            Some(HandEvent::Grasped(object)) => self.grasp_object(object, hand),
            Some(HandEvent::Turned(angle_rad)) => {
                if let Some(held) = &mut self.in_hand {
                    held.turn(angle_rad);
                }
            }
            Some(HandEvent::Released) => self.release_object(),
            Some(HandEvent::Removed) => self.remove_held_object(),
            Some(HandEvent::Impossible(action)) => self.notes.push(format!(
                "the person could not {}: the object is not there, is held, or lies on the floor",
                action.words()
            )),
        }
    }

    fn bring_object(&mut self, model: &ModelChoice, hand: nalgebra::Point3<f64>) {
        if self.objects.len() >= MAX_OBJECTS || self.last_id >= LAST_ID {
            let note = "nothing more is brought: the scene is full; start it again".to_owned();
            self.notes.push(note);
            return;
        }
        let brought = match model {
            // Over days a person brings many models; those of a folder are few.
            ModelChoice::Generated { .. } => self.library.load_uncached(model),
            ModelChoice::File(_) => self.library.load(model),
        };
        match brought {
            Ok(model) => {
                let pose = held_object::carried_below(&hand, &model);
                let object = self.add_object(model, &pose);
                self.grasp_object(object, hand);
            }
            Err(error) => self.notes.push(error.to_string()),
        }
    }

    fn grasp_object(&mut self, object: u16, hand: nalgebra::Point3<f64>) {
        // The object may have gone, fallen, or been grasped by the arm while the hand was on its
        // way.
        let grip = hand - nalgebra::Vector3::z() * crate::person::GRIP_M;
        let is_there = |found: &&SimulatedObject| {
            !found.is_held() && (found.top() - grip).norm() < MISSED_GRIP_M
        };
        let Some(found) = self.find(object).filter(is_there) else {
            self.notes.push(format!(
                "the person reached for object {object}, which was not there any more"
            ));
            return;
        };
        let (body, pose) = (found.body, found.world_from_object);
        self.physics.set_held(body, true);
        self.in_hand = Some(HeldObject::new(object, &hand, &pose));
        self.set_state(object, ObjectState::HeldByPerson);
    }

    fn release_object(&mut self) {
        let Some(held) = self.in_hand.take() else {
            return;
        };
        if let Some(object) = self.find(held.object) {
            let body = object.body;
            self.physics.set_held(body, false);
            self.set_state(held.object, ObjectState::Moving);
        }
    }

    fn remove_held_object(&mut self) {
        let Some(held) = self.in_hand.take() else {
            return;
        };
        if let Some(index) = self.objects.iter().position(|o| o.id == held.object) {
            let object = self.objects.remove(index);
            self.physics.remove(object.body);
        }
    }

    fn set_state(&mut self, id: u16, state: ObjectState) {
        if let Some(object) = self.objects.iter_mut().find(|object| object.id == id) {
            object.state = state;
        }
    }

    /// Updates the objects' poses and states from the physics.
    fn refresh_objects(&mut self) {
        for object in &mut self.objects {
            object.refresh(&self.physics, &self.scene.table);
        }
    }

    /// Emits one report for each object that has fallen.
    fn report_falls(&mut self) {
        for object in &mut self.objects {
            if object.has_newly_fallen() {
                self.notes.push(format!(
                    "{} (object {}) fell off the table and lies on the floor",
                    object.model.name, object.id
                ));
            }
        }
    }

    /// Objects of the scene, in the order of their arrival.
    pub fn objects(&self) -> &[SimulatedObject] {
        &self.objects
    }

    /// Finds an object by its number.
    pub fn find(&self, id: u16) -> Option<&SimulatedObject> {
        self.objects.iter().find(|object| object.id == id)
    }

    /// Description of the simulated scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    pub(crate) fn boxes(&self) -> &[RoomBox] {
        &self.boxes
    }

    /// Capsules of the person's torso, head, upper arm, forearm, hand and legs, world frame;
    /// empty without a person.
    pub fn person_capsules(&self) -> Vec<Capsule> {
        let person = self.person.as_ref();
        person.map_or_else(Vec::new, |person| person.body().capsules.to_vec())
    }

    /// Gives the arm a command, which replaces the current one, and returns its identity.
    ///
    /// # Errors
    /// A sentence with the reason for the rejection.
    pub fn command_arm(&mut self, command: &ArmCommand) -> Result<u64, String> {
        let arm = self.arm.as_mut();
        let arm = arm.ok_or("the scene has no arm; add `[arm]` to it".to_owned())?;
        arm.command(command)
    }

    /// Status of the arm; `None` without an arm.
    pub fn arm_status(&self) -> Option<ArmStatus> {
        self.arm.as_ref().map(SimulatedArm::status)
    }

    /// Bounding capsules of the arm, world frame; empty without an arm.
    pub fn arm_capsules(&self) -> Vec<Capsule> {
        self.arm
            .as_ref()
            .map_or_else(Vec::new, SimulatedArm::capsules)
    }

    /// Friction coefficient between the gripper's pads and objects, drawn by the seed; `None`
    /// without an arm.
    pub fn pad_friction(&self) -> Option<f64> {
        self.arm.as_ref().map(|arm| arm.friction)
    }

    pub(crate) fn arm(&self) -> Option<&SimulatedArm> {
        self.arm.as_ref()
    }

    /// True if the person is performing an action.
    pub fn is_person_busy(&self) -> bool {
        self.person.as_ref().is_some_and(Person::is_busy)
    }

    /// Pose of the camera, `world_from_camera`.
    pub fn world_from_camera(&self) -> RigidTransform {
        self.scene.camera.world_from_camera(self.time_s())
    }

    /// Replaces the mounting pose of the camera.
    pub fn set_camera(&mut self, mount: CameraMount) {
        Arc::make_mut(&mut self.scene).camera = mount;
    }

    /// Time since the start of the scene, seconds.
    pub fn time_s(&self) -> f64 {
        self.n_steps as f64 / f64::from(STEPS_PER_SECOND)
    }

    /// Takes the accumulated messages for the user, one sentence each.
    pub fn take_notes(&mut self) -> Vec<String> {
        self.notes.append(&mut self.library.take_notes());
        std::mem::take(&mut self.notes)
    }

    /// Steps only the physics; neither the arm nor the person moves, and the scene time stands
    /// still.
    fn run_physics(&mut self, n_steps: u32) {
        for _ in 0..n_steps {
            self.physics.step();
        }
        self.refresh_objects();
    }
}
