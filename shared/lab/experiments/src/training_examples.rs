//! `tabula-lab examples`: training examples of the segmentation, from labelled scenes, and of the
//! learned metric, from views.

mod color_augmentation;

use crate::arguments::{ExamplesArguments, TrainedModel};
use crate::evaluate::MetricExamples;
use crate::output_files::write;
use crate::parallel;
use color_augmentation::augment;
use command_line::{Output, progress_bar};
use detection::{
    Config, DetectionInput, EDGE_FEATURE_NAMES, FEATURE_NAMES, ScenePriors, SegmentationExamples,
    Workspace,
};
use evaluation::labelled_scenes::{LabelledScene, LabelledScenes};
use evaluation::segmentation_score::FIRST_OBJECT_LABEL;
use point_cloud::OrganizedCloud;
use random::Random;
use serde::Serialize;
use service::Failure;
use std::path::Path;
use std::process::ExitCode;

/// Report on the examples of the data sets.
#[derive(Debug, Default, Serialize)]
struct ExamplesReport {
    n_scenes: usize,
    n_examples: usize,
    n_positive: usize,
    file: String,
}

/// Report on the examples of the learned metric.
#[derive(Debug, Serialize)]
struct MetricExamplesReport {
    n_examples: usize,
    file: String,
}

/// Examples of one model of the segmentation: features and class of each.
type LabelledFeatures<'e> = Vec<(&'e [f32], bool)>;

/// Writes the examples of some data sets.
///
/// # Errors
/// When a data set cannot be read or has no examples, or the file cannot be written.
pub fn run(arguments: &ExamplesArguments, output: &Output) -> Result<ExitCode, Failure> {
    match arguments.model {
        TrainedModel::EdgeNetwork => write_scene_examples(
            arguments,
            &EDGE_FEATURE_NAMES,
            |examples| {
                let edges = examples.edges.iter();
                edges
                    .map(|edge| (edge.features.as_slice(), edge.is_boundary))
                    .collect()
            },
            output,
        ),
        TrainedModel::RegionMerging => write_scene_examples(
            arguments,
            &FEATURE_NAMES,
            |examples| {
                let pairs = examples.pairs.iter();
                pairs
                    .map(|pair| (pair.features.as_slice(), pair.is_one_object))
                    .collect()
            },
            output,
        ),
        TrainedModel::LearnedMetric => write_metric_examples(arguments, output),
    }
}

/// Writes the examples of all organised scenes of some data sets.
fn write_scene_examples(
    arguments: &ExamplesArguments,
    names: &[&str],
    labelled_features: fn(&SegmentationExamples) -> LabelledFeatures<'_>,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let mut report = ExamplesReport {
        file: arguments.out.display().to_string(),
        ..ExamplesReport::default()
    };
    let mut rows = Vec::new();
    for folder in &arguments.datasets {
        for examples in examples_of_scenes(folder, output)? {
            report.n_scenes += 1;
            for (features, is_positive) in labelled_features(&examples) {
                report.n_examples += 1;
                report.n_positive += usize::from(is_positive);
                let label = f32::from(u8::from(is_positive));
                let row = features.iter().chain([&label]);
                rows.extend(row.flat_map(|value| value.to_le_bytes()));
            }
        }
    }
    if report.n_examples == 0 {
        return Err(Failure::general(
            "the data sets have no objects that touch to learn from; simulate some, for example \
             with: tabula simulate scene --kind clutter",
        ));
    }
    let header = npy_header(names, report.n_examples);
    write(&arguments.out, &[header, rows].concat())?;
    output.answer(&report, || {
        format!(
            "{} examples, {} of them positive, of {} scenes: {}",
            report.n_examples, report.n_positive, report.n_scenes, report.file
        )
    });
    Ok(ExitCode::SUCCESS)
}

