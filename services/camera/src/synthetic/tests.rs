//! Tests of the synthetic table: geometry, visibility, noise and reproducibility.

use super::arrangement::objects;
use super::depth_sensor::depth_deviation_m;
use super::*;
use point_cloud::Rgba;
use std::collections::HashSet;

const WIDTH: usize = 640;
const N_PIXELS: usize = 640 * 480;

/// Kinect camera at half resolution, for tests with many views.
const HALF: PinholeCamera = PinholeCamera {
    fx_px: 292.5,
    fy_px: 292.5,
    cx_px: 159.5,
    cy_px: 119.5,
    width: 320,
    height: 240,
};

fn frame(table: &SyntheticTable, frame: u64) -> Vec<Point> {
    let mut points = vec![Point::default(); N_PIXELS];
    table.fill(frame, &mut points);
    points
}

fn depths(table: &SyntheticTable, camera: &PinholeCamera) -> Vec<f32> {
    table.render(camera, &table.world_from_camera()).depth_m
}

/// Points around an object's footprint on the table, millimetres apart.
fn footprint(object: &TableObject) -> Vec<Point3<f64>> {
    let [x, y, z] = object.bounds_in_world.half_sides_m.into();
    let side = |t: f64| [[t * x, y], [t * x, -y], [x, t * y], [-x, t * y]];
    let steps = (-50..=50).map(|step| f64::from(step) / 50.0);
    steps
        .flat_map(side)
        .map(|[x, y]| object.bounds_in_world.frame_from_box * Point3::new(x, y, -z))
        .collect()
}

fn free_space_m(a: &TableObject, b: &TableObject) -> f64 {
    let (around_a, around_b) = (footprint(a), footprint(b));
    let distances = around_a
        .iter()
        .flat_map(|p| around_b.iter().map(move |q| (p - q).norm()));
    distances.fold(f64::INFINITY, f64::min)
}

#[test]
fn objects_stand_apart_from_each_other_and_from_the_rim() {
    for arrangement in (0..=100).chain(u32::MAX - 9..=u32::MAX) {
        let objects = objects(arrangement);
        for (i, object) in objects.iter().enumerate() {
            for p in footprint(object) {
                assert!((p.z - TABLE_HEIGHT_M).abs() < 1e-9);
                let to_rim = |axis: usize| TABLE_HALF_SIDES_M[axis] - p[axis].abs();
                assert!(
                    to_rim(0).min(to_rim(1)) >= 0.06,
                    "{arrangement}: {object:?}"
                );
            }
            for other in &objects[..i] {
                let free = free_space_m(object, other);
                assert!(
                    free >= 0.06,
                    "{arrangement}: {} {} {free}",
                    object.name,
                    other.name
                );
            }
        }
    }
}

/// Each object gives the same readings on an otherwise empty table as among the others,
/// without shadows.
#[test]
fn objects_are_in_full_view_and_nothing_hides_or_shades_them() {
    let empty = SyntheticTable::with_objects(0, Vec::new(), HALF);
    for arrangement in 0..=50 {
        let all = SyntheticTable::with_objects(arrangement, objects(arrangement), HALF);
        for object in all.objects() {
            let alone = SyntheticTable::with_objects(0, vec![object.clone()], HALF);
            let is_object = |pixel: &usize| alone.pixels[*pixel].raw != empty.pixels[*pixel].raw;
            let pixels: Vec<usize> = (0..HALF.n_pixels()).filter(is_object).collect();
            let context = format!("{arrangement}: {}", object.name);
            assert!(pixels.len() > 300, "{context} has {} pixels", pixels.len());
            for pixel in pixels {
                check_in_view(pixel, &context);
                let reading = |table: &SyntheticTable| {
                    (table.pixels[pixel].raw, table.pixels[pixel].loss >= 256)
                };
                assert_eq!(
                    reading(&all),
                    reading(&alone),
                    "{context}, hidden or shaded"
                );
            }
        }
    }
}

