//! Association of images by timestamp (Sturm et al. 2012).

/// Largest difference of two images of one frame, seconds: that of TUM's `associate.py`.
const MAX_DIFFERENCE_S: f64 = 0.02;

/// Difference of two timestamps, seconds, and the indices of depth and colour image.
type Candidate = (f64, usize, usize);

/// Parses a timestamp in seconds with decimal places, such as `1305031102.175304`.
pub(super) fn parse_timestamp(name: &str) -> Option<f64> {
    let (seconds, fraction) = name.split_once('.')?;
    let is_number = |digits: &str| {
        (1..=12).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit())
    };
    let is_timestamp = is_number(seconds) && is_number(fraction);
    is_timestamp.then(|| name.parse().ok()).flatten()
}

/// Pairs of indices of two ascending lists of timestamps, seconds, ascending: the nearest first,
/// each at most once, not further apart than 20 ms.
///
/// *Complexity*: O(n log n) for lists with a bounded number of timestamps in 20 ms.
pub(super) fn associate(depth_s: &[f64], color_s: &[f64]) -> Vec<(usize, usize)> {
    let mut candidates = Vec::new();
    for (depth_index, &time_s) in depth_s.iter().enumerate() {
        let first = color_s.partition_point(|&other_s| other_s < time_s - MAX_DIFFERENCE_S);
        let near = color_s[first..].iter().enumerate();
        let near = near.take_while(|(_, other_s)| **other_s <= time_s + MAX_DIFFERENCE_S);
        candidates
            .extend(near.map(|(at, other_s)| ((time_s - other_s).abs(), depth_index, first + at)));
    }
    let by_difference = |left: &Candidate, right: &Candidate| {
        (left.0.total_cmp(&right.0)).then((left.1, left.2).cmp(&(right.1, right.2)))
    };
    candidates.sort_unstable_by(by_difference);
    let (mut is_depth_free, mut is_color_free) =
        (vec![true; depth_s.len()], vec![true; color_s.len()]);
    let mut pairs = Vec::new();
    for (_, depth, color) in candidates {
        if is_depth_free[depth] && is_color_free[color] {
            (is_depth_free[depth], is_color_free[color]) = (false, false);
            pairs.push((depth, color));
        }
    }
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn timestamps_are_decimal_seconds() {
        assert_eq!(
            parse_timestamp("1305031102.175304"),
            Some(1_305_031_102.175_304)
        );
        for other in [
            "000123", "1.", ".5", "1e3.5", "-1.5", "1.5.2", "frame.1", "",
        ] {
            assert_eq!(parse_timestamp(other), None, "{other}");
        }
    }

    #[test]
    fn the_nearest_image_is_taken() {
        let (depth_s, color_s) = ([0.0, 0.033, 0.5], [0.01, 0.035, 0.045]);
        assert_eq!(associate(&depth_s, &color_s), [(0, 0), (1, 1)]);
    }

    proptest! {
        #[test]
        fn pairs_are_near_unique_and_complete(
            mut depth_ms in prop::collection::vec(0..2000_u32, 0..60),
            mut color_ms in prop::collection::vec(0..2000_u32, 0..60),
        ) {
            depth_ms.sort_unstable();
            color_ms.sort_unstable();
            let seconds = |ms: &[u32]| ms.iter().map(|&ms| f64::from(ms) / 1e3).collect::<Vec<_>>();
            let pairs = associate(&seconds(&depth_ms), &seconds(&color_ms));
            let is_near = |depth: usize, color: usize| depth_ms[depth].abs_diff(color_ms[color]) < 20;
            prop_assert!(pairs.iter().all(|&(d, c)| depth_ms[d].abs_diff(color_ms[c]) <= 20));
            prop_assert!(pairs.is_sorted_by(|left, right| left.0 < right.0));
            let mut colors: Vec<usize> = pairs.iter().map(|pair| pair.1).collect();
            colors.sort_unstable();
            prop_assert!(colors.is_sorted_by(|left, right| left < right));
            // No image is left without a companion beside a free one.
            for depth in (0..depth_ms.len()).filter(|d| pairs.iter().all(|pair| pair.0 != *d)) {
                for color in (0..color_ms.len()).filter(|c| pairs.iter().all(|pair| pair.1 != *c)) {
                    prop_assert!(!is_near(depth, color));
                }
            }
        }
    }
}
