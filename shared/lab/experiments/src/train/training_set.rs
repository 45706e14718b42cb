//! Training examples of the segmentation, of one data set of labelled scenes.

use super::color_augmentation::augment;
use crate::parallel;
use command_line::{Output, progress_bar};
use detection::{Config, DetectionInput, ScenePriors, SegmentationExamples, Workspace};
use evaluation::labelled_scenes::{LabelledScene, LabelledScenes};
use evaluation::segmentation_score::FIRST_OBJECT_LABEL;
use point_cloud::OrganizedCloud;
use random::Random;
use service::Failure;
use std::path::Path;

/// Rows of features with their classes.
#[derive(Default)]
pub(super) struct Rows {
    /// Features, row by row.
    pub(super) features: Vec<f32>,
    pub(super) labels: Vec<bool>,
}

impl Rows {
    pub(super) fn push(&mut self, features: &[f32], label: bool) {
        self.features.extend_from_slice(features);
        self.labels.push(label);
    }
}

/// Training examples of one data set.
pub(super) struct TrainingSet {
    pub(super) dataset: String,
    pub(super) n_scenes: usize,
    pub(super) rows: Rows,
}

impl TrainingSet {
    /// Reads the examples of all organised scenes of a data set; `add_rows` adds those of a scene
    /// that are needed.
    pub(super) fn read(
        folder: &Path,
        output: &Output,
        add_rows: impl Fn(&SegmentationExamples, &mut Rows) + Sync,
    ) -> Result<Self, Failure> {
        let scenes = LabelledScenes::open(folder).map_err(Failure::usage)?;
        let entries = scenes.entries();
        let bar = progress_bar(entries.len() as u64, "scenes", output);
        let of_scenes = parallel::map(entries.len(), &bar, Workspace::default, |workspace, i| {
            let scene = scenes.read(&entries[i]).map_err(Failure::general)?;
            let is_organised = scene.height > 1;
            let rows = is_organised.then(|| {
                let mut rows = Rows::default();
                add_rows(&examples(scene, i as u64, workspace)?, &mut rows);
                Ok::<_, Failure>(rows)
            });
            rows.transpose()
        });
        bar.finish_and_clear();
        let mut set = Self {
            dataset: folder.display().to_string(),
            n_scenes: 0,
            rows: Rows::default(),
        };
        for rows in of_scenes {
            if let Some(rows) = rows? {
                set.rows.features.extend(rows.features);
                set.rows.labels.extend(rows.labels);
                set.n_scenes += 1;
            }
        }
        Ok(set)
    }

    /// Name of the data set: the last part of its folder.
    pub(super) fn name(&self) -> &str {
        self.dataset
            .trim_end_matches('/')
            .rsplit('/')
            .next()
            .unwrap_or(&self.dataset)
    }
}

/// Examples of one scene; the seed draws the change of its colours.
fn examples(
    mut scene: LabelledScene,
    seed: u64,
    workspace: &mut Workspace,
) -> Result<SegmentationExamples, Failure> {
    augment(&mut scene.points, scene.width, &mut Random::from_seed(seed));
    let cloud = OrganizedCloud::new(&scene.points, scene.width, scene.height);
    let frame = DetectionInput {
        cloud: cloud.map_err(Failure::general)?,
        up_in_camera: scene.up_in_camera,
        seed,
        priors: ScenePriors::default(),
    };
    let object = |&label: &u16| (label >= FIRST_OBJECT_LABEL).then_some(label);
    let objects: Vec<Option<u16>> = scene.labels.iter().map(object).collect();
    let config = Config::default();
    let mut examples = SegmentationExamples::default();
    detection::add_examples(&frame, &config, workspace, &objects, &mut examples);
    Ok(examples)
}
