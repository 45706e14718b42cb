use super::*;
use nalgebra::Vector3;
use proptest::prelude::*;

fn point(x: f32, y: f32, z: f32) -> Point {
    let color = Rgba::opaque(200, 100, 50);
    Point { x, y, z, color }
}

fn unpacked(bytes: &[u8]) -> Vec<Point> {
    PackedCloud::checked(bytes).unwrap().points().collect()
}

#[test]
fn the_layout_is_the_documented_one() {
    let points = [point(1.0, 2.0, 3.0), point(1.5, 2.0, 2.9999)];
    let bytes = pack_cloud(points.iter(), &RigidTransform::identity());
    let mut expected = vec![1, 0, 0, 0, 2, 0, 0, 0];
    for value in [1.25_f32, 2.0, 2.99995] {
        expected.extend(value.to_le_bytes());
    }
    // -0.25 m and 0.25 m in steps of 0.1 mm, and half a step in z.
    expected.extend([0x3c, 0xf6, 0, 0, 0, 0, 200, 100, 50]);
    expected.extend([0xc4, 0x09, 0, 0]);
    assert_eq!(bytes[..24], expected[..24]);
    assert_eq!(bytes[26..33], expected[26..33]);
    assert_eq!(bytes.len(), 20 + 2 * 9);
}

#[test]
fn points_that_cannot_be_packed_are_dropped() {
    let identity = RigidTransform::identity();
    let here = point(0.0, 0.0, 1.0);
    let without_depth = Point::without_depth(Rgba::opaque(1, 2, 3));
    let infinite = point(f32::INFINITY, 0.0, 1.0);
    let bytes = pack_cloud([without_depth, here, infinite].iter(), &identity);
    assert_eq!(unpacked(&bytes), [here]);
    assert!(pack_cloud([without_depth].iter(), &identity).is_empty());
    assert!(pack_cloud([].iter(), &identity).is_empty());
    // Three in a middle that is 3 m from either end, and two out of reach.
    let spread = [-3.4, -3.0, 0.0, 3.0, 3.4].map(|x| point(x, 0.0, 1.0));
    let bytes = pack_cloud(spread.iter(), &identity);
    assert_eq!(unpacked(&bytes).len(), 3);
    assert!(pack_cloud([point(3e38, 0.0, 0.0)].iter(), &identity).len() < 40);
}

#[test]
fn too_many_points_are_subsampled_evenly() {
    for n_points in [
        MAX_CLOUD_POINTS,
        MAX_CLOUD_POINTS + 1,
        7 * MAX_CLOUD_POINTS / 2,
    ] {
        let points: Vec<Point> = (0..n_points)
            .map(|i| point(i as f32 / n_points as f32, 0.0, 1.0))
            .collect();
        let bytes = pack_cloud(points.iter(), &RigidTransform::identity());
        let kept = unpacked(&bytes);
        assert_eq!(kept.len(), MAX_CLOUD_POINTS);
        let widest = kept
            .windows(2)
            .map(|two| two[1].x - two[0].x)
            .fold(0.0, f32::max);
        assert!(widest < 2.5e-4, "{widest} of {n_points}");
        assert_eq!(
            bytes,
            pack_cloud(points.iter(), &RigidTransform::identity())
        );
    }
}

#[test]
fn invalid_bytes_are_refused_by_a_sentence() {
    let good = pack_cloud([point(0.0, 0.0, 1.0)].iter(), &RigidTransform::identity());
    let changed = |place: usize, bytes: [u8; 4]| {
        let mut wrong = good.clone();
        wrong[place..place + 4].copy_from_slice(&bytes);
        wrong
    };
    let mut too_many = changed(4, (MAX_CLOUD_POINTS as u32 + 1).to_le_bytes());
    too_many.resize(HEADER_BYTES + (MAX_CLOUD_POINTS + 1) * POINT_BYTES, 0);
    for (wrong, says) in [
        (vec![], "too few"),
        (good[..HEADER_BYTES - 1].to_vec(), "19 bytes are too few"),
        (changed(0, [2, 0, 0, 0]), "format 2"),
        (changed(4, [2, 0, 0, 0]), "of 2 points"),
        (changed(4, [0xff; 4]), "of 4294967295 points"),
        (good[..good.len() - 1].to_vec(), "28 bytes"),
        ([good.as_slice(), &[0]].concat(), "30 bytes"),
        (too_many, "30001 points"),
        (changed(8, f32::NAN.to_le_bytes()), "not finite"),
        (changed(16, f32::INFINITY.to_le_bytes()), "not finite"),
    ] {
        let sentence = PackedCloud::checked(&wrong).unwrap_err().to_string();
        assert!(sentence.contains(says), "{sentence}");
    }
}

prop_compose! {
    fn pose()(
        position in prop::array::uniform3(-5.0_f64..5.0),
        turn in prop::array::uniform3(-2.0_f64..2.0),
    ) -> RigidTransform {
        RigidTransform::new(Vector3::from(position), Vector3::from(turn))
    }
}

prop_compose! {
    fn near_point()(
        place in prop::array::uniform3(-1.0_f32..1.0),
        [red, green, blue] in any::<[u8; 3]>(),
    ) -> Point {
        let [x, y, z] = place;
        Point { x, y, z: z + 1.5, color: Rgba::opaque(red, green, blue) }
    }
}

proptest! {
    #[test]
    fn positions_are_kept_to_a_twentieth_of_a_millimetre(
        points in prop::collection::vec(near_point(), 1..50),
        world_from_camera in pose(),
    ) {
        let bytes = pack_cloud(points.iter(), &world_from_camera);
        let unpacked = unpacked(&bytes);
        prop_assert_eq!(unpacked.len(), points.len());
        for (unpacked, point) in unpacked.iter().zip(&points) {
            let off = unpacked.position() - world_from_camera * point.position();
            // Half a step, and the rounding of a coordinate below 16 m.
            prop_assert!(off.amax() <= 5.0e-5 + 1e-6, "{}", off);
            prop_assert_eq!(unpacked.color, point.color);
        }
    }

    #[test]
    fn arbitrary_bytes_do_not_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        if let Ok(cloud) = PackedCloud::checked(&bytes) {
            prop_assert!(cloud.points().all(|point| point.is_finite()));
        }
    }

    /// Valid sizes with arbitrary numbers.
    #[test]
    fn any_points_are_finite(
        origin in prop::array::uniform3(prop::num::f32::ANY),
        points in prop::collection::vec(any::<[u8; POINT_BYTES]>(), 0..20),
    ) {
        let mut bytes = [FORMAT.to_le_bytes(), (points.len() as u32).to_le_bytes()].concat();
        bytes.extend(origin.map(f32::to_le_bytes).as_flattened());
        bytes.extend(points.as_flattened());
        match PackedCloud::checked(&bytes) {
            Ok(cloud) => {
                prop_assert_eq!(cloud.n_points(), points.len());
                prop_assert!(cloud.points().all(|point| point.is_finite()));
            }
            Err(error) => {
                prop_assert_eq!(error, InvalidCloud::Origin);
                prop_assert!(!origin.iter().all(|value| value.is_finite()));
            }
        }
    }
}
