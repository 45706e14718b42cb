//! Golden bytes of all records of the working memory: a stored name never changes by a renamed
//! type.

use std::path::{Path, PathBuf};

use durable_leveldb::record;
use serde::Serialize;
use serde::de::DeserializeOwned;
use test_data::golden;

use crate::event::{Event, EventKind, Lesson, LessonKind, Outcome, StepChange};
use crate::fact::{BoxPose, Fact, Subject, Value};
use crate::object::ObjectRecord;
use crate::record_key::RecordKey;
use crate::robot::Robot;
use crate::surface::SurfaceRecord;
use crate::task::{Task, TaskState};
use crate::task_step::{StepContent, StepState, TaskStep};
use crate::working_memory::WorkingMeta;

fn check<T>(kind: &str, key: RecordKey, examples: &[(&str, T)])
where
    T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug,
{
    let file: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/golden")
        .join(format!("{kind}.txt"));
    let key = key.key();
    golden::check(
        &file,
        examples,
        |value| record::seal(&key, value),
        |bytes| record::unseal(&key, bytes).unwrap(),
    );
}

fn place() -> BoxPose {
    BoxPose {
        position_m: [0.5, -0.25, 0.75],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: [0.125, 0.25, 0.5],
    }
}

fn fact(subject: Subject, value: Value) -> Fact {
    Fact {
        number: 4,
        subject,
        value,
        start_ns: 5,
        end_ns: None,
    }
}

fn object(is_probable: bool) -> ObjectRecord {
    ObjectRecord {
        track_id: 7,
        state: "tracked".to_owned(),
        label: Some("mug".to_owned()),
        is_probable,
        place: place(),
        first_seen_ns: 1,
        last_seen_ns: 2,
        gone_ns: Some(3),
        surface: None,
        scene: 0,
        noted_seen_ns: 0,
    }
}

#[test]
fn golden_facts_are_written_and_read() {
    let object = Subject::Object(7);
    let word = || "word".to_owned();
    let ended = Fact {
        end_ns: Some(6),
        ..fact(Subject::Task(2), Value::State(word()))
    };
    let examples = [
        ("state of an object", fact(object, Value::State(word()))),
        ("label of an object", fact(object, Value::Label(word()))),
        ("place of an object", fact(object, Value::Place(place()))),
        (
            "activity of the robot",
            fact(Subject::Robot, Value::Activity(word())),
        ),
        (
            "holding of the robot",
            fact(Subject::Robot, Value::Holding(true)),
        ),
        ("state of a task that has ended", ended),
    ];
    check("fact", RecordKey::Fact(4), &examples);
}

/// Events of objects, and the start of memory and task.
fn scene_events() -> Vec<(&'static str, EventKind)> {
    let word = || "word".to_owned();
    vec![
        ("started", EventKind::Started),
        (
            "appeared",
            EventKind::Appeared {
                track_id: 7,
                label: None,
                is_probable: false,
                position_m: [0.5, 1.5, 2.5],
            },
        ),
        (
            "vanished",
            EventKind::Vanished {
                track_id: 7,
                label: Some(word()),
                is_probable: false,
            },
        ),
        (
            "relabelled",
            EventKind::Relabelled {
                track_id: 7,
                before: None,
                after: Some(word()),
                before_is_probable: false,
                after_is_probable: false,
            },
        ),
        (
            "moved",
            EventKind::Moved {
                track_id: 7,
                from_m: [0.5, 1.5, 2.5],
                to_m: [3.5, 4.5, 5.5],
            },
        ),
        (
            "question",
            EventKind::Question {
                track_id: 7,
                category: Some(word()),
                sentence: "Is it a word?".to_owned(),
            },
        ),
        (
            "task started",
            EventKind::TaskStarted {
                task: 2,
                kind: word(),
            },
        ),
    ]
}

/// Lessons, and ends of tasks and actions.
fn outcome_events() -> Vec<(&'static str, EventKind)> {
    let word = || "word".to_owned();
    let mut kinds = Vec::new();
    let lessons = [
        ("taught", LessonKind::Taught),
        ("corrected", LessonKind::Corrected),
        ("forgot", LessonKind::Forgot),
    ];
    kinds.extend(lessons.map(|(name, lesson)| {
        let taught = Lesson {
            kind: lesson,
            category: word(),
            track_id: Some(7),
            author: "anna".to_owned(),
            history: 8,
        };
        (name, EventKind::Lesson(taught))
    }));
    let outcomes = [
        ("task succeeded", "action succeeded", Outcome::Succeeded),
        ("task failed", "action failed", Outcome::Failed),
        ("task cancelled", "action cancelled", Outcome::Cancelled),
    ];
    for (task, action, outcome) in outcomes {
        let ended = EventKind::TaskEnded {
            task: 2,
            kind: word(),
            outcome,
            reason: "reason".to_owned(),
        };
        let note = "note".to_owned();
        let action_ended = EventKind::ActionEnded {
            command_id: 9,
            outcome,
            note,
        };
        kinds.extend([(task, ended), (action, action_ended)]);
    }
    kinds
}

#[test]
fn golden_events_are_written_and_read() {
    let event = |kind| Event {
        sequence: 4,
        wall_ns: 5,
        kind,
    };
    let examples: Vec<_> = scene_events()
        .into_iter()
        .chain(outcome_events())
        .map(|(name, kind)| (name, event(kind)))
        .collect();
    check("event", RecordKey::Event(4), &examples);
}

