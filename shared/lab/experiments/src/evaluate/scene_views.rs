//! Detected objects of simulated scenes, labelled by the ground truth.

mod candidate_label;
mod scene_describer;
mod scene_sampler;

use super::recognition::{HypothesisDescriptors, RecognitionMethod};
use super::view_table::ViewTable;
use crate::parallel;
use command_line::{Output, progress_bar};
use evaluation::recogniser::LabelledView;
pub(super) use scene_describer::PICTURES;
use scene_describer::{DescribedScene, SceneDescriber};
use scene_sampler::SceneSampler;
use service::Failure;
use std::path::Path;

/// Statistics of detection in the simulated scenes.
#[derive(Default)]
pub(super) struct SceneStatistics {
    pub(super) n_scenes: usize,
    /// Fold of each false candidate (no object, or a smaller part of one); the descriptions follow
    /// those of the views, in the same order.
    pub(super) folds_of_clutter: Vec<u32>,
    /// Number of false candidates that are parts of an object, by category.
    pub(super) n_parts: Vec<u32>,
    /// Number of objects that show a pixel with depth, by category.
    pub(super) n_visible: Vec<u32>,
    /// Number of objects without a pixel with depth.
    pub(super) n_hidden: u32,
    /// Names and paths of the drawn scenes.
    pub(super) pictures: Vec<(String, String)>,
}

/// Detected objects and false candidates of all scenes.
#[derive(Default)]
pub(super) struct SceneViews {
    /// Table of the detected objects, scene by scene.
    pub(super) table: ViewTable,
    /// Index of the scene of each detected object.
    pub(super) scenes: Vec<usize>,
    /// Scene of each false candidate: no object, or a smaller part of one.
    pub(super) scenes_of_clutter: Vec<usize>,
    /// Descriptors of the objects, then of the false candidates.
    pub(super) descriptions: Vec<HypothesisDescriptors>,
    /// Kind of each scene: object set and camera height as one number.
    pub(super) kinds: Vec<u32>,
    /// Statistics without the folds, which are not assigned yet.
    pub(super) statistics: SceneStatistics,
}

/// Simulates scenes on all cores, detects and describes their objects, and draws the first scene of
/// each kind.
pub(super) fn simulate(
    n_scenes: u32,
    seed: u64,
    method: RecognitionMethod,
    out: &Path,
    output: &Output,
) -> Result<SceneViews, Failure> {
    let sampler = SceneSampler::new(seed)?;
    let describer = method.describer()?;
    let bar = progress_bar(n_scenes.into(), "scenes", output);
    let own = || SceneDescriber::new(describer.clone());
    let scenes = parallel::map(n_scenes as usize, &bar, own, |describer, scene| {
        describer.describe(&sampler, scene, out)
    });
    bar.finish_and_clear();
    let scenes: Vec<DescribedScene> = scenes.into_iter().collect::<Result<_, _>>()?;
    Ok(collected(&sampler, scenes))
}

fn collected(sampler: &SceneSampler, scenes: Vec<DescribedScene>) -> SceneViews {
    let categories: Vec<String> = sampler.categories().iter().map(|&n| n.to_owned()).collect();
    let mut statistics = SceneStatistics {
        n_scenes: scenes.len(),
        n_parts: vec![0; categories.len()],
        n_visible: vec![0; categories.len()],
        ..SceneStatistics::default()
    };
    let mut views = SceneViews {
        table: ViewTable {
            categories,
            is_up_known: true,
            ..ViewTable::default()
        },
        ..SceneViews::default()
    };
    let (mut of_clutter, mut sum_ms) = (Vec::new(), 0.0);
    for (number, scene) in scenes.into_iter().enumerate() {
        views.kinds.push(SceneSampler::kind_of(number) as u32);
        statistics.n_hidden += scene.n_hidden;
        statistics.pictures.extend(scene.picture);
        sum_ms += scene.describe_ms;
        for category in scene.visible {
            statistics.n_visible[category as usize] += 1;
        }
        for category in scene.parts {
            statistics.n_parts[category as usize] += 1;
        }
        for (category, descriptors) in scene.found {
            views.table.labels.push(LabelledView {
                category,
                instance: None,
            });
            let name = &views.table.categories[category as usize];
            views.table.files.push(format!("scene-{number}/{name}"));
            views.scenes.push(number);
            views.descriptions.push(descriptors);
        }
        for descriptors in scene.clutter {
            views.scenes_of_clutter.push(number);
            of_clutter.push(descriptors);
        }
        for reason in scene.left_out {
            views.table.omissions.add(1, || reason);
        }
    }
    views.descriptions.extend(of_clutter);
    views.table.describe_ms = sum_ms / views.descriptions.len().max(1) as f64;
    SceneViews {
        statistics,
        ..views
    }
}

#[cfg(test)]
mod tests;
