use super::super::bin_picking_twin::{TwinKind, thrown};
use super::super::captured_view::CapturedView;
use super::super::entropy_prediction::PredictionScore;
use super::super::prediction_source::PredictionSource;
use super::super::published_statistic::SourceStatistic;
use super::*;
use dataset::bop_scene::{BopImage, BopObject, BopPixels, BopSceneWriter};
use geometry::RigidTransform;
use scene_writer::Written;

/// Seed of the written scenes.
const SEED: u64 = 1001;
/// Seed of the noise of hypotheses: that of the arguments.
const NOISE_SEED: u64 = 3;

/// Scene in the simulation and as it is read.
struct RoundTrip {
    folder: tempfile::TempDir,
    views: Vec<CapturedView>,
    read: Vec<CapturedView>,
}

/// Writes a scene of cups and reads it back.
fn round_trip(n_views: u32, written: Written) -> RoundTrip {
    let folder = tempfile::tempdir().unwrap();
    let bin = thrown(TwinKind::CoffeeCups, SEED, n_views).unwrap();
    let views = scene_writer::write(bin, folder.path(), (written, NOISE_SEED));
    let (bop, models) = (folder.path().join("scene"), folder.path().join("models"));
    let read = bop_capture::read(&bop, &models, NOISE_SEED).unwrap();
    RoundTrip {
        folder,
        views,
        read,
    }
}

impl RoundTrip {
    /// Asserts that the true entropies of all views agree, bit.
    fn assert_entropies_within(&self, tolerance: f64) {
        assert_eq!(self.views.len(), self.read.len());
        for (view, read) in self.views.iter().zip(&self.read) {
            let [simulated, read] = [view.entropy, read.entropy];
            assert!((simulated - read).abs() < tolerance, "{simulated} {read}");
        }
    }

    /// Asserts that the figures of sources agree, bit.
    fn assert_figures_within(&self, sources: &[PredictionSource], tolerance: f64) {
        let [simulated, read] = [&self.views, &self.read].map(|views| SceneStatistic::of(views));
        let figures = |of: &SourceStatistic| {
            let PredictionScore {
                mae, rmse, bias, ..
            } = of.score;
            [mae, rmse, bias, of.best_ten_sd, of.best_ten_mse.sqrt()]
        };
        for ((source, simulated), (_, read)) in simulated.sources.iter().zip(&read.sources) {
            let pairs = figures(simulated).into_iter().zip(figures(read));
            for (simulated, read) in pairs.filter(|_| sources.contains(source)) {
                assert!(
                    (simulated - read).abs() < tolerance,
                    "{source:?} {simulated} {read}"
                );
            }
        }
    }
}

/// Arguments of a run on a BOP scene of a folder.
fn arguments(folder: &Path) -> NextBestViewArguments {
    NextBestViewArguments {
        bop: Some(folder.join("scene")),
        bop_models: Some(folder.join("models")),
        ..super::super::tests::arguments(folder.join("out"))
    }
}

/// Image of one object before the camera.
fn image(number: u32, camera_from_world: Option<RigidTransform>) -> BopImage {
    BopImage {
        number,
        focal_px: [500.0; 2],
        principal_px: [4.0; 2],
        depth_scale_mm: 1.0,
        camera_from_world,
        objects: vec![BopObject {
            model: 1,
            camera_from_object: RigidTransform::translation(0.0, 0.0, 0.5),
            visible_share: Some(1.0),
        }],
    }
}

/// Writes images of 8 by 8 pixels and runs the statistic, which refuses them with a sentence.
fn refused(folder: &Path, images: &[BopImage]) -> String {
    let mut writer = BopSceneWriter::create(&folder.join("scene")).unwrap();
    for image in images {
        let masks = vec![vec![true; 64]; image.objects.len()];
        let pixels = BopPixels {
            size: (8, 8),
            depth_m: &[0.5; 64],
            colors: &[],
            visible_masks: &masks,
        };
        writer.write_image(image, &pixels).unwrap();
    }
    writer.finish().unwrap();
    let ran = super::super::run(&arguments(folder), &Output::new(true));
    ran.unwrap_err().sentence
}

#[test]
fn bop_scene_of_true_depth_has_the_figures_of_its_simulation() {
    let written = Written {
        is_measured: false,
        has_camera_poses: true,
    };
    let trip = round_trip(12, written);
    // Depth is written in tenths of a millimetre.
    trip.assert_entropies_within(2e-4);
    // The surroundings of the bounds are measured in place of known.
    trip.assert_figures_within(&PredictionSource::ALL, 0.02);
    assert_command_agrees(&trip);
}

/// Asserts that the command writes the figures of the scene that it reads.
fn assert_command_agrees(trip: &RoundTrip) {
    let folder = trip.folder.path();
    super::super::run(&arguments(folder), &Output::new(true)).unwrap();
    let json = std::fs::read(folder.join("out/next-best-view.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let entry = &report["published_statistic"][0];
    assert_eq!(
        (&entry["kind"], &entry["n_objects"]),
        (&"bop".into(), &15.into())
    );
    assert!(entry["paper_mse"].is_null() && entry["sources"]["truth"]["over_scenes"].is_null());
    let own = SceneStatistic::of(&trip.read);
    for (source, statistic) in own.sources {
        let written = &entry["sources"][source.word()];
        assert_eq!(written["best_ten_sd"].as_f64(), Some(statistic.best_ten_sd));
        assert_eq!(written["mae"].as_f64(), Some(statistic.score.mae));
    }
    for file in ["index.html", STATISTIC] {
        assert!(folder.join("out").join(file).exists(), "{file}");
    }
}

#[test]
fn bop_scene_of_measured_depth_without_camera_poses_is_near_its_simulation() {
    let written = Written {
        is_measured: true,
        has_camera_poses: false,
    };
    let trip = round_trip(8, written);
    // What the sensor misses is filled in.
    trip.assert_entropies_within(0.04);
    trip.assert_figures_within(&[PredictionSource::Truth], 0.03);
}

#[test]
fn unusable_scenes_are_refused_with_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let missing = super::super::run(&arguments(folder), &Output::new(true));
    let sentence = missing.unwrap_err().sentence;
    assert!(sentence.contains("scene_camera.json"), "{sentence}");
    let sentence = refused(folder, &[image(1, None)]);
    assert!(
        sentence.contains("has one image; the entropy"),
        "{sentence}"
    );
    let lost = BopImage {
        objects: Vec::new(),
        ..image(7, None)
    };
    let sentence = refused(folder, &[image(1, None), lost.clone()]);
    assert!(
        sentence.contains("camera of image 7") && sentence.contains("cam_R_w2c"),
        "{sentence}"
    );
    let pose = Some(RigidTransform::identity());
    let empty = [1, 2].map(|number| BopImage {
        objects: Vec::new(),
        ..image(number, pose)
    });
    let sentence = refused(folder, &empty);
    assert!(sentence.contains("lists no objects"), "{sentence}");
    let mut unseen = image(2, None);
    unseen.objects[0].visible_share = None;
    let sentence = refused(
        folder,
        &[
            unseen.clone(),
            BopImage {
                number: 3,
                ..unseen
            },
        ],
    );
    assert!(sentence.contains("calc_gt_info.py"), "{sentence}");
    let sentence = refused(folder, &[image(1, None), image(2, None)]);
    assert!(sentence.contains("obj_000001.ply"), "{sentence}");
}
