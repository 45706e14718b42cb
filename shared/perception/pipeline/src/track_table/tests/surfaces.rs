//! Frames of another surface than the table of the tracks.

use super::*;
use detection::{Outline, SurfaceRole, Table, TableChoice};
use geometry::{ConvexPolygon, Plane};
use nalgebra::{Point2, Unit};

/// Height of the table on which the candidates stand, metres.
const TABLE_M: f64 = 0.75;

/// Height of a seat, metres.
const SEAT_M: f64 = 0.5;

/// Level table of half a metre at a height over the camera, which looks up.
fn table_at(height_m: f64) -> Table {
    let up = Unit::new_normalize(Vector3::z());
    let plane = Plane::through(&Point3::new(0.0, 0.0, height_m), up);
    let mut corners = [(-0.25, -0.25), (0.25, -0.25), (0.25, 0.25), (-0.25, 0.25)]
        .map(|(x, y)| Point2::new(x, y));
    Table {
        plane,
        plane_by_image: plane,
        table_from_camera: plane.plane_from_source(),
        polygon: ConvexPolygon::convex_hull_of(&mut corners),
        outline: Outline::default(),
        choice: TableChoice::Only,
        role: SurfaceRole::Table,
        n_samples: 1000,
        depth_noise: DepthNoise::KINECT_V1,
        noise_ratio: 1.0,
    }
}

fn detection(height_m: f64, places: &[f64]) -> Detection {
    Detection {
        surfaces: vec![table_at(height_m)],
        candidates: places.iter().map(|x| candidate_at(*x)).collect(),
        point_indices: (0..200).collect(),
        ..Detection::default()
    }
}

/// Confirmed track of an object on the table, and the wall behind it.
fn confirmed_on_table() -> (TableFixture, Vec<Point>) {
    let on_wall = Point {
        z: 1.5,
        ..Point::without_depth(Rgba::opaque(120, 120, 120))
    };
    let wall = vec![on_wall; PinholeCamera::KINECT_V1.n_pixels()];
    let mut fixture = TableFixture::new();
    for _ in 0..3 {
        show(&mut fixture, &wall, &detection(TABLE_M, &[0.0]));
    }
    (fixture, wall)
}

/// One frame of a camera.
fn show(fixture: &mut TableFixture, cloud: &[Point], detection: &Detection) {
    fixture.update(detection, cloud, Some(PinholeCamera::KINECT_V1));
}

#[test]
fn surface_at_another_height_neither_starts_nor_ends_a_track() {
    let (mut fixture, wall) = confirmed_on_table();
    for height_m in [0.0, SEAT_M, 0.9].repeat(5) {
        show(&mut fixture, &wall, &detection(height_m, &[0.3]));
        assert_eq!(fixture.update.rejected_candidates, [0]);
    }
    assert_eq!(fixture.ids(), [1]);
    assert_eq!(
        fixture.table.tracks()[0].visibility(),
        Visibility::Missing,
        "free space in its place says nothing"
    );
    // The table again, by the height and not by the place.
    for _ in 0..3 {
        show(&mut fixture, &wall, &detection(TABLE_M + 0.03, &[0.0, 0.3]));
    }
    assert_eq!(fixture.ids(), [1, 2]);
    for _ in 0..3 {
        show(&mut fixture, &wall, &detection(TABLE_M, &[0.3]));
    }
    assert_eq!(fixture.ids(), [2], "free space over the table ends a track");
}

#[test]
fn surface_that_lasts_out_of_view_of_the_tracks_becomes_the_table() {
    let frames_until_start = |surfaces_m: &[f64], x: f64| {
        let (mut fixture, wall) = confirmed_on_table();
        fixture.world_from_camera = RigidTransform::translation(x, 0.0, 0.0);
        (0..290).find(|frame| {
            let height_m = surfaces_m[frame % surfaces_m.len()];
            show(&mut fixture, &wall, &detection(height_m, &[0.3]));
            fixture.ids().len() > 1
        })
    };
    assert_eq!(frames_until_start(&[TABLE_M], 3.0), Some(2));
    let n_frames = frames_until_start(&[SEAT_M], 3.0).unwrap();
    assert!((140..=160).contains(&n_frames), "{n_frames}");
    // The camera looks about, or has not moved on.
    assert_eq!(frames_until_start(&[SEAT_M, 0.0], 3.0), None);
    assert_eq!(frames_until_start(&[SEAT_M], 0.0), None);
}

#[test]
fn tracks_on_two_tables_keep_both() {
    let (mut fixture, wall) = confirmed_on_table();
    fixture.world_from_camera = RigidTransform::translation(3.0, 0.0, 0.0);
    for _ in 0..160 {
        show(&mut fixture, &wall, &detection(SEAT_M, &[0.0]));
    }
    assert_eq!(fixture.ids(), [1, 2]);
    for (x, height_m, id) in [(0.0, TABLE_M, 1), (3.0, SEAT_M, 2)].repeat(3) {
        fixture.world_from_camera = RigidTransform::translation(x, 0.0, 0.0);
        show(&mut fixture, &wall, &detection(height_m, &[0.0]));
        let sightings = fixture.update.sightings.iter();
        let seen: Vec<u64> = sightings.map(|sighting| sighting.track_id).collect();
        assert_eq!(seen, [id]);
    }
}

#[test]
fn surface_is_free_once_no_track_is_left() {
    let (mut fixture, wall) = confirmed_on_table();
    let n_frames = (0..310).find(|_| {
        show(&mut fixture, &wall, &detection(SEAT_M, &[0.3]));
        fixture.ids() == [2]
    });
    // After the 10 s of an object that is missing.
    assert!(n_frames.is_some_and(|n| n > 290), "{n_frames:?}");
}

#[test]
fn of_a_frame_with_another_table_only_objects_on_the_tracked_one_count() {
    let (mut fixture, wall) = confirmed_on_table();
    let mut seen = detection(SEAT_M, &[0.0, 0.3]);
    seen.surfaces.push(Table {
        role: SurfaceRole::Level,
        ..table_at(TABLE_M)
    });
    seen.candidates[0].surface = 1;
    for _ in 0..5 {
        show(&mut fixture, &wall, &seen);
        assert_eq!(fixture.update.rejected_candidates, [1]);
    }
    assert_eq!(fixture.ids(), [1]);
    assert_eq!(fixture.table.tracks()[0].visibility(), Visibility::Visible);
}

#[test]
fn objects_on_each_level_of_the_tracked_furniture_start_tracks() {
    let (mut fixture, wall) = confirmed_on_table();
    let mut seen = detection(TABLE_M, &[0.0, 0.3]);
    seen.surfaces.push(Table {
        role: SurfaceRole::Level,
        ..table_at(TABLE_M + 0.3)
    });
    seen.candidates[1].surface = 1;
    for _ in 0..3 {
        show(&mut fixture, &wall, &seen);
    }
    assert_eq!(fixture.ids(), [1, 2]);
    // Each level alone is the table of a track.
    for _ in 0..3 {
        let mut upper = detection(TABLE_M + 0.3, &[0.3]);
        upper.candidates[0].surface = 0;
        show(&mut fixture, &wall, &upper);
        assert!(fixture.update.rejected_candidates.is_empty());
    }
}
