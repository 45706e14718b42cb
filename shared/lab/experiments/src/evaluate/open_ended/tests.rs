use super::*;
use crate::arguments::{DescriptionArguments, DescriptorVariant, LessonArguments};
use dataset::pcd::{self, Encoding, PcdView};
use geometry::RigidTransform;
use point_cloud::Point;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

pub(crate) fn description() -> DescriptionArguments {
    DescriptionArguments {
        variant: DescriptorVariant::Published,
        distance: None,
        shape_only: false,
        up: None,
        bins: 15,
        threshold: None,
        views_max: None,
    }
}

fn arguments(dataset: &Path, out: &Path) -> OpenEndedArguments {
    OpenEndedArguments {
        lessons: LessonArguments {
            dataset: dataset.to_owned(),
            out: out.to_owned(),
            seed: 5,
            tau: 0.67,
            protocol: Some(ViewProtocol::View),
        },
        description: description(),
        runs: 3,
        open_set_share: 0.0,
        log: Some(out.join("log.csv")),
    }
}

/// Data set of bars with different proportions, one category each; their widths overlap, so that
/// some are confused.
pub(crate) fn write_bars(root: &Path, n_categories: u16, n_views: u16) {
    for category in 0..n_categories {
        let folder = root.join(format!("bar, {category}"));
        fs::create_dir_all(&folder).unwrap();
        for view in 0..n_views {
            let point = |i: u16| {
                let (t, phase) = (f32::from(i), f32::from(view));
                let width_m = 0.02 + 0.004 * (f32::from(category) + 1.5 * (phase * 7.3).sin());
                Point {
                    x: 0.1 * (t * 0.7 + phase).sin(),
                    y: width_m * (t * 1.9 + 2.0 * phase).cos(),
                    z: 0.01 * (t * 0.3).sin() + 0.0005 * phase,
                    ..Point::default()
                }
            };
            let points: Vec<Point> = (0..400).map(point).collect();
            write_points(&folder.join(format!("{view}.pcd")), &points);
        }
    }
}

pub(crate) fn write_points(path: &Path, points: &[Point]) {
    let view = PcdView {
        points,
        labels: None,
        width: points.len(),
        height: 1,
        viewpoint: RigidTransform::identity(),
    };
    fs::write(path, pcd::write(view, Encoding::Binary).unwrap()).unwrap();
}

fn json(out: &Path) -> Value {
    let bytes = fs::read(out.join("open-ended.json")).unwrap();
    let mut document: Value = serde_json::from_slice(&bytes).unwrap();
    // Values that differ between runs and folders.
    for key in ["timing", "page", "file"] {
        document.as_object_mut().unwrap().remove(key).unwrap();
    }
    document
}

/// Counts of a run, recomputed from its log.
#[derive(Debug, Default)]
struct Counted {
    questions: u32,
    wrong: u32,
    categories: u32,
}

fn count(log: &str) -> BTreeMap<u64, Counted> {
    let mut runs: BTreeMap<u64, Counted> = BTreeMap::new();
    for line in log.lines().skip(1) {
        // Names of files and categories are quoted when they have a comma.
        let plain: String = line.split('"').step_by(2).collect();
        let quoted: Vec<&str> = line.split('"').skip(1).step_by(2).collect();
        let fields: Vec<&str> = plain.split(',').collect();
        let is_right = match quoted[..] {
            [_, truth, prediction] => truth == prediction,
            _ => !fields[4].is_empty() && fields[4] == fields[5],
        };
        let run = runs.entry(fields[0].parse().unwrap()).or_default();
        run.questions += 1;
        run.wrong += u32::from(!is_right);
        run.categories = run.categories.max(fields[2].parse().unwrap());
    }
    runs
}

fn check_log(out: &Path) {
    let log = fs::read_to_string(out.join("log.csv")).unwrap();
    let (counted, document) = (count(&log), json(out));
    let runs = document["runs"].as_array().unwrap();
    assert_eq!(counted.len(), runs.len());
    assert!(counted.values().any(|run| run.wrong > 0));
    for run in runs {
        let of_log = &counted[&run["seed"].as_u64().unwrap()];
        let number = |key: &str| run[key].as_f64().unwrap();
        let (qci, tlc) = (f64::from(of_log.questions), f64::from(of_log.categories));
        let wrong = f64::from(of_log.wrong);
        assert_eq!((number("qci"), number("tlc")), (qci, tlc));
        assert!((number("gca") - (1.0 - wrong / qci)).abs() < 1e-12);
        // The corrections of the identity are the wrong answers, to the integer.
        let corrections = (number("aic") - 3.0) * tlc;
        assert!((corrections - wrong).abs() < 1e-6, "{corrections}, {wrong}");
        assert_eq!(number("corrections"), wrong);
    }
}

#[test]
fn question_log_reproduces_the_metrics_and_runs_are_reproducible() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_bars(&data, 6, 40);
    let outs = ["first", "second"].map(|name| folder.path().join(name));
    for out in &outs {
        run(&arguments(&data, out), &Output::new(true)).unwrap();
        check_log(out);
    }
    let read = |name: &str| outs.clone().map(|out| fs::read(out.join(name)).unwrap());
    for name in ["log.csv", "overview.svg", "runs/seed-6.svg"] {
        let [first, second] = read(name);
        assert!(first == second && first.len() > 500, "{name}");
    }
    assert_eq!(json(&outs[0]), json(&outs[1]));
    // A run of several is the same when it is played alone.
    let mut alone = arguments(&data, &folder.path().join("alone"));
    (alone.runs, alone.lessons.seed) = (1, 6);
    run(&alone, &Output::new(true)).unwrap();
    assert_eq!(
        json(&outs[0])["runs"][1],
        json(&alone.lessons.out)["runs"][0]
    );
    let page = fs::read_to_string(outs[0].join("index.html")).unwrap();
    assert!(page.contains("overview.svg") && page.contains("runs/seed-7.svg"));
}

