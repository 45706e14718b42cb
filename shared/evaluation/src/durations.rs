//! What measured durations say.

/// The middle and the slow end of durations.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Percentiles {
    /// Half of the durations are not longer.
    pub p50: f64,
    /// 99 of 100 durations are not longer.
    pub p99: f64,
}

impl Percentiles {
    /// Of values of any unit, by nearest rank; `None` without values.
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        Some(Self {
            p50: nearest_rank(&values, 0.5)?,
            p99: nearest_rank(&values, 0.99)?,
        })
    }
}

/// The least of sorted values that a share of them, 0 to 1, does not exceed; `None`
/// without values.
pub fn nearest_rank<T: Copy>(sorted: &[T], share: f64) -> Option<T> {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied()
}

/// Adds up the bytes of a cloud, eight at a time: the least that reading a
/// cloud once can cost.
pub fn sum_of_words(points: &[point_cloud::Point]) -> u64 {
    let word = |low: u32, high: u32| u64::from(low) | u64::from(high) << 32;
    points.iter().fold(0, |sum: u64, point| {
        sum.wrapping_add(word(point.x.to_bits(), point.y.to_bits()))
            .wrapping_add(word(point.z.to_bits(), point.color.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::{Point, Rgba};

    #[test]
    fn percentiles_are_values_by_nearest_rank() {
        let of = |n: u32| Percentiles::of((1..=n).rev().map(f64::from).collect());
        for (n, p50, p99) in [
            (1, 1.0, 1.0),
            (2, 1.0, 2.0),
            (4, 2.0, 4.0),
            (200, 100.0, 198.0),
        ] {
            assert_eq!(of(n), Some(Percentiles { p50, p99 }), "{n} values");
        }
        assert_eq!(of(0), None);
    }

    #[test]
    fn every_byte_is_read() {
        let point = Point {
            x: 1.0,
            y: 2.0,
            z: 3.0,
            color: Rgba(4),
        };
        let sum = sum_of_words(&[point, point]);
        for changed in [
            Point { x: 1.5, ..point },
            Point { y: 1.5, ..point },
            Point { z: 1.5, ..point },
            Point {
                color: Rgba(5),
                ..point
            },
        ] {
            assert_ne!(sum_of_words(&[point, changed]), sum);
        }
    }
}
