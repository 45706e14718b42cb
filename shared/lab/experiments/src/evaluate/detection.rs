//! `tabula-lab evaluate detection`: segmentation scores and timing of detection on labelled scenes.

mod report;
mod report_page;
mod scene_result;

use crate::arguments::DetectionArguments;
use crate::evaluate::perturbation::{add_noise, shifted};
use crate::output_files::{create_folder, write};
use crate::timing::durations_ms;
use command_line::{Output, progress_bar};
use detection::{
    Config, Detection, DetectionInput, Execution, RawConfig, ScenePriors, Workspace, detect,
};
use evaluation::hypothesis_image::HypothesisImages;
use evaluation::labelled_scenes::{LabelledScene, LabelledScenes, SceneEntry};
use evaluation::memory_floor::sum_of_words;
use evaluation::scene_picture;
use evaluation::segmentation_score::Overlaps;
use point_cloud::{OrganizedCloud, Point, Rgba};
use random::Random;
use report::DetectionReport;
use scene_result::{PsiScores, SceneDraws, SceneResult, SkippedScene, WovRange};
use service::Failure;
use statistics::percentiles::Percentiles;
use std::convert::Infallible;
use std::hint::black_box;
use std::process::ExitCode;

/// Folder of the pictures, inside the output folder.
const PICTURES: &str = "scenes";

/// Error of evaluating one scene or the whole data set.
enum SceneError {
    /// Error of one scene; the evaluation goes on.
    Scene(String),
    /// Failure that ends the whole evaluation.
    Run(Failure),
}

impl From<Failure> for SceneError {
    fn from(failure: Failure) -> Self {
        Self::Run(failure)
    }
}

/// Error of evaluating one scene.
fn scene_error(error: impl std::fmt::Display) -> SceneError {
    SceneError::Scene(error.to_string())
}

