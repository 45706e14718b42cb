//! Phases in which motions are planned: a transport, the rest of one, and the way home.

use super::transport_record::TransportRecord;
use super::way_home::{is_at_home, transit, way_home, way_up};
use super::{N_WAYS_MAX, Robot, TaskRun};
use arm_kinematics::JointVector;
use arm_scene::ArmScene;
use grasping::GraspSettings;
use service::Failure;
use std::ops::ControlFlow;
use std::time::Duration;
use tasks::TaskSignal;

/// Time for which the points of all objects are awaited.
const POINTS_PATIENCE: Duration = Duration::from_millis(1500);
/// Time without a usable scene after which a plan has failed.
const SCENE_PATIENCE: Duration = Duration::from_secs(10);

impl TaskRun {
    /// Plans the transport of the present object by the newest scene.
    pub(super) fn plan(&mut self, robot: &mut Robot<'_>) -> Result<Option<TaskSignal>, Failure> {
        if self.record.is_some() {
            // The arm does not move before the memory knows the plan.
            return Ok(self.journal.is_empty().then_some(TaskSignal::Done));
        }
        let Some(arm_scene) = self.arm_scene(robot)? else {
            return Ok(self.no_scene());
        };
        self.charge();
        let Some(step) = self.present_step().cloned() else {
            return Ok(Some(self.fail("no object was chosen")));
        };
        let failed = self.failed.iter();
        let failed: Vec<&TransportRecord> = failed
            .filter(|(track, _)| *track == step.track)
            .map(|(_, record)| record)
            .collect();
        let place = self.place(&step.place);
        match transport(&arm_scene, (step.track, &failed), place) {
            Ok(record) => self.record = Some(record),
            Err(reason) => return Ok(Some(self.fail(reason))),
        }
        self.record_step();
        Ok(None)
    }

    /// Plans the way to the place anew, with the object in the hand, from a little higher: it may have
    /// met something.
    pub(super) fn replan(&mut self, robot: &mut Robot<'_>) -> Result<Option<TaskSignal>, Failure> {
        if let ControlFlow::Break(signal) = self.rise(robot) {
            return Ok(signal);
        }
        let Some(arm_scene) = self.arm_scene(robot)? else {
            return Ok(self.no_scene());
        };
        self.charge();
        self.n_tries += 1;
        if self.n_tries > 2 * N_WAYS_MAX {
            let reason = format!("the hand holds the object, {}", self.reason);
            return Ok(Some(self.fail(reason)));
        }
        let track = self.present_step().map(|step| step.track);
        let mut objects = arm_scene.snapshot.objects.iter();
        let index = objects.position(|object| Some(object.track) == track);
        let Some(record) = &mut self.record else {
            return Ok(Some(self.fail("the plan of the transport is lost")));
        };
        if self.n_tries > N_WAYS_MAX && !record.is_set_back {
            let (number, reason) = (self.number, &self.reason);
            tracing::info!("task {number}: sets the object back, since {reason}");
            record.set_back();
        }
        let load = record.load(index);
        let goal = JointVector::from(record.above_rad);
        match transit(&arm_scene, &goal, (record.width_m, load.as_ref())) {
            Ok(path) => record.go_by(&path),
            Err(reason) => {
                self.reason = reason;
                return Ok(None);
            }
        }
        self.record_step();
        Ok(Some(TaskSignal::Done))
    }

    /// Moves the arm home on a planned way.
    pub(super) fn go_home(&mut self, robot: &mut Robot<'_>) -> Result<Option<TaskSignal>, Failure> {
        if self.is_begun {
            return Ok(self.carry_out(robot));
        }
        let Some(report) = self.look_at_arm(robot) else {
            return Ok(None);
        };
        if is_at_home(&report) {
            self.n_tries = 0;
            return Ok(Some(TaskSignal::Done));
        }
        let Some(arm_scene) = self.arm_scene(robot)? else {
            return Ok(self.no_scene());
        };
        self.charge();
        self.n_tries += 1;
        let motions = way_home(&arm_scene, &report);
        match motions {
            Ok(motions) => self.driver.begin(motions),
            Err(reason) if self.n_tries <= N_WAYS_MAX => {
                tracing::info!("task {}: no way home yet: {reason}", self.number());
                self.driver.begin(way_up(&report));
            }
            Err(reason) => {
                let reason = format!("the arm finds no way home: {reason}");
                return Ok(Some(self.fail(reason)));
            }
        }
        self.is_begun = true;
        Ok(None)
    }

    /// Charges the time of a planning, which begins now, to a source in lockstep: it waits meanwhile.
    fn charge(&mut self) {
        if self.is_lockstep {
            self.planned_until = self.now + self.config.planning_time;
        }
    }

    /// True while the time of a planning passes; a lease is kept meanwhile.
    pub(super) fn is_charged(&mut self, robot: &mut Robot<'_>) -> bool {
        let is_charged = self.now < self.planned_until;
        if is_charged {
            self.driver.keep(robot.link);
        }
        is_charged
    }

    /// Scene for planning from the newest frame; `None` while none is complete.
    fn arm_scene(&self, robot: &Robot<'_>) -> Result<Option<ArmScene>, Failure> {
        let is_usable = robot.watch.is_complete() || self.elapsed() > POINTS_PATIENCE;
        if !is_usable || robot.watch.n_scenes() == 0 || !robot.watch.is_fresh() {
            return Ok(None);
        }
        robot.watch.arm_scene(self.config.gripper, robot.common)
    }

    /// Failure when no scene has come for too long.
    fn no_scene(&mut self) -> Option<TaskSignal> {
        let is_late = self.elapsed() > SCENE_PATIENCE;
        is_late.then(|| self.fail("no scene has come for 10 s; see `tabula status`"))
    }

    /// Configuration of a place with its name.
    fn place(&self, name: &str) -> Option<(String, grasp_scene::PlaceConfig)> {
        let place = self.config.places.get(name)?;
        Some((name.to_owned(), place.clone()))
    }
}

/// Transport of an object to a place of the configuration, by another grasp than those of transports
/// that have failed.
///
/// # Errors
/// The reason why there is none, in words.
fn transport(
    arm_scene: &ArmScene,
    (track, failed): (u64, &[&TransportRecord]),
    place: Option<(String, grasp_scene::PlaceConfig)>,
) -> Result<TransportRecord, String> {
    let (name, place) = place.ok_or("its place is no longer in the configuration")?;
    let object = arm_scene
        .seen_object(track)
        .ok_or("it is not seen at the moment")?;
    let scene = arm_scene.scene();
    let mut grasps = arm_scene.grasps(&scene, object, &GraspSettings::default());
    let n_possible = grasps.grasps.len();
    grasps.grasps.retain(|grasp| {
        let world_from_tool = arm_scene.frame.world_from_plan * grasp.plan_from_tool;
        let mut failed = failed.iter();
        !failed.any(|record| record.is_grasp_near(&world_from_tool))
    });
    if n_possible > 0 && grasps.grasps.is_empty() {
        return Err("all grasps that are possible have failed".to_owned());
    }
    let area = place.area(&name, &arm_scene.frame);
    let transport = arm_scene.transport(&scene, object, &grasps, &area);
    let transport = transport.map_err(|reason| {
        let why_no_grasp = grasps.why_none(&scene, track);
        why_no_grasp.unwrap_or_else(|| reason.words(&scene, Some(&area)))
    })?;
    let grasp = &grasps.grasps[transport.reached.grasp];
    Ok(TransportRecord::new(
        (arm_scene, &scene),
        object,
        grasp,
        &transport,
    ))
}
