//! Segmentation metrics: agreement of hypotheses with labelled objects.
//!
//! Labels: 0 is invalid and ignored, 1 to 9 are the table and other background, from 10 on each
//! label is an object, so separately labelled parts count as separate objects. Hypotheses with
//! fewer than 100 valid pixels are ignored.

mod overlaps;

pub use overlaps::Overlaps;

use serde::Serialize;

/// Smallest label of an object; smaller labels are background.
pub const FIRST_OBJECT_LABEL: u16 = 10;

/// Minimum number of valid pixels of a scored hypothesis. Chosen; part of the metric definition.
pub const HYPOTHESIS_PIXELS_MIN: usize = 100;

/// F-measure from which an object counts as found in `f75`. Part of the metric definition.
const FINE_MATCH_F_MEASURE: f64 = 0.75;

/// Segmentation scores of one scene, or means over several, as fractions.
///
/// Overlap is intersection over union (`IoU`) of the pixels of an object and a hypothesis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct SegmentationScore {
    /// Number of labelled objects; summed over several scenes.
    pub n_objects: usize,
    /// Number of hypotheses; summed over several scenes.
    pub n_hypotheses: usize,
    /// Weighted overlap (`WOv`): mean best `IoU` over the objects, weighted by the objects' pixels
    /// (Silberman et al. 2012, Stein et al. 2014).
    pub wov: f64,
    /// Unweighted overlap (`UOv`): mean best `IoU` over the objects.
    pub uov: f64,
    /// Over-segmentation: share of the objects' pixels outside the hypothesis
    /// that covers most of the object (Richtsfeld et al. 2012).
    pub fos: f64,
    /// Under-segmentation: pixels of the best covering hypotheses outside their object, over the
    /// objects' pixels; may exceed 1 (Richtsfeld et al. 2012).
    pub fus: f64,
    /// Precision at `IoU` 0.5: share of the hypotheses that match an object.
    pub p50: f64,
    /// Recall at `IoU` 0.5: share of the objects that are matched.
    pub r50: f64,
    /// F-measure at `IoU` 0.5: harmonic mean of `p50` and `r50`.
    pub f50: f64,
    /// Overlap precision: common pixels of objects and their hypotheses, matched one to one for
    /// the greatest sum of F-measures, over the pixels of all hypotheses (Dave et al. 2019, Xie
    /// et al. 2020).
    pub o_p: f64,
    /// Overlap recall: the matched pixels over the pixels of all objects.
    pub o_r: f64,
    /// Overlap F-measure: harmonic mean of `o_p` and `o_r`.
    pub o_f: f64,
    /// Share of the objects matched with an F-measure of at least 0.75.
    pub f75: f64,
}

/// Names of the measures, in the order of [`SegmentationScore::values`].
pub const MEASURE_NAMES: [&str; 11] = [
    "wov", "uov", "fos", "fus", "p50", "r50", "f50", "o_p", "o_r", "o_f", "f75",
];

/// Meanings of the measures in a few words, in the order of [`MEASURE_NAMES`].
pub const MEASURE_MEANINGS: [&str; MEASURE_NAMES.len()] = [
    "mean best IoU of the objects, weighted by their pixels",
    "the same with equal weights",
    "over-segmentation (0 is best)",
    "under-segmentation (0 is best)",
    "precision at an IoU above 0.5",
    "recall at that IoU",
    "their F-measure",
    "overlap precision of a one-to-one matching",
    "its recall",
    "their F-measure",
    "share of the objects matched with an F-measure of at least 0.75",
];

impl SegmentationScore {
    /// Metric values in the order of [`MEASURE_NAMES`].
    pub fn values(&self) -> [f64; MEASURE_NAMES.len()] {
        [
            self.wov, self.uov, self.fos, self.fus, self.p50, self.r50, self.f50, self.o_p,
            self.o_r, self.o_f, self.f75,
        ]
    }

    fn from_values(n_objects: usize, n_hypotheses: usize, values: [f64; 11]) -> Self {
        let [wov, uov, fos, fus, p50, r50, f50, o_p, o_r, o_f, f75] = values;
        Self {
            n_objects,
            n_hypotheses,
            wov,
            uov,
            fos,
            fus,
            p50,
            r50,
            f50,
            o_p,
            o_r,
            o_f,
            f75,
        }
    }

