//! Report of a task for people and programs.

use super::{Robot, TaskRun};
use crate::config::Config;
use control_protocol::{LeftObjectReport, PlannedObjectReport, Refusal, TaskOrder, TaskReport};
use std::sync::Arc;
use tasks::{StepState, TaskPhase, left_words, n_attempts, object_words, report};

impl TaskRun {
    /// Report of the task as it is.
    pub(crate) fn report(&self) -> TaskReport {
        let step = self.present_step();
        let n_done = self.steps.iter();
        let n_done = n_done
            .filter(|step| step.state == StepState::Succeeded)
            .count();
        let planned = self.selection.next.iter().map(|next| PlannedObjectReport {
            track_id: next.track,
            label: next.label.clone(),
            place: next.place.clone(),
        });
        let left = self.selection.left.iter().map(|left| LeftObjectReport {
            track_id: left.track,
            reason: left_words(left),
        });
        TaskReport {
            task_id: Some(self.number),
            kind: self.order.kind.word().to_owned(),
            author: self.author.clone(),
            phase: self.state.phase.word().to_owned(),
            is_paused: self.is_paused,
            waits_for: self.waits_for.clone(),
            track_id: step.map(|step| step.track),
            label: step.and_then(|step| step.label.clone()),
            place: step.map(|step| step.place.clone()),
            attempt: step.map_or(0, |step| n_attempts(&self.steps, step.track)),
            n_done: n_done as u32,
            sentence: self.sentence(),
            planned: planned.collect(),
            left: left.collect(),
        }
    }

    /// Sentence about the present phase, or the outcome of the task.
    fn sentence(&self) -> String {
        if self.state.phase.is_end() {
            return self.outcome.clone();
        }
        let object = self.present_step().map_or_else(
            || "the next object".to_owned(),
            |step| object_words(step.track, step.label.as_deref()),
        );
        match self.state.phase {
            TaskPhase::Look => "Looks at the table.".to_owned(),
            TaskPhase::Choose => "Chooses the next object.".to_owned(),
            TaskPhase::Ask => "Asks for names.".to_owned(),
            TaskPhase::Plan | TaskPhase::Replan => format!("Plans the transport of {object}."),
            TaskPhase::Reach | TaskPhase::Approach => format!("Moves the hand to {object}."),
            TaskPhase::Close => format!("Grasps {object}."),
            TaskPhase::Lift | TaskPhase::CheckLift => format!("Lifts {object}."),
            TaskPhase::Carry => format!("Carries {object}."),
            TaskPhase::Lower | TaskPhase::Release => format!("Sets {object} down."),
            TaskPhase::SetBack | TaskPhase::LetGo => format!("Sets {object} back."),
            TaskPhase::Retreat | TaskPhase::Leave | TaskPhase::Return => {
                "Moves the arm out of the camera's sight.".to_owned()
            }
            TaskPhase::CheckPlace => format!("Looks whether {object} stands at its place."),
            TaskPhase::Halt => "Stands still.".to_owned(),
            TaskPhase::Succeeded | TaskPhase::Failed | TaskPhase::Cancelled => String::new(),
        }
    }

    /// Report of what a task of an order would do by the newest scene.
    ///
    /// # Errors
    /// A refusal about an order that cannot be carried out.
    pub(crate) fn preview(
        order: TaskOrder,
        config: Arc<Config>,
        robot: &Robot<'_>,
    ) -> Result<TaskReport, Refusal> {
        let mut task = Self::new(0, (order, String::new()), config)?;
        task.select(robot);
        let what_is_left = report(&task.goal, &[], &task.selection.left);
        let sentence = match task.selection.next.as_slice() {
            [] => what_is_left,
            next => {
                let names = next.iter().map(|one| {
                    let name = object_words(one.track, one.label.as_deref());
                    format!("{name} to {}", one.place)
                });
                format!("Would carry {}.", names.collect::<Vec<_>>().join(", then "))
            }
        };
        Ok(TaskReport {
            task_id: None,
            phase: String::new(),
            sentence,
            ..task.report()
        })
    }
}
