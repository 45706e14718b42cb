//! Conversion between the working memory's tasks and steps and the control protocol.

use control_protocol::{MAX_PAGE_STEPS, RecordedStep, Refusal, RefusalKind, TaskOutcome};
use scene_document::{TaskDocument, TaskStepDocument, TasksDocument};
use working_memory::{
    Outcome, StepContent, StepRefusal, StepState, Task, TaskRefusal, TaskState, TaskStep,
    WorldModel,
};

/// Page of tasks, newest first.
pub(crate) fn tasks(model: &WorldModel, before: Option<u64>, n_most: usize) -> TasksDocument {
    let mut known = model.tasks_before(before.unwrap_or(u64::MAX));
    let tasks: Vec<TaskDocument> = known.by_ref().take(n_most).map(task_of_page).collect();
    let has_more = known.next().is_some();
    let next = tasks.last().map(|task| task.task_id).filter(|_| has_more);
    TasksDocument { tasks, next }
}

/// Task with all its steps and their plans; a refusal if there is none.
pub(crate) fn whole_task(model: &WorldModel, number: u64) -> Result<TaskDocument, Refusal> {
    let known = model.task(number);
    let known = known.ok_or_else(|| refusal(&TaskRefusal::Unknown { task: number }))?;
    let steps = known.steps.iter().map(step);
    Ok(task(known, steps.collect()))
}

/// Task as on a page: with its newest steps, without their plans.
pub(crate) fn task_of_page(known: &Task) -> TaskDocument {
    let n_older = known.steps.len().saturating_sub(MAX_PAGE_STEPS);
    let steps = known.steps.iter().skip(n_older).map(step_of_page);
    task(known, steps.collect())
}

fn task(task: &Task, steps: Vec<TaskStepDocument>) -> TaskDocument {
    let (state, ended_ns, reason) = match &task.state {
        TaskState::Running => ("running", None, ""),
        TaskState::Ended {
            outcome,
            reason,
            ended_ns,
            ..
        } => (word(*outcome), Some(*ended_ns), reason.as_str()),
    };
    TaskDocument {
        task_id: task.number,
        kind: task.kind.clone(),
        parameters: task.parameters.clone(),
        author: task.author.clone(),
        state: state.to_owned(),
        phase: String::new(),
        plan: Vec::new(),
        track_ids: Vec::new(),
        started_ns: task.started_ns,
        ended_ns,
        reason: reason.to_owned(),
        steps,
    }
}

fn step(step: &TaskStep) -> TaskStepDocument {
    TaskStepDocument {
        plan: step.content.plan.clone(),
        ..step_of_page(step)
    }
}

fn step_of_page(step: &TaskStep) -> TaskStepDocument {
    let content = &step.content;
    TaskStepDocument {
        number: content.number,
        state: step_word(content.state).to_owned(),
        primitive: content.primitive.clone(),
        track_id: content.track_id,
        label: content.label.clone(),
        place: content.place.clone(),
        attempt: content.attempt,
        reason: content.reason.clone(),
        plan: String::new(),
        started_ns: step.started_ns,
        ended_ns: step.ended_ns,
    }
}

/// Content of a step in the working memory's own type; a refusal if its state is none.
pub(crate) fn content(step: RecordedStep) -> Result<StepContent, Refusal> {
    let states = [
        StepState::Running,
        StepState::Held,
        StepState::Succeeded,
        StepState::Failed,
    ];
    let mut states = states.into_iter();
    let state = states.find(|state| step_word(*state) == step.state);
    let state = state.ok_or_else(|| {
        let sentence = format!(
            "a step has no state \"{}\"; use running, held, succeeded or failed",
            step.state
        );
        Refusal::new(RefusalKind::Invalid, sentence)
    })?;
    Ok(StepContent {
        number: step.number,
        state,
        primitive: step.primitive,
        track_id: step.track_id,
        label: step.label,
        place: step.place,
        attempt: step.attempt,
        reason: step.reason,
        plan: step.plan,
    })
}

/// Word for the outcome of a task or an action.
pub(crate) fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Succeeded => "succeeded",
        Outcome::Failed => "failed",
        Outcome::Cancelled => "cancelled",
    }
}

/// Word for the state of a step.
pub(crate) fn step_word(state: StepState) -> &'static str {
    match state {
        StepState::Running => "running",
        StepState::Held => "held",
        StepState::Succeeded => "succeeded",
        StepState::Failed => "failed",
    }
}

/// Outcome of a task in the working memory's own type.
pub(crate) fn outcome(outcome: TaskOutcome) -> Outcome {
    match outcome {
        TaskOutcome::Succeeded => Outcome::Succeeded,
        TaskOutcome::Failed => Outcome::Failed,
        TaskOutcome::Cancelled => Outcome::Cancelled,
    }
}

