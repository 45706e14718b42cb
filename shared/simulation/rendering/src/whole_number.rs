//! Whole numbers of floats, in a form that becomes vector instructions.

/// Adding 1.5·2²³ to a number of less than 2²² leaves no bits for a fraction, and
/// the nearest whole number in the lowest bits. Unlike a cast, which checks for
/// overflow number by number, it is the same few instructions for many at once.
const NO_FRACTION: f32 = 12_582_912.0;

/// The whole number at or below `x`, for less than 2²² of either sign; beyond,
/// and for NaN, any number.
#[inline]
pub(crate) fn floor(x: f32) -> i32 {
    let shifted = x + NO_FRACTION;
    let nearest = shifted.to_bits().wrapping_sub(NO_FRACTION.to_bits()) as i32;
    nearest.wrapping_sub(i32::from(shifted - NO_FRACTION > x))
}

/// The whole number at or above `x`, for less than 2³¹ of either sign; beyond,
/// and for NaN, any number.
#[inline]
pub(crate) fn ceil_f64(x: f64) -> i32 {
    // As above, with 1.5·2⁵².
    const NO_FRACTION: f64 = 6_755_399_441_055_744.0;
    let shifted = x + NO_FRACTION;
    let nearest = shifted.to_bits() as i32;
    nearest.wrapping_add(i32::from(shifted - NO_FRACTION < x))
}

/// The whole number next to `x` towards 0, in the same range.
#[inline]
pub(crate) fn truncated(x: f32) -> i32 {
    let magnitude = floor(x.abs());
    if x < 0.0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_agree_with_casts() {
        for i in -4000..4000 {
            for x in [i as f32 / 16.0, i as f32 * 1000.3, i as f32 * 1e-6] {
                assert_eq!(floor(x), x.floor() as i32, "{x}");
                assert_eq!(truncated(x), x as i32, "{x}");
                let x = f64::from(x) + 1e-9;
                assert_eq!(ceil_f64(x), x.ceil() as i32, "{x}");
            }
        }
        for x in [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MIN, f32::MAX] {
            floor(x);
            truncated(x);
            ceil_f64(f64::from(x));
        }
    }
}
