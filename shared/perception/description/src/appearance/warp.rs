//! Softsign warp of metric coordinates to histogram bins.

use super::soft_bins::SoftBins;

/// Scale of the warp: half of the bins of a side lie within this distance from the
/// middle, metres. Bins are finest in the middle, where small objects lie; half a metre
/// is the last bin on either side. Chosen.
const WARP_SCALE_M: f32 = 0.03;

/// Bin and interpolation weight of a coordinate after the warp `x / (|x| + 30 mm)`,
/// which ranges from -1 to 1.
pub(super) fn warped_bin(coordinate_m: f32, middle_m: f32, bins: SoftBins) -> (u32, f32) {
    let x = coordinate_m - middle_m;
    bins.locate(0.5 + 0.5 * x / (x.abs() + WARP_SCALE_M))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_warp_is_odd_and_monotonic() {
        let at = |x: f32| {
            let (bin, share) = warped_bin(x, 0.1, SoftBins::new(16));
            bin as f32 + share
        };
        assert!((at(0.1) - 7.5).abs() < 1e-6);
        assert!((at(0.13) - 11.5).abs() < 1e-5);
        assert!((at(0.07) - 3.5).abs() < 1e-5);
        assert!(at(0.4) > at(0.3) && at(9.0) <= 15.0);
    }
}
