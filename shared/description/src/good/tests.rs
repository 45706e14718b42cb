use super::*;
use crate::object_frame;
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};
use point_cloud::{Point, Rgba};
use proptest::prelude::*;

const IDENTITY: DescriptorFrame = DescriptorFrame {
    object_from_source: [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ],
};

/// Points on a lopsided, curved sheet about a metre in front of the camera.
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

fn describe(good: &mut Good, cloud: &[Point], viewpoint: &Point3<f64>) -> Vec<f32> {
    let points = ObjectPoints::all(cloud);
    let frame = object_frame(points, viewpoint).unwrap().descriptor_frame();
    let mut out = Vec::new();
    good.compute(points, &frame, &mut out).unwrap();
    out
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
    ) {
        let cloud: Vec<_> = points.iter().map(|&[x, y, z]| Point { x, y, z, color: Rgba(0) }).collect();
        let mut good = Good::new(n_bins, 0.0015).unwrap();
        let mut out = vec![7.0];
        good.compute(ObjectPoints::all(&cloud), &IDENTITY, &mut out).unwrap();
        prop_assert_eq!(out.len(), good.dimension());
        for part in out.chunks(n_bins * n_bins) {
            let sum: f32 = part.iter().sum();
            // A part is empty only when no point is within the cube.
            prop_assert!(sum == 0.0 || (sum - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn a_moved_object_has_the_same_descriptor(
        turn in prop::array::uniform3(-3.0_f64..3.0),
        shift in prop::array::uniform3(-1.0_f64..1.0),
    ) {
        let cloud = sheet(3000);
        let motion = RigidTransform::new(Vector3::from(shift), Vector3::from(turn));
        let viewpoint = Point3::new(0.1, -0.2, 0.0);
        let mut good = Good::new(15, 0.0015).unwrap();
        let still = describe(&mut good, &cloud, &viewpoint);
        let followed = describe(&mut good, &moved(&cloud, &motion), &(motion * viewpoint));
        let difference: f32 = still.iter().zip(&followed).map(|(a, b)| (a - b).abs()).sum();
        // Of 6 for disjoint descriptors: rounding moves a few points to the next bin.
        prop_assert!(difference < 0.05, "{}", difference);
    }

    #[test]
    fn hostile_points_and_frames_do_no_harm(
        points in prop::collection::vec(prop::array::uniform3(any::<f32>()), 0..20),
        rows in prop::array::uniform3(prop::array::uniform4(any::<f32>())),
    ) {
        let cloud: Vec<_> = points.iter().map(|&[x, y, z]| Point { x, y, z, color: Rgba(0) }).collect();
        let mut good = Good::new(5, 0.0015).unwrap();
        let mut out = Vec::new();
        let frame = DescriptorFrame { object_from_source: rows };
        let result = good.compute(ObjectPoints::all(&cloud), &frame, &mut out);
        prop_assert_eq!(out.len(), if result.is_ok() { 75 } else { 0 });
        prop_assert!(out.iter().all(|v| (0.0..=1.0).contains(v)));
    }
}

#[test]
fn a_selection_is_described_like_a_copy() {
    let cloud = sheet(2000);
    let indices: Vec<u32> = (0..2000).filter(|i| i % 3 == 0).collect();
    let copy: Vec<Point> = indices.iter().map(|&i| cloud[i as usize]).collect();
    let mut good = Good::new(15, 0.0015).unwrap();
    let (mut of_selection, mut of_copy) = (Vec::new(), Vec::new());
    let selection = ObjectPoints::selected(&cloud, &indices).unwrap();
    let frame = object_frame(selection, &Point3::origin()).unwrap();
    assert_eq!(
        object_frame(ObjectPoints::all(&copy), &Point3::origin()),
        Some(frame)
    );
    let frame = frame.descriptor_frame();
    good.compute(selection, &frame, &mut of_selection).unwrap();
    good.compute(ObjectPoints::all(&copy), &frame, &mut of_copy)
        .unwrap();
    assert_eq!(of_selection, of_copy);
}

#[test]
fn four_points_fall_where_they_should() {
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
    let mut good = Good::new(2, 0.0015).unwrap();
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
fn nothing_is_allocated_once_the_largest_object_was_seen() {
    let cloud = sheet(5000);
    let mut good = Good::new(15, 0.0015).unwrap();
    let mut out = Vec::new();
    let memory = |good: &Good, out: &Vec<f32>| {
        let p = &good.points;
        [&p.x, &p.y, &p.z, out].map(|buffer| (buffer.as_ptr(), buffer.capacity()))
    };
    good.compute(ObjectPoints::all(&cloud), &IDENTITY, &mut out)
        .unwrap();
    let before = memory(&good, &out);
    for n in [10, 5000, 1, 4999] {
        good.compute(ObjectPoints::all(&cloud[..n]), &IDENTITY, &mut out)
            .unwrap();
    }
    assert_eq!(memory(&good, &out), before);
}

#[test]
fn points_without_depth_are_left_out() {
    let mut cloud = sheet(1000);
    let mut good = Good::new(5, 0.0015).unwrap();
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
fn impossible_parameters_are_refused() {
    for n_bins in [0, 1, 65, usize::MAX] {
        assert_eq!(
            Good::new(n_bins, 0.0015).unwrap_err(),
            Error::BinCount(n_bins)
        );
    }
    for threshold in [-0.001, f32::NAN, f32::INFINITY] {
        assert!(matches!(
            Good::new(15, threshold),
            Err(Error::SignThreshold(_))
        ));
    }
}
