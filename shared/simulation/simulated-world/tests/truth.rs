//! Tests of the ground truth against rendered images and object poses.

#![expect(clippy::unwrap_used, reason = "a failing set-up must fail the test")]

use geometry::PinholeCamera;
use nalgebra::Vector3;
use point_cloud::Point;
use rendering::kinect::SensorModel;
use simulated_world::{
    ARM_ID, ModelChoice, ModelLibrary, ObjectPlacement, ObjectPlan, ObjectTruth, PERSON_ID, Scene,
    SceneKind, SimulatedKinect, World, truth_json,
};

/// Frame captured from a simulated world.
struct Look {
    truth: Vec<ObjectTruth>,
    points: Vec<Point>,
    mask: Vec<u16>,
}

fn look(world: &World) -> Look {
    let camera = PinholeCamera::KINECT_V1;
    let mut kinect = SimulatedKinect::new(world, camera).unwrap();
    let mut points = vec![Point::default(); camera.n_pixels()];
    let truth = kinect.look(world, 0, &mut points).unwrap();
    let mask = kinect.mask().to_vec();
    Look {
        truth,
        points,
        mask,
    }
}

fn upright(category: &str, position_m: [f64; 2]) -> ObjectPlan {
    ObjectPlan {
        model: ModelChoice::Generated {
            category: category.to_owned(),
            instance: 3,
        },
        placement: ObjectPlacement::Upright {
            position_m,
            yaw_rad: 0.2,
            raised_m: 0.0,
        },
    }
}

fn world_of(objects: Vec<ObjectPlan>) -> World {
    let scene = Scene {
        objects,
        sensor: SensorModel::PERFECT,
        ..Scene::default()
    };
    World::new(scene, ModelLibrary::generated()).unwrap()
}

fn generated(kind: SceneKind, seed: u64) -> World {
    let mut library = ModelLibrary::generated();
    let mut scene = Scene::generate(kind, kind.default_n_objects(), seed, &mut library).unwrap();
    scene.sensor = SensorModel::PERFECT;
    scene.arm = Some(simulated_world::ArmMount::default());
    World::new(scene, library).unwrap()
}

#[test]
fn visible_fraction_is_one_alone_and_less_behind_another_object() {
    let alone = look(&world_of(vec![upright("mug", [0.0, 0.05])]));
    assert_eq!(alone.truth[0].visible_px, alone.truth[0].unoccluded_px);
    assert!((alone.truth[0].visible_fraction() - 1.0).abs() < 1e-12);
    let behind = look(&world_of(vec![
        upright("mug", [0.0, 0.05]),
        upright("cereal-box", [0.03, -0.12]),
    ]));
    let [mug, cereals] = behind.truth.as_slice() else {
        panic!("{:?}", behind.truth);
    };
    assert!(mug.visible_fraction() < 0.5, "{mug:?}");
    assert_eq!(cereals.visible_px, cereals.unoccluded_px);
    // Within a few pixels: the mug stands as before, except for settling.
    let before_px = f64::from(alone.truth[0].unoccluded_px);
    assert!((f64::from(mug.unoccluded_px) / before_px - 1.0).abs() < 0.01);
}

#[test]
fn visible_pixels_are_zero_outside_of_the_image() {
    let mut world = world_of(vec![upright("mug", [0.0, 0.05])]);
    world.set_camera(simulated_world::CameraMount {
        look_at_m: [3.0, -3.0, 0.5],
        ..world.scene().camera
    });
    let truth = &look(&world).truth[0];
    assert_eq!((truth.visible_px, truth.unoccluded_px), (0, 0));
    assert!(truth.visible_fraction().abs() < 1e-12);
}

#[test]
fn mask_pixel_counts_match_the_ground_truth() {
    for (kind, seed) in [
        (SceneKind::Isolated, 1),
        (SceneKind::Pile, 2),
        (SceneKind::SetTable, 3),
    ] {
        let look = look(&generated(kind, seed));
        for object in &look.truth {
            let n = look.mask.iter().filter(|id| **id == object.id).count();
            assert_eq!(n, object.visible_px as usize, "{object:?}");
            assert!(object.visible_px <= object.unoccluded_px, "{object:?}");
        }
        let is_known = |id: &u16| {
            [0, ARM_ID, PERSON_ID].contains(id) || look.truth.iter().any(|object| object.id == *id)
        };
        assert!(look.mask.iter().all(is_known));
    }
}

#[test]
fn points_of_an_object_are_within_its_ground_truth_box() {
    for (kind, seed) in [(SceneKind::Isolated, 4), (SceneKind::Pile, 5)] {
        let world = generated(kind, seed);
        let look = look(&world);
        let world_from_camera = world.world_from_camera();
        for object in &look.truth {
            let object_from_camera = object.world_from_object.inverse() * world_from_camera;
            let half_m = object.size_m / 2.0;
            let seen = look.points.iter().zip(&look.mask);
            let own = seen.filter(|(point, id)| **id == object.id && point.is_finite());
            let mut extent_m = Vector3::<f64>::zeros();
            for (point, _) in own {
                let at = object_from_camera * point.position();
                extent_m = extent_m.sup(&at.coords.abs());
            }
            let outside_m = (extent_m - half_m).max();
            assert!(outside_m < 0.002, "{} {outside_m} m", object.name);
            // At least its half is seen from one side.
            if object.visible_fraction() > 0.99 {
                assert!((extent_m - half_m * 0.5).min() > 0.0, "{}", object.name);
            }
        }
    }
}

#[test]
fn truth_json_matches_the_ground_truth() {
    let look = look(&generated(SceneKind::Isolated, 6));
    let text = truth_json(12, 0.4, &look.truth);
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["frame"], 12);
    let objects = document["objects"].as_array().unwrap();
    assert_eq!(objects.len(), look.truth.len());
    for (written, object) in objects.iter().zip(&look.truth) {
        assert_eq!(written["id"], object.id);
        assert_eq!(written["state"], object.state.word());
        assert_eq!(written["visible_px"], object.visible_px);
        let x = written["position_m"][0].as_f64().unwrap();
        assert!((x - object.world_from_object.translation.x).abs() < 1e-12);
    }
}