/// Asserts a margin of ten pixels of the half-size image to its borders and the blind
/// columns.
fn check_in_view(pixel: usize, context: &str) {
    let (row, column) = (pixel / HALF.width as usize, pixel % HALF.width as usize);
    let (width, height) = (HALF.width as usize - N_BLIND_COLUMNS, HALF.height as usize);
    assert!((10..height - 10).contains(&row), "{context} in row {row}");
    assert!(
        (10..width - 10).contains(&column),
        "{context} in column {column}"
    );
}

#[test]
fn arrangement_0_holds_the_five_best_known_objects() {
    let names: Vec<_> = objects(0).iter().map(|object| object.name).collect();
    assert_eq!(names, ["mug", "bowl", "box", "ball", "bottle"]);
}

#[test]
fn within_eight_arrangements_an_object_moves_turns_and_is_replaced_by_another_kind() {
    for n in 0..100 {
        let before = objects(n);
        assert_eq!(
            before
                .iter()
                .map(|object| object.name)
                .collect::<HashSet<_>>()
                .len(),
            5
        );
        for (old, m) in before
            .iter()
            .flat_map(|old| (n + 1..n + 8).map(move |m| (old, m)))
        {
            let after = objects(m);
            let origin = |o: &TableObject| Point3::from(o.world_from_object.translation.vector);
            for new in after.iter().filter(|new| new.name == old.name) {
                assert!((origin(new) - origin(old)).norm() > 0.25);
                let turn = old
                    .world_from_object
                    .rotation
                    .angle_to(&new.world_from_object.rotation);
                assert!(turn.to_degrees() > 8.0, "{n} {m} {}: {turn}", old.name);
            }
            let place_is_taken = |new: &TableObject| {
                new.name != old.name && (origin(new) - origin(old)).norm() < 0.05
            };
            assert!(after.iter().any(place_is_taken), "{n} {m} {}", old.name);
        }
    }
}

/// Every rendered point of an object lies in its ground-truth box, whose top is reached.
#[test]
fn ground_truth_agrees_with_what_is_seen() {
    let camera = PinholeCamera::KINECT_V1;
    let empty = SyntheticTable::with_objects(0, Vec::new(), camera);
    let empty_m = depths(&empty, &camera);
    let (mut kinds, mut n_table) = (HashSet::new(), 0);
    for arrangement in [0, 4] {
        let table = SyntheticTable::new(arrangement);
        let point = |pixel: usize, z: f32| {
            let (column, row) = ((pixel % WIDTH) as f64, (pixel / WIDTH) as f64);
            table.world_from_camera() * camera.back_project(column, row, f64::from(z))
        };
        let mut tops = vec![f64::NEG_INFINITY; table.objects().len()];
        for (pixel, z) in depths(&table, &camera).into_iter().enumerate() {
            let p = point(pixel, z);
            if z == empty_m[pixel] {
                n_table += usize::from((p.z - TABLE_HEIGHT_M).abs() < 1e-6);
                continue;
            }
            let holds = |object: &TableObject| object.bounds_in_world.contains(&p, 2e-5);
            let owner = table
                .objects()
                .iter()
                .position(holds)
                .expect("a ground-truth box contains the point");
            tops[owner] = p.z.max(tops[owner]);
        }
        for (object, top) in table.objects().iter().zip(tops) {
            let height = object.bounds_in_world.sides_m().z;
            assert!(
                (top - TABLE_HEIGHT_M - height).abs() < 0.002,
                "{} {top}",
                object.name
            );
            assert!((object.centre_in_world().z - TABLE_HEIGHT_M - 0.5 * height).abs() < 1e-9);
            kinds.insert(object.name);
        }
    }
    assert_eq!((kinds.len(), n_table > N_PIXELS / 2), (8, true));
}

