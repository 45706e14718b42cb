use super::*;
use nalgebra::{UnitQuaternion, UnitVector3};
use random::Random;
use sensor_noise::DepthNoise;

/// Noise of the depth, metres.
const NOISE_M: f64 = 0.001;

/// Spacing of the points of a model, metres.
const SPACING_M: f64 = 0.003;

/// Surface point with its outward normal.
type SurfacePoint = (Vector3<f64>, Vector3<f64>);

/// Lattice points of a box with a corner in the origin of the axes it is at.
fn box_points(centre: Vector3<f64>, half: Vector3<f64>) -> Vec<SurfacePoint> {
    let mut points = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let steps = |i: usize| (2.0 * half[i] / SPACING_M).round().max(1.0) as usize;
        for side in [-1.0, 1.0] {
            for (i, j) in (0..=steps(u)).flat_map(|i| (0..=steps(v)).map(move |j| (i, j))) {
                let along = |i: usize, n: usize| 2.0 * i as f64 / n as f64 - 1.0;
                let mut place = Vector3::zeros();
                place[axis] = side * half[axis];
                place[u] = along(i, steps(u)) * half[u];
                place[v] = along(j, steps(v)) * half[v];
                let mut normal = Vector3::zeros();
                normal[axis] = side;
                points.push((centre + place, normal));
            }
        }
    }
    points
}

/// An L of two boxes: no turn brings it onto itself but a half turn about one axis.
fn bracket() -> Vec<SurfacePoint> {
    let mut points = box_points(Vector3::zeros(), Vector3::new(0.06, 0.02, 0.015));
    let arm = box_points(
        Vector3::new(0.045, 0.05, 0.0),
        Vector3::new(0.015, 0.03, 0.015),
    );
    points.extend(arm);
    points
}

fn model(surface: &[SurfacePoint]) -> PoseModel {
    let points: Vec<[f32; 3]> = surface
        .iter()
        .map(|(p, _)| p.cast::<f32>().into())
        .collect();
    PoseModel::new(&points, SPACING_M).unwrap()
}

/// Points of a surface in a pose that a camera in the origin sees, each four times with noise
/// along the line of sight; hidden parts of the surface itself are removed by a depth buffer.
fn seen(surface: &[SurfacePoint], pose: &Isometry3<f64>, random: &mut Random) -> Vec<[f32; 3]> {
    let pixel = |p: &Vector3<f64>| [p.x / p.z, p.y / p.z].map(|c| (c * 220.0).floor() as i32);
    let mut nearest = std::collections::HashMap::new();
    let facing = surface.iter().filter_map(|(place, normal)| {
        let place = (pose * Point3::from(*place)).coords;
        ((pose.rotation * normal).dot(&place) < -0.1 * place.norm()).then_some(place)
    });
    let facing: Vec<Vector3<f64>> = facing.collect();
    for place in &facing {
        let depth = nearest.entry(pixel(place)).or_insert(f64::INFINITY);
        *depth = place.z.min(*depth);
    }
    let visible = facing.iter().filter(|p| p.z < nearest[&pixel(p)] + 0.012);
    let mut points = Vec::new();
    for place in visible {
        for _ in 0..4 {
            let blur = Vector3::from_fn(|_, _| 0.001 * random.normal());
            let along = NOISE_M * random.normal() * place.normalize();
            points.push((place + 0.3 * blur + along).cast::<f32>().into());
        }
    }
    points
}

fn random_pose(random: &mut Random) -> Isometry3<f64> {
    let axis = UnitVector3::new_normalize(Vector3::from_fn(|_, _| random.normal()));
    let turn = UnitQuaternion::from_axis_angle(&axis, random.between(0.0, 3.1));
    let place = Vector3::new(random.between(-0.2, 0.2), random.between(-0.2, 0.2), 0.9);
    Isometry3::from_parts(place.into(), turn)
}

