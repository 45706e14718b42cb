use super::*;
use crate::ViewOrigin;
use nalgebra::{Point3, UnitQuaternion, UnitVector3, Vector3};
use random::Random;
use sensor_noise::DepthNoise;

/// Noise of the points, metres.
const NOISE_M: f64 = 0.0005;

/// Points on a surface that a camera in a direction sees: those whose normals point to it.
fn seen(
    surface: impl Fn(&mut Random) -> (Vector3<f64>, Vector3<f64>),
    towards: Vector3<f64>,
    seed: u64,
) -> Vec<Vector3<f64>> {
    let mut random = Random::from_seed(seed);
    let mut points = Vec::new();
    while points.len() < 6000 {
        let (place, normal) = surface(&mut random);
        if normal.dot(&towards) > 0.1 {
            points.push(place + NOISE_M * random.normal() * normal);
        }
    }
    points
}

/// Surface of a box with sides of 12, 8 and 5 cm.
fn box_surface(random: &mut Random) -> (Vector3<f64>, Vector3<f64>) {
    let half = Vector3::new(0.06, 0.04, 0.025);
    let mut place = half.map(|half| half * random.between(-1.0, 1.0));
    let axis = random.below(3);
    let side = if random.unit() < 0.5 { -1.0 } else { 1.0 };
    place[axis] = side * half[axis];
    let mut normal = Vector3::zeros();
    normal[axis] = side;
    (place, normal)
}

/// Surface of a can without its lids: radius 3.3 cm, height 11 cm.
fn can_surface(random: &mut Random) -> (Vector3<f64>, Vector3<f64>) {
    let angle = random.between(0.0, std::f64::consts::TAU);
    let normal = Vector3::new(angle.cos(), angle.sin(), 0.0);
    let height = Vector3::z() * random.between(-0.055, 0.055);
    (0.033 * normal + height, normal)
}

fn ball_surface(random: &mut Random) -> (Vector3<f64>, Vector3<f64>) {
    let normal = Vector3::from_fn(|_, _| random.normal()).normalize();
    (0.04 * normal, normal)
}

fn surface(points: &[Vector3<f64>], pose: &Isometry3<f64>) -> ViewSurface {
    let moved: Vec<[f32; 3]> = points
        .iter()
        .map(|point| (pose * Point3::from(*point)).cast::<f32>().into())
        .collect();
    ViewSurface::new(&moved, None).unwrap()
}

fn motion(rotation_deg: Vector3<f64>, shift_mm: Vector3<f64>) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_scaled_axis(rotation_deg.map(f64::to_radians));
    Isometry3::from_parts(Translation3::from(1e-3 * shift_mm), rotation)
}

/// Rotation error in degrees, and that of the place of the origin in millimetres.
fn errors(found: &Registration, moved: &Isometry3<f64>) -> (f64, f64) {
    let off = found.target_from_source * moved;
    (
        off.rotation.angle().to_degrees(),
        1e3 * off.translation.vector.norm(),
    )
}

fn direction(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z).normalize()
}

#[test]
fn views_of_a_box_are_registered_from_far_off() {
    let target = seen(box_surface, direction(1.0, 1.0, 1.0), 1);
    let source = seen(box_surface, direction(1.0, 0.5, 1.2), 2);
    let target = surface(&target, &Isometry3::identity());
    let mut random = Random::from_seed(3);
    for _ in 0..10 {
        let draw =
            |random: &mut Random, most: f64| Vector3::from_fn(|_, _| random.between(-most, most));
        let moved = motion(draw(&mut random, 10.0), draw(&mut random, 25.0));
        let prior = Prior::at(Isometry3::identity());
        let found = register(&target, &surface(&source, &moved), &prior).unwrap();
        let (rotation_deg, shift_mm) = errors(&found, &moved);
        assert!(
            rotation_deg < 0.6 && shift_mm < 1.0,
            "{rotation_deg} {shift_mm}"
        );
        assert!(
            found.common_share > 0.9 && found.residual_m < 0.001,
            "{found:?}"
        );
        assert!(found.contradiction < 0.4, "{found:?}");
    }
}

#[test]
fn turn_of_a_can_about_its_axis_stays_as_in_the_prior() {
    let target = seen(can_surface, direction(1.0, 0.0, 0.3), 4);
    // Another side: the parts that both show would coincide best after a turn of 40°.
    let source = seen(
        can_surface,
        direction(40_f64.to_radians().cos(), 40_f64.to_radians().sin(), 0.3),
        5,
    );
    let target = surface(&target, &Isometry3::identity());
    let moved = motion(Vector3::new(4.0, -3.0, 0.0), Vector3::new(8.0, 5.0, -4.0));
    let source = surface(&source, &moved);
    let prior = Prior {
        target_from_source: moved.inverse(),
        translation_sigma_m: 0.01,
        rotation_sigma_rad: 5.0_f64.to_radians(),
    };
    let found = register(&target, &source, &prior).unwrap();
    assert!(found.is_rotation_weak, "{found:?}");
    let (rotation_deg, shift_mm) = errors(&found, &moved);
    assert!(
        rotation_deg < 1.0 && shift_mm < 2.0,
        "{rotation_deg} {shift_mm}"
    );
}

