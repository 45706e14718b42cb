//! Examples for the learned metric: descriptors of views in all symmetries, with their objects.

use super::recognition::RecognitionMethod;
use super::view_selection::ViewSelection;
use crate::arguments::AblationVariant;
use command_line::Output;
use description::AppearanceDescriptor;
use service::Failure;
use std::collections::BTreeMap;
use std::path::Path;

/// Number of bins of GOOD, which the project's descriptor has none of.
const N_BINS: usize = 15;

/// Descriptors with their objects, row after row.
#[derive(Debug, Default)]
pub(crate) struct MetricExamples {
    /// Values of all rows: the descriptor's, the number of the object and that of its category.
    pub(crate) values: Vec<f32>,
    /// Number of rows: eight for each view, each axis hypothesis with its mirror image.
    pub(crate) n_rows: usize,
    objects: BTreeMap<(u32, Option<u32>), usize>,
}

impl MetricExamples {
    /// Names of the values of a row: the part of the descriptor and its place, then the object.
    pub(crate) fn names() -> Vec<String> {
        let parts = AppearanceDescriptor::value_parts();
        let parts = parts.iter().enumerate();
        let names = parts.map(|(place, part)| format!("{part} {place}"));
        names.chain(["object".to_owned()]).collect()
    }

    /// Adds the views of a data set whose objects and upward axis are known.
    ///
    /// # Errors
    /// When the data set cannot be read, or does not tell them.
    pub(crate) fn add(&mut self, dataset: &Path, output: &Output) -> Result<(), Failure> {
        let method = RecognitionMethod::of_ablation(AblationVariant::Ours, N_BINS);
        let selection = ViewSelection::open(dataset, None)?;
        let (table, mut described) = selection.describe_by(&[method], output)?;
        let is_told = table.labels.iter().all(|label| label.instance.is_some());
        if !is_told || !table.is_up_known {
            let dataset = dataset.display();
            return Err(Failure::usage(format!(
                "the data set {dataset} does not tell which views show the same object, or which \
                 way is up; simulate views with: tabula simulate views"
            )));
        }
        let is_odd = AppearanceDescriptor::mirror_odd_values();
        for (label, hypotheses) in table.labels.iter().zip(described.remove(0)) {
            let next = self.objects.len();
            let key = (label.category, label.instance);
            let object = *self.objects.entry(key).or_insert(next);
            for hypothesis in &hypotheses {
                let mirrored = hypothesis.iter().zip(is_odd);
                let mirrored = mirrored.map(|(value, odd)| if *odd { -value } else { *value });
                self.add_row(hypothesis.iter().copied(), object, label.category);
                self.add_row(mirrored, object, label.category);
            }
        }
        Ok(())
    }

    fn add_row(&mut self, values: impl Iterator<Item = f32>, object: usize, category: u32) {
        self.values.extend(values);
        self.values.extend([object as f32, category as f32]);
        self.n_rows += 1;
    }
}
