use super::*;
use crate::viewing_conditions::{HandContact, ViewingConditions};
use proptest::prelude::*;
use sensor_noise::DepthNoise;
use std::f64::consts::FRAC_PI_2;

const FRAME_NS: u64 = 33_333_333;

fn upright(position: Point3<f64>, yaw_rad: f64, half_sides_m: Vector3<f64>) -> OrientedBox {
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_rad);
    OrientedBox {
        frame_from_box: RigidTransform::from_parts(position.coords.into(), rotation),
        half_sides_m,
    }
}

/// Viewing conditions of an elongated object, one metre away, frontal.
fn conditions(is_truncated: bool) -> ViewingConditions {
    ViewingConditions {
        depth_m: 1.0,
        depth_noise: DepthNoise::KINECT_V1,
        ray_in_world: Vector3::y_axis(),
        variances_m2: Vector3::new(3.3e-3, 5e-4, 2e-3),
        stands_on_table: false,
        is_truncated,
        hand_contact: HandContact::None,
    }
}

fn measured(frame: u64, shape: OrientedBox, is_truncated: bool) -> Measurement {
    Measurement::new(frame * FRAME_NS, shape, conditions(is_truncated)).unwrap()
}

fn seen(frame: u64, position: Point3<f64>, yaw_rad: f64) -> Measurement {
    let shape = upright(position, yaw_rad, Vector3::new(0.1, 0.04, 0.08));
    measured(frame, shape, false)
}

/// Low-discrepancy noise in [-1, 1) with mean zero.
fn quasi_noise(i: u64) -> f64 {
    (i as f64 * 0.618_033_988_749_895).fract() * 2.0 - 1.0
}

