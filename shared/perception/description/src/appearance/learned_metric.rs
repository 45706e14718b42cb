//! Learned metric of appearance descriptors: whitening within categories, and principal components.
//!
//! Two mugs differ in some values more than in others. Distances are taken after a linear map
//! `(S + λ)^(-1/2)`, where `S` is the scatter of the differences between objects of one category,
//! so that what varies within categories counts less than what does not. Colours are not mapped but
//! scaled, since generated objects of a category have any colour. The principal components of what
//! results, of the largest variance first, are the values that are compared.
//!
//! Scatter and components are symmetrised over all axis hypotheses and mirror images, so that these
//! act on the components as they do on a stored descriptor: by exchanging values and their signs.
//!
//! *Source*: relevant component analysis, Bar-Hillel, Hertz, Shental and Weinshall, "Learning a
//! Mahalanobis metric from equivalence constraints", Journal of Machine Learning Research 6, 2005.

use super::axis_hypotheses::{half_turn_odd_values, mirror_odd_values};
use super::trained_metric::{N_VALUES, QUARTER_TURN, SIGN_CLASSES, UNIT, WEIGHTS};
use std::sync::LazyLock;

/// Learned metric: a linear map of stored descriptors with upright axes.
#[derive(Debug)]
pub struct LearnedMetric {
    blocks: Vec<SignClassBlock>,
}

/// Map between the values of one sign class.
#[derive(Debug)]
struct SignClassBlock {
    /// Places of the values in a stored descriptor.
    sources: Vec<usize>,
    /// Places of the mapped values.
    targets: Vec<usize>,
    /// Weights of a source for all targets, one source after another.
    weights: Vec<f32>,
}

impl LearnedMetric {
    /// Number of mapped values.
    pub const DIMENSION: usize = N_VALUES;

    /// Maps a stored descriptor to [`DIMENSION`](Self::DIMENSION) values, of the largest variance
    /// first, whose Euclidean distance is the learned one. They replace the content of `mapped`.
    /// Missing values are taken as 0.
    pub fn map(stored: &[f32], mapped: &mut Vec<f32>) {
        static METRIC: LazyLock<LearnedMetric> = LazyLock::new(LearnedMetric::trained);
        mapped.clear();
        mapped.resize(N_VALUES, 0.0);
        for block in &METRIC.blocks {
            block.apply(stored, mapped);
        }
    }

    /// Mapped descriptor in the second axis hypothesis: after a quarter turn about the vertical.
    pub fn quarter_turn(mapped: &[f32]) -> Vec<f32> {
        let value = |&(source, sign): &(u16, i8)| {
            let value = mapped.get(usize::from(source)).copied().unwrap_or(0.0);
            f32::from(sign) * value
        };
        QUARTER_TURN.iter().map(value).collect()
    }

    /// Mapped values that change their sign by a half turn. True for such a value.
    pub fn half_turn_odd_values() -> &'static [bool] {
        static VALUES: LazyLock<Vec<bool>> = LazyLock::new(|| values_of(|class| class & 2 != 0));
        &VALUES
    }

    /// Mapped values that change their sign when the object is mirrored. True for such a value.
    pub fn mirror_odd_values() -> &'static [bool] {
        static VALUES: LazyLock<Vec<bool>> = LazyLock::new(|| values_of(|class| class & 1 != 0));
        &VALUES
    }

    /// Map of the trained table.
    fn trained() -> Self {
        let (half_turn, mirror) = (half_turn_odd_values(), mirror_odd_values());
        let classes = half_turn.into_iter().zip(mirror);
        let classes = classes.map(|(half, mirror)| 2 * u8::from(half) + u8::from(mirror));
        let classes: Vec<u8> = classes.collect();
        let block = |class| SignClassBlock::trained(class, &classes);
        Self {
            blocks: (0..4).map(block).collect(),
        }
    }
}

fn values_of(is_odd: impl Fn(u8) -> bool) -> Vec<bool> {
    SIGN_CLASSES.iter().map(|class| is_odd(*class)).collect()
}

