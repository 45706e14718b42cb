//! Storage order of descriptor values, by expected variance.

use super::color_histograms::CHROMATICITY_SIDE;
use super::cosine_transform::frequencies;
use super::{COLOR_OFFSET, DIMENSION, N_CHROMATICITIES, PROFILE_OFFSET, SIZE_OFFSET};

/// Rank offset of odd frequencies: most objects are nearly symmetric.
const ODD_RANK_OFFSET: usize = 8;

/// Rank of the cells of nearly grey chromaticity, the most frequent one.
const GREY_RANK: usize = 8;

/// Rank of the lightness values in the order of expected variance.
const LIGHTNESS_RANK: usize = 18;

/// Rank of the values of the box profile in the order of expected variance.
const PROFILE_RANK: usize = 14;

/// Permutation from stored to computed values, in order of expected variance, so that a
/// nearest-neighbour search can prune views by their first values. The sides of the box
/// come first, then the low frequencies, even ones earlier, with the colours among them.
///
/// The variances over views of generated and of scanned objects decrease in nearly this
/// order.
pub(super) fn storage_order() -> Vec<usize> {
    let mut places: Vec<usize> = (0..DIMENSION).collect();
    let ranks: Vec<usize> = ranks().collect();
    places.sort_by_key(|&place| ranks[place]);
    places
}

fn ranks() -> impl Iterator<Item = usize> {
    let of_frequencies = |(k, l): (usize, usize)| {
        let is_odd = k % 2 == 1 || l % 2 == 1;
        2 * (k + l) + if is_odd { ODD_RANK_OFFSET } else { 0 }
    };
    let of_projections = (0..3).flat_map(move |_| frequencies().map(of_frequencies));
    let of_sides = [0; COLOR_OFFSET - SIZE_OFFSET].into_iter();
    let of_chromaticities = (0..N_CHROMATICITIES).map(|cell| {
        let (red, green) = (cell / CHROMATICITY_SIDE, cell % CHROMATICITY_SIDE);
        GREY_RANK + 2 * red.abs_diff(3).max(2 * green.abs_diff(3))
    });
    let of_lightnesses = std::iter::repeat_n(
        LIGHTNESS_RANK,
        PROFILE_OFFSET - COLOR_OFFSET - N_CHROMATICITIES,
    );
    let of_profile = std::iter::repeat_n(PROFILE_RANK, DIMENSION - PROFILE_OFFSET);
    of_projections
        .chain(of_sides)
        .chain(of_chromaticities)
        .chain(of_lightnesses)
        .chain(of_profile)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn storage_order_is_a_permutation_with_the_sides_first() {
        let places = storage_order();
        assert!((SIZE_OFFSET..COLOR_OFFSET).all(|side| places[..6].contains(&side)));
        let mut sorted = places.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..DIMENSION));
        assert_eq!(ranks().count(), DIMENSION);
    }
}
