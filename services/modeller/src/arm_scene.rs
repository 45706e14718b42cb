//! Scene of the arm for one command: the newest snapshot of the daemon, with arm and people.

use crate::awaited_snapshot::awaited_snapshot;
use crate::presence::require_daemon;
use arm_scene::{ArmAndPeople, ArmScene};
use channel::{Domain, Role, RunFolder};
use command_line::StopSignal;
use scene_client::{DaemonModels, SnapshotReceiver};
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

/// Receives the newest scene of the daemon. `None` when the stop signal is raised.
///
/// # Errors
/// When no daemon runs, nothing comes in time, or the configuration is wrong.
pub(crate) fn receive(
    common: &CommonArguments,
    configuration: &Configuration,
    stop: &StopSignal,
) -> Result<Option<ArmScene>, Failure> {
    let gripper = configuration.section(GRIPPER_SECTION)?;
    require_daemon(&common.domain)?;
    let domain = Domain::join(&common.domain, &RunFolder::of_user(), Role::Guest)?;
    let mut receiver = SnapshotReceiver::new(&domain)?;
    let mut bodies = ArmAndPeople::new(&domain)?;
    let Some(snapshot) = awaited_snapshot(&mut receiver, stop)? else {
        return Ok(None);
    };
    bodies.receive()?;
    let models = || DaemonModels::connect(common);
    ArmScene::new(snapshot, &bodies, gripper, models).map(Some)
}

/// Index of the object of a track that is seen.
///
/// # Errors
/// When it is not seen in this frame.
pub(crate) fn seen_object(arm_scene: &ArmScene, track: u64) -> Result<usize, Failure> {
    arm_scene.seen_object(track).ok_or_else(|| {
        let sentence = format!(
            "object {track} is not seen in this frame, so that nothing can be planned for it; see \
             `tabula objects`"
        );
        Failure::new(exit_code::REFUSED, sentence)
    })
}
