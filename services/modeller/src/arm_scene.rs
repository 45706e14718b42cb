//! Scene of the arm: a snapshot of the daemon with the arm, people, stored models and the gripper.

use crate::arm_and_people::ArmAndPeople;
use crate::awaited_snapshot::awaited_snapshot;
use crate::presence::require_daemon;
use arm_kinematics::GripperModel;
use channel::{Domain, Role, RunFolder};
use command_line::StopSignal;
use grasp_scene::{SceneBodies, grasp_scene};
use grasping::{GraspScene, PlacedArm};
use scene_client::{DaemonModels, ModelShelf, PlanningFrame, Snapshot, SnapshotReceiver};
use service::{CommonArguments, Configuration, Failure, exit_code};
use std::path::Path;

/// Section of the configuration with the gripper.
const GRIPPER_SECTION: &str = "gripper";

/// Stop signal and configuration of a command, whose picture can be written.
///
/// # Errors
/// When the picture has no place, or the configuration is wrong.
pub(crate) fn prepared(
    common: &CommonArguments,
    picture: Option<&Path>,
) -> Result<(StopSignal, Configuration), Failure> {
    if let Some(file) = picture {
        dataset::check_output(file).map_err(Failure::usage)?;
    }
    let stop = StopSignal::install()?;
    let configuration = Configuration::find(common.config.as_deref(), common.home().path())?;
    Ok((stop, configuration))
}

/// Snapshot with everything that the planning of the arm's motions needs.
pub(crate) struct ArmScene {
    pub(crate) snapshot: Snapshot,
    pub(crate) frame: PlanningFrame,
    pub(crate) gripper: GripperModel,
    /// Arm; `None` where there is none, or its place is unknown.
    pub(crate) arm: Option<PlacedArm>,
    /// Remarks for people.
    pub(crate) notes: Vec<String>,
    shelf: ModelShelf,
    bodies: SceneBodies,
}

impl ArmScene {
    /// Receives the newest scene of the daemon. `None` when the stop signal is raised.
    ///
    /// # Errors
    /// When no daemon runs, nothing comes in time, or the configuration is wrong.
    pub(crate) fn receive(
        common: &CommonArguments,
        configuration: &Configuration,
        stop: &StopSignal,
    ) -> Result<Option<Self>, Failure> {
        let gripper = configuration.section(GRIPPER_SECTION)?;
        require_daemon(&common.domain)?;
        let domain = Domain::join(&common.domain, &RunFolder::of_user(), Role::Guest)?;
        let mut receiver = SnapshotReceiver::new(&domain)?;
        let mut bodies = ArmAndPeople::new(&domain)?;
        let Some(snapshot) = awaited_snapshot(&mut receiver, stop)? else {
            return Ok(None);
        };
        bodies.receive()?;
        let frame = PlanningFrame::of(&snapshot)
            .ok_or_else(|| Failure::general("the image has no depth; see `tabula status`"))?;
        let mut notes = frame.notes.clone();
        let mut shelf = ModelShelf::default();
        if let Err(failure) = shelf.refresh(&snapshot, || DaemonModels::connect(common)) {
            notes.push(format!("the stored models are not used: {failure}"));
        }
        Ok(Some(Self {
            arm: bodies.placed(gripper, &snapshot, &frame, &mut notes),
            bodies: bodies.in_world,
            snapshot,
            frame,
            gripper,
            notes,
            shelf,
        }))
    }

    /// Scene of the planning.
    pub(crate) fn scene(&self) -> GraspScene<'_> {
        grasp_scene(&self.snapshot, &self.frame, &self.shelf, &self.bodies)
    }

    /// Index of the object of a track that is seen.
    ///
    /// # Errors
    /// When it is not seen in this frame.
    pub(crate) fn seen_object(&self, track: u64) -> Result<usize, Failure> {
        let mut objects = self.snapshot.objects.iter();
        let index = objects.position(|object| object.track == track);
        let index = index.filter(|index| !self.snapshot.objects[*index].points.is_empty());
        index.ok_or_else(|| {
            let sentence = format!(
                "object {track} is not seen in this frame, so that nothing can be planned for it; \
                 see `tabula objects`"
            );
            Failure::new(exit_code::REFUSED, sentence)
        })
    }
}
