//! Robot update: effects of a state report of the arm on robot, facts and events.

use crate::event::EventKind;
use crate::fact::{Property, Subject, ValueRef};
use crate::record_key::RecordKey;
use crate::robot::{Robot, RobotSighting};
use crate::world_model::WorldModel;

impl WorldModel {
    /// Updates the robot from a state report.
    pub fn observe_robot(&mut self, sighting: &RobotSighting<'_>, now_ns: u64) {
        let has_changed = match &self.robot {
            Some(robot) => !robot.has_same_state(sighting),
            None => true,
        };
        if has_changed {
            self.record_action_end(sighting, now_ns);
            let (config, dirty) = (&self.config, &mut self.dirty);
            for value in [
                ValueRef::Activity(sighting.activity),
                ValueRef::Holding(sighting.is_holding),
            ] {
                self.facts
                    .assert_fact(Subject::Robot, value, now_ns, config, dirty);
            }
        }
        let robot = self
            .robot
            .get_or_insert_with(|| Robot::new(sighting, now_ns));
        robot.update(sighting, now_ns);
        let unwritten_ns = now_ns.abs_diff(robot.noted_heard_ns);
        if has_changed || unwritten_ns >= self.config.seen_period_ns {
            robot.noted_heard_ns = now_ns;
            self.dirty.add(RecordKey::Robot);
        }
    }

    /// Records the end of an action. An action that had ended before the first report is not an
    /// event.
    fn record_action_end(&mut self, sighting: &RobotSighting<'_>, now_ns: u64) {
        let Some(robot) = self.robot.as_ref().filter(|robot| robot.is_heard) else {
            return;
        };
        let was_over = robot.command_id == sighting.command_id && robot.outcome.is_some();
        if let Some(outcome) = sighting.outcome
            && sighting.command_id != 0
            && !was_over
        {
            let ended = EventKind::ActionEnded {
                command_id: sighting.command_id,
                outcome,
                note: sighting.note.to_owned(),
            };
            self.events.add(ended, now_ns, &mut self.dirty);
        }
    }

    /// Ends all facts about a robot that no longer sends reports.
    pub fn lose_robot(&mut self) {
        let Some(robot) = self.robot.as_mut().filter(|robot| robot.is_heard) else {
            return;
        };
        robot.is_heard = false;
        for property in [Property::Activity, Property::Holding] {
            let end_ns = robot.last_heard_ns;
            self.facts
                .retract(Subject::Robot, property, end_ns, &mut self.dirty);
        }
        self.dirty.add(RecordKey::Robot);
    }
}