#[test]
fn the_camera_stands_where_it_says() {
    let table = SyntheticTable::new(0);
    let world_from_camera = table.world_from_camera();
    let eye = world_from_camera.translation.vector;
    let distance = (eye - Vector3::new(0.0, 0.0, TABLE_HEIGHT_M)).norm();
    assert!((distance - 1.0).abs() < 1e-9);
    let up = table.up_in_camera();
    assert!((world_from_camera.rotation * up.into_inner() - Vector3::z()).norm() < 1e-9);
    // Upright: nothing of gravity along the rows; looking down by 43 degrees.
    assert!(up.x.abs() < 1e-9 && up.y < 0.0);
    assert!(((-up.z).asin().to_degrees() - 43.0).abs() < 1e-6);
}

#[test]
fn frames_are_reproducible_and_differ_in_their_noise() {
    let table = SyntheticTable::new(1);
    let bits = |points: &[Point]| -> Vec<[u32; 4]> {
        let bits = |p: &Point| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), p.color.0];
        points.iter().map(bits).collect()
    };
    let first = bits(&frame(&table, 7));
    assert_eq!(first, bits(&frame(&SyntheticTable::new(1), 7)));
    for other in [8, 0, u64::MAX] {
        let other = bits(&frame(&table, other));
        let n_equal = first.iter().zip(&other).filter(|(a, b)| a == b).count();
        assert!(n_equal < N_PIXELS / 5, "{n_equal} equal points");
    }
}

#[test]
fn a_slice_of_another_length_gets_as_much_of_the_frame_as_it_holds() {
    let table = SyntheticTable::new(0);
    let whole = frame(&table, 3);
    let mut short = vec![Point::default(); 1000];
    table.fill(3, &mut short);
    let same = |a: &[Point], b: &[Point]| {
        a.iter()
            .zip(b)
            .all(|(a, b)| a.color == b.color && a.z.to_bits() == b.z.to_bits())
    };
    assert!(same(&short, &whole[..1000]));
    let mut long = vec![Point::default(); N_PIXELS + 9];
    table.fill(3, &mut long);
    assert!(same(&long[..N_PIXELS], &whole));
    assert_eq!(long[N_PIXELS..], [Point::default(); 9]);
}

/// Each point lies on its pixel's ray and the 11-bit scale, within the noise of the
/// surface; its colour within the colour noise.
#[test]
fn every_measured_point_lies_where_the_geometry_says() {
    let camera = PinholeCamera::KINECT_V1;
    let steps_m = 8.0 * 0.075 * camera.fx_px;
    for arrangement in 0..3 {
        let table = SyntheticTable::new(arrangement);
        let view = table.render(&camera, &table.world_from_camera());
        for (pixel, point) in frame(&table, 11).iter().enumerate() {
            check_color(point.color, &view.rgb[3 * pixel..][..3]);
            if !point.is_finite() {
                continue;
            }
            let seen = camera
                .project(&point.position())
                .expect("the point is in front of the camera");
            let (column, row) = ((pixel % WIDTH) as f64, (pixel / WIDTH) as f64);
            assert!((seen.x - column).abs() < 1e-3 && (seen.y - row).abs() < 1e-3);
            let (z, truth) = (f64::from(point.z), f64::from(view.depth_m[pixel]));
            let raw = 1090.0 - steps_m / z;
            assert!(
                (raw - raw.round()).abs() < 1e-3 && (0.0..2047.0).contains(&raw),
                "{raw}"
            );
            let off = (steps_m / z - steps_m / truth).abs();
            let deviation = depth_deviation_m(truth) * steps_m / (truth * truth);
            assert!(
                off <= 3.47 * deviation + 0.501,
                "pixel {pixel}: {z} of {truth}"
            );
        }
    }
}

fn check_color(measured: Rgba, truth: &[u8]) {
    assert_eq!(measured.0 >> 24, 0xff);
    for (measured, truth) in measured.rgb().iter().zip(truth) {
        assert!(measured.abs_diff(*truth) <= 8, "{measured} of {truth}");
    }
}

