//! Models of objects of known shape, from noisy views on an orbit.

#[path = "../src/test_object.rs"]
mod test_object;

use mesh::{TriangleMesh, Vertex};
use model_construction::{Config, Error, Misfit, ModelBuilder, PoseSigma};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use point_cloud::Point;
use random::Random;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use test_object::{TestObject, disturbed, view, world_from_camera};

const SIGMA: PoseSigma = PoseSigma {
    rotation_rad: 0.05,
    translation_m: 0.01,
};

/// Model of an object from an orbit of 24 views, with the true poses.
fn built(object: TestObject, seed: u64) -> (ModelBuilder, Vec<Isometry3<f64>>) {
    let mut random = Random::from_seed(seed);
    let mut builder = ModelBuilder::new(Config::default());
    let mut truth = Vec::new();
    for index in 0..24_u32 {
        let pose = world_from_camera(15.0 * f64::from(index), 40.0);
        let points = object.points(&pose, seed + u64::from(index));
        let reported = disturbed(&pose, &SIGMA, &mut random);
        let added = builder.add(&view(&points, reported, SIGMA, index.into()));
        assert!(added.is_ok(), "view {index}: {added:?}");
        truth.push(pose);
    }
    builder.finish();
    (builder, truth)
}

#[test]
fn a_stopped_agreement_leaves_the_views_where_they_are() {
    let stop = Arc::new(AtomicBool::new(false));
    let mut builder = ModelBuilder::new(Config::default()).stopped_by(stop.clone());
    let mut random = Random::from_seed(3);
    for index in 0..4_u32 {
        let pose = world_from_camera(15.0 * f64::from(index), 40.0);
        let points = TestObject::BoxWithBall.points(&pose, index.into());
        let reported = disturbed(&pose, &SIGMA, &mut random);
        builder
            .add(&view(&points, reported, SIGMA, index.into()))
            .unwrap();
    }
    let poses = |builder: &ModelBuilder| -> Vec<Isometry3<f64>> {
        let views = builder.views().iter();
        views.map(|view| view.object_from_camera).collect()
    };
    let before = poses(&builder);
    stop.store(true, Ordering::Relaxed);
    assert!(!builder.finish());
    assert_eq!(poses(&builder), before);
    stop.store(false, Ordering::Relaxed);
    assert!(builder.finish());
    assert_ne!(poses(&builder), before);
}

/// Pose of the model's frame in the world that fits the first of the views.
fn world_from_model(builder: &ModelBuilder, truth: &[Isometry3<f64>]) -> Isometry3<f64> {
    truth[0] * builder.views()[0].object_from_camera.inverse()
}

/// Distances of the vertices from the surface of the object, metres, ascending.
fn sorted_distances_m(
    object: TestObject,
    mesh: &TriangleMesh,
    world_from_model: &Isometry3<f64>,
) -> Vec<f64> {
    let place = |vertex: &Vertex| world_from_model * vertex.position.cast::<f64>();
    let distances = mesh
        .vertices
        .iter()
        .map(|vertex| object.distance_m(&place(vertex)).abs());
    let mut distances: Vec<f64> = distances.collect();
    distances.sort_unstable_by(f64::total_cmp);
    distances
}

#[test]
fn the_mesh_of_a_noisy_orbit_is_the_surface_of_the_object() {
    let object = TestObject::BoxWithBall;
    let (builder, truth) = built(object, 1);
    assert!(builder.is_closed());
    let mesh = builder.mesh();
    let pose = world_from_model(&builder, &truth);
    let distances = sorted_distances_m(object, &mesh, &pose);
    assert!(mesh.vertices.len() > 5000);
    assert!(
        distances[distances.len() / 2] < 0.0007,
        "{}",
        distances[distances.len() / 2]
    );
    assert!(distances[distances.len() * 95 / 100] < 0.002);
    // Normals and triangles point outwards.
    let outwards = |place: &Point3<f64>, normal: &Vector3<f64>| {
        object.distance_m(&(place + normal * 0.005)) > object.distance_m(place)
    };
    let n_outwards = mesh
        .vertices
        .iter()
        .filter(|vertex| {
            outwards(
                &(pose * vertex.position.cast::<f64>()),
                &(pose * vertex.normal.cast::<f64>()),
            )
        })
        .count();
    let share = n_outwards as f64 / mesh.vertices.len() as f64;
    assert!(share > 0.99, "{share}");
}

