//! Steps of tasks: records, repetitions and refusals, and a naive reference of them.

use durable_leveldb::MutationId;

use super::{CONFIG, SECOND, kinds};
use crate::*;

const STATES: [StepState; 4] = [
    StepState::Running,
    StepState::Held,
    StepState::Succeeded,
    StepState::Failed,
];

/// Content of a step with one of the states, and a reason or none.
pub(super) fn content(number: u64, state: usize, reason: usize) -> StepContent {
    StepContent {
        number,
        state: STATES[state],
        primitive: "lift".to_owned(),
        track_id: 7,
        label: Some("mug".to_owned()),
        place: Some("shelf".to_owned()),
        attempt: 1,
        reason: ["", "it slipped"][reason].to_owned(),
        plan: "{}".to_owned(),
    }
}

/// Records a step in a list; `true` if it is recorded then.
pub(super) fn record_naively(
    steps: &mut Vec<TaskStep>,
    is_running: bool,
    content: StepContent,
    now_ns: u64,
) -> bool {
    if steps.iter().any(|step| step.content == content) {
        return true;
    }
    let open = steps.iter().position(|step| step.ended_ns.is_none());
    let is_next = content.number == steps.len() as u64 + 1;
    let started_ns = match open {
        _ if !is_running => return false,
        Some(open) if steps[open].content.number == content.number => steps.remove(open).started_ns,
        None if is_next => now_ns,
        _ => return false,
    };
    let is_ended = content.state.is_ended();
    steps.push(TaskStep {
        content,
        started_ns,
        ended_ns: is_ended.then_some(now_ns.max(started_ns)),
    });
    true
}

/// Ends the last step of a list with its task, which gives no reason.
pub(super) fn end_naively(steps: &mut [TaskStep], ended_ns: u64) {
    if let Some(last) = steps.last_mut()
        && last.ended_ns.is_none()
    {
        last.content.state = StepState::Failed;
        last.content.reason = "the task ended before the step".to_owned();
        last.ended_ns = Some(ended_ns.max(last.started_ns));
    }
}

/// Model with some running tasks.
fn model(n_tasks: u128) -> WorldModel {
    let mut model = WorldModel::new(CONFIG);
    for id in 0..n_tasks {
        let new = NewTask {
            id: MutationId(id),
            kind: "clear".to_owned(),
            parameters: String::new(),
            author: String::new(),
        };
        model.start_task(&new, SECOND).unwrap();
    }
    model
}

fn end(model: &mut WorldModel, task: u64, reason: &str, now_ns: u64) -> Task {
    let end = TaskEnd {
        id: MutationId(100 + u128::from(task)),
        task,
        outcome: Outcome::Cancelled,
        reason: reason.to_owned(),
    };
    model.end_task(&end, now_ns).unwrap().clone()
}

fn refused(model: &mut WorldModel, content: StepContent) -> StepRefusal {
    let (version, newest) = (model.version(), model.newest_event());
    let refusal = model.record_step(1, content, 9 * SECOND).unwrap_err();
    assert_eq!((model.version(), model.newest_event()), (version, newest));
    match refusal {
        TaskRefusal::Step(refusal) => refusal,
        other => panic!("{other:?}"),
    }
}

/// Events of the steps of the model: number and state.
fn step_events(model: &WorldModel) -> Vec<(u64, StepState)> {
    let events = kinds(model, 0).into_iter();
    let step = |kind| match kind {
        EventKind::TaskStep(change) => Some((change.step, change.state)),
        _ => None,
    };
    events.filter_map(step).collect()
}

#[test]
fn step_keeps_its_newest_content_and_each_state_is_one_event() {
    let mut model = model(1);
    for (second, number, state) in [
        (1, 1, 0),
        (2, 1, 0),
        (3, 1, 1),
        (4, 1, 3),
        (5, 2, 0),
        (6, 2, 1),
        (7, 2, 2),
    ] {
        let now_ns = second * SECOND;
        let content = content(number, state, 0);
        let recorded = model.record_step(1, content.clone(), now_ns).unwrap();
        assert_eq!(recorded.steps.last().unwrap().content, content);
    }
    let steps = &model.task(1).unwrap().steps;
    let times: Vec<_> = steps
        .iter()
        .map(|step| (step.started_ns / SECOND, step.ended_ns))
        .collect();
    assert_eq!(times, [(1, Some(4 * SECOND)), (5, Some(7 * SECOND))]);
    let expected = [(1, 0), (1, 1), (1, 3), (2, 0), (2, 1), (2, 2)];
    assert_eq!(
        step_events(&model),
        expected.map(|(number, state)| (number, STATES[state]))
    );
}

