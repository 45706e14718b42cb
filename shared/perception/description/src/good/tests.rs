use super::*;
use crate::reference_frame;
use geometry::RigidTransform;
use nalgebra::Vector3;
use point_cloud::{Point, Rgba};
use proptest::prelude::*;

/// Variant of the published program.
const PUBLISHED: GoodVariant = GoodVariant::Published {
    sign_threshold_m: 0.0015,
};

/// Variant of the authors' evaluations.
const WORKSPACE: GoodVariant = GoodVariant::Workspace {
    support: Support::Adaptive,
};

/// Variant of the authors' evaluations with a fixed support.
const WORKSPACE_FIXED: GoodVariant = GoodVariant::Workspace {
    support: Support::Fixed { side_m: 0.2 },
};

fn variant() -> impl Strategy<Value = GoodVariant> {
    prop_oneof![Just(PUBLISHED), Just(WORKSPACE), Just(WORKSPACE_FIXED)]
}

const IDENTITY: DescriptorFrame = DescriptorFrame {
    object_from_source: [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ],
};

/// Frame at about the middle of the sheet.
const CENTRED: DescriptorFrame = DescriptorFrame {
    object_from_source: [
        [1.0, 0.0, 0.0, -0.0625],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, -0.90625],
    ],
};

/// Points on a curved asymmetric sheet about a metre in front of the camera.
fn sheet(n_points: u32) -> Vec<Point> {
    (0..n_points)
        .map(|i| {
            let t = f64::from(i);
            let (u, v) = ((t * 0.618_034).fract(), (t * 0.754_878).fract());
            let (x, y) = (0.2 * u * u, 0.08 * (v - 0.5) * (1.0 - u));
            Point {
                x: x as f32,
                y: y as f32,
                z: (0.9 + 3.0 * y * y) as f32,
                color: Rgba(0),
            }
        })
        .collect()
}

fn moved(cloud: &[Point], motion: &RigidTransform) -> Vec<Point> {
    let place = |p: &Point| {
        let q = motion * p.position();
        Point {
            x: q.x as f32,
            y: q.y as f32,
            z: q.z as f32,
            ..*p
        }
    };
    cloud.iter().map(place).collect()
}