#[test]
fn open_set_questions_have_their_own_metrics() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_bars(&data, 6, 40);
    let mut open = arguments(&data, &folder.path().join("open"));
    open.open_set_share = 0.3;
    run(&open, &Output::new(true)).unwrap();
    let score = json(&open.lessons.out)["open_set"].clone();
    assert!(score["n"].as_u64().unwrap() > 0);
    assert!((0.0..=1.0).contains(&score["auroc"].as_f64().unwrap()));
    // Without a threshold nothing is unknown.
    assert_eq!(score["rejected"], 0.0);
}

#[test]
fn unusable_views_are_omitted_with_reasons() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    write_bars(&data, 4, 30);
    let first = data.join("bar, 0");
    let whole = fs::read(first.join("0.pcd")).unwrap();
    fs::write(first.join("90.pcd"), &whole[..whole.len() / 2]).unwrap();
    fs::write(first.join("91.pcd"), b"no PCD at all").unwrap();
    fs::create_dir(first.join("92.pcd")).unwrap();
    let nothing = [Point::without_depth(point_cloud::Rgba(0)); 3];
    write_points(&first.join("93.pcd"), &nothing);
    let far = [0.0, 1.0, 2.0].map(|x| Point {
        x: x * 1e38,
        ..Point::default()
    });
    write_points(&first.join("94.pcd"), &far);
    fs::create_dir(data.join("few")).unwrap();
    fs::copy(first.join("0.pcd"), data.join("few/0.pcd")).unwrap();
    let arguments = arguments(&data, &folder.path().join("out"));
    run(&arguments, &Output::new(true)).unwrap();
    let document = json(&arguments.lessons.out);
    assert_eq!(document["n_left_out"], 6, "{document}");
    let reasons = document["left_out"].to_string();
    for part in [
        "90.pcd",
        "91.pcd",
        "92.pcd",
        "93.pcd",
        "94.pcd",
        "category few",
    ] {
        assert!(reasons.contains(part), "{part} is not in {reasons}");
    }
    assert_eq!(document["runs"][0]["tlc"], 4);
}

#[test]
fn unusable_data_sets_are_refused_with_reasons() {
    let folder = tempfile::tempdir().unwrap();
    let check = |data: &Path, change: fn(&mut OpenEndedArguments), part: &str| {
        let mut arguments = arguments(data, &folder.path().join("out"));
        change(&mut arguments);
        let failure = run(&arguments, &Output::new(true)).unwrap_err();
        assert!(failure.sentence.contains(part), "{}", failure.sentence);
    };
    check(folder.path(), |_| {}, "holds no views");
    check(&folder.path().join("missing"), |_| {}, "missing");
    let data = folder.path().join("data");
    write_bars(&data, 2, 10);
    check(&data, |a| a.lessons.tau = 1.5, "1.5");
    check(&data, |a| a.open_set_share = 0.95, "0.95");
    check(
        &data,
        |a| a.lessons.protocol = Some(ViewProtocol::InstanceDisjoint),
        "0 of the categories",
    );
    let broken = folder.path().join("broken");
    fs::create_dir_all(broken.join("a")).unwrap();
    fs::write(broken.join("a/1.pcd"), b"nothing").unwrap();
    check(&broken, |_| {}, "none of the 1 views");
}

fn restaurant_views() -> PathBuf {
    test_data::path("restaurant-views")
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn real_views_are_learned_reproducibly() {
    let folder = tempfile::tempdir().unwrap();
    let outs = ["first", "second"].map(|name| folder.path().join(name));
    for out in &outs {
        run(&arguments(&restaurant_views(), out), &Output::new(true)).unwrap();
        check_log(out);
    }
    let [first, second] = outs
        .clone()
        .map(|out| fs::read(out.join("log.csv")).unwrap());
    assert_eq!(first, second);
    let document = json(&outs[0]);
    assert_eq!(document, json(&outs[1]));
    assert_eq!(
        (&document["n_categories"], &document["n_views"]),
        (&20.into(), &1200.into())
    );
}

#[test]
fn lesson_split_keeps_objects_apart_where_most_categories_have_two() {
    let view = |(category, instance): (u32, Option<u32>)| LabelledView { category, instance };
    let split = |views: &[(u32, Option<u32>)]| {
        let labels: Vec<LabelledView> = views.iter().copied().map(view).collect();
        lesson_split(None, &labels)
    };
    let apart = [(0, Some(1)), (0, Some(2)), (1, Some(1)), (1, Some(1))];
    assert_eq!(split(&apart), LessonSplit::InstanceDisjoint);
    assert_eq!(split(&apart[1..]), LessonSplit::ByView);
    assert_eq!(
        split(&[(0, None), (0, None), (1, None)]),
        LessonSplit::ByView
    );
    assert_eq!(split(&[]), LessonSplit::ByView);
    let labels = apart.map(view);
    assert_eq!(
        lesson_split(Some(ViewProtocol::View), &labels),
        LessonSplit::ByView
    );
}