/// The spread of readings is that of the noise model and the quantisation together,
/// without bias.
#[test]
fn the_spread_of_readings_is_the_noise_models() {
    let camera = PinholeCamera::KINECT_V1;
    let table = SyntheticTable::new(0);
    let truth_m = depths(&table, &camera);
    let (mut sum, mut sum_of_squares, mut n) = (0.0, 0.0, 0.0);
    for (point, truth) in (0..8)
        .flat_map(|k| frame(&table, k))
        .zip(truth_m.iter().cycle())
    {
        let truth = f64::from(*truth);
        if point.is_finite() && (0.7..1.3).contains(&truth) {
            let step = truth * truth / (8.0 * 0.075 * camera.fx_px);
            let expected = depth_deviation_m(truth).hypot(step / 12.0_f64.sqrt());
            let off = (f64::from(point.z) - truth) / expected;
            (sum, sum_of_squares, n) = (sum + off, sum_of_squares + off * off, n + 1.0);
        }
    }
    let (mean, deviation) = (sum / n, (sum_of_squares / n).sqrt());
    assert!(
        mean.abs() < 0.02 && (deviation - 1.0).abs() < 0.02,
        "{mean} {deviation} {n}"
    );
}

#[test]
fn depth_is_missing_in_shadows_left_of_objects_and_in_the_blind_columns() {
    let table = SyntheticTable::new(0);
    let points = frame(&table, 0);
    let n_lost = points.iter().filter(|point| !point.is_finite()).count();
    assert!(
        (N_PIXELS / 50..N_PIXELS / 10).contains(&n_lost),
        "{n_lost} lost"
    );
    assert!((0..N_PIXELS).all(|i| i % WIDTH < WIDTH - N_BLIND_COLUMNS || !points[i].is_finite()));
    let camera_from_world = table.world_from_camera().inverse();
    let cereal_box = &table.objects()[2];
    let centre = camera_from_world * (cereal_box.centre_in_world() + 0.08 * Vector3::z());
    let at = table
        .camera()
        .project(&centre)
        .expect("the point is in front of the camera");
    let lost = |columns: std::ops::Range<usize>| {
        columns
            .filter(|column| !points[at.y as usize * WIDTH + column].is_finite())
            .count()
    };
    let (left, right) = (
        lost(at.x as usize - 80..at.x as usize),
        lost(at.x as usize..at.x as usize + 80),
    );
    assert!(left > 8 && right < 6, "{left} left, {right} right");
}

/// Normals predict the depth of neighbouring pixels, except at edges.
#[test]
fn normals_agree_with_neighbouring_depths() {
    let camera = PinholeCamera::KINECT_V1;
    for arrangement in [0, 4] {
        let table = SyntheticTable::new(arrangement);
        let pose = table.world_from_camera();
        let bare = SyntheticTable::with_objects(0, Vec::new(), camera);
        let (surfaces, bare) = (
            cast_image(&table.scene, &camera, &pose),
            depths(&bare, &camera),
        );
        let (mut n, mut n_wrong) = (0.0, 0.0);
        for pixel in (0..N_PIXELS - 1).filter(|pixel| pixel % WIDTH != WIDTH - 1) {
            let (Some(a), Some(b)) = (surfaces[pixel], surfaces[pixel + 1]) else {
                continue;
            };
            if a.t as f32 != bare[pixel] && (a.t - b.t).abs() < 0.02 {
                let ray = world_ray(&camera, &pose, pixel);
                let next = world_ray(&camera, &pose, pixel + 1).direction;
                let predicted = a.t * a.normal.dot(&ray.direction) / a.normal.dot(&next);
                n += 1.0;
                n_wrong += f64::from(u8::from((predicted - b.t).abs() > 0.001));
            }
        }
        assert!(n > 10_000.0 && n_wrong < 0.05 * n, "{n_wrong} of {n}");
    }
}

