//! Metric coordinates in a finite number of bins.

use super::soft_bins::SoftBins;

/// Distance from the middle at which half of the bins of a side are used, metres.
/// Bins are finest in the middle, where small objects are, and reach half a metre
/// to both sides; what is farther counts for the last.
const HALF_WAY_M: f32 = 0.03;

/// Where coordinates lie on a side of `bins`: a coordinate `x` is brought to
/// `x / (|x| + 30 mm)`, which is from -1 to 1.
pub(super) fn place(coordinate_m: f32, middle_m: f32, bins: SoftBins) -> (u32, f32) {
    let x = coordinate_m - middle_m;
    bins.place(0.5 + 0.5 * x / (x.abs() + HALF_WAY_M))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_odd_about_the_middle_and_rise_to_the_last_bin() {
        let at = |x: f32| {
            let (bin, share) = place(x, 0.1, SoftBins::new(16));
            bin as f32 + share
        };
        assert!((at(0.1) - 7.5).abs() < 1e-6);
        assert!((at(0.13) - 11.5).abs() < 1e-5);
        assert!((at(0.07) - 3.5).abs() < 1e-5);
        assert!(at(0.4) > at(0.3) && at(9.0) <= 15.0);
    }
}
