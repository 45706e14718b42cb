use super::*;
use geometry::RigidTransform;
use nalgebra::{Matrix3, Point3, Unit, Vector3};
use point_cloud::{Point, Rgba};
use proptest::prelude::*;

/// Bent asymmetric sheet with three different sides, a metre away.
fn sheet(n_points: u16) -> Vec<Point> {
    (0..n_points)
        .map(|i| {
            let t = f64::from(i);
            let (u, v) = ((t * 0.618_034).fract(), (t * 0.754_878).fract());
            let at = Point3::new(
                0.2 * u * u,
                0.1 * (v - 0.5) * (1.2 - u),
                0.9 + 0.05 * (u - 0.3) * (u - 0.3) + 0.02 * v * v,
            );
            point(&at, Rgba::opaque(200, (200.0 * u) as u8, 40))
        })
        .collect()
}

fn point(at: &Point3<f64>, color: Rgba) -> Point {
    Point {
        x: at.x as f32,
        y: at.y as f32,
        z: at.z as f32,
        color,
    }
}

fn mapped(cloud: &[Point], map: impl Fn(Point3<f64>) -> Point3<f64>) -> Vec<Point> {
    cloud
        .iter()
        .map(|p| point(&map(p.position()), p.color))
        .collect()
}

fn described(cloud: &[Point], up: Option<&UnitVector3<f64>>) -> [Vec<f32>; N_AXIS_HYPOTHESES] {
    let mut appearance = AppearanceDescriptor::new(AppearanceWeights::default()).unwrap();
    let points = ObjectPoints::all(cloud);
    appearance.describe(points, up).unwrap().clone()
}

/// Distance of an object to a stored view: the least over the axis hypotheses.
fn distance(hypotheses: &[Vec<f32>; N_AXIS_HYPOTHESES], stored: &[f32]) -> f32 {
    let to = |hypothesis: &Vec<f32>| {
        let squares = hypothesis
            .iter()
            .zip(stored)
            .map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f32>().sqrt()
    };
    hypotheses.iter().map(to).fold(f32::INFINITY, f32::min)
}

fn motion() -> impl Strategy<Value = RigidTransform> {
    let three = |r: f64| prop::array::uniform3(-r..r).prop_map(Vector3::from);
    (three(1.0), three(3.0)).prop_map(|(shift, turn)| RigidTransform::new(shift, turn))
}

proptest! {
    #[test]
    fn appearance_is_invariant_to_rigid_motion(motion in motion()) {
        let cloud = sheet(2000);
        let still = described(&cloud, None);
        let moved = described(&mapped(&cloud, |p| motion * p), None);
        prop_assert!(distance(&moved, &still[0]) < 0.02, "{}", distance(&moved, &still[0]));
    }

    #[test]
    fn upright_appearance_is_invariant_to_rigid_motion_with_up(motion in motion(), yaw_rad in -3.1_f64..3.1) {
        let cloud = sheet(2000);
        let up = Unit::new_normalize(Vector3::new(0.1, -0.9, -0.4));
        let still = described(&cloud, Some(&up));
        let turn = RigidTransform::new(Vector3::zeros(), up.into_inner() * yaw_rad);
        let moved = mapped(&cloud, |p| motion * turn * p);
        let moved = described(&moved, Some(&(motion.rotation * up)));
        prop_assert!(distance(&moved, &still[0]) < 0.02, "{}", distance(&moved, &still[0]));
    }

    #[test]
    fn appearance_is_independent_of_the_order_of_points(cloud in Just(sheet(500)).prop_shuffle()) {
        let sorted = described(&sheet(500), None);
        prop_assert!(distance(&described(&cloud, None), &sorted[0]) < 1e-3);
    }

    #[test]
    fn appearance_depends_little_on_density(n_points in 600_u16..6000) {
        let dense = described(&sheet(6000), None);
        let thin = described(&sheet(n_points), None);
        let narrow = mapped(&sheet(6000), |p| Point3::new(p.x, 0.7 * p.y, p.z));
        let other = distance(&described(&narrow, None), &dense[0]);
        prop_assert!(distance(&thin, &dense[0]) < 0.5 * other, "{other}");
    }

    #[test]
    fn appearance_of_arbitrary_points_is_finite(
        points in prop::collection::vec(prop::array::uniform3(any::<f32>()), 0..20),
        is_upright in any::<bool>(),
    ) {
        let cloud: Vec<_> =
            points.iter().map(|&[x, y, z]| Point { x, y, z, color: Rgba(0) }).collect();
        let mut appearance = AppearanceDescriptor::new(AppearanceWeights::default()).unwrap();
        let up = is_upright.then(Vector3::y_axis);
        if let Ok(hypotheses) = appearance.describe(ObjectPoints::all(&cloud), up.as_ref()) {
            for hypothesis in hypotheses {
                prop_assert_eq!(hypothesis.len(), AppearanceDescriptor::DIMENSION);
                prop_assert!(hypothesis.iter().all(|value| value.is_finite()));
            }
        }
    }
}