#[test]
fn step_that_is_recorded_again_changes_nothing() {
    let mut model = model(1);
    for state in [0, 3] {
        model.record_step(1, content(1, state, 1), SECOND).unwrap();
    }
    model.record_step(1, content(2, 0, 0), SECOND).unwrap();
    let (version, task) = (model.version(), model.task(1).unwrap().clone());
    for again in [content(1, 3, 1), content(2, 0, 0)] {
        assert_eq!(model.record_step(1, again, 5 * SECOND).unwrap(), &task);
    }
    assert_eq!(model.version(), version);
    // Also after the end of the task.
    model.record_step(1, content(2, 2, 0), SECOND).unwrap();
    end(&mut model, 1, "", 6 * SECOND);
    assert!(model.record_step(1, content(2, 2, 0), 7 * SECOND).is_ok());
}

#[test]
fn primitive_of_a_step_changes_without_an_event() {
    let mut model = model(1);
    model.record_step(1, content(1, 0, 0), SECOND).unwrap();
    let (version, newest) = (model.version(), model.newest_event());
    let approach = StepContent {
        primitive: "approach".to_owned(),
        ..content(1, 0, 0)
    };
    model.record_step(1, approach.clone(), 2 * SECOND).unwrap();
    assert!(model.version() > version);
    assert_eq!(model.newest_event(), newest);
    assert_eq!(
        model.task(1).unwrap().open_step().unwrap().content,
        approach
    );
}

#[test]
fn step_out_of_order_is_refused() {
    let mut model = model(1);
    let number = |number, next| StepRefusal::Number {
        task: 1,
        number,
        next,
    };
    assert_eq!(refused(&mut model, content(0, 0, 0)), number(0, 1));
    assert_eq!(refused(&mut model, content(2, 0, 0)), number(2, 1));
    assert_eq!(
        refused(&mut model, content(u64::MAX, 0, 0)),
        number(u64::MAX, 1)
    );
    model.record_step(1, content(1, 0, 0), SECOND).unwrap();
    let open = StepRefusal::IsOpen { task: 1, open: 1 };
    assert_eq!(refused(&mut model, content(2, 0, 0)), open);
    model.record_step(1, content(1, 3, 0), SECOND).unwrap();
    let ended = StepRefusal::HasEnded { task: 1, number: 1 };
    for other in [content(1, 0, 0), content(1, 2, 0), content(1, 3, 1)] {
        assert_eq!(refused(&mut model, other), ended);
    }
    model.record_step(1, content(2, 0, 0), SECOND).unwrap();
    assert_eq!(refused(&mut model, content(1, 0, 0)), ended);
}

#[test]
fn step_of_an_unknown_or_ended_task_is_refused() {
    let mut model = model(1);
    let unknown = model.record_step(2, content(1, 0, 0), SECOND).unwrap_err();
    assert_eq!(unknown, TaskRefusal::Unknown { task: 2 });
    end(&mut model, 1, "", SECOND);
    let ended = model.record_step(1, content(1, 0, 0), SECOND).unwrap_err();
    assert_eq!(ended, TaskRefusal::HasEnded { task: 1 });
}