impl SignClassBlock {
    /// Block of a sign class, given those of the stored values.
    fn trained(class: u8, of_stored: &[u8]) -> Self {
        let places = |classes: &[u8]| -> Vec<usize> {
            let is_of_class = |place: &usize| classes[*place] == class;
            (0..classes.len()).filter(is_of_class).collect()
        };
        let (sources, targets) = (places(of_stored), places(&SIGN_CLASSES));
        let mut weights = Vec::with_capacity(sources.len() * targets.len());
        for source in 0..sources.len() {
            let weight = |&target: &usize| WEIGHTS[target].get(source).copied().unwrap_or(0);
            weights.extend(
                targets
                    .iter()
                    .map(|target| UNIT * f32::from(weight(target))),
            );
        }
        Self {
            sources,
            targets,
            weights,
        }
    }

    fn apply(&self, stored: &[f32], mapped: &mut [f32]) {
        let mut sums = [0.0; N_VALUES];
        let sums = &mut sums[..self.targets.len()];
        let rows = self.weights.chunks_exact(self.targets.len().max(1));
        for (&source, weights) in self.sources.iter().zip(rows) {
            let value = stored.get(source).copied().unwrap_or(0.0);
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += value * weight;
            }
        }
        for (&target, sum) in self.targets.iter().zip(sums) {
            mapped[target] = *sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AppearanceDescriptor, AxesKind};
    use random::Random;

    const DIMENSION: usize = AppearanceDescriptor::DIMENSION;

    fn descriptor() -> Vec<f32> {
        let mut random = Random::from_seed(3);
        let value = |_| random.between(-0.2, 0.2) as f32;
        (0..DIMENSION).map(value).collect()
    }

    fn mapped(stored: &[f32]) -> Vec<f32> {
        let mut mapped = Vec::new();
        LearnedMetric::map(stored, &mut mapped);
        mapped
    }

    fn with_signs(values: &[f32], is_odd: &[bool]) -> Vec<f32> {
        let values = values.iter().zip(is_odd);
        values.map(|(v, odd)| if *odd { -v } else { *v }).collect()
    }

    fn assert_near(a: &[f32], b: &[f32]) {
        assert_eq!(a.len(), b.len());
        for (place, (a, b)) in a.iter().zip(b).enumerate() {
            assert!((a - b).abs() < 2e-3, "value {place}: {a} {b}");
        }
    }

    #[test]
    fn table_fits_the_descriptor() {
        let metric = LearnedMetric::trained();
        let n_sources: usize = metric.blocks.iter().map(|block| block.sources.len()).sum();
        assert_eq!(n_sources, DIMENSION);
        for block in &metric.blocks {
            for target in &block.targets {
                assert_eq!(WEIGHTS[*target].len(), block.sources.len());
            }
        }
    }

    #[test]
    fn axis_hypotheses_and_mirror_image_act_on_mapped_values() {
        let stored = descriptor();
        let values = mapped(&stored);
        let turned = |hypothesis| {
            let turned =
                AppearanceDescriptor::axis_hypothesis_of(&stored, AxesKind::Upright, hypothesis);
            mapped(&turned)
        };
        let quarter = LearnedMetric::quarter_turn(&values);
        assert_near(&turned(1), &quarter);
        let half_turn = LearnedMetric::half_turn_odd_values();
        assert_near(&turned(2), &with_signs(&values, half_turn));
        assert_near(&turned(3), &with_signs(&quarter, half_turn));
        let mirrored = with_signs(&stored, AppearanceDescriptor::mirror_odd_values());
        let expected = with_signs(&values, LearnedMetric::mirror_odd_values());
        assert_near(&mapped(&mirrored), &expected);
    }

    #[test]
    fn missing_values_are_zero() {
        let stored = descriptor();
        let mut padded = stored[..100].to_vec();
        padded.resize(DIMENSION, 0.0);
        assert_eq!(mapped(&stored[..100]), mapped(&padded));
        assert_eq!(mapped(&[]), [0.0; N_VALUES]);
    }
}
