use super::captured_view::capture_all;
use super::closed_loop::LoopScene;
use super::loop_method::Method;
use super::object_recognition::ObjectRecogniser;
use super::prediction_source::PredictionSource;
use super::scene_planner::ScenePlanner;
use super::simulated_bin::SimulatedBin;
use super::*;
use nalgebra::Point3;
use simulated_world::ModelSource;
use std::path::PathBuf;

pub(super) fn arguments(out: PathBuf) -> NextBestViewArguments {
    NextBestViewArguments {
        scenes: 1,
        views: 4,
        starts: 1,
        models: ModelSource::Generated,
        sigma_share: 0.35,
        visited_share: 0.1,
        gain_weight: 1.0,
        twin_scenes: 1,
        twin_views: 12,
        lesson_heaps: 1,
        bop: None,
        bop_models: None,
        seed: 3,
        out,
    }
}

#[test]
fn report_holds_the_figures_of_a_small_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    run(&arguments(out.clone()), &Output::new(true)).unwrap();
    let json = std::fs::read(out.join("next-best-view.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    for key in [
        "pearson_r",
        "spearman_rho",
        "entropy_mae",
        "regret",
        "views_to_95",
    ] {
        assert!(report[key].is_f64(), "{key}: {report}");
    }
    let views_to_95 = report["views_to_95"].as_f64().unwrap();
    assert!((1.0..=4.0).contains(&views_to_95), "{views_to_95}");
    assert!(report["pearson_r"].as_f64().unwrap().abs() <= 1.0);
    for method in Method::ALL {
        let found = &report["methods"][method.word()];
        let shares = found["found_by_views"].as_array().unwrap();
        let shares: Vec<f64> = shares.iter().map(|share| share.as_f64().unwrap()).collect();
        assert!(shares.is_sorted() && shares[29] <= 1.0, "{shares:?}");
        // All methods begin with the same view.
        assert_eq!(shares[0], report["methods"]["random"]["found_by_views"][0]);
        assert!(out.join(format!("views-{}.png", method.word())).exists());
    }
    let exact = report["predictions"]["truth"]["mae"].as_f64().unwrap();
    assert!(exact < 0.25, "{exact}");
    let kinds = report["published_statistic"].as_array().unwrap();
    for (entry, (kind, n_objects)) in kinds.iter().zip([("coffee-cups", 15), ("juice-boxes", 5)]) {
        assert_eq!(
            (&entry["kind"], &entry["n_objects"]),
            (&kind.into(), &n_objects.into())
        );
        for (source, figures) in entry["sources"].as_object().unwrap() {
            let figure = |key: &str| figures[key].as_f64().unwrap();
            // The ten best of eleven predictions are better than all.
            assert!(
                figure("best_ten_mse").sqrt() < figure("rmse"),
                "{source} {figures}"
            );
            assert!(
                figure("best_ten_sd") > 0.0
                    && figure("rmse") < entry["entropy_max"].as_f64().unwrap()
            );
        }
    }
    assert_eq!(kinds.len(), 2);
    for file in [
        "index.html",
        STATISTIC,
        figures::ENTROPY,
        figures::PREDICTION,
        figures::LOOPS,
    ] {
        assert!(out.join(file).exists(), "{file}");
    }
}

#[test]
fn objects_lie_in_the_bin_and_exact_hypotheses_show_them() {
    let bin = SimulatedBin::new(5, 12, &ModelLibrary::generated()).unwrap();
    let scene = &bin.scene;
    assert!(scene.objects.len() > 12, "{}", scene.objects.len());
    assert_eq!((scene.cameras.len(), bin.mounts.len()), (12, 12));
    let walls = scene.walls.unwrap();
    assert!(walls.contain(&Point3::new(0.214, 0.0, 0.80)));
    assert!(!walls.contain(&Point3::new(0.1, 0.0, 0.80)));
    // What a view from above shows of exact hypotheses is near its truth.
    let untaught = ObjectRecogniser::taught(&bin, (0, 1), &ModelLibrary::generated()).unwrap();
    let planner = ScenePlanner::new(scene, Some(untaught), 1, true).unwrap();
    let views = capture_all(&bin, Some(&planner), false).unwrap();
    let predicted = views[10].plans.predicted[PredictionSource::Truth as usize][10];
    assert!(
        (predicted - views[10].entropy).abs() < 0.3,
        "{predicted} for {}",
        views[10].entropy
    );
    // No method sees a view twice.
    let settings = PlanSettings::default();
    let loop_scene = LoopScene {
        scene,
        views: &views,
        settings: &settings,
        seed: 1,
    };
    for method in Method::ALL {
        let mut visited = closed_loop::run(&loop_scene, method, 7).views;
        assert_eq!(visited[0], 7);
        let n = visited.len();
        visited.sort_unstable();
        visited.dedup();
        assert_eq!(visited.len(), n, "{}", method.word());
    }
}