/// Mean distance of the model's points in the estimated pose from the nearest in the true one.
fn nearest_point_error_m(
    surface: &[SurfacePoint],
    found: &Isometry3<f64>,
    truth: &Isometry3<f64>,
) -> f64 {
    let places = |pose: &Isometry3<f64>| -> Vec<Point3<f64>> {
        surface
            .iter()
            .step_by(5)
            .map(|(p, _)| pose * Point3::from(*p))
            .collect()
    };
    let truth = places(truth);
    let nearest = |p: &Point3<f64>| truth.iter().map(|q| (p - q).norm()).fold(1.0, f64::min);
    let found = places(found);
    found.iter().map(nearest).sum::<f64>() / found.len() as f64
}

#[test]
fn pose_is_found_in_any_orientation() {
    let surface = bracket();
    let model = model(&surface);
    assert!(
        (0.14..0.17).contains(&model.diameter_m()),
        "{}",
        model.diameter_m()
    );
    let mut random = Random::from_seed(11);
    let mut n_right = 0;
    for _ in 0..20 {
        let truth = random_pose(&mut random);
        let segment = seen(&surface, &truth, &mut random);
        let view = SegmentView::new(&segment, &segment, DepthNoise::KINECT_V1).unwrap();
        let found = estimate_pose(&model, &view).unwrap();
        let error_m = nearest_point_error_m(&surface, &found.camera_from_model, &truth);
        n_right += usize::from(error_m < 0.004 && found.is_good());
    }
    assert!(n_right >= 18, "{n_right} of 20");
}

#[test]
fn what_the_camera_saw_through_tells_a_short_bar_from_a_long_one() {
    let [short, long] =
        [0.05, 0.11].map(|half| box_points(Vector3::zeros(), Vector3::new(half, 0.02, 0.02)));
    let mut random = Random::from_seed(12);
    let turn = UnitQuaternion::from_euler_angles(0.7, 0.4, 0.2);
    let truth = Isometry3::from_parts(Vector3::new(0.0, 0.0, 0.9).into(), turn);
    let segment = seen(&short, &truth, &mut random);
    // A wall behind the bar: there is nothing in front of it but the bar.
    let step = |i: u16| 0.003 * f32::from(i) - 0.3;
    let wall = (0..200).flat_map(|i| (0..200).map(move |j| [step(i), step(j), 1.1]));
    let scene: Vec<[f32; 3]> = segment.iter().copied().chain(wall).collect();
    let view = SegmentView::new(&segment, &scene, DepthNoise::KINECT_V1).unwrap();
    let [short, long] = [&short, &long].map(|bar| estimate_pose(&model(bar), &view).unwrap());
    assert!(short.is_good(), "{short:?}");
    assert!(
        long.contradiction > short.contradiction + 0.2,
        "{long:?} against {short:?}"
    );
}

#[test]
fn unusable_models_and_segments_are_refused() {
    let points: Vec<[f32; 3]> = bracket()
        .iter()
        .map(|(p, _)| p.cast::<f32>().into())
        .collect();
    let refused = PoseModel::new(&[[0.0, f32::NAN, 0.0]], SPACING_M).unwrap_err();
    assert_eq!(refused, Error::NotFinite(0));
    let in_wrong_units = PoseModel::new(&[[6000.0, 0.0, 0.0]], SPACING_M).unwrap_err();
    assert_eq!(in_wrong_units, Error::TooFar(0));
    assert!(matches!(
        PoseModel::new(&[], SPACING_M),
        Err(Error::TooFewSurfels { .. })
    ));
    assert!(SegmentView::new(&points[..5], &points, DepthNoise::KINECT_V1).is_err());
    assert!(SegmentView::new(&points, &[[f32::INFINITY; 3]], DepthNoise::KINECT_V1).is_err());
    // A scene without points says nothing against any pose.
    let in_front: Vec<[f32; 3]> = points.iter().map(|[x, y, z]| [*x, *y, z + 0.9]).collect();
    let blind = SegmentView::new(&in_front, &[], DepthNoise::KINECT_V1).unwrap();
    assert!(estimate_pose(&model(&bracket()), &blind).is_ok());
}
