//! Phases in which the arm moves, and what interrupts its motions.

use super::way_home::way_up;
use super::{N_WAYS_MAX, Robot, TaskRun};
use crate::robot::MotionProgress;
use control_protocol::ArmReport;
use std::ops::ControlFlow;
use std::time::Duration;
use tasks::{TaskPhase, TaskSignal};

/// Time without an answer of the arm after which the task halts.
const ARM_PATIENCE: Duration = Duration::from_secs(20);
/// Height over the planned place at which an object that meets the surface counts as set down,
/// metres. Chosen: it may have turned between the fingers.
const TOUCH_DOWN_M: f64 = 0.06;
/// As [`TOUCH_DOWN_M`], after all ways were tried: a long object that hangs from the fingers is set
/// down as it hangs.
const LAST_TOUCH_DOWN_M: f64 = 0.15;
/// Distance from the planned place seen from above, metres, at which that holds.
const BESIDE_M: f64 = 0.02;

impl TaskRun {
    /// Carries out the motions of the phase.
    pub(super) fn carry_out(&mut self, robot: &mut Robot<'_>) -> Option<TaskSignal> {
        if !self.is_begun {
            let phase = self.state.phase;
            let Some(record) = &self.record else {
                return Some(self.fail("the plan of the transport is lost"));
            };
            self.driver.begin(record.motions(phase));
            self.is_begun = true;
        }
        let progress = self.driver.poll(robot.link);
        self.signal_of(progress)
    }

    /// Keeps the arm at rest with the object in the hand; a signal when that is not so any more.
    pub(super) fn hold_still(&mut self, robot: &mut Robot<'_>) -> Option<TaskSignal> {
        if !self.is_begun {
            self.driver.begin([]);
            self.is_begun = true;
        }
        match self.driver.poll(robot.link) {
            MotionProgress::Done => {
                let is_lost = !self.driver.is_holding();
                is_lost.then(|| self.dropped())
            }
            progress => self.signal_of(progress),
        }
    }

    /// Lifts the hand a little, as far as that goes, and keeps it at rest there. Breaks, perhaps with a
    /// signal, until it rests with the object.
    pub(super) fn rise(&mut self, robot: &mut Robot<'_>) -> ControlFlow<Option<TaskSignal>> {
        if !self.is_begun {
            let Some(report) = self.look_at_arm(robot) else {
                return ControlFlow::Break(None);
            };
            self.driver.begin(way_up(&report));
            self.is_begun = true;
        }
        match self.driver.poll(robot.link) {
            MotionProgress::Failed(_) => {
                self.driver.begin([]);
                ControlFlow::Break(None)
            }
            MotionProgress::Done if self.is_hand_empty() => {
                ControlFlow::Break(Some(self.dropped()))
            }
            MotionProgress::Done => ControlFlow::Continue(()),
            progress => ControlFlow::Break(self.signal_of(progress)),
        }
    }

    /// Newest report of the arm; `None` while it does not answer.
    pub(super) fn look_at_arm(&mut self, robot: &mut Robot<'_>) -> Option<ArmReport> {
        match self.driver.look(robot.link) {
            Ok(report) => Some(report.clone()),
            Err(unanswered) => {
                self.waits_for = format!("the arm: {unanswered}");
                None
            }
        }
    }

    /// True while a pause or a person near the arm interrupts the task.
    pub(super) fn is_waiting(&mut self, robot: &mut Robot<'_>) -> bool {
        let is_motion = self.state.phase.is_motion() && self.is_begun;
        let limit_m = self.config.person_distance_m;
        let distance_m = robot.watch.person_distance_m();
        let is_person_near = is_motion && distance_m.is_some_and(|distance_m| distance_m < limit_m);
        if !self.is_paused && !is_person_near {
            if self.driver.is_halted() {
                self.driver.go_on();
                self.waits_for.clear();
                tracing::info!("task {}: goes on", self.number());
            }
            return false;
        }
        if is_motion && !self.driver.is_halted() {
            self.driver.halt(robot.link);
            if is_person_near {
                self.waits_for = "a person within reach of the arm to step back".into();
                tracing::info!(
                    "task {}: waits, since a person is near the arm",
                    self.number()
                );
            }
        }
        // The lease stays, so that the object in the hand is held.
        if is_motion {
            self.driver.poll(robot.link);
        }
        true
    }

    /// Signal of the arm's progress in the present phase.
    fn signal_of(&mut self, progress: MotionProgress) -> Option<TaskSignal> {
        let phase = self.state.phase;
        let must_hold = phase.has_object() && phase != TaskPhase::SetBack;
        match progress {
            MotionProgress::Moving => (must_hold && self.is_hand_empty()).then(|| self.dropped()),
            MotionProgress::Done if phase == TaskPhase::Close && self.is_hand_empty() => {
                Some(self.fail("the fingers closed on nothing"))
            }
            MotionProgress::Done if must_hold && self.is_hand_empty() => Some(self.dropped()),
            MotionProgress::Done => Some(TaskSignal::Done),
            MotionProgress::Failed(_) if phase == TaskPhase::Lower && self.is_touching_down() => {
                Some(TaskSignal::Done)
            }
            MotionProgress::Failed(reason) => {
                tracing::debug!("task {}: {reason}", self.number());
                Some(self.fail(reason))
            }
            MotionProgress::Stopped(sentence) => {
                self.waits_for = format!("{sentence}; `tabula task resume` lets the task go on");
                self.reason = sentence;
                Some(TaskSignal::Stopped)
            }
            MotionProgress::Silent(sentence) => {
                self.waits_for = format!("the arm: {sentence}");
                let is_late = self.elapsed() > ARM_PATIENCE;
                is_late.then(|| {
                    self.reason = sentence;
                    TaskSignal::Stopped
                })
            }
        }
    }

    fn is_hand_empty(&self) -> bool {
        self.driver
            .report()
            .is_some_and(|report| !report.is_holding)
    }

    fn dropped(&mut self) -> TaskSignal {
        self.reason = "the fingers have lost the object".into();
        TaskSignal::Dropped
    }

    /// True if the arm was stopped by a contact so near to the place that the object has met the
    /// surface.
    fn is_touching_down(&self) -> bool {
        let pair = self.record.as_ref().zip(self.driver.report());
        pair.is_some_and(|(record, report)| {
            let [over_m, beside_m] = record.over_release_m(report.position_m);
            let most_m = if self.n_tries < N_WAYS_MAX {
                TOUCH_DOWN_M
            } else {
                LAST_TOUCH_DOWN_M
            };
            report.is_holding && (0.0..=most_m).contains(&over_m) && beside_m <= BESIDE_M
        })
    }
}
