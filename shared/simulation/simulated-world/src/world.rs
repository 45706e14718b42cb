//! The world while it runs.

mod held;
mod object;
mod settling;
mod view_of_person;

pub use object::{ObjectState, SceneObject};

use crate::arm::{ArmCommand, ArmStatus, SimulatedArm};
use crate::arrangement;
use crate::error::Error;
use crate::model_library::ModelLibrary;
use crate::person::{HandEvent, Person};
use crate::physics::{Physics, STEPS_PER_SECOND};
use crate::room::{self, Block};
use crate::scene::{CameraMount, ModelChoice, Placing, Scene};
use crate::scene_file::MOST_OBJECTS;
use geometry::{Capsule, RigidTransform};
use held::Held;
use std::sync::Arc;
use view_of_person::ViewOfPerson;

/// An object dropped into a pile has this long before the next one follows, steps.
const DROP_STEPS: u32 = STEPS_PER_SECOND * 35 / 100;
/// A hand that is farther than this from an object's top does not take it, metres.
const MISSED_GRIP_M: f64 = 0.05;
/// Greatest number of an object; larger ones have a meaning in the mask.
const LAST_ID: u16 = 60_000;
/// Lift of an object that is put down at the start, metres.
const PUT_DOWN_LIFT_M: f64 = 0.001;

/// A table with its objects, its arm and its person, at one instant.
///
/// A clone goes on exactly as the original does.
#[derive(Debug, Clone)]
pub struct World {
    scene: Arc<Scene>,
    blocks: Arc<[Block]>,
    library: ModelLibrary,
    physics: Physics,
    objects: Vec<SceneObject>,
    last_id: u16,
    arm: Option<SimulatedArm>,
    person: Option<Person>,
    in_hand: Option<Held>,
    n_steps: u64,
    notes: Vec<String>,
}

impl World {
    /// Sets up a scene and lets its objects come to rest.
    ///
    /// # Errors
    /// When a model can not be used.
    pub fn new(scene: Scene, mut library: ModelLibrary) -> Result<Self, Error> {
        let blocks: Arc<[Block]> = room::blocks(&scene).into();
        let mut physics = Physics::new();
        room::build(&blocks, &mut physics);
        let arm = scene
            .arm
            .as_ref()
            .and_then(|mount| SimulatedArm::new(mount, &mut physics));
        let models = scene.objects.iter().map(|plan| library.load(&plan.model));
        let models = models.collect::<Result<Vec<_>, _>>()?;
        let mut world = Self {
            person: scene
                .person
                .clone()
                .map(|plan| Person::new(plan, scene.seed)),
            scene: Arc::new(scene),
            arm,
            blocks,
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
            world.add_planned(model, &plan.placing);
        }
        world.settle();
        Ok(world)
    }

    fn add_planned(&mut self, model: Arc<crate::ObjectModel>, placing: &Placing) {
        match placing {
            Placing::Upright {
                position_m,
                yaw_rad,
            } => {
                let pose = arrangement::upright_pose(
                    &model,
                    &self.scene.table,
                    *position_m,
                    *yaw_rad,
                    PUT_DOWN_LIFT_M,
                );
                self.add_object(model, &pose);
            }
            Placing::Dropped { world_from_object } => {
                self.add_object(model, world_from_object);
                self.run_physics(DROP_STEPS);
            }
        }
    }

    fn add_object(&mut self, model: Arc<crate::ObjectModel>, pose: &RigidTransform) -> u16 {
        self.last_id += 1;
        let body = self
            .physics
            .add_object(&model.shape, model.mass_kg, model.friction, pose);
        self.objects
            .push(SceneObject::new(self.last_id, model, body));
        self.refresh_objects();
        self.last_id
    }