/// Scores, times and draws all scenes; the worst scene comes first in the report.
pub(super) fn run(arguments: &DetectionArguments, output: &Output) -> Result<ExitCode, Failure> {
    let scenes = LabelledScenes::open(&arguments.dataset).map_err(Failure::usage)?;
    create_folder(&arguments.out.join(PICTURES))?;
    if let Some(labels) = &arguments.labels {
        create_folder(labels)?;
    }
    let folders = scenes.unusable().iter().map(|(name, error)| SkippedScene {
        name: name.clone(),
        reason: error.to_string(),
    });
    let mut skipped: Vec<SkippedScene> = folders.collect();
    let mut results = Vec::new();
    let mut evaluator = SceneEvaluator::new(arguments)?;
    let bar = progress_bar(scenes.entries().len() as u64, "scenes", output);
    for entry in scenes.entries() {
        match evaluator.evaluate(&scenes, entry) {
            Ok(result) => results.push(result),
            Err(SceneError::Run(failure)) => return Err(failure),
            Err(SceneError::Scene(reason)) => skipped.push(SkippedScene {
                name: entry.name.clone(),
                reason,
            }),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    // The sort is stable: equally bad scenes stay in natural order.
    results.sort_by(|a, b| a.scores.before_psi.wov.total_cmp(&b.scores.before_psi.wov));
    let Some(document) = DetectionReport::of(&results, &skipped, arguments) else {
        return Err(nothing_scored(arguments, &skipped));
    };
    let page = report_page::page(&document, arguments.labels.as_deref());
    page.publish(&arguments.out, "detection.json", &document, output)
}

fn nothing_scored(arguments: &DetectionArguments, skipped: &[SkippedScene]) -> Failure {
    let first = skipped.first();
    let first = first.map_or(String::new(), |SkippedScene { name, reason }| {
        format!("; the first, {name}: {reason}")
    });
    Failure::general(format!(
        "none of the scenes of {} could be scored{first}",
        arguments.dataset.display()
    ))
}

/// Evaluator of labelled scenes, with buffers reused from scene to scene.
struct SceneEvaluator<'a> {
    arguments: &'a DetectionArguments,
    /// Configuration with each part of an object apart.
    config_of_parts: Config,
    /// Default configuration, which makes one object of its disjoint parts.
    config: Config,
    workspace: Workspace,
    detection: Detection,
}

impl<'a> SceneEvaluator<'a> {
    fn new(arguments: &'a DetectionArguments) -> Result<Self, Failure> {
        let parts = RawConfig {
            joins_parts: false,
            ..RawConfig::default()
        };
        Ok(Self {
            arguments,
            config_of_parts: Config::new(parts).map_err(Failure::general)?,
            config: Config::default(),
            workspace: Workspace::default(),
            detection: Detection::default(),
        })
    }

    /// Detects, scores, draws and times one scene.
    fn evaluate(
        &mut self,
        scenes: &LabelledScenes,
        entry: &SceneEntry,
    ) -> Result<SceneResult, SceneError> {
        let scene = scenes.read(entry).map_err(scene_error)?;
        let cloud = OrganizedCloud::new(&scene.points, scene.width, scene.height);
        let frame = DetectionInput {
            cloud: cloud.map_err(scene_error)?,
            up_in_camera: scene.up_in_camera,
            priors: ScenePriors::default(),
        };
        let found = self.find(&frame, true)?;
        let whole_objects = PsiScores::of(&found, &scene.whole_object_labels());
        let whole_objects = whole_objects.ok_or_else(no_object)?;
        let draws = self.draw_anew(&scene, frame)?;
        let found = self.find(&frame, false)?;
        let scores = PsiScores::of(&found, &scene.labels).ok_or_else(no_object)?;
        self.write_labels(&entry.name, &found, &scene)?;
        let picture = self.draw(&entry.name, &scene, &found)?;
        let [durations_ms, pass_ms] = self.measure(&frame)?;
        Ok(SceneResult {
            name: entry.name.clone(),
            group: entry.group.clone(),
            is_odd: entry.is_odd,
            has_up: scene.up_in_camera.is_some(),
            assumptions: self.detection.assumptions,
            n_points: scene.points.len(),
            scores,
            whole_objects,
            draws,
            detection_ms: Percentiles::of(durations_ms.clone()).unwrap_or_default(),
            durations_ms,
            pass_ms,
            picture,
        })
    }

    /// Scores of a scene with noise drawn anew, and shifted; `None` without draws and for a cloud
    /// without an image grid.
    fn draw_anew(
        &mut self,
        scene: &LabelledScene,
        frame: DetectionInput<'_>,
    ) -> Result<Option<SceneDraws>, SceneError> {
        let n_draws = self.arguments.draws as usize;
        if n_draws == 0 || scene.height < 2 {
            return Ok(None);
        }
        let mut wov = |points: &[Point], labels: &[u16]| {
            let cloud = OrganizedCloud::new(points, scene.width, scene.height);
            let cloud = cloud.map_err(scene_error)?;
            let found = self.find(&DetectionInput { cloud, ..frame }, false)?;
            let scores = PsiScores::of(&found, labels).ok_or_else(no_object)?;
            Ok::<f64, SceneError>(scores.before_psi.wov)
        };
        let mut noisy = scene.points.clone();
        let no_point = Point::without_depth(Rgba::opaque(0, 0, 0));
        let (mut with_noise, mut after_shift) = (Vec::new(), Vec::new());
        for draw in 0..n_draws {
            add_noise(
                &scene.points,
                &mut Random::from_seed(draw as u64),
                &mut noisy,
            );
            with_noise.push(wov(&noisy, &scene.labels)?);
            let points = shifted(&scene.points, scene.width, draw, no_point);
            let labels = shifted(&scene.labels, scene.width, draw, 0);
            after_shift.push(wov(&points, &labels)?);
        }
        let ranges = WovRange::of(&with_noise).zip(WovRange::of(&after_shift));
        Ok(ranges.map(|(noise, shifted)| SceneDraws { noise, shifted }))
    }

    /// Detects the objects of a scene, with their disjoint parts joined or not.
    fn find(
        &mut self,
        frame: &DetectionInput<'_>,
        joins_parts: bool,
    ) -> Result<HypothesisImages, SceneError> {
        let config = if joins_parts {
            &self.config
        } else {
            &self.config_of_parts
        };
        let (workspace, detection) = (&mut self.workspace, &mut self.detection);
        detect(frame, config, workspace, detection, Execution::default()).map_err(scene_error)?;
        HypothesisImages::of(&self.detection, frame.cloud.points().len())
            .ok_or_else(|| scene_error("detection finds more objects than 16 bits can number"))
    }

    /// Draws the result; returns the path of the picture, relative to the output folder.
    fn draw(
        &self,
        name: &str,
        scene: &LabelledScene,
        found: &HypothesisImages,
    ) -> Result<String, Failure> {
        let picture = format!("{PICTURES}/{name}.png");
        let overlaps = Overlaps::count(&found.before_psi, &scene.labels);
        let image = scene_picture::draw(scene, &self.detection.surfaces, found, &overlaps);
        let image = image.map_err(Failure::general)?;
        write(&self.arguments.out.join(&picture), &image)?;
        Ok(picture)
    }

    /// Times of detection and of one pass over the cloud, milliseconds, one for each repetition.
    fn measure(&mut self, frame: &DetectionInput<'_>) -> Result<[Vec<f64>; 2], SceneError> {
        let repeats = self.arguments.repeats;
        let detection_ms = durations_ms(repeats, || {
            let (workspace, detection) = (&mut self.workspace, &mut self.detection);
            let execution = Execution::default();
            detect(
                black_box(frame),
                &self.config,
                workspace,
                detection,
                execution,
            )?;
            black_box(&self.detection);
            Ok::<(), detection::Error>(())
        });
        let Ok(pass_ms) = durations_ms(repeats, || {
            black_box(sum_of_words(black_box(frame.cloud.points())));
            Ok::<(), Infallible>(())
        });
        Ok([detection_ms.map_err(scene_error)?, pass_ms])
    }

    /// Writes result and truth as raw 16-bit label images, little-endian.
    fn write_labels(
        &self,
        name: &str,
        found: &HypothesisImages,
        scene: &LabelledScene,
    ) -> Result<(), Failure> {
        let Some(folder) = &self.arguments.labels else {
            return Ok(());
        };
        let images = [("pred", &found.before_psi), ("gt", &scene.labels)];
        for (extension, values) in images {
            let bytes: Vec<u8> = values
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect();
            write(&folder.join(format!("{name}.{extension}")), &bytes)?;
        }
        Ok(())
    }
}

/// Error of a scene without labelled objects.
fn no_object() -> SceneError {
    scene_error("no object is labelled; objects have labels from 10 on, or a number in a mask")
}

#[cfg(test)]
mod tests;
