use super::*;
use point_cloud::{Point, Rgba};
use proptest::prelude::*;

/// A lopsided surface, visible from the origin: longer along one axis, thicker at
/// one end, about a metre away.
fn lopsided(n_points: u16) -> Vec<Point3<f64>> {
    (0..n_points)
        .map(|i| {
            let t = f64::from(i);
            let (u, v) = ((t * 0.618_034).fract(), (t * 0.754_878).fract());
            let x = 0.2 * u * u;
            Point3::new(
                x - 0.07,
                0.05 * (v - 0.5) * (1.0 - 3.0 * x),
                0.9 + 0.04 * v * v,
            )
        })
        .collect()
}

fn cloud(points: &[Point3<f64>]) -> Vec<Point> {
    points
        .iter()
        .map(|p| Point {
            x: p.x as f32,
            y: p.y as f32,
            z: p.z as f32,
            color: Rgba(0),
        })
        .collect()
}

fn frame(points: &[Point3<f64>], viewpoint: &Point3<f64>) -> ObjectFrame {
    object_frame(ObjectPoints::all(&cloud(points)), viewpoint).unwrap()
}

fn motion() -> impl Strategy<Value = RigidTransform> {
    let three = |r: f64| prop::array::uniform3(-r..r).prop_map(Vector3::from);
    (three(2.0), three(3.0)).prop_map(|(shift, turn)| RigidTransform::new(shift, turn))
}

fn is_same(a: &RigidTransform, b: &RigidTransform) -> bool {
    let difference = a.inv_mul(b);
    difference.rotation.angle() < 1e-3 && difference.translation.vector.norm() < 1e-5
}

proptest! {
    #[test]
    fn the_frame_follows_points_and_viewer(motion in motion()) {
        let points = lopsided(500);
        let viewpoint = Point3::new(0.0, 0.0, -0.2);
        let moved: Vec<_> = points.iter().map(|p| motion * p).collect();
        let still = frame(&points, &viewpoint).source_from_object;
        let followed = frame(&moved, &(motion * viewpoint)).source_from_object;
        prop_assert!(is_same(&(motion * still), &followed));
    }

    #[test]
    fn the_order_of_points_has_no_say(shuffled in Just(lopsided(200)).prop_shuffle()) {
        let viewpoint = Point3::origin();
        let expected = frame(&lopsided(200), &viewpoint).source_from_object;
        prop_assert!(is_same(&expected, &frame(&shuffled, &viewpoint).source_from_object));
    }

    #[test]
    fn hostile_points_do_no_harm(
        cloud in prop::collection::vec(prop::array::uniform3(any::<f32>()), 0..20),
        viewpoint in prop::array::uniform3(any::<f64>()),
    ) {
        let cloud: Vec<_> =
            cloud.iter().map(|&[x, y, z]| Point { x, y, z, color: Rgba(0) }).collect();
        let frame = object_frame(ObjectPoints::all(&cloud), &Point3::from(viewpoint));
        if let Some(frame) = frame {
            let rotation = frame.source_from_object.rotation.to_rotation_matrix();
            prop_assert!((rotation.matrix().determinant() - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn z_faces_the_viewer_and_x_the_long_tail() {
    let points = lopsided(500);
    for side in [-1.0, 1.0] {
        let viewpoint = Point3::new(0.0, 0.0, 0.9 + side);
        let frame = frame(&points, &viewpoint);
        let rotation = frame.source_from_object.rotation.to_rotation_matrix();
        let centroid = Point3::from(frame.source_from_object.translation.vector);
        assert!(rotation.matrix().column(2).dot(&(viewpoint - centroid)) > 0.5);
        // The points crowd at small x, so the tail is at large x.
        assert!(rotation[(0, 0)] > 0.9);
        assert!(frame.variances_m2[0] > frame.variances_m2[1]);
        assert!(frame.variances_m2[1] > frame.variances_m2[2]);
    }
}

/// A grid that looks the same from both sides of each axis, in the plane z = 1.
fn symmetric_plate(bend: impl Fn(f64, f64) -> f64) -> Vec<Point3<f64>> {
    let steps = || (-10..=10).map(|i| f64::from(i) / 10.0);
    steps()
        .flat_map(|u| steps().map(move |v| (u, v)))
        .map(|(u, v)| Point3::new(0.1 * u, 0.05 * v, 1.0 + bend(u, v)))
        .collect()
}

#[test]
fn a_symmetric_object_turns_its_long_axis_to_the_viewer() {
    let plate = symmetric_plate(|_, _| 0.0);
    for side in [-1.0, 1.0] {
        let x_axis = frame(&plate, &Point3::new(side, 0.0, 0.0)).source_from_object * Vector3::x();
        assert!(side * x_axis.x > 0.99);
        let from_y = frame(&plate, &Point3::new(0.0, side, 0.0)).source_from_object;
        assert!(side * (from_y * Vector3::y()).y > 0.99);
    }
}

#[test]
fn without_any_cue_the_source_frame_decides() {
    let seen_from_above = frame(&symmetric_plate(|_, _| 0.0), &Point3::origin());
    let x_axis = seen_from_above.source_from_object * Vector3::x();
    let z_axis = seen_from_above.source_from_object * Vector3::z();
    assert!(x_axis.x > 0.99 && z_axis.z < -0.99);
}

#[test]
fn seen_along_the_edge_the_longer_tail_decides_z() {
    for side in [-1.0, 1.0] {
        let plate = symmetric_plate(|u, v| side * 0.02 * (u * v).powi(4));
        let centroid_height = plate.iter().map(|p| p.z).sum::<f64>() / plate.len() as f64;
        for tilt in [-1e-3, 1e-3] {
            let frame = frame(&plate, &Point3::new(1.0, 0.0, centroid_height + tilt));
            assert!(side * (frame.source_from_object * Vector3::z()).z > 0.9);
        }
    }
}

#[test]
fn too_few_points_have_no_frame() {
    let hole = Point::without_depth(Rgba(0));
    let point = Point {
        x: 1.0,
        ..Point::default()
    };
    for cloud in [&[][..], &[point, point], &[point, hole, point, hole]] {
        assert_eq!(
            object_frame(ObjectPoints::all(cloud), &Point3::origin()),
            None
        );
    }
}