proptest! {
    #[test]
    fn constant_velocity_is_estimated_through_noise(
        v in prop::array::uniform3(-0.4..0.4_f64),
        p in prop::array::uniform3(-2.0..2.0_f64),
    ) {
        let (config, velocity, start) = (MotionConfig::default(), Vector3::from(v), Point3::from(p));
        let truth = |frame: u64| start + velocity * (frame as f64 / 30.0);
        let noisy = |frame: u64| {
            let noise = Vector3::new(quasi_noise(frame), quasi_noise(3 * frame + 1), quasi_noise(7 * frame + 2));
            seen(frame, truth(frame) + 0.003 * noise, 0.3)
        };
        let mut filter = MotionFilter::start(&noisy(0), &config);
        for frame in 1..60 {
            filter = filter.updated(&noisy(frame), None, &config).unwrap();
        }
        prop_assert!((filter.box_in_world().centre() - truth(59)).norm() < 0.004);
        prop_assert!((filter.velocity_m_s() - velocity).norm() < 0.08);
        let ahead = filter.predicted(62 * FRAME_NS, &config);
        prop_assert!((ahead.box_in_world().centre() - truth(62)).norm() < 0.012);
        let trace = |filter: &MotionFilter| filter.position_covariance_m2().trace();
        prop_assert!(trace(&ahead) > trace(&filter));
    }

    #[test]
    fn every_finite_history_keeps_the_state_finite(
        history in prop::collection::vec(
            (any::<u64>(), prop::array::uniform3(-1e5..1e5_f64), -4.0..4.0_f64,
             prop::array::uniform3(0.0..50.0_f64), -1e5..1e5_f64, any::<(bool, bool)>()),
            1..30,
        ),
    ) {
        let config = MotionConfig::default();
        let mut stamps: Vec<u64> = history.iter().map(|step| step.0).collect();
        stamps.sort_unstable();
        let mut filter: Option<MotionFilter> = None;
        for (stamp_ns, (_, p, yaw, sides, depth_m, (is_truncated, is_handled))) in stamps.into_iter().zip(history) {
            let shape = upright(p.into(), yaw, sides.into());
            let hand_contact = if is_handled { HandContact::Touching } else { HandContact::None };
            let seen = ViewingConditions { depth_m, hand_contact, ..conditions(is_truncated) };
            let measurement = Measurement::new(stamp_ns, shape, seen).unwrap();
            let next = filter.map_or_else(
                || MotionFilter::start(&measurement, &config),
                |filter| filter.updated(&measurement, None, &config).unwrap(),
            );
            let shape = next.box_in_world();
            prop_assert!(shape.centre().iter().all(|value| value.is_finite()));
            prop_assert!((shape.frame_from_box.rotation.norm() - 1.0).abs() < 1e-9);
            prop_assert!(shape.half_sides_m.iter().all(|side| (0.0..=50.0).contains(side)));
            prop_assert!(next.velocity_m_s().norm() <= SPEED_MAX_M_S * 1.0001);
            for covariance in [next.position_covariance_m2(), next.rotation_covariance_rad2()] {
                prop_assert!(covariance.iter().all(|value| value.is_finite()));
                prop_assert!(covariance.trace() > 0.0);
            }
            prop_assert!((0.0..=1.0).contains(&next.completeness()));
            let again = filter.map(|filter| filter.updated(&measurement, None, &config).unwrap());
            prop_assert!(again.is_none_or(|again| again == next), "a replay differs");
            filter = Some(next);
        }
    }

    #[test]
    fn equivalent_boxes_keep_the_pose(
        yaw in -3.0..3.0_f64, readings in prop::collection::vec(0..4_u8, 1..20),
    ) {
        let config = MotionConfig::default();
        let position = Point3::new(0.1, 0.2, 0.3);
        let mut filter = MotionFilter::start(&seen(0, position, yaw), &config);
        let first = filter.box_in_world();
        for (frame, quarter) in (1..).zip(readings) {
            let sides = if quarter % 2 == 1 { [0.04, 0.1, 0.08] } else { [0.1, 0.04, 0.08] };
            let shape = upright(position, yaw + FRAC_PI_2 * f64::from(quarter), sides.into());
            filter = filter.updated(&measured(frame, shape, false), None, &config).unwrap();
        }
        let last = filter.box_in_world();
        prop_assert!(first.frame_from_box.rotation.angle_to(&last.frame_from_box.rotation) < 1e-6);
        prop_assert!((first.half_sides_m - last.half_sides_m).norm() < 1e-9);
    }
}

#[test]
fn a_truncated_box_does_not_shrink_the_object() {
    let config = MotionConfig::default();
    let mut filter = MotionFilter::start(&seen(0, Point3::origin(), 0.0), &config);
    let half = upright(
        Point3::new(0.05, 0.0, 0.0),
        0.0,
        Vector3::new(0.05, 0.04, 0.08),
    );
    for frame in 1..30 {
        let cut = measured(frame, half, true);
        filter = filter.updated(&cut, None, &config).unwrap();
    }
    let shape = filter.box_in_world();
    assert!((shape.half_sides_m - Vector3::new(0.1, 0.04, 0.08)).norm() < 1e-6);
    assert!(shape.centre().coords.norm() < 1e-6, "and does not move it");
    assert!((filter.completeness() - 0.5).abs() < 1e-3);
}

/// Rotation error after a turn by 3 rad in 3 s and a second of rest, radians.
fn error_after_turn(is_handled: bool) -> f64 {
    let config = MotionConfig::default();
    let seen = |frame: u64, yaw_rad: f64, is_handled: bool| {
        let hand_contact = if is_handled {
            HandContact::Touching
        } else {
            HandContact::None
        };
        let conditions = ViewingConditions {
            hand_contact,
            ..conditions(false)
        };
        let shape = upright(Point3::origin(), yaw_rad, Vector3::new(0.1, 0.04, 0.08));
        Measurement::new(frame * FRAME_NS, shape, conditions).unwrap()
    };
    let mut filter = MotionFilter::start(&seen(0, 0.0, false), &config);
    for frame in 1..=120 {
        let yaw_rad = (frame as f64 / 90.0).min(1.0) * 3.0;
        let measurement = seen(frame, yaw_rad, is_handled && frame <= 90);
        filter = filter.updated(&measurement, None, &config).unwrap();
    }
    let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 3.0);
    let rotation = filter.box_in_world().frame_from_box.rotation;
    rotation.angle_to(&turned)
}

