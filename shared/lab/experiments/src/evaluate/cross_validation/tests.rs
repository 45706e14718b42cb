use super::super::open_ended::tests::{description, write_points};
use super::*;
use crate::arguments::{DescriptionArguments, DescriptorVariant, FoldProtocol};
use dataset::washington::{CAMERA, CroppedView, ViewName, write_view};
use point_cloud::Point;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn arguments(dataset: &Path, out: &Path) -> CrossValidationArguments {
    CrossValidationArguments {
        dataset: Some(dataset.to_owned()),
        scenes: None,
        description: description(),
        open_set_share: 0.0,
        out: out.to_owned(),
        folds: 5,
        seed: 1,
        protocol: None,
        sides: 1,
        contiguous: false,
        log: Some(out.join("log.csv")),
    }
}

fn document(out: &Path) -> Value {
    let bytes = fs::read(out.join("cross-validation.json")).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

/// Data set of two distinct categories: a line and a square.
fn write_shapes(root: &Path, n_views: u16) {
    for (name, width_m) in [("line", 0.01), ("square", 0.2)] {
        fs::create_dir_all(root.join(name)).unwrap();
        for view in 0..n_views {
            let point = |i: u16| {
                let t = f32::from(i) + f32::from(view) * 0.37;
                Point {
                    x: 0.2 * (t * 0.7).sin(),
                    y: width_m * (t * 1.9).cos(),
                    z: 0.005 * (t * 0.3).sin(),
                    ..Point::default()
                }
            };
            let points: Vec<Point> = (0..300).map(point).collect();
            write_points(&root.join(format!("{name}/{view}.pcd")), &points);
        }
    }
}

#[test]
fn cross_validation_asks_each_view_once_and_logs_it() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_shapes(&data, 12);
    let arguments = arguments(&data, &folder.path().join("out"));
    run(&arguments, &Output::new(true)).unwrap();
    let document = document(&arguments.out);
    assert_eq!(document["accuracy_micro"], 1.0, "{document}");
    assert_eq!(document["f1_macro"], 1.0);
    assert_eq!(document["settings"]["folds"], "view");
    let log = fs::read_to_string(arguments.out.join("log.csv")).unwrap();
    let mut asked: Vec<&str> = log
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(1).unwrap())
        .collect();
    asked.sort_unstable();
    asked.dedup();
    assert_eq!(asked.len(), 24);
    assert!(
        fs::read_to_string(arguments.out.join("confusion.svg"))
            .unwrap()
            .contains("square")
    );
}

#[test]
fn contiguous_folds_are_slices_of_the_list() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_shapes(&data, 10);
    let mut arguments = arguments(&data, &folder.path().join("out"));
    arguments.contiguous = true;
    run(&arguments, &Output::new(true)).unwrap();
    let log = fs::read_to_string(arguments.out.join("log.csv")).unwrap();
    let first: Vec<&str> = log.lines().filter(|line| line.starts_with("0,")).collect();
    let files: Vec<&str> = first
        .iter()
        .map(|line| line.split(',').nth(1).unwrap())
        .collect();
    assert_eq!(
        files,
        ["line/0.pcd", "line/1.pcd", "square/0.pcd", "square/1.pcd"]
    );
}

/// View of a square of pixels at 1 m.
fn square_view(side: u32) -> CroppedView {
    let n_pixels = (side * side) as usize;
    CroppedView {
        size: (side, side),
        top_left: (300, 200),
        color: vec![90; 3 * n_pixels],
        depth_mm: vec![1000; n_pixels],
        mask: vec![255; n_pixels],
    }
}

