//! Counts of pixels that objects and hypotheses share.

use super::{FIRST_OBJECT_LABEL, HYPOTHESIS_PIXELS_MIN};
use std::collections::BTreeMap;
use tracking::{AssignmentBuffers, assign};

/// Pixels of each object, of each hypothesis, and of both. Only pixels with a
/// valid label count.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Overlaps {
    /// The objects' labels, ascending.
    labels: Vec<u16>,
    /// The hypotheses' numbers, ascending; only those that are large enough.
    numbers: Vec<u16>,
    of_object: Vec<usize>,
    of_hypothesis: Vec<usize>,
    /// Row by row: objects x hypotheses.
    shared: Vec<usize>,
}

impl Overlaps {
    /// Counts. `hypothesis_of` is the number of each pixel's hypothesis, 0 for
    /// none; `label_of` its label, 0 for invalid, below 10 for what is no
    /// object. Hypotheses with fewer than 100 valid pixels are left out.
    ///
    /// # Panics
    /// When the two images differ in size.
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

    /// The objects' labels, ascending; their places are the objects' indices.
    pub fn labels(&self) -> &[u16] {
        &self.labels
    }

    /// The numbers of the hypotheses that count, ascending; their places are
    /// the hypotheses' indices.
    pub fn numbers(&self) -> &[u16] {
        &self.numbers
    }

    /// Pixels of each object.
    pub(super) fn of_object(&self) -> &[usize] {
        &self.of_object
    }

    /// Pixels of each hypothesis.
    pub(super) fn of_hypothesis(&self) -> &[usize] {
        &self.of_hypothesis
    }

    /// Pixels that an object shares with each hypothesis.
    pub(super) fn row(&self, object: usize) -> &[usize] {
        let n = self.numbers.len();
        &self.shared[object * n..(object + 1) * n]
    }

    /// Common pixels over all pixels of an object and a hypothesis.
    pub(super) fn ratio(&self, object: usize, hypothesis: usize) -> f64 {
        let shared = self.row(object)[hypothesis];
        let union = self.of_object[object] + self.of_hypothesis[hypothesis] - shared;
        shared as f64 / union as f64
    }

    /// F-measure of an object and a hypothesis.
    pub(super) fn f_measure(&self, object: usize, hypothesis: usize) -> f64 {
        let sizes = self.of_object[object] + self.of_hypothesis[hypothesis];
        2.0 * self.row(object)[hypothesis] as f64 / sizes as f64
    }

    /// The hypothesis of each object, by index, so that the sum of F-measures
    /// is greatest; `None` for an object that is left without.
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
