use super::*;
use nalgebra::{Translation3, UnitQuaternion};

fn pose(x: f64, y: f64, z: f64, turn: f64) -> RigidTransform {
    RigidTransform::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::from_euler_angles(turn, 0.4 * turn, -turn),
    )
}

/// Three cups and a box.
fn objects() -> Vec<BopWorldObject> {
    let object = |model, world_from_object| BopWorldObject {
        model,
        world_from_object,
    };
    vec![
        object(1, pose(0.0, 0.0, 0.1, 0.3)),
        object(1, pose(0.1, 0.02, 0.1, 1.3)),
        object(1, pose(-0.05, 0.12, 0.15, -0.7)),
        object(2, pose(-0.1, -0.1, 0.12, 2.0)),
    ]
}

/// Image from a camera of the objects with these indices, in their order.
fn image(number: u32, world_from_camera: &RigidTransform, shown: &[usize]) -> BopImage {
    let objects = objects();
    let seen = |&index: &usize| BopObject {
        model: objects[index].model,
        camera_from_object: world_from_camera.inverse() * objects[index].world_from_object,
        visible_share: Some(1.0),
    };
    BopImage {
        number,
        focal_px: [550.0; 2],
        principal_px: [320.0, 240.0],
        depth_scale_mm: 1.0,
        camera_from_world: None,
        objects: shown.iter().map(seen).collect(),
    }
}

fn assert_near(a: &RigidTransform, b: &RigidTransform) {
    let off = a.inverse() * b;
    assert!(
        off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-6,
        "{off}"
    );
}

#[test]
fn given_camera_poses_are_the_world() {
    let cameras = [pose(0.0, -0.5, 0.9, 0.2), pose(0.4, 0.3, 0.8, -0.5)];
    let images: Vec<BopImage> = [(0, vec![0, 3]), (1, vec![3, 2, 0])]
        .into_iter()
        .map(|(i, shown)| BopImage {
            camera_from_world: Some(cameras[i].inverse()),
            ..image(i as u32, &cameras[i], &shown)
        })
        .collect();
    let world = BopWorld::of(&images).unwrap();
    assert_eq!(world.objects_of_images, [vec![0, 1], vec![1, 2, 0]]);
    for (camera, expected) in world.world_from_cameras.iter().zip(&cameras) {
        assert_near(camera, expected);
    }
    assert_near(
        &world.objects[2].world_from_object,
        &objects()[2].world_from_object,
    );
}

#[test]
fn cameras_follow_from_common_objects_in_any_order() {
    let cameras = [
        pose(0.0, -0.5, 0.9, 0.2),
        pose(0.4, 0.3, 0.8, -0.5),
        pose(-0.4, 0.1, 0.7, 0.9),
    ];
    // The second image shares no object with the first, but both do with the third.
    let images = [
        image(4, &cameras[0], &[0, 1]),
        image(7, &cameras[1], &[3, 2]),
        image(9, &cameras[2], &[3, 1, 2, 0]),
    ];
    let world = BopWorld::of(&images).unwrap();
    assert_eq!(world.objects.len(), 4);
    assert_eq!(world.world_from_cameras[0], RigidTransform::identity());
    for (camera, expected) in world.world_from_cameras.iter().zip(&cameras) {
        assert_near(&(cameras[0] * camera), expected);
    }
    // An object is the same in all images, whatever its place in their lists.
    let [first, second, third] = [0, 1, 2].map(|image| &world.objects_of_images[image]);
    assert_eq!([third[3], third[1]], [first[0], first[1]]);
    assert_eq!([third[0], third[2]], [second[0], second[1]]);
}

#[test]
fn annotations_that_differ_by_millimetres_are_one_object() {
    let camera = pose(0.4, 0.3, 0.8, -0.5);
    let mut second = image(1, &camera, &[0, 1, 2, 3]);
    for (seen, sign) in second.objects.iter_mut().zip([1.0, -1.0, 1.0, -1.0]) {
        seen.camera_from_object.translation.vector.x += 0.002 * sign;
    }
    let first = image(0, &RigidTransform::identity(), &[0, 1, 2, 3]);
    let world = BopWorld::of(&[first, second]).unwrap();
    assert_eq!(world.objects.len(), 4);
    let off = world.world_from_cameras[1].translation.vector - camera.translation.vector;
    assert!(off.norm() < 0.006, "{off}");
}

#[test]
fn image_without_a_certain_object_is_named() {
    let cameras = [pose(0.0, -0.5, 0.9, 0.2), pose(0.4, 0.3, 0.8, -0.5)];
    let first = image(0, &cameras[0], &[0, 1, 2]);
    // No object in common.
    assert_eq!(
        BopWorld::of(&[first.clone(), image(5, &cameras[1], &[3])]).unwrap_err(),
        5
    );
    // One cup, which may be any of the three.
    assert_eq!(
        BopWorld::of(&[first, image(6, &cameras[1], &[1])]).unwrap_err(),
        6
    );
    // One box, of which there is but one.
    let boxed = [image(0, &cameras[0], &[3, 0]), image(1, &cameras[1], &[3])];
    assert!(BopWorld::of(&boxed).is_ok());
}
