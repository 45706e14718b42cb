//! Overlap matrix: pixels shared by objects and hypotheses.

use super::{FIRST_OBJECT_LABEL, HYPOTHESIS_PIXELS_MIN};
use std::collections::BTreeMap;
use tracking::{AssignmentBuffers, assign};

/// Pixel counts of each object, each hypothesis, and each pair, over pixels with a valid label.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Overlaps {
    /// Labels of the ground-truth objects, ascending.
    labels: Vec<u16>,
    /// Numbers of the scored hypotheses, ascending.
    numbers: Vec<u16>,
    of_object: Vec<usize>,
    of_hypothesis: Vec<usize>,
    /// Number of pixels shared by each object and hypothesis. *Shape*: `n_objects x n_hypotheses`,
    /// row-major.
    shared: Vec<usize>,
}

impl Overlaps {
    /// Counts the pixels of two label images. `hypothesis_of` is the number of each pixel's
    /// hypothesis, 0 for none; `label_of` its label, 0 for invalid, below 10 for background.
    /// Hypotheses with fewer than 100 valid pixels are left out.
    ///
    /// # Panics
    /// If the images differ in size.
    pub fn count(hypothesis_of: &[u16], label_of: &[u16]) -> Self {
        assert_eq!(
            hypothesis_of.len(),
            label_of.len(),
            "result and truth must be of the same image"
        );
        let pairs = || {
            let pairs = hypothesis_of.iter().copied().zip(label_of.iter().copied());
            pairs.filter(|&(_, label)| label != 0)
        };
        let mut sizes = pixels_of_each(pairs().map(|(number, _)| number));
        sizes.retain(|&number, n_pixels| number != 0 && *n_pixels >= HYPOTHESIS_PIXELS_MIN);
        let mut objects = pixels_of_each(pairs().map(|(_, label)| label));
        objects.retain(|&label, _| label >= FIRST_OBJECT_LABEL);
        let (labels, of_object): (Vec<_>, Vec<_>) = objects.into_iter().unzip();
        let (numbers, of_hypothesis): (Vec<_>, Vec<_>) = sizes.into_iter().unzip();
        let mut shared = vec![0; labels.len() * numbers.len()];
        for (number, label) in pairs() {
            let object = labels.binary_search(&label);
            if let (Ok(object), Ok(hypothesis)) = (object, numbers.binary_search(&number)) {
                shared[object * numbers.len() + hypothesis] += 1;
            }
        }
        Self {
            labels,
            numbers,
            of_object,
            of_hypothesis,
            shared,
        }
    }

    /// Labels of the objects, ascending; their positions are the object indices.
    pub fn labels(&self) -> &[u16] {
        &self.labels
    }

    /// Numbers of the scored hypotheses, ascending; their positions are the hypothesis indices.
    pub fn numbers(&self) -> &[u16] {
        &self.numbers
    }

    /// Number of pixels of each ground-truth object.
    pub(super) fn of_object(&self) -> &[usize] {
        &self.of_object
    }

    /// Number of pixels of each hypothesis.
    pub(super) fn of_hypothesis(&self) -> &[usize] {
        &self.of_hypothesis
    }

    /// Number of pixels that an object shares with each hypothesis.
    pub(super) fn row(&self, object: usize) -> &[usize] {
        let n = self.numbers.len();
        &self.shared[object * n..(object + 1) * n]
    }

    /// Intersection over union of an object and a hypothesis.
    pub(super) fn ratio(&self, object: usize, hypothesis: usize) -> f64 {
        let shared = self.row(object)[hypothesis];
        let union = self.of_object[object] + self.of_hypothesis[hypothesis] - shared;
        shared as f64 / union as f64
    }

    /// F-measure (Dice coefficient) of an object and a hypothesis.
    pub(super) fn f_measure(&self, object: usize, hypothesis: usize) -> f64 {
        let sizes = self.of_object[object] + self.of_hypothesis[hypothesis];
        2.0 * self.row(object)[hypothesis] as f64 / sizes as f64
    }

    /// Optimal one-to-one matching: hypothesis index of each object for the greatest sum of
    /// F-measures; `None` for an unmatched object.
    pub fn matches(&self) -> Vec<Option<usize>> {
        let n = self.numbers.len();
        if n == 0 {
            return vec![None; self.labels.len()];
        }
        let pairs = (0..self.labels.len()).flat_map(|object| (0..n).map(move |h| (object, h)));
        let costs: Vec<f64> = pairs
            .map(|(object, hypothesis)| 1.0 - self.f_measure(object, hypothesis))
            .collect();
        assign(&costs, n, 1.0, &mut AssignmentBuffers::default()).to_vec()
    }
}

fn pixels_of_each(values: impl Iterator<Item = u16>) -> BTreeMap<u16, usize> {
    let mut counts = vec![0; 1 << 16];
    for value in values {
        counts[usize::from(value)] += 1;
    }
    let values = (0..=u16::MAX).zip(counts);
    values.filter(|&(_, n_pixels)| n_pixels > 0).collect()
}