#[test]
fn step_with_wrong_texts_is_refused() {
    let mut model = model(1);
    let long = |n_bytes: usize| "x".repeat(n_bytes);
    let good = || content(1, 0, 0);
    let no_primitive = StepContent {
        primitive: String::new(),
        ..good()
    };
    let primitive = StepContent {
        primitive: long(65),
        ..good()
    };
    let label = StepContent {
        label: Some(long(65)),
        ..good()
    };
    let place = StepContent {
        place: Some(long(65)),
        ..good()
    };
    let reason = StepContent {
        reason: long(513),
        ..good()
    };
    let plan = StepContent {
        plan: long(8193),
        ..good()
    };
    for (wrong, name) in [
        (no_primitive, "primitive"),
        (primitive, "primitive"),
        (label, "label"),
        (place, "place"),
        (reason, "reason"),
        (plan, "plan"),
    ] {
        let refusal = refused(&mut model, wrong);
        let StepRefusal::Text { what, .. } = &refusal else {
            panic!("{refusal:?}");
        };
        assert_eq!(*what, name);
    }
    let attempt = StepContent {
        attempt: 0,
        ..good()
    };
    assert_eq!(refused(&mut model, attempt), StepRefusal::Attempt);
    let longest = StepContent {
        primitive: long(64),
        label: Some(long(64)),
        place: Some(long(64)),
        reason: long(512),
        plan: long(8192),
        ..good()
    };
    model.record_step(1, longest, SECOND).unwrap();
}

#[test]
fn steps_above_the_limits_of_a_task_are_refused() {
    let mut model = model(1);
    for number in 1..=256 {
        model.record_step(1, content(number, 2, 0), SECOND).unwrap();
    }
    let refusal = refused(&mut model, content(257, 0, 0));
    assert_eq!(refusal, StepRefusal::TooMany { task: 1 });

    let mut model = self::model(1);
    let long = |number, state| StepContent {
        plan: "x".repeat(MAX_PLAN_BYTES),
        ..content(number, state, 0)
    };
    for number in 1..=32 {
        model.record_step(1, long(number, 0), SECOND).unwrap();
        model.record_step(1, long(number, 2), SECOND).unwrap();
    }
    let n_bytes = MAX_TASK_PLAN_BYTES + MAX_PLAN_BYTES;
    let refusal = refused(&mut model, long(33, 0));
    assert_eq!(refusal, StepRefusal::Plans { task: 1, n_bytes });
    let short = StepContent {
        plan: String::new(),
        ..content(33, 0, 0)
    };
    model.record_step(1, short, SECOND).unwrap();
}

#[test]
fn open_step_fails_with_its_task() {
    let mut model = model(3);
    for task in 1..=3 {
        model.record_step(task, content(1, 1, 0), SECOND).unwrap();
    }
    let long = "ü".repeat(400);
    for (task, reason, expected) in [
        (1, "stopped by anna", "stopped by anna"),
        (2, "", "the task ended before the step"),
        (3, long.as_str(), &long[..512]),
    ] {
        let ended = end(&mut model, task, reason, 2 * SECOND);
        let [step] = ended.steps.as_slice() else {
            panic!("{ended:?}");
        };
        assert_eq!(step.content.state, StepState::Failed);
        assert_eq!(step.content.reason, expected);
        assert_eq!(step.ended_ns, Some(2 * SECOND));
    }
    let newest: Vec<_> = kinds(&model, model.newest_event() - 2);
    assert!(matches!(&newest[0], EventKind::TaskStep(change) if change.task == 3));
    assert!(matches!(newest[1], EventKind::TaskEnded { task: 3, .. }));
}

#[test]
fn steps_of_ended_tasks_make_room_for_those_of_running_ones() {
    let mut model = model(300);
    let long = |number| StepContent {
        plan: "x".repeat(MAX_PLAN_BYTES),
        ..content(number, 2, 0)
    };
    let fill = |model: &mut WorldModel, task| {
        let steps = (1..=32).map(long);
        let record = |content| model.record_step(task, content, SECOND).map(|_| ());
        steps.map(record).collect::<Result<Vec<()>, _>>()
    };
    for task in 1..=10 {
        fill(&mut model, task).unwrap();
        end(&mut model, task, "", task * SECOND);
    }
    let n_filled = (11..=300).take_while(|task| fill(&mut model, *task).is_ok());
    let n_filled = n_filled.count() as u64;
    assert!((200..256).contains(&n_filled), "{n_filled}");
    assert!((1..=10).all(|task| model.task(task).is_none()));
    let full = model.record_step(300, long(1), SECOND).unwrap_err();
    assert!(
        matches!(full, TaskRefusal::Step(StepRefusal::Full { .. })),
        "{full}"
    );
    end(&mut model, 11, "", SECOND);
    model.record_step(300, long(1), SECOND).unwrap();
    assert!(model.task(11).is_none());
}