#[test]
fn an_object_turned_by_hand_is_followed() {
    assert!(error_after_turn(true) < 0.02);
    // Also without a reported hand contact.
    assert!(
        error_after_turn(false) < 0.10,
        "{}",
        error_after_turn(false)
    );
}

#[test]
fn a_rotationally_symmetric_object_keeps_its_first_orientation() {
    let config = MotionConfig::default();
    let seen = |frame: u64| {
        let round = ViewingConditions {
            variances_m2: Vector3::new(1e-3, 1e-3, 3e-3),
            ..conditions(false)
        };
        // Any rectangle fits a circle.
        let shape = upright(
            Point3::origin(),
            0.7 * quasi_noise(frame),
            Vector3::repeat(0.04),
        );
        Measurement::new(frame * FRAME_NS, shape, round).unwrap()
    };
    let mut filter = MotionFilter::start(&seen(0), &config);
    let first = filter.box_in_world().frame_from_box.rotation;
    for frame in 1..600 {
        filter = filter.updated(&seen(frame), None, &config).unwrap();
    }
    let last = filter.box_in_world().frame_from_box.rotation;
    assert!(first.angle_to(&last) < 0.01);
}

/// Centre of a resting object after one measurement shifted along the ray by 3 cm, metres, with
/// this law of the depth noise at 2 m.
fn shift_with(depth_noise: DepthNoise) -> f64 {
    let config = MotionConfig::default();
    let seen = |frame: u64, y: f64| {
        let conditions = ViewingConditions {
            depth_m: 2.0,
            depth_noise,
            ..conditions(false)
        };
        let shape = upright(Point3::new(0.0, y, 0.0), 0.0, Vector3::new(0.1, 0.04, 0.08));
        Measurement::new(frame * FRAME_NS, shape, conditions).unwrap()
    };
    let mut filter = MotionFilter::start(&seen(0, 0.0), &config);
    for frame in 1..30 {
        filter = filter.updated(&seen(frame, 0.0), None, &config).unwrap();
    }
    let shifted = filter.updated(&seen(30, 0.03), None, &config).unwrap();
    shifted.box_in_world().centre().y
}

#[test]
fn a_shift_within_the_depth_noise_is_noise() {
    // The standard deviation at 2 m is 2, 6, 11 and 18 mm.
    assert!(shift_with(DepthNoise::TIME_OF_FLIGHT) > 0.025);
    let shifts_m = [
        DepthNoise::KINECT_V1,
        DepthNoise::STEREO,
        DepthNoise::KINECT_V1.scaled(3.0),
    ]
    .map(shift_with);
    assert!(shifts_m.iter().all(|shift_m| *shift_m < 0.01));
    assert!(shifts_m.is_sorted_by(|larger, smaller| larger > smaller));
}

#[test]
fn an_old_measurement_is_refused() {
    let config = MotionConfig::default();
    let filter = MotionFilter::start(&seen(5, Point3::origin(), 0.0), &config);
    let error = filter
        .updated(&seen(4, Point3::origin(), 0.0), None, &config)
        .unwrap_err();
    assert!(matches!(error, Error::OutOfOrder { .. }), "{error}");
}

