//! Conversion between raw depth of a Kinect v1 and metres.
//!
//! A raw value is the disparity the sensor measures, 11 bits, growing with distance. Two fits are
//! in use: Nicolas Burrus's reciprocal (2010), from the first measurements for ROS, and Stéphane
//! Magnenat's tangent (2010, wiki of libfreenect's project, *Imaging Information*). The tangent
//! is the default because it agrees with the sensor's own geometry: with the values libfreenect
//! knows of a Kinect (reference plane 1.2 m at raw 800, projector 75 mm from the camera, pixel
//! 0.1042 mm) it differs by less than half a per cent between 0.57 m and 1.57 m, where the
//! reciprocal is four to five per cent short.

use std::fmt;

/// Raw value of a pixel without depth.
pub const NO_DEPTH: u16 = 2047;
/// Maximum depth, metres: the sensor's own limit. Larger values count as no depth.
pub const MAX_DEPTH_M: f32 = 10.0;

/// Number of raw depth values (11 bits).
const N_VALUES: usize = 2048;

/// Fit that converts raw depth to metres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DepthFormula {
    /// Tangent fit z = 0.1236 · tan(raw / 2842.5 + 1.1863), Magnenat 2010.
    #[default]
    Magnenat,
    /// Reciprocal fit z = 1 / (3.3309495161 − 0.0030711016 · raw), Burrus 2010.
    Burrus,
}

impl DepthFormula {
    /// Depth of a raw value, metres; outside the range of the fit the result is negative, huge or
    /// infinite.
    fn depth_m(self, raw: f64) -> f64 {
        match self {
            Self::Magnenat => 0.1236 * (raw / 2842.5 + 1.1863).tan(),
            Self::Burrus => 1.0 / (3.330_949_516_1 - 0.003_071_101_6 * raw),
        }
    }

    /// Raw value, with its fraction, of a positive depth in metres.
    fn raw(self, depth_m: f64) -> f64 {
        match self {
            Self::Magnenat => 2842.5 * ((depth_m / 0.1236).atan() - 1.1863),
            Self::Burrus => (3.330_949_516_1 - 1.0 / depth_m) / 0.003_071_101_6,
        }
    }
}

/// Look-up table from raw value to metres, 8 kB.
#[derive(Clone, PartialEq)]
pub struct DepthTable {
    formula: DepthFormula,
    /// Depth of each raw value, metres; NaN for no depth.
    depth_m: Box<[f32; N_VALUES]>,
    /// Largest raw depth value that has a depth.
    last_raw: u16,
}

impl fmt::Debug for DepthTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DepthTable")
            .field("formula", &self.formula)
            .finish_non_exhaustive()
    }
}

impl Default for DepthTable {
    fn default() -> Self {
        Self::new(DepthFormula::default())
    }
}

impl DepthTable {
    /// Evaluates the formula for every raw value.
    pub fn new(formula: DepthFormula) -> Self {
        let mut depth_m = Box::new([f32::NAN; N_VALUES]);
        let mut last_raw = 0;
        for raw in 0..NO_DEPTH {
            let z = formula.depth_m(f64::from(raw)) as f32;
            // The fits are monotonic up to their pole and wrong beyond it.
            if !(0.0..=MAX_DEPTH_M).contains(&z) {
                break;
            }
            depth_m[usize::from(raw)] = z;
            last_raw = raw;
        }
        Self {
            formula,
            depth_m,
            last_raw,
        }
    }

    /// Depth of a raw value, metres; NaN for no depth: 2047, everything beyond [`MAX_DEPTH_M`],
    /// and values wider than 11 bits.
    #[inline]
    pub fn depth_m(&self, raw: u16) -> f32 {
        self.depth_m
            .get(usize::from(raw))
            .copied()
            .unwrap_or(f32::NAN)
    }

    /// Smallest and largest representable depth, metres.
    pub fn range_m(&self) -> (f32, f32) {
        (self.depth_m[0], self.depth_m[usize::from(self.last_raw)])
    }