#[test]
fn golden_records_of_subjects_are_written_and_read() {
    let object = object(false);
    check("object", RecordKey::Object(7), &[("object", object)]);
    let robot = Robot {
        activity: "moving".to_owned(),
        command_id: 9,
        outcome: Some(Outcome::Succeeded),
        note: String::new(),
        is_holding: true,
        opening_m: 0.0625,
        joint_angles_rad: vec![0.5, -0.5],
        position_m: [0.5, 1.5, 2.5],
        orientation_xyzw: [0.0, 0.0, 1.0, 0.0],
        last_heard_ns: 4,
        is_heard: true,
        noted_heard_ns: 0,
    };
    check("robot", RecordKey::Robot, &[("robot", robot)]);
    let task = |state| Task {
        number: 2,
        kind: "clear".to_owned(),
        parameters: "all".to_owned(),
        author: "anna".to_owned(),
        started_ns: 5,
        state,
        start_id: 6,
        steps: Vec::new(),
    };
    let ended = TaskState::Ended {
        outcome: Outcome::Failed,
        reason: "reason".to_owned(),
        ended_ns: 8,
        end_id: 9,
    };
    let examples = [
        ("running", task(TaskState::Running)),
        ("ended", task(ended)),
    ];
    check("task", RecordKey::Task(2), &examples);
    let meta = WorkingMeta {
        schema: 1,
        newest_fact: 2,
        newest_event: 3,
        newest_task: 4,
        newest_surface: 0,
    };
    check("meta", RecordKey::Meta, &[("meta", meta)]);
}

#[test]
fn golden_records_of_surfaces_are_written_and_read() {
    let surface = SurfaceRecord {
        number: 3,
        kind: "table".to_owned(),
        plane: [0.0, 0.0, 1.0, -0.75],
        corners_m: vec![[0.0, 0.0, 0.75], [1.0, 0.0, 0.75], [1.0, 1.0, 0.75]],
        first_seen_ns: 1,
        last_seen_ns: 2,
        is_seen: false,
        noted_seen_ns: 0,
    };
    check("surface", RecordKey::Surface(3), &[("surface", surface)]);
    let meta = WorkingMeta {
        schema: 2,
        newest_fact: 2,
        newest_event: 3,
        newest_task: 4,
        newest_surface: 5,
    };
    check("meta-2", RecordKey::Meta, &[("meta", meta)]);
    let state = Value::State("seen".to_owned());
    let fact = fact(Subject::Surface(3), state);
    check(
        "fact-2",
        RecordKey::Fact(4),
        &[("state of a surface", fact)],
    );
}

#[test]
fn golden_records_with_probable_labels_are_written_and_read() {
    let object = object(true);
    check("object-2", RecordKey::Object(7), &[("probable", object)]);
    let label = Value::ProbableLabel("word".to_owned());
    let fact = fact(Subject::Object(7), label);
    let examples = [("probable label of an object", fact)];
    check("fact-probable", RecordKey::Fact(4), &examples);
    let kind = EventKind::Relabelled {
        track_id: 7,
        before: Some("word".to_owned()),
        after: Some("word".to_owned()),
        before_is_probable: true,
        after_is_probable: true,
    };
    let event = Event {
        sequence: 4,
        wall_ns: 5,
        kind,
    };
    check("event-2", RecordKey::Event(4), &[("relabelled", event)]);
}

/// States of a step with the name of each.
const STEP_STATES: [(&str, StepState); 4] = [
    ("running", StepState::Running),
    ("held", StepState::Held),
    ("succeeded", StepState::Succeeded),
    ("failed", StepState::Failed),
];

#[test]
fn golden_records_of_steps_are_written_and_read() {
    let step = |state, name: Option<&str>| TaskStep {
        content: StepContent {
            number: 1,
            state,
            primitive: "lift".to_owned(),
            track_id: 7,
            label: name.map(str::to_owned),
            place: name.map(str::to_owned),
            attempt: 2,
            reason: "reason".to_owned(),
            plan: "{}".to_owned(),
        },
        started_ns: 5,
        ended_ns: state.is_ended().then_some(6),
    };
    let task = |step| Task {
        number: 2,
        kind: "clear".to_owned(),
        parameters: "all".to_owned(),
        author: "anna".to_owned(),
        started_ns: 5,
        state: TaskState::Running,
        start_id: 6,
        steps: vec![step],
    };
    let examples: Vec<_> = STEP_STATES
        .iter()
        .map(|(name, state)| {
            (
                *name,
                task(step(*state, state.is_ended().then_some("word"))),
            )
        })
        .collect();
    check("task-2", RecordKey::Task(2), &examples);
    let event = |state| Event {
        sequence: 4,
        wall_ns: 5,
        kind: EventKind::TaskStep(StepChange {
            task: 2,
            kind: "word".to_owned(),
            step: 1,
            track_id: 7,
            state,
            primitive: "lift".to_owned(),
            reason: "reason".to_owned(),
        }),
    };
    let examples = STEP_STATES.map(|(name, state)| (name, event(state)));
    check("event-3", RecordKey::Event(4), &examples);
}
