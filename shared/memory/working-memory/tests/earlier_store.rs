//! Stores of earlier versions open with nothing lost.
//!
//! The fixture of a schema was written by a version of that schema, by the steps of [`fill`]. It
//! must hold what the same steps give today.

#![expect(clippy::unwrap_used, reason = "the helpers of tests fail as tests do")]

use std::fs;
use std::path::Path;

use working_memory::{
    BoxPose, Event, EventKind, Fact, FactQuery, Lesson, LessonKind, MutationId, NewTask,
    ObjectRecord, Outcome, Robot, RobotSighting, Sighting, StepContent, StepState, Subject,
    SurfaceSighting, Task, TaskEnd, WRITE_BUFFER_BYTES, WorkingMemory, WorldCondition, WorldConfig,
    WorldModel,
};

const SECOND: u64 = 1_000_000_000;
const CONFIG: WorldConfig = WorldConfig {
    move_min_m: 0.02,
    turn_min_rad: 0.3,
    keep_ns: 1000 * SECOND,
    n_kept_most: 1000,
    seen_period_ns: 10 * SECOND,
    write_buffer_bytes: WRITE_BUFFER_BYTES,
};

fn sighting(track_id: u64, label: Option<&'static str>, x_m: f64, now_s: u64) -> Sighting<'static> {
    Sighting {
        track_id,
        state: "tracked",
        label,
        is_probable: false,
        place: BoxPose {
            position_m: [x_m, 0.0, 0.7],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            size_m: [0.1; 3],
        },
        surface: None,
        first_seen_ns: SECOND,
        last_seen_ns: now_s * SECOND,
    }
}

/// Two objects of which one is moved and named and the other leaves, an action of the arm, two
/// tasks of which one fails, and a lesson.
fn fill(model: &mut WorldModel) {
    let (unknown, bowl, mug) = (None, Some("bowl"), Some("mug"));
    let scenes = [
        vec![sighting(7, unknown, 0.1, 2), sighting(8, mug, 0.5, 2)],
        vec![sighting(7, bowl, 0.4, 3), sighting(8, mug, 0.5, 3)],
        vec![sighting(7, bowl, 0.4, 4)],
    ];
    for (now_s, scene) in (2..).zip(scenes) {
        model.observe(scene, true, now_s * SECOND);
    }
    let robot = |outcome, activity| RobotSighting {
        activity,
        outcome,
        command_id: 3,
        note: "",
        is_holding: activity == "idle",
        opening_m: 0.05,
        joint_angles_rad: &[0.5; 6],
        position_m: [0.5, 0.25, 1.0],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
    };
    model.observe_robot(&robot(None, "moving"), 5 * SECOND);
    model.observe_robot(&robot(Some(Outcome::Succeeded), "idle"), 6 * SECOND);
    for (id, kind) in [(1, "clear"), (2, "find")] {
        let task = NewTask {
            id: MutationId(id),
            kind: kind.to_owned(),
            parameters: "all".to_owned(),
            author: "anna".to_owned(),
        };
        let now_ns = (6 + id as u64) * SECOND;
        model.start_task(&task, now_ns).unwrap();
    }
    let end = TaskEnd {
        id: MutationId(3),
        task: 1,
        outcome: Outcome::Failed,
        reason: "dropped".to_owned(),
    };
    model.end_task(&end, 9 * SECOND).unwrap();
    let lesson = Lesson {
        kind: LessonKind::Taught,
        category: "bowl".to_owned(),
        track_id: Some(7),
        author: "anna".to_owned(),
        history: 4,
    };
    model.record_teaching(lesson, 10 * SECOND);
}

/// A surface that is kept, and an object whose label is only probable: new in schema 2.
fn fill_doubts_and_surfaces(model: &mut WorldModel) {
    let probable = Sighting {
        is_probable: true,
        ..sighting(9, Some("mug"), 0.6, 11)
    };
    let scene = [sighting(7, Some("bowl"), 0.4, 11), probable];
    model.observe(scene, true, 11 * SECOND);
    let corners_m = [[0.0, 0.0, 0.7], [1.0, 0.0, 0.7], [1.0, 1.0, 0.7]];
    for now_s in [11, 12] {
        let surface = SurfaceSighting {
            kind: "table",
            plane: [0.0, 0.0, 1.0, -0.7],
            corners_m: &corners_m,
        };
        model.observe_surfaces([surface], now_s * SECOND, &mut Vec::new());
    }
}

/// Steps of the running task, of which one failed and one holds its object: new in schema 3.
fn fill_steps(model: &mut WorldModel) {
    for (second, number, state, reason) in [
        (13, 1, StepState::Running, ""),
        (14, 1, StepState::Failed, "it slipped"),
        (15, 2, StepState::Running, ""),
        (16, 2, StepState::Held, ""),
    ] {
        let content = StepContent {
            number,
            state,
            primitive: "lift".to_owned(),
            track_id: 7,
            label: Some("bowl".to_owned()),
            place: Some("shelf".to_owned()),
            attempt: number as u32,
            reason: reason.to_owned(),
            plan: "{}".to_owned(),
        };
        model.record_step(2, content, second * SECOND).unwrap();
    }
}

/// All that a store holds.
type Content = (
    Vec<Fact>,
    Vec<Event>,
    Vec<Task>,
    Vec<ObjectRecord>,
    Option<Robot>,
);

/// Opens a store after the downtime, and reads everything.
fn content(folder: &Path) -> Content {
    let (memory, model, report) = WorkingMemory::open(folder, CONFIG, 100 * SECOND).unwrap();
    assert_eq!(report.condition, WorldCondition::Sound, "{report}");
    memory.close().unwrap();
    let all = FactQuery {
        subject: None,
        label: None,
        region: None,
        window: None,
        before: None,
        n_most: 100,
    };
    (
        model.facts(&all).facts,
        model.events_since(0).cloned().collect(),
        model.tasks_before(u64::MAX).cloned().collect(),
        model.past_objects().cloned().collect(),
        model.robot().cloned(),
    )
}

/// Checks that the fixture of a schema holds what the steps of `fill` give today, and returns it.
fn check_fixture(schema: &str, fill: impl FnOnce(&mut WorldModel)) -> Content {
    let earlier = tempfile::tempdir().unwrap();
    let database = earlier.path().join("database");
    fs::create_dir(&database).unwrap();
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let fixture = fixtures.join(schema).join("database");
    for file in fs::read_dir(fixture).unwrap().flatten() {
        fs::copy(file.path(), database.join(file.file_name())).unwrap();
    }
    let today = tempfile::tempdir().unwrap();
    let (mut memory, mut model, _) = WorkingMemory::open(today.path(), CONFIG, SECOND).unwrap();
    fill(&mut model);
    memory.write_changes(&mut model).unwrap();
    memory.close().unwrap();
    let earlier = content(earlier.path());
    assert_eq!(earlier, content(today.path()));
    earlier
}

#[test]
fn store_of_schema_1_opens_with_nothing_lost() {
    let (facts, events, tasks, objects, robot) = check_fixture("schema-1", fill);
    assert_eq!((facts.len(), tasks.len(), objects.len()), (13, 2, 2));
    assert_eq!(events.len(), 12, "eleven, and the start of the memory");
    assert!(robot.is_some());
}

#[test]
fn store_of_schema_2_opens_with_nothing_lost() {
    let (facts, _, tasks, objects, _) = check_fixture("schema-2", |model| {
        fill(model);
        fill_doubts_and_surfaces(model);
    });
    let is_surface = |fact: &&Fact| matches!(fact.subject, Subject::Surface(_));
    assert_eq!(facts.iter().filter(is_surface).count(), 2);
    assert!(objects.iter().any(|object| object.is_probable));
    assert!(tasks.iter().all(|task| task.steps.is_empty()));
}

#[test]
fn store_of_schema_3_opens_with_nothing_lost() {
    let (_, events, tasks, _, _) = check_fixture("schema-3", |model| {
        fill(model);
        fill_doubts_and_surfaces(model);
        fill_steps(model);
    });
    let steps: Vec<_> = tasks.iter().flat_map(|task| &task.steps).collect();
    assert_eq!(steps.len(), 2);
    assert_eq!(steps[1].content.state, StepState::Held);
    let is_step = |event: &&Event| matches!(event.kind, EventKind::TaskStep(_));
    assert_eq!(events.iter().filter(is_step).count(), 4);
}
