//! Scores of a segmentation against labels, as the peers are scored in
//! `reference/peers/seg_score.py`.

/// Segments with fewer pixels are ignored.
const SEGMENT_PIXELS_MIN: usize = 100;

/// Scores of one scene, each from 0 to 1 but `fus`.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Score {
    /// Labelled objects.
    pub(crate) n_objects: usize,
    /// Found segments.
    pub(crate) n_segments: usize,
    /// Overlap weighted by size (Stein et al. 2014).
    pub(crate) wov: f64,
    /// Mean overlap.
    pub(crate) uov: f64,
    /// Over-segmentation (Richtsfeld et al. 2012).
    pub(crate) fos: f64,
    /// Under-segmentation (Richtsfeld et al. 2012).
    pub(crate) fus: f64,
    /// Segments that are an object with an overlap above one half.
    pub(crate) p50: f64,
    /// Objects that are found with an overlap above one half.
    pub(crate) r50: f64,
    /// Harmonic mean of the two.
    pub(crate) f50: f64,
    /// Objects found with an F-measure of at least 0.75.
    pub(crate) f75: f64,
}

/// Counts of pixels per object, per segment, and of both.
struct Overlaps {
    of_object: Vec<usize>,
    of_segment: Vec<usize>,
    shared: Vec<Vec<usize>>,
}

/// Scores `segment_of` (0: none) against `label_of` (0: invalid, below 10:
/// table). `None` for a scene without objects.
pub(crate) fn score(segment_of: &[u32], label_of: &[u32]) -> Option<Score> {
    let Overlaps {
        of_object,
        of_segment,
        shared,
    } = overlaps(segment_of, label_of);
    let total: usize = of_object.iter().sum();
    if of_object.is_empty() {
        return None;
    }
    let mut score = Score {
        n_objects: of_object.len(),
        n_segments: of_segment.len(),
        ..Score::default()
    };
    let (mut n_hits, mut n_fine) = (0, 0);
    for (object, row) in shared.iter().enumerate() {
        let size = of_object[object];
        let union = |segment: usize| size + of_segment[segment] - row[segment];
        let ratio = |segment: usize| row[segment] as f64 / union(segment) as f64;
        let best_overlap = (0..row.len()).map(ratio).fold(0.0, f64::max);
        let weight = size as f64 / total as f64;
        score.wov += weight * best_overlap;
        score.uov += best_overlap / of_object.len() as f64;
        n_hits += (0..row.len())
            .filter(|&segment| ratio(segment) > 0.5)
            .count();
        // F = 2 IoU / (1 + IoU); above 2/3 at most one segment matches an object.
        n_fine += usize::from(2.0 * best_overlap / (1.0 + best_overlap) >= 0.75);
        let best = (0..row.len()).rev().max_by_key(|&segment| row[segment]);
        if let Some(best) = best.filter(|&best| row[best] > 0) {
            score.fos -= row[best] as f64 / total as f64;
            score.fus += (of_segment[best] - row[best]) as f64 / total as f64;
        }
    }
    score.fos += 1.0;
    score.p50 = if of_segment.is_empty() {
        1.0
    } else {
        f64::from(n_hits as u32) / of_segment.len() as f64
    };
    score.r50 = n_hits as f64 / of_object.len() as f64;
    score.f50 = 2.0 * n_hits as f64 / (of_segment.len() + of_object.len()) as f64;
    score.f75 = n_fine as f64 / of_object.len() as f64;
    Some(score)
}

fn overlaps(segment_of: &[u32], label_of: &[u32]) -> Overlaps {
    let valid = || {
        segment_of
            .iter()
            .zip(label_of)
            .filter(|&(_, &label)| label != 0)
    };
    let mut objects: Vec<u32> = valid()
        .map(|(_, &label)| label)
        .filter(|&l| l >= 10)
        .collect();
    let mut segments: Vec<u32> = valid()
        .map(|(&segment, _)| segment)
        .filter(|&s| s > 0)
        .collect();
    let distinct = |values: &mut Vec<u32>| {
        values.sort_unstable();
        values.dedup();
    };
    let all = segments.clone();
    distinct(&mut objects);
    distinct(&mut segments);
    segments.retain(|s| all.iter().filter(|&other| other == s).count() >= SEGMENT_PIXELS_MIN);
    let mut result = Overlaps {
        of_object: vec![0; objects.len()],
        of_segment: vec![0; segments.len()],
        shared: vec![vec![0; segments.len()]; objects.len()],
    };
    for (&segment, &label) in valid() {
        let segment = segments.binary_search(&segment).ok();
        let object = objects.binary_search(&label).ok();
        if let Some(object) = object {
            result.of_object[object] += 1;
        }
        if let Some(segment) = segment {
            result.of_segment[segment] += 1;
        }
        if let (Some(object), Some(segment)) = (object, segment) {
            result.shared[object][segment] += 1;
        }
    }
    result
}