#[test]
fn each_axis_hypothesis_equals_the_descriptor_of_the_turned_frame() {
    let cloud = sheet(800);
    let points = ObjectPoints::all(&cloud);
    let quarters = [0.0, 1.0, 2.0, 3.0].map(|n| Vector3::z() * (n * std::f64::consts::FRAC_PI_2));
    let halves = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()]
        .map(|axis| axis * std::f64::consts::PI);
    let up = UnitVector3::new_unchecked(Vector3::z());
    for (up, turns) in [(None, halves), (Some(&up), quarters)] {
        let hypotheses = described(&cloud, up);
        let axes = object_axes(points, up).unwrap();
        let matrix =
            Matrix3::from_fn(|i, j| f64::from(axes.object_from_source.object_from_source[i][j]));
        let mut good = WarpedGood::new();
        let mut found = Vec::new();
        for turn in turns {
            let turned = nalgebra::Rotation3::new(turn).matrix().transpose() * matrix;
            let rows = [0, 1, 2]
                .map(|i| [0, 1, 2, 3].map(|j| if j < 3 { turned[(i, j)] as f32 } else { 0.0 }));
            let frame = crate::DescriptorFrame {
                object_from_source: rows,
            };
            let ranges = good
                .append(points, &frame, {
                    found.clear();
                    &mut found
                })
                .unwrap();
            found.extend(ranges.map(|(low, high)| (high - low + SIDE_OFFSET_M).ln()));
            let is_it = |hypothesis: &Vec<f32>| {
                let stored = value_order::storage_order().into_iter().zip(hypothesis);
                let mut without_color = stored.filter(|(place, _)| *place < COLOR_OFFSET);
                without_color.all(|(place, value)| (found[place] - value).abs() < 1e-3)
            };
            assert_eq!(
                hypotheses
                    .iter()
                    .filter(|hypothesis| is_it(hypothesis))
                    .count(),
                1,
                "{turn}"
            );
        }
    }
}

#[test]
fn axis_hypotheses_of_a_stored_view_equal_those_of_the_object() {
    let cloud = sheet(800);
    let up = Vector3::z_axis();
    for (up, kind) in [(None, AxesKind::Principal), (Some(&up), AxesKind::Upright)] {
        let hypotheses = described(&cloud, up);
        let of_stored =
            |hypothesis| AppearanceDescriptor::axis_hypothesis_of(&hypotheses[0], kind, hypothesis);
        assert_eq!(std::array::from_fn(of_stored), hypotheses);
    }
}

#[test]
fn hypotheses_differ_by_a_half_turn_in_the_signs_of_the_odd_values() {
    let cloud = sheet(800);
    let up = Vector3::z_axis();
    let is_odd = AppearanceDescriptor::half_turn_odd_values();
    assert_eq!(is_odd.len(), AppearanceDescriptor::DIMENSION);
    for up in [None, Some(&up)] {
        let [first, second, of_first, of_second] = described(&cloud, up);
        for (described, turned) in [(first, of_first), (second, of_second)] {
            let signed = described.iter().zip(is_odd);
            let expected: Vec<f32> = signed.map(|(x, odd)| if *odd { -x } else { *x }).collect();
            assert_eq!(turned, expected);
        }
    }
}

#[test]
fn appearance_distinguishes_mirror_images() {
    let cloud = sheet(2000);
    let stored = &described(&cloud, None)[0];
    let mirrored = described(&mapped(&cloud, |p| Point3::new(-p.x, p.y, p.z)), None);
    assert!(distance(&mirrored, stored) > 0.2);
}

#[test]
fn mirror_image_differs_in_the_signs_of_the_odd_values() {
    let cloud = sheet(2000);
    let up = Vector3::z_axis();
    let is_odd = AppearanceDescriptor::mirror_odd_values();
    assert_eq!(is_odd.len(), AppearanceDescriptor::DIMENSION);
    for up in [None, Some(&up)] {
        let stored = &described(&cloud, up)[0];
        let signed = stored.iter().zip(is_odd);
        let of_mirrored: Vec<f32> = signed.map(|(x, odd)| if *odd { -x } else { *x }).collect();
        let mirrored = described(&mapped(&cloud, |p| Point3::new(-p.x, p.y, p.z)), up);
        assert!(distance(&mirrored, stored) > 0.2);
        assert!(distance(&mirrored, &of_mirrored) < 1e-3);
    }
}

#[test]
fn appearance_distinguishes_size_and_colour() {
    let cloud = sheet(2000);
    let stored = &described(&cloud, None)[0];
    let middle = Point3::new(0.1, 0.0, 0.9);
    let larger = mapped(&cloud, |p| middle + 1.3 * (p - middle));
    assert!(distance(&described(&larger, None), stored) > 0.3);
    let mut blue = cloud.clone();
    for p in &mut blue {
        p.color = Rgba::opaque(30, 40, 180);
    }
    assert!(distance(&described(&blue, None), stored) > 0.5);
    let mut appearance = AppearanceDescriptor::new(AppearanceWeights::shape_only()).unwrap();
    let stored = appearance
        .describe(ObjectPoints::all(&cloud), None)
        .unwrap()[0]
        .clone();
    let blind = appearance.describe(ObjectPoints::all(&blue), None).unwrap();
    assert_eq!(distance(blind, &stored), 0.0);
}

#[test]
fn invalid_weights_and_too_few_points_are_rejected() {
    for shape in [-0.1, 101.0, f32::NAN] {
        let weights = AppearanceWeights {
            shape,
            ..AppearanceWeights::default()
        };
        let error = AppearanceDescriptor::new(weights).unwrap_err();
        assert!(
            error.to_string().contains("choose a number from 0 to 100"),
            "{error}"
        );
    }
    let mut appearance = AppearanceDescriptor::new(AppearanceWeights::default()).unwrap();
    let error = appearance
        .describe(ObjectPoints::all(&sheet(2)), None)
        .unwrap_err();
    assert!(
        error.to_string().contains("too few finite points"),
        "{error}"
    );
}
