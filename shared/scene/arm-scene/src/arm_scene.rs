//! Scene of the arm: a snapshot with everything that the planning of the arm's motions needs.

use crate::arm_and_people::ArmAndPeople;
use arm_kinematics::GripperModel;
use grasp_scene::{SceneBodies, grasp_scene};
use grasping::{
    Grasp, GraspPlan, GraspPlanner, GraspScene, GraspSettings, Obstacles, PlacedArm,
    contact_surface,
};
use scene_client::{ModelShelf, PlanningFrame, Snapshot, StoredModels};
use service::Failure;
use transport::{NoTransport, PlaceArea, ReachedGrasp, Transport, TransportPlanner, reach_region};

/// Seed of the random trees.
pub const SEED: u64 = 1;

/// Snapshot with everything that the planning of the arm's motions needs.
pub struct ArmScene {
    /// Snapshot.
    pub snapshot: Snapshot,
    /// Frame of planning.
    pub frame: PlanningFrame,
    /// Gripper of the configuration.
    pub gripper: GripperModel,
    /// Arm; `None` where there is none, or its place is unknown.
    pub arm: Option<PlacedArm>,
    /// Remarks for people.
    pub notes: Vec<String>,
    shelf: ModelShelf,
    bodies: SceneBodies,
}

impl ArmScene {
    /// Scene of a snapshot, with the bodies received last and the stored models.
    ///
    /// # Errors
    /// When the image has no depth.
    pub fn new<M: StoredModels>(
        snapshot: Snapshot,
        bodies: &ArmAndPeople,
        gripper: GripperModel,
        models: impl FnOnce() -> Result<M, Failure>,
    ) -> Result<Self, Failure> {
        let frame = PlanningFrame::of(&snapshot)
            .ok_or_else(|| Failure::general("the image has no depth; see `tabula status`"))?;
        let mut notes = frame.notes.clone();
        let mut shelf = ModelShelf::default();
        if let Err(failure) = shelf.refresh(&snapshot, models) {
            notes.push(format!("the stored models are not used: {failure}"));
        }
        Ok(Self {
            arm: bodies.placed(gripper, &snapshot, &frame, &mut notes),
            bodies: bodies.in_world.clone(),
            snapshot,
            frame,
            gripper,
            notes,
            shelf,
        })
    }

    /// Scene of the planning.
    pub fn scene(&self) -> GraspScene<'_> {
        grasp_scene(&self.snapshot, &self.frame, &self.shelf, &self.bodies)
    }

    /// Index of the object of a track that is seen; `None` when it is not in this frame.
    pub fn seen_object(&self, track: u64) -> Option<usize> {
        let mut objects = self.snapshot.objects.iter();
        let index = objects.position(|object| object.track == track);
        index.filter(|index| !self.snapshot.objects[*index].points.is_empty())
    }

    /// Grasps of an object of the scene.
    pub fn grasps(
        &self,
        scene: &GraspScene<'_>,
        object: usize,
        settings: &GraspSettings,
    ) -> GraspPlan {
        let obstacles = Obstacles::of(scene);
        let planner = GraspPlanner {
            scene,
            obstacles: &obstacles,
            gripper: &self.gripper,
            arm: self.arm.as_ref(),
            settings,
        };
        planner.plan(object)
    }

    /// Transport of an object of the scene to an area by one of its grasps.
    ///
    /// # Errors
    /// The reason of the grasp that came farthest; that no grasp is known where there is no arm.
    pub fn transport(
        &self,
        scene: &GraspScene<'_>,
        object: usize,
        grasps: &GraspPlan,
        area: &PlaceArea,
    ) -> Result<Transport, NoTransport> {
        let contacts = contact_surface(scene, object);
        self.plan(scene, |planner| {
            planner.plan((object, &contacts), &grasps.grasps, area)
        })
    }

    /// First of the grasps that the arm can move to.
    ///
    /// # Errors
    /// The reason of the best grasp; that no grasp is known where there is no arm.
    pub fn reach(
        &self,
        scene: &GraspScene<'_>,
        grasps: &[Grasp],
    ) -> Result<ReachedGrasp, NoTransport> {
        self.plan(scene, |planner| planner.reach(grasps))
    }

    /// Plan of a transport planner with the obstacles within the arm's reach.
    fn plan<T>(
        &self,
        scene: &GraspScene<'_>,
        plan: impl FnOnce(&TransportPlanner<'_>) -> Result<T, NoTransport>,
    ) -> Result<T, NoTransport> {
        let placed = self.arm.as_ref().ok_or(NoTransport::NoGrasp)?;
        let obstacles = Obstacles::within(scene, &reach_region(placed));
        plan(&TransportPlanner {
            scene,
            obstacles: &obstacles,
            placed,
            seed: SEED,
        })
    }
}
