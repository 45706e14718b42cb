//! Golden bytes of the documents: keys and their order never change by a renamed field.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use scene_document::{
    ActorStampsDocument, AssumptionDocument, CameraPoseDocument, CategoryAnswer, CategoryDocument,
    ColorShareDocument, CovarianceDocument, EventDocument, FactDocument, FindingDocument,
    HealthDocument, ModelDocument, ModelViewDocument, NearCategoryDocument, ObjectDocument,
    PlaceDocument, RefusedViewDocument, RejectedDocument, RobotDocument, SceneDocument,
    SurfaceDocument, TaskDocument, TaskStepDocument, WorldDocument, WorldObjectDocument,
    WorldSurfaceDocument,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;
use test_data::golden;

fn check<T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(
    kind: &str,
    examples: &[(&str, T)],
) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    golden::check(
        &folder.join(format!("{kind}.txt")),
        examples,
        |value| serde_json::to_vec(value).unwrap(),
        |bytes| serde_json::from_slice(bytes).unwrap(),
    );
}

fn object() -> ObjectDocument {
    ObjectDocument {
        track_id: 7,
        state: "tracked".into(),
        scene_age_s: Some(0.5),
        capture_stamp_ns: Some(9),
        label: Some("mug".into()),
        answer: CategoryAnswer::Is,
        distance: Some(0.25),
        probability: Some(0.75),
        position_m: [0.5, -0.5, 1.0],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: [0.125, 0.25, 0.5],
        first_seen_ns: 1,
        last_seen_ns: 8,
        age_s: 1.5,
        unseen_s: 0.5,
        n_points: 100,
        n_views: 3,
        mean_rgb: [1, 2, 3],
        colors: vec![ColorShareDocument {
            color: "red".into(),
            share: 0.5,
        }],
        cut_by_image: true,
        memory_sequence: 4,
        covariance: Some(CovarianceDocument {
            position_m2: [1.0; 6],
            rotation_rad2: [2.0; 6],
        }),
        velocity_m_s: Some([0.5; 3]),
        angular_velocity_rad_s: Some([0.25; 3]),
        view: Some(2),
        is_key_view: true,
        n_key_views: 2,
        n_sides: 1,
        categories: vec![NearCategoryDocument {
            label: "mug".into(),
            distance: 0.25,
            probability: 0.75,
        }],
        linked_to: Some(5),
        stamps: ActorStampsDocument {
            asked_ns: Some(1),
            ..ActorStampsDocument::default()
        },
    }
}

fn rejected() -> RejectedDocument {
    RejectedDocument {
        position_m: [0.5; 3],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: [0.25; 3],
        n_points: 5,
        verdict: "false".into(),
        why: vec!["it is a part of the table's edge".into()],
        findings: vec![FindingDocument {
            constraint: "C_edge".into(),
            truth: "true".into(),
            reason: 51,
            sentence: "it is at the table's rim".into(),
        }],
    }
}

#[test]
fn golden_objects_and_scenes_are_written_and_read() {
    let unknown = ObjectDocument::default();
    let probable = ObjectDocument {
        answer: CategoryAnswer::Probably,
        ..ObjectDocument::default()
    };
    let examples = [
        ("known", object()),
        ("unknown", unknown),
        ("probable", probable),
    ];
    check("object", &examples);
    let scene = SceneDocument {
        scene_age_s: Some(0.5),
        capture_stamp_ns: Some(9),
        is_stale: true,
        note: "no frame was processed".into(),
        objects: vec![object()],
        n_more: 1,
        session: "18446744073709551615".into(),
        frame_sequence: 3,
        source_name: "camera".into(),
        received_ns: Some(10),
        published_ns: Some(11),
        frames_dropped: 2,
        n_late: 1,
        has_table: true,
        surfaces: vec![SurfaceDocument {
            kind: "table".into(),
            normal: [0.0, 0.0, 1.0],
            offset_m: -0.75,
            outline_m: vec![[0.0, 0.0, 0.75], [1.0, 0.0, 0.75], [1.0, 1.0, 0.75]],
            n_samples: 900,
            track_ids: vec![7],
        }],
        has_world_pose: true,
        camera: Some(CameraPoseDocument {
            position_m: [0.0, 0.0, 1.5],
            orientation_xyzw: [1.0, 0.0, 0.0, 0.0],
        }),
        up: Some([0.0, 0.0, 1.0]),
        rule: "not C_edge".into(),
        assumptions: vec![AssumptionDocument {
            name: "no-robot-known".into(),
            sentence: "no arm state came".into(),
        }],
        ignored: vec![rejected()],
        n_more_ignored: 6,
    };
    check(
        "scene-2",
        &[("scene", scene), ("none", SceneDocument::default())],
    );
}