/// A surface seen by the depth camera is at the same place for a displaced camera.
#[test]
fn another_camera_sees_the_same_scene() {
    let table = SyntheticTable::new(2);
    let camera = PinholeCamera::KINECT_V1;
    let wider = PinholeCamera {
        fx_px: 525.0,
        fy_px: 525.0,
        ..camera
    };
    let right_by_25_mm = RigidTransform::translation(0.025, 0.0, 0.0);
    let here = table.render(&camera, &table.world_from_camera());
    let there = table.render(&wider, &(table.world_from_camera() * right_by_25_mm));
    assert_eq!(
        (there.depth_m.len(), there.rgb.len()),
        (N_PIXELS, 3 * N_PIXELS)
    );
    let (mut n, mut n_same_depth, mut n_same_color) = (0, 0, 0);
    for (pixel, z) in here.depth_m.iter().enumerate() {
        let (column, row) = ((pixel % WIDTH) as f64, (pixel / WIDTH) as f64);
        let p = right_by_25_mm.inverse() * camera.back_project(column, row, f64::from(*z));
        let at = wider
            .project(&p)
            .expect("the point is in front of the camera");
        let (column, row) = (at.x.round(), at.y.round());
        if (0.0..640.0).contains(&column) && (0.0..480.0).contains(&row) {
            let there_idx = row as usize * WIDTH + column as usize;
            let differs =
                |i: &usize| here.rgb[3 * pixel + i].abs_diff(there.rgb[3 * there_idx + i]) > 30;
            n += 1;
            n_same_depth += usize::from((there.depth_m[there_idx] - z).abs() < 0.005);
            n_same_color += usize::from((0..3).find(differs).is_none());
        }
    }
    assert!(n > N_PIXELS * 9 / 10, "{n}");
    assert!(
        n_same_depth > n * 97 / 100 && n_same_color > n * 95 / 100,
        "{n_same_depth} {n_same_color} {n}"
    );
}

#[test]
fn a_camera_that_looks_away_sees_nothing() {
    let table = SyntheticTable::new(0);
    let up = RigidTransform::translation(0.0, 0.0, 5.0);
    let view = table.render(&HALF, &up);
    assert!(view.depth_m.iter().all(|z| z.is_nan()) && view.rgb.iter().all(|c| *c == 0));
}

#[test]
fn the_blocks_of_a_crowd_stand_apart_from_each_other_and_from_the_rim() {
    let blocks = arrangement::crowd(CROWD_MAX, |_| false);
    assert_eq!(blocks.len(), CROWD_MAX as usize);
    for (i, block) in blocks.iter().enumerate() {
        for p in footprint(block) {
            let to_rim = |axis: usize| TABLE_HALF_SIDES_M[axis] - p[axis].abs();
            assert!(to_rim(0).min(to_rim(1)) >= 0.04, "{block:?}");
        }
        let centre = block.centre_in_world();
        let is_near = |other: &&TableObject| (other.centre_in_world() - centre).norm() < 0.09;
        for other in blocks[..i].iter().filter(is_near) {
            let free = free_space_m(block, other);
            assert!(free >= 0.022, "{block:?} {other:?} {free}");
        }
    }
}

#[test]
fn every_block_of_a_parade_is_away_in_one_phase() {
    let place = |object: &TableObject| object.centre_in_world().coords.map(|x| (x * 1e3) as i64);
    let whole: Vec<_> = SyntheticTable::crowd(10)
        .objects()
        .iter()
        .map(place)
        .collect();
    let phases = SyntheticTable::parade(10);
    for block in whole {
        let is_there =
            |phase: &&SyntheticTable| phase.objects().iter().map(place).any(|b| b == block);
        assert_eq!(phases.iter().filter(is_there).count(), N_PHASES - 1);
    }
}

#[test]
fn every_block_of_a_crowd_is_in_view() {
    let table = SyntheticTable::crowd(CROWD_MAX);
    let camera_from_world = table.world_from_camera().inverse();
    let [width, height] = [table.camera().width, table.camera().height].map(f64::from);
    for block in table.objects() {
        for p in footprint(block) {
            let [x, y] = table
                .camera()
                .project(&(camera_from_world * p))
                .unwrap()
                .into();
            let right = width - N_BLIND_COLUMNS as f64;
            assert!(
                x > 10.0 && x < right - 10.0 && y > 10.0 && y < height - 10.0,
                "{x} {y}"
            );
        }
    }
}
