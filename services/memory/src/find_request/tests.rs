use super::*;
use scene_document::{CameraPoseDocument, ColorShareDocument, NearCategoryDocument};

fn object(track_id: u64, label: Option<&str>, position_m: [f64; 3], color: &str) -> ObjectDocument {
    ObjectDocument {
        colors: vec![ColorShareDocument {
            color: color.into(),
            share: 0.9,
        }],
        track_id,
        state: TrackState::Tracked.word().to_owned(),
        label: label.map(str::to_owned),
        probability: Some(0.9),
        position_m,
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m: [0.1; 3],
        ..ObjectDocument::default()
    }
}

fn known(scene: SceneDocument) -> KnownWorld {
    let upright = upright_from_world(&scene);
    let object = |object: &ObjectDocument| live_object(object, &upright, &[], 0);
    KnownWorld {
        objects: scene.objects.iter().map(object).collect(),
        viewpoint: viewpoint(&scene, &upright),
        upright,
        taught_names: vec!["mug".into(), "box".into()],
        scene,
        lessons: vec![],
    }
}

fn found(world: &KnownWorld, words: &str) -> Vec<u64> {
    let query = FindQuery {
        words: words.into(),
        speaker: None,
        utc_offset_s: 0,
    };
    let report = world.answer(&query, &Synonyms::default()).unwrap();
    report.matches.iter().map(|found| found.track_id).collect()
}

/// Two mugs and a box in front of a camera without a pose: the world is the camera frame.
fn scene_of_a_camera() -> SceneDocument {
    let up = Vector3::new(0.0, -1.0, -1.0).normalize();
    SceneDocument {
        objects: vec![
            object(1, Some("mug"), [-0.3, 0.1, 1.0], "red"),
            object(2, Some("mug"), [0.3, 0.1, 1.0], "blue"),
            object(3, Some("box"), [0.0, 0.1, 1.0], "brown"),
        ],
        has_table: true,
        up: Some(up.into()),
        camera: Some(CameraPoseDocument {
            position_m: [0.0; 3],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        }),
        ..SceneDocument::default()
    }
}

#[test]
fn find_knows_left_and_right_without_a_camera_pose() {
    let world = known(scene_of_a_camera());
    assert_eq!(found(&world, "the mug left of the box"), [1]);
    assert_eq!(found(&world, "the mug to the right of the box"), [2]);
    assert_eq!(found(&world, "the blue mug"), [2]);
}

#[test]
fn find_without_a_table_and_a_pose_has_no_viewpoint() {
    let scene = SceneDocument {
        up: None,
        ..scene_of_a_camera()
    };
    assert_eq!(known(scene).viewpoint, None);
}

#[test]
fn find_uses_the_image_when_the_camera_looks_straight_down() {
    let scene = SceneDocument {
        up: Some([0.0, 0.0, -1.0]),
        ..scene_of_a_camera()
    };
    let viewpoint = known(scene).viewpoint.unwrap();
    let right = Vector3::from(viewpoint.right_in_world);
    let of_camera = upright_from_world(&SceneDocument {
        up: Some([0.0, 0.0, -1.0]),
        ..scene_of_a_camera()
    }) * Vector3::x();
    assert!((right - of_camera).norm() < 1e-6, "{right} {of_camera}");
}

#[test]
fn find_answers_from_gone_objects_when_no_live_one_fits() {
    let mut world = known(scene_of_a_camera());
    world.objects.push(WorldObject {
        track_id: 9,
        names: vec![("teapot".into(), 1.0)],
        presence: Presence::Gone,
        ..world.objects[0].clone()
    });
    world.taught_names.push("teapot".into());
    let query = FindQuery {
        words: "the teapot".into(),
        speaker: None,
        utc_offset_s: 0,
    };
    let report = world.answer(&query, &Synonyms::default()).unwrap();
    assert_eq!(report.matches[0].track_id, 9);
    assert_eq!(report.matches[0].state, GONE);
    assert!(!report.matches[0].doubts.is_empty());
}

#[test]
fn find_matches_gone_objects_by_what_is_known_of_them() {
    let mut world = known(scene_of_a_camera());
    world.objects.push(WorldObject {
        track_id: 9,
        names: vec![("teapot".into(), 1.0)],
        color_shares: [0.0; ColorTerm::ALL.len()],
        presence: Presence::Gone,
        ..world.objects[0].clone()
    });
    assert_eq!(found(&world, "the teapot left of the box"), [9]);
    assert!(found(&world, "the teapot right of the box").is_empty());
    assert!(found(&world, "the red teapot").is_empty());
    assert!(found(&world, "the teapot that is not red").is_empty());
}

#[test]
fn find_reports_the_place_of_a_gone_object_in_the_world() {
    let mut world = known(scene_of_a_camera());
    let position_m = [0.1, 0.2, 1.1];
    let upright = world.upright;
    world.objects.push(WorldObject {
        track_id: 9,
        names: vec![("teapot".into(), 1.0)],
        presence: Presence::Gone,
        centre_in_world_m: (upright * Vector3::from(position_m)).into(),
        ..world.objects[0].clone()
    });
    let query = FindQuery {
        words: "the teapot".into(),
        speaker: None,
        utc_offset_s: 0,
    };
    let report = world.answer(&query, &Synonyms::default()).unwrap();
    let reported = Vector3::from(report.matches[0].position_m.unwrap());
    assert!((reported - Vector3::from(position_m)).norm() < 1e-9);
}

#[test]
fn find_refuses_a_query_without_words() {
    let query = FindQuery {
        words: " ?! ".into(),
        speaker: None,
        utc_offset_s: 0,
    };
    let refusal = known(scene_of_a_camera())
        .answer(&query, &Synonyms::default())
        .unwrap_err();
    assert_eq!(refusal.kind, RefusalKind::Invalid);
}

#[test]
fn find_takes_the_label_before_the_probable_categories() {
    let mut unknown = object(4, None, [0.0; 3], "red");
    unknown.categories = vec![NearCategoryDocument {
        label: "mug".into(),
        distance: 0.5,
        probability: 0.3,
    }];
    assert_eq!(names(&unknown), [("mug".to_owned(), 0.3)]);
    let labelled = ObjectDocument {
        label: Some("box".into()),
        ..unknown
    };
    let expected = [("box".to_owned(), 0.9), ("mug".to_owned(), 0.3)];
    assert_eq!(names(&labelled), expected);
}