    /// Raw value with the nearest depth, for synthesising recordings: the inverse of
    /// [`Self::depth_m`]. [`NO_DEPTH`] for NaN and out-of-range depths.
    pub fn raw(&self, depth_m: f32) -> u16 {
        let (nearest, farthest) = self.range_m();
        if !(nearest..=farthest).contains(&depth_m) {
            return NO_DEPTH;
        }
        let below =
            (self.formula.raw(f64::from(depth_m)).floor().max(0.0) as u16).min(self.last_raw);
        let above = (below + 1).min(self.last_raw);
        let error = |raw| (self.depth_m(raw) - depth_m).abs();
        if error(above) < error(below) {
            above
        } else {
            below
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FORMULAS: [DepthFormula; 2] = [DepthFormula::Magnenat, DepthFormula::Burrus];

    #[test]
    fn depth_agrees_with_hand_computed_values() {
        let check = |formula, raw, expected_m: f32| {
            let z = DepthTable::new(formula).depth_m(raw);
            assert!((z - expected_m).abs() < 1e-3, "{formula:?} {raw}: {z}");
        };
        // Hand-computed values of the formulas at three points each.
        check(DepthFormula::Magnenat, 0, 0.3055);
        check(DepthFormula::Magnenat, 500, 0.5839);
        check(DepthFormula::Magnenat, 800, 1.1951);
        check(DepthFormula::Burrus, 0, 0.3002);
        check(DepthFormula::Burrus, 500, 0.5570);
        check(DepthFormula::Burrus, 800, 1.1441);
    }

    /// Triangulation by the sensor's geometry, with the factory values libfreenect uses if it
    /// cannot read a device's own (`registration.c`, zero-plane information).
    fn triangulated_m(raw: u16) -> f64 {
        let (reference_cm, base_cm, pixel_cm, reference_raw) = (120.0, 7.5, 0.1042, 800.0);
        let shift_cm = ((f64::from(raw) - reference_raw) / 4.0 - 0.375) * pixel_cm;
        (shift_cm * reference_cm / (base_cm - shift_cm) + reference_cm) / 100.0
    }

    #[test]
    fn default_formula_agrees_with_the_sensor_geometry() {
        let largest_error = |formula| {
            let table = DepthTable::new(formula);
            let error = |raw| (f64::from(table.depth_m(raw)) / triangulated_m(raw) - 1.0).abs();
            (480..=870).map(error).fold(0.0, f64::max)
        };
        assert!(largest_error(DepthFormula::default()) < 0.005);
        assert!(largest_error(DepthFormula::Burrus) > 0.04);
    }

    #[test]
    fn raw_values_beyond_the_range_have_no_depth() {
        for formula in FORMULAS {
            let table = DepthTable::new(formula);
            assert!(table.last_raw > 1000 && table.last_raw < 1084);
            for raw in (table.last_raw + 1..=NO_DEPTH).chain([2048, u16::MAX]) {
                assert!(table.depth_m(raw).is_nan(), "{raw}");
            }
            for depth_m in [f32::NAN, f32::INFINITY, -1.0, 0.0, 0.2, 10.1] {
                assert_eq!(table.raw(depth_m), NO_DEPTH, "{depth_m}");
            }
        }
    }

    #[test]
    fn every_raw_value_comes_back() {
        for formula in FORMULAS {
            let table = DepthTable::new(formula);
            for raw in 0..=table.last_raw {
                assert_eq!(table.raw(table.depth_m(raw)), raw);
            }
            assert_eq!(table.raw(table.depth_m(NO_DEPTH)), NO_DEPTH);
        }
    }

    proptest! {
        /// Brute-force check that the inverse gives the nearest raw value.
        #[test]
        fn the_inverse_is_the_nearest(depth_m in 0.31f32..9.9, burrus: bool) {
            let table = DepthTable::new(FORMULAS[usize::from(burrus)]);
            prop_assume!(depth_m <= table.range_m().1);
            let error = |raw| (table.depth_m(raw) - depth_m).abs();
            let best = (0..=table.last_raw).map(error).fold(f32::INFINITY, f32::min);
            prop_assert_eq!(error(table.raw(depth_m)), best);
        }
    }
}