#[test]
fn registration_removes_most_of_the_errors_of_the_poses() {
    let (builder, truth) = built(TestObject::BoxWithBall, 2);
    let pose = world_from_model(&builder, &truth);
    let object_from_world = Isometry3::identity();
    let mut errors = [Vec::new(), Vec::new()];
    for (view, truth) in builder.views().iter().zip(&truth) {
        let error = |found: &Isometry3<f64>| {
            let off = object_from_world * found * truth.inverse();
            let corner = Point3::new(0.05, 0.05, 0.05);
            (off * corner - corner).norm()
        };
        let reported = builder.views()[0].reported.inverse() * view.reported;
        errors[0].push(error(&(truth_of_first(&builder, pose) * reported)));
        errors[1].push(error(&(pose * view.object_from_camera)));
    }
    let [before, after] = errors.map(|mut values| {
        values.sort_unstable_by(f64::total_cmp);
        values[values.len() / 2]
    });
    assert!(before > 0.03, "before {before}");
    assert!(after < 0.003, "after {after}");
}

/// True pose of the first camera.
fn truth_of_first(builder: &ModelBuilder, world_from_model: Isometry3<f64>) -> Isometry3<f64> {
    world_from_model * builder.views()[0].object_from_camera
}

#[test]
fn the_colors_keep_a_ball_from_turning() {
    let (builder, truth) = built(TestObject::Ball, 3);
    let pose = world_from_model(&builder, &truth);
    for (view, truth) in builder.views().iter().zip(&truth) {
        let turn = (pose * view.object_from_camera)
            .rotation
            .angle_to(&truth.rotation);
        assert!(turn < 0.03, "{} degrees", turn.to_degrees());
    }
}

#[test]
fn a_hand_held_camera_without_poses_makes_a_model() {
    let object = TestObject::BoxWithBall;
    let mut builder = ModelBuilder::new(Config {
        step_min_rad: 0.1,
        ..Config::default()
    });
    for index in 0..90_u32 {
        let pose = world_from_camera(4.0 * f64::from(index), 40.0);
        let points = object.points(&pose, u64::from(index));
        let mut view = view(&points, None, SIGMA, index.into());
        view.captured_ns /= 5;
        assert!(builder.add(&view).is_ok(), "view {index}");
    }
    // Views that show nothing new were only followed.
    assert!(
        (40..=60).contains(&builder.views().len()),
        "{}",
        builder.views().len()
    );
    // The first camera counts as level, so that the top of the model is on top.
    let first = &builder.views()[0];
    let down = first.object_from_camera.rotation * Vector3::y();
    assert!(down.dot(&-Vector3::z()) > 0.999, "{down}");
    assert!(first.direction().dot(&-Vector3::x()) > 0.99);
    builder.finish();
    let pose = world_from_camera(0.0, 40.0) * builder.views()[0].object_from_camera.inverse();
    let distances = sorted_distances_m(object, &builder.mesh(), &pose);
    assert!(
        distances[distances.len() / 2] < 0.001,
        "{}",
        distances[distances.len() / 2]
    );
}

/// Model of an object that is turned by 30° between the views of a camera that stands still.
fn turned(object: TestObject, is_pose_known: bool) -> ModelBuilder {
    let mut builder = ModelBuilder::new(Config::default());
    let camera = world_from_camera(0.0, 40.0);
    for index in 0..12_u32 {
        // The object turns, and is put down a little beside the place where it was.
        let pose = world_from_camera(30.0 * f64::from(index), 40.0);
        let points = object.points(&pose, 50 + u64::from(index));
        let shift = Isometry3::translation(0.01 * f64::from(index % 3), 0.0, 0.0);
        let mut view = view(
            &points,
            is_pose_known.then_some(shift * camera),
            SIGMA,
            index.into(),
        );
        view.up_in_camera = Some(camera.inverse() * Vector3::z_axis());
        view.placement = index;
        let added = builder.add(&view);
        assert!(added.is_ok(), "view {index}: {added:?}");
    }
    assert!(builder.is_closed());
    builder.finish();
    builder
}

