//! In which order the values of a descriptor stand.

use super::color::CHROMATICITY_SIDE;
use super::cosine_transform::frequencies;
use super::{COLOR_AT, DIMENSION, N_CHROMATICITIES, SIZE_AT};

/// What is added to the rank of frequencies when one of them is odd: most
/// objects look much the same from both sides.
const ODD: usize = 8;
/// Rank of the cells of what is nearly grey, the most frequent colours.
const GREY: usize = 8;
/// Rank of lightness.
const LIGHTNESS: usize = 18;

/// The places of the values, as they are computed, in the order in which they are
/// stored: first what differs most between views, so that a search can pass over
/// most of them by their first values. Those are the sides of the box, then the
/// low frequencies, the even ones earlier, and among them the colours.
///
/// The variances of views of generated objects and of scanned ones fall in nearly
/// this order.
pub(super) fn places() -> Vec<usize> {
    let mut places: Vec<usize> = (0..DIMENSION).collect();
    let ranks: Vec<usize> = ranks().collect();
    places.sort_by_key(|&place| ranks[place]);
    places
}

fn ranks() -> impl Iterator<Item = usize> {
    let of_frequencies = |(k, l): (usize, usize)| {
        let is_odd = k % 2 == 1 || l % 2 == 1;
        2 * (k + l) + if is_odd { ODD } else { 0 }
    };
    let of_projections = (0..3).flat_map(move |_| frequencies().map(of_frequencies));
    let of_sides = [0; COLOR_AT - SIZE_AT].into_iter();
    let of_chromaticities = (0..N_CHROMATICITIES).map(|cell| {
        let (red, green) = (cell / CHROMATICITY_SIDE, cell % CHROMATICITY_SIDE);
        GREY + 2 * red.abs_diff(3).max(2 * green.abs_diff(3))
    });
    let of_lightnesses = std::iter::repeat_n(LIGHTNESS, DIMENSION - COLOR_AT - N_CHROMATICITIES);
    of_projections
        .chain(of_sides)
        .chain(of_chromaticities)
        .chain(of_lightnesses)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_has_one_place_and_the_sides_are_among_the_first() {
        let places = places();
        assert!((SIZE_AT..COLOR_AT).all(|side| places[..6].contains(&side)));
        let mut sorted = places.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..DIMENSION));
        assert_eq!(ranks().count(), DIMENSION);
    }
}