#[test]
fn views_of_an_instance_stay_in_one_fold_by_default() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    for (category, side) in [("cup", 20), ("pan", 40)] {
        for instance in 1..=5 {
            for frame in 1..=3 {
                let name = ViewName::new(category, instance, 1, frame).unwrap();
                write_view(&data, &name, &square_view(side + frame), Some(&CAMERA)).unwrap();
            }
        }
    }
    let mut arguments = arguments(&data, &folder.path().join("out"));
    run(&arguments, &Output::new(true)).unwrap();
    let grouped = document(&arguments.out);
    assert_eq!(grouped["settings"]["folds"], "instance-disjoint");
    assert_eq!(grouped["settings"]["n_grouped"], 2);
    let log = fs::read_to_string(arguments.out.join("log.csv")).unwrap();
    let fold_of = |object: &str| {
        let lines = log.lines().filter(|line| line.contains(object));
        let mut folds: Vec<&str> = lines.map(|line| line.split(',').next().unwrap()).collect();
        folds.dedup();
        folds
    };
    for object in ["cup_1/", "cup_5/", "pan_3/"] {
        assert_eq!(fold_of(object).len(), 1, "{object}");
    }
    arguments.protocol = Some(FoldProtocol::View);
    run(&arguments, &Output::new(true)).unwrap();
    assert_eq!(document(&arguments.out)["settings"]["folds"], "view");
}

#[test]
fn other_sides_are_asked_and_new_objects_told_from_them() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    // A cup that looks quite different from behind, and three other objects.
    for (category, side, side_behind) in [
        ("cup", 20, 60),
        ("pan", 40, 42),
        ("jar", 70, 71),
        ("lid", 100, 102),
    ] {
        for frame in 1..=6 {
            let shown = if frame > 3 { side_behind } else { side };
            for height in [1, 2] {
                let name = ViewName::new(category, 1, height, frame).unwrap();
                write_view(&data, &name, &square_view(shown + frame), Some(&CAMERA)).unwrap();
            }
        }
    }
    let mut arguments = arguments(&data, &folder.path().join("out"));
    arguments.description.variant = DescriptorVariant::Ours;
    arguments.protocol = Some(FoldProtocol::OtherSide);
    (arguments.folds, arguments.open_set_share) = (2, 0.5);
    run(&arguments, &Output::new(true)).unwrap();
    let document = document(&arguments.out);
    assert_eq!(document["settings"]["folds"], "other-side");
    assert_eq!(document["settings"]["n_grouped"], 4);
    let log = fs::read_to_string(arguments.out.join("log.csv")).unwrap();
    let n_asked = |fold: &str, frames: [u8; 3]| {
        let is_asked = |line: &&str| {
            let view = line.split(',').nth(1).unwrap();
            let is_frame = |frame: &u8| view.contains(&format!("_{frame}."));
            line.starts_with(fold) && frames.iter().any(is_frame)
        };
        log.lines().filter(is_asked).count()
    };
    // The first fold asks the first half of the turn, seen from both heights.
    assert_eq!(
        (n_asked("0,", [1, 2, 3]), n_asked("0,", [4, 5, 6])),
        (24, 0)
    );
    assert_eq!(
        (n_asked("1,", [1, 2, 3]), n_asked("1,", [4, 5, 6])),
        (0, 24)
    );
    let new_sides = &document["new_sides"];
    assert!(new_sides.is_object(), "{document}");
    assert!(new_sides["n_new_objects"].as_u64() > Some(0), "{document}");
}

#[test]
fn protocols_that_need_objects_are_refused_where_they_are_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_shapes(&data, 10);
    let mut arguments = arguments(&data, &folder.path().join("out"));
    arguments.protocol = Some(FoldProtocol::OtherSide);
    let error = run(&arguments, &Output::new(true)).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("leave out --protocol other-side"),
        "{error}"
    );
}

#[test]
fn views_beyond_the_threshold_are_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_shapes(&data, 10);
    let mut arguments = arguments(&data, &folder.path().join("out"));
    arguments.description = DescriptionArguments {
        threshold: Some(0.0),
        ..description()
    };
    run(&arguments, &Output::new(true)).unwrap();
    let document = document(&arguments.out);
    assert_eq!(
        (&document["accuracy_micro"], &document["f1_micro"]),
        (&0.0.into(), &0.0.into())
    );
    assert_eq!(document["categories"]["line"]["taken_for"], Value::Null);
}