fn place() -> PlaceDocument {
    PlaceDocument {
        position_m: [0.5, -0.5, 1.0],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: [0.125, 0.25, 0.5],
    }
}

#[test]
fn golden_scene_of_0_2_is_still_read() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/scene.txt");
    let scenes = golden::read(&file);
    let read = |bytes: &[u8]| serde_json::from_slice::<SceneDocument>(bytes).unwrap();
    let scenes: Vec<SceneDocument> = scenes.iter().map(|(_, bytes)| read(bytes)).collect();
    let table = &scenes[0].surfaces[0];
    assert_eq!((table.kind.as_str(), table.offset_m), ("table", -0.75));
    assert!(table.outline_m.is_empty() && table.track_ids.is_empty() && table.n_samples == 0);
    assert!(scenes[1].surfaces.is_empty());
}

#[test]
fn golden_world_of_the_first_form_is_still_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let bytes = |name: &str| golden::read(&folder.join(name)).remove(0).1;
    let world: WorldDocument = serde_json::from_slice(&bytes("world.txt")).unwrap();
    assert!(world.surfaces.is_empty());
    let fact: FactDocument = serde_json::from_slice(&bytes("fact.txt")).unwrap();
    assert_eq!((fact.surface_id, fact.answer), (None, None));
    let event: EventDocument = serde_json::from_slice(&bytes("event.txt")).unwrap();
    assert_eq!(event.answer, CategoryAnswer::Unknown);
}

#[test]
fn golden_events_and_tasks_without_steps_are_still_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let bytes = |name: &str| golden::read(&folder.join(name)).remove(0).1;
    let event: EventDocument = serde_json::from_slice(&bytes("event-2.txt")).unwrap();
    assert_eq!((event.step, event.primitive), (None, None));
    let task: TaskDocument = serde_json::from_slice(&bytes("task.txt")).unwrap();
    assert_eq!((task.task_id, task.steps.len()), (2, 0));
}

#[test]
fn golden_world_and_facts_are_written_and_read() {
    let object = WorldObjectDocument {
        track_id: 7,
        state: "tracked".into(),
        state_since_ns: 1,
        label: Some("mug".into()),
        answer: CategoryAnswer::Probably,
        label_since_ns: Some(2),
        place: place(),
        place_since_ns: 3,
        first_seen_ns: 1,
        last_seen_ns: 4,
    };
    let robot = RobotDocument {
        activity: "moving".into(),
        is_holding: true,
        note: String::new(),
        opening_m: 0.0625,
        joint_angles_rad: vec![0.5, -0.5],
        position_m: [0.5, 1.5, 2.5],
        orientation_xyzw: [0.0, 0.0, 1.0, 0.0],
        last_heard_ns: 4,
        is_heard: true,
    };
    let surface = WorldSurfaceDocument {
        surface_id: 3,
        kind: "table".into(),
        state: "seen".into(),
        normal: [0.0, 0.0, 1.0],
        offset_m: -0.75,
        outline_m: vec![[0.0, 0.0, 0.75], [1.0, 0.0, 0.75], [1.0, 1.0, 0.75]],
        track_ids: vec![7],
        first_seen_ns: 1,
        last_seen_ns: 4,
    };
    let world = WorldDocument {
        now_ns: 5,
        scene_age_s: Some(0.5),
        capture_stamp_ns: Some(9),
        is_stale: false,
        objects: vec![object],
        surfaces: vec![surface],
        robot: Some(robot),
        newest_event: 6,
    };
    check("world-2", &[("world", world)]);
    let fact = FactDocument {
        fact: 4,
        subject: "object".into(),
        track_id: Some(7),
        task_id: None,
        surface_id: None,
        property: "place".into(),
        value: None,
        answer: None,
        place: Some(place()),
        start_ns: 5,
        end_ns: Some(6),
    };
    check("fact-2", &[("place of an object", fact)]);
}

