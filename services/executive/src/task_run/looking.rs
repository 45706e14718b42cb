//! Phases in which the robot looks: at the table, at what was lifted, and at what was set down.

use super::{Robot, TaskRun};
use std::time::Duration;
use tasks::{
    CarryStep, NextObject, StepState, TaskSignal, TaskView, is_hopeless, is_place_empty, object_at,
    object_words, select,
};

/// Number of scenes of a look: after a motion the tracker knows what is new after 22 sightings.
const LOOK_SCENES: u32 = 30;
/// Number of scenes after which nothing more is expected to come into view.
const LONG_LOOK_SCENES: u32 = 75;
/// Time without a scene after which a look has failed.
const SCENE_PATIENCE: Duration = Duration::from_secs(20);
/// Number of scenes before a lift is judged.
const LIFT_SCENES: u32 = 8;
/// Number of scenes after which a lift that is not seen has failed.
const LIFT_SCENES_MAX: u32 = 60;
/// Number of scenes after which an object that is not seen at its place is not there: a track of an
/// object in a scene at rest needs a hundred sightings beside a larger one.
const PLACE_SCENES_MAX: u32 = 120;

impl TaskRun {
    /// Looks at the table for a while.
    pub(super) fn look(&mut self, robot: &Robot<'_>) -> Option<TaskSignal> {
        if !robot.watch.is_fresh() {
            self.waits_for = "a scene of the camera that is newer than 0.3 s".into();
            let is_late = self.elapsed() > SCENE_PATIENCE;
            return is_late.then(|| self.fail("no scene has come for 20 s; see `tabula status`"));
        }
        self.waits_for.clear();
        self.select(robot);
        let n_scenes = robot.watch.n_scenes();
        let is_clear = !self.selection.next.is_empty() && robot.watch.is_complete();
        let is_enough = n_scenes
            >= if is_clear {
                LOOK_SCENES
            } else {
                LONG_LOOK_SCENES
            };
        is_enough.then_some(TaskSignal::Done)
    }

    /// Chooses the next object by the newest scene.
    pub(super) fn choose(&mut self, robot: &Robot<'_>) -> TaskSignal {
        self.select(robot);
        let Some(next) = self.selection.next.first().cloned() else {
            return self.nothing_next();
        };
        if is_hopeless(&self.steps) {
            self.reason = "nine attempts in a row have failed".into();
            return TaskSignal::GoalMissed;
        }
        let mut objects = robot.watch.objects().into_iter();
        self.stood = objects.find(|object| object.track == next.track);
        self.begin_step(step_to(&next));
        TaskSignal::Done
    }

    /// Signal of a choice without a next object.
    fn nothing_next(&mut self) -> TaskSignal {
        if self.selection.need_names().next().is_some() {
            TaskSignal::NamesNeeded
        } else if self.selection.is_goal_reached(&self.goal, &self.steps) {
            TaskSignal::NothingLeft
        } else {
            self.reason = "not everything could be done".into();
            TaskSignal::GoalMissed
        }
    }

    /// Waits for names of the objects that are left.
    pub(super) fn ask(&mut self, robot: &Robot<'_>) -> Option<TaskSignal> {
        self.select(robot);
        let asked: Vec<String> = self
            .selection
            .need_names()
            .map(|track| track.to_string())
            .collect();
        if asked.is_empty() || !self.selection.next.is_empty() {
            return Some(TaskSignal::Done);
        }
        if self.elapsed() > self.config.ask_patience {
            self.rules.is_answer_overdue = true;
            return Some(self.fail("nobody has named the objects that are left"));
        }
        let (objects, first) = (asked.join(", "), &asked[0]);
        self.waits_for =
            format!("a name for {objects}; teach it, as by: tabula teach {first} NAME");
        None
    }

    /// Checks that the object is in the hand, and that its place is empty.
    pub(super) fn check_lift(&mut self, robot: &mut Robot<'_>) -> Option<TaskSignal> {
        if let Some(signal) = self.hold_still(robot) {
            return Some(signal);
        }
        let n_scenes = robot.watch.n_scenes();
        let stood = self.stood.as_ref()?;
        if n_scenes >= LIFT_SCENES && is_place_empty(&stood.body, &robot.watch.objects()) {
            return Some(TaskSignal::Done);
        }
        let is_late = n_scenes >= LIFT_SCENES_MAX;
        is_late.then(|| self.fail("something still stands where the object stood"))
    }

    /// Checks that the object is seen at its place.
    pub(super) fn check_place(&mut self, robot: &Robot<'_>) -> Option<TaskSignal> {
        let record = self.record.as_ref()?;
        if record.is_set_back {
            let reason = format!("it was set back, since {}", self.reason);
            return Some(self.fail(reason));
        }
        let foot = record.foot();
        let objects = robot.watch.objects();
        if let Some(found) = object_at(&foot, &objects)
            && robot.watch.is_fresh()
        {
            let name = object_words(found.track, found.label.as_deref());
            tracing::info!("task {}: {name} stands at its place", self.number());
            return Some(TaskSignal::Done);
        }
        let is_late = robot.watch.n_scenes() >= PLACE_SCENES_MAX;
        is_late.then(|| self.fail("the object is not seen at its place"))
    }

    /// Chooses anew among the objects of the newest scene.
    pub(super) fn select(&mut self, robot: &Robot<'_>) {
        let objects = robot.watch.objects();
        let view = TaskView {
            objects: &objects,
            places: &self.config.named_places,
            steps: &self.steps,
            arm_base: robot.watch.arm_base().unwrap_or_default(),
        };
        self.selection = select(&self.goal, &self.rules, &view);
    }
}

/// First state of the step to an object.
fn step_to(next: &NextObject) -> CarryStep {
    CarryStep {
        track: next.track,
        label: next.label.clone(),
        place: next.place.clone(),
        state: StepState::Running,
        reason: String::new(),
    }
}