#[test]
fn withheld_categories_are_scored_as_open_set_only() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_shapes(&data, 20);
    let mut arguments = arguments(&data, &folder.path().join("out"));
    arguments.open_set_share = 0.5;
    run(&arguments, &Output::new(true)).unwrap();
    let document = document(&arguments.out);
    // Of two categories one is taught in each of five folds; four views of each are asked.
    let open_set = &document["open_set"];
    assert_eq!(
        (&open_set["n"], &open_set["n_known"]),
        (&20.into(), &20.into())
    );
    // A line and a square are never like each other.
    assert_eq!(open_set["auroc"], 1.0, "{document}");
    assert_eq!(open_set["false_alarms_at_95"], 0.0);
    assert_eq!(document["accuracy_micro"], 1.0);
    let folds = document["folds"].as_array().unwrap();
    for fold in folds {
        assert_eq!(
            (&fold["n_taught"], &fold["n_asked"]),
            (&16.into(), &4.into())
        );
    }
    let log = fs::read_to_string(arguments.out.join("log.csv")).unwrap();
    let n_open = log.lines().filter(|line| line.ends_with(",1")).count();
    assert_eq!(n_open, 20);
}

#[test]
fn report_omits_open_set_metrics_without_such_questions() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_shapes(&data, 10);
    let arguments = arguments(&data, &folder.path().join("out"));
    run(&arguments, &Output::new(true)).unwrap();
    let document = document(&arguments.out);
    assert_eq!(document.get("open_set"), None);
    assert_eq!(document.get("scenes"), None);
}

#[test]
fn scene_objects_are_found_or_missed_and_false_candidates_lower_precision() {
    let folder = tempfile::tempdir().unwrap();
    let mut arguments = arguments(folder.path(), &folder.path().join("out"));
    arguments.dataset = None;
    arguments.scenes = Some(24);
    arguments.folds = 2;
    arguments.description.variant = DescriptorVariant::Ours;
    run(&arguments, &Output::new(true)).unwrap();
    let document = document(&arguments.out);
    let scenes = &document["scenes"];
    let n = |value: &Value| value.as_u64().unwrap();
    assert_eq!(n(&scenes["n_objects"]) + n(&scenes["n_hidden"]), 4 * 41);
    assert_eq!(
        n(&scenes["n_found"]) + n(&scenes["n_missed"]),
        n(&scenes["n_objects"])
    );
    assert_eq!(n(&scenes["n_found"]), n(&document["n_views"]));
    let categories = document["categories"].as_object().unwrap();
    let sum = |key: &str| {
        categories
            .values()
            .map(|figures| n(&figures[key]))
            .sum::<u64>()
    };
    assert_eq!(sum("n_missed"), n(&scenes["n_missed"]));
    assert_eq!(sum("n_parts"), n(&scenes["n_parts"]));
    let n_right = sum("n_right") as f64;
    let n_named = n(&scenes["n_found"]) + n(&scenes["n_false_names"]);
    let figure = |key: &str| scenes[key].as_f64().unwrap();
    assert!((figure("precision") - n_right / n_named as f64).abs() < 1e-12);
    assert!((figure("recall") - n_right / n(&scenes["n_objects"]) as f64).abs() < 1e-12);
    assert!(
        document["accuracy_micro"].as_f64().unwrap() > 0.5,
        "{document}"
    );
    assert_eq!(document["settings"]["folds"], "scene");
    // Both views of an object in the same kind of scene are never in one part.
    let log = fs::read_to_string(arguments.out.join("log.csv")).unwrap();
    let fold_of = |view: &str| {
        let line = log.lines().find(|line| line.contains(view)).unwrap();
        line.split(',').next().unwrap().to_owned()
    };
    assert_ne!(fold_of("scene-0/"), fold_of("scene-12/"));
}
