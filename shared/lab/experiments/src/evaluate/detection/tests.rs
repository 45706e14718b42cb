use super::*;
use crate::arguments::{SceneArguments, SimulateVerb};
use crate::simulate;
use constraint::Assumptions;
use dataset::pcd::{self, Encoding, PcdView};
use evaluation::segmentation_score::{SegmentationScore, score};
use geometry::{PinholeCamera, RigidTransform};
use point_cloud::{Point, Rgba};
use serde_json::Value;
use service::exit_code;
use std::path::Path;

/// Label of the box in the test [`scene`].
const BOX_LABEL: u32 = 20;

fn arguments(dataset: &Path, out: &Path) -> DetectionArguments {
    DetectionArguments {
        dataset: dataset.to_owned(),
        out: out.to_owned(),
        labels: Some(out.join("labels")),
        draws: 2,
        repeats: 2,
    }
}

/// Points and labels of a camera looking straight down on a table with boxes, each a square of
/// pixels 2.5 cm above it.
fn scene(boxes: &[[u32; 2]]) -> (Vec<Point>, Vec<u32>) {
    let camera = PinholeCamera::KINECT_V1;
    let pixels =
        (0..camera.height).flat_map(|row| (0..camera.width).map(move |column| (row, column)));
    let pixel = |(row, column): (u32, u32)| {
        let is_over = |&[top, left]: &[u32; 2]| {
            (top..top + 60).contains(&row) && (left..left + 60).contains(&column)
        };
        let found = boxes.iter().position(is_over);
        let z_m = if found.is_some() { 0.875 } else { 0.9 };
        let p = camera.back_project(column.into(), row.into(), z_m);
        let point = Point {
            x: p.x as f32,
            y: p.y as f32,
            z: p.z as f32,
            color: Rgba::opaque(90, 120, 150),
        };
        (point, found.map_or(1, |i| BOX_LABEL + 10 * i as u32))
    };
    pixels.map(pixel).unzip()
}

fn write_scene(path: &Path, boxes: &[[u32; 2]], has_labels: bool) {
    let (points, labels) = scene(boxes);
    let view = PcdView {
        points: &points,
        labels: has_labels.then_some(&labels[..]),
        width: 640,
        height: 480,
        viewpoint: RigidTransform::identity(),
    };
    std::fs::write(path, pcd::write(view, Encoding::Binary).unwrap()).unwrap();
}

fn document(out: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(out.join("detection.json")).unwrap()).unwrap()
}

#[test]
fn evaluation_scores_times_and_draws_labelled_clouds() {
    let folder = tempfile::tempdir().unwrap();
    let (dataset, out) = (folder.path().join("data"), folder.path().join("out"));
    std::fs::create_dir(&dataset).unwrap();
    let path = |name: &str| dataset.join(name);
    write_scene(&path("learn3.pcd"), &[[100, 100], [300, 400]], true);
    write_scene(&path("learn18.pcd"), &[[200, 300]], true);
    write_scene(&path("learn19.pcd"), &[], true);
    write_scene(&path("learn20.pcd"), &[[200, 300]], false);
    std::fs::write(path("learn21.pcd"), "no cloud").unwrap();
    run(&arguments(&dataset, &out), &Output::new(true)).unwrap();

    let document = document(&out);
    assert_eq!(document["n_scenes"], 2);
    for place in ["overall", "after_psi"] {
        let scores = &document[place];
        assert!(scores["wov"].as_f64().unwrap() > 0.95, "{scores}");
        for measure in ["p50", "r50", "f50", "f75"] {
            assert_eq!(scores[measure], 1.0, "{scores}");
        }
        assert_eq!(scores["n_objects"], 3);
    }
    assert_eq!(document["groups"]["boxes"]["n_scenes"], 1);
    assert_eq!(document["groups"]["stacked"]["n_scenes"], 1);
    assert_eq!(document["halves"]["even"]["n_scenes"], 1);
    assert_eq!(document["halves"]["odd"]["n_objects"], 2);
    let skipped: Vec<_> = document["skipped"].as_array().unwrap().iter().collect();
    for (skipped, (name, reason)) in skipped.iter().zip([
        ("learn19", "no object is labelled"),
        ("learn20", "no field `label`"),
        ("learn21", "PCD"),
    ]) {
        assert_eq!(skipped["name"], name);
        assert!(
            skipped["reason"].as_str().unwrap().contains(reason),
            "{skipped}"
        );
    }
    assert_eq!(skipped.len(), 3);
    let [p50, p99] = ["p50", "p99"].map(|p| document["detection_ms"][p].as_f64().unwrap());
    assert!(p50 > 0.0 && p99 >= p50);
    for figure in ["ns_per_point", "pass_over_cloud_ms", "ratio_to_pass"] {
        assert!(document[figure].as_f64().unwrap() > 0.0, "{figure}");
    }
    let scenes = document["per_scene"].as_array().unwrap();
    assert!(scenes[0]["wov"].as_f64() <= scenes[1]["wov"].as_f64());
    for scene in scenes {
        let picture = std::fs::read(out.join(scene["picture"].as_str().unwrap())).unwrap();
        assert!(picture.starts_with(b"\x89PNG"));
    }
    assert!(
        std::fs::read_to_string(out.join("index.html"))
            .unwrap()
            .contains("scenes/learn3.png")
    );
}