/// Writes the descriptors of all views of some data sets.
fn write_metric_examples(
    arguments: &ExamplesArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let mut examples = MetricExamples::default();
    for folder in &arguments.datasets {
        examples.add(folder, output)?;
    }
    let report = MetricExamplesReport {
        n_examples: examples.n_rows,
        file: arguments.out.display().to_string(),
    };
    let names = MetricExamples::names();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let rows = examples.values.iter();
    let rows: Vec<u8> = rows.flat_map(|value| value.to_le_bytes()).collect();
    let header = npy_header(&names, examples.n_rows);
    write(&arguments.out, &[header, rows].concat())?;
    output.answer(&report, || {
        format!("{} examples: {}", report.n_examples, report.file)
    });
    Ok(ExitCode::SUCCESS)
}

/// Examples of each organised scene of a data set.
fn examples_of_scenes(
    folder: &Path,
    output: &Output,
) -> Result<Vec<SegmentationExamples>, Failure> {
    let scenes = LabelledScenes::open(folder).map_err(Failure::usage)?;
    let entries = scenes.entries();
    let bar = progress_bar(entries.len() as u64, "scenes", output);
    let of_scenes = parallel::map(entries.len(), &bar, Workspace::default, |workspace, i| {
        let scene = scenes.read(&entries[i]).map_err(Failure::general)?;
        let is_organised = scene.height > 1;
        let examples = is_organised.then(|| examples_of_scene(scene, i as u64, workspace));
        examples.transpose()
    });
    bar.finish_and_clear();
    of_scenes
        .into_iter()
        .filter_map(Result::transpose)
        .collect()
}

/// Examples of one scene; the seed draws the change of its colours and the edges.
fn examples_of_scene(
    mut scene: LabelledScene,
    seed: u64,
    workspace: &mut Workspace,
) -> Result<SegmentationExamples, Failure> {
    augment(&mut scene.points, scene.width, &mut Random::from_seed(seed));
    let cloud = OrganizedCloud::new(&scene.points, scene.width, scene.height);
    let frame = DetectionInput {
        cloud: cloud.map_err(Failure::general)?,
        up_in_camera: scene.up_in_camera,
        priors: ScenePriors::default(),
    };
    let object = |&label: &u16| (label >= FIRST_OBJECT_LABEL).then_some(label);
    let objects: Vec<Option<u16>> = scene.labels.iter().map(object).collect();
    let config = Config::default();
    let mut random = Random::from_seed(seed);
    let mut examples = SegmentationExamples::default();
    detection::add_examples(
        &frame,
        &config,
        workspace,
        &objects,
        &mut random,
        &mut examples,
    );
    Ok(examples)
}

/// Header of an NPY file (version 1.0) of rows of single-precision features with these names, and
/// the class, 0 or 1, behind them.
fn npy_header(names: &[&str], n_rows: usize) -> Vec<u8> {
    let fields = names.iter().chain([&"class"]);
    let fields: Vec<String> = fields.map(|name| format!("({name:?}, '<f4')")).collect();
    let fields = fields.join(", ");
    let text = format!("{{'descr': [{fields}], 'fortran_order': False, 'shape': ({n_rows},)}}");
    // The rows begin at a multiple of 64 bytes, behind ten bytes, the text and a line feed.
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend((length as u16).to_le_bytes());
    header.extend(format!("{text:<0$}\n", length - 1).bytes());
    header
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn npy_header_tells_its_length_and_the_fields() {
        let header = npy_header(&["height, metres", "the cell's slope"], 7);
        assert_eq!(header.len() % 64, 0);
        assert_eq!(header[8..10], (header.len() as u16 - 10).to_le_bytes());
        let text = str::from_utf8(&header[10..]).unwrap();
        let expected = "{'descr': [(\"height, metres\", '<f4'), (\"the cell's slope\", '<f4'), \
                        (\"class\", '<f4')], 'fortran_order': False, 'shape': (7,)}";
        assert_eq!(text.trim_end(), expected);
        assert!(text.ends_with('\n'));
    }
}