#[test]
fn impossible_measurements_and_settings_are_refused() {
    let good = upright(Point3::origin(), 0.0, Vector3::new(0.1, 0.1, 0.1));
    let mut far = good;
    far.frame_from_box.translation.vector.x = 1e300;
    let mut unknown = good;
    unknown.frame_from_box.translation.vector.z = f64::NAN;
    let negative = OrientedBox {
        half_sides_m: Vector3::new(-0.1, 0.1, 0.1),
        ..good
    };
    for bad in [far, unknown, negative] {
        assert!(Measurement::new(0, bad, conditions(false)).is_err());
    }
    let endless = ViewingConditions {
        depth_m: f64::INFINITY,
        ..conditions(false)
    };
    let shapeless = ViewingConditions {
        variances_m2: Vector3::repeat(f64::NAN),
        ..conditions(false)
    };
    let noiseless = ViewingConditions {
        depth_noise: DepthNoise::KINECT_V1.scaled(f32::NAN),
        ..conditions(false)
    };
    for bad in [endless, shapeless, noiseless] {
        assert!(Measurement::new(0, good, bad).is_err());
    }
    let config = MotionConfig {
        size_random_walk_sigma_m: f64::NAN,
        ..MotionConfig::default()
    };
    assert!(
        config
            .validated()
            .unwrap_err()
            .to_string()
            .contains("size_random_walk_sigma_m")
    );
    assert!(MotionConfig::default().validated().is_ok());
}

/// Whole views, then persistently smaller ones, without a depth image: a single smaller
/// box must be ignored, a lasting one accepted.
#[test]
fn a_lasting_size_change_is_accepted_and_a_flicker_is_not() {
    let config = MotionConfig::default();
    let small = upright(
        Point3::new(-0.02, 0.0, 0.0),
        0.0,
        Vector3::new(0.08, 0.04, 0.08),
    );
    let mut filter = MotionFilter::start(&seen(0, Point3::origin(), 0.0), &config);
    for frame in 1..=10 {
        filter = filter
            .updated(&seen(frame, Point3::origin(), 0.0), None, &config)
            .unwrap();
    }
    filter = filter
        .updated(&measured(11, small, false), None, &config)
        .unwrap();
    assert!(
        filter.box_in_world().half_sides_m.x > 0.098,
        "a single frame must not change the size"
    );
    for frame in 12..400 {
        filter = filter
            .updated(&measured(frame, small, false), None, &config)
            .unwrap();
    }
    let half_m = filter.box_in_world().half_sides_m.x;
    assert!(
        (half_m - 0.08).abs() < 2e-3,
        "{half_m} {}",
        filter.box_in_world().centre()
    );
    assert!((filter.box_in_world().centre().x + 0.02).abs() < 2e-3);
}

#[test]
fn a_jump_is_followed_at_once_and_noise_at_rest_is_damped() {
    let config = MotionConfig::default();
    let mut filter = MotionFilter::start(&seen(0, Point3::origin(), 0.0), &config);
    let noisy = |frame: u64, x: f64| {
        let noise = Vector3::new(
            quasi_noise(frame),
            quasi_noise(3 * frame + 1),
            quasi_noise(7 * frame + 2),
        );
        seen(
            frame,
            Point3::from(Vector3::x() * x + 0.003 * noise),
            0.02 * quasi_noise(5 * frame),
        )
    };
    for frame in 1..60 {
        filter = filter.updated(&noisy(frame, 0.0), None, &config).unwrap();
    }
    assert!(filter.box_in_world().centre().coords.norm() < 0.0025);
    assert!(filter.velocity_m_s().norm() < 0.02);
    filter = filter.updated(&noisy(60, 0.3), None, &config).unwrap();
    assert!((filter.box_in_world().centre().x - 0.3).abs() < 0.01);
}

/// Position after 20 frames with the same measurement of an object at the origin.
fn position_after(measurement_of: impl Fn(u64) -> Measurement) -> Point3<f64> {
    let config = MotionConfig::default();
    let mut filter = MotionFilter::start(&seen(0, Point3::origin(), 0.0), &config);
    for frame in 1..20 {
        let next = seen(frame, Point3::origin(), 0.0);
        filter = filter.updated(&next, None, &config).unwrap();
    }
    for frame in 20..40 {
        filter = filter
            .updated(&measurement_of(frame), None, &config)
            .unwrap();
    }
    filter.box_in_world().centre()
}