proptest! {
    #[test]
    fn each_part_is_a_distribution(
        points in prop::collection::vec(prop::array::uniform3(-0.1_f32..0.1), 1..200),
        n_bins in 2_usize..=64,
        variant in variant(),
    ) {
        let cloud: Vec<_> = points.iter().map(|&[x, y, z]| Point { x, y, z, color: Rgba(0) }).collect();
        let mut good = Good::new(n_bins, variant).unwrap();
        let mut out = vec![7.0];
        good.compute(ObjectPoints::all(&cloud), &IDENTITY, &mut out).unwrap();
        prop_assert_eq!(out.len(), good.dimension());
        for part in out.chunks(n_bins * n_bins) {
            let sum: f32 = part.iter().sum();
            // A part is empty only when no point lies within the cube.
            prop_assert!(sum == 0.0 || (sum - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn good_is_invariant_to_a_common_motion_of_points_and_frame(
        variant in variant(),
        turn in prop::array::uniform3(-3.0_f64..3.0),
        shift in prop::array::uniform3(-1.0_f64..1.0),
    ) {
        let cloud = sheet(3000);
        let motion = RigidTransform::new(Vector3::from(shift), Vector3::from(turn));
        let object_from_source = RigidTransform::translation(-0.05, 0.0, -0.9);
        let mut good = Good::new(15, variant).unwrap();
        let mut describe = |cloud: &[Point], frame: &RigidTransform| {
            let mut out = Vec::new();
            good.compute(ObjectPoints::all(cloud), &DescriptorFrame::from(frame), &mut out).unwrap();
            out
        };
        let still = describe(&cloud, &object_from_source);
        let followed = describe(&moved(&cloud, &motion), &(object_from_source * motion.inverse()));
        let difference: f32 = still.iter().zip(&followed).map(|(a, b)| (a - b).abs()).sum();
        // Disjoint descriptors differ by 6: rounding moves a few points to the next bin.
        prop_assert!(difference < 0.05, "{}", difference);
    }

    #[test]
    fn good_is_independent_of_the_order_of_points(
        variant in variant(),
        cloud in Just(sheet(300)).prop_shuffle(),
    ) {
        let mut good = Good::new(15, variant).unwrap();
        let (mut sorted, mut shuffled) = (Vec::new(), Vec::new());
        good.compute(ObjectPoints::all(&sheet(300)), &CENTRED, &mut sorted).unwrap();
        good.compute(ObjectPoints::all(&cloud), &CENTRED, &mut shuffled).unwrap();
        prop_assert_eq!(sorted, shuffled);
    }

    #[test]
    fn an_exactly_representable_shift_changes_no_bit(
        variant in variant(),
        steps in prop::array::uniform3(-400_i16..400),
    ) {
        // Coordinates in steps of 2^-20 m, shifts of 2^-10 m: no sum is rounded.
        let shift_m = steps.map(|i| f32::from(i) / 1024.0);
        let on_grid = |value: f32| (value * 1_048_576.0).round() / 1_048_576.0;
        let cloud: Vec<Point> = sheet(1000)
            .iter()
            .map(|p| Point { x: on_grid(p.x), y: on_grid(p.y), z: on_grid(p.z), ..*p })
            .collect();
        let [x, y, z] = shift_m;
        let shifted: Vec<Point> =
            cloud.iter().map(|p| Point { x: p.x + x, y: p.y + y, z: p.z + z, ..*p }).collect();
        let mut frame = CENTRED;
        for (row, shift) in frame.object_from_source.iter_mut().zip(shift_m) {
            row[3] -= shift;
        }
        let mut good = Good::new(15, variant).unwrap();
        let (mut here, mut there) = (Vec::new(), Vec::new());
        good.compute(ObjectPoints::all(&cloud), &CENTRED, &mut here).unwrap();
        good.compute(ObjectPoints::all(&shifted), &frame, &mut there).unwrap();
        prop_assert_eq!(here, there);
    }

    #[test]
    fn good_of_arbitrary_points_and_frames_is_bounded(
        variant in variant(),
        points in prop::collection::vec(prop::array::uniform3(any::<f32>()), 0..20),
        rows in prop::array::uniform3(prop::array::uniform4(any::<f32>())),
    ) {
        let cloud: Vec<_> = points.iter().map(|&[x, y, z]| Point { x, y, z, color: Rgba(0) }).collect();
        let mut good = Good::new(5, variant).unwrap();
        let mut out = Vec::new();
        let frame = DescriptorFrame { object_from_source: rows };
        let result = good.compute(ObjectPoints::all(&cloud), &frame, &mut out);
        prop_assert_eq!(out.len(), if result.is_ok() { 75 } else { 0 });
        prop_assert!(out.iter().all(|v| (0.0..=1.0).contains(v)));
    }
}

#[test]
fn a_selection_has_the_descriptor_of_its_copy() {
    let cloud = sheet(2000);
    let indices: Vec<u32> = (0..2000).filter(|i| i % 3 == 0).collect();
    let copy: Vec<Point> = indices.iter().map(|&i| cloud[i as usize]).collect();
    let mut good = Good::new(15, PUBLISHED).unwrap();
    let (mut of_selection, mut of_copy) = (Vec::new(), Vec::new());
    let selection = ObjectPoints::selected(&cloud, &indices).unwrap();
    let frame = reference_frame(selection).unwrap();
    assert_eq!(reference_frame(ObjectPoints::all(&copy)), Some(frame));
    good.compute(selection, &frame, &mut of_selection).unwrap();
    good.compute(ObjectPoints::all(&copy), &frame, &mut of_copy)
        .unwrap();
    assert_eq!(of_selection, of_copy);
}

#[test]
fn four_points_fall_into_the_expected_bins() {
    // Support 0.1 + 0.02 m, so bins of 0.06 m: each coordinate falls left or right.
    let at = |x: f32, y: f32, z: f32| Point {
        x,
        y,
        z,
        color: Rgba(0),
    };
    let cloud = [
        at(-0.05, 0.0, 0.02),
        at(0.05, 0.0, 0.02),
        at(0.05, 0.0, -0.02),
        at(0.05, 0.01, 0.02),
    ];
    let mut good = Good::new(2, PUBLISHED).unwrap();
    let mut out = Vec::new();
    good.compute(ObjectPoints::all(&cloud), &IDENTITY, &mut out)
        .unwrap();
    let (yz, xz, xy) = (
        [0.0, 0.0, 0.25, 0.75],
        [0.0, 0.25, 0.25, 0.5],
        [0.0, 0.25, 0.0, 0.75],
    );
    assert_eq!(out, [xz, yz, xy].concat());
}

#[test]
fn points_without_depth_are_skipped() {
    let mut cloud = sheet(1000);
    let mut good = Good::new(5, PUBLISHED).unwrap();
    let (mut whole, mut with_holes) = (Vec::new(), Vec::new());
    good.compute(ObjectPoints::all(&cloud), &IDENTITY, &mut whole)
        .unwrap();
    cloud.insert(17, Point::without_depth(Rgba(0)));
    good.compute(ObjectPoints::all(&cloud), &IDENTITY, &mut with_holes)
        .unwrap();
    assert_eq!(whole, with_holes);
    let hole = [Point::without_depth(Rgba(0)); 3];
    assert_eq!(
        good.compute(ObjectPoints::all(&hole), &IDENTITY, &mut whole),
        Err(Error::NoPoints)
    );
    assert!(whole.is_empty());
}

#[test]
fn invalid_parameters_are_rejected() {
    for n_bins in [0, 1, 65, usize::MAX] {
        assert_eq!(
            Good::new(n_bins, PUBLISHED).unwrap_err(),
            Error::BinCount(n_bins)
        );
    }
    for threshold in [-0.001, f32::NAN, f32::INFINITY] {
        let variant = GoodVariant::Published {
            sign_threshold_m: threshold,
        };
        assert!(matches!(
            Good::new(15, variant),
            Err(Error::SignThreshold(_))
        ));
    }
    for side_m in [-0.2, 0.0, f64::NAN, f64::INFINITY] {
        let support = Support::Fixed { side_m };
        let error = Good::new(15, GoodVariant::Workspace { support }).unwrap_err();
        assert!(
            error.to_string().contains(&format!("sides of {side_m} m")),
            "{error}"
        );
    }
}

#[test]
fn a_fixed_support_preserves_size() {
    let small = sheet(3000);
    let large: Vec<Point> = small
        .iter()
        .map(|p| Point {
            x: 2.0 * p.x,
            y: 2.0 * p.y,
            z: 2.0 * p.z,
            ..*p
        })
        .collect();
    let change = |variant: GoodVariant| {
        let mut good = Good::new(15, variant).unwrap();
        let mut describe = |cloud: &[Point]| {
            let points = ObjectPoints::all(cloud);
            let frame = reference_frame(points).unwrap();
            let mut out = Vec::new();
            good.compute(points, &frame, &mut out).unwrap();
            out
        };
        let (a, b) = (describe(&small), describe(&large));
        a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum::<f32>()
    };
    let (adaptive, fixed) = (change(WORKSPACE), change(WORKSPACE_FIXED));
    assert!(2.0 * adaptive < fixed, "{adaptive} {fixed}");
}

/// Sign ambiguity of principal axes: two signs depend on the eigen solver, and the third
/// follows. The programs multiply by one common sign, which resolves only a part, so the
/// same points have four descriptors. These variants therefore need a frame with
/// meaningful axes.
#[test]
fn the_four_signs_of_the_axes_give_four_descriptors() {
    // Asymmetric along each axis.
    let bend = |p: &Point| Point {
        y: p.y + 40.0 * p.y * p.y,
        z: p.z + 1.5 * p.x * p.x,
        ..*p
    };
    let cloud: Vec<Point> = sheet(3000).iter().map(bend).collect();
    let points = ObjectPoints::all(&cloud);
    let frame = reference_frame(points).unwrap();
    for variant in [PUBLISHED, WORKSPACE] {
        let mut good = Good::new(15, variant).unwrap();
        let descriptors = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| {
            let mut turned = frame;
            for (row, sign) in turned.object_from_source.iter_mut().zip([x, y, x * y]) {
                *row = row.map(|value| sign * value);
            }
            let mut out = Vec::new();
            good.compute(points, &turned, &mut out).unwrap();
            out
        });
        for i in 0..4 {
            for j in 0..i {
                let pairs = descriptors[i].iter().zip(&descriptors[j]);
                let difference: f32 = pairs.map(|(a, b)| (a - b).abs()).sum();
                // Disjoint descriptors differ by 6.
                assert!(difference > 0.5, "{variant:?} {i} {j}: {difference}");
            }
        }
    }
}