#[test]
fn label_images_reproduce_the_scores() {
    let folder = tempfile::tempdir().unwrap();
    let (dataset, out) = (folder.path().join("data"), folder.path().join("out"));
    std::fs::create_dir(&dataset).unwrap();
    write_scene(&dataset.join("a1.pcd"), &[[100, 100], [300, 400]], true);
    run(&arguments(&dataset, &out), &Output::new(true)).unwrap();
    let image = |name: &str| -> Vec<u16> {
        let bytes = std::fs::read(out.join("labels").join(name)).unwrap();
        let (pairs, rest) = bytes.as_chunks();
        assert!(rest.is_empty());
        pairs.iter().copied().map(u16::from_le_bytes).collect()
    };
    let truth: Vec<u32> = image("a1.gt").into_iter().map(u32::from).collect();
    assert_eq!(truth, scene(&[[100, 100], [300, 400]]).1);
    let labels = image("a1.gt");
    assert_eq!(image("a1.pred").into_iter().max(), Some(2));
    let again = score(&Overlaps::count(&image("a1.pred"), &labels)).unwrap();
    let document = document(&out);
    let scores = &document["per_scene"][0];
    assert_eq!(scores["wov"].as_f64(), Some(again.wov));
    assert_eq!(scores["fus"].as_f64(), Some(again.fus));
    assert_eq!(document["groups"]["data"]["o_f"].as_f64(), Some(again.o_f));
    // No partial file is left.
    for place in [&out, &out.join("labels"), &out.join("scenes")] {
        for file in std::fs::read_dir(place).unwrap() {
            let name = file.unwrap().file_name();
            assert!(
                !name.to_string_lossy().ends_with(".part"),
                "{}",
                name.display()
            );
        }
    }
}

#[test]
fn simulated_sequences_are_grouped_by_kind_and_have_gravity() {
    let folder = tempfile::tempdir().unwrap();
    let (dataset, out) = (folder.path().join("data"), folder.path().join("out"));
    let output = Output::new(true);
    for kind in ["isolated", "pile"] {
        let scene = SceneArguments {
            file: None,
            kind: Some(kind.into()),
            objects: Some(3),
            models: None,
            seed: Some(2),
            frames: 2,
            rate: 2.0,
            out: dataset.join(kind),
        };
        simulate::run(&SimulateVerb::Scene(scene), &output).unwrap();
    }
    run(&arguments(&dataset, &out), &output).unwrap();
    let document = document(&out);
    assert_eq!(document["n_scenes"], 4);
    for kind in ["isolated", "pile"] {
        assert_eq!(document["groups"][kind]["n_scenes"], 2);
    }
    assert!(
        document["groups"]["isolated"]["r50"].as_f64().unwrap() > 0.5,
        "{document}"
    );
    assert_eq!(document["assumptions"][0], "up is known in 4 of 4 scenes");
    assert_eq!(document["skipped"].as_array().unwrap().len(), 0);
    assert!(out.join("labels/pile-frame-000001.gt").exists());
}

#[test]
fn unusable_folders_are_refused_with_reasons() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["empty", "unlabelled"] {
        std::fs::create_dir(path(name)).unwrap();
    }
    write_scene(&path("unlabelled/a.pcd"), &[], false);
    std::fs::write(path("file"), "a").unwrap();
    for (name, code, reason) in [
        ("missing", exit_code::USAGE, "missing"),
        ("empty", exit_code::USAGE, "is empty"),
        ("file", exit_code::USAGE, "not a folder"),
        (
            "unlabelled",
            exit_code::FAILURE,
            "the first, a: the PCD file has no field `label`",
        ),
    ] {
        let arguments = arguments(&path(name), &path("out"));
        let failure = run(&arguments, &Output::new(true)).unwrap_err();
        assert_eq!(failure.code, code, "{failure}");
        assert!(failure.sentence.contains(reason), "{failure}");
        assert!(!path("out/detection.json").exists());
    }
}

#[test]
fn report_lists_groups_halves_and_worst_scenes() {
    let scores = |wov: f64| PsiScores {
        before_psi: SegmentationScore {
            wov,
            ..SegmentationScore::default()
        },
        after_psi: SegmentationScore::default(),
    };
    let result = |name: &str, wov: f64, is_odd: bool| SceneResult {
        name: name.into(),
        group: "boxes".into(),
        is_odd,
        has_up: false,
        assumptions: Assumptions::default(),
        n_points: 1000,
        scores: scores(wov),
        whole_objects: scores(0.125),
        draws: None,
        detection_ms: Percentiles { p50: 2.0, p99: 4.0 },
        durations_ms: vec![2.0, 4.0],
        pass_ms: vec![0.1],
        picture: format!("scenes/{name}.png"),
    };
    let results = [result("learn1", 0.25, true), result("learn2", 0.75, false)];
    let skipped: Vec<SkippedScene> = (5..20)
        .map(|i| SkippedScene {
            name: format!("learn{i}"),
            reason: "it is broken".into(),
        })
        .collect();
    let arguments = arguments(Path::new("data"), Path::new("out"));
    let document = DetectionReport::of(&results, &skipped, &arguments).unwrap();
    let text = report_page::page(&document, None).text();
    for part in [
        "Parts before ψ\n%          scenes  wov",
        "even half  1       75.0",
        "boxes      2       50.0",
        "learn1  boxes  25.0",
        "Parts after ψ",
        "Whole objects before ψ\n%          scenes  wov",
        "all        2       0.0",
        "all        2       12.5",
        "wov: mean best IoU of the objects, weighted by their pixels; uov: the same with equal \
         weights; fos: over-segmentation (0 is best)",
        "; f75: share of the objects matched with an F-measure of at least 0.75\n",
        "2.00 ms (median), 4.00 ms (99 %)",
        "2000.0 ns a point, 20.0 times a pass over the cloud (0.100 ms)",
        "left out: learn14: it is broken\nleft out: 5 more",
        "out/index.html",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}
