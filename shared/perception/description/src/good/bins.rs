//! Equal-width bins along one axis, bit-exact with the reference programs.

use crate::projected_points::{Block, LANES};

/// Precision in which a coordinate is shifted to the corner of the support.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rounding {
    /// Single precision, as in the published program, which stores it in a point.
    Single,
    /// Double precision, as in the program of the authors' workspace.
    Double,
}

/// Equal-width bins that divide a support around 0.
///
/// The reference programs find the bin by a division in double precision. A
/// multiplication in single precision gives the same bin except next to an edge, where
/// the division decides; few blocks need it (benchmark `good`).
#[derive(Debug, Clone, Copy)]
pub(super) struct Bins {
    n: u32,
    half_support_m: f64,
    width_m: f64,
    rounding: Rounding,
    /// Number of histogram bins per metre.
    density: f32,
    /// Middle of the support in bins, minus half a bin, which turns rounding to the
    /// nearest bin into rounding down.
    middle: f32,
    /// Distance from the middle of a bin, in bins, above which an edge is near.
    safe: f32,
}

/// Rounding constant 1.5 x 2^23: neighbouring single-precision numbers around it differ
/// by one, so adding it rounds to the nearest integer, which is then in the lowest bits.
const ROUNDING_CONSTANT: f32 = 12_582_912.0;

impl Bins {
    /// Bins, 2 to 64, along a finite support of positive length.
    pub(super) fn new(n: u32, support_m: f64, rounding: Rounding) -> Self {
        let density = (f64::from(n) / support_m) as f32;
        // Four roundings of numbers up to n amount to n 2^-22 bins at most. For
        // subnormal numbers no bound is known, and the division always decides.
        let uncertain = if density.is_normal() {
            n as f32 / 1_048_576.0
        } else {
            1.0
        };
        Self {
            n,
            half_support_m: support_m / 2.0,
            width_m: support_m / f64::from(n),
            rounding,
            density,
            middle: n as f32 / 2.0 - 0.5,
            safe: 0.5 - uncertain,
        }
    }

    /// Bins of x, y and z, the first two multiplied by `sign`, +1 or -1; `n` for a
    /// coordinate outside the support or NaN.
    #[inline]
    pub(super) fn indices(self, block: &Block, sign: f32) -> [[u32; LANES]; 3] {
        let mut bins = [[0; LANES]; 3];
        let mut near_edge = [0; LANES];
        let behind = self.n as f32;
        let axes = [(&block.x, sign), (&block.y, sign), (&block.z, 1.0)];
        for (bins, (coordinates_m, sign)) in bins.iter_mut().zip(axes) {
            let density = sign * self.density;
            for i in 0..LANES {
                let place = coordinates_m[i] * density + self.middle;
                let place = if place < behind { place } else { behind };
                let rounded = place + ROUNDING_CONSTANT;
                let from_middle = (place - (rounded - ROUNDING_CONSTANT)).abs();
                bins[i] = rounded.to_bits().wrapping_sub(ROUNDING_CONSTANT.to_bits());
                near_edge[i] |= u32::from(from_middle > self.safe) | u32::from(place < -self.safe);
            }
        }
        if near_edge.into_iter().fold(0, |any, lane| any | lane) != 0 {
            bins = axes.map(|(axis, sign)| self.by_division(axis, sign));
        }
        bins
    }

    /// Bins by division, as the reference programs compute them. Truncation goes towards
    /// zero, so the first bin extends back by one width.
    #[cold]
    fn by_division(self, coordinates_m: &[f32; LANES], sign: f32) -> [u32; LANES] {
        coordinates_m.map(|coordinate_m| {
            let shifted = f64::from(sign * coordinate_m) + self.half_support_m;
            let shifted = match self.rounding {
                Rounding::Single => f64::from(shifted as f32),
                Rounding::Double => shifted,
            };
            let place = shifted / self.width_m;
            if place > -1.0 && place < f64::from(self.n) {
                place as u32
            } else {
                self.n
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn block(coordinates: [f32; LANES]) -> Block {
        Block {
            x: coordinates,
            y: coordinates,
            z: coordinates,
        }
    }

    /// Bin, which must be equal along each axis.
    fn bin(bins: Bins, coordinate: f32) -> u32 {
        let [x, y, z] = bins.indices(&block([coordinate; LANES]), 1.0);
        assert_eq!((x, y), (y, z));
        x[0]
    }

    #[test]
    fn bins_are_half_open_and_the_first_reaches_back() {
        for rounding in [Rounding::Single, Rounding::Double] {
            let bins = Bins::new(4, 4.0, rounding);
            for (coordinate, expected) in [
                (-2.0, 0),
                (-1.001, 0),
                (-1.0, 1),
                (1.999, 3),
                (2.0, 4),
                (-2.999, 0),
                (-3.0, 4),
                (99.0, 4),
                (f32::NAN, 4),
                (f32::NEG_INFINITY, 4),
                (f32::MAX, 4),
            ] {
                assert_eq!(bin(bins, coordinate), expected, "{coordinate}");
            }
        }
    }

    #[test]
    fn coordinates_next_to_an_edge_depend_on_the_rounding() {
        // 2^-25 below the edge at 0: lost when 2 is added in single precision.
        let coordinate = -(0.5_f32.powi(25));
        assert_eq!(bin(Bins::new(4, 4.0, Rounding::Single), coordinate), 2);
        assert_eq!(bin(Bins::new(4, 4.0, Rounding::Double), coordinate), 1);
    }

    proptest! {
        #[test]
        fn multiplication_and_division_find_the_same_bin(
            n in 2_u32..=64,
            support_m in prop_oneof![0.02_f64..1.0, 1e-30_f64..1e-20, 1e20_f64..1e38, Just(1e300)],
            places in prop::array::uniform8(-1.5_f64..1.5),
            steps in -9_i32..9,
            sign in prop_oneof![Just(1.0_f32), Just(-1.0)],
            is_single in any::<bool>(),
        ) {
            let rounding = if is_single { Rounding::Single } else { Rounding::Double };
            let bins = Bins::new(n, support_m, rounding);
            let check = |coordinates: [f32; LANES]| {
                let turned = bins.by_division(&coordinates, sign);
                let expected = [turned, turned, bins.by_division(&coordinates, 1.0)];
                prop_assert_eq!(bins.indices(&block(coordinates), sign), expected);
                Ok(())
            };
            check(places.map(|place| (place * support_m) as f32))?;
            // Some steps of single precision around each edge.
            for edge in 0..=n {
                let edge_m = (f64::from(edge) / f64::from(n) - 0.5) * support_m;
                let bits = (edge_m as f32).to_bits().wrapping_add_signed(steps);
                check([f32::from_bits(bits); LANES])?;
            }
        }
    }
}