#[test]
fn an_object_at_rest_does_not_follow_a_wrong_camera_pose() {
    let shifted = Point3::new(0.03, 0.0, 0.0);
    let followed = position_after(|frame| seen(frame, shifted, 0.0));
    assert!((followed - shifted).norm() < 0.005, "{followed}");
    let noise_m = 0.15;
    let at_rest = position_after(|frame| seen(frame, shifted, 0.0).with_pose_sigma_m(noise_m));
    assert!(at_rest.coords.norm() < 0.01, "{at_rest}");
    let unknown = seen(0, shifted, 0.0).with_pose_sigma_m(f64::NAN);
    assert_eq!(unknown.pose_sigma_m(), 0.0);
}

#[test]
fn a_fragment_does_not_move_an_object() {
    let place = Point3::new(-0.06, 0.0, 0.0);
    let fragment = upright(place, 0.0, Vector3::new(0.03, 0.03, 0.08));
    let moved = position_after(|frame| measured(frame, fragment, false));
    assert!(moved.coords.norm() < 0.04, "{moved}");
}

#[test]
fn a_stopped_object_keeps_its_place() {
    let config = MotionConfig::default();
    let mut filter = MotionFilter::start(&seen(0, Point3::origin(), 0.0), &config);
    for frame in 1..20 {
        let place = Point3::new(0.01 * frame as f64, 0.0, 0.0);
        filter = filter
            .updated(&seen(frame, place, 0.0), None, &config)
            .unwrap();
    }
    assert!(filter.velocity_m_s().norm() > 0.2);
    let later = filter.stopped().predicted(30 * FRAME_NS, &config);
    let apart = later.box_in_world().centre() - filter.box_in_world().centre();
    assert_eq!(apart.norm(), 0.0);
}

/// Filter after a second of motion along x at 0.2 m/s, with the number of its frames.
fn moving_filter(is_at_rest: bool) -> (MotionFilter, u64) {
    let (config, n_frames) = (MotionConfig::default(), 30);
    let at = |frame: u64| {
        let position = Point3::new(0.2 * frame as f64 / 30.0, 0.0, 0.0);
        seen(frame, position, 0.0).with_rest(is_at_rest)
    };
    let start = MotionFilter::start(&at(0), &config);
    let filter = (1..n_frames).fold(start, |filter, frame| {
        filter.updated(&at(frame), None, &config).unwrap()
    });
    (filter, n_frames)
}

#[test]
fn velocity_without_a_reliable_face_decays() {
    let (moving, n_frames) = moving_filter(false);
    assert!(moving.velocity_m_s().x > 0.15, "{}", moving.velocity_m_s());
    // A fragment in the middle of the box says nothing of a motion.
    let config = MotionConfig::default();
    let fragmented = (0..20).fold(moving, |filter, frame| {
        let middle = filter.box_in_world().centre();
        let fragment = upright(middle, 0.0, Vector3::new(0.03, 0.01, 0.02));
        let fragment = measured(n_frames + frame, fragment, false);
        filter.updated(&fragment, None, &config).unwrap()
    });
    let velocity_m_s = fragmented.velocity_m_s();
    assert!(velocity_m_s.norm() < 0.02, "{velocity_m_s}");
}

#[test]
fn velocity_of_an_object_that_nothing_moves_decays() {
    let (handled, _) = moving_filter(false);
    let (at_rest, _) = moving_filter(true);
    let [handled_m_s, at_rest_m_s] = [handled, at_rest].map(|filter| filter.velocity_m_s().norm());
    assert!(
        at_rest_m_s < 0.8 * handled_m_s,
        "{at_rest_m_s} {handled_m_s}"
    );
    // What the camera sees is followed all the same.
    let lag_m = (at_rest.box_in_world().centre() - handled.box_in_world().centre()).norm();
    assert!(lag_m < 0.02, "{lag_m}");
}
