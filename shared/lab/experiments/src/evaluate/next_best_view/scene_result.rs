//! Result of one scene: its views, the predictions of their entropy, and the closed loops.

use super::captured_view::{CapturedView, capture_all};
use super::closed_loop::{self, LoopCourse, LoopScene};
use super::entropy_prediction::{self, PredictedPairs, PredictionScore};
use super::findable_objects::findable;
use super::loop_method::Method;
use super::object_recognition::ObjectRecogniser;
use super::pose_accuracy::PoseCounts;
use super::prediction_source::PredictionSource;
use super::scene_planner::ScenePlanner;
use super::simulated_bin::SimulatedBin;
use super::view_pictures;
use crate::arguments::NextBestViewArguments;
use random::{Random, mix64};
use service::Failure;
use simulated_world::ModelLibrary;
use view_planning::PlanSettings;

/// Random stream of the first views of the loops.
const STREAM_STARTS: u64 = 3;

/// Figures of one view.
#[derive(Debug, Clone, Copy)]
pub(super) struct ViewFigures {
    pub(super) entropy: f64,
    pub(super) object_entropy: f64,
    pub(super) visibility: f64,
    /// F1 score of detection with recognition.
    pub(super) f1: f64,
    /// F1 score of detection alone.
    pub(super) detection_f1: f64,
    pub(super) n_detected: usize,
    pub(super) elevation_deg: f64,
}

/// Result of one scene.
#[derive(Debug)]
pub(super) struct SceneResult {
    pub(super) seed: u64,
    pub(super) n_objects: usize,
    /// Number of objects that detection finds in at least one view.
    pub(super) n_findable: usize,
    pub(super) views: Vec<ViewFigures>,
    pub(super) poses: PoseCounts,
    pub(super) predictions: Vec<(PredictionSource, PredictionScore)>,
    /// Some predicted and true entropies with noisy hypotheses, for the figure.
    pub(super) pairs: PredictedPairs,
    pub(super) courses: Vec<(Method, Vec<LoopCourse>)>,
    /// Pictures of chosen views: file name and PNG.
    pub(super) pictures: Vec<(String, Vec<u8>)>,
}

/// Seed of the scene with a number.
pub(super) fn scene_seed(seed: u64, number: usize) -> u64 {
    seed.wrapping_mul(1_000_003).wrapping_add(number as u64)
}

/// Runs the scene with a number.
pub(super) fn run(
    number: usize,
    arguments: &NextBestViewArguments,
    settings: &PlanSettings,
    library: &ModelLibrary,
) -> Result<SceneResult, Failure> {
    let seed = scene_seed(arguments.seed, number);
    let bin = SimulatedBin::new(seed, arguments.views, library)?;
    let scene = &bin.scene;
    let recogniser = ObjectRecogniser::taught(&bin, (arguments.lesson_heaps, seed), library)?;
    let planner = ScenePlanner::new(scene, Some(recogniser), seed, true)?;
    let views = capture_all(&bin, Some(&planner), number == 0)?;
    let (predictions, pairs) = predictions(&views);
    let loop_scene = LoopScene {
        scene,
        views: &views,
        settings,
        seed,
    };
    let courses = courses(&loop_scene, arguments);
    let pictures = if number == 0 {
        view_pictures::draw(&views, &courses)?
    } else {
        Vec::new()
    };
    let n_findable = findable(&views).into_iter().filter(|&is| is).count();
    let figures = views.iter().zip(&bin.mounts);
    let figures = figures.map(|(view, mount)| ViewFigures {
        entropy: view.entropy,
        object_entropy: view.object_entropy,
        visibility: view.visibility(),
        f1: view.segments.f1(scene),
        detection_f1: view.segments.detection_f1(),
        n_detected: view.segments.n_detected(),
        elevation_deg: mount.elevation_deg,
    });
    Ok(SceneResult {
        seed,
        n_objects: scene.objects.len(),
        n_findable,
        views: figures.collect(),
        poses: PoseCounts::of(scene, &views),
        predictions,
        pairs,
        courses,
        pictures,
    })
}

/// Scores of the predictions from each source, and some predicted and true entropies.
fn predictions(
    views: &[CapturedView],
) -> (Vec<(PredictionSource, PredictionScore)>, PredictedPairs) {
    let (mut scores, mut shown) = (Vec::new(), Vec::new());
    for source in PredictionSource::ALL {
        let predicted = entropy_prediction::of_all(views, source);
        scores.push((source, entropy_prediction::score(&predicted)));
        if source == PredictionSource::NoisyTruth {
            // The first current view against all others.
            shown = predicted.into_iter().next().unwrap_or_default();
        }
    }
    (scores, shown)
}

fn courses(
    loop_scene: &LoopScene<'_>,
    arguments: &NextBestViewArguments,
) -> Vec<(Method, Vec<LoopCourse>)> {
    let mut random = Random::substream(mix64(loop_scene.seed), STREAM_STARTS);
    let n_views = loop_scene.views.len();
    let starts: Vec<usize> = (0..arguments.starts)
        .map(|_| random.below(n_views))
        .collect();
    let of_method = |method| {
        let courses = starts
            .iter()
            .map(|&start| closed_loop::run(loop_scene, method, start));
        (method, courses.collect())
    };
    Method::ALL.into_iter().map(of_method).collect()
}