#[test]
fn ball_is_placed_and_its_rotation_stays_near_the_prior() {
    let target = surface(
        &seen(ball_surface, direction(1.0, 0.0, 0.5), 6),
        &Isometry3::identity(),
    );
    let moved = motion(Vector3::zeros(), Vector3::new(6.0, -4.0, 5.0));
    let source = surface(&seen(ball_surface, direction(0.9, 0.4, 0.5), 7), &moved);
    let prior = Prior {
        rotation_sigma_rad: 3.0_f64.to_radians(),
        ..Prior::at(Isometry3::identity())
    };
    let found = register(&target, &source, &prior).unwrap();
    let (rotation_deg, shift_mm) = errors(&found, &moved);
    // Three standard deviations of the prior.
    assert!(
        rotation_deg < 9.0 && shift_mm < 1.0,
        "{rotation_deg} {shift_mm}"
    );
}

#[test]
fn known_viewpoints_give_the_same_result_as_estimated_ones() {
    let towards = direction(1.0, 1.0, 1.0);
    let points: Vec<[f32; 3]> = seen(box_surface, towards, 8)
        .iter()
        .map(|point| point.cast::<f32>().into())
        .collect();
    let viewpoints = [
        None,
        Some(ViewOrigin::Direction(UnitVector3::new_unchecked(towards))),
        Some(ViewOrigin::Camera(Point3::from(0.8 * towards))),
    ];
    for viewpoint in viewpoints {
        let surfaces = [(); 2].map(|()| ViewSurface::new(&points, viewpoint).unwrap());
        let [target, source] = &surfaces;
        let found = register(target, source, &Prior::at(Isometry3::identity())).unwrap();
        assert!(found.contradiction < 0.05, "{viewpoint:?}: {found:?}");
        assert!(found.target_from_source.rotation.angle() < 1e-3);
    }
}

#[test]
fn unusable_views_are_refused() {
    let far = motion(Vector3::zeros(), Vector3::new(900.0, 0.0, 0.0));
    let points = seen(box_surface, direction(1.0, 1.0, 1.0), 9);
    let (target, source) = (
        surface(&points, &Isometry3::identity()),
        surface(&points, &far),
    );
    let apart = register(&target, &source, &Prior::at(Isometry3::identity())).unwrap_err();
    assert_eq!(apart, Error::NoOverlap { reach_mm: 50 });
    assert!(apart.to_string().contains("within 50 mm"));
    let few = ViewSurface::new(&[[0.0; 3]; 40], None).unwrap_err();
    assert!(
        matches!(few, Error::TooFewSurfels { n_points: 40, .. }),
        "{few}"
    );
    assert!(ViewSurface::new(&[], None).is_err());
    let broken = ViewSurface::new(&[[0.0, f32::NAN, 0.0]], None).unwrap_err();
    assert_eq!(broken, Error::NotFinite(0));
}

#[test]
fn depth_noise_of_a_far_camera_is_no_contradiction() {
    let camera = Point3::from(2.0 * direction(1.0, 1.0, 1.0));
    let noisy = |seed: u64, law: Option<DepthNoise>| {
        let mut random = Random::from_seed(seed);
        let noise_m = DepthNoise::KINECT_V1.bounded_sigma_m(2.0);
        let points: Vec<[f32; 3]> = seen(box_surface, direction(1.0, 1.0, 1.0), seed)
            .iter()
            .map(|point| {
                let ray = (point - camera.coords).normalize();
                (point + noise_m * random.normal() * ray)
                    .cast::<f32>()
                    .into()
            })
            .collect();
        let surface = ViewSurface::new(&points, Some(ViewOrigin::Camera(camera))).unwrap();
        match law {
            Some(law) => surface.with_depth_noise(law),
            None => surface,
        }
    };
    let contradiction = |law: Option<DepthNoise>| {
        let prior = Prior::at(Isometry3::identity());
        let found = register(&noisy(11, law), &noisy(12, law), &prior);
        found.unwrap().contradiction
    };
    let (known, unknown) = (
        contradiction(Some(DepthNoise::KINECT_V1)),
        contradiction(None),
    );
    assert!(known < 0.7 * unknown, "{known} {unknown}");
}