    /// Means over scenes with equal weights, and sums of the counts; `None` without scenes.
    pub fn mean<'a>(scores: impl IntoIterator<Item = &'a Self>) -> Option<Self> {
        let (mut n_scenes, mut n_objects, mut n_hypotheses) = (0_u32, 0, 0);
        let mut sums = [0.0; MEASURE_NAMES.len()];
        for score in scores {
            n_scenes += 1;
            n_objects += score.n_objects;
            n_hypotheses += score.n_hypotheses;
            for (sum, value) in sums.iter_mut().zip(score.values()) {
                *sum += value;
            }
        }
        let means = sums.map(|sum| sum / f64::from(n_scenes));
        (n_scenes > 0).then(|| Self::from_values(n_objects, n_hypotheses, means))
    }
}

/// Scores a scene; `None` for a scene without objects.
pub fn score(overlaps: &Overlaps) -> Option<SegmentationScore> {
    let (n_objects, n_hypotheses) = (overlaps.labels().len(), overlaps.numbers().len());
    if n_objects == 0 {
        return None;
    }
    let mut score = SegmentationScore {
        n_objects,
        n_hypotheses,
        ..SegmentationScore::default()
    };
    best_overlaps(overlaps, &mut score);
    matches_above_one_half(overlaps, &mut score);
    matched_overlaps(overlaps, &mut score);
    Some(score)
}

/// Measures over the best hypothesis of each object: `WOv`, `UOv`, Fos, Fus.
fn best_overlaps(overlaps: &Overlaps, score: &mut SegmentationScore) {
    let n_hypotheses = score.n_hypotheses;
    let total = overlaps.of_object().iter().sum::<usize>() as f64;
    let (mut n_covered, mut n_outside) = (0, 0);
    for (object, &size) in overlaps.of_object().iter().enumerate() {
        let ratios = (0..n_hypotheses).map(|hypothesis| overlaps.ratio(object, hypothesis));
        let best = ratios.fold(0.0, f64::max);
        score.wov += best * size as f64 / total;
        score.uov += best / score.n_objects as f64;
        // Ties go to the first hypothesis.
        let row = overlaps.row(object);
        let largest = (0..n_hypotheses).rev().max_by_key(|&h| row[h]);
        if let Some(largest) = largest.filter(|&h| row[h] > 0) {
            n_covered += row[largest];
            n_outside += overlaps.of_hypothesis()[largest] - row[largest];
        }
    }
    score.fos = 1.0 - n_covered as f64 / total;
    score.fus = n_outside as f64 / total;
}

/// Precision, recall and F-measure at `IoU` 0.5; above one half, matches are unique.
fn matches_above_one_half(overlaps: &Overlaps, score: &mut SegmentationScore) {
    let pairs = (0..score.n_objects).flat_map(|o| (0..score.n_hypotheses).map(move |h| (o, h)));
    let n_hits = pairs.filter(|&(o, h)| overlaps.ratio(o, h) > 0.5).count() as f64;
    score.p50 = if score.n_hypotheses == 0 {
        1.0
    } else {
        n_hits / score.n_hypotheses as f64
    };
    score.r50 = n_hits / score.n_objects as f64;
    score.f50 = 2.0 * n_hits / (score.n_hypotheses + score.n_objects) as f64;
}

/// Measures over the one-to-one matching with the greatest sum of F-measures.
fn matched_overlaps(overlaps: &Overlaps, score: &mut SegmentationScore) {
    let (mut n_common, mut n_fine) = (0, 0_usize);
    for (object, matched) in overlaps.matches().into_iter().enumerate() {
        let Some(hypothesis) = matched else { continue };
        n_common += overlaps.row(object)[hypothesis];
        n_fine += usize::from(overlaps.f_measure(object, hypothesis) >= FINE_MATCH_F_MEASURE);
    }
    score.f75 = n_fine as f64 / score.n_objects as f64;
    if score.n_hypotheses == 0 {
        score.o_p = 1.0;
        return;
    }
    let n_common = n_common as f64;
    score.o_p = n_common / overlaps.of_hypothesis().iter().sum::<usize>() as f64;
    score.o_r = n_common / overlaps.of_object().iter().sum::<usize>() as f64;
    score.o_f = 2.0 * score.o_p * score.o_r / (score.o_p + score.o_r).max(1e-12);
}

#[cfg(test)]
mod tests;