#[test]
fn golden_events_and_tasks_are_written_and_read() {
    let event = EventDocument {
        sequence: 4,
        wall_ns: 5,
        event: "moved".into(),
        track_id: Some(7),
        task_id: Some(2),
        label: Some("mug".into()),
        answer: CategoryAnswer::Is,
        label_before: Some("cup".into()),
        answer_before: CategoryAnswer::Probably,
        position_m: Some([0.5; 3]),
        from_m: Some([1.5; 3]),
        command_id: Some(9),
        task_kind: Some("clear".into()),
        step: Some(3),
        primitive: Some("lift".into()),
        reason: "reason".into(),
        author: Some("anna".into()),
        history_sequence: Some(8),
        sentence: String::new(),
    };
    check("event-3", &[("event", event.in_words())]);
    let step = TaskStepDocument {
        number: 1,
        state: "failed".into(),
        primitive: "lift".into(),
        track_id: 7,
        label: Some("mug".into()),
        place: Some("shelf".into()),
        attempt: 1,
        reason: "it slipped".into(),
        plan: "{}".into(),
        started_ns: 5,
        ended_ns: Some(6),
    };
    let task = TaskDocument {
        task_id: 2,
        kind: "clear".into(),
        parameters: "all".into(),
        author: "anna".into(),
        state: "failed".into(),
        phase: "grasp".into(),
        plan: vec!["pick 7".into()],
        track_ids: vec![7],
        started_ns: 5,
        ended_ns: Some(6),
        reason: "reason".into(),
        steps: vec![step],
    };
    check("task-2", &[("task", task)]);
}

#[test]
fn golden_categories_models_and_health_are_written_and_read() {
    let category = CategoryDocument {
        category: "mug".into(),
        n_views: 3,
        bytes: 900,
        last_taught_ns: 5,
    };
    check("category", &[("category", category)]);
    let model = ModelDocument {
        name: "mug".into(),
        bytes: 900,
        author: "anna".into(),
        decided_ns: 5,
        sequence: 4,
        extents_m: [0.125, 0.25, 0.5],
        n_vertices: 10,
        n_triangles: 20,
        is_closed_loop: true,
        completeness: 0.75,
        missing: vec!["below".into()],
        unseen_directions: vec![[0.0, 0.0, -1.0]],
        views: vec![ModelViewDocument {
            captured_ns: 3,
            n_points: 100,
            new_surface_share: 0.5,
            position_m: [0.0, 0.0, 1.5],
            orientation_xyzw: [1.0, 0.0, 0.0, 0.0],
        }],
        refused: vec![RefusedViewDocument {
            captured_ns: 4,
            reason: "it does not fit".into(),
        }],
    };
    check("model", &[("model", model)]);
    let health = HealthDocument {
        process: "camera".into(),
        pid: 3,
        state: "ready".into(),
        stamp_ns: 9,
        started_ns: 1,
        uptime_s: 0.5,
        frames: 10,
        frames_dropped: 1,
        frames_late: 2,
        allocated_bytes: 3,
        resident_bytes: 4,
        shared_memory_bytes: 5,
        restarts: 6,
        actors: 7,
        abandoned: 8,
        note: "note".into(),
    };
    check("health", &[("health", health)]);
}