    /// Advances by one step of 1/120 s.
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
        self.notice_falls();
    }

    fn step_person(&mut self) {
        let Some(mut person) = self.person.take() else {
            return;
        };
        let dt_s = 1.0 / f64::from(STEPS_PER_SECOND);
        let event = person.step(self.time_s(), dt_s, &ViewOfPerson::new(self));
        let hand = person.hand();
        self.person = Some(person);
        match event {
            None => {}
            Some(HandEvent::Brings(model)) => self.bring(&model, hand),
            Some(HandEvent::Takes(object)) => self.take(object, hand),
            Some(HandEvent::LetsGo) => self.let_go(),
            Some(HandEvent::TakesAway) => self.take_away(),
            Some(HandEvent::CanNot(action)) => self.notes.push(format!(
                "the person left out {}: the object is not there, is held, or lies on the floor",
                action.words()
            )),
        }
    }

    fn bring(&mut self, model: &ModelChoice, hand: nalgebra::Point3<f64>) {
        if self.objects.len() >= MOST_OBJECTS || self.last_id >= LAST_ID {
            let note = "nothing more is brought: the scene is full; start it again".to_owned();
            self.notes.push(note);
            return;
        }
        let brought = match model {
            // Over days a person brings many; those of a folder are few.
            ModelChoice::Generated { .. } => self.library.look_at(model),
            ModelChoice::File(_) => self.library.load(model),
        };
        match brought {
            Ok(model) => {
                let pose = held::carried_below(&hand, &model);
                let object = self.add_object(model, &pose);
                self.take(object, hand);
            }
            Err(error) => self.notes.push(error.to_string()),
        }
    }

    fn take(&mut self, object: u16, hand: nalgebra::Point3<f64>) {
        // While the hand was on its way it may have gone, fallen, or been taken by the arm.
        let grip = hand - nalgebra::Vector3::z() * crate::person::GRIP_M;
        let is_there =
            |found: &&SceneObject| !found.is_held() && (found.top() - grip).norm() < MISSED_GRIP_M;
        let Some(found) = self.find(object).filter(is_there) else {
            self.notes.push(format!(
                "the person reached for object {object}, which was not there any more"
            ));
            return;
        };
        let (body, pose) = (found.body, found.world_from_object);
        self.physics.set_held(body, true);
        self.in_hand = Some(Held::new(object, &hand, &pose));
        self.set_state(object, ObjectState::HeldByPerson);
    }

    fn let_go(&mut self) {
        let Some(held) = self.in_hand.take() else {
            return;
        };
        if let Some(object) = self.find(held.object) {
            let body = object.body;
            self.physics.set_held(body, false);
            self.set_state(held.object, ObjectState::Moving);
        }
    }

    fn take_away(&mut self) {
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

    /// Takes poses and states over from the physics.
    fn refresh_objects(&mut self) {
        for object in &mut self.objects {
            object.refresh(&self.physics, &self.scene.table);
        }
    }

    /// Says of each object once that it has fallen.
    fn notice_falls(&mut self) {
        for object in &mut self.objects {
            if object.has_newly_fallen() {
                self.notes.push(format!(
                    "{} (object {}) fell off the table and lies on the floor",
                    object.model.name, object.id
                ));
            }
        }
    }

    /// The objects that are there, in the order they came.
    pub fn objects(&self) -> &[SceneObject] {
        &self.objects
    }

    /// One object by its number.
    pub fn find(&self, id: u16) -> Option<&SceneObject> {
        self.objects.iter().find(|object| object.id == id)
    }

    /// What the world is made from.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    pub(crate) fn library(&self) -> &ModelLibrary {
        &self.library
    }

    /// The person's torso, head, upper arm, forearm, hand and legs, world frame; empty
    /// without a person.
    pub fn person_capsules(&self) -> Vec<Capsule> {
        let person = self.person.as_ref();
        person.map_or_else(Vec::new, |person| person.body().capsules.to_vec())
    }

    /// Gives the arm a command, which replaces what it is still doing; its number
    /// is returned.
    ///
    /// # Errors
    /// A sentence that says why it can not be carried out.
    pub fn command_arm(&mut self, command: &ArmCommand) -> Result<u64, String> {
        let arm = self.arm.as_mut();
        let arm = arm.ok_or("the scene has no arm; add `[arm]` to it".to_owned())?;
        arm.command(command)
    }

    /// How the arm is; `None` without one.
    pub fn arm_status(&self) -> Option<ArmStatus> {
        self.arm.as_ref().map(SimulatedArm::status)
    }

    /// Capsules that contain the arm, world frame; empty without one.
    pub fn arm_capsules(&self) -> Vec<Capsule> {
        self.arm
            .as_ref()
            .map_or_else(Vec::new, SimulatedArm::capsules)
    }

    pub(crate) fn arm(&self) -> Option<&SimulatedArm> {
        self.arm.as_ref()
    }

    /// Whether the person does something at the moment.
    pub fn is_person_busy(&self) -> bool {
        self.person.as_ref().is_some_and(Person::is_busy)
    }

    /// Pose of the camera.
    pub fn world_from_camera(&self) -> RigidTransform {
        self.scene.camera.world_from_camera(self.time_s())
    }

    /// Moves the camera to another mount.
    pub fn set_camera(&mut self, mount: CameraMount) {
        Arc::make_mut(&mut self.scene).camera = mount;
    }

    /// Time since the scene began, seconds.
    pub fn time_s(&self) -> f64 {
        self.n_steps as f64 / f64::from(STEPS_PER_SECOND)
    }

    /// What has happened that a person should know, one sentence each; given once.
    pub fn take_notes(&mut self) -> Vec<String> {
        self.notes.append(&mut self.library.take_notes());
        std::mem::take(&mut self.notes)
    }

    /// Steps the physics alone: nobody moves, no time passes for the script.
    fn run_physics(&mut self, n_steps: u32) {
        for _ in 0..n_steps {
            self.physics.step();
        }
        self.refresh_objects();
    }
}
