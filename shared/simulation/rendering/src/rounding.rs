//! Vectorisable rounding of floating-point numbers to integers.

/// Rounding constant: adding 1.5·2²³ to a number below 2²² leaves no bits for a fraction, and the
/// nearest integer in the lowest bits. Unlike a cast, which checks each number for overflow, it
/// is the same few instructions for many numbers at once.
const ROUNDING_BIAS: f32 = 12_582_912.0;

/// Rounds down to an integer, for magnitudes below 2²²; any number beyond, and for NaN.
#[inline]
pub(crate) fn floor(x: f32) -> i32 {
    let shifted = x + ROUNDING_BIAS;
    let nearest = shifted.to_bits().wrapping_sub(ROUNDING_BIAS.to_bits()) as i32;
    nearest.wrapping_sub(i32::from(shifted - ROUNDING_BIAS > x))
}

/// Rounds up to an integer, for magnitudes below 2³¹; any number beyond, and for NaN.
#[inline]
pub(crate) fn ceil_f64(x: f64) -> i32 {
    // As for `f32`, with 1.5·2⁵².
    const ROUNDING_BIAS: f64 = 6_755_399_441_055_744.0;
    let shifted = x + ROUNDING_BIAS;
    let nearest = shifted.to_bits() as i32;
    nearest.wrapping_add(i32::from(shifted - ROUNDING_BIAS < x))
}

/// Rounds towards 0, for magnitudes below 2²²; any number beyond, and for NaN.
#[inline]
pub(crate) fn truncate(x: f32) -> i32 {
    let magnitude = floor(x.abs());
    if x < 0.0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }
}

/// Rounds to the nearest integer, for magnitudes below 2²².
///
/// Unlike `f32::round` it needs no call where the processor has no instruction for it, and can be
/// vectorised.
#[inline]
pub(crate) fn round(x: f32) -> f32 {
    (x + ROUNDING_BIAS) - ROUNDING_BIAS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_agree_with_casts() {
        for i in -4000..4000 {
            for x in [i as f32 / 16.0, i as f32 * 1000.3, i as f32 * 1e-6] {
                assert_eq!(floor(x), x.floor() as i32, "{x}");
                assert_eq!(truncate(x), x as i32, "{x}");
                let x = f64::from(x) + 1e-9;
                assert_eq!(ceil_f64(x), x.ceil() as i32, "{x}");
            }
        }
        for x in [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MIN, f32::MAX] {
            floor(x);
            truncate(x);
            ceil_f64(f64::from(x));
        }
    }

    #[test]
    fn rounding_is_to_the_nearest() {
        for x in [0.0, 0.4, 0.6, 1.49, 87.51, -3.7, 100_000.3] {
            assert_eq!(round(x), x.round());
        }
    }
}