/// Refusal of a task request as a wire refusal.
pub(crate) fn refusal(refusal: &TaskRefusal) -> Refusal {
    let kind = match refusal {
        TaskRefusal::Unknown { .. } => RefusalKind::NotFound,
        TaskRefusal::HasEnded { .. } | TaskRefusal::TooMany { .. } => RefusalKind::Conflict,
        TaskRefusal::Step(refusal) => step_refusal_kind(refusal),
        _ => RefusalKind::Invalid,
    };
    Refusal::new(kind, refusal.to_string())
}

/// Kind of a refusal of a step: a conflict with what is recorded, or invalid by itself.
fn step_refusal_kind(refusal: &StepRefusal) -> RefusalKind {
    match refusal {
        StepRefusal::Attempt | StepRefusal::Text { .. } => RefusalKind::Invalid,
        _ => RefusalKind::Conflict,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_protocol as protocol;
    use perceptual_memory::MutationId;
    use working_memory::{NewTask, WRITE_BUFFER_BYTES, WorldConfig};

    /// Model with a task of some steps, of which all but the last have ended.
    fn model(n_steps: u64) -> WorldModel {
        let mut model = WorldModel::new(WorldConfig {
            move_min_m: 0.02,
            turn_min_rad: 0.3,
            keep_ns: 1000,
            n_kept_most: 1000,
            seen_period_ns: 10,
            write_buffer_bytes: WRITE_BUFFER_BYTES,
        });
        let new = NewTask {
            id: MutationId(1),
            kind: "clear".into(),
            parameters: String::new(),
            author: String::new(),
        };
        model.start_task(&new, 1).unwrap();
        for number in 1..=n_steps {
            let state = if number < n_steps { "failed" } else { "held" };
            let step = content(recorded(number, state)).unwrap();
            model.record_step(1, step, 2).unwrap();
        }
        model
    }

    fn recorded(number: u64, state: &str) -> RecordedStep {
        RecordedStep {
            number,
            state: state.into(),
            primitive: "lift".into(),
            track_id: 7,
            label: Some("mug".into()),
            place: None,
            attempt: 1,
            reason: String::new(),
            plan: "{}".into(),
        }
    }

    #[test]
    fn page_has_the_newest_steps_without_their_plans() {
        let model = model(20);
        let page = tasks(&model, None, 10);
        let steps = &page.tasks[0].steps;
        assert_eq!(steps.len(), MAX_PAGE_STEPS);
        assert_eq!((steps[0].number, steps[15].number), (5, 20));
        assert!(steps.iter().all(|step| step.plan.is_empty()));
        assert_eq!(steps[14].ended_ns, Some(2));
        assert_eq!(
            (steps[15].state.as_str(), steps[15].ended_ns),
            ("held", None)
        );
    }

    #[test]
    fn whole_task_has_all_steps_with_their_plans() {
        let model = model(20);
        let task = whole_task(&model, 1).unwrap();
        assert_eq!(task.steps.len(), 20);
        assert!(task.steps.iter().all(|step| step.plan == "{}"));
        let unknown = whole_task(&model, 2).unwrap_err();
        assert_eq!(unknown.kind, RefusalKind::NotFound);
    }

    #[test]
    fn step_of_an_unknown_state_is_refused() {
        let refusal = content(recorded(1, "cancelled")).unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::Invalid);
        assert!(refusal.sentence.contains("cancelled"), "{refusal}");
    }

    #[test]
    fn refused_steps_are_conflicts_or_invalid() {
        let mut model = model(2);
        let kind = |model: &mut WorldModel, step| {
            let content = content(step).unwrap();
            refusal(&model.record_step(1, content, 3).unwrap_err()).kind
        };
        for conflict in [
            recorded(1, "held"),
            recorded(3, "held"),
            recorded(9, "held"),
        ] {
            assert_eq!(kind(&mut model, conflict), RefusalKind::Conflict);
        }
        let no_attempt = RecordedStep {
            attempt: 0,
            ..recorded(2, "held")
        };
        let no_primitive = RecordedStep {
            primitive: String::new(),
            ..recorded(2, "held")
        };
        for invalid in [no_attempt, no_primitive] {
            assert_eq!(kind(&mut model, invalid), RefusalKind::Invalid);
        }
    }

    /// The limits that fit into a message are those that the working memory keeps.
    #[test]
    fn limits_of_protocol_and_memory_are_equal() {
        let of_protocol = [
            protocol::MAX_TASK_STEPS,
            protocol::MAX_STEP_WORD_BYTES,
            protocol::MAX_STEP_REASON_BYTES,
            protocol::MAX_PLAN_BYTES,
            protocol::MAX_TASK_PLAN_BYTES,
        ];
        let of_memory = [
            working_memory::MAX_TASK_STEPS,
            working_memory::MAX_STEP_WORD_BYTES,
            working_memory::MAX_STEP_REASON_BYTES,
            working_memory::MAX_PLAN_BYTES,
            working_memory::MAX_TASK_PLAN_BYTES,
        ];
        assert_eq!(of_protocol, of_memory);
    }
}
