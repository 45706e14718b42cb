use super::*;
use geometry::{OrientedBox, RigidTransform};
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, PI};

fn box_at(x: f64, yaw_rad: f64) -> OrientedBox {
    OrientedBox {
        frame_from_box: RigidTransform::new(Vector3::new(x, 0.0, 0.8), Vector3::z() * yaw_rad),
        half_sides_m: Vector3::new(0.06, 0.03, 0.1),
    }
}

fn object(id: u64, x: f64) -> GroundTruthObject {
    GroundTruthObject {
        id,
        world_from_object: box_at(x, 0.0).frame_from_box,
        whole_box: box_at(x, 0.0),
        seen_box: Some(box_at(x, 0.0)),
        symmetry: Symmetry::Half,
        range_m: 1.0,
        is_visible: true,
        counts: true,
    }
}

fn track(id: u64, x: f64, yaw_rad: f64) -> TrackState {
    TrackState {
        id,
        is_output: true,
        box_in_world: box_at(x, yaw_rad),
    }
}

/// Two static objects with one track each, 30 frames.
fn perfect() -> Vec<TrackedFrame> {
    let frame = |i: u32| TrackedFrame {
        time_s: f64::from(i) / 30.0,
        objects: vec![object(1, 0.0), object(2, 0.3)],
        tracks: vec![track(11, 0.0, 0.0), track(12, 0.3, 0.0)],
        pixels: vec![],
        tracks_of_people: vec![],
        ended: vec![],
    };
    (0..30).map(frame).collect()
}

#[test]
fn frames_with_tracks_of_people_are_counted_once() {
    let mut frames = perfect();
    frames[3].tracks_of_people = vec![11, 12];
    frames[4].tracks_of_people = vec![11];
    let (mut score, _) = TrackingScore::of(&frames);
    assert_eq!(score.n_frames_with_person_track, 2);
    score.add(&score.clone());
    assert_eq!(score.n_frames_with_person_track, 4);
}

#[test]
fn perfect_tracks_have_no_errors() {
    let (score, matches) = TrackingScore::of(&perfect());
    assert_eq!(
        (score.mot.mota(), score.identity.idf1()),
        (Some(1.0), Some(1.0))
    );
    assert_eq!((score.n_objects, score.n_ids, score.n_tracks), (2, 2, 2));
    assert_eq!(
        (score.n_lost, score.n_flips, score.n_tracks_of_nothing),
        (0, 0, 0)
    );
    assert!(score.errors.centre_mm.iter().all(|error| *error < 1e-9));
    assert_eq!(score.errors.centre_mm.len(), 60);
    assert!(
        score
            .errors
            .orientation_deg
            .iter()
            .all(|error| *error < 1e-6)
    );
    assert!(matches.iter().all(|of_frame| of_frame.len() == 2));
}

#[test]
fn pose_errors_are_measured() {
    let mut frames = perfect();
    for frame in &mut frames {
        frame.tracks[0] = track(11, 0.004, 0.1 + PI);
    }
    let (score, _) = TrackingScore::of(&frames);
    let worst = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    assert!((worst(&score.errors.centre_mm) - 4.0).abs() < 1e-9);
    assert!((worst(&score.errors.orientation_deg) - 0.1_f64.to_degrees()).abs() < 1e-6);
    // A constant half turn from the start is no flip.
    assert_eq!(score.n_flips, 0);
}

#[test]
fn only_a_turn_of_the_track_alone_is_a_flip() {
    let mut frames = perfect();
    for frame in &mut frames[10..] {
        let turned = box_at(0.0, FRAC_PI_2);
        frame.objects[0].world_from_object = turned.frame_from_box;
        frame.tracks[0].box_in_world = turned;
    }
    assert_eq!(TrackingScore::of(&frames).0.n_flips, 0);
    for frame in &mut frames[20..] {
        frame.tracks[1].box_in_world = box_at(0.3, PI);
    }
    assert_eq!(TrackingScore::of(&frames).0.n_flips, 1);
}

#[test]
fn lost_and_removed_tracks_are_distinguished() {
    let mut frames = perfect();
    for (index, frame) in frames.iter_mut().enumerate() {
        if index >= 10 {
            frame.tracks[0].id = 13;
        }
        if index >= 20 {
            frame.objects.pop();
            frame.tracks.pop();
        }
    }
    frames[10].ended.push(11);
    frames[25].ended.push(12);
    let (score, _) = TrackingScore::of(&frames);
    assert_eq!((score.n_lost, score.n_ids, score.mot.n_switches), (1, 3, 1));
    assert_eq!(score.lost(), Some(0.5));
    let [Some(after_s)] = score.removed_after_s[..] else {
        panic!("{:?}", score.removed_after_s);
    };
    assert!((after_s - 6.0 / 30.0).abs() < 1e-9);
}

#[test]
fn unseen_tracks_are_not_scored() {
    let mut frames = perfect();
    for frame in &mut frames[15..] {
        frame.tracks[0].is_output = false;
        frame.objects[0].counts = false;
    }
    let (score, _) = TrackingScore::of(&frames);
    assert_eq!(score.mot.mota(), Some(1.0));
    assert_eq!(score.mot.n_objects, 45);
}

#[test]
fn metrics_of_runs_add_up() {
    let (mut score, _) = TrackingScore::of(&perfect());
    let other = score.clone();
    score.add(&other);
    assert_eq!(
        (score.mot.n_objects, score.identity.idf1()),
        (120, Some(1.0))
    );
    assert_eq!((score.n_objects, score.errors.centre_mm.len()), (4, 120));
}
