use super::captured_view::capture_all;
use super::closed_loop::LoopScene;
use super::loop_method::Method;
use super::object_hypotheses::{HypothesisNoise, ObjectHypotheses};
use super::simulated_bin::SimulatedBin;
use super::*;
use nalgebra::Point3;
use next_best_view::{RenderConfig, ViewPlanner, VirtualView};
use std::path::PathBuf;

pub(super) fn arguments(out: PathBuf) -> NextBestViewArguments {
    NextBestViewArguments {
        scenes: 1,
        views: 4,
        starts: 1,
        models: "generated".into(),
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
        statistic_report::STATISTIC,
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
    let is_inside = |point: &[f32; 3]| {
        let place = Point3::from(*point).cast::<f64>();
        (0..2).all(|axis| place[axis].abs() <= scene.workspace.greatest[axis] + 1e-3)
    };
    assert!(scene.furniture.iter().all(is_inside));
    let at_wall = Point3::new(0.214, 0.0, 0.80);
    assert_eq!(scene.workspace.is_at_wall(&at_wall), Some(true));
    let inside = Point3::new(0.1, 0.0, 0.80);
    assert_eq!(scene.workspace.is_at_wall(&inside), Some(false));
    // The entropy of a virtual view from above is near that of the rendered image.
    let views = capture_all(&bin, None, false).unwrap();
    let known = ObjectHypotheses::noisy(scene, &HypothesisNoise::NONE, 1, |_| true);
    let planned = known.planning_scene(scene, &[]).unwrap();
    let mut view = VirtualView::default();
    view.render(&planned, &scene.cameras[10], &RenderConfig::default())
        .unwrap();
    let areas = view.object_areas_m2();
    assert_eq!(areas.len(), scene.objects.len());
    let entropy = next_best_view::view_entropy(
        areas,
        view.background_area_m2(),
        next_best_view::TotalArea::Visible,
        2.0,
    );
    assert!(
        (entropy - views[10].entropy).abs() < 0.3,
        "{entropy} for {}",
        views[10].entropy
    );
    // No method sees a view twice.
    let config = Config::default();
    let loop_scene = LoopScene {
        scene,
        views: &views,
        config: &config,
        seed: 1,
    };
    for method in Method::ALL {
        let course = closed_loop::run(&loop_scene, method, 7, &mut ViewPlanner::default());
        let mut visited = course.unwrap().views;
        assert_eq!(visited[0], 7);
        let n = visited.len();
        visited.sort_unstable();
        visited.dedup();
        assert_eq!(visited.len(), n, "{}", method.word());
    }
}

#[test]
fn missing_objects_and_false_ones_follow_the_noise() {
    let bin = SimulatedBin::new(5, 2, &ModelLibrary::generated()).unwrap();
    let scene = &bin.scene;
    let n_objects = |noise: &HypothesisNoise, seed| {
        let known = ObjectHypotheses::noisy(scene, noise, seed, |_| true);
        known.planning_scene(scene, &[]).unwrap().ids().len()
    };
    let n = scene.objects.len();
    assert_eq!(n_objects(&HypothesisNoise::POSES, 1), n);
    let of_seeds: Vec<usize> = (0..40)
        .map(|seed| n_objects(&HypothesisNoise::ALL, seed))
        .collect();
    let mean = of_seeds.iter().sum::<usize>() as f64 / 40.0;
    // One false object, and one in ten missing.
    assert!((mean - (0.9 * n as f64 + 1.0)).abs() < 0.8, "{mean} of {n}");
    assert_eq!(n_objects(&HypothesisNoise::ALL, 7), of_seeds[7]);
}