#[test]
fn object_that_is_turned_before_a_fixed_camera_makes_a_model() {
    for is_pose_known in [true, false] {
        let object = TestObject::BoxWithBall;
        let builder = turned(object, is_pose_known);
        let pose = world_from_camera(0.0, 40.0) * builder.views()[0].object_from_camera.inverse();
        let distances = sorted_distances_m(object, &builder.mesh(), &pose);
        let [median, most] = [2, 1].map(|part| distances[(distances.len() - 1) / part]);
        assert!(median < 0.001 && most < 0.01, "{median} {most}");
    }
    // The shape of a ball does not tell its turn; its colours do.
    let builder = turned(TestObject::Ball, true);
    let pose = world_from_camera(0.0, 40.0) * builder.views()[0].object_from_camera.inverse();
    for (index, view) in (0_u32..).zip(builder.views()) {
        let truth = world_from_camera(30.0 * f64::from(index), 40.0);
        let off = (pose * view.object_from_camera)
            .rotation
            .angle_to(&truth.rotation);
        assert!(off < 0.05, "view {index}: {} degrees", off.to_degrees());
    }
}

#[test]
fn one_view_makes_a_model_of_its_side() {
    let pose = world_from_camera(0.0, 40.0);
    let points = TestObject::BoxWithBall.points(&pose, 4);
    let mut builder = ModelBuilder::new(Config::default());
    assert_eq!(builder.add(&view(&points, pose, SIGMA, 0)), Ok(None));
    builder.finish();
    assert!(builder.mesh().triangles.len() > 1000);
    assert!(!builder.surface_points().is_empty());
    assert!(!builder.is_closed());
}

#[test]
fn a_view_that_does_not_fit_is_refused_and_changes_nothing() {
    let pose = world_from_camera(0.0, 40.0);
    let points = TestObject::BoxWithBall.points(&pose, 5);
    let mut builder = ModelBuilder::new(Config::default());
    builder.add(&view(&points, pose, SIGMA, 0)).unwrap();
    let mesh = builder.mesh();
    let other = TestObject::Ball.points(&pose, 6);
    let refused = builder.add(&view(&other, pose, SIGMA, 1)).unwrap_err();
    assert!(matches!(refused, Error::Misfit(_)), "{refused}");
    // The same view again, with a pose that is said to be sure and is far off.
    let turned = Isometry3::from_parts(
        Translation3::identity(),
        UnitQuaternion::from_scaled_axis(Vector3::z() * 0.35),
    );
    let sure = PoseSigma {
        rotation_rad: 0.005,
        translation_m: 0.002,
    };
    let points = TestObject::BoxWithBall.points(&pose, 7);
    let refused = builder
        .add(&view(&points, turned * pose, sure, 2))
        .unwrap_err();
    assert!(
        matches!(refused, Error::Misfit(_) | Error::Surface(_)),
        "{refused}"
    );
    assert_eq!(builder.views().len(), 1);
    assert_eq!(builder.mesh(), mesh);
}

#[test]
fn degenerate_views_get_a_sentence() {
    let pose = world_from_camera(0.0, 40.0);
    let mut builder = ModelBuilder::new(Config::default());
    let refused = |builder: &mut ModelBuilder, points: &[Point], pose: Isometry3<f64>| {
        builder
            .add(&view(points, pose, SIGMA, 0))
            .unwrap_err()
            .to_string()
    };
    assert!(refused(&mut builder, &[], pose).contains("none of the 0 points"));
    let behind = Point {
        z: -1.0,
        ..Point::default()
    };
    assert!(refused(&mut builder, &[behind; 50], pose).contains("none of the 50 points"));
    let near = Point {
        z: 0.8,
        ..Point::default()
    };
    assert!(refused(&mut builder, &[near; 50], pose).contains("too few"));
    let points = TestObject::Ball.points(&pose, 8);
    let broken = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert!(refused(&mut builder, &points, broken).contains("camera pose"));
    assert!(builder.mesh().triangles.is_empty());
    builder.finish();
    // The other side of the object has nothing in common with the first view.
    builder.add(&view(&points, pose, SIGMA, 0)).unwrap();
    let far = Isometry3::translation(1.0, 0.0, 0.0) * pose;
    let points = TestObject::Ball.points(&pose, 9);
    let error = builder.add(&view(&points, far, SIGMA, 1)).unwrap_err();
    assert!(!matches!(
        error,
        Error::Misfit(Misfit::LittleOverlap {
            common_percent: 100
        })
    ));
}
